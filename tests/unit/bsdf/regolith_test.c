/* SPDX-License-Identifier: MIT */
/* Dust, the Moon and Hapke's regolith against closed forms and independently computed reflectances. */
#include "albedos.h"

TEST(lommel_seeliger_reflects_by_its_closed_form)
{
    EXPECT_ALBEDO("lommel_seeliger albedo=0.5", 0.076713, 0.083799, 0.112673, 0.167046);
    EXPECT_ALBEDO("lommel_seeliger albedo=0.9", 0.138083768748, 0.150837336449, 0.20281223505, 0.300683674743);
    struct sr_bsdf b = bsdf_of("lommel_seeliger albedo=0.4");
    EXPECT_RELATIVE(bsdf_value(&b, direction(0, 0), direction(0, 0)) * 1000, 15.9155, 1e-5); // cd/m2 of 1000 lx
}

TEST(lunar_reflects_as_its_equations_integrate)
{
    EXPECT_ALBEDO("lunar reflectance=1 compaction=0.6 forward=0.1", 0.342167, 0.351406, 0.398022, 0.509509);
}

/* R(0) = 2, phase 1: f = 2 / (3 pi) rho 2 / (2 mu): at full phase a half Moon's limb is as bright as its middle in f
 * cos */
TEST(lunar_full_phase_doubles_and_has_no_limb)
{
    struct sr_bsdf b = bsdf_of("lunar reflectance=0.3 compaction=0.4 forward=0.2");
    for (double t = 0; t < 85; t += 12) {
        double L = bsdf_value(&b, direction(t, 30), direction(t, 30)) * cos(t * QUADRATURE_PI / 180);
        EXPECT_RELATIVE(L, 0.3 * 2 / (3 * QUADRATURE_PI), 1e-4); // 1e-4: the cusp magnifies rounding of the angle
    }
    // beyond a quarter turn shadows no longer count: half phase, f = 2 rho / (3 pi) (1 / pi + t) / (mu0 + mu)
    double mu = sqrt(0.5), f = 0.3 * 2 / (3 * QUADRATURE_PI) * (1 / QUADRATURE_PI + 0.2) / (2 * mu);
    EXPECT_RELATIVE(bsdf_value(&b, direction(45, 0), direction(45, 180)), f, 1e-5);
}

TEST(dust_covers_its_base_by_its_optical_thickness)
{
    EXPECT_ALBEDO("dust albedo=0.5 thickness=0.5 reflectance=0", 0.057217, 0.064207, 0.095871, 0.163473);
    EXPECT_ALBEDO("dust albedo=0.5 thickness=0 reflectance=0.3", 0.3, 0.3, 0.3, 0.3);
    EXPECT_ALBEDO("dust albedo=0.5 thickness=50 reflectance=0.3", 0.076713, 0.083799, 0.112673,
                  0.167046); // Lommel-Seeliger
    struct sr_bsdf b = bsdf_of("dust albedo=0 thickness=0.2 reflectance=0.5");
    EXPECT_RELATIVE(bsdf_value(&b, direction(60, 0), direction(0, 0)), 0.5 / QUADRATURE_PI * exp(-0.2 * 3), 1e-5);
}

TEST(hapke_reflects_as_its_equations_integrate)
{
#define REGOLITH "hapke albedo=0.3 b=0.3 c=0.4 surge=1 surge_width=0.06"
    EXPECT_ALBEDO(REGOLITH, 0.081000, 0.084252, 0.098713, 0.128649);
    EXPECT_ALBEDO(REGOLITH " theta_bar=20", 0.078036, 0.080716, 0.086067, 0.089164);
    EXPECT_ALBEDO(REGOLITH " version=1981", 0.080428, 0.083585, 0.097583, 0.126558);
}

TEST(hapke_of_isotropic_grains)
{
#define ISOTROPIC "hapke b=0 c=0 surge=0"
    EXPECT_ALBEDO(ISOTROPIC " albedo=1", 0.985565, 0.985835, 0.986990, 0.989417);
    EXPECT_ALBEDO(ISOTROPIC " albedo=1 version=1981", 1.039721, 1.030831, 1.000000, 0.967445);
    EXPECT_ALBEDO(ISOTROPIC " albedo=0.9 version=1981", 0.404754959068, 0.423913459401, 0.486743912359, 0.566352568368);
}

