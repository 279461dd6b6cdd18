/* SPDX-License-Identifier: MIT */
/* Rays, points, orientation, boxes and areas against closed forms and equations in double. */
#include "common.h"

static const double pi = 3.14159265358979323846;

/* The distance from the implicit surface in object space, in double. */
static double off_surface(struct sr_shape s, sr_vec3 p)
{
    const struct sr_shape_quadric *q = s.model == &sr_shape_sphere ? &((const struct sr_shape_sphere *)s.self)->quadric
                                       : s.model == &sr_shape_disk
                                           ? &((const struct sr_shape_disk *)s.self)->quadric
                                           : &((const struct sr_shape_cylinder *)s.self)->quadric;
    double o[3], w[3] = {(double)p.x, (double)p.y, (double)p.z};
    for (int i = 0; i < 3; ++i)
        o[i] = q->to_object[i][0] * w[0] + q->to_object[i][1] * w[1] + q->to_object[i][2] * w[2] + q->to_object[i][3];
    if (s.model == &sr_shape_sphere)
        return sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2]) - (double)((const struct sr_shape_sphere *)s.self)->radius;
    if (s.model == &sr_shape_disk)
        return o[2] - (double)((const struct sr_shape_disk *)s.self)->height;
    return sqrt(o[0] * o[0] + o[1] * o[1]) - (double)((const struct sr_shape_cylinder *)s.self)->radius;
}

static struct sr_shape quadric(int k, struct sr_transform t)
{
    switch (k) {
    case 0:
        return make_sphere(1.3f, placed(t));
    case 1:
        return make_partial_sphere(1.3f, -0.7f, 1.1f, 210, placed(t));
    case 2:
        return make_disk(0.4f, 1.2f, 0.3f, 320, placed(t));
    case 3:
        return make_cylinder(0.8f, -0.4f, 1, 300, placed(t));
    default:
        return make_disk(0, 1, 0, 360, placed(t));
    }
}

static struct sr_transform somewhere(struct sr_rng *rng, float far)
{
    struct sr_transform t = sr_transform_translate(sr_scale(far, random_direction(rng)));
    t = then(t, sr_transform_rotate(360 * uniform(rng), random_direction(rng)));
    return then(t, sr_transform_scale((sr_vec3){0.5f + uniform(rng), 0.5f + uniform(rng), -0.5f - uniform(rng)}));
}

/* The point of a hit lies on the surface to within p_error, and on the ray to within the precision of the hit's floats.
 */
