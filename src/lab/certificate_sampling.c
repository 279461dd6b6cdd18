/* SPDX-License-Identifier: MIT */
/* What a certificate finds by statistics: that samples fall as the density says, and that the light they carry is the
 * light that f describes.
 *
 * The sphere is two squares: the concentric map of a disk (Shirley & Chiu 1997) with |z| = (1 - r^2)^2, in which the
 * horizon is the edge and wide (densities may end a little above it), and the normal no singularity. Cells follow the
 * sampler: a first run of samples divides them until each holds few, and they are divided toward the mirror direction
 * and straight back too, where a lobe could be that is never drawn. The density is integrated over each cell by
 * adaptive Gauss-Legendre rules, in double.
 *
 *     normalisation   INTEGRAL pdf dwi <= 1
 *     lost            samples that are not drawn, or mirrored, are as many as the density leaves over: 1 - INTEGRAL pdf
 *     sampling        chi2 = SUM (O - E)^2 / (E + e^2) over cells, e the error of the integral (Pearson 1900)
 *     light           mean of f |cos_theta_i| g / pdf over samples = INTEGRAL f |cos_theta_i| g dwi,
 *                     for g = 1, wi.x, wi.z; the integral by random points in each cell, a stratified
 *                     estimate with an error of its own
 *
 * Limits: a lobe narrower than 1e-4 rad off these directions that the sampler never draws is not found. Where the
 * samples of many cells crowd on a ridge that is much narrower than the cell, no quadrature of this size resolves the
 * density: such viewing directions are left out (bsdf of slopes 1e-4 by 1; the law that a sample's pdf is pdf() is
 * still checked). */
#include "lab/certificate.h"

#include <string.h>

#define LAST (SR_LAMBDA_COUNT - 1)

enum { DEEPEST = 14, MAX_CELLS = 6000, FIRST_RUN = 8192, SPECIAL_DEPTH = 6 };

/* A square of a hemisphere's map: x, y in -1 … 1; a leaf where child is 0. */
struct cell {
    double x, y, size;
    bool below;
    int child; // index of the first of four
    double expected, error, observed;
    int first; // samples of the first run
};
struct spot {
    double x, y;
    bool below;
};
struct cells {
    struct cell *items;
    int count;
    int leaves;
    int on_ridges, in_all; // of the first run's samples
};

/* ---- the map ---- */

static sr_vec3 direction_at(double a, double b, bool below)
{
    bool wide = fabs(a) > fabs(b);
    double r = wide ? a : b, across = wide ? b : a, angle = r != 0 ? M_PI / 4 * (across / r) : 0;
    double s = fmin(r * r, 1), z = (1 - s) * (1 - s),
           sine = r * sqrt((2 - s) * (1 + z)); // r may be below 0: so is the sine
    double x = sine * cos(angle), y = sine * sin(angle);
    return (sr_vec3){(float)(wide ? x : y), (float)(wide ? y : x), (float)(below ? -z : z)};
}

static struct spot spot_of(sr_vec3 w)
{
    double x = (double)w.x, y = (double)w.y, z = fmin(fabs((double)w.z), 1);
    double r = sqrt((x * x + y * y) / ((1 + z) * (1 + sqrt(z)))); // sqrt(1 - sqrt(z)) without cancellation
    bool wide = fabs(x) > fabs(y);
    double major = wide ? x : y, minor = wide ? y : x;
    double a = copysign(r, major), b = major != 0 ? a * (atan(minor / major) * 4 / M_PI) : 0;
    return (struct spot){wide ? a : b, wide ? b : a, (double)w.z < 0};
}

/* Solid angle for an area of the square [sr]. */
static double jacobian(double a, double b)
{
    double r2 = fmax(a * a, b * b);
    return M_PI * fmax(1 - r2, 0);
}

/* ---- division ---- */

static bool contains(const struct cell *q, const struct spot *p)
{
    return p->below == q->below && p->x >= q->x && p->x < q->x + q->size && p->y >= q->y && p->y < q->y + q->size;
}

/* Whether the samples of a cell lie in few of its 16 parts, as spread ones hardly do. */
static bool is_ridge(const struct cell *q, const struct spot *spots, int count)
{
    uint32_t taken = 0;
    for (int i = 0; i < count; ++i) {
        int x = (int)(4 * (spots[i].x - q->x) / q->size), y = (int)(4 * (spots[i].y - q->y) / q->size);
        taken |= 1u << ((x & 3) + 4 * (y & 3));
    }
    return count >= 12 && __builtin_popcount(taken) <= 4;
}

