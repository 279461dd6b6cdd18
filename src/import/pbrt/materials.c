/* SPDX-License-Identifier: MIT */
/* Materials, made when the first shape wears them: model, textures, bump and normal map. */
#include "import/pbrt/build.h"

#include <string.h>

/* What every material has besides its model's own. */
struct common {
    struct sr_texture displacement;
    const char *normal_map;
    struct sr_texture normal[3];
};
static const struct sr_param common_params[] = {
    {SR_PARAM_FLOAT_TEXTURE, "displacement", "m", -INFINITY, INFINITY, NAN, offsetof(struct common, displacement),
     "bump"},
    {SR_PARAM_FILE, "normalmap", "1", 0, 0, NAN, offsetof(struct common, normal_map),
     "directions in red, green and blue"},
    {SR_PARAM_FLOAT_TEXTURE, "normalx", "1", -INFINITY, INFINITY, NAN, offsetof(struct common, normal[0]),
     "of the normal, along dp/du"},
    {SR_PARAM_FLOAT_TEXTURE, "normaly", "1", -INFINITY, INFINITY, NAN, offsetof(struct common, normal[1]),
     "of the normal, on the side of dp/dv"},
    {SR_PARAM_FLOAT_TEXTURE, "normalz", "1", -INFINITY, INFINITY, NAN, offsetof(struct common, normal[2]),
     "of the normal, along the smooth one"},
    {.name = NULL},
};
const struct sr_param *const sr_pbrt_material_params = common_params;

static bool is_interface(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e)
{
    bool is_old = e->model[0] == 0 || strcmp(e->model, "none") == 0;
    if (is_old)
        sr_pbrt_warn(b->d, e->where, "%s \"%s\" is deprecated: \"interface\" is the name of the material that is none",
                     e->directive, e->model);
    return is_old || strcmp(e->model, "interface") == 0;
}

static sr_status make(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_material **out)
{
    *out = NULL;
    if (is_interface(b, e))
        return SR_OK;
    const struct sr_material_model *m = sr_material_model_find(e->model);
    if (!m) {
        const char *names[40];
        size_t n = 0;
        const struct sr_material_model
            *one; // first those with words of their own, then one for each BSDF: too many to list
        while (n < 39 && (one = sr_material_model((int)n)) && one != sr_material_of_bsdf(sr_bsdf_model_find(one->name)))
            names[n++] = one->name;
        names[n++] = "and the models of 'steradian brdf list'";
        return sr_pbrt_unsupported(b, e, names, n);
    }
    struct sr_material *material = sr_arena_alloc(b->arena, sizeof *material);
    void *self = sr_arena_alloc(b->arena, m->size);
    struct common common = {0};
    if (!material || !self)
        return sr_pbrt_no_memory(b);
    sr_status status = sr_pbrt_bind(b, m->params, e, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, self);
    if (status == SR_OK && !m->choose) // a mix leaves the maps to its parts
        status = sr_pbrt_bind(b, common_params, e, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, &common);
    if (status == SR_OK && common.normal_map) // directions, so linear
        status = sr_pbrt_texels(b, common.normal_map, sr_pbrt_find(&e->params, "normalmap")->where, 1, true,
                                &material->normal_map);
    if (status == SR_OK && common.normal_map && material->normal_map.channels < 3)
        status =
            sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                         "%s \"%s\": the normal map is grey: expected red, green and blue", e->directive, e->model);
    bool has_normal = common.normal[0].model || common.normal[1].model || common.normal[2].model;
    if (status == SR_OK && has_normal && !(common.normal[0].model && common.normal[1].model && common.normal[2].model))
        status = sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                              "%s \"%s\": expected \"normalx\", \"normaly\" and \"normalz\" together", e->directive,
                              e->model);
    if (status == SR_OK && has_normal &&
        !(material->normal = sr_arena_copy(b->arena, common.normal, sizeof common.normal)))
        status = sr_pbrt_no_memory(b);
    if (status != SR_OK)
        return status;
    struct sr_error inner = {0};
    if (sr_material_prepare(m, self, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    material->model = m;
    material->self = self;
    material->displacement = common.displacement;
    sr_pbrt_warn_unused(b, e, m->params, common_params);
    const char *remark = m->remark ? m->remark(self) : NULL;
    if (remark)
        sr_pbrt_warn(b->d, e->where, "%s \"%s\": %s", e->directive, e->model, remark);
    *out = material;
    return SR_OK;
}

static sr_status get(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_pbrt_built_material *built,
                     const struct sr_material **out)
{
    if (built->is_being_made)
        return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT, "%s \"%s\" is a mix of itself", e->directive,
                            e->name ? e->name : e->model);
    if (!built->is_made) {
        if (b->depth >= SR_PBRT_MAX_DEPTH)
            return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT, "materials are nested more than %d deep",
                                SR_PBRT_MAX_DEPTH);
        built->is_being_made = true;
        ++b->depth;
        uint64_t outside = b->parts;
        b->parts = 1;
        sr_status status = make(b, e, &built->material);
        built->parts = b->parts;
        b->parts = outside;
        --b->depth;
        built->is_being_made = false;
        if (status == SR_OK && built->parts > SR_PBRT_MAX_PARTS)
            status =
                sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                             "%s \"%s\" is made of more than %d materials and textures, each as often as it is used",
                             e->directive, e->name ? e->name : e->model, SR_PBRT_MAX_PARTS);
        if (status != SR_OK)
            return status;
        built->is_made = true;
    }
    b->parts += built->parts;
    *out = built->material;
    return SR_OK;
}

sr_status sr_pbrt_material(struct sr_pbrt_build *b, const struct sr_pbrt_material_ref *ref,
                           const struct sr_material **out)
{
    if (!ref->name)
        return get(b, SR_PBRT_AT(b->d->materials, struct sr_pbrt_entity, ref->index), &b->materials[ref->index], out);
    uint32_t index1 = sr_pbrt_names_find(&b->d->material_names, ref->name);
    if (index1)
        return get(b, SR_PBRT_AT(b->d->named_materials, struct sr_pbrt_entity, index1 - 1),
                   &b->materials[b->d->materials.count + index1 - 1], out);
    struct sr_pbrt_suggestion s = {.word = ref->name};
    char buffer[160];
    sr_pbrt_names_suggest(&b->d->material_names, &s);
    return sr_pbrt_fail(b->d, ref->where, b->error, SR_ERROR_INPUT, "there is no material named \"%s\"%s", ref->name,
                        sr_pbrt_suggestion_text(&s, buffer));
}

sr_status sr_pbrt_materials(struct sr_pbrt_build *b, const struct sr_pbrt_param *p, struct sr_slice *out)
{
    const struct sr_material **list = sr_arena_alloc(b->arena, p->count * sizeof *list);
    if (!list)
        return sr_pbrt_no_memory(b);
    for (uint32_t i = 0; i < p->count; ++i) {
        struct sr_pbrt_material_ref ref = {0, p->strings[i], p->where};
        sr_status status = sr_pbrt_material(b, &ref, &list[i]);
        if (status != SR_OK)
            return status;
        if (!list[i])
            sr_pbrt_warn(
                b->d, p->where,
                "\"string %s\": \"%s\" is an interface: paths go through its share, but shadows are whole, as pbrt's; \"alpha\" of a shape makes true holes",
                p->name, p->strings[i]);
    }
    *out = (struct sr_slice){list, p->count};
    return SR_OK;
}
