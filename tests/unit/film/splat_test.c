/* SPDX-License-Identifier: MIT */
/* Splats: sums that do not depend on order, filters that share light out exactly, guarded ranges, error bars. */
#include "film/film.h"
#include "test.h"

static struct sr_arena arena;

static struct sr_film *film_of(int w, int h, uint32_t groups)
{
    struct sr_film_settings s = {.width = w, .height = h, .x1 = w, .y1 = h};
    struct sr_error error = {0};
    struct sr_film *film;
    EXPECT(sr_film_create(&s, false, &film, &error) == SR_OK &&
           sr_film_add_splats(film, groups, 0x1p-56, &error) == SR_OK);
    return film;
}

static struct sr_filter filter_of(const char *name)
{
    const struct sr_filter_model *m = sr_filter_model_find(name);
    char *self = sr_arena_alloc(&arena, m->size);
    for (const struct sr_param *p = m->params; p->name; ++p)
        *(float *)(void *)(self + p->offset) = (float)p->initial;
    struct sr_filter f;
    struct sr_error error = {0};
    EXPECT(sr_filter_prepare(&arena, m, self, &f, &error) == SR_OK);
    return f;
}

TEST(splats_add_up_in_any_order_and_by_any_thread)
{
    enum { N = 20000 };
    struct sr_filter f = filter_of("mitchell");
    struct sr_film *a = film_of(7, 5, 4), *b = film_of(7, 5, 4);
    for (int pass = 0; pass < 2; ++pass)
        for (int k = 0; k < N; ++k) {
            int i = pass ? N - 1 - k : k;
            struct sr_rng rng = sr_rng_seed((uint64_t)i, 7);
            sr_vec2 q = {9 * sr_rng_float(&rng) - 1, 7 * sr_rng_float(&rng) - 1};
            float size = powf(10, 12 * sr_rng_float(&rng) - 8) * (sr_rng_float(&rng) < .3f ? -1 : 1);
            float rgb[3] = {size, size * sr_rng_float(&rng), size * sr_rng_float(&rng)};
            sr_film_splat(pass ? b : a, &f, (uint32_t)i % 4, q, rgb);
        }
    EXPECT(memcmp(a->splats->words, b->splats->words, 7 * 5 * sr_film_splats_B(4)) == 0);
    sr_film_destroy(a);
    sr_film_destroy(b);
}

struct racing {
    struct sr_film *film;
    struct sr_filter filter;
};

static void race(void *context, uint64_t i)
{
    struct racing *r = context;
    float rgb[3] = {i % 2 ? -3e5f : 3e5f, 1, 1e-9f}; // the lower word overflows at every other turn
    for (int k = 0; k < 5000; ++k)
        sr_film_splat(r->film, &r->filter, 0, (sr_vec2){0.5f, 0.5f}, rgb);
}

TEST(threads_carry_right)
{
    struct racing r = {film_of(1, 1, 2), filter_of("box")};
    sr_parallel_for(4, 8, race, &r);
    sr_film_splat_paths(r.film, 0, 40000);
    double mean[3];
    sr_film_pixel_mean(r.film, 0, 0, mean);
    EXPECT_NEAR(mean[0], 0, 1e-9);
    EXPECT_NEAR(mean[1], 1, 1e-12);
    EXPECT_NEAR(mean[2], (double)1e-9f, 1e-16);
    sr_film_destroy(r.film);
}

// evenly lit rasters give even pictures with every filter, up to what the filter sees beyond the border
TEST(filters_share_splats_out)
{
    static const char *const names[] = {"box", "triangle", "gaussian", "mitchell", "sinc"};
    for (int k = 0; k < 5; ++k) {
        struct sr_filter f = filter_of(names[k]);
        enum { SIDE = 11, STEPS = 40 };
        struct sr_film *film = film_of(SIDE, SIDE, 2);
        for (int j = 0; j < SIDE * STEPS; ++j)
            for (int i = 0; i < SIDE * STEPS; ++i)
                sr_film_splat(film, &f, 0, (sr_vec2){((float)i + .5f) / STEPS, ((float)j + .5f) / STEPS},
                              (float[3]){SIDE * SIDE, 0, 0});
        sr_film_splat_paths(film, 0, (uint64_t)SIDE * SIDE * STEPS * STEPS);
        double mean[3];
        sr_film_pixel_mean(film, SIDE / 2, SIDE / 2, mean);
        EXPECT_NEAR(mean[0], 1, 2e-3);
        sr_film_destroy(film);
    }
}

TEST(splats_out_of_range_are_dropped_and_counted)
{
    struct sr_filter f = filter_of("box");
    struct sr_film *film = film_of(2, 2, 2);
    sr_film_splat(film, &f, 0, (sr_vec2){1, 1}, (float[3]){NAN, 0, 0});
    sr_film_splat(film, &f, 0, (sr_vec2){1, 1}, (float[3]){0, INFINITY, 0});
    sr_film_splat(film, &f, 0, (sr_vec2){1, 1}, (float[3]){0, 0, 1e30f});
    sr_film_splat(film, &f, 0, (sr_vec2){1e20f, 1}, (float[3]){1, 1, 1}); // far outside: nobody's
    sr_film_splat(film, &f, 0, (sr_vec2){-1e20f, NAN}, (float[3]){1, 1, 1});
    EXPECT_EQUAL_INT(film->splats->dropped, 3);
    for (size_t i = 0; i < 2 * 2 * sr_film_splats_B(2) / sizeof(uint64_t); ++i)
        EXPECT(film->splats->words[i] == 0);
    sr_film_destroy(film);
}

// 95 % intervals of a region, whose pixels are splatted together, cover as often as they say
TEST(error_bars_of_splats_cover)
{
    struct sr_filter f = filter_of("gaussian");
    enum { FILMS = 400, PATHS = 200, GROUPS = 8 };
    int covered = 0;
    struct sr_rng rng = sr_rng_seed(3, 9);
    const double w[3] = {1, 0, 0};
    for (int k = 0; k < FILMS; ++k) {
        struct sr_film *film = film_of(4, 4, GROUPS);
        for (int i = 0; i < PATHS; ++i)
            sr_film_splat(film, &f, (uint32_t)i % GROUPS,
                          (sr_vec2){8 * sr_rng_float(&rng) - 2, 8 * sr_rng_float(&rng) - 2}, (float[3]){64, 0, 0});
        for (uint32_t g = 0; g < GROUPS; ++g)
            sr_film_splat_paths(film, g, PATHS / GROUPS);
        double mean = 0;
        for (size_t p = 0; p < 16; ++p)
            mean += sr_film_splat_mean(film, p, 0) / 16;
        double se = sqrt(sr_film_splat_variance(film, 0, 0, 4, 4, w)) / 16;
        covered += fabs(mean - 1) < sr_student_quantile(0.975, GROUPS - 1) * se;
        sr_film_destroy(film);
    }
    printf("    %d of %d intervals cover\n", covered, FILMS);
    EXPECT(covered >= 0.92 * FILMS && covered <= 0.98 * FILMS);
}
