/* SPDX-License-Identifier: MIT */
/* The estimators of the rendering equation: one file each.
 *
 *     L(x, wo) = Le(x, wo) + integral f(wo, wi) L(x, wi) |cos theta_i| dwi        [W m^-2 sr^-1 nm^-1] */
#ifndef SR_INTEGRATOR_INTEGRATOR_H
#define SR_INTEGRATOR_INTEGRATOR_H

#include "scene/scene.h"
#include "sensor/sensor.h"

#include <stdatomic.h>

/* What paths from the lights are told to: a sensor with its film, or a meter. It gains
 *
 *     beta f(w, wi) |cos theta| weight          w toward the target, cos theta of w at the vertex
 *
 * by each vertex that carries the flux beta; connect gives w and the weight (a sensor's: struct sr_sensor_view). */
struct sr_target {
    const void *self;
    bool (*connect)(const void *self, sr_vec3 p, float time, sr_vec2 u, struct sr_sensor_view *view);
    float (*density)(const void *self, sr_vec3 d, float distance,
                     float time);       // of a sensor's rays, for weighing; NULL: a meter
    float pixels;                       // [pixel^2] of the raster that they are spread over
    const struct sr_path_start *middle; // NULL, or a sensor ray, for footprints
    struct sr_sampler sampler;          // of the path from the lights that is wanted now
    void (*add)(void *user, sr_vec2 raster, sr_spectrum gain, const struct sr_wavelengths *w);
    void *user;
};

/* What one thread owns while it renders. */
struct sr_worker {
    const struct sr_target *target;       // NULL: nobody listens, and L alone must be all
    uint64_t rays, shadow_rays, vertices; // counted, never shared
    struct sr_ray_log *log;               // NULL, or where rays are recorded until it is full
    void *
        shared; // what the integrator's begin has made for the picture; NULL: there is no picture, or nothing is shared
    void *held; // what of it this thread holds
    uint32_t replicate; // of the sample that is wanted now
    uint32_t untold;    // samples since somebody was told of the progress
};

/* What an integrator may know of the picture before its first sample. */
struct sr_picture_plan {
    uint32_t x0, y0, width, height; // [pixel] the part that is rendered
    uint32_t spp;                   // samples per pixel in all
    uint32_t per_replicate;         // samples of each replicate; 0: one net of spp samples
    uint32_t seed;
    enum sr_sampler_kind sampler;
    struct sr_lambda_law law;
    bool jitter_lambda;
    int threads;
    /* One sample of the picture with numbers of the integrator's choice, which is thrown away: L learns from it what it
     * wants. */
    void (*try)(const void *picture, uint32_t x, uint32_t y, const struct sr_sampler *sampler,
                struct sr_worker *worker);
    const void *picture;
    const atomic_bool *cancel; // NULL, or set by somebody who wants to stop
    struct sr_worker *counted; // what begin has traced is added to its counters
    char *remark;              // of SR_PICTURE_REMARK bytes: one sentence about what has been shared, or empty
};
enum { SR_PICTURE_REMARK = 200 };

/* A sample's numbers come in groups of four: the sensor's two (one pair, drawn together), then two for each bounce. */
enum { SR_USE_FILM = 0, SR_USE_LENS = 1, SR_USE_BOUNCE = 2 };
/* Added to the group of a bounce that goes through a body: one for where it comes out, then two as any bounce has. */
#define SR_USE_SUBSURFACE 0x40000000u

/* What a ray brings, and how wide it is: a sensor ray knows how it changes from pixel to pixel. */
struct sr_path_start {
    struct sr_ray ray;
    sr_vec3 dodx, dody; // [m]
    sr_vec3 dddx, dddy; // [1]
    /* NULL: a sensor ray. Or where lights have been sampled as well: light that the ray meets is then weighed by pdf,
     * the density that chose its direction [1/sr]. Only for integrators that say so. */
    const struct sr_point *receiver;
    float pdf;
    const struct sr_medium *medium; // where the ray begins; NULL: vacuum
};

