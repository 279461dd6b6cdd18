/* SPDX-License-Identifier: MIT */
/* The strategies of sampling, and their densities, all as seen from x.
 *
 *     hemisphere form: integral over directions of h(wi) L(x, wi) dwi
 *     area form:       integral over surfaces of h(wi) Le(y, -wi) V(x, y) |cos theta_y| / r^2 dA(y)
 *
 * with h = f(wo, wi) |cos theta_i|, or a meter's response, and dwi = |cos theta_y| dA / r^2,
 *
 * so a density by area p_A [1/m^2] is the density p_A r^2 / |cos theta_y| by solid angle [1/sr], which is all that
 * estimators see. E. Veach, Robust Monte Carlo methods for light transport simulation, 1997, ch. 8. */
#include "integrator/strategies.h"

/* ---- hemisphere form ---- */

// share of the two sides of the frame: both alike, or the one that counts
static float side_share(const struct sr_vertex *v, float z)
{
    return (z > 0 ? v->above : v->below) ? (v->above && v->below ? 0.5f : 1) : 0;
}

static sr_vec3 to_side(const struct sr_vertex *v, float u, sr_vec3 wi)
{
    if (!v->above || (v->below && u < 0.5f))
        wi.z = -wi.z;
    return wi;
}

static float uniform_density(const struct sr_vertex *v, const struct sr_lights *lights, const struct sr_arrival *a)
{
    (void)lights;
    return a->is_met ? side_share(v, a->wi.z) / (2 * SR_PI) : 0;
}

static float uniform_direction(const struct sr_vertex *v, sr_u4 u, sr_vec3 *wi)
{
    *wi = to_side(v, u[2], sr_warp_uniform_hemisphere((sr_vec2){u[0], u[1]}));
    return side_share(v, wi->z) / (2 * SR_PI);
}

static float cosine_density(const struct sr_vertex *v, const struct sr_lights *lights, const struct sr_arrival *a)
{
    (void)lights;
    return a->is_met ? side_share(v, a->wi.z) * fabsf(a->wi.z) * SR_INV_PI : 0;
}

static float cosine_direction(const struct sr_vertex *v, sr_u4 u, sr_vec3 *wi)
{
    *wi = to_side(v, u[2], sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]}));
    return side_share(v, wi->z) * fabsf(wi->z) * SR_INV_PI;
}

static float bsdf_density(const struct sr_vertex *v, const struct sr_lights *lights, const struct sr_arrival *a)
{
    (void)lights;
    if (!a->is_met)
        return 0;
    return v->receiver ? v->receiver->pdf(v->receiver->self, a->wi) : sr_bsdf_pdf(&v->bsdf, v->wo, a->wi, SR_RADIANCE);
}

/* ---- area form ---- */

// [1/m^2] to [1/sr]: the one place where area becomes solid angle
static float per_steradian(float per_area, const struct sr_point *x, sr_vec3 wi, sr_vec3 p, sr_vec3 n)
{
    float cos_theta_y = fabsf(sr_dot(n, wi));
    return cos_theta_y > 1e-7f ? per_area * sr_length2(sr_sub(p, x->p)) / cos_theta_y : 0;
}

static float density_by_area(const struct sr_light_area *m, const struct sr_point *x, const struct sr_arrival *a)
{
    float (*area_pdf)(const void *, uint32_t, const struct sr_point *) = m->shape.model->area_pdf;
    return per_steradian(area_pdf ? area_pdf(m->shape.self, m->primitive, a->there) : 1 / m->area, x, a->world,
                         a->there->p, a->there->n);
}

static bool draw_by_area(const struct sr_light_area *m, const struct sr_point *x, sr_u4 u, float pmf, float *density,
                         struct sr_shape_sample *s)
{
    if (!m->shape.model->sample(m->shape.self, m->primitive, NULL, (sr_vec2){u[0], u[1]}, s))
        return false;
    *density = pmf * per_steradian(s->pdf, x, sr_normalize(sr_sub(s->p, x->p)), s->p, s->n);
    return *density > 0;
}

