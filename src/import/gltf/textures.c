/* SPDX-License-Identifier: MIT */
/* Images, samplers and where on the surface they lie.
 *
 * The file counts v downward from the top row, pbrt upward; meshes get (u, 1 - v), after emission's own transform U if
 * there is one. With T the transform of a texture (KHR_texture_transform: scale, then rotation, then offset) a map is
 * read at
 *
 *     F T U^-1 F (u, v),   F (u, v) = (u, 1 - v)
 *
 * glTF 2.0, 3.8. */
#include "import/gltf/gltf.h"

#include <stdio.h>
#include <string.h>

/* ---- affine maps: (u, v) -> (m0 u + m1 v + m2, m3 u + m4 v + m5) ---- */

static void chain(const double a[6], const double b[6], double out[6]) // a after b
{
    double r[6] = {a[0] * b[0] + a[1] * b[3], a[0] * b[1] + a[1] * b[4], a[0] * b[2] + a[1] * b[5] + a[2],
                   a[3] * b[0] + a[4] * b[3], a[3] * b[1] + a[4] * b[4], a[3] * b[2] + a[4] * b[5] + a[5]};
    memcpy(out, r, sizeof r);
}

static void invert(const double m[6], double out[6])
{
    double det = m[0] * m[4] - m[1] * m[3], r[6] = {m[4] / det, -m[1] / det, 0, -m[3] / det, m[0] / det, 0};
    r[2] = -(r[0] * m[2] + r[1] * m[5]);
    r[5] = -(r[3] * m[2] + r[4] * m[5]);
    memcpy(out, r, sizeof r);
}

bool sr_gltf_is_identity(const double m[6])
{
    return m[0] == 1 && m[1] == 0 && m[2] == 0 && m[3] == 0 && m[4] == 1 && m[5] == 0;
}

/* ---- images ---- */

/* The name under which an image is read: a file's, or that of bytes in memory, "model.glb#image3.png". */
const char *sr_gltf_image(struct sr_gltf *g, uint32_t image)
{
    if (g->images[image])
        return g->images[image];
    struct sr_gltf_at at = sr_gltf_entry(g, "images", image);
    const char *uri = sr_gltf_string(g, &at, "uri"), *slash = strrchr(g->c.path, '/');
    struct sr_gltf_buffer bytes = {NULL, 0};
    size_t unused;
    if (uri && !sr_gltf_is_data_uri(uri)) {
        char *name = strstr(uri, "://") ? NULL : sr_gltf_unescape(&g->scratch, uri);
        if (!name)
            sr_gltf_fail(g, &at, "\"%.200s\": expected the name of a file beside this one", uri);
        return g->images[image] = name ? sr_compose_word(&g->c, name) : "";
    }
    if (uri)
        sr_gltf_fetch(g, &at, uri, &bytes);
    else
        bytes = sr_gltf_view(g, &at, "bufferView", &unused);
    if (sr_gltf_is_well(g) && !bytes.data)
        sr_gltf_fail(g, &at, "expected a \"uri\" or a \"bufferView\"");
    if (!sr_gltf_is_well(g))
        return "";
    bool is_png = bytes.size > 4 && memcmp(bytes.data, "\x89PNG", 4) == 0;
    const char *name =
        sr_compose_printf(&g->c, "%s#image%u.%s", slash ? slash + 1 : g->c.path, image, is_png ? "png" : "jpg");
    uint8_t *copy = sr_gltf_array_for(g, &at, &g->c.d->words, bytes.size, 1);
    if (copy) {
        memcpy(copy, bytes.data, bytes.size);
        sr_compose_file(&g->c, name, copy, bytes.size);
    }
    return g->images[image] = name;
}

/* ---- textures ---- */

static const char *wrap(struct sr_gltf *g, const struct sr_gltf_at *sampler, const char *key)
{
    uint64_t code = sr_gltf_size(g, sampler, key, 10497, 1 << 16);
    if (sr_gltf_is_well(g) && code != 10497 && code != 33071 && code != 33648)
        sr_gltf_fail(g, sampler, "%s %u: expected 10497, 33071 or 33648", key, (unsigned)code);
    return code == 33071 ? "clamp" : code == 33648 ? "mirror" : "repeat";
}