/* A place that takes light in, with a weight: reading = integral response(wi) L(x, wi) dwi. Directions are local. */
struct sr_receiver {
    struct sr_point x;
    struct sr_frame frame;
    const void *self;
    float (*response)(const void *self, sr_vec3 wi);
    float (*sample)(const void *self, sr_u4 u, sr_vec3 *wi); // returns its density [1/sr]; 0: none
    float (*pdf)(const void *self, sr_vec3 wi);              // [1/sr]
    bool is_upper;                                           // response is 0 where wi.z < 0
};

struct sr_integrator_model {
    const char *name;
    const char *text; // what it does, in one line
    const struct sr_param *params;
    size_t size;
    /* Radiance arriving along the ray, per wavelength. first: NULL, or the first surface; its material is NULL if there
     * is none, and t is infinite. */
    sr_spectrum (*L)(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                     const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                     struct sr_worker *worker);
    bool knows_receivers; // weighs what a ray from start->receiver meets
    bool knows_media;     // others take all media for vacuum
    /* L is only what worker->target, if there is one, is not told of: by L itself, or by splat, one path from the
     * lights with the numbers target->sampler. As many are wanted as samples in all. */
    bool splats;
    void (*splat)(const void *self, const struct sr_scene *scene, struct sr_wavelengths *w,
                  struct sr_worker *worker); // or NULL
    /* The reading of a receiver, estimated by the integrator's own strategies there, too. NULL: the meter's, and L. */
    sr_spectrum (*gather)(const void *self, const struct sr_scene *scene, const struct sr_receiver *receiver,
                          const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_worker *worker);
    /* What all samples of a picture share beyond the scene; L finds it in worker->shared, and must do without where
     * that is NULL: at meters. NULL hooks: nothing. */
    sr_status (*begin)(const void *self, const struct sr_scene *scene, const struct sr_picture_plan *plan,
                       void **shared, struct sr_error *error);
    void (*end)(void *shared);
    bool by_turns; // where samples of a number share something, all pixels take them one after the other
    /* Once the parameters are known: checks them, computes what follows from them. NULL: nothing to do. */
    sr_status (*prepare)(void *self, struct sr_arena *arena, struct sr_error *error);
    /* One sentence: which light of this scene the estimator cannot find, so that it is missing from the result. NULL,
     * or returns NULL: none. */
    const char *(*blind)(const void *self, const struct sr_scene *scene);
    const char *(*label)(const void *self); // what tells it from others of its kind; NULL: its name
    // follows light through translucent bodies; NULL: never, to it they are glass
    bool (*enters_bodies)(const void *self);
};
extern const struct sr_integrator_model *const sr_integrator_models[]; // ends with NULL
const struct sr_integrator_model *sr_integrator_model_find(const char *name);

/* The reference without chance: what meters read is integrated by render/quadrature.c. L is not a number. */
struct sr_quadrature {
    int32_t max_depth; // 0: light straight from lights; 1: reflected once, for meters that look along a ray
    float tolerance;   // [1] relative error that each integral aims at
};
extern const struct sr_integrator_model sr_integrator_quadrature;

struct sr_integrator {
    const struct sr_integrator_model *model;
    const void *self;
};

/* "NAME[,key=value…]", or the estimator of a set of strategies: "bsdf+light-area[:power][,key=value…]". Whole numbers
 * that both have (maxdepth) are base's, and all the rest if it is of the same kind; base NULL: as the tables say. */
sr_status sr_integrator_parse(const char *text, const struct sr_integrator *base, struct sr_arena *arena,
                              struct sr_integrator *out, struct sr_error *error);
static inline const char *sr_integrator_label(const struct sr_integrator *i)
{
    return i->model->label ? i->model->label(i->self) : i->model->name;
}
/* What the estimator itself says, or what holds for all of its kind. */
const char *sr_integrator_blind(const struct sr_integrator *i, const struct sr_scene *scene);
/* The strategies by number, NULL where they end. */
const char *sr_strategy_name(int i);
const char *sr_strategy_text(int i);

