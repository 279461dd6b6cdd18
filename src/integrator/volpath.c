/* SPDX-License-Identifier: MIT */
/* Volumetric path tracing: the equation of transfer between surfaces, the rendering equation at them, one scattering
 * per turn.
 *
 *     L(x, -d) = integral_0^s T(t) [sigma_a Le + sigma_s integral p(d, w') L(y, w') dw'] dt + T(s) L_surface
 *         [W m^-2 sr^-1 nm^-1]
 *
 * y = x + t d. Light that arrives at a scattering is estimated twice, by a direction toward a light and by one that the
 * matter prefers; both kinds of paths, and those that any of the eight wavelengths would have drawn, are weighed by the
 * balance heuristic (Veach 1997; Miller, Georgiev & Jarosz 2019; docs/theory/volumes.md). Without media it is path.c.
 */
#include "integrator/flight.h"
#include "integrator/path.h"
#include "integrator/shade.h"

enum { GROUPS = 3 };

static const struct sr_param params[] = {
    SR_PATH_PARAMS(1),
    {.name = NULL},
};

/* What stays the same along a path. */
struct walk {
    const struct sr_scene *scene;
    const struct sr_lights *lights;
    struct sr_wavelengths
        w; // the path's own: what dispersion ends goes on being counted by those that look at the result
    struct sr_rng rng;
    struct sr_worker *worker;
    bool has_bodies; // that are to be gone through
};

static struct walk walk_of(const struct sr_path *path, const struct sr_scene *scene, const struct sr_sampler *sampler,
                           const struct sr_wavelengths *w, struct sr_worker *worker)
{
    return (struct walk){scene,  sr_scene_lights(scene),
                         *w,     sr_rng_seed((uint64_t)sampler->key << 32 | sampler->sample, SR_USE_BOUNCE),
                         worker, path->subsurface && sr_scene_has_subsurface(scene)};
}

// dispersion has left the first wavelength alone: it counts for all, since no other would have drawn what is still to
// come
static void keep_first(struct sr_carried *c)
{
    sr_spectrum *all[] = {&c->f, &c->q, &c->r};
    for (int i = 0; i < 3; ++i)
        *all[i] = (sr_spectrum){(*all[i])[0]};
}

/* Light that arrives straight from a light at x, which is in `medium` there. */
struct arriving {
    struct sr_light_sample l;
    float pdf; // [1/sr], of the light, too
};

static bool draw_light(const struct walk *k, const struct sr_point *x, sr_u4 u, struct arriving *a)
{
    uint32_t index;
    float pmf;
    if (!sr_lights_pick(k->lights, x, u[2], &index, &pmf) ||
        !sr_light_draw(k->lights->lights[index], x, (sr_vec2){u[0], u[1]}, &k->w, &a->l))
        return false;
    a->pdf = pmf * a->l.pdf;
    return a->pdf > 0;
}

// what of it is scattered on (value: f cos or p), were pdf the matter's own density of that direction
static void receive(struct walk *k, const struct sr_point *x, const struct sr_medium *medium, const struct arriving *a,
                    sr_spectrum value, float pdf, struct sr_carried *c)
{
    struct sr_passage p;
    value *= a->l.L;
    if (sr_spectrum_is_black(value) || !sr_pass_to_light(k->scene, x, medium, &a->l, &k->w, &k->rng, k->worker, &p))
        return;
    float density = sr_spectrum_mean(c->q * (p.S * a->pdf + p.U * (a->l.is_delta ? 0 : pdf)));
    if (density > 0)
        c->L += c->f * value * p.T * (1 / density);
}

static void receive_from_outside(const struct walk *k, const struct sr_point *from, const struct sr_ray *ray,
                                 struct sr_carried *c)
{
    bool has_rival = c->r[0] > 0;
    for (uint32_t i = 0; i < k->lights->infinite_count; ++i) {
        uint32_t index = k->lights->infinite[i];
        struct sr_light light = k->lights->lights[index];
        float density;
        sr_spectrum Le = light.model->Le_pdf(light.self, ray->o, ray->d, &k->w, &density);
        if (has_rival && density > 0)
            density *= sr_lights_pmf(k->lights, from, index);
        c->L += sr_carried_to(c, Le, density);
    }
}

