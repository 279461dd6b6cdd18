/* SPDX-License-Identifier: MIT */
/* Materials as an importer makes them: by the parameter table, then prepare. */
#ifndef SR_TEST_UNIT_MATERIAL_MAKE_H
#define SR_TEST_UNIT_MATERIAL_MAKE_H

#include "material/material.h"
#include "test.h"

struct made {
    const struct sr_material_model *model;
    void *self;
    struct sr_arena arena;
    struct sr_error error;
};

static inline void *made_member(struct made *m, const char *name)
{
    for (const struct sr_param *p = m->model->params; p->name; ++p)
        if (strcmp(p->name, name) == 0)
            return (char *)m->self + p->offset;
    test_fail(__FILE__, __LINE__, "%s has no %s", m->model->name, name);
}

static inline struct made make(const char *name)
{
    struct made m = {.model = sr_material_model_find(name)};
    EXPECT(m.model != NULL);
    m.self = sr_arena_alloc(&m.arena, m.model->size);
    for (const struct sr_param *p = m.model->params; p->name; ++p) {
        void *member = (char *)m.self + p->offset;
        if (p->kind == SR_PARAM_FLOAT)
            *(float *)member = (float)p->initial;
        else if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM)
            *(int32_t *)member = (int32_t)p->initial;
        else if (p->kind == SR_PARAM_BOOL)
            *(bool *)member = p->initial != 0;
        else if (p->kind == SR_PARAM_FLOAT_TEXTURE && !isnan(p->initial))
            *(struct sr_texture *)member = sr_texture_constant_float(&m.arena, (float)p->initial);
        else if ((p->kind == SR_PARAM_ALBEDO_TEXTURE || p->kind == SR_PARAM_UNBOUNDED_TEXTURE) && !isnan(p->initial))
            *(struct sr_texture *)member = sr_texture_constant_spectrum(&m.arena, sr_spd_constant((float)p->initial));
    }
    return m;
}

static inline void set_float(struct made *m, const char *name, float value)
{
    *(struct sr_texture *)made_member(m, name) = sr_texture_constant_float(&m->arena, value);
}

static inline void set_spectrum(struct made *m, const char *name, struct sr_spd value)
{
    *(struct sr_texture *)made_member(m, name) = sr_texture_constant_spectrum(&m->arena, value);
}

/* A float texture that is a + b u + c v, made of bilerp's corners. */
static inline struct sr_texture ramp(struct sr_arena *arena, float a, float b, float c)
{
    const struct sr_texture_model *model = sr_texture_model_find("bilerp", true);
    char *self = sr_arena_alloc(arena, model->size);
    const char *names[4] = {"v00", "v01", "v10", "v11"};
    const float values[4] = {a, a + c, a + b, a + b + c};
    for (const struct sr_param *p = model->params; p->name; ++p)
        for (int i = 0; i < 4; ++i)
            if (strcmp(p->name, names[i]) == 0)
                *(float *)(void *)(self + p->offset) = values[i];
    *(struct sr_mapping *)(void *)(self + sr_texture_mapping_offset(model)) =
        (struct sr_mapping){.uscale = 1, .vscale = 1};
    return (struct sr_texture){model, self};
}

static inline bool try_to_make(struct made *m, struct sr_material *material)
{
    *material = (struct sr_material){.model = m->model, .self = m->self};
    return sr_material_prepare(m->model, m->self, &m->arena, &m->error) == SR_OK;
}

static inline struct sr_material made_material(struct made *m)
{
    struct sr_material material;
    if (!try_to_make(m, &material))
        test_fail(__FILE__, __LINE__, "%s: %s", m->model->name, m->error.text);
    return material;
}

static inline struct sr_wavelengths wavelengths(void)
{
    struct sr_wavelengths w;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        w.lambda[i] = 400 + 300 * (float)i / (SR_LAMBDA_COUNT - 1);
        w.pdf[i] = 1 / 470.0f;
    }
    return w;
}

/* A square of 2 m x 3 m in the plane z = 0, seen from above. */
static inline struct sr_point point(void)
{
    return (struct sr_point){
        .n = {0, 0, 1}, .ns = {0, 0, 1}, .dpdu = {2, 0, 0}, .dpdv = {0, 3, 0}, .dpdus = {2, 0, 0}, .uv = {0.25f, 0.5f}};
}

struct shaded {
    struct sr_bsdf bsdf;
    struct sr_frame frame;
    struct sr_point x;
    struct sr_wavelengths w;
};

static inline struct shaded shade(const struct sr_material *m, struct sr_point x, float u)
{
    struct shaded s = {.x = x, .w = wavelengths()};
    sr_material_shade(m, &s.x, (sr_vec3){0.6f, 0, 0.8f}, u, 77, &s.w, &s.bsdf, &s.frame);
    return s;
}

#endif
