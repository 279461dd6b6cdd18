/* SPDX-License-Identifier: MIT */
/* The energy that a certificate looks for: the directional albedo, on a grid of directions and then where it is
 * largest.
 *
 *     E(wo) = INTEGRAL f(wo, wi) |cos_theta_i| dwi = mean of f |cos_theta_i| / pdf over samples    [1], at most 1
 *
 * in the form for importance, delta lobes included. The grid and the search (golden section over theta_o) take samples
 * that fill the square evenly (Hammersley 1960), so that E is smooth in wo; the verdict falls on fresh random ones, by
 * their standard error, because a maximum of noisy values is too large. Where the sampler never looks, energy would be
 * overlooked here: that is what the support and the light are checked for. */
#include "lab/certificate.h"

#include <string.h>

static double radical_inverse(uint32_t i, uint32_t base)
{
    double value = 0, digit = 1.0 / base;
    for (; i; i /= base, digit /= base)
        value += (i % base) * digit;
    return value;
}

static sr_spectrum weight(const struct subject *s, sr_vec3 wo, float u, sr_vec2 square)
{
    struct sr_bsdf_sample sample;
    if (!sr_bsdf_sample(s->b, wo, u, square, SR_IMPORTANCE, &sample))
        return SR_BLACK;
    return sample.f * (fabsf(sample.wi.z) / sample.pdf);
}

double lab_albedo(struct subject *s, sr_vec3 wo, uint32_t n, int *k)
{
    double sum[SR_LAMBDA_COUNT] = {0};
    for (uint32_t i = 0; i < n; ++i) {
        if (s->is_random)
            lab_reseed(s, i);
        sr_vec2 square = {(float)((i + 0.5) / n), (float)radical_inverse(i, 2)};
        sr_spectrum v = weight(s, wo, (float)radical_inverse(i, 3), square);
        for (int j = 0; j < SR_LAMBDA_COUNT; ++j)
            sum[j] += (double)v[j];
    }
    *k = 0;
    for (int j = 1; j < SR_LAMBDA_COUNT; ++j)
        if (sum[j] > sum[*k])
            *k = j;
    return sum[*k] / n;
}

static sr_vec3 viewer(double theta_deg, double phi, bool below)
{
    double t = theta_deg * M_PI / 180;
    return (sr_vec3){(float)(sin(t) * cos(phi)), (float)(sin(t) * sin(phi)), (float)(below ? -cos(t) : cos(t))};
}

/* The mean over fresh random samples, one tally a wavelength. */
static void estimate(struct certifying *c, sr_vec3 wo, uint32_t n, struct sr_tally E[SR_LAMBDA_COUNT])
{
    struct subject *s = c->subject;
    for (uint32_t i = 0; i < n; ++i) {
        if (s->is_random)
            lab_reseed(s, sr_rng_u32(&c->rng));
        float u = lab_u(&c->rng);
        sr_spectrum v = weight(s, wo, u, lab_square(&c->rng));
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            sr_tally_add(&E[k], (double)v[k]);
    }
    c->findings->evaluations += n;
}

/* Whether the albedo is above the limit, by n samples. Samples that all weigh the same but for rare ones that are lost
 * (and weigh nothing) may hold no lost one: their spread is 0, their mean too high. By what n samples can miss, ln(1/p)
 * of the largest, more of them are asked. */
static bool exceeds(struct certifying *c, sr_vec3 wo, int k, uint32_t n, double *mean, double *error)
{
    enum { MORE = 64 };
    double limit = c->subject->largest_albedo * (1 + 1e-5) + 2e-5, missed = 14; // ln(1/p), p = 1e-6
    struct sr_tally E[SR_LAMBDA_COUNT] = {0};
    estimate(c, wo, n, E);
    bool is_above = E[k].mean - c->z * sr_tally_standard_error(&E[k]) > limit;
    if (is_above && E[k].mean - limit < missed * E[k].max / n) {
        memset(E, 0, sizeof E);
        estimate(c, wo, n * MORE, E);
        is_above = E[k].mean - fmax(c->z * sr_tally_standard_error(&E[k]), missed * E[k].max / (n * MORE)) > limit;
    }
    *mean = E[k].mean;
    *error = sr_tally_standard_error(&E[k]);
    return is_above;
}

