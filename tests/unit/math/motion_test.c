/* SPDX-License-Identifier: MIT */
/* Motions: their ends, the way between against quaternions, inverses, boxes. */
#include "test.h"

static uint32_t state = 4321;

static float uniform(float lo, float hi)
{
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return lo + (hi - lo) * ((float)(state >> 8) * 0x1p-24f);
}

static sr_vec3 vector(float size)
{
    return (sr_vec3){uniform(-size, size), uniform(-size, size), uniform(-size, size)};
}

static struct sr_transform product(struct sr_transform a, struct sr_transform b)
{
    return sr_transform_multiply(&a, &b);
}

static struct sr_transform any(bool mirrors)
{
    struct sr_transform turn = sr_transform_rotate(uniform(-180, 180), vector(1)),
                        other = sr_transform_rotate(uniform(-180, 180), vector(1));
    struct sr_transform size = sr_transform_scale(
        (sr_vec3){uniform(0.3f, 3), mirrors ? uniform(-3, -0.3f) : uniform(0.3f, 3), uniform(0.3f, 3)});
    return product(product(sr_transform_translate(vector(10)), turn), product(size, other));
}

static void expect_close(sr_vec3 a, sr_vec3 b, float tolerance)
{
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(motions_begin_and_end_where_they_are_told)
{
    for (int i = 0; i < 200; ++i) {
        struct sr_transform a = any(i & 1), b = any(i & 1), t;
        struct sr_motion m;
        EXPECT(sr_motion_make(&a, &b, 0.25f, 0.75f, &m) && m.moves);
        sr_vec3 p = vector(1);
        sr_motion_at(&m, 0.1f, &t);
        expect_close(sr_transform_point(&t, p), sr_transform_point(&a, p), 0);
        sr_motion_at(&m, 0.9f, &t);
        expect_close(sr_transform_point(&t, p), sr_transform_point(&b, p), 0);
        // near the ends: nothing jumps
        sr_motion_at(&m, 0.25f + 1e-6f, &t);
        expect_close(sr_transform_point(&t, p), sr_transform_point(&a, p), 3e-4f);
        sr_motion_at(&m, 0.75f - 1e-6f, &t);
        expect_close(sr_transform_point(&t, p), sr_transform_point(&b, p), 3e-4f);
        sr_motion_at(&m, uniform(0.25f, 0.75f), &t);
        expect_close(sr_inverse_point(&t, sr_transform_point(&t, p)), p, 4e-5f);
        EXPECT(sr_transform_swaps_handedness(&t) == (i & 1));
    }
}

/* Unit quaternions x, y, z, w and slerp, as Shoemake gave them, 1985. */
static void quaternion(double angle, const double axis[3], double q[4])
{
    for (int i = 0; i < 3; ++i)
        q[i] = sin(angle / 2) * axis[i];
    q[3] = cos(angle / 2);
}

static sr_vec3 turned(const double q[4], sr_vec3 v)
{
    double p[3] = {(double)v.x, (double)v.y, (double)v.z}, t[3], r[3];
    for (int i = 0; i < 3; ++i) // t = 2 q x p,  p' = p + w t + q x t
        t[i] = 2 * (q[(i + 1) % 3] * p[(i + 2) % 3] - q[(i + 2) % 3] * p[(i + 1) % 3]);
    for (int i = 0; i < 3; ++i)
        r[i] = p[i] + q[3] * t[i] + q[(i + 1) % 3] * t[(i + 2) % 3] - q[(i + 2) % 3] * t[(i + 1) % 3];
    return (sr_vec3){(float)r[0], (float)r[1], (float)r[2]};
}

TEST(the_way_between_is_slerp_after_even_stretching)
{
    for (int i = 0; i < 300; ++i) {
        double angle[2] = {(double)uniform(-180, 180), (double)uniform(-180, 180)}, q[2][4], dot = 0;
        sr_vec3 axis[2] = {sr_normalize(vector(1)), sr_normalize(vector(1))}, T[2] = {vector(5), vector(5)},
                S[2] = {{1, 2, 0.5f}, {2, 1, 0.7f}};
        struct sr_transform ends[2];
        for (int k = 0; k < 2; ++k) {
            const double a[3] = {(double)axis[k].x, (double)axis[k].y, (double)axis[k].z};
            quaternion(angle[k] * (3.14159265358979323846 / 180), a, q[k]);
            ends[k] = product(product(sr_transform_translate(T[k]), sr_transform_rotate((float)angle[k], axis[k])),
                              sr_transform_scale(S[k]));
        }
        for (int c = 0; c < 4; ++c)
            dot += q[0][c] * q[1][c];
        if (fabs(dot) < 1e-3) // which way round is shorter is a matter of rounding
            continue;
        struct sr_motion m;
        EXPECT(sr_motion_make(&ends[0], &ends[1], 0, 1, &m));
        double x = (double)uniform(0, 1), theta = acos(fmin(fabs(dot), 1)), now[4];
        for (int c = 0; c < 4; ++c)
            now[c] = theta < 1e-6 ? q[0][c]
                                  : (sin((1 - x) * theta) * q[0][c] + (dot < 0 ? -1 : 1) * sin(x * theta) * q[1][c]) /
                                        sin(theta);
        sr_vec3 p = vector(1), s = sr_add(sr_scale((float)(1 - x), S[0]), sr_scale((float)x, S[1]));
        sr_vec3 expected = sr_add(turned(now, (sr_vec3){s.x * p.x, s.y * p.y, s.z * p.z}),
                                  sr_add(sr_scale((float)(1 - x), T[0]), sr_scale((float)x, T[1])));
        struct sr_transform t;
        sr_motion_at(&m, (float)x, &t);
        expect_close(sr_transform_point(&t, p), expected, 2e-5f);
    }
}

TEST(boxes_hold_what_moves_in_them)
{
    double spare = 0;
    for (int i = 0; i < 300; ++i) {
        struct sr_transform a = any(false), b = any(false), t;
        struct sr_motion m;
        EXPECT(sr_motion_make(&a, &b, 0.2f, 0.9f, &m));
        sr_vec3 c = vector(3), half = {uniform(0.1f, 2), uniform(0.1f, 2), uniform(0.1f, 2)};
        struct sr_box own = {sr_sub(c, half), sr_add(c, half)}, tight = sr_box_empty();
        float t0 = uniform(0, 1), t1 = uniform(t0, 1);
        struct sr_box all = sr_motion_box(&m, own, t0, t1);
        for (int k = 0; k <= 400; ++k) {
            sr_motion_at(&m, t0 + (t1 - t0) * (float)k / 400, &t);
            struct sr_box now = sr_box_transform(&t, own);
            EXPECT(sr_box_contains(all, now.lo) && sr_box_contains(all, now.hi));
            tight = sr_box_union(tight, now);
        }
        spare = fmax(spare, (double)(sr_length(sr_box_diagonal(all)) / sr_length(sr_box_diagonal(tight))));
    }
    EXPECT(spare < 1.01); // and hardly more
}

TEST(no_way_leads_through_a_mirror)
{
    struct sr_transform a = sr_transform_identity(), b = sr_transform_scale((sr_vec3){-1, 1, 1}), c = a, t;
    struct sr_motion m;
    EXPECT(!sr_motion_make(&a, &b, 0, 1, &m));
    c.m[3][0] = 0.5f;
    EXPECT(!sr_motion_make(&a, &c, 0, 1, &m));
    EXPECT(sr_motion_make(&b, &b, 0, 1, &m) && !m.moves); // what stands may be anything
    sr_motion_at(&m, 0.5f, &t);
    EXPECT_NEAR(t.m[0][0], -1, 0);
    c = sr_transform_rotate(180, (sr_vec3){0, 0, 1}); // half a turn: about +z
    EXPECT(sr_motion_make(&a, &c, 0, 1, &m));
    sr_motion_at(&m, 0.5f, &t);
    expect_close(sr_transform_vector(&t, (sr_vec3){1, 0, 0}), (sr_vec3){0, 1, 0}, 1e-6f);
    EXPECT(sr_motion_make(&a, &c, 0.5f, 0.5f, &m)); // a jump
    sr_motion_at(&m, 0.5f, &t);
    EXPECT_NEAR(t.m[0][0], 1, 0);
    sr_motion_at(&m, 0.51f, &t);
    EXPECT_NEAR(t.m[0][0], -1, 0);
}
