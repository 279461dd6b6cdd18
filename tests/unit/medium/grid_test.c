/* SPDX-License-Identifier: MIT */
/* Dense grids and the cloud: what they have at a point, against closed forms; and what they refuse. */
#include "scenery.h"

static struct sr_slice slice(const float *values, uint32_t count)
{
    return (struct sr_slice){values, count};
}

static void *grid(const char *name, int nx, int ny, int nz)
{
    const struct sr_medium_model *model = sr_medium_model_find(name);
    void *self = scenery_medium(model);
    *(int32_t *)scenery_member(model, self, "nx") = nx;
    *(int32_t *)scenery_member(model, self, "ny") = ny;
    *(int32_t *)scenery_member(model, self, "nz") = nz;
    return self;
}
#define MEMBER(name, self, member, type) (*(type *)scenery_member(sr_medium_model_find(name), self, member))

static struct sr_medium_at look(struct sr_medium m, float x, float y, float z)
{
    struct sr_medium_at at;
    struct sr_wavelengths w = scenery_wavelengths();
    m.model->at(m.self, (sr_vec3){x, y, z}, &w, &at);
    return at;
}

TEST(linear_interpolation_is_exact_for_linear_fields_and_fades_outside)
{
    enum { NX = 7, NY = 4, NZ = 5 };
    float density[NX * NY * NZ];
    for (int z = 0; z < NZ; ++z)
        for (int y = 0; y < NY; ++y)
            for (int x = 0; x < NX; ++x)
                density[(z * NY + y) * NX + x] = 1 + 2 * (float)x + 0.5f * (float)y + 3 * (float)z;
    void *self = grid("uniformgrid", NX, NY, NZ);
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(density, NX * NY * NZ);
    MEMBER("uniformgrid", self, "p1", sr_vec3) = (sr_vec3){NX, 2 * NY, NZ};
    MEMBER("uniformgrid", self, "sigma_a", struct sr_spd) = sr_spd_constant(0.25f);
    ((struct sr_medium_common *)self)->medium_to_world = sr_transform_translate((sr_vec3){10, 0, 0});
    struct sr_medium m = scenery_prepare(sr_medium_model_find("uniformgrid"), self);
    struct sr_rng rng = sr_rng_seed(1, 1);
    for (int i = 0; i < 200; ++i) {
        float x = 0.5f + (NX - 1) * sr_rng_float(&rng), y = 1 + (2 * NY - 2) * sr_rng_float(&rng),
              z = 0.5f + (NZ - 1) * sr_rng_float(&rng);
        double d = 1 + 2 * ((double)x - 0.5) + 0.5 * ((double)y / 2 - 0.5) + 3 * ((double)z - 0.5);
        EXPECT_RELATIVE(look(m, 10 + x, y, z).sigma_a[0], 0.25 * d, 1e-5);
        EXPECT_RELATIVE(look(m, 10 + x, y, z).sigma_s[2], d, 1e-5);
    }
    EXPECT_RELATIVE(look(m, 10, 1, 0.5f).sigma_s[0], 0.5, 1e-5); // at the face: half of the first voxel
    EXPECT_RELATIVE(look(m, 10, 0, 0).sigma_s[0], 0.125, 1e-5);  // at the corner: an eighth
    EXPECT_NEAR(look(m, 9, 1, 0.5f).sigma_s[0], 0, 0);
    EXPECT_NEAR(look(m, 1e30f, 1, 0.5f).sigma_s[0], 0, 0);
}

