/* SPDX-License-Identifier: MIT */
/* Phong's descendants against independently computed reflectances. */
#include "albedos.h"

TEST(blinn_phong_returns_all_that_arrives_along_the_normal)
{
    EXPECT_ALBEDO("blinn_phong reflectance=0 specular=1 exponent=20", 1, 0.775700, 0.327950, 0.110907);
    EXPECT_ALBEDO("blinn_phong reflectance=0 specular=1 exponent=50", 1, 0.7600030083, 0.280649183625, 0.0664218732579);
    EXPECT_ALBEDO("blinn_phong reflectance=0 specular=1 exponent=100", 1, 0.755000, 0.265058, 0.049448);
    EXPECT_ALBEDO("blinn_phong reflectance=0.3 specular=0.5 exponent=20", 0.8, 0.3 + 0.5 * 0.775700,
                  0.3 + 0.5 * 0.327950, 0.3 + 0.5 * 0.110907);
}

TEST(blinn_phong_with_the_usual_fit_makes_light)
{
    struct sr_bsdf b = bsdf_of("blinn_phong reflectance=0 specular=1 exponent=20 normalisation=energy_plus_8");
    EXPECT_NEAR(bsdf_albedo(&b, 0, 0), 1.060658, 1e-5);
    b = bsdf_of("blinn_phong reflectance=0 specular=1 exponent=100 normalisation=energy_plus_8");
    EXPECT_NEAR(bsdf_albedo(&b, 0, 0), 1.018100, 1e-5);
    b = bsdf_of("blinn_phong reflectance=0 specular=1 exponent=8.8 normalisation=energy_plus_8");
    double worst = bsdf_albedo(&b, 0, 0), documented = (double)b.model->largest_albedo;
    EXPECT(worst < documented && worst > documented - 2e-4);
}

TEST(phong_modified_reflects_as_the_cosine_while_its_lobe_is_whole)
{
    EXPECT_ALBEDO("phong_modified specular=1 exponent=20", 1, 0.866025, 0.500509, 0.200342);
    EXPECT_ALBEDO("phong_modified specular=1 exponent=50", 1, 0.866025403784, 0.500002112234, 0.180808032686);
    EXPECT_ALBEDO("phong_modified specular=1 exponent=100", 1, 0.866025, 0.500000, 0.175233);
}

TEST(ashikhmin_shirley_reflects_as_its_equations_integrate)
{
#define EVEN(n) "ashikhmin_shirley exponent_x=" #n " exponent_y=" #n
    EXPECT_ALBEDO(EVEN(100) " specular=1 reflectance=0", 0.961165, 0.933701, 0.845943, 0.659848);
    EXPECT_ALBEDO(EVEN(100) " specular=0.05 reflectance=0", 0.048058, 0.046801, 0.069181, 0.221629);
    EXPECT_ALBEDO(EVEN(100) " specular=0.05 reflectance=0.5", 0.508214509767, 0.493967771281, 0.431461030118,
                  0.395005533193);
#define BRUSHED "ashikhmin_shirley exponent_x=10 exponent_y=500 specular=1 reflectance=0"
    EXPECT_ALBEDO(BRUSHED, 0.836902, 0.798824, 0.666154, 0.557126);
    EXPECT_ALBEDO_ALONG(90, BRUSHED, 0.836902, 0.831872, 0.809932, 0.712381);
}

TEST(ashikhmin_shirley_matte_part_gives_way_to_the_surface)
{
    struct sr_bsdf with = bsdf_of(EVEN(100) " specular=0.05 reflectance=0.5"),
                   without = bsdf_of(EVEN(100) " specular=0.05 reflectance=0");
    const double theta[] = {0, 30, 60, 80}, expected[] = {0.460156, 0.447167, 0.362280, 0.173376};
    for (int i = 0; i < 4; ++i)
        EXPECT_NEAR(bsdf_albedo(&with, theta[i], 0) - bsdf_albedo(&without, theta[i], 0), expected[i], 5e-6);
}

TEST(lafortune_reflects_as_its_equations_integrate)
{
    EXPECT_ALBEDO("lafortune reflectance=0 specular=1 c_x=-0.95 c_y=-0.95 c_z=0.85 exponent=10 normalisation=none",
                  0.103083, 0.117167, 0.113137, 0.065603);
    struct sr_bsdf b =
        bsdf_of("lafortune reflectance=0 specular=1 c_x=0.2 c_y=0.1 c_z=0.7 exponent=6 normalisation=none");
    EXPECT_RELATIVE(bsdf_albedo(&b, 0, 0), 2 * QUADRATURE_PI / 8 * pow(0.7, 6), 1e-5);
}

