/* SPDX-License-Identifier: MIT */
/* Coated surfaces: closed forms, and fast paths against the general random walk. */
#include "bsdf/bsdf.h"
#include "test.h"

static sr_vec3 direction(double theta_deg, double phi_deg)
{
    double t = theta_deg * 3.14159265358979324 / 180, p = phi_deg * 3.14159265358979324 / 180;
    return (sr_vec3){(float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)cos(t)};
}
static struct sr_bsdf_coated lacquer(float rho, float alpha, float eta, float thickness, int max_depth)
{
    return (struct sr_bsdf_coated){.base_reflectance = SR_BLACK + rho,
                                   .coat_ggx = {alpha, alpha},
                                   .coat_eta = eta,
                                   .thickness = thickness,
                                   .max_depth = max_depth,
                                   .sample_count = 1};
}
static struct sr_bsdf bsdf_of(const struct sr_bsdf_model *model, struct sr_bsdf_coated c)
{
    struct sr_bsdf b = {.model = model};
    memcpy(b.data, &c, sizeof c);
    return b;
}
static double matte_albedo(const struct sr_bsdf *b, sr_vec3 wo)
{
    double x[256], w[256], sum = 0;
    sr_gauss_legendre(256, 0, 1, x, w);
    for (int i = 0; i < 256; ++i) // c = v^2: the square root at grazing becomes smooth
        sum += w[i] * 4 * x[i] * x[i] * x[i] * 3.14159265358979324 *
               (double)sr_bsdf_f(b, wo, direction(acos(x[i] * x[i]) * 180 / 3.14159265358979324, 77), SR_RADIANCE)[0];
    return sum;
}

/* F + (1 - F) rho (1 - r_i) / (1 - rho r_i): Saunderson 1942, Elias & Simonot 2001; n = 1.5, rho = 1/2. */
TEST(smooth_coat_over_lambert_is_saundersons)
{
    static const double theta[4] = {0, 30, 60, 80}, expected[4] = {0.316070886659, 0.317156, 0.351112787571, 0.563785};
    struct sr_bsdf b = bsdf_of(&sr_bsdf_coated_diffuse, lacquer(0.5f, 0, 1.5f, 0, 2000));
    for (int i = 0; i < 4; ++i) {
        sr_vec3 wo = direction(theta[i], 0);
        EXPECT_NEAR(sr_fresnel_dielectric(wo.z, 1.5f) + (float)matte_albedo(&b, wo), expected[i], 2e-6);
        EXPECT_NEAR(b.model->albedo(b.data, wo)[0], expected[i], 2e-6);
    }
}

/* f(depth 3) / f(depth 1) = 1 + rho Fi: what the coat returns to the base, against Walsh's closed form. */
TEST(inner_reflectance_of_a_clear_coat_is_walshs)
{
    static const float eta[] = {0.6f, 0.9f, 1.1f, 1.33f, 1.5f, 2, 2.8f};
    for (int i = 0; i < 7; ++i) {
        struct sr_bsdf one = bsdf_of(&sr_bsdf_coated_diffuse, lacquer(0.8f, 0, eta[i], 0, 1));
        struct sr_bsdf two = bsdf_of(&sr_bsdf_coated_diffuse, lacquer(0.8f, 0, eta[i], 0, 3));
        sr_vec3 wo = direction(20, 0), wi = direction(30, 50);
        double Fi =
            (sr_bsdf_f(&two, wo, wi, SR_RADIANCE)[0] / (double)sr_bsdf_f(&one, wo, wi, SR_RADIANCE)[0] - 1) / 0.8;
        EXPECT_NEAR(Fi, sr_fresnel_diffuse(1 / (double)eta[i]), 3e-6);
    }
}
/* The same with a medium that absorbs: 2 INTEGRAL F(c) exp(-2 d / c) c dc by fine quadrature. */
TEST(inner_reflectance_of_a_tinted_coat_is_the_integral)
{
    static const float eta[] = {0.7f, 1.3f, 1.5f, 2.5f}, depth[] = {0.001f, 0.01f, 0.1f, 0.5f, 2};
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 5; ++j) {
            struct sr_bsdf one = bsdf_of(&sr_bsdf_coated_diffuse, lacquer(1, 0, eta[i], depth[j], 1));
            struct sr_bsdf two = bsdf_of(&sr_bsdf_coated_diffuse, lacquer(1, 0, eta[i], depth[j], 3));
            sr_vec3 wo = direction(20, 0), wi = direction(30, 50);
            double Fi = sr_bsdf_f(&two, wo, wi, SR_RADIANCE)[0] / (double)sr_bsdf_f(&one, wo, wi, SR_RADIANCE)[0] - 1,
                   sum = 0;
            int n = 20000;
            for (int k = 0; k < n; ++k) {
                double c = (k + 0.5) / n;
                sum += 2 * c * (double)sr_fresnel_dielectric((float)-c, eta[i]) * exp(-2 * (double)depth[j] / c) / n;
            }
            EXPECT_NEAR(Fi, sum, 1e-5);
        }
}

