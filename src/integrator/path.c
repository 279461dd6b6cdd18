/* SPDX-License-Identifier: MIT */
/* Path tracing: the rendering equation, one bounce per turn of the loop.
 *
 *     L(x, wo) = Le(x, wo) + integral f(wo, wi) L(x, wi) |cos theta_i| dwi        [W m^-2 sr^-1 nm^-1]
 *
 * The integral is estimated twice, by a direction toward a light and by one that the surface prefers, and the two are
 * weighed by their densities (Veach 1997, power heuristic). */
#include "integrator/path.h"
#include "integrator/shade.h"

static const struct sr_param params[] = {
    SR_PATH_PARAMS(0),
    {.name = NULL},
};

// the weight of light met by the surface's choice (pdf), had a light been chosen instead and then that direction
// (density)
static float weight_of_hit(const struct sr_lights *lights, const struct sr_point *from, float pdf, uint32_t light,
                           float density)
{
    return density > 0 ? sr_mis_weight(pdf, sr_lights_pmf(lights, from, light) * density) : 1;
}

// light from outside the scene along an escaping ray
static sr_spectrum escaping(const struct sr_scene *scene, const struct sr_point *from, float pdf,
                            const struct sr_ray *ray, const struct sr_wavelengths *w)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    sr_spectrum L = SR_BLACK;
    for (uint32_t i = 0; i < lights->infinite_count; ++i) {
        uint32_t index = lights->infinite[i];
        struct sr_light light = lights->lights[index];
        float density;
        sr_spectrum Le = light.model->Le_pdf(light.self, ray->o, ray->d, w, &density);
        L += isinf(pdf) ? Le : Le * weight_of_hit(lights, from, pdf, index, density);
    }
    return L;
}

/* Light that s lets into a body at x comes out of it elsewhere: x, frame and bsdf are there from now on, s is how the
 * path leaves it, and light straight from lights is added to L. beta is that of x before s. false: the path ends. */
static __attribute__((noinline)) bool emerge(const struct sr_scene *scene, const struct sr_bssrdf *b,
                                             const struct sr_sampler *sampler, uint32_t group, struct sr_wavelengths *w,
                                             struct sr_worker *worker, struct sr_hit *x, struct sr_frame *frame,
                                             struct sr_bsdf *bsdf, struct sr_bsdf_sample *s, sr_spectrum *beta,
                                             sr_spectrum *L)
{
    sr_u4 u_light, u_bsdf;
    sr_sample8(sampler, group + 1, &u_light, &u_bsdf);
    *beta *= s->f * (sr_abs_cos_theta(s->wi) / s->pdf);
    if (!sr_subsurface_step(scene, b, sr_sample4(sampler, group), x, w, worker, beta, bsdf, frame))
        return false;
    const sr_vec3 up = {0, 0, 1};
    struct sr_light_sample l;
    sr_spectrum L_direct;
    if (sr_path_direct(sr_scene_lights(scene), &x->point, frame, bsdf, up, u_light, w, &l, &L_direct) &&
        sr_unoccluded(scene, &x->point, &l, worker))
        *L += *beta * L_direct;
    return sr_bsdf_sample(bsdf, up, u_bsdf[2], (sr_vec2){u_bsdf[0], u_bsdf[1]}, SR_RADIANCE, s);
}

