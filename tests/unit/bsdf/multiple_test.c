/* SPDX-License-Identifier: MIT */
/* Rough metal and glass that keep what bounces: in a white furnace they return all light. */
#include "quadrature.h"

TEST(white_rough_metal_returns_all_light)
{
    static const double alpha[7] = {0.02, 0.07, 0.1, 0.33, 0.5, 0.77, 1}, theta[6] = {0, 30, 60, 80, 87, 89};
    double worst = 0;
    for (int i = 0; i < 7; ++i) {
        struct sr_bsdf b = specimen("ggx_conductor_ms", "eta", 0.0, "k", 1.0, "alpha", alpha[i], NULL);
        for (int k = 0; k < 6; ++k) {
            double E = albedo_by_facets(&b, direction(theta[k], 25), 1, 1, alpha[i]);
            worst = fmax(worst, fabs(E - 1));
        }
        EXPECT_SAMPLES(&b, direction(75, 0), 1, 1);
    }
    EXPECT(worst < 3e-4);
}

/* E_avg of the single bounce, tabulated elsewhere, is what the many bounces make up for: with F = 1 they carry 1 -
 * E_avg. */
TEST(bounces_carry_what_one_of_them_loses)
{
    static const double alpha[5] = {0.1, 0.25, 0.5, 0.75, 1},
                        average[5] = {.972046, .882323, .700240, .536303, .409137};
    for (int i = 0; i < 5; ++i) {
        struct sr_bsdf all = specimen("ggx_conductor_ms", "eta", 0.0, "k", 1.0, "alpha", alpha[i], NULL);
        struct sr_bsdf one =
            specimen("conductor", "eta", 0.0, "k", 1.0, "alpha_x", alpha[i], "alpha_y", alpha[i], NULL);
        double x[12], w[12], carried = 0;
        sr_gauss_legendre(12, 0, 1, x, w);
        for (int k = 0; k < 12; ++k) {
            sr_vec3 wo = direction(acos(x[k]) * 180 / QUADRATURE_PI, 0);
            carried += 2 * w[k] * x[k] *
                       (albedo_by_facets(&all, wo, 1, 1, alpha[i]) - albedo_by_facets(&one, wo, 1, 1, alpha[i]));
        }
        EXPECT_NEAR(carried, 1 - average[i], 3e-4);
    }
}

/* A grey metal: the second term is Fms (1 - E(zo)), with F_avg by a finer quadrature. */
TEST(bounces_are_paid_for_at_each_facet)
{
    sr_spectrum eta = SR_BLACK + 0.2f, k = SR_BLACK + 3.0f;
    double x[32], w[32], F = 0, E_avg = .700240;
    sr_gauss_legendre(32, 0, 1, x, w);
    for (int i = 0; i < 32; ++i)
        F += 2 * w[i] * x[i] * (double)sr_fresnel_conductor((float)x[i], eta, k)[0];
    struct sr_bsdf all = specimen("ggx_conductor_ms", "eta", 0.2, "k", 3.0, "alpha", 0.5, NULL);
    struct sr_bsdf one = specimen("conductor", "eta", 0.2, "k", 3.0, "alpha_x", 0.5, "alpha_y", 0.5, NULL);
    sr_vec3 wo = direction(60, 0);
    double E = 0.698251; // of the single bounce at F = 1
    EXPECT_NEAR(albedo_by_facets(&all, wo, 1, 1, 0.5) - albedo_by_facets(&one, wo, 1, 1, 0.5),
                F * F * E_avg / (1 - F * (1 - E_avg)) * (1 - E), 3e-4);
}

/* What the many bounces carry to a side: what f has beyond the single events. */
struct beyond {
    struct sr_bsdf all, one;
    sr_vec3 wo;
};
static double beyond_integrand(const void *context, sr_vec3 wi)
{
    const struct beyond *b = context;
    return (
        double)((sr_bsdf_f(&b->all, b->wo, wi, SR_IMPORTANCE)[0] - sr_bsdf_f(&b->one, b->wo, wi, SR_IMPORTANCE)[0]) *
                fabsf(wi.z));
}
static struct beyond beyond(double eta, double alpha, double theta, bool below)
{
    struct beyond b = {specimen("ggx_dielectric_ms", "eta", eta, "alpha", alpha, NULL),
                       specimen("microfacet_dielectric", "eta", eta, "alpha_x", alpha, "alpha_y", alpha, NULL),
                       direction(below ? 180 - theta : theta, 25)};
    return b;
}

TEST(ground_glass_returns_all_light)
{
    static const double eta[4] = {1.13, 1.33, 1.5, 2.4}, alpha[4] = {0.1, 0.2, 0.45, 1}, theta[4] = {8, 45, 75, 86};
    double worst = 0;
    for (int i = 0; i < 64; ++i)
        for (int below = 0; below < 2; ++below) {
            double n = eta[i / 16], a = alpha[i / 4 % 4], E = 0;
            struct beyond b = beyond(n, a, theta[i % 4], below);
            for (int side = 1; side >= -1; side -= 2)
                E += albedo_by_facets(&b.one, b.wo, side, n, a) + hemisphere_integral(beyond_integrand, &b, side, 16);
            worst = fmax(worst, fabs(E - 1));
        }
    EXPECT(worst < 4e-3);
    struct beyond b = beyond(1.5, 0.5, 60, true);
    double R = albedo_by_facets(&b.one, b.wo, 1, 1.5, 0.5) + hemisphere_integral(beyond_integrand, &b, -1, 16);
    EXPECT_SAMPLES(&b.all, b.wo, 1, R);
    EXPECT_SAMPLES(&b.all, b.wo, -1, 1 - R);
}

/* Glass of eta 1.5, alpha 0.5: R + T of single events, tabulated elsewhere (masking beta), are what the rest makes up
 * for. */
TEST(glass_bounces_carry_what_single_events_lose)
{
    static const double theta[4] = {0, 30, 60, 80},
                        outside[4] = {.028175 + .939932, .029831 + .924339, .043935 + .832974, .082835 + .599913},
                        inside[4] = {.046171 + .707683, .155562 + .563789, .434486 + .210526, .598924 + .031333};
    for (int k = 0; k < 8; ++k) {
        struct beyond b = beyond(1.5, 0.5, theta[k / 2], k & 1);
        double carried =
            hemisphere_integral(beyond_integrand, &b, 1, 16) + hemisphere_integral(beyond_integrand, &b, -1, 16);
        EXPECT_NEAR(carried, 1 - (k & 1 ? inside : outside)[k / 2], 6e-4);
    }
}
