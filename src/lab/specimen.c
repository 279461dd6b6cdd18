/* SPDX-License-Identifier: MIT */
/* A specimen from words: models with their parameters, files of measured data, materials of scenes, and sums of these.
 *
 * Parameters go through the material that follows from the model's table, the same way as those of a scene file, so
 * that a specimen is what a scene of these words would show. Materials of scenes are taken at uv = (0.5, 0.5), in the
 * frame of their shading normal; a mix is taken apart into the sum that it stands for. */
#include "lab/private.h"

#include "import/import.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reading {
    struct sr_arena *arena;
    struct sr_log *log;
    struct sr_error *error;
};

static sr_status no_memory(const struct reading *r)
{
    return sr_fail(r->error, SR_ERROR_RESOURCE, "not enough memory for a specimen");
}

/* ---- suggestions ---- */

/* Letters to insert, delete or replace between two words (Levenshtein 1966); the first 31 letters count. */
static int distance(const char *a, const char *b)
{
    int row[32], n = 0;
    for (; b[n] && n < 31; ++n)
        row[n] = n;
    row[n] = n;
    for (int i = 0; a[i] && i < 31; ++i) {
        int before = row[0];
        row[0] = i + 1;
        for (int j = 1; j <= n; ++j) {
            int replaced = before + (a[i] != b[j - 1]), other = 1 + (row[j] < row[j - 1] ? row[j] : row[j - 1]);
            before = row[j];
            row[j] = replaced < other ? replaced : other;
        }
    }
    return row[n];
}
static void suggest(const char *word, const char *candidate, const char **best, int *least)
{
    int d = distance(word, candidate);
    if (d < *least && d < (int)strlen(candidate)) {
        *least = d;
        *best = candidate;
    }
}

/* ---- values ---- */

static bool number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end != text && *end == 0 && isfinite(*value);
}

static sr_status parse_float(const struct reading *r, const struct sr_param *row, const char *text, float *out)
{
    double v;
    if (!number(text, &v) || v < row->min || v > row->max)
        return sr_fail(r->error, SR_ERROR_INPUT, "%s=%s: a number from %g to %g [%s] was expected", row->name, text,
                       row->min, row->max, row->unit);
    *out = (float)v;
    return SR_OK;
}

/* pairs: lambda [nm], value, … */
static sr_status spectrum_of_pairs(const struct reading *r, const char *what, const float *pairs, size_t count,
                                   struct sr_spd *out)
{
    float *columns = sr_arena_alloc(r->arena, (2 * count + 1) * sizeof *columns);
    if (!columns)
        return no_memory(r);
    for (size_t i = 0; i < count; ++i) {
        columns[i] = pairs[2 * i];
        columns[count + i] = pairs[2 * i + 1];
    }
    struct sr_error inner = {0};
    *out = sr_spd_from_samples(r->arena, columns, columns + count, (int)count, &inner);
    return inner.status == SR_OK ? SR_OK : sr_fail(r->error, SR_ERROR_INPUT, "%s: %s", what, inner.text);
}

/* Numbers between anything of `between`; '#' begins a comment of one line. */
static sr_status spectrum_of_text(const struct reading *r, const char *what, const char *text, const char *between,
                                  struct sr_spd *out)
{
    struct sr_array pairs = {0};
    sr_status status = SR_OK;
    for (const char *p = text; status == SR_OK;) {
        p += strspn(p, between);
        if (*p == '#') {
            p += strcspn(p, "\n");
            continue;
        }
        if (!*p)
            break;
        char *end;
        float v = strtof(p, &end), *slot = end != p && isfinite(v) ? sr_array_push(&pairs, sizeof *slot) : NULL;
        if (slot)
            *slot = v;
        else
            status = end == p || !isfinite(v)
                         ? sr_fail(r->error, SR_ERROR_INPUT,
                                   "%s: pairs of wavelength [nm] and value were expected, at \"%.16s\"", what, p)
                         : no_memory(r);
        p = end;
    }
    if (status == SR_OK && (pairs.count < 4 || pairs.count % 2 || pairs.count > 1 << 22))
        status = sr_fail(r->error, SR_ERROR_INPUT,
                         "%s: has %zu numbers: two or more pairs of wavelength [nm] and value were expected", what,
                         pairs.count);
    if (status == SR_OK)
        status = spectrum_of_pairs(r, what, pairs.data, pairs.count / 2, out);
    sr_array_free(&pairs);
    return status;
}

