/* SPDX-License-Identifier: MIT */
/* Sampling toward a point against closed forms: irradiances of Lambertian sources [W/m^2] and solid angles [sr]. */
#include "common.h"

static const sr_vec3 up = {0, 0, 1}, nowhere = {0, 0, 0}, origin = {0, 0, 0};

#define EXPECT_IRRADIANCE(tally, expected)                                                                             \
    do {                                                                                                               \
        struct sr_tally E_ = (tally);                                                                                  \
        EXPECT(sr_tally_standard_error(&E_) < 2e-3 * (expected));                                                      \
        EXPECT_MEAN(E_, expected);                                                                                     \
    } while (0)

static struct sr_transform move(float x, float y, float z)
{
    return sr_transform_translate((sr_vec3){x, y, z});
}

/* E = pi L R^2 / (R^2 + h^2);  off axis Foote 1915, the tilted one by the irradiance vector (Howell's catalogue) */
TEST(disk_sends_the_irradiance_of_foote)
{
    struct sr_point x = receiver(origin, up);
    EXPECT_IRRADIANCE(irradiance(make_disk(2, 1, 0, 360, here()), 0, &x, 200000, 1), 0.628318530718);
    struct sr_shape aside = make_disk(2, 1, 0, 360, placed(move(1.5f, 0, 0)));
    EXPECT_IRRADIANCE(irradiance(aside, 0, &x, 200000, 2), 0.321335102752);
    // the receiver leans by 35 deg toward the disk, which is at +x for it
    struct sr_point tilted = receiver(origin, (sr_vec3){sinf(35 * SR_PI / 180), 0, cosf(35 * SR_PI / 180)});
    EXPECT_IRRADIANCE(irradiance(aside, 0, &tilted, 200000, 3), 0.381493863441);
}

/* E = pi L (R/D)^2 cos theta (Gershun), clipped by the horizon (Naraghi 1988) */
TEST(sphere_sends_the_irradiance_of_gershun_and_naraghi)
{
    struct sr_shape s = make_sphere(1, placed(move(0, 0, 3)));
    struct sr_point x = receiver(origin, (sr_vec3){sinf(40 * SR_PI / 180), 0, cosf(40 * SR_PI / 180)});
    EXPECT_IRRADIANCE(irradiance(s, 0, &x, 200000, 4), 0.267399954981);
    s = make_sphere(1, placed(move(0, 0, 2)));
    x = receiver(origin, (sr_vec3){sinf(80 * SR_PI / 180), 0, cosf(80 * SR_PI / 180)});
    EXPECT_IRRADIANCE(irradiance(s, 0, &x, 600000, 5), 0.171831975127);
    x = receiver(origin, (sr_vec3){1, 0, 0});
    EXPECT_IRRADIANCE(irradiance(s, 0, &x, 600000, 6), 0.0905860737061);
}

/* The same sphere, drawn by area as ellipsoids are: a nearly rigid transform, and one made of a scaled unit sphere. */
TEST(sphere_by_area_sends_the_same_irradiance)
{
    struct sr_point x = receiver(origin, (sr_vec3){sinf(40 * SR_PI / 180), 0, cosf(40 * SR_PI / 180)});
    struct sr_shape s = make_sphere(1, placed(then(move(0, 0, 3), sr_transform_scale((sr_vec3){1, 1, 1.0001f}))));
    EXPECT(!((const struct sr_shape_sphere *)s.self)->is_rigid);
    struct sr_tally E = irradiance(s, 0, &x, 1500000, 7);
    EXPECT(sr_tally_standard_error(&E) < 2e-3 * E.mean);
    EXPECT(fabs(E.mean / 0.267399954981 - 1) < 4.9 * sr_tally_standard_error(&E) / E.mean + 1e-4);
}

/* From within, all directions are met: E on any side is pi. */
TEST(sphere_from_within_fills_a_hemisphere)
{
    struct sr_shape s = make_sphere(2, here());
    struct sr_point x = receiver((sr_vec3){0.7f, -0.3f, 0.4f}, up);
    struct sr_tally E = {0};
    struct sr_rng rng = sr_rng_seed(8, 1);
    for (int i = 0; i < 2000000; ++i) {
        struct sr_shape_sample y;
        sr_vec2 u = {uniform(&rng), uniform(&rng)};
        EXPECT(s.model->sample(s.self, 0, &x, u, &y));
        sr_tally_add(&E, fmax(0, (double)sr_dot(sr_normalize(sr_sub(y.p, x.p)), up)) / (double)y.pdf);
    }
    EXPECT_IRRADIANCE(E, 3.14159265358979);
}