TEST(lafortune_can_be_modified_phong_or_a_retroreflector)
{
    struct sr_bsdf phong = bsdf_of("phong_modified reflectance=0.1 specular=0.6 exponent=30");
    struct sr_bsdf mirror = bsdf_of("lafortune reflectance=0.1 specular=0.6 exponent=30 c_x=-1 c_y=-1 c_z=1");
    struct sr_bsdf back = bsdf_of("lafortune reflectance=0.1 specular=0.6 exponent=30 c_x=1 c_y=1 c_z=1");
    for (int k = 0; k < 50; ++k) {
        double to = 7.0 * (k % 10), ti = 15.0 * (k / 10), phi = 31.0 * k; // deg
        sr_vec3 wo = direction(to, 0), wi = direction(ti, phi), mirrored = {-wi.x, -wi.y, wi.z};
        EXPECT_RELATIVE(bsdf_value(&mirror, wo, wi), bsdf_value(&phong, wo, wi), 1e-5);
        EXPECT_RELATIVE(bsdf_value(&back, wo, mirrored), bsdf_value(&phong, wo, wi), 1e-5);
    }
}

/* Reflectances were computed for Strauss' own formula without 1 / pi and (e + 1) / (2 pi), under light from everywhere;
 * e = 7.5 */
TEST(strauss_reflects_as_its_equations_integrate)
{
    struct sr_bsdf b = bsdf_of("strauss smoothness=0.6 metalness=0.5 reflectance=0.5");
    const double theta[] = {0, 30, 60, 80}, raw[] = {0.984005, 0.987423, 0.998235, 0.978896};
    double diffuse = (1 - 0.5 * 0.6) * (1 - 0.6 * 0.6 * 0.6) * 0.5;
    for (int i = 0; i < 4; ++i) {
        double glossy = bsdf_albedo_in(&b, theta[i], 0, SR_RADIANCE) - diffuse;
        EXPECT_RELATIVE(QUADRATURE_PI * diffuse + glossy * 2 * QUADRATURE_PI / 8.5, raw[i], 1e-5);
    }
}

TEST(strauss_is_not_reciprocal_as_documented)
{
    struct sr_bsdf b = bsdf_of("strauss smoothness=0.6 metalness=0.5 reflectance=0.5");
    double asymmetry = bsdf_asymmetry(&b, 20000);
    EXPECT(asymmetry > 0.8 && asymmetry <= (double)b.model->asymmetry);
    // but the form for light paths is its adjoint
    sr_vec3 v = direction(20, 0), w = direction(70, 170);
    EXPECT_RELATIVE(sr_bsdf_f(&b, v, w, SR_RADIANCE)[0], sr_bsdf_f(&b, w, v, SR_IMPORTANCE)[0], 1e-6);
    EXPECT(fabs(bsdf_value(&b, v, w) / bsdf_value(&b, w, v) - 1) > 0.1);
}

TEST(highlights_do_not_care_which_way_light_goes)
{
    const char *models[] = {"blinn_phong exponent=200", "phong_modified exponent=200",
                            "ashikhmin_shirley exponent_x=20 exponent_y=300", "lafortune exponent=50 c_x=-0.9 c_y=0.5"};
    for (size_t i = 0; i < sizeof models / sizeof models[0]; ++i) {
        struct sr_bsdf b = bsdf_of(models[i]);
        EXPECT(bsdf_asymmetry(&b, 20000) < 1e-4);
    }
}

/* cos^n of a float cosine is lost where the lobe is narrow; by sine and cosine it is not: at n = 1e5, one thousandth of
 * a radian from the mirror direction, cos^n = exp(-n / 2 d^2). */
TEST(highlights_are_exact_where_they_are_narrow)
{
    const double n = 1e5, d = 1e-3 * 180 / QUADRATURE_PI;
    struct sr_bsdf phong = bsdf_of("phong_modified specular=1 exponent=100000");
    struct sr_bsdf blinn = bsdf_of("blinn_phong reflectance=0 specular=1 exponent=100000");
    double power = pow(cos(1e-3), n), power_h = pow(cos(0.5e-3), n), N = (n + 2) * (n + 4) / (8 * QUADRATURE_PI * n);
    EXPECT_RELATIVE(bsdf_value(&phong, direction(0, 0), direction(d, 70)), (n + 2) / (2 * QUADRATURE_PI) * power, 1e-4);
    EXPECT_RELATIVE(bsdf_value(&blinn, direction(0, 0), direction(d, 70)), N * power_h, 1e-4);
}
