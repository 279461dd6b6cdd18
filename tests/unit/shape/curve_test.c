/* SPDX-License-Identifier: MIT */
/* Curves: where rays meet them by closed form and by brute force, and that hits, points and boxes tell the same. */
#include "common.h"

#include <string.h>

enum { FLAT, RIBBON, CYLINDER };

static struct sr_shape make_curve(struct sr_shape_curve c, struct sr_shape_placement placement)
{
    struct sr_shape_curves *m = sr_arena_alloc(&test_arena, sizeof *m);
    m->one = c;
    return PREPARE(sr_shape_curve, m, placement);
}

static struct sr_shape_curve bezier(const sr_vec3 P[4], float width0, float width1, int type)
{
    return (struct sr_shape_curve){.width = 1,
                                   .width0 = width0,
                                   .width1 = width1,
                                   .degree = 3,
                                   .type = type,
                                   .split_depth = 3,
                                   .P = {sr_arena_copy(&test_arena, P, 4 * sizeof *P), 4}};
}

struct found {
    bool is_hit;
    float t;
    sr_vec2 hit;
    uint32_t primitive;
};

static struct found cast_all(struct sr_shape s, sr_vec3 o, sr_vec3 d)
{
    struct found f = {.t = INFINITY};
    uint32_t n = s.model->primitive_count(s.self);
    for (uint32_t i = 0; i < n; ++i) {
        float t;
        sr_vec2 hit;
        if (s.model->intersect(s.self, i, o, d, 1e-20f, f.t, &t, &hit))
            f = (struct found){true, t, hit, i};
    }
    return f;
}

static struct sr_point point_of(struct sr_shape s, struct found f, sr_vec3 d)
{
    struct sr_point x = {.time = 0};
    s.model->seen_point(s.self, f.primitive, f.hit, d, &x);
    return x;
}

/* u along all the segments: as if there were one */
static float u_of(struct sr_shape s, struct found f)
{
    const struct sr_shape_curves *m = s.self;
    return (float)(f.primitive >> m->split) + f.hit.x;
}

static const sr_vec3 straight[4] = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}};

TEST(curve_straight_strip_by_closed_form)
{
    struct sr_shape s = make_curve(bezier(straight, 0.2f, 0.4f, FLAT), here());
    struct sr_rng rng = sr_rng_seed(3, 1);
    for (int i = 0; i < 2000; ++i) {
        float z = 3.4f * uniform(&rng) - 0.2f, y = 0.5f * uniform(&rng) - 0.25f, h = 0.2f + 0.2f * z / 3;
        struct found f = cast_all(s, (sr_vec3){5, y, z}, (sr_vec3){-2, 0, 0});
        bool expected = z >= 0 && z <= 3 && fabsf(y) <= h / 2;
        if (fabsf(fabsf(y) - h / 2) < 1e-5f)
            continue;
        EXPECT_EQUAL_INT(f.is_hit, expected);
        if (!expected)
            continue;
        EXPECT_NEAR(f.t, 2.5, 1e-5);
        EXPECT_NEAR(f.hit.x, z / 3, 1e-5);
        EXPECT_NEAR(f.hit.y, 0.5f + y / h, 1e-4); // b = d x z = (-1 0 0) x (0 0 1) = (0 1 0)
        struct sr_point x = point_of(s, f, (sr_vec3){-2, 0, 0});
        EXPECT_NEAR(x.p.x, 0, 1e-6);
        EXPECT_NEAR(x.p.y, y, 1e-6);
        EXPECT_NEAR(x.p.z, z, 1e-5);
        EXPECT_NEAR(x.n.x, -1, 1e-6); // away from the viewer, as pbrt has it
        EXPECT_NEAR(x.dpdu.z, 3, 1e-5);
        EXPECT_NEAR(x.dpdv.y, h, 1e-5);
    }
    double area = 0;
    for (uint32_t i = 0; i < s.model->primitive_count(s.self); ++i)
        area += (double)s.model->area(s.self, i);
    EXPECT_NEAR(area, 0.9, 1e-6);
}