static void receive_from_hit(const struct walk *k, const struct sr_point *from, sr_vec3 d, const struct sr_hit *x,
                             struct sr_carried *c)
{
    sr_spectrum Le = sr_hit_Le(k->scene, x, sr_neg(d), &k->w);
    if (!sr_spectrum_any(Le > 0.0f))
        return;
    float density = c->r[0] > 0 ? sr_light_density(k->lights->lights[x->light], from, d, &x->point) : 0;
    c->L += sr_carried_to(c, Le, density > 0 ? density * sr_lights_pmf(k->lights, from, x->light) : 0);
}

/* A path that carries little ends by lot, and those that survive carry its share. */
static bool survives(struct sr_carried *c, float eta_scale, int bounce, float u)
{
    float carried = sr_spectrum_max(c->f) / sr_spectrum_mean(c->q) * eta_scale;
    if (!(carried > 0))
        return false;
    if (carried >= 1 || bounce <= 1)
        return true;
    float survive = sr_survival(carried);
    c->f *= 1 / survive;
    return u < survive;
}

/* Light that s lets into a body at x comes out of it elsewhere, into the same medium: x, frame and bsdf are there from
 * now on, and s is how the path leaves it. false: the path ends. */
static bool emerge(struct walk *k, const struct sr_bssrdf *body, const struct sr_sampler *sampler, uint32_t group,
                   const struct sr_medium *medium, struct sr_hit *x, struct sr_frame *frame, struct sr_bsdf *bsdf,
                   struct sr_bsdf_sample *s, struct sr_carried *c)
{
    sr_u4 u_light, u_scatter;
    sr_sample8(sampler, group + 1, &u_light, &u_scatter);
    c->f *= s->f * (sr_abs_cos_theta(s->wi) / s->pdf);
    if (!sr_subsurface_step(k->scene, body, sr_sample4(sampler, group), x, &k->w, k->worker, &c->f, bsdf, frame))
        return false;
    const sr_vec3 up = {0, 0, 1};
    struct arriving a;
    if (draw_light(k, &x->point, u_light, &a)) {
        sr_vec3 wi = sr_to_local(frame, a.l.wi);
        float pdf;
        sr_spectrum f = sr_bsdf_f_pdf(bsdf, up, wi, SR_RADIANCE, &pdf);
        receive(k, &x->point, sr_hit_medium(x, a.l.wi, medium), &a, f * sr_abs_cos_theta(wi), pdf, c);
    }
    return sr_bsdf_sample(bsdf, up, u_scatter[2], (sr_vec2){u_scatter[0], u_scatter[1]}, SR_RADIANCE, s);
}

