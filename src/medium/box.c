/* SPDX-License-Identifier: MIT */
/* A ray's way through a box of equal cells, each with a majorant: a three-dimensional digital differential analyser (J.
 * Amanatides & A. Woo, A Fast Voxel Traversal Algorithm, 1987).
 *
 * The next crossing along each axis is computed from the plane itself, t = (plane - o) / d, not by adding up steps, so
 * that no error grows; a crossing never comes before the one before it, as rounding keeps the order of the planes. Each
 * cell's majorant holds 1/64 of a cell around it, too, which is more than a point of the ray may be off by rounding. */
#include "medium/private.h"

static const double around = 1.0 / 64; // of a cell
static const float standing = 1e-30f;  // [cells/m] slower than that, no ray meets a plane

sr_status sr_medium_box_set(struct sr_medium_box *box, const struct sr_transform *medium_to_world, sr_vec3 p0,
                            sr_vec3 p1, const int32_t cells[3], struct sr_arena *arena, struct sr_error *error)
{
    const float(*m)[4] = medium_to_world->inverse;
    if (m[3][0] != 0 || m[3][1] != 0 || m[3][2] != 0 || !(m[3][3] > 0))
        return sr_fail(error, SR_ERROR_INPUT, "a medium cannot be transformed in perspective");
    double scale = 1 / (double)m[3][3];
    for (int k = 0; k < 3; ++k) {
        double a = (double)sr_component(p0, k), b = (double)sr_component(p1, k), lo = fmin(a, b), extent = fabs(b - a);
        if (!(extent > 0) || !isfinite(extent))
            return sr_fail(error, SR_ERROR_INPUT,
                           "the corners \"p0\" and \"p1\" of a medium span no box: its extent along %c is %g m",
                           "xyz"[k], extent);
        double per_m = cells[k] / extent;
        for (int j = 0; j < 3; ++j)
            box->to_cells[k][j] = (float)((double)m[k][j] * scale * per_m);
        box->to_cells[k][3] = (float)(((double)m[k][3] * scale - lo) * per_m);
        box->cells[k] = cells[k];
        for (int j = 0; j < 4; ++j)
            if (!isfinite(box->to_cells[k][j]))
                return sr_fail(error, SR_ERROR_INPUT,
                               "the box of a medium is too small or too far away for its transform");
    }
    box->to_unit = (sr_vec3){1 / (float)cells[0], 1 / (float)cells[1], 1 / (float)cells[2]};
    box->largest = sr_arena_alloc(arena, (size_t)cells[0] * (size_t)cells[1] * (size_t)cells[2] * sizeof(float));
    return box->largest ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "no memory for the majorants of a medium");
}

void sr_medium_box_fill(struct sr_medium_box *box,
                        float (*largest)(const void *context, const double lo[3], const double hi[3]),
                        const void *context)
{
    const int32_t *n = box->cells;
    float *out = box->largest;
    for (int32_t z = 0; z < n[2]; ++z)
        for (int32_t y = 0; y < n[1]; ++y)
            for (int32_t x = 0; x < n[0]; ++x) {
                const double lo[3] = {(x - around) / n[0], (y - around) / n[1], (z - around) / n[2]},
                             hi[3] = {(x + 1 + around) / n[0], (y + 1 + around) / n[1], (z + 1 + around) / n[2]};
                *out++ = largest(context, lo, hi) * 1.00001f; // for the rounding of sums of products
            }
}

void sr_medium_box_begin(const struct sr_medium_box *box, sr_vec3 o, sr_vec3 d, float t_max, sr_spectrum scale,
                         struct sr_medium_walk *walk)
{
    float from[3], speed[3], t0 = 0, t1 = t_max;
    for (int k = 0; k < 3; ++k) {
        const float *a = box->to_cells[k];
        float n = (float)box->cells[k];
        from[k] = a[0] * o.x + a[1] * o.y + a[2] * o.z + a[3];
        speed[k] = a[0] * d.x + a[1] * d.y + a[2] * d.z;
        if (fabsf(speed[k]) < standing) {
            speed[k] = 0;
            walk->step[k] = 0;
            if (!(from[k] >= 0 && from[k] <= n))
                t1 = -1;
            continue;
        }
        float inverse = 1 / speed[k], at_0 = -from[k] * inverse, at_n = (n - from[k]) * inverse;
        walk->step[k] = inverse;
        t0 = sr_max(t0, sr_min(at_0, at_n));
        t1 = sr_min(t1, sr_max(at_0, at_n));
    }
    walk->grid = box;
    walk->scale = scale;
    walk->o = (sr_vec3){from[0], from[1], from[2]};
    walk->t = t0;
    walk->t_max = t1;
    if (!(t0 < t1))
        return;
    for (int k = 0; k < 3; ++k) {
        float place = sr_min(sr_max(from[k] + t0 * speed[k], 0), (float)(box->cells[k] - 1));
        walk->cell[k] = (int32_t)place;
        walk->way[k] = speed[k] > 0 ? 1 : speed[k] < 0 ? -1 : 0;
        walk->next[k] =
            walk->way[k] ? ((float)(walk->cell[k] + (walk->way[k] > 0)) - from[k]) * walk->step[k] : INFINITY;
    }
}

bool sr_medium_box_next(struct sr_medium_walk *walk, struct sr_medium_segment *segment)
{
    const struct sr_medium_box *box = walk->grid;
    const float *o = &walk->o.x;
    while (walk->t < walk->t_max) {
        int k = walk->next[0] < walk->next[1] ? 0 : 1;
        k = walk->next[2] < walk->next[k] ? 2 : k;
        int32_t *cell = walk->cell;
        float largest =
            box->largest[((size_t)cell[2] * (size_t)box->cells[1] + (size_t)cell[1]) * (size_t)box->cells[0] +
                         (size_t)cell[0]];
        float t0 = walk->t, t1 = walk->t_max;
        if (walk->next[k] < walk->t_max) {
            int32_t there = cell[k] + walk->way[k];
            if ((uint32_t)there < (uint32_t)box->cells[k]) { // else the end of the box comes a rounding error later
                t1 = walk->next[k];
                cell[k] = there;
                walk->next[k] = ((float)(there + (walk->way[k] > 0)) - o[k]) * walk->step[k];
            }
        }
        if (!(t1 > t0)) // a corner
            continue;
        walk->t = t1;
        if (largest > 0) {
            *segment = (struct sr_medium_segment){.t0 = t0, .t1 = t1, .majorant = largest * walk->scale};
            return true;
        }
    }
    return false;
}