/* ---- particles of light ---- */

enum sr_particle_event { SR_PARTICLE_EMITTED, SR_PARTICLE_ABSORBED, SR_PARTICLE_ESCAPED, SR_PARTICLE_GIVEN_UP };
/* Told of each event: flux [lm for each wavelength, as paths have it], the direction of travel, and where it is
 * absorbed (in media: a hit of no object and no material); what light from outside emits is what enters the scene's
 * sphere. w as it is then: dispersion ends wavelengths on the way. */
struct sr_particle_watch {
    void (*event)(void *user, enum sr_particle_event event, const struct sr_hit *hit, sr_vec3 d, sr_spectrum flux,
                  const struct sr_wavelengths *w);
    void *user;
};
/* Follows one particle from a light until it is absorbed or leaves the scene. */
void sr_follow_particle(const struct sr_scene *scene, const struct sr_sampler *sampler, struct sr_wavelengths *w,
                        const struct sr_particle_watch *watch, struct sr_worker *worker);

/* ---- what the estimators share ---- */

/* raycast and visible, counted and recorded. */
bool sr_trace(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit, struct sr_worker *worker);
bool sr_trace_bare(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit,
                   struct sr_worker *worker);
bool sr_unoccluded(const struct sr_scene *scene, const struct sr_point *x, const struct sr_light_sample *s,
                   struct sr_worker *worker);

/* The footprint of a sensor ray where it meets a surface: the neighbouring rays, on the tangent plane. */
void sr_first_footprint(const struct sr_path_start *start, struct sr_point *x);
/* The footprint that a pixel would have at x if the sensor saw x straight on, whatever hides it: what matters where a
 * path has been scattered, which looks at x from all sides. Bump maps tilt by it, so it decides what they look like; it
 * is what pbrt takes (Pharr, Jakob & Humphreys 2023, 10.1.2). */
void sr_seen_footprint(const struct sr_path_start *start, struct sr_point *x);
/* The footprint at a surface of a path: a cone of that spread, whose width goes along, until the path is scattered. */
void sr_path_footprint(const struct sr_path_start *start, struct sr_hit *x, bool is_first, bool is_scattered,
                       float spread, float *width);

/* A path that has been let into the body at x by its BSDF comes out of it elsewhere: x becomes that point, with the
 * frame and the BSDF of the exit, where wo is the frame's z; beta is multiplied. b: sr_material_bssrdf at x. u: numbers
 * of its own, such as the group SR_USE_SUBSURFACE of the bounce. false: the path ends. */
bool sr_subsurface_step(const struct sr_scene *scene, const struct sr_bssrdf *b, sr_u4 u, struct sr_hit *x,
                        const struct sr_wavelengths *w, struct sr_worker *worker, sr_spectrum *beta,
                        struct sr_bsdf *bsdf, struct sr_frame *frame);

/* Lights that are delta functions: no ray meets them. */
bool sr_has_delta_lights(const struct sr_scene *scene);

/* Whether the light's ray got to its first point, where that is a portal: nothing may stand outside. */
bool sr_has_come_in(const struct sr_scene *scene, const struct sr_light_ray *r, struct sr_worker *worker);

/* Radiance of all infinite lights along an escaping ray. */
sr_spectrum sr_escape_Le(const struct sr_scene *scene, const struct sr_ray *ray,
                         const struct sr_wavelengths *wavelengths);
/* Radiance that leaves the hit toward w by its own glow; black where it is dark. */
sr_spectrum sr_hit_Le(const struct sr_scene *scene, const struct sr_hit *hit, sr_vec3 w,
                      const struct sr_wavelengths *wavelengths);

/* Power heuristic of two densities (Veach 1997, beta = 2), safe against overflow. */
static inline float sr_mis_weight(float pdf, float other)
{
    float q = other / pdf, weight = 1 / (1 + q * q);
    return weight >= 0 ? weight : pdf > 0; // 0 / 0: nothing; both infinite: all
}

#endif
