/* SPDX-License-Identifier: MIT */
/* Hair in pbrt's words: struck where v says, dyed by the first thing that is told. */
#include "make.h"

static struct sr_bsdf_hair hair_at(struct made *m, struct sr_point x)
{
    struct sr_material material = made_material(m);
    struct shaded s = shade(&material, x, 0.5f);
    struct sr_bsdf_hair h;
    EXPECT(s.bsdf.model == &sr_bsdf_hair);
    memcpy(&h, s.bsdf.data, sizeof h);
    EXPECT_NEAR(sr_dot(s.frame.x, sr_normalize(x.dpdu)), 1, 1e-6); // the fibre's axis
    return h;
}

static void expect_absorption(const struct sr_bsdf_hair *h, struct sr_spd spd)
{
    struct sr_wavelengths w = wavelengths();
    sr_spectrum s = sr_spd_eval(&spd, w.lambda);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        EXPECT_RELATIVE(h->sigma[i], s[i], 1e-5);
}

TEST(hair_is_struck_at_2_v_less_1)
{
    struct made m = make("hair");
    struct sr_point x = point();
    for (float v = 0; v <= 1; v += 0.125f) {
        x.uv.y = v;
        EXPECT_NEAR(hair_at(&m, x).h, 2 * v - 1, 1e-6);
    }
    sr_arena_free(&m.arena);
}

TEST(hair_of_which_nothing_is_told_is_brown)
{
    struct made m = make("hair");
    struct sr_bsdf_hair h = hair_at(&m, point());
    expect_absorption(&h,
                      sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){1.3f * 0.419f, 1.3f * 0.697f, 1.3f * 1.37f}));
    EXPECT_NEAR(h.eta, 1.55, 1e-6);
    EXPECT_NEAR(h.beta_m, 0.3, 1e-6);
    EXPECT_NEAR(h.beta_n, 0.3, 1e-6);
    EXPECT_NEAR(h.alpha, 2, 1e-6);
    sr_arena_free(&m.arena);
}

TEST(hair_is_dyed_by_the_first_thing_that_is_told)
{
    struct made m = make("hair");
    set_float(&m, "pheomelanin", 0.8f); // alone: no eumelanin with it
    struct sr_bsdf_hair h = hair_at(&m, point());
    expect_absorption(&h,
                      sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){0.8f * 0.187f, 0.8f * 0.4f, 0.8f * 1.05f}));
    EXPECT(!m.model->remark(m.self));

    set_spectrum(&m, "color", sr_spd_constant(0.25f));
    h = hair_at(&m, point()); // (ln c / q)^2, q of beta_n = 0.3
    double n = 0.3, q = 5.969 - 0.215 * n + 2.532 * n * n - 10.73 * pow(n, 3) + 5.574 * pow(n, 4) + 0.245 * pow(n, 5);
    expect_absorption(&h, sr_spd_constant((float)pow(log(0.25) / q, 2)));
    EXPECT(m.model->remark(m.self) != NULL);

    set_spectrum(&m, "sigma_a", sr_spd_constant(33));
    h = hair_at(&m, point());
    expect_absorption(&h, sr_spd_constant(33));
    sr_arena_free(&m.arena);
}

TEST(hair_takes_textures_and_holds_them_in_their_range)
{
    struct made m = make("hair");
    *(struct sr_texture *)made_member(&m, "eumelanin") = ramp(&m.arena, -1, 4, 0);
    *(struct sr_texture *)made_member(&m, "beta_m") = ramp(&m.arena, 0, 4, 0);
    *(struct sr_texture *)made_member(&m, "eta") = ramp(&m.arena, 0, 0, 0);
    struct sr_point x = point();
    x.uv.x = 0.5f; // eumelanin 1, beta_m 2
    struct sr_bsdf_hair h = hair_at(&m, x);
    expect_absorption(&h, sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){0.419f, 0.697f, 1.37f}));
    EXPECT(h.beta_m == 1 && h.eta > 1);
    x.uv.x = 0.125f; // eumelanin < 0
    h = hair_at(&m, x);
    EXPECT(sr_spectrum_is_black(h.sigma));
    sr_vec3 wo = sr_normalize((sr_vec3){0.3f, 0.2f, 0.7f}), wi = sr_normalize((sr_vec3){-0.3f, 0.5f, 0.7f});
    EXPECT(sr_spectrum_is_finite(sr_bsdf_hair.f(&h, wo, wi, SR_RADIANCE)));
    sr_arena_free(&m.arena);
}
