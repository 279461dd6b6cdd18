/* SPDX-License-Identifier: MIT */
/* Hair comes as a directive a strand: those that follow one another and have all else in common become one shape. */
#include "import/pbrt/build.h"

#include <string.h>

bool sr_pbrt_is_curve(const struct sr_pbrt_shape *s)
{
    return strcmp(s->entity.model, sr_shape_curve.name) == 0;
}

static bool same_text(const char *a, const char *b)
{
    return a == b || (a && b && strcmp(a, b) == 0);
}

static bool same_alpha(const struct sr_pbrt_shape *a, const struct sr_pbrt_shape *b)
{
    const struct sr_pbrt_param *p = sr_pbrt_find(&a->entity.params, "alpha"),
                               *q = sr_pbrt_find(&b->entity.params, "alpha");
    if (!p || !q || p->type != q->type || p->count != 1 || q->count != 1)
        return p == q;
    return p->type == SR_PBRT_FLOAT ? p->floats[0] == q->floats[0]
                                    : p->type == SR_PBRT_TEXTURE && same_text(p->strings[0], q->strings[0]);
}

static bool same_state(const struct sr_pbrt_build *b, const struct sr_pbrt_shape *x, const struct sr_pbrt_shape *y)
{
    uint32_t i = x->entity.transform, j = y->entity.transform;
    return !y->name && x->material.index == y->material.index && same_text(x->material.name, y->material.name) &&
           x->area_light1 == y->area_light1 && x->object1 == y->object1 &&
           x->reverse_orientation == y->reverse_orientation && same_text(x->inside, y->inside) &&
           same_text(x->outside, y->outside) && same_alpha(x, y) &&
           (i == j ||
            memcmp(SR_PBRT_AT(b->d->transforms, struct sr_pbrt_transform, i),
                   SR_PBRT_AT(b->d->transforms, struct sr_pbrt_transform, j), sizeof(struct sr_pbrt_transform)) == 0);
}

static sr_status bind_curve(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s, struct sr_shape_curve *curve)
{
    struct sr_error inner = {0};
    b->is_borrowing = true;
    sr_status status =
        sr_pbrt_bind(b, sr_shape_curve.params, &s->entity, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, curve);
    b->is_borrowing = false;
    if (status == SR_OK && sr_shape_curve_segments(curve, &inner) == 0)
        return sr_pbrt_wrap(b, &s->entity, &inner);
    if (status == SR_OK && curve->N.count && curve->type != 1 && !b->has_warned_curve_normals) {
        b->has_warned_curve_normals = true;
        sr_pbrt_warn(b->d, s->entity.where, "Shape \"curve\": only ribbons have \"N\"");
    }
    return status;
}

sr_status sr_pbrt_curves(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s,
                         const struct sr_shape_placement *placement, struct sr_shape *shape, size_t *run)
{
    const struct sr_pbrt_shape *end = SR_PBRT_AT(b->d->shapes, struct sr_pbrt_shape, b->d->shapes.count);
    struct sr_array curves = {0};
    struct sr_shape_curves *self = sr_arena_alloc(b->arena, sizeof *self);
    sr_status status = self ? SR_OK : sr_pbrt_no_memory(b);
    for (const struct sr_pbrt_shape *i = s; i < end && status == SR_OK; ++i) {
        struct sr_shape_curve curve = {0};
        if (i > s && !(sr_pbrt_is_curve(i) && same_state(b, s, i)))
            break;
        if ((status = bind_curve(b, i, &curve)) != SR_OK)
            break;
        const struct sr_shape_curve *first = i == s ? &curve : curves.data;
        if (curve.type != first->type || curve.split_depth != first->split_depth || curves.count == UINT32_MAX)
            break;
        struct sr_shape_curve *slot = sr_array_push(&curves, sizeof *slot);
        if (!slot)
            status = sr_pbrt_no_memory(b);
        else
            *slot = curve;
    }
    struct sr_error inner = {0};
    if (status == SR_OK &&
        sr_shape_curves_make(curves.data, (uint32_t)curves.count, placement, b->arena, self, &inner) != SR_OK)
        status = sr_pbrt_wrap(b, &s->entity, &inner);
    *shape = (struct sr_shape){&sr_shape_curve, self};
    *run = curves.count;
    sr_array_free(&curves);
    return status;
}
