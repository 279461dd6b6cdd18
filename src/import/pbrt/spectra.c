/* SPDX-License-Identifier: MIT */
/* Values of parameters as spectra: rgb by its use, blackbody, inline samples, names, and files of two columns.
 *
 * Files hold wavelength [nm] and value, lines of their own, # begins a comment. */
#include "import/number.h"
#include "import/pbrt/build.h"

#include <string.h>

struct sr_pbrt_spectrum_file {
    const char *path;
    struct sr_spd value;
};

static sr_status from_samples(struct sr_pbrt_build *b, const float *pairs, uint32_t count, const char *what,
                              struct sr_location where, struct sr_spd *out)
{
    float *columns = sr_arena_alloc(&b->scratch, 2 * sizeof(float) * (size_t)count);
    if (!columns)
        return sr_pbrt_no_memory(b);
    for (uint32_t i = 0; i < count; ++i) {
        columns[i] = pairs[2 * i];
        columns[count + i] = pairs[2 * i + 1];
    }
    struct sr_error inner = {0};
    *out = sr_spd_from_samples(b->arena, columns, columns + count, (int)count, &inner);
    return inner.status == SR_OK ? SR_OK
                                 : sr_pbrt_fail(b->d, where, b->error, inner.status, "%s: %s", what, inner.text);
}

static sr_status read_pairs(struct sr_pbrt_build *b, const char *path, const char *text, struct sr_location where,
                            struct sr_array *pairs)
{
    int line = 1;
    for (const char *p = text;;) {
        double value;
        while (*p == ' ' || *p == '\t' || *p == '\r' || *p == '\n' || *p == ',')
            line += *p++ == '\n';
        if (*p == '#') {
            while (*p && *p != '\n')
                ++p;
            continue;
        }
        if (!*p)
            break;
        const char *end = sr_number_read(p, &value);
        if (!end)
            return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT,
                                "%s:%d: expected wavelengths (nm) and values, all of them numbers", path, line);
        float *slot = sr_array_push(pairs, sizeof *slot);
        if (!slot)
            return sr_pbrt_no_memory(b);
        *slot = (float)value;
        p = end;
    }
    if (pairs->count < 2 || pairs->count % 2 || pairs->count > 1 << 24)
        return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT,
                            "%s: has %zu numbers: expected pairs of wavelength (nm) and value", path, pairs->count);
    return SR_OK;
}

static sr_status from_file(struct sr_pbrt_build *b, const char *path, struct sr_location where, struct sr_spd *out)
{
    for (size_t i = 0; i < b->spectra.count; ++i) {
        const struct sr_pbrt_spectrum_file *f = SR_PBRT_AT(b->spectra, struct sr_pbrt_spectrum_file, i);
        if (strcmp(f->path, path) == 0) {
            *out = f->value;
            return SR_OK;
        }
    }
    char *text;
    size_t size;
    struct sr_error inner = {0};
    struct sr_array pairs = {0};
    if (sr_file_read(path, 64 << 20, &text, &size, &inner) != SR_OK)
        return sr_pbrt_fail(b->d, where, b->error, inner.status, "%s", inner.text);
    b->hash = sr_pbrt_hash(b->hash, text, size);
    sr_status status = read_pairs(b, path, text, where, &pairs);
    if (status == SR_OK)
        status = from_samples(b, pairs.data, (uint32_t)(pairs.count / 2), path, where, out);
    sr_free(text);
    sr_array_free(&pairs);
    struct sr_pbrt_spectrum_file *f = status == SR_OK ? sr_array_push(&b->spectra, sizeof *f) : NULL;
    if (f)
        *f = (struct sr_pbrt_spectrum_file){path, *out};
    return status != SR_OK ? status : f ? SR_OK : sr_pbrt_no_memory(b);
}

static sr_status by_name(struct sr_pbrt_build *b, const struct sr_pbrt_param *p, struct sr_spd *out)
{
    const char *name = p->strings[0];
    *out = sr_spd_named(name);
    if (out->kind != SR_SPD_NONE)
        return SR_OK;
    char *path = sr_pbrt_resolve(b, &b->scratch, name, p->where);
    if (!path)
        return sr_pbrt_no_memory(b);
    if (sr_file_exists(path))
        return from_file(b, path, p->where, out);
    struct sr_pbrt_suggestion s = {.word = name};
    char buffer[160];
    for (int i = 0; sr_spd_name(i); ++i)
        sr_pbrt_suggest(&s, sr_spd_name(i));
    return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                        "\"spectrum %s\": \"%s\" is neither the name of a spectrum nor a file%s", p->name, name,
                        sr_pbrt_suggestion_text(&s, buffer));
}

static sr_status from_rgb(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                          enum sr_param_kind kind, struct sr_spd *out)
{
    if (p->count != 3)
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                            "\"rgb %s\" of %s \"%s\" has %u values: expected 3", p->name, e->directive, e->model,
                            p->count);
    struct sr_rgb rgb = {p->floats[0], p->floats[1], p->floats[2]};
    float largest = sr_max(rgb.r, sr_max(rgb.g, rgb.b));
    if (kind == SR_PARAM_ALBEDO && largest > 1)
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                            "\"rgb %s\" of %s \"%s\" has the component %g: expected 0 to 1, for it is a reflectance",
                            p->name, e->directive, e->model, (double)largest);
    *out = kind == SR_PARAM_ALBEDO      ? sr_spd_from_rgb_albedo(p->space, rgb)
           : kind == SR_PARAM_UNBOUNDED ? sr_spd_from_rgb_unbounded(p->space, rgb)
                                        : sr_spd_from_rgb_illuminant(p->space, rgb);
    return SR_OK;
}

sr_status sr_pbrt_spectrum(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                           enum sr_param_kind kind, struct sr_spd *out)
{
    switch (p->type) {
    case SR_PBRT_RGB:
        return from_rgb(b, e, p, kind, out);
    case SR_PBRT_BLACKBODY:
        if (p->count != 1 || !(p->floats[0] > 0) || !isfinite(p->floats[0]))
            return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                                "\"blackbody %s\": expected one temperature above 0 K", p->name);
        *out = sr_spd_blackbody(p->floats[0]);
        return SR_OK;
    case SR_PBRT_SPECTRUM:
        return p->is_text ? by_name(b, p, out) : from_samples(b, p->floats, p->count / 2, p->name, p->where, out);
    case SR_PBRT_FLOAT:
        if (p->count == 1 && p->floats[0] >= 0 && kind != SR_PARAM_ILLUMINANT) {
            *out = sr_spd_constant(p->floats[0]);
            return SR_OK;
        } // fall through
    default:
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                            "\"%s %s\" of %s \"%s\" is no spectrum: expected rgb, spectrum or blackbody",
                            sr_pbrt_type_name(p->type), p->name, e->directive, e->model);
    }
}
