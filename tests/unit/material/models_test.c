/* SPDX-License-Identifier: MIT */
/* What numbers each material hands to its BSDF. */
#include "make.h"

TEST(tables_are_complete_and_defaults_prepare)
{
    const struct sr_material_model *model;
    int count = 0;
    for (; (model = sr_material_model(count)); ++count) {
        EXPECT(sr_material_model_find(model->name) == model);
        EXPECT((model->bsdf != NULL) != (model->choose != NULL));
        for (const struct sr_param *p = model->params; p->name; ++p)
            EXPECT(p->offset < model->size && p->text && p->unit);
        if (model->choose)
            continue;
        struct made m = make(model->name);
        struct sr_material material = {0};
        if (!try_to_make(&m, &material)) { // models of files say what they miss
            EXPECT(m.error.text[0] != 0);
            sr_arena_free(&m.arena);
            continue;
        }
        struct shaded s = shade(&material, point(), 0.5f);
        EXPECT(s.bsdf.model ? s.bsdf.model->size <= SR_BSDF_SIZE : strcmp(model->name, "interface") == 0);
        sr_arena_free(&m.arena);
    }
    EXPECT(count >= 9);
    EXPECT(sr_material_of_bsdf(&sr_bsdf_conductor) != sr_material_model_find("conductor"));
}

TEST(diffuse_holds_its_reflectance_in_0_to_1)
{
    struct made m = make("diffuse");
    struct sr_material material = made_material(&m);
    struct shaded s = shade(&material, point(), 0.5f);
    const struct sr_bsdf_diffuse *b = (const void *)s.bsdf.data;
    EXPECT(s.bsdf.model == &sr_bsdf_diffuse);
    EXPECT_NEAR(b->reflectance[0], 0.5, 0);
    set_spectrum(&m, "reflectance", sr_spd_constant(1.5f));
    material = made_material(&m);
    s = shade(&material, point(), 0.5f);
    EXPECT_NEAR(b->reflectance[7 % SR_LAMBDA_COUNT], 1, 0);
    struct sr_spd red = sr_spd_from_rgb_albedo(SR_SRGB, (struct sr_rgb){0.7f, 0.2f, 0.1f});
    set_spectrum(&m, "reflectance", red);
    material = made_material(&m);
    s = shade(&material, point(), 0.5f);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        EXPECT_NEAR(b->reflectance[i], sr_spd_at(&red, s.w.lambda[i]), 1e-6);
    sr_arena_free(&m.arena);
}

TEST(a_texture_that_varies_is_evaluated_at_the_point)
{
    struct made m = make("conductor");
    *(struct sr_texture *)made_member(&m, "uroughness") = ramp(&m.arena, 0, 1, 0); // u = 1/4
    set_float(&m, "roughness", 0.81f);
    struct sr_material material = made_material(&m);
    struct shaded s = shade(&material, point(), 0.5f);
    const struct sr_bsdf_conductor *b = (const void *)s.bsdf.data;
    EXPECT_NEAR(b->ggx.alpha_x, 0.5, 1e-6); // roots
    EXPECT_NEAR(b->ggx.alpha_y, 0.9, 1e-6);
    *(bool *)made_member(&m, "remaproughness") = false;
    material = made_material(&m);
    s = shade(&material, point(), 0.5f);
    EXPECT_NEAR(b->ggx.alpha_x, 0.25, 1e-6);
    EXPECT_NEAR(b->ggx.alpha_y, 0.81, 1e-6);
    sr_arena_free(&m.arena);
}

TEST(diffuse_transmission_scales_then_clamps)
{
    struct made m = make("diffusetransmission");
    set_spectrum(&m, "reflectance", sr_spd_constant(0.75f));
    *(float *)made_member(&m, "scale") = 2;
    struct sr_material material = made_material(&m);
    struct shaded s = shade(&material, point(), 0.5f);
    const struct sr_bsdf_diffuse_transmission *b = (const void *)s.bsdf.data;
    EXPECT(s.bsdf.model == &sr_bsdf_diffuse_transmission);
    EXPECT_NEAR(b->reflectance[0], 1, 0);
    EXPECT_NEAR(b->transmittance[0], 0.5, 1e-7);
    sr_arena_free(&m.arena);
}

