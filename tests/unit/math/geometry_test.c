/* SPDX-License-Identifier: MIT */
/* Frames, transforms, boxes, offsets and the equal-area map. */
#include "test.h"

static uint32_t state = 12345;

static float uniform(float lo, float hi)
{
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return lo + (hi - lo) * ((float)(state >> 8) * 0x1p-24f);
}

static sr_vec3 direction(void)
{
    float z = uniform(-1, 1);
    return sr_normalize(sr_spherical_direction(sqrtf(1 - z * z), z, uniform(0, 2 * SR_PI)));
}

static void expect_vec(sr_vec3 a, sr_vec3 b, float tolerance)
{
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

static void expect_orthonormal(struct sr_frame f)
{
    EXPECT_NEAR(sr_length(f.x), 1, 1e-6);
    EXPECT_NEAR(sr_length(f.y), 1, 1e-6);
    EXPECT_NEAR(sr_dot(f.x, f.y), 0, 1e-6);
    EXPECT_NEAR(sr_dot(f.x, f.z), 0, 1e-6);
    EXPECT_NEAR(sr_dot(f.y, f.z), 0, 1e-6);
    expect_vec(sr_cross(f.x, f.y), f.z, 2e-6f);
}

TEST(frames_are_orthonormal_and_right_handed)
{
    for (int i = 0; i < 20000; ++i) {
        sr_vec3 z = direction();
        expect_orthonormal(sr_frame_from_z(z));
        struct sr_frame f = sr_frame_from_zx(z, direction());
        expect_orthonormal(f);
        sr_vec3 w = direction();
        expect_vec(sr_to_world(&f, sr_to_local(&f, w)), w, 1e-6f);
    }
    expect_orthonormal(sr_frame_from_z((sr_vec3){0, 0, -1}));
    expect_orthonormal(sr_frame_from_z((sr_vec3){0, 0, -0.0f + 1}));
    expect_orthonormal(sr_frame_from_z(sr_normalize((sr_vec3){1e-4f, -1e-4f, -1})));
    expect_orthonormal(sr_frame_from_zx((sr_vec3){0, 0, 1}, (sr_vec3){0, 0, 3}));
    expect_orthonormal(sr_frame_from_zx((sr_vec3){0, 0, 1}, (sr_vec3){0, 0, 0}));
    expect_orthonormal(sr_frame_from_zx((sr_vec3){0, 0, 1}, (sr_vec3){NAN, 0, 0}));
    struct sr_frame f = sr_frame_from_zx((sr_vec3){0, 0, 1}, (sr_vec3){3, 0, 7});
    expect_vec(f.x, (sr_vec3){1, 0, 0}, 1e-7f);
}

static struct sr_transform random_transform(void)
{
    struct sr_transform a = sr_transform_translate((sr_vec3){uniform(-9, 9), uniform(-9, 9), uniform(-9, 9)});
    struct sr_transform b = sr_transform_rotate(uniform(-400, 400), sr_scale(uniform(0.1f, 20), direction()));
    struct sr_transform c = sr_transform_scale((sr_vec3){uniform(0.1f, 4), uniform(-3, -0.2f), uniform(0.3f, 5)});
    struct sr_transform bc = sr_transform_multiply(&b, &c);
    return sr_transform_multiply(&a, &bc);
}

TEST(transforms_and_their_inverses_cancel)
{
    for (int i = 0; i < 2000; ++i) {
        struct sr_transform t = random_transform(), u = sr_transform_from_matrix(t.m);
        sr_vec3 p = {uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)};
        expect_vec(sr_inverse_point(&t, sr_transform_point(&t, p)), p, 3e-4f);
        expect_vec(sr_inverse_vector(&u, sr_transform_vector(&u, p)), p, 1e-4f);
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                EXPECT_NEAR(t.inverse[r][c], u.inverse[r][c], 1e-4);
        EXPECT(sr_transform_is_valid(&t));
        EXPECT(sr_transform_swaps_handedness(&t));
        // a normal stays perpendicular to its surface
        sr_vec3 n = direction(), tangent = sr_frame_from_z(n).x;
        sr_vec3 n2 = sr_transform_normal(&t, n), tangent2 = sr_transform_vector(&t, tangent);
        EXPECT_NEAR(sr_dot(n2, tangent2) / (sr_length(n2) * sr_length(tangent2)), 0, 2e-6);
    }
    struct sr_transform identity = sr_transform_identity();
    EXPECT(sr_transform_is_identity(&identity) && !sr_transform_swaps_handedness(&identity));
}

TEST(inverse_divides_by_w_and_pivots)
{
    const float projection[4][4] = {{1, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 1.001f, -0.1f}, {0, 0, 1, 0}};
    struct sr_transform t = sr_transform_from_matrix(projection);
    sr_vec3 p = {0.3f, -0.2f, 4};
    expect_vec(sr_transform_point(&t, p), (sr_vec3){0.075f, -0.1f, (1.001f * 4 - 0.1f) / 4}, 1e-6f);
    expect_vec(sr_inverse_point(&t, sr_transform_point(&t, p)), p, 1e-4f);
    const float shuffled[4][4] = {{0, 0, 2, 1}, {3, 0, 0, 2}, {0, -4, 0, 3}, {0, 0, 0, 1}};
    t = sr_transform_from_matrix(shuffled);
    EXPECT(sr_transform_is_valid(&t));
    expect_vec(sr_inverse_point(&t, (sr_vec3){5, 8, -5}), (sr_vec3){2, 2, 2}, 1e-6f);
}

