/* SPDX-License-Identifier: MIT */
/* Nicodemus' nine reflectances by adaptive cubature.
 *
 *     rho(Omega_i; Omega_r) = 1 / Omega_i  INTEGRAL_i INTEGRAL_r f(w_r, w_i) dOmega_r dOmega_i    [1]
 *
 * with dOmega = cos theta d omega; the mean over Omega_i is f itself for a direction, and where light leaves into a
 * direction the reflectance is one per projected solid angle [1/sr]. R = rho / (that of the perfect diffuser). Uniform
 * radiance within the incident beam. F. E. Nicodemus et al., NBS Monograph 160, 1977.
 *
 * A region is integrated in polar coordinates about its axis, one variable within the other, each adaptively
 * (sr_integrate), so that a kink along any curve is a kink of one variable only. Intervals begin at the mirror's
 * direction, where lobes are, and beside the plane of incidence; on the hemisphere alpha = pi/2 (1 - u^2), so that
 * roots of the cosine become smooth. A lobe far narrower than a thousandth of a radian and far from the mirror's
 * direction may be missed.
 *
 * Delta lobes are summed apart, as sample() shows them. */
#include "lab/reflect.h"
#include "lab/twin.h"
#include "quantity/quantity.h"

#include <string.h>

#define SHARE 0.1  // of a tolerance goes to what is integrated within
#define LEAST 1e-2 // [1] of the brightest wavelength: darker ones need not be more exact than that
#define EVALUATIONS 60000000
enum { INTERVALS = 100, DELTAS = 8 };

struct task {
    const struct sr_twin *twin; // or, where there is none,
    const struct sr_bsdf *bsdf;
    struct lab_region from, to;
    int64_t budget; // [1] evaluations
    uint64_t evaluations;
    bool is_isotropic;
    bool is_broken;        // f was not finite
    bool has_random_delta; // more delta lobes than can be told apart
    double inner_tolerance[SR_LAMBDA_COUNT];
};

static sr_vec3 to_float(const double w[3])
{
    return (sr_vec3){(float)w[0], (float)w[1], (float)w[2]};
}

static void evaluate(struct task *t, const double wo[3], const double wi[3], double f[SR_LAMBDA_COUNT])
{
    ++t->evaluations;
    --t->budget;
    if (t->twin) {
        sr_twin_f(t->twin, wo, wi, SR_RADIANCE, f);
    } else {
        sr_spectrum s = sr_bsdf_f(t->bsdf, to_float(wo), to_float(wi), SR_RADIANCE);
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
            f[l] = (double)s[l];
    }
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        if (!isfinite(f[l])) {
            t->is_broken = true;
            f[l] = 0;
        }
}

/* ---- one region ---- */

/* INTEGRAL over the region of y(w) cos theta d omega */
struct cap {
    struct task *task;
    const struct lab_region *region;
    void (*y)(struct task *task, const void *context, const double w[3], struct sr_estimate *out);
    const void *context;
    double betas[6]; // where intervals of beta begin and end
    int beta_count;
    double tolerance[SR_LAMBDA_COUNT]; // of the integral over beta
    double alpha;
    bool any_beta; // y is the same for all
};

static void scale(struct sr_estimate *s, double factor)
{
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
        s->value[l] *= factor;
        s->error[l] *= fabs(factor);
    }
}

static void over_beta(void *context, double beta, struct sr_estimate *out)
{
    struct cap *c = context;
    double w[3];
    sr_region_direction(c->region, c->alpha, beta, w);
    if (c->region->is_hemisphere)
        w[2] = fmax(w[2], 1e-300);
    if (!(w[2] > 0)) {
        *out = (struct sr_estimate){0};
        return;
    }
    c->y(c->task, c->context, w, out);
    scale(out, w[2] * sin(c->alpha));
}

