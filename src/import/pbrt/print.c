/* SPDX-License-Identifier: MIT */
/* Numbers in as few digits as keep them, parameters on one line or on one line each. */
#include "import/pbrt/print.h"

#include "import/number.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 110 }; // columns

void sr_print_bytes(struct sr_print *out, const char *bytes, size_t count)
{
    if (out->has_failed)
        return;
    if (out->size + count + 1 > out->capacity) {
        size_t capacity = 2 * out->capacity + count + 4096;
        char *grown = sr_realloc(out->text, out->capacity, capacity);
        if (!grown) {
            out->has_failed = true;
            return;
        }
        out->text = grown;
        out->capacity = capacity;
    }
    memcpy(out->text + out->size, bytes, count);
    out->size += count;
    out->text[out->size] = 0;
}

void sr_print_word(struct sr_print *out, const char *word)
{
    sr_print_bytes(out, word, strlen(word));
}

void sr_print_line(struct sr_print *out, int more_depth)
{
    for (int i = 0; i < out->depth; ++i)
        sr_print_word(out, "    ");
    if (out->prefix)
        sr_print_word(out, out->prefix);
    for (int i = 0; i < more_depth; ++i)
        sr_print_word(out, "    ");
}

void sr_print_quoted(struct sr_print *out, const char *text)
{
    static const char plain[] = "\b\f\n\r\t\\\"", letters[] = "bfnrt\\\"";
    sr_print_word(out, "\"");
    while (*text) {
        size_t n = strcspn(text, plain);
        sr_print_bytes(out, text, n);
        text += n;
        if (*text) {
            char escape[2] = {'\\', letters[strchr(plain, *text) - plain]};
            sr_print_bytes(out, escape, 2);
            ++text;
        }
    }
    sr_print_word(out, "\"");
}

/* ---- numbers ---- */

/* 1e+06 and 1e-07 as 1e6 and 1e-7 */
static void shorten_exponent(char *text)
{
    char *e = strchr(text, 'e'), *to = e + 1, *from = e + 1;
    if (!e)
        return;
    if (*from == '-')
        *to++ = '-';
    from += *from == '-' || *from == '+';
    while (*from == '0' && from[1])
        ++from;
    memmove(to, from, strlen(from) + 1);
}

static bool reads_back_float(const char *text, float value)
{
    double ours;
    return sr_number_read(text, &ours) && (float)ours == value && strtof(text, NULL) == value;
}

static bool reads_back_double(const char *text, double value)
{
    double ours;
    return sr_number_read(text, &ours) && ours == value && strtod(text, NULL) == value;
}

static void write_float(char text[40], float value)
{
    for (int digits = 6; digits <= 12; ++digits) { // %g drops zeros at the end, so six digits are also one
        snprintf(text, 40, "%.*g", digits, (double)value);
        shorten_exponent(text);
        if (reads_back_float(text, value))
            break;
    }
}

void sr_print_float(struct sr_print *out, float value)
{
    char text[40];
    write_float(text, value);
    sr_print_word(out, text);
}

double sr_print_few_digits(float value)
{
    char text[40];
    write_float(text, value);
    return strtod(text, NULL);
}

void sr_print_double(struct sr_print *out, double value)
{
    char text[40];
    for (int digits = 6; digits <= 18; digits = digits == 6 ? 15 : digits + 1) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        shorten_exponent(text);
        if (reads_back_double(text, value))
            break;
    }
    sr_print_word(out, text);
}

/* ---- parameters ---- */

static uint32_t tuple_of(const struct sr_pbrt_param *p)
{
    switch (p->type) {
    case SR_PBRT_POINT2:
    case SR_PBRT_VECTOR2:
    case SR_PBRT_SPECTRUM:
        return p->is_text ? 1 : 2;
    case SR_PBRT_POINT3:
    case SR_PBRT_VECTOR3:
    case SR_PBRT_NORMAL:
    case SR_PBRT_RGB:
        return 3;
    default:
        return 1;
    }
}

static void print_value(struct sr_print *out, const struct sr_pbrt_param *p, uint32_t i)
{
    char text[16];
    if (p->strings)
        sr_print_quoted(out, p->strings[i]);
    else if (p->floats)
        sr_print_float(out, p->floats[i]);
    else if (p->type == SR_PBRT_BOOL)
        sr_print_word(out, p->ints[i] ? "true" : "false");
    else {
        snprintf(text, sizeof text, "%d", (int)p->ints[i]);
        sr_print_word(out, text);
    }
}

/* column: where the line began; 0 width: never a new line */
static void print_param(struct sr_print *out, const struct sr_pbrt_param *p, bool may_wrap)
{
    size_t line = out->size - 4; // where the name's line began, more or less
    uint32_t tuple = tuple_of(p);
    sr_print_word(out, "\"");
    sr_print_word(out, sr_pbrt_type_name(p->type));
    sr_print_word(out, " ");
    sr_print_word(out, p->name);
    sr_print_word(out, "\" ");
    if (p->count == 1) {
        print_value(out, p, 0);
        return;
    }
    sr_print_word(out, "[");
    for (uint32_t i = 0; i < p->count && !out->has_failed; ++i) {
        if (may_wrap && i % tuple == 0 && out->size - line > WIDTH - 16) {
            sr_print_word(out, "\n");
            line = out->size;
            sr_print_line(out, 2);
        } else
            sr_print_word(out, i > 0 && tuple > 1 && i % tuple == 0 ? "  " : " ");
        print_value(out, p, i);
    }
    sr_print_word(out, " ]");
}

