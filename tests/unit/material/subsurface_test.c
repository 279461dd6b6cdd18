/* SPDX-License-Identifier: MIT */
/* Translucent bodies in pbrt's words: what each way of telling the medium makes of it. */
#include "make.h"
#include "medium/medium.h"

static bool body_of(const struct sr_material *material, float u, struct sr_bssrdf *b)
{
    struct sr_point x = point();
    struct sr_wavelengths w = wavelengths();
    return sr_material_bssrdf(material, &x, (sr_vec3){0.6f, 0, 0.8f}, u, 77, &w, b);
}

TEST(a_named_medium_is_the_measured_one_in_scene_units_per_millimetre)
{
    struct made m = make("subsurface");
    *(const char **)made_member(&m, "name") = "Ketchup";
    *(float *)made_member(&m, "scale") = 2;
    *(float *)made_member(&m, "g") = 0.5f; // is in the measured sigma_s already
    struct sr_material material = made_material(&m);
    struct sr_bssrdf b;
    struct sr_spd sigma_a, sigma_s;
    struct sr_wavelengths w = wavelengths();
    EXPECT(body_of(&material, 0.5f, &b) && sr_medium_preset("Ketchup", &sigma_a, &sigma_s));
    sr_spectrum a = sr_spd_eval(&sigma_a, w.lambda), s = sr_spd_eval(&sigma_s, w.lambda);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        EXPECT_RELATIVE(b.sigma_t[i], 2 * (a[i] + s[i]), 1e-5);
        EXPECT_RELATIVE(b.albedo[i], s[i] / (a[i] + s[i]), 1e-5);
    }
    EXPECT_NEAR(b.eta, 1.33, 1e-6);
    EXPECT(m.model->remark(m.self) != NULL);
    sr_arena_free(&m.arena);
}

TEST(a_wanted_reflectance_comes_out)
{
    struct made m = make("subsurface");
    *(struct sr_texture *)made_member(&m, "mfp") = sr_texture_constant_spectrum(&m.arena, sr_spd_constant(0.02f));
    *(float *)made_member(&m, "scale") = 0.5f;
    for (float r = 0.05f; r < 1; r += 0.1f) {
        set_spectrum(&m, "reflectance", sr_spd_constant(r));
        struct sr_material material = made_material(&m);
        struct sr_bssrdf b;
        EXPECT(body_of(&material, 0.5f, &b));
        EXPECT_RELATIVE(b.sigma_t[0], 100, 1e-5);
        EXPECT_NEAR(sr_diffusion_effective(b.diffusion, b.albedo[3]), r, 1e-5);
    }
    sr_arena_free(&m.arena);
}

TEST(a_medium_that_is_empty_lets_nothing_out_and_breaks_nothing)
{
    struct made m = make("subsurface");
    set_spectrum(&m, "sigma_a", sr_spd_constant(0));
    set_spectrum(&m, "sigma_s", sr_spd_constant(0));
    struct sr_material material = made_material(&m);
    struct sr_bssrdf b;
    EXPECT(body_of(&material, 0.5f, &b));
    EXPECT(sr_spectrum_is_black(b.albedo) && sr_spectrum_is_black(b.sigma_t));
    EXPECT(sr_bssrdf_sample(&b, 0, 0.3f) < 0);
    sr_arena_free(&m.arena);
}

TEST(a_mix_has_the_body_of_the_part_that_it_chooses)
{
    struct made a = make("diffuse"), c = make("subsurface"), m = make("mix");
    struct sr_material first = made_material(&a), second = made_material(&c);
    const struct sr_material *parts[2] = {&first, &second};
    *(struct sr_slice *)made_member(&m, "materials") = (struct sr_slice){parts, 2};
    set_float(&m, "amount", 0.3f);
    struct sr_material mix = made_material(&m);
    struct sr_bssrdf b;
    EXPECT(sr_material_has_bssrdf(&mix) && sr_material_has_bssrdf(&second) && !sr_material_has_bssrdf(&first) &&
           !sr_material_has_bssrdf(NULL));
    for (float u = 0; u < 1; u += 0.07f)
        EXPECT(body_of(&mix, u, &b) == (shade(&mix, point(), u).bsdf.model == &sr_bsdf_dielectric));
    sr_arena_free(&a.arena);
    sr_arena_free(&c.arena);
    sr_arena_free(&m.arena);
}
