/* SPDX-License-Identifier: MIT */
/* A goniophotometer: the intensity of everything that leaves the scene, by C-planes and gamma, from infinitely far.
 *
 *     I(C, gamma) = flux into the cell / solid angle of the cell                  [cd], [W/sr]
 *
 * Cells are centred on the planes C = 0, dC, … and on gamma = 0, dgamma, …, 180 deg; at the two poles one cell is what
 * all planes share. gamma is counted from the axis (given none: -z, down), C from `facing` (+x) toward axis x facing
 * turned around, that is, seen against the axis, against the clock: with the axis -z, C 90 is +y, as IES and EULUMDAT
 * files have it. CIE 121-1996. Limits: I is the mean over a cell, which rounds off peaks narrower than it. */
#include "meter/private.h"

struct intensity {
    struct sr_meter_common common;
    sr_vec3 axis, facing;     // [1]
    float c_step, gamma_step; // [deg]
    // derived
    struct sr_frame frame; // x: C 0, y: C 90, z: against gamma 0
    uint32_t planes, rows;
};

#define MEMBER(m) offsetof(struct intensity, m)
static const struct sr_param params[] = {
    {SR_PARAM_VECTOR3, "axis", "1", 0, 0, NAN, MEMBER(axis), "where gamma is 0; none: -z"},
    {SR_PARAM_VECTOR3, "facing", "1", 0, 0, NAN, MEMBER(facing), "where C is 0, square to the axis; none: +x"},
    {SR_PARAM_FLOAT, "cstep", "deg", 0.5, 360, 15, MEMBER(c_step), "between planes; divides 360"},
    {SR_PARAM_FLOAT, "gammastep", "deg", 0.25, 90, 5, MEMBER(gamma_step), "between angles; divides 180"},
    {.name = NULL},
};

static bool divides(double whole, float step, uint32_t *count)
{
    double n = whole / (double)step;
    *count = (uint32_t)(n + 0.5);
    return fabs(n - *count) < 1e-4;
}

static sr_status prepare(void *self, const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct intensity *m = self;
    sr_vec3 axis = sr_transform_vector(t, isnan(m->axis.x) ? (sr_vec3){0, 0, -1} : m->axis);
    sr_vec3 facing = sr_transform_vector(t, isnan(m->facing.x) ? (sr_vec3){1, 0, 0} : m->facing);
    if (meter_direction("axis", &axis, error) != SR_OK || meter_direction("facing", &facing, error) != SR_OK)
        return error->status;
    if (sr_length(sr_cross(axis, facing)) < 1e-3f)
        return sr_fail(error, SR_ERROR_INPUT, "\"facing\" is along the axis: expected a direction square to it");
    if (!divides(360, m->c_step, &m->planes) || !divides(180, m->gamma_step, &m->rows))
        return sr_fail(error, SR_ERROR_INPUT, "\"cstep\" %g must divide 360 and \"gammastep\" %g must divide 180",
                       (double)m->c_step, (double)m->gamma_step);
    m->rows += 1;
    m->frame = sr_frame_from_zx(sr_neg(axis), facing);
    return SR_OK;
}

static void raster(const void *self, uint32_t *width, uint32_t *height)
{
    const struct intensity *m = self;
    *width = m->planes;
    *height = m->rows;
}

static uint32_t far(const void *self, sr_vec3 w)
{
    const struct intensity *m = self;
    sr_vec3 d = sr_to_local(&m->frame, w);
    double gamma = atan2((double)sqrtf(d.x * d.x + d.y * d.y), -(double)d.z) * (180 / 3.14159265358979323846);
    double c = (double)sr_angle_of(d.y, d.x) * (180 / 3.14159265358979323846);
    uint32_t row = (uint32_t)(gamma / (double)m->gamma_step + 0.5),
             plane = (uint32_t)(c / (double)m->c_step + 0.5) % m->planes;
    row = row < m->rows ? row : m->rows - 1;
    return row == 0 || row == m->rows - 1 ? row * m->planes : row * m->planes + plane;
}

static double cell(const void *self, uint32_t index, double *c_deg, double *gamma_deg)
{
    const struct intensity *m = self;
    uint32_t row = index / m->planes;
    const double degree = 3.14159265358979323846 / 180, step = (double)m->gamma_step;
    *gamma_deg = row * step;
    *c_deg = index % m->planes * (double)m->c_step;
    double ring = 2 * 3.14159265358979323846 *
                  (cos(fmax(0, *gamma_deg - step / 2) * degree) - cos(fmin(180, *gamma_deg + step / 2) * degree));
    return row == 0 || row == m->rows - 1 ? ring : ring / m->planes;
}

static bool place(const void *self, sr_vec2 u, struct sr_meter_place *out)
{
    (void)self, (void)u, (void)out;
    return false;
}
static float response(const void *self, sr_vec3 wi)
{
    (void)self, (void)wi;
    return 0;
}
static float sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    (void)self, (void)u, (void)wi;
    return 0;
}
static double extent(const void *self)
{
    (void)self;
    return 0;
}

const struct sr_meter_model meter_intensity = {
    .name = "intensity",
    .what = "flux that leaves the scene, and its intensity distribution",
    .law = "∫ I dω, I = dΦ/dω in the far field",
    .suffix = "",
    .kind = SR_KIND_FLUX,
    .params = params,
    .size = sizeof(struct intensity),
    .prepare = prepare,
    .place = place,
    .response = response,
    .sample = sample,
    .pdf = response,
    .extent = extent,
    .raster = raster,
    .far = far,
    .cell = cell,
};
