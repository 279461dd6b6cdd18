/* SPDX-License-Identifier: MIT */
/* The table of profiles: splines through it, distances drawn from it, albedos found by it.
 *
 *     2 pi r S_r(r) = sigma_t SUM_j SUM_k w_j(albedo) w_k(r sigma_t) profile_jk      [1/m]
 *
 * w are Catmull & Rom's weights on uneven nodes: the cubic in an interval has the nodes' values and, at its ends, the
slope
 * between the neighbours. A distance is drawn by the integral of that spline, solved in its interval by Newton's steps
 * between shrinking bounds. The model lets out up to 2 % more than has entered near an albedo of 1, and more where g is
negative; there the shares from 0.98 on are pressed together so that the last is 1. Nodes as pbrt-v4 has them (Pharr,
Jakob & Humphreys 2016, 15.5.4): radii 0, 0.0025, … by
 * 1.2, albedos denser toward 1. Splines can dip below 0 where a profile dies away, by some 1e-7 of all; there nothing
comes out. */
#include "subsurface/private.h"

enum { ALBEDOS = SR_DIFFUSION_ALBEDOS, RADII = SR_DIFFUSION_RADII };

/* Weights of the nodes first … first + 3 at x; those that lie outside of the table weigh 0. */
struct weights {
    int first;
    float w[4];
};

