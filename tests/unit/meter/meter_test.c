/* SPDX-License-Identifier: MIT */
/* Meters against their definitions: responses integrate to what is known, densities are densities of what is drawn. */
#include "meter/meter.h"
#include "test.h"

struct made {
    struct sr_meter meter;
    struct sr_arena arena;
};

static void *member(const struct sr_param *rows, void *self, const char *name)
{
    for (const struct sr_param *p = rows; p->name; ++p)
        if (strcmp(p->name, name) == 0)
            return (char *)self + p->offset;
    test_fail(__FILE__, __LINE__, "there is no parameter %s", name);
}

/* As the importer binds a meter of which nothing is said. */
static void *self_of(struct made *m, const char *name)
{
    const struct sr_meter_model *model = sr_meter_model_find(name);
    EXPECT(model != NULL);
    void *self = sr_arena_alloc(&m->arena, model->size);
    const struct sr_param *tables[2] = {sr_meter_common_params, model->params};
    for (int t = 0; t < 2; ++t)
        for (const struct sr_param *p = tables[t]; p->name; ++p) {
            void *at = (char *)self + p->offset;
            EXPECT(p->offset < model->size && p->text && p->unit);
            if (p->kind == SR_PARAM_FLOAT)
                *(float *)at = (float)p->initial;
            else if (p->kind == SR_PARAM_ENUM || p->kind == SR_PARAM_INT)
                *(int32_t *)at = (int32_t)p->initial;
            else if (p->kind == SR_PARAM_POINT3 || p->kind == SR_PARAM_VECTOR3 || p->kind == SR_PARAM_NORMAL3)
                *(sr_vec3 *)at = (sr_vec3){(float)p->initial, (float)p->initial, (float)p->initial};
        }
    m->meter = (struct sr_meter){model, self};
    return self;
}

