/* SPDX-License-Identifier: MIT */
/* A measured material: a file of BSDF data, whatever its format.
 *
 *     f = the file's value between its measurements [1/sr];
 *         pdf in proportion to f |cos_theta_i|, tabulated for each view
 *
 * MERL binary, RGL tensor files (pbrt's "measured"), polarised tensor files, BSDF XML (Klems matrices and tensor
 * trees), Cornell goniometer data, ASTM text, ABg coefficients, and plain tables: see the room measured/. Data break
 * what models keep: they are reciprocal and keep energy as well as they were measured. Data of one side serve for both.
 */
#include "bsdf/bsdf.h"
#include "measured/measured.h"

struct measured {
    const char *filename;
    int32_t quantity, angles;
    const struct sr_measured *data;
    sr_spectrum lambda; // [nm]
};

static const struct sr_param params[] = {
    {SR_PARAM_FILE, "filename", "1", 0, 0, 0, offsetof(struct measured, filename), "file of BSDF data"},
    {SR_PARAM_ENUM, "quantity", "1", 0, 3, 0, offsetof(struct measured, quantity), "auto|bsdf|cosine|factor"},
    {SR_PARAM_ENUM, "angles", "1", 0, 2, 0, offsetof(struct measured, angles), "auto|degrees|radians"},
    {0},
};

static sr_status load(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct measured *m = self;
    if (!m->filename || !m->filename[0])
        return sr_fail(error, SR_ERROR_INPUT, "a measured material needs the parameter filename");
    return sr_measured_read(m->filename, &(struct sr_measured_options){.quantity = m->quantity, .angles = m->angles},
                            arena, &m->data, error);
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    ((struct measured *)self)->lambda = at->lambda;
}

static uint32_t lobes(const void *self)
{
    const struct measured *m = self;
    uint32_t sides = sr_measured_sides(m->data);
    return SR_LOBE_GLOSSY | (sides & SR_MEASURED_REFLECTION ? SR_LOBE_REFLECTION : 0) |
           (sides & SR_MEASURED_TRANSMISSION ? SR_LOBE_TRANSMISSION : 0);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct measured *m = self;
    return mode == SR_RADIANCE ? sr_measured_f(m->data, wo, wi, m->lambda) : sr_measured_f(m->data, wi, wo, m->lambda);
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct measured *m = self;
    (void)mode;
    return sr_measured_pdf(m->data, wo, wi);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct measured *m = self;
    *s = (struct sr_bsdf_sample){.eta = 1};
    if (!sr_measured_sample(m->data, wo, u_lobe, u, &s->wi, &s->pdf))
        return false;
    s->lobe = SR_LOBE_GLOSSY | (sr_same_hemisphere(wo, s->wi) ? SR_LOBE_REFLECTION : SR_LOBE_TRANSMISSION);
    s->f = f(self, wo, s->wi, mode);
    return true;
}

const struct sr_bsdf_model sr_bsdf_measured = {
    .name = "measured",
    .title = "Measured data",
    .source = "the file's authors",
    .limits = "only as good as the measurement: reciprocity, energy and coverage are reported for each file",
    .params = params,
    .size = sizeof(struct measured),
    .load = load,
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .asymmetry = 1,
};
