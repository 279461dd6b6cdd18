/* SPDX-License-Identifier: MIT */
#include "scenery.h"

struct sr_arena *scenery_arena(void)
{
    static struct sr_arena arena;
    return &arena;
}

void *scenery_medium(const struct sr_medium_model *model)
{
    char *self = sr_arena_alloc(scenery_arena(), model->size);
    ((struct sr_medium_common *)(void *)self)->medium_to_world = sr_transform_identity();
    for (const struct sr_param *p = model->params; p->name; ++p) {
        float v = (float)p->initial;
        void *member = self + p->offset;
        if (p->kind == SR_PARAM_FLOAT)
            *(float *)member = v;
        else if (p->kind == SR_PARAM_INT)
            *(int32_t *)member = (int32_t)v;
        else if (p->kind == SR_PARAM_POINT3)
            *(sr_vec3 *)member = (sr_vec3){v, v, v};
        else if (p->kind == SR_PARAM_STRING)
            *(const char **)member = p->text;
        else if (p->kind == SR_PARAM_UNBOUNDED && !isnan(v))
            *(struct sr_spd *)member = sr_spd_constant(v);
    }
    return self;
}

void *scenery_member(const struct sr_medium_model *model, void *self, const char *name)
{
    for (const struct sr_param *p = model->params; p->name; ++p)
        if (strcmp(p->name, name) == 0)
            return (char *)self + p->offset;
    test_fail(__FILE__, __LINE__, "no parameter %s", name);
}

struct sr_medium scenery_prepare(const struct sr_medium_model *model, void *self)
{
    struct sr_error error = {0};
    if (model->prepare(self, scenery_arena(), &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "prepare: %s", error.text);
    return (struct sr_medium){model, self};
}

const char *scenery_refusal(const struct sr_medium_model *model, void *self)
{
    static struct sr_error error;
    error = (struct sr_error){0};
    if (model->prepare(self, scenery_arena(), &error) == SR_OK)
        test_fail(__FILE__, __LINE__, "%s was not refused", model->name);
    return error.text;
}
