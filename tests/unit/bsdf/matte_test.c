/* SPDX-License-Identifier: MIT */
/* Rough matte surfaces and limb darkening, against independently computed reflectances and closed forms. */
#include "albedos.h"

TEST(oren_nayar_reflects_as_its_equations_integrate)
{
    EXPECT_ALBEDO("oren_nayar reflectance=0.9 sigma=0.5235987756 variant=qualitative", 0.695798, 0.732880, 0.786699,
                  0.829379);
    EXPECT_ALBEDO("oren_nayar reflectance=0.9 sigma=0.5235987756", 0.789205, 0.791965, 0.817478, 0.861554);
    EXPECT_ALBEDO("oren_nayar reflectance=1 sigma=0.5 variant=qualitative", 0.784482758691, 0.82472469096,
                  0.883128419881, 0.92944459343);
    EXPECT_ALBEDO("oren_nayar reflectance=1 sigma=0.5", 0.896325, 0.899320, 0.927006, 0.974838);
}

TEST(oren_nayar_without_slopes_is_lambert)
{
    EXPECT_ALBEDO("oren_nayar reflectance=0.7 sigma=0", 0.7, 0.7, 0.7, 0.7);
    EXPECT_ALBEDO("oren_nayar reflectance=0.7 sigma=0 variant=qualitative", 0.7, 0.7, 0.7, 0.7);
}

/* the values of the full model's own equation, in double and by trigonometry, at each branch */
TEST(oren_nayar_full_is_the_published_equation)
{
    const double s2 = 0.6 * 0.6, rho = 0.4, pi = QUADRATURE_PI;
    struct sr_bsdf b = bsdf_of("oren_nayar reflectance=0.4 sigma=0.6");
    for (int i = 0; i < 400; ++i) {
        double ti = 89.5 * (i % 20) / 19, to = 89.9 * ((i / 20) % 5) / 4, phi = 180 * (i / 100) / 3.0 + 1;
        double alpha = (ti > to ? ti : to) * pi / 180, beta = (ti > to ? to : ti) * pi / 180, c = cos(phi * pi / 180);
        double C1 = 1 - 0.5 * s2 / (s2 + 0.33), C3 = 0.125 * s2 / (s2 + 0.09) * pow(4 * alpha * beta / (pi * pi), 2);
        double C2 = 0.45 * s2 / (s2 + 0.09) * (c >= 0 ? sin(alpha) : sin(alpha) - pow(2 * beta / pi, 3));
        double f = rho / pi * (C1 + c * C2 * tan(beta) + (1 - fabs(c)) * C3 * tan((alpha + beta) / 2)) +
                   0.17 * rho * rho / pi * s2 / (s2 + 0.13) * (1 - c * pow(2 * beta / pi, 2));
        EXPECT_NEAR(bsdf_value(&b, direction(to, 10), direction(ti, 10 + phi)), f, 2e-5 * f + 1e-6);
    }
}

TEST(eon_keeps_all_light_and_fon_loses_what_it_should)
{
    EXPECT_ALBEDO("eon reflectance=1 roughness=1", 1, 1, 1, 1);
    EXPECT_ALBEDO("eon reflectance=1 roughness=0.3", 1, 1, 1, 1);
    EXPECT_ALBEDO("eon reflectance=0.8 roughness=0.5", 0.778234, 0.779408, 0.786883, 0.795563);
    EXPECT_ALBEDO("eon variant=fon reflectance=0.8 roughness=0.5", 0.699364, 0.704790, 0.739351, 0.779484);
    EXPECT_ALBEDO("eon variant=fon reflectance=1 roughness=1", 0.776522, 0.788571, 0.865320, 0.954442);
    EXPECT_ALBEDO("eon variant=fon reflectance=1 roughness=0.5", 0.874204808855, 0.880987224927, 0.924188697546,
                  0.97435554002);
    EXPECT_ALBEDO("eon reflectance=0.3 roughness=0", 0.3, 0.3, 0.3, 0.3);
}

TEST(minnaert_reflects_by_powers_of_the_cosines)
{
    EXPECT_ALBEDO("minnaert reflectance=0.8 k=1.5", 0.8, 0.744484, 0.565685, 0.333369);
    EXPECT_ALBEDO("minnaert reflectance=0.8 k=1", 0.8, 0.8, 0.8, 0.8);
    // more than arrives, as documented; Gauss's panels converge slowly on cos^(k-1): a finer word about k < 1 is the
    // closed form
    EXPECT_ALBEDO("minnaert reflectance=0.8 k=0.75", 0.8, 0.829292, 0.951366, 1.239289);
    // f = (A / pi) (mu mu0)^(k - 1) with A = 0.5
    EXPECT_ALBEDO("minnaert reflectance=0.5555555556 k=0.8", 0.555555555556, 0.57177000498, 0.638165752776,
                  0.788485023771);
}

/* with its mirror, which no quadrature sees: E = R + reflectance (1 - R) */
TEST(coupled_gives_its_matter_what_its_mirror_leaves)
{
    struct sr_bsdf b = bsdf_of("coupled reflectance=0.5 specular=0.05"),
                   white = bsdf_of("coupled reflectance=1 specular=0.3");
    const double theta[] = {0, 30, 60, 80}, expected[] = {0.525000, 0.525021, 0.539844, 0.708028};
    for (int i = 0; i < 4; ++i) {
        sr_vec3 wo = direction(theta[i], 40);
        double R = 0.05 + 0.95 * pow(1 - (double)wo.z, 5);
        EXPECT_RELATIVE(bsdf_albedo(&b, theta[i], 40) + R, expected[i], 3e-6);
        EXPECT_RELATIVE(b.model->albedo(b.data, wo)[0], expected[i], 3e-6);
        EXPECT_RELATIVE(albedo_by_samples(&b, wo, 1, 20000), expected[i], 1e-3);
        EXPECT_RELATIVE(white.model->albedo(white.data, wo)[0], 1, 1e-6);
    }
}

TEST(matte_models_do_not_care_which_way_light_goes)
{
    const char *models[] = {"oren_nayar sigma=0.7",
                            "oren_nayar variant=qualitative sigma=0.7",
                            "eon roughness=1",
                            "eon variant=fon roughness=1",
                            "minnaert k=0.6",
                            "minnaert k=2",
                            "coupled"};
    for (size_t i = 0; i < sizeof models / sizeof models[0]; ++i) {
        struct sr_bsdf b = bsdf_of(models[i]);
        EXPECT(bsdf_asymmetry(&b, 20000) < 2e-6);
    }
}
