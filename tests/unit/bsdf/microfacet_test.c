/* SPDX-License-Identifier: MIT */
/* Surfaces of microfacets against published and independently computed reflectances, for 0, 30, 60 and 80 degrees: by
 * quadrature over all directions, and by the mean weight of samples. */
#include "quadrature.h"

static const double angles[4] = {0, 30, 60, 80};

enum { GGX, BECKMANN, PHONG, SMITH = 0, PRODUCT, V_CAVITY, CONDUCTOR = 0, SCHLICK, ONE };

/* alpha: for a quadrature over facets; 0: over all directions */
static void expect_albedos(const struct sr_bsdf *b, double phi, double alpha, const double expected[4],
                           double tolerance)
{
    for (int i = 0; i < 4; ++i) {
        sr_vec3 wo = direction(angles[i], phi);
        double E = alpha > 0 ? albedo_by_facets(b, wo, 1, 1, alpha) : albedo_toward(b, wo, 1, 240);
        EXPECT_RELATIVE(E, expected[i], tolerance);
        wo.z = -wo.z; // the other side is no different
        EXPECT_SAMPLES(b, wo, 1, expected[i]);
    }
}

static struct sr_bsdf white(int distribution, int masking, double alpha_x, double alpha_y)
{
    return specimen("microfacet", "distribution", (double)distribution, "masking", (double)masking, "fresnel",
                    (double)ONE, "alpha_x", alpha_x, "alpha_y", alpha_y, NULL);
}

TEST(microfacets_reflect_what_their_masking_lets_through)
{
    static const struct {
        double alpha, correlated[4], product[4];
    } rows[] = {
        {0.1, {.988304, .986087, .969205, .895519}, {.988304, .986085, .969115, .891971}},
        {0.3,
         {.877358415789, .863872895533, .821711003151, .848232379451},
         {.877358415789, .86362169332, .818133486743, .821077813807}},
        {0.5, {.687849, .683052, .698251, .805323}, {.687849, .681647, .686007, .746902}},
        {1, {.306853, .335194, .450694, .668186}, {.306853, .328884, .409137, .522904}},
    };
    for (int i = 0; i < 4; ++i) {
        struct sr_bsdf a = white(GGX, SMITH, rows[i].alpha, rows[i].alpha);
        struct sr_bsdf b = white(GGX, PRODUCT, rows[i].alpha, rows[i].alpha);
        expect_albedos(&a, 20, rows[i].alpha, rows[i].correlated, i == 1 ? 5e-7 : 2e-6); // six digits, or twelve
        expect_albedos(&b, 20, rows[i].alpha, rows[i].product, i == 1 ? 5e-7 : 2e-6);
    }
    struct sr_bsdf closed = white(GGX, SMITH, 1, 1);
    EXPECT_NEAR(albedo_toward(&closed, direction(0, 0), 1, 240), 1 - log(2), 1e-6);
}

TEST(microfacets_of_two_widths_reflect_by_azimuth)
{
    static const double expected[3][4] = {{.878205, .876300, .861860, .801311},
                                          {.878205, .869312, .838413, .860780},
                                          {.878205, .863644, .835280, .884000}};
    struct sr_bsdf b = white(GGX, SMITH, 0.1, 0.4);
    for (int i = 0; i < 3; ++i)
        expect_albedos(&b, 45 * i, 0, expected[i], 1e-5);
}

TEST(beckmann_facets_reflect_what_quadrature_says)
{
    static const struct {
        double alpha, expected[4];
    } rows[] = {
        {0.2, {1.000000, .999877, .972364, .909446}},
        {0.3, {.999713154351, .991445180784, .923288712076, .916341289067}},
        {0.5, {.942998, .902793, .869360, .929020}},
    };
    for (int i = 0; i < 3; ++i) {
        struct sr_bsdf b = white(BECKMANN, SMITH, rows[i].alpha, rows[i].alpha);
        expect_albedos(&b, 70, rows[i].alpha, rows[i].expected, i == 1 ? 5e-7 : 2e-6);
        // the model of its own, with a metal so dense that it reflects all
        b = specimen("beckmann_conductor", "eta", 0.0, "k", 1.0, "alpha_x", rows[i].alpha, "alpha_y", rows[i].alpha,
                     NULL);
        expect_albedos(&b, 70, rows[i].alpha, rows[i].expected, i == 1 ? 5e-7 : 2e-6);
    }
}

TEST(microfacets_bear_their_fresnel)
{
    static const double metal[4] = {.809994, .797035, .756184, .782682},
                        schlick[4] = {.035127, .035179, .051124, .118601};
    struct sr_bsdf b = specimen("microfacet", "eta", 0.2, "k", 3.0, "alpha_x", 0.3, "alpha_y", 0.3, NULL);
    expect_albedos(&b, 0, 0.3, metal, 2e-6);
    b = specimen("conductor", "eta", 0.2, "k", 3.0, "alpha_x", 0.3, "alpha_y", 0.3, NULL);
    expect_albedos(&b, 0, 0.3, metal, 2e-6);
    b = specimen("microfacet", "fresnel", (double)SCHLICK, "specular", 0.04, "alpha_x", 0.3, "alpha_y", 0.3, NULL);
    expect_albedos(&b, 0, 0.3, schlick, 1.5e-5);
}

