/* SPDX-License-Identifier: MIT */
/* Directions by the BSDF and by what has been learned: one of the two draws, and both densities count, so that the
 * weight f cos / p has no variance but that of the integrand against the mixture (Veach 1997, balance heuristic of one
 * sample). */
#include "integrator/mixture.h"

bool sr_mixture_sample(const struct sr_mixture *m, sr_u4 u, bool wants_guide, struct sr_bsdf_sample *s,
                       sr_spectrum *gain, struct sr_guide_record *r)
{
    sr_vec2 u2 = {u[0], u[1]};
    if (u[2] < m->share) {
        r->pdf_guide = sr_guide_sample(m->guide, m->cell, u2, &r->w);
        *s = (struct sr_bsdf_sample){.wi = sr_to_local(m->frame, r->w), .eta = 1, .lobe = SR_LOBE_GLOSSY};
        s->f = sr_bsdf_f_pdf(m->bsdf, m->wo, s->wi, SR_RADIANCE, &r->pdf_bsdf);
        s->lobe |= sr_same_hemisphere(m->wo, s->wi) ? SR_LOBE_REFLECTION : SR_LOBE_TRANSMISSION;
    } else {
        if (!sr_bsdf_sample(m->bsdf, m->wo, (u[2] - m->share) / (1 - m->share), u2, SR_RADIANCE, s))
            return false;
        r->w = sr_to_world(m->frame, s->wi);
        bool is_delta = s->lobe & SR_LOBE_SPECULAR;
        r->pdf_bsdf = s->pdf_is_proportional && !is_delta ? sr_bsdf_pdf(m->bsdf, m->wo, s->wi, SR_RADIANCE) : s->pdf;
        bool is_known = m->cell && m->cell->has_light && !is_delta && (m->share > 0 || wants_guide);
        r->pdf_guide = is_known ? sr_guide_pdf(m->guide, m->cell, r->w) : 0;
    }
    r->is_direction = !(s->lobe & SR_LOBE_SPECULAR);
    r->pdf = sr_guide_mix(m->share, r->pdf_bsdf, r->pdf_guide);
    // what the BSDF has drawn may share an unknown factor with its density: then only their ratio is known, and it is
    // weighed against the guide by a density like it
    float weight = u[2] < m->share              ? 1 / r->pdf
                   : m->share > 0 && r->pdf > 0 ? r->pdf_bsdf / (r->pdf * s->pdf)
                                                : 1 / ((1 - m->share) * s->pdf);
    *gain = s->f * (sr_abs_cos_theta(s->wi) * weight);
    return true;
}
