/* SPDX-License-Identifier: MIT */
/* OpenPBR's surface: what it becomes where only one of its slabs is left, and that joined slabs keep the light's sum.
 */
#include "quadrature.h"

static void pair(struct sr_rng *rng, sr_vec3 w[2])
{
    for (int j = 0; j < 2; ++j)
        w[j] = direction(170 * (double)sr_rng_float(rng) + 5, 360 * (double)sr_rng_float(rng));
}
static void expect_equal(const struct sr_bsdf *a, const struct sr_bsdf *b, double tolerance)
{
    struct sr_rng rng = sr_rng_seed(51, 1);
    for (int i = 0; i < 1000; ++i) {
        sr_vec3 w[2];
        pair(&rng, w);
        for (int mode = 0; mode < 2; ++mode) {
            double expected = (double)sr_bsdf_f(b, w[0], w[1], (enum sr_transport)mode)[0];
            EXPECT_NEAR(sr_bsdf_f(a, w[0], w[1], (enum sr_transport)mode)[0], expected, tolerance * expected + 1e-7);
        }
    }
}

TEST(openpbr_glass_is_ground_glass)
{
    struct sr_bsdf a = specimen("openpbr", "transmission_weight", 1.0, "specular_roughness", 0.5, NULL);
    struct sr_bsdf b = specimen("dielectric", "alpha_x", 0.25, "alpha_y", 0.25, NULL);
    expect_equal(&a, &b, 1e-4);
}

/* Without gloss (specular_weight 0) the matte slab is EON itself. */
TEST(openpbr_matte_is_eon)
{
    struct sr_bsdf a =
        specimen("openpbr", "specular_weight", 0.0, "base_color", 0.7, "base_diffuse_roughness", 0.6, NULL);
    struct sr_bsdf b = specimen("eon", "reflectance", 0.7, "roughness", 0.6, NULL);
    double theta[3] = {10, 40, 70};
    for (int i = 0; i < 3; ++i) {
        double c = cos(theta[i] * QUADRATURE_PI / 180), E = albedo_toward(&b, direction(theta[i], 0), 1, 96);
        // where F0 is 0 Schlick's curve still moves a little light from grazing to steep directions
        EXPECT_RELATIVE(albedo_toward(&a, direction(theta[i], 0), 1, 96), E, 0.05 + 1.1 * pow(1 - c, 5));
    }
}

/* F82 at its three fixed points: F0 at the normal, specular_color times Schlick's at 81.8 deg, 1 at grazing. */
TEST(openpbr_metal_has_the_fresnel_curve_of_its_colours)
{
    struct sr_bsdf a = specimen("openpbr", "base_metalness", 1.0, "base_color", 0.6, "specular_color", 0.5,
                                "specular_roughness", 0.3, NULL);
    struct sr_bsdf b = specimen("openpbr", "base_metalness", 1.0, "base_color", 1.0, "specular_color", 1.0,
                                "specular_roughness", 0.3, NULL); // F = 1
    double theta[3] = {0, acos(1 / 7.0) * 180 / QUADRATURE_PI, 89.99},
           F[3] = {0.6, 0.5 * (0.6 + 0.4 * pow(6 / 7.0, 5)), 1};
    for (int i = 0; i < 3; ++i) {
        sr_vec3 wo = direction(theta[i], 0), wi = {-wo.x, -wo.y, wo.z};
        EXPECT_RELATIVE(sr_bsdf_f(&a, wo, wi, SR_RADIANCE)[0] / sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0], F[i], 2e-3);
    }
    EXPECT_RELATIVE(albedo_toward(&b, direction(30, 0), 1, 240), /* alpha = 0.09, single scattering */ 0.99, 0.01);
}

/* White and glossy: what the gloss does not take the matte returns, as a whole no less and no more than all. */
TEST(openpbr_gloss_over_white_keeps_the_sum)
{
    for (int k = 0; k < 3; ++k) {
        struct sr_bsdf b = specimen("openpbr", "base_color", 1.0, "specular_roughness", 0.3 + 0.2 * k, NULL);
        for (int theta = 0; theta < 80; theta += 25)
            EXPECT_NEAR(albedo_toward(&b, direction(theta, 0), 1, 240), 1, 0.02);
    }
}

/* A smooth coat over a matte base, gloss aside, is the coated Lambert surface of Saunderson: the coat's mirror left
 * out. */
TEST(openpbr_coat_over_matte_is_saundersons)
{
    struct sr_bsdf a = specimen("openpbr", "base_color", 0.5, "specular_ior", 1.5, "specular_weight", 0.0,
                                "coat_weight", 1.0, "coat_ior", 1.5, NULL);
    struct sr_bsdf b =
        specimen("coated_diffuse", "reflectance", 0.5, "coat_eta", 1.5, "thickness", 0.0, "max_depth", 100.0, NULL);
    for (int theta = 5; theta < 60; theta += 15) {
        sr_vec3 wo = direction(theta, 0), wi = direction(20, 120);
        EXPECT_RELATIVE(sr_bsdf_f(&a, wo, wi, SR_RADIANCE)[0], sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0], 0.04);
    }
}

