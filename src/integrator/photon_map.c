/* SPDX-License-Identifier: MIT */
/* Photons behind mirrors and clear glass, traced by all threads that wait for them, and found by a hashed grid.
 *
 * H. W. Jensen, Global illumination using photon maps, 1996: the caustic map. The radius of the i-th map shrinks as
 *
 *     r(i+1)^2 = r(i)^2 (i + alpha) / (i + 1),  alpha = 2/3
 *
 * C. Knaus & M. Zwicker, Progressive photon mapping: a probabilistic approach, 2011, eq. 20: bias and variance of the
 * mean over all maps both vanish. Limit: at any number of maps caustics are blurred by about the last radius. */
#define _POSIX_C_SOURCE 200809L
#include "integrator/photon_map.h"

#include "integrator/shade.h"
#include "integrator/vertices.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

enum { CHUNK = 1024, MOST_SCATTERINGS = 64, MOST_PASSED = 1000, MAPS_OF_A_REPLICATE = 16 };

enum state { FREE, BUILDING, READY };

struct slot {
    struct sr_photon_map map;
    enum state state;
    bool has_failed;
    uint32_t replicate, number;
    int users; // threads that hold it or build it
    uint64_t last_use;
    uint64_t next_chunk, done_chunks;
    struct sr_array *chunks; // of struct sr_photon, one array each
};

struct sr_photon_maps {
    const struct sr_scene *scene;
    struct sr_photon_plan plan;
    struct sr_picture_plan picture;
    uint64_t chunk_count, clock;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int slot_count;
    struct slot slots[];
};

struct sr_photon_maps *sr_photon_maps_create(const struct sr_scene *scene, const struct sr_photon_plan *plan,
                                             const struct sr_picture_plan *picture)
{
    int slots = picture->threads + MAPS_OF_A_REPLICATE; // each thread holds one at most
    struct sr_photon_maps *m = sr_alloc(sizeof *m + (size_t)slots * sizeof m->slots[0]);
    if (!m)
        return NULL;
    m->slot_count = slots;
    m->scene = scene;
    m->plan = *plan;
    m->picture = *picture;
    if (m->plan.paths == 0)
        m->plan.paths = (uint64_t)picture->width * picture->height;
    if (!(m->plan.radius > 0))
        m->plan.radius = 0.004f * sr_length(sr_box_diagonal(sr_scene_bounds(scene)));
    m->chunk_count = (m->plan.paths + CHUNK - 1) / CHUNK;
    pthread_mutex_init(&m->lock, NULL);
    pthread_cond_init(&m->changed, NULL);
    return m;
}

static void empty(struct sr_photon_maps *m, struct slot *s)
{
    for (uint64_t i = 0; s->chunks && i < m->chunk_count; ++i)
        sr_array_free(&s->chunks[i]);
    sr_free(s->chunks);
    sr_free(s->map.photons);
    sr_free(s->map.cells);
    *s = (struct slot){0};
}

void sr_photon_maps_destroy(struct sr_photon_maps *m)
{
    for (int i = 0; i < m->slot_count; ++i)
        empty(m, &m->slots[i]);
    pthread_mutex_destroy(&m->lock);
    pthread_cond_destroy(&m->changed);
    sr_free(m);
}

/* ---- particles ---- */

static bool keep(struct sr_array *photons, const struct sr_hit *x, sr_vec3 d, sr_spectrum flux, uint32_t scatterings,
                 const struct sr_wavelengths *w)
{
    struct sr_photon *p = sr_array_push(photons, sizeof *p);
    if (!p)
        return false;
    *p = (struct sr_photon){.flux = flux,
                            .p = x->point.p,
                            .wi = sr_neg(d),
                            .n = x->point.n,
                            .scatterings = scatterings,
                            .is_single = sr_wavelengths_secondary_terminated(w)};
    return true;
}