TEST(grids_glow_by_spectrum_and_by_temperature)
{
    static const float density[2] = {1, 3}, factor[2] = {0.5f, 2}, temperature[2] = {2100, 3100};
    struct sr_wavelengths w = scenery_wavelengths();
    void *self = grid("uniformgrid", 2, 1, 1);
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(density, 2);
    MEMBER("uniformgrid", self, "Le", struct sr_spd) = sr_spd_blackbody(2500);
    MEMBER("uniformgrid", self, "Lescale", struct sr_slice) = slice(factor, 2);
    struct sr_medium m = scenery_prepare(sr_medium_model_find("uniformgrid"), self);
    EXPECT(m.model->glows(m.self));
    struct sr_spd planck = sr_spd_blackbody(2500);
    double one = (double)sr_spd_eval(&planck, w.lambda)[1] / sr_spd_luminous_integral(&planck);
    EXPECT_RELATIVE(look(m, 0.25f, 0.5f, 0.5f).Le[1], 0.5 * one, 1e-4);
    EXPECT_RELATIVE(look(m, 0.5f, 0.5f, 0.5f).Le[1], 1.25 * one, 1e-4);

    self = grid("uniformgrid", 2, 1, 1);
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(density, 2);
    MEMBER("uniformgrid", self, "Le", struct sr_spd) = sr_spd_blackbody(2500);
    m = scenery_prepare(sr_medium_model_find("uniformgrid"), self); // no Lescale: pbrt's one voxel
    EXPECT_RELATIVE(look(m, 0.25f, 0.5f, 0.5f).Le[1], 0.75 * one, 1e-4);
    self = grid("uniformgrid", 2, 1, 1);
    static const float three[1] = {3};
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(density, 2);
    MEMBER("uniformgrid", self, "Le", struct sr_spd) = sr_spd_blackbody(2500);
    MEMBER("uniformgrid", self, "Lescale", struct sr_slice) = slice(three, 1);
    m = scenery_prepare(sr_medium_model_find("uniformgrid"), self);
    EXPECT_RELATIVE(look(m, 0.01f, 0.5f, 0.9f).Le[1], 3 * one, 1e-4);

    for (int is_absolute = 0; is_absolute < 2; ++is_absolute) {
        self = grid("uniformgrid", 2, 1, 1);
        MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(density, 2);
        MEMBER("uniformgrid", self, "temperature", struct sr_slice) = slice(temperature, 2);
        MEMBER("uniformgrid", self, "Lescale", struct sr_slice) = slice(three, 1);
        MEMBER("uniformgrid", self, "temperaturecutoff", float) = 100;
        MEMBER("uniformgrid", self, "temperaturescale", float) = 2;
        ((struct sr_medium_common *)self)->is_absolute = is_absolute;
        m = scenery_prepare(sr_medium_model_find("uniformgrid"), self);
        double T = (2100 - 100) * 2, T_peak = 2.897771955e6 / T;
        double expected = sr_planck((double)w.lambda[1], T) * (is_absolute ? 683 : 1 / sr_planck(T_peak, T));
        EXPECT_RELATIVE(look(m, 0.25f, 0.5f, 0.5f).Le[1], 3 * expected, 1e-4);
    }
}

TEST(coloured_grids_interpolate_spectra)
{
    static const float sigma_a[6] = {0.1f, 0.5f, 0.9f, 3, 2, 0}, sigma_s[6] = {1, 1, 1, 0, 0, 0},
                       Le[6] = {1, 1, 1, 0, 0, 0};
    void *self = grid("rgbgrid", 1, 1, 2);
    MEMBER("rgbgrid", self, "sigma_a", struct sr_slice) = slice(sigma_a, 2);
    MEMBER("rgbgrid", self, "sigma_s", struct sr_slice) = slice(sigma_s, 2);
    MEMBER("rgbgrid", self, "Le", struct sr_slice) = slice(Le, 2);
    MEMBER("rgbgrid", self, "scale", float) = 4;
    MEMBER("rgbgrid", self, "Lescale", float) = 0.01f;
    struct sr_medium m = scenery_prepare(sr_medium_model_find("rgbgrid"), self);
    EXPECT(m.model->glows(m.self));
    struct sr_wavelengths w = scenery_wavelengths();
    struct sr_spd first = sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){0.1f, 0.5f, 0.9f}),
                  second = sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){3, 2, 0});
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        double a = (double)sr_spd_eval(&first, w.lambda)[i], b = (double)sr_spd_eval(&second, w.lambda)[i];
        EXPECT_RELATIVE(look(m, 0.5f, 0.5f, 0.25f).sigma_a[i], 4 * a, 1e-5);
        EXPECT_RELATIVE(look(m, 0.5f, 0.5f, 0.5f).sigma_a[i], 2 * (a + b), 1e-5);
        EXPECT_RELATIVE(look(m, 0.5f, 0.5f, 0.375f).sigma_s[i], 3, 2e-3);
        struct sr_spd white = {.kind = SR_SPD_TABLE, .scale = 1, .table = sr_colour_space(SR_SRGB)->illuminant};
        EXPECT_RELATIVE(look(m, 0.5f, 0.5f, 0.25f).Le[i], 0.01 * (double)sr_spd_eval(&white, w.lambda)[i], 2e-3);
    }
    self = grid("rgbgrid", 1, 1, 2);
    MEMBER("rgbgrid", self, "sigma_a", struct sr_slice) = slice(sigma_a, 2);
    MEMBER("rgbgrid", self, "scale", float) = 4;
    m = scenery_prepare(sr_medium_model_find("rgbgrid"), self);
    EXPECT_NEAR(look(m, 0.01f, 0.01f, 0.01f).sigma_s[0], 4, 1e-6); // not given: 1, everywhere
    EXPECT(!m.model->glows(m.self));
}