/* Divides a cell that holds spots[0 … count-1]; the first `special` of specials are directions to divide toward. */
static void divide(struct cells *cells, int index, int depth, struct spot *spots, int count,
                   const struct spot *specials, int special_count)
{
    struct cell q = cells->items[index];
    bool is_special = false;
    for (int i = 0; i < special_count; ++i)
        is_special |= contains(&q, &specials[i]);
    bool divides = depth < 2 || (depth < DEEPEST && count > FIRST_RUN / 256) || (depth < SPECIAL_DEPTH && is_special);
    if (!divides || cells->count + 4 > MAX_CELLS) {
        ++cells->leaves;
        cells->items[index].first = count;
        cells->in_all += count;
        cells->on_ridges += is_ridge(&q, spots, count) ? count : 0;
        return;
    }
    int child = cells->count;
    cells->count += 4;
    cells->items[index].child = child;
    for (int k = 0; k < 4; ++k) {
        double half = q.size / 2;
        struct cell *part = &cells->items[child + k];
        *part = (struct cell){.x = q.x + (k & 1) * half, .y = q.y + (k >> 1) * half, .size = half, .below = q.below};
        int inside = 0;
        for (int i = 0; i < count; ++i)
            if (contains(part, &spots[i])) {
                struct spot t = spots[inside];
                spots[inside++] = spots[i];
                spots[i] = t;
            }
        divide(cells, child + k, depth + 1, spots, inside, specials, special_count);
        spots += inside;
        count -= inside;
    }
}

static struct cell *leaf_of(struct cells *cells, sr_vec3 w)
{
    struct spot p = spot_of(w);
    p.x = fmin(fmax(p.x, -1), 1 - 1e-12);
    p.y = fmin(fmax(p.y, -1), 1 - 1e-12);
    struct cell *q = &cells->items[p.below];
    while (q->child) {
        double half = q->size / 2;
        q = &cells->items[q->child + (p.x >= q->x + half) + 2 * (p.y >= q->y + half)];
    }
    return q;
}

/* ---- integration ---- */

struct integrand {
    const struct subject *s;
    sr_vec3 wo;
    uint64_t evaluations, most;
};

static double density(struct integrand *g, double x, double y, bool below)
{
    ++g->evaluations;
    double p = (double)sr_bsdf_pdf(g->s->b, g->wo, direction_at(x, y, below), SR_RADIANCE);
    return p >= 0 && p < 1e30 ? p * jacobian(x, y) : 0; // NaN and infinity are found elsewhere
}

