/* SPDX-License-Identifier: MIT */
/* Stray light of optics: the ABg and Harvey laws against closed forms and independently computed albedos. */
#include "quadrature.h"

/* In the plane of direction cosines about the mirror's point, where a narrow law is smooth: rings r = l sinh(x), cut by
 * the unit disk; the ring's part inside is known in closed form, so that one dimension is left. */
static double scattered(const struct sr_bsdf *b, double theta_deg, double width)
{
    double t = theta_deg * QUADRATURE_PI / 180, s = sin(t), x[8], w[8], sum = 0;
    double ends[3] = {0, asinh((1 - s) / width), asinh((1 + s) / width)};
    for (int part = 0; part < 2; ++part)
        for (int panel = 0; panel < 60; ++panel) {
            double step = (ends[part + 1] - ends[part]) / 60, e0, e1;
            // eased toward the ends, where the ring begins to be cut as a square root
            e0 = panel / 60.0, e1 = (panel + 1) / 60.0;
            sr_gauss_legendre(8, e0, e1, x, w);
            for (int i = 0; i < 8; ++i) {
                double y = x[i] * x[i] * (3 - 2 * x[i]);
                double a = ends[part] + 60 * step * y, r = width * sinh(a);
                double cut = (1 - r * r - s * s) / (2 * r * s); // |mirror + r e| < 1
                double inside = s <= 0 || cut >= 1 ? 1 : cut <= -1 ? 0 : 1 - acos(cut) / QUADRATURE_PI;
                // any direction at that distance: f knows r only
                double px = s - r, pz2 = 1 - px * px;
                if (!(pz2 > 0))
                    continue;
                sr_vec3 wi = {(float)px, 0, (float)sqrt(pz2)}, wo = {(float)-s, 0, (float)cos(t)};
                sum += w[i] * 6 * x[i] * (1 - x[i]) * 60 * step * width * cosh(a) * 2 * QUADRATURE_PI * r * inside *
                       (double)sr_bsdf_f(b, wo, wi, SR_RADIANCE)[0];
            }
        }
    return sum;
}

TEST(stray_light_is_as_tabulated_elsewhere)
{
    static const double angles[4] = {0, 30, 60, 80}, abg[4] = {.0413437, .0393575, .0325767, .0238851},
                        harvey[4] = {.001131, .001067, .000874, .000678};
    struct sr_bsdf a = specimen("abg", "A", 0.0025, "B", 0.001, "g", 1.8, NULL);
    struct sr_bsdf h = specimen("harvey", "b0", 0.1, "l", 0.01, "s", -1.5, NULL);
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(scattered(&a, angles[i], 0.02), abg[i], 6e-7);
        EXPECT_NEAR(scattered(&h, angles[i], 0.01), harvey[i], 6e-7);
        EXPECT_SAMPLES(&a, direction(angles[i], 40), 1, abg[i]);
        if (i > 0) // there every sample weighs the same
            EXPECT_SAMPLES(&h, direction(angles[i], 40), 1, scattered(&h, angles[i], 0.01));
    }
}

TEST(total_integrated_scatter_has_its_closed_forms)
{
    static const double B[3] = {1e-5, 1e-3, 0.5};
    for (int i = 0; i < 3; ++i) {
        struct sr_bsdf b = specimen("abg", "A", 0.001, "B", B[i], "g", 2.0, NULL);
        EXPECT_RELATIVE(scattered(&b, 0, sqrt(B[i])), QUADRATURE_PI * 0.001 * log(1 + 1 / B[i]), 1e-5);
    }
    struct sr_bsdf even = specimen("abg", "A", 0.1, "B", 1.0, "g", 0.0, NULL);
    EXPECT_RELATIVE(sr_bsdf_f(&even, direction(20, 0), direction(70, 130), SR_RADIANCE)[0], 0.05, 1e-6);
    static const double s[4] = {-0.5, -1.5, -2, -3.5};
    for (int i = 0; i < 4; ++i) {
        double l = 0.02, b0 = 0.2, p = 1 + s[i] / 2, x = log(1 + 1 / (l * l));
        double tis = QUADRATURE_PI * b0 * l * l * (p == 0 ? x : (exp(p * x) - 1) / p);
        struct sr_bsdf b = specimen("harvey", "b0", b0, "l", l, "s", s[i], NULL);
        EXPECT_RELATIVE(scattered(&b, 0, l), tis, 1e-5);
    }
}

/* Where both laws agree: shoulders B = l^2, A = b0 B for g = 2 = -s. */
TEST(abg_of_slope_two_is_harvey)
{
    struct sr_bsdf a = specimen("abg", "A", 4e-4, "B", 4e-4, "g", 2.0, "specular", 0.5, NULL);
    struct sr_bsdf h = specimen("harvey", "b0", 1.0, "l", 0.02, "s", -2.0, "specular", 0.5, NULL);
    for (int i = 0; i < 9; ++i) {
        sr_vec3 wo = direction(35, 10), wi = direction(10.0 * i, 185);
        EXPECT_RELATIVE(sr_bsdf_f(&a, wo, wi, SR_RADIANCE)[0], sr_bsdf_f(&h, wo, wi, SR_RADIANCE)[0], 1e-4);
    }
    EXPECT_SAMPLES(&a, direction(35, 10), 1, 0.5 + scattered(&a, 35, 0.02));
}

/* More than all the light is not given back: the height is lowered. */
TEST(stray_light_leaves_room_for_the_mirror)
{
    struct sr_bsdf a = specimen("abg", "A", 1.0, "B", 1e-4, "g", 2.5, "specular", 0.7, NULL);
    struct sr_bsdf h = specimen("harvey", "b0", 90.0, "l", 0.1, "s", -1.0, "specular", 0.7, NULL);
    double E = scattered(&a, 0, 0.03);
    EXPECT(E < 0.3 && E > 0.298);
    EXPECT_RELATIVE(scattered(&h, 0, 0.1), 0.3, 1e-5);
}