/* A coat's colour is what light keeps there and back at normal incidence; it goes with the length of the way. */
TEST(openpbr_coat_color_is_its_transmittance)
{
    struct sr_bsdf a = specimen("openpbr", "coat_weight", 1.0, "coat_color", 0.4, NULL);
    struct sr_bsdf b = specimen("openpbr", "coat_weight", 1.0, "coat_color", 1.0, NULL);
    sr_vec3 n = direction(30, 0), w = direction(30, 90);
    double cosine = sqrt(1 - 0.25 / (1.6 * 1.6));
    EXPECT_RELATIVE(sr_bsdf_f(&a, n, w, SR_RADIANCE)[0] / sr_bsdf_f(&b, n, w, SR_RADIANCE)[0], pow(0.4, 1 / cosine),
                    1e-3);
}

TEST(openpbr_makes_no_light_under_any_layer)
{
    struct sr_rng rng = sr_rng_seed(52, 1);
    for (int set = 0; set < 60; ++set) {
        struct sr_bsdf b =
            specimen("openpbr", "base_color", 1.0, "base_metalness", set % 3 == 0 ? 1.0 : 0.0, "specular_roughness",
                     0.3 + 0.7 * (double)sr_rng_float(&rng), "coat_weight", set % 2 ? 1.0 : 0.0, "coat_roughness",
                     0.4 + 0.6 * (double)sr_rng_float(&rng), "coat_ior", 1.1 + (double)sr_rng_float(&rng),
                     "coat_darkening", (double)sr_rng_float(&rng), "fuzz_weight", set % 5 ? 0.0 : 1.0, NULL);
        double theta = 85 * (double)sr_rng_float(&rng);
        EXPECT(albedo_by_samples(&b, direction(theta, 0), 1, 4000) < (double)b.model->largest_albedo + 0.01);
    }
}

TEST(openpbr_thin_wall_is_a_pane)
{
    struct sr_bsdf b = specimen("openpbr", "transmission_weight", 1.0, "thin_walled", 1.0, "specular_roughness", 0.0,
                                "transmission_color", 0.5, NULL);
    for (int i = 0; i < 3; ++i) {
        float c = 1 - 0.3f * (float)i, s = sqrtf(1 - c * c), cos_t = sqrtf(1 - s * s / 2.25f);
        float rs = (c - 1.5f * cos_t) / (c + 1.5f * cos_t), rp = (1.5f * c - cos_t) / (1.5f * c + cos_t),
              F = (rs * rs + rp * rp) / 2;
        for (int side = -1; side <= 1; side += 2) {
            sr_vec3 wo = {s, 0, (float)side * c};
            double through = 0, back = 0;
            const int N = 20000;
            for (int k = 0; k < N; ++k) {
                struct sr_bsdf_sample x;
                float u = ((float)k + 0.5f) / (float)N;
                if (!sr_bsdf_sample(&b, wo, u, (sr_vec2){fmodf(u * 377.1f, 1), fmodf(u * 1713.7f, 1)}, SR_RADIANCE, &x))
                    continue;
                double weight = (double)(x.f[0] * fabsf(x.wi.z) / x.pdf) / N;
                if (x.wi.z * wo.z < 0) {
                    EXPECT_NEAR(sr_dot(x.wi, wo), -1, 1e-5);
                    through += weight;
                } else
                    back += weight;
            }
            EXPECT_NEAR(through, 0.5 * (double)((1 - F) / (1 + F)), 2e-3);
            EXPECT_NEAR(back, (double)(2 * F / (1 + F)), 4e-3);
        }
    }
}

/* A quarter wave of index sqrt(n) on glass of n reflects nothing; a half wave changes nothing. */
TEST(openpbr_film_of_a_quarter_wave_takes_the_mirror_away)
{
    sr_vec3 w = {0, 0, 1};
    double n = sqrt(1.5), quarter = 0.550 / (4 * n);
    struct sr_bsdf bare = specimen("openpbr", "base_color", 0.0, "specular_roughness", 0.5, NULL);
    struct sr_bsdf none = specimen("openpbr", "base_color", 0.0, "specular_roughness", 0.5, "thin_film_weight", 1.0,
                                   "thin_film_ior", n, "thin_film_thickness", quarter, NULL);
    struct sr_bsdf half = specimen("openpbr", "base_color", 0.0, "specular_roughness", 0.5, "thin_film_weight", 1.0,
                                   "thin_film_ior", n, "thin_film_thickness", 2 * quarter, NULL);
    double mirror = sr_bsdf_f(&bare, w, w, SR_RADIANCE)[0];
    EXPECT(mirror > 0.01);
    EXPECT_NEAR(sr_bsdf_f(&none, w, w, SR_RADIANCE)[0] / mirror, 0, 2e-3);
    EXPECT_NEAR(sr_bsdf_f(&half, w, w, SR_RADIANCE)[0] / mirror, 1, 2e-3);
}
