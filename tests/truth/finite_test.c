/* SPDX-License-Identifier: MIT */
/* Samples that are not finite are counted, every one of them, and none of them reaches the picture. */
#include "agree/render_helper.h"

#include <string.h>

static struct sr_bsdf_model poisoned_model;
static struct sr_material_model poisoned_material;
static struct sr_integrator_model watched;
static const struct sr_integrator_model *path_model;
static bool is_poisoned;        // the sample that is being made: tests here use one thread
static uint64_t poisoned_count; // samples

/* One value in sixteen, by the direction. */
static sr_spectrum poison(sr_spectrum f, sr_vec3 wo, sr_vec3 wi)
{
    static const float kinds[3] = {NAN, INFINITY, -INFINITY};
    uint32_t bits[3];
    memcpy(bits, &wi, sizeof bits);
    uint32_t h = sr_hash_combine(bits[0], sr_hash_combine(bits[1], bits[2]));
    if (h % 16 || !(wo.z > 0 && wi.z > 0))
        return f;
    is_poisoned = true;
    f[h >> 8 & 3] = kinds[(h >> 16) % 3];
    return f;
}

static sr_spectrum poisoned_f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return poison(sr_bsdf_diffuse.f(self, wo, wi, mode), wo, wi);
}

static bool poisoned_sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                            struct sr_bsdf_sample *s)
{
    bool is_there = sr_bsdf_diffuse.sample(self, wo, u_lobe, u, mode, s);
    s->f = poison(s->f, wo, s->wi);
    return is_there;
}

static void poisoned_bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    (void)self;
    (void)c;
    out->model = &poisoned_model;
    struct sr_bsdf_diffuse *d = (void *)out->data;
    d->reflectance = (sr_spectrum){} + 0.5f;
}

static sr_spectrum watched_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                             const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                             struct sr_worker *worker)
{
    is_poisoned = false;
    sr_spectrum L = path_model->L(self, scene, start, sampler, w, first, worker);
    poisoned_count += is_poisoned;
    return L;
}

TEST(samples_that_are_not_finite_are_counted_to_the_last)
{
    static const char text[] =
        "LookAt 0 0 1  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 30\nSampler \"sobol\" \"integer pixelsamples\" 512\n"
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\nIntegrator \"path\" \"integer maxdepth\" 1\nWorldBegin\n"
        "LightSource \"infinite\"\nMaterial \"conductor\" \"float roughness\" 0.5\nShape \"disk\" \"float radius\" 9\n";
    struct sr_import_result scene;
    struct sr_error error = {0};
    if (!import_scene(scene_file("poison.pbrt", text), NULL, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_hit hit;
    EXPECT(sr_raycast(scene.scene, &(struct sr_ray){.o = {0, 0, 1}, .d = {0, 0, -1}, .t_max = INFINITY}, &hit));
    poisoned_model = sr_bsdf_diffuse;
    poisoned_model.f = poisoned_f;
    poisoned_model.sample = poisoned_sample;
    poisoned_material = *hit.material->model;
    poisoned_material.bsdf = poisoned_bsdf;
    ((struct sr_material *)(uintptr_t)hit.material)->model = &poisoned_material;
    struct sr_render_job job = sr_render_job_of(&scene);
    path_model = job.integrator.model;
    watched = *path_model;
    watched.L = watched_L;
    job.integrator.model = &watched;
    job.threads = 1;
    job.spp = is_slow_build() ? 16 : 512;
    job.with_aov = true;
    struct sr_render_report report;
    struct sr_film *film = render_or_fail(&job, &report);
    uint64_t in_pixels = 0;
    for (size_t i = 0; i < 256; ++i) {
        const struct sr_film_pixel *p = &film->pixels[i];
        EXPECT(isfinite(p->sum[0]) && isfinite(p->sum[1]) && isfinite(p->sum[2]) && isfinite(p->square[0]) &&
               isfinite(p->largest));
        EXPECT(p->sum[0] > 0);
        in_pixels += p->dropped;
    }
    double samples = 256.0 * job.spp; // each meets one direction's value
    EXPECT_NEAR(poisoned_count, samples / 16, 4.9 * sqrt(samples * 15 / 256));
    EXPECT_EQUAL_INT(report.dropped, poisoned_count);
    EXPECT_EQUAL_INT(in_pixels, poisoned_count);
    // the first one is told, and is the same when it is asked for again
    float rgb[3];
    struct sr_worker worker = {0};
    EXPECT(!sr_render_sample(&job, report.dropped_x, report.dropped_y, report.dropped_replicate, report.dropped_sample,
                             rgb, NULL, &worker));
    sr_film_destroy(film);
    sr_import_result_free(&scene);
}

/* Walls on both sides of the sensor's plane: paths from the lights reach them, far beside the picture. */
TEST(paths_from_lights_beside_the_sensor_are_not_dropped)
{
    static const char text[] =
        "LookAt 0 -1.8 0  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 70\nSampler \"sobol\" \"integer pixelsamples\" 64\n"
        "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32\nIntegrator \"lightpath\" \"integer maxdepth\" 6\nWorldBegin\n"
        "LightSource \"infinite\" \"point3 portal\" [0.2 -0.5 2  0.2 0.7 2  1.2 0.7 2  1.2 -0.5 2]\nMaterial \"diffuse\" \"float reflectance\" 0.7\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -2 -2  2 -2 -2  -2 2 -2  2 2 -2]\nShape \"bilinearmesh\" \"point3 P\" [-2 2 -2  2 2 -2  -2 2 2  2 2 2]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -2 -2  -2 2 -2  -2 -2 2  -2 2 2]\nShape \"bilinearmesh\" \"point3 P\" [2 -2 -2  2 2 -2  2 -2 2  2 2 2]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -2 -2  2 -2 -2  -2 -2 2  2 -2 2]\n";
    struct sr_import_result scene;
    struct sr_error error = {0};
    if (!import_scene(scene_file("room.pbrt", text), NULL, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    struct sr_render_report report;
    struct sr_film *film = render_or_fail(&job, &report);
    EXPECT_EQUAL_INT(report.dropped, 0);
    EXPECT(sr_film_splat_mean(film, 16 * 32 + 16, 1) > 0);
    // the light's own value may still be none
    struct sr_filter filter = scene.filter;
    sr_film_splat(film, &filter, 0, (sr_vec2){16, 16}, (float[3]){NAN, 0, 0});
    sr_film_splat(film, &filter, 0, (sr_vec2){NAN, 16}, (float[3]){1, 1, 1});
    sr_film_splat(film, &filter, 0, (sr_vec2){1e7f, 16}, (float[3]){INFINITY, 1, 1});
    EXPECT_EQUAL_INT(film->splats->dropped, 2);
    sr_film_destroy(film);
    sr_import_result_free(&scene);
}
