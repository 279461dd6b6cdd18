/* SPDX-License-Identifier: MIT */
/* Walks that keep their vertices. From a light, the flux beta of a path changes at a vertex by
 *
 *     beta' = beta f(wi, wo) |cos theta_i'| |cos theta_o| / (|cos theta_i| pdf(wo))        [lm]
 *
 * theta' by the shading normal, theta by the geometric one, wi toward the light: the adjoint of the scattering that
 * paths from a sensor see (E. Veach, Robust Monte Carlo methods, 1997, 5.3). Carrying little, paths end by lot. */
#include "integrator/vertices.h"
#include "integrator/shade.h"

float sr_vertex_density(float pdf_direction, const struct sr_vertex *from, const struct sr_vertex *to)
{
    if (to->is_outside)
        return pdf_direction;
    sr_vec3 d = sr_sub(to->x.p, from->x.p);
    float r2 = sr_length2(d);
    if (from->is_outside || !(r2 > 0))
        return 0;
    return pdf_direction * sr_vertex_cos(to, sr_scale(1 / sqrtf(r2), d)) / r2;
}

// |cos theta_i'| / |cos theta_i|
static float adjoint(const struct sr_vertex *v)
{
    float c = fabsf(sr_dot(v->x.n, v->to_last));
    return c > 0 ? sr_abs_cos_theta(v->local_to_last) / c : 0;
}

sr_spectrum sr_vertex_leaving(const struct sr_vertex *v, sr_vec3 out)
{
    sr_vec3 local = sr_to_local(&v->frame, out);
    return sr_bsdf_f(&v->bsdf, local, v->local_to_last, SR_RADIANCE) * (adjoint(v) * sr_vertex_cos(v, out));
}

static void set_footprint(const struct sr_walk *walk, const struct sr_hit *hit, int count, bool is_scattered,
                          float *width, struct sr_point *x)
{
    const struct sr_path_start *s = walk->start;
    if (walk->mode == SR_RADIANCE && count == 1) {
        sr_first_footprint(s, x);
        *width = 0.5f * (sr_length(x->dpdx) + sr_length(x->dpdy));
        return;
    }
    if (!is_scattered && s)
        *width += 0.5f * (sr_length(s->dddx) + sr_length(s->dddy)) * hit->t;
    if (!hit->has_footprint)
        return;
    if (s && (is_scattered || walk->mode == SR_IMPORTANCE)) {
        sr_seen_footprint(s, x);
    } else {
        struct sr_frame tangent = sr_frame_from_z(x->n);
        sr_point_set_footprint(x, sr_scale(*width, tangent.x), sr_scale(*width, tangent.y));
    }
}

// of the first vertex: over the picture, of one sample of each pixel
static float sensor_density(const struct sr_walk *walk, const struct sr_vertex *v)
{
    const struct sr_target *target = walk->worker->target;
    if (!target || !target->density)
        return 1;
    float distance = sr_length(sr_sub(v->x.p, walk->start->ray.o));
    return target->density(target->self, walk->start->ray.d, distance, walk->start->ray.time) *
           sr_vertex_cos(v, walk->start->ray.d) / target->pixels;
}

int sr_walk_vertices(const struct sr_walk *walk, struct sr_ray ray, sr_spectrum beta, float pdf_direction,
                     struct sr_vertex *v)
{
    const struct sr_scene *scene = walk->scene;
    bool has_footprints = sr_scene_has_footprints(scene), is_scattered = false;
    bool from_light = walk->mode == SR_IMPORTANCE;
    float width = 0, eta_scale = 1, begun_with = from_light ? sr_spectrum_max(beta) : 1;
    int passed = 0, count = 1;
    struct sr_hit hit;
    for (;;) {
        bool is_seen = count == 1 && (walk->first || has_footprints);
        bool is_hit =
            is_seen ? sr_trace(scene, &ray, &hit, walk->worker) : sr_trace_bare(scene, &ray, &hit, walk->worker);
        if (count == 1 && walk->first && passed == 0)
            *walk->first = is_hit ? hit : (struct sr_hit){.t = INFINITY};
        if (walk->met && (!is_hit || hit.light != SR_NO_LIGHT))
            walk->met(walk->user, count, is_hit ? &hit : NULL, ray.d, pdf_direction, beta);
        if (!is_hit || (hit.material && count > walk->max_scatterings))
            return count;

        struct sr_vertex *x = &v[count], *last = &v[count - 1];
        uint32_t group = walk->first_group + 2 * (uint32_t)(count - 1);
        sr_u4 u_light, u_bsdf;
        x->bsdf.model = NULL;
        if (hit.material) {
            if (has_footprints)
                set_footprint(walk, &hit, count, is_scattered, &width, &hit.point);
            if (count == 1 && walk->first && passed == 0)
                walk->first->point = hit.point;
            x->x = hit.point;
            sr_sample8(walk->sampler, group, &u_light, &u_bsdf);
            uint32_t seed = sr_shade_seed(walk->sampler, group);
            sr_material_shade(hit.material, &x->x, sr_neg(ray.d), u_bsdf[3], seed, walk->w, &x->bsdf, &x->frame);
        }
        if (!x->bsdf.model) { // an interface: the path goes on as it was
            if (++passed > 1000)
                return count;
            ray = sr_leave(&hit.point, ray.d);
            continue;
        }
        walk->worker->vertices += 1;
        x->to_last = sr_neg(ray.d);
        x->local_to_last = sr_to_local(&x->frame, x->to_last);
        x->beta = beta;
        x->is_outside = x->is_delta = false;
        x->is_connectible =
            sr_bsdf_is_diffuse(&x->bsdf) || sr_bsdf_lobes(&x->bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY);
        x->pdf = !from_light && count == 1 ? sensor_density(walk, x)
                 : last->is_outside        ? pdf_direction * sr_vertex_cos(x, ray.d)
                                           : sr_vertex_density(pdf_direction, last, x);
        x->pdf_back = 0;
        if (x->local_to_last.z == 0)
            return count;
        ++count;

        struct sr_bsdf_sample s;
        if (!sr_bsdf_sample(&x->bsdf, x->local_to_last, u_bsdf[2], (sr_vec2){u_bsdf[0], u_bsdf[1]}, walk->mode, &s))
            return count;
        sr_vec3 out = sr_to_world(&x->frame, s.wi);
        sr_spectrum f = s.f;
        if (from_light && x->bsdf.model->asymmetry > 0 && !(s.lobe & SR_LOBE_SPECULAR) && !s.pdf_is_proportional)
            f = sr_bsdf_f(&x->bsdf, s.wi, x->local_to_last, SR_RADIANCE);
        beta *= f * ((from_light ? adjoint(x) * sr_vertex_cos(x, out) : sr_abs_cos_theta(s.wi)) / s.pdf);
        x->is_delta = s.lobe & SR_LOBE_SPECULAR;
        float pdf_back = sr_abs_cos_theta(x->local_to_last);
        pdf_direction = sr_abs_cos_theta(s.wi);
        if (!x->is_delta) {
            enum sr_transport other = from_light ? SR_RADIANCE : SR_IMPORTANCE;
            pdf_direction = s.pdf_is_proportional ? sr_bsdf_pdf(&x->bsdf, x->local_to_last, s.wi, walk->mode) : s.pdf;
            pdf_back = sr_bsdf_pdf(&x->bsdf, s.wi, x->local_to_last, other);
            is_scattered = true;
        }
        last->pdf_back = sr_vertex_density(pdf_back, x, last);
        if (s.lobe & SR_LOBE_TRANSMISSION && !from_light)
            eta_scale *= s.eta * s.eta;
        ray = sr_leave(&x->x, out);

        float carried = sr_spectrum_max(beta) * eta_scale / begun_with;
        if (!(carried > 0))
            return count;
        if (carried < 1 && count > 3) {
            float survive = sr_max(carried, 0.05f);
            if (u_light[3] >= survive)
                return count;
            beta *= 1 / survive;
        }
    }
}

