/* SPDX-License-Identifier: MIT */
/* Sheen against what it was fitted to, simulated anew, and against the authors' own table. */
#include "quadrature.h"

/* Where the table of the paper's code has nodes (tizian/ltc-sheen, Apache 2.0): the share of light, made from the same
 * layer by other means. alpha = i / 31, cos theta_o = j / 31. */
TEST(sheen_returns_what_the_authors_found)
{
    static const struct {
        int i, j;
        double R;
    } rows[9] = {{5, 1, .50797},  {7, 3, .35318},   {8, 7, .13964},  {9, 4, .35989},  {9, 10, .08309},
                 {10, 2, .53780}, {10, 15, .03460}, {11, 6, .31348}, {11, 31, .00224}};
    for (int k = 0; k < 9; ++k) {
        struct sr_bsdf b = specimen("sheen_ltc", "alpha", rows[k].i / 31.0, NULL);
        double theta = acos(rows[k].j / 31.0) * 180 / QUADRATURE_PI;
        double R = (double)b.model->albedo(b.data, direction(theta, 20))[0];
        EXPECT_NEAR(R, rows[k].R, 0.025 * rows[k].R + 5e-4);
        EXPECT_SAMPLES(&b, direction(theta, 20), 1, R);
    }
}

/* ---- the layer: a walk among mirroring flakes, by flakes that are accepted or refused in proportion to what is seen
 * ---- */

static double number(struct sr_rng *rng)
{
    return ((double)sr_rng_u32(rng) + 0.5) / 4294967296.0;
}

/* SGGX of S = diag(1, 1, sigma^2): normals S^1/2 y of points y even over the sphere, by how much of each is seen. */
static bool leaves(double alpha, sr_vec3 view, struct sr_rng *rng, double w[3])
{
    double sigma = alpha * alpha, d[3] = {-(double)view.x, -(double)view.y, -(double)view.z}, depth = 0;
    for (;;) {
        double area = sqrt(d[0] * d[0] + d[1] * d[1] + sigma * sigma * d[2] * d[2]);
        depth -= d[2] * -log(number(rng)) / area;
        if (depth < 0 || depth > 1)
            break;
        double m[3], seen, length;
        do {
            double z = 2 * number(rng) - 1, phi = 2 * QUADRATURE_PI * number(rng), r = sqrt(1 - z * z);
            m[0] = r * cos(phi), m[1] = r * sin(phi), m[2] = sigma * z;
            length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
            seen = -(m[0] * d[0] + m[1] * d[1] + m[2] * d[2]); // <= area
        } while (!(number(rng) * area < seen));
        for (int i = 0; i < 3; ++i)
            d[i] += 2 * seen / (length * length) * m[i];
    }
    memcpy(w, d, 3 * sizeof *w);
    return depth < 0;
}

TEST(sheen_is_the_light_of_a_layer_of_fibres)
{
    enum { WALKS = 20000, RINGS = 4, SECTORS = 4 };
    static const double alpha[3] = {0.33, 0.6, 0.93}, theta[3] = {25, 62, 84}, elsewhere[3] = {0.20, 0.12, 0.12};
    struct sr_rng rng = sr_rng_seed(3, 5);
    for (int k = 0; k < 9; ++k) {
        double a = alpha[k / 3], n = 0, cells[RINGS][SECTORS] = {{0}}, model[RINGS][SECTORS] = {{0}}, apart = 0;
        struct sr_bsdf b = specimen("sheen_ltc", "alpha", a, NULL);
        sr_vec3 wo = direction(theta[k % 3], 0);
        for (int i = 0; i < WALKS; ++i) {
            double w[3];
            if (!leaves(a, wo, &rng, w))
                continue;
            n += 1;
            int ring = (int)(RINGS * w[2] * w[2]),
                sector = (int)(SECTORS * acos(w[0] / hypot(w[0], w[1])) / QUADRATURE_PI);
            cells[ring < RINGS ? ring : RINGS - 1][sector < SECTORS ? sector : SECTORS - 1] += 1;
        }
        double R = (double)b.model->albedo(b.data, wo)[0];
        EXPECT_NEAR(R, n / WALKS, 4 * sqrt(R / WALKS) + 0.004);
        for (int i = 0; i < 1 << 16; ++i) { // the model's directions, by its own sampler
            struct sr_bsdf_sample s;
            float x = (float)number(&rng) * SR_ONE_MINUS_EPSILON, y = (float)number(&rng) * SR_ONE_MINUS_EPSILON;
            if (!sr_bsdf_sample(&b, wo, 0, (sr_vec2){x, y}, SR_RADIANCE, &s))
                continue;
            double c = (double)s.wi.x / hypot((double)s.wi.x, (double)s.wi.y);
            int ring = (int)(RINGS * s.wi.z * s.wi.z), sector = (int)(SECTORS * acos(c) / QUADRATURE_PI);
            model[ring < RINGS ? ring : RINGS - 1][sector < SECTORS ? sector : SECTORS - 1] += 1.0 / (1 << 16);
        }
        for (int i = 0; i < RINGS * SECTORS; ++i)
            apart += fabs(cells[i / SECTORS][i % SECTORS] / n - model[i / SECTORS][i % SECTORS]) / 2;
        EXPECT(apart < elsewhere[k / 3] + 4 / sqrt(n)); // of the light, where the fit sends it elsewhere
    }
}
