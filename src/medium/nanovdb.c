/* SPDX-License-Identifier: MIT */
/* Smoke, fire and clouds of films: densities and temperatures from NanoVDB files, where most of space is empty.
 *
 *     sigma_a = scale d(p) sigma_a(lambda),   sigma_s likewise     [1/m]
 *     Le = Lescale B(lambda, (T(p) - offset) factor)               [cd/m^2 times the share of its wavelength]
 *
 * d and T: linear between the values of the file's index space; B: Planck's law scaled to a maximum of 1, dark below
 * 100 K. The medium reaches as far as the boxes of both grids. Densities below 0, which filters leave, count as 0. */
#include "medium/private.h"
#include "medium/sparse.h"

#include <string.h>

struct nanovdb {
    struct sr_medium_common common;
    const char *filename, *gridname, *temperaturename;
    struct sr_spd sigma_a, sigma_s;
    float scale, g, Lescale, temperatureoffset, temperaturecutoff, temperaturescale;
    // derived
    struct sr_medium_box box;
    struct sr_sparse density, temperature;              // temperature.table NULL: none
    float density_index[3][4], temperature_index[3][4]; // from the world
    double lo[3], hi[3];                                // of the box [m]
    float offset;                                       // [K]
};

static const struct sr_param params[] = {
    {SR_PARAM_FILE, "filename", "1", 0, 0, 0, offsetof(struct nanovdb, filename),
     "NanoVDB file, plain, zipped or gzipped"},
    {SR_PARAM_STRING, "gridname", "1", 0, 0, 0, offsetof(struct nanovdb, gridname), "density"},
    {SR_PARAM_STRING, "temperaturename", "1", 0, 0, 0, offsetof(struct nanovdb, temperaturename), "temperature"},
    {SR_PARAM_UNBOUNDED, "sigma_a", "1/m", 0, INFINITY, 1, offsetof(struct nanovdb, sigma_a),
     "absorption coefficient where the density is 1"},
    {SR_PARAM_UNBOUNDED, "sigma_s", "1/m", 0, INFINITY, 1, offsetof(struct nanovdb, sigma_s),
     "scattering coefficient where the density is 1"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct nanovdb, scale), "factor of both"},
    {SR_PARAM_FLOAT, "g", "1", -SR_MEDIUM_MOST_G, SR_MEDIUM_MOST_G, 0, offsetof(struct nanovdb, g),
     "mean cosine of scattering, Henyey & Greenstein"},
    {SR_PARAM_FLOAT, "Lescale", "1", 0, INFINITY, 1, offsetof(struct nanovdb, Lescale), "factor of what glows"},
    {SR_PARAM_FLOAT, "temperatureoffset", "K", -INFINITY, INFINITY, NAN, offsetof(struct nanovdb, temperatureoffset),
     "subtracted from the temperatures"},
    {SR_PARAM_FLOAT, "temperaturecutoff", "K", -INFINITY, INFINITY, 0, offsetof(struct nanovdb, temperaturecutoff),
     "older name of temperatureoffset"},
    {SR_PARAM_FLOAT, "temperaturescale", "1", 0, INFINITY, 1, offsetof(struct nanovdb, temperaturescale),
     "factor of the temperatures, after that"},
    {.name = NULL},
};

/* From the world to the grid's index space: the medium's transform, then the file's map. */
static bool set_index(const struct sr_transform *medium_to_world, const struct sr_sparse *g, float out[3][4])
{
    const float(*m)[4] = medium_to_world->inverse;
    bool is_finite = true;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) {
            double sum = j == 3 ? g->to_index[i][3] : 0;
            for (int k = 0; k < 3; ++k)
                sum += g->to_index[i][k] * (double)m[k][j] / (double)m[3][3];
            out[i][j] = (float)sum;
            is_finite &= isfinite(out[i][j]) != 0;
        }
    return is_finite;
}

static inline sr_vec3 to_index(const float a[3][4], sr_vec3 p)
{
    return (sr_vec3){a[0][0] * p.x + a[0][1] * p.y + a[0][2] * p.z + a[0][3],
                     a[1][0] * p.x + a[1][1] * p.y + a[1][2] * p.z + a[1][3],
                     a[2][0] * p.x + a[2][1] * p.y + a[2][2] * p.z + a[2][3]};
}

/* The box in index space around a part of the medium's. */
static void index_box(const struct nanovdb *m, const double lo[3], const double hi[3], double index_lo[3],
                      double index_hi[3])
{
    for (int i = 0; i < 3; ++i) {
        index_lo[i] = index_hi[i] = m->density.to_index[i][3];
        for (int k = 0; k < 3; ++k) {
            double a = m->density.to_index[i][k], from = m->lo[k] + lo[k] * (m->hi[k] - m->lo[k]),
                   to = m->lo[k] + hi[k] * (m->hi[k] - m->lo[k]);
            index_lo[i] += fmin(a * from, a * to);
            index_hi[i] += fmax(a * from, a * to);
        }
    }
}

static float largest_density(const void *context, const double lo[3], const double hi[3])
{
    double index_lo[3], index_hi[3];
    index_box(context, lo, hi, index_lo, index_hi);
    return sr_sparse_largest(&((const struct nanovdb *)context)->density, index_lo, index_hi);
}

