/* SPDX-License-Identifier: MIT */
/* From what a scene file says of a light's brightness to a spectrum with that brightness.
 *
 *     s'(lambda) = luminance s(lambda) / INTEGRAL s ybar dlambda     so  INTEGRAL s' ybar dlambda = luminance  [cd/m^2]
 *
 * Spectra thus contain 683 lm/W: s' / 683 is in W m^-2 sr^-1 nm^-1. Of scenes in SI units s' = 683 s, and Planck's law
 * as it is. An RGB emission is rgb times a white illuminant, and is normalised by the white alone, as pbrt-v4 does:
 * grey 0.5 is half as bright as white. Limits: a spectrum without luminance (all of it outside 360 to 830 nm) has no
 * such factor and is refused. */
#include "light/emission.h"

#include "quantity/quantity.h"

static struct sr_spd white_of(enum sr_colour_space_id space)
{
    return (struct sr_spd){.kind = SR_SPD_TABLE, .scale = 1, .table = sr_colour_space(space)->illuminant};
}

sr_status sr_light_normalise(struct sr_spd *s, enum sr_colour_space_id space, float luminance, struct sr_error *error)
{
    if (s->kind == SR_SPD_NONE)
        *s = white_of(space);
    struct sr_spd measured = *s;
    if (s->kind == SR_SPD_ILLUMINANT)
        measured = (struct sr_spd){.kind = SR_SPD_TABLE, .scale = 1, .table = s->table};
    double integral = sr_spd_luminous_integral(&measured);
    if (integral > 0) {
        s->scale = (float)((double)s->scale * ((double)luminance / integral));
        return isfinite(s->scale) ? SR_OK : sr_fail(error, SR_ERROR_INPUT, "the emission of a light is not finite");
    }
    if (sr_spd_max(s) > 0)
        return sr_fail(
            error, SR_ERROR_INPUT,
            "the emission spectrum of a light has no luminance, so that it cannot be scaled to the brightness asked for");
    s->scale = 0;
    return SR_OK;
}

static bool has_own_unit(const struct sr_spd *s)
{
    return s->kind != SR_SPD_NONE && s->kind != SR_SPD_ILLUMINANT;
}

sr_status sr_light_set_brightness(struct sr_spd *s, enum sr_colour_space_id space, bool is_absolute, float scale,
                                  float share, struct sr_error *error)
{
    if (!is_absolute || !has_own_unit(s))
        return sr_light_normalise(s, space, scale * (share > 0 ? share : 1), error);
    double factor = (double)scale * (double)SR_KM;
    if (share > 0) {
        double given = sr_observer_integral(SR_RADIOMETRIC, s, (double)SR_LAMBDA_MIN, (double)SR_LAMBDA_MAX);
        if (!(given > 0))
            return sr_fail(error, SR_ERROR_INPUT,
                           "a light without radiation from 360 to 830 nm cannot be scaled to the power asked for");
        factor *= (double)share / given;
    } else if (s->kind == SR_SPD_BLACKBODY)
        factor *=
            sr_planck(2.897771955e6 / (double)s->temperature, (double)s->temperature); // its maximum, by Wien's law
    s->scale = (float)((double)s->scale * factor);
    return isfinite(s->scale) ? SR_OK : sr_fail(error, SR_ERROR_INPUT, "the emission of a light is not finite");
}

float sr_light_choice_weight(const struct sr_spd *s)
{
    return (float)(sr_spd_luminous_integral(s) + 1e-3 * SR_CIE_Y_INTEGRAL * (double)sr_spd_max(s));
}

sr_status sr_light_check_finite(const struct sr_texels *t, const char *filename, struct sr_error *error)
{
    size_t n = (size_t)t->width * t->height * t->channels;
    for (size_t i = 0; t->floats && i < n; ++i)
        if (!isfinite(t->floats[i]))
            return sr_fail(error, SR_ERROR_INPUT, "%s: texel %zu of a light's image is infinite or not a number",
                           filename, i / t->channels);
    return SR_OK;
}

sr_status sr_light_check_texels(const struct sr_texels *t, const char *filename, struct sr_error *error)
{
    if (t->channels < 3)
        return sr_fail(error, SR_ERROR_INPUT, "%s: the image of a light needs the channels R, G and B", filename);
    return sr_light_check_finite(t, filename, error);
}

double sr_light_mean_luminance(const struct sr_texels *t)
{
    double sum = 0;
    for (uint32_t y = 0; y < t->height; ++y)
        for (uint32_t x = 0; x < t->width; ++x)
            sum += sr_light_texel_luminance(t, x, y);
    return sum / ((double)t->width * t->height);
}

float sr_light_delta_pdf(const void *self, const struct sr_point *reference, sr_vec3 wi, const struct sr_point *there)
{
    (void)self, (void)reference, (void)wi, (void)there;
    return 0;
}

sr_spectrum sr_light_delta_Le(const void *self, const struct sr_point *there, sr_vec3 w,
                              const struct sr_wavelengths *wavelengths)
{
    (void)self, (void)there, (void)w, (void)wavelengths;
    return SR_BLACK;
}
