/* SPDX-License-Identifier: MIT */
/* For guided paths: directions at a surface of which a share is drawn by what has been learned, the rest by the BSDF.
 *
 *     p(wi) = (1 - a) p_bsdf(wi) + a p_guide(x, wi)        [1/sr] */
#ifndef SR_INTEGRATOR_MIXTURE_H
#define SR_INTEGRATOR_MIXTURE_H

#include "bsdf/bsdf.h"
#include "integrator/guide.h"

struct sr_mixture {
    const struct sr_guide *guide;
    const struct sr_guide_cell *cell; // NULL: the share is 0
    float share;                      // a
    const struct sr_bsdf *bsdf;
    const struct sr_frame *frame;
    sr_vec3 wo; // in the frame
};

/* Of the direction w, for which the BSDF alone has pdf_bsdf. */
static inline float sr_mixture_pdf(const struct sr_mixture *m, sr_vec3 w, float pdf_bsdf)
{
    return sr_guide_mix(m->share, pdf_bsdf, sr_guide_pdf(m->guide, m->cell, w));
}

/* Draws w; u[2] chooses by what. gain: f |cos theta| / p; r: w and its densities, that of the guide where it has a
 * share or is wanted. false: the path ends. */
bool sr_mixture_sample(const struct sr_mixture *m, sr_u4 u, bool wants_guide, struct sr_bsdf_sample *s,
                       sr_spectrum *gain, struct sr_guide_record *r);

#endif
