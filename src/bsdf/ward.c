/* SPDX-License-Identifier: MIT */
/* Ward's fit to gloss that a gonioreflectometer saw, with brushed surfaces in mind: two slope widths.
 *
 *     f = reflectance / pi + specular exp(-tan^2 d (cos^2 p / ax^2 + sin^2 p / ay^2)) / (4 pi ax ay sqrt(|zo| |zi|))
 *         [1/sr]
 *
 * d and p are the half vector's angles. The exponent is the exact one (the paper's approximation, for a faster
 * hardware, is not). Reciprocal. specular is what a lobe far from the horizon would reflect: at alpha = 0.2 it is 0.895
 * of that straight on, 0.459 at 60 and 0.216 at 80 degrees; towards grazing E then grows again, without a bound, as 1 /
 * sqrt(|zo|). G. J. Ward, Measuring and modeling anisotropic reflection, 1992; B. Walter, Notes on the Ward BRDF, 2005.
 */
#include "bsdf/ward.h"

static const struct sr_param params[] = WARD_PARAMS;

static inline float factor(sr_vec3 H, sr_vec3 wo, sr_vec3 wi)
{
    (void)H;
    return 1 / (sqrtf(fabsf(wo.z)) * sqrtf(fabsf(wi.z)));
}

WARD_FUNCTIONS(sr_bsdf_ward, factor)

const struct sr_bsdf_model sr_bsdf_ward = {
    .name = "ward",
    .title = "Ward 1992",
    .source = "G. J. Ward, Measuring and modeling anisotropic reflection, 1992, eq. 4",
    .limits = "Loses light toward grazing (three quarters of it at 80 degrees), and makes it at the very horizon",
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