/* One path from the lights, as long as it meets nothing but mirrors and clear glass; false: no memory. */
static bool trace(const struct sr_photon_maps *m, const struct sr_photon_map *map, const struct sr_sampler *sampler,
                  struct sr_array *photons, struct sr_worker *worker)
{
    struct sr_wavelengths w = map->w;
    sr_u4 u = sr_sample4(sampler, SR_USE_LIGHT_PATH), u_place = sr_sample4(sampler, SR_USE_LIGHT_PATH + 1);
    struct sr_light_ray r;
    if (!sr_lights_emit(sr_scene_lights(m->scene), u[2], (sr_vec2){u_place[0], u_place[1]}, (sr_vec2){u[0], u[1]}, &w,
                        &r) ||
        !sr_has_come_in(m->scene, &r, worker))
        return true;
    float cos_theta = sr_length2(r.from.n) > 0 ? fabsf(sr_dot(r.from.n, r.w)) : 1;
    sr_spectrum beta = r.L * (cos_theta / (r.pmf * r.pdf_area * r.pdf_direction));
    struct sr_ray ray = sr_leave(&r.from, r.w);
    ray.time = u_place[2];
    uint32_t most = m->plan.max_depth < MOST_SCATTERINGS ? (uint32_t)m->plan.max_depth : MOST_SCATTERINGS;
    for (uint32_t scatterings = 0, passed = 0; scatterings < most && passed < MOST_PASSED;) {
        struct sr_hit x;
        if (!sr_trace_bare(m->scene, &ray, &x, worker))
            return true;
        struct sr_bsdf bsdf = {.model = NULL};
        struct sr_frame frame;
        sr_u4 u_survive, u_bsdf;
        if (x.material) {
            uint32_t group = SR_USE_LIGHT_PATH + 2 + 2 * scatterings;
            sr_sample8(sampler, group, &u_survive, &u_bsdf);
            sr_point_set_footprint(&x.point, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 0});
            sr_material_shade(x.material, &x.point, sr_neg(ray.d), u_bsdf[3], sr_shade_seed(sampler, group), &w, &bsdf,
                              &frame);
        }
        if (!bsdf.model) {
            ++passed;
            ray = sr_leave(&x.point, ray.d);
            continue;
        }
        worker->vertices += 1;
        if (scatterings > 0 && sr_bsdf_lobes(&bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY) &&
            !keep(photons, &x, ray.d, beta, scatterings, &w))
            return false;
        sr_vec3 back = sr_to_local(&frame, sr_neg(ray.d));
        struct sr_bsdf_sample s;
        if (back.z == 0 ||
            !sr_bsdf_sample(&bsdf, back, u_bsdf[2], (sr_vec2){u_bsdf[0], u_bsdf[1]}, SR_IMPORTANCE, &s) ||
            !(s.lobe & SR_LOBE_SPECULAR))
            return true;
        sr_vec3 out = sr_to_world(&frame, s.wi);
        float in_cos = fabsf(sr_dot(x.point.n, ray.d)), out_cos = fabsf(sr_dot(x.point.n, out));
        sr_spectrum rest = beta * s.f * (in_cos > 0 ? sr_abs_cos_theta(back) * out_cos / (in_cos * s.pdf) : 0);
        float survive = sr_spectrum_max(rest) / sr_spectrum_max(beta);
        if (!(survive > 0) || u_survive[3] >= survive)
            return true;
        beta = rest * (survive < 1 ? 1 / survive : 1);
        ray = sr_leave(&x.point, out);
        ++scatterings;
    }
    return true;
}

static bool trace_chunk(const struct sr_photon_maps *m, struct slot *s, uint64_t chunk, struct sr_worker *worker)
{
    uint64_t end = (chunk + 1) * CHUNK < m->plan.paths ? (chunk + 1) * CHUNK : m->plan.paths;
    for (uint64_t i = chunk * CHUNK; i < end; ++i) {
        uint64_t index = (uint64_t)s->number * m->plan.paths + i; // all maps of a replicate are parts of one net
        struct sr_sampler sampler = sr_sampler_start(m->picture.sampler, m->picture.seed, UINT32_MAX,
                                                     (uint32_t)(index >> 32), s->replicate, (uint32_t)index);
        if (!trace(m, &s->map, &sampler, &s->chunks[chunk], worker))
            return false;
    }
    return true;
}