static void over_alpha(void *context, double u, struct sr_estimate *out)
{
    struct cap *c = context;
    double slope = 1;
    c->alpha = u;
    if (c->region->is_hemisphere) {
        c->alpha = M_PI / 2 * (1 - u * u);
        slope = M_PI * u;
    }
    if (c->any_beta) {
        over_beta(c, 0, out);
        scale(out, 2 * M_PI * slope);
        return;
    }
    sr_integrate(over_beta, c, c->betas, c->beta_count, c->tolerance, INTERVALS, &c->task->budget, out);
    scale(out, slope);
}

static void integrate(struct task *t, const struct lab_region *region, const double *other,
                      void (*y)(struct task *, const void *, const double *, struct sr_estimate *), const void *context,
                      const double tolerance[SR_LAMBDA_COUNT], struct sr_estimate *out)
{
    struct cap c = {.task = t, .region = region, .y = y, .context = context, .betas = {0, 2 * M_PI}, .beta_count = 2};
    c.any_beta = t->is_isotropic && !other && region->is_hemisphere && t->from.is_hemisphere && t->to.is_hemisphere;
    double alphas[3] = {0, region->half, region->half}, own[SR_LAMBDA_COUNT];
    if (other) { // the mirror's direction, or the way back where only that lies within
        double alpha, beta, back_alpha, back_beta;
        sr_region_angles(region, (const double[3]){-other[0], -other[1], other[2]}, &alpha, &beta);
        sr_region_angles(region, other, &back_alpha, &back_beta);
        if (alpha > region->half && back_alpha < region->half) {
            alpha = back_alpha;
            beta = back_beta;
        }
        if (alpha < region->half && alpha > 1e-9)
            alphas[1] = alpha;
        int panels = region->is_hemisphere ? 4 : alpha < region->half ? 2 : 1; // in a cone there are fewer surprises
        c.beta_count = panels + 1;
        for (int k = 0; k <= panels; ++k)
            c.betas[k] = beta + 2 * M_PI / panels * k;
    }
    if (region->is_hemisphere) {
        double u = sqrt(fmax(0, 1 - alphas[1] / (M_PI / 2)));
        memcpy(alphas, (double[3]){0, u, 1}, sizeof alphas);
    }
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
        c.tolerance[l] = SHARE * tolerance[l] / region->half;
        own[l] = (1 - 2 * SHARE) * tolerance[l];
    }
    sr_integrate(over_alpha, &c, alphas, 3, own, INTERVALS, &t->budget, out);
}

/* ---- both ---- */

static void plain_f(const double f[SR_LAMBDA_COUNT], struct sr_estimate *out)
{
    *out = (struct sr_estimate){0};
    memcpy(out->value, f, sizeof out->value);
}
static void toward(struct task *t, const void *wi, const double w[3], struct sr_estimate *out)
{
    double f[SR_LAMBDA_COUNT];
    evaluate(t, w, wi, f);
    plain_f(f, out);
}
static void coming_from(struct task *t, const void *wo, const double w[3], struct sr_estimate *out)
{
    double f[SR_LAMBDA_COUNT];
    evaluate(t, wo, w, f);
    plain_f(f, out);
}
static void gathered(struct task *t, const void *unused, const double wi[3], struct sr_estimate *out)
{
    (void)unused;
    integrate(t, &t->to, wi, toward, wi, t->inner_tolerance, out);
}
static void received(struct task *t, const void *unused, const double wo[3], struct sr_estimate *out)
{
    (void)unused;
    integrate(t, &t->from, wo, coming_from, wo, t->inner_tolerance, out);
}

/* Does f stay the same when both directions turn about the normal? Then one azimuth of a whole hemisphere tells of all.
 */
