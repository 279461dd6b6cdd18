/* SPDX-License-Identifier: MIT */
/* Path tracing with caustics by photons: light that mirrors and clear glass throw on a surface, whether the surface is
 * seen directly, in a mirror or through glass.
 *
 * Each path of light has one estimator. Seen from its light, it is scattered by s >= 0 delta reflections and
 * refractions before anything else scatters it. Paths with s = 0 and those that nothing else scatters are traced from
 * the sensor, as in path.c; paths with s > 0 are joined where they first meet anything else, at x, by the density of
 * photons about x:
 *
 *     L(x, wo) = 1 / (paths pi r^2) SUM f(wo, wi) flux        over photons closer than r
 *
 * H. W. Jensen 1996; r shrinks from sample to sample (photon_map.c), so that the picture converges to the equation's
 * solution. Limits: caustics are blurred by r, which error bars do not tell; what slightly rough glass throws is left
 * to path tracing; a meter, which shares nothing, is read by path tracing alone. */
#include "integrator/photon_map.h"
#include "integrator/way.h"

struct caustics {
    int32_t max_depth;
    int32_t light_sampler;
    int32_t photons;
    float radius;
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct caustics, max_depth), "most scatterings of a path"},
    {SR_PARAM_ENUM, "lightsampler", "1", 0, 3, 0, offsetof(struct caustics, light_sampler),
     "bvh|power|uniform|exhaustive"},
    {SR_PARAM_INT, "photonsperiteration", "1", -1, 1e9, -1, offsetof(struct caustics, photons),
     "paths from the lights for each sample; -1: as many as pixels"},
    {SR_PARAM_FLOAT, "radius", "m", 0, 1e30, 0, offsetof(struct caustics, radius),
     "that a photon is spread over at first; 0: 0.4 % of the scene's diagonal"},
    {.name = NULL},
};

static sr_status begin(const void *self, const struct sr_scene *scene, const struct sr_picture_plan *picture,
                       void **shared, struct sr_error *error)
{
    const struct caustics *m = self;
    *shared = NULL;
    if (!sr_scene_has_mirrors(scene)) // then there are no such paths
        return SR_OK;
    struct sr_photon_plan plan = {
        .radius = m->radius, .paths = m->photons > 0 ? (uint64_t)m->photons : 0, .max_depth = m->max_depth};
    *shared = sr_photon_maps_create(scene, &plan, picture);
    return *shared ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for maps of photons");
}

static void end(void *shared)
{
    sr_photon_maps_destroy(shared);
}

/* ---- the density of photons at a surface ---- */

struct gathering {
    const struct sr_hit *x;
    const struct sr_bsdf *bsdf;
    const struct sr_frame *frame;
    sr_vec3 wo;
    uint32_t most;           // scatterings that a photon may have behind it
    sr_spectrum sum, single; // of photons of all wavelengths, and of those of which only the first is left
};

static void gather_one(void *user, const struct sr_photon *photon)
{
    struct gathering *g = user;
    if (photon->scatterings > g->most || sr_dot(photon->n, g->x->point.n) < 0.7f) // around a corner
        return;
    sr_vec3 wi = sr_to_local(g->frame, photon->wi);
    float in_cos = fabsf(sr_dot(photon->wi, g->x->point.n)), pdf;
    if (in_cos < 1e-6f)
        return;
    // flux counts by the true surface, f by the shading normal (Veach 1997, 5.3)
    sr_spectrum fL =
        sr_bsdf_f_pdf(g->bsdf, g->wo, wi, SR_RADIANCE, &pdf) * photon->flux * (sr_abs_cos_theta(wi) / in_cos);
    *(photon->is_single ? &g->single : &g->sum) += fL;
}

/* ---- paths from the sensor ---- */

static void gather(const struct sr_photon_map *map, struct gathering *g, sr_spectrum beta, sr_spectrum *L,
                   sr_spectrum *L_single)
{
    g->sum = g->single = SR_BLACK;
    sr_photons_near(map, g->x->point.p, gather_one, g);
    float density = 1 / ((float)map->paths * SR_PI * map->radius * map->radius); // [1/m^2] of one photon
    *L += beta * g->sum * density;
    *L_single += beta * g->single * density;
}

/* Light that mirrors throw on what has scattered this path before is the photons'. */
static bool is_photons(const struct sr_photon_map *map, const struct sr_way *p)
{
    return map && p->is_scattered && isinf(p->pdf);
}

/* L along the path, but for what photons of a single wavelength bring. */
static sr_spectrum walk(const struct caustics *m, const struct sr_photon_map *map, struct sr_way *p,
                        sr_spectrum *single)
{
    for (;;) {
        sr_spectrum met;
        enum sr_arrival arrival = sr_way_arrive(p, m->max_depth, !is_photons(map, p), &met);
        if (arrival == SR_ARRIVAL_END)
            return p->L;
        if (arrival == SR_ARRIVAL_NOTHING)
            continue;
        sr_way_gain_direct(p);
        if (map && sr_way_is_open(p) && p->bounce + 1 < m->max_depth)
            gather(map,
                   &(struct gathering){.x = &p->x,
                                       .bsdf = &p->bsdf,
                                       .frame = &p->frame,
                                       .wo = p->wo,
                                       .most = (uint32_t)(m->max_depth - p->bounce - 1)},
                   p->beta, &p->L, single);
        if (!sr_way_scatter(p))
            return p->L;
        float stands_for = sr_way_lot(p, sr_spectrum_max(p->beta), !is_photons(map, p));
        if (stands_for == 0)
            return p->L;
        p->beta *= stands_for;
    }
}

static sr_spectrum caustics_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                              const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                              struct sr_worker *worker)
{
    const struct sr_photon_map *map = NULL;
    if (worker->shared) {
        map = sr_photon_map_of(worker->shared, worker->replicate, sampler->sample, worker);
        if (!map)
            return SR_BLACK + NAN; // no memory: dropped, and told
        *w = map->w;               // photons are of the same wavelengths
    }
    struct sr_way way;
    sr_way_begin(&way, scene, start, sampler, w, first, worker);
    sr_spectrum single = SR_BLACK, L = walk(self, map, &way, &single);
    // of one wavelength: it stands for all, whether dispersion has left the sensor's path the others or not
    L[0] += single[0] * (sr_wavelengths_secondary_terminated(w) ? 1 : SR_LAMBDA_COUNT);
    return L;
}

const struct sr_integrator_model sr_integrator_caustics = {
    .name = "caustics",
    .text = "paths from the sensor, and photons where mirrors and glass throw light on a surface",
    .params = params,
    .size = sizeof(struct caustics),
    .L = caustics_L,
    .knows_receivers = true,
    .begin = begin,
    .end = end,
    .by_turns = true,
};