static sr_status parse_rgb(const struct reading *r, const struct sr_param *row, const char *text, struct sr_spd *out)
{
    bool is_albedo = row->kind == SR_PARAM_ALBEDO_TEXTURE || row->kind == SR_PARAM_ALBEDO;
    float v[3];
    const char *p = text + strlen("rgb:");
    for (int i = 0; i < 3; ++i) {
        char *end;
        v[i] = strtof(p, &end);
        if (end == p || !(v[i] >= 0 && v[i] <= (is_albedo ? 1 : INFINITY)) || *end != (i < 2 ? ',' : 0))
            return sr_fail(r->error, SR_ERROR_INPUT, "%s=%s: rgb:R,G,B with numbers from 0%s was expected", row->name,
                           text, is_albedo ? " to 1" : "");
        p = end + 1;
    }
    struct sr_rgb rgb = {v[0], v[1], v[2]};
    *out = is_albedo ? sr_spd_from_rgb_albedo(SR_SRGB, rgb) : sr_spd_from_rgb_unbounded(SR_SRGB, rgb);
    return SR_OK;
}

static sr_status parse_spectrum(const struct reading *r, const struct sr_param *row, const char *text,
                                struct sr_spd *out)
{
    double v;
    sr_status status = SR_OK;
    if (number(text, &v))
        *out = sr_spd_constant((float)v);
    else if (strncmp(text, "rgb:", 4) == 0)
        status = parse_rgb(r, row, text, out);
    else if (text[strspn(text, "0123456789.")] == ':')
        status = spectrum_of_text(r, text, text, ":,", out);
    else if ((*out = sr_spd_named(text)).kind != SR_SPD_NONE)
        status = SR_OK;
    else if (sr_file_exists(text)) {
        char *data;
        size_t size;
        status = sr_file_read(text, 64 << 20, &data, &size, r->error);
        if (status == SR_OK) {
            status = spectrum_of_text(r, text, data, " \t\r\n,;", out);
            sr_free(data);
        }
    } else {
        const char *best = NULL;
        int least = 4;
        for (int i = 0; sr_spd_name(i); ++i)
            suggest(text, sr_spd_name(i), &best, &least);
        return sr_fail(r->error, SR_ERROR_INPUT,
                       "%s=%s: a number, the name of a spectrum, a file of \"nm value\" lines, rgb:R,G,B or "
                       "nm:value,nm:value was expected%s%s%s",
                       row->name, text, best ? "; did you mean " : "", best ? best : "", best ? "?" : "");
    }
    if (status != SR_OK)
        return status;
    for (float nm = SR_LAMBDA_MIN; nm <= SR_LAMBDA_MAX; nm += 5) {
        double at = (double)sr_spd_at(out, nm);
        bool is_outside_table = at == 0 && out->kind == SR_SPD_TABLE;
        if (!(at <= row->max && (at >= row->min || is_outside_table)))
            return sr_fail(r->error, SR_ERROR_INPUT, "%s=%s: is %g [%s] at %g nm: %g to %g was expected", row->name,
                           text, at, row->unit, (double)nm, row->min, row->max);
    }
    return SR_OK;
}

static sr_status parse_choice(const struct reading *r, const struct sr_param *row, const char *text, int32_t *out)
{
    int32_t i = 0;
    for (const char *p = row->text; *p; ++i) {
        size_t n = strcspn(p, "|");
        char index[16];
        snprintf(index, sizeof index, "%d", (int)i);
        if ((strlen(text) == n && strncmp(p, text, n) == 0) || strcmp(text, index) == 0) {
            *out = i;
            return SR_OK;
        }
        p += n + (p[n] == '|');
    }
    return sr_fail(r->error, SR_ERROR_INPUT, "%s=%s: one of %s was expected", row->name, text, row->text);
}

/* ---- a part ---- */

static bool has_number(enum sr_param_kind kind)
{
    return kind == SR_PARAM_FLOAT || kind == SR_PARAM_FLOAT_TEXTURE;
}
static bool has_spectrum(enum sr_param_kind kind)
{
    return kind == SR_PARAM_ALBEDO_TEXTURE || kind == SR_PARAM_UNBOUNDED_TEXTURE;
}

