/* SPDX-License-Identifier: MIT */
/* Where the light of a scene goes: every lumen and watt that is emitted is absorbed somewhere, or leaves.
 *
 *     Phi_emitted = SUM over materials and media Phi_absorbed + Phi_escaped + Phi_given_up          [lm], [W]
 *
 * by particles from the lights (integrator.h); what is left of the difference is the closure, with its own uncertainty
 * from the same replicates. Light from outside counts as it enters the scene's sphere. What a BSDF loses that it should
 * have kept counts as absorbed by its material. */
#include "render/render.h"

enum {
    DEFAULT_REPLICATES = 16,
    DEFAULT_SAMPLES = 65536,
    EMITTED = 0,
    ABSORBED,
    ESCAPED,
    GIVEN_UP,
    CLOSURE,
    IN_MEDIA,
    PARTS
};

/* Sums of one replicate: the parts, then materials, then objects; each in two systems. */
struct replicate {
    double (*sums)[2];
    const struct balancing *b;
    uint64_t dropped;
};

struct balancing {
    const struct sr_render_job *job;
    uint32_t materials, objects;
    uint64_t n; // particles of each replicate
    struct replicate *replicates;
};

static void count(void *user, enum sr_particle_event event, const struct sr_hit *hit, sr_vec3 d, sr_spectrum flux,
                  const struct sr_wavelengths *w)
{
    (void)d;
    struct replicate *r = user;
    double readings[SR_SYSTEM_COUNT];
    sr_observe(flux, w, readings);
    double value[2] = {readings[SR_PHOTOPIC], readings[SR_RADIOMETRIC]};
    if (!isfinite(value[0]) || !isfinite(value[1])) {
        ++r->dropped;
        return;
    }
    int part = event == SR_PARTICLE_EMITTED    ? EMITTED
               : event == SR_PARTICLE_ABSORBED ? ABSORBED
               : event == SR_PARTICLE_ESCAPED  ? ESCAPED
                                               : GIVEN_UP;
    for (int k = 0; k < 2; ++k) {
        r->sums[part][k] += value[k];
        r->sums[CLOSURE][k] += part == EMITTED ? value[k] : -value[k];
        if (part == ABSORBED && !hit->object)
            r->sums[IN_MEDIA][k] += value[k];
        if (part == ABSORBED && hit->material_number && hit->material_number <= r->b->materials)
            r->sums[PARTS + hit->material_number - 1][k] += value[k];
        if (part == ABSORBED && hit->object && hit->object <= r->b->objects)
            r->sums[PARTS + r->b->materials + hit->object - 1][k] += value[k];
    }
}

static void run_replicate(void *context, uint64_t index)
{
    struct balancing *b = context;
    const struct sr_render_job *job = b->job;
    struct sr_worker worker = {0};
    struct sr_particle_watch watch = {count, &b->replicates[index]};
    for (uint64_t i = 0; i < b->n; ++i) {
        if ((i & 63) == 0 && job->cancel && atomic_load_explicit(job->cancel, memory_order_relaxed))
            return;
        struct sr_sampler sampler =
            sr_sampler_start(job->sampler, job->seed, UINT32_MAX, UINT32_MAX - 1, (uint32_t)index, (uint32_t)i);
        struct sr_wavelengths w = sr_wavelengths_sample(job->lambda, sr_sample4(&sampler, SR_USE_FILM)[2]);
        sr_follow_particle(job->scene, &sampler, &w, &watch, &worker);
    }
}

static void read_part(const struct balancing *b, uint32_t R, uint32_t part, struct sr_quantity out[2])
{
    static const enum sr_system systems[2] = {SR_PHOTOPIC, SR_RADIOMETRIC};
    for (int k = 0; k < 2; ++k) {
        struct sr_tally t = {0};
        for (uint32_t r = 0; r < R; ++r)
            sr_tally_add(&t, b->replicates[r].sums[part][k] / (double)b->n);
        out[k] = sr_quantity_of_tally(&t, sr_unit_of(SR_KIND_FLUX, systems[k], false));
    }
}

sr_status sr_measure_balance(const struct sr_render_job *job, const struct sr_measure_settings *settings,
                             struct sr_arena *arena, struct sr_balance *out, struct sr_error *error)
{
    uint32_t R = settings->replicates ? settings->replicates : DEFAULT_REPLICATES;
    struct sr_scene_counts counts = sr_scene_count(job->scene);
    struct balancing b = {.job = job,
                          .materials = (uint32_t)counts.materials,
                          .objects = (uint32_t)counts.objects,
                          .n = ((settings->samples ? settings->samples : DEFAULT_SAMPLES) + R - 1) / R};
    *out = (struct sr_balance){.materials = b.materials, .objects = b.objects, .samples = b.n * R};
    if (R < 2 || R > 4096 || b.n > UINT32_MAX)
        return sr_fail(error, SR_ERROR_USAGE, "%u replicates of %llu particles: expected 2 to 4096 of less than 2^32",
                       R, (unsigned long long)b.n);
    struct sr_arena scratch = {0};
    size_t parts = PARTS + (size_t)b.materials + b.objects;
    b.replicates = sr_arena_alloc(&scratch, R * sizeof *b.replicates);
    double(*sums)[2] = sr_arena_alloc(&scratch, R * parts * sizeof *sums);
    out->by_material = sr_arena_alloc(arena, (b.materials + 1) * sizeof *out->by_material);
    out->by_object = sr_arena_alloc(arena, ((size_t)b.objects + 1) * sizeof *out->by_object);
    if (!b.replicates || !sums || !out->by_material || !out->by_object) {
        sr_arena_free(&scratch);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the balance of %u objects", b.objects);
    }
    for (uint32_t r = 0; r < R; ++r)
        b.replicates[r] = (struct replicate){sums + r * parts, &b, 0};
    sr_parallel_for(job->threads > 0 ? job->threads : sr_thread_count(), R, run_replicate, &b);
    read_part(&b, R, EMITTED, out->emitted);
    read_part(&b, R, ABSORBED, out->absorbed);
    read_part(&b, R, ESCAPED, out->escaped);
    read_part(&b, R, GIVEN_UP, out->given_up);
    read_part(&b, R, CLOSURE, out->closure);
    read_part(&b, R, IN_MEDIA, out->in_media);
    for (uint32_t i = 0; i < b.materials; ++i)
        read_part(&b, R, PARTS + i, out->by_material[i]);
    for (uint32_t i = 0; i < b.objects; ++i)
        read_part(&b, R, PARTS + b.materials + i, out->by_object[i]);
    for (uint32_t r = 0; r < R; ++r)
        out->dropped += b.replicates[r].dropped;
    sr_arena_free(&scratch);
    return job->cancel && atomic_load_explicit(job->cancel, memory_order_relaxed) ? SR_CANCELLED : SR_OK;
}