/* Howell/Hamilton-Morgan: a rectangle over its corner; a square over its middle; as one patch and as two triangles */
TEST(rectangle_sends_the_irradiance_of_the_catalogue_as_patch_and_as_triangles)
{
    struct sr_point x = receiver(origin, up);
    sr_vec3 q[4] = {{0, 0, 1}, {2, 0, 1}, {0, 1, 1}, {2, 1, 1}};
    EXPECT_IRRADIANCE(irradiance(make_patch(q[0], q[1], q[2], q[3], here()), 0, &x, 200000, 9), 0.525824101542);
    struct sr_tally a = irradiance(make_triangle(q[0], q[1], q[3], here()), 0, &x, 200000, 10);
    struct sr_tally b = irradiance(make_triangle(q[0], q[3], q[2], here()), 0, &x, 200000, 11);
    double error = hypot(sr_tally_standard_error(&a), sr_tally_standard_error(&b));
    EXPECT(error < 2e-3 * 0.5258);
    EXPECT_NEAR(a.mean + b.mean, 0.525824101542, 4.9 * error + 1e-6);
    sr_vec3 s[4] = {{-.5f, -.5f, 1}, {.5f, -.5f, 1}, {-.5f, .5f, 1}, {.5f, .5f, 1}};
    EXPECT_IRRADIANCE(irradiance(make_patch(s[0], s[1], s[2], s[3], here()), 0, &x, 200000, 12), 0.752274688454);
    // a parallelogram that is no rectangle goes by area: two halves of the square, sheared, are the square again
    struct sr_tally l =
        irradiance(make_patch(s[0], s[1], (sr_vec3){.5f, .5f, 1}, (sr_vec3){1.5f, .5f, 1}, here()), 0, &x, 400000, 13);
    struct sr_tally t0 = irradiance(make_triangle(s[0], s[1], s[3], here()), 0, &x, 200000, 14);
    struct sr_tally t1 = irradiance(make_triangle(s[1], (sr_vec3){1.5f, .5f, 1}, s[3], here()), 0, &x, 200000, 15);
    error = hypot(sr_tally_standard_error(&l), hypot(sr_tally_standard_error(&t0), sr_tally_standard_error(&t1)));
    EXPECT_NEAR(l.mean, t0.mean + t1.mean, 4.9 * error + 1e-6);
}

/* A patch with uneven sides lies in the plane z = 1 and is the union of two triangles. */
TEST(general_patch_sends_what_its_two_triangles_send)
{
    struct sr_point x = receiver(origin, sr_normalize((sr_vec3){0.1f, 0.2f, 1}));
    sr_vec3 q[4] = {{-1, -1, 1}, {1, -0.5f, 1}, {-0.6f, 1, 1}, {0.5f, 0.4f, 1}};
    struct sr_tally p = irradiance(make_patch(q[0], q[1], q[2], q[3], here()), 0, &x, 600000, 16);
    struct sr_tally a = irradiance(make_triangle(q[0], q[1], q[3], here()), 0, &x, 200000, 17);
    struct sr_tally b = irradiance(make_triangle(q[0], q[3], q[2], here()), 0, &x, 200000, 18);
    double error = hypot(sr_tally_standard_error(&p), hypot(sr_tally_standard_error(&a), sr_tally_standard_error(&b)));
    EXPECT(error < 2e-3 * p.mean);
    EXPECT_NEAR(p.mean, a.mean + b.mean, 4.9 * error + 1e-6);
}

/* E = (L/2) SUM Theta_i Gamma_i . n (Lambert 1760) */
static const sr_vec3 polygon[3] = {{1, 0, 1}, {-1, 2, 1.5f}, {-1, -1, 2}};
TEST(triangle_sends_the_irradiance_of_lambert)
{
    struct sr_point x = receiver(origin, up);
    EXPECT_IRRADIANCE(irradiance(make_triangle(polygon[0], polygon[1], polygon[2], here()), 0, &x, 200000, 19),
                      0.875254739837);
}