/* ---- the grid ---- */

/* Cells are as wide as two radii, so that a sphere touches eight of them at most. */
static uint32_t hash_cell(int32_t x, int32_t y, int32_t z)
{
    uint32_t h = (uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u;
    return h ^ h >> 15;
}

/* Far away for its radius numbers of cells are folded, for they must fit an int; floats there are whole numbers. */
static int32_t number_of(float x)
{
    const float most = 0x1p30f;
    if (!(fabsf(x) < most))
        x = isfinite(x) ? fmodf(x, most) : 0;
    return (int32_t)floorf(x);
}

static uint32_t cell_of(const struct sr_photon_map *map, sr_vec3 p)
{
    float side = 2 * map->radius;
    return hash_cell(number_of(p.x / side), number_of(p.y / side), number_of(p.z / side)) & map->mask;
}

/* Counting sort of the chunks' photons, in the order of chunks. */
static bool build_grid(const struct sr_photon_maps *m, struct slot *s)
{
    struct sr_photon_map *map = &s->map;
    size_t count = 0;
    for (uint64_t i = 0; i < m->chunk_count; ++i)
        count += s->chunks[i].count;
    uint32_t cells = 64;
    while (cells < count && cells < 1u << 30)
        cells *= 2;
    map->mask = cells - 1;
    map->count = (uint32_t)count;
    map->photons = sr_alloc((count + 1) * sizeof *map->photons);
    map->cells = sr_alloc(((size_t)cells + 2) * sizeof *map->cells);
    if (count >= UINT32_MAX || !map->photons || !map->cells)
        return false;
    // filling moves the beginning of each cell to its end, which is the beginning of the next
    uint32_t *begin = map->cells + 1;
    for (uint64_t i = 0; i < m->chunk_count; ++i)
        for (size_t k = 0; k < s->chunks[i].count; ++k)
            ++begin[cell_of(map, ((struct sr_photon *)s->chunks[i].data)[k].p)];
    uint32_t sum = 0;
    for (uint32_t c = 0; c <= cells; ++c) {
        uint32_t n = begin[c];
        begin[c] = sum;
        sum += n;
    }
    for (uint64_t i = 0; i < m->chunk_count; ++i)
        for (size_t k = 0; k < s->chunks[i].count; ++k) {
            const struct sr_photon *p = &((struct sr_photon *)s->chunks[i].data)[k];
            map->photons[begin[cell_of(map, p->p)]++] = *p;
        }
    for (uint64_t i = 0; i < m->chunk_count; ++i)
        sr_array_free(&s->chunks[i]);
    sr_free(s->chunks);
    s->chunks = NULL;
    return true;
}

void sr_photons_near(const struct sr_photon_map *map, sr_vec3 p, void (*f)(void *user, const struct sr_photon *photon),
                     void *user)
{
    float side = 2 * map->radius, r2 = map->radius * map->radius;
    sr_vec3 corner = {p.x / side - 0.5f, p.y / side - 0.5f, p.z / side - 0.5f};
    int32_t x = number_of(corner.x), y = number_of(corner.y), z = number_of(corner.z);
    uint32_t visited[8];
    int n = 0;
    for (int i = 0; i < 8; ++i) {
        uint32_t cell = hash_cell(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2)) & map->mask;
        bool is_new = true; // two of the eight may share a hash
        for (int k = 0; k < n; ++k)
            is_new = is_new && visited[k] != cell;
        if (!is_new)
            continue;
        visited[n++] = cell;
        for (uint32_t k = map->cells[cell]; k < map->cells[cell + 1]; ++k)
            if (sr_length2(sr_sub(map->photons[k].p, p)) < r2)
                f(user, &map->photons[k]);
    }
}

