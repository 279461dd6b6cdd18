/* SPDX-License-Identifier: MIT */
/* What a medium radiates where it is thick.
 *
 *     Le'(lambda) = scale Le(lambda) / INTEGRAL Le ybar dlambda          so  INTEGRAL Le' ybar dlambda = scale [cd/m^2]
 *
 * as lights do: spectra contain 683 lm/W. Of an rgb emission the white alone is scaled to 1, and rgb multiplies it
 * (pbrt-v4). In scenes of absolute units Le' = 683 scale Le, and black bodies follow Planck's law (1901). */
#include "medium/private.h"

static const float coldest = 100; // [K] below that nothing is seen: Le is 0, as in pbrt

static double planck_maximum(float temperature) // [W m^-2 sr^-1 nm^-1], at the wavelength of Wien's law
{
    return sr_planck(2.897771955e6 / (double)temperature, (double)temperature);
}

sr_status sr_medium_set_emission(struct sr_spd *Le, const struct sr_medium_common *common, float scale,
                                 struct sr_error *error)
{
    if (Le->kind == SR_SPD_NONE || !(scale * sr_spd_max(Le) > 0)) {
        *Le = (struct sr_spd){.kind = SR_SPD_NONE};
        return SR_OK;
    }
    double factor = (double)scale;
    if (common->is_absolute && Le->kind != SR_SPD_ILLUMINANT)
        factor *= (double)SR_KM * (Le->kind == SR_SPD_BLACKBODY ? planck_maximum(Le->temperature) : 1);
    else {
        struct sr_spd measured = *Le;
        if (Le->kind == SR_SPD_ILLUMINANT)
            measured = (struct sr_spd){.kind = SR_SPD_TABLE, .scale = 1, .table = Le->table};
        double luminance = sr_spd_luminous_integral(&measured);
        if (!(luminance > 0))
            return sr_fail(
                error, SR_ERROR_INPUT,
                "the emission spectrum \"Le\" has no luminance, so that it cannot be scaled to the brightness asked for");
        factor /= luminance;
    }
    Le->scale = (float)((double)Le->scale * factor);
    return isfinite(Le->scale) ? SR_OK : sr_fail(error, SR_ERROR_INPUT, "the emission \"Le\" is not finite");
}

sr_spectrum sr_medium_blackbody(float temperature, bool is_absolute, const struct sr_wavelengths *w)
{
    if (!(temperature > coldest))
        return SR_BLACK;
    struct sr_spd s = sr_spd_blackbody(temperature);
    if (is_absolute)
        s.scale *= (float)((double)SR_KM * planck_maximum(temperature));
    return sr_spd_eval(&s, w->lambda);
}

sr_status sr_medium_scale(struct sr_spd *sigma_a, struct sr_spd *sigma_s, float scale, struct sr_error *error)
{
    sigma_a->scale *= scale;
    sigma_s->scale *= scale;
    if (!isfinite(sr_spd_max(sigma_a) + sr_spd_max(sigma_s)))
        return sr_fail(error, SR_ERROR_INPUT, "\"sigma_a\" and \"sigma_s\" times \"scale\" %g are not finite",
                       (double)scale);
    return SR_OK;
}