static struct sr_tally mean_f(struct sr_bsdf_coated c, const struct sr_bsdf_model *model, sr_vec3 wo, sr_vec3 wi, int n)
{
    struct sr_tally t = {0};
    struct sr_bsdf b = {.model = model};
    for (int i = 0; i < n; ++i) {
        c.seed = (uint32_t)i;
        memcpy(b.data, &c, sizeof c);
        sr_tally_add(&t, (double)sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0]);
    }
    return t;
}
/* A medium that scatters a 1e-30th is one that absorbs; but it takes the general walk, with free flights and joints. */
TEST(closed_form_of_a_smooth_coat_is_the_mean_of_walks)
{
    static const struct {
        float rho, eta, thickness;
        int max_depth;
    } rows[] = {{0.9f, 1.5f, 0.01f, 10},
                {0.5f, 1.8f, 0.3f, 4},
                {0.9f, 0.8f, 0.1f, 10},
                {1, 2.5f, 0.02f, 7},
                {0.7f, 1.33f, 1, 1}};
    for (int i = 0; i < 5; ++i) {
        struct sr_bsdf_coated c = lacquer(rows[i].rho, 0, rows[i].eta, rows[i].thickness, rows[i].max_depth);
        sr_vec3 wo = direction(35, 0), wi = direction(25, 110);
        struct sr_bsdf b = bsdf_of(&sr_bsdf_coated_diffuse, c);
        c.albedo = SR_BLACK + 1e-30f;
        struct sr_tally walk = mean_f(c, &sr_bsdf_coated_diffuse, wo, wi, 100000);
        EXPECT_MEAN(walk, sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0]);
    }
}
TEST(fast_product_of_a_rough_coat_has_the_mean_of_walks)
{
    static const struct {
        float rho, alpha, eta, thickness;
        int max_depth;
    } rows[] = {{0.9f, 0.3f, 1.5f, 0.01f, 10},
                {1, 0.1f, 2, 0.1f, 6},
                {0.6f, 0.8f, 1.3f, 0.2f, 20},
                {0.8f, 0.4f, 0.8f, 0.05f, 5}};
    for (int i = 0; i < 4; ++i)
        for (int grazing = 0; grazing < 2; ++grazing) {
            struct sr_bsdf_coated c =
                lacquer(rows[i].rho, rows[i].alpha, rows[i].eta, rows[i].thickness, rows[i].max_depth);
            sr_vec3 wo = direction(grazing ? 75 : 35, 0), wi = direction(45, 110);
            struct sr_tally fast = mean_f(c, &sr_bsdf_coated_diffuse, wo, wi, 100000);
            c.albedo = SR_BLACK + 1e-30f;
            struct sr_tally walk = mean_f(c, &sr_bsdf_coated_diffuse, wo, wi, 100000);
            double error = hypot(sr_tally_standard_error(&fast), sr_tally_standard_error(&walk));
            EXPECT_NEAR(fast.mean, walk.mean, 4.9 * error);
            EXPECT(error < 0.01 * walk.mean);
        }
}