// largest i <= n - 2 with x[i] <= at
static int interval_of(const float *x, int n, float at)
{
    int lo = 0, hi = n - 1;
    while (hi - lo > 1) {
        int middle = (lo + hi) / 2;
        if (x[middle] <= at)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

static bool weights_at(const float *x, int n, float at, struct weights *out)
{
    if (!(at >= x[0] && at <= x[n - 1]))
        return false;
    int i = interval_of(x, n, at);
    float h = x[i + 1] - x[i], t = (at - x[i]) / h, t2 = t * t, t3 = t2 * t;
    float d0 = t3 - 2 * t2 + t, d1 = t3 - t2; // of the slopes at both ends, times h
    out->first = i - 1;
    out->w[0] = out->w[3] = 0;
    out->w[1] = 2 * t3 - 3 * t2 + 1;
    out->w[2] = 3 * t2 - 2 * t3;
    float left = i > 0 ? d0 * h / (x[i + 1] - x[i - 1]) : d0, right = i < n - 2 ? d1 * h / (x[i + 2] - x[i]) : d1;
    out->w[i > 0 ? 0 : 1] -= left;
    out->w[2] += left;
    out->w[i < n - 2 ? 3 : 2] += right;
    out->w[1] -= right;
    return true;
}

static inline float at_albedo(const struct weights *a, const float *column, int stride)
{
    float sum = 0;
    for (int j = 0; j < 4; ++j)
        if (a->w[j] != 0)
            sum += a->w[j] * column[(a->first + j) * stride];
    return sum;
}

/* A cubic on 0 … 1 by values and slopes (per the whole interval) at its ends: itself, and its integral from 0. */
struct cubic {
    float f0, f1, d0, d1;
};
static float cubic_at(struct cubic c, float t)
{
    return c.f0 + t * (c.d0 + t * (3 * (c.f1 - c.f0) - 2 * c.d0 - c.d1 + t * (2 * (c.f0 - c.f1) + c.d0 + c.d1)));
}
static float cubic_integral(struct cubic c, float t)
{
    return t * (c.f0 + t * (c.d0 / 2 + t * ((3 * (c.f1 - c.f0) - 2 * c.d0 - c.d1) / 3 +
                                            t * (2 * (c.f0 - c.f1) + c.d0 + c.d1) / 4)));
}
/* t with value(t) = target, where value grows; slope is its derivative. */
static float solve(struct cubic c, float target, float (*value)(struct cubic, float),
                   float (*slope)(struct cubic, float))
{
    float lo = 0, hi = 1, t = 0.5f;
    for (int i = 0; i < 40 && hi - lo > 1e-7f; ++i) {
        float excess = value(c, t) - target;
        if (excess == 0)
            break;
        if (excess > 0)
            hi = t;
        else
            lo = t;
        float d = slope(c, t), next = t - excess / d;
        next = next > lo && next < hi ? next : (lo + hi) / 2; // also where d is 0
        if (fabsf(next - t) < 1e-7f)
            return next;
        t = next;
    }
    return t;
}
static float cubic_slope(struct cubic c, float t)
{
    return c.d0 + t * (2 * (3 * (c.f1 - c.f0) - 2 * c.d0 - c.d1) + t * 3 * (2 * (c.f0 - c.f1) + c.d0 + c.d1));
}

// the slope between the neighbours of i
static float slope_at(const float *x, const float *f, int n, int i)
{
    int a = i > 0 ? i - 1 : 0, b = i < n - 1 ? i + 1 : n - 1;
    return (f[b] - f[a]) / (x[b] - x[a]);
}

static struct cubic cubic_of(const float *x, const float *f, int n, int i)
{
    float h = x[i + 1] - x[i];
    return (struct cubic){f[i], f[i + 1], h * slope_at(x, f, n, i), h * slope_at(x, f, n, i + 1)};
}

static void integrate(struct sr_diffusion *d, int j)
{
    float *sum = d->cumulative[j];
    for (int k = 0; k < RADII - 1; ++k)
        sum[k + 1] = sum[k] + (d->radius[k + 1] - d->radius[k]) *
                                  cubic_integral(cubic_of(d->radius, d->profile[j], RADII, k), 1);
    d->effective[j] = sum[RADII - 1];
}

const struct sr_diffusion *sr_diffusion_make(double g, double eta, struct sr_arena *arena, struct sr_error *error)
{
    struct sr_diffusion *d = sr_arena_alloc(arena, sizeof *d);
    if (!d) {
        sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a table of diffusion");
        return NULL;
    }
    d->radius[1] = 0.0025f;
    for (int k = 2; k < RADII; ++k)
        d->radius[k] = d->radius[k - 1] * 1.2f;
    for (int j = 0; j < ALBEDOS; ++j)
        d->albedo[j] = (float)(expm1(-8.0 * j / (ALBEDOS - 1)) / expm1(-8));
    struct subsurface_kernel kernel = subsurface_kernel_of(g, eta);
    double single[RADII]; // 2 pi r S for an albedo of 1, in proportion to which it is; at r = 0 it is finite
    for (int k = 0; k < RADII; ++k) {
        double r = k ? (double)d->radius[k] : 1e-4;
        single[k] = 2 * M_PI * r * subsurface_single(&kernel, 1, r);
    }
    for (int j = 0; j < ALBEDOS; ++j) {
        double albedo = (double)d->albedo[j];
        float *f = d->profile[j];
        for (int k = 0; k < RADII; ++k)
            f[k] = (float)(albedo * single[k] + 2 * M_PI * (double)d->radius[k] *
                                                    subsurface_multiple(&kernel, albedo, (double)d->radius[k]));
        integrate(d, j);
    }
    float most = d->effective[ALBEDOS - 1], knee = 0.98f;
    for (int j = 0; j < ALBEDOS; ++j) {
        float e = d->effective[j],
              factor = most > 1 && e > knee ? (knee + (1 - knee) * (e - knee) / (most - knee)) / e : 1;
        for (int k = 0; k < RADII; ++k)
            d->profile[j][k] *= factor;
        integrate(d, j);
        int k = 1;
        while (k < RADII - 1 && d->cumulative[j][k] < d->effective[j] * (1 - 1e-4f))
            ++k;
        d->reach[j] = d->radius[k];
    }
    return d;
}

float sr_diffusion_effective(const struct sr_diffusion *d, float albedo)
{
    struct weights a;
    return weights_at(d->albedo, ALBEDOS, sr_clamp(albedo, 0, 1), &a) ? at_albedo(&a, d->effective, 1) : 0;
}

float sr_diffusion_albedo(const struct sr_diffusion *d, float effective)
{
    if (!(effective > 0))
        return 0;
    if (effective >= d->effective[ALBEDOS - 1])
        return 1;
    int i = interval_of(d->effective, ALBEDOS, effective);
    float t = solve(cubic_of(d->albedo, d->effective, ALBEDOS, i), effective, cubic_at, cubic_slope);
    return d->albedo[i] + t * (d->albedo[i + 1] - d->albedo[i]);
}

float sr_bssrdf_reach(const struct sr_bssrdf *b, int i)
{
    const struct sr_diffusion *d = b->diffusion;
    if (!(b->sigma_t[i] > 0))
        return 0;
    int j = interval_of(d->albedo, ALBEDOS, b->albedo[i]);
    return sr_max(d->reach[j], d->reach[j + 1]) / b->sigma_t[i];
}

sr_spectrum sr_bssrdf_profile(const struct sr_bssrdf *b, float r, sr_spectrum *pdf)
{
    const struct sr_diffusion *d = b->diffusion;
    sr_spectrum S = SR_BLACK, p = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float radius = sr_max(r * b->sigma_t[i], 1e-6f); // at 0 the table says 0 / 0
        struct weights a, k;
        if (!(b->albedo[i] > 0) || !weights_at(d->albedo, ALBEDOS, b->albedo[i], &a) ||
            !weights_at(d->radius, RADII, radius, &k))
            continue;
        float sum = 0;
        for (int n = 0; n < 4; ++n)
            if (k.w[n] != 0)
                sum += k.w[n] * at_albedo(&a, &d->profile[0][k.first + n], RADII);
        S[i] = sr_max(sum, 0) * sr_sqr(b->sigma_t[i]) / (2 * SR_PI * radius);
        p[i] = S[i] / at_albedo(&a, d->effective, 1);
    }
    if (pdf)
        *pdf = p;
    return S;
}

float sr_bssrdf_sample(const struct sr_bssrdf *b, int i, float u)
{
    const struct sr_diffusion *d = b->diffusion;
    struct weights a;
    if (!(b->sigma_t[i] > 0) || !(b->albedo[i] > 0) || !weights_at(d->albedo, ALBEDOS, b->albedo[i], &a))
        return -1;
    float target = u * at_albedo(&a, d->effective, 1);
    int lo = 0, hi = RADII - 1;
    while (hi - lo > 1) {
        int middle = (lo + hi) / 2;
        if (at_albedo(&a, &d->cumulative[0][middle], RADII) <= target)
            lo = middle;
        else
            hi = middle;
    }
    float f[4], x[4]; // the profile about the interval
    int first = lo > 0 ? lo - 1 : 0, last = lo + 2 < RADII ? lo + 2 : RADII - 1;
    for (int k = first; k <= last; ++k) {
        f[k - first] = at_albedo(&a, &d->profile[0][k], RADII);
        x[k - first] = d->radius[k];
    }
    float h = d->radius[lo + 1] - d->radius[lo];
    float rest = (target - at_albedo(&a, &d->cumulative[0][lo], RADII)) / h;
    float t = solve(cubic_of(x, f, last - first + 1, lo - first), rest, cubic_integral, cubic_at);
    return (d->radius[lo] + t * h) / b->sigma_t[i];
}