TEST(curve_cylinder_turns_its_normal_across)
{
    struct sr_shape s = make_curve(bezier(straight, 1, 1, CYLINDER), here());
    for (int i = 0; i < 100; ++i) {
        float y = ((float)i + 0.5f) / 100 - 0.5f;
        sr_vec3 d = {-1, 0, 0};
        struct found f = cast_all(s, (sr_vec3){5, y, 1}, d);
        EXPECT(f.is_hit);
        struct sr_point x = point_of(s, f, d);
        EXPECT_NEAR(x.n.x, -cos((double)SR_PI * (double)y), 1e-5);
        EXPECT_NEAR(x.n.y, sin((double)SR_PI * (double)y), 1e-5);
        EXPECT_NEAR(sr_dot(x.n, x.dpdv), 0, 1e-6);
        EXPECT_NEAR(x.p.x, 0, 1e-6);
    }
}

TEST(curve_ribbon_narrows_as_it_turns)
{
    const sr_vec3 N[2] = {{2, 0, 0}, {0, 3, 0}}; // a quarter turn: N(u) = (cos(pi u / 2), sin(pi u / 2), 0)
    struct sr_shape_curve c = bezier(straight, 1, 1, RIBBON);
    c.N = (struct sr_slice){N, 2};
    struct sr_shape s = make_curve(c, here());
    for (int i = 0; i < 200; ++i) {
        float u = ((float)i + 0.5f) / 200, half = 0.5f * cosf(SR_PI / 2 * u);
        sr_vec3 d = {-1, 0, 0};
        struct found in = cast_all(s, (sr_vec3){4, half - 1e-4f, 3 * u}, d),
                     out = cast_all(s, (sr_vec3){4, half + 1e-4f, 3 * u}, d);
        EXPECT(in.is_hit || half < 2e-4f);
        EXPECT(!out.is_hit);
        if (!in.is_hit)
            continue;
        struct sr_point x = point_of(s, in, d);
        EXPECT_NEAR(fabsf(x.n.x), cosf(SR_PI / 2 * u), 1e-4);
        EXPECT_NEAR(fabsf(x.n.y), sinf(SR_PI / 2 * u), 1e-4);
    }
}

static void random_points(struct sr_rng *rng, sr_vec3 *P, int n)
{
    for (int i = 0; i < n; ++i)
        P[i] = (sr_vec3){2 * uniform(rng) - 1, 2 * uniform(rng) - 1, 2 * uniform(rng) - 1};
}