TEST(conductor_is_copper_unless_told_otherwise)
{
    struct made m = make("conductor");
    struct sr_material material = made_material(&m);
    struct shaded s = shade(&material, point(), 0.5f);
    const struct sr_bsdf_conductor *b = (const void *)s.bsdf.data;
    struct sr_spd eta = sr_spd_named("metal-Cu-eta"), k = sr_spd_named("metal-Cu-k");
    EXPECT(s.bsdf.model == &sr_bsdf_conductor);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        EXPECT_NEAR(b->eta[i], sr_spd_at(&eta, s.w.lambda[i]), 1e-5);
        EXPECT_NEAR(b->k[i], sr_spd_at(&k, s.w.lambda[i]), 1e-5);
    }
    EXPECT(sr_ggx_is_smooth(b->ggx));
    EXPECT(!sr_wavelengths_secondary_terminated(&s.w)); // a mirror sends all wavelengths the same way
    sr_arena_free(&m.arena);
}

/* With eta = 1 and k = 2 sqrt(r) / sqrt(1 - r) Fresnel's equations give r back at normal incidence. */
TEST(a_metal_of_given_reflectance_reflects_it)
{
    for (float r = 0.05f; r < 1; r += 0.15f) {
        struct made m = make("conductor");
        set_spectrum(&m, "reflectance", sr_spd_constant(r));
        struct sr_material material = made_material(&m);
        struct shaded s = shade(&material, point(), 0.5f);
        const struct sr_bsdf_conductor *b = (const void *)s.bsdf.data;
        EXPECT_NEAR(sr_fresnel_conductor(1, b->eta, b->k)[0], r, 2e-6);
        sr_arena_free(&m.arena);
    }
    struct made both = make("conductor");
    set_spectrum(&both, "reflectance", sr_spd_constant(0.5f));
    set_spectrum(&both, "k", sr_spd_constant(3));
    EXPECT_EQUAL_INT(both.model->prepare(both.self, &both.arena, &both.error), SR_ERROR_INPUT);
    sr_arena_free(&both.arena);
}

TEST(dispersion_ends_the_secondary_wavelengths_and_a_constant_index_does_not)
{
    const char *names[2] = {"dielectric", "thindielectric"};
    for (int i = 0; i < 2; ++i) {
        struct made m = make(names[i]);
        struct sr_material material = made_material(&m);
        struct shaded s = shade(&material, point(), 0.5f);
        EXPECT(!sr_wavelengths_secondary_terminated(&s.w));
        EXPECT_NEAR(((const struct sr_bsdf_thin_dielectric *)(const void *)s.bsdf.data)->eta, 1.5,
                    0); // both begin with eta
        struct sr_spd glass = sr_spd_named("glass-BK7");
        set_spectrum(&m, "eta", glass);
        material = made_material(&m);
        s = shade(&material, point(), 0.5f);
        EXPECT(sr_wavelengths_secondary_terminated(&s.w));
        EXPECT_NEAR(((const struct sr_bsdf_thin_dielectric *)(const void *)s.bsdf.data)->eta,
                    sr_spd_at(&glass, s.w.lambda[0]), 1e-6);
        sr_arena_free(&m.arena);
    }
}

