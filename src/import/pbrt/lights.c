/* SPDX-License-Identifier: MIT */
/* LightSource and AreaLightSource. */
#include "import/pbrt/build.h"

#include <string.h>

/* Above this, samples look like W m^-2 sr^-1 nm^-1: relative spectra end at 1 or near 100. */
static const float relative_most = 250;

static float largest_sample(const struct sr_pbrt_param *p)
{
    float largest = 0;
    for (uint32_t i = 1; p->floats && i < p->count; i += 2)
        largest = sr_max(largest, p->floats[i]);
    return largest;
}

/* What an emission spectrum's numbers mean, where that may surprise: once for a scene. */
void sr_pbrt_tell_normalisation(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e)
{
    bool has_total = sr_pbrt_find(&e->params, "power") || sr_pbrt_find(&e->params, "illuminance");
    bool is_si = b->result->units == SR_UNITS_SI;
    for (uint32_t i = 0; i < e->params.count; ++i) {
        const struct sr_pbrt_param *p = &e->params.items[i];
        if (p->type != SR_PBRT_SPECTRUM && p->type != SR_PBRT_BLACKBODY)
            continue;
        bool is_spectrum = p->type == SR_PBRT_SPECTRUM && !has_total;
        if (is_si && is_spectrum && p->is_text && sr_spd_named(p->strings[0]).kind != SR_SPD_NONE &&
            !b->has_warned_units) {
            b->has_warned_units = true;
            sr_pbrt_warn(b->d, p->where,
                         "\"%s\" is a relative spectrum, and its numbers count as W m^-2 sr^-1 nm^-1 here: "
                         "\"power\", \"illuminance\" or \"scale\" make it as bright as wanted",
                         p->strings[0]);
        }
        if (!is_si && is_spectrum && !p->is_text && largest_sample(p) > relative_most && !b->has_warned_units) {
            b->has_warned_units = true;
            sr_pbrt_warn(b->d, p->where,
                         "this spectrum looks absolute (up to %g), but only its shape counts, as in pbrt: "
                         "#@ Option \"string units\" \"si\" or --units si take its numbers as W m^-2 sr^-1 nm^-1",
                         (double)largest_sample(p));
        }
        if (!is_si && !b->has_told_normalisation) {
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

/* Images in another layout than the light's own. */
static sr_status make_square(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_texels *texels)
{
    struct sr_error inner = {0};
    if (!sr_light_is_latitude_longitude(texels))
        return SR_OK;
    uint32_t width = texels->width, height = texels->height;
    if (sr_light_make_square(texels, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    sr_log(
        b->log, SR_INFO,
        "%s:%d: the image of the light is %u x %u, taken as a latitude-longitude map (first row: +z) and converted to an "
        "equal-area octahedral one of %u x %u",
        e->where.file, e->where.line, width, height, texels->width, texels->height);
    return SR_OK;
}

static sr_status add_light(struct sr_pbrt_build *b, const struct sr_pbrt_light *light)
{
    const struct sr_pbrt_entity *e = &light->entity;
    const struct sr_light_model *m = sr_light_model_find(e->model);
    if (m == &sr_light_infinite && sr_pbrt_find(&e->params, "portal"))
        m = &sr_light_portal;
    if (!m || m == &sr_light_area) {
        const char *names[32];
        size_t n = 0;
        for (int i = 0; sr_light_models[i] && n < 32; ++i)
            if (sr_light_models[i] != &sr_light_area)
                names[n++] = sr_light_models[i]->name;
        return sr_pbrt_unsupported(b, e, names, n);
    }
    struct sr_medium around; // only its name is checked: shadow rays find out by themselves what they come through
    sr_status status = sr_pbrt_medium(b, light->outside, light->medium_where, &around);
    char *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    if (status == SR_OK)
        status = sr_pbrt_bind(b, m->params, e, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, self);
    size_t at = sr_light_transform_offset(m);
    if (at != SIZE_MAX)
        *(struct sr_transform *)(self + at) = sr_pbrt_transform_of(b, e->transform, SR_PBRT_TO_WORLD);
    if ((at = sr_light_space_offset(m)) != SIZE_MAX)
        *(enum sr_colour_space_id *)(self + at) = e->space;
    if ((at = sr_light_absolute_offset(m)) != SIZE_MAX)
        *(bool *)(self + at) = b->result->units == SR_UNITS_SI;
    if (status == SR_OK && (at = sr_light_texels_offset(m)) != SIZE_MAX)
        status = read_image(b, e, (struct sr_texels *)(self + at));
    if (status == SR_OK && m->wants_octahedral_map)
        status = make_square(b, e, (struct sr_texels *)(self + at));
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
    emission->is_absolute = b->result->units == SR_UNITS_SI;
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
