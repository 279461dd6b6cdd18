/* SPDX-License-Identifier: MIT */
/* Thin films and optical coatings: printed values, and the product of characteristic matrices in double precision,
 * which is another way to the same light. */
#include "quadrature.h"

#include "bsdf/film.h"

#include <complex.h>

struct slab {
    double n, k, d; // [1] [1] [nm]
};

/* Born & Wolf, 1.6: [B; C] = PRODUCT [[cos p, -i sin p / q], [-i q sin p, cos p]] [1; q_sub] for exp(-i omega t). */
static void characteristic_matrix(const struct slab *slabs, int count, double n0, double complex n_sub, double lambda,
                                  double c, bool p_polarised, double *R, double *T)
{
    double complex s0 = n0 * sqrt(1 - c * c), cos_sub = csqrt(1 - s0 * s0 / (n_sub * n_sub));
    if (cimag(n_sub * cos_sub) < 0)
        cos_sub = -cos_sub;
    double complex q_sub = p_polarised ? n_sub / cos_sub : n_sub * cos_sub, q0 = p_polarised ? n0 / c : n0 * c;
    double complex B = 1, C = q_sub;
    for (int j = count; j-- > 0;) {
        double complex n = slabs[j].n + I * slabs[j].k, cosine = csqrt(1 - s0 * s0 / (n * n));
        if (cimag(n * cosine) < 0)
            cosine = -cosine;
        double complex q = p_polarised ? n / cosine : n * cosine,
                       p = 2 * QUADRATURE_PI * n * slabs[j].d * cosine / lambda;
        double complex B1 = ccos(p) * B - I / q * csin(p) * C;
        C = -I * q * csin(p) * B + ccos(p) * C;
        B = B1;
    }
    double complex r = (q0 * B - C) / (q0 * B + C), t = 2 * q0 / (q0 * B + C);
    *R = creal(r * conj(r));
    *T = creal(q_sub) / creal(q0) * creal(t * conj(t));
}

static struct film_stack stack_of(const struct slab *slabs, int count, double n, double k)
{
    struct film_stack f = {
        .film_count = count, .layer_count = count, .n = SR_BLACK + (float)n, .k = SR_BLACK + (float)k};
    for (int i = 0; i < count; ++i) {
        f.films[i] = (struct film){SR_BLACK + (float)slabs[i].n, SR_BLACK + (float)slabs[i].k, (float)slabs[i].d};
        f.sequence[i] = (uint8_t)i;
    }
    return f;
}

TEST(films_match_the_characteristic_matrix)
{
    struct sr_rng rng = sr_rng_seed(21, 1);
    for (int set = 0; set < 4000; ++set) {
        struct slab slabs[6];
        int count = 1 + (int)(sr_rng_float(&rng) * 6);
        bool clear = set & 1, from_below = set & 2 && clear;
        for (int i = 0; i < count; ++i)
            slabs[i] = (struct slab){1 + 2 * (double)sr_rng_float(&rng), clear ? 0 : 0.3 * (double)sr_rng_float(&rng),
                                     300 * (double)sr_rng_float(&rng)};
        double n = 1 + 3 * (double)sr_rng_float(&rng), k = clear ? 0 : 5 * (double)sr_rng_float(&rng),
               lambda = 400 + 300 * (double)sr_rng_float(&rng), c = 0.05 + 0.9 * (double)sr_rng_float(&rng), R, T;
        struct film_stack f = stack_of(slabs, count, n, k);
        struct film_power p = film_reflect(&f, SR_BLACK + (float)lambda, (float)c, 0, from_below);
        if (from_below)
            for (int i = 0; i < count / 2; ++i) {
                struct slab swap = slabs[i];
                slabs[i] = slabs[count - 1 - i];
                slabs[count - 1 - i] = swap;
            }
        for (int polarised = 0; polarised < 2; ++polarised) {
            characteristic_matrix(slabs, count, from_below ? n : 1, from_below ? 1 : n + I * k, lambda, c, polarised,
                                  &R, &T);
            EXPECT_NEAR((polarised ? p.Rp : p.Rs)[0], R, 2e-5);
            EXPECT_NEAR((polarised ? p.Tp : p.Ts)[0], T, 2e-5 + 2e-4 * T);
            if (clear)
                EXPECT_NEAR((polarised ? p.Rp + p.Tp : p.Rs + p.Ts)[0], 1, 1e-5);
        }
    }
}