void sr_print_params(struct sr_print *out, const struct sr_pbrt_params *params)
{
    size_t line = out->size, start = out->size, values = 0;
    while (line > 0 && out->text[line - 1] != '\n')
        --line;
    for (uint32_t i = 0; i < params->count; ++i)
        values += params->items[i].count;
    if (values <= WIDTH / 2) { // else it does not fit anyway
        for (uint32_t i = 0; i < params->count; ++i) {
            sr_print_word(out, " ");
            print_param(out, &params->items[i], false);
        }
        if (out->size - line <= WIDTH) {
            sr_print_word(out, "\n");
            return;
        }
        out->size = start;
    }
    for (uint32_t i = 0; i < params->count; ++i) {
        sr_print_word(out, "\n");
        sr_print_line(out, 1);
        print_param(out, &params->items[i], true);
    }
    sr_print_word(out, "\n");
}

/* ---- meshes ---- */

bool sr_print_is_mesh(const char *model, const struct sr_pbrt_params *params, uint32_t more_than,
                      struct sr_print_mesh *mesh)
{
    const struct sr_pbrt_param *P = sr_pbrt_peek(params, "P"), *N = sr_pbrt_peek(params, "N"),
                               *uv = sr_pbrt_peek(params, "uv"), *indices = sr_pbrt_peek(params, "indices"),
                               *faces = sr_pbrt_peek(params, "faceIndices");
    if (strcmp(model, "trianglemesh") != 0 || !P || !P->floats || !indices || !indices->ints ||
        sr_pbrt_peek(params, "S"))
        return false;
    *mesh = (struct sr_print_mesh){
        .P = P->floats, .indices = indices->ints, .vertex_count = P->count / 3, .triangle_count = indices->count / 3};
    if (mesh->vertex_count <= more_than || P->count % 3 || indices->count % 3 ||
        (N && (!N->floats || N->count != P->count)) || (uv && (!uv->floats || uv->count != 2 * mesh->vertex_count)) ||
        (faces && (!faces->ints || faces->count != mesh->triangle_count)))
        return false;
    mesh->N = N ? N->floats : NULL;
    mesh->uv = uv ? uv->floats : NULL;
    mesh->faces = faces ? faces->ints : NULL;
    return true;
}

static void put(struct sr_print *out, const void *data, uint32_t words)
{
    const unsigned char *p = data;
    for (uint32_t i = 0; i < words; ++i, p += 4) { // little-endian, whatever the machine is
        uint32_t v;
        memcpy(&v, p, 4);
        char bytes[4] = {(char)(v & 255), (char)(v >> 8 & 255), (char)(v >> 16 & 255), (char)(v >> 24)};
        sr_print_bytes(out, bytes, 4);
    }
}

static sr_status write_ply(const char *path, const struct sr_print_mesh *mesh, struct sr_error *error)
{
    struct sr_print out = {0};
    char head[512];
    snprintf(
        head, sizeof head,
        "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\nproperty float z\n%s%selement face %u\n"
        "property list uchar int vertex_indices\n%send_header\n",
        (unsigned)mesh->vertex_count, mesh->N ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
        mesh->uv ? "property float u\nproperty float v\n" : "", (unsigned)mesh->triangle_count,
        mesh->faces ? "property int face_indices\n" : "");
    sr_print_word(&out, head);
    for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
        put(&out, &mesh->P[3 * i], 3);
        if (mesh->N)
            put(&out, &mesh->N[3 * i], 3);
        if (mesh->uv)
            put(&out, &mesh->uv[2 * i], 2);
    }
    for (uint32_t i = 0; i < mesh->triangle_count; ++i) {
        sr_print_bytes(&out, "\3", 1);
        put(&out, &mesh->indices[3 * i], 3);
        if (mesh->faces)
            put(&out, &mesh->faces[i], 1);
    }
    sr_status status = out.has_failed ? sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", path)
                                      : sr_file_write(path, out.text, out.size, error);
    sr_free(out.text);
    return status;
}

sr_status sr_print_mesh_apart(struct sr_pbrt_description *d, const char *path, const struct sr_print_mesh *mesh,
                              const char **model, struct sr_pbrt_params *params, struct sr_error *error)
{
    static const char *const gone[] = {"P", "N", "uv", "indices", "faceIndices"};
    struct sr_pbrt_param *items = sr_pbrt_words(d, (params->count + 1) * sizeof *items);
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, **text = sr_pbrt_words(d, sizeof *text);
    if (!items || !text || !(*text = sr_pbrt_text(d, name, strlen(name))))
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", path);
    items[0] = (struct sr_pbrt_param){.type = SR_PBRT_STRING_TYPE, .name = "filename", .count = 1, .strings = text};
    uint32_t count = 1;
    for (uint32_t i = 0; i < params->count; ++i) {
        bool is_gone = false;
        for (size_t k = 0; k < sizeof gone / sizeof *gone; ++k)
            is_gone = is_gone || strcmp(params->items[i].name, gone[k]) == 0;
        if (!is_gone)
            items[count++] = params->items[i];
    }
    *params = (struct sr_pbrt_params){items, count};
    *model = "plymesh";
    return write_ply(path, mesh, error);
}
