/* SPDX-License-Identifier: MIT */
/* Levels of detail of an image, and RGB texels made curves once, before rendering.
 *
 * A texel of a spectrum texture is s(lambda) = scale (1/2 + x / (2 sqrt(1 + x^2))), x quadratic in lambda (Jakob &
 * Hanika 2019). To find x from RGB needs a walk through a large table; it is done here, once a texel, and a hit only
 * evaluates.
 *
 * Interpolating the curves is linear in the spectrum, so the colour of what is interpolated, under the
 * space's illuminant, is the interpolated RGB; between texels the curve differs from the one that the interpolated RGB
 * would be given by a metamer, and a footprint's mean is the mean of the spectra under it, as of real surfaces. (Levels
 * above the first are curves of mean RGBs: again metamers.)
 *
 * Stored are the values of x at 400, 550 and 700 nm, to 2^-12 of themselves: s is wrong by less than 5e-5 at the
 * anchors, by 4e-5 in the mean over all RGB and wavelengths, by 9e-4 at worst (saturated colours, where x crosses zero
 * steeply); a step of 8-bit texels is 4e-3. 8 bytes a texel, 10.7 with the pyramid.
 *
 * Williams 1983. Images whose sides are no powers of two are not resampled: a level has ceil(n / 2) cells, and texels
 * on a border of cells count to both by their overlap. */
#include "texture/pyramid.h"

#include <string.h>

// ---- packing ----

typedef uint16_t u16x4 __attribute__((vector_size(8)));
typedef uint32_t u32x4 __attribute__((vector_size(16)));
typedef float f32x4 __attribute__((vector_size(16)));

static const f32x4 anchor_nm = {400, 550, 700, 0};

static inline u16x4 halves_from_floats(f32x4 x)
{
    u32x4 bits = (u32x4)(x * 0x1p-112f); // the exponents of binary16 now stand where those of binary32 do
    u32x4 magnitude = ((bits & 0x7fffffffu) + 0x1000u) >> 13;
    u32x4 is_large =
        (u32x4)(magnitude >
                0x7b53u); // 6e4: black and white have x = -inf and inf; here s is then within 1e-10 of 0 and 1
    magnitude = (magnitude & ~is_large) | (0x7b53u & is_large);
    return __builtin_convertvector((bits >> 16 & 0x8000u) | magnitude, u16x4);
}

static float scale_from_packed(uint16_t packed)
{
    uint32_t bits = (uint32_t)packed << 15;
    float x;
    memcpy(&x, &bits, 4);
    return x;
}

// the smallest storable number that is not below x >= 0
static uint16_t scale_to_packed(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, 4);
    return (uint16_t)((bits + 0x7fffu) >> 15);
}

struct sr_packed_texel sr_packed_texel_encode(struct sr_texture_use use, struct sr_rgb rgb)
{
    uint16_t packed_scale = scale_to_packed(1);
    if (use.rgb_use != SR_PARAM_ALBEDO) {
        // the curve of rgb / scale, with twice the greatest as scale: where the sigmoid is smoothest. The scale is
        // rounded before the division, so that costs nothing
        packed_scale = scale_to_packed(2 * sr_max(rgb.r, sr_max(rgb.g, rgb.b)));
        float scale = scale_from_packed(packed_scale);
        float inv = scale > 0 ? 1 / scale : 0;
        rgb = (struct sr_rgb){rgb.r * inv, rgb.g * inv, rgb.b * inv};
    }
    rgb = (struct sr_rgb){sr_clamp(rgb.r, 0, 1), sr_clamp(rgb.g, 0, 1), sr_clamp(rgb.b, 0, 1)};
    struct sr_sigmoid c = sr_rgb_to_sigmoid(use.space, rgb);
    u16x4 packed = halves_from_floats((c.c0 * anchor_nm + c.c1) * anchor_nm + c.c2);
    packed[3] = packed_scale;
    struct sr_packed_texel t;
    memcpy(&t, &packed, sizeof t); // in one go: waiting for four stores would take longer than all the rest
    return t;
}