TEST(singular_and_unfinished_matrices_are_refused_and_small_ones_are_not)
{
    const float singular[4][4] = {{1, 2, 3, 0}, {2, 4, 6, 0}, {0, 1, 1, 0}, {0, 0, 0, 1}};
    struct sr_transform t = sr_transform_from_matrix(singular);
    EXPECT(!sr_transform_is_valid(&t));
    t = sr_transform_translate((sr_vec3){NAN, 0, 0});
    EXPECT(!sr_transform_is_valid(&t));
    t = sr_transform_scale((sr_vec3){1, 0, 1});
    EXPECT(!sr_transform_is_valid(&t));
    t = sr_transform_look_at((sr_vec3){0, 0, 0}, (sr_vec3){0, 3, 0}, (sr_vec3){0, 1, 0});
    EXPECT(!sr_transform_is_valid(&t));
    t = sr_transform_scale((sr_vec3){1e-6f, 1e-6f, 1e-6f});
    EXPECT(sr_transform_is_valid(&t));
}

TEST(rotation_turns_counterclockwise_around_its_axis)
{
    struct sr_transform t = sr_transform_rotate(90, (sr_vec3){0, 0, 5});
    expect_vec(sr_transform_vector(&t, (sr_vec3){1, 0, 0}), (sr_vec3){0, 1, 0}, 0);
    t = sr_transform_rotate(30, (sr_vec3){1, 0, 0});
    expect_vec(sr_transform_vector(&t, (sr_vec3){0, 1, 0}), (sr_vec3){0, sqrtf(0.75f), 0.5f}, 1e-7f);
    t = sr_transform_rotate(120, (sr_vec3){1, 1, 1});
    expect_vec(sr_transform_vector(&t, (sr_vec3){1, 2, 3}), (sr_vec3){3, 1, 2}, 1e-6f);
}

TEST(look_at_puts_the_target_on_z_and_up_on_y)
{
    sr_vec3 eye = {3, 4, 1.5f}, look = {0.5f, 0.5f, 0};
    struct sr_transform t = sr_transform_look_at(eye, look, (sr_vec3){0, 0, 1});
    expect_vec(sr_transform_point(&t, eye), (sr_vec3){0, 0, 0}, 1e-6f);
    expect_vec(sr_transform_point(&t, look), (sr_vec3){0, 0, sr_length(sr_sub(look, eye))}, 1e-6f);
    sr_vec3 up = sr_transform_vector(&t, (sr_vec3){0, 0, 1});
    EXPECT_NEAR(up.x, 0, 1e-7);
    EXPECT(up.y > 0.5f);
    // looking along +z with y up, x is right: the identity
    t = sr_transform_look_at((sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 1}, (sr_vec3){0, 1, 0});
    EXPECT(sr_transform_is_identity(&t));
    // looking along -z, x points to world -x
    t = sr_transform_look_at((sr_vec3){0, 0, 0}, (sr_vec3){0, 0, -1}, (sr_vec3){0, 1, 0});
    expect_vec(sr_transform_vector(&t, (sr_vec3){1, 0, 0}), (sr_vec3){-1, 0, 0}, 0);
}

TEST(transformed_points_are_never_further_off_than_their_bound)
{
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        struct sr_transform t = random_transform();
        double p[3] = {(double)uniform(-100, 100), (double)uniform(-100, 100), (double)uniform(-100, 100)};
        float e = i % 2 ? uniform(0, 1e-3f) : 0;
        sr_vec3 rounded = {(float)(p[0] + (double)uniform(-e, e)), (float)(p[1] + (double)uniform(-e, e)),
                           (float)(p[2] + (double)uniform(-e, e))};
        sr_vec3 p_error = {e * 1.05f, e * 1.05f, e * 1.05f}, error; // and the rounding to float
        sr_vec3 q = sr_transform_point_error(&t, rounded, p_error, &error);
        for (int r = 0; r < 3; ++r) {
            if (e > 0 && e < 1e-4f)
                continue;
            double truth = (double)t.m[r][3];
            for (int c = 0; c < 3; ++c)
                truth += (double)t.m[r][c] * (e > 0 ? p[c] : (double)sr_component(rounded, c));
            double off = fabs((double)sr_component(q, r) - truth) / (double)sr_component(error, r);
            worst = fmax(worst, off);
        }
    }
    EXPECT(worst <= 1);
    EXPECT(worst > 0.3); // a bound so loose that nothing comes near would be no use
}