/* Gauss-Legendre of 3 x 3 points: the mean over the square. */
static double rule(struct integrand *g, double x, double y, double size, bool below)
{
    static const double node[3] = {0.112701665379258311, 0.5, 0.887298334620741689},
                        w[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    double sum = 0;
    for (int i = 0; i < 9; ++i)
        sum += w[i / 3] * w[i % 3] * density(g, x + size * node[i / 3], y + size * node[i % 3], below);
    return sum;
}

/* Simpson's rule, with nodes on the border. */
static double simpson(struct integrand *g, double x, double y, double size, bool below)
{
    static const double node[3] = {1e-9, 0.5, 1 - 1e-9}, w[3] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
    double sum = 0;
    for (int i = 0; i < 9; ++i)
        sum += w[i / 3] * w[i % 3] * density(g, x + size * node[i / 3], y + size * node[i % 3], below);
    return sum;
}

/* Mass of the density in the square [1]; *error adds what the last halving changed. */
static double integrate(struct integrand *g, double x, double y, double size, bool below, double whole,
                        double tolerance, int depth, int forced, double *error)
{
    double half = size / 2, part[4], sum = 0, area = size * size;
    for (int k = 0; k < 4; ++k) {
        part[k] = rule(g, x + (k & 1) * half, y + (k >> 1) * half, half, below);
        sum += part[k] / 4;
    }
    double changed = fabs(sum - whole) * area;
    // an edge of the density near the square's own border meets no node of Gauss: Simpson's lie on the border
    double odd = fabs(sum - simpson(g, x, y, size, below)) * area;
    bool is_even = changed <= fmax(tolerance, 1e-5 * sum * area) && odd <= fmax(tolerance, 0.03 * sum * area);
    if ((forced <= 0 && (is_even || depth == 0)) || g->evaluations > g->most) {
        *error += changed / 2; // the finer rule is much better where f is smooth, and twice as good at an edge
        return sum * area;
    }
    double mass = 0;
    for (int k = 0; k < 4; ++k)
        mass += integrate(g, x + (k & 1) * half, y + (k >> 1) * half, half, below, part[k], tolerance / 3, depth - 1,
                          forced - 1, error);
    return mass;
}

/* ---- statistics ---- */

struct drawing {
    struct sr_bsdf_sample sample;
    bool is_drawn, is_spread; // spread: not a delta function
};

static struct drawing draw(struct certifying *c, sr_vec3 wo, enum sr_transport mode)
{
    struct drawing d = {0};
    float u = lab_u(&c->rng);
    d.is_drawn = sr_bsdf_sample(c->subject->b, wo, u, lab_square(&c->rng), mode, &d.sample);
    d.is_spread = d.is_drawn && !(d.sample.lobe & SR_LOBE_SPECULAR) && sr_is_finite(d.sample.wi) &&
                  fabsf(sr_length2(d.sample.wi) - 1) < 1e-2f;
    return d;
}

static void build(struct certifying *c, sr_vec3 wo, struct cells *cells, struct spot *spots)
{
    int count = 0;
    for (int i = 0; i < FIRST_RUN; ++i) {
        if (c->subject->is_random && c->subject->is_proportional)
            lab_reseed(c->subject, sr_rng_u32(&c->rng));
        struct drawing d = draw(c, wo, SR_RADIANCE);
        if (d.is_spread)
            spots[count++] = spot_of(d.sample.wi);
    }
    struct spot specials[4] = {spot_of((sr_vec3){-wo.x, -wo.y, wo.z}), spot_of(wo), spot_of(sr_neg(wo)),
                               spot_of((sr_vec3){0, 0, wo.z < 0 ? -1.0f : 1.0f})};
    *cells = (struct cells){.items = cells->items, .count = 2};
    int split = 0;
    for (int i = 0; i < count; ++i) // those above come first
        if (!spots[i].below) {
            struct spot t = spots[split];
            spots[split++] = spots[i];
            spots[i] = t;
        }
    for (int side = 0; side < 2; ++side) {
        cells->items[side] = (struct cell){.x = -1, .y = -1, .size = 2, .below = side};
        divide(cells, side, 0, spots + (side ? split : 0), side ? count - split : split, specials, 4);
    }
}

/* Expected shares of all leaves, and of both hemispheres together. */
static double expect(struct certifying *c, sr_vec3 wo, struct cells *cells, double n, double *error)
{
    struct integrand g = {.s = c->subject, .wo = wo, .most = 5000000};
    double total = 0;
    *error = 0;
    for (int i = 0; i < cells->count; ++i) {
        struct cell *q = &cells->items[i];
        if (q->child)
            continue;
        double whole = rule(&g, q->x, q->y, q->size, q->below), area = q->size * q->size;
        double tolerance = fmax(0.03 * sqrt(whole * area / n), 2e-7);
        // samples show where a ridge lies between the nodes: they ask for more nodes, and never change the answer
        for (int forced = 0; forced <= 6; forced += 3) {
            q->error = 0;
            q->expected = integrate(&g, q->x, q->y, q->size, q->below, whole, tolerance, 9, forced, &q->error);
            double m = q->expected * FIRST_RUN;
            if (fabs(q->first - m) < (forced ? 4 : 3) * sqrt(m + 1) + 1 || g.evaluations > g.most / 2)
                break;
        }
        total += q->expected;
        *error += q->error;
    }
    c->findings->evaluations += g.evaluations;
    return total;
}

static double chi2_of(struct cells *cells, double n, double total, int *degrees, double worst[3])
{
    double chi2 = 0, pool_o = 0, pool_e = 0, pool_v = 0, worst_term = 0;
    int terms = 0;
    for (int i = 0; i < cells->count; ++i) {
        struct cell *q = &cells->items[i];
        if (q->child)
            continue;
        double e = q->expected * n, v = e + (q->error * n) * (q->error * n), term;
        pool_o += q->observed;
        pool_e += e;
        pool_v += v;
        if (pool_e < 8) // small ones wait for others
            continue;
        term = (pool_o - pool_e) * (pool_o - pool_e) / pool_v;
        chi2 += term;
        ++terms;
        if (term > worst_term) {
            sr_vec3 w = direction_at(q->x + q->size / 2, q->y + q->size / 2, q->below);
            worst_term = term;
            worst[0] = lab_theta_deg(w);
            worst[1] = lab_phi_deg(w);
            worst[2] = pool_o / pool_e;
        }
        pool_o = pool_e = pool_v = 0;
    }
    if (pool_e > 0 || pool_o > 0) { // what is left, and what was drawn where nothing is expected
        double e = fmax(pool_e, 0.1);
        chi2 += (pool_o - e) * (pool_o - e) / fmax(pool_v, fmax(e, 1));
        ++terms;
    }
    *degrees = terms - (total > 1 - 1e-9 && terms > 1 ? 1 : 0);
    return chi2;
}

/* P(at least this many | mean), of Poisson's distribution. */
static double poisson_tail(double count, double mean)
{
    return count < 1 ? 1 : 1 - sr_incomplete_gamma_upper(count, fmax(mean, 1e-12));
}

static void check_density(struct certifying *c, sr_vec3 wo, struct cells *cells, const char *set)
{
    struct findings *f = c->findings;
    double n = c->samples, error, total = expect(c, wo, cells, n, &error);
    double theta = lab_theta_deg(wo);
    lab_find(c, CHECK_NORMALISATION, total, total > 1 + error + 5e-4,
             "INTEGRAL pdf = %.7g +- %.1g at theta_o %.4g deg; %s", total, error, theta, set);
    double lost = 0, drawn = 0;
    for (uint32_t i = 0; i < c->samples; ++i) {
        struct drawing d = draw(c, wo, SR_RADIANCE);
        if (!d.is_spread)
            ++lost;
        else {
            leaf_of(cells, d.sample.wi)->observed += 1;
            ++drawn;
        }
    }
    f->evaluations += c->samples;

    double left = fmax(1 - total, 0) * n, slack = (error + 1e-5) * n;
    double variance = fmax(1 - total, 0) * fmin(total, 1) * n;
    double excess = lost - left;
    f->lost += excess;
    f->lost_variance += variance;
    f->lost_slack += slack;
    double p = excess > 0 ? poisson_tail(lost, left + slack)
                          : sr_normal_p_two_sided(fmax(-excess - slack, 0) / sqrt(variance + 1));
    lab_find(
        c, CHECK_LOST, fabs(excess) / n, p < c->p,
        "%.0f of %.0f samples are lost or mirrored, %.1f +- %.1f by the density (p = %.2g) at theta_o %.4g deg; %s",
        lost, n, left, sqrt(variance), p, theta, set);
    if (drawn < 100)
        return;
    int degrees;
    double worst[3] = {0, 0, 0}, chi2 = chi2_of(cells, n, total, &degrees, worst);
    p = degrees > 0 ? sr_chi2_p(chi2, degrees) : 1;
    lab_find(c, CHECK_SAMPLING, chi2 / fmax(degrees, 1), p < c->p,
             "chi2 = %.1f of %d degrees, p = %.2g at theta_o %.4g deg; most (%.3g of expected) at %.3g, %.3g deg; %s",
             chi2, degrees, p, theta, worst[2], worst[0], worst[1], set);
}

static double luminous(sr_spectrum f) // weighs the wavelengths, so that mixing them up is seen
{
    return (double)f[0] + 2 * (double)f[LAST];
}

static void check_light(struct certifying *c, sr_vec3 wo, struct cells *cells, const char *set)
{
    struct subject *s = c->subject;
    struct sr_tally drawn[3] = {0};
    double described[3] = {0}, variance[3] = {0}, largest = 0;
    int points = s->is_random ? 64 : 4;
    for (int i = 0; i < cells->count; ++i) {
        const struct cell *q = &cells->items[i];
        if (q->child)
            continue;
        struct sr_tally v[3] = {0};
        for (int k = 0; k < points; ++k) { // in turn in each quarter
            if (s->is_random)
                lab_reseed(s, sr_rng_u32(&c->rng));
            double x = q->x + q->size * ((k & 1) + (double)lab_u(&c->rng)) / 2;
            double y = q->y + q->size * ((k >> 1 & 1) + (double)lab_u(&c->rng)) / 2;
            sr_vec3 wi = direction_at(x, y, q->below);
            double value = luminous(sr_bsdf_f(s->b, wo, wi, SR_IMPORTANCE)) * fabs((double)wi.z) * jacobian(x, y) *
                           q->size * q->size;
            largest = fmax(largest, value / points);
            sr_tally_add(&v[0], value);
            sr_tally_add(&v[1], value * (double)wi.x);
            sr_tally_add(&v[2], value * (double)wi.z);
        }
        for (int k = 0; k < 3; ++k) {
            described[k] += v[k].mean;
            variance[k] += sr_tally_variance(&v[k]) / points;
        }
    }
    for (uint32_t i = 0; i < c->samples; ++i) {
        if (s->is_random)
            lab_reseed(s, sr_rng_u32(&c->rng));
        struct drawing d = draw(c, wo, SR_IMPORTANCE);
        double w = d.is_spread ? luminous(d.sample.f) * (double)(fabsf(d.sample.wi.z) / d.sample.pdf) : 0;
        sr_tally_add(&drawn[0], w);
        sr_tally_add(&drawn[1], w * (double)d.sample.wi.x);
        sr_tally_add(&drawn[2], w * (double)d.sample.wi.z);
    }
    c->findings->evaluations += c->samples + (uint64_t)(points * cells->leaves);
    static const char *const moments[] = {"1", "wi.x", "wi.z"};
    for (int k = 0; k < 3; ++k) {
        double own = sr_tally_standard_error(&drawn[k]), error = sqrt(variance[k] + own * own) + 1e-5 * described[0];
        if (!(described[0] > 1e-6) && !(drawn[0].mean > 1e-6))
            continue; // black, or mirrors only
        double d = drawn[k].mean - described[k], slack = s->is_random ? lab_bernstein(c, largest) : 0;
        double z = copysign(fmax(fabs(d) - slack, 0), d) / fmax(error, 1e-9);
        lab_find(c, CHECK_LIGHT, fabs(z), fabs(z) > c->z,
                 "moment %s: drawn %.6g, described %.6g +- %.2g, z = %.2f at theta_o %.4g deg; %s", moments[k],
                 drawn[k].mean, described[k], error, z, lab_theta_deg(wo), set);
        if (k == 0) {
            c->findings->light_z += z;
            ++c->findings->light_count;
        }
    }
}

void lab_check_sampling(struct certifying *c)
{
    struct subject *s = c->subject;
    struct cells cells = {.items = sr_alloc(MAX_CELLS * sizeof *cells.items)};
    struct spot *spots = sr_alloc(FIRST_RUN * sizeof *spots);
    char set[80];
    lab_describe(s, 0, set, sizeof set);
    if (!cells.items || !spots)
        sr_fail(c->error, SR_ERROR_RESOURCE, "not enough memory for a certificate");
    uint32_t directions = cells.items && spots && sr_bsdf_lobes(s->b) ? c->directions : 0; // black: draws nothing
    for (uint32_t i = 0; i < directions; ++i) {
        sr_vec3 wo = lab_sphere(&c->rng);
        if (i % 4 == 1) // grazing, but not so that floats have no digits left
            wo = sr_spherical_direction(0.9998f, copysignf(0.02f, wo.z), 6.28f * lab_u(&c->rng));
        build(c, wo, &cells, spots);
        if (cells.on_ridges * 20 > cells.in_all)
            continue;
        if (!s->is_proportional)
            check_density(c, wo, &cells, set);
        check_light(c, wo, &cells, set);
    }
    if (s->is_proportional) {
        lab_skip(c, CHECK_NORMALISATION, "samples know their density up to a factor only");
        lab_skip(c, CHECK_LOST, "samples know their density up to a factor only");
    }
    lab_skip(c, CHECK_SAMPLING,
             s->is_proportional ? "samples know their density up to a factor only" : "only mirrors are drawn");
    lab_skip(c, CHECK_LIGHT, "it has delta lobes only, or is black");
    sr_free(cells.items);
    sr_free(spots);
}
