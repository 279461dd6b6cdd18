/* SPDX-License-Identifier: MIT */
/* Rays of the sensors against hand-computed ones, and optics that follow from them. */
#include "sensor/sensor.h"
#include "test.h"

struct made {
    const struct sr_sensor_model *model;
    void *self;
    struct sr_arena arena;
    struct sr_error error;
};

static void *member(struct made *m, const char *name)
{
    for (const struct sr_param *p = m->model->params; p->name; ++p)
        if (strcmp(p->name, name) == 0)
            return (char *)m->self + p->offset;
    test_fail(__FILE__, __LINE__, "%s has no %s", m->model->name, name);
}

static void set(struct made *m, const char *name, float value)
{
    *(float *)member(m, name) = value;
}

static struct made make(const char *name)
{
    struct made m = {.model = sr_sensor_model_find(name)};
    EXPECT(m.model != NULL);
    m.self = sr_arena_alloc(&m.arena, m.model->size);
    for (const struct sr_param *p = m.model->params; p->name; ++p) {
        EXPECT(p->offset < m.model->size && p->text && p->unit);
        if (p->kind == SR_PARAM_FLOAT)
            set(&m, p->name, (float)p->initial);
        else if (p->kind == SR_PARAM_ENUM)
            *(int32_t *)member(&m, p->name) = (int32_t)p->initial;
    }
    return m;
}

