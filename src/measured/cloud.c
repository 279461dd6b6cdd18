/* SPDX-License-Identifier: MIT */
/* Measurements that fill no grid: a smooth mean of the eight nearest ones.
 *
 *     log(f + e) = SUM w_k log(f_k + e) / SUM w_k,   w_k = ((R - d_k) / (R d_k))^2,   R = distance of the ninth,
 *         e = 0.001 / sr
 *
 * in logarithms, so that a peak that one measurement has hit does not spread to its neighbours
 * (D. Shepard 1968; weights of R. Franke & G. Nielson 1980: continuous, exact at the measurements). Distances of
 * isotropic data are taken between the invariants
 *     (|s_i + s_o|, |s_i - s_o|, ||s_i| - |s_o||),    s = (x, y) of a direction,
 * which do not change when wi and wo are exchanged, turned or mirrored: f is reciprocal by construction, and the first
 * of them is the distance from the mirror direction. Others: between (s_i, s_o). Found in a k-d tree. */
#include "measured/private.h"

#include <stdlib.h>

enum { NEAREST = 9, LEAST = 16 };
#define LOG_OFFSET 1e-3f // [1/sr]

struct point {
    float x[4];
    uint32_t row;
    uint8_t axis;
};

struct cloud {
    uint32_t count;
    struct point *points; // a balanced tree: the middle one of a range splits it
    float *values;
    struct channels channels;
    bool is_isotropic;
};

static void place(bool is_isotropic, sr_vec3 wo, sr_vec3 wi, float x[4])
{
    if (is_isotropic) {
        float ax = wi.x + wo.x, ay = wi.y + wo.y, bx = wi.x - wo.x, by = wi.y - wo.y;
        x[0] = sqrtf(ax * ax + ay * ay);
        x[1] = sqrtf(bx * bx + by * by);
        x[2] = fabsf(sqrtf(wi.x * wi.x + wi.y * wi.y) - sqrtf(wo.x * wo.x + wo.y * wo.y));
        x[3] = 0;
    } else {
        x[0] = wi.x;
        x[1] = wi.y;
        x[2] = wo.x;
        x[3] = wo.y;
    }
    if (wo.z < 0)
        x[0] += 16; // what passes through lies far from what is reflected
}

#define COMPARE(n)                                                                                                     \
    static int compare##n(const void *a, const void *b)                                                                \
    {                                                                                                                  \
        float x = ((const struct point *)a)->x[n], y = ((const struct point *)b)->x[n];                                \
        return x < y ? -1 : x > y;                                                                                     \
    }
COMPARE(0)
COMPARE(1)
COMPARE(2)
COMPARE(3)
static int (*const comparisons[4])(const void *, const void *) = {compare0, compare1, compare2, compare3};

static void split(struct point *points, uint32_t count)
{
    while (count > 1) {
        int axis = 0;
        float widest = -1;
        for (int a = 0; a < 4; ++a) {
            float lo = INFINITY, hi = -INFINITY;
            for (uint32_t k = 0; k < count; ++k) {
                lo = sr_min(lo, points[k].x[a]);
                hi = sr_max(hi, points[k].x[a]);
            }
            if (hi - lo > widest) {
                widest = hi - lo;
                axis = a;
            }
        }
        qsort(points, count, sizeof *points, comparisons[axis]);
        uint32_t middle = count / 2;
        points[middle].axis = (uint8_t)axis;
        split(points, middle);
        points += middle + 1;
        count -= middle + 1;
    }
}

struct found {
    int count;
    float distance2[NEAREST];
    uint32_t row[NEAREST];
};