static void prepare(struct made *m)
{
    struct sr_error error = {0};
    struct sr_transform one = sr_transform_identity();
    if (m->meter.model->prepare((void *)(uintptr_t)m->meter.self, &one, &m->arena, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

static struct made make(const char *name)
{
    struct made m = {0};
    self_of(&m, name);
    if (strcmp(name, "flux") == 0 || strcmp(name, "irradiancemap") == 0) {
        *(sr_vec3 *)member(m.meter.model->params, (void *)(uintptr_t)m.meter.self, "u") = (sr_vec3){2, 0, 0};
        *(sr_vec3 *)member(m.meter.model->params, (void *)(uintptr_t)m.meter.self, "v") = (sr_vec3){0, 3, 0};
    }
    prepare(&m);
    return m;
}

static float of_response(const struct sr_meter *m, sr_vec3 w)
{
    return m->model->response(m->self, w);
}
static float of_pdf(const struct sr_meter *m, sr_vec3 w)
{
    return m->model->pdf(m->self, w);
}

/* INTEGRAL of f over the octants of the sphere, each by Gauss-Legendre. */
static double over_sphere(const struct sr_meter *m, float (*f)(const struct sr_meter *, sr_vec3))
{
    enum { N = 48 };
    double sum = 0;
    for (int octant = 0; octant < 8; ++octant) {
        double z[N], wz[N], phi[N], wphi[N], quarter = (double)SR_PI / 2;
        sr_gauss_legendre(N, octant & 4 ? -1 : 0, octant & 4 ? 0 : 1, z, wz);
        sr_gauss_legendre(N, (octant & 3) * quarter, (octant & 3) * quarter + quarter, phi, wphi);
        for (int i = 0; i < N; ++i)
            for (int k = 0; k < N; ++k) {
                double s = sqrt(1 - z[i] * z[i]);
                sum += wz[i] * wphi[k] *
                       (double)f(m, (sr_vec3){(float)(s * cos(phi[k])), (float)(s * sin(phi[k])), (float)z[i]});
            }
    }
    return sum;
}

TEST(responses_of_bodies_read_pi_of_uniform_light)
{
    static const struct {
        const char *name;
        double extent;
    } meters[] = {{"irradiance", 1},    {"cylindrical", 1}, {"semicylindrical", 1},
                  {"hemispherical", 1}, {"spherical", 1},   {"fluence", 4}};
    for (size_t i = 0; i < sizeof meters / sizeof *meters; ++i) {
        struct made m = make(meters[i].name);
        EXPECT_RELATIVE(over_sphere(&m.meter, of_response), meters[i].extent * (double)SR_PI, 2e-4);
        EXPECT_RELATIVE(m.meter.model->extent(m.meter.self), meters[i].extent * (double)SR_PI, 1e-6);
        sr_arena_free(&m.arena);
    }
}

TEST(densities_of_directions_are_those_of_what_is_drawn)
{
    enum { CELLS_Z = 8, CELLS_PHI = 8, CELLS = CELLS_Z * CELLS_PHI, DRAWS = 1 << 16, FINE = 16 };
    for (int k = 0; sr_meter_models[k]; ++k) {
        struct made m = {0};
        if (strcmp(sr_meter_models[k]->name, "radiance") == 0 || sr_meter_models[k]->far)
            continue; // a delta, and a cone that is tested below; meters of the far field draw nothing
        m = make(sr_meter_models[k]->name);
        EXPECT_RELATIVE(over_sphere(&m.meter, of_pdf), 1, 2e-4);
        double seen[CELLS] = {0}, expected[CELLS] = {0};
        struct sr_rng rng = sr_rng_seed(7, (uint64_t)k);
        for (int i = 0; i < DRAWS; ++i) {
            sr_vec3 w;
            sr_u4 u = {sr_rng_float(&rng), sr_rng_float(&rng), sr_rng_float(&rng), sr_rng_float(&rng)};
            float pdf = m.meter.model->sample(m.meter.self, u, &w);
            EXPECT_NEAR(sr_length(w), 1, 1e-5);
            EXPECT_NEAR(pdf, of_pdf(&m.meter, w), 1e-6);
            int z = (int)((w.z + 1) / 2 * CELLS_Z), phi = (int)(sr_angle_of(w.y, w.x) / (2 * SR_PI) * CELLS_PHI);
            seen[(z < CELLS_Z ? z : CELLS_Z - 1) * CELLS_PHI + (phi < CELLS_PHI ? phi : CELLS_PHI - 1)] += 1;
        }
        for (int i = 0; i < CELLS * FINE * FINE; ++i) {
            int cell = i / (FINE * FINE), a = i % FINE, b = i / FINE % FINE;
            double z = -1 + 2 * (cell / CELLS_PHI + (a + 0.5) / FINE) / CELLS_Z,
                   phi = 2 * (double)SR_PI * (cell % CELLS_PHI + (b + 0.5) / FINE) / CELLS_PHI;
            double s = sqrt(1 - z * z), area = 4 * (double)SR_PI / (CELLS * FINE * FINE);
            expected[cell] +=
                DRAWS * area *
                (double)of_pdf(&m.meter, (sr_vec3){(float)(s * cos(phi)), (float)(s * sin(phi)), (float)z});
        }
        EXPECT_CHI2(seen, expected, CELLS);
        sr_arena_free(&m.arena);
    }
}

TEST(responses_follow_their_definitions_in_single_directions)
{
    double theta = 0.7, phi = 2.1, s = sin(theta), c = cos(theta);
    sr_vec3 w = {(float)(s * cos(phi)), (float)(s * sin(phi)), (float)c};
    const struct {
        const char *name;
        double up, down;
    } meters[] = {
        {"irradiance", c, 0},
        {"cylindrical", s / (double)SR_PI, s / (double)SR_PI},
        {"semicylindrical", s * (1 + cos(phi)) / (double)SR_PI, s * (1 + cos(phi)) / (double)SR_PI},
        {"hemispherical", (1 + c) / 4, (1 - c) / 4},
        {"spherical", 0.25, 0.25},
        {"fluence", 1, 1},
        {"flux", c, 0},
    };
    for (size_t i = 0; i < sizeof meters / sizeof *meters; ++i) {
        struct made m = make(meters[i].name);
        EXPECT_NEAR(of_response(&m.meter, w), meters[i].up, 1e-6);
        EXPECT_NEAR(of_response(&m.meter, (sr_vec3){w.x, w.y, -w.z}), meters[i].down, 1e-6);
        sr_arena_free(&m.arena);
    }
}

TEST(sides_of_a_surface_count_as_they_say)
{
    static const double up[4] = {0.8, 0, 0.8, 0.8}, down[4] = {0, 0.8, 0.8, -0.8};
    for (int side = 0; side < 4; ++side) {
        struct made m = {0};
        void *self = self_of(&m, "flux");
        *(sr_vec3 *)member(m.meter.model->params, self, "u") = (sr_vec3){2, 0, 0};
        *(sr_vec3 *)member(m.meter.model->params, self, "v") = (sr_vec3){0, 3, 0};
        *(int32_t *)member(m.meter.model->params, self, "side") = side;
        prepare(&m);
        EXPECT_NEAR(of_response(&m.meter, (sr_vec3){0.6f, 0, 0.8f}), up[side], 1e-6);
        EXPECT_NEAR(of_response(&m.meter, (sr_vec3){0.6f, 0, -0.8f}), down[side], 1e-6);
        EXPECT_RELATIVE(over_sphere(&m.meter, of_pdf), 1, 1e-4);
        EXPECT_RELATIVE(m.meter.model->extent(m.meter.self), (side < 2 ? 6 : 12) * (double)SR_PI, 1e-6);
        sr_arena_free(&m.arena);
    }
}

TEST(a_cone_takes_in_its_mean_and_nothing_beside_it)
{
    static const float angles[] = {0.05f, 3, 30, 90, 140};
    for (size_t i = 0; i < sizeof angles / sizeof *angles; ++i) {
        struct sr_arena arena = {0};
        float a = angles[i] * SR_PI / 180;
        struct sr_meter m = sr_meter_radiance_along(&arena, (sr_vec3){1, 2, 3}, (sr_vec3){0, 5, 0}, a);
        double omega = 2 * (double)SR_PI * (1 - cos((double)a));
        struct sr_rng rng = sr_rng_seed(3, i);
        for (int k = 0; k < 1000; ++k) {
            sr_vec3 w;
            sr_u4 u = {sr_rng_float(&rng), sr_rng_float(&rng), 0, 0};
            EXPECT_RELATIVE(m.model->sample(m.self, u, &w), 1 / omega,
                            2e-4); // 1 - cos keeps fewer digits here than there
            EXPECT(w.z > 0 || angles[i] > 89);
            EXPECT(sqrtf(w.x * w.x + w.y * w.y) <= sinf(a) * 1.0001f || angles[i] >= 90);
        }
        EXPECT_NEAR(of_response(&m, (sr_vec3){sinf(a * 1.01f), 0, cosf(a * 1.01f)}), 0, 0);
        EXPECT(of_response(&m, (sr_vec3){sinf(a * 0.99f), 0, cosf(a * 0.99f)}) > 0);
        struct sr_meter_place at;
        EXPECT(m.model->place(m.self, (sr_vec2){0, 0}, &at) && !m.model->is_ray(m.self));
        EXPECT_NEAR(at.frame.z.y, 1, 1e-6);
        sr_arena_free(&arena);
    }
    struct sr_arena arena = {0};
    struct sr_meter ray = sr_meter_radiance_along(&arena, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 1}, 0);
    EXPECT(ray.model && ray.model->is_ray(ray.self));
    EXPECT(sr_meter_radiance_along(&arena, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 0}, 0).model == NULL);
    EXPECT(sr_meter_irradiance_at(&arena, (sr_vec3){0, 0, 0}, (sr_vec3){0, NAN, 0}).model == NULL);
    sr_arena_free(&arena);
}

TEST(points_of_surfaces_are_spread_by_area)
{
    static const double areas[] = {2, 3.14159265, 12.5663706}; // rectangle, disk, sphere
    for (int shape = 0; shape < 3; ++shape) {
        struct made m = {0};
        void *self = self_of(&m, "flux");
        *(sr_vec3 *)member(m.meter.model->params, self, "u") = (sr_vec3){1, 0, 0};
        *(sr_vec3 *)member(m.meter.model->params, self, "v") = (sr_vec3){1, 2, 0};
        *(int32_t *)member(m.meter.model->params, self, "shape") = shape;
        prepare(&m);
        struct sr_tally x2 = {0}, z2 = {0};
        for (uint32_t i = 0; i < 4096; ++i) {
            struct sr_meter_place at;
            struct sr_sampler sampler = sr_sampler_start(SR_SAMPLER_INDEPENDENT, 1, 0, 0, 0, i);
            sr_u4 u = sr_sample4(&sampler, 0);
            EXPECT(m.meter.model->place(m.meter.self, (sr_vec2){u[0], u[1]}, &at));
            EXPECT_RELATIVE(at.weight, areas[shape], 1e-5);
            sr_tally_add(&x2, (double)(at.x.p.x * at.x.p.x));
            sr_tally_add(&z2, (double)(at.x.p.z * at.x.p.z));
        }
        EXPECT_MEAN(x2, ((const double[]){7.0 / 6, 0.25, 1.0 / 3}[shape])); // (u + v)^2: 1/3 + 1/3 + 2/4
        if (shape == 2)
            EXPECT_MEAN(z2, 1.0 / 3);
        sr_arena_free(&m.arena);
    }
}

/* ---- detectors ---- */

TEST(a_spectrometer_counts_every_wavelength_once)
{
    struct sr_error error = {0};
    static const double widths[] = {10, 10, 20, 5};
    for (int k = 0; k < 4; ++k) {
        struct sr_spectrometer s;
        EXPECT_EQUAL_INT(sr_spectrometer_prepare(400, 10, 700, widths[k],
                                                 k == 1 ? SR_BAND_RECTANGULAR : SR_BAND_TRIANGULAR, &s, &error),
                         SR_OK);
        EXPECT_EQUAL_INT(s.count, 31);
        struct sr_tally sums[31] = {0};
        for (uint32_t i = 0; i < 20000; ++i) {
            struct sr_wavelengths w =
                sr_wavelengths_sample((struct sr_lambda_range){360, 830}, ((float)i + 0.5f) / 20000);
            double bins[31] = {0};
            sr_spectrum X = SR_BLACK; // 2e-3 lambda per nm
            for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
                X[l] = SR_KM * 2e-3f * w.lambda[l];
            sr_spectrometer_add(&s, X, &w, bins);
            for (int b = 0; b < 31; ++b)
                sr_tally_add(&sums[b], bins[b]);
        }
        for (int b = 0; b < 31; ++b) // a symmetric bandpass gives the middle of a straight line
            EXPECT_RELATIVE(sums[b].mean, 2e-3 * (400 + 10 * b), 5e-3);
    }
    struct sr_spectrometer s;
    EXPECT(sr_spectrometer_prepare(400, 0, 700, NAN, SR_BAND_TRIANGULAR, &s, &error) != SR_OK);
    EXPECT(sr_spectrometer_prepare(700, 10, 400, NAN, SR_BAND_TRIANGULAR, &s, &error) != SR_OK);
    EXPECT(sr_spectrometer_prepare(400, 1e-3, 700, NAN, SR_BAND_TRIANGULAR, &s, &error) != SR_OK);
}

static void colour_of_spd(const struct sr_spd *s, double c[SR_COLOUR_COUNT])
{
    double xyz[3];
    sr_spd_xyz(s, xyz);
    for (int i = 0; i < 3; ++i)
        c[i] = xyz[i];
    sr_colour_of(c);
}

TEST(colours_of_black_bodies_and_daylight_are_the_known_ones)
{
    double c[SR_COLOUR_COUNT];
    static const float T[] = {1500, 2856, 6500, 20000};
    for (int i = 0; i < 4; ++i) {
        struct sr_spd s = sr_spd_blackbody(T[i]);
        colour_of_spd(&s, c);
        EXPECT_RELATIVE(c[SR_COLOUR_CCT], T[i], 1e-4);
        EXPECT_NEAR(c[SR_COLOUR_DUV], 0, 1e-6);
    }
    struct sr_spd D65 = sr_spd_named("stdillum-D65");
    colour_of_spd(&D65, c);
    EXPECT_NEAR(c[SR_COLOUR_x], 0.31272, 2e-5); // CIE 015:2018, table 5
    EXPECT_NEAR(c[SR_COLOUR_u], 0.19783, 2e-5);
    EXPECT_NEAR(c[SR_COLOUR_v], 0.46833, 3e-5);
    EXPECT_NEAR(c[SR_COLOUR_CCT], 6504, 1.5);
    EXPECT_NEAR(c[SR_COLOUR_DUV], 0.0032, 5e-5);
    double green[SR_COLOUR_COUNT] = {0.2, 1, 0.1};
    sr_colour_of(green);
    EXPECT(isnan(green[SR_COLOUR_CCT]) && green[SR_COLOUR_DUV] > 0.05);
    double black[SR_COLOUR_COUNT] = {0};
    sr_colour_of(black);
    EXPECT(isnan(black[SR_COLOUR_x]) && isnan(black[SR_COLOUR_DUV]));
}

TEST(cells_of_a_goniophotometer_share_the_sphere)
{
    struct made m = {0};
    void *self = self_of(&m, "intensity");
    *(sr_vec3 *)member(m.meter.model->params, self, "axis") = (sr_vec3){1, 2, 3};
    *(sr_vec3 *)member(m.meter.model->params, self, "facing") = (sr_vec3){3, 0, -1};
    prepare(&m);
    uint32_t planes, rows;
    m.meter.model->raster(m.meter.self, &planes, &rows);
    EXPECT(planes == 24 && rows == 37);
    enum { DRAWS = 400000, CELLS = 24 * 37 };
    static double seen[CELLS], expected[CELLS];
    double all = 0;
    for (uint32_t k = 0; k < CELLS; ++k) {
        double c, gamma, solid_angle = m.meter.model->cell(m.meter.self, k, &c, &gamma);
        EXPECT_NEAR(c, k % planes * 15.0, 1e-9);
        EXPECT_NEAR(gamma, k / planes * 5.0, 1e-9);
        bool is_pole = k / planes == 0 || k / planes == rows - 1;
        if (!is_pole || k % planes == 0)
            all += solid_angle, expected[k] = DRAWS * solid_angle / (4 * (double)SR_PI);
    }
    EXPECT_RELATIVE(all, 4 * (double)SR_PI, 1e-6);
    struct sr_rng rng = sr_rng_seed(3, 3);
    for (int i = 0; i < DRAWS; ++i)
        seen[m.meter.model->far(m.meter.self,
                                sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}))] += 1;
    EXPECT_CHI2(seen, expected, CELLS);
    // gamma 90, C 0 and C 90: seen against the axis, against the clock
    sr_vec3 axis = sr_normalize((sr_vec3){1, 2, 3}), facing = sr_normalize((sr_vec3){3, 0, -1}),
            left = sr_cross(facing, axis);
    EXPECT_EQUAL_INT(m.meter.model->far(m.meter.self, facing), 18 * planes);
    EXPECT_EQUAL_INT(m.meter.model->far(m.meter.self, left), 18 * planes + 6);
    EXPECT_EQUAL_INT(m.meter.model->far(m.meter.self, axis), 0);
    EXPECT_EQUAL_INT(m.meter.model->far(m.meter.self, sr_neg(axis)), 36 * planes);
    sr_arena_free(&m.arena);
}