/* Van Oosterom & Strackee 1983; 4 asin(a b / sqrt((a^2 + h^2)(b^2 + h^2))); 2 pi (1 - cos). With and without a normal.
 */
TEST(mean_of_1_over_pdf_is_the_solid_angle)
{
    struct sr_shape t = make_triangle(polygon[0], polygon[1], polygon[2], here());
    struct sr_shape r =
        make_patch((sr_vec3){-1, -.5f, 1}, (sr_vec3){1, -.5f, 1}, (sr_vec3){-1, .5f, 1}, (sr_vec3){1, .5f, 1}, here());
    struct sr_shape s = make_sphere(1, placed(move(0, 0, 3))), d = make_disk(2, 1, 0, 360, here());
    for (int k = 0; k < 2; ++k) {
        struct sr_point x = receiver(origin, k ? up : nowhere);
        struct sr_tally a = solid_angle(t, 0, &x, 100000, 20), b = solid_angle(r, 0, &x, 100000, 21),
                        c = solid_angle(d, 0, &x, 100000, 22);
        if (k) {
            EXPECT_MEAN(a, 0.972893793949);
            EXPECT_MEAN(b, 1.28700221759);
        } else { // uniform: every draw says the same
            EXPECT_RELATIVE(a.mean, 0.972893793949, 1e-5);
            EXPECT_RELATIVE(b.mean, 1.28700221759, 1e-5);
            EXPECT(sr_tally_standard_error(&a) < 1e-8);
        }
        EXPECT_MEAN(c, 2 * 3.14159265358979 * (1 - 2 / sqrt(5)));
        struct sr_tally e = solid_angle(s, 0, &x, 1000, 23);
        EXPECT_RELATIVE(e.mean, 2 * 3.14159265358979 * (1 - sqrt(1 - 1.0 / 9)), 1e-6);
    }
}

/* Far away, Omega -> pi (R/D)^2: 1 - cos must not cancel. */
TEST(sphere_far_away_keeps_its_solid_angle)
{
    for (int k = 1; k <= 6; ++k) {
        float D = powf(10, (float)k);
        struct sr_shape s = make_sphere(1, placed(move(0, D, 0)));
        struct sr_point x = receiver(origin, nowhere);
        double sin2 = 1 / ((double)D * (double)D), exact = 2 * 3.14159265358979 * sin2 / (1 + sqrt(1 - sin2));
        EXPECT_RELATIVE(solid_angle(s, 0, &x, 200, 24).mean, exact, 1e-6);
        EXPECT(pdf_deviation(s, 0, &x, 200, 25) < 1e-6);
    }
}

/* The near half and nothing else; at the same distance from the axis, uniform in 1 - cos. */
TEST(sphere_cone_is_uniform_and_on_the_near_side)
{
    struct sr_shape s = make_sphere(2, placed(then(move(1, -2, 3), sr_transform_rotate(33, (sr_vec3){1, 1, 0}))));
    struct sr_point x = receiver((sr_vec3){0, 0.5f, 0.2f}, nowhere);
    sr_vec3 axis = sr_sub((sr_vec3){1, -2, 3}, x.p);
    double sin2 = 4 / (double)sr_length2(axis), whole = 1 - sqrt(1 - sin2), seen[100] = {0}, expected[100];
    struct sr_frame f = sr_frame_from_z(sr_normalize(axis));
    struct sr_rng rng = sr_rng_seed(26, 1);
    enum { draws = 100000 };
    for (int i = 0; i < draws; ++i) {
        struct sr_shape_sample y;
        EXPECT(s.model->sample(s.self, 0, &x, (sr_vec2){uniform(&rng), uniform(&rng)}, &y));
        sr_vec3 w = sr_sub(y.p, x.p), l = sr_to_local(&f, sr_normalize(w));
        EXPECT(sr_dot(w, y.n) < 1e-3f);
        int a = (int)((1 - (double)l.z) / whole * 10),
            b = (int)((atan2((double)l.y, (double)l.x) / 6.283185308 + 0.5) * 10);
        seen[(a > 9 ? 9 : a) * 10 + (b > 9 ? 9 : b)] += 1;
    }
    for (int i = 0; i < 100; ++i)
        expected[i] = draws / 100.0;
    EXPECT_CHI2(seen, expected, 100);
}

