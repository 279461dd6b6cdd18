/* SPDX-License-Identifier: MIT */
/* Choosing among many lights: probabilities, counts, sums, and no light forgotten. */
#include "scenery.h"

enum { EMITTERS = 1000 };

static float uniform(struct sr_rng *rng, float lo, float hi)
{
    return lo + (hi - lo) * sr_rng_float(rng);
}

static sr_vec3 inside_cube(struct sr_rng *rng, float size)
{
    return (sr_vec3){uniform(rng, -size, size), uniform(rng, -size, size), uniform(rng, -size, size)};
}

static struct scenery_quad random_quad(struct sr_rng *rng, float room, float size)
{
    struct scenery_quad q = {inside_cube(rng, room), sr_scale(uniform(rng, 0.01f, size), scenery_unit(rng)), {0, 0, 0}};
    do
        q.ey = sr_scale(uniform(rng, 0.01f, size), scenery_unit(rng));
    while (!(sr_length(sr_cross(q.ex, q.ey)) > 0.1f * sr_length(q.ex) * sr_length(q.ey)));
    return q;
}

/* n lights of all finite kinds, a bunch that only their seed decides; aligned: all shine toward about +z, from all
 * heights */
static struct sr_light *oriented_lights(uint32_t n, uint64_t seed, float room, float size, bool only_quads,
                                        bool aligned)
{
    struct sr_rng rng = sr_rng_seed(seed, 77);
    struct sr_light *lights = sr_arena_alloc(&scenery_arena, n * sizeof *lights);
    struct scenery_quad *quads = sr_arena_alloc(&scenery_arena, n * sizeof *quads);
    struct sr_light_emission *e = sr_arena_alloc(&scenery_arena, 2 * sizeof *e);
    struct sr_error error = {0};
    for (int k = 0; k < 2; ++k) {
        e[k] = scenery_emission();
        e[k].two_sided = k == 1;
        e[k].scale = (float)(1 + 3 * k);
        EXPECT(sr_light_emission_prepare(&e[k], 1, &scenery_arena, &error) == SR_OK);
    }
    for (uint32_t i = 0; i < n; ++i) {
        int kind = only_quads ? (int)(sr_rng_u32(&rng) % 2) : (int)(sr_rng_u32(&rng) % 4);
        quads[i] = random_quad(&rng, room, size);
        if (aligned) {
            quads[i].ex = (sr_vec3){uniform(&rng, 0.2f, 1) * size, 0, uniform(&rng, -0.01f, 0.01f) * size};
            quads[i].ey = (sr_vec3){0, uniform(&rng, 0.2f, 1) * size, 0};
            kind = kind == 1 || kind == 2 ? 0 : kind; // one-sided ones and spots
        }
        if (kind < 2) {
            lights[i] = scenery_quad_light(quads, i, &e[kind]);
            continue;
        }
        const struct sr_light_model *m = sr_light_model_find(kind == 2 ? "point" : "spot");
        void *self = scenery_new(m);
        sr_vec3 from = quads[i].corner, to = sr_add(from, aligned ? (sr_vec3){0, 0, 1e-3f + room} : scenery_unit(&rng));
        SCENERY_POINT(m, self, "from", from.x, from.y, from.z);
        SCENERY_FLOAT(m, self, "scale", uniform(&rng, 0.1f, 2));
        if (kind == 3) {
            float cone = uniform(&rng, 1, aligned ? 20 : 179);
            SCENERY_POINT(m, self, "to", to.x, to.y, to.z);
            SCENERY_FLOAT(m, self, "coneangle", cone);
            SCENERY_FLOAT(m, self, "conedeltaangle", uniform(&rng, 0, cone));
        }
        lights[i] = scenery_finish(m, self);
    }
    return lights;
}

static struct sr_light *mixed_lights(uint32_t n, uint64_t seed, float room, float size, bool only_quads)
{
    return oriented_lights(n, seed, room, size, only_quads, false);
}

