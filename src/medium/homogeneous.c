/* SPDX-License-Identifier: MIT */
/* The same medium everywhere: fog, milk, coloured glass.
 *
 *     sigma_t = scale (sigma_a + sigma_s) [1/m],     T(t) = exp(-sigma_t t)     (P. Bouguer 1729)
 *
 * It has no bounds: the surfaces around it, or the camera that stands in it, say where it is. The transform in force
 * does not scale its coefficients. */
#include "medium/private.h"

struct homogeneous {
    struct sr_medium_common common;
    struct sr_spd sigma_a, sigma_s, Le; // [1/m] [1/m] [cd/m^2 times the share of its wavelength]
    float scale, Lescale, g;
    const char *preset;
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "sigma_a", "1/m", 0, INFINITY, 1, offsetof(struct homogeneous, sigma_a),
     "absorption coefficient"},
    {SR_PARAM_UNBOUNDED, "sigma_s", "1/m", 0, INFINITY, 1, offsetof(struct homogeneous, sigma_s),
     "scattering coefficient"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct homogeneous, scale),
     "factor of both; presets are in 1/mm, so 1000 for scenes in metres"},
    {SR_PARAM_STRING, "preset", "1", 0, 0, 0, offsetof(struct homogeneous, preset), ""},
    {SR_PARAM_FLOAT, "g", "1", -SR_MEDIUM_MOST_G, SR_MEDIUM_MOST_G, 0, offsetof(struct homogeneous, g),
     "mean cosine of scattering, Henyey & Greenstein"},
    {SR_PARAM_ILLUMINANT, "Le", "cd/m^2", 0, INFINITY, NAN, offsetof(struct homogeneous, Le),
     "radiance where it is thick: it emits sigma_a Le on each metre"},
    {SR_PARAM_FLOAT, "Lescale", "1", 0, INFINITY, 1, offsetof(struct homogeneous, Lescale), "factor of Le"},
    {.name = NULL},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct homogeneous *m = self;
    if (m->preset && m->preset[0] && !sr_medium_preset(m->preset, &m->sigma_a, &m->sigma_s))
        return sr_fail(error, SR_ERROR_INPUT, "there is no preset \"%s\"", m->preset);
    if (sr_medium_scale(&m->sigma_a, &m->sigma_s, m->scale, error))
        return error->status;
    return sr_medium_set_emission(&m->Le, &m->common, m->Lescale, error);
}

static void at(const void *self, sr_vec3 p, const struct sr_wavelengths *w, struct sr_medium_at *out)
{
    (void)p;
    const struct homogeneous *m = self;
    out->sigma_a = sr_spd_along(&m->sigma_a, w);
    out->sigma_s = sr_spd_along(&m->sigma_s, w);
    out->Le = sr_spd_along(&m->Le, w);
    out->g = m->g;
}

static void begin(const void *self, sr_vec3 o, sr_vec3 d, float t_max, const struct sr_wavelengths *w,
                  struct sr_medium_walk *walk)
{
    (void)o, (void)d;
    const struct homogeneous *m = self;
    walk->t = 0;
    walk->t_max = t_max;
    walk->scale = sr_spd_along(&m->sigma_a, w) + sr_spd_along(&m->sigma_s, w);
}

static bool next(const void *self, struct sr_medium_walk *walk, struct sr_medium_segment *segment)
{
    (void)self;
    if (!(walk->t < walk->t_max))
        return false;
    *segment = (struct sr_medium_segment){.t0 = walk->t, .t1 = walk->t_max, .majorant = walk->scale};
    walk->t = walk->t_max;
    return true;
}

static bool glows(const void *self)
{
    return ((const struct homogeneous *)self)->Le.kind != SR_SPD_NONE;
}

const struct sr_medium_model sr_medium_homogeneous = {
    .name = "homogeneous",
    .params = params,
    .size = sizeof(struct homogeneous),
    .is_uniform = true,
    .prepare = prepare,
    .at = at,
    .begin = begin,
    .next = next,
    .glows = glows,
};