TEST(offset_origins_clear_the_error_box_on_the_side_of_the_ray)
{
    for (int i = 0; i < 20000; ++i) {
        struct sr_point x = {.n = direction(), .p = sr_scale(uniform(0, 1000), direction())};
        float e = uniform(0, 1e-3f);
        x.p_error = (sr_vec3){e, uniform(0, e), uniform(0, e)};
        sr_vec3 w = direction(), o = sr_point_offset(&x, w), d = sr_sub(o, x.p);
        double height = (double)d.x * (double)x.n.x + (double)d.y * (double)x.n.y + (double)d.z * (double)x.n.z;
        double needed = fabs((double)x.n.x) * (double)x.p_error.x + fabs((double)x.n.y) * (double)x.p_error.y +
                        fabs((double)x.n.z) * (double)x.p_error.z;
        EXPECT(sr_dot(w, x.n) < 0 ? -height >= needed * 0.999999 : height >= needed * 0.999999);
        EXPECT(fabs(height) < 1.01 * needed + 1e-3);
    }
}

TEST(boxes_hold_what_is_put_in)
{
    struct sr_box b = sr_box_empty();
    EXPECT(sr_box_is_empty(b) && !sr_box_contains(b, (sr_vec3){0, 0, 0}));
    b = sr_box_add(sr_box_add(b, (sr_vec3){1, -2, 3}), (sr_vec3){-1, 4, 5});
    EXPECT(!sr_box_is_empty(b) && sr_box_contains(b, (sr_vec3){0, 0, 4}) && !sr_box_contains(b, (sr_vec3){0, 0, 0}));
    expect_vec(sr_box_centre(b), (sr_vec3){0, 1, 4}, 0);
    expect_vec(sr_box_diagonal(b), (sr_vec3){2, 6, 2}, 0);
    sr_vec3 centre;
    float radius;
    sr_box_bounding_sphere(b, &centre, &radius);
    EXPECT_NEAR(radius, sqrt(11), 1e-5);
    struct sr_transform t = sr_transform_rotate(90, (sr_vec3){0, 0, 1});
    struct sr_box r = sr_box_transform(&t, b);
    expect_vec(r.lo, (sr_vec3){-4, -1, 3}, 0);
    expect_vec(r.hi, (sr_vec3){2, 1, 5}, 0);
    EXPECT(sr_box_is_empty(sr_box_transform(&t, sr_box_empty())));
    r = sr_box_union(b, sr_box_empty());
    expect_vec(r.lo, b.lo, 0);
}

TEST(equal_area_map_has_its_landmarks)
{
    expect_vec(sr_equal_area_square_to_sphere((sr_vec2){0.5f, 0.5f}), (sr_vec3){0, 0, 1}, 1e-7f);
    expect_vec(sr_equal_area_square_to_sphere((sr_vec2){0, 0}), (sr_vec3){0, 0, -1}, 1e-7f);
    expect_vec(sr_equal_area_square_to_sphere((sr_vec2){1, 0.5f}), (sr_vec3){1, 0, 0}, 1e-6f);
    expect_vec(sr_equal_area_square_to_sphere((sr_vec2){0.5f, 1}), (sr_vec3){0, 1, 0}, 1e-6f);
    float h = sqrtf(0.5f);
    expect_vec(sr_equal_area_square_to_sphere((sr_vec2){0.75f, 0.25f}), (sr_vec3){h, -h, 0}, 1e-6f);
}

TEST(equal_area_map_goes_there_and_back)
{
    for (int i = 0; i < 100000; ++i) {
        sr_vec2 p = {uniform(0, 1), uniform(0, 1)};
        if (i % 4 == 0)
            p = (sr_vec2){0.5f + (p.x - 0.5f) * 1e-3f, 0.5f + (p.y - 0.5f) * 1e-3f};
        sr_vec3 d = sr_equal_area_square_to_sphere(p);
        EXPECT_NEAR(sr_length(d), 1, 1e-6);
        sr_vec2 q = sr_equal_area_sphere_to_square(d);
        EXPECT_NEAR(q.x, p.x, 1e-6);
        EXPECT_NEAR(q.y, p.y, 1e-6);
    }
    for (int i = 0; i < 100000; ++i) {
        sr_vec3 d = direction();
        if (i % 4 == 0)
            d = sr_normalize((sr_vec3){d.x * 1e-3f, d.y * 1e-3f, d.z});
        expect_vec(sr_equal_area_square_to_sphere(sr_equal_area_sphere_to_square(d)), d, 1e-6f);
    }
}

TEST(equal_area_map_keeps_areas)
{
    // cells of equal z and azimuth, filled by uniform points of the square
    double observed[16 * 16] = {0}, expected[16 * 16];
    int n = 512;
    for (int i = 0; i < n * n; ++i) {
        sr_vec2 p = {uniform(0, 1), uniform(0, 1)};
        sr_vec3 d = sr_equal_area_square_to_sphere(p);
        int row = (int)fminf(15, 8 * (d.z + 1)), column = (int)fminf(15, 8 * (atan2f(d.y, d.x) / SR_PI + 1));
        observed[row * 16 + column] += 1;
    }
    for (int i = 0; i < 256; ++i)
        expected[i] = n * n / 256.0;
    EXPECT_CHI2(observed, expected, 256);
}