/* Three films, s and p, 550 nm, from normal to 80 deg. */
TEST(single_films_have_their_printed_reflectances)
{
    static const double theta[4] = {0, 30, 60, 80};
    static const struct {
        struct slab film;
        double n, k;
        double R[4][2];
    } rows[] = {
        {{1.33, 0, 300}, 1, 0, {{.075430, .075430}, {.091866, .036123}, {.053629, .001713}, {.035937, .009908}}},
        {{1.38, 0, 99.6377}, 1.52, 0, {{.012601, .012601}, {.020636, .007017}, {.100818, .006049}, {.449406, .243173}}},
        {{1.5, 0, 400},
         1.0152,
         6.6273,
         {{.887276, .887276}, {.921676, .897827}, {.948130, .846079}, {.959166, .905839}}},
    };
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) {
            struct film_stack f = stack_of(&rows[i].film, 1, rows[i].n, rows[i].k);
            struct film_power p = film_reflect(&f, SR_BLACK + 550, direction(theta[j], 0).z, 0, false);
            // the second angle of the metal is printed s first, from 30 deg on
            EXPECT_NEAR(p.Rs[0], rows[i].R[j][0], 1.5e-6);
            EXPECT_NEAR(p.Rp[0], rows[i].R[j][1], 1.5e-6);
        }
}