/* What a parameter is where no word gives it. Textures stay as they are: materials know their own. */
static void set_initial(const struct sr_param *row, void *at)
{
    if (row->kind == SR_PARAM_FLOAT)
        memcpy(at, &(float){(float)row->initial}, sizeof(float));
    else if (row->kind == SR_PARAM_INT || row->kind == SR_PARAM_ENUM)
        memcpy(at, &(int32_t){isfinite(row->initial) ? (int32_t)row->initial : 0}, sizeof(int32_t));
    else if (row->kind == SR_PARAM_BOOL)
        memcpy(at, &(bool){row->initial > 0}, sizeof(bool));
    else if (row->kind == SR_PARAM_STRING)
        memcpy(at, &row->text, sizeof row->text);
}

static sr_status set(const struct reading *r, const struct sr_param *row, const char *text, void *at)
{
    float f = 0;
    int32_t i = 0;
    double v;
    struct sr_spd spd;
    sr_status status = SR_OK;
    if (has_number(row->kind)) {
        if (parse_float(r, row, text, &f) != SR_OK)
            return r->error->status;
        if (row->kind == SR_PARAM_FLOAT)
            memcpy(at, &f, sizeof f);
        else
            *(struct sr_texture *)at = sr_texture_constant_float(r->arena, f);
        return row->kind == SR_PARAM_FLOAT || ((struct sr_texture *)at)->model ? SR_OK : no_memory(r);
    }
    if (has_spectrum(row->kind)) {
        if (parse_spectrum(r, row, text, &spd) != SR_OK)
            return r->error->status;
        *(struct sr_texture *)at = sr_texture_constant_spectrum(r->arena, spd);
        return ((struct sr_texture *)at)->model ? SR_OK : no_memory(r);
    }
    switch (row->kind) {
    case SR_PARAM_INT:
        if (!number(text, &v) || v != floor(v) || v < row->min || v > row->max)
            return sr_fail(r->error, SR_ERROR_INPUT, "%s=%s: a whole number from %g to %g was expected", row->name,
                           text, row->min, row->max);
        memcpy(at, &(int32_t){(int32_t)v}, sizeof(int32_t));
        break;
    case SR_PARAM_ENUM:
        status = parse_choice(r, row, text, &i);
        if (status == SR_OK)
            memcpy(at, &i, sizeof i);
        break;
    case SR_PARAM_BOOL:
        if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0)
            return sr_fail(r->error, SR_ERROR_INPUT, "%s=%s: true or false was expected", row->name, text);
        memcpy(at, &(bool){text[0] == 't'}, sizeof(bool));
        break;
    case SR_PARAM_FILE:
    case SR_PARAM_STRING: {
        const char *copy = sr_arena_string(r->arena, text);
        if (!copy)
            return no_memory(r);
        memcpy(at, &copy, sizeof copy);
        break;
    }
    default:
        return sr_fail(r->error, SR_ERROR_INPUT, "%s: cannot be given in words, only in a scene", row->name);
    }
    return status;
}

static sr_status unknown_parameter(const struct reading *r, const struct sr_material_model *m, const char *word)
{
    char list[512] = "", name[64];
    size_t n = 0;
    const char *best = NULL;
    int least = 4;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "="), word);
    for (const struct sr_param *p = m->params; p->name; ++p) {
        if (n < sizeof list - 80)
            n += (size_t)snprintf(list + n, sizeof list - n, "%s%s", n ? ", " : "", p->name);
        suggest(name, p->name, &best, &least);
    }
    return sr_fail(r->error, SR_ERROR_INPUT, "%s has no parameter \"%s\"%s%s%s; it has %s", m->name, name,
                   best ? ": did you mean " : "", best ? best : "", best ? "?" : "", list[0] ? list : "none");
}

