/* SPDX-License-Identifier: MIT */
/* From one surface to the next through a medium, at all wavelengths of a path (docs/theory/volumes.md).
 *
 *     T(t) = exp(-integral sigma_t ds),     density of being scattered at t: sigma_t(t) T(t)     [1], [1/m]
 *
 * The distance is drawn for the first wavelength. Each other one might have been the first, and would have drawn the
 * same path with another density: what the path brings is divided by the mean of all eight (Miller, Georgiev & Jarosz
 * 2019). Where sigma_t varies, a majorant of it takes its place, and most of what is met are null collisions (Woodcock
 * et al. 1965). */
#ifndef SR_INTEGRATOR_FLIGHT_H
#define SR_INTEGRATOR_FLIGHT_H

#include "integrator/integrator.h"

/* What a path carries; all three divided by the density with which the first wavelength has drawn the path. */
struct sr_carried {
    sr_spectrum f; // the path's throughput                                       [1]
    sr_spectrum q; // densities that other wavelengths would have drawn it with   [1]
    sr_spectrum r; // the same, had a light sample led from the last scattering to here, but for the light's density; 0:
                   // none could
    sr_spectrum L; // radiance gathered so far                                    [W m^-2 sr^-1 nm^-1]
};

/* What light from x that arrives over a path's whole way would bring, with weight. */
static inline sr_spectrum sr_carried_to(const struct sr_carried *c, sr_spectrum L, float light_density)
{
    return c->f * L * (1 / sr_spectrum_mean(c->q + c->r * light_density));
}

/* In a segment: where a majorant is far above what is there, steps may be shorter than floats can tell, and never end.
 * The sample is given up then, as one that is no number: told and counted. */
enum { SR_MOST_NULLS = 1 << 18 };
enum sr_flight { SR_FLIGHT_THROUGH, SR_FLIGHT_SCATTERED, SR_FLIGHT_LOST };

/* Along the ray, t = 0 … length. depth: optical depth that the first wavelength may still go; what is gone through is
 * subtracted. at: of a uniform medium, filled beforehand; of others, filled where light is scattered. */
enum sr_flight sr_fly(const struct sr_medium *medium, const struct sr_ray *ray, float length,
                      const struct sr_wavelengths *w, struct sr_rng *rng, float *depth, struct sr_medium_at *at,
                      struct sr_carried *c, float *t);

/* Straight through, whatever is there: as sr_carried, of this way alone, and all three over a common factor. */
struct sr_passage {
    sr_spectrum T; // what is transmitted; its expectation, over S, is the transmittance
    sr_spectrum S; // density of this walk, which is never scattered
    sr_spectrum U; // density of the same steps by a walk that might have been
};
/* false: nothing comes through. */
bool sr_pass(const struct sr_medium *medium, sr_vec3 o, sr_vec3 d, float length, const struct sr_wavelengths *w,
             struct sr_rng *rng, struct sr_passage *p);
/* Through all that is between x, in `medium`, and a light. false: something opaque is. */
bool sr_pass_to_light(const struct sr_scene *scene, const struct sr_point *x, const struct sr_medium *medium,
                      const struct sr_light_sample *l, const struct sr_wavelengths *w, struct sr_rng *rng,
                      struct sr_worker *worker, struct sr_passage *p);

#endif
