/* SPDX-License-Identifier: MIT */
/* Standard errors of rectangles of pixels, against the pools of neighbours written out. */
#include "test.h"

#include "film/film.h"

enum { WIDTH = 150, HEIGHT = 9 };

/* Pixels of all kinds: ordinary ones, some with too few blocks to tell, some that are not finite in a channel. */
static struct sr_film *random_film(void)
{
    struct sr_film_settings settings = {.width = WIDTH, .height = HEIGHT, .x1 = WIDTH, .y1 = HEIGHT};
    struct sr_film *film;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_film_create(&settings, false, &film, &error), SR_OK);
    struct sr_rng rng = sr_rng_seed(5, 7);
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        struct sr_film_pixel *p = &film->pixels[i];
        float u = sr_rng_float(&rng);
        p->blocks = u < 0.1f ? 0 : u < 0.2f ? 1 : 4;
        p->n = 4 * p->blocks;
        for (int c = 0; c < 3; ++c) {
            p->sum[c] = p->n * (double)sr_rng_float(&rng);
            p->square[c] = p->n ? p->sum[c] * p->sum[c] / p->n * (0.9 + (double)sr_rng_float(&rng)) : 0;
        }
        if (u > 0.95f)
            p->square[1] = INFINITY;
    }
    return film;
}

static double variance_of(const struct sr_film *film, int64_t x, int64_t y, int c)
{
    const struct sr_film_pixel *p = &film->pixels[y * WIDTH + x];
    return p->blocks < 2 ? NAN
                         : fmax(0, p->square[c] - p->sum[c] * p->sum[c] / p->n) / ((double)(p->blocks - 1) * p->n);
}

static double error_of(const struct sr_film *film, int64_t x, int64_t y, int c, int reach)
{
    double sum = 0, count = 0, own = variance_of(film, x, y, c);
    for (int64_t j = y - reach; j <= y + reach; ++j)
        for (int64_t i = x - reach; i <= x + reach; ++i) {
            double v = i < 0 || j < 0 || i >= WIDTH || j >= HEIGHT ? NAN : variance_of(film, i, j, c);
            sum += isfinite(v) ? v : 0;
            count += isfinite(v);
        }
    return count > 0 ? sqrt(fmax(sum / count, isfinite(own) ? own : 0)) : NAN;
}

static bool is_same(double a, double b)
{
    return isnan(a) ? isnan(b) : fabs(a - b) <= 1e-12 * fabs(b); // a compiler may fuse what it multiplies and adds
}

static void expect_errors(const struct sr_film *film, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, bool pooled)
{
    static double told[HEIGHT * WIDTH][3];
    sr_film_errors(film, x0, y0, x1, y1, pooled, told[0]);
    for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = x0; x < x1; ++x)
            for (int c = 0; c < 3; ++c)
                EXPECT(is_same(told[(y - y0) * (x1 - x0) + x - x0][c], error_of(film, x, y, c, pooled ? 2 : 0)));
}

TEST(errors_of_rectangles_are_those_of_their_pixels)
{
    struct sr_film *film = random_film();
    for (int pooled = 0; pooled < 2; ++pooled) {
        expect_errors(film, 0, 0, WIDTH, HEIGHT, pooled);
        expect_errors(film, 60, 3, 131, 8, pooled);
        for (uint32_t x = 0; x < WIDTH; ++x)
            expect_errors(film, x, x % HEIGHT, x + 1, x % HEIGHT + 1, pooled);
    }
    sr_film_destroy(film);
}