/* From a model's words "name=value". */
static sr_status make_material(const struct reading *r, const struct sr_material_model *m, int count,
                               const char *const *words, struct sr_material *out)
{
    unsigned char *self = sr_arena_alloc(r->arena, m->size);
    if (!self)
        return no_memory(r);
    for (const struct sr_param *p = m->params; p->name; ++p)
        set_initial(p, self + p->offset);
    for (int i = 0; i < count; ++i) {
        const char *sign = strchr(words[i], '=');
        if (!sign)
            return sr_fail(r->error, SR_ERROR_INPUT,
                           "\"%s\": name=value was expected after %s, or + before another part", words[i], m->name);
        const struct sr_param *p = m->params;
        while (p->name && (strlen(p->name) != (size_t)(sign - words[i]) ||
                           strncmp(p->name, words[i], (size_t)(sign - words[i])) != 0))
            ++p;
        if (!p->name)
            return unknown_parameter(r, m, words[i]);
        for (int k = 0; k < i; ++k)
            if (strncmp(words[k], words[i], (size_t)(sign - words[i]) + 1) == 0)
                return sr_fail(r->error, SR_ERROR_INPUT, "%s is given twice", p->name);
        if (set(r, p, sign + 1, self + p->offset) != SR_OK)
            return r->error->status;
    }
    struct sr_error inner = {0};
    if (sr_material_prepare(m, self, r->arena, &inner) != SR_OK)
        return sr_fail(r->error, inner.status, "%s: %s", m->name, inner.text);
    out->model = m;
    out->self = self;
    return SR_OK;
}

static sr_status unknown_model(const struct reading *r, const char *word)
{
    const char *best = NULL;
    int least = 4;
    for (int i = 0; sr_bsdf_models[i]; ++i)
        suggest(word, sr_bsdf_models[i]->name, &best, &least);
    return sr_fail(
        r->error, SR_ERROR_INPUT,
        "\"%s\" is neither a model ('steradian brdf list' tells them) nor a file nor SCENE.pbrt:MATERIAL%s%s%s", word,
        best ? "; did you mean " : "", best ? best : "", best ? "?" : "");
}

/* "SCENE.pbrt:NAME", also ".pbrt.gz"; NULL where it is not of this form. */
static const char *material_name(const char *word)
{
    const char *colon = strrchr(word, ':');
    if (!colon || !colon[1])
        return NULL;
    size_t n = (size_t)(colon - word);
    return (n > 5 && strncmp(colon - 5, ".pbrt", 5) == 0) || (n > 8 && strncmp(colon - 8, ".pbrt.gz", 8) == 0)
               ? colon + 1
               : NULL;
}

static struct sr_point middle(void)
{
    return (struct sr_point){
        .n = {0, 0, 1}, .ns = {0, 0, 1}, .dpdu = {1, 0, 0}, .dpdv = {0, 1, 0}, .dpdus = {1, 0, 0}, .uv = {0.5f, 0.5f}};
}

/* Adds a material; a mix as its parts, with the amount found by halving: choose gives the second where u < amount. */
static sr_status add(const struct reading *r, const struct sr_material *material, float weight,
                     const struct sr_bsdf_model *model, int depth, struct sr_specimen *specimen)
{
    if (!material || !material->model || strcmp(material->model->name, "interface") == 0)
        return sr_fail(r->error, SR_ERROR_INPUT, "an interface does not scatter: nothing can be told of it");
    if (material->model->choose && depth < 8) {
        struct sr_point x = middle();
        struct sr_wavelengths w = {.lambda = SR_BLACK + 550, .pdf = SR_ONE};
        float lo = 0, hi = 1;
        struct sr_material_context c = {.x = &x, .wo = {0, 0, 1}, .w = &w, .u = SR_ONE_MINUS_EPSILON};
        const struct sr_material *first = material->model->choose(material->self, &c);
        c.u = 0;
        const struct sr_material *second = material->model->choose(material->self, &c);
        if (first == second)
            return add(r, first, weight, model, depth + 1, specimen);
        for (int i = 0; i < 32; ++i) {
            float u = (lo + hi) / 2;
            c.u = u;
            if (material->model->choose(material->self, &c) == second)
                lo = u;
            else
                hi = u;
        }
        sr_status status = add(r, first, weight * (1 - hi), model, depth + 1, specimen);
        return status == SR_OK ? add(r, second, weight * hi, model, depth + 1, specimen) : status;
    }
    if (specimen->part_count == SR_SPECIMEN_PARTS)
        return sr_fail(r->error, SR_ERROR_INPUT, "a specimen has at most %d parts", SR_SPECIMEN_PARTS);
    specimen->parts[specimen->part_count++] = (struct sr_specimen_part){*material, weight, model};
    return SR_OK;
}

