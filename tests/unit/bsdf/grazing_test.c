/* SPDX-License-Identifier: MIT */
/* What rounding does where light just skims a surface, or hardly notices it: values that were found wrong by
 * certificates. */
#include "bsdf/facets_interface.h"
#include "quadrature.h"

/* Fresnel's reflectance where the indices nearly match: 1 - sin_t^2 has no digits left at grazing. In double:
 * F = ((c - g)^2 / (c + g)^2 + (n^2 c - g)^2 / (n^2 c + g)^2) / 2,  g^2 = n^2 - 1 + c^2. */
TEST(fresnel_keeps_its_digits_at_grazing)
{
    EXPECT_NEAR(sr_fresnel_dielectric(1.2e-4f, 1), 0, 1e-12);
    const double n[4] = {1.0001, 1.001, 1.5, 0.9999}, c[4] = {1e-3, 1e-2, 1e-4, 0.02};
    for (int i = 0; i < 4; ++i) {
        double e = (double)(float)n[i], x = (double)(float)c[i], g = sqrt(e * e - 1 + x * x);
        double s = (x - g) / (x + g), p = (e * e * x - g) / (e * e * x + g);
        EXPECT_RELATIVE(sr_fresnel_dielectric((float)c[i], (float)n[i]), (s * s + p * p) / 2, 2e-5);
    }
}

/* Mirror directions whose lengths are off by roundings: f was 0, and the sample 1.7e7. */
TEST(grazing_samples_agree_with_f)
{
    struct sr_bsdf b = specimen("microfacet_dielectric", "distribution", 1.0, "masking", 2.0, "eta", 0.8809, "alpha_x",
                                0.09748, "alpha_y", 0.0116, NULL);
    sr_vec3 wo = {0x1.9cc09cp-1f, -0x1.2ef386p-1f, 0x1.afb7d4p-14f},
            wi = {-0x1.9cc0aap-1f, 0x1.2ef374p-1f, 0x1.2a2748p-14f};
    float p, q;
    sr_spectrum f = sr_bsdf_f_pdf(&b, wo, wi, SR_RADIANCE, &p), g = sr_bsdf_f_pdf(&b, wi, wo, SR_RADIANCE, &q);
    EXPECT_RELATIVE(f[0], 1.697e7, 5e-3);
    EXPECT_RELATIVE(p, 2946, 5e-3);
    EXPECT_RELATIVE(g[0], (double)f[0], 1e-6); // the same half vector, the same cosine
}

/* B(x, 3) = 2 / (x (x + 1) (x + 2)): heights that work against each other at grazing, where logarithms were off by
 * 1e-3. */
TEST(masking_of_what_passes_keeps_its_digits_at_grazing)
{
    for (float x = 1; x < 2e5f; x *= 3) {
        double y = (double)x, exact = 2 / (y * (y + 1) * (y + 2));
        EXPECT_RELATIVE(euler_beta(x, 3), exact, 4e-6);
        EXPECT_RELATIVE(euler_beta(3, x), exact, 4e-6);
    }
}

/* OpenPBR's glass without specular weight has the index 1: light goes straight on, whatever the roughness. */
TEST(openpbr_glass_of_index_one_lets_light_go_on)
{
    struct sr_bsdf b = specimen("openpbr", "transmission_weight", 1.0, "specular_weight", 0.0, "transmission_color",
                                0.7, "specular_roughness", 0.4, NULL);
    EXPECT((sr_bsdf_lobes(&b) & SR_LOBE_SPECULAR) != 0);
    struct sr_rng rng = sr_rng_seed(9, 1);
    for (int side = -1; side <= 1; side += 2) {
        double sum = 0;
        sr_vec3 wo = direction(60, 20);
        wo.z *= (float)side;
        for (int i = 0; i < 4000; ++i) {
            struct sr_bsdf_sample s;
            float u = sr_rng_float(&rng), x = sr_rng_float(&rng);
            if (!sr_bsdf_sample(&b, wo, u, (sr_vec2){x, sr_rng_float(&rng)}, SR_RADIANCE, &s))
                continue;
            if (s.lobe & SR_LOBE_TRANSMISSION) {
                EXPECT_NEAR(sr_length(sr_add(s.wi, wo)), 0, 1e-7);
                sum += (double)(s.f[0] * fabsf(s.wi.z) / s.pdf) / 4000;
            }
        }
        EXPECT_NEAR(sum, 0.7, 2e-3); // 0.1 % of samples look for other lobes
    }
}

/* A rough coat's walk leaves by two ways; where the draw of one fails, the other was dropped: f lost up to a fifth. */
TEST(coated_metal_describes_the_light_it_sends)
{
    struct sr_bsdf b =
        specimen("coated_conductor", "eta", 0.02, "k", 6.0, "coat_eta", 0.6, "coat_alpha_x", 0.3, "coat_alpha_y", 1.0,
                 "base_alpha_x", 0.5, "base_alpha_y", 0.5, "thickness", 0.0, "max_depth", 100.0, NULL);
    struct sr_rng rng = sr_rng_seed(10, 1);
    sr_vec3 wo = direction(40, 60);
    struct sr_tally described = {0}, drawn = {0};
    for (int i = 0; i < 60000; ++i) {
        struct sr_bsdf_sample s;
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_tally_add(&described, (double)(sr_bsdf_f(&b, wo, wi, SR_IMPORTANCE)[0] * SR_PI));
        float u = sr_rng_float(&rng), x = sr_rng_float(&rng);
        bool is_drawn = sr_bsdf_sample(&b, wo, u, (sr_vec2){x, sr_rng_float(&rng)}, SR_IMPORTANCE, &s);
        sr_tally_add(&drawn, is_drawn ? (double)(s.f[0] * s.wi.z / s.pdf) : 0);
    }
    double error = hypot(sr_tally_standard_error(&described), sr_tally_standard_error(&drawn));
    EXPECT(error < 0.01);
    EXPECT_NEAR(described.mean, drawn.mean, 5 * error);
}
