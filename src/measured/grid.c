/* SPDX-License-Identifier: MIT */
/* Measurements that fill a grid of angles: linear along each of them.
 *
 *     f = SUM over 16 corners of w_i(theta_i) w_j(phi_i) w_k(theta_o) w_l(phi_o) f_ijkl
 *
 * Azimuths that go round are periodic; isotropic ones that cover half a turn count for both halves; outside of the
 * measured angles the nearest ones count. Reflection and transmission are never mixed. */
#include "measured/private.h"

#include <stdlib.h>

struct axis {
    int count;
    float *at;     // [rad] increasing
    bool is_round; // periodic; without a last value that repeats the first
    bool is_folded;
    int side; // theta_o: how many are below the horizon's angle of 90 deg
};

struct grid {
    struct axis axes[4];
    float *values;
    struct channels channels;
    bool is_isotropic;
};

static int compare(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

#define SAME 2e-4f // [rad] angles closer than this are one

static bool axis_make(struct axis *axis, const struct rows *rows, int which, float *scratch, struct sr_arena *arena)
{
    for (size_t k = 0; k < rows->count; ++k)
        scratch[k] = rows->angles[4 * k + (size_t)which];
    qsort(scratch, rows->count, sizeof(float), compare);
    size_t n = 0;
    for (size_t k = 0; k < rows->count; ++k)
        if (n == 0 || scratch[k] - scratch[n - 1] > SAME)
            scratch[n++] = scratch[k];
    axis->count = (int)n;
    axis->at = sr_arena_copy(arena, scratch, n * sizeof(float));
    if (!axis->at)
        return false;
    float lo = scratch[0], hi = scratch[n - 1], widest = 0;
    for (size_t k = 1; k < n; ++k)
        widest = sr_max(widest, scratch[k] - scratch[k - 1]);
    if (which & 1) {
        if (hi - lo < 2 * SR_PI - SAME) // 0, 10, … 350: the gap to the next turn is not wider than the others
            axis->is_round = n > 2 && 2 * SR_PI - (hi - lo) < widest * 1.01f + SAME;
        if (!axis->is_round && which == 3 && hi - lo < SR_PI + 0.01f)
            axis->is_folded = (lo > -0.01f && hi < SR_PI + 0.01f) || (hi < 0.01f && lo > -SR_PI - 0.01f);
    }
    for (size_t k = 0; k < n; ++k)
        axis->side += scratch[k] <= SR_PI / 2 + 1e-4f;
    return true;
}

static int axis_place(const struct axis *axis, float x)
{
    float t;
    int i = axis->count > 1 ? axis_find(axis->at, axis->count, x, &t) : 0;
    return i + (axis->count > 1 && t > 0.5f);
}

/* neighbours and shares on an axis of azimuths */
static int azimuth(const struct axis *axis, float phi, int index[2], float share[2])
{
    share[0] = 1;
    index[0] = 0;
    if (axis->count == 1)
        return 1;
    float lo = axis->at[0], hi = axis->at[axis->count - 1], t;
    if (axis->is_folded) {
        phi = fabsf(phi - 2 * SR_PI * rintf(phi / (2 * SR_PI)));
        phi = lo < -0.01f ? -phi : phi;
    } else {
        phi = phi - lo;
        phi = lo + phi - 2 * SR_PI * floorf(phi / (2 * SR_PI));
        if (phi > hi && axis->is_round) {
            index[0] = axis->count - 1;
            index[1] = 0;
            share[1] = (phi - hi) / (lo + 2 * SR_PI - hi);
            share[0] = 1 - share[1];
            return 2;
        }
        if (phi > hi && phi - hi > lo + 2 * SR_PI - phi)
            return 1; // nearer to the first
    }
    index[0] = axis_find(axis->at, axis->count, phi, &t);
    index[1] = index[0] + 1;
    share[1] = t;
    share[0] = 1 - t;
    return 2;
}

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct grid *g = data;
    float theta_i = atan2f(sqrtf(wi.x * wi.x + wi.y * wi.y), wi.z);
    float theta_o = atan2f(sqrtf(wo.x * wo.x + wo.y * wo.y), wo.z);
    float phi_i = wi.x != 0 || wi.y != 0 ? atan2f(wi.y, wi.x) : 0,
          phi_o = wo.x != 0 || wo.y != 0 ? atan2f(wo.y, wo.x) : 0;
    int index[4][2], count[4];
    float share[4][2], t;
    // theta_i
    index[0][0] = axis_find(g->axes[0].at, g->axes[0].count, theta_i, &t);
    index[0][1] = index[0][0] + 1;
    share[0][0] = 1 - t;
    share[0][1] = t;
    count[0] = t > 0 ? 2 : 1;
    // theta_o, on its side only
    const struct axis *o = &g->axes[2];
    int first = wo.z < 0 ? o->side : 0, n = wo.z < 0 ? o->count - o->side : o->side;
    if (n == 0)
        return SR_BLACK;
    index[2][0] = first + axis_find(o->at + first, n, theta_o, &t);
    index[2][1] = index[2][0] + 1;
    share[2][0] = 1 - t;
    share[2][1] = t;
    count[2] = t > 0 ? 2 : 1;
    count[1] = azimuth(&g->axes[1], phi_i, index[1], share[1]);
    count[3] = azimuth(&g->axes[3], g->is_isotropic ? phi_o - phi_i : phi_o, index[3], share[3]);
    struct corners at = {0};
    for (int i = 0; i < count[0]; ++i)
        for (int j = 0; j < count[1]; ++j)
            for (int k = 0; k < count[2]; ++k)
                for (int l = 0; l < count[3]; ++l) {
                    float w = share[0][i] * share[1][j] * share[2][k] * share[3][l];
                    if (!(w > 0))
                        continue;
                    size_t cell = (size_t)index[0][i] * (size_t)g->axes[1].count + (size_t)index[1][j];
                    cell = (cell * (size_t)o->count + (size_t)index[2][k]) * (size_t)g->axes[3].count +
                           (size_t)index[3][l];
                    at.base[at.count] = cell * (size_t)g->channels.count;
                    at.weight[at.count++] = w;
                }
    return channels_eval(&g->channels, g->values, &at, lambda);
}

