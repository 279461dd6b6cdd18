/* SPDX-License-Identifier: MIT */
/* Ward's gloss as Dür mended it: the light that Ward's loses toward grazing, given back.
 *
 *     f = reflectance / pi + specular exp(-tan^2 d (cos^2 p / ax^2 + sin^2 p / ay^2)) / (4 pi ax ay |zo| |zi|)   [1/sr]
 *
 * d and p are the half vector's angles. Reciprocal. At alpha = 0.2 E is 0.928 straight on and 0.918 at 80 degrees, but
 * at the horizon it grows without a bound, as 1 / |zo|: at alpha = 0.5, 1.33 at 85 and 5.1 at 89 degrees. A. Dür, An
 * improved normalization for the Ward reflectance model, 2006. */
#include "bsdf/ward.h"

static const struct sr_param params[] = WARD_PARAMS;

static inline float factor(sr_vec3 H, sr_vec3 wo, sr_vec3 wi)
{
    (void)H;
    return 1 / larger(fabsf(wo.z) * fabsf(wi.z), 1e-30f);
}

WARD_FUNCTIONS(sr_bsdf_ward_duer, factor)

const struct sr_bsdf_model sr_bsdf_ward_duer = {
    .name = "ward_duer",
    .title = "Ward, normalised by Dür",
    .source = "A. Dür, An improved normalization for the Ward reflectance model, 2006, eq. 5",
    .limits = "Makes light at grazing angles, without a bound: not for views beyond 80 degrees",
    .params = params,
    .size = sizeof(struct ward),
    .ready = ward_ready,
    .lobes = ward_lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .largest_albedo = INFINITY,
};
