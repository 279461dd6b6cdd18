/* SPDX-License-Identifier: MIT */
/* Disney's BRDF of 2012: printed directional albedos of its lobes, together and alone. */
#include "quadrature.h"

static const double theta[4] = {0, 30, 60, 80};

TEST(disney_has_its_printed_albedos)
{
    static const double plain[4] = {.539635, .539326, .559672, .644675},
                        metal[4] = {.457920, .452315, .438647, .468901}, flat[4] = {.413783, .447131, .595003, .787556},
                        chalk[4] = {1.048021, 1.047541, 1.075627, 1.307418};
    struct sr_bsdf b[4] = {specimen("disney", NULL), specimen("disney", "metallic", 1.0, NULL),
                           specimen("disney", "subsurface", 1.0, NULL),
                           specimen("disney", "reflectance", 1.0, "roughness", 1.0, NULL)};
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(albedo_toward(&b[0], direction(theta[i], 0), 1, 320), plain[i], 3e-6);
        EXPECT_NEAR(albedo_toward(&b[1], direction(theta[i], 0), 1, 320), metal[i], 3e-6);
        EXPECT_NEAR(albedo_toward(&b[2], direction(theta[i], 0), 1, 320), flat[i], 3e-6);
        EXPECT_NEAR(albedo_toward(&b[3], direction(theta[i], 0), 1, 320), chalk[i], 3e-6);
    }
}

static double difference(const void *context, sr_vec3 wi) // of two models' f, times cos
{
    const struct albedo_query *q = context;
    return (double)((sr_bsdf_f(&q->bsdf[0], q->wo, wi, SR_IMPORTANCE)[0] -
                     sr_bsdf_f(&q->bsdf[1], q->wo, wi, SR_IMPORTANCE)[0]) *
                    wi.z);
}

/* Burley's diffuse lobe is what colour adds: 1.00595... = 1 + 1/168 at normal incidence. */
TEST(burleys_diffuse_lobe_has_its_closed_albedo)
{
    static const double E[4] = {1.00595238095, 1.00516746422, 1.00832015749, 1.02538775313};
    struct sr_bsdf pair[2] = {specimen("disney", "reflectance", 1.0, NULL),
                              specimen("disney", "reflectance", 0.0, NULL)};
    for (int i = 0; i < 4; ++i) {
        struct albedo_query q = {pair, direction(theta[i], 0)};
        EXPECT_RELATIVE(hemisphere_integral(difference, &q, 1, 160), E[i], 1e-5);
    }
}

/* The clear coat is sharp, so that samples of it count: mean of f cos / pdf with the whole model's density. */
TEST(disneys_clear_coat_has_its_printed_albedo)
{
    static const double E[4] = {.009370, .009370, .015041, .045660};
    struct sr_bsdf with = specimen("disney", "reflectance", 0.0, "specular", 0.0, "clearcoat", 1.0, NULL);
    struct sr_bsdf without = specimen("disney", "reflectance", 0.0, "specular", 0.0, NULL);
    for (int i = 0; i < 4; ++i) {
        sr_vec3 wo = direction(theta[i], 0);
        double both = albedo_by_samples(&with, wo, 1, 400000), one = albedo_toward(&without, wo, 1, 320);
        EXPECT_NEAR(both - one, E[i], 3e-3 * E[i]);
    }
}

/* A tint keeps the luminance: of a grey base nothing changes. */
TEST(grey_has_no_tint)
{
    struct sr_bsdf a =
        specimen("disney", "reflectance", 0.3, "specular_tint", 1.0, "sheen", 1.0, "sheen_tint", 1.0, NULL);
    struct sr_bsdf b =
        specimen("disney", "reflectance", 0.3, "specular_tint", 0.0, "sheen", 1.0, "sheen_tint", 0.0, NULL);
    for (int i = 0; i < 4; ++i)
        EXPECT_RELATIVE(sr_bsdf_f(&a, direction(theta[i], 0), direction(40, 130), SR_RADIANCE)[0],
                        sr_bsdf_f(&b, direction(theta[i], 0), direction(40, 130), SR_RADIANCE)[0], 1e-6);
}
