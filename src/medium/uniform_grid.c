/* SPDX-License-Identifier: MIT */
/* Smoke and fire as a simulation leaves them: a density on a regular grid in a box.
 *
 *     sigma_a = scale d(p) sigma_a(lambda),   sigma_s likewise     [1/m]
 *     Le = Lescale(p) Le(lambda)   or   Lescale(p) B(lambda, (T(p) - offset) factor)
 *         [cd/m^2 times the share of its wavelength]
 *
 * B is Planck's law scaled to a maximum of 1; colder than 100 K it is dark. d, T and Lescale are linear between the
 * voxels (grid.c). Where no Lescale is given pbrt-v4 takes a grid of one voxel, which fades from the middle of the box
 * to an eighth at its corners; scene files get that. One value of Lescale for many voxels is a factor that does not
 * fade. */
#include "medium/private.h"

struct uniform_grid {
    struct sr_medium_common common;
    struct sr_slice density, temperature, Lescale; // of float
    int32_t nx, ny, nz;
    sr_vec3 p0, p1;
    struct sr_spd sigma_a, sigma_s, Le;
    float scale, g, temperatureoffset, temperaturecutoff, temperaturescale;
    // derived
    int32_t n[3];
    struct sr_medium_box box;
    const float *Lescale_values; // of Lescale_n voxels; NULL: constant
    int32_t Lescale_n[3];
    float Lescale_constant, offset; // [1] [K]
    bool has_temperature;
};

static const struct sr_param params[] = {
    {SR_PARAM_FLOATS, "density", "1", 0, INFINITY, 0, offsetof(struct uniform_grid, density),
     "of each voxel, x fastest"},
    {SR_PARAM_INT, "nx", "1", 1, INT32_MAX, 1, offsetof(struct uniform_grid, nx), "voxels along x"},
    {SR_PARAM_INT, "ny", "1", 1, INT32_MAX, 1, offsetof(struct uniform_grid, ny), "voxels along y"},
    {SR_PARAM_INT, "nz", "1", 1, INT32_MAX, 1, offsetof(struct uniform_grid, nz), "voxels along z"},
    {SR_PARAM_POINT3, "p0", "m", -INFINITY, INFINITY, 0, offsetof(struct uniform_grid, p0), "corner of the box"},
    {SR_PARAM_POINT3, "p1", "m", -INFINITY, INFINITY, 1, offsetof(struct uniform_grid, p1), "opposite corner"},
    {SR_PARAM_UNBOUNDED, "sigma_a", "1/m", 0, INFINITY, 1, offsetof(struct uniform_grid, sigma_a),
     "absorption coefficient where the density is 1"},
    {SR_PARAM_UNBOUNDED, "sigma_s", "1/m", 0, INFINITY, 1, offsetof(struct uniform_grid, sigma_s),
     "scattering coefficient where the density is 1"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct uniform_grid, scale), "factor of both"},
    {SR_PARAM_FLOAT, "g", "1", -SR_MEDIUM_MOST_G, SR_MEDIUM_MOST_G, 0, offsetof(struct uniform_grid, g),
     "mean cosine of scattering, Henyey & Greenstein"},
    {SR_PARAM_ILLUMINANT, "Le", "cd/m^2", 0, INFINITY, NAN, offsetof(struct uniform_grid, Le),
     "radiance where it is thick: it emits sigma_a Le on each metre"},
    {SR_PARAM_FLOATS, "Lescale", "1", 0, INFINITY, 0, offsetof(struct uniform_grid, Lescale),
     "factor of the emission of each voxel, or one for all"},
    {SR_PARAM_FLOATS, "temperature", "K", -INFINITY, INFINITY, 0, offsetof(struct uniform_grid, temperature),
     "of each voxel, which glows as a black body"},
    {SR_PARAM_FLOAT, "temperatureoffset", "K", -INFINITY, INFINITY, NAN,
     offsetof(struct uniform_grid, temperatureoffset), "subtracted from the temperatures"},
    {SR_PARAM_FLOAT, "temperaturecutoff", "K", -INFINITY, INFINITY, 0, offsetof(struct uniform_grid, temperaturecutoff),
     "older name of temperatureoffset"},
    {SR_PARAM_FLOAT, "temperaturescale", "1", 0, INFINITY, 1, offsetof(struct uniform_grid, temperaturescale),
     "factor of the temperatures, after that"},
    {.name = NULL},
};

static float largest_density(const void *context, const double lo[3], const double hi[3])
{
    const struct uniform_grid *m = context;
    const float *density = m->density.data;
    int32_t first[3], last[3];
    sr_medium_grid_range(m->n, lo, hi, first, last);
    float largest = 0;
    for (int32_t z = first[2]; z <= last[2]; ++z)
        for (int32_t y = first[1]; y <= last[1]; ++y) {
            const float *row = density + ((size_t)z * (size_t)m->n[1] + (size_t)y) * (size_t)m->n[0];
            for (int32_t x = first[0]; x <= last[0]; ++x)
                largest = sr_max(row[x], largest);
        }
    return largest;
}

