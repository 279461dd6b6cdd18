/* SPDX-License-Identifier: MIT */
/* LightSource and AreaLightSource. */
#include "import/pbrt/build.h"

#include <string.h>

/* Emission that is an absolute spectrum loses its scale in pbrt; images must match, so it does here. */
void sr_pbrt_tell_normalisation(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e)
{
    for (uint32_t i = 0; i < e->params.count && !b->has_told_normalisation; ++i) {
        enum sr_pbrt_type type = e->params.items[i].type;
        if (type == SR_PBRT_SPECTRUM || type == SR_PBRT_BLACKBODY) {
            b->has_told_normalisation = true;
            sr_log(b->log, SR_INFO,
                   "%s:%d: emission given as a spectrum is scaled to luminance 1 before \"scale\" or \"power\", as "
                   "pbrt does",
                   e->where.file, e->where.line);
        }
    }
}

static sr_status read_image(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_texels *texels)
{
    const char *name = NULL;
    sr_status status = sr_pbrt_get_string(b->d, &e->params, "filename", &name, b->error);
    if (status != SR_OK || !name)
        return status;
    struct sr_location where = sr_pbrt_find(&e->params, "filename")->where;
    const char *path = sr_pbrt_resolve(b, &b->scratch, name, where);
    return path ? sr_pbrt_texels(b, path, where, 0, true, texels) : sr_pbrt_no_memory(b);
}

static sr_status add_light(struct sr_pbrt_build *b, const struct sr_pbrt_light *light)
{
    const struct sr_pbrt_entity *e = &light->entity;
    const struct sr_light_model *m = sr_light_model_find(e->model);
    if (!m || m == &sr_light_area) {
        const char *names[32];
        size_t n = 0;
        for (int i = 0; sr_light_models[i] && n < 32; ++i)
            if (sr_light_models[i] != &sr_light_area)
                names[n++] = sr_light_models[i]->name;
        return sr_pbrt_unsupported(b, e, names, n);
    }
    sr_status status = sr_pbrt_refuse_medium(b, light->outside, light->medium_where);
    char *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    if (status == SR_OK)
        status = sr_pbrt_bind(b, m->params, e, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, self);
    size_t at = sr_light_transform_offset(m);
    if (at != SIZE_MAX)
        *(struct sr_transform *)(self + at) = sr_pbrt_transform_of(b, e->transform)->start;
    if ((at = sr_light_space_offset(m)) != SIZE_MAX)
        *(enum sr_colour_space_id *)(self + at) = e->space;
    if (status == SR_OK && (at = sr_light_texels_offset(m)) != SIZE_MAX)
        status = read_image(b, e, (struct sr_texels *)(self + at));
    if (status != SR_OK)
        return status;
    struct sr_error inner = {0};
    if (m->prepare && m->prepare(self, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    sr_pbrt_tell_normalisation(b, e);
    sr_pbrt_warn_unused(b, e, m->params, NULL);
    sr_scene_add_light(b->result->scene, (struct sr_light){m, self});
    return SR_OK;
}

sr_status sr_pbrt_build_lights(struct sr_pbrt_build *b)
{
    sr_status status = SR_OK;
    for (size_t i = 0; i < b->d->lights.count && status == SR_OK; ++i)
        status = add_light(b, SR_PBRT_AT(b->d->lights, struct sr_pbrt_light, i));
    return status;
}

sr_status sr_pbrt_emission(struct sr_pbrt_build *b, uint32_t area_light1, float area,
                           const struct sr_light_emission **out)
{
    struct sr_pbrt_entity *e = SR_PBRT_AT(b->d->area_lights, struct sr_pbrt_entity, area_light1 - 1);
    const char *const supported[] = {"diffuse"};
    if (strcmp(e->model, "diffuse") != 0)
        return sr_pbrt_unsupported(b, e, supported, 1);
    struct sr_light_emission *emission = sr_arena_alloc(b->arena, sizeof *emission);
    if (!emission)
        return sr_pbrt_no_memory(b);
    sr_status status =
        sr_pbrt_bind(b, sr_light_emission_params, e, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, emission);
    emission->space = e->space;
    if (status == SR_OK)
        status = read_image(b, e, &emission->texels);
    if (status != SR_OK)
        return status;
    struct sr_error inner = {0};
    if (sr_light_emission_prepare(emission, area, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    sr_pbrt_tell_normalisation(b, e);
    sr_pbrt_warn_unused(b, e, sr_light_emission_params, NULL);
    for (uint32_t i = 0; i < e->params.count; ++i) // said once is enough for all shapes that wear it
        e->params.items[i].used = true;
    *out = emission;
    return SR_OK;
}