/* false: the measurements fill no grid (or *no_memory) */
bool grid_build(const struct source *s, const struct rows *rows, struct sr_measured *m, bool *no_memory)
{
    struct grid *g = sr_arena_alloc(s->arena, sizeof *g);
    float *scratch = sr_alloc(rows->count * sizeof(float));
    *no_memory = !g || !scratch;
    double cells = 1;
    for (int a = 0; a < 4 && !*no_memory; ++a) {
        *no_memory = !axis_make(&g->axes[a], rows, a, scratch, s->arena);
        cells *= *no_memory ? 1 : g->axes[a].count;
    }
    sr_free(scratch);
    if (*no_memory || cells != (double)rows->count)
        return false;
    size_t channels = (size_t)rows->channels.count;
    uint8_t *seen = sr_alloc(rows->count);
    g->values = sr_arena_alloc(s->arena, rows->count * channels * sizeof(float));
    *no_memory = !seen || !g->values;
    bool full = !*no_memory;
    for (size_t k = 0; full && k < rows->count; ++k) {
        size_t cell = 0;
        for (int a = 0; a < 4; ++a)
            cell = cell * (size_t)g->axes[a].count + (size_t)axis_place(&g->axes[a], rows->angles[4 * k + (size_t)a]);
        full = !seen[cell];
        seen[cell] = 1;
        memcpy(g->values + cell * channels, rows->values + k * channels, channels * sizeof(float));
    }
    sr_free(seen);
    if (!full)
        return false;
    g->channels = rows->channels;
    g->is_isotropic = m->is_isotropic;
    m->data = g;
    m->f = f;
    return true;
}
