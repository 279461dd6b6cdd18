/* SPDX-License-Identifier: MIT */
/* Coloured smoke: both coefficients, and the emission, as rgb on a regular grid in a box.
 *
 *     sigma_a(p, lambda) = scale sum over the eight voxels around p of w_i s(rgb_i, lambda)   [1/m],   sigma_s likewise
 *     Le = Lescale sum of w_i s(rgb_i, lambda) white(lambda)                 [cd/m^2 times the share of its wavelength]
 *
 * s: the spectra of rgb (Jakob & Hanika 2019), interpolated as spectra (pbrt-v4). A coefficient that is not given is 1
 * in all of the box. The white is the colour space's illuminant with the numbers of its table, about 100, as pbrt-v4
 * has it: rgb (1, 1, 1) of sRGB is 10567 cd/m^2; Lescale makes of it what is wanted. */
#include "medium/private.h"

struct colour { // scale times sigmoid
    struct sr_sigmoid sigmoid;
    float scale;
};

struct rgb_grid {
    struct sr_medium_common common;
    struct sr_slice sigma_a, sigma_s, Le; // of struct sr_rgb, until they are spectra
    int32_t nx, ny, nz;
    sr_vec3 p0, p1;
    float scale, g, Lescale;
    // derived
    int32_t n[3];
    struct sr_medium_box box;
    const struct colour *a, *s, *e; // of each voxel [1/m] [1/m] [1]; NULL: 1, 1, 0
    struct sr_spd white;
};

static const struct sr_param params[] = {
    {SR_PARAM_RGBS, "sigma_a", "1/m", 0, INFINITY, 0, offsetof(struct rgb_grid, sigma_a),
     "absorption coefficient of each voxel, x fastest"},
    {SR_PARAM_RGBS, "sigma_s", "1/m", 0, INFINITY, 0, offsetof(struct rgb_grid, sigma_s),
     "scattering coefficient of each voxel"},
    {SR_PARAM_RGBS, "Le", "10567 cd/m^2", 0, INFINITY, 0, offsetof(struct rgb_grid, Le),
     "radiance of each voxel where it is thick, in units of the table of the colour space's white"},
    {SR_PARAM_INT, "nx", "1", 1, INT32_MAX, 1, offsetof(struct rgb_grid, nx), "voxels along x"},
    {SR_PARAM_INT, "ny", "1", 1, INT32_MAX, 1, offsetof(struct rgb_grid, ny), "voxels along y"},
    {SR_PARAM_INT, "nz", "1", 1, INT32_MAX, 1, offsetof(struct rgb_grid, nz), "voxels along z"},
    {SR_PARAM_POINT3, "p0", "m", -INFINITY, INFINITY, 0, offsetof(struct rgb_grid, p0), "corner of the box"},
    {SR_PARAM_POINT3, "p1", "m", -INFINITY, INFINITY, 1, offsetof(struct rgb_grid, p1), "opposite corner"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct rgb_grid, scale), "factor of both coefficients"},
    {SR_PARAM_FLOAT, "g", "1", -SR_MEDIUM_MOST_G, SR_MEDIUM_MOST_G, 0, offsetof(struct rgb_grid, g),
     "mean cosine of scattering, Henyey & Greenstein"},
    {SR_PARAM_FLOAT, "Lescale", "1", 0, INFINITY, 1, offsetof(struct rgb_grid, Lescale), "factor of Le"},
    {.name = NULL},
};

static float colour_max(const struct colour *c)
{
    struct sr_spd s = {.kind = SR_SPD_SIGMOID, .scale = c->scale, .sigmoid = c->sigmoid};
    return c->scale > 0 ? sr_spd_max(&s) : 0;
}

