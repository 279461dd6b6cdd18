/* SPDX-License-Identifier: MIT */
/* A gonioreflectometer without a bench: light of a parallel beam is followed until it leaves the specimen, and sorted
 * by the direction in which it does.
 *
 *     f(wi, wo) = dPhi_o / (Phi_i cos theta_o dw_o)      [1/sr], the mean over a cell of directions
 *
 * Paths are those of light (importance transport): they scatter as the materials' own draws say, so that mirrors and
 * glass are no exception, and end by escape, by absorption, or by lot once they carry little. Each replicate is a
 * scrambled net of its own; their scatter tells the errors. M. Ashikhmin, S. Premoze, P. Shirley, A microfacet-based
 * BRDF generator, 2000, for the idea of BRDFs made of geometry. Limits: far field; what a finite specimen loses at its
 * sides counts as leaving. */
#include "render/render.h"

#include <string.h>

enum { MAX_SCATTERINGS = 1000, GROUP_WALK = 2 };
static const double pi = 3.14159265358979323846;

/* Follows light that carries beta; *d becomes the direction in which it leaves. false: it does not. */
static bool follow(const struct sr_scene *scene, struct sr_ray ray, const struct sr_sampler *sampler,
                   struct sr_wavelengths *w, sr_spectrum *beta, sr_vec3 *d, bool *has_hit)
{
    float begun_with = sr_spectrum_max(*beta);
    *has_hit = false;
    for (uint32_t count = 0, passed = 0; count < MAX_SCATTERINGS && passed < MAX_SCATTERINGS;) {
        struct sr_hit hit;
        if (!sr_raycast(scene, &ray, &hit)) {
            *d = ray.d;
            return true;
        }
        uint32_t group = GROUP_WALK + 2 * count;
        sr_u4 u = sr_sample4(sampler, group), v = sr_sample4(sampler, group + 1);
        struct sr_bsdf bsdf = {.model = NULL};
        struct sr_frame frame;
        sr_vec3 back = sr_neg(ray.d);
        if (hit.material)
            sr_material_shade(hit.material, &hit.point, back, u[3],
                              sr_hash_combine(sampler->key + sampler->sample, group), w, &bsdf, &frame);
        if (!bsdf.model) {
            ++passed;
            ray = sr_leave(&hit.point, ray.d);
            continue;
        }
        *has_hit = true;
        ++count;
        sr_vec3 local = sr_to_local(&frame, back);
        struct sr_bsdf_sample s;
        if (local.z == 0 || !sr_bsdf_sample(&bsdf, local, u[2], (sr_vec2){u[0], u[1]}, SR_IMPORTANCE, &s))
            return false;
        sr_vec3 out = sr_to_world(&frame, s.wi);
        sr_spectrum f = s.f;
        if (bsdf.model->asymmetry > 0 && !(s.lobe & SR_LOBE_SPECULAR) && !s.pdf_is_proportional)
            f = sr_bsdf_f(&bsdf, s.wi, local, SR_RADIANCE);
        // the adjoint of what shading normals do to paths of a camera (Veach 1997, 5.3)
        float cos_back = fabsf(sr_dot(hit.point.n, back));
        if (!(cos_back > 0))
            return false;
        *beta *= f * (sr_abs_cos_theta(local) / cos_back * fabsf(sr_dot(hit.point.n, out)) / s.pdf);
        ray = sr_leave(&hit.point, out);
        float carried = sr_spectrum_max(*beta) / begun_with;
        if (!(carried > 0))
            return false;
        if (carried < 1 && count > 3) {
            float survive = sr_max(carried, 0.05f);
            if (v[0] >= survive)
                return false;
            *beta *= 1 / survive;
        }
    }
    return false;
}

/* Mean and standard error of the mean of `replicates` rows of numbers; both may be the same as the first row. */
static void mean_of(const double *rows, size_t count, uint32_t replicates, double *mean, double *error)
{
    for (size_t i = 0; i < count; ++i) {
        struct sr_tally t = {0};
        for (uint32_t r = 0; r < replicates; ++r)
            sr_tally_add(&t, rows[r * count + i]);
        mean[i] = t.mean;
        error[i] = sr_tally_standard_error(&t);
    }
}

/* ---- a beam on a patch ---- */

struct scatter_run {
    const struct sr_gonio *g;
    const struct sr_gonio_beam *beam;
    float height; // [m] above which nothing is
    size_t cells;
    double *rows; // of each replicate: cells * SR_LAMBDA_COUNT, then reflected, transmitted, missed
};
enum { EXTRA = 2 * SR_LAMBDA_COUNT + 1 };

static size_t cell_of(const struct sr_gonio_beam *b, sr_vec3 d, float phi_i)
{
    double theta = atan2(hypot((double)d.x, (double)d.y), (double)d.z), phi = atan2((double)d.y, (double)d.x);
    if (b->is_isotropic) {
        phi = fabs(remainder(phi - (double)phi_i, 2 * pi)) / pi; // the difference of azimuths, folded
    } else
        phi = (phi < 0 ? phi + 2 * pi : phi) / (2 * pi);
    uint32_t i = (uint32_t)(theta / (pi / 2) * b->theta_count), j = (uint32_t)(phi * b->phi_count);
    return (size_t)(i < b->theta_count ? i : b->theta_count - 1) * b->phi_count +
           (j < b->phi_count ? j : b->phi_count - 1);
}