/* ---- who has which map ---- */

static void begin(struct sr_photon_maps *m, struct slot *s, uint32_t replicate, uint32_t number)
{
    empty(m, s);
    s->state = BUILDING;
    s->replicate = replicate;
    s->number = number;
    double r2 = (double)m->plan.radius * (double)m->plan.radius;
    for (uint32_t i = 1; i <= number; ++i)
        r2 *= (i - 1.0 / 3) / i;
    s->map.radius = (float)sqrt(r2);
    s->map.paths = m->plan.paths;
    struct sr_sampler sampler =
        sr_sampler_start(m->picture.sampler, m->picture.seed, UINT32_MAX, UINT32_MAX, replicate, number);
    s->map.w =
        sr_wavelengths_draw(&m->picture.law, m->picture.jitter_lambda ? sr_sample4(&sampler, SR_USE_FILM)[2] : 0.5f);
    sr_wavelengths_know(&s->map.w, sr_scene_lights(m->scene)->white);
    s->chunks = sr_alloc((m->chunk_count + 1) * sizeof *s->chunks);
    s->has_failed = !s->chunks;
}

/* With the lock held; helps where the map is being made. */
static void finish(struct sr_photon_maps *m, struct slot *s, struct sr_worker *worker)
{
    while (s->state == BUILDING) {
        if (s->next_chunk < m->chunk_count && !s->has_failed) {
            uint64_t chunk = s->next_chunk++;
            pthread_mutex_unlock(&m->lock);
            bool is_done = trace_chunk(m, s, chunk, worker);
            pthread_mutex_lock(&m->lock);
            ++s->done_chunks;
            s->has_failed |= !is_done;
        } else if (s->done_chunks == s->next_chunk && s->next_chunk != UINT64_MAX) {
            s->next_chunk = UINT64_MAX; // nobody else builds the grid
            bool has_failed = s->has_failed;
            pthread_mutex_unlock(&m->lock);
            has_failed = has_failed || !build_grid(m, s);
            pthread_mutex_lock(&m->lock);
            s->has_failed = has_failed;
            s->state = READY;
            pthread_cond_broadcast(&m->changed);
        } else {
            pthread_cond_wait(&m->changed, &m->lock);
        }
        if (s->done_chunks == m->chunk_count)
            pthread_cond_broadcast(&m->changed);
    }
}

static struct slot *find(struct sr_photon_maps *m, uint32_t replicate, uint32_t number)
{
    struct slot *oldest = NULL;
    for (int i = 0; i < m->slot_count; ++i) {
        struct slot *s = &m->slots[i];
        if (s->state != FREE && s->replicate == replicate && s->number == number)
            return s;
        if (s->users == 0 && (!oldest || s->last_use < oldest->last_use))
            oldest = s;
    }
    if (oldest)
        begin(m, oldest, replicate, number);
    return oldest;
}

const struct sr_photon_map *sr_photon_map_of(struct sr_photon_maps *m, uint32_t replicate, uint32_t sample,
                                             struct sr_worker *worker)
{
    // where every replicate visits all its samples in one go, several share a map, so that all maps of it are at hand
    uint32_t each =
        m->picture.per_replicate ? (m->picture.per_replicate + MAPS_OF_A_REPLICATE - 1) / MAPS_OF_A_REPLICATE : 1;
    uint32_t number = sample / each;
    struct slot *held = worker->held;
    if (!held || held->replicate != replicate || held->number != number) {
        pthread_mutex_lock(&m->lock);
        if (held)
            --held->users;
        while (!(held = find(m, replicate, number)))
            pthread_cond_wait(&m->changed, &m->lock);
        ++held->users;
        held->last_use = ++m->clock;
        finish(m, held, worker);
        pthread_cond_broadcast(&m->changed);
        pthread_mutex_unlock(&m->lock);
        worker->held = held;
    }
    return held->has_failed ? NULL : &held->map;
}
