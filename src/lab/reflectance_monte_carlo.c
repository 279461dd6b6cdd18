/* SPDX-License-Identifier: MIT */
/* Nicodemus' nine reflectances by drawing directions, with the standard error of the mean.
 *
 *     rho = E[ f cos theta_r / p(w_r) ],    w_i uniform in projected solid angle of the incident beam       [1]
 *
 * Where light is gathered over the hemisphere the specimen's own sampler draws w_r; over a cone, by turns the sampler
 * and a uniform density in the cone, weighed by the balance heuristic (Veach 1997, 9.2). Walks whose density nobody
 * knows are drawn on the hemisphere as they come; for a cone they are found by the uniform density alone. Delta lobes
 * count where they land. Random f gets a new seed for each sample. Single precision: what is systematic is below 1e-6.
 */
#include "lab/private.h"
#include "lab/reflect.h"

struct draw {
    const struct sr_specimen *specimen;
    struct sr_specimen_at at;
    struct lab_region from, to;
    struct sr_rng rng;
    uint32_t seed;
};

static double uniform(struct draw *d)
{
    return (double)sr_rng_float(&d->rng);
}

static sr_vec3 to_float(const double w[3])
{
    return (sr_vec3){(float)w[0], (float)w[1], (float)w[2]};
}

/* A direction of the region, and cos theta / density [sr]; its mean is the projected solid angle. */
static sr_vec3 draw_within(struct draw *d, const struct lab_region *r, double *weight)
{
    double w[3];
    *weight = 1;
    if (r->is_direction)
        return to_float(r->z);
    double u = uniform(d), beta = 2 * M_PI * uniform(d);
    if (r->is_hemisphere) { // in proportion to the cosine
        *weight = M_PI;
        sr_region_direction(r, asin(sqrt(u)), beta, w);
    } else {
        double s = sin(r->half / 2); // 1 - cos(half) = 2 s^2
        sr_region_direction(r, 2 * asin(s * sqrt(u)), beta, w);
        *weight = w[2] * 4 * M_PI * s * s;
    }
    return to_float(w);
}

static bool contains(const struct lab_region *r, sr_vec3 w)
{
    return sr_region_contains(r, (const double[3]){(double)w.x, (double)w.y, (double)w.z});
}

/* f between two directions; `known` is where the light comes from, or, if `reverse`, where it goes */
static sr_spectrum between(const struct draw *d, sr_vec3 known, sr_vec3 drawn, bool reverse)
{
    return reverse ? sr_bsdf_f(&d->at.bsdf, known, drawn, SR_RADIANCE)
                   : sr_bsdf_f(&d->at.bsdf, drawn, known, SR_RADIANCE);
}

/* One sample of INTEGRAL f cos theta d omega over the region, with the other direction known. */
static sr_spectrum gather(struct draw *d, sr_vec3 known, const struct lab_region *r, bool reverse)
{
    const struct sr_bsdf *b = &d->at.bsdf;
    if (r->is_direction)
        return between(d, known, to_float(r->z), reverse);
    double s = sin(r->half / 2), in_cone = 1 / (4 * M_PI * s * s); // [1/sr]
    bool by_sampler = r->is_hemisphere || uniform(d) < 0.5;
    double share = r->is_hemisphere ? 1 : 0.5;
    if (!by_sampler) {
        double weight;
        sr_vec3 w = draw_within(d, r, &weight);
        if (!(w.z > 0))
            return SR_BLACK;
        float pdf = b->model->is_random ? 0 : sr_bsdf_pdf(b, known, w, SR_RADIANCE);
        return between(d, known, w, reverse) * (float)((double)w.z / (share * (in_cone + (double)pdf)));
    }
    struct sr_bsdf_sample one;
    float u_lobe = sr_rng_float(&d->rng);
    sr_vec2 u = {sr_rng_float(&d->rng), sr_rng_float(&d->rng)};
    if (!sr_bsdf_sample(b, known, u_lobe, u, SR_RADIANCE, &one) || !(one.wi.z > 0) || !(one.pdf > 0) ||
        !contains(r, one.wi))
        return SR_BLACK;
    if ((one.lobe & SR_LOBE_SPECULAR) || (r->is_hemisphere && (b->model->is_random || one.pdf_is_proportional)))
        return one.f * (one.wi.z / (one.pdf * (float)share));
    if (b->model->is_random) // the uniform density alone sees these
        return SR_BLACK;
    double pdf = share * ((double)one.pdf + (r->is_hemisphere ? 0 : in_cone));
    return between(d, known, one.wi, reverse) * (float)((double)one.wi.z / pdf);
}

sr_status sr_reflectance_monte_carlo(const struct sr_specimen *specimen, sr_spectrum lambda, const struct sr_beam *from,
                                     const struct sr_beam *to, uint64_t samples, uint32_t seed,
                                     struct sr_reflectance *out, struct sr_error *error)
{
    if (sr_beam_check(from, error) != SR_OK || sr_beam_check(to, error) != SR_OK)
        return error->status;
    if (samples < 2)
        return sr_fail(error, SR_ERROR_USAGE, "%d samples: a standard error needs at least 2", (int)samples);
    struct draw d = {.specimen = specimen,
                     .from = sr_region_of(from),
                     .to = sr_region_of(to),
                     .rng = sr_rng_seed(seed, 0x7265666cu)};
    sr_reflectance_describe(from, to, out);
    sr_specimen_at(specimen, lambda, seed, &d.at);
    if ((sr_bsdf_lobes(&d.at.bsdf) & SR_LOBE_SPECULAR) && d.from.is_direction && d.to.is_direction)
        return sr_fail(
            error, SR_ERROR_USAGE,
            "%s reflects as a mirror: between two directions f may be a delta function; gather the light in a "
            "cone or the hemisphere",
            specimen->title);
    bool to_direction = d.to.is_direction && !d.from.is_direction; // then the sampler looks back along the beam
    struct sr_tally tally[SR_LAMBDA_COUNT] = {0};
    for (uint64_t n = 0; n < samples; ++n) {
        if (d.at.bsdf.model->is_random)
            sr_specimen_at(specimen, lambda, sr_hash_combine(seed, (uint32_t)n), &d.at);
        double weight = 1, incident = d.from.is_direction ? 1 : d.from.projected;
        sr_spectrum y;
        if (to_direction) {
            y = gather(&d, to_float(d.to.z), &d.from, true);
        } else {
            sr_vec3 wi = draw_within(&d, &d.from, &weight);
            y = wi.z > 0 ? gather(&d, wi, &d.to, false) : SR_BLACK;
        }
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
            sr_tally_add(&tally[l], (double)y[l] * weight / incident);
    }
    out->has_converged = true;
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
        out->value[l] = tally[l].mean;
        out->error[l] = sr_tally_standard_error(&tally[l]);
        out->has_converged &= isfinite(out->value[l]);
    }
    out->evaluations = samples;
    sr_reflectance_factor(out);
    return SR_OK;
}