/* Every shape, many places and scales. */
static struct sr_shape zoo(int k, struct sr_transform t)
{
    struct sr_shape_placement p = placed(t);
    switch (k) {
    case 0:
        return make_triangle((sr_vec3){0, 0, 0}, (sr_vec3){1, 0, 0.2f}, (sr_vec3){0.3f, 0.9f, 0}, p);
    case 1:
        return make_patch((sr_vec3){0, 0, 0}, (sr_vec3){1, 0, 0}, (sr_vec3){0, 1, 0}, (sr_vec3){1, 1, 0}, p);
    case 2:
        return make_patch((sr_vec3){0, 0, 0}, (sr_vec3){1, 0, 0}, (sr_vec3){0.4f, 1, 0}, (sr_vec3){1.4f, 1, 0}, p);
    case 3:
        return make_patch((sr_vec3){0, 0, 0}, (sr_vec3){1, 0, 0.3f}, (sr_vec3){0, 1.2f, 0.3f},
                          (sr_vec3){1.1f, 1, -0.2f}, p);
    case 4:
        return make_sphere(1, p);
    case 5:
        return make_partial_sphere(1, -0.5f, 0.8f, 250, p);
    case 6:
        return make_disk(0.2f, 1, 0, 360, p);
    case 7:
        return make_disk(0.2f, 1, 0.4f, 200, p);
    default:
        return make_cylinder(0.5f, -0.6f, 0.7f, 300, p);
    }
}
enum { zoo_count = 9 };

/* Inverting a direction to the numbers that drew it loses digits where the shape is seen almost edge on; that must be
 * rare. */
TEST(pdf_is_what_sample_said)
{
    for (int k = 0; k < zoo_count; ++k) {
        for (int scaled = 0; scaled < 2; ++scaled) {
            struct sr_transform t = then(move(0.3f, 0.2f, -0.1f), sr_transform_rotate(50, (sr_vec3){1, 2, -1}));
            if (scaled)
                t = then(t, sr_transform_scale((sr_vec3){1, 0.5f, -1.7f}));
            struct sr_shape s = zoo(k, t);
            struct sr_rng rng = sr_rng_seed(30, (uint64_t)k);
            int off[3] = {0};
            for (int i = 0; i < 3000; ++i) {
                sr_vec3 p = sr_scale(0.3f + 6 * sr_sqr(uniform(&rng)), random_direction(&rng));
                struct sr_point x = receiver(p, i % 3 ? random_direction(&rng) : nowhere);
                double deviation = pdf_deviation(s, 0, &x, 2, (uint64_t)i);
                off[0] += deviation > 1e-4;
                off[1] += deviation > 1e-3;
                off[2] += deviation > 1e-2;
            }
            if (off[0] > 6 || off[1] > 1 || off[2] > 0)
                test_fail(__FILE__, __LINE__,
                          "shape %d, scaled %d: of 3000 places, %d %d %d deviate by 1e-4, 1e-3, 1e-2", k, scaled,
                          off[0], off[1], off[2]);
        }
    }
}

/* Directions drawn uniformly from the sphere, those that meet the shape: their mean of pdf (first meeting, or all) is
 * the probability that sample draws a direction at all, which is 1. A check of pdf that does not lean on sample. */
TEST(pdf_integrates_to_1_over_the_directions_that_meet)
{
    for (int k = 0; k < zoo_count; ++k) {
        struct sr_transform t = then(move(0.3f, 0.2f, 1.4f), sr_transform_scale((sr_vec3){1, 0.8f, 1.3f}));
        if (k == 4)
            t = move(0.3f, 0.2f, 1.6f);
        struct sr_shape s = zoo(k, t);
        struct sr_point x = receiver(origin, sr_normalize((sr_vec3){0.2f, 0, 1}));
        struct sr_tally mean = {0};
        struct sr_rng rng = sr_rng_seed(31, (uint64_t)k);
        for (int i = 0; i < 200000; ++i) {
            sr_vec3 w = random_direction(&rng), o = x.p;
            double sum = 0;
            for (int j = 0; j < 4; ++j) { // through the near side to the far one
                float at;
                sr_vec2 hit;
                if (!cast(s, o, w, &at, &hit))
                    break;
                struct sr_point there;
                s.model->point(s.self, 0, hit, &there);
                sum += (double)s.model->pdf(s.self, 0, &x, w, &there);
                if (k == 4)
                    break; // the cone counts a direction once
                o = sr_point_offset(&there, w);
            }
            sr_tally_add(&mean, sum * 4 * 3.14159265358979);
        }
        if (!(fabs(mean.mean - 1) < 4.9 * sr_tally_standard_error(&mean)))
            test_fail(__FILE__, __LINE__, "shape %d: integral %g +- %g", k, mean.mean, sr_tally_standard_error(&mean));
        EXPECT(sr_tally_standard_error(&mean) < 0.03);
    }
}