/* has_footprints, has_subsurface: constants where the compiler is to leave out what they ask for. */
SR_INLINE sr_spectrum follow(const struct sr_path *path, const struct sr_scene *scene,
                             const struct sr_path_start *start, const struct sr_sampler *sampler,
                             struct sr_wavelengths *w, struct sr_hit *first, bool has_footprints, bool has_subsurface,
                             struct sr_worker *worker)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    struct sr_ray ray = start->ray;
    sr_spectrum L = SR_BLACK;  // radiance gathered so far                     [W m^-2 sr^-1 nm^-1]
    sr_spectrum beta = SR_ONE; // product of f |cos theta_i| / pdf             [1]
    // density that chose ray.d [1/sr]; infinite: no light sampling could compete
    float pdf = INFINITY;
    float eta_scale = 1;       // what refraction has made of beta, and will undo [1]
    bool is_scattered = false; // by more than mirrors and clear glass
    float outside = 1;         // beta of light from outside the scene, over beta [1]
    struct sr_cone cone = sr_cone_of(start, has_footprints);
    struct sr_hit hits[2]; // where the path is now, and where it was scattered last
    struct sr_hit *x = &hits[0], *from = &hits[1];
    bool is_seen = first || has_footprints; // where the path is, all of it
    int passed = 0;
    if (start->receiver) {
        from->point = *start->receiver;
        pdf = start->pdf;
    }

    for (int bounce = 0;;) {
        // drawn before the ray is traced, so that the processor does both at once
        uint32_t group = SR_USE_BOUNCE + 2 * (uint32_t)bounce;
        sr_u4 u_light, u_bsdf;
        sr_sample8(sampler, group, &u_light, &u_bsdf);
        if (!(is_seen ? sr_trace(scene, &ray, x, worker) : sr_trace_bare(scene, &ray, x, worker))) {
            if (is_seen && first)
                *first = (struct sr_hit){.t = INFINITY};
            return L + beta * outside * escaping(scene, &from->point, pdf, &ray, w);
        }
        if (SR_UNLIKELY(is_seen) && first)
            *first = *x;

        // Le(x, wo)
        if (x->light != SR_NO_LIGHT) {
            sr_spectrum Le = sr_hit_Le(scene, x, sr_neg(ray.d), w);
            if (sr_spectrum_any(Le > 0.0f))
                L += beta * Le *
                     (isinf(pdf)
                          ? 1
                          : weight_of_hit(lights, &from->point, pdf, x->light,
                                          sr_light_density(lights->lights[x->light], &from->point, ray.d, &x->point)));
        }
        if (!x->material) { // an interface: the path goes on as it was
            if (!sr_pass_by(x, &ray, &passed))
                return L;
            continue;
        }
        if (bounce == path->max_depth)
            return L;

        // what scatters here
        sr_cone_meet(&cone, x, bounce == 0, is_scattered, first);
        worker->vertices += 1;
        struct sr_bsdf bsdf;
        struct sr_frame frame;
        if (!sr_shade_plain(x, ray.d, u_bsdf[3], sr_shade_seed(sampler, group), w, &bsdf, &frame)) {
            if (!sr_pass_by(x, &ray, &passed))
                return L;
            continue;
        }
        sr_vec3 wo = sr_to_local(&frame, sr_neg(ray.d));
        if (wo.z == 0)
            return L;

        // integral f L |cos theta_i| dwi, by the lights and by the surface: L(x, wi) is the next turn of this loop.
        // Both, too, are drawn before the shadow ray is traced
        struct sr_light_sample l;
        sr_spectrum L_direct;
        bool is_lit = (sr_bsdf_is_diffuse(&bsdf) || sr_bsdf_lobes(&bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY)) &&
                      sr_path_direct(lights, &x->point, &frame, &bsdf, wo, u_light, w, &l, &L_direct);
        struct sr_bsdf_sample s;
        bool goes_on = sr_bsdf_sample(&bsdf, wo, u_bsdf[2], (sr_vec2){u_bsdf[0], u_bsdf[1]}, SR_RADIANCE, &s);
        if (is_lit && sr_unoccluded(scene, &x->point, &l, worker))
            L += beta * L_direct;
        if (!goes_on)
            return L;
        struct sr_bssrdf body;
        if (SR_UNLIKELY(has_subsurface) && s.lobe & SR_LOBE_TRANSMISSION &&
            sr_material_bssrdf(x->material, &x->point, sr_neg(ray.d), u_bsdf[3], sr_shade_seed(sampler, group), w,
                               &body) &&
            !emerge(scene, &body, sampler, SR_USE_SUBSURFACE + 3 * (uint32_t)bounce, w, worker, x, &frame, &bsdf, &s,
                    &beta, &L))
            return L;
        beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
        pdf = s.lobe & SR_LOBE_SPECULAR ? INFINITY
              : s.pdf_is_proportional   ? sr_bsdf_pdf(&bsdf, wo, s.wi, SR_RADIANCE)
                                        : s.pdf;
        if (s.lobe & SR_LOBE_TRANSMISSION)
            eta_scale *= s.eta * s.eta;
        is_scattered |= !(s.lobe & SR_LOBE_SPECULAR);
        ray = sr_leave(&x->point, sr_to_world(&frame, s.wi));
        struct sr_hit *free = from;
        from = x;
        x = free;
        ++bounce;
        is_seen = false;

        // a path that carries little ends by lot, and those that survive carry its share. There is no lot over light
        // from outside the scene, most of which only this ray can find
        float carried = sr_spectrum_max(beta) * eta_scale;
        if (!(carried > 0))
            return L;
        outside = 1;
        if (carried < 1 && bounce > 1) {
            float survive = sr_survival(carried);
            bool has_outside = lights->infinite_count > 0;
            if (u_light[3] >= survive) {
                if (has_outside && sr_sees_outside(scene, &from->point, ray.d, worker))
                    L += beta * escaping(scene, &from->point, pdf, &ray, w);
                return L;
            }
            beta *= 1 / survive;
            outside = has_outside ? survive : 1;
        }
    }
}

static sr_spectrum path_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                          const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                          struct sr_worker *worker)
{
    const struct sr_path *path = self;
    bool has_footprints = sr_scene_has_footprints(scene),
         has_subsurface = path->subsurface && sr_scene_has_subsurface(scene);
    if (SR_LIKELY(!first && !has_footprints && !has_subsurface))
        return follow(path, scene, start, sampler, w, NULL, false, false, worker);
    return follow(path, scene, start, sampler, w, first, has_footprints, has_subsurface, worker);
}

bool sr_path_enters_bodies(const void *self)
{
    return ((const struct sr_path *)self)->subsurface;
}

const struct sr_integrator_model sr_integrator_path = {
    .name = "path",
    .text = "paths from the sensor; lights and BSDFs sampled and weighed by the power heuristic",
    .params = params,
    .size = sizeof(struct sr_path),
    .L = path_L,
    .knows_receivers = true,
    .enters_bodies = sr_path_enters_bodies};