static void prepare(struct made *m, uint32_t width, uint32_t height, struct sr_transform t)
{
    if (m->model->prepare(m->self, (struct sr_sensor_raster){width, height}, &t, &m->arena, &m->error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", m->error.text);
}

static struct sr_sensor_ray look(const struct made *m, float x, float y, sr_vec2 lens)
{
    struct sr_sensor_ray r;
    EXPECT(m->model->ray(m->self, (sr_vec2){x, y}, lens, 0.25f, &r));
    EXPECT_NEAR(sr_length(r.ray.d), 1, 1e-6);
    EXPECT_NEAR(r.weight, 1, 0);
    EXPECT_NEAR(r.ray.time, 0.25, 0);
    return r;
}

static void expect_vector(sr_vec3 v, double x, double y, double z, double tolerance)
{
    EXPECT_NEAR(v.x, x, tolerance);
    EXPECT_NEAR(v.y, y, tolerance);
    EXPECT_NEAR(v.z, z, tolerance);
}

static const sr_vec2 middle = {0.5f, 0.5f};

TEST(fov_spans_the_shorter_side)
{
    struct made m = make("perspective");
    set(&m, "fov", 45);
    prepare(&m, 400, 200, sr_transform_identity());
    double k = tan(22.5 * 3.14159265358979 / 180);
    // pixel (300, 50): screen x = 2 (2 * 300.5 / 400 - 1), y = 1 - 2 * 50.5 / 200
    double x = k * 2 * (2 * 300.5 / 400 - 1), y = k * (1 - 2 * 50.5 / 200), length = sqrt(x * x + y * y + 1);
    struct sr_sensor_ray r = look(&m, 300.5f, 50.5f, middle);
    expect_vector(r.ray.d, x / length, y / length, 1 / length, 1e-6);
    expect_vector(r.ray.o, 0, 0, 0, 0);
    prepare(&m, 200, 400, sr_transform_identity());
    r = look(&m, 200, 200, middle); // right border, half height
    expect_vector(r.ray.d, k / sqrt(1 + k * k), 0, 1 / sqrt(1 + k * k), 1e-6);
    r = look(&m, 100, 0, middle); // upper border: twice as far
    expect_vector(r.ray.d, 0, 2 * k / sqrt(1 + 4 * k * k), 1 / sqrt(1 + 4 * k * k), 1e-6);
    sr_arena_free(&m.arena);
}

TEST(screen_window_and_frame_aspect_ratio_choose_the_frame)
{
    struct made m = make("perspective");
    set(&m, "frameaspectratio", 2);
    prepare(&m, 100, 100, sr_transform_identity());
    expect_vector(look(&m, 100, 50, middle).ray.d, 2 / sqrt(5), 0, 1 / sqrt(5), 1e-6);
    static const float window[4] = {0, 1, 0, 0.5f};
    *(struct sr_slice *)member(&m, "screenwindow") = (struct sr_slice){window, 4};
    prepare(&m, 100, 100, sr_transform_identity());
    expect_vector(look(&m, 0, 100, middle).ray.d, 0, 0, 1, 1e-6);
    expect_vector(look(&m, 100, 0, middle).ray.d, 1 / 1.5, 0.5 / 1.5, 1 / 1.5, 1e-6);
    sr_arena_free(&m.arena);
}

TEST(the_camera_looks_from_where_its_transform_puts_it)
{
    struct made m = make("perspective");
    struct sr_transform look_at = sr_transform_look_at((sr_vec3){1, 2, 3}, (sr_vec3){1, 2, -5}, (sr_vec3){0, 1, 0});
    prepare(&m, 100, 100, sr_transform_invert(&look_at));
    struct sr_sensor_ray r = look(&m, 50, 50, middle);
    expect_vector(r.ray.o, 1, 2, 3, 1e-6);
    expect_vector(r.ray.d, 0, 0, -1, 1e-6);
    EXPECT(look(&m, 50, 10, middle).ray.d.y > 0.1f); // up is up
    sr_arena_free(&m.arena);
}

TEST(differentials_are_differences_of_one_pixel)
{
    const char *names[3] = {"perspective", "orthographic", "spherical"};
    struct sr_transform turn = sr_transform_rotate(30, (sr_vec3){1, 2, 3}),
                        stretch = sr_transform_scale((sr_vec3){2, 1, 1});
    for (int i = 0; i < 3; ++i) {
        struct made m = make(names[i]);
        if (i < 2) {
            set(&m, "lensradius", 0.3f);
            set(&m, "focaldistance", 4);
        }
        prepare(&m, 64, 48, sr_transform_multiply(&turn, &stretch));
        sr_vec2 lens = {0.8f, 0.3f};
        struct sr_sensor_ray r = look(&m, 20.3f, 31.7f, lens), x = look(&m, 21.3f, 31.7f, lens),
                             y = look(&m, 20.3f, 32.7f, lens);
        EXPECT_NEAR(sr_length(sr_sub(sr_sub(x.ray.d, r.ray.d), r.dddx)), 0, 1e-6);
        EXPECT_NEAR(sr_length(sr_sub(sr_sub(y.ray.d, r.ray.d), r.dddy)), 0, 1e-6);
        EXPECT_NEAR(sr_length(sr_sub(sr_sub(x.ray.o, r.ray.o), r.dodx)), 0, 1e-6);
        EXPECT_NEAR(sr_length(sr_sub(sr_sub(y.ray.o, r.ray.o), r.dody)), 0, 1e-6);
        sr_arena_free(&m.arena);
    }
}

// solid angle of the pixel (x, y) [sr], of the great-circle polygon through its corners' rays
static double pixel_solid_angle(const struct made *m, float x, float y)
{
    sr_vec3 a = look(m, x, y, middle).ray.d, b = look(m, x + 1, y, middle).ray.d,
            c = look(m, x + 1, y + 1, middle).ray.d, d = look(m, x, y + 1, middle).ray.d;
    return sr_spherical_triangle_area(a, b, c) + sr_spherical_triangle_area(a, c, d);
}

/* A film of 36 x 24 mm behind f = 50 mm: 4 atan(a b / (f sqrt(a^2 + b^2 + f^2))) = 0.316522070564 sr: a = 18, b = 12 */
TEST(solid_angles_of_all_pixels_sum_to_that_of_the_frame)
{
    struct made m = make("perspective");
    set(&m, "fov", (float)(360 / 3.14159265358979323846 * atan(12.0 / 50)));
    prepare(&m, 36, 24, sr_transform_identity());
    double sum = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 36; ++x)
            sum += pixel_solid_angle(&m, (float)x, (float)y);
    EXPECT_RELATIVE(sum, 0.316522070564, 1e-6);
    sr_arena_free(&m.arena);
}

/* Pixels of a flat film shrink as cos^3, and are lit under cos: cos^4(40 deg) = 0.344362511235. */
TEST(irradiance_of_a_flat_film_behind_a_pinhole_falls_as_cos_4)
{
    struct made m = make("perspective");
    const float n = 2000;
    prepare(&m, 2000, 2000, sr_transform_identity());
    float x = (float)(1000 * (1 + tan(40 * 3.14159265358979 / 180)));
    double centre = pixel_solid_angle(&m, n / 2 - 0.5f, n / 2 - 0.5f),
           aside = pixel_solid_angle(&m, x - 0.5f, n / 2 - 0.5f);
    double cos_theta = (double)look(&m, x, n / 2, middle).ray.d.z;
    EXPECT_RELATIVE(aside / centre * cos_theta, 0.344362511235, 2e-3); // corners in float: 1e-7 of 1e-3
    sr_arena_free(&m.arena);
}

/* Image irradiance through a pupil of radius R = 12.5 mm at h = 50 mm from the film, of a field with L = 1:
 * E = INTEGRAL over the lens of cos_theta^2 / r^2 dA = (pi / 2) (1 - (h^2 + d^2 - R^2) / sqrt((h^2 + d^2 + R^2)^2 - 4
 * R^2 d^2)) (Foote 1915) at d = h tan(angle): 0.184799567858 on axis, 0.163249931822 at 15, 0.0681550144293 at 40
 * degrees. */
TEST(a_lens_lights_its_film_as_the_pupil_of_foote_does)
{
    const double angle[3] = {0, 15, 40}, expected[3] = {0.184799567858, 0.163249931822, 0.0681550144293};
    struct made m = make("perspective");
    set(&m, "lensradius", 0.0125f);
    prepare(&m, 1000, 1000, sr_transform_identity());
    for (int i = 0; i < 3; ++i) {
        double tangent = tan(angle[i] * 3.14159265358979 / 180);
        struct sr_rng rng = sr_rng_seed(7, (uint64_t)i);
        struct sr_tally E = {0};
        for (int k = 0; k < 20000; ++k) {
            sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
            struct sr_sensor_ray r = look(&m, (float)(500 * (1 + tangent)), 500, u);
            double dx = (double)r.ray.o.x + 0.05 * tangent, dy = (double)r.ray.o.y, h = 0.05,
                   r2 = dx * dx + dy * dy + h * h;
            sr_tally_add(&E, 3.14159265358979 * 0.0125 * 0.0125 * h * h / (r2 * r2));
        }
        EXPECT_MEAN(E, expected[i]);
    }
    sr_arena_free(&m.arena);
}

/* f = 50 mm, f/2, sharp at 2 m, a point at 4 m: the film stands at v = 1 / (1/f - 1/u) = 51.282 mm, the point's image
 * is a disk of D |v2 - v| / v2 = 0.320512820513 mm. The disk is made of all film points from which some ray meets the
 * point. */
TEST(the_circle_of_confusion_is_that_of_the_thin_lens)
{
    struct made m = make("perspective");
    set(&m, "lensradius", 0.0125f);
    set(&m, "focaldistance", 2);
    set(&m, "fov", 2);
    prepare(&m, 1000, 1000, sr_transform_identity());
    double film[2], k = tan(3.14159265358979 / 180), v = 1 / (1 / 0.05 - 1 / 2.0);
    for (int rim = 0; rim < 2; ++rim) {
        sr_vec2 u = {rim ? SR_ONE_MINUS_EPSILON : 0, 0.5f};
        double hit[2];
        for (int i = 0; i < 2; ++i) { // where the plane z = 4 is met is linear in the raster position
            struct sr_sensor_ray r = look(&m, i ? 750 : 250, 500, u);
            hit[i] = (double)r.ray.o.x + (double)(r.ray.d.x / r.ray.d.z) * 4;
        }
        double raster = 250 - 500 * hit[0] / (hit[1] - hit[0]);
        film[rim] = v * k * (raster / 500 - 1);
    }
    EXPECT_RELATIVE(fabs(film[1] - film[0]), 0.320512820513e-3, 1e-4);

    // and all rays of one pixel meet in the sharp plane
    struct sr_rng rng = sr_rng_seed(3, 3);
    for (int i = 0; i < 100; ++i) {
        sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
        struct sr_ray r = look(&m, 600, 300, u).ray;
        sr_vec3 p = sr_mad(r.o, 2 / r.d.z, r.d);
        expect_vector(p, 2 * k * 0.2, 2 * k * 0.4, 2, 1e-6);
    }
    sr_arena_free(&m.arena);
}

TEST(orthographic_rays_are_parallel_and_meet_in_the_sharp_plane)
{
    struct made m = make("orthographic");
    prepare(&m, 400, 200, sr_transform_identity());
    struct sr_sensor_ray r = look(&m, 300, 50, middle);
    expect_vector(r.ray.o, 1, 0.5, 0, 1e-6);
    expect_vector(r.ray.d, 0, 0, 1, 0);
    set(&m, "lensradius", 0.5f);
    set(&m, "focaldistance", 3);
    prepare(&m, 400, 200, sr_transform_identity());
    r = look(&m, 300, 50, (sr_vec2){0.9f, 0.2f});
    EXPECT(sr_length(sr_sub(r.ray.o, (sr_vec3){1, 0.5f, 0})) > 0.1f);
    expect_vector(sr_mad(r.ray.o, 3 / r.ray.d.z, r.ray.d), 1, 0.5, 3, 1e-6);
    sr_arena_free(&m.arena);
}

TEST(spherical_sees_all_directions_with_y_up)
{
    struct made m = make("spherical");
    prepare(&m, 64, 64, sr_transform_identity());
    expect_vector(look(&m, 32, 32, middle).ray.d, 0, 1, 0, 1e-6);
    expect_vector(look(&m, 0, 0, middle).ray.d, 0, -1, 0, 1e-6);
    double sum = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            sum += fabs(pixel_solid_angle(&m, (float)x, (float)y));
    EXPECT_NEAR(sum, 4 * 3.14159265358979, 1e-3);
    prepare(&m, 1000, 1000, sr_transform_identity());
    for (int y = 30; y < 1000; y += 101)
        for (int x = 5; x < 1000; x += 97) // small pixels have straight borders: each sees 4 pi / 10^6 sr
            EXPECT_RELATIVE(fabs(pixel_solid_angle(&m, (float)x, (float)y)), 4e-6 * 3.14159265358979, 5e-3);
    *(int32_t *)member(&m, "mapping") = 1;
    prepare(&m, 100, 50, sr_transform_identity());
    expect_vector(look(&m, 0, 25, middle).ray.d, 1, 0, 0, 1e-6);
    expect_vector(look(&m, 25, 25, middle).ray.d, 0, 0, 1, 1e-6);
    expect_vector(look(&m, 50, 12.5f, middle).ray.d, -sqrt(0.5), sqrt(0.5), 0, 1e-6);
    sr_arena_free(&m.arena);
}

static void expect_refused(struct made *m, uint32_t width, struct sr_transform t)
{
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(m->model->prepare(m->self, (struct sr_sensor_raster){width, 10}, &t, &m->arena, &error),
                     SR_ERROR_INPUT);
    EXPECT(error.text[0] != 0);
}

TEST(nonsense_is_refused)
{
    static const float empty[4] = {1, 1, 0, 1};
    struct made m = make("perspective");
    expect_refused(&m, 0, sr_transform_identity());
    expect_refused(&m, 10, sr_transform_scale((sr_vec3){1, 0, 1}));
    set(&m, "fov", 180);
    expect_refused(&m, 10, sr_transform_identity());
    set(&m, "fov", 90);
    set(&m, "focaldistance", 0);
    expect_refused(&m, 10, sr_transform_identity());
    set(&m, "focaldistance", 1);
    *(struct sr_slice *)member(&m, "screenwindow") = (struct sr_slice){empty, 4};
    expect_refused(&m, 10, sr_transform_identity());
    *(struct sr_slice *)member(&m, "screenwindow") = (struct sr_slice){empty, 3};
    expect_refused(&m, 10, sr_transform_identity());
    sr_arena_free(&m.arena);
}

/* ---- importance ---- */

static struct made importance_case(int i)
{
    struct made m = make(i < 2 ? "perspective" : i < 4 ? "orthographic" : "spherical");
    if (i < 4) {
        set(&m, "lensradius", i % 2 ? 0.3f : 0);
        set(&m, "focaldistance", 2.5f);
    }
    if (i < 2)
        set(&m, "fov", 70);
    if (i == 5)
        *(int32_t *)member(&m, "mapping") = 1;
    struct sr_transform turn = sr_transform_rotate(35, (sr_vec3){1, -2, 0.5f}),
                        move = sr_transform_translate((sr_vec3){1, 2, 3}),
                        stretch = sr_transform_scale(i < 4 ? (sr_vec3){-1.5f, 1.2f, 0.8f} : (sr_vec3){1, -1, 1});
    struct sr_transform t = sr_transform_multiply(&move, &turn);
    prepare(&m, 40, 24, sr_transform_multiply(&t, &stretch));
    return m;
}

TEST(connections_are_rays_backwards)
{
    struct sr_rng rng = sr_rng_seed(1, 1);
    for (int k = 0; k < 6; ++k) {
        struct made m = importance_case(k);
        for (int i = 0; i < 2000; ++i) {
            sr_vec2 q = {40 * sr_rng_float(&rng), 24 * sr_rng_float(&rng)},
                    u = {sr_rng_float(&rng), sr_rng_float(&rng)};
            struct sr_sensor_ray r = look(&m, q.x, q.y, u);
            float t = 0.2f + 4 * sr_rng_float(&rng);
            struct sr_sensor_view v;
            EXPECT(m.model->connect(m.self, sr_mad(r.ray.o, t, r.ray.d), 0, u, &v));
            EXPECT_NEAR(v.raster.x, q.x, 2e-3);
            EXPECT_NEAR(v.raster.y, q.y, 2e-3);
            EXPECT_NEAR(v.distance, t, 1e-5 * (double)t + 3e-6);
            EXPECT_NEAR(sr_length(sr_add(v.wi, r.ray.d)), 0, 3e-5);
            EXPECT_NEAR(sr_length(sr_sub(v.p, r.ray.o)), 0, 2e-5);
            EXPECT_RELATIVE(v.weight, m.model->density(m.self, r.ray.d, t, 0), 2e-4);
            // the raster's area is that of the cross section which its corners' rays cut out
            if (k == 4 && i > 200)
                continue; // the octahedral map's creases are nearly everywhere within reach of coarse steps
            const float h = 0.02f;
            if (k == 5 && (q.y < 1 || q.y > 23))
                continue;
            sr_vec3 p[4], d = r.ray.d;
            for (int c = 0; c < 4; ++c) {
                struct sr_sensor_ray s = look(&m, q.x + (c & 1 ? h : -h), q.y + (c & 2 ? h : -h), u);
                float reach = sr_dot(sr_sub(sr_mad(r.ray.o, t, d), s.ray.o), d) / sr_dot(s.ray.d, d);
                p[c] = sr_mad(s.ray.o, reach, s.ray.d);
            }
            double area = 0.5 * (double)sr_length(sr_cross(sr_sub(p[3], p[0]), sr_sub(p[2], p[1])));
            if (k != 4)
                EXPECT_RELATIVE((double)v.weight * area, 4 * (double)h * (double)h, 0.02);
        }
        sr_arena_free(&m.arena);
    }
}

// the integral of the weight over all places that a picture sees is the number of its pixels
TEST(importance_integrates_to_the_raster)
{
    struct sr_rng rng = sr_rng_seed(2, 2);
    for (int k = 0; k < 6; ++k) {
        struct made m = importance_case(k);
        struct sr_tally all = {0};
        struct sr_sensor_ray axis = look(&m, 20, 12, middle);
        const float radius = 8; // a sphere around the sensor, wide enough for parallel rays to leave through it once
        for (int i = 0; i < 400000; ++i) {
            sr_vec3 n = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
            struct sr_sensor_view v;
            double value = 0;
            if (m.model->connect(m.self, sr_mad(axis.ray.o, radius, n), 0,
                                 (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &v) &&
                v.raster.x >= 0 && v.raster.x < 40 && v.raster.y >= 0 && v.raster.y < 24 && sr_dot(n, v.wi) < 0)
                value = (double)(v.weight * -sr_dot(n, v.wi)) * 4 * (double)SR_PI * (double)(radius * radius);
            sr_tally_add(&all, value);
        }
        printf("    sensor %d: %.2f pixels +- %.2f\n", k, all.mean, sr_tally_standard_error(&all));
        EXPECT_MEAN(all, 40 * 24);
        sr_arena_free(&m.arena);
    }
}
