/* SPDX-License-Identifier: MIT */
/* RGL's tensor files: the warp against its definition, symmetries, colours, the writer. */
#include "fixtures.h"
#include "fuzz/seeds.h"
#include "measured/private.h"

static struct gloss satin = {.base = 0.4f, .lobe = 0.8f, .exponent = 60};

/* Anisotropic and reciprocal; the lobe is as symmetric as the part of the turn that a file covers says. */
static sr_spectrum brushed_f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    int part = *(const int *)user;
    sr_vec3 h = sr_normalize(sr_add(wo, wi));
    float odd = part == 1 ? 0.5f * h.x : 0, skew = part <= 2 ? 2 * h.x * h.y : 0; // even under a half turn only
    return (0.1f + expf(-(3 * h.x * h.x + 20 * h.y * h.y)) * (1 + odd + skew)) * (0.5f + lambda / 1000);
}

static void compare(const struct sr_measured *m, sr_measured_source f, void *user, double tolerance)
{
    struct sr_rng rng = sr_rng_seed(1, 1);
    for (int n = 0; n < 5000; ++n) {
        sr_vec3 wo = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        if (wo.z < 0.2f || wi.z < 0.2f)
            continue;
        double is = (double)sr_measured_f(m, wo, wi, SR_BLACK + 500)[1],
               should = (double)f(user, wo, wi, SR_BLACK + 500)[1];
        EXPECT_NEAR(is, should, tolerance * (0.1 + should));
    }
}

TEST(rgl_isotropic_file_gives_the_formula)
{
    struct bytes b = rgl_file(gloss_f, &satin, 0, false);
    struct sr_arena arena = {0};
    const struct sr_measured *m = parse(&arena, &b);
    compare(m, gloss_f, &satin, 0.04);
    EXPECT_NEAR(sr_measured_f(m, direction(20, 0), direction(-20, 0), SR_BLACK + 500)[0],
                gloss_f(&satin, direction(20, 0), direction(-20, 0), SR_BLACK + 500)[0], 0.002);
    EXPECT(sr_measured_f(m, direction(20, 0), direction(160, 0), SR_BLACK + 500)[0] == 0);
    struct sr_measured_report r;
    sr_measured_report(m, &r);
    EXPECT(r.is_isotropic && r.is_spectral && r.channels == 3 && r.lambda_min == 400 && r.lambda_max == 700);
    EXPECT_NEAR(r.theta_i_max, 85, 1e-3);
    sr_arena_free(&arena);
    drop(&b);
}

TEST(rgl_anisotropic_files_of_a_turn_a_half_and_a_quarter_give_the_formula)
{
    static int parts[3] = {1, 2, 4};
    for (int i = 0; i < 3; ++i) {
        struct bytes b = rgl_file(brushed_f, &parts[i], parts[i], false);
        struct sr_arena arena = {0};
        compare(parse(&arena, &b), brushed_f, &parts[i], 0.06);
        sr_arena_free(&arena);
        drop(&b);
    }
}

TEST(rgl_rgb_becomes_a_spectrum_of_that_colour)
{
    static struct gloss matte = {.base = 0.5f};
    struct bytes b = rgl_file(grey_gloss_f, &matte, 0, true);
    struct sr_arena arena = {0};
    const struct sr_measured *m = parse(&arena, &b);
    sr_spectrum f = sr_measured_f(m, direction(30, 0), direction(40, 90), wavelengths());
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        EXPECT_NEAR(f[i], 0.5 / PI, 0.003); // grey stays grey
    sr_arena_free(&arena);
    drop(&b);
}

/* GGX's normals with f cos / (D / 4 sigma) = F G2 / G1 + …: what make_synth_bsdf.py wrote; D and sigma by the closed
 * form. */
TEST(rgl_synthetic_metal_is_ggx)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    const struct sr_measured *m;
    EXPECT(sr_measured_read(test_reference_file("brdf/rgl_tensor/synth_metal.bsdf"), NULL, &arena, &m, &error) ==
           SR_OK);
    struct sr_rng rng = sr_rng_seed(1, 1);
    double sum = 0, difference = 0;
    for (int n = 0; n < 20000; ++n) {
        sr_vec3 wo = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        if (wo.z < 0.3f || wi.z < 0.3f)
            continue;
        sr_vec3 h = sr_normalize(sr_add(wo, wi));
        double a2 = 0.4 * 0.4, c = (double)h.z, d = (double)sr_dot(wo, h), q = c * c * (a2 - 1) + 1;
        double co = (double)wo.z, ci = (double)wi.z;
        double lo = (sqrt(1 + a2 * (1 - co * co) / (co * co)) - 1) / 2,
               li = (sqrt(1 + a2 * (1 - ci * ci) / (ci * ci)) - 1) / 2;
        double F = (0.9 + 0.1 * pow(1 - d, 5)) * (0.4 + 0.55 / (1 + exp(-(600 - 520) / 25.0)));
        double should = F * a2 / (PI * q * q) / (1 + lo + li) / (4 * co * ci);
        double is = (double)sr_measured_f(m, wo, wi, SR_BLACK + 600)[0];
        sum += should;
        difference += fabs(is - should);
    }
    EXPECT(difference / sum < 0.01);
    sr_arena_free(&arena);
}

