/* SPDX-License-Identifier: MIT */
/* Private to this room: where the integral is taken, and the strategies that draw from it. */
#ifndef SR_INTEGRATOR_STRATEGIES_H
#define SR_INTEGRATOR_STRATEGIES_H

#include "integrator/integrator.h"

/* A surface that scatters, or a receiver that weighs: the place x of the integral. Directions are local to the frame.
 */
struct sr_vertex {
    struct sr_hit hit; // hit.point is x
    struct sr_frame frame;
    struct sr_bsdf bsdf;
    sr_vec3 wo;
    const struct sr_receiver *receiver; // NULL: a surface
    bool above, below;                  // on which sides of the frame light counts
};

/* The integrand without the light: f(wo, wi) |cos theta_i| [1/sr], or the receiver's response. */
static inline sr_spectrum sr_vertex_weight(const struct sr_vertex *v, sr_vec3 wi)
{
    return v->receiver ? SR_ONE * v->receiver->response(v->receiver->self, wi)
                       : sr_bsdf_f(&v->bsdf, v->wo, wi, SR_RADIANCE) * sr_abs_cos_theta(wi);
}

/* Light that arrives at x, whoever found it. */
struct sr_arrival {
    sr_vec3 world, wi; // toward it, in the world and in the frame
    uint32_t light;
    const struct sr_point *there; // where it leaves a surface; NULL: it comes from a point or from outside
    bool is_delta; // it comes from a point or from one direction: densities are probabilities of the light
    bool is_met;   // a ray may meet it
};

/* One way to draw from the integral. A direction, which a ray then follows to whatever shines there; or light, whose
 * way to x must then be free. */
struct sr_strategy {
    const char *name, *text;
    float (*direction)(const struct sr_vertex *v, sr_u4 u, sr_vec3 *wi); // returns its density [1/sr]; 0: none
    bool (*light)(const struct sr_vertex *v, const struct sr_lights *lights, sr_u4 u, uint32_t *index, float *density,
                  struct sr_shape_sample *s);
    /* Density with which it would have found this arrival [1/sr], or its probability if the light is a delta function.
     */
    float (*density)(const struct sr_vertex *v, const struct sr_lights *lights, const struct sr_arrival *a);
    bool finds_points; // lights that are delta functions
    bool finds_unmet;  // surfaces that no ray meets
};
enum { SR_STRATEGY_COUNT = 6 };
extern const struct sr_integrator_model sr_integrator_estimator;
extern const struct sr_strategy sr_strategies[SR_STRATEGY_COUNT];
enum { SR_BY_UNIFORM, SR_BY_COSINE, SR_BY_BSDF, SR_BY_UNIFORM_AREA, SR_BY_LIGHT_AREA, SR_BY_LIGHT_SOLID_ANGLE };

#endif