static void search(const struct point *points, uint32_t count, const float x[4], struct found *found)
{
    while (count > 0) {
        uint32_t middle = count / 2;
        const struct point *p = &points[middle];
        float d2 = 0;
        for (int a = 0; a < 4; ++a)
            d2 += (p->x[a] - x[a]) * (p->x[a] - x[a]);
        if (found->count < NEAREST || d2 < found->distance2[NEAREST - 1]) {
            int k = found->count < NEAREST ? found->count++ : NEAREST - 1;
            for (; k > 0 && found->distance2[k - 1] > d2; --k) {
                found->distance2[k] = found->distance2[k - 1];
                found->row[k] = found->row[k - 1];
            }
            found->distance2[k] = d2;
            found->row[k] = p->row;
        }
        float beyond = x[p->axis] - p->x[p->axis];
        bool upper = beyond > 0;
        search(upper ? p + 1 : points, upper ? count - middle - 1 : middle, x, found);
        if (found->count == NEAREST && beyond * beyond >= found->distance2[NEAREST - 1])
            return;
        if (upper)
            count = middle;
        else {
            points = p + 1;
            count -= middle + 1;
        }
    }
}

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct cloud *c = data;
    float x[4];
    place(c->is_isotropic, wo, wi, x);
    struct found found = {0};
    search(c->points, c->count, x, &found);
    size_t channels = (size_t)c->channels.count;
    struct corners at = {0};
    float R = sqrtf(found.distance2[NEAREST - 1]), sum = 0;
    for (int k = 0; k < NEAREST - 1; ++k) {
        float d = sr_max(sqrtf(found.distance2[k]), 1e-6f);
        float w = d < R ? sr_sqr((R - d) / (R * d)) : k == 0 ? 1 : 0;
        at.base[at.count] = found.row[k] * channels;
        at.weight[at.count++] = w;
        sum += w;
    }
    for (int k = 0; k < at.count; ++k)
        at.weight[k] /= sum;
    return channels_eval(&c->channels, c->values, &at, lambda);
}

static sr_vec3 direction(float theta, float phi)
{
    return sr_spherical_direction(sinf(theta), cosf(theta), phi);
}

sr_status cloud_build(const struct source *s, const struct rows *rows, struct sr_measured *m)
{
    size_t side[2] = {0};
    for (size_t k = 0; k < rows->count; ++k)
        side[rows->angles[4 * k + 2] > SR_PI / 2 + 1e-4f]++;
    for (int i = 0; i < 2; ++i)
        if (side[i] > 0 && side[i] < LEAST)
            return fail_at(s, 0,
                           "its %zu measurements of %s fill no grid of angles, and are fewer than the %d from which "
                           "one can interpolate",
                           side[i], i ? "transmission" : "reflection", LEAST);
    if (rows->count > UINT32_MAX / 2)
        return fail_at(s, 0, "holds %zu measurements, at most 2^31 are expected", rows->count);
    struct cloud *c = sr_arena_alloc(s->arena, sizeof *c);
    struct point *points = sr_arena_alloc(s->arena, rows->count * sizeof *points);
    size_t channels = (size_t)rows->channels.count;
    float *values = sr_arena_copy(s->arena, rows->values, rows->count * channels * sizeof(float));
    if (!c || !points || !values)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory for its %zu measurements", s->name,
                       rows->count);
    for (size_t k = 0; k < rows->count * channels; ++k)
        values[k] = logf(values[k] + LOG_OFFSET);
    for (size_t k = 0; k < rows->count; ++k) {
        const float *a = rows->angles + 4 * k;
        place(m->is_isotropic, direction(a[2], a[3]), direction(a[0], a[1]), points[k].x);
        if ((a[2] > SR_PI / 2 + 1e-4f) != (points[k].x[0] > 8)) // a rounding at the horizon
            points[k].x[0] += a[2] > SR_PI / 2 + 1e-4f ? 16 : -16;
        points[k].row = (uint32_t)k;
    }
    split(points, (uint32_t)rows->count);
    *c = (struct cloud){.count = (uint32_t)rows->count,
                        .points = points,
                        .values = values,
                        .channels = rows->channels,
                        .is_isotropic = m->is_isotropic};
    c->channels.log_offset = LOG_OFFSET;
    m->data = c;
    m->f = f;
    return SR_OK;
}