TEST(sampling_by_area_is_uniform_in_the_right_measure)
{
    for (int k = 0; k < zoo_count; ++k) {
        struct sr_shape s = zoo(k, then(move(1, 2, 3), sr_transform_scale((sr_vec3){2, 0.7f, 1.1f})));
        struct sr_tally A = {0};
        struct sr_rng rng = sr_rng_seed(32, (uint64_t)k);
        for (int i = 0; i < 50000; ++i) {
            struct sr_shape_sample y;
            EXPECT(s.model->sample(s.self, 0, NULL, (sr_vec2){uniform(&rng), uniform(&rng)}, &y));
            sr_tally_add(&A, 1 / (double)y.pdf); // mean of 1 / pdf: the area
        }
        if (!(fabs(A.mean / (double)s.model->area(s.self, 0) - 1) < 4.9 * sr_tally_standard_error(&A) / A.mean + 1e-5))
            test_fail(__FILE__, __LINE__, "shape %d: area %g by samples, %g told", k, A.mean,
                      (double)s.model->area(s.self, 0));
    }
}

TEST(the_density_by_area_is_that_of_the_samples)
{
    for (int k = 0; k < zoo_count; ++k) {
        struct sr_shape s = zoo(k, then(move(1, 2, 3), sr_transform_scale((sr_vec3){2, 0.7f, 1.1f})));
        struct sr_rng rng = sr_rng_seed(34, (uint64_t)k);
        for (int i = 0; i < 2000; ++i) {
            struct sr_shape_sample y;
            EXPECT(s.model->sample(s.self, 0, NULL, (sr_vec2){uniform(&rng), uniform(&rng)}, &y));
            struct sr_point there = {.p = y.p, .n = y.n};
            float pdf = s.model->area_pdf ? s.model->area_pdf(s.self, 0, &there) : 1 / s.model->area(s.self, 0);
            if (!(fabsf(pdf / y.pdf - 1) < 2e-3f))
                test_fail(__FILE__, __LINE__, "shape %d: density %g of a sample drawn with %g", k, (double)pdf,
                          (double)y.pdf);
        }
    }
}

/* uv of samples by area, where the map from area to uv is known */
TEST(samples_fill_uv_evenly)
{
    for (int k = 0; k < 4; ++k) {
        struct sr_shape s = k == 0   ? make_partial_sphere(2, -1, 1.5f, 270, here())
                            : k == 1 ? make_cylinder(1, 0, 3, 200, here())
                            : k == 2 ? make_disk(0, 2, 0.5f, 300, here())
                                     : make_disk(0, 2, 0, 360, here());
        enum { n = 8, draws = 64000 };
        double seen[n * n] = {0}, expected[n * n];
        struct sr_rng rng = sr_rng_seed(33, (uint64_t)k);
        for (int i = 0; i < draws; ++i) {
            struct sr_shape_sample y;
            EXPECT(s.model->sample(s.self, 0, NULL, (sr_vec2){uniform(&rng), uniform(&rng)}, &y));
            double v = (double)y.uv.y;
            if (k == 0) { // v is linear in theta, area in cos theta
                double lo = acos(-0.5), hi = acos(0.75), theta = lo + v * (hi - lo);
                v = (cos(theta) + 0.5) / 1.25;
            } else if (k >= 2) { // v is linear in rho, area in rho^2
                double hole = k == 2 ? 0.5 : 0, rho = 2 - v * (2 - hole);
                v = (rho * rho - hole * hole) / (4 - hole * hole);
            }
            int a = (int)(y.uv.x * n), b = (int)(v * n);
            seen[(a < 0 ? 0 : a >= n ? n - 1 : a) * n + (b < 0 ? 0 : b >= n ? n - 1 : b)] += 1;
        }
        for (int i = 0; i < n * n; ++i)
            expected[i] = (double)draws / (n * n);
        EXPECT_CHI2(seen, expected, n * n);
    }
}

