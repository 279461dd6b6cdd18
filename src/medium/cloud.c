/* SPDX-License-Identifier: MIT */
/* A cloud out of noise, lit from above, flat below (pbrt-v4's).
 *
 *     q   = frequency p,   twice:  q += v DN(10 * 1.99^i q),   v = 0.05 wispiness / 2^i,  i = 0, 1
 *     d   = sum over i = 0 … 4 of 2^(-1-i) N(1.99^i q)
 *     density(p) = clamp(clamp(4.5 (1 - y) density d, 0, 1) + 2 max(0, 1/2 - y), 0, 1)                    [1]
 *
 * p in the medium's space, N: Perlin's noise (2002), DN its differences over 0.01 divided by that. The majorant is what
 * the density cannot exceed at a height y, as |N| <= 1.05. */
#include "medium/private.h"

struct cloud {
    struct sr_medium_common common;
    struct sr_spd sigma_a, sigma_s;
    float density, wispiness, frequency, g;
    sr_vec3 p0, p1;
    struct sr_medium_box box;
};

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "density", "1", 0, INFINITY, 1, offsetof(struct cloud, density),
     "factor of the noise: how much of the box is cloud"},
    {SR_PARAM_FLOAT, "wispiness", "1", -INFINITY, INFINITY, 1, offsetof(struct cloud, wispiness),
     "how far finer noise displaces the cloud; none: not above 0"},
    {SR_PARAM_FLOAT, "frequency", "1/m", -INFINITY, INFINITY, 5, offsetof(struct cloud, frequency),
     "of the coarsest noise"},
    {SR_PARAM_FLOAT, "g", "1", -SR_MEDIUM_MOST_G, SR_MEDIUM_MOST_G, 0, offsetof(struct cloud, g),
     "mean cosine of scattering, Henyey & Greenstein"},
    {SR_PARAM_UNBOUNDED, "sigma_a", "1/m", 0, INFINITY, 1, offsetof(struct cloud, sigma_a),
     "absorption coefficient where the density is 1"},
    {SR_PARAM_UNBOUNDED, "sigma_s", "1/m", 0, INFINITY, 1, offsetof(struct cloud, sigma_s),
     "scattering coefficient where the density is 1"},
    {SR_PARAM_POINT3, "p0", "m", -INFINITY, INFINITY, 0, offsetof(struct cloud, p0), "corner of the box"},
    {SR_PARAM_POINT3, "p1", "m", -INFINITY, INFINITY, 1, offsetof(struct cloud, p1), "opposite corner"},
    {.name = NULL},
};

static float density_at_height(const struct cloud *m, float y, float noise)
{
    float d = sr_clamp((1 - y) * 4.5f * m->density * noise, 0, 1);
    return sr_clamp(d + 2 * sr_max(0, 0.5f - y), 0, 1);
}

static float largest_density(const void *context, const double lo[3], const double hi[3])
{
    const struct cloud *m = context;
    // it falls with the height, where noise is above 0; above the height 1 noise below 0 counts
    float most_noise = 1.05f * 0.96875f;
    float bottom = sr_min(m->p0.y, m->p1.y), extent = fabsf(m->p1.y - m->p0.y);
    float y0 = bottom + (float)lo[1] * extent, y1 = bottom + (float)hi[1] * extent;
    return sr_max(density_at_height(m, y0, most_noise), density_at_height(m, y1, -most_noise));
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct cloud *m = self;
    const int32_t cells[3] = {1, 32, 1};
    if (!isfinite(m->density) || !isfinite(m->wispiness) || !isfinite(m->frequency))
        return sr_fail(error, SR_ERROR_INPUT, "\"density\", \"wispiness\" and \"frequency\" must be finite");
    if (sr_medium_scale(&m->sigma_a, &m->sigma_s, 1, error) ||
        sr_medium_box_set(&m->box, &m->common.medium_to_world, m->p0, m->p1, cells, arena, error))
        return error->status;
    sr_medium_box_fill(&m->box, largest_density, m);
    return SR_OK;
}

static sr_vec3 noise_slope(sr_vec3 p)
{
    const float step = 0.01f;
    float n = sr_noise(p);
    return (sr_vec3){(sr_noise((sr_vec3){p.x + step, p.y, p.z}) - n) / step,
                     (sr_noise((sr_vec3){p.x, p.y + step, p.z}) - n) / step,
                     (sr_noise((sr_vec3){p.x, p.y, p.z + step}) - n) / step};
}

static float density_of(const struct cloud *m, sr_vec3 p)
{
    const float finer = 1.99f;
    sr_vec3 q = sr_scale(m->frequency, p);
    if (m->wispiness > 0) {
        float height = 0.05f * m->wispiness, frequency = 10;
        for (int i = 0; i < 2; ++i, height *= 0.5f, frequency *= finer)
            q = sr_mad(q, height, noise_slope(sr_scale(frequency, q)));
    }
    float noise = 0, height = 0.5f, frequency = 1;
    for (int i = 0; i < 5; ++i, height *= 0.5f, frequency *= finer)
        noise += height * sr_noise(sr_scale(frequency, q));
    return density_at_height(m, p.y, noise);
}

static void at(const void *self, sr_vec3 p, const struct sr_wavelengths *w, struct sr_medium_at *out)
{
    const struct cloud *m = self;
    float density = density_of(m, sr_inverse_point(&m->common.medium_to_world, p));
    out->sigma_a = density * sr_spd_along(&m->sigma_a, w);
    out->sigma_s = density * sr_spd_along(&m->sigma_s, w);
    out->Le = SR_BLACK;
    out->g = m->g;
}

static void begin(const void *self, sr_vec3 o, sr_vec3 d, float t_max, const struct sr_wavelengths *w,
                  struct sr_medium_walk *walk)
{
    const struct cloud *m = self;
    sr_medium_box_begin(&m->box, o, d, t_max, sr_spd_along(&m->sigma_a, w) + sr_spd_along(&m->sigma_s, w), walk);
}

static bool next(const void *self, struct sr_medium_walk *walk, struct sr_medium_segment *segment)
{
    (void)self;
    return sr_medium_box_next(walk, segment);
}

static bool glows(const void *self)
{
    (void)self;
    return false;
}

const struct sr_medium_model sr_medium_cloud = {
    .name = "cloud",
    .params = params,
    .size = sizeof(struct cloud),
    .prepare = prepare,
    .at = at,
    .begin = begin,
    .next = next,
    .glows = glows,
};