sr_spectrum sr_packed_texels_sum(const struct sr_packed_texel *const texel[], const float weight[], int count,
                                 bool has_scale, sr_spectrum lambda)
{
    // Lagrange's polynomials of the anchors, with the factor that turns the bits of a half into its float
    sr_spectrum a = (lambda - 400.0f) * (1 / 150.0f), b = (lambda - 550.0f) * (1 / 150.0f),
                c = (lambda - 700.0f) * (1 / 150.0f);
    sr_spectrum l0 = b * c * 0x1p111f, l1 = a * c * -0x1p112f, l2 = a * b * 0x1p111f;
    sr_spectrum sum = SR_BLACK;
    float flat = 0;
    for (int i = 0; i < count; ++i) {
        u16x4 halves;
        memcpy(&halves, texel[i], sizeof halves);
        u32x4 wide = __builtin_convertvector(halves, u32x4);
        u32x4 bits = ((wide & 0x8000u) << 16) | ((wide & 0x7fffu) << 13);
        f32x4 h = (f32x4)bits;
        float w = 0.5f * weight[i];
        if (has_scale)
            w *= scale_from_packed(texel[i]->scale);
        sr_spectrum x = h[0] * l0 + h[1] * l1 + h[2] * l2;
        sr_spectrum y = x * x + 1.0f;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            y[k] = sqrtf(y[k]);
        sum += w * x / y;
        flat += w;
    }
    return sum + flat;
}

// ---- levels ----

// an image to read from: the texels of the file, or a level that has been averaged before
struct source {
    uint32_t width, height, channels;
    const struct sr_texels *texels; // or NULL
    const float *floats;
    bool is_float;
    bool has_alpha; // a float texture's number is alpha: there is one, and it is not 1 everywhere
};

// a float texture's number in *r, or linear RGB
static struct sr_rgb fetch(const struct source *s, uint32_t x, uint32_t y)
{
    size_t i = ((size_t)y * s->width + x) * s->channels;
    if (!s->texels)
        return s->channels == 1 ? (struct sr_rgb){s->floats[i], s->floats[i], s->floats[i]}
                                : (struct sr_rgb){s->floats[i], s->floats[i + 1], s->floats[i + 2]};
    const struct sr_texels *t = s->texels;
    float v[4] = {0};
    for (uint32_t k = 0; k < s->channels; ++k) {
        if (t->floats)
            v[k] = t->floats[i + k];
        else
            v[k] = k == 3 || !t->decode ? (float)t->bytes[i + k] * (1 / 255.0f) : t->decode[t->bytes[i + k]];
    }
    if (s->channels == 1)
        return (struct sr_rgb){v[0], v[0], v[0]};
    if (!s->is_float)
        return (struct sr_rgb){v[0], v[1], v[2]};
    float number = s->has_alpha ? v[3] : (v[0] + v[1] + v[2]) * (1 / 3.0f);
    return (struct sr_rgb){number, number, number};
}

// what fetch gives for texels x0 ... x0 + count - 1 of a row
static void fetch_row(const struct source *s, uint32_t x0, uint32_t count, uint32_t y, struct sr_rgb *out)
{
    const struct sr_texels *t = s->texels;
    if (!t || t->floats || !t->decode || s->is_float || s->channels < 3) {
        for (uint32_t x = 0; x < count; ++x)
            out[x] = fetch(s, x0 + x, y);
        return;
    }
    // as most images are
    const unsigned char *b = (const unsigned char *)t->bytes + ((size_t)y * s->width + x0) * s->channels;
    for (uint32_t x = 0; x < count; ++x, b += s->channels)
        out[x] = (struct sr_rgb){t->decode[b[0]], t->decode[b[1]], t->decode[b[2]]};
}

