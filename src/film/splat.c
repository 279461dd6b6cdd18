/* SPDX-License-Identifier: MIT */
/* Splats: exact sums of what paths from the lights bring to the picture, whoever adds first.
 *
 *     pixel = (sum over paths of f(raster - centre) rgb) / paths,
 *         var(pixel) = sum over groups (m_g - m)^2 / (G (G - 1))
 *
 * A sum is a signed integer of 128 bits in two words, in a unit that is a power of two: integers add in any order to
 * the same number, floats do not. The lower word is added to atomically; whoever makes it overflow carries, so that the
 * pair is right when all are done (while others add, a reader may miss a carry that is on its way). G groups of paths,
 * m_g the mean of each, tell the error. Limits: a splat is rounded to the unit; those beyond 2^95 of it are dropped and
 * counted. */
#include "film/film.h"

static const double LARGEST = 0x1p95; // [unit]

struct wide { // two's complement
    uint64_t low, high;
};

static struct wide negative(struct wide a)
{
    struct wide b = {~a.low + 1, ~a.high};
    b.high += b.low == 0;
    return b;
}

size_t sr_film_splats_B(uint32_t groups)
{
    return (size_t)groups * 3 * sizeof(struct wide);
}

sr_status sr_film_add_splats(struct sr_film *film, uint32_t groups, double unit, struct sr_error *error)
{
    struct sr_film_splats *s = sr_alloc(sizeof *s);
    groups = groups < 2 ? 2 : groups > SR_SPLAT_GROUPS ? SR_SPLAT_GROUPS : groups;
    if (s)
        *s = (struct sr_film_splats){.groups = groups,
                                     .unit = unit,
                                     .words = sr_alloc((size_t)film->width * film->height * sr_film_splats_B(groups))};
    film->splats = s;
    return s && s->words ? SR_OK
                         : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the splats of %u x %u pixels",
                                   film->width, film->height);
}

static uint64_t *words_of(const struct sr_film *film, size_t pixel, int channel, uint32_t group)
{
    const struct sr_film_splats *s = film->splats;
    return &s->words[((pixel * 3 + (size_t)channel) * s->groups + group) * 2];
}

static void add_wide(uint64_t words[2], struct wide a)
{
    uint64_t before = __atomic_fetch_add(&words[0], a.low, __ATOMIC_RELAXED);
    a.high += before + a.low < before;
    if (a.high)
        __atomic_fetch_add(&words[1], a.high, __ATOMIC_RELAXED);
}

static void add(uint64_t words[2], double value) // [unit]
{
    double units = rint(fabs(value)), high = floor(units * 0x1p-64);
    struct wide a = {(uint64_t)(units - high * 0x1p64), (uint64_t)high};
    if (value < 0)
        a = negative(a);
    add_wide(words, a);
}

static double sum_of(const uint64_t words[2]) // [unit]
{
    struct wide a = {__atomic_load_n(&words[0], __ATOMIC_RELAXED), __atomic_load_n(&words[1], __ATOMIC_RELAXED)};
    bool is_negative = a.high >> 63;
    if (is_negative) // its magnitude, lest small numbers be lost beside 2^64
        a = negative(a);
    double sum = (double)a.high * 0x1p64 + (double)a.low;
    return is_negative ? -sum : sum;
}

void sr_film_splat(struct sr_film *film, const struct sr_filter *filter, uint32_t group, sr_vec2 raster,
                   const float rgb[3])
{
    double pixels = (double)film->width * film->height, unit = film->splats->unit;
    float largest = sr_max(fabsf(rgb[0]), sr_max(fabsf(rgb[1]), fabsf(rgb[2])));
    // pixels whose centres are less than the radius away
    float x = raster.x - 0.5f - (float)film->settings.x0, y = raster.y - 0.5f - (float)film->settings.y0;
    float first_x = floorf(x - filter->radius.x) + 1, last_x = floorf(x + filter->radius.x);
    float first_y = floorf(y - filter->radius.y) + 1, last_y = floorf(y + filter->radius.y);
    // far beside the picture, near the sensor's own plane, values are large without bound: they are none of the
    // picture's
    if (last_x < 0 || last_y < 0 || first_x >= (float)film->width || first_y >= (float)film->height)
        return;
    if (!(isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2])) || isnan(x) || isnan(y) ||
        (double)largest * fabs(filter->inverse_integral) > LARGEST * unit * pixels) {
        __atomic_fetch_add(&film->splats->dropped, 1, __ATOMIC_RELAXED);
        return;
    }
    int x0 = (int)sr_max(first_x, 0), x1 = (int)sr_min(last_x, (float)(film->width - 1));
    int y0 = (int)sr_max(first_y, 0), y1 = (int)sr_min(last_y, (float)(film->height - 1));
    for (int j = y0; j <= y1; ++j)
        for (int i = x0; i <= x1; ++i) {
            double f = (double)filter->model->value(filter->self, (sr_vec2){x - (float)i, y - (float)j}) *
                       filter->inverse_integral / pixels / unit;
            for (int c = 0; c < 3; ++c)
                if (f * (double)rgb[c] != 0)
                    add(words_of(film, (size_t)j * film->width + (size_t)i, c, group), f * (double)rgb[c]);
        }
}

void sr_film_splat_paths(struct sr_film *film, uint32_t group, uint64_t paths)
{
    __atomic_fetch_add(&film->splats->paths[group], paths, __ATOMIC_RELAXED);
}

