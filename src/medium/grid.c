/* SPDX-License-Identifier: MIT */
/* What dense grids share.
 *
 *     d(u) = sum over the eight voxels around u of w_i d_i,     w: product of 1 - |u n - 1/2 - i| along x, y, z [1]
 *
 * Voxels outside are 0, so that the outermost half voxel fades to half. Of linear interpolation the largest value
 * between two planes is that of a voxel within, or next to them. */
#include "medium/private.h"

float sr_medium_grid_at(const float *values, const int32_t n[3], sr_vec3 unit)
{
    struct sr_medium_voxel v;
    if (!sr_medium_voxel_find(n, unit, &v))
        return 0;
    if (v.is_inside) {
        size_t row = (size_t)n[0], plane = row * (size_t)n[1];
        const float *p = values + (size_t)v.i[2] * plane + (size_t)v.i[1] * row + (size_t)v.i[0];
        float d00 = sr_lerp(v.f[0], p[0], p[1]), d10 = sr_lerp(v.f[0], p[row], p[row + 1]);
        float d01 = sr_lerp(v.f[0], p[plane], p[plane + 1]), d11 = sr_lerp(v.f[0], p[plane + row], p[plane + row + 1]);
        return sr_lerp(v.f[2], sr_lerp(v.f[1], d00, d10), sr_lerp(v.f[1], d01, d11));
    }
    float sum = 0, weight;
    size_t place;
    for (int c = 0; c < 8; ++c)
        if (sr_medium_voxel_corner(n, &v, c, &place, &weight))
            sum += weight * values[place];
    return sum;
}

void sr_medium_grid_range(const int32_t n[3], const double lo[3], const double hi[3], int32_t first[3], int32_t last[3])
{
    for (int k = 0; k < 3; ++k) {
        first[k] = (int32_t)fmin(fmax(floor(lo[k] * n[k] - 0.5), 0), n[k] - 1);
        last[k] = (int32_t)fmin(fmax(floor(hi[k] * n[k] - 0.5) + 1, 0), n[k] - 1);
    }
}

sr_status sr_medium_grid_check(const char *what, struct sr_slice values, uint32_t each, const int32_t n[3], float least,
                               struct sr_error *error)
{
    uint64_t expected = (uint64_t)n[0] * (uint64_t)n[1]; // below 2^62
    bool is_sane = expected <= UINT32_MAX && (expected *= (uint64_t)n[2]) * each <= UINT32_MAX;
    if (!is_sane || values.count != expected)
        return sr_fail(error, SR_ERROR_INPUT, "\"%s\" has %u values: expected nx ny nz = %d x %d x %d of them", what,
                       values.count, (int)n[0], (int)n[1], (int)n[2]);
    const float *v = values.data;
    for (size_t i = 0; i < expected * each; ++i)
        if (!(v[i] >= least) || !isfinite(v[i]))
            return sr_fail(error, SR_ERROR_INPUT, "\"%s\" of voxel (%d, %d, %d) is %g: expected finite values%s", what,
                           (int)(i / each % (size_t)n[0]), (int)(i / each / (size_t)n[0] % (size_t)n[1]),
                           (int)(i / each / (size_t)n[0] / (size_t)n[1]), (double)v[i],
                           least == 0 ? " of 0 or more" : "");
    return SR_OK;
}

/* A cell more costs each ray a step, a cell less some collisions more: with h the size of cells, a / h against b
 * sigma_t h, so that the best h goes as sigma_t^-1/2. The factor is from counting both in clouds of noise, 2 to 100
 * mean free paths thick. */
void sr_medium_grid_cells(const int32_t n[3], float sigma_t, const struct sr_transform *medium_to_world, sr_vec3 p0,
                          sr_vec3 p1, int32_t cells[3])
{
    const float(*m)[4] = medium_to_world->m;
    for (int k = 0; k < 3; ++k) {
        float length = sqrtf(m[0][k] * m[0][k] + m[1][k] * m[1][k] + m[2][k] * m[2][k]) *
                       fabsf(sr_component(p1, k) - sr_component(p0, k)); // [m]
        float best = 2.5f * sqrtf(sr_min(sigma_t * length, 1e6f)),
              most = sr_min((float)(n[k] / 2 + 1), SR_MEDIUM_MOST_CELLS);
        cells[k] = (int32_t)sr_clamp(best, 1, most);
    }
}

float sr_medium_grid_largest(struct sr_slice values)
{
    float largest = 0;
    for (uint32_t i = 0; i < values.count; ++i)
        largest = sr_max(((const float *)values.data)[i], largest);
    return largest;
}
