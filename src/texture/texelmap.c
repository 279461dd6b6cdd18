/* SPDX-License-Identifier: MIT */
/* One channel of an image, or its colour, over any coordinates of the surface.
 *
 *     (s, t) = (a u + b v + c, d u + e v + f),   transform = (a b c d e f)
 *     number: offset + scale texel,   colour: factor RGB, component by component, made a spectrum
 *
 * (u, v) are the surface's, or, where the mesh gives a pair for each corner of each triangle, those (corners.h). t
 * counts upward and rows of texels downward, as in imagemap; the two directions wrap each in its own way, and "mirror"
 * turns every other repetition around. Interpolated between texel centres; colours as their curves (pyramid.c).
 * glTF 2.0, Khronos Group 2021, 3.8; KHR_texture_transform. Limits: no levels of detail. */
#include "texture/corners.h"
#include "texture/private.h"
#include "texture/pyramid.h"

enum { FILTER_BILINEAR, FILTER_POINT };
enum { WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR };
enum { CHANNEL_MEAN = 4 };

struct texelmap {
    const char *filename, *encoding;
    int32_t filter, swrap, twrap, channel;
    float scale, offset;       // [1] of numbers
    struct sr_slice factor;    // of colours
    struct sr_slice transform; // six numbers, or none
    struct sr_slice uv;        // sr_vec2, three a triangle, or none
    struct sr_texels texels;
    float m[6];           // derived: the transform
    const uint8_t *bytes; // derived, of numbers: one channel; or
    const float *floats;
    const float *decode;
    struct sr_pyramid pyramid; // derived, of colours: its first level
    struct sr_spd white;       // for emission: the spectrum of RGB (1,1,1); else kind NONE
};

#define OFFSET(member) offsetof(struct texelmap, member)
#define COMMON_ROWS                                                                                                    \
    {SR_PARAM_FILE, "filename", "1", 0, 0, NAN, OFFSET(filename), "the image"},                                        \
        {SR_PARAM_STRING, "encoding", "1", 0, 0, 0, OFFSET(encoding), "sRGB"},                                         \
        {SR_PARAM_ENUM, "filter", "1", 0, 1, 0, OFFSET(filter), "bilinear|point"},                                     \
        {SR_PARAM_ENUM, "swrap", "1", 0, 2, 0, OFFSET(swrap), "repeat|clamp|mirror"},                                  \
        {SR_PARAM_ENUM, "twrap", "1", 0, 2, 0, OFFSET(twrap), "repeat|clamp|mirror"},                                  \
        {SR_PARAM_FLOATS, "transform", "1", -INFINITY, INFINITY, NAN, OFFSET(transform), "a b c d e f; identity"},     \
    {                                                                                                                  \
        SR_PARAM_POINT2S, "uv", "1", -INFINITY, INFINITY, NAN, OFFSET(uv), "coordinates of each triangle's corners"    \
    }
static const struct sr_param params_float[] = {
    COMMON_ROWS,
    {SR_PARAM_ENUM, "channel", "1", 0, 4, 4, OFFSET(channel), "r|g|b|a|mean"},
    {SR_PARAM_FLOAT, "scale", "1", -INFINITY, INFINITY, 1, OFFSET(scale), "factor of the texels"},
    {SR_PARAM_FLOAT, "offset", "1", -INFINITY, INFINITY, 0, OFFSET(offset), "added to them"},
    {0},
};
static const struct sr_param params_spectrum[] = {
    COMMON_ROWS,
    {SR_PARAM_FLOATS, "factor", "1", 0, INFINITY, NAN, OFFSET(factor), "of red, green and blue; 1 1 1"},
    {0},
};

/* ---- looking up ---- */

