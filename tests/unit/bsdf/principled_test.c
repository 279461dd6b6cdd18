/* SPDX-License-Identifier: MIT */
/* Disney's BSDF of 2015: what it becomes at the ends of its parameters, which other models know. */
#include "quadrature.h"

static void pair(struct sr_rng *rng, sr_vec3 w[2])
{
    for (int j = 0; j < 2; ++j)
        w[j] = direction(170 * (double)sr_rng_float(rng) + 5, 360 * (double)sr_rng_float(rng));
}

/* What a rounding of wo does to f, near total reflection above all; the models take some of them. */
static float moved(const struct sr_bsdf *b, const sr_vec3 w[2], enum sr_transport mode)
{
    float f = sr_bsdf_f(b, w[0], w[1], mode)[0], most = 0;
    for (int i = 0; i < 4; ++i) {
        const float by = (i & 1 ? 1 : -1) * 0x1p-22f;
        sr_vec3 wo = {w[0].x * (1 + by), w[0].y * (1 + by), w[0].z * (i & 2 ? 1 + by : 1 - by)};
        most = sr_max(most, fabsf(sr_bsdf_f(b, wo, w[1], mode)[0] - f));
    }
    return most;
}

/* White, all transmission: ground glass. */
TEST(principled_glass_is_ground_glass)
{
    struct sr_rng rng = sr_rng_seed(41, 1);
    for (int k = 0; k < 3; ++k) {
        double r = 0.4 + 0.25 * k, eta = 1.2 + 0.4 * k;
        struct sr_bsdf a =
            specimen("principled", "reflectance", 1.0, "specular_transmission", 1.0, "roughness", r, "eta", eta, NULL);
        struct sr_bsdf b = specimen("dielectric", "alpha_x", r * r, "alpha_y", r * r, "eta", eta, NULL);
        for (int i = 0; i < 1000; ++i) {
            sr_vec3 w[2];
            pair(&rng, w);
            for (int mode = 0; mode < 2; ++mode) {
                float expected = sr_bsdf_f(&b, w[0], w[1], (enum sr_transport)mode)[0];
                EXPECT_NEAR(sr_bsdf_f(&a, w[0], w[1], (enum sr_transport)mode)[0], expected,
                            1e-4f * expected + 2e-6f + 4 * moved(&b, w, (enum sr_transport)mode));
            }
        }
    }
}

/* White metal has Fresnel's factor 1: the albedos of Trowbridge-Reitz's surface alone, alpha = 0.3. */
TEST(principled_white_metal_has_the_albedo_of_its_facets)
{
    static const double theta[4] = {0, 30, 60, 80},
                        E[4] = {0.877358415789, 0.863872895533, 0.821711003151, 0.848232379451};
    struct sr_bsdf b = specimen("principled", "reflectance", 1.0, "metallic", 1.0, "roughness", sqrt(0.3), NULL);
    for (int i = 0; i < 4; ++i)
        EXPECT_RELATIVE(albedo_toward(&b, direction(theta[i], 0), 1, 320), E[i], 1e-5);
}

static double matte_part(const void *context, sr_vec3 wi)
{
    const struct albedo_query *q = context;
    return (double)((sr_bsdf_f(&q->bsdf[0], q->wo, wi, SR_IMPORTANCE)[0] -
                     sr_bsdf_f(&q->bsdf[1], q->wo, wi, SR_IMPORTANCE)[0]) *
                    wi.z);
}

/* The smooth diffuse lobe: E = (1 - FV / 2) 2 INTEGRAL (1 - (1 - c)^5 / 2) c dc = (1 - FV / 2) 41 / 42. */
TEST(principled_smooth_diffuse_lobe_has_its_closed_albedo)
{
    struct sr_bsdf two[2] = {specimen("principled", "reflectance", 1.0, "roughness", 0.0, NULL),
                             specimen("principled", "reflectance", 0.0, "roughness", 0.0, NULL)};
    for (int theta = 0; theta < 90; theta += 20) {
        struct albedo_query q = {two, direction(theta, 0)};
        double expected = (1 - 0.5 * pow(1 - cos(theta * QUADRATURE_PI / 180), 5)) * 41 / 42;
        EXPECT_RELATIVE(hemisphere_integral(matte_part, &q, 1, 96), expected, 1e-5);
    }
}

/* What lets no light through looks the same from both sides. */
TEST(principled_plastic_has_two_equal_sides)
{
    struct sr_bsdf b = specimen("principled", "clearcoat", 1.0, "sheen", 0.5, "anisotropic", 0.7, NULL);
    struct sr_rng rng = sr_rng_seed(42, 1);
    for (int i = 0; i < 500; ++i) {
        sr_vec3 w[2];
        pair(&rng, w);
        EXPECT_RELATIVE(sr_bsdf_f(&b, w[0], w[1], SR_RADIANCE)[0],
                        sr_bsdf_f(&b, sr_neg(w[0]), sr_neg(w[1]), SR_RADIANCE)[0], 1e-5);
    }
}
