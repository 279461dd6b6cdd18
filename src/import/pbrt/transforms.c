/* SPDX-License-Identifier: MIT */
/* The directives that change the current transform: CTM <- CTM T, for the shutter's opening, its closing, or both.
 *
 * The sixteen numbers of Transform and ConcatTransform stand column after column. */
#include "import/pbrt/parser.h"

#include <string.h>

static sr_status set(struct sr_pbrt_parser *p, const struct sr_matrix *a, bool is_relative)
{
    struct sr_transform t = sr_matrix_to_transform(a);
    if (!sr_transform_is_valid(&t))
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT, "%s: expected a transform that can be inverted",
                            p->directive);
    struct sr_matrix *ctm[2] = {p->state.at_start ? &p->state.ctm.start : NULL,
                                p->state.at_end ? &p->state.ctm.end : NULL};
    for (int i = 0; i < 2; ++i)
        if (ctm[i])
            *ctm[i] = is_relative ? sr_matrix_multiply(ctm[i], a) : *a;
    p->state.transform = UINT32_MAX;
    return SR_OK;
}

uint32_t sr_pbrt_store_transform(struct sr_pbrt_parser *p)
{
    if (p->state.transform == UINT32_MAX) {
        struct sr_pbrt_transform *t = sr_array_push(&p->d->transforms, sizeof *t);
        if (!t) {
            sr_fail(p->error, SR_ERROR_RESOURCE, "%s: not enough memory for its transforms", p->main_path);
            return UINT32_MAX;
        }
        *t = p->state.ctm;
        p->state.transform = (uint32_t)p->d->transforms.count - 1;
    }
    return p->state.transform;
}

sr_status sr_pbrt_read_identity(struct sr_pbrt_parser *p)
{
    struct sr_matrix a = sr_matrix_identity();
    return set(p, &a, false);
}

sr_status sr_pbrt_read_translate(struct sr_pbrt_parser *p)
{
    double v[3];
    if (sr_pbrt_read_numbers(p, 3, v) != SR_OK)
        return p->error->status;
    struct sr_matrix a = sr_matrix_translate(v);
    return set(p, &a, true);
}

sr_status sr_pbrt_read_scale(struct sr_pbrt_parser *p)
{
    double v[3];
    if (sr_pbrt_read_numbers(p, 3, v) != SR_OK)
        return p->error->status;
    if (v[0] == 0 || v[1] == 0 || v[2] == 0)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "Scale %g %g %g: expected three numbers other than 0", v[0], v[1], v[2]);
    struct sr_matrix a = sr_matrix_scale(v);
    return set(p, &a, true);
}

sr_status sr_pbrt_read_rotate(struct sr_pbrt_parser *p)
{
    double v[4];
    if (sr_pbrt_read_numbers(p, 4, v) != SR_OK)
        return p->error->status;
    if (v[1] == 0 && v[2] == 0 && v[3] == 0)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "Rotate about the axis 0 0 0: expected an axis of some length");
    struct sr_matrix a = sr_matrix_rotate(v[0], v + 1);
    return set(p, &a, true);
}

sr_status sr_pbrt_read_look_at(struct sr_pbrt_parser *p)
{
    double v[9];
    if (sr_pbrt_read_numbers(p, 9, v) != SR_OK)
        return p->error->status;
    struct sr_matrix a;
    if (!sr_matrix_look_at(v, v + 3, v + 6, &a))
        return sr_pbrt_fail(
            p->d, p->where, p->error, SR_ERROR_INPUT,
            "LookAt: the eye is where it looks, or up points along the view: expected three different directions");
    return set(p, &a, true);
}

static sr_status read_matrix(struct sr_pbrt_parser *p, bool is_relative)
{
    double v[16];
    if (sr_pbrt_read_numbers(p, 16, v) != SR_OK)
        return p->error->status;
    struct sr_matrix a;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            a.m[row][column] = v[column * 4 + row];
    return set(p, &a, is_relative);
}

sr_status sr_pbrt_read_transform(struct sr_pbrt_parser *p)
{
    return read_matrix(p, false);
}

sr_status sr_pbrt_read_concat_transform(struct sr_pbrt_parser *p)
{
    return read_matrix(p, true);
}

/* ---- names for transforms ---- */

sr_status sr_pbrt_name_coordinates(struct sr_pbrt_parser *p, const char *name, const struct sr_pbrt_transform *t)
{
    struct sr_pbrt_coordinates *c = NULL;
    for (size_t i = 0; i < p->coordinates.count && !c; ++i) {
        struct sr_pbrt_coordinates *known = SR_PBRT_AT(p->coordinates, struct sr_pbrt_coordinates, i);
        c = strcmp(known->name, name) == 0 ? known : NULL;
    }
    if (!c)
        c = sr_array_push(&p->coordinates, sizeof *c);
    if (!c)
        return sr_fail(p->error, SR_ERROR_RESOURCE, "%s: not enough memory", p->main_path);
    *c = (struct sr_pbrt_coordinates){name, *t};
    return SR_OK;
}

sr_status sr_pbrt_read_coordinate_system(struct sr_pbrt_parser *p)
{
    const char *name;
    if (sr_pbrt_read_string(p, "a name for the coordinate system", &name) != SR_OK)
        return p->error->status;
    return sr_pbrt_name_coordinates(p, name, &p->state.ctm);
}

sr_status sr_pbrt_read_coord_sys_transform(struct sr_pbrt_parser *p)
{
    const char *name;
    char buffer[160];
    if (sr_pbrt_read_string(p, "the name of a coordinate system", &name) != SR_OK)
        return p->error->status;
    struct sr_pbrt_suggestion s = {.word = name};
    for (size_t i = 0; i < p->coordinates.count; ++i) {
        const struct sr_pbrt_coordinates *c = SR_PBRT_AT(p->coordinates, struct sr_pbrt_coordinates, i);
        sr_pbrt_suggest(&s, c->name);
        if (strcmp(c->name, name) == 0) {
            p->state.ctm = c->transform;
            p->state.transform = UINT32_MAX;
            return SR_OK;
        }
    }
    sr_pbrt_warn(p->d, p->where,
                 "CoordSysTransform \"%s\": no coordinate system has this name; the transform stays as it is%s", name,
                 sr_pbrt_suggestion_text(&s, buffer));
    return SR_OK;
}

/* ---- motion ---- */

sr_status sr_pbrt_read_active_transform(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_token token;
    if (sr_pbrt_lexer_next(p->lexer, &token, p->error) != SR_OK)
        return p->error->status;
    static const char *const words[] = {"All", "StartTime", "EndTime"};
    for (int i = 0; i < 3; ++i)
        if (token.kind == SR_PBRT_WORD && token.length == strlen(words[i]) &&
            memcmp(token.text, words[i], token.length) == 0) {
            p->state.at_start = i != 2;
            p->state.at_end = i != 1;
            return SR_OK;
        }
    return sr_pbrt_fail(p->d, token.where, p->error, SR_ERROR_INPUT,
                        "ActiveTransform: expected All, StartTime or EndTime");
}

sr_status sr_pbrt_read_transform_times(struct sr_pbrt_parser *p)
{
    double v[2];
    if (sr_pbrt_read_numbers(p, 2, v) != SR_OK)
        return p->error->status;
    if (!(v[0] <= v[1]) || !isfinite(v[0]) || !isfinite(v[1]))
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "TransformTimes %g %g: expected two times, the earlier one first", v[0], v[1]);
    p->d->transform_start_time = (float)v[0];
    p->d->transform_end_time = (float)v[1];
    return SR_OK;
}
