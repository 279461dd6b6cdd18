/* SPDX-License-Identifier: MIT */
/* Named textures, made when something asks for them, once for each use: a float, or a spectrum that is an albedo, an
 * unbounded quantity or an emission, for that decides what RGB means. */
#include "import/pbrt/build.h"

#include <string.h>

static sr_status unknown_texture(struct sr_pbrt_build *b, const struct sr_pbrt_param *p, bool is_float)
{
    const char *type = is_float ? "float" : "spectrum";
    struct sr_pbrt_suggestion s = {.word = p->strings[0]};
    char buffer[160];
    if (sr_pbrt_names_find(is_float ? &b->d->spectrum_textures : &b->d->float_textures, p->strings[0]))
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                            "\"texture %s\": \"%s\" is a %s texture: expected a %s texture", p->name, p->strings[0],
                            is_float ? "spectrum" : "float", type);
    sr_pbrt_names_suggest(is_float ? &b->d->float_textures : &b->d->spectrum_textures, &s);
    return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT, "\"texture %s\": there is no %s texture \"%s\"%s",
                        p->name, type, p->strings[0], sr_pbrt_suggestion_text(&s, buffer));
}

/* An image is read later, together with all others. */
static sr_status put_off(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_texture_model *m,
                         void *self, enum sr_param_kind use)
{
    const char *name = NULL, *encoding = NULL;
    float gamma;
    if (sr_pbrt_get_string(b->d, &e->params, "filename", &name, b->error) != SR_OK ||
        sr_pbrt_get_string(b->d, &e->params, "encoding", &encoding, b->error) != SR_OK ||
        sr_pbrt_encoding(b, e, encoding, &gamma) != SR_OK)
        return b->error->status;
    if (!name)
        return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT, "Texture \"%s\": expected \"string filename\"",
                            e->name);
    struct sr_location where = sr_pbrt_find(&e->params, "filename")->where;
    struct sr_pbrt_late_texture *late = sr_array_push(&b->late_textures, sizeof *late);
    const char *path = sr_pbrt_resolve(b, &b->scratch, name, where);
    if (!late || !path)
        return sr_pbrt_no_memory(b);
    *late = (struct sr_pbrt_late_texture){
        .entity = e, .model = m, .self = self, .use = {use, e->space}, .path = path, .where = where, .gamma = gamma};
    return SR_OK;
}

static void find_like(struct sr_pbrt_late_texture *late, size_t k)
{
    struct sr_pbrt_late_texture *t = &late[k];
    for (size_t i = 0; i < k && t->model->share && !t->like; ++i)
        if (!late[i].like && late[i].model == t->model && late[i].use.rgb_use == t->use.rgb_use &&
            late[i].gamma == t->gamma && strcmp(late[i].path, t->path) == 0)
            t->like = &late[i];
}

static void prepare_late(struct sr_pbrt_late_texture *t)
{
    if (t->model->prepare)
        t->model->prepare(t->self, t->use, &t->arena, &t->error);
}

static void prepare_first(void *context, uint64_t k)
{
    struct sr_pbrt_late_texture *t = &((struct sr_pbrt_late_texture *)context)[k];
    if (!t->like)
        prepare_late(t);
}

static void prepare_again(void *context, uint64_t k)
{
    struct sr_pbrt_late_texture *t = &((struct sr_pbrt_late_texture *)context)[k];
    if (!t->like)
        return;
    if (t->like->error.status == SR_OK)
        t->model->share(t->self, t->like->self);
    prepare_late(t);
}

sr_status sr_pbrt_finish_textures(struct sr_pbrt_build *b)
{
    struct sr_pbrt_late_texture *late = b->late_textures.data;
    size_t count = b->late_textures.count;
    if (sr_pbrt_images_read_ahead(b) != SR_OK)
        return b->error->status;
    for (size_t k = 0; k < count; ++k) {
        struct sr_texels *texels = (struct sr_texels *)((char *)late[k].self + late[k].model->texels_offset);
        if (sr_pbrt_texels(b, late[k].path, late[k].where, late[k].gamma, false, texels) != SR_OK)
            return b->error->status;
        find_like(late, k);
    }
    sr_parallel_for(b->threads, count, prepare_first, late);
    sr_parallel_for(b->threads, count, prepare_again, late);
    for (size_t k = 0; k < count; ++k) {
        sr_arena_adopt(b->arena, &late[k].arena);
        if (late[k].error.status != SR_OK)
            sr_pbrt_wrap(b, late[k].entity, &late[k].error); // the first one sticks
    }
    b->late_textures.count = 0;
    return b->error->status;
}