/* The bias that weighs_as_pbrt is there to reproduce: at alpha 0.3 and n = 1.5 the base looks 8 % too bright. */
TEST(weights_of_pbrt_do_not_sum_to_one)
{
    struct sr_bsdf_coated c = lacquer(0.5f, 0.3f, 1.5f, 0.01f, 10), black = c;
    sr_vec3 wo = direction(35, 0), wi = direction(40, 110);
    struct sr_tally ours = mean_f(c, &sr_bsdf_coated_diffuse, wo, wi, 100000);
    c.weighs_as_pbrt = true;
    struct sr_tally theirs = mean_f(c, &sr_bsdf_coated_diffuse, wo, wi, 100000);
    black.base_reflectance = SR_BLACK;
    double coat = mean_f(black, &sr_bsdf_coated_diffuse, wo, wi, 100).mean;
    EXPECT_NEAR((theirs.mean - coat) / (ours.mean - coat), 1.08, 0.03);
}

/* Both smooth, nothing between: a mirror with the series F + T^2 Fc / (1 - F Fc), each crossing of the metal's light.
 */
TEST(mirror_under_glass_is_a_series_of_bounces)
{
    struct sr_bsdf_coated c = {
        .base_eta = SR_BLACK + 0.3f, .base_k = SR_BLACK + 2, .coat_eta = 1.5f, .max_depth = 100, .sample_count = 1};
    struct sr_bsdf b = bsdf_of(&sr_bsdf_coated_conductor, c);
    EXPECT_EQUAL_INT(sr_bsdf_lobes(&b), SR_LOBE_REFLECTION | SR_LOBE_SPECULAR);
    sr_vec3 wo = direction(50, 0);
    struct sr_rng rng = sr_rng_seed(5, 6);
    struct sr_tally E = {0};
    for (int i = 0; i < 50000; ++i) {
        struct sr_bsdf_sample s;
        if (sr_bsdf_sample(&b, wo, sr_rng_float(&rng), (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, SR_RADIANCE,
                           &s)) {
            EXPECT(s.lobe & SR_LOBE_SPECULAR);
            EXPECT_NEAR(s.wi.x, -wo.x, 1e-5);
            sr_tally_add(&E, (double)(s.f[0] * s.wi.z / s.pdf));
        } else
            sr_tally_add(&E, 0);
    }
    double F = (double)sr_fresnel_dielectric(wo.z, 1.5f), ct = sqrt(1 - sr_sqr(wo.x) / 2.25);
    double Fc = (double)sr_fresnel_conductor((float)ct, c.base_eta, c.base_k)[0];
    EXPECT_MEAN(E, F + (1 - F) * (1 - F) * Fc / (1 - F * Fc));
}

/* Without a coat that refracts (eta = 1) and without a medium, the base is all there is. */
TEST(coat_of_index_one_is_no_coat)
{
    struct sr_bsdf_coated c = lacquer(0.7f, 0, 1, 0, 10);
    c.base_eta = SR_BLACK + 0.2f;
    c.base_k = SR_BLACK + 3;
    c.base_ggx = (struct sr_ggx){0.3f, 0.5f};
    struct sr_bsdf coated = bsdf_of(&sr_bsdf_coated_conductor, c), matte = bsdf_of(&sr_bsdf_coated_diffuse, c),
                   bare = {.model = &sr_bsdf_conductor};
    struct sr_bsdf_conductor metal = {c.base_eta, c.base_k, c.base_ggx};
    memcpy(bare.data, &metal, sizeof metal);
    sr_vec3 wo = direction(35, 0), wi = direction(45, 170);
    EXPECT_RELATIVE(sr_bsdf_f(&coated, wo, wi, SR_RADIANCE)[0], sr_bsdf_f(&bare, wo, wi, SR_RADIANCE)[0], 1e-5);
    EXPECT_RELATIVE(sr_bsdf_f(&matte, wo, wi, SR_RADIANCE)[0], 0.7 / 3.14159265, 1e-5);
    EXPECT_RELATIVE(sr_bsdf_f(&coated, sr_neg(wo), sr_neg(wi), SR_RADIANCE)[0],
                    sr_bsdf_f(&bare, wo, wi, SR_RADIANCE)[0], 1e-5);
}
