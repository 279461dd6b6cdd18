/* SPDX-License-Identifier: MIT */
/* Glare of fields whose answer is known: solid angles of pixels, even fields, one disk on an even background, errors.
 */
#include "glare/glare.h"
#include "test.h"

#define PI 3.14159265358979323846

static const double angles[] = {180, 120, 61};

TEST(pixels_of_a_fisheye_see_all_of_it_once)
{
    static const struct sr_sensor_raster rasters[] = {{64, 64}, {101, 101}, {90, 60}, {7, 31}};
    for (int kind = 0; kind < 4; ++kind)
        for (int a = 0; a < 3; ++a)
            for (int r = 0; r < 4; ++r) {
                double rim = angles[a] / 2 * PI / 180, omega = 0, projected = 0, w, p;
                for (uint32_t y = 0; y < rasters[r].height; ++y)
                    for (uint32_t x = 0; x < rasters[r].width; ++x) {
                        sr_fisheye_pixel((enum sr_fisheye)kind, rim, rasters[r], x, y, &w, &p);
                        EXPECT(w >= 0 && p >= 0 && p <= w + 1e-6 * PI / (rasters[r].width * rasters[r].height));
                        omega += w;
                        projected += p;
                    }
                EXPECT_RELATIVE(omega, 2 * PI * (1 - cos(rim)), 1e-12);
                EXPECT_RELATIVE(projected, PI * sin(rim) * sin(rim), 1e-12);
            }
}

/* Each pixel alone, against many small parts of it and the Jacobian of the projection. */
TEST(each_pixel_sees_the_integral_of_its_projection)
{
    struct sr_sensor_raster raster = {16, 16};
    for (int kind = 0; kind < 4; ++kind)
        for (int pixel = 0; pixel < 256; pixel += 5) {
            enum { N = 64 };
            uint32_t x = (uint32_t)pixel % 16, y = (uint32_t)pixel / 16;
            double rim = 80 * PI / 180, sum[2] = {0, 0}, w, p;
            for (int k = 0; k < N * N; ++k) {
                double u = ((x + (k % N + 0.5) / N) - 8) / 8, v = ((y + (k / N + 0.5) / N) - 8) / 8,
                       r = sqrt(u * u + v * v), h = 1e-5;
                if (r > 1)
                    continue;
                double theta = sr_fisheye_angle((enum sr_fisheye)kind, r, rim);
                double slope = (sr_fisheye_angle((enum sr_fisheye)kind, r + h, rim) -
                                sr_fisheye_angle((enum sr_fisheye)kind, r - h, rim)) /
                               (2 * h);
                double density = sin(theta) / r * slope / (64.0 * N * N); // dw = sin theta dtheta dphi, dA = r dr dphi
                sum[0] += density;
                sum[1] += density * cos(theta);
            }
            sr_fisheye_pixel((enum sr_fisheye)kind, rim, raster, x, y, &w, &p);
            EXPECT_NEAR(w, sum[0], 5e-3 * sum[0] + 1e-5); // the parts at the rim are all or nothing
            EXPECT_NEAR(p, sum[1], 5e-3 * sum[1] + 1e-5);
        }
}

TEST(rays_of_the_camera_go_where_pixels_are_said_to_look)
{
    const struct sr_sensor_model *model = sr_sensor_model_find("fisheye");
    EXPECT(model);
    for (int kind = 0; kind < 4; ++kind) {
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        struct sr_transform t = sr_transform_identity();
        void *self = sr_arena_alloc(&arena, model->size);
        for (const struct sr_param *p = model->params; p->name; ++p)
            if (p->kind == SR_PARAM_FLOAT)
                *(float *)(void *)((char *)self + p->offset) = (float)p->initial;
            else
                *(int32_t *)(void *)((char *)self + p->offset) = kind;
        struct sr_sensor_raster raster = {40, 30};
        EXPECT_EQUAL_INT(model->prepare(self, raster, &t, &arena, &error), SR_OK);
        struct sr_sensor_ray ray;
        EXPECT(model->ray(self, (sr_vec2){20, 15}, (sr_vec2){0, 0}, 0, &ray) && ray.ray.d.z > 0.999999f);
        EXPECT(model->ray(self, (sr_vec2){35, 15}, (sr_vec2){0, 0}, 0, &ray) &&
               fabsf(ray.ray.d.x - 1) < 1e-3f); // the rim, right
        EXPECT(model->ray(self, (sr_vec2){20, 0}, (sr_vec2){0, 0}, 0, &ray) &&
               fabsf(ray.ray.d.y - 1) < 1e-3f); // and above
        EXPECT(!model->ray(self, (sr_vec2){1, 1}, (sr_vec2){0, 0}, 0, &ray));
        double d[3];
        EXPECT(model->ray(self, (sr_vec2){27.5f, 11.25f}, (sr_vec2){0, 0}, 0, &ray));
        EXPECT(sr_fisheye_direction((enum sr_fisheye)kind, PI / 2, raster, 27.5, 11.25, d));
        EXPECT_NEAR(ray.ray.d.x, d[0], 1e-6);
        EXPECT_NEAR(ray.ray.d.y, d[1], 1e-6);
        EXPECT_NEAR(ray.ray.d.z, d[2], 1e-6);
        sr_arena_free(&arena);
    }
}