// source cells that fall into target cell i when n cells become ceil(n / 2) of equal size, with their shares (sum 1)
static int overlaps(uint32_t n, uint32_t i, uint32_t index[3], float share[3])
{
    if (n == 1) {
        index[0] = 0;
        share[0] = 1;
        return 1;
    }
    uint32_t m = (n + 1) / 2;
    if (n == 2 * m) { // most images
        index[0] = 2 * i;
        index[1] = 2 * i + 1;
        share[0] = share[1] = 0.5f;
        return 2;
    }
    double lo = (double)i * n / m, hi = (double)(i + 1) * n / m;
    int count = 0;
    for (uint32_t k = (uint32_t)lo; k < n && (double)k < hi && count < 3; ++k) {
        double part = fmin(hi, (double)k + 1) - fmax(lo, (double)k);
        if (part > 1e-9) {
            index[count] = k;
            share[count++] = (float)(part / (hi - lo));
        }
    }
    return count;
}

struct work {
    struct source source;
    float *halved; // [1] next level's numbers, source.is_float ? 1 : 3 of each texel
    float *values;
    struct sr_packed_texel *spectra;
    struct sr_pyramid_adjust adjust;
    struct sr_texture_use use;
};

// NaN counts as nothing, infinity as much
static float adjusted(struct sr_pyramid_adjust a, float v)
{
    v *= a.scale;
    v = a.invert ? 1 - v : v;
    return v > 0 ? (v < 1e30f ? v : 1e30f) : 0;
}

// images repeat their colours: those met lately in a band of rows are kept with their curves
enum { BAND_ROWS = 32, CACHE_SIZE = 2048, RUN = 256 };
struct cached {
    struct sr_rgb rgb;
    struct sr_packed_texel packed;
};

static uint32_t cache_slot(struct sr_rgb rgb)
{
    uint32_t bits[3];
    memcpy(bits, &rgb, sizeof bits);
    return (bits[0] * 0x9e3779b1u ^ bits[1] * 0x85ebca77u ^ bits[2] * 0xc2b2ae3du) >> 21; // 11 bits: CACHE_SIZE
}

static void convert_band(void *context, uint64_t band)
{
    struct work *work = context;
    uint32_t y0 = (uint32_t)band * BAND_ROWS, y1 = y0 + BAND_ROWS;
    y1 = y1 < work->source.height ? y1 : work->source.height;
    struct cached cache[CACHE_SIZE];
    for (int i = 0; i < CACHE_SIZE && work->spectra; ++i)
        cache[i].rgb.r = -1; // no texel's: none is negative
    struct sr_rgb run[RUN];
    for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = 0; x < work->source.width; ++x) {
            uint32_t left = work->source.width - x;
            if (x % RUN == 0)
                fetch_row(&work->source, x, left < RUN ? left : RUN, y, run);
            struct sr_rgb rgb = run[x % RUN];
            size_t i = (size_t)y * work->source.width + x;
            rgb.r = adjusted(work->adjust, rgb.r);
            if (work->values) {
                work->values[i] = rgb.r;
                continue;
            }
            rgb.g = adjusted(work->adjust, rgb.g);
            rgb.b = adjusted(work->adjust, rgb.b);
            struct cached *c = &cache[cache_slot(rgb)];
            if (c->rgb.r != rgb.r || c->rgb.g != rgb.g || c->rgb.b != rgb.b)
                *c = (struct cached){rgb, sr_packed_texel_encode(work->use, rgb)};
            work->spectra[i] = c->packed;
        }
}

