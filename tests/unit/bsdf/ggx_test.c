/* SPDX-License-Identifier: MIT */
/* Rough surfaces against published and independently computed reflectances. */
#include "bsdf/bsdf.h"
#include "test.h"

static sr_vec3 direction(double theta_deg, double phi_deg)
{
    double t = theta_deg * 3.14159265358979324 / 180, p = phi_deg * 3.14159265358979324 / 180;
    return (sr_vec3){(float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)cos(t)};
}

/* INTEGRAL g(wi) dwi over the hemisphere z > 0 (side 1) or z < 0 (side -1). Gauss-Legendre in theta, trapezoid in phi.
 */
static double hemisphere(double (*g)(void *, sr_vec3), void *context, int side, int n)
{
    static double x[512], w[512];
    sr_gauss_legendre(n, 0, 3.14159265358979324 / 2, x, w);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            sr_vec3 wi = direction(x[i] * 180 / 3.14159265358979324, (j + 0.5) * 180 / n);
            wi.z *= (float)side;
            sum += g(context, wi) * w[i] * sin(x[i]) * 3.14159265358979324 / n;
        }
    return sum;
}

struct query {
    struct sr_bsdf bsdf;
    struct sr_ggx ggx;
    sr_vec3 wo;
};
static double f_cos(void *context, sr_vec3 wi)
{
    struct query *q = context;
    return (double)(sr_bsdf_f(&q->bsdf, q->wo, wi, SR_IMPORTANCE)[0] * fabsf(wi.z));
}
static double visible(void *context, sr_vec3 m)
{
    struct query *q = context;
    return (double)sr_ggx_visible_pdf(q->ggx, q->wo, m);
}
static double projected(void *context, sr_vec3 m)
{
    struct query *q = context;
    return (double)(sr_ggx_D(q->ggx, m) * m.z);
}

static struct query white_metal(float ax, float ay, double theta, double phi)
{
    struct query q = {.bsdf.model = &sr_bsdf_conductor, .ggx = {ax, ay}, .wo = direction(theta, phi)};
    *(struct sr_bsdf_conductor *)q.bsdf.data = (struct sr_bsdf_conductor){SR_BLACK, SR_ONE, q.ggx}; // eta = 0: F = 1
    return q;
}

TEST(ggx_facets_cover_the_surface_once)
{
    struct query q = white_metal(0.3f, 0.6f, 60, 40);
    EXPECT_NEAR(hemisphere(projected, &q, 1, 200), 1, 1e-5); // INTEGRAL D cos = 1
    EXPECT_NEAR(hemisphere(visible, &q, 1, 200), 1, 1e-5);   // so do those that wo sees
}

TEST(ggx_masking_is_that_of_smith)
{
    struct sr_ggx g = {0.3f, 0.3f};
    sr_vec3 wo = direction(60, 0), wi = direction(75, 100);
    double t2o = 0.09 * 3, t2i = 0.09 * pow(tan(75 * 3.14159265358979 / 180), 2);
    double lo = (sqrt(1 + t2o) - 1) / 2, li = (sqrt(1 + t2i) - 1) / 2;
    EXPECT_NEAR(sr_ggx_G1(g, wo), 1 / (1 + lo), 1e-6);
    EXPECT_NEAR(sr_ggx_G(g, wo, wi), 1 / (1 + lo + li), 1e-6);
    EXPECT(sr_ggx_is_smooth((struct sr_ggx){0.0009f, 0.0009f}) && !sr_ggx_is_smooth((struct sr_ggx){0, 0.001f}));
    EXPECT_NEAR(sr_ggx_roughness_to_alpha(0.25f), 0.5, 1e-7);
}

/* alpha = 0.3, F = 1, height-correlated Smith: directional albedo by two independent quadratures in double. */
TEST(ggx_reflects_what_quadrature_in_double_says)
{
    static const double expected[4] = {0.877358415789, 0.863872895533, 0.821711003151, 0.848232379451};
    static const double theta[4] = {0, 30, 60, 80};
    for (int i = 0; i < 4; ++i) {
        struct query q = white_metal(0.3f, 0.3f, theta[i], 20);
        EXPECT_NEAR(hemisphere(f_cos, &q, 1, 200), expected[i], 1e-5);
    }
    struct query q = white_metal(1, 1, 0, 0);
    EXPECT_NEAR(hemisphere(f_cos, &q, 1, 200), 1 - log(2), 1e-5); // closed form
}
TEST(ggx_anisotropic_reflects_what_quadrature_in_double_says)
{
    static const double expected[3][2] = {{0.861860, 0.801311}, {0.835280, 0.884000}, {0.838413, 0.860780}};
    static const double phi[3] = {0, 90, 45};
    for (int i = 0; i < 3; ++i) {
        struct query q = white_metal(0.1f, 0.4f, 60, phi[i]);
        EXPECT_NEAR(hemisphere(f_cos, &q, 1, 250), expected[i][0], 1e-5);
        q = white_metal(0.1f, 0.4f, 80, phi[i]);
        EXPECT_NEAR(hemisphere(f_cos, &q, 1, 400), expected[i][1], 5e-5);
    }
}

