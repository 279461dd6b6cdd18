/* SPDX-License-Identifier: MIT */
/* A ball of a specimen under a simple sky: what the eye makes of a BSDF.
 *
 *     L(p, wo) = INTEGRAL f(wo, wi) L_sky(wi) |cos_theta_i| d wi       [1 of the sky's unit, per wavelength]
 *
 * The ball is of unit radius and convex: what leaves it upward from a point meets the sky, what goes inside meets the
 * wall again, at most 32 times. The round light is sampled by itself and by the BSDF, weighed by the balance heuristic
 * (Veach & Guibas 1995). All light has the spectrum of D65. Tones: Y (1 + Y / 16) / (1 + Y), Y times 2.2 (Reinhard et
 * al. 2002), then sRGB. */
#include "lab/private.h"

struct ball {
    const struct sr_specimen *specimen;
    struct sr_spd d65;
    float d65_scale; // 1 / (the light's luminous integral)
    sr_vec3 sun;
    float cos_sun, sun_radiance;
    bool has_sky;
    uint32_t size, samples;
    uint8_t *srgb;
};

static float sky(const struct ball *b, sr_vec3 w)
{
    if (!b->has_sky)
        return 0;
    float t = sr_clamp(w.y, -1, 1);
    if (t < 0)
        return 0.16f + 0.06f * -t; // the ground
    float horizon = 0.75f - 0.45f * sqrtf(t);
    return t < 0.03f ? sr_lerp(t / 0.03f, 0.16f, horizon) : horizon;
}

static float radiance(const struct ball *b, sr_vec3 w, float *pdf_light)
{
    bool is_sun = sr_dot(w, b->sun) > b->cos_sun;
    *pdf_light = is_sun ? 1 / (2 * SR_PI * (1 - b->cos_sun)) : 0;
    return sky(b, w) + (is_sun ? b->sun_radiance : 0);
}

/* One path; the sum of what it gathers at the wavelengths. */
static sr_spectrum gather(const struct ball *b, sr_vec3 p, sr_spectrum lambda, struct sr_sampler *sampler,
                          uint32_t seed)
{
    enum { BOUNCES = 32 };
    sr_spectrum L = SR_BLACK, beta = SR_ONE;
    sr_vec3 wo = {0, 0, 1};
    struct sr_specimen_at at;
    for (uint32_t bounce = 0; bounce < BOUNCES; ++bounce) {
        struct sr_frame frame = sr_frame_from_zx(p, sr_cross((sr_vec3){0, 1, 0}, p));
        sr_vec3 local = sr_to_local(&frame, wo);
        sr_specimen_at(b->specimen, lambda, sr_hash_combine(seed, bounce), &at);
        if (!at.bsdf.model || local.z == 0)
            return L;
        sr_u4 u = sr_sample4(sampler, 1 + 2 * bounce), v = sr_sample4(sampler, 2 + 2 * bounce);

        // the round light
        float cos_off = 1 - u[2] * (1 - b->cos_sun);
        struct sr_frame about = sr_frame_from_z(b->sun);
        sr_vec3 toward =
            sr_to_world(&about, sr_spherical_direction(sr_safe_sqrt(1 - cos_off * cos_off), cos_off, 2 * SR_PI * u[3]));
        sr_vec3 wi = sr_to_local(&frame, toward);
        float pdf_light = 1 / (2 * SR_PI * (1 - b->cos_sun));
        if (wi.z > 0) {
            float pdf;
            sr_spectrum f = sr_bsdf_f_pdf(&at.bsdf, local, wi, SR_RADIANCE, &pdf);
            L += beta * f * (b->sun_radiance * wi.z / (pdf_light + pdf));
        }

        struct sr_bsdf_sample s;
        if (!sr_bsdf_sample(&at.bsdf, local, v[0], (sr_vec2){u[0], u[1]}, SR_RADIANCE, &s) || !(s.pdf > 0))
            return L;
        beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
        sr_vec3 d = sr_to_world(&frame, s.wi);
        if (s.wi.z > 0) { // out
            float pdf_same, other = radiance(b, d, &pdf_same) - sky(b, d);
            float pdf = s.pdf_is_proportional ? sr_bsdf_pdf(&at.bsdf, local, s.wi, SR_RADIANCE) : s.pdf;
            float share = (s.lobe & SR_LOBE_SPECULAR) ? 1 : pdf / (pdf + pdf_same);
            return L + beta * (sky(b, d) + other * share);
        }
        p = sr_normalize(sr_mad(p, -2 * sr_dot(p, d), d)); // p - 2 (p.d) d: the chord's other end
        wo = sr_neg(d);
        if (sr_spectrum_max(beta) < 1e-3f)
            return L;
    }
    return L;
}

