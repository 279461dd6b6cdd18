/* SPDX-License-Identifier: MIT */
/* Textures as an importer makes them: by the parameter table, then prepare. */
#ifndef SR_TEST_UNIT_TEXTURE_MAKE_H
#define SR_TEST_UNIT_TEXTURE_MAKE_H

#include "test.h"
#include "texture/texture.h"

struct made {
    const struct sr_texture_model *model;
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

static inline struct sr_mapping *made_mapping(struct made *m)
{
    return (void *)((char *)m->self + sr_texture_mapping_offset(m->model));
}

static inline struct made make(const char *name, bool is_float)
{
    struct made m = {.model = sr_texture_model_find(name, is_float)};
    EXPECT(m.model != NULL);
    EXPECT(m.model->is_float == is_float && m.model->is_spectrum == !is_float);
    m.self = sr_arena_alloc(&m.arena, m.model->size);
    for (const struct sr_param *p = m.model->params; p->name; ++p) {
        void *member = (char *)m.self + p->offset;
        if (p->kind == SR_PARAM_FLOAT)
            *(float *)member = (float)p->initial;
        else if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM)
            *(int32_t *)member = (int32_t)p->initial;
        else if (p->kind == SR_PARAM_BOOL)
            *(bool *)member = p->initial != 0;
        else if (p->kind == SR_PARAM_ALBEDO)
            *(struct sr_spd *)member = sr_spd_constant((float)p->initial);
        else if (p->kind == SR_PARAM_FLOAT_TEXTURE)
            *(struct sr_texture *)member = sr_texture_constant_float(&m.arena, (float)p->initial);
        else if (p->kind == SR_PARAM_ALBEDO_TEXTURE)
            *(struct sr_texture *)member = sr_texture_constant_spectrum(&m.arena, sr_spd_constant((float)p->initial));
    }
    if (sr_texture_mapping_offset(m.model) != SR_TEXTURE_NOWHERE)
        *made_mapping(&m) = (struct sr_mapping){.uscale = 1,
                                                .vscale = 1,
                                                .v1 = {NAN, NAN, NAN},
                                                .v2 = {NAN, NAN, NAN},
                                                .world_to_texture = sr_transform_identity()};
    return m;
}

static inline struct sr_texture made_texture(struct made *m, enum sr_param_kind use)
{
    struct sr_texture_use how = {use, SR_SRGB};
    if (m->model->prepare && m->model->prepare(m->self, how, &m->arena, &m->error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", m->model->name, m->error.text);
    return (struct sr_texture){m->model, m->self};
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

#endif