static bool is_isotropic(struct task *t)
{
    struct sr_rng rng = sr_rng_seed(1, 2);
    double most[SR_LAMBDA_COUNT] = {0}, difference[SR_LAMBDA_COUNT] = {0};
    for (int n = 0; n < 32; ++n) {
        double f[2][SR_LAMBDA_COUNT], zo = (double)sr_rng_float(&rng), zi = n % 2 ? (double)sr_rng_float(&rng) : zo;
        double so = sqrt(1 - zo * zo), si = sqrt(1 - zi * zi), turn = 2 * M_PI * (double)sr_rng_float(&rng);
        double between = n % 2 ? 2 * M_PI * (double)sr_rng_float(&rng) : M_PI;
        for (int k = 0; k < 2; ++k)
            evaluate(t, (const double[3]){so * cos(k * turn), so * sin(k * turn), zo},
                     (const double[3]){si * cos(k * turn + between), si * sin(k * turn + between), zi}, f[k]);
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
            most[l] = fmax(most[l], fabs(f[0][l]));
            difference[l] = fmax(difference[l], fabs(f[0][l] - f[1][l]));
        }
    }
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        if (difference[l] > (t->twin ? 1e-11 : 1e-5) * most[l])
            return false;
    return true;
}

/* The integral over both regions; over a direction: the value there. */
static void both(struct task *t, const double tolerance[SR_LAMBDA_COUNT], struct sr_estimate *out)
{
    if (t->from.is_direction && t->to.is_direction)
        toward(t, t->from.z, t->to.z, out);
    else if (t->from.is_direction)
        integrate(t, &t->to, t->from.z, toward, t->from.z, tolerance, out);
    else if (t->to.is_direction)
        integrate(t, &t->from, t->to.z, coming_from, t->to.z, tolerance, out);
    else {
        bool from_outside = t->from.half <= t->to.half; // the larger region within: it is the harder one
        const struct lab_region *outer = from_outside ? &t->from : &t->to;
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
            t->inner_tolerance[l] = SHARE * tolerance[l] / outer->projected;
        integrate(t, outer, NULL, from_outside ? gathered : received, NULL, tolerance, out);
    }
}

static double largest(const double v[SR_LAMBDA_COUNT])
{
    double most = 0;
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        most = fmax(most, fabs(v[l]));
    return most;
}

static void tolerances(const double value[SR_LAMBDA_COUNT], double relative, double out[SR_LAMBDA_COUNT])
{
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        out[l] = relative * fmax(fabs(value[l]), LEAST * largest(value));
}

/* To a relative tolerance of a value that is not known before: a coarse one gives the scale, and is corrected. */
static void to_tolerance(struct task *t, double relative, struct sr_estimate *out)
{
    double tolerance[SR_LAMBDA_COUNT] = {0};
    t->budget = 0;
    both(t, tolerance, out);
    for (int turn = 0; turn < 3; ++turn) {
        double before[SR_LAMBDA_COUNT];
        bool is_enough = true;
        tolerances(out->value, relative, tolerance);
        memcpy(before, tolerance, sizeof before);
        t->budget = EVALUATIONS;
        both(t, tolerance, out);
        tolerances(out->value, relative, tolerance);
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
            is_enough &= out->error[l] <= tolerance[l] || !(before[l] > 1.01 * tolerance[l]);
        if (is_enough || t->budget <= 0)
            return;
    }
}

/* ---- delta lobes ---- */

static bool sample(const struct task *t, int part, const double wo[3], double u_lobe, struct twin_sample *s)
{
    const double u[2] = {0.5, 0.5};
    if (t->twin)
        return sr_twin_sample(t->twin, part, wo, u_lobe, u, s);
    struct sr_bsdf_sample one;
    if (!sr_bsdf_sample(t->bsdf, to_float(wo), (float)u_lobe, (sr_vec2){0.5f, 0.5f}, SR_RADIANCE, &one))
        return false;
    *s = (struct twin_sample){
        .wi = {(double)one.wi.x, (double)one.wi.y, (double)one.wi.z}, .pdf = (double)one.pdf, .lobe = one.lobe};
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        s->f[l] = (double)one.f[l];
    return true;
}