/* ---- pictures ---- */

static struct sr_image *picture(uint32_t width, uint32_t height, float L, float error)
{
    struct sr_error e = {0};
    struct sr_image *image;
    const char *names[] = {"Y", "SE.Y"};
    EXPECT_EQUAL_INT(sr_image_create(width, height, error > 0 ? 2 : 1, names, SR_IMAGE_FLOATS, &image, &e), SR_OK);
    for (size_t i = 0; i < (size_t)width * height; ++i) {
        image->floats[i * image->channel_count] = L;
        if (error > 0)
            image->floats[i * 2 + 1] = error;
    }
    return image;
}

static struct sr_glare glare_of(const struct sr_image *image, struct sr_glare_options o)
{
    static struct sr_arena arena;
    struct sr_error error = {0};
    struct sr_glare g;
    if (sr_glare_measure(image, &o, &arena, &g, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return g;
}

TEST(an_even_field_gives_pi_times_its_luminance)
{
    for (int projection = 0; projection < 6; ++projection) {
        bool is_spherical = projection >= SR_GLARE_EQUAL_AREA;
        struct sr_image *image = picture(projection == SR_GLARE_EQUIRECTANGULAR ? 256 : 128, 128, 100, 0);
        struct sr_glare g =
            glare_of(image, (struct sr_glare_options){.projection = (enum sr_glare_projection)projection});
        EXPECT_RELATIVE(g.E_v, 100 * PI, is_spherical ? 1e-3 : 1e-6);
        EXPECT_RELATIVE(g.omega, 2 * PI, is_spherical ? 2e-3 : 1e-6);
        EXPECT_RELATIVE(g.L_background, 100, is_spherical ? 1e-3 : 1e-6);
        EXPECT_EQUAL_INT(g.source_count, 0);
        EXPECT(isnan(g.index[SR_GLARE_UGR]));
        EXPECT_RELATIVE(g.index[SR_GLARE_DGP], 5.87e-5 * g.E_v + 0.16, 1e-9);
        sr_image_free(image);
    }
}

/* The direction that a pixel of each projection looks to, as its definition says. */
static bool direction(enum sr_glare_projection projection, double x, double y, uint32_t size, double d[3])
{
    if (projection <= SR_GLARE_STEREOGRAPHIC)
        return sr_fisheye_direction((enum sr_fisheye)projection, PI / 2, (struct sr_sensor_raster){size, size}, x, y,
                                    d);
    sr_vec3 s = sr_equal_area_square_to_sphere((sr_vec2){(float)(x / size), (float)(y / size)});
    d[0] = (double)s.x, d[1] = (double)s.z, d[2] = (double)s.y;
    return true;
}

/* A disk of half angle alpha at (sigma, tau), made of the pixels that it covers by more than half. */
TEST(a_disk_on_an_even_background_has_the_indices_of_the_formulas)
{
    static const double sigmas[] = {0, 25, 40, 40}, taus[] = {0, 0, 60, 150};
    const double alpha = 6, L = 8000, background = 120;
    for (int projection = 0; projection < 5; ++projection)
        for (int place = 0; place < 4; ++place) {
            const uint32_t size = 600;
            double s = sigmas[place] * PI / 180, t = taus[place] * PI / 180,
                   axis[3] = {sin(s) * sin(t), sin(s) * cos(t), cos(s)};
            struct sr_image *image = picture(size, size, (float)background, 0);
            for (uint32_t y = 0; y < size; ++y)
                for (uint32_t x = 0; x < size; ++x) {
                    int inside = 0;
                    double d[3];
                    bool is_near = direction((enum sr_glare_projection)projection, x, y, size, d) &&
                                   d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2] > cos((alpha + 4) * PI / 180);
                    for (int k = 0; k < 16 && is_near; ++k) {
                        if (direction((enum sr_glare_projection)projection, x + (k % 4 + 0.5) / 4,
                                      y + (k / 4 + 0.5) / 4, size, d))
                            inside += d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2] > cos(alpha * PI / 180);
                    }
                    image->floats[(size_t)y * size + x] = (float)(background + (L - background) * (inside > 8 ? 1 : 0));
                }
            struct sr_glare g =
                glare_of(image, (struct sr_glare_options){.projection = (enum sr_glare_projection)projection,
                                                          .threshold = 1000});
            double omega = 2 * PI * (1 - cos(alpha * PI / 180)), c = PI * pow(sin(alpha * PI / 180), 2) * cos(s);
            double tau = fmin(taus[place], 90);
            double P = exp((35.2 - 0.31889 * tau - 1.22 * exp(-2 * tau / 9)) * 1e-3 * sigmas[place] +
                           (21 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5 * sigmas[place] * sigmas[place]);
            double E_d = L * c, E_i = background * (PI - c), E_v = E_d + E_i, Lb = E_i / PI,
                   sum = L * L * omega / (P * P);
            double mean = (L * omega + background * (2 * PI - omega)) / (2 * PI),
                   M = 0.5 * L * (20.4 * omega + 1.52 * pow(omega, 0.2) - 0.075) / (P * pow(mean, 0.44));
            double tolerance = projection == SR_GLARE_EQUAL_AREA ? 2 : 1; // half as many pixels
            EXPECT_EQUAL_INT(g.source_count, 1);
            EXPECT_RELATIVE(g.sources[0].omega, omega, 1.3e-2 * tolerance); // whole pixels
            EXPECT_RELATIVE(g.sources[0].L, L, 1e-6);
            EXPECT_NEAR(g.sources[0].sigma_deg, sigmas[place], 0.1);
            if (place)
                EXPECT_NEAR(g.sources[0].tau_deg, taus[place], 0.2);
            EXPECT_RELATIVE(g.sources[0].position, P, 5e-3);
            EXPECT_RELATIVE(g.E_v, E_v, 6e-3 * tolerance);
            EXPECT_NEAR(g.index[SR_GLARE_UGR], 8 * log10(0.25 / Lb * sum), 0.05 * tolerance);
            EXPECT_NEAR(g.index[SR_GLARE_DGP], 5.87e-5 * E_v + 0.0918 * log10(1 + sum / pow(E_v, 1.87)) + 0.16,
                        1e-3 * tolerance);
            EXPECT_NEAR(g.index[SR_GLARE_DGI],
                        10 * log10(0.478 * pow(L, 1.6) * pow(omega / (P * P), 0.8) / (Lb + 0.07 * sqrt(omega) * L)),
                        0.05 * tolerance);
            EXPECT_NEAR(g.index[SR_GLARE_CGI], 8 * log10(2 * (1 + E_d / 500) / (E_d + E_i) * sum), 0.05 * tolerance);
            EXPECT_NEAR(g.index[SR_GLARE_VCP], 50 * erfc(-(6.374 - 1.3227 * log(M)) / sqrt(2)), 0.5 * tolerance);
            sr_image_free(image);
        }
}

TEST(position_index_is_one_on_the_line_of_sight_and_grows_away_from_it)
{
    EXPECT_NEAR(sr_glare_position(0, 30), 1, 0);
    for (int tau = 0; tau <= 90; tau += 15)
        for (int sigma = 5; sigma < 85; sigma += 5)
            EXPECT(sr_glare_position(sigma + 5, tau) > sr_glare_position(sigma, tau));
    EXPECT_NEAR(sr_glare_position(20, 170), sr_glare_position(20, 90), 0);
}

TEST(sources_are_connected_and_peaks_stand_apart)
{
    struct sr_image *image = picture(200, 200, 50, 0);
    const struct {
        uint32_t x0, x1, y0, y1;
        float L;
    } spots[] = {{60, 80, 60, 80, 5000}, {80, 90, 80, 90, 5000}, {120, 130, 60, 70, 6000}, {64, 68, 64, 68, 90000}};
    for (int k = 0; k < 4; ++k)
        for (uint32_t y = spots[k].y0; y < spots[k].y1; ++y)
            for (uint32_t x = spots[k].x0; x < spots[k].x1; ++x)
                image->floats[y * 200 + x] = spots[k].L;
    struct sr_glare g = glare_of(image, (struct sr_glare_options){.threshold = 2000});
    EXPECT_EQUAL_INT(g.source_count, 3); // the first two touch at a corner
    uint32_t pixels = 0;
    for (uint32_t k = 0; k < 3; ++k)
        pixels += g.sources[k].pixels;
    EXPECT_EQUAL_INT(pixels, 400 + 100 + 100);
    EXPECT_EQUAL_INT(g.sources[1].pixels, 16); // less light than the first
    EXPECT_RELATIVE(g.sources[1].L, 90000, 1e-6);
    EXPECT(g.labels[60 * 200 + 60] == g.labels[85 * 200 + 85] && g.labels[65 * 200 + 125] &&
           g.labels[65 * 200 + 65] != g.labels[60 * 200 + 60]);
    g = glare_of(image, (struct sr_glare_options){.threshold = 2000, .peak = (double)INFINITY});
    EXPECT_EQUAL_INT(g.source_count, 2);
    // five times the mean of a task that sees the background alone
    g = glare_of(image, (struct sr_glare_options){.task = {100, 150, 5}});
    EXPECT_RELATIVE(g.threshold, 250, 1e-6);
    EXPECT_RELATIVE(g.L_task, 50, 1e-6);
    sr_image_free(image);
}

/* Pictures with independent noise: the indices scatter as much as each picture says. */
TEST(errors_of_the_indices_are_the_scatter_of_noisy_pictures)
{
    enum { PICTURES = 400, SIZE = 48 };
    static double index[SR_GLARE_INDICES + 1][PICTURES];
    double told[SR_GLARE_INDICES + 1] = {0};
    struct sr_rng rng = sr_rng_seed(11, 5);
    for (int n = 0; n < PICTURES; ++n) {
        struct sr_image *image = picture(SIZE, SIZE, 0, 1);
        for (uint32_t i = 0; i < SIZE * SIZE; ++i) {
            uint32_t x = i % SIZE, y = i / SIZE;
            float L = x > 26 && x < 32 && y > 12 && y < 18 ? 4000 : x > 8 && x < 12 && y > 20 && y < 24 ? 3000 : 200;
            image->floats[2 * i + 1] = 0.2f * L;
            image->floats[2 * i] =
                L * (1 + 0.2f * (float)sr_normal_quantile((double)sr_rng_float(&rng) * 0.999998 + 1e-6));
        }
        struct sr_glare g = glare_of(image, (struct sr_glare_options){.threshold = 1000});
        EXPECT(g.has_errors);
        EXPECT_EQUAL_INT(g.source_count, 2);
        for (int k = 0; k < SR_GLARE_INDICES; ++k) {
            index[k][n] = g.index[k];
            told[k] += g.error[k] / PICTURES;
        }
        index[SR_GLARE_INDICES][n] = g.E_v;
        told[SR_GLARE_INDICES] += g.E_v_error / PICTURES;
        sr_image_free(image);
    }
    for (int k = 0; k <= SR_GLARE_INDICES; ++k) {
        struct sr_tally tally = {0};
        for (int n = 0; n < PICTURES; ++n)
            sr_tally_add(&tally, index[k][n]);
        EXPECT_RELATIVE(told[k], sqrt(sr_tally_variance(&tally)), 0.17); // 4.9 / sqrt(2 * 400)
    }
}

TEST(pictures_without_luminance_or_place_are_refused)
{
    struct sr_error error = {0};
    struct sr_arena arena = {0};
    struct sr_glare g;
    struct sr_image *image = picture(32, 32, 1, 0), *part;
    EXPECT_EQUAL_INT(sr_glare_measure(image, &(struct sr_glare_options){.angle_deg = 200}, &arena, &g, &error),
                     SR_ERROR_USAGE);
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_crop(image, 2, 2, 8, 8, &part, &error), SR_OK);
    EXPECT_EQUAL_INT(sr_glare_measure(part, &(struct sr_glare_options){0}, &arena, &g, &error), SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "part of a picture"));
    error = (struct sr_error){0};
    image->floats[16 * 32 + 16] = NAN;
    EXPECT_EQUAL_INT(sr_glare_measure(image, &(struct sr_glare_options){0}, &arena, &g, &error), SR_ERROR_INPUT);
    sr_image_free(part);
    sr_image_free(image);
    sr_arena_free(&arena);
}
