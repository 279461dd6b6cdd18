/* SPDX-License-Identifier: MIT */
/* An image over the surface.
 *
 * (s, t) of the mapping; t counts upward and rows of texels downward, so the image is read at (s, 1 - t). Texel (i, j)
 * of a level has its centre at ((i + 1/2) / width, (j + 1/2) / height).
 *
 *     level = levels - 1 + log2(width of the footprint),   width = 2 max(|dsdx|, |dsdy|, |dtdx|, |dtdy|)
 *
 * point and bilinear read the level rounded down, trilinear mixes it with the next (below level 1 it reads the image
 * itself), as pbrt does (Pharr, Jakob & Humphreys 2023, 10.4). "ewa" is the elliptical weighted average: texels under
 * the ellipse that a pixel's disk becomes, weighed by a Gaussian of the distance from its middle, on the two levels
 * around the one where the minor axis is one texel long (Heckbert 1989; Greene & Heckbert 1986):
 *
 *     weight = exp(-2 r^2) - exp(-2),   r^2 = A x^2 + B x y + C y^2 < 1,   level = levels - 1 + log2(minor axis)
 *
 * Over an image that repeats, each filter keeps the mean of the texels.
 *
 * Spectrum textures interpolate the texels' curves (see pyramid.c); the wrap "octahedralsphere" is that of equal-area
 * environment maps, where leaving the square over an edge means to enter it over the same edge, mirrored in the middle.
 */
#include "texture/private.h"
#include "texture/pyramid.h"

enum { FILTER_BILINEAR, FILTER_POINT, FILTER_TRILINEAR, FILTER_EWA };
enum { WRAP_REPEAT, WRAP_CLAMP, WRAP_BLACK, WRAP_OCTAHEDRAL };

struct imagemap {
    const char *filename;
    const char *encoding; // the importer makes texels.decode of it
    int32_t filter;
    int32_t wrap;
    float max_anisotropy; // [1]
    float scale;          // [1]
    bool invert;
    struct sr_mapping mapping;
    struct sr_texels texels;
    struct sr_pyramid pyramid;
    enum sr_param_kind rgb_use;
    struct sr_spd white; // for emission: the spectrum of RGB (1,1,1) in the texels' space; else kind NONE
};

#define OFFSET(member) offsetof(struct imagemap, member)
static const struct sr_param params[] = {
    {SR_PARAM_FILE, "filename", "1", 0, 0, NAN, OFFSET(filename), "the image"},
    {SR_PARAM_STRING, "encoding", "1", 0, 0, 0, OFFSET(encoding), "sRGB"},
    {SR_PARAM_ENUM, "filter", "1", 0, 3, 0, OFFSET(filter), "bilinear|point|trilinear|ewa"},
    {SR_PARAM_ENUM, "wrap", "1", 0, 3, 0, OFFSET(wrap), "repeat|clamp|black|octahedralsphere"},
    {SR_PARAM_FLOAT, "maxanisotropy", "1", 1, INFINITY, 8, OFFSET(max_anisotropy),
     "ewa: greatest ratio of the ellipse's axes"},
    {SR_PARAM_FLOAT, "scale", "1", -INFINITY, INFINITY, 1, OFFSET(scale), "factor of the texels"},
    {SR_PARAM_BOOL, "invert", "1", 0, 1, 0, OFFSET(invert), "1 - value, after scale"},
    {0},
};

// ---- which texels ----

// up to four texels of a level and what they count
struct taps {
    size_t index[4];
    float weight[4];
    int count;
};

static int wrapped(int i, int n, int wrap, bool *outside)
{
    if (SR_LIKELY(i >= 0 && i < n))
        return i;
    if (wrap == WRAP_REPEAT)
        return i % n < 0 ? i % n + n : i % n;
    *outside = true;
    return i < 0 ? 0 : n - 1;
}

