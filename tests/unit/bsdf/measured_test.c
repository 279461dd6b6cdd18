/* SPDX-License-Identifier: MIT */
/* The model over a file of measured data: parameters, both transport modes, draws. */
#include "bsdf/bsdf.h"
#include "test.h"

/* f = 1/10 (2 + cos_theta_i) / sr: not reciprocal, so that the modes differ */
static const char *write_table(void)
{
    static char path[512];
    static char text[65536];
    size_t n = 0;
    snprintf(path, sizeof path, "%s/measured.txt", test_folder());
    for (int i = 0; i <= 90; i += 10)
        for (int o = 0; o <= 90; o += 10)
            for (int p = 0; p <= 180; p += 90)
                n += (size_t)snprintf(text + n, sizeof text - n, "%d 0 %d %d %.6f\n", i, o, p,
                                      0.1 * (2 + cos(i * 3.14159265 / 180)));
    struct sr_error error = {0};
    EXPECT(sr_file_write(path, text, n, &error) == SR_OK);
    return path;
}

static void set(struct sr_bsdf *b, const char *name, const void *value, size_t size)
{
    for (const struct sr_param *p = b->model->params; p->name; ++p)
        if (strcmp(p->name, name) == 0) {
            memcpy(b->data + p->offset, value, size);
            return;
        }
    test_fail(__FILE__, __LINE__, "no parameter %s", name);
}

static struct sr_bsdf load(struct sr_arena *arena, const char *path, int32_t quantity)
{
    struct sr_bsdf b = {.model = &sr_bsdf_measured};
    struct sr_error error = {0};
    set(&b, "filename", &path, sizeof path);
    set(&b, "quantity", &quantity, sizeof quantity);
    if (b.model->load(b.data, arena, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    b.model->ready(b.data, &(struct sr_bsdf_at){.lambda = SR_BLACK + 550});
    return b;
}

TEST(measured_material_evaluates_and_draws_its_file)
{
    struct sr_arena arena = {0};
    const char *path = write_table();
    struct sr_bsdf b = load(&arena, path, 0), factor = load(&arena, path, 3);
    sr_vec3 wo = {0.6f, 0, 0.8f}, wi = {0, 0, 1};
    EXPECT_EQUAL_INT(sr_bsdf_lobes(&b), SR_LOBE_REFLECTION | SR_LOBE_GLOSSY);
    EXPECT_NEAR(sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0], 0.3, 1e-5);
    EXPECT_NEAR(sr_bsdf_f(&b, wo, wi, SR_IMPORTANCE)[0], 0.28, 1e-3); // light arrives from wo
    EXPECT_NEAR(sr_bsdf_f(&factor, wo, wi, SR_RADIANCE)[0], 0.3 * 0.3183098862, 1e-5);
    struct sr_rng rng = sr_rng_seed(1, 1);
    struct sr_tally tally = {0};
    for (int n = 0; n < 20000; ++n) {
        struct sr_bsdf_sample s;
        float u = sr_rng_float(&rng);
        sr_vec2 v = {sr_rng_float(&rng), sr_rng_float(&rng)};
        bool drawn = sr_bsdf_sample(&b, wo, u, v, SR_RADIANCE, &s);
        sr_tally_add(&tally, drawn ? (double)(s.f[0] * s.wi.z / s.pdf) : 0);
        if (drawn)
            EXPECT_RELATIVE(s.pdf, sr_bsdf_pdf(&b, wo, s.wi, SR_RADIANCE), 0);
    }
    // INTEGRAL of (2 + c) c / 10 over the hemisphere = pi/5 + 2 pi / 30; the table's chords lie lower by 0.0013 of the
    // second
    double expected = 3.14159265 * (0.2 + (1 - 0.0013 * 1.5) / 15);
    EXPECT_NEAR(tally.mean, expected, 4.9 * sr_tally_standard_error(&tally) + 5e-4);
    sr_arena_free(&arena);
    remove(path);
}

TEST(measured_material_without_a_file_says_so)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_bsdf b = {.model = &sr_bsdf_measured};
    EXPECT(b.model->load(b.data, &arena, &error) == SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "filename"));
    sr_arena_free(&arena);
}