static bool is_same(const struct twin_sample *a, const struct twin_sample *b)
{
    double d = fabs(a->pdf - b->pdf);
    for (int k = 0; k < 3; ++k)
        d += fabs(a->wi[k] - b->wi[k]);
    return d < 1e-6 * (1 + a->pdf) && fabs(a->f[0] - b->f[0]) <= 1e-6 * fabs(a->f[0]);
}

/* What delta lobes reflect of light from w into the region, or from the region toward w, of 1 [1]. */
static void mirrored(struct task *t, const double w[3], const struct lab_region *region, double out[SR_LAMBDA_COUNT])
{
    memset(out, 0, SR_LAMBDA_COUNT * sizeof *out);
    int parts = t->twin ? sr_twin_part_count(t->twin) : 1;
    for (int part = 0; part < parts; ++part) {
        struct twin_sample known[DELTAS], s;
        int count = 0;
        double probability = 0;
        for (int k = 0; k < 64 + 12; ++k) { // lobes of small probability are at the ends
            double small = pow(10, -2 - 0.5 * ((k - 64) / 2));
            double u_lobe = k < 64 ? (k + 0.5) / 64 : k % 2 ? 1 - small : small;
            if (!sample(t, part, w, u_lobe, &s) || !(s.lobe & SR_LOBE_SPECULAR) || !(s.wi[2] > 0))
                continue;
            bool is_known = false;
            for (int i = 0; i < count; ++i)
                is_known |= is_same(&known[i], &s);
            if (is_known)
                continue;
            probability += s.pdf;
            if (count == DELTAS || probability > 1 + 1e-5) { // walks: their pdf is no probability
                t->has_random_delta = true;
                return;
            }
            known[count++] = s;
            if (sr_region_contains(region, s.wi))
                for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
                    out[l] += s.f[l] * s.wi[2];
        }
    }
}

static void mirrored_into(struct task *t, const void *to, const double w[3], struct sr_estimate *out)
{
    double value[SR_LAMBDA_COUNT];
    ++t->evaluations;
    --t->budget;
    mirrored(t, w, to, value);
    plain_f(value, out);
}

static void deltas(struct task *t, double relative, struct sr_estimate *out)
{
    double value[SR_LAMBDA_COUNT], tolerance[SR_LAMBDA_COUNT];
    if (t->from.is_direction) {
        mirrored(t, t->from.z, &t->to, value);
        plain_f(value, out);
    } else if (t->to.is_direction) {
        mirrored(t, t->to.z, &t->from, value);
        plain_f(value, out);
    } else {
        // the smaller region is where it is known best whether light arrives; a mirror's way goes both ways
        bool is_from = t->from.half <= t->to.half;
        const struct lab_region *over = is_from ? &t->from : &t->to, *into = is_from ? &t->to : &t->from;
        t->budget = 0;
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
            tolerance[l] = 0;
        integrate(t, over, NULL, mirrored_into, into, tolerance, out);
        tolerances(out->value, relative, tolerance);
        t->budget = EVALUATIONS / 50;
        integrate(t, over, NULL, mirrored_into, into, tolerance, out);
    }
}

/* ---- all ---- */

/* Whether f is a function: does it stay the same in another random walk? */
static bool is_function(const struct sr_specimen *specimen, sr_spectrum lambda)
{
    static const float z[4] = {1, 0.8f, 0.5f, 0.2f};
    struct sr_specimen_at a, b;
    sr_specimen_at(specimen, lambda, 1, &a);
    if (!a.bsdf.model->is_random)
        return true;
    sr_specimen_at(specimen, lambda, 2, &b);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            sr_vec3 wo = {sr_safe_sqrt(1 - z[i] * z[i]), 0, z[i]}, wi = {0, sr_safe_sqrt(1 - z[j] * z[j]), z[j]};
            sr_spectrum f = sr_bsdf_f(&a.bsdf, wo, wi, SR_RADIANCE), g = sr_bsdf_f(&b.bsdf, wo, wi, SR_RADIANCE);
            if (sr_spectrum_any(f != g))
                return false;
        }
    return true;
}

