/* SPDX-License-Identifier: MIT */
/* Ward's gloss and its descendants against independently computed reflectances. */
#include "quadrature.h"

static const double angles[4] = {0, 30, 60, 80};

static struct sr_bsdf lobe(const char *name, double alpha_x, double alpha_y)
{
    return specimen(name, "reflectance", 0.0, "specular", 1.0, "alpha_x", alpha_x, "alpha_y", alpha_y, NULL);
}

static void expect_albedos(const struct sr_bsdf *b, double phi, const double expected[4], double tolerance)
{
    for (int i = 0; i < 4; ++i)
        EXPECT_RELATIVE(albedo_toward(b, direction(angles[i], phi), 1, 240), expected[i], tolerance);
}

TEST(ward_reflects_what_quadrature_in_double_says)
{
    static const double ward[4] = {0.894917170147, 0.777279120997, 0.458850939351, 0.216226840462};
    static const double duer[4] = {0.928313221932, 0.928302290704, 0.916914559301, 0.917777094149};
    static const double gmd[4] = {.960000, .952649, .897580, .799414};
    struct sr_bsdf b = lobe("ward", 0.2, 0.2);
    expect_albedos(&b, 10, ward, 5e-6); // f cos begins as sqrt(cos) at the horizon
    b = lobe("ward_duer", 0.2, 0.2);
    expect_albedos(&b, 10, duer, 3e-6);
    b = lobe("ward_gmd", 0.2, 0.2);
    expect_albedos(&b, 10, gmd, 3e-6);
}

TEST(ward_of_two_widths_reflects_by_azimuth)
{
    static const double along[4] = {.950000, .948225, .933362, .832459},
                        across[4] = {.950000, .932881, .853702, .799959};
    struct sr_bsdf b = lobe("ward_gmd", 0.1, 0.3);
    expect_albedos(&b, 0, along, 3e-6);
    expect_albedos(&b, 90, across, 3e-6);
    for (int i = 0; i < 4; ++i) { // the same by samples
        EXPECT_SAMPLES(&b, direction(angles[i], 0), 1, along[i]);
        EXPECT_SAMPLES(&b, direction(angles[i], 90), 1, across[i]);
    }
    EXPECT_NEAR(albedo_toward(&b, direction(0, 0), 1, 240), 1 - (0.01 + 0.09) / 2, 2e-5); // closed but for exp(-1/0.09)
}

TEST(ward_makes_light_at_the_horizon_as_documented)
{
    static const double duer[3] = {.880295, 1.333427, 5.144714}, theta[3] = {80, 85, 89};
    for (int i = 0; i < 3; ++i) {
        struct sr_bsdf b = lobe("ward_duer", 0.5, 0.5);
        EXPECT_RELATIVE(albedo_toward(&b, direction(theta[i], 0), 1, 240), duer[i], 1e-5);
    }
    static const double gmd[3] = {.765428, .825086, .933182};
    for (int i = 0; i < 3; ++i) {
        struct sr_bsdf b = lobe("ward_gmd", 0.5, 0.5);
        EXPECT_RELATIVE(albedo_toward(&b, direction(theta[i], 0), 1, 240), gmd[i], 1e-5);
    }
    // E sqrt(cos) of 1992 tends to a constant
    struct sr_bsdf b = lobe("ward", 0.5, 0.5);
    double E = albedo_toward(&b, direction(89.9, 0), 1, 240), F = albedo_toward(&b, direction(89.99, 0), 1, 240);
    EXPECT_RELATIVE(F / E, sqrt(10), 0.03);
    EXPECT(F > 1);
}

TEST(ward_adds_its_matte_part)
{
    struct sr_bsdf b = specimen("ward", "reflectance", 0.4, "specular", 0.3, "alpha_x", 0.2, "alpha_y", 0.2, NULL);
    EXPECT_RELATIVE(albedo_toward(&b, direction(30, 0), 1, 240), 0.4 + 0.3 * 0.777279121, 5e-6);
    EXPECT_SAMPLES(&b, direction(30, 0), 1, 0.4 + 0.3 * 0.777279121);
}