// the two texels beside the coordinate x, and what the second counts
static float neighbours(float x, uint32_t n, int32_t wrap, uint32_t index[2])
{
    if (wrap == WRAP_REPEAT) {
        x -= floorf(x);
    } else if (wrap == WRAP_MIRROR) {
        x -= 2 * floorf(x / 2);
        x = x > 1 ? 2 - x : x;
    }
    x = x >= 0 ? sr_min(x, 1) : 0; // NaN: 0
    float texel = x * (float)n - 0.5f, lower = floorf(texel);
    bool over = (uint32_t)(lower + 1) >= n;
    index[0] = lower < 0 ? (wrap == WRAP_REPEAT ? n - 1 : 0) : (uint32_t)lower;
    index[1] = over ? (wrap == WRAP_REPEAT ? 0 : n - 1) : (uint32_t)(lower + 1);
    return texel - lower;
}

static sr_vec2 coordinates(const struct texelmap *m, const struct sr_point *x)
{
    sr_vec2 uv = x->uv;
    if (m->uv.count) {
        float w[3];
        const sr_vec2 *c = (const sr_vec2 *)m->uv.data + corners_at(x, m->uv.count / 3, w);
        uv = (sr_vec2){w[0] * c[0].x + w[1] * c[1].x + w[2] * c[2].x, w[0] * c[0].y + w[1] * c[1].y + w[2] * c[2].y};
    }
    return (sr_vec2){m->m[0] * uv.x + m->m[1] * uv.y + m->m[2], m->m[3] * uv.x + m->m[4] * uv.y + m->m[5]};
}