static sr_status run(struct task *t, const struct sr_specimen *specimen, uint32_t lobes, double tolerance,
                     struct sr_reflectance *out, struct sr_error *error)
{
    struct sr_estimate sum = {0}, delta = {0};
    t->is_isotropic = is_isotropic(t);
    if (lobes & ~(uint32_t)(SR_LOBE_SPECULAR | SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION))
        to_tolerance(t, tolerance, &sum);
    if (lobes & SR_LOBE_SPECULAR) {
        if (t->from.is_direction && t->to.is_direction) {
            struct lab_region near = t->to;
            near.is_direction = false;
            near.half = 1e-6;
            mirrored(t, t->from.z, &near, delta.value);
            if (largest(delta.value) > 0)
                return sr_fail(
                    error, SR_ERROR_USAGE,
                    "%s reflects as a mirror from one of these directions into the other: f is a delta function "
                    "there; gather the light in a cone or the hemisphere",
                    specimen->title);
        } else {
            deltas(t, tolerance, &delta);
        }
        if (t->has_random_delta)
            return sr_fail(
                error, SR_ERROR_USAGE,
                "what %s reflects as a mirror is a random estimate: only the Monte Carlo method can count it",
                specimen->title);
    }
    double incident = t->from.is_direction ? 1 : t->from.projected, rounding = t->twin ? 0 : 3e-7;
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {

        out->value[l] = (sum.value[l] + delta.value[l]) / incident;
        out->error[l] = (sum.error[l] + delta.error[l]) / incident + rounding * out->value[l];
    }
    double limit[SR_LAMBDA_COUNT];
    tolerances(out->value, tolerance, limit);
    out->has_converged = !t->is_broken;
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        out->has_converged &= out->error[l] <= 1.1 * limit[l] + rounding * out->value[l];
    out->evaluations = t->evaluations;
    sr_reflectance_factor(out);
    return SR_OK;
}

static sr_status cubature(const struct sr_specimen *specimen, sr_spectrum lambda, const struct sr_beam *from,
                          const struct sr_beam *to, double tolerance, bool in_double, struct sr_reflectance *out,
                          struct sr_error *error)
{
    if (sr_beam_check(from, error) != SR_OK || sr_beam_check(to, error) != SR_OK)
        return error->status;
    sr_reflectance_describe(from, to, out);
    if (!is_function(specimen, lambda))
        return sr_fail(error, SR_ERROR_USAGE,
                       "f of %s is a random estimate, which cubature cannot integrate: use the Monte Carlo method",
                       specimen->title);
    struct sr_arena arena = {0};
    struct sr_specimen_at at;
    sr_specimen_at(specimen, lambda, 1, &at);
    struct task t = {.bsdf = &at.bsdf, .from = sr_region_of(from), .to = sr_region_of(to)};
    sr_status status = SR_OK;
    if (in_double)
        status = sr_twin_make(&arena, &at.bsdf, lambda, SR_TWIN_DECIMAL, &t.twin, error);
    if (status == SR_OK) // floats cannot do better than 1e-6
        status = run(&t, specimen, sr_bsdf_lobes(&at.bsdf), t.twin ? tolerance : fmax(tolerance, 1e-6), out, error);
    sr_arena_free(&arena);
    return status;
}

sr_status sr_reflectance_cubature(const struct sr_specimen *specimen, sr_spectrum lambda, const struct sr_beam *from,
                                  const struct sr_beam *to, double tolerance, struct sr_reflectance *out,
                                  struct sr_error *error)
{
    return cubature(specimen, lambda, from, to, tolerance, true, out, error);
}

sr_status sr_reflectance_cubature_single(const struct sr_specimen *specimen, sr_spectrum lambda,
                                         const struct sr_beam *from, const struct sr_beam *to, double tolerance,
                                         struct sr_reflectance *out, struct sr_error *error)
{
    return cubature(specimen, lambda, from, to, tolerance, false, out, error);
}