/* Omega does not change when everything grows or shrinks, nor when all moves away together. */
TEST(scale_and_place_change_no_solid_angle)
{
    for (int k = 0; k < zoo_count; ++k) {
        double at_one = 0;
        const float scales[] = {1, 1e-6f, 1e-3f, 1e3f, 1e6f};
        for (int i = 0; i < 5; ++i) {
            float a = scales[i];
            struct sr_shape s = zoo(k, sr_transform_scale((sr_vec3){a, a, a}));
            struct sr_point x = receiver(sr_scale(a, (sr_vec3){0.4f, 0.3f, 2.5f}), (sr_vec3){0, 0, -1});
            double omega = solid_angle(s, 0, &x, 4000, 40).mean;
            if (i == 0)
                at_one = omega;
            EXPECT_RELATIVE(omega, at_one, 2e-3);
            EXPECT(pdf_deviation(s, 0, &x, 300, 41) < 1e-3);
        }
    }
}

TEST(triangle_without_area_is_never_sampled)
{
    struct sr_shape s = make_triangle((sr_vec3){0, 0, 1}, (sr_vec3){1, 1, 1}, (sr_vec3){2, 2, 1}, here());
    struct sr_point x = receiver(origin, up);
    struct sr_shape_sample y;
    EXPECT(s.model->area(s.self, 0) == 0);
    EXPECT(!s.model->sample(s.self, 0, &x, (sr_vec2){0.3f, 0.4f}, &y));
    EXPECT(!s.model->sample(s.self, 0, NULL, (sr_vec2){0.3f, 0.4f}, &y));
    s = make_patch(origin, up, origin, up, here());
    EXPECT(s.model->area(s.self, 0) == 0);
    EXPECT(!s.model->sample(s.self, 0, NULL, (sr_vec2){0.3f, 0.4f}, &y));
}

/* Van Oosterom & Strackee in double, with the volume from the edges */
static double solid_angle_exactly(const sr_vec3 v[3])
{
    double a[3][3], l[3], e[3], f[3], volume = 0, dots[3] = {0};
    for (int i = 0; i < 3; ++i) {
        a[i][0] = (double)v[i].x;
        a[i][1] = (double)v[i].y;
        a[i][2] = (double)v[i].z;
        l[i] = sqrt(a[i][0] * a[i][0] + a[i][1] * a[i][1] + a[i][2] * a[i][2]);
    }
    for (int j = 0; j < 3; ++j) {
        e[j] = a[1][j] - a[0][j];
        f[j] = a[2][j] - a[0][j];
        for (int i = 0; i < 3; ++i)
            dots[i] += a[i][j] * a[(i + 1) % 3][j];
    }
    for (int i = 0; i < 3; ++i)
        volume += a[0][i] * (e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3]);
    return 2 * atan2(fabs(volume), l[0] * l[1] * l[2] + dots[0] * l[2] + dots[1] * l[0] + dots[2] * l[1]);
}

/* Many triangles of all sizes, needles among them: 1/pdf averages to the exact solid angle. */
TEST(triangles_of_all_sizes_keep_their_solid_angle)
{
    struct sr_rng rng = sr_rng_seed(50, 1);
    for (int i = 0; i < 200; ++i) {
        float size = powf(10, -3 + 4 * uniform(&rng)), thin = powf(10, -3 * uniform(&rng));
        sr_vec3 c = random_direction(&rng), e = sr_scale(size, random_direction(&rng)),
                f = sr_scale(size * thin, random_direction(&rng));
        sr_vec3 v[3] = {c, sr_add(c, e), sr_add(c, f)};
        struct sr_shape s = make_triangle(v[0], v[1], v[2], here());
        double exact = solid_angle_exactly(v);
        struct sr_point x = receiver(origin, i % 2 ? random_direction(&rng) : nowhere);
        struct sr_tally omega = solid_angle(s, 0, &x, 2000, (uint64_t)i);
        if (!(fabs(omega.mean - exact) < 6 * sr_tally_standard_error(&omega) + 1e-3 * exact))
            test_fail(__FILE__, __LINE__, "triangle %d: %g +- %g, exactly %g", i, omega.mean,
                      sr_tally_standard_error(&omega), exact);
    }
}