static void halve_row(void *context, uint64_t y)
{
    struct work *work = context;
    const struct source *s = &work->source;
    uint32_t width = (s->width + 1) / 2, channels = s->is_float ? 1 : 3;
    uint32_t rows[3], columns[3], begin = 0, end = 0; // columns that `mean` holds
    float row_share[3], column_share[3];
    int row_count = overlaps(s->height, (uint32_t)y, rows, row_share);
    struct sr_rgb mean[RUN], row[RUN]; // of the rows
    for (uint32_t x = 0; x < width; ++x) {
        int column_count = overlaps(s->width, x, columns, column_share);
        if (columns[column_count - 1] >= end) {
            begin = columns[0];
            end = s->width - begin < RUN ? s->width : begin + RUN;
            memset(mean, 0, sizeof mean);
            for (int j = 0; j < row_count; ++j) {
                fetch_row(s, begin, end - begin, rows[j], row);
                for (uint32_t i = 0; i < end - begin; ++i)
                    mean[i] = (struct sr_rgb){mean[i].r + row_share[j] * row[i].r, mean[i].g + row_share[j] * row[i].g,
                                              mean[i].b + row_share[j] * row[i].b};
            }
        }
        struct sr_rgb sum = {0};
        for (int i = 0; i < column_count; ++i) {
            struct sr_rgb v = mean[columns[i] - begin];
            sum.r += column_share[i] * v.r;
            sum.g += column_share[i] * v.g;
            sum.b += column_share[i] * v.b;
        }
        float *out = work->halved + ((size_t)y * width + x) * channels;
        out[0] = sum.r;
        if (channels == 3) {
            out[1] = sum.g;
            out[2] = sum.b;
        }
    }
}

static bool has_alpha(const struct sr_texels *t)
{
    size_t n = t->channels == 4 ? (size_t)t->width * t->height : 0;
    for (size_t i = 0; i < n; ++i)
        if (t->floats ? t->floats[4 * i + 3] != 1 : t->bytes[4 * i + 3] != 255)
            return true;
    return false;
}

// small images are done before a thread has begun
static int threads_for(uint32_t width, uint32_t height)
{
    return (uint64_t)width * height > 65536 ? sr_thread_count() : 1;
}

sr_status sr_pyramid_build(struct sr_pyramid *p, const struct sr_texels *texels, bool is_float,
                           struct sr_pyramid_adjust adjust, struct sr_texture_use use, struct sr_arena *arena,
                           struct sr_error *error)
{
    if (texels->width == 0 || texels->height == 0 || texels->width > 1u << 30 || texels->height > 1u << 30 ||
        (!texels->bytes && !texels->floats) ||
        (texels->channels != 1 && texels->channels != 3 && texels->channels != 4))
        return sr_fail(error, SR_ERROR_INPUT,
                       "an image texture has no texels that could be used (%u x %u, %u channels)",
                       (unsigned)texels->width, (unsigned)texels->height, (unsigned)texels->channels);

    p->count = 0;
    use.space = texels->space;
    struct source source = {
        texels->width, texels->height, texels->channels, texels, NULL, is_float, is_float && has_alpha(texels)};
    float *previous = NULL;
    sr_status status = SR_OK;
    for (;;) {
        size_t n = (size_t)source.width * source.height;
        struct work work = {.source = source, .adjust = adjust, .use = use};
        if (is_float)
            work.values = sr_arena_alloc(arena, n * sizeof(float));
        else
            work.spectra = sr_arena_alloc(arena, n * sizeof(struct sr_packed_texel));
        if (!work.values && !work.spectra) {
            status = sr_fail(error, SR_ERROR_RESOURCE, "no memory for an image texture of %u x %u",
                             (unsigned)source.width, (unsigned)source.height);
            break;
        }
        sr_parallel_for(threads_for(source.width, source.height), (source.height + BAND_ROWS - 1) / BAND_ROWS,
                        convert_band, &work);
        p->levels[p->count++] = (struct sr_pyramid_level){source.width, source.height, work.values, work.spectra};
        if (n == 1)
            break;

        uint32_t width = (source.width + 1) / 2, height = (source.height + 1) / 2, channels = is_float ? 1 : 3;
        work.halved = sr_alloc((size_t)width * height * channels * sizeof(float));
        if (!work.halved) {
            status = sr_fail(error, SR_ERROR_RESOURCE, "no memory to average an image texture");
            break;
        }
        sr_parallel_for(threads_for(width, height), height, halve_row, &work);
        sr_free(previous);
        previous = work.halved;
        source = (struct source){width, height, channels, NULL, previous, is_float, false};
    }
    sr_free(previous);
    return status;
}