/* One part: [weight*]HEAD [name=value …] */
static sr_status read_part(const struct reading *r, int count, const char *const *words, struct sr_specimen *specimen)
{
    const char *head = words[0];
    char *end;
    float weight = strtof(head, &end);
    if (end != head && *end == '*' && !sr_file_exists(head)) {
        if (!(weight > 0 && weight < INFINITY))
            return sr_fail(r->error, SR_ERROR_INPUT, "%s: the weight of a part is above 0", head);
        head = end + 1;
    } else
        weight = 1;
    struct sr_material material = {0};
    const struct sr_bsdf_model *model = sr_bsdf_model_find(head);
    const struct sr_material_model *m = model ? sr_material_of_bsdf(model) : sr_material_model_find(head);
    sr_status status;
    if (m)
        status = make_material(r, m, count - 1, words + 1, &material);
    else if (material_name(head)) {
        const char *name = material_name(head);
        char *path = sr_arena_string(r->arena, head);
        const struct sr_material *found = NULL;
        if (!path)
            return no_memory(r);
        path[name - 1 - head] = 0;
        if (count > 1)
            return sr_fail(r->error, SR_ERROR_INPUT,
                           "%s: the material of a scene has its values there: \"%s\" was not expected", head, words[1]);
        status = sr_import_pbrt_material(path, name, r->arena, &found, r->log, r->error);
        if (status == SR_OK && found)
            material = *found;
    } else if (sr_file_exists(head)) {
        model = sr_bsdf_model_find("measured");
        if (!model)
            return sr_fail(r->error, SR_ERROR_INPUT, "%s: files of measured data are not supported", head);
        const char **more = sr_arena_alloc(r->arena, ((size_t)count + 1) * sizeof *more);
        if (!more || !(more[0] = sr_arena_printf(r->arena, "filename=%s", head)))
            return no_memory(r);
        for (int i = 1; i < count; ++i)
            more[i] = words[i];
        status = make_material(r, sr_material_of_bsdf(model), count, more, &material);
    } else
        status = unknown_model(r, head);
    return status == SR_OK ? add(r, &material, weight, model, 0, specimen) : status;
}

sr_status sr_specimen_read(struct sr_arena *arena, int count, const char *const *words, struct sr_specimen *specimen,
                           struct sr_log log, struct sr_error *error)
{
    struct reading r = {arena, &log, error};
    *specimen = (struct sr_specimen){0};
    size_t length = 1;
    for (int i = 0; i < count; ++i)
        length += strlen(words[i]) + 1;
    char *title = sr_arena_alloc(arena, length);
    if (!title)
        return no_memory(&r);
    for (int i = 0; i < count; ++i) {
        if (i)
            strcat(title, " ");
        strcat(title, words[i]);
    }
    specimen->title = title;
    if (count == 0)
        return sr_fail(error, SR_ERROR_USAGE, "a model, a file of measured data, or SCENE.pbrt:MATERIAL was expected");
    for (int first = 0, i = 0; i <= count; ++i)
        if (i == count || strcmp(words[i], "+") == 0) {
            if (i == first)
                return sr_fail(error, SR_ERROR_USAGE, "a part was expected on either side of +");
            sr_status status = read_part(&r, i - first, words + first, specimen);
            if (status != SR_OK)
                return status;
            first = i + 1;
        }
    return SR_OK;
}

void sr_specimen_at(const struct sr_specimen *specimen, sr_spectrum lambda, uint32_t seed, struct sr_specimen_at *at)
{
    struct sum sum = {.parts = at->parts, .count = specimen->part_count};
    float total = 0;
    bool is_random = false;
    at->lambda = lambda;
    for (int j = 0; j < specimen->part_count; ++j) {
        struct sr_point x = middle();
        struct sr_frame unused;
        struct sr_wavelengths w = {.lambda = lambda, .pdf = SR_ONE};
        sr_material_shade(&specimen->parts[j].material, &x, (sr_vec3){0, 0, 1}, 0.5f,
                          sr_hash_combine(seed, (uint32_t)j), &w, &at->parts[j], &unused);
        sum.weight[j] = specimen->parts[j].weight;
        sum.share[j] = sr_bsdf_lobes(&at->parts[j]) ? sum.weight[j] : 0;
        total += sum.share[j];
        is_random |= at->parts[j].model->is_random;
    }
    if (specimen->part_count == 1 && sum.weight[0] == 1) {
        at->bsdf = at->parts[0];
        return;
    }
    for (int j = 0; j < specimen->part_count && total > 0; ++j)
        sum.share[j] /= total;
    at->bsdf.model = is_random ? &lab_random_sum : &lab_sum;
    memcpy(at->bsdf.data, &sum, sizeof sum);
}
