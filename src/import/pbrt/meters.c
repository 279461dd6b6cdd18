/* SPDX-License-Identifier: MIT */
/* Meters of the scene file: "#@ Meter" with its parameters, and the shapes that they measure on. */
#include "import/pbrt/build.h"

#include <string.h>

/* ---- shapes as meters see them ---- */

struct part {
    struct sr_shape shape;
    uint32_t primitive;
};

struct surface {
    struct sr_alias alias; // by area
    struct part *parts;
};

static float draw(const void *self, sr_vec2 u, struct sr_point *x)
{
    const struct surface *s = self;
    float pmf;
    uint32_t bits[2], i;
    memcpy(bits, &u, sizeof bits);
    i = sr_alias_sample(&s->alias, sr_with_more_bits(u.x, sr_hash_combine(bits[0], bits[1])), &pmf, &u.x);
    struct sr_shape_sample drawn;
    if (!s->parts[i].shape.model->sample(s->parts[i].shape.self, s->parts[i].primitive, NULL, u, &drawn))
        return 0;
    *x = (struct sr_point){.p = drawn.p, .p_error = drawn.p_error, .n = drawn.n, .ns = drawn.n, .uv = drawn.uv};
    return pmf * drawn.pdf;
}

static sr_status make_surface(struct sr_pbrt_build *b, const char *name, struct sr_meter_surface *out)
{
    uint32_t count = 0, n = 0;
    const struct sr_pbrt_named_shape *named = b->named_shapes.data;
    for (size_t i = 0; i < b->named_shapes.count; ++i)
        if (strcmp(named[i].name, name) == 0)
            count += named[i].shape.model->primitive_count(named[i].shape.self);
    struct surface *s = sr_arena_alloc(b->arena, sizeof *s);
    float *areas = sr_arena_alloc(&b->scratch, (count + 1) * sizeof *areas);
    if (!s || !areas || !(s->parts = sr_arena_alloc(b->arena, (count + 1) * sizeof *s->parts)))
        return sr_pbrt_no_memory(b);
    double area = 0;
    for (size_t i = 0; i < b->named_shapes.count; ++i) {
        if (strcmp(named[i].name, name) != 0)
            continue;
        for (uint32_t k = 0; k < named[i].shape.model->primitive_count(named[i].shape.self); ++k, ++n) {
            s->parts[n] = (struct part){named[i].shape, k};
            areas[n] = named[i].shape.model->area(named[i].shape.self, k);
            area += (double)areas[n];
        }
    }
    *out = (struct sr_meter_surface){.self = s, .area = area, .draw = draw};
    return area > 0 && sr_alias_build(b->arena, areas, count, &s->alias) ? SR_OK : sr_pbrt_no_memory(b);
}

static sr_status find_surface(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_meter_model *m,
                              struct sr_meter_common *common)
{
    const char *name = common->surface_name;
    if (!name)
        return SR_OK;
    struct sr_location where = sr_pbrt_find(&e->params, "surface")->where;
    if (!m->wants_surface)
        return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT, "Meter \"%s\" does not measure on a shape",
                            e->model);
    struct sr_pbrt_suggestion s = {.word = name};
    const struct sr_pbrt_named_shape *named = b->named_shapes.data;
    for (size_t i = 0; i < b->named_shapes.count; ++i) {
        if (strcmp(named[i].name, name) == 0 && named[i].is_of_object)
            return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT,
                                "Meter \"%s\": the shape \"%s\" belongs to an object, which has many places or none",
                                e->model, name);
        if (strcmp(named[i].name, name) == 0 && named[i].moves)
            return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT,
                                "Meter \"%s\": the shape \"%s\" moves: expected one that stands", e->model, name);
        if (strcmp(named[i].name, name) == 0 && !named[i].shape.model->sample)
            return sr_pbrt_fail(
                b->d, where, b->error, SR_ERROR_INPUT,
                "Meter \"%s\": the shape \"%s\" is a %s, which turns to whoever looks: nothing is measured on it",
                e->model, name, named[i].shape.model->name);
        if (strcmp(named[i].name, name) == 0)
            return make_surface(b, name, &common->surface);
        sr_pbrt_suggest(&s, named[i].name);
    }
    char buffer[160];
    return sr_pbrt_fail(
        b->d, where, b->error, SR_ERROR_INPUT,
        "Meter \"%s\": no shape has the name \"%s\", which a line #@ Name \"%s\" before it would give%s", e->model,
        name, name, sr_pbrt_suggestion_text(&s, buffer));
}