static sr_spectrum walk(struct walk *k, int max_depth, const struct sr_path_start *start,
                        const struct sr_sampler *sampler, struct sr_hit *first)
{
    struct sr_ray ray = start->ray;
    const struct sr_medium *medium = start->medium, *known = NULL;
    struct sr_medium_at at = {.g = 0}; // of `known`, a uniform medium, or where light was scattered last
    struct sr_carried c = {.f = SR_ONE, .q = SR_ONE, .r = SR_BLACK, .L = SR_BLACK};
    float eta_scale = 1;       // what refraction has made of f, and will undo [1]
    bool is_scattered = false; // by more than mirrors and clear glass
    struct sr_cone cone = sr_cone_of(start, sr_scene_has_footprints(k->scene));
    struct sr_point from = {.time = ray.time}; // where the path was scattered last
    float depth = 0; // optical depth that the first wavelength may go until the next scattering
    int passed = 0;
    if (start->receiver) {
        from = *start->receiver;
        c.r = SR_ONE / start->pdf;
    }

    for (int bounce = 0, flown = -1;;) {
        uint32_t group = SR_USE_BOUNCE + GROUPS * (uint32_t)bounce;
        sr_u4 u_light, u_scatter;
        sr_sample8(sampler, group, &u_light, &u_scatter);
        if (flown < bounce) // behind an interface, the flight goes on
            depth = -log1pf(-sr_sample4(sampler, group + 2)[0]);
        flown = bounce;
        bool is_seen = bounce == 0 && (first || cone.is_wanted);
        ray.t_max = INFINITY;
        if (medium && medium->model->is_uniform) {
            if (known != medium)
                medium->model->at(medium->self, ray.o, &k->w, &at);
            known = medium;
            if (!is_seen && !medium->model->glows(medium->self) && sr_spectrum_any(at.sigma_s > 0.0f))
                ray.t_max = depth / (at.sigma_a[0] + at.sigma_s[0]); // farther it will not come
        } else {
            known = NULL;
        }
        struct sr_hit x;
        bool is_hit = is_seen ? sr_trace(k->scene, &ray, &x, k->worker) : sr_trace_bare(k->scene, &ray, &x, k->worker);
        if (first && bounce == 0)
            *first = is_hit ? x : (struct sr_hit){.t = INFINITY};

        // on the way there
        float t;
        enum sr_flight flight = medium
                                    ? sr_fly(medium, &ray, is_hit ? x.t : INFINITY, &k->w, &k->rng, &depth, &at, &c, &t)
                                    : SR_FLIGHT_THROUGH;
        if (flight == SR_FLIGHT_LOST)
            return c.L;
        if (flight == SR_FLIGHT_SCATTERED) {
            if (bounce == max_depth)
                return c.L;
            k->worker->vertices += 1;
            from = (struct sr_point){.p = sr_mad(ray.o, t, ray.d), .time = ray.time};
            struct arriving a;
            if (draw_light(k, &from, u_light, &a)) {
                float p = sr_phase_hg(sr_dot(ray.d, a.l.wi), at.g);
                receive(k, &from, medium, &a, SR_BLACK + p, p, &c);
            }
            float pdf = sr_phase_hg_sample(ray.d, at.g, (sr_vec2){u_scatter[0], u_scatter[1]}, &ray.d);
            c.r = c.q / pdf;
            ray.o = from.p;
            is_scattered = true;
            if (!survives(&c, eta_scale, ++bounce, u_light[3]))
                return c.L;
            continue;
        }

        // Le(x, wo), and light from outside the scene
        if (!is_hit) {
            receive_from_outside(k, &from, &ray, &c);
            return c.L;
        }
        if (x.light != SR_NO_LIGHT)
            receive_from_hit(k, &from, ray.d, &x, &c);
        if (x.material && bounce == max_depth)
            return c.L;
        sr_cone_meet(&cone, &x, bounce == 0, is_scattered, first);
        struct sr_bsdf bsdf;
        struct sr_frame frame;
        uint32_t seed = sr_shade_seed(sampler, group);
        bool was_whole = !sr_wavelengths_secondary_terminated(&k->w),
             scatters = sr_shade_plain(&x, ray.d, u_scatter[3], seed, &k->w, &bsdf, &frame);
        if (was_whole && sr_wavelengths_secondary_terminated(&k->w))
            keep_first(&c);
        if (!scatters) { // an interface: the path goes on as it was
            medium = sr_hit_medium(&x, ray.d, medium);
            if (!sr_pass_by(&x, &ray, &passed))
                return c.L;
            continue;
        }

        // integral f L |cos theta_i| dwi, by the lights and by the surface
        k->worker->vertices += 1;
        sr_vec3 wo = sr_to_local(&frame, sr_neg(ray.d));
        if (wo.z == 0)
            return c.L;
        struct arriving a;
        if (sr_bsdf_lobes(&bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY) && draw_light(k, &x.point, u_light, &a)) {
            sr_vec3 wi = sr_to_local(&frame, a.l.wi);
            float pdf;
            sr_spectrum f = sr_bsdf_f_pdf(&bsdf, wo, wi, SR_RADIANCE, &pdf);
            receive(k, &x.point, sr_hit_medium(&x, a.l.wi, medium), &a, f * sr_abs_cos_theta(wi), pdf, &c);
        }
        struct sr_bsdf_sample s;
        if (!sr_bsdf_sample(&bsdf, wo, u_scatter[2], (sr_vec2){u_scatter[0], u_scatter[1]}, SR_RADIANCE, &s))
            return c.L;
        struct sr_bssrdf body;
        if (SR_UNLIKELY(k->has_bodies) && s.lobe & SR_LOBE_TRANSMISSION &&
            sr_material_bssrdf(x.material, &x.point, sr_neg(ray.d), u_scatter[3], seed, &k->w, &body) &&
            !emerge(k, &body, sampler, SR_USE_SUBSURFACE + 3 * (uint32_t)bounce, medium, &x, &frame, &bsdf, &s, &c))
            return c.L;
        c.f *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
        bool is_specular = s.lobe & SR_LOBE_SPECULAR;
        float pdf = s.pdf_is_proportional ? sr_bsdf_pdf(&bsdf, wo, s.wi, SR_RADIANCE) : s.pdf;
        c.r = is_specular || !(pdf > 0) ? SR_BLACK : c.q / pdf;
        if (s.lobe & SR_LOBE_TRANSMISSION)
            eta_scale *= s.eta * s.eta;
        is_scattered |= !is_specular;
        from = x.point;
        ray = sr_leave(&x.point, sr_to_world(&frame, s.wi));
        medium = sr_hit_medium(&x, ray.d, medium);
        if (!survives(&c, eta_scale, ++bounce, u_light[3]))
            return c.L;
    }
}