/* A quarter wave on glass, and a soap film at 45 deg, by the models as scenes use them. */
TEST(quarter_wave_and_soap_film_reflect_as_the_closed_form_says)
{
    static const double lambda[3] = {450, 550, 650};
    static const double coating[3] = {0.0162043087664, 0.0126007902146, 0.0143683479916},
                        soap[3] = {0.0999111428613, 0.0482649076976, 0.00189098238075};
    double n1 = 1.38, n2 = 1.52;
    struct sr_bsdf glass = specimen("thin_film_dielectric", "film_thickness", 99.6377, "film_eta", n1, "eta", n2, NULL);
    struct sr_bsdf bubble =
        specimen("thin_film_dielectric", "film_thickness", 300.0, "film_eta", 1.33, "eta", 1.0, NULL);
    for (int i = 0; i < 3; ++i) {
        struct sr_bsdf_sample s;
        specimen_ready(&glass, (float)lambda[i]);
        specimen_ready(&bubble, (float)lambda[i]);
        EXPECT(sr_bsdf_sample(&glass, direction(0, 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s));
        EXPECT(s.lobe == (SR_LOBE_REFLECTION | SR_LOBE_SPECULAR));
        EXPECT_RELATIVE(s.f[0] * s.wi.z, coating[i], 1e-5);
        EXPECT(sr_bsdf_sample(&bubble, direction(45, 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s));
        EXPECT_RELATIVE(s.f[0] * s.wi.z, soap[i], 1e-5);
        EXPECT(sr_bsdf_sample(&bubble, direction(45, 0), 0.9999f, (sr_vec2){0, 0}, SR_RADIANCE, &s));
        EXPECT(s.lobe == (SR_LOBE_TRANSMISSION | SR_LOBE_SPECULAR) && s.eta == 1);
        EXPECT_NEAR(s.f[0] * -s.wi.z, 1 - soap[i], 5e-7);
        EXPECT_NEAR(sr_angle_between(s.wi, sr_neg(direction(45, 0))), 0, 1e-6); // straight on
    }
    specimen_ready(&glass, 550);
    struct sr_bsdf_sample s;
    EXPECT(sr_bsdf_sample(&glass, direction(0, 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s));
    EXPECT_NEAR(s.f[0], pow((n2 - n1 * n1) / (n2 + n1 * n1), 2), 2e-8);
}

/* A quarter wave of index sqrt(n) makes glass black; half a wave is as if it were not there. */
TEST(quarter_and_half_waves)
{
    struct sr_bsdf quarter =
        specimen("thin_film_dielectric", "film_eta", 2.0, "eta", 4.0, "film_thickness", 68.75, NULL);
    struct sr_bsdf half = specimen("thin_film_dielectric", "film_eta", 2.0, "eta", 1.5, "film_thickness", 137.5, NULL);
    EXPECT_NEAR(quarter.model->albedo(quarter.data, direction(0, 0))[0], 1, 1e-6);
    struct sr_bsdf_sample s;
    if (sr_bsdf_sample(&quarter, direction(0, 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s) && s.eta == 1)
        EXPECT_NEAR(s.f[0], 0, 1e-12);
    EXPECT(sr_bsdf_sample(&half, direction(0, 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s));
    EXPECT_NEAR(s.f[0], 0.04, 1e-7);
}

/* Without thickness, films leave a bare surface: the models that have none. */
TEST(films_of_no_thickness_are_not_there)
{
    struct sr_bsdf film = specimen("thin_film_conductor", "film_thickness", 0.0, "alpha_x", 0.3, "alpha_y", 0.2, NULL);
    struct sr_bsdf none = specimen("multilayer_conductor", "layer_count", 0.0, "alpha_x", 0.3, "alpha_y", 0.2, NULL);
    struct sr_bsdf metal = specimen("conductor", "alpha_x", 0.3, "alpha_y", 0.2, NULL);
    struct sr_bsdf film_d =
        specimen("thin_film_dielectric", "film_thickness", 0.0, "alpha_x", 0.3, "alpha_y", 0.2, NULL);
    struct sr_bsdf none_d = specimen("multilayer_dielectric", "layer_count", 0.0, "alpha_x", 0.3, "alpha_y", 0.2, NULL);
    struct sr_bsdf glass = specimen("dielectric", "alpha_x", 0.3, "alpha_y", 0.2, NULL);
    struct sr_rng rng = sr_rng_seed(22, 1);
    for (int i = 0; i < 2000; ++i) {
        sr_vec3 w[2];
        for (int j = 0; j < 2; ++j)
            w[j] = direction(180 * (double)sr_rng_float(&rng), 360 * (double)sr_rng_float(&rng));
        float expected = sr_bsdf_f(&metal, w[0], w[1], SR_RADIANCE)[0];
        EXPECT_RELATIVE(sr_bsdf_f(&film, w[0], w[1], SR_RADIANCE)[0], expected, 2e-5);
        EXPECT_RELATIVE(sr_bsdf_f(&none, w[0], w[1], SR_RADIANCE)[0], expected, 2e-5);
        expected = sr_bsdf_f(&glass, w[0], w[1], SR_RADIANCE)[0];
        EXPECT_NEAR(sr_bsdf_f(&film_d, w[0], w[1], SR_RADIANCE)[0], expected, 1e-4f * expected + 1e-6f);
        EXPECT_NEAR(sr_bsdf_f(&none_d, w[0], w[1], SR_RADIANCE)[0], expected, 1e-4f * expected + 1e-6f);
    }
}

/* (HL)^3 H of 2.35 and 1.38, quarter waves at 550 nm, on glass of 1.52. */
TEST(dielectric_mirror_has_its_printed_reflectances)
{
    double H = 550 / (4 * 2.35), L = 550 / (4 * 1.38);
    struct slab slabs[7] = {{2.35, 0, H}, {1.38, 0, L}, {2.35, 0, H}, {1.38, 0, L},
                            {2.35, 0, H}, {1.38, 0, L}, {2.35, 0, H}};
    struct film_stack f = stack_of(slabs, 7, 1.52, 0);
    static const double theta[4] = {0, 30, 60, 80},
                        R[4][2] = {{.955855, .955855}, {.968879, .926670}, {.983036, .537311}, {.993032, .397242}};
    struct sr_bsdf mirror = specimen("multilayer_dielectric", "eta", 1.52, NULL); // its defaults
    for (int i = 0; i < 4; ++i) {
        struct film_power p = film_reflect(&f, SR_BLACK + 550, direction(theta[i], 0).z, 0, false);
        EXPECT_NEAR(p.Rs[0], R[i][0], 1.5e-6);
        EXPECT_NEAR(p.Rp[0], R[i][1], 1.5e-6);
        struct sr_bsdf_sample s;
        EXPECT(sr_bsdf_sample(&mirror, direction(theta[i], 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s));
        EXPECT_NEAR(s.f[0] * s.wi.z, (R[i][0] + R[i][1]) / 2, 1.5e-6);
    }
    specimen_ready(&mirror, 450);
    struct sr_bsdf_sample s;
    EXPECT(sr_bsdf_sample(&mirror, direction(0, 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s));
    EXPECT_NEAR(s.f[0], 0.589673, 1.5e-6);
}

/* Rough and clear: what a facet does not reflect it lets through, so that films only move light between the two. */
TEST(rough_clear_films_return_as_much_as_bare_glass_does)
{
    struct sr_bsdf film =
        specimen("thin_film_dielectric", "film_eta", 2.3, "film_thickness", 60.0, "alpha_x", 0.3, "alpha_y", 0.3, NULL);
    struct sr_bsdf glass = specimen("dielectric", "alpha_x", 0.3, "alpha_y", 0.3, NULL);
    for (int theta = 10; theta < 80; theta += 30) {
        double more =
            albedo_toward(&film, direction(theta, 0), 1, 96) - albedo_toward(&glass, direction(theta, 0), 1, 96);
        double less =
            albedo_toward(&glass, direction(theta, 0), -1, 160) - albedo_toward(&film, direction(theta, 0), -1, 160);
        EXPECT(more > 0.1);
        EXPECT_RELATIVE(more, less, 0.2); // what is masked on the way differs between the two sides
    }
}

static sr_status read_layers(const char *text, size_t size, struct sr_bsdf *b, struct sr_arena *arena)
{
    static char path[600];
    snprintf(path, sizeof path, "%s/layers.txt", test_folder());
    struct sr_error error = {0};
    EXPECT(sr_file_write(path, text, size, &error) == SR_OK);
    *b = specimen("multilayer_dielectric", "eta", 1.52, NULL);
    for (const struct sr_param *p = b->model->params; p->name; ++p)
        if (p->kind == SR_PARAM_FILE)
            memcpy(b->data + p->offset, &(const char *){path}, sizeof(char *));
    sr_status status = b->model->load(b->data, arena, &error);
    if (status != SR_OK)
        EXPECT(strstr(error.text, "layers.txt"));
    else
        specimen_ready(b, 550);
    return status;
}

TEST(layers_come_from_files)
{
    struct sr_arena arena = {0};
    struct sr_bsdf b;
    const char *good = "# one layer over another\n1.38 0 99.6377\n\n  2.1, 0.01, 50 # absorbs\r\n1.6 0 20";
    EXPECT(read_layers(good, strlen(good), &b, &arena) == SR_OK);
    struct slab slabs[3] = {{1.38, 0, 99.6377}, {2.1, 0.01, 50}, {1.6, 0, 20}};
    double Rs, Rp, T;
    characteristic_matrix(slabs, 3, 1, 1.52, 550, cos(QUADRATURE_PI / 6), false, &Rs, &T);
    characteristic_matrix(slabs, 3, 1, 1.52, 550, cos(QUADRATURE_PI / 6), true, &Rp, &T);
    struct sr_bsdf_sample s;
    EXPECT(sr_bsdf_sample(&b, direction(30, 0), 0, (sr_vec2){0, 0}, SR_RADIANCE, &s));
    EXPECT_NEAR(s.f[0] * s.wi.z, (Rs + Rp) / 2, 1e-6);
    EXPECT(b.model->albedo(b.data, direction(30, 0))[0] < 0.999f);

    static const char *const bad[] = {"1.5 0",    "1.5 0 100 7", "1.5 zero 100",  "1.5 0 nan",
                                      "-1 0 100", "1.5 0 1e9",   "1.5 0 100\n1\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        EXPECT(read_layers(bad[i], strlen(bad[i]), &b, &arena) == SR_ERROR_INPUT);
    EXPECT(read_layers("1.5 0 100\n\0junk", 15, &b, &arena) == SR_ERROR_INPUT);
    char many[17 * 10 + 1] = "";
    for (int i = 0; i < 17; ++i)
        strcat(many, "1.5 0 100\n");
    EXPECT(read_layers(many, strlen(many), &b, &arena) == SR_ERROR_INPUT);
    EXPECT(read_layers(many, strlen(many) - 10, &b, &arena) == SR_OK);
    sr_arena_free(&arena);
}
