/* SPDX-License-Identifier: MIT */
/* Photon beam diffusion against quadratures that share nothing with it but the integrands as they are printed. */
#include "subsurface/subsurface.h"
#include "test.h"

#define PI 3.14159265358979323846

/* Fresnel's reflectance from inside, by tangents and sines of the angles. */
static double reflected(double cosine, double eta)
{
    double a = acos(cosine), s = eta * sin(a);
    if (s >= 1)
        return 1;
    double b = asin(s);
    if (a < 1e-7)
        return pow((eta - 1) / (eta + 1), 2);
    return (pow(sin(a - b) / sin(a + b), 2) + pow(tan(a - b) / tan(a + b), 2)) / 2;
}

static double moment(double eta, int k)
{
    double sum = 0;
    int n = 50000;
    for (int i = 0; i < n; ++i) {
        double mu = (i + 0.5) / n;
        sum += reflected(mu, eta) * pow(mu, k) / n;
    }
    return sum;
}

/* midpoints in sqrt z, up to 40 */
static double midpoints(double (*f)(const double *, double), const double *p)
{
    double sum = 0;
    int n = 60000;
    for (int i = 0; i < n; ++i) {
        double s = sqrt(40) * (i + 0.5) / n;
        sum += f(p, s * s) * 2 * s * sqrt(40) / n;
    }
    return sum;
}

static double single_integrand(const double *p, double x) // albedo, g, eta, r
{
    double albedo = p[0], g = p[1], eta = p[2], r = p[3];
    double critical = eta > 1 ? r * sqrt(eta * eta - 1) : 0, t = critical + x, d = hypot(r, t), c = t / d;
    double phase = (1 - g * g) / (4 * PI * pow(1 + g * g + 2 * g * c, 1.5));
    return albedo * exp(-x) * exp(-d - critical) / (d * d) * phase * (1 - reflected(c, eta)) * c;
}

static double multiple_integrand(const double *p, double z) // and F1, F2
{
    double albedo = p[0], g = p[1], r = p[3], F1 = p[4], F2 = p[5];
    double a = 1 - albedo, s = albedo * (1 - g), t = a + s;
    double D = (2 * a + s) / (3 * t * t), tr = sqrt(a / D), ze = -2 * D * (1 + 3 * F2) / (1 - 2 * F1);
    double zv = -z + 2 * ze, dr = hypot(r, z), dv = hypot(r, zv);
    double phi = (exp(-tr * dr) / dr - exp(-tr * dv) / dv) / (4 * PI * D);
    double E =
        (z * (1 + tr * dr) * exp(-tr * dr) / pow(dr, 3) - zv * (1 + tr * dv) * exp(-tr * dv) / pow(dv, 3)) / (4 * PI);
    double kappa = 1 - exp(-2 * t * (dr + z));
    return t * exp(-t * z) * kappa * pow(s / t, 2) * (phi * (1 - 2 * F1) / 4 + E * (1 - 3 * F2) / 2);
}

TEST(profiles_are_the_integrals_of_photon_beam_diffusion)
{
    static const double cases[][4] = {// albedo, g, eta, r
                                      {0.9, 0, 1.33, 0.3},     {0.9, 0, 1.33, 3}, {0.5, 0.6, 1.5, 1},
                                      {0.99, -0.3, 1.4, 0.05}, {1, 0, 1.33, 8},   {0.3, 0, 1, 0.7},
                                      {0.8, 0, 0.8, 0.4}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const double *c = cases[i];
        double p[6] = {c[0], c[1], c[2], c[3], moment(c[2], 1), moment(c[2], 2)};
        EXPECT_RELATIVE(sr_diffusion_single(c[0], c[1], c[2], c[3]), midpoints(single_integrand, p), 2e-5);
        EXPECT_RELATIVE(sr_diffusion_multiple(c[0], c[1], c[2], c[3]), midpoints(multiple_integrand, p), 2e-5);
    }
}

static struct sr_arena arena;

static const struct sr_diffusion *table(double g, double eta)
{
    struct sr_error error = {0};
    static const struct sr_diffusion *usual; // most ask for this one
    if (usual && g == 0 && eta == 1.33)
        return usual;
    const struct sr_diffusion *d = sr_diffusion_make(g, eta, &arena, &error);
    if (!d)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    if (g == 0 && eta == 1.33)
        usual = d;
    return d;
}

static struct sr_bssrdf body(const struct sr_diffusion *d, float albedo, float sigma_t)
{
    struct sr_bssrdf b = {.diffusion = d, .sigma_t = SR_BLACK + sigma_t, .albedo = SR_BLACK + albedo, .eta = 1.33f};
    return b;
}

/* INTEGRAL 2 pi r S dr in ln r */
static double exact_share(double albedo, double g, double eta)
{
    enum { N = 60 };
    double x[N], w[N], sum = 0;
    sr_gauss_legendre(N, log(1e-6), log(200), x, w);
    for (int i = 0; i < N; ++i) {
        double r = exp(x[i]);
        sum +=
            w[i] * r * 2 * PI * r * (sr_diffusion_single(albedo, g, eta, r) + sr_diffusion_multiple(albedo, g, eta, r));
    }
    return sum;
}