static void bezier_at(const sr_vec3 P[4], double t, double p[3])
{
    double s = 1 - t, w[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    p[0] = p[1] = p[2] = 0;
    for (int k = 0; k < 4; ++k)
        p[0] += w[k] * (double)P[k].x, p[1] += w[k] * (double)P[k].y, p[2] += w[k] * (double)P[k].z;
}

/* Least over u of twice the distance of the ray's line from the curve over the width there; *u: where. */
static double brute_force(const sr_vec3 P[4], double h0, double h1, sr_vec3 o, sr_vec3 d, double *u)
{
    enum { steps = 4000 };
    double best = INFINITY;
    for (int i = 0; i <= steps; ++i) {
        double t = (double)i / steps, p[3];
        bezier_at(P, t, p);
        double q[3] = {p[0] - (double)o.x, p[1] - (double)o.y, p[2] - (double)o.z},
               w[3] = {(double)d.x, (double)d.y, (double)d.z};
        double along = q[0] * w[0] + q[1] * w[1] + q[2] * w[2],
               d2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - along * along;
        double r = 2 * sqrt(fmax(d2, 0)) / (h0 + t * (h1 - h0));
        if (r < best && along > 0) {
            best = r;
            *u = t;
        }
    }
    return best;
}

TEST(curve_is_met_where_brute_force_says)
{
    struct sr_rng rng = sr_rng_seed(5, 1);
    int hits = 0, wrong = 0, tried = 0, far = 0;
    for (int k = 0; k < 60; ++k) {
        sr_vec3 P[4];
        random_points(&rng, P, 4);
        struct sr_shape s = make_curve(bezier(P, 0.02f, 0.1f, k % 2 ? CYLINDER : FLAT), here());
        for (int i = 0; i < 50; ++i) {
            double at[3], u = 0;
            bezier_at(P, (double)uniform(&rng), at);
            sr_vec3 d = random_direction(&rng), off = sr_scale(0.08f, random_direction(&rng));
            sr_vec3 o = sr_mad(sr_add((sr_vec3){(float)at[0], (float)at[1], (float)at[2]}, off), -6, d);
            double r = brute_force(P, 0.02, 0.1, o, d, &u);
            if (fabs(r - 1) < 0.05 || u < 0.01 || u > 0.99)
                continue;
            struct found f = cast_all(s, o, d);
            ++tried;
            wrong += f.is_hit != (r < 1);
            hits += f.is_hit;
            if (!f.is_hit)
                continue;
            struct sr_point x = point_of(s, f, d);
            sr_vec3 there = sr_mad(o, f.t, d), miss = sr_sub(x.p, there);
            double h = 0.02 + 0.08 * (double)f.hit.x;
            far += (double)sr_length(miss) > 0.01 * h;
            struct sr_box b = s.model->bounds(s.self, f.primitive);
            EXPECT(sr_box_contains(b, x.p));
            EXPECT(f.hit.y >= 0 && f.hit.y <= 1 && f.hit.x >= 0 && f.hit.x <= 1);
            EXPECT_NEAR(sr_length(x.n), 1, 1e-5);
        }
    }
    EXPECT(hits > 300 && tried > 1500);
    EXPECT(wrong <= tried / 200); // cusps seen end on
    EXPECT(far <= hits / 100);
}

TEST(curve_bases_and_degrees_are_the_same_curve)
{
    struct sr_rng rng = sr_rng_seed(6, 1);
    sr_vec3 B[6];
    random_points(&rng, B, 6);
    for (int degree = 2; degree <= 3; ++degree) {
        struct sr_shape_curve c = {
            .width = 0.3f, .width0 = 0.1f, .width1 = 0.3f, .degree = degree, .basis = 1, .split_depth = 2, .P = {B, 6}};
        struct sr_shape spline = make_curve(c, here());
        // the same by knots' averages: Bézier points of a uniform spline
        sr_vec3 Z[16];
        int n = 0, segments = 6 - degree;
        for (int i = 0; i < segments; ++i) {
            const sr_vec3 *q = B + i;
            if (degree == 2) {
                if (i == 0)
                    Z[n++] = sr_scale(0.5f, sr_add(q[0], q[1]));
                Z[n++] = q[1];
                Z[n++] = sr_scale(0.5f, sr_add(q[1], q[2]));
            } else {
                sr_vec3 a = sr_scale(1 / 3.0f, sr_add(sr_scale(2, q[1]), q[2])),
                        b = sr_scale(1 / 3.0f, sr_add(q[1], sr_scale(2, q[2])));
                sr_vec3 before = sr_scale(1 / 3.0f, sr_add(q[0], sr_scale(2, q[1]))),
                        after = sr_scale(1 / 3.0f, sr_add(sr_scale(2, q[2]), q[3]));
                if (i == 0)
                    Z[n++] = sr_scale(0.5f, sr_add(before, a));
                Z[n++] = a;
                Z[n++] = b;
                Z[n++] = sr_scale(0.5f, sr_add(b, after));
            }
        }
        struct sr_shape_curve k = c;
        k.basis = 0;
        k.P = (struct sr_slice){Z, (uint32_t)n};
        k.split_depth = 0;
        struct sr_shape same = make_curve(k, here());
        EXPECT_EQUAL_INT((int)((const struct sr_shape_curves *)same.self)->count, segments);
        int hits = 0;
        for (int i = 0; i < 4000; ++i) {
            sr_vec3 d = random_direction(&rng), o = sr_mad(sr_scale(0.6f, random_direction(&rng)), -4, d);
            struct found f = cast_all(spline, o, d), g = cast_all(same, o, d);
            if (!f.is_hit || !g.is_hit || f.hit.y < 0.01f || f.hit.y > 0.99f)
                continue;
            ++hits;
            if (fabsf(f.t - g.t) > 1e-3f)
                continue;
            EXPECT_NEAR(u_of(spline, f), u_of(same, g), 2e-3);
            EXPECT_NEAR(f.hit.y, g.hit.y, 1e-2);
        }
        EXPECT(hits > 200);
    }
}

TEST(curve_widths_run_along_all_segments)
{
    const sr_vec3 P[10] = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4},
                           {0, 0, 5}, {0, 0, 6}, {0, 0, 7}, {0, 0, 8}, {0, 0, 9}};
    struct sr_shape_curve c = {.width = 0.1f, .width0 = NAN, .width1 = 1, .degree = 3, .split_depth = 3, .P = {P, 10}};
    struct sr_shape s = make_curve(c, here());
    for (float z = 0.25f; z < 9; z += 0.5f) {
        float half = 0.5f * (0.1f + 0.9f * z / 9);
        EXPECT(cast_all(s, (sr_vec3){3, half - 1e-4f, z}, (sr_vec3){-1, 0, 0}).is_hit);
        EXPECT(!cast_all(s, (sr_vec3){3, half + 1e-4f, z}, (sr_vec3){-1, 0, 0}).is_hit);
    }
}

