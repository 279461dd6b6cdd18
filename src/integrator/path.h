/* SPDX-License-Identifier: MIT */
/* Path tracing and volumetric path tracing take the same parameters, and without media they are the same. */
#ifndef SR_INTEGRATOR_PATH_H
#define SR_INTEGRATOR_PATH_H

#include "integrator/integrator.h"

struct sr_path {
    int32_t max_depth;     // most scatterings of a path
    int32_t light_sampler; // enum sr_light_choice; the scene was finished with it
    bool regularize;
    bool subsurface; // light goes through translucent bodies
};
// rows of a table: one line each, or two
// clang-format off
#define SR_PATH_PARAMS(is_through_bodies) \
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct sr_path, max_depth), "most scatterings of a path"}, \
    {SR_PARAM_ENUM, "lightsampler", "1", 0, 3, 0, offsetof(struct sr_path, light_sampler), \
     "bvh|power|uniform|exhaustive"}, \
    {SR_PARAM_BOOL, "regularize", "1", 0, 1, 0, offsetof(struct sr_path, regularize), \
     "accepted; never done, for it is biased"}, \
    {SR_PARAM_BOOL, "subsurface", "1", 0, 1, is_through_bodies, offsetof(struct sr_path, subsurface), \
     "light goes through bodies of the material \"subsurface\"; false: they are glass, as for pbrt's path"}
// clang-format on
bool sr_path_enters_bodies(const void *self);
extern const struct sr_integrator_model sr_integrator_path, sr_integrator_volpath;

/* Light that reaches x straight from a light and leaves toward wo, were nothing in between; false: none. */
static inline bool sr_path_direct(const struct sr_lights *lights, const struct sr_point *x,
                                  const struct sr_frame *frame, const struct sr_bsdf *bsdf, sr_vec3 wo, sr_u4 u,
                                  const struct sr_wavelengths *w, struct sr_light_sample *l, sr_spectrum *L)
{
    uint32_t index;
    float pmf;
    if (!sr_lights_pick(lights, x, u[2], &index, &pmf) ||
        !sr_light_draw(lights->lights[index], x, (sr_vec2){u[0], u[1]}, w, l))
        return false;

    sr_vec3 wi = sr_to_local(frame, l->wi);
    float pdf = pmf * l->pdf, pdf_bsdf;
    sr_spectrum f = sr_bsdf_f_pdf(bsdf, wo, wi, SR_RADIANCE, &pdf_bsdf);
    sr_spectrum fL = f * l->L * sr_abs_cos_theta(wi);
    *L = fL * ((l->is_delta ? 1 : sr_mis_weight(pdf, pdf_bsdf)) / pdf);
    return sr_spectrum_any(fL > 0.0f);
}

#endif
