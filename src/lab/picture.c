/* SPDX-License-Identifier: MIT */
/* The numbers behind pictures of a specimen: f of many pairs of directions, directional albedo, mirror lobes, colour.
 *
 *     E(w) = INTEGRAL f(w, wi) |cos_theta_i| d wi   [1],   by draws of wi: mean of f |cos_theta_i| / pdf
 *     XYZ  = SUM D65 (x, y, z)bar v / SUM D65 ybar  [1],   48 wavelengths
 *
 * Light that arrives from w is followed in the form for light paths (importance), so that what passes into another
 * medium counts as flux. Enough for the eye; sr_reflectance_cubature is for those who need digits. */
#include "lab/private.h"

void sr_specimen_f(const struct sr_specimen *specimen, sr_spectrum lambda, const sr_vec3 *wo, const sr_vec3 *wi,
                   size_t count, uint32_t seeds, sr_spectrum *f)
{
    struct sr_specimen_at at;
    for (uint32_t seed = 0; seed < (seeds ? seeds : 1); ++seed) {
        sr_specimen_at(specimen, lambda, seed, &at);
        for (size_t i = 0; i < count; ++i) {
            sr_spectrum one = sr_bsdf_f(&at.bsdf, wo[i], wi[i], SR_RADIANCE);
            f[i] = seed ? f[i] + (one - f[i]) * (1 / (float)(seed + 1)) : one;
        }
        if (!at.bsdf.model || !at.bsdf.model->is_random)
            break;
    }
}

struct sr_specimen_albedo sr_specimen_albedo(const struct sr_specimen *specimen, sr_spectrum lambda, sr_vec3 w,
                                             uint32_t draws)
{
    struct sr_specimen_albedo sum = {0};
    struct sr_specimen_at at;
    sr_specimen_at(specimen, lambda, 1, &at);
    for (uint32_t i = 0; i < draws; ++i) {
        struct sr_sampler sampler = sr_sampler_start(SR_SAMPLER_SOBOL, 1, 0, 0, 0, i);
        struct sr_bsdf_sample s;
        sr_u4 u = sr_sample4(&sampler, 0);
        if (at.bsdf.model->is_random)
            sr_specimen_at(specimen, lambda, i, &at); // another walk each time
        if (!sr_bsdf_sample(&at.bsdf, w, u[2], (sr_vec2){u[0], u[1]}, SR_IMPORTANCE, &s) || !(s.pdf > 0))
            continue;
        sr_spectrum weight = s.f * (sr_abs_cos_theta(s.wi) / (s.pdf * (float)draws));
        if (sr_same_hemisphere(w, s.wi))
            sum.reflected += weight;
        else
            sum.transmitted += weight;
    }
    return sum;
}

int sr_specimen_deltas(const struct sr_specimen *specimen, sr_spectrum lambda, sr_vec3 w,
                       struct sr_delta deltas[SR_DELTAS])
{
    enum { DRAWS = 256 };
    struct sr_specimen_at at;
    int count = 0;
    sr_specimen_at(specimen, lambda, 1, &at);
    if (!(sr_bsdf_lobes(&at.bsdf) & SR_LOBE_SPECULAR))
        return 0;
    for (uint32_t i = 0; i < DRAWS; ++i) {
        struct sr_sampler sampler = sr_sampler_start(SR_SAMPLER_SOBOL, 1, 0, 0, 0, i);
        struct sr_bsdf_sample s;
        sr_u4 u = sr_sample4(&sampler, 0);
        if (!sr_bsdf_sample(&at.bsdf, w, u[2], (sr_vec2){u[0], u[1]}, SR_IMPORTANCE, &s) ||
            !(s.lobe & SR_LOBE_SPECULAR) || !(s.pdf > 0))
            continue;
        int k = 0;
        while (k < count && sr_length(sr_sub(deltas[k].direction, s.wi)) > 1e-3f)
            ++k;
        if (k == SR_DELTAS)
            continue;
        if (k == count)
            deltas[count++] = (struct sr_delta){.direction = s.wi};
        deltas[k].albedo += s.f * (sr_abs_cos_theta(s.wi) / (s.pdf * DRAWS));
    }
    return count;
}

/* ---- colour ---- */

static const float first_nm = 384, step_nm = 8;
_Static_assert(48 % SR_LAMBDA_COUNT == 0, "48 wavelengths do not fill whole sets");

sr_spectrum sr_colour_lambda(int set)
{
    sr_spectrum lambda;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) // apart from each other, so that each set sees the whole range
        lambda[i] = first_nm + step_nm * (float)(i * SR_COLOUR_SETS + set);
    return lambda;
}

/* D65 times the observer, so that a white surface is white; the sum of 48 is off the integral's white by 1e-3. */
struct weights {
    double xyz[48][3];
};
static struct weights colour_weights(void)
{
    const struct sr_colour_space *srgb = sr_colour_space(SR_SRGB);
    struct sr_spd d65 = sr_spd_named("stdillum-D65");
    struct weights w;
    double sum[3] = {0};
    for (int k = 0; k < 48; ++k) {
        double nm = (double)first_nm + (double)step_nm * k;
        sr_observer_1931(nm, w.xyz[k]);
        for (int c = 0; c < 3; ++c) {
            w.xyz[k][c] *= (double)sr_spd_at(&d65, (float)nm);
            sum[c] += w.xyz[k][c];
        }
    }
    const double *xy = srgb->xy[3];
    const double white[3] = {xy[0] / xy[1], 1, (1 - xy[0] - xy[1]) / xy[1]};
    for (int k = 0; k < 48; ++k)
        for (int c = 0; c < 3; ++c)
            w.xyz[k][c] *= white[c] / sum[c];
    return w;
}

void sr_colour_add(int set, sr_spectrum values, double xyz[3])
{
    static _Thread_local struct weights weights;
    static _Thread_local bool is_known;
    if (!is_known)
        weights = colour_weights();
    is_known = true;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        for (int c = 0; c < 3; ++c)
            xyz[c] += weights.xyz[i * SR_COLOUR_SETS + set][c] * (double)values[i];
}