static double all_paths(const struct sr_film_splats *s)
{
    uint64_t n = 0;
    for (uint32_t g = 0; g < s->groups; ++g)
        n += __atomic_load_n(&s->paths[g], __ATOMIC_RELAXED);
    return (double)n;
}

double sr_film_splat_mean(const struct sr_film *film, size_t pixel, int channel)
{
    const struct sr_film_splats *s = film->splats;
    double n = s ? all_paths(s) : 0, sum = 0;
    for (uint32_t g = 0; n > 0 && g < s->groups; ++g)
        sum += sum_of(words_of(film, pixel, channel, g));
    return n > 0 ? sum * s->unit * ((double)film->width * film->height) / n : 0;
}

double sr_film_splat_variance(const struct sr_film *film, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1,
                              const double w[3])
{
    const struct sr_film_splats *s = film->splats;
    double sums[SR_SPLAT_GROUPS] = {0}, all = 0, n = s ? all_paths(s) : 0, spread = 0, used = 0;
    if (!(n > 0))
        return 0;
    for (uint32_t g = 0; g < s->groups; ++g) {
        for (uint32_t y = y0; y < y1; ++y)
            for (uint32_t x = x0; x < x1; ++x)
                for (int c = 0; c < 3; ++c)
                    if (w[c] != 0)
                        sums[g] += w[c] * sum_of(words_of(film, (size_t)y * film->width + x, c, g));
        all += sums[g];
        used += s->paths[g] > 0;
    }
    for (uint32_t g = 0; g < s->groups; ++g) {
        double deviation = sums[g] - all * (double)s->paths[g] / n;
        spread += deviation * deviation;
    }
    double scale = s->unit * ((double)film->width * film->height) / n;
    return used > 1 ? spread * scale * scale * used / (used - 1) : NAN;
}

/* ---- sums that travel ----
 *
 * The numbers of groups, pixels and dropped values, paths of each group; then each sum that is not 0: how many that are
 * 0 it comes after, and its value, the sign in the lowest bit. Numbers go in groups of 7 bits, lowest first, the 8th
 * bit: more follow. */

typedef unsigned __int128 uint128;
enum { LONGEST = 19 }; // [B] of 128 bits, 7 in each

struct bytes {
    uint8_t *data;
    size_t size, room;
};

static bool put(struct bytes *b, uint128 value)
{
    if (b->room - b->size < LONGEST) {
        size_t room = b->room * 2 + 4096;
        uint8_t *grown = sr_realloc(b->data, b->room, room);
        if (!grown)
            return false;
        b->data = grown;
        b->room = room;
    }
    for (; value >> 7; value >>= 7)
        b->data[b->size++] = (uint8_t)(value | 0x80);
    b->data[b->size++] = (uint8_t)value;
    return true;
}

static bool get(const uint8_t **at, const uint8_t *end, uint128 *value)
{
    *value = 0;
    for (int shift = 0; *at < end && shift < 7 * LONGEST; shift += 7) {
        uint8_t byte = *(*at)++;
        *value |= (uint128)(byte & 0x7f) << shift;
        if (!(byte & 0x80))
            return true;
    }
    return false;
}

uint8_t *sr_film_splats_pack(struct sr_film *film, size_t *size)
{
    struct sr_film_splats *s = film->splats;
    struct bytes b = {0};
    size_t count = (size_t)film->width * film->height * 3 * s->groups, last = 0;
    bool is_ok = put(&b, s->groups) && put(&b, (uint128)film->width * film->height) && put(&b, s->dropped);
    for (uint32_t g = 0; is_ok && g < s->groups; ++g)
        is_ok = put(&b, s->paths[g]);
    for (size_t i = 0; is_ok && i < count; ++i) {
        uint128 sum = (uint128)s->words[2 * i + 1] << 64 | s->words[2 * i];
        if (!sum)
            continue;
        is_ok = put(&b, i - last) && put(&b, sum >> 127 ? ~(sum << 1) : sum << 1);
        s->words[2 * i] = s->words[2 * i + 1] = 0;
        last = i + 1;
    }
    s->dropped = 0;
    for (uint32_t g = 0; g < s->groups; ++g)
        s->paths[g] = 0;
    if (!is_ok) {
        sr_free(b.data);
        b = (struct bytes){0};
    }
    *size = b.size;
    return b.data;
}

bool sr_film_splats_add(struct sr_film *film, const uint8_t *bytes, size_t size)
{
    struct sr_film_splats *s = film->splats;
    const uint8_t *at = bytes, *end = bytes + size;
    size_t count = (size_t)film->width * film->height * 3 * s->groups, next = 0;
    uint128 groups, pixels, dropped, paths, gap, sum;
    if (!get(&at, end, &groups) || groups != s->groups || !get(&at, end, &pixels) ||
        pixels != (uint128)film->width * film->height || !get(&at, end, &dropped))
        return false;
    __atomic_fetch_add(&s->dropped, (uint64_t)dropped, __ATOMIC_RELAXED);
    for (uint32_t g = 0; g < s->groups; ++g) {
        if (!get(&at, end, &paths))
            return false;
        sr_film_splat_paths(film, g, (uint64_t)paths);
    }
    while (at < end) {
        if (!get(&at, end, &gap) || !get(&at, end, &sum) || gap >= count - next)
            return false;
        next += (size_t)gap;
        uint128 value = sum & 1 ? ~(sum >> 1) : sum >> 1;
        add_wide(&s->words[2 * next], (struct wide){(uint64_t)value, (uint64_t)(value >> 64)});
        ++next;
    }
    return true;
}
