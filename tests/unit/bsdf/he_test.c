/* SPDX-License-Identifier: MIT */
/* Waves on a rough plane against independently computed shares, diffuse and mirrored, at 0, 30, 60 and 80 degrees. */
#include "quadrature.h"

TEST(he_shares_light_out_between_lobe_and_mirror)
{
    static const struct {
        double sigma, tau, lobe[4], mirror[4];
    } rows[2] = {{0.18, 3, {1.000025, 1.000042, .976341, .432446}, {4.51e-8, 3.10e-6, .0145752, .576361}},
                 {0.05, 2, {.728857, .624259, .276705, .054514}, {.271153, .375760, .721612, .961411}}};
    static const double angles[4] = {0, 30, 60, 80};
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 4; ++k) {
            struct sr_bsdf b = specimen("he", "eta", 0.0, "k", 1.0, "sigma", rows[i].sigma, "tau", rows[i].tau, NULL);
            sr_vec3 wo = direction(angles[k], 20);
            EXPECT_RELATIVE(albedo_toward(&b, wo, 1, 240), rows[i].lobe[k], 1e-5);
            struct sr_bsdf_sample s;
            if (rows[i].mirror[k] < 1e-3)
                continue;
            EXPECT(sr_bsdf_sample(&b, wo, 0, (sr_vec2){0.5f, 0.5f}, SR_RADIANCE, &s) && (s.lobe & SR_LOBE_SPECULAR));
            EXPECT_RELATIVE(s.f[0] * fabsf(wo.z), rows[i].mirror[k], 1e-5);
            EXPECT_SAMPLES(&b, wo, 1, rows[i].lobe[k] + rows[i].mirror[k]);
        }
}

/* Where heights are many waves, facets remain: Beckmann's with alpha = 2 sigma / tau, straight on, to 0.06 / g. */
TEST(he_tends_to_beckmann)
{
    struct sr_bsdf wave = specimen("he", "eta", 0.0, "k", 1.0, "sigma", 1.0, "tau", 10.0, NULL);
    struct sr_bsdf facets = specimen("beckmann_conductor", "eta", 0.0, "k", 1.0, "alpha_x", 0.2, "alpha_y", 0.2, NULL);
    for (int i = 0; i < 20; i += 4) {
        sr_vec3 wo = direction(5, 0), wi = direction(i, 60);
        EXPECT_RELATIVE(sr_bsdf_f(&wave, wo, wi, SR_RADIANCE)[0], sr_bsdf_f(&facets, wo, wi, SR_RADIANCE)[0], 5e-3);
    }
}

/* At grazing the mirror takes nearly all: what is left to the lobe must keep its digits, and be drawn. */
TEST(he_is_seen_at_the_horizon)
{
    struct sr_bsdf b = specimen("he", "sigma", 0.05, "tau", 3.0, NULL);
    static const double angles[4] = {89, 89.9, 89.99, 89.9999};
    for (int i = 0; i < 4; ++i) {
        sr_vec3 wo = direction(angles[i], 0), wi = direction(70, 180);
        EXPECT(sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0] > 0);
        EXPECT(sr_bsdf_pdf(&b, wo, wi, SR_RADIANCE) > 0);
        EXPECT_RELATIVE(sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0], sr_bsdf_f(&b, wi, wo, SR_RADIANCE)[0], 1e-5);
    }
}

/* It is wavelength that decides: one surface, nearly a mirror at 10 um, without a mirror's image at 0.4 um. */
TEST(he_turns_into_a_mirror_at_long_waves)
{
    struct sr_bsdf b = specimen("he", "eta", 0.0, "k", 1.0, "sigma", 0.2, "tau", 4.0, NULL);
    sr_vec3 wo = direction(30, 0);
    struct sr_bsdf_sample s;
    static const double nm[3] = {400, 1000, 10000};
    for (int i = 0; i < 3; ++i) {
        specimen_ready(&b, (float)nm[i]);
        // at 30 deg nothing hides anything: exp(-g), g = (4 pi sigma cos / lambda)^2
        double share = exp(-pow(4 * QUADRATURE_PI * 0.2 * cos(QUADRATURE_PI / 6) / (nm[i] * 1e-3), 2));
        bool is_mirror =
            sr_bsdf_sample(&b, wo, 0, (sr_vec2){0.5f, 0.5f}, SR_RADIANCE, &s) && (s.lobe & SR_LOBE_SPECULAR);
        EXPECT(is_mirror == (share > 1e-6));
        if (is_mirror)
            EXPECT_RELATIVE(s.f[0] * fabsf(wo.z), share, 1e-5);
    }
}
