/* SPDX-License-Identifier: MIT */
/* For the files of this room: emission, and boxes with a coarse grid of majorants in them. */
#ifndef SR_MEDIUM_PRIVATE_H
#define SR_MEDIUM_PRIVATE_H

#include "medium/medium.h"

#define SR_MEDIUM_MOST_G 0.9999 // of the mean cosine: beyond that scattering is none

/* Makes Le as bright as a scene says: `scale` times luminance 1 [cd/m^2] as pbrt does, rgb times a white of luminance
 * 1, or what an absolute spectrum says. Kind NONE (dark) where nothing is left of it. */
sr_status sr_medium_set_emission(struct sr_spd *Le, const struct sr_medium_common *common, float scale,
                                 struct sr_error *error);

/* What a black body radiates whose spectrum a scene scales by its maximum; of absolute scenes Planck's law. Below 100
 * K: nothing. */
sr_spectrum sr_medium_blackbody(float temperature, bool is_absolute, const struct sr_wavelengths *w);

/* Multiplies both coefficients by scale; an error where they are not finite then. */
sr_status sr_medium_scale(struct sr_spd *sigma_a, struct sr_spd *sigma_s, float scale, struct sr_error *error);

/* ---- boxes ---- */

enum { SR_MEDIUM_MOST_CELLS = 64 }; // along an axis

/* A box of the medium's space, and over it a grid of cells with the largest density of each. */
struct sr_medium_box {
    float to_cells[3][4]; // from the world; the box is 0 … cells along each axis
    sr_vec3 to_unit;      // times that: the box as the cube 0 … 1
    int32_t cells[3];
    float *largest; // [1] x fastest
};

/* Corners may be given in any order. */
sr_status sr_medium_box_set(struct sr_medium_box *box, const struct sr_transform *medium_to_world, sr_vec3 p0,
                            sr_vec3 p1, const int32_t cells[3], struct sr_arena *arena, struct sr_error *error);
/* Asks for the largest density between two corners of the cube 0 … 1, for each cell and a little around it. */
void sr_medium_box_fill(struct sr_medium_box *box,
                        float (*largest)(const void *context, const double lo[3], const double hi[3]),
                        const void *context);

static inline sr_vec3 sr_medium_box_unit(const struct sr_medium_box *box, sr_vec3 p)
{
    const float(*a)[4] = (const float(*)[4])box->to_cells;
    return (sr_vec3){(a[0][0] * p.x + a[0][1] * p.y + a[0][2] * p.z + a[0][3]) * box->to_unit.x,
                     (a[1][0] * p.x + a[1][1] * p.y + a[1][2] * p.z + a[1][3]) * box->to_unit.y,
                     (a[2][0] * p.x + a[2][1] * p.y + a[2][2] * p.z + a[2][3]) * box->to_unit.z};
}

/* A walk through the cells; scale [1/m] of density 1. Cells without density are passed over. */
void sr_medium_box_begin(const struct sr_medium_box *box, sr_vec3 o, sr_vec3 d, float t_max, sr_spectrum scale,
                         struct sr_medium_walk *walk);
bool sr_medium_box_next(struct sr_medium_walk *walk, struct sr_medium_segment *segment);

/* ---- dense grids: samples at the middles of n[0] n[1] n[2] voxels of the cube 0 … 1, x fastest, linear between them,
 * and fading to 0 outside, as pbrt's ---- */

struct sr_medium_voxel { // around a point
    int32_t i[3];
    float f[3];     // [1] share of the voxel after
    bool is_inside; // all eight are in the grid
};

/* false: nothing is there. */
static inline bool sr_medium_voxel_find(const int32_t n[3], sr_vec3 unit, struct sr_medium_voxel *v)
{
    float s[3] = {unit.x * (float)n[0] - 0.5f, unit.y * (float)n[1] - 0.5f, unit.z * (float)n[2] - 0.5f};
    v->is_inside = true;
    for (int k = 0; k < 3; ++k) {
        if (!(s[k] > -1 && s[k] < (float)n[k]))
            return false;
        float whole = floorf(s[k]);
        v->i[k] = (int32_t)whole;
        v->f[k] = s[k] - whole;
        v->is_inside &= v->i[k] >= 0 && v->i[k] + 1 < n[k];
    }
    return true;
}
/* The place of corner c (bits: x, y, z) and its weight; false: outside. */
static inline bool sr_medium_voxel_corner(const int32_t n[3], const struct sr_medium_voxel *v, int c, size_t *place,
                                          float *weight)
{
    int32_t x = v->i[0] + (c & 1), y = v->i[1] + (c >> 1 & 1), z = v->i[2] + (c >> 2);
    *weight = (c & 1 ? v->f[0] : 1 - v->f[0]) * (c & 2 ? v->f[1] : 1 - v->f[1]) * (c & 4 ? v->f[2] : 1 - v->f[2]);
    *place = ((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x;
    return x >= 0 && x < n[0] && y >= 0 && y < n[1] && z >= 0 && z < n[2];
}
float sr_medium_grid_at(const float *values, const int32_t n[3], sr_vec3 unit);
/* The voxels that count between two corners of the cube: first … last along each axis. */
void sr_medium_grid_range(const int32_t n[3], const double lo[3], const double hi[3], int32_t first[3],
                          int32_t last[3]);
/* n[0] n[1] n[2] values of `what` are given, finite and not below `least`. */
sr_status sr_medium_grid_check(const char *what, struct sr_slice values, uint32_t each, const int32_t n[3], float least,
                               struct sr_error *error);
/* How many cells of majorants serve a box of n voxels best whose largest sigma_t is that [1/m]. */
void sr_medium_grid_cells(const int32_t n[3], float sigma_t, const struct sr_transform *medium_to_world, sr_vec3 p0,
                          sr_vec3 p1, int32_t cells[3]);
float sr_medium_grid_largest(struct sr_slice values); // of float, none below 0

#endif