static struct sr_lights build(const struct sr_light *lights, uint32_t n, enum sr_light_choice choice)
{
    struct sr_lights l;
    struct sr_error error = {0};
    if (sr_lights_build(&scenery_arena, lights, n, choice, &l, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return l;
}

static struct sr_point random_receiver(struct sr_rng *rng, float room, bool has_normal)
{
    struct sr_point x = {.p = inside_cube(rng, room)};
    if (has_normal)
        x.n = x.ns = scenery_unit(rng);
    return x;
}

TEST(probabilities_add_up_to_1_less_the_walks_that_end_in_the_dark)
{
    const uint32_t counts[] = {1, 2, 3, 8, 9, 20, 65, 300, 2000};
    for (int choice = SR_LIGHTS_BVH; choice <= SR_LIGHTS_UNIFORM; ++choice)
        for (int k = 0; k < 9; ++k) {
            struct sr_lights l =
                build(mixed_lights(counts[k], (uint64_t)k, 1, 0.1f, false), counts[k], (enum sr_light_choice)choice);
            struct sr_rng rng = sr_rng_seed(8, (uint64_t)k);
            for (int i = 0; i < 10; ++i) {
                struct sr_point x = random_receiver(&rng, i < 5 ? 1 : 5, i % 2);
                double sum = 0;
                for (uint32_t j = 0; j < counts[k]; ++j)
                    sum += (double)sr_lights_pmf(&l, &x, j);
                int dark = 0, draws = 2000;
                for (int d = 0; d < draws; ++d) {
                    uint32_t index;
                    float pmf;
                    dark += !sr_lights_pick(
                        &l, &x, ((float)d + sr_rng_float(&rng)) / (float)draws * SR_ONE_MINUS_EPSILON, &index, &pmf);
                }
                EXPECT(sum < 1 + 1e-4);
                EXPECT_NEAR(sum, 1 - (double)dark / draws, 0.02);
                if (choice != SR_LIGHTS_BVH)
                    EXPECT_NEAR(sum, 1, 1e-4);
            }
        }
}

/* Of so many, each has 128 of the numbers of 24 bits: too few to grant a dim one its probability. */
TEST(dim_lights_among_very_many_are_picked_as_often_as_their_power_says)
{
    enum { LIGHTS = 1 << 17, DRAWS = 2000000 };
    const struct sr_light_model *m = sr_light_model_find("point");
    struct sr_light of[2], *lights = sr_arena_alloc(&scenery_arena, LIGHTS * sizeof *lights);
    for (int k = 0; k < 2; ++k) {
        void *self = scenery_new(m);
        SCENERY_FLOAT(m, self, "scale", k ? 0.002f : 1);
        of[k] = scenery_finish(m, self);
    }
    for (uint32_t i = 0; i < LIGHTS; ++i)
        lights[i] = of[i & 1];
    struct sr_lights l = build(lights, LIGHTS, SR_LIGHTS_POWER);
    struct sr_rng rng = sr_rng_seed(5, 1);
    double observed[2] = {0}, expected[2] = {DRAWS / 1.002, DRAWS * 0.002 / 1.002};
    for (int d = 0; d < DRAWS; ++d) {
        struct sr_point x = random_receiver(&rng, 1, false);
        uint32_t index;
        float pmf;
        EXPECT(sr_lights_pick(&l, &x, sr_rng_float(&rng), &index, &pmf));
        observed[index & 1] += 1;
    }
    EXPECT_CHI2(observed, expected, 2);
}

/* The first allocation of the choice is refused as all others are. */
TEST(lights_without_memory_are_an_error)
{
    const struct sr_light *lights = mixed_lights(3, 1, 1, 0.1f, false);
    for (uint64_t k = 0; k < 20; ++k) {
        struct sr_arena arena = {0};
        struct sr_lights l;
        struct sr_error error = {0};
        sr_alloc_fail(k, 1);
        sr_status status = sr_lights_build(&arena, lights, 3, SR_LIGHTS_POWER, &l, &error);
        sr_alloc_fail(0, 0);
        EXPECT(status == SR_OK || status == SR_ERROR_RESOURCE);
        EXPECT(k > 0 || status == SR_ERROR_RESOURCE);
        sr_arena_free(&arena);
    }
}

TEST(lights_are_picked_in_proportion_to_their_area)
{
    static const uint32_t counts[] = {1, 2, 31, 32, 33, 100, 300};
    for (int k = 0; k < 7; ++k) {
        uint32_t n = counts[k];
        const struct sr_light *lights = mixed_lights(n, (uint64_t)k, 1, 0.1f, false);
        struct sr_lights l = build(lights, n, SR_LIGHTS_BVH);
        struct sr_point x = {.p = {1, 2, 3}};
        double total = 0, sum = 0;
        for (uint32_t i = 0; i < n; ++i) {
            total +=
                lights[i].model == &sr_light_area ? (double)((const struct sr_light_area *)lights[i].self)->area : 0;
            sum += (double)sr_lights_pmf_by_area(&l, i);
        }
        enum { DRAWS = 100000 };
        double *seen = sr_arena_alloc(&scenery_arena, n * sizeof *seen),
               *expected = sr_arena_alloc(&scenery_arena, n * sizeof *expected);
        struct sr_rng rng = sr_rng_seed(11, (uint64_t)k);
        for (int d = 0; d < DRAWS; ++d) {
            uint32_t index;
            float pmf;
            if (!sr_lights_pick_by_area(&l, &x, sr_rng_float(&rng), &index, &pmf)) {
                EXPECT(total == 0);
                continue;
            }
            EXPECT(pmf == sr_lights_pmf_by_area(&l, index));
            ++seen[index];
        }
        for (uint32_t i = 0; i < n; ++i)
            expected[i] = DRAWS * (double)sr_lights_pmf_by_area(&l, i);
        if (total > 0) {
            EXPECT_NEAR(sum, 1, 1e-5);
            EXPECT_CHI2(seen, expected, n);
        }
    }
}

/* where every light reaches everything no walk ends in the dark */
TEST(probabilities_of_points_add_up_to_1)
{
    for (uint32_t n = 1; n < 3000; n = n * 3 + 1) {
        struct sr_rng rng = sr_rng_seed(n, 1);
        struct sr_light *lights = sr_arena_alloc(&scenery_arena, n * sizeof *lights);
        for (uint32_t i = 0; i < n; ++i) {
            const struct sr_light_model *m = sr_light_model_find("point");
            void *self = scenery_new(m);
            sr_vec3 p = i % 3 ? inside_cube(&rng, 10) : (sr_vec3){1, 2, 3}; // many in one place
            SCENERY_POINT(m, self, "from", p.x, p.y, p.z);
            lights[i] = scenery_finish(m, self);
        }
        struct sr_lights l = build(lights, n, SR_LIGHTS_BVH);
        for (int i = 0; i < 20; ++i) {
            struct sr_point x = random_receiver(&rng, 10, i % 2);
            double sum = 0;
            for (uint32_t j = 0; j < n; ++j)
                sum += (double)sr_lights_pmf(&l, &x, j);
            EXPECT_NEAR(sum, 1, 2e-4);
        }
    }
}

/* Nothing in the tree has a length of its own: the same lamps, receivers and numbers in scenes of 2 mm and 2000 km.
 * Some receivers are within lamps, some lamps are small. */
TEST(picks_do_not_depend_on_the_size_of_the_scene)
{
    enum { N = 200, PICKS = 4000 };
    static uint32_t first[PICKS];
    static float first_pmf[PICKS];
    static const int exponents[] = {0, -10, 10, 20};
    for (int k = 0; k < 4; ++k) {
        struct sr_rng rng = sr_rng_seed(5, 6);
        float scale = exp2f((float)exponents[k]);
        struct sr_light lights[N];
        struct sr_light_emission *e = sr_arena_alloc(&scenery_arena, sizeof *e);
        struct scenery_quad *quads = sr_arena_alloc(&scenery_arena, N * sizeof *quads);
        struct sr_error error = {0};
        *e = scenery_emission();
        EXPECT(sr_light_emission_prepare(e, 1, &scenery_arena, &error) == SR_OK);
        for (uint32_t i = 0; i < N; ++i) {
            struct scenery_quad q = random_quad(&rng, 1, 0.2f);
            float size = i % 3 ? scale : scale * 0.01f;
            quads[i] = (struct scenery_quad){sr_scale(scale, q.corner), sr_scale(size, q.ex), sr_scale(size, q.ey)};
            lights[i] = scenery_quad_light(quads, i, e);
        }
        struct sr_lights tree = build(lights, N, SR_LIGHTS_BVH);
        for (uint32_t i = 0; i < PICKS; ++i) {
            struct sr_point x = random_receiver(&rng, 1, i % 2);
            x.p = i % 5 ? sr_scale(scale, x.p) : quads[i % N].corner;
            uint32_t index = UINT32_MAX;
            float pmf = 0, u = sr_rng_float(&rng);
            sr_lights_pick(&tree, &x, u, &index, &pmf);
            if (k == 0) {
                first[i] = index;
                first_pmf[i] = pmf;
            }
            if (index != first[i] || pmf != first_pmf[i]) // to the last bit
                test_fail(__FILE__, __LINE__, "scaled by 2^%d, receiver %u: lamp %u with %.9g, expected %u with %.9g",
                          exponents[k], i, index, (double)pmf, first[i], (double)first_pmf[i]);
        }
    }
}

TEST(picks_are_as_frequent_as_their_probabilities)
{
    enum { N = 150, DRAWS = 200000 };
    for (int choice = SR_LIGHTS_BVH; choice <= SR_LIGHTS_UNIFORM; ++choice) {
        struct sr_lights l = build(mixed_lights(N, 5, 1, 0.2f, false), N, (enum sr_light_choice)choice);
        struct sr_rng rng = sr_rng_seed(9, (uint64_t)choice);
        for (int k = 0; k < 4; ++k) {
            struct sr_point x = random_receiver(&rng, 1, k % 2);
            double observed[N + 1] = {0}, expected[N + 1] = {0}, left = DRAWS;
            for (uint32_t i = 0; i < N; ++i) {
                expected[i] = DRAWS * (double)sr_lights_pmf(&l, &x, i);
                left -= expected[i];
            }
            expected[N] = left > 1e-3 * DRAWS ? left : 0;
            for (int i = 0; i < DRAWS; ++i) {
                uint32_t index;
                float pmf;
                if (sr_lights_pick(&l, &x, sr_rng_float(&rng), &index, &pmf)) {
                    observed[index] += 1;
                    EXPECT_RELATIVE(pmf, sr_lights_pmf(&l, &x, index), 1e-4);
                } else {
                    observed[N] += 1;
                }
            }
            if (expected[N] == 0) { // hardly any dark walks: not a cell of its own
                EXPECT(observed[N] < 3e-3 * DRAWS);
                observed[N] = 0;
            }
            EXPECT_CHI2(observed, expected, N + 1);
        }
    }
}

static double contribution(struct sr_light light, const struct sr_point *x, sr_vec2 u, const struct sr_wavelengths *w)
{
    struct sr_light_sample s;
    if (!sr_light_draw(light, x, u, w, &s))
        return 0;
    return (double)(s.L[0] / s.pdf) * fmax((double)sr_dot(s.wi, x->ns), 0);
}

TEST(irradiance_of_1000_emitters_is_the_sum_of_each)
{
    for (int choice = SR_LIGHTS_BVH; choice <= SR_LIGHTS_UNIFORM; ++choice) {
        const struct sr_light *lights = mixed_lights(EMITTERS, 3, 1, 0.02f, false);
        struct sr_lights l = build(lights, EMITTERS, (enum sr_light_choice)choice);
        struct sr_wavelengths w = scenery_wavelengths(25);
        struct sr_rng rng = sr_rng_seed(10, 1);
        for (int k = 0; k < 3; ++k) {
            struct sr_point x = random_receiver(&rng, 1, true);
            x.p.z += 2; // above the lights
            double E = 0;
            for (uint32_t i = 0; i < EMITTERS; ++i) // small: a grid over each is as good as the integral
                for (int j = 0; j < 16; ++j)
                    E += contribution(lights[i], &x,
                                      (sr_vec2){((float)(j % 4) + 0.5f) / 4, ((float)(j / 4) + 0.5f) / 4}, &w) /
                         16;
            struct sr_tally tally = {0};
            for (int i = 0; i < 100000; ++i) {
                uint32_t index;
                float pmf;
                bool is_picked = sr_lights_pick(&l, &x, sr_rng_float(&rng), &index, &pmf);
                sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
                sr_tally_add(&tally, is_picked ? contribution(lights[index], &x, u, &w) / (double)pmf : 0);
            }
            printf("    1000 emitters, choice %d: relative deviation of one draw %.3g\n", choice,
                   sqrt(sr_tally_variance(&tally)) / E);
            EXPECT_MEAN(tally, E);
        }
    }
}

/* any light whose draw brings something has a chance; receivers lie also close to emitters and between ones that are
 * alike */
TEST(no_light_that_contributes_is_left_out)
{
    struct sr_wavelengths w = scenery_wavelengths(25);
    int contributing = 0;
    for (int k = 0; k < 60; ++k) {
        struct sr_rng rng = sr_rng_seed(11, (uint64_t)k);
        uint32_t n = 1 + sr_rng_u32(&rng) % (k % 3 == 0 ? 300 : 30);
        float room = powf(10, uniform(&rng, -2, 4)), size = room * powf(10, uniform(&rng, -4, 0));
        const struct sr_light *lights =
            oriented_lights(n, (uint64_t)k + 100, room, fmaxf(size, 0.02f), k % 2, k % 4 >= 2);
        struct sr_lights l = build(lights, n, SR_LIGHTS_BVH);
        for (int i = 0; i < 60; ++i) {
            struct sr_point x = random_receiver(&rng, i % 3 == 0 ? 5 * room : room, i % 4 != 0);
            for (uint32_t j = 0; j < n; ++j) {
                if (i % 3 == 1) { // near light j
                    struct sr_light_bounds b;
                    lights[j].model->bounds(lights[j].self, &b);
                    x.p = sr_mad(sr_box_centre(b.box), size * powf(10, uniform(&rng, -3, 1)), scenery_unit(&rng));
                }
                struct sr_light_sample s;
                sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
                if (!sr_light_draw(lights[j], &x, u, &w, &s) || (i % 4 != 0 && sr_dot(s.wi, x.ns) == 0))
                    continue;
                ++contributing;
                if (!(sr_lights_pmf(&l, &x, j) > 0))
                    test_fail(__FILE__, __LINE__,
                              "set %d, %u lights, room %g m, size %g m: light %u (%s) is left out at distance %g m", k,
                              n, (double)room, (double)size, j, lights[j].model->name, (double)s.distance);
            }
        }
    }
    printf("    %d contributions\n", contributing);
    EXPECT(contributing > 100000);
}

TEST(infinite_lights_have_equal_shares_with_the_tree_and_a_uniform_sky_none)
{
    static float t[3 * 16 * 16];
    for (int i = 0; i < 3 * 16 * 16; ++i)
        t[i] = (float)(i % 7);
    struct sr_light lights[5];
    memcpy(lights, mixed_lights(2, 1, 1, 0.1f, true), 2 * sizeof *lights);
    lights[2] = scenery_finish(sr_light_model_find("infinite"), scenery_new(sr_light_model_find("infinite")));
    lights[3] = scenery_finish(sr_light_model_find("distant"), scenery_new(sr_light_model_find("distant")));
    struct sr_light_common *image = scenery_new(sr_light_model_find("infinite"));
    image->texels = (struct sr_texels){16, 16, 3, NULL, t, NULL, SR_SRGB};
    lights[4] = scenery_finish(sr_light_model_find("infinite"), image);

    struct sr_lights l = build(lights, 5, SR_LIGHTS_BVH);
    struct sr_point x = {.p = {3, 3, 3}};
    EXPECT_EQUAL_INT(l.infinite_count, 2);
    EXPECT_EQUAL_INT(l.infinite[0], 2);
    EXPECT_EQUAL_INT(l.infinite[1], 4);
    EXPECT(sr_lights_pmf(&l, &x, 2) == 0);
    EXPECT_NEAR(sr_lights_pmf(&l, &x, 3), 1.0 / 3, 1e-6);
    EXPECT_NEAR(sr_lights_pmf(&l, &x, 4), 1.0 / 3, 1e-6);
    int count[5] = {0};
    for (int i = 0; i < 3000; ++i) {
        uint32_t index;
        float pmf;
        if (sr_lights_pick(&l, &x, ((float)i + 0.5f) / 3000, &index, &pmf)) {
            ++count[index];
            EXPECT_RELATIVE(pmf, sr_lights_pmf(&l, &x, index), 1e-5);
        }
    }
    EXPECT_NEAR(count[3], 1000, 1);
    EXPECT_NEAR(count[4], 1000, 1);

    uint32_t index;
    float pmf;
    l = build(&lights[2], 1, SR_LIGHTS_BVH); // a uniform sky alone
    EXPECT(!sr_lights_pick(&l, &x, 0.5f, &index, &pmf));
    EXPECT_EQUAL_INT(l.infinite_count, 1);
    l = build(&lights[3], 1, SR_LIGHTS_BVH); // a sun alone
    EXPECT(sr_lights_pick(&l, &x, 0.5f, &index, &pmf) && index == 0 && pmf == 1);
    l = build(NULL, 0, SR_LIGHTS_BVH);
    EXPECT(!sr_lights_pick(&l, &x, 0.5f, &index, &pmf));
}

/* not a matter of truth but of cost: told, and a hundred times the lights take less than a thousand times as long */
TEST(trees_are_built_and_walked_fast)
{
    const uint32_t counts[] = {1, 10, 1000, 10000, 1000000};
    double before_s = 0;
    for (int k = 0; k < 5; ++k) {
        uint32_t n = counts[k];
        struct sr_arena arena = {0};
        struct sr_rng rng = sr_rng_seed(12, 1);
        struct scenery_quad *quads = sr_alloc(n * sizeof *quads);
        struct sr_light_area *areas = sr_alloc(n * sizeof *areas);
        struct sr_light *lights = sr_alloc(n * sizeof *lights);
        struct sr_light_emission e = scenery_emission();
        struct sr_error error = {0};
        EXPECT(sr_light_emission_prepare(&e, 1, &arena, &error) == SR_OK);
        for (uint32_t i = 0; i < n; ++i) {
            quads[i] = random_quad(&rng, 10, 0.02f);
            areas[i] = (struct sr_light_area){
                .shape = {&scenery_quads, quads}, .primitive = i, .emission = &e, .area = scenery_quad_area(quads, i)};
            lights[i] = (struct sr_light){&sr_light_area, &areas[i]};
        }
        struct sr_lights l;
        double t0 = test_processor_s();
        EXPECT(sr_lights_build(&arena, lights, n, SR_LIGHTS_BVH, &l, &error) == SR_OK);
        double build_s = test_processor_s() - t0;
        enum { WALKS = 100000, PLACES = 1024 };
        static struct sr_point x[PLACES];
        static uint32_t found[PLACES];
        for (int i = 0; i < PLACES; ++i)
            x[i] = random_receiver(&rng, 10, true);
        float sum = 0, pmf = 0;
        t0 = test_processor_s();
        for (int i = 0; i < WALKS; ++i)
            sum +=
                sr_lights_pick(&l, &x[i % PLACES], (float)(i * 7919 % WALKS) / (float)WALKS, &found[i % PLACES], &pmf)
                    ? pmf
                    : 0;
        double pick_ns = (test_processor_s() - t0) / WALKS * 1e9;
        t0 = test_processor_s();
        for (int i = 0; i < WALKS; ++i)
            sum += sr_lights_pmf(&l, &x[i % PLACES], found[i % PLACES]);
        double pmf_ns = (test_processor_s() - t0) / WALKS * 1e9;
        printf("    %7u lights: pick %.0f ns, pmf %.0f ns, built in %.3f s, %.1f B a light (%g)\n", n, pick_ns, pmf_ns,
               build_s, (double)arena.total / n, (double)sum);
        if (n == 1000000)
            EXPECT(build_s < 1000 * fmax(before_s, 0.01) && (double)arena.total / n < 64);
        before_s = build_s;
        sr_free(quads);
        sr_free(areas);
        sr_free(lights);
        sr_arena_free(&arena);
    }
}