TEST(rgl_written_from_a_formula_reads_back)
{
    char path[512];
    snprintf(path, sizeof path, "%s/satin.bsdf", test_folder());
    struct sr_error error = {0};
    struct sr_arena arena = {0};
    const struct sr_measured *m;
    struct sr_measured_rgl_grid fine = {.theta_count = 24, .resolution = 64, .lambda_count = 4};
    EXPECT(sr_measured_write_rgl(path, &fine, gloss_f, &satin, &error) == SR_OK);
    EXPECT(sr_measured_read(path, NULL, &arena, &m, &error) == SR_OK);
    compare(m, gloss_f, &satin, 0.05);
    for (int i = 0; i < 4; ++i) {
        sr_vec3 w = direction(25 * i, 10);
        EXPECT_RELATIVE(sr_measured_albedo(m, w, SR_MEASURED_REFLECTION, SR_BLACK + 600, 96)[0],
                        albedo_by_quadrature(gloss_f, &satin, w, 600), 0.015);
    }
    EXPECT(sr_measured_write_rgl(path, &(struct sr_measured_rgl_grid){.theta_count = 1}, gloss_f, &satin, &error) ==
           SR_ERROR_USAGE);
    remove(path);
    sr_arena_free(&arena);
}

/* Mueller matrices whose intensity is known; the rest of them is not read. */
TEST(polarised_file_gives_its_intensity)
{
    enum { P = 9, D = 10, H = 12, W = 2 };
    static float phi[P], theta_d[D], theta_h[H], M[P * D * H * W * 16];
    static const uint16_t nm[W] = {450, 650};
    for (int i = 0; i < P; ++i)
        phi[i] = (float)(2 * PI * i / (P - 1) - PI);
    for (int i = 0; i < D; ++i)
        theta_d[i] = (float)(PI / 2 * i / (D - 1));
    for (int i = 0; i < H; ++i)
        theta_h[i] = (float)(PI / 2 * i / (H - 1));
    for (int i = 0; i < P * D * H * W * 16; ++i) {
        int w = i / 16 % W, h = i / 16 / W % H, d = i / 16 / W / H % D;
        M[i] = i % 16 ? NAN : (float)((1 + w) * (0.1 + 0.2 * h / (H - 1.0) + 0.3 * d / (D - 1.0)));
    }
    M[0] = NAN; // below the horizon
    M[16] = -1;
    struct tensor fields[] = {{"phi_d", 10, 2, phi, {1, P}},
                              {"theta_d", 10, 2, theta_d, {1, D}},
                              {"theta_h", 10, 2, theta_h, {1, H}},
                              {"wvls", 3, 1, nm, {W}},
                              {"M", 10, 6, M, {P, D, H, W, 4, 4}}};
    struct sr_arena arena = {0};
    struct bytes b = tensor_file(fields, 5);
    const struct sr_measured *m = parse(&arena, &b);
    // both at 30 deg on opposite sides: h is the normal, theta_d = 30 deg
    EXPECT_NEAR(sr_measured_f(m, direction(30, 0), direction(30, 180), SR_BLACK + 550)[0], 1.5 * (0.1 + 0.3 / 3), 1e-4);
    // wi = wo at 45 deg: theta_h = 45 deg, theta_d = 0
    EXPECT_NEAR(sr_measured_f(m, direction(45, 20), direction(45, 20), SR_BLACK + 450)[0], 0.1 + 0.2 / 2, 1e-3);
    struct sr_measured_report r;
    sr_measured_report(m, &r);
    EXPECT_EQUAL_INT(r.invalid, 2);
    for (int i = 0; i < 3; ++i)
        fields[i].shape[0] = 0; // without angles: even ones, which these are
    struct bytes silent = tensor_file(fields, 5);
    const struct sr_measured *same = parse(&arena, &silent);
    EXPECT_NEAR(sr_measured_f(same, direction(45, 20), direction(20, 70), SR_BLACK + 450)[0],
                sr_measured_f(m, direction(45, 20), direction(20, 70), SR_BLACK + 450)[0], 1e-6);
    sr_measured_report(same, &r);
    EXPECT(strstr(r.note, "names no angles"));
    sr_arena_free(&arena);
    drop(&b);
    drop(&silent);
}

/* The part of a turn is told as it is, also where it is too small for its inverse to be an int. */
TEST(rgl_angles_that_cover_another_part_of_a_turn_are_refused)
{
    static const struct {
        float reach;
        const char *part;
    } cases[] = {{1.05f, "1/3 of"}, {0.3f, "1/10 of"}, {1e-9f, "1/3141592"}, {1e-30f, "1/3141592"}};
    static struct seed seed;
    static const float turn[3] = {-3.14f, 0, 3.14f};
    for (int i = 0; i < 4; ++i) {
        seed_make(SEED_RGL_RGB, &seed);
        size_t phi = 0;
        while (phi + sizeof turn <= seed.size && memcmp(seed.data + phi, turn, sizeof turn) != 0)
            ++phi;
        EXPECT(phi + sizeof turn <= seed.size);
        memcpy(seed.data + phi, (float[3]){-cases[i].reach, 0, cases[i].reach}, sizeof turn);
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        struct sr_measured *m;
        EXPECT_EQUAL_INT(measured_load("file", seed.data, seed.size, NULL, &arena, &m, &error), SR_ERROR_INPUT);
        if (!strstr(error.text, "phi_i") || !strstr(error.text, cases[i].part))
            test_fail(__FILE__, __LINE__, "%g rad: %s", (double)cases[i].reach, error.text);
        sr_arena_free(&arena);
    }
}