static float largest_of(const struct colour *colours, const int32_t n[3], const int32_t first[3], const int32_t last[3])
{
    float largest = 0;
    for (int32_t z = first[2]; z <= last[2]; ++z)
        for (int32_t y = first[1]; y <= last[1]; ++y)
            for (int32_t x = first[0]; x <= last[0]; ++x)
                largest = sr_max(
                    colour_max(&colours[((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x]), largest);
    return largest;
}

static float largest_sigma_t(const void *context, const double lo[3], const double hi[3])
{
    const struct rgb_grid *m = context;
    int32_t first[3], last[3];
    sr_medium_grid_range(m->n, lo, hi, first, last);
    return (m->a ? largest_of(m->a, m->n, first, last) : m->scale) +
           (m->s ? largest_of(m->s, m->n, first, last) : m->scale);
}

/* The rgb of the file, which end with the import, as spectra times `factor`. */
static sr_status to_spectra(const struct rgb_grid *m, const char *what, struct sr_slice *from, float factor,
                            const struct colour **to, struct sr_arena *arena, struct sr_error *error)
{
    if (!from->count)
        return SR_OK;
    if (sr_medium_grid_check(what, *from, 3, m->n, 0, error))
        return error->status;
    struct colour *colours = sr_arena_alloc(arena, from->count * sizeof *colours);
    if (!colours)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for \"%s\" of a medium", what);
    for (uint32_t i = 0; i < from->count; ++i) {
        struct sr_spd s = sr_spd_from_rgb_unbounded(m->common.space, ((const struct sr_rgb *)from->data)[i]);
        colours[i] = (struct colour){s.sigmoid, s.scale * factor}; // of black the scale is 0
        if (!isfinite(colours[i].scale))
            return sr_fail(error, SR_ERROR_INPUT, "\"%s\" of voxel %u is not finite", what, i);
    }
    *to = colours;
    *from = (struct sr_slice){0};
    return SR_OK;
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct rgb_grid *m = self;
    int32_t cells[3];
    for (int k = 0; k < 3; ++k)
        m->n[k] = k == 0 ? m->nx : k == 1 ? m->ny : m->nz;
    if (!m->sigma_a.count && !m->sigma_s.count)
        return sr_fail(error, SR_ERROR_INPUT, "expected a parameter \"rgb sigma_a\" or \"rgb sigma_s\"");
    if (m->Le.count && !m->sigma_a.count)
        return sr_fail(error, SR_ERROR_INPUT, "what glows absorbs: \"rgb Le\" needs \"rgb sigma_a\"");
    m->white = (struct sr_spd){.kind = SR_SPD_TABLE, .scale = 1, .table = sr_colour_space(m->common.space)->illuminant};
    if (to_spectra(m, "sigma_a", &m->sigma_a, m->scale, &m->a, arena, error) ||
        to_spectra(m, "sigma_s", &m->sigma_s, m->scale, &m->s, arena, error) ||
        to_spectra(m, "Le", &m->Le, m->Lescale, &m->e, arena, error))
        return error->status;
    const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    sr_medium_grid_cells(m->n, largest_sigma_t(m, zero, one), &m->common.medium_to_world, m->p0, m->p1, cells);
    if (sr_medium_box_set(&m->box, &m->common.medium_to_world, m->p0, m->p1, cells, arena, error))
        return error->status;
    sr_medium_box_fill(&m->box, largest_sigma_t, m);
    return SR_OK;
}

static sr_spectrum sum(const struct colour *colours, const size_t *places, const float *weights, int count,
                       sr_spectrum lambda)
{
    sr_spectrum s = SR_BLACK;
    for (int c = 0; c < count; ++c) {
        const struct colour *colour = &colours[places[c]];
        if (colour->scale > 0)
            s += weights[c] * colour->scale * sr_sigmoid_eval(colour->sigmoid, lambda);
    }
    return s;
}

static void at(const void *self, sr_vec3 p, const struct sr_wavelengths *w, struct sr_medium_at *out)
{
    const struct rgb_grid *m = self;
    struct sr_medium_voxel v;
    size_t places[8];
    float weights[8];
    int count = 0;
    if (sr_medium_voxel_find(m->n, sr_medium_box_unit(&m->box, p), &v))
        for (int c = 0; c < 8; ++c)
            count += sr_medium_voxel_corner(m->n, &v, c, &places[count], &weights[count]);
    out->sigma_a = m->a ? sum(m->a, places, weights, count, w->lambda) : SR_BLACK + m->scale;
    out->sigma_s = m->s ? sum(m->s, places, weights, count, w->lambda) : SR_BLACK + m->scale;
    out->Le = m->e ? sum(m->e, places, weights, count, w->lambda) * sr_spd_along(&m->white, w) : SR_BLACK;
    out->g = m->g;
}

static void begin(const void *self, sr_vec3 o, sr_vec3 d, float t_max, const struct sr_wavelengths *w,
                  struct sr_medium_walk *walk)
{
    (void)w;
    const struct rgb_grid *m = self;
    sr_medium_box_begin(&m->box, o, d, t_max, SR_ONE, walk);
}

static bool next(const void *self, struct sr_medium_walk *walk, struct sr_medium_segment *segment)
{
    (void)self;
    return sr_medium_box_next(walk, segment);
}

static bool glows(const void *self)
{
    const struct rgb_grid *m = self;
    return m->e && m->Lescale > 0;
}

const struct sr_medium_model sr_medium_rgb_grid = {
    .name = "rgbgrid",
    .params = params,
    .size = sizeof(struct rgb_grid),
    .prepare = prepare,
    .at = at,
    .begin = begin,
    .next = next,
    .glows = glows,
};
