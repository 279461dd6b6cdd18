/* SPDX-License-Identifier: MIT */
/* The exit from a translucent body: normalised, and drawn by its density. */
#include "quadrature.h"

TEST(all_that_comes_to_the_exit_leaves)
{
    static const float etas[] = {1, 1.33f, 1.8f, 0.75f};
    for (int i = 0; i < 4; ++i) {
        struct sr_bsdf b;
        sr_bsdf_exit_make(&b, etas[i]);
        double x[64], w[64], importance = 0, radiance = 0;
        sr_vec3 wo = direction(0, 0);
        // a root's end there: theta = end (1 - t^2)
        double end = etas[i] < 1 ? asin((double)etas[i]) : QUADRATURE_PI / 2;
        sr_gauss_legendre(64, 0, 1, x, w);
        for (int k = 0; k < 64; ++k) {
            w[k] *= 2 * end * x[k];
            x[k] = end * (1 - x[k] * x[k]);
            sr_vec3 wi = {(float)sin(x[k]), 0, (float)cos(x[k])};
            double weight = w[k] * 2 * QUADRATURE_PI * sin(x[k]) * cos(x[k]);
            importance += weight * (double)sr_bsdf_f(&b, wo, wi, SR_IMPORTANCE)[0];
            radiance += weight * (double)sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0];
            EXPECT(sr_spectrum_is_black(sr_bsdf_f(&b, wo, sr_neg(wi), SR_RADIANCE)));
        }
        EXPECT_NEAR(importance, 1, 2e-5);
        EXPECT_NEAR(radiance, etas[i] * etas[i], 4e-5);
    }
}
