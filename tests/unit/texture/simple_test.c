/* SPDX-License-Identifier: MIT */
/* constant, scale, mix, bilerp: sums of a few terms. */
#include "make.h"

static const struct sr_point anywhere = {.uv = {0.25f, 0.5f}};

static struct sr_texture ramp(struct made *m) // a float texture that is u
{
    *m = make("bilerp", true);
    *(float *)made_member(m, "v01") = 0;
    *(float *)made_member(m, "v10") = 1;
    return made_texture(m, SR_PARAM_ALBEDO);
}

TEST(tables_name_each_texture_and_give_pbrt_defaults)
{
    int count = 0;
    for (; sr_texture_models[count]; ++count) {
        const struct sr_texture_model *m = sr_texture_models[count];
        EXPECT(m->is_float != m->is_spectrum);
        EXPECT(m->is_float ? m->eval_float != NULL : m->eval_spectrum != NULL);
        EXPECT(sr_texture_model_find(m->name, m->is_float) == m);
        bool is_of_one_type = !sr_texture_model_find(m->name, !m->is_float);
        bool is_noise = strcmp(m->name, "marble") == 0 || (m->is_float && m->params->kind != SR_PARAM_FLOAT_TEXTURE);
        bool has_no_other = strcmp(m->name, "product") == 0 || strcmp(m->name, "threshold") == 0; // numbers have scale
        EXPECT(!is_of_one_type || is_noise || has_no_other);
        struct made made = make(m->name, m->is_float);
        for (const struct sr_param *p = m->params; p->name; ++p)
            EXPECT(p->offset < m->size && p->text && p->unit);
        sr_arena_free(&made.arena);
    }
    EXPECT_EQUAL_INT(count, 26);
    EXPECT(sr_texture_model_find("marzipan", true) == NULL);
}

TEST(constant_is_its_value_and_says_so)
{
    struct sr_arena arena = {0};
    struct sr_texture t = sr_texture_constant_float(&arena, 0.375f);
    float value = 0;
    EXPECT_NEAR(sr_texture_float(t, &anywhere), 0.375, 0);
    EXPECT(sr_texture_is_constant_float(t, &value) && value == 0.375f);
    struct sr_texture s = sr_texture_constant_spectrum(&arena, sr_spd_constant(0.25f));
    struct sr_wavelengths w = wavelengths();
    struct sr_spd spd;
    EXPECT_NEAR(sr_texture_spectrum(s, &anywhere, &w)[3], 0.25, 0);
    EXPECT(sr_texture_is_constant_spectrum(s, &spd) && spd.scale == 0.25f);
    EXPECT(!sr_texture_is_constant_float(s, &value));
    EXPECT(!sr_texture_is_constant_float((struct sr_texture){0}, &value));
    sr_arena_free(&arena);
}

TEST(scale_multiplies_and_folds_what_is_constant)
{
    struct made r, m = make("scale", false);
    struct sr_wavelengths w = wavelengths();
    struct sr_spd spd;
    *(struct sr_texture *)made_member(&m, "tex") = sr_texture_constant_spectrum(&m.arena, sr_spd_constant(0.5f));
    *(struct sr_texture *)made_member(&m, "scale") = sr_texture_constant_float(&m.arena, 3);
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    EXPECT_NEAR(sr_texture_spectrum(t, &anywhere, &w)[0], 1.5, 1e-7);
    EXPECT(sr_texture_is_constant_spectrum(t, &spd) && spd.scale == 1.5f);
    *(struct sr_texture *)made_member(&m, "scale") = ramp(&r);
    EXPECT_NEAR(sr_texture_spectrum(t, &anywhere, &w)[0], 0.125, 1e-7);
    EXPECT(!sr_texture_is_constant_spectrum(t, &spd));
    sr_arena_free(&m.arena);
    sr_arena_free(&r.arena);
}

TEST(mix_weighs_its_parts_by_amount)
{
    struct made r, m = make("mix", true);
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    float value = -1;
    EXPECT(sr_texture_is_constant_float(t, &value));
    EXPECT_NEAR(value, 0.5, 0); // 0, 1 and 0.5 by default
    *(struct sr_texture *)made_member(&m, "tex1") = sr_texture_constant_float(&m.arena, 2);
    *(struct sr_texture *)made_member(&m, "tex2") = sr_texture_constant_float(&m.arena, 6);
    *(struct sr_texture *)made_member(&m, "amount") = ramp(&r);
    EXPECT_NEAR(sr_texture_float(t, &anywhere), 3, 1e-6);
    EXPECT(!sr_texture_is_constant_float(t, &value));
    sr_arena_free(&m.arena);
    sr_arena_free(&r.arena);
}

TEST(bilerp_joins_its_corners)
{
    struct made m = make("bilerp", false);
    *(struct sr_spd *)made_member(&m, "v00") = sr_spd_constant(1);
    *(struct sr_spd *)made_member(&m, "v01") = sr_spd_constant(2);
    *(struct sr_spd *)made_member(&m, "v10") = sr_spd_constant(3);
    *(struct sr_spd *)made_member(&m, "v11") = sr_spd_constant(5);
    struct sr_texture t = made_texture(&m, SR_PARAM_UNBOUNDED);
    struct sr_wavelengths w = wavelengths();
    // .75 .5 1 + .75 .5 2 + .25 .5 3 + .25 .5 5
    EXPECT_NEAR(sr_texture_spectrum(t, &anywhere, &w)[SR_LAMBDA_COUNT - 1], 2.125, 1e-6);
    sr_arena_free(&m.arena);
}