static sr_vec3 tone(const double xyz[3])
{
    double y = 2.2 * xyz[1], mapped = 2.2 * (1 + y / 16) / (1 + y);
    struct sr_xyz v = {(float)(xyz[0] * mapped), (float)(xyz[1] * mapped), (float)(xyz[2] * mapped)};
    struct sr_rgb rgb = sr_rgb_from_xyz(sr_colour_space(SR_SRGB), v);
    return (sr_vec3){rgb.r, rgb.g, rgb.b};
}

static void render_row(void *context, uint64_t row)
{
    const struct ball *b = context;
    for (uint32_t column = 0; column < b->size; ++column) {
        double xyz[3] = {0};
        uint32_t hits = 0;
        for (uint32_t i = 0; i < b->samples; ++i) {
            struct sr_sampler sampler = sr_sampler_start(SR_SAMPLER_SOBOL, 1, column, (uint32_t)row, 0, i);
            sr_u4 u = sr_sample4(&sampler, 0);
            float x = 2.06f * (((float)column + u[0]) / (float)b->size - 0.5f);
            float y = 2.06f * (0.5f - ((float)row + u[1]) / (float)b->size);
            if (x * x + y * y >= 1)
                continue;
            struct sr_wavelengths w =
                sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, u[2]);
            uint32_t seed = sr_hash_combine((uint32_t)row * b->size + column, i);
            sr_vec3 p = {x, y, sr_safe_sqrt(1 - x * x - y * y)};
            sr_spectrum L = gather(b, p, w.lambda, &sampler, seed) * sr_spd_eval(&b->d65, w.lambda) * b->d65_scale;
            if (!sr_spectrum_is_finite(L))
                continue;
            struct sr_xyz one = sr_spectrum_to_xyz(L, &w);
            xyz[0] += (double)one.x;
            xyz[1] += (double)one.y;
            xyz[2] += (double)one.z;
            ++hits;
        }
        for (int c = 0; c < 3; ++c)
            xyz[c] /= hits ? hits : 1;
        sr_vec3 rgb = tone(xyz);
        float cover = (float)hits / (float)b->samples;
        uint8_t *out = b->srgb + 3 * (row * b->size + column);
        for (int c = 0; c < 3; ++c) {
            float v = sr_lerp(cover, 1, sr_clamp(sr_component(rgb, c), 0, 1));
            out[c] = (uint8_t)lrintf(255 * sr_clamp(sr_srgb_encode(v), 0, 1));
        }
    }
}

sr_status sr_specimen_ball(const struct sr_specimen *specimen, enum sr_ball_light light, uint32_t size,
                           uint32_t samples, uint8_t *srgb, struct sr_error *error)
{
    if (size < 1 || size > 4096 || samples < 1 || samples > 1 << 16)
        return sr_fail(error, SR_ERROR_INPUT, "a ball of %u pixels with %u samples: up to 4096 and 65536 are drawn",
                       size, samples);
    struct ball b = {.specimen = specimen,
                     .d65 = sr_spd_named("stdillum-D65"),
                     .size = size,
                     .samples = samples,
                     .srgb = srgb,
                     .has_sky = light == SR_BALL_SKY};
    b.d65_scale = (float)(1 / sr_spd_luminous_integral(&b.d65));
    b.sun = sr_normalize((sr_vec3){-0.55f, 0.62f, 0.56f});
    b.cos_sun = cosf(sr_radians(light == SR_BALL_SKY ? 12 : 0.25f));
    // irradiance of a surface that faces it: that of a white sky; a sky of its own adds a third
    b.sun_radiance = (light == SR_BALL_SKY ? 0.8f : 1.2f) / (2 * (1 - b.cos_sun));
    sr_parallel_for(sr_thread_count(), size, render_row, &b);
    return SR_OK;
}