bool lab_gains_energy(struct certifying *c, sr_vec3 wo, int k, double *mean, double *error)
{
    return exceeds(c, wo, k, c->samples / 2, mean, error);
}

static void check_closed_form(struct certifying *c, uint32_t n)
{
    struct subject *s = c->subject;
    if (!s->b->model->albedo) {
        lab_skip(c, CHECK_ALBEDO, "the model tells no closed form");
        return;
    }
    for (int i = 0; i < 3; ++i) {
        sr_vec3 wo = lab_sphere(&c->rng);
        sr_spectrum known = s->b->model->albedo(s->b->data, wo);
        int k = (int)(lab_u(&c->rng) * SR_LAMBDA_COUNT);
        if (!isfinite(known[k]))
            continue;
        struct sr_tally E[SR_LAMBDA_COUNT] = {0};
        estimate(c, wo, n, E);
        double error = sr_tally_standard_error(&E[k]), d = fabs(E[k].mean - (double)known[k]);
        char set[90];
        lab_describe(s, k, set, sizeof set);
        lab_find(c, CHECK_ALBEDO, d, d > c->z * error + 2e-5,
                 "drawn %.6g +- %.2g, closed form %.6g at theta_o %.4g deg; %s", E[k].mean, error, (double)known[k],
                 lab_theta_deg(wo), set);
    }
    lab_skip(c, CHECK_ALBEDO, "the model tells no closed form for these parameters");
}

void lab_check_energy(struct certifying *c)
{
    static const double grid_deg[] = {0, 20, 40, 55, 65, 72, 78, 83, 86, 88, 89.5};
    enum { GRID = sizeof grid_deg / sizeof grid_deg[0] };
    struct subject *s = c->subject;
    uint32_t coarse = s->is_random ? 64 : 256, fine = 4 * coarse, fresh = c->samples / 4;
    double best = -1, best_phi = 0;
    int best_i = 0, wavelength = 0;
    bool best_below = false;
    for (int below = 0; below < (s->transmits ? 2 : 1); ++below)
        for (int j = 0; j < 2; ++j) {
            double phi = 2 * M_PI * (double)lab_u(&c->rng);
            for (int i = 0; i < GRID; ++i) {
                int k;
                double E = lab_albedo(s, viewer(grid_deg[i], phi, below), coarse, &k);
                c->findings->evaluations += coarse;
                if (E > best) {
                    best = E;
                    best_phi = phi;
                    best_i = i;
                    best_below = below;
                    wavelength = k;
                }
            }
        }
    double lo = grid_deg[best_i ? best_i - 1 : 0], hi = best_i + 1 < GRID ? grid_deg[best_i + 1] : 89.95;
    double shrink = (sqrt(5) - 1) / 2, x = hi - shrink * (hi - lo), y = lo + shrink * (hi - lo),
           theta = grid_deg[best_i];
    int k;
    double fx = lab_albedo(s, viewer(x, best_phi, best_below), fine, &k),
           fy = lab_albedo(s, viewer(y, best_phi, best_below), fine, &k);
    for (int i = 0; i < 8; ++i) {
        if (fx > fy) {
            hi = y, y = x, fy = fx, x = hi - shrink * (hi - lo);
            fx = lab_albedo(s, viewer(x, best_phi, best_below), fine, &k);
        } else {
            lo = x, x = y, fx = fy, y = lo + shrink * (hi - lo);
            fy = lab_albedo(s, viewer(y, best_phi, best_below), fine, &k);
        }
    }
    c->findings->evaluations += 10 * fine;
    if (fmax(fx, fy) > lab_albedo(s, viewer(theta, best_phi, best_below), fine, &k))
        theta = fx > fy ? x : y;
    double mean, error;
    bool is_above = exceeds(c, viewer(theta, best_phi, best_below), wavelength, fresh, &mean, &error);
    char set[100];
    lab_describe(s, wavelength, set, sizeof set);
    lab_find(c, CHECK_ENERGY, mean, is_above, "E = %.6g +- %.2g at theta_o %.4g%s, phi %.4g deg; %s", mean, error,
             theta, best_below ? " from below" : "", best_phi * 180 / M_PI, set);
    check_closed_form(c, fresh);
}