/* ---- meters ---- */

static sr_status unknown_meter(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e)
{
    char list[512] = "", buffer[160];
    struct sr_pbrt_suggestion s = {.word = e->model};
    for (int i = 0; sr_meter_models[i]; ++i) {
        sr_pbrt_suggest(&s, sr_meter_models[i]->name);
        if (i)
            strncat(list, ", ", sizeof list - strlen(list) - 1);
        strncat(list, sr_meter_models[i]->name, sizeof list - strlen(list) - 1);
    }
    return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                        "Meter \"%s\": there is no such kind of meter%s; kinds: %s", e->model,
                        sr_pbrt_suggestion_text(&s, buffer), list);
}

static sr_status check_name(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_meter *meters,
                            uint32_t count, struct sr_meter_common *common)
{
    if (!common->name && !(common->name = sr_arena_printf(b->arena, "meter %u", (unsigned)count + 1)))
        return sr_pbrt_no_memory(b);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(sr_meter_common(&meters[i])->name, common->name) == 0)
            return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                                "Meter \"%s\": the name \"%s\" is taken, by line %d", e->model, common->name,
                                SR_PBRT_AT(b->d->meters, struct sr_pbrt_entity, i)->where.line);
    return SR_OK;
}

static sr_status check_lambda(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e,
                              const struct sr_meter_common *common)
{
    const float *l = common->lambda.data;
    struct sr_spectrometer s;
    struct sr_error inner = {0};
    if (common->lambda.count == 0)
        return SR_OK;
    struct sr_location where = sr_pbrt_find(&e->params, "lambda")->where;
    if (common->lambda.count != 3)
        return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT,
                            "\"float lambda\" of Meter \"%s\" has %u values: expected first, step, last [nm]", e->model,
                            (unsigned)common->lambda.count);
    if (sr_spectrometer_prepare((double)l[0], (double)l[1], (double)l[2], (double)common->fwhm,
                                (enum sr_meter_bandpass)common->bandpass, &s, &inner) != SR_OK)
        return sr_pbrt_fail(b->d, where, b->error, inner.status, "Meter \"%s\": %s", e->model, inner.text);
    return SR_OK;
}

static sr_status build_meter(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_meter *meters,
                             uint32_t count)
{
    static const struct sr_pbrt_use plain = {SR_PARAM_ALBEDO, false};
    const struct sr_meter_model *m = sr_meter_model_find(e->model);
    if (!m)
        return unknown_meter(b, e);
    void *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    sr_status status = sr_pbrt_bind(b, sr_meter_common_params, e, plain, self);
    if (status == SR_OK)
        status = sr_pbrt_bind(b, m->params, e, plain, self);
    if (status == SR_OK)
        status = check_name(b, e, meters, count, self);
    if (status == SR_OK)
        status = check_lambda(b, e, self);
    if (status == SR_OK)
        status = find_surface(b, e, m, self);
    if (status != SR_OK)
        return status;
    struct sr_error inner = {0};
    struct sr_transform to_world = sr_pbrt_transform_of(b, e->transform, SR_PBRT_TO_WORLD);
    if (m->prepare(self, &to_world, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    meters[count] = (struct sr_meter){m, self};
    sr_pbrt_warn_unused(b, e, m->params, sr_meter_common_params);
    return SR_OK;
}

sr_status sr_pbrt_build_meters(struct sr_pbrt_build *b)
{
    size_t n = b->d->meters.count;
    struct sr_meter *meters = sr_arena_alloc(b->arena, (n + 1) * sizeof *meters);
    if (!meters)
        return sr_pbrt_no_memory(b);
    for (uint32_t i = 0; i < n; ++i)
        if (build_meter(b, SR_PBRT_AT(b->d->meters, struct sr_pbrt_entity, i), meters, i) != SR_OK)
            return b->error->status;
    b->result->meters = meters;
    b->result->meter_count = (uint32_t)n;
    return SR_OK;
}