TEST(curve_transforms_scale_the_width)
{
    struct sr_rng rng = sr_rng_seed(8, 1);
    sr_vec3 P[4];
    random_points(&rng, P, 4);
    const sr_vec3 N[2] = {{1, 0, 0}, {0, 0.6f, 0.8f}};
    const struct sr_transform t[4] = {
        then(sr_transform_translate((sr_vec3){1, 2, 3}),
             then(sr_transform_rotate(40, (sr_vec3){1, 2, 1}), sr_transform_scale((sr_vec3){3, 3, 3}))),
        then(sr_transform_rotate(70, (sr_vec3){0, 2, 1}), sr_transform_scale((sr_vec3){2, 2, -2})),
        then(sr_transform_rotate(20, (sr_vec3){1, 0, 1}), sr_transform_scale((sr_vec3){1, 2, 4})),
        sr_transform_scale((sr_vec3){-1, 2, 0.5f}),
    };
    for (int k = 0; k < 12; ++k) {
        struct sr_shape_curve c = bezier(P, 0.2f, 0.1f, k / 4);
        c.N = (struct sr_slice){N, 2};
        struct sr_shape object = make_curve(c, here()), world = make_curve(c, placed(t[k % 4]));
        EXPECT_EQUAL_INT(((const struct sr_shape_curves *)world.self)->is_here, k % 4 == 0);
        int hits = 0;
        for (int i = 0; i < 1500; ++i) {
            sr_vec3 d = random_direction(&rng), o = sr_mad(sr_scale(0.5f, random_direction(&rng)), -4, d);
            struct found f = cast_all(object, o, d);
            sr_vec3 dw = sr_transform_vector(&t[k % 4], d);
            struct found g = cast_all(world, sr_transform_point(&t[k % 4], o), dw);
            if (f.is_hit != g.is_hit || !f.is_hit || fabsf(f.t - g.t) > 1e-3f)
                continue; // a grazing ray
            ++hits;
            EXPECT_NEAR(f.hit.x, g.hit.x, 3e-3);
            struct sr_point x = point_of(object, f, d), y = point_of(world, g, dw);
            sr_vec3 n = sr_normalize(sr_transform_normal(&t[k % 4], x.n));
            bool is_mirror = sr_transform_swaps_handedness(&t[k % 4]);
            EXPECT_NEAR(sr_dot(n, y.n), is_mirror ? -1 : 1, 1e-3);
            EXPECT(sr_box_contains(world.model->bounds(world.self, g.primitive), y.p));
            EXPECT_NEAR(sr_length(sr_sub(sr_transform_point(&t[k % 4], x.p), y.p)), 0, 5e-3);
        }
        EXPECT(hits > 60);
    }
}

TEST(curve_shows_length_times_width)
{
    // a strip that faces parallel rays from any side shows L h sin(angle)
    struct sr_shape s = make_curve(bezier(straight, 0.1f, 0.3f, FLAT), here());
    struct sr_rng rng = sr_rng_seed(9, 1);
    for (int k = 0; k < 4; ++k) {
        sr_vec3 d = random_direction(&rng);
        struct sr_frame f = sr_frame_from_z(d);
        struct sr_tally hits = {0};
        for (int i = 0; i < 20000; ++i) {
            sr_vec2 u = {4 * uniform(&rng) - 2, 4 * uniform(&rng) - 2};
            sr_vec3 o = sr_add((sr_vec3){0, 0, 1.5f}, sr_to_world(&f, (sr_vec3){u.x, u.y, -5}));
            sr_tally_add(&hits, cast_all(s, o, d).is_hit);
        }
        EXPECT_MEAN(hits, 3 * 0.2 * sqrt(1 - (double)d.z * (double)d.z) / 16);
    }
}

