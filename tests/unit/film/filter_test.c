/* SPDX-License-Identifier: MIT */
/* Positions drawn for a pixel filter: weighted, they have the filter's integral over any part of its extent. */
#include "film/film.h"
#include "test.h"

#include <string.h>

enum { N = 1 << 18, CELLS = 12 };

struct five { // every filter's numbers, as its table of parameters orders them
    float value[8];
};

static void defaults(const struct sr_filter_model *model, struct five *self)
{
    *self = (struct five){{0}};
    for (const struct sr_param *p = model->params; p->name; ++p) {
        float initial = (float)p->initial;
        memcpy((char *)self + p->offset, &initial, sizeof initial);
    }
}

// the share of the integral over a cell of the extent, by the midpoint rule
static double share_of(const struct sr_filter *f, int i, int j)
{
    enum { FINE = 64 };
    double sum = 0;
    for (int b = 0; b < FINE; ++b)
        for (int a = 0; a < FINE; ++a) {
            sr_vec2 p = {f->radius.x * (float)(((double)i + (a + 0.5) / FINE) / CELLS * 2 - 1),
                         f->radius.y * (float)(((double)j + (b + 0.5) / FINE) / CELLS * 2 - 1)};
            sum += (double)f->model->value(f->self, p);
        }
    return sum;
}

static void check(const struct sr_filter_model *model, const struct five *self)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_filter f;
    if (sr_filter_prepare(&arena, model, self, &f, &error) != SR_OK) {
        test_fail(__FILE__, __LINE__, "%s", error.text);
        sr_arena_free(&arena);
        return;
    }
    static double drawn[CELLS][CELLS], expected[CELLS][CELLS];
    double all = 0, mean = 0, total = 0;
    memset(drawn, 0, sizeof drawn);
    for (int j = 0; j < CELLS; ++j)
        for (int i = 0; i < CELLS; ++i)
            all += expected[j][i] = share_of(&f, i, j);
    for (uint32_t k = 0; k < N; ++k) { // a (0,2)-sequence: the error is far below 1/sqrt(N)
        struct sr_sampler s = sr_sampler_start(SR_SAMPLER_SOBOL, 1, 0, 0, 0, k);
        sr_u4 u = sr_sample4(&s, 0);
        float weight;
        sr_vec2 p = sr_filter_sample(&f, (sr_vec2){u[0], u[1]}, &weight);
        EXPECT(fabsf(p.x) <= f.radius.x * 1.0001f && fabsf(p.y) <= f.radius.y * 1.0001f);
        float value = model->value(self, p);
        if (fabsf(value) > 0.02f * fabsf(model->value(self, (sr_vec2){0, 0})))
            EXPECT((value < 0) == (weight < 0));
        int i = (int)((p.x / f.radius.x + 1) / 2 * CELLS), j = (int)((p.y / f.radius.y + 1) / 2 * CELLS);
        i = i < 0 ? 0 : i >= CELLS ? CELLS - 1 : i;
        j = j < 0 ? 0 : j >= CELLS ? CELLS - 1 : j;
        drawn[j][i] += (double)weight;
        total += (double)weight;
    }
    mean = total / N;
    EXPECT_NEAR(mean, 1,
                3e-4); // the error of a net of N points where sinc changes its sign: its exact mean is 1 within 4e-6
    for (int j = 0; j < CELLS; ++j)
        for (int i = 0; i < CELLS; ++i)
            EXPECT_NEAR(drawn[j][i] / N, expected[j][i] / all, 3e-4);
    sr_arena_free(&arena);
}

TEST(positions_follow_each_filter)
{
    for (int i = 0; sr_filter_models[i]; ++i) {
        struct five self;
        defaults(sr_filter_models[i], &self);
        check(sr_filter_models[i], &self);
    }
}

TEST(positions_follow_filters_wider_than_high)
{
    for (int i = 0; sr_filter_models[i]; ++i) {
        struct five self;
        defaults(sr_filter_models[i], &self);
        self.value[0] *= 1.7f;
        self.value[1] *= 0.6f;
        check(sr_filter_models[i], &self);
    }
}

TEST(order_is_kept)
{
    struct five self;
    const struct sr_filter_model *model = sr_filter_model_find("gaussian");
    defaults(model, &self);
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_filter f;
    EXPECT_EQUAL_INT(sr_filter_prepare(&arena, model, &self, &f, &error), SR_OK);
    float before = -INFINITY;
    for (int i = 0; i < 10000; ++i) {
        float weight;
        sr_vec2 p = sr_filter_sample(&f, (sr_vec2){(float)i / 10000, 0.5f}, &weight);
        EXPECT(p.x >= before);
        before = p.x;
    }
    sr_arena_free(&arena);
}