TEST(a_cloud_has_the_density_of_its_formula)
{
    const struct sr_medium_model *model = sr_medium_model_find("cloud");
    struct sr_rng rng = sr_rng_seed(2, 2);
    for (int wispy = 0; wispy < 2; ++wispy) {
        void *self = scenery_medium(model);
        MEMBER("cloud", self, "wispiness", float) = (float)wispy;
        MEMBER("cloud", self, "density", float) = 2;
        MEMBER("cloud", self, "frequency", float) = 4;
        struct sr_medium m = scenery_prepare(model, self);
        double sum = 0, most = 0;
        for (int i = 0; i < 400; ++i) {
            sr_vec3 p = {sr_rng_float(&rng), sr_rng_float(&rng), sr_rng_float(&rng)};
            double q[3] = {4 * (double)p.x, 4 * (double)p.y, 4 * (double)p.z}, noise = 0;
            for (int k = 0; k < 2 && wispy; ++k) {
                double f = 10 * pow(1.99, k), slope[3],
                       n = (double)sr_noise((sr_vec3){(float)(f * q[0]), (float)(f * q[1]), (float)(f * q[2])});
                for (int j = 0; j < 3; ++j)
                    slope[j] = ((double)sr_noise((sr_vec3){(float)(f * q[0] + 0.01 * (j == 0)),
                                                           (float)(f * q[1] + 0.01 * (j == 1)),
                                                           (float)(f * q[2] + 0.01 * (j == 2))}) -
                                n) /
                               0.01;
                for (int j = 0; j < 3; ++j)
                    q[j] += 0.05 / (1 + k) * slope[j];
            }
            for (int k = 0; k < 5; ++k) {
                double f = pow(1.99, k),
                       n = (double)sr_noise((sr_vec3){(float)(f * q[0]), (float)(f * q[1]), (float)(f * q[2])});
                noise += pow(0.5, k + 1) * n;
                most = fmax(most, fabs(n));
            }
            double d = fmin(1, fmax(0, 4.5 * 2 * (1 - (double)p.y) * noise)) + 2 * fmax(0, 0.5 - (double)p.y);
            d = fmin(1, fmax(0, d));
            EXPECT_NEAR(look(m, p.x, p.y, p.z).sigma_s[0], d, 2e-3);
            sum += d;
        }
        EXPECT(sum > 100 && sum < 300);
        EXPECT(most <= 1.05);
        EXPECT_NEAR(look(m, 0.3f, -0.2f, 0.8f).sigma_a[0], 1, 1e-6); // below: solid
    }
}

TEST(grids_refuse_what_makes_no_sense)
{
    static const float two[6] = {1, 2, 1, 1, 1, 1}, bad[2] = {1, -1}, nan_[2] = {NAN, 1};
    const struct sr_medium_model *u = sr_medium_model_find("uniformgrid"), *rgb = sr_medium_model_find("rgbgrid");
    EXPECT(strstr(scenery_refusal(u, grid("uniformgrid", 1, 1, 1)), "expected a parameter \"float density\""));
    void *self = grid("uniformgrid", 3, 1, 1);
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(two, 2);
    EXPECT_EQUAL_TEXT(scenery_refusal(u, self), "\"density\" has 2 values: expected nx ny nz = 3 x 1 x 1 of them");
    self = grid("uniformgrid", 0x7fffffff, 0x7fffffff, 0x7fffffff);
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(two, 2);
    EXPECT(strstr(scenery_refusal(u, self), "expected nx ny nz"));
    self = grid("uniformgrid", 65536, 65536, 2); // its product is 2^33
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(two, 0);
    EXPECT(strstr(scenery_refusal(u, self), "expected"));
    self = grid("uniformgrid", 2, 1, 1);
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(bad, 2);
    EXPECT_EQUAL_TEXT(scenery_refusal(u, self),
                      "\"density\" of voxel (1, 0, 0) is -1: expected finite values of 0 or more");
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(nan_, 2);
    EXPECT(strstr(scenery_refusal(u, self), "voxel (0, 0, 0) is"));
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(two, 2);
    MEMBER("uniformgrid", self, "temperature", struct sr_slice) = slice(two, 2);
    MEMBER("uniformgrid", self, "Le", struct sr_spd) = sr_spd_constant(1);
    EXPECT(strstr(scenery_refusal(u, self), "exclude each other"));
    self = grid("uniformgrid", 2, 1, 1);
    MEMBER("uniformgrid", self, "density", struct sr_slice) = slice(two, 2);
    MEMBER("uniformgrid", self, "p1", sr_vec3) = (sr_vec3){1, 0, 1};
    EXPECT(strstr(scenery_refusal(u, self), "span no box: its extent along y"));
    MEMBER("uniformgrid", self, "p1", sr_vec3) = (sr_vec3){1, 1, 1};
    ((struct sr_medium_common *)self)->medium_to_world.inverse[3][0] = 0.5f;
    EXPECT(strstr(scenery_refusal(u, self), "perspective"));
    self = grid("rgbgrid", 2, 1, 1);
    EXPECT(strstr(scenery_refusal(rgb, self), "\"rgb sigma_a\" or \"rgb sigma_s\""));
    MEMBER("rgbgrid", self, "sigma_s", struct sr_slice) = slice(two, 2);
    MEMBER("rgbgrid", self, "Le", struct sr_slice) = slice(two, 2);
    EXPECT(strstr(scenery_refusal(rgb, self), "needs \"rgb sigma_a\""));
}