/* n = 1.5, alpha = 0.3 and 0.5, from outside and inside: shares reflected and transmitted, by quadrature in double. */
TEST(rough_glass_reflects_and_transmits_what_quadrature_in_double_says)
{
    static const struct {
        float alpha;
        int side;
        double theta, R, T;
    } rows[] = {
        {0.3f, 1, 0, 0.035597, 0.952793},  {0.3f, 1, 60, 0.060983, 0.887517},  {0.5f, 1, 30, 0.029831, 0.924850},
        {0.3f, -1, 0, 0.048744, 0.850745}, {0.3f, -1, 60, 0.653744, 0.131079}, {0.5f, -1, 80, 0.598924, 0.069992},
    };
    for (int i = 0; i < 6; ++i) {
        struct query q = {.bsdf.model = &sr_bsdf_dielectric, .wo = direction(rows[i].theta, 30)};
        q.wo.z *= (float)rows[i].side;
        *(struct sr_bsdf_dielectric *)q.bsdf.data = (struct sr_bsdf_dielectric){1.5f, {rows[i].alpha, rows[i].alpha}};
        EXPECT_NEAR(hemisphere(f_cos, &q, rows[i].side, 200), rows[i].R, 1e-4);
        EXPECT_NEAR(hemisphere(f_cos, &q, -rows[i].side, 400), rows[i].T, 1e-3); // a kink where total reflection begins

        // the same by the sampler, on a lattice of 3 dimensions (Roberts 2018)
        double share[2] = {0, 0};
        const int n = 1 << 20;
        for (int k = 1; k <= n; ++k) {
            double a = k * 0.8191725133961645, b = k * 0.6710436067037893, c = k * 0.5497004779019703;
            struct sr_bsdf_sample s;
            if (sr_bsdf_sample(&q.bsdf, q.wo, (float)(a - floor(a)) * SR_ONE_MINUS_EPSILON,
                               (sr_vec2){(float)(b - floor(b)) * SR_ONE_MINUS_EPSILON,
                                         (float)(c - floor(c)) * SR_ONE_MINUS_EPSILON},
                               SR_IMPORTANCE, &s))
                share[!!(s.lobe & SR_LOBE_TRANSMISSION)] += (double)(s.f[0] * fabsf(s.wi.z) / s.pdf) / n;
        }
        EXPECT_NEAR(share[0], rows[i].R, 1.5e-4);
        EXPECT_NEAR(share[1], rows[i].T, 1.5e-4);
    }
}

/* Radiance is n^2 times denser in glass: f(a, b) / n_a^2 = f(b, a) / n_b^2, and importance is not compressed. */
TEST(rough_glass_compresses_radiance_by_eta_squared)
{
    struct sr_bsdf b = {.model = &sr_bsdf_dielectric};
    *(struct sr_bsdf_dielectric *)b.data = (struct sr_bsdf_dielectric){1.5f, {0.4f, 0.2f}};
    sr_vec3 out = direction(40, 10), in = direction(160, 215);
    float into = sr_bsdf_f(&b, out, in, SR_RADIANCE)[0], out_of = sr_bsdf_f(&b, in, out, SR_RADIANCE)[0];
    EXPECT(into > 0);
    EXPECT_RELATIVE(out_of / (1.5f * 1.5f), into, 1e-5);
    EXPECT_RELATIVE(sr_bsdf_f(&b, out, in, SR_IMPORTANCE)[0], into * 2.25f, 1e-5);
    EXPECT_RELATIVE(sr_bsdf_f(&b, in, out, SR_IMPORTANCE)[0], into, 1e-5);
}

/* Smooth glass loses nothing: each weight is 1 in the form for importance, 1/eta^2 or eta^2 for radiance. */
TEST(smooth_glass_keeps_every_photon)
{
    struct sr_bsdf b = {.model = &sr_bsdf_dielectric};
    *(struct sr_bsdf_dielectric *)b.data = (struct sr_bsdf_dielectric){1.5f, {0, 0}};
    struct sr_rng rng = sr_rng_seed(3, 4);
    for (int i = 0; i < 1000; ++i) {
        sr_vec3 wo = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        struct sr_bsdf_sample s, r;
        float u = sr_rng_float(&rng);
        EXPECT(sr_bsdf_sample(&b, wo, u, (sr_vec2){0, 0}, SR_IMPORTANCE, &s));
        EXPECT(sr_bsdf_sample(&b, wo, u, (sr_vec2){0, 0}, SR_RADIANCE, &r));
        EXPECT_NEAR(s.f[0] * fabsf(s.wi.z) / s.pdf, 1, 1e-6);
        float eta = s.lobe & SR_LOBE_REFLECTION ? 1 : wo.z > 0 ? 1.5f : 1 / 1.5f;
        EXPECT_NEAR(s.eta, eta, 1e-6);
        EXPECT_NEAR(r.f[0] * fabsf(r.wi.z) / r.pdf * eta * eta, 1, 1e-6);
        EXPECT_NEAR(sr_length(s.wi), 1, 1e-6);
    }
    EXPECT_NEAR(b.model->albedo(b.data, direction(50, 0))[0], 1, 0);
}
