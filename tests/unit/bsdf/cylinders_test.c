/* SPDX-License-Identifier: MIT */
/* Parallel cylinders against rays that are traced between them, and independently computed reflectances. */
#include "albedos.h"

#define PI QUADRATURE_PI

/* does a ray from (y, z) toward w run into a cylinder? */
static bool is_hidden(double y, double z, sr_vec3 w, double d)
{
    double length = hypot((double)w.y, (double)w.z), uy = (double)w.y / length, uz = (double)w.z / length;
    for (int k = -12; k <= 12; ++k) {
        double cy = k * d - y, along = cy * uy - z * uz, across2 = cy * cy + z * z - along * along;
        bool from_it = fabs(cy * cy + z * z - 1) < 1e-9;
        if (!from_it && along > 0 && across2 < 1)
            return true;
    }
    return false;
}

static double facet(double ny, double nz, sr_vec3 wo, sr_vec3 wi, const double k[3])
{
    double o = ny * (double)wo.y + nz * (double)wo.z, i = ny * (double)wi.y + nz * (double)wi.z;
    double c = 2 * o * i - (double)sr_dot(wo, wi);
    return o > 0 && i > 0 ? (k[0] / PI + k[1] * (k[2] + 2) / (2 * PI) * (c > 0 ? pow(c, k[2]) : 0)) * o * i : 0;
}

static double traced(double d, double h, const double k[3], sr_vec3 wo, sr_vec3 wi)
{
    enum { POINTS = 20000 };
    double sum = 0, least = asin(h), half = sqrt(1 - h * h);
    for (int j = 0; j < POINTS; ++j) {
        double g = least + (PI - 2 * least) * (j + 0.5) / POINTS, y = half + (d - 2 * half) * (j + 0.5) / POINTS;
        if (!is_hidden(cos(g), sin(g), wo, d) && !is_hidden(cos(g), sin(g), wi, d))
            sum += facet(cos(g), sin(g), wo, wi, k) * (PI - 2 * least) / POINTS;
        if (!is_hidden(y, h, wo, d) && !is_hidden(y, h, wi, d))
            sum += facet(0, 1, wo, wi, k) * (d - 2 * half) / POINTS;
    }
    return sum / (d * (double)wo.z * (double)wi.z);
}

TEST(poulin_fournier_is_what_rays_find_between_cylinders)
{
    struct sr_bsdf b = bsdf_of("poulin_fournier reflectance=0.3 specular=0.5 distance=2.6 height=0.4 exponent=15");
    struct sr_bsdf dense = bsdf_of("poulin_fournier reflectance=0.3 specular=0.5 distance=2 height=0 exponent=200");
    struct sr_rng rng = sr_rng_seed(4, 1);
    for (int i = 0; i < 60; ++i) {
        sr_vec3 w[2];
        for (int k = 0; k < 2; ++k) {
            double theta = 88 * (double)sr_rng_float(&rng);
            w[k] = direction(theta, 360 * (double)sr_rng_float(&rng));
        }
        double f = traced(2.6, 0.4, (double[]){0.3, 0.5, 15}, w[0], w[1]),
               g = traced(2, 0, (double[]){0.3, 0.5, 200}, w[0], w[1]);
        EXPECT_NEAR(bsdf_value(&b, w[0], w[1]), f, 2e-3 * f + 1e-4);
        EXPECT_NEAR(bsdf_value(&dense, w[0], w[1]), g, 2e-3 * g + 1e-4);
    }
}

/* The figures for distance 2 and 3 across the cylinders are of a sum over rays, 40000 points of the profile by 400
 * directions. */
TEST(poulin_fournier_reflects_as_was_computed)
{
#define MATTE "poulin_fournier reflectance=1 specular=0 height=0 distance="
    struct sr_bsdf b = bsdf_of(MATTE "2");
    EXPECT_RELATIVE(bsdf_value(&b, direction(0, 0), direction(0, 0)), 0.25, 1e-6);
    EXPECT_NEAR(bsdf_value(&b, direction(30, 0), direction(45, 90)), 0.254911, 1e-6);
    const double theta[] = {0, 30, 60, 80}, two[] = {0.80200, 0.80667, 0.85365, 0.93410},
                 three[] = {0.79565, 0.78409, 0.73774, 0.89435};
    struct sr_bsdf wide = bsdf_of(MATTE "3");
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(bsdf_albedo(&b, theta[i], 90), two[i], 4e-5);
        EXPECT_NEAR(bsdf_albedo(&wide, theta[i], 90), three[i], 4e-5);
        EXPECT_NEAR(bsdf_albedo(&b, theta[i], 0), 0.80200, 4e-5);
        EXPECT_NEAR(bsdf_albedo(&wide, theta[i], 0), 0.79565, 4e-5);
    }
}

TEST(poulin_fournier_does_not_care_which_way_light_goes)
{
    struct sr_bsdf b = bsdf_of("poulin_fournier exponent=100 distance=2.5 height=0.3");
    EXPECT(bsdf_asymmetry(&b, 20000) < 1e-3);
}

/* drawn along the cylinders' ring of mirror directions, no sample weighs much */
TEST(poulin_fournier_draws_where_the_ring_is)
{
    struct sr_bsdf b = bsdf_of("poulin_fournier reflectance=0 specular=1 exponent=400");
    struct sr_rng rng = sr_rng_seed(6, 1);
    sr_vec3 wo = direction(50, 20);
    for (int i = 0; i < 5000; ++i) {
        float u = sr_rng_float(&rng), v = sr_rng_float(&rng);
        struct sr_bsdf_sample s;
        if (sr_bsdf_sample(&b, wo, sr_rng_float(&rng), (sr_vec2){u, v}, SR_IMPORTANCE, &s))
            EXPECT((double)(s.f[0] * fabsf(s.wi.z) / s.pdf) < 1.5);
    }
}
