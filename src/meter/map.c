/* SPDX-License-Identifier: MIT */
/* An irradiance map: the mean irradiance of each cell of a rectangle's grid, or of a shape's texture coordinates.
 *
 *     E_ij = 1/A_ij INTEGRAL over the cell, INTEGRAL over the hemisphere of L cos(theta) dw dA      [lx], [W m^-2]
 *
 * Cell (i, j) is that of p + (i … i+1)/nx u + (j … j+1)/ny v, or where (u, v) = (i … i+1)/nx, (j … j+1)/ny. */
#include "meter/private.h"

struct map {
    struct sr_meter_common common;
    struct meter_surface_params surface;
    int32_t nx, ny;
};

static const struct sr_param params[] = {
    METER_SURFACE_ROWS(struct map, surface),
    {SR_PARAM_INT, "nx", "1", 1, 8192, 16, offsetof(struct map, nx), "cells along u"},
    {SR_PARAM_INT, "ny", "1", 1, 8192, 16, offsetof(struct map, ny), "cells along v"},
    {.name = NULL},
};

static sr_status prepare(void *self, const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error)
{
    struct map *m = self;
    if (m->surface.shape != METER_RECTANGLE)
        return sr_fail(error, SR_ERROR_INPUT,
                       "a map is made of a rectangle or of a named shape: expected \"string shape\" \"rectangle\"");
    return meter_surface_prepare(&m->common, &m->surface, t, arena, error);
}

static bool place_in(const void *self, uint32_t cell, sr_vec2 u, struct sr_meter_place *out)
{
    const struct map *m = self;
    uint32_t nx = (uint32_t)m->nx, i = cell % nx, j = cell / nx;
    struct sr_point x;
    if (!(m->common.surface.draw(m->common.surface.self,
                                 (sr_vec2){((float)i + u.x) / (float)nx, ((float)j + u.y) / (float)m->ny}, &x) > 0))
        return false;
    meter_place_on(&x, 1, out); // a mean over the cell
    return true;
}

static bool place(const void *self, sr_vec2 u, struct sr_meter_place *out)
{
    const struct map *m = self;
    struct sr_point x;
    float density = m->common.surface.draw(m->common.surface.self, u, &x);
    if (!(density > 0))
        return false;
    meter_place_on(&x, (float)(1 / ((double)density * m->common.surface.area)), out); // the mean over all
    return true;
}

static uint32_t cell_of(const void *self, const struct sr_meter_place *place)
{
    const struct map *m = self;
    sr_vec2 uv = place->x.uv;
    if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1))
        return UINT32_MAX;
    int32_t i = (int32_t)(uv.x * (float)m->nx), j = (int32_t)(uv.y * (float)m->ny);
    return (uint32_t)((j < m->ny ? j : m->ny - 1) * m->nx + (i < m->nx ? i : m->nx - 1));
}

static void raster(const void *self, uint32_t *width, uint32_t *height)
{
    const struct map *m = self;
    *width = (uint32_t)m->nx;
    *height = (uint32_t)m->ny;
}

static float response(const void *self, sr_vec3 wi)
{
    (void)self;
    return sr_max(wi.z, 0);
}
static float pdf(const void *self, sr_vec3 wi)
{
    (void)self;
    return sr_warp_cosine_hemisphere_pdf(wi.z);
}
static float sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    *wi = sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]});
    return pdf(self, *wi);
}
static double extent(const void *self)
{
    (void)self;
    return (double)SR_PI;
}

const struct sr_meter_model meter_irradiancemap = {
    .name = "irradiancemap",
    .what = "mean irradiance",
    .law = "∫ L cos θ dω, mean over the area",
    .suffix = "mean",
    .kind = SR_KIND_FLUX_DENSITY,
    .params = params,
    .size = sizeof(struct map),
    .wants_surface = true,
    .prepare = prepare,
    .place = place,
    .response = response,
    .sample = sample,
    .pdf = pdf,
    .extent = extent,
    .raster = raster,
    .place_in = place_in,
    .cell_of = cell_of,
};