static sr_spectrum volpath_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                             const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                             struct sr_worker *worker)
{
    if (!sr_scene_has_media(scene))
        return sr_integrator_path.L(self, scene, start, sampler, w, first, worker);
    struct walk k = walk_of(self, scene, sampler, w, worker);
    return walk(&k, ((const struct sr_path *)self)->max_depth, start, sampler, first);
}

/* reading = integral response L dwi, by the lights and by the receiver. */
static sr_spectrum gather(const void *self, const struct sr_scene *scene, const struct sr_receiver *receiver,
                          const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_worker *worker)
{
    struct walk k = walk_of(self, scene, sampler, w, worker);
    const struct sr_point *x = &receiver->x;
    sr_u4 u, u_light;
    sr_sample8(sampler, SR_USE_FILM, &u, &u_light);
    struct sr_carried c = {.f = SR_ONE, .q = SR_ONE, .L = SR_BLACK};
    struct arriving a;
    if (draw_light(&k, x, u_light, &a)) {
        sr_vec3 wi = sr_to_local(&receiver->frame, a.l.wi);
        float response = receiver->response(receiver->self, wi);
        struct sr_ray ray = sr_leave(x, a.l.wi);
        if (response != 0)
            receive(&k, x, sr_scene_medium_at(scene, &ray), &a, SR_BLACK + response, receiver->pdf(receiver->self, wi),
                    &c);
    }
    sr_vec3 wi;
    float pdf = receiver->sample(receiver->self, u, &wi),
          response = pdf > 0 ? receiver->response(receiver->self, wi) : 0;
    if (response == 0)
        return c.L;
    struct sr_path_start start = {.ray = sr_leave(x, sr_to_world(&receiver->frame, wi)), .receiver = x, .pdf = pdf};
    start.medium = sr_scene_medium_at(scene, &start.ray);
    return c.L + walk(&k, ((const struct sr_path *)self)->max_depth, &start, sampler, NULL) * (response / pdf);
}

const struct sr_integrator_model sr_integrator_volpath = {
    .name = "volpath",
    .text = "path through media, too: null collisions, all wavelengths weighed",
    .params = params,
    .size = sizeof(struct sr_path),
    .L = volpath_L,
    .gather = gather,
    .knows_media = true,
    .enters_bodies = sr_path_enters_bodies,
};
