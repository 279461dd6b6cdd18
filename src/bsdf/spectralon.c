/* SPDX-License-Identifier: MIT */
/* Spectralon (sintered PTFE of 99 %), the white that others are measured against, as it was measured: 8 deg /
 * hemispherical reflectance of 250 ... 2500 nm from calibrations, and directions from a goniometer, where it is no
 * Lambert surface: 7 % brighter than one where light and viewer are at the normal, darker to grazing, up to 80 %
 * brighter toward the forward direction at 70 deg.
 *
 *     f = rho(lambda) / pi (1 + SUM_mab c_mab (Z_ma(wi) Z_mb(wo) + Z_mb(wi) Z_ma(wo)))   [1/sr]
 *
 * Z_mk(w) = R_(m + 2 k)^m (sin theta) exp(i m phi) are Zernike's polynomials on the disk under the hemisphere, real
 * parts of products taken, up to order 8, without the constant one (Koenderink, van Doorn & Stavridi 1996: modes of
 * scattering). They are orthogonal to 1 by projected solid angle, so that f is reciprocal and E(wo) = rho(lambda) from
 * every direction, and that is what the calibration says of 8 deg. c = c0 + (redness - 1) c1, redness = (0.0209 lambda
 * / um + 0.978)^2.94: the forward scattering of long waves is stronger. pdf = cos_theta_i / pi.
 *
 * Data: panel 4 of the GRIT laboratory and its published goniometer fit for 0 ... 70 deg (A comprehensive BRF model for
 * Spectralon, IEEE TGRS 2024), normalised by its integral over the whole hemisphere, which makes it reciprocal; the
 * modes reproduce it with 0.4 % rms, 3.1 % at most (both at 70 deg), 1.2 % within 60 deg. "9710" ... are other panels'
 * calibrations. Limits: beyond 70 deg extrapolated; wavelengths outside 250 ... 2500 nm as at the ends; the peak within
 * 5 deg of the direction to the light is not in the data. */
#include "bsdf/hemisphere.h"
#include "bsdf/spectralon_data.h"

struct spectralon {
    int32_t panel;
    sr_spectrum reflectance, excess; // by ready: rho, redness - 1
};

static const struct sr_param params[] = {
    {SR_PARAM_ENUM, "panel", "", 0, 4, 0, offsetof(struct spectralon, panel), SPECTRALON_PANELS},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct spectralon *m = self;
    const uint16_t *table = spectralon_reflectance[m->panel];
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
        float x = sr_clamp((at->lambda[k] - SPECTRALON_FIRST) / SPECTRALON_STEP, 0, SPECTRALON_COUNT - 1);
        int i = x < SPECTRALON_COUNT - 1 ? (int)x : SPECTRALON_COUNT - 2;
        m->reflectance[k] = 1e-4f * sr_lerp(x - (float)i, table[i], table[i + 1]);
        float um = 1e-3f * (SPECTRALON_FIRST + x * SPECTRALON_STEP);
        m->excess[k] = powf(spectralon_redness[0] * um + spectralon_redness[1], spectralon_redness[2]) - 1;
    }
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

enum { ORDER = 8, GROWING_ORDER = 4 };

/* Q_k(t), k = 0 ... count - 1, of the order m */
static void radial(int m, int count, float t, float q[5])
{
    for (int k = 0; k < count; ++k) {
        float sum = 0;
        for (int j = k; j >= 0; --j)
            sum = sum * t + spectralon_radial[m][k][j];
        q[k] = sum;
    }
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct spectralon *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float t_o = sin2_theta(wo), t_i = sin2_theta(wi), dot = wo.x * wi.x + wo.y * wi.y, steady = 1, growing = 0;
    float turned[2] = {1, dot}; // (sin_i sin_o)^m cos m (phi_i - phi_o), of two m
    const float *c0 = spectralon_steady, *c1 = spectralon_growing;
    for (int order = 0; order <= ORDER; ++order) {
        int first = order == 0, count = (ORDER - order) / 2 + 1,
            grows = GROWING_ORDER < order ? 0 : (GROWING_ORDER - order) / 2 + 1;
        float q_o[5], q_i[5], s = 0, g = 0;
        radial(order, count, t_o, q_o);
        radial(order, count, t_i, q_i);
        for (int a = first; a < count; ++a)
            for (int b = a; b < count; ++b) {
                float both = a == b ? q_o[a] * q_i[a] : q_o[a] * q_i[b] + q_i[a] * q_o[b];
                s += *c0++ * both;
                if (b < grows)
                    g += *c1++ * both;
            }
        steady += s * turned[0];
        growing += g * turned[0];
        float next = 2 * dot * turned[1] - t_o * t_i * turned[0];
        turned[0] = turned[1];
        turned[1] = next;
    }
    return m->reflectance * SR_INV_PI * (steady + m->excess * growing);
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)self;
    (void)mode;
    return upper(&wo, &wi) ? wi.z * SR_INV_PI : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)u_lobe;
    return finish(&sr_bsdf_spectralon, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct spectralon *m = self;
    (void)wo;
    return m->reflectance;
}

const struct sr_bsdf_model sr_bsdf_spectralon = {
    .name = "spectralon",
    .title = "Spectralon SRS-99, measured",
    .source = "GRIT laboratory, A comprehensive BRF model for Spectralon, IEEE TGRS 2024; Labsphere's calibrations",
    .limits = "Measured to 70 deg; extrapolated beyond.",
    .params = params,
    .size = sizeof(struct spectralon),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
};
