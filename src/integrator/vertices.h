/* SPDX-License-Identifier: MIT */
/* For the files of this room: paths kept as vertices, whether they begin at a sensor or at a light.
 *
 * Densities are by area [1/m^2], those of light from outside the scene by solid angle [1/sr] and, of the vertex after
 * it, by area across. A mirror or clear glass leaves no choice: its density is a delta function of the projected solid
 * angle, which stands in both directions' densities and is left out of both. */
#ifndef SR_INTEGRATOR_VERTICES_H
#define SR_INTEGRATOR_VERTICES_H

#include "integrator/integrator.h"

enum { SR_MAX_SCATTERINGS = 100 }; // of a path that is kept
/* What estimators of such paths miss where more is asked for (their hook `blind`). */
static inline const char *sr_long_paths_missing(int32_t max_depth)
{
    return max_depth > SR_MAX_SCATTERINGS ? "it follows at most 100 scatterings of a path, and more are asked for: "
                                            "what longer paths bring is missing"
                                          : NULL;
}

struct sr_vertex {
    struct sr_point x;     // n is 0 at sensors, point lights, and light from outside
    sr_vec3 to_last;       // [1] toward the vertex before
    sr_vec3 local_to_last; // the same in the frame
    sr_spectrum beta;      // what arrives: sensor paths, what radiance is multiplied by; light paths, flux
    float pdf, pdf_back;   // as its own path draws it; as it is drawn from the vertex after it
    bool is_outside;       // light from outside the scene: x has no place
    bool is_delta;         // left by a choice without density
    bool is_connectible;   // scatters light in all directions
    struct sr_frame frame;
    struct sr_bsdf bsdf;
};

/* Light met by a sensor's path: the vertices before it, and a place on a surface or (NULL) the direction of escape. */
typedef void sr_met_light(void *user, int count, const struct sr_hit *hit, sr_vec3 d, float pdf_direction,
                          sr_spectrum beta);

struct sr_walk {
    const struct sr_scene *scene;
    enum sr_transport mode;            // SR_RADIANCE: from a sensor
    bool has_time;                     // of paths from lights; else it is drawn
    float time;                        // [1] share of the shutter interval
    const struct sr_path_start *start; // sensor paths: the sensor's ray; light paths: a sensor's, or NULL
    const struct sr_sampler *sampler;
    uint32_t first_group; // of the random numbers of vertex 1
    int max_scatterings;
    struct sr_wavelengths *w;
    struct sr_worker *worker;
    sr_met_light *met; // NULL: nobody asks
    void *user;
    struct sr_hit *first; // NULL, or where the first surface is told
};

/* Follows the path that leaves v[0]; returns the number of vertices, v[0] included. pdf_direction: of ray.d, from a
 * light. */
int sr_walk_vertices(const struct sr_walk *walk, struct sr_ray ray, sr_spectrum beta, float pdf_direction,
                     struct sr_vertex *v);

/* A path from the lights. v[1].beta is the flux that arrives at the first surface. */
struct sr_light_path {
    uint32_t light;
    int count; // of vertices; 0: no light
};
struct sr_light_path sr_light_vertices(const struct sr_walk *walk, struct sr_vertex *v);

/* Where the numbers of light paths begin: a group for the light and the direction, one for the place, then two a
 * vertex. */
enum { SR_USE_LIGHT_PATH = 0x10000 };

/* |cos| of the geometric normal; 1 where there is none. */
static inline float sr_vertex_cos(const struct sr_vertex *v, sr_vec3 w)
{
    float c = fabsf(sr_dot(v->x.n, w));
    return v->x.n.x == 0 && v->x.n.y == 0 && v->x.n.z == 0 ? 1 : c;
}

/* Density by area at `to` of a direction's density at `from`; outside: by what the scene's border shows. */
float sr_vertex_density(float pdf_direction, const struct sr_vertex *from, const struct sr_vertex *to);

/* f(out, from) of a vertex of a light path, toward out, with what turns flux into what leaves: |cos theta'_from / cos
 * theta_from| |cos theta_out|, primed by the shading normal (Veach 1997, 5.3). */
sr_spectrum sr_vertex_leaving(const struct sr_vertex *v, sr_vec3 out);

/* What a light path tells the target from v, but for visibility and weights; false: nothing. */
bool sr_vertex_seen(const struct sr_vertex *v, const struct sr_target *target, sr_vec2 u, struct sr_sensor_view *view,
                    sr_spectrum *gain);
bool sr_vertices_see(const struct sr_scene *scene, const struct sr_vertex *v, sr_vec3 p, sr_vec3 wi, float distance,
                     struct sr_worker *worker);

/* Radiance of light that is met at once; weighed where the start is a receiver for which lights have been sampled. */
sr_spectrum sr_met_at_once(const struct sr_scene *scene, const struct sr_path_start *start, const struct sr_hit *hit,
                           sr_vec3 d, const struct sr_wavelengths *w);

#endif