// leaving over an edge is coming in over the same edge, at the place mirrored at the edge's middle
static void wrap_octahedral(int *x, int *y, int w, int h)
{
    while (*x < 0 || *x >= w) {
        *x = *x < 0 ? -1 - *x : 2 * w - 1 - *x;
        *y = h - 1 - *y;
    }
    while (*y < 0 || *y >= h) {
        *y = *y < 0 ? -1 - *y : 2 * h - 1 - *y;
        *x = w - 1 - *x;
    }
}

// false: outside, where there is nothing
static bool wrap(const struct sr_pyramid_level *l, int how, int x, int y, size_t *index)
{
    int w = (int)l->width, h = (int)l->height;
    bool outside = false;
    if (how == WRAP_OCTAHEDRAL) {
        wrap_octahedral(&x, &y, w, h);
    } else {
        x = wrapped(x, w, how, &outside);
        y = wrapped(y, h, how, &outside);
    }
    *index = (size_t)y * l->width + (size_t)x;
    return !outside || how != WRAP_BLACK;
}

static void add_tap(struct taps *taps, const struct sr_pyramid_level *l, int how, int x, int y, float weight)
{
    if (weight == 0 || !wrap(l, how, x, y, &taps->index[taps->count]))
        return;
    taps->weight[taps->count++] = weight;
}

static struct taps find_taps(const struct sr_pyramid_level *l, int how, bool point, sr_vec2 st)
{
    // into one period, or to where nothing new comes any more: then texel numbers are small (and NaN becomes a number)
    if (how == WRAP_REPEAT) {
        st.x -= floorf(st.x);
        st.y -= floorf(st.y);
        st.x = st.x >= 0 && st.x < 1 ? st.x : 0; // x - floor(x) may round to 1
        st.y = st.y >= 0 && st.y < 1 ? st.y : 0;
    } else {
        st.x = sr_min(sr_max(st.x, -1), 2);
        st.y = sr_min(sr_max(st.y, -1), 2);
    }
    struct taps taps = {.count = 0};
    float x = st.x * (float)l->width, y = st.y * (float)l->height;
    if (point) {
        add_tap(&taps, l, how, (int)floorf(x), (int)floorf(y), 1);
        return taps;
    }
    x -= 0.5f;
    y -= 0.5f;
    float fx = floorf(x), fy = floorf(y);
    int x0 = (int)fx, y0 = (int)fy;
    float dx = x - fx, dy = y - fy;
    add_tap(&taps, l, how, x0, y0, (1 - dx) * (1 - dy));
    add_tap(&taps, l, how, x0 + 1, y0, dx * (1 - dy));
    add_tap(&taps, l, how, x0, y0 + 1, (1 - dx) * dy);
    add_tap(&taps, l, how, x0 + 1, y0 + 1, dx * dy);
    return taps;
}

// ---- looking up: one function for numbers and one for curves, the same otherwise ----

struct lookup {
    const struct imagemap *map;
    const sr_spectrum *lambda; // NULL: a float texture, the answer is the first component
};

static sr_spectrum read_level(const struct lookup *q, uint32_t level, sr_vec2 st)
{
    const struct imagemap *m = q->map;
    const struct sr_pyramid_level *l = &m->pyramid.levels[level];
    struct taps taps = find_taps(l, m->wrap, m->filter == FILTER_POINT, st);
    if (!q->lambda) {
        float sum = 0;
        for (int i = 0; i < taps.count; ++i)
            sum += taps.weight[i] * l->values[taps.index[i]];
        return SR_BLACK + sum;
    }
    const struct sr_packed_texel *texel[4];
    for (int i = 0; i < taps.count; ++i)
        texel[i] = &l->spectra[taps.index[i]];
    return sr_packed_texels_sum(texel, taps.weight, taps.count, m->rgb_use != SR_PARAM_ALBEDO, *q->lambda);
}

static sr_spectrum read_width(const struct lookup *q, sr_vec2 st, float width)
{
    const struct imagemap *m = q->map;
    uint32_t last = m->pyramid.count - 1;
    float cells = width * (float)(1u << last); // level = log2 of it
    if (SR_LIKELY(!(cells >= 2)))              // level 0, or NaN
        if (m->filter < FILTER_TRILINEAR || !(cells > 1))
            return read_level(q, 0, st);
    float level = sr_max(log2f(cells), 0);
    if (level >= (float)last)
        return read_level(q, last, (sr_vec2){0.5f, 0.5f});
    uint32_t below = (uint32_t)level;
    if (m->filter < FILTER_TRILINEAR || below == 0)
        return read_level(q, below, st);
    float share = level - (float)below;
    return (1 - share) * read_level(q, below, st) + share * read_level(q, below + 1, st);
}

