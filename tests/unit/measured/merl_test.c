/* SPDX-License-Identifier: MIT */
/* MERL files, written from formulas and read back. */
#include "fixtures.h"

static struct gloss satin = {.base = 0.4f, .lobe = 0.8f, .exponent = 60};

static struct bytes written; // of satin; 35 MB, made once
static const struct sr_measured *satin_file(void)
{
    static struct sr_arena arena;
    static const struct sr_measured *m;
    if (m)
        return m;
    char path[512];
    snprintf(path, sizeof path, "%s/satin.binary", test_folder());
    struct sr_error error = {0};
    EXPECT(sr_measured_write_merl(path, gloss_f, &satin, &error) == SR_OK);
    char *data;
    EXPECT(sr_file_read(path, 1u << 30, &data, &written.size, &error) == SR_OK);
    written.data = data;
    written.room = written.size;
    EXPECT_EQUAL_INT(written.size, 34992012); // as the published ones
    remove(path);
    return m = parse(&arena, &written);
}

/* The cells are half a degree wide in phi_d, one in theta_d and i/45 in theta_h: linear interpolation of h_z^60 is off
 * by less than step^2 / 8 times the second derivative, 1 % of its height where it is steep, and the colour of the base
 * by the uplift of a smooth spectrum. */
TEST(merl_written_from_a_formula_reads_back_within_interpolation)
{
    const struct sr_measured *m = satin_file();
    struct sr_rng rng = sr_rng_seed(1, 1);
    for (int n = 0; n < 20000; ++n) {
        sr_vec3 wo = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_spectrum lambda = SR_BLACK + 550, is = sr_measured_f(m, wo, wi, lambda),
                    should = gloss_f(&satin, wo, wi, lambda);
        EXPECT_NEAR(is[0], should[0], 0.01f * 0.8f + 0.01f);
    }
}

TEST(merl_albedo_is_that_of_the_formula)
{
    const struct sr_measured *m = satin_file();
    static const double theta[] = {0, 20, 45, 60, 75};
    for (int i = 0; i < 5; ++i) {
        sr_vec3 w = direction(theta[i], 30);
        double is = (double)sr_measured_albedo(m, w, SR_MEASURED_REFLECTION, SR_BLACK + 550, 96)[0];
        EXPECT_RELATIVE(is, albedo_by_quadrature(gloss_f, &satin, w, 550), 0.01);
        EXPECT_RELATIVE(is, albedo_by_quadrature(measured_f, &m, w, 550), 0.002); // the same f, another quadrature
    }
}

TEST(merl_keeps_spectra_as_colours)
{
    const struct sr_measured *m = satin_file();
    sr_vec3 wo = direction(10, 0), wi = direction(50, 100);
    sr_spectrum lambda = wavelengths(), is = sr_measured_f(m, wo, wi, lambda), should = gloss_f(&satin, wo, wi, lambda);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        EXPECT_RELATIVE(is[i], should[i], 0.06); // a smooth spectrum of that colour
    EXPECT(is[SR_LAMBDA_COUNT - 1] > 1.3f * is[0]);
}

TEST(merl_markers_take_no_part_and_are_counted)
{
    satin_file();
    struct bytes b = {0};
    put(&b, written.data, written.size);
    struct sr_rng rng = sr_rng_seed(3, 1);
    uint64_t cells = 90 * 90 * 180;
    for (int n = 0; n < 50000; ++n) {
        double v = -1;
        uint64_t cell = sr_rng_u32(&rng) % cells;
        memcpy(b.data + 12 + 8 * (cell + cells * (sr_rng_u32(&rng) % 3)), &v, 8);
    }
    struct sr_arena arena = {0};
    const struct sr_measured *m = parse(&arena, &b), *whole = satin_file();
    double worst = 0;
    for (int n = 0; n < 20000; ++n) { // a cell in thirty is missing: its neighbours stand in for it
        sr_vec3 wo = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        double a = (double)sr_measured_f(m, wo, wi, SR_BLACK + 550)[0],
               c = (double)sr_measured_f(whole, wo, wi, SR_BLACK + 550)[0];
        worst = fmax(worst, fabs(a - c) / c);
    }
    EXPECT(worst > 0 && worst < 0.2);
    struct sr_measured_report r, r_whole;
    sr_measured_report(m, &r);
    sr_measured_report(whole, &r_whole);
    EXPECT(r.invalid > r_whole.invalid + 3 * 20000 && r.coverage < 0.98 && r_whole.coverage > 0.999);
    EXPECT(r_whole.reciprocity_max < 1e-3); // by the format
    sr_arena_free(&arena);
    drop(&b);
}

TEST(merl_that_is_damaged_is_refused_with_the_place)
{
    satin_file();
    struct bytes b = {0};
    put(&b, written.data, written.size);
    double nan = NAN;
    memcpy(b.data + 12 + 8 * 1000, &nan, 8);
    expect_refused(&b, "byte 8012");
    b.size -= 1;
    expect_refused(&b, "34992011 bytes");
    b.size = 12;
    expect_refused(&b, "12 bytes");
    memcpy(b.data, &(int32_t){4096}, 4);
    memcpy(b.data + 4, &(int32_t){4096}, 4);
    memcpy(b.data + 8, &(int32_t){4096}, 4);
    expect_refused(&b, "bytes long"); // and asks for no memory
    drop(&b);
}