static bool uniform_area_light(const struct sr_vertex *v, const struct sr_lights *lights, sr_u4 u, uint32_t *index,
                               float *density, struct sr_shape_sample *s)
{
    float pmf;
    return sr_lights_pick_by_area(lights, &v->hit.point, u[2], index, &pmf) &&
           draw_by_area(lights->lights[*index].self, &v->hit.point, u, pmf, density, s);
}

static float uniform_area_density(const struct sr_vertex *v, const struct sr_lights *lights, const struct sr_arrival *a)
{
    return a->there ? sr_lights_pmf_by_area(lights, a->light) *
                          density_by_area(lights->lights[a->light].self, &v->hit.point, a)
                    : 0;
}

/* Lights that have no surface draw themselves, in estimator.c: here only which, with what probability. */
static bool light_area_light(const struct sr_vertex *v, const struct sr_lights *lights, sr_u4 u, uint32_t *index,
                             float *density, struct sr_shape_sample *s)
{
    if (!sr_lights_pick(lights, &v->hit.point, u[2], index, density))
        return false;
    struct sr_light light = lights->lights[*index];
    return light.model != &sr_light_area || draw_by_area(light.self, &v->hit.point, u, *density, density, s);
}

static float density_without_surface(const struct sr_vertex *v, const struct sr_lights *lights,
                                     const struct sr_arrival *a)
{
    struct sr_light light = lights->lights[a->light];
    return a->is_delta ? 1 : light.model->pdf(light.self, &v->hit.point, a->world, NULL);
}

static float light_area_density(const struct sr_vertex *v, const struct sr_lights *lights, const struct sr_arrival *a)
{
    return sr_lights_pmf(lights, &v->hit.point, a->light) *
           (a->there ? density_by_area(lights->lights[a->light].self, &v->hit.point, a)
                     : density_without_surface(v, lights, a));
}

static bool light_solid_angle_light(const struct sr_vertex *v, const struct sr_lights *lights, sr_u4 u, uint32_t *index,
                                    float *density, struct sr_shape_sample *s)
{
    if (!sr_lights_pick(lights, &v->hit.point, u[2], index, density))
        return false;
    struct sr_light light = lights->lights[*index];
    if (light.model != &sr_light_area)
        return true;
    const struct sr_light_area *m = light.self;
    if (!m->shape.model->sample(m->shape.self, m->primitive, &v->hit.point, (sr_vec2){u[0], u[1]}, s))
        return false;
    *density *= s->pdf;
    return *density > 0 && isfinite(*density);
}

static float light_solid_angle_density(const struct sr_vertex *v, const struct sr_lights *lights,
                                       const struct sr_arrival *a)
{
    float pmf = sr_lights_pmf(lights, &v->hit.point, a->light);
    if (!a->there)
        return pmf * density_without_surface(v, lights, a);
    const struct sr_light_area *m = lights->lights[a->light].self;
    return pmf * m->shape.model->pdf(m->shape.self, m->primitive, &v->hit.point, a->world, a->there);
}

const struct sr_strategy sr_strategies[SR_STRATEGY_COUNT] = {
    {"uniform-hemisphere", "directions with density 1 / 2 pi", .direction = uniform_direction,
     .density = uniform_density},
    {"cosine-hemisphere", "directions with density cos / pi", .direction = cosine_direction, .density = cosine_density},
    {"bsdf", "directions as the surface scatters, or as the meter responds", .density = bsdf_density},
    {"uniform-area", "points even over all that glows: 1 / A", .light = uniform_area_light,
     .density = uniform_area_density, .finds_unmet = true},
    {"light-area", "one light by its share, points even over it", .light = light_area_light,
     .density = light_area_density, .finds_points = true, .finds_unmet = true},
    {"light-solid-angle", "one light by its share, directions even over its solid angle",
     .light = light_solid_angle_light, .density = light_solid_angle_density, .finds_points = true, .finds_unmet = true},
};

const char *sr_strategy_name(int i)
{
    return i < SR_STRATEGY_COUNT ? sr_strategies[i].name : NULL;
}

const char *sr_strategy_text(int i)
{
    return i < SR_STRATEGY_COUNT ? sr_strategies[i].text : NULL;
}