// texels under an ellipse, added up in groups
struct gathered {
    const struct lookup *q;
    const struct sr_pyramid_level *level;
    sr_spectrum sum;
    float weights;
    int count;
    float weight[64];
    const struct sr_packed_texel *texel[64];
};

static void add_group(struct gathered *g)
{
    bool has_scale = g->q->map->rgb_use != SR_PARAM_ALBEDO;
    if (g->count)
        g->sum += sr_packed_texels_sum(g->texel, g->weight, g->count, has_scale, *g->q->lambda);
    g->count = 0;
}

static void gather(struct gathered *g, int x, int y, float weight)
{
    size_t index;
    g->weights += weight;
    if (!wrap(g->level, g->q->map->wrap, x, y, &index))
        return;
    if (!g->q->lambda) {
        g->sum += weight * g->level->values[index];
        return;
    }
    g->weight[g->count] = weight;
    g->texel[g->count++] = &g->level->spectra[index];
    if (g->count == (int)(sizeof g->weight / sizeof *g->weight))
        add_group(g);
}

static sr_spectrum read_ellipse_level(const struct lookup *q, uint32_t level, sr_vec2 st, sr_vec2 major, sr_vec2 minor)
{
    const struct sr_pyramid_level *l = &q->map->pyramid.levels[level];
    float w = (float)l->width, h = (float)l->height, x = st.x * w - 0.5f, y = st.y * h - 0.5f;
    sr_vec2 a = {major.x * w, major.y * h}, b = {minor.x * w, minor.y * h};
    // a disk of one texel added, or a thin ellipse would fall between texels
    float A = a.y * a.y + b.y * b.y + 1, B = -2 * (a.x * a.y + b.x * b.y), C = a.x * a.x + b.x * b.x + 1;
    float inverse = 1 / (A * C - B * B / 4);
    float reach = sqrtf(A); // of the ellipse along y
    A *= inverse;
    B *= inverse;
    C *= inverse;
    struct gathered g = {.q = q, .level = l};
    for (int j = (int)ceilf(y - reach); j <= (int)floorf(y + reach); ++j) {
        // where the row enters and leaves: A dx^2 + B dx dy + C dy^2 = 1
        float dy = (float)j - y, middle = -B * dy / (2 * A),
              half = sr_safe_sqrt(middle * middle - (C * dy * dy - 1) / A);
        for (int i = (int)ceilf(x + middle - half); i <= (int)floorf(x + middle + half); ++i) {
            float dx = (float)i - x, r2 = A * dx * dx + B * dx * dy + C * dy * dy;
            if (r2 < 1)
                gather(&g, i, j, expf(-2 * r2) - 0.13533528f);
        }
    }
    add_group(&g);
    return g.weights > 0 ? g.sum / g.weights : read_level(q, level, st);
}