TEST(points_lie_on_the_surface_within_their_error)
{
    struct sr_rng rng = sr_rng_seed(1, 1);
    const float far[] = {0, 3, 1000, 1e5f};
    for (int k = 0; k < 5; ++k) {
        int hits = 0;
        for (int i = 0; i < 4000; ++i) {
            struct sr_shape s = quadric(k, somewhere(&rng, far[i % 4]));
            struct sr_box b = s.model->bounds(s.self, 0);
            sr_vec3 c = sr_box_centre(b), o = sr_mad(c, 4, random_direction(&rng));
            sr_vec3 d = sr_normalize(sr_sub(sr_mad(c, 1, random_direction(&rng)), o));
            float t;
            sr_vec2 hit;
            if (!cast(s, o, d, &t, &hit))
                continue;
            ++hits;
            struct sr_point x;
            s.model->point(s.self, 0, hit, &x);
            double error = (double)sr_length(x.p_error), ulp = 6e-8 * (double)fmaxf(sr_length(o), sr_length(x.p));
            EXPECT(fabs(off_surface(s, x.p)) <= 2.5 * error + 1e-14); // scales of 0.5 … 1.5 and three axes
            EXPECT(error <= 2e-7 * (double)sr_length(x.p) + 1e-30);
            EXPECT(sr_length(sr_sub(sr_mad(o, t, d), x.p)) < 4e-6 + 10 * ulp);
            EXPECT(sr_box_contains(b, x.p));
            EXPECT_NEAR(sr_length(x.n), 1, 1e-6);
            sr_vec2 uv = s.model->uv(s.self, 0, hit);
            EXPECT(uv.x == x.uv.x && uv.y == x.uv.y && uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
            // the frame lies in the surface
            EXPECT(fabsf(sr_dot(x.n, x.dpdu)) < 1e-5f * sr_length(x.dpdu));
            EXPECT(fabsf(sr_dot(x.n, x.dpdv)) < 1e-5f * sr_length(x.dpdv));
        }
        EXPECT(hits > 800);
    }
}

/* Whether a ray meets a whole sphere is told by its distance from the centre; where, by Pythagoras. */
TEST(sphere_is_met_where_pythagoras_says)
{
    struct sr_rng rng = sr_rng_seed(2, 1);
    for (int i = 0; i < 20000; ++i) {
        sr_vec3 c = sr_scale(5 * uniform(&rng), random_direction(&rng));
        float r = powf(10, -3 + 4 * uniform(&rng));
        struct sr_shape s = i % 64 ? (struct sr_shape){0} : make_sphere(r, placed(sr_transform_translate(c)));
        if (!s.model)
            continue;
        for (int j = 0; j < 200; ++j) {
            sr_vec3 o = sr_mad(c, 3 * r, random_direction(&rng)),
                    d = sr_normalize(sr_sub(sr_mad(c, 1.2f * r, random_direction(&rng)), o));
            double w[3] = {(double)c.x - (double)o.x, (double)c.y - (double)o.y, (double)c.z - (double)o.z};
            double dd = (double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z;
            double along = (w[0] * d.x + w[1] * d.y + w[2] * d.z) / dd,
                   h2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2] - along * along * dd;
            double r2 = (double)r * (double)r;
            float t;
            sr_vec2 hit;
            bool is_met = cast(s, o, d, &t, &hit);
            if (fabs(h2 - r2) > 1e-6 * r2)
                EXPECT(is_met == (h2 < r2 && along > 0));
            if (is_met && h2 < r2 * (1 - 1e-5))
                EXPECT_RELATIVE(t, along - sqrt((r2 - h2) / dd), 1e-5);
        }
    }
}

/* A ray cast at a chosen point of known uv comes back with that uv, and the derivatives are those of differences. */
TEST(quadric_coordinates_and_derivatives)
{
    struct sr_rng rng = sr_rng_seed(3, 1);
    for (int i = 0; i < 2000; ++i) {
        double u = 0.05 + 0.9 * (double)uniform(&rng), v = 0.05 + 0.9 * (double)uniform(&rng);
        struct sr_transform t = somewhere(&rng, 1);
        struct sr_shape s = quadric(1 + i % 3, t);
        struct sr_point x[5];
        const double h = 1e-3, step[5][2] = {{0, 0}, {h, 0}, {-h, 0}, {0, h}, {0, -h}};
        for (int j = 0; j < 5; ++j) {
            double a = u + step[j][0], b = v + step[j][1], p[3], n[3];
            if (i % 3 == 0) {
                double lo = acos((double)(-0.7f / 1.3f)), hi = acos((double)(1.1f / 1.3f)), theta = lo + b * (hi - lo),
                       phi = a * 210 * pi / 180;
                n[0] = sin(theta) * cos(phi), n[1] = sin(theta) * sin(phi), n[2] = cos(theta);
                for (int m = 0; m < 3; ++m)
                    p[m] = 1.3 * n[m];
            } else if (i % 3 == 1) {
                double rho = 1.2 - b * 0.9, phi = a * 320 * pi / 180;
                p[0] = rho * cos(phi), p[1] = rho * sin(phi), p[2] = 0.4;
                n[0] = n[1] = 0, n[2] = 1;
            } else {
                double phi = a * 300 * pi / 180;
                p[0] = 0.8 * cos(phi), p[1] = 0.8 * sin(phi), p[2] = -0.4 + b * 1.4;
                n[0] = cos(phi), n[1] = sin(phi), n[2] = 0;
            }
            sr_vec3 outer = {(float)(p[0] + 0.1 * n[0]), (float)(p[1] + 0.1 * n[1]), (float)(p[2] + 0.1 * n[2])};
            sr_vec3 o = sr_transform_point(&t, outer),
                    d = sr_transform_vector(&t, (sr_vec3){(float)-n[0], (float)-n[1], (float)-n[2]});
            float at;
            sr_vec2 hit;
            EXPECT(s.model->intersect(s.self, 0, o, d, 0, 1, &at, &hit)); // t counts in lengths of d
            s.model->point(s.self, 0, hit, &x[j]);
            EXPECT_NEAR(at, 0.1, 1e-5);
            EXPECT_NEAR(x[j].uv.x, a, 2e-6);
            EXPECT_NEAR(x[j].uv.y, b, 2e-6);
            EXPECT(sr_dot(x[j].n, d) < 0); // outside, under a mirror also
        }
        sr_vec3 du = sr_scale((float)(0.5 / h), sr_sub(x[1].p, x[2].p)),
                dv = sr_scale((float)(0.5 / h), sr_sub(x[3].p, x[4].p));
        sr_vec3 nu = sr_scale((float)(0.5 / h), sr_sub(x[1].n, x[2].n)),
                nv = sr_scale((float)(0.5 / h), sr_sub(x[3].n, x[4].n));
        EXPECT(sr_length(sr_sub(du, x[0].dpdu)) < 5e-3f);
        EXPECT(sr_length(sr_sub(dv, x[0].dpdv)) < 5e-3f);
        EXPECT(sr_length(sr_sub(nu, x[0].dndu)) < 1e-2f);
        EXPECT(sr_length(sr_sub(nv, x[0].dndv)) < 1e-2f);
    }
}

/* A planet, touched at its pole from a metre above: no digits are lost to its radius. */
TEST(planet_is_touched_to_a_micrometre_at_its_pole)
{
    const float R = 6371000;
    struct sr_shape s = make_sphere(R, placed(sr_transform_translate((sr_vec3){0, 0, -R})));
    float t;
    sr_vec2 hit;
    EXPECT(cast(s, (sr_vec3){0.1f, -0.2f, 1}, (sr_vec3){0, 0, -1}, &t, &hit));
    EXPECT_NEAR(t, 1, 1e-6);
    struct sr_point x;
    s.model->point(s.self, 0, hit, &x);
    EXPECT_NEAR(x.p.x, 0.1f, 1e-7);
    EXPECT_NEAR(x.p.y, -0.2f, 1e-7);
    EXPECT_NEAR(x.p.z, 0, 1e-7);
}

/* GARP against subdivision: the patch as 2 * 64 * 64 triangles, met by brute force. */
TEST(patch_is_met_where_its_triangles_are)
{
    sr_vec3 q[4] = {{0, 0, 0}, {1, 0, 0.5f}, {0, 1.2f, 0.4f}, {1.1f, 1, -0.6f}};
    struct sr_shape s = make_patch(q[0], q[1], q[2], q[3], here());
    struct sr_rng rng = sr_rng_seed(4, 1);
    enum { n = 64 };
    int hits = 0;
    for (int i = 0; i < 60; ++i) {
        sr_vec3 o = sr_add((sr_vec3){0.5f, 0.5f, 0}, sr_scale(2, random_direction(&rng)));
        sr_vec3 d = sr_normalize(sr_sub((sr_vec3){uniform(&rng), uniform(&rng), 0.2f * uniform(&rng)}, o));
        float nearest = INFINITY, t;
        sr_vec2 hit;
        for (int j = 0; j < n * n * 2; ++j) {
            float u = (float)(j / 2 % n) / n, v = (float)(j / 2 / n) / n, w = 1.0f / n;
            float c[3][2] = {{u, v}, {j % 2 ? u + w : u, j % 2 ? v : v + w}, {u + w, v + w}};
            sr_vec3 p[3];
            for (int k = 0; k < 3; ++k) {
                float a = c[k][0], b = c[k][1];
                p[k] = sr_add(sr_add(sr_scale((1 - a) * (1 - b), q[0]), sr_scale(a * (1 - b), q[1])),
                              sr_add(sr_scale((1 - a) * b, q[2]), sr_scale(a * b, q[3])));
            }
            struct sr_shape_mesh m = {.P = {p, 3}};
            if (cast((struct sr_shape){&sr_shape_trianglemesh, &m}, o, d, &t, &hit) && t < nearest)
                nearest = t;
        }
        bool is_met = cast(s, o, d, &t, &hit);
        if (is_met && isfinite(nearest)) {
            ++hits;
            if (fabsf(t - nearest) > 0.02f) // grazing: the facets may miss by their sagitta
                test_fail(__FILE__, __LINE__, "ray %d: %g, by facets %g", i, (double)t, (double)nearest);
            struct sr_point x;
            s.model->point(s.self, 0, hit, &x);
            EXPECT(sr_length(sr_sub(x.p, sr_mad(o, t, d))) < 2e-6f);
        }
    }
    EXPECT(hits > 30);
}

/* Points of a patch by (u, v), derivatives by differences, with and without uv. */
TEST(patch_derivatives)
{
    sr_vec3 P[4] = {{0, 0, 0}, {1, 0, 0.5f}, {0, 1.2f, 0.4f}, {1.1f, 1, -0.6f}};
    sr_vec2 uv[4] = {{1, 0.2f}, {3, 0}, {0.8f, 1}, {3.3f, 1.4f}};
    sr_vec3 N[4] = {{0, 0, 1}, {0.1f, 0.2f, 1}, {-0.2f, 0, 1}, {0.3f, 0, 1}};
    for (int k = 0; k < 4; ++k) {
        struct sr_shape_patches m = {.P = SLICE(P)};
        if (k & 1)
            m.uv = SLICE(uv);
        if (k & 2)
            m.N = SLICE(N);
        struct sr_shape s = PREPARE(sr_shape_bilinearmesh, &m, here());
        struct sr_point x[5];
        const float h = 4e-3f, step[5][2] = {{0, 0}, {h, 0}, {-h, 0}, {0, h}, {0, -h}};
        for (int j = 0; j < 5; ++j)
            s.model->point(s.self, 0, (sr_vec2){0.3f + step[j][0], 0.6f + step[j][1]}, &x[j]);
        for (int j = 1; j < 5; ++j) { // first order: x(j) = x(0) + d/du du + d/dv dv
            float du = x[j].uv.x - x[0].uv.x, dv = x[j].uv.y - x[0].uv.y;
            sr_vec3 p = sr_mad(sr_mad(x[0].p, du, x[0].dpdu), dv, x[0].dpdv),
                    n = sr_mad(sr_mad(x[0].ns, du, x[0].dndu), dv, x[0].dndv);
            EXPECT(sr_length(sr_sub(p, x[j].p)) < 3e-5f);
            EXPECT(sr_length(sr_sub(n, x[j].ns)) < 1e-4f);
        }
        EXPECT(sr_dot(x[0].n, x[0].ns) > 0);
    }
}

TEST(triangle_point_has_uv_frame_normals_and_face)
{
    sr_vec3 P[4] = {{0, 0, 0}, {2, 0, 1}, {0, 3, 0.5f}, {9, 9, 9}};
    sr_vec2 uv[4] = {{0.1f, 0.2f}, {1.5f, 0.1f}, {0.4f, 2}, {0, 0}};
    sr_vec3 N[4] = {{0.1f, 0, 1}, {0.3f, 0.2f, 1}, {-0.2f, 0.4f, 1}, {0, 0, 1}},
            S[4] = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
    int32_t indices[6] = {3, 1, 2, 0, 1, 2}, faces[2] = {7, 11};
    for (int k = 0; k < 8; ++k) {
        struct sr_shape_mesh m = {.indices = SLICE(indices), .P = SLICE(P), .face_indices = SLICE(faces)};
        if (k & 1)
            m.uv = SLICE(uv);
        if (k & 2)
            m.N = SLICE(N);
        if (k & 4)
            m.S = SLICE(S);
        struct sr_shape s = PREPARE(sr_shape_trianglemesh, &m, here());
        struct sr_rng rng = sr_rng_seed(5, (uint64_t)k);
        for (int i = 0; i < 300; ++i) {
            float a = sqrtf(uniform(&rng)), b = uniform(&rng);
            sr_vec2 hit = {a * (1 - b), a * b}, near = {hit.x + 1e-2f, hit.y - 7e-3f};
            struct sr_point x, y;
            s.model->point(s.self, 1, hit, &x);
            s.model->point(s.self, 1, near, &y);
            double exact[3], p[3] = {(double)x.p.x, (double)x.p.y, (double)x.p.z},
                             e[3] = {(double)x.p_error.x, (double)x.p_error.y, (double)x.p_error.z};
            double b1 = (double)hit.x, b2 = (double)hit.y, b0 = 1 - b1 - b2;
            exact[0] = b0 * (double)P[0].x + b1 * (double)P[1].x + b2 * (double)P[2].x;
            exact[1] = b0 * (double)P[0].y + b1 * (double)P[1].y + b2 * (double)P[2].y;
            exact[2] = b0 * (double)P[0].z + b1 * (double)P[1].z + b2 * (double)P[2].z;
            for (int j = 0; j < 3; ++j)
                EXPECT(fabs(p[j] - exact[j]) <= e[j]);
            EXPECT_EQUAL_INT(x.face, 11);
            sr_vec2 w = s.model->uv(s.self, 1, hit);
            EXPECT(fabsf(w.x - x.uv.x) < 1e-6f && fabsf(w.y - x.uv.y) < 1e-6f);
            float du = y.uv.x - x.uv.x, dv = y.uv.y - x.uv.y;
            EXPECT(sr_length(sr_sub(sr_mad(sr_mad(x.p, du, x.dpdu), dv, x.dpdv), y.p)) < 1e-5f);
            EXPECT(sr_length(sr_sub(sr_mad(sr_mad(x.ns, du, x.dndu), dv, x.dndv), y.ns)) < 1e-4f);
            EXPECT(sr_dot(x.n, x.ns) > 0);
            sr_vec3 tangent = k & 4 ? (sr_vec3){0, 1, 0} : x.dpdu;
            EXPECT(sr_length(sr_sub(x.dpdus, tangent)) < 1e-6f);
        }
    }
}

/* The side of n: winding, mirror, reversal; with N, the side of N, reversed with reversal. As in pbrt. */
TEST(orientation_follows_winding_mirror_reversal_and_shading_normals)
{
    sr_vec3 P[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, Nup[4], Ndown[4];
    for (int i = 0; i < 4; ++i) {
        Nup[i] = (sr_vec3){0, 0, 2};
        Ndown[i] = (sr_vec3){0, 0, -2};
    }
    for (int k = 0; k < 24; ++k) {
        bool is_mirrored = k & 1, is_reversed = k & 2, is_patch = k & 4;
        int shading = k / 8; // none, up, down
        struct sr_shape_placement place = {sr_transform_scale((sr_vec3){is_mirrored ? -1.0f : 1.0f, 1, 1}),
                                           is_reversed};
        struct sr_slice N = {shading == 1 ? Nup : Ndown, shading ? (is_patch ? 4u : 3u) : 0};
        struct sr_shape_mesh triangle = {.P = {P, 3}, .N = N};
        struct sr_shape_patches patch = {.P = {P, 4}, .N = N};
        struct sr_shape s =
            is_patch ? PREPARE(sr_shape_bilinearmesh, &patch, place) : PREPARE(sr_shape_trianglemesh, &triangle, place);
        // a mirror in x turns the winding in the world, and flip_normals turns it back: only reversal is left
        float expected = (shading == 2 ? -1.0f : 1.0f) * (is_reversed ? -1.0f : 1.0f);
        struct sr_point x;
        s.model->point(s.self, 0, (sr_vec2){0.3f, 0.3f}, &x);
        EXPECT_NEAR(x.n.z, expected, 1e-6);
        EXPECT_NEAR(x.ns.z, expected, 1e-6);
        struct sr_shape_sample y;
        EXPECT(s.model->sample(s.self, 0, NULL, (sr_vec2){0.2f, 0.2f}, &y));
        EXPECT_NEAR(y.n.z, expected, 1e-6);
        sr_vec3 axis;
        float cos_theta;
        s.model->normals(s.self, 0, &axis, &cos_theta);
        EXPECT_NEAR(axis.z, expected, 1e-6);
        EXPECT_NEAR(cos_theta, 1, 1e-6);
    }
    for (int k = 0; k < 4; ++k) { // quadrics: away from the centre, from the axis, +z
        struct sr_shape_placement place = {sr_transform_scale((sr_vec3){1, k & 1 ? -2.0f : 2.0f, 1}), k & 2};
        struct sr_shape s[3] = {make_sphere(1, place), make_cylinder(1, -1, 1, 360, place),
                                make_disk(0, 1, 0, 360, place)};
        for (int i = 0; i < 3; ++i) {
            struct sr_shape_sample y;
            EXPECT(s[i].model->sample(s[i].self, 0, NULL, (sr_vec2){0.2f, 0.3f}, &y));
            float side = i < 2 ? sr_dot(y.n, (sr_vec3){y.p.x, y.p.y, 0}) : y.n.z;
            EXPECT((side > 0) == !(k & 2));
        }
    }
}

/* Areas [m^2]: spheroids by their closed forms, an ellipsoid by Knud Thomsen's bound of 1.1 %, and a sheared disk. */
TEST(areas)
{
    struct sr_shape s = make_sphere(1, placed(sr_transform_scale((sr_vec3){1, 1, 2}))); // prolate
    double e = sqrt(1 - 0.25);
    EXPECT_RELATIVE(s.model->area(s.self, 0), 2 * pi * (1 + 2 / e * asin(e)), 1e-6);
    s = make_sphere(2, placed(sr_transform_scale((sr_vec3){1, 1, 0.05f}))); // oblate, flat
    double c = 0.05, flat = sqrt(1 - c * c);
    EXPECT_RELATIVE(s.model->area(s.self, 0), 4 * 2 * pi * (1 + c * c / flat * atanh(flat)), 1e-5);
    s = make_sphere(3, placed(sr_transform_rotate(20, (sr_vec3){1, 1, 1})));
    EXPECT_RELATIVE(s.model->area(s.self, 0), 36 * pi, 1e-6);
    s = make_partial_sphere(2, 0, 1, 90, here());
    EXPECT_RELATIVE(s.model->area(s.self, 0), pi / 2 * 2, 1e-6);
    s = make_disk(0, 2, 1, 180, placed(sr_transform_scale((sr_vec3){3, 1, 5})));
    EXPECT_RELATIVE(s.model->area(s.self, 0), 3 * pi / 2 * 3, 1e-6);
    s = make_cylinder(1, 0, 1, 360, placed(sr_transform_scale((sr_vec3){2, 1, 1}))); // the ellipse's circumference
    EXPECT_RELATIVE(s.model->area(s.self, 0), 9.688448220547674, 1e-6);
    s = make_triangle((sr_vec3){0, 0, 0}, (sr_vec3){3e-6f, 0, 0}, (sr_vec3){0, 4e-6f, 0}, here());
    EXPECT_RELATIVE(s.model->area(s.self, 0), 6e-12, 1e-6);
    s = make_triangle((sr_vec3){0, 0, 0}, (sr_vec3){3e6f, 0, 0}, (sr_vec3){0, 0, 4e6f}, here());
    EXPECT_RELATIVE(s.model->area(s.self, 0), 6e12, 1e-6);
    // the saddle z = u v over the unit square: INTEGRAL sqrt(1 + u^2 + v^2) = 1.2807897...
    s = make_patch((sr_vec3){0, 0, 0}, (sr_vec3){1, 0, 0}, (sr_vec3){0, 1, 0}, (sr_vec3){1, 1, 1}, here());
    double saddle = 0;
    for (int i = 0; i < 1000; ++i) {
        for (int j = 0; j < 1000; ++j)
            saddle += 1e-6 * sqrt(1 + pow((i + 0.5) / 1000, 2) + pow((j + 0.5) / 1000, 2));
    }
    EXPECT_RELATIVE(s.model->area(s.self, 0), saddle, 1e-6);
}

/* The normals of a patch stay in the cone that is told. */
TEST(cone_of_normals_holds_all_normals)
{
    struct sr_rng rng = sr_rng_seed(6, 1);
    int narrow = 0;
    for (int i = 0; i < 300; ++i) {
        sr_vec3 q[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
        for (int k = 0; k < 4; ++k)
            q[k] = sr_mad(q[k], 0.6f, random_direction(&rng));
        struct sr_shape s = make_patch(q[0], q[1], q[2], q[3], here());
        sr_vec3 axis;
        float cos_theta;
        s.model->normals(s.self, 0, &axis, &cos_theta);
        narrow += cos_theta > 0;
        for (int j = 0; j < 200; ++j) {
            struct sr_point x;
            s.model->point(s.self, 0, (sr_vec2){uniform(&rng), uniform(&rng)}, &x);
            EXPECT(sr_dot(x.n, axis) >= cos_theta - 1e-4f);
        }
    }
    EXPECT(narrow > 50);
}

/* Partial quadrics: a ray passes through what is cut away and meets the far side. */
TEST(partial_quadrics_let_rays_through_their_openings)
{
    float t;
    sr_vec2 hit;
    struct sr_shape bowl = make_partial_sphere(1, -1, 0, 360, here());
    EXPECT(cast(bowl, (sr_vec3){0.1f, 0, 3}, (sr_vec3){0, 0, -1}, &t, &hit));
    EXPECT_NEAR(t, 3 + sqrt(1 - 0.01), 1e-6);
    struct sr_shape wedge = make_cylinder(1, -1, 1, 90, here()); // x > 0, y > 0
    EXPECT(!cast(wedge, (sr_vec3){-3, -0.5f, 0}, (sr_vec3){1, 0, 0}, &t, &hit));
    EXPECT(cast(wedge, (sr_vec3){-3, 0.6f, 0}, (sr_vec3){1, 0, 0}, &t, &hit));
    EXPECT_NEAR(t, 3.8, 1e-6);
    EXPECT(!cast(wedge, (sr_vec3){-3, 0.6f, 1.5f}, (sr_vec3){1, 0, 0}, &t, &hit));
    struct sr_shape ring = make_disk(1, 2, 1, 360, here());
    EXPECT(!cast(ring, (sr_vec3){0.5f, 0, 0}, (sr_vec3){0, 0, 1}, &t, &hit));
    EXPECT(cast(ring, (sr_vec3){1.5f, 0, 0}, (sr_vec3){0, 0, 1}, &t, &hit));
    EXPECT(!cast(ring, (sr_vec3){1.5f, 0, 0}, (sr_vec3){1, 0, 0}, &t, &hit));
    // t_min and t_max exclude
    struct sr_shape s = make_sphere(1, here());
    EXPECT(s.model->intersect(s.self, 0, (sr_vec3){0, 0, 3}, (sr_vec3){0, 0, -1}, 2.5f, 10, &t, &hit));
    EXPECT_NEAR(t, 4, 1e-6);
    EXPECT(!s.model->intersect(s.self, 0, (sr_vec3){0, 0, 3}, (sr_vec3){0, 0, -1}, 0, 1.9f, &t, &hit));
}

/* A ray that leaves a convex quadric outward never meets it again, one that goes inward meets the far side. */
TEST(rays_that_leave_do_not_come_back)
{
    struct sr_rng rng = sr_rng_seed(7, 1);
    for (int i = 0; i < 20000; ++i) {
        struct sr_shape s = quadric(i % 2 ? 0 : 4, somewhere(&rng, i % 4 < 2 ? 2 : 1e4f));
        struct sr_shape_sample y;
        EXPECT(s.model->sample(s.self, 0, NULL, (sr_vec2){uniform(&rng), uniform(&rng)}, &y));
        struct sr_point x = {.p = y.p, .p_error = y.p_error, .n = y.n, .ns = y.n};
        sr_vec3 w = random_direction(&rng);
        bool is_outward = sr_dot(w, y.n) > 0;
        float t;
        sr_vec2 hit;
        bool is_met = cast(s, sr_point_offset(&x, w), w, &t, &hit);
        EXPECT(!(is_outward && is_met));
        EXPECT(i % 2 == 0 || is_outward || is_met || fabsf(sr_dot(w, y.n)) < 1e-3f + 1e-4f * sr_length(x.p));
    }
}

static sr_status try_mesh(struct sr_shape_mesh m, const char *word)
{
    struct sr_error error = {0};
    struct sr_shape_placement p = here();
    sr_status status = sr_shape_trianglemesh.prepare(&m, &p, &test_arena, &error);
    if (status != SR_OK && !strstr(error.text, word))
        test_fail(__FILE__, __LINE__, "\"%s\" does not say %s", error.text, word);
    return status;
}

TEST(wrong_meshes_are_refused_with_what_was_expected)
{
    sr_vec3 P[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    int32_t good[3] = {0, 1, 2}, high[3] = {0, 1, 3}, low[3] = {0, -1, 2}, four[4] = {0, 1, 2, 0};
    EXPECT(try_mesh((struct sr_shape_mesh){.indices = SLICE(good), .P = SLICE(P)}, "") == SR_OK);
    EXPECT(try_mesh((struct sr_shape_mesh){.P = SLICE(P)}, "") == SR_OK);
    EXPECT(try_mesh((struct sr_shape_mesh){.indices = SLICE(high), .P = SLICE(P)}, "expected 0 to 2") ==
           SR_ERROR_INPUT);
    EXPECT(try_mesh((struct sr_shape_mesh){.indices = SLICE(low), .P = SLICE(P)}, "index -1") == SR_ERROR_INPUT);
    EXPECT(try_mesh((struct sr_shape_mesh){.indices = SLICE(four), .P = SLICE(P)}, "multiple of 3") == SR_ERROR_INPUT);
    EXPECT(try_mesh((struct sr_shape_mesh){.indices = SLICE(good)}, "\"P\"") == SR_ERROR_INPUT);
    EXPECT(try_mesh((struct sr_shape_mesh){.indices = SLICE(good), .P = SLICE(P), .N = {P, 2}}, "expected 3") ==
           SR_ERROR_INPUT);
    struct sr_shape_sphere s = {.radius = -1, .z_min = NAN, .z_max = NAN, .phi_max = 360};
    struct sr_error error = {0};
    struct sr_shape_placement p = here();
    EXPECT(sr_shape_sphere.prepare(&s, &p, &test_arena, &error) == SR_ERROR_INPUT);
}

TEST(triangles_with_numbers_that_are_not_finite_are_left_out)
{
    sr_vec3 P[5] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}, {1, 1, 0}};
    sr_vec2 uv[5] = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {0, INFINITY}};
    int32_t indices[12] = {0, 3, 2, 0, 1, 2, 1, 4, 2, 2, 1, 0}, faces[4] = {5, 6, 7, 8};
    struct sr_shape_mesh m = {.indices = SLICE(indices), .P = SLICE(P), .uv = SLICE(uv), .face_indices = SLICE(faces)};
    struct sr_error error = {0};
    struct sr_shape_placement p = here();
    EXPECT_EQUAL_INT(sr_shape_trianglemesh.prepare(&m, &p, &test_arena, &error), SR_OK);
    EXPECT_EQUAL_INT(m.left_out, 2);
    EXPECT_EQUAL_INT(m.indices.count, 6);
    EXPECT(memcmp(m.indices.data, (int32_t[]){0, 1, 2, 2, 1, 0}, 24) == 0);
    EXPECT(m.face_indices.count == 2 && memcmp(m.face_indices.data, (int32_t[]){6, 8}, 8) == 0);
    for (int i = 0; i < 5; ++i)
        EXPECT(sr_is_finite(((const sr_vec3 *)m.P.data)[i]));
}

/* Parallelograms become triangles of the same points, uv and normals; others stay. */
TEST(planar_quads_split_into_the_same_surface)
{
    sr_vec3 P[8] = {{0, 0, 0}, {2, 0, 1}, {0.5f, 1, 0}, {2.5f, 1, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}};
    int32_t indices[8] = {4, 5, 6, 7, 0, 1, 2, 3}, faces[2] = {5, 6};
    struct sr_shape_patches all = {.indices = SLICE(indices), .P = SLICE(P), .face_indices = SLICE(faces)}, rest;
    struct sr_shape_mesh triangles;
    EXPECT_EQUAL_INT(sr_shape_split_planar_quads(&all, &test_arena, &triangles, &rest), 1);
    EXPECT_EQUAL_INT(triangles.indices.count, 6);
    EXPECT_EQUAL_INT(rest.indices.count, 4);
    struct sr_shape t = PREPARE(sr_shape_trianglemesh, &triangles, here()),
                    r = PREPARE(sr_shape_bilinearmesh, &rest, here());
    struct sr_shape a = PREPARE(sr_shape_bilinearmesh, &all, here());
    EXPECT_EQUAL_INT(r.model->primitive_count(r.self), 1);
    struct sr_rng rng = sr_rng_seed(8, 1);
    for (int i = 0; i < 200; ++i) {
        float u = uniform(&rng), v = uniform(&rng);
        struct sr_point x, y;
        a.model->point(a.self, 1, (sr_vec2){u, v}, &x);
        // halves (0,0) (1,0) (1,1) and (0,0) (1,1) (0,1)
        sr_vec2 hit = u >= v ? (sr_vec2){u - v, v} : (sr_vec2){u, v - u};
        t.model->point(t.self, u >= v ? 0 : 1, hit, &y);
        EXPECT(sr_length(sr_sub(x.p, y.p)) < 1e-6f && sr_length(sr_sub(x.n, y.n)) < 1e-6f && x.face == y.face);
        EXPECT(fabsf(x.uv.x - y.uv.x) < 1e-6f && fabsf(x.uv.y - y.uv.y) < 1e-6f);
        EXPECT(sr_length(sr_sub(x.dpdu, y.dpdu)) < 1e-5f && sr_length(sr_sub(x.dpdv, y.dpdv)) < 1e-5f);
    }
}

TEST(models_are_found_by_name)
{
    EXPECT(sr_shape_model_find("sphere") == &sr_shape_sphere);
    EXPECT(sr_shape_model_find("teapot") == NULL);
    for (int i = 0; sr_shape_models[i]; ++i)
        EXPECT(sr_shape_model_find(sr_shape_models[i]->name) == sr_shape_models[i]);
}