struct sr_light_path sr_light_vertices(const struct sr_walk *walk, struct sr_vertex *v)
{
    struct sr_light_path none = {0, 0};
    const struct sr_lights *lights = sr_scene_lights(walk->scene);
    sr_u4 u = sr_sample4(walk->sampler, SR_USE_LIGHT_PATH), u_place = sr_sample4(walk->sampler, SR_USE_LIGHT_PATH + 1);
    struct sr_light_ray r;
    if (!sr_lights_emit(lights, u[2], (sr_vec2){u_place[0], u_place[1]}, (sr_vec2){u[0], u[1]}, walk->w, &r) ||
        !sr_has_come_in(walk->scene, &r, walk->worker))
        return none;
    struct sr_light light = lights->lights[r.light];
    v[0].x = r.from;
    v[0].x.time = walk->has_time ? walk->time : u_place[2];
    v[0].is_outside = light.model->is_infinite;
    v[0].is_delta = false;
    v[0].pdf_back = 0;
    // weights know the densities of any point alike, whoever has found it
    float pdf_area, pdf_direction;
    light.model->emit_pdf(light.self, r.from.n, r.w, &pdf_area, &pdf_direction);
    v[0].pdf = r.pmf * (v[0].is_outside ? pdf_direction : pdf_area);
    sr_spectrum beta = r.L * (sr_vertex_cos(&v[0], r.w) / (r.pmf * r.pdf_area * r.pdf_direction));
    float pdf = v[0].is_outside ? pdf_area : pdf_direction;
    return (struct sr_light_path){r.light, sr_walk_vertices(walk, sr_leave(&v[0].x, r.w), beta, pdf, v)};
}

bool sr_vertex_seen(const struct sr_vertex *v, const struct sr_target *target, sr_vec2 u, struct sr_sensor_view *view,
                    sr_spectrum *gain)
{
    if (!v->is_connectible || !target->connect(target->self, v->x.p, v->x.time, u, view))
        return false;
    *gain = v->beta * sr_vertex_leaving(v, view->wi) * view->weight;
    return sr_spectrum_any(*gain != 0.0f);
}

bool sr_vertices_see(const struct sr_scene *scene, const struct sr_vertex *v, sr_vec3 p, sr_vec3 wi, float distance,
                     struct sr_worker *worker)
{
    struct sr_light_sample s = {.wi = wi, .distance = distance, .p = p};
    return sr_unoccluded(scene, &v->x, &s, worker);
}

sr_spectrum sr_met_at_once(const struct sr_scene *scene, const struct sr_path_start *start, const struct sr_hit *hit,
                           sr_vec3 d, const struct sr_wavelengths *w)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    sr_spectrum L = SR_BLACK;
    for (uint32_t k = 0; k < (hit ? 1 : lights->infinite_count); ++k) {
        uint32_t index = hit ? hit->light : lights->infinite[k];
        struct sr_light light = lights->lights[index];
        sr_spectrum Le =
            hit ? light.model->Le(light.self, &hit->point, sr_neg(d), w) : sr_light_escaping(light, start->ray.o, d, w);
        float pdf = start->receiver ? light.model->pdf(light.self, start->receiver, d, hit ? &hit->point : NULL) : 0;
        L += pdf > 0 ? Le * sr_mis_weight(start->pdf, sr_lights_pmf(lights, start->receiver, index) * pdf) : Le;
    }
    return L;
}
