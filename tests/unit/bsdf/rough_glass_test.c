/* SPDX-License-Identifier: MIT */
/* Ground glass of index 1.5 against independently computed shares of reflected and transmitted light, for each way of
 * masking what passes, from outside and from inside, at 0, 30, 60 and 80 degrees. */
#include "quadrature.h"

static const double angles[4] = {0, 30, 60, 80};

enum { BETA, PRODUCT, SUM };

static struct sr_bsdf glass(int distribution, int masking, double alpha)
{
    return specimen("microfacet_dielectric", "distribution", (double)distribution, "masking", (double)masking,
                    "alpha_x", alpha, "alpha_y", alpha, NULL);
}
static sr_vec3 from(int side, double theta)
{
    sr_vec3 w = direction(theta, 30);
    w.z *= (float)side;
    return w;
}

static double share(const struct sr_bsdf *b, sr_vec3 wo, int side, double alpha)
{
    return albedo_by_facets(b, wo, side, 1.5, alpha);
}

/* From inside and straight on: integrals over one angle, split where total reflection begins. */
static const struct {
    double alpha;
    int side;
    double R[4], sum[4], product[4], beta[4];
} rows[] = {
    {.1,
     1,
     {.039637, .041663, .085882, .255755},
     {.959198, .956545, .906365, .687656},
     {.959198, .956545, .906355, .687441},
     {.959198, .956545, .906348, .687293}},
    {.3,
     1,
     {.035597, .037608, .060983, .124530},
     {.952793, .945140, .887517, .776590},
     {.952793, .945109, .886349, .757291},
     {.952793, .945088, .885544, .740313}},
    {.5,
     1,
     {.028175, .029831, .043935, .082835},
     {.939932, .924850, .848696, .757577},
     {.939932, .924544, .839760, .678763},
     {.939932, .924339, .832974, .599913}},
    {.1,
     -1,
     {.042542, .105415, .940337, .875191},
     {.946421, .879783, .023048, .008185},
     {.946421, .879780, .023035, .008095},
     {.946421, .879779, .023025, .008014}},
    {.3,
     -1,
     {.048742, .183931, .653744, .731028},
     {.850747, .686404, .131079, .039412},
     {.850747, .686275, .129681, .034208},
     {.850747, .686190, .128424, .028926}},
    {.5,
     -1,
     {.046162, .155562, .434486, .598924},
     {.707707, .564751, .225266, .069992},
     {.707707, .564182, .217617, .050659},
     {.707707, .563789, .210526, .031333}},
};

/* By facets, as over directions f begins with steps and kinks: where m lies in the surface, and where total reflection
 * begins. */
TEST(ground_glass_shares_light_out_as_quadrature_says)
{
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 4; ++k) {
            struct sr_bsdf beta = glass(0, BETA, rows[i].alpha), product = glass(0, PRODUCT, rows[i].alpha),
                           sum = glass(0, SUM, rows[i].alpha);
            sr_vec3 wo = from(rows[i].side, angles[k]);
            double tolerance = 6e-7; // the tables have six digits
            double R = share(&beta, wo, 1, rows[i].alpha), T = share(&beta, wo, -1, rows[i].alpha);
            EXPECT_NEAR(R, rows[i].R[k], tolerance + 1e-5 * rows[i].R[k]);
            EXPECT_NEAR(T, rows[i].beta[k], tolerance + 1e-5 * rows[i].beta[k]);
            EXPECT_NEAR(share(&product, wo, -1, rows[i].alpha), rows[i].product[k],
                        tolerance + 1e-5 * rows[i].product[k]);
            EXPECT_NEAR(share(&sum, wo, -1, rows[i].alpha), rows[i].sum[k], tolerance + 1e-5 * rows[i].sum[k]);
            EXPECT_SAMPLES(&beta, wo, 1, R);
            EXPECT_SAMPLES(&beta, wo, -1, T);
        }
}

/* Our dielectric masks by the sum: the same function, by another way of calculating. */
TEST(dielectric_is_ground_glass_masked_by_the_sum)
{
    struct sr_bsdf a = glass(0, SUM, 0.3), b = specimen("dielectric", "alpha_x", 0.3, "alpha_y", 0.3, NULL);
    struct sr_rng rng = sr_rng_seed(5, 6);
    for (int i = 0; i < 1000; ++i) {
        sr_vec3 wo = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        float p, q;
        sr_spectrum f = sr_bsdf_f_pdf(&a, wo, wi, SR_RADIANCE, &p), g = sr_bsdf_f_pdf(&b, wo, wi, SR_RADIANCE, &q);
        EXPECT_NEAR(f[0], g[0], 1e-4f * g[0]);
        EXPECT_NEAR(p, q, 1e-4f * q);
    }
}

/* Walter's own: product masking on both sides. */
TEST(ground_glass_as_walter_made_it_loses_what_is_known)
{
    static const struct {
        double alpha, theta, R, T;
    } walter[] = {{.1, 60, 0.0858698, 0.9063545}, {.1, 80, 0.2542620, 0.6874408}, {.5, 0, 0.0281748, 0.9399317},
                  {.5, 30, 0.0297619, 0.9245436}, {.5, 60, 0.0428549, 0.8397604}, {.5, 80, 0.0733426, 0.6787626}};
    for (int i = 0; i < 6; ++i) {
        struct sr_bsdf b = glass(0, PRODUCT, walter[i].alpha);
        EXPECT_RELATIVE(share(&b, from(1, walter[i].theta), 1, walter[i].alpha), walter[i].R, 3e-6);
        EXPECT_RELATIVE(share(&b, from(1, walter[i].theta), -1, walter[i].alpha), walter[i].T, 3e-6);
    }
}

/* Beckmann's reflection tends to the metal's with the same F; what it loses and passes adds up to less than 1. The
 * product of gammas is tested against its closed form at whole numbers by G' at Lambda = 0: B(1, 1 + b) = 1 / (1 + b).
 */
TEST(beckmann_glass_keeps_its_books)
{
    struct sr_bsdf b = specimen("beckmann_dielectric", "alpha_x", 0.3, "alpha_y", 0.3, NULL);
    struct sr_bsdf same = glass(1, BETA, 0.3);
    for (int k = 0; k < 4; ++k)
        for (int side = -1; side <= 1; side += 2) {
            sr_vec3 wo = from(side, angles[k]);
            double R = share(&b, wo, 1, 0.3), T = share(&b, wo, -1, 0.3);
            EXPECT(R + T < 1 + 1e-5 && R + T > 0.6);
            EXPECT_SAMPLES(&b, wo, 1, R);
            if (T > 1e-4)
                EXPECT_SAMPLES(&b, wo, -1, T);
            EXPECT_NEAR(share(&same, wo, -1, 0.3), T, 1e-6);
        }
    // straight on nothing is masked: f of all three ways agrees
    struct sr_bsdf product = glass(1, PRODUCT, 0.3), sum = glass(1, SUM, 0.3);
    sr_vec3 n = {0, 0, 1}, below = direction(170, 40);
    float f = sr_bsdf_f(&b, n, below, SR_RADIANCE)[0];
    EXPECT_RELATIVE(sr_bsdf_f(&product, n, below, SR_RADIANCE)[0], f, 1e-6);
    EXPECT_RELATIVE(sr_bsdf_f(&sum, n, below, SR_RADIANCE)[0], f, 1e-6);
}