/* In six digits: V-cavities have creases. */
TEST(cook_torrance_reflects_what_quadrature_says)
{
    static const struct {
        double alpha, expected[4];
    } rows[] = {
        {0.2, {.999980, .998851, .965587, .933892}},
        {0.3, {.9955783, .9811940, .9247656, .9449153}},
        {0.5, {.892423, .875045, .886876, .955095}},
    };
    for (int i = 0; i < 3; ++i) {
        struct sr_bsdf b = specimen("cook_torrance", "alpha", rows[i].alpha, "reflectance", 0.0, "specular", 1.0, "eta",
                                    0.0, "k", 1.0, NULL);
        expect_albedos(&b, 0, 0, rows[i].expected, 1e-5);
        b = white(BECKMANN, V_CAVITY, rows[i].alpha, rows[i].alpha);
        expect_albedos(&b, 0, 0, rows[i].expected, 1e-5);
    }
    // the matte part adds its share, the other constant is 4 / pi as bright
    struct sr_bsdf b =
        specimen("cook_torrance", "alpha", 0.3, "reflectance", 0.3, "specular", 0.7, "eta", 0.0, "k", 1.0, NULL);
    EXPECT_RELATIVE(albedo_toward(&b, direction(30, 0), 1, 240), 0.3 + 0.7 * 0.981194, 1e-5);
    b = specimen("cook_torrance", "alpha", 0.3, "reflectance", 0.0, "specular", 1.0, "eta", 0.0, "k", 1.0, "constant",
                 1.0, NULL);
    EXPECT_RELATIVE(albedo_toward(&b, direction(30, 0), 1, 240), 4 / QUADRATURE_PI * 0.981194, 1e-5);
}

/* Where no light bounces twice, Fresnel's share of a nearly flat surface is that of a mirror. */
TEST(cook_torrance_tends_to_a_mirror)
{
    struct sr_bsdf b = specimen("cook_torrance", "alpha", 0.01, "reflectance", 0.0, "specular", 1.0, NULL);
    for (int i = 0; i < 3; ++i)
        EXPECT_RELATIVE(sampled_weights(&b, direction(angles[i], 0), 1, 1 << 14).mean,
                        sr_fresnel_dielectric((float)cos(angles[i] * QUADRATURE_PI / 180), 1.5f), 2e-3);
}

struct tilts {
    double alpha, scale;
};
static double tilted(const void *context, sr_vec3 m)
{
    const struct tilts *t = context;
    double theta = acos((double)m.z);
    return exp(-theta * theta / (t->alpha * t->alpha)) * (double)m.z;
}

/* At normal incidence and in the mirror's direction f = D(n) / 4: 1 / (4 N') with N' the facets' area by quadrature. */
TEST(torrance_sparrow_covers_the_surface_once)
{
    static const double alpha[4] = {0.05, 0.2, 0.5, 1};
    for (int i = 0; i < 4; ++i) {
        struct sr_bsdf b = specimen("torrance_sparrow", "alpha", alpha[i], "reflectance", 0.0, "specular", 1.0, "eta",
                                    0.0, "k", 1.0, NULL);
        double area = hemisphere_integral(tilted, &(struct tilts){.alpha = alpha[i]}, 1, 240);
        sr_vec3 n = {0, 0, 1};
        EXPECT_RELATIVE(sr_bsdf_f(&b, n, n, SR_RADIANCE)[0], 1 / (4 * area), 1e-5);
    }
}

/* Small tilts are slopes: Beckmann's facets in the same grooves are the limit, and no light is made. */
TEST(torrance_sparrow_tends_to_cook_torrance)
{
    for (int i = 0; i < 4; ++i) {
        struct sr_bsdf a = specimen("torrance_sparrow", "alpha", 0.05, NULL);
        struct sr_bsdf b = specimen("cook_torrance", "alpha", 0.05, NULL);
        sr_vec3 wo = direction(angles[i], 0);
        double E = albedo_toward(&a, wo, 1, 240);
        EXPECT_RELATIVE(E, albedo_toward(&b, wo, 1, 240), 2e-3);
        EXPECT_SAMPLES(&a, wo, 1, E);
        a = specimen("torrance_sparrow", "alpha", 0.7, NULL);
        EXPECT_SAMPLES(&a, wo, 1, albedo_toward(&a, wo, 1, 240));
    }
}

/* At normal incidence D / 4 is seen in the mirror's direction, and facets that are tilted by more than 45 degrees send
 * light below: the share (1/2)^((n + 2) / 2) of each azimuth, which the density lacks. */
TEST(phong_facets_are_normalised)
{
    struct sr_bsdf b = white(PHONG, V_CAVITY, 0.2, 0.2);
    sr_vec3 n = {0, 0, 1};
    EXPECT_RELATIVE(sr_bsdf_f(&b, n, n, SR_RADIANCE)[0], 1 / (4 * QUADRATURE_PI * 0.04), 1e-6);
    EXPECT_RELATIVE(sr_bsdf_pdf(&b, n, n, SR_RADIANCE), 1 / (4 * QUADRATURE_PI * 0.04), 1e-6);
    struct albedo_query q = {&b, n};
    EXPECT_NEAR(hemisphere_integral(pdf_integrand, &q, 1, 240), 1, 1e-5);
    b = white(PHONG, V_CAVITY, 0.2, 0.5); // two exponents: 48 and 6
    double below = 0;
    for (int i = 0; i < 360; ++i) // azimuths of facets by their slopes
        below +=
            pow(0.5, 1 / (pow(0.2 * cos(i * QUADRATURE_PI / 180), 2) + pow(0.5 * sin(i * QUADRATURE_PI / 180), 2)));
    EXPECT_NEAR(hemisphere_integral(pdf_integrand, &q, 1, 240), 1 - below / 360, 1e-5);
}