static void scatter_replicate(void *context, uint64_t replicate)
{
    const struct scatter_run *run = context;
    const struct sr_gonio_beam *b = run->beam;
    size_t count = run->cells * SR_LAMBDA_COUNT + EXTRA;
    double *row = run->rows + replicate * count, *extra = row + run->cells * SR_LAMBDA_COUNT;
    struct sr_box box = sr_scene_bounds(run->g->scene);
    float far = 2 * sr_length(sr_sub(box.hi, box.lo)) + 1;
    for (uint32_t k = 0; k < run->g->samples; ++k) {
        struct sr_sampler sampler =
            sr_sampler_start(SR_SAMPLER_SOBOL, run->g->seed, b->stream, 0, (uint32_t)replicate, k);
        sr_u4 u = sr_sample4(&sampler, 0);
        // every wavelength leads as often as any other: where dispersion ends the rest, the leader stands for all of
        // its share
        uint32_t shift = (uint32_t)(u[3] * SR_LAMBDA_COUNT) % SR_LAMBDA_COUNT;
        struct sr_wavelengths w = {.pdf = SR_ONE};
        for (uint32_t i = 0; i < SR_LAMBDA_COUNT; ++i)
            w.lambda[i] = b->lambda[(i + shift) % SR_LAMBDA_COUNT];
        float phi_i = b->phi_i + (b->is_isotropic ? 2 * SR_PI * u[2] : 0);
        sr_vec3 wi = sr_spherical_direction(sinf(b->theta_i), cosf(b->theta_i), phi_i), d;
        sr_vec3 p = {(float)(b->x0 + (double)u[0] * (b->x1 - b->x0)), (float)(b->y0 + (double)u[1] * (b->y1 - b->y0)),
                     run->height};
        struct sr_ray ray = {.o = sr_mad(p, far, wi), .d = sr_neg(wi), .t_max = INFINITY};
        sr_spectrum beta = SR_ONE;
        bool has_hit, has_left = follow(run->g->scene, ray, &sampler, &w, &beta, &d, &has_hit);
        if (!has_hit)
            extra[2 * SR_LAMBDA_COUNT] += 1;
        if (!has_left || !has_hit || d.z == 0)
            continue;
        double *to = d.z > 0 ? row + cell_of(b, d, phi_i) * SR_LAMBDA_COUNT : NULL,
               *sum = extra + (d.z > 0 ? 0 : SR_LAMBDA_COUNT);
        for (uint32_t i = 0; i < SR_LAMBDA_COUNT; ++i) {
            double value = w.pdf[i] > 0 ? (double)(beta[i] / w.pdf[i]) : 0;
            uint32_t at = (i + shift) % SR_LAMBDA_COUNT;
            sum[at] += value;
            if (to)
                to[at] += value;
        }
    }
    for (size_t i = 0; i < count; ++i)
        row[i] /= run->g->samples;
}

sr_status sr_gonio_scatter(const struct sr_gonio *g, const struct sr_gonio_beam *b, struct sr_arena *arena,
                           struct sr_gonio_scatter *out, struct sr_error *error)
{
    *out = (struct sr_gonio_scatter){.cells = (size_t)b->theta_count * b->phi_count};
    if (!b->theta_count || !b->phi_count || !(b->x1 > b->x0) || !(b->y1 > b->y0) ||
        !(b->theta_i >= 0 && b->theta_i < SR_PI / 2) || !g->samples || g->replicates < 2)
        return sr_fail(error, SR_ERROR_USAGE,
                       "a beam needs a patch, cells, an angle of incidence below 90 deg, samples, and two replicates");
    struct sr_box box = sr_scene_bounds(g->scene);
    if (!(box.hi.z >= box.lo.z))
        return sr_fail(error, SR_ERROR_INPUT, "the scene has no specimen");
    size_t count = out->cells * SR_LAMBDA_COUNT + EXTRA;
    struct scatter_run run = {g, b, box.hi.z, out->cells, sr_alloc(count * g->replicates * sizeof(double))};
    double *mean = sr_arena_alloc(arena, count * sizeof *mean), *u = sr_arena_alloc(arena, count * sizeof *u);
    if (!run.rows || !mean || !u) {
        sr_free(run.rows);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %zu directions in %u replicates", out->cells,
                       g->replicates);
    }
    sr_parallel_for(g->threads > 0 ? g->threads : sr_thread_count(), g->replicates, scatter_replicate, &run);
    mean_of(run.rows, count, g->replicates, mean, u);
    sr_free(run.rows);
    for (size_t c = 0; c < out->cells; ++c) {
        double lower = sin(pi / 2 * (double)(c / b->phi_count) / b->theta_count),
               upper = sin(pi / 2 * (double)(c / b->phi_count + 1) / b->theta_count);
        // folded cells are two of half the width
        double projected = 2 * pi / b->phi_count * (upper * upper - lower * lower) / 2;
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
            mean[c * SR_LAMBDA_COUNT + (size_t)i] /= projected;
            u[c * SR_LAMBDA_COUNT + (size_t)i] /= projected;
        }
    }
    out->f = mean;
    out->f_error = u;
    const double *extra = mean + out->cells * SR_LAMBDA_COUNT, *extra_u = u + out->cells * SR_LAMBDA_COUNT;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        out->reflected[i] = extra[i];
        out->reflected_error[i] = extra_u[i];
        out->transmitted[i] = extra[SR_LAMBDA_COUNT + i];
    }
    out->missed = extra[2 * SR_LAMBDA_COUNT];
    return SR_OK;
}
