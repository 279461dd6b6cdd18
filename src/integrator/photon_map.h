/* SPDX-License-Identifier: MIT */
/* For the estimators of this room: light that mirrors and clear glass have thrown on surfaces, as particles in a grid.
 *
 * A map is a pure function of the scene, the seed, the replicate and its number; whichever threads need it make it
 * together. */
#ifndef SR_INTEGRATOR_PHOTON_MAP_H
#define SR_INTEGRATOR_PHOTON_MAP_H

#include "integrator/integrator.h"

/* A particle where it arrives, after at least one delta reflection or refraction and nothing else. */
struct sr_photon {
    sr_spectrum flux; // [lm, as paths have it] of one of the map's paths
    sr_vec3 p;        // [m]
    sr_vec3 wi;       // [1] where it came from
    sr_vec3 n;        // [1] geometric normal of the surface
    uint32_t scatterings;
    bool is_single; // dispersion has ended all wavelengths but the first
};

struct sr_photon_map {
    struct sr_wavelengths w;   // of all its paths
    float radius;              // [m] of the disk that a photon is spread over
    uint64_t paths;            // that left the lights
    struct sr_photon *photons; // sorted by cell
    uint32_t count;
    uint32_t *cells; // first photon of each hashed cell, and one more
    uint32_t mask;   // number of cells less 1
};

struct sr_photon_plan {
    float radius;   // [m] of the first map; 0: derived from the scene
    uint64_t paths; // of each map; 0: as many as pixels
    int32_t max_depth;
};

/* What a picture's threads share. NULL: no memory. */
struct sr_photon_maps *sr_photon_maps_create(const struct sr_scene *scene, const struct sr_photon_plan *plan,
                                             const struct sr_picture_plan *picture);
void sr_photon_maps_destroy(struct sr_photon_maps *maps);
/* The map that goes with a sample. Valid until the thread asks for another; NULL: no memory. */
const struct sr_photon_map *sr_photon_map_of(struct sr_photon_maps *maps, uint32_t replicate, uint32_t sample,
                                             struct sr_worker *worker);

/* Calls f for each photon whose distance from p is less than the radius. */
void sr_photons_near(const struct sr_photon_map *map, sr_vec3 p, void (*f)(void *user, const struct sr_photon *photon),
                     void *user);

#endif
