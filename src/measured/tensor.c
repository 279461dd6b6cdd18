/* SPDX-License-Identifier: MIT */
/* Tensor files: named arrays in one file, as RGL (EPFL) and the polarised measurements of KAIST use them.
 *
 *     "tensor_file\0", version 1 0, uint32 count; for each field: uint16 length, name, uint16 dimensions n, uint8 type,
 *     uint64 offset, n uint64 sizes; then the data, each at its offset from the beginning of the file. Little-endian.
 *
 * Nothing is trusted: each size is held against the file's before it is used. */
#include "measured/private.h"

static const uint8_t type_size[12] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
static const char *const type_name[12] = {"nothing", "uint8",  "int8",  "uint16",  "int16",   "uint32",
                                          "int32",   "uint64", "int64", "float16", "float32", "float64"};

struct reader {
    const struct source *source;
    size_t at;
    bool failed;
};

static uint64_t take(struct reader *r, int bytes, const char *what)
{
    uint64_t value = 0;
    if (r->failed)
        return 0;
    if (r->source->size - r->at < (size_t)bytes) {
        r->failed = true;
        fail_at(r->source, 0, "ends at byte %zu, in the header: %s is expected at byte %zu", r->source->size, what,
                r->at);
        return 0;
    }
    for (int i = bytes - 1; i >= 0; --i)
        value = value << 8 | (uint8_t)r->source->data[r->at + (size_t)i];
    r->at += (size_t)bytes;
    return value;
}

static sr_status read_field(struct reader *r, struct tensor_field *f)
{
    const struct source *s = r->source;
    size_t length = (size_t)take(r, 2, "the length of a field's name"), at = r->at;
    if (!r->failed && length >= sizeof f->name)
        return fail_at(s, 0, "byte %zu: a field's name of %zu characters, at most %zu are expected", at - 2, length,
                       sizeof f->name - 1);
    for (size_t i = 0; i < length; ++i) {
        char c = (char)take(r, 1, "a field's name");
        f->name[i] = c >= 32 && c < 127 ? c : '?';
    }
    at = r->at;
    f->dimensions = (int)take(r, 2, "a field's number of dimensions");
    if (!r->failed && f->dimensions > 8)
        return fail_at(s, 0, "byte %zu: field %s has %d dimensions, at most 8 are expected", at, f->name,
                       f->dimensions);
    at = r->at;
    f->type = (uint8_t)take(r, 1, "a field's type");
    if (!r->failed && (f->type == 0 || f->type > 11))
        return fail_at(s, 0, "byte %zu: field %s is of type %d, 1 to 11 are known", at, f->name, f->type);
    at = r->at;
    uint64_t offset = take(r, 8, "a field's offset");
    f->count = 1;
    for (int i = 0; i < f->dimensions; ++i) {
        size_t size_at = r->at;
        f->shape[i] = take(r, 8, "a field's size");
        if (r->failed)
            break;
        if (f->shape[i] > 0 && f->count > s->size / f->shape[i])
            return fail_at(s, 0, "byte %zu: field %s has more elements than the file has bytes (%zu)", size_at, f->name,
                           s->size);
        f->count *= f->shape[i];
    }
    if (r->failed)
        return SR_ERROR_INPUT;
    uint64_t bytes = f->count * type_size[f->type];
    if (offset > s->size || bytes > s->size - offset)
        return fail_at(s, 0, "byte %zu: field %s is said to lie at bytes %llu to %llu of a file of %zu", at, f->name,
                       (unsigned long long)offset, (unsigned long long)(offset + bytes), s->size);
    f->data = s->data + offset;
    return SR_OK;
}

const struct tensor_field *tensor_find(const struct tensor_file *t, const char *name)
{
    for (int i = 0; i < t->count; ++i)
        if (strcmp(t->fields[i].name, name) == 0)
            return &t->fields[i];
    return NULL;
}

const struct tensor_field *tensor_need(const struct tensor_file *t, const char *name, enum tensor_type type,
                                       int dimensions)
{
    const struct tensor_field *f = tensor_find(t, name);
    if (!f)
        fail_at(t->source, 0, "has no field \"%s\", which is expected in such a tensor file", name);
    else if (f->type != type || (dimensions && f->dimensions != dimensions)) {
        fail_at(t->source, 0, "field %s is of %s in %d dimensions, %s in %d is expected", name, type_name[f->type],
                f->dimensions, type_name[type], dimensions);
        f = NULL;
    }
    return f;
}

float *tensor_floats(const struct tensor_file *t, const struct tensor_field *f, float least)
{
    float *values = sr_arena_alloc(t->source->arena, f->count * sizeof(float) + sizeof(float));
    if (!values) {
        sr_fail(t->source->error, SR_ERROR_RESOURCE, "%s: not enough memory for field %s", t->source->name, f->name);
        return NULL;
    }
    memcpy(values, f->data, f->count * sizeof(float));
    for (uint64_t i = 0; i < f->count; ++i)
        if (!(values[i] >= least && values[i] < 1e15f)) {
            fail_at(t->source, 0, "byte %llu: field %s has a value of %g, a finite one of at least %g is expected",
                    (unsigned long long)((size_t)(f->data - t->source->data) + i * sizeof(float)), f->name,
                    (double)values[i], (double)least);
            return NULL;
        }
    return values;
}

sr_status read_tensor_file(const struct source *s, struct sr_measured *m)
{
    static const char magic[12] = "tensor_file";
    if (s->size < sizeof magic || memcmp(s->data, magic, sizeof magic) != 0)
        return fail_at(s, 0, "ends at byte %zu, in the header: \"tensor_file\" and a zero byte are expected", s->size);
    struct reader r = {.source = s, .at = sizeof magic};
    uint64_t version = take(&r, 2, "the version");
    uint64_t count = take(&r, 4, "the number of fields");
    if (r.failed)
        return SR_ERROR_INPUT;
    if (version != 1)
        return fail_at(s, 0, "byte 12: version %d.%d, 1.0 is expected", (int)(version & 255), (int)(version >> 8));
    struct tensor_file *t = sr_alloc(sizeof *t);
    if (!t)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    t->source = s;
    sr_status status = SR_OK;
    if (count == 0 || count > sizeof t->fields / sizeof t->fields[0])
        status = fail_at(s, 0, "byte 14: %llu fields, 1 to 64 are expected", (unsigned long long)count);
    for (; status == SR_OK && t->count < (int)count; ++t->count)
        status = read_field(&r, &t->fields[t->count]);
    if (status == SR_OK)
        status = tensor_find(t, "M") ? read_polarised(t, m) : read_rgl(t, m);
    sr_free(t);
    return status;
}