/* Cells of some voxels each; where the map is so oblique that the boxes around them would overlap too much, fewer. */
static void choose_cells(const struct nanovdb *m, int32_t cells[3])
{
    const double zero[3] = {0, 0, 0};
    double lo[3], hi[3];
    int32_t voxels[3];
    for (int k = 0; k < 3; ++k) { // along an edge of the box
        double square = 0;
        for (int i = 0; i < 3; ++i)
            square += m->density.to_index[i][k] * m->density.to_index[i][k];
        voxels[k] = (int32_t)fmin(fmax(sqrt(square) * (m->hi[k] - m->lo[k]), 1), 1 << 20);
    }
    sr_vec3 p0 = {(float)m->lo[0], (float)m->lo[1], (float)m->lo[2]},
            p1 = {(float)m->hi[0], (float)m->hi[1], (float)m->hi[2]};
    float sigma_t = largest_density(m, zero, (double[]){1, 1, 1}) * (sr_spd_max(&m->sigma_a) + sr_spd_max(&m->sigma_s));
    sr_medium_grid_cells(voxels, sigma_t, &m->common.medium_to_world, p0, p1, cells);
    for (;; cells[0] = cells[0] / 2 + 1, cells[1] = cells[1] / 2 + 1, cells[2] = cells[2] / 2 + 1) {
        double work = 1, there = 1;
        index_box(m, zero, (double[]){1.0 / cells[0], 1.0 / cells[1], 1.0 / cells[2]}, lo, hi);
        for (int k = 0; k < 3; ++k) {
            double span = 128.0 * m->density.n[k];
            work *= cells[k] * fmin(hi[k] - lo[k] + 2, span);
            there *= span;
        }
        if (work <= 64 * there || (cells[0] <= 2 && cells[1] <= 2 && cells[2] <= 2))
            break;
    }
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct nanovdb *m = self;
    const char *temperature = m->temperaturename ? m->temperaturename : "temperature";
    int32_t cells[3];
    if (!m->filename)
        return sr_fail(error, SR_ERROR_INPUT, "expected a parameter \"string filename\"");
    if (sr_sparse_read(m->filename, m->gridname ? m->gridname : "density", true, true, &m->density, arena, error) ||
        sr_sparse_read(m->filename, temperature,
                       m->temperaturename && m->temperaturename[0] && strcmp(temperature, "temperature") != 0, false,
                       &m->temperature, arena, error) ||
        sr_medium_scale(&m->sigma_a, &m->sigma_s, m->scale, error))
        return error->status;
    m->offset = isnan(m->temperatureoffset) ? m->temperaturecutoff : m->temperatureoffset;
    for (int k = 0; k < 3; ++k) { // as the box has them
        m->lo[k] =
            (double)(float)(m->temperature.table ? fmin(m->density.lo[k], m->temperature.lo[k]) : m->density.lo[k]);
        m->hi[k] =
            (double)(float)(m->temperature.table ? fmax(m->density.hi[k], m->temperature.hi[k]) : m->density.hi[k]);
    }
    choose_cells(m, cells);
    sr_vec3 lo = {(float)m->lo[0], (float)m->lo[1], (float)m->lo[2]},
            hi = {(float)m->hi[0], (float)m->hi[1], (float)m->hi[2]};
    if (sr_medium_box_set(&m->box, &m->common.medium_to_world, lo, hi, cells, arena, error))
        return error->status;
    if (!set_index(&m->common.medium_to_world, &m->density, m->density_index) ||
        (m->temperature.table && !set_index(&m->common.medium_to_world, &m->temperature, m->temperature_index)))
        return sr_fail(error, SR_ERROR_INPUT, "%s: its voxels are too small or too far away for single precision",
                       m->filename);
    sr_medium_box_fill(&m->box, largest_density, m);
    return SR_OK;
}

static void at(const void *self, sr_vec3 p, const struct sr_wavelengths *w, struct sr_medium_at *out)
{
    const struct nanovdb *m = self;
    float density = sr_sparse_at(&m->density, to_index((const float(*)[4])m->density_index, p));
    out->sigma_a = density * sr_spd_along(&m->sigma_a, w);
    out->sigma_s = density * sr_spd_along(&m->sigma_s, w);
    out->Le = SR_BLACK;
    out->g = m->g;
    if (m->temperature.table && m->Lescale > 0) {
        float temperature = sr_sparse_at(&m->temperature, to_index((const float(*)[4])m->temperature_index, p));
        out->Le =
            m->Lescale * sr_medium_blackbody((temperature - m->offset) * m->temperaturescale, m->common.is_absolute, w);
    }
}

static void begin(const void *self, sr_vec3 o, sr_vec3 d, float t_max, const struct sr_wavelengths *w,
                  struct sr_medium_walk *walk)
{
    const struct nanovdb *m = self;
    sr_medium_box_begin(&m->box, o, d, t_max, sr_spd_along(&m->sigma_a, w) + sr_spd_along(&m->sigma_s, w), walk);
}

static bool next(const void *self, struct sr_medium_walk *walk, struct sr_medium_segment *segment)
{
    (void)self;
    return sr_medium_box_next(walk, segment);
}

static bool glows(const void *self)
{
    const struct nanovdb *m = self;
    return m->temperature.table && m->Lescale > 0;
}

const struct sr_medium_model sr_medium_nanovdb = {
    .name = "nanovdb",
    .params = params,
    .size = sizeof(struct nanovdb),
    .prepare = prepare,
    .at = at,
    .begin = begin,
    .next = next,
    .glows = glows,
};