static sr_status prepare_emission(struct uniform_grid *m, struct sr_error *error)
{
    static const float one[1] = {1};
    m->has_temperature = m->temperature.count > 0;
    if (m->has_temperature && m->Le.kind != SR_SPD_NONE)
        return sr_fail(error, SR_ERROR_INPUT, "\"Le\" and \"temperature\" exclude each other");
    if (m->has_temperature && sr_medium_grid_check("temperature", m->temperature, 1, m->n, -INFINITY, error))
        return error->status;
    m->offset = isnan(m->temperatureoffset) ? m->temperaturecutoff : m->temperatureoffset;
    m->Lescale_constant = 1;
    m->Lescale_values = one;
    for (int k = 0; k < 3; ++k)
        m->Lescale_n[k] = m->Lescale.count ? m->n[k] : 1;
    if (m->Lescale.count == 1 && m->density.count > 1) {
        m->Lescale_constant = *(const float *)m->Lescale.data;
        m->Lescale_values = NULL;
        if (!(m->Lescale_constant >= 0) || !isfinite(m->Lescale_constant))
            return sr_fail(error, SR_ERROR_INPUT, "\"Lescale\" is %g: expected finite values of 0 or more",
                           (double)m->Lescale_constant);
    } else if (m->Lescale.count) {
        if (sr_medium_grid_check("Lescale", m->Lescale, 1, m->n, 0, error))
            return error->status;
        m->Lescale_values = m->Lescale.data;
    }
    return sr_medium_set_emission(&m->Le, &m->common, 1, error);
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct uniform_grid *m = self;
    int32_t cells[3];
    for (int k = 0; k < 3; ++k)
        m->n[k] = k == 0 ? m->nx : k == 1 ? m->ny : m->nz;
    if (!m->density.count)
        return sr_fail(error, SR_ERROR_INPUT, "expected a parameter \"float density\"");
    if (sr_medium_grid_check("density", m->density, 1, m->n, 0, error) ||
        sr_medium_scale(&m->sigma_a, &m->sigma_s, m->scale, error) || prepare_emission(m, error))
        return error->status;
    float sigma_t = sr_medium_grid_largest(m->density) * (sr_spd_max(&m->sigma_a) + sr_spd_max(&m->sigma_s));
    sr_medium_grid_cells(m->n, sigma_t, &m->common.medium_to_world, m->p0, m->p1, cells);
    if (sr_medium_box_set(&m->box, &m->common.medium_to_world, m->p0, m->p1, cells, arena, error))
        return error->status;
    sr_medium_box_fill(&m->box, largest_density, m);
    return SR_OK;
}

static sr_spectrum emission(const struct uniform_grid *m, sr_vec3 unit, const struct sr_wavelengths *w)
{
    float scale = m->Lescale_values ? sr_medium_grid_at(m->Lescale_values, m->Lescale_n, unit) : m->Lescale_constant;
    if (!(scale > 0))
        return SR_BLACK;
    if (!m->has_temperature)
        return scale * sr_spd_along(&m->Le, w);
    float temperature = sr_medium_grid_at(m->temperature.data, m->n, unit);
    return scale * sr_medium_blackbody((temperature - m->offset) * m->temperaturescale, m->common.is_absolute, w);
}

static void at(const void *self, sr_vec3 p, const struct sr_wavelengths *w, struct sr_medium_at *out)
{
    const struct uniform_grid *m = self;
    sr_vec3 unit = sr_medium_box_unit(&m->box, p);
    float density = sr_medium_grid_at(m->density.data, m->n, unit);
    out->sigma_a = density * sr_spd_along(&m->sigma_a, w);
    out->sigma_s = density * sr_spd_along(&m->sigma_s, w);
    out->Le = m->has_temperature || m->Le.kind != SR_SPD_NONE ? emission(m, unit, w) : SR_BLACK;
    out->g = m->g;
}

static void begin(const void *self, sr_vec3 o, sr_vec3 d, float t_max, const struct sr_wavelengths *w,
                  struct sr_medium_walk *walk)
{
    const struct uniform_grid *m = self;
    sr_medium_box_begin(&m->box, o, d, t_max, sr_spd_along(&m->sigma_a, w) + sr_spd_along(&m->sigma_s, w), walk);
}

static bool next(const void *self, struct sr_medium_walk *walk, struct sr_medium_segment *segment)
{
    (void)self;
    return sr_medium_box_next(walk, segment);
}

static bool glows(const void *self)
{
    const struct uniform_grid *m = self;
    return m->has_temperature || m->Le.kind != SR_SPD_NONE;
}

const struct sr_medium_model sr_medium_uniform_grid = {
    .name = "uniformgrid",
    .params = params,
    .size = sizeof(struct uniform_grid),
    .prepare = prepare,
    .at = at,
    .begin = begin,
    .next = next,
    .glows = glows,
};