struct sr_gltf_texture sr_gltf_texture(struct sr_gltf *g, const struct sr_gltf_at *material, const char *key)
{
    struct sr_gltf_texture t = {.info = sr_gltf_object(g, material, key),
                                .transform = {1, 0, 0, 0, 1, 0},
                                .swrap = "repeat",
                                .twrap = "repeat",
                                .filter = "bilinear"};
    if (!t.info.json)
        return t;
    uint32_t texture1 = sr_gltf_index1(g, &t.info, "index", sr_gltf_root_count(g, "textures"));
    t.set = (uint32_t)sr_gltf_size(g, &t.info, "texCoord", 0, SR_GLTF_UV_SETS - 1);
    struct sr_gltf_at moved = sr_gltf_extension(g, &t.info, "KHR_texture_transform");
    if (moved.json) {
        double offset[2] = {0, 0}, scale[2] = {1, 1}, angle = sr_gltf_number(g, &moved, "rotation", 0, -1e6, 1e6);
        sr_gltf_numbers(g, &moved, "offset", 2, offset);
        sr_gltf_numbers(g, &moved, "scale", 2, scale);
        t.set = (uint32_t)sr_gltf_size(g, &moved, "texCoord", t.set, SR_GLTF_UV_SETS - 1);
        double c = cos(angle), s = sin(angle),
               m[6] = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
        memcpy(t.transform, m, sizeof m);
    }
    if (sr_gltf_is_well(g) && !texture1)
        sr_gltf_fail(g, &t.info, "expected the \"index\" of a texture");
    if (!sr_gltf_is_well(g))
        return t;
    struct sr_gltf_at texture = sr_gltf_entry(g, "textures", texture1 - 1);
    t.image1 = sr_gltf_index1(g, &texture, "source", sr_gltf_root_count(g, "images"));
    uint32_t sampler1 = sr_gltf_index1(g, &texture, "sampler", sr_gltf_root_count(g, "samplers"));
    if (sampler1) {
        struct sr_gltf_at sampler = sr_gltf_entry(g, "samplers", sampler1 - 1);
        t.swrap = wrap(g, &sampler, "wrapS");
        t.twrap = wrap(g, &sampler, "wrapT");
        t.filter = sr_gltf_size(g, &sampler, "magFilter", 9729, 1 << 16) == 9728 ? "point" : "bilinear";
    }
    if (sr_gltf_is_well(g) && !t.image1) {
        sr_gltf_warn(g, &texture, "has no image in a format that is supported and is left out");
        t.info.json = NULL;
    }
    return t;
}

bool sr_gltf_is_new(struct sr_gltf *g, const char *name)
{
    if (sr_pbrt_names_find(&g->made, name))
        return false;
    if (!sr_pbrt_names_add(&g->made, sr_compose_word(&g->c, name), 1))
        sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
    return true;
}

/* Numbers of a parameter: six at most. */
static void add_numbers(struct sr_gltf *g, const char *name, const double *values, size_t count)
{
    float *f = sr_pbrt_words(g->c.d, count * sizeof *f);
    for (size_t i = 0; i < count && f; ++i)
        f[i] = (float)values[i];
    if (f)
        sr_compose_floats(&g->c, SR_PBRT_FLOAT, name, f, count);
    else
        sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
}

const char *sr_gltf_texelmap(struct sr_gltf *g, const struct sr_gltf_surface *s, const struct sr_gltf_texture *t,
                             const char *what, const char *channel, const double factor[3], double offset, bool is_srgb)
{
    static const double flip[6] = {1, 0, 0, 0, -1, 1};
    const char *name = sr_compose_printf(&g->c, "%s.%s", s->name, what), *image = sr_gltf_image(g, t->image1 - 1);
    if (!sr_gltf_is_well(g) || !sr_gltf_is_new(g, name))
        return name;
    double m[6];
    if (s->is_split) {
        chain(flip, t->transform, m);
        sr_compose_floats(&g->c, SR_PBRT_POINT2, "uv", (const float *)s->corner_uv[t->set],
                          2 * (size_t)s->corner_count);
    } else {
        invert(s->uv_transform, m);
        chain(m, flip, m);
        chain(t->transform, m, m);
        chain(flip, m, m);
    }
    sr_compose_string(&g->c, "filename", image);
    if (!is_srgb)
        sr_compose_string(&g->c, "encoding", "linear");
    if (!sr_gltf_is_identity(m))
        add_numbers(g, "transform", m, 6);
    if (strcmp(t->swrap, "repeat") != 0)
        sr_compose_string(&g->c, "swrap", t->swrap);
    if (strcmp(t->twrap, "repeat") != 0)
        sr_compose_string(&g->c, "twrap", t->twrap);
    if (strcmp(t->filter, "point") == 0)
        sr_compose_string(&g->c, "filter", t->filter);
    if (channel) {
        sr_compose_string(&g->c, "channel", channel);
        if (factor[0] != 1)
            sr_compose_float(&g->c, "scale", (float)factor[0]);
        if (offset != 0)
            sr_compose_float(&g->c, "offset", (float)offset);
    } else if (factor[0] != 1 || factor[1] != 1 || factor[2] != 1)
        add_numbers(g, "factor", factor, 3);
    sr_compose_texture(&g->c, name, channel != NULL, "texelmap");
    return name;
}
