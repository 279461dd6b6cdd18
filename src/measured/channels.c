/* SPDX-License-Identifier: MIT */
/* Values over wavelengths: one grey channel, three of linear sRGB, or many of a spectrum; and the way back to RGB.
 *
 *     f(lambda) = SUM over corners of weight_k v_k(lambda)
 *
 * linear between the two neighbouring wavelengths, constant beyond the outermost. RGB is summed first and then made a
 * spectrum (Jakob & Hanika 2019, scaled by twice the greatest component), so that f stays linear along each colour. */
#include "measured/private.h"

bool channels_set_lambda(struct channels *c, const float *lambda, int count)
{
    for (int i = 0; i < count; ++i)
        if (!(lambda[i] > (i ? lambda[i - 1] : 0)) || !isfinite(lambda[i]))
            return false;
    c->kind = CHANNEL_SPECTRAL;
    c->count = count;
    c->lambda = lambda;
    c->first = lambda[0];
    c->step = count > 1 ? (lambda[count - 1] - lambda[0]) / (float)(count - 1) : 0;
    for (int i = 0; i < count; ++i)
        if (fabsf(lambda[i] - (c->first + (float)i * c->step)) > 1e-3f)
            c->step = 0;
    return true;
}

static float sum_of(const float *values, const struct corners *at)
{
    float sum = 0;
    for (int k = 0; k < at->count; ++k)
        sum += at->weight[k] * values[at->base[k]];
    return sum;
}

sr_spectrum uplift_at(float r, float g, float b, sr_spectrum lambda)
{
    struct sr_rgb rgb = {sr_max(r, 0), sr_max(g, 0), sr_max(b, 0)};
    if (!(rgb.r + rgb.g + rgb.b > 0))
        return SR_BLACK;
    struct sr_spd s = sr_spd_from_rgb_unbounded(SR_SRGB, rgb);
    return sr_spd_eval(&s, lambda);
}

static float linear(const struct channels *c, float sum)
{
    return c->log_offset > 0 ? sr_max(expf(sum) - c->log_offset, 0) : sum;
}

sr_spectrum channels_eval(const struct channels *c, const float *values, const struct corners *at, sr_spectrum lambda)
{
    if (c->kind == CHANNEL_GREY)
        return SR_BLACK + linear(c, sum_of(values, at));
    if (c->kind == CHANNEL_RGB)
        return uplift_at(linear(c, sum_of(values, at)), linear(c, sum_of(values + c->stride, at)),
                         linear(c, sum_of(values + 2 * c->stride, at)), lambda);
    sr_spectrum f = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float t;
        int band;
        if (c->step > 0) {
            float x = sr_clamp((lambda[i] - c->first) / c->step, 0, (float)(c->count - 1));
            band = (int)x < c->count - 1 ? (int)x : c->count - 2;
            t = x - (float)band;
        } else
            band = axis_find(c->lambda, c->count, lambda[i], &t);
        const float *v = values + (size_t)band * c->stride;
        float value = sum_of(v, at);
        if (t > 0)
            value += t * (sum_of(v + c->stride, at) - value);
        f[i] = value;
    }
    if (c->log_offset > 0) {
        f = sr_spectrum_exp(f) - c->log_offset;
        f = sr_spectrum_select(f > 0.0f, f, SR_BLACK);
    }
    return f;
}

/* rgb = M xyz, xyz = SUM of S(lambda) (x, y, z)bar f(lambda) over that of f = 1; each row is made to sum to 1 exactly,
 * so that white is (1, 1, 1). */
struct rgb_weights rgb_weights_make(void)
{
    const struct sr_colour_space *space = sr_colour_space(SR_SRGB);
    struct sr_spd white = {.kind = SR_SPD_TABLE, .scale = 1, .table = space->illuminant};
    struct rgb_weights w;
    double total[3] = {0};
    enum { N = RGB_BANDS * SR_LAMBDA_COUNT };
    double row[3][N];
    for (int n = 0; n < N; ++n) {
        double lambda = 380 + 400.0 * n / (N - 1), xyz[3];
        sr_observer_1931(lambda, xyz);
        double S = (double)sr_spd_at(&white, (float)lambda);
        for (int c = 0; c < 3; ++c) {
            row[c][n] = 0;
            for (int k = 0; k < 3; ++k)
                row[c][n] += space->rgb_from_xyz[c][k] * xyz[k] * S;
            total[c] += row[c][n];
        }
        w.lambda[n / SR_LAMBDA_COUNT][n % SR_LAMBDA_COUNT] = (float)lambda;
    }
    for (int n = 0; n < N; ++n) {
        w.r[n / SR_LAMBDA_COUNT][n % SR_LAMBDA_COUNT] = (float)(row[0][n] / total[0]);
        w.g[n / SR_LAMBDA_COUNT][n % SR_LAMBDA_COUNT] = (float)(row[1][n] / total[1]);
        w.b[n / SR_LAMBDA_COUNT][n % SR_LAMBDA_COUNT] = (float)(row[2][n] / total[2]);
    }
    return w;
}

static float component_sum(sr_spectrum s)
{
    return sr_spectrum_mean(s) * SR_LAMBDA_COUNT;
}

struct sr_rgb rgb_of(const struct rgb_weights *w, sr_measured_source f, void *user, sr_vec3 wo, sr_vec3 wi)
{
    sr_spectrum r = SR_BLACK, g = SR_BLACK, b = SR_BLACK;
    for (int k = 0; k < RGB_BANDS; ++k) {
        sr_spectrum value = f(user, wo, wi, w->lambda[k]);
        r += w->r[k] * value;
        g += w->g[k] * value;
        b += w->b[k] * value;
    }
    return (struct sr_rgb){component_sum(r), component_sum(g), component_sum(b)};
}

/* XYZ scaled so that a perfect reflector has Y = 1 and the white of the space. */
struct sr_rgb rgb_of_xyz(float x, float y, float z)
{
    struct sr_rgb rgb = sr_rgb_from_xyz(sr_colour_space(SR_SRGB), (struct sr_xyz){x, y, z});
    return (struct sr_rgb){sr_max(rgb.r, 0), sr_max(rgb.g, 0), sr_max(rgb.b, 0)};
}