TEST(the_table_keeps_the_integrals)
{
    const struct sr_diffusion *d = table(0, 1.33);
    static const float albedos[] = {0.2f, 0.6f, 0.9f, 0.99f, 0.999f};
    for (int i = 0; i < 5; ++i) {
        double exact = exact_share((double)albedos[i], 0, 1.33);
        printf("  albedo %.3f: comes out %.5f, exact %.5f\n", (double)albedos[i],
               (double)sr_diffusion_effective(d, albedos[i]), exact);
        EXPECT_RELATIVE(sr_diffusion_effective(d, albedos[i]), exact, 4e-3);
        struct sr_bssrdf b = body(d, albedos[i], 2);
        for (float r = 0.02f; r < 4; r *= 1.37f) { // S(r) = sigma_t^2 S(r sigma_t)
            double S = 4 * (sr_diffusion_single((double)albedos[i], 0, 1.33, 2 * (double)r) +
                            sr_diffusion_multiple((double)albedos[i], 0, 1.33, 2 * (double)r));
            EXPECT_RELATIVE(sr_bssrdf_profile(&b, r, NULL)[0], S, 0.02);
        }
    }
}

TEST(no_more_comes_out_than_has_entered)
{
    static const double gs[] = {-0.5, 0.8}, etas[] = {1, 1.5};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            const struct sr_diffusion *d = table(gs[i], etas[j]);
            for (int k = 1; k < SR_DIFFUSION_ALBEDOS; ++k)
                EXPECT(d->effective[k] > d->effective[k - 1]);
            printf("  g %4.1f eta %.2f: all of albedo 1 is %.4f\n", gs[i], etas[j],
                   (double)d->effective[SR_DIFFUSION_ALBEDOS - 1]);
            EXPECT(d->effective[SR_DIFFUSION_ALBEDOS - 1] <= 1 + 1e-6f);
            for (float a = 0.99f; a <= 1; a += 1e-4f)
                EXPECT(sr_diffusion_effective(d, a) <= 1 + 1e-4f);
        }
}

TEST(an_albedo_is_found_by_what_comes_out)
{
    const struct sr_diffusion *d = table(0, 1.5);
    for (float e = 0.004f; e < d->effective[SR_DIFFUSION_ALBEDOS - 1]; e += 0.0137f)
        EXPECT_NEAR(sr_diffusion_effective(d, sr_diffusion_albedo(d, e)), e, 3e-5);
    EXPECT(sr_diffusion_albedo(d, 0) == 0);
    EXPECT(sr_diffusion_albedo(d, 1) > 0.99999f);
}

TEST(distances_are_drawn_by_their_density)
{
    const struct sr_diffusion *d = table(0, 1.33);
    static const float albedos[] = {0.05f, 0.77f, 0.995f, 1};
    for (int i = 0; i < 4; ++i) {
        enum { CELLS = 40, DRAWS = 200000 };
        struct sr_bssrdf b = body(d, albedos[i], 3);
        float end = sr_bssrdf_reach(&b, 0);
        double observed[CELLS] = {0}, expected[CELLS] = {0};
        for (int k = 0; k < DRAWS; ++k) {
            float r = sr_bssrdf_sample(&b, 2, ((float)k + 0.5f) / DRAWS);
            EXPECT(r >= 0);
            int cell = (int)(CELLS * sqrtf(r / end));
            if (cell < CELLS)
                observed[cell] += 1;
        }
        for (int cell = 0; cell < CELLS; ++cell) { // cells even in sqrt r
            double x[32], w[32];
            sr_gauss_legendre(32, (double)cell / CELLS, (cell + 1.0) / CELLS, x, w);
            for (int k = 0; k < 32; ++k) {
                double r = (double)end * x[k] * x[k];
                sr_spectrum pdf;
                sr_bssrdf_profile(&b, (float)r, &pdf);
                expected[cell] += w[k] * 2 * (double)end * x[k] * 2 * PI * r * (double)pdf[2] * DRAWS;
            }
            EXPECT_NEAR(observed[cell], expected[cell],
                        3 + 2e-3 * expected[cell]); // the draws are even: no chance in them
        }
    }
}

TEST(what_does_not_scatter_lets_nothing_out)
{
    const struct sr_diffusion *d = table(0, 1.33);
    struct sr_bssrdf black = body(d, 0, 3), thin = body(d, 0.5f, 0);
    sr_spectrum pdf;
    EXPECT(sr_spectrum_is_black(sr_bssrdf_profile(&black, 0.1f, &pdf)) && sr_spectrum_is_black(pdf));
    EXPECT(sr_bssrdf_sample(&black, 0, 0.5f) < 0);
    EXPECT(sr_spectrum_is_black(sr_bssrdf_profile(&thin, 0.1f, &pdf)));
    EXPECT(sr_bssrdf_sample(&thin, 0, 0.5f) < 0 && sr_bssrdf_reach(&thin, 0) == 0);
    EXPECT(sr_spectrum_is_finite(sr_bssrdf_profile(&black, 0, NULL)));
}

/* The model's limit: a half space of the same index, scattering evenly, returns of diffuse light 1 - 2 sqrt(1 - albedo)
 * alpha_1 (Chandrasekhar 1950; H's first moment), and of a beam straight down 1 - sqrt(1 - albedo) H(1). The model
 * knows no direction of what enters; it lies between the two for albedos up to 0.9, and above both by up to 6 % beyond.
 */
TEST(a_half_space_is_met_within_the_limits_of_diffusion)
{
    static const double cases[][3] = {{0.5, 0.146544, 0.115226}, {0.9, 0.478024, 0.414947}, {0.99, 0.794564, 0.752721}};
    const struct sr_diffusion *d = table(0, 1);
    for (int i = 0; i < 3; ++i) {
        double e = (double)sr_diffusion_effective(d, (float)cases[i][0]);
        printf("  albedo %.2f: %.4f, diffuse light %.4f (%+.1f %%), a beam %.4f (%+.1f %%)\n", cases[i][0], e,
               cases[i][1], 100 * (e / cases[i][1] - 1), cases[i][2], 100 * (e / cases[i][2] - 1));
        EXPECT(e > cases[i][2] * 0.99 && e < cases[i][1] * 1.07);
    }
}
