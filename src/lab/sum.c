/* SPDX-License-Identifier: MIT */
/* A weighted sum of BSDFs, which is again a BSDF, because light adds up.
 *
 *     f = SUM w_j f_j  [1/sr],    pdf = SUM p_j pdf_j  [1/sr],    p_j = w_j / SUM w_j
 *
 * Delta lobes are drawn with the probability p_j times that of their part; so are parts whose density is known up to a
 * factor only, with their own f: one part at a time, right in the mean (Veach 1997, 9.2.4). Parts that reflect nothing
 * are not drawn. The sum conserves energy where SUM w_j E_j <= 1. */
#include "lab/private.h"

static uint32_t lobes(const void *self)
{
    const struct sum *m = self;
    uint32_t all = 0;
    for (int j = 0; j < m->count; ++j)
        all |= m->share[j] > 0 ? sr_bsdf_lobes(&m->parts[j]) : 0;
    return all;
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *pdf)
{
    const struct sum *m = self;
    sr_spectrum f = SR_BLACK;
    *pdf = 0;
    for (int j = 0; j < m->count; ++j)
        if (m->share[j] > 0) {
            float p;
            f += m->weight[j] * sr_bsdf_f_pdf(&m->parts[j], wo, wi, mode, &p);
            *pdf += m->share[j] * p;
        }
    return f;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return lab_sum.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    lab_sum.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct sum *m = self;
    int j = -1;
    for (int k = 0; k < m->count; ++k) {
        if (!(m->share[k] > 0))
            continue;
        if (j >= 0) { // beyond the part before
            u_lobe -= m->share[j];
        }
        j = k;
        if (u_lobe < m->share[k])
            break;
    }
    if (j < 0)
        return false;
    u_lobe = sr_clamp(u_lobe / m->share[j], 0, SR_ONE_MINUS_EPSILON);
    if (!sr_bsdf_sample(&m->parts[j], wo, u_lobe, u, mode, s))
        return false;
    if ((s->lobe & SR_LOBE_SPECULAR) || s->pdf_is_proportional) {
        s->f *= m->weight[j];
        s->pdf *= m->share[j];
        return s->pdf > 0;
    }
    if (m->count > 1) {
        s->f = lab_sum.f_pdf(self, wo, s->wi, mode, &s->pdf);
        return s->pdf > 0;
    }
    s->f *= m->weight[j];
    return true;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct sum *m = self;
    sr_spectrum E = SR_BLACK;
    for (int j = 0; j < m->count; ++j)
        if (m->share[j] > 0)
            E += m->weight[j] *
                 (m->parts[j].model->albedo ? m->parts[j].model->albedo(m->parts[j].data, wo) : SR_BLACK + NAN);
    return E;
}

static const struct sr_param params[] = {{0}};

#define SUM                                                                                                            \
    .name = "sum", .title = "Sum of BSDFs", .params = params, .size = sizeof(struct sum), .lobes = lobes, .f = f,      \
    .pdf = pdf, .sample = sample, .f_pdf = f_pdf, .albedo = albedo

const struct sr_bsdf_model lab_sum = {SUM};
const struct sr_bsdf_model lab_random_sum = {SUM, .is_random = true};