struct taps {
    size_t index[4];
    float weight[4];
};
static struct taps find_taps(const struct texelmap *m, const struct sr_point *x)
{
    sr_vec2 st = coordinates(m, x);
    uint32_t i[2], j[2];
    float fx = neighbours(st.x, m->texels.width, m->swrap, i), fy = neighbours(1 - st.y, m->texels.height, m->twrap, j);
    if (m->filter == FILTER_POINT) {
        fx = fx >= 0.5f;
        fy = fy >= 0.5f;
    }
    size_t above = (size_t)j[0] * m->texels.width, below = (size_t)j[1] * m->texels.width;
    return (struct taps){{above + i[0], above + i[1], below + i[0], below + i[1]},
                         {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct texelmap *m = self;
    struct taps taps = find_taps(m, x);
    float sum = 0;
    for (int k = 0; k < 4; ++k)
        sum += taps.weight[k] * (m->bytes ? m->decode[m->bytes[taps.index[k]]] : m->floats[taps.index[k]]);
    return m->offset + m->scale * sum;
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct texelmap *m = self;
    struct taps taps = find_taps(m, x);
    const struct sr_packed_texel *texel[4], *texels = m->pyramid.levels[0].spectra;
    int count = 0;
    for (int k = 0; k < 4; ++k)
        if (taps.weight[k] > 0) {
            taps.weight[count] = taps.weight[k];
            texel[count++] = &texels[taps.index[k]];
        }
    bool is_emission = m->white.kind != SR_SPD_NONE;
    sr_spectrum s = sr_packed_texels_sum(texel, taps.weight, count, true, w->lambda);
    return is_emission ? s * sr_spd_eval(&m->white, w->lambda) : s;
}

/* ---- making ---- */

static sr_status check(struct texelmap *m, struct sr_error *error)
{
    static const float identity[6] = {1, 0, 0, 0, 1, 0};
    const float *t = m->transform.count ? m->transform.data : identity;
    if (m->transform.count != 0 && m->transform.count != 6)
        return sr_fail(error, SR_ERROR_INPUT, "\"transform\" has %u numbers: expected 6", m->transform.count);
    for (int i = 0; i < 6; ++i) {
        m->m[i] = t[i];
        if (!isfinite(t[i]))
            return sr_fail(error, SR_ERROR_INPUT, "\"transform\" must be finite numbers");
    }
    if (m->uv.count % 3)
        return sr_fail(error, SR_ERROR_INPUT, "\"uv\" has %u pairs: expected three for each triangle", m->uv.count);
    return m->texels.width && m->texels.height ? SR_OK : sr_fail(error, SR_ERROR_INPUT, "the image has no texels");
}

static float texel_of(const struct sr_texels *t, size_t pixel, uint32_t channel)
{
    size_t i = pixel * t->channels + channel;
    return t->floats                    ? t->floats[i]
           : channel == 3 || !t->decode ? (float)t->bytes[i] * (1 / 255.0f)
                                        : t->decode[t->bytes[i]];
}

// one channel by itself; grey images are the same in r, g and b, and what has no alpha is opaque
static sr_status prepare_float(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    (void)use;
    struct texelmap *m = self;
    const struct sr_texels *t = &m->texels;
    if (check(m, error))
        return error->status;
    size_t count = (size_t)t->width * t->height;
    uint32_t channel = m->channel == 3 ? 3 : t->channels < 3 ? 0 : (uint32_t)m->channel;
    bool is_mean = t->channels >= 3 && m->channel == CHANNEL_MEAN, is_bytes = t->bytes && !is_mean;
    void *plane = sr_arena_alloc(arena, count * (is_bytes ? 1 : sizeof(float)));
    float *linear = sr_arena_alloc(arena, 256 * sizeof(float));
    if (!plane || !linear)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %u x %u texels", t->width, t->height);
    for (size_t p = 0; p < count; ++p) {
        bool is_absent = channel >= t->channels;
        if (is_bytes)
            ((uint8_t *)plane)[p] = is_absent ? 255 : t->bytes[p * t->channels + channel];
        else if (is_mean)
            ((float *)plane)[p] = (texel_of(t, p, 0) + texel_of(t, p, 1) + texel_of(t, p, 2)) * (1 / 3.0f);
        else
            ((float *)plane)[p] = is_absent ? 1 : t->floats[p * t->channels + channel];
    }
    for (int i = 0; i < 256; ++i)
        linear[i] = t->decode && channel != 3 ? t->decode[i] : (float)i * (1 / 255.0f);
    m->bytes = is_bytes ? plane : NULL;
    m->floats = is_bytes ? NULL : plane;
    m->decode = linear;
    return SR_OK;
}

// the texels times a factor for each component, linear
static sr_status tinted(const struct texelmap *m, const float factor[3], float **out, struct sr_error *error)
{
    const struct sr_texels *t = &m->texels;
    size_t count = (size_t)t->width * t->height;
    *out = sr_alloc(3 * count * sizeof(float));
    for (size_t p = 0; *out && p < count; ++p)
        for (uint32_t k = 0; k < 3; ++k)
            (*out)[3 * p + k] = factor[k] * texel_of(t, p, t->channels < 3 ? 0 : k);
    return *out ? SR_OK
                : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %u x %u texels", t->width, t->height);
}

static sr_status prepare_spectrum(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    struct texelmap *m = self;
    static const float ones[3] = {1, 1, 1};
    const float *factor = m->factor.count ? m->factor.data : ones;
    if (check(m, error))
        return error->status;
    if (m->factor.count != 0 && m->factor.count != 3)
        return sr_fail(error, SR_ERROR_INPUT, "\"factor\" has %u numbers: expected 3", m->factor.count);
    if (use.rgb_use == SR_PARAM_ILLUMINANT)
        m->white = sr_spd_from_rgb_illuminant(m->texels.space, (struct sr_rgb){1, 1, 1});
    struct sr_texels texels = m->texels;
    struct sr_pyramid_adjust adjust = {factor[0], false};
    float *own = NULL;
    if (factor[0] != factor[1] || factor[0] != factor[2]) {
        if (tinted(m, factor, &own, error))
            return error->status;
        texels.bytes = NULL;
        texels.floats = own;
        texels.channels = 3;
        adjust.scale = 1;
    }
    sr_status status = sr_pyramid_build(&m->pyramid, &texels, false, adjust, use, arena, error);
    sr_free(own);
    return status;
}

const struct sr_texture_model sr_texture_texelmap_float = {
    .name = "texelmap",
    .params = params_float,
    .size = sizeof(struct texelmap),
    .is_float = true,
    .texels_offset = OFFSET(texels),
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_float,
    .eval_float = eval_float,
};
const struct sr_texture_model sr_texture_texelmap_spectrum = {
    .name = "texelmap",
    .params = params_spectrum,
    .size = sizeof(struct texelmap),
    .is_spectrum = true,
    .texels_offset = OFFSET(texels),
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_spectrum,
    .eval_spectrum = eval_spectrum,
};