TEST(curve_is_not_met_by_rays_that_leave_it)
{
    struct sr_rng rng = sr_rng_seed(10, 1);
    const sr_vec3 N[2] = {{1, 0, 0}, {0, 1, 0}};
    for (int type = 0; type < 3; ++type)
        for (int k = 0; k < 40; ++k) {
            float offset = k % 2 ? 0 : 100; // [m] from the origin
            sr_vec3 P[4], way = random_direction(&rng);
            for (int i = 0; i < 4; ++i)
                P[i] = sr_mad((sr_vec3){offset, -offset, 0}, (float)i, way);
            struct sr_shape_curve c = bezier(P, 0.01f, 0.02f, type);
            c.N = (struct sr_slice){N, 2};
            struct sr_shape s = make_curve(c, here());
            for (int i = 0; i < 100; ++i) {
                sr_vec3 d = random_direction(&rng), b = sr_cross(d, way);
                sr_vec3 at =
                    sr_mad(sr_mad(P[0], 3 * uniform(&rng), way), 0.008f * (uniform(&rng) - 0.5f), sr_normalize(b));
                struct found f = cast_all(s, sr_mad(at, -3, d), d);
                if (!f.is_hit)
                    continue;
                struct sr_point x = point_of(s, f, d);
                for (int j = 0; j < 20; ++j) {
                    sr_vec3 w = random_direction(&rng);
                    if (cast_all(s, sr_point_offset(&x, w), w).is_hit)
                        test_fail(__FILE__, __LINE__, "type %d, offset %g", type, (double)offset);
                }
            }
        }
}

static void expect_refused(struct sr_shape_curve c, const char *says)
{
    struct sr_shape_curves m = {.one = c};
    struct sr_shape_placement placement = here();
    struct sr_error error = {0};
    EXPECT(sr_shape_curve.prepare(&m, &placement, &test_arena, &error) != SR_OK);
    if (!strstr(error.text, says))
        test_fail(__FILE__, __LINE__, "expected \"%s\" in \"%s\"", says, error.text);
}

TEST(curve_refuses_wrong_counts)
{
    struct sr_shape_curve good = bezier(straight, 1, 1, FLAT), c = good;
    c.P.count = 3;
    expect_refused(c, "3 \"P\", expected 4");
    c = good;
    c.P.count = 0;
    c.basis = 1;
    expect_refused(c, "0 \"P\"");
    c = good;
    c.degree = 2; // 3, 5, 7
    expect_refused(c, "4 \"P\", expected 3");
    c = good;
    c.type = RIBBON;
    expect_refused(c, "0 \"N\", expected 2");
    const sr_vec3 N[2] = {{1, 0, 0}, {0, 0, 0}};
    c.N = (struct sr_slice){N, 2};
    expect_refused(c, "none is 0");
    c = good;
    c.width0 = INFINITY;
    expect_refused(c, "finite");
    const sr_vec3 bad[4] = {{0, 0, 0}, {0, NAN, 0}, {1, 1, 1}, {2, 2, 2}};
    expect_refused(bezier(bad, 1, 1, FLAT), "finite");
}

TEST(curve_without_extent_is_never_met)
{
    const sr_vec3 P[4] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    struct sr_shape dot = make_curve(bezier(P, 1, 1, FLAT), here()),
                    thin = make_curve(bezier(straight, 0, 0, FLAT), here());
    EXPECT(!cast_all(dot, (sr_vec3){0, 1, 1}, (sr_vec3){1, 0, 0}).is_hit);
    EXPECT(!cast_all(thin, (sr_vec3){-1, 0, 1}, (sr_vec3){1, 0, 0}).is_hit);
    EXPECT(!cast_all(make_curve(bezier(straight, 1, 1, FLAT), here()), (sr_vec3){0, 0, -1}, (sr_vec3){0, 0, 1})
                .is_hit); // end on
    EXPECT_EQUAL_INT((int)dot.model->area(dot.self, 0), 0);
    EXPECT_EQUAL_INT((int)thin.model->area(thin.self, 0), 0);
}