static sr_status make(struct sr_pbrt_build *b, const struct sr_pbrt_texture *t, struct sr_pbrt_bound_texture *bound,
                      enum sr_param_kind use, struct sr_texture *out)
{
    const struct sr_pbrt_entity *e = &t->entity;
    const struct sr_texture_model *m = sr_texture_model_find(e->model, t->is_float);
    if (!m && strcmp(e->model, "ptex") == 0)
        return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                            "Texture \"%s\": Ptex files are not read: bake it into an image over the surface's (u, v) "
                            "and use \"imagemap\"",
                            e->name);
    if (!m) {
        const char *names[32];
        size_t n = 0;
        for (int i = 0; sr_texture_models[i] && n < 32; ++i)
            if (sr_texture_models[i]->is_float == t->is_float)
                names[n++] = sr_texture_models[i]->name;
        return sr_pbrt_unsupported(b, e, names, n);
    }
    char *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    struct sr_pbrt_use binding = {t->is_float ? SR_PARAM_ALBEDO : use, !t->is_float};
    sr_status status = sr_pbrt_bind(b, m->params, e, binding, self);
    struct sr_transform texture_to_world = sr_pbrt_transform_of(b, e->transform, SR_PBRT_TO_WORLD),
                        world_to_texture = sr_transform_invert(&texture_to_world);
    bool is_2d = m->mapping_offset != SR_TEXTURE_NOWHERE;
    if (status == SR_OK && is_2d) {
        struct sr_mapping *mapping = (struct sr_mapping *)(self + m->mapping_offset);
        status = sr_pbrt_bind(b, sr_mapping_params, e, binding, mapping);
        mapping->world_to_texture = world_to_texture;
    }
    if (m->transform_offset != SR_TEXTURE_NOWHERE)
        *(struct sr_transform *)(self + m->transform_offset) = world_to_texture;
    bool has_image = m->texels_offset != SR_TEXTURE_NOWHERE;
    if (status == SR_OK && has_image)
        status = put_off(b, e, m, self, use);
    if (status != SR_OK)
        return status;
    struct sr_error inner = {0};
    if (!has_image && m->prepare && m->prepare(self, (struct sr_texture_use){use, e->space}, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    if (!bound->has_warned)
        sr_pbrt_warn_unused(b, e, m->params, is_2d ? sr_mapping_params : NULL);
    bound->has_warned = true;
    *out = (struct sr_texture){m, self};
    return SR_OK;
}

sr_status sr_pbrt_named_texture(struct sr_pbrt_build *b, const struct sr_pbrt_param *p, bool is_float,
                                enum sr_param_kind use, struct sr_texture *out)
{
    uint32_t index1 = sr_pbrt_names_find(is_float ? &b->d->float_textures : &b->d->spectrum_textures, p->strings[0]);
    if (!index1)
        return unknown_texture(b, p, is_float);
    const struct sr_pbrt_texture *t = SR_PBRT_AT(b->d->textures, struct sr_pbrt_texture, index1 - 1);
    struct sr_pbrt_bound_texture *bound = &b->textures[index1 - 1];
    int slot = is_float ? 0 : use == SR_PARAM_ALBEDO ? 1 : use == SR_PARAM_UNBOUNDED ? 2 : 3;
    if (bound->made[slot].model) {
        b->parts += bound->parts[slot];
        *out = bound->made[slot];
        return SR_OK;
    }
    if (bound->is_being_made)
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                            "\"texture %s\": texture \"%s\" is made of itself", p->name, p->strings[0]);
    if (b->depth >= SR_PBRT_MAX_DEPTH)
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT, "textures are nested more than %d deep",
                            SR_PBRT_MAX_DEPTH);
    bound->is_being_made = true;
    ++b->depth;
    uint64_t outside = b->parts;
    b->parts = 1;
    sr_status status = make(b, t, bound, use, &bound->made[slot]);
    bound->parts[slot] = b->parts;
    b->parts += outside;
    --b->depth;
    bound->is_being_made = false;
    if (status == SR_OK && bound->parts[slot] > SR_PBRT_MAX_PARTS)
        status = sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                              "texture \"%s\" is made of more than %d others, each as often as it is used",
                              p->strings[0], SR_PBRT_MAX_PARTS);
    *out = bound->made[slot];
    return status;
}