TEST(coated_materials_pass_on_what_they_are_given)
{
    struct made m = make("coateddiffuse");
    set_float(&m, "roughness", 0.25f);
    set_float(&m, "g", 0.3f);
    set_spectrum(&m, "albedo", sr_spd_constant(0.6f));
    struct sr_material material = made_material(&m);
    struct shaded s = shade(&material, point(), 0.5f);
    const struct sr_bsdf_coated *b = (const void *)s.bsdf.data;
    EXPECT(s.bsdf.model == &sr_bsdf_coated_diffuse);
    EXPECT_NEAR(b->base_reflectance[0], 0.5, 0);
    EXPECT_NEAR(b->albedo[0], 0.6, 1e-7);
    EXPECT_NEAR(b->coat_ggx.alpha_x, 0.5, 1e-6);
    EXPECT_NEAR(b->coat_eta, 1.5, 0);
    EXPECT_NEAR(b->thickness, 0.01, 1e-8);
    EXPECT_NEAR(b->g, 0.3, 1e-7);
    EXPECT_EQUAL_INT(b->max_depth, 10);
    EXPECT_EQUAL_INT(b->sample_count, 1);
    EXPECT_EQUAL_INT(b->seed, 77);
    sr_arena_free(&m.arena);

    struct made n = make("coatedconductor");
    set_spectrum(&n, "interface.eta", sr_spd_constant(2));
    set_float(&n, "conductor.roughness", 0.04f);
    material = made_material(&n);
    s = shade(&material, point(), 0.5f);
    struct sr_spd eta = sr_spd_named("metal-Cu-eta"), k = sr_spd_named("metal-Cu-k");
    EXPECT(s.bsdf.model == &sr_bsdf_coated_conductor);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) { // relative to the coat
        EXPECT_NEAR(b->base_eta[i], sr_spd_at(&eta, s.w.lambda[i]) / 2, 1e-5);
        EXPECT_NEAR(b->base_k[i], sr_spd_at(&k, s.w.lambda[i]) / 2, 1e-5);
    }
    EXPECT_NEAR(b->base_ggx.alpha_y, 0.2, 1e-6);
    EXPECT(sr_ggx_is_smooth(b->coat_ggx));
    sr_arena_free(&n.arena);
}

TEST(mix_chooses_by_amount_and_leaves_a_uniform_number)
{
    struct made a = make("diffuse"), b = make("conductor"), m = make("mix"), outer = make("mix");
    struct sr_material first = made_material(&a), second = made_material(&b);
    const struct sr_material *parts[2] = {&first, &second};
    *(struct sr_slice *)made_member(&m, "materials") = (struct sr_slice){parts, 2};
    set_float(&m, "amount", 0.3f);
    struct sr_material mix = made_material(&m);
    struct sr_tally is_second = {0}, left = {0};
    struct sr_wavelengths w = wavelengths();
    struct sr_point x = point();
    for (int i = 0; i < 10000; ++i) {
        struct sr_material_context c = {&x, {0, 0, 1}, &w, ((float)i + 0.5f) / 10000, 0};
        const struct sr_material *chosen = mix.model->choose(mix.self, &c);
        sr_tally_add(&is_second, chosen == &second);
        sr_tally_add(&left, (double)c.u);
        EXPECT(c.u >= 0 && c.u < 1);
    }
    EXPECT_NEAR(is_second.mean, 0.3, 1e-4);
    EXPECT_NEAR(left.mean, 0.5, 1e-3);
    EXPECT_NEAR(sr_tally_variance(&left), 1 / 12.0, 1e-3);

    // amount 0 is the first, 1 the second, and mixes may be mixed
    const struct sr_material *nested[2] = {&mix, &mix};
    *(struct sr_slice *)made_member(&outer, "materials") = (struct sr_slice){nested, 2};
    struct sr_material all = made_material(&outer);
    for (int amount = 0; amount < 2; ++amount) {
        set_float(&m, "amount", (float)amount);
        mix = made_material(&m);
        for (float u = 0; u < 1; u += 0.09f)
            EXPECT(shade(&all, x, u).bsdf.model == (amount ? &sr_bsdf_conductor : &sr_bsdf_diffuse));
    }
    sr_arena_free(&a.arena);
    sr_arena_free(&b.arena);
    sr_arena_free(&m.arena);
    sr_arena_free(&outer.arena);
}

TEST(an_interface_does_not_scatter)
{
    struct made m = make("interface");
    struct sr_material material = made_material(&m), none = {0};
    EXPECT(shade(&material, point(), 0.5f).bsdf.model == NULL);
    EXPECT(shade(&none, point(), 0.5f).bsdf.model == NULL);
    sr_arena_free(&m.arena);
}