static sr_spectrum read_ellipse(const struct lookup *q, const struct sr_mapped *f, sr_vec2 st)
{
    sr_vec2 major = {f->dsdx, -f->dtdx}, minor = {f->dsdy, -f->dtdy}; // t is flipped
    float length = sqrtf(major.x * major.x + major.y * major.y), other = sqrtf(minor.x * minor.x + minor.y * minor.y);
    if (length < other) {
        sr_vec2 swap = major;
        major = minor;
        minor = swap;
        float longer = other;
        other = length;
        length = longer;
    }
    float least = length / sr_min(q->map->max_anisotropy, 64);
    if (other < least) { // blurs along the minor axis, or the work would have no end
        minor = other > 0 ? (sr_vec2){minor.x * least / other, minor.y * least / other}
                          : (sr_vec2){-major.y * least / length, major.x * least / length};
        other = least;
    }
    if (!(other > 0) || !(length < 1e6f))
        return length > 0 ? read_level(q, q->map->pyramid.count - 1, (sr_vec2){0.5f, 0.5f}) : read_level(q, 0, st);
    uint32_t last = q->map->pyramid.count - 1;
    float level = sr_max(log2f(other) + (float)last, 0);
    if (level >= (float)last)
        return read_level(q, last, (sr_vec2){0.5f, 0.5f});
    // into the first period, where floats are fine
    if (q->map->wrap == WRAP_REPEAT) {
        st.x -= floorf(st.x);
        st.y -= floorf(st.y);
    } else {
        st.x = sr_clamp(st.x, -64, 64);
        st.y = sr_clamp(st.y, -64, 64);
    }
    if (!(fabsf(st.x) <= 64 && fabsf(st.y) <= 64)) // not a number
        st = (sr_vec2){0, 0};
    uint32_t below = (uint32_t)level;
    float share = level - (float)below;
    sr_spectrum fine = read_ellipse_level(q, below, st, major, minor);
    return share > 0 ? (1 - share) * fine + share * read_ellipse_level(q, below + 1, st, major, minor) : fine;
}

static sr_spectrum look_up(const struct lookup *q, const struct sr_point *x)
{
    struct sr_mapped f = sr_mapping_apply(&q->map->mapping, x);
    sr_vec2 st = {f.st.x, 1 - f.st.y};
    if (q->map->filter == FILTER_EWA)
        return read_ellipse(q, &f, st);
    return read_width(q, st, 2 * sr_max(sr_max(fabsf(f.dsdx), fabsf(f.dsdy)), sr_max(fabsf(f.dtdx), fabsf(f.dtdy))));
}

static float eval_float(const void *self, const struct sr_point *x)
{
    return look_up(&(struct lookup){self, NULL}, x)[0];
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct imagemap *m = self;
    sr_spectrum s = look_up(&(struct lookup){m, &w->lambda}, x);
    return m->white.kind == SR_SPD_NONE ? s : s * sr_spd_eval(&m->white, w->lambda);
}

static sr_status prepare_for(struct imagemap *m, bool is_float, struct sr_texture_use use, struct sr_arena *arena,
                             struct sr_error *error)
{
    m->rgb_use = use.rgb_use;
    m->max_anisotropy = sr_max(m->max_anisotropy, 1);
    if (!is_float && use.rgb_use == SR_PARAM_ILLUMINANT)
        m->white = sr_spd_from_rgb_illuminant(m->texels.space, (struct sr_rgb){1, 1, 1});
    sr_status status = sr_mapping_prepare(&m->mapping, error);
    if (status == SR_OK && m->pyramid.count == 0)
        status = sr_pyramid_build(&m->pyramid, &m->texels, is_float, (struct sr_pyramid_adjust){m->scale, m->invert},
                                  use, arena, error);
    return status;
}

static void share(void *self, const void *other)
{
    struct imagemap *m = self;
    const struct imagemap *o = other;
    if (m->scale == o->scale && m->invert == o->invert && m->texels.bytes == o->texels.bytes &&
        m->texels.floats == o->texels.floats)
        m->pyramid = o->pyramid;
}

static sr_status prepare_float(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    return prepare_for(self, true, use, arena, error);
}

static sr_status prepare_spectrum(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    return prepare_for(self, false, use, arena, error);
}

const struct sr_texture_model sr_texture_imagemap_float = {
    .name = "imagemap",
    .params = params,
    .size = sizeof(struct imagemap),
    .is_float = true,
    .texels_offset = OFFSET(texels),
    .mapping_offset = OFFSET(mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_float,
    .share = share,
    .eval_float = eval_float,
};
const struct sr_texture_model sr_texture_imagemap_spectrum = {
    .name = "imagemap",
    .params = params,
    .size = sizeof(struct imagemap),
    .is_spectrum = true,
    .texels_offset = OFFSET(texels),
    .mapping_offset = OFFSET(mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_spectrum,
    .share = share,
    .eval_spectrum = eval_spectrum,
};