/* the value of f at one place by Hapke's formula, with a phase law by Legendre, both surges, and no relief */
TEST(hapke_puts_surges_and_phase_together)
{
    struct sr_bsdf b = bsdf_of("hapke albedo=0.6 phase=legendre b=-0.4 c=0.2 surge=0.8 surge_width=0.05 coherent=0.5 "
                               "coherent_width=0.1 version=1981");
    const double w = 0.6, to = 20, ti = 35, deg = QUADRATURE_PI / 180, a = (ti - to) * deg, y = tan(a / 2) / 0.1;
    double mu = cos(to * deg), mu0 = cos(ti * deg), gamma = sqrt(1 - w);
    double H = (1 + 2 * mu) / (1 + 2 * mu * gamma), H0 = (1 + 2 * mu0) / (1 + 2 * mu0 * gamma);
    double p = 1 - 0.4 * cos(a) + 0.2 * (1.5 * cos(a) * cos(a) - 0.5), B = 0.8 / (1 + tan(a / 2) / 0.05);
    double C = 0.5 * (1 + (1 - exp(-y)) / y) / (2 * (1 + y) * (1 + y));
    double f = w / (4 * QUADRATURE_PI) / (mu + mu0) * ((1 + B) * p + H * H0 - 1) * (1 + C);
    EXPECT_RELATIVE(bsdf_value(&b, direction(to, 0), direction(ti, 0)), f, 1e-5);
}

/* Hapke 1984 in its own words, both branches; at opposition nothing that is lit is hidden: S mu_0e / mu_0 =
 * chi-symmetric */
TEST(hapke_relief_is_the_published_shadowing)
{
    struct sr_bsdf rough = bsdf_of("hapke albedo=0.3 b=0 c=0 surge=0 version=1981 theta_bar=25");
    const double pi = QUADRATURE_PI, T = tan(25 * pi / 180), X = 1 / sqrt(1 + pi * T * T), w = 0.3, gamma = sqrt(1 - w);
    for (int k = 0; k < 300; ++k) {
        double i = (2 + 86.0 * (k % 10) / 9) * pi / 180, e = (5 + 84.0 * (k / 10 % 6) / 5) * pi / 180,
               psi = pi * (k / 60) / 4.01;
        double cot = 1 / T, E1i = exp(-2 * cot / tan(i) / pi), E1e = exp(-2 * cot / tan(e) / pi);
        double E2i = exp(-cot * cot / tan(i) / tan(i) / pi), E2e = exp(-cot * cot / tan(e) / tan(e) / pi);
        double eta_i = X * (cos(i) + sin(i) * T * E2i / (2 - E1i)), eta_e = X * (cos(e) + sin(e) * T * E2e / (2 - E1e));
        double half = pow(sin(psi / 2), 2), fs = exp(-2 * tan(psi / 2)), mu0e, mue, S;
        if (i <= e) {
            double K = 2 - E1e - psi / pi * E1i;
            mu0e = X * (cos(i) + sin(i) * T * (cos(psi) * E2e + half * E2i) / K);
            mue = X * (cos(e) + sin(e) * T * (E2e - half * E2i) / K);
            S = mue / eta_e * cos(i) / eta_i * X / (1 - fs + fs * X * cos(i) / eta_i);
        } else {
            double K = 2 - E1i - psi / pi * E1e;
            mu0e = X * (cos(i) + sin(i) * T * (E2i - half * E2e) / K);
            mue = X * (cos(e) + sin(e) * T * (cos(psi) * E2i + half * E2e) / K);
            S = mue / eta_e * cos(i) / eta_i * X / (1 - fs + fs * X * cos(e) / eta_e);
        }
        double HH = (1 + 2 * mu0e) / (1 + 2 * mu0e * gamma) * (1 + 2 * mue) / (1 + 2 * mue * gamma);
        double f = w / (4 * pi) * mu0e / (mu0e + mue) * HH * S / cos(i);
        EXPECT_NEAR(bsdf_value(&rough, direction(e * 180 / pi, 15), direction(i * 180 / pi, 15 + psi * 180 / pi)), f,
                    3e-5 * f);
    }
}

TEST(regolith_does_not_care_which_way_light_goes)
{
    const char *models[] = {"lommel_seeliger",     "lunar", "dust g=0.5", REGOLITH, REGOLITH " theta_bar=30",
                            REGOLITH " coherent=1"};
    for (size_t i = 0; i < sizeof models / sizeof models[0]; ++i) {
        struct sr_bsdf b = bsdf_of(models[i]);
        EXPECT(bsdf_asymmetry(&b, 20000) < 1e-4);
    }
}
