/* SPDX-License-Identifier: MIT */
/* Charlie sheen: printed directional albedos, and where it gains light. */
#include "quadrature.h"

TEST(sheen_has_its_printed_albedos)
{
    static const double theta[4] = {0, 30, 60, 80};
    static const double half[4] = {1.0 / 12, .124507, .267132, .476357},
                        fifth[4] = {.019642, .051406, .212796, .538518};
    struct sr_bsdf a = specimen("sheen", "alpha", 0.5, NULL), b = specimen("sheen", "alpha", 0.2, NULL);
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(albedo_toward(&a, direction(theta[i], 0), 1, 320), half[i], 1e-6);
        EXPECT_NEAR(albedo_toward(&b, direction(theta[i], 0), 1, 320), fifth[i], 1e-6);
    }
    struct sr_bsdf c = specimen("sheen", "alpha", 0.1, NULL), d = specimen("sheen", "alpha", 0.3, NULL);
    EXPECT_NEAR(albedo_toward(&c, direction(85, 0), 1, 320), .826488, 3e-6);
    EXPECT_NEAR(albedo_toward(&c, direction(89, 0), 1, 640), 1.175364, 1e-4); // the documented gain
    EXPECT_NEAR(albedo_toward(&d, direction(89, 0), 1, 640), .798956, 1e-4);
}

/* Fitted masking is for real slopes' sake: nothing is gained at any angle. */
TEST(estevez_masking_keeps_sheen_below_one)
{
    static const double alpha[] = {0.1, 0.2, 0.4, 0.7, 1};
    for (int i = 0; i < 5; ++i) {
        struct sr_bsdf b = specimen("sheen", "alpha", alpha[i], "visibility", 1.0, NULL);
        for (int theta = 1; theta < 90; theta += 11)
            EXPECT(albedo_toward(&b, direction(theta, 0), 1, 160) < 1);
        EXPECT(albedo_toward(&b, direction(89.5, 0), 1, 640) < 1);
    }
}
