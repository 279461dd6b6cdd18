/* SPDX-License-Identifier: MIT */
/* What is learned of directions: drawn as its density says, the same in any order, other in other places. */
#include "test.h"

#include "integrator/mixture.h"
#include "sample/sample.h"

enum { GRID = 16, ROUNDS = 5 };

/* Light from a disk about +x toward places with x < 0, from all sides toward the others. */
static void learn_round(struct sr_guide *g, uint32_t round, uint32_t n, bool is_reversed)
{
    for (uint32_t i = 0; i < n; ++i) {
        uint32_t k = is_reversed ? n - 1 - i : i;
        struct sr_rng rng = sr_rng_seed(k, round);
        sr_vec3 p = {2 * sr_rng_float(&rng) - 1, sr_rng_float(&rng), sr_rng_float(&rng)}, up = {0, 1, 0};
        struct sr_guide_record r = {.pdf = SR_INV_PI / 4, .pdf_bsdf = SR_INV_PI / 4, .is_direction = true};
        r.w = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        r.light = p.x >= 0 || r.w.x > 0.9f ? 1 : 0;
        r.noise = r.light;
        r.place = sr_guide_place(g, p, up);
        r.cell = sr_guide_find(g, &r.place);
        const struct sr_guide_cell *cell = sr_guide_cell(g, r.cell);
        r.pdf_guide = cell->has_light ? sr_guide_pdf(g, cell, r.w) : 0;
        sr_guide_add(g, &r);
    }
}

static struct sr_guide *learned(bool is_reversed)
{
    struct sr_box bounds = {{-1, 0, 0}, {1, 1, 1}};
    struct sr_guide *g = sr_guide_create(&bounds, 1, 1);
    EXPECT(g != NULL);
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        learn_round(g, round, 4000u << round, is_reversed);
        EXPECT(sr_guide_refine(g));
    }
    return g;
}

static const struct sr_guide_cell *cell_at(const struct sr_guide *g, float x)
{
    sr_vec3 p = {x, 0.5f, 0.5f}, up = {0, 1, 0};
    struct sr_guide_place place = sr_guide_place(g, p, up);
    return sr_guide_cell(g, sr_guide_find(g, &place));
}

TEST(guided_directions_are_drawn_as_their_density_says)
{
    struct sr_guide *g = learned(false);
    for (int side = 0; side < 2; ++side) {
        const struct sr_guide_cell *cell = cell_at(g, side ? 0.5f : -0.5f);
        double observed[GRID * GRID] = {0}, expected[GRID * GRID] = {0}, integral = 0;
        uint32_t n = is_slow_build() ? 20000 : 200000;
        for (uint32_t i = 0; i < n; ++i) {
            struct sr_rng rng = sr_rng_seed(i, 77);
            sr_vec3 w;
            float pdf = sr_guide_sample(g, cell, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w);
            EXPECT_NEAR(sr_length(w), 1, 1e-5);
            if (i % 16 == 0 && fabsf(pdf / sr_guide_pdf(g, cell, w) - 1) > 1e-3f) { // within rounding of a border
                sr_vec2 q = sr_equal_area_sphere_to_square(w);
                float off = fmodf(q.x * 4096, 1), off_y = fmodf(q.y * 4096, 1);
                EXPECT(sr_min(sr_min(off, 1 - off), sr_min(off_y, 1 - off_y)) < 0.02f);
            }
            sr_vec2 q = sr_equal_area_sphere_to_square(w);
            observed[(int)(q.x * GRID) % GRID + GRID * ((int)(q.y * GRID) % GRID)] += 1;
        }
        enum { FINE = 256 };
        for (int y = 0; y < FINE; ++y)
            for (int x = 0; x < FINE; ++x) {
                sr_vec3 w =
                    sr_equal_area_square_to_sphere((sr_vec2){((float)x + 0.5f) / FINE, ((float)y + 0.5f) / FINE});
                double share = (double)sr_guide_pdf(g, cell, w) * 4 * (double)SR_PI / (FINE * FINE);
                integral += share;
                expected[x * GRID / FINE + GRID * (y * GRID / FINE)] += share * n;
            }
        EXPECT_NEAR(integral, 1, 1e-4);
        EXPECT_CHI2(observed, expected, GRID * GRID);
    }
    sr_guide_destroy(g);
}

/* Directions that lie about +x and a surface's own, which are only those above it: drawn as sr_mixture_pdf says, of
 * which the integral is 1, and weighed so that f cos is integrated. */
static void expect_drawn_as_mixed(const struct sr_guide *g, const struct sr_bsdf *bsdf, float share, double most_lost)
{
    enum { FINE = 256 };
    struct sr_frame frame = sr_frame_from_z(sr_normalize((sr_vec3){0.5f, 1, 0.2f}));
    struct sr_mixture m = {.guide = g,
                           .cell = cell_at(g, -0.5f),
                           .share = share,
                           .bsdf = bsdf,
                           .frame = &frame,
                           .wo = sr_normalize((sr_vec3){0.3f, -0.4f, 1})};
    double observed[GRID * GRID] = {0}, expected[GRID * GRID] = {0}, integral = 0, reflected = 0;
    uint32_t n = is_slow_build() ? 20000 : 200000;
    for (int i = 0; i < FINE * FINE; ++i) {
        int x = i % FINE, y = i / FINE;
        sr_vec3 w = sr_equal_area_square_to_sphere((sr_vec2){((float)x + 0.5f) / FINE, ((float)y + 0.5f) / FINE}),
                wi = sr_to_local(&frame, w);
        float pdf_bsdf;
        double f = (double)sr_bsdf_f_pdf(bsdf, m.wo, wi, SR_RADIANCE, &pdf_bsdf)[0],
               area = 4 * (double)SR_PI / (FINE * FINE), p = (double)sr_mixture_pdf(&m, w, pdf_bsdf) * area;
        integral += p;
        reflected += f * (double)sr_abs_cos_theta(wi) * area;
        expected[x * GRID / FINE + GRID * (y * GRID / FINE)] += p * n;
    }
    struct sr_tally gained = {0};
    double drawn = 0;
    for (uint32_t i = 0; i < n; ++i) {
        struct sr_rng rng = sr_rng_seed(i, 78);
        sr_u4 u = {sr_rng_float(&rng), sr_rng_float(&rng), sr_rng_float(&rng), 0};
        struct sr_bsdf_sample s;
        sr_spectrum gain = SR_BLACK;
        struct sr_guide_record r = {0};
        if (sr_mixture_sample(&m, u, false, &s, &gain, &r)) {
            sr_vec2 q = sr_equal_area_sphere_to_square(r.w);
            observed[(int)(q.x * GRID) % GRID + GRID * ((int)(q.y * GRID) % GRID)] += 1;
            drawn += 1;
        }
        sr_tally_add(&gained, (double)gain[0]);
    }
    printf("  share %.3g: integral of the density %.5f, drawn %.5f; reflected %.5f, by the draws %.5f +- %.2g\n",
           (double)share, integral, drawn / n, reflected, gained.mean, sr_tally_standard_error(&gained));
    EXPECT(integral < 1 + 2e-4 && integral > 1 - most_lost - 2e-4);
    EXPECT_NEAR(drawn / n, integral, 5 * sqrt(most_lost / n) + 2e-4);
    EXPECT_CHI2(observed, expected, GRID * GRID);
    EXPECT_MEAN(gained, reflected);
    EXPECT(sr_tally_standard_error(&gained) < (is_slow_build() ? 0.02 : 0.006) * reflected);
}

TEST(guided_and_own_directions_are_drawn_as_their_mixture_says)
{
    struct sr_guide *g = learned(false);
    struct sr_bsdf lambert = {.model = &sr_bsdf_diffuse}, metal = {.model = sr_bsdf_model_find("conductor")};
    *(struct sr_bsdf_diffuse *)lambert.data = (struct sr_bsdf_diffuse){SR_BLACK + 0.7f};
    *(struct sr_bsdf_conductor *)metal.data =
        (struct sr_bsdf_conductor){SR_BLACK + 0.2f, SR_BLACK + 3.0f, {0.5f, 0.5f}};
    for (int k = 1; k < SR_GUIDE_SHARES; k += 3) {
        expect_drawn_as_mixed(g, &lambert, sr_guide_shares[k], 0);
        expect_drawn_as_mixed(g, &metal, sr_guide_shares[k],
                              0.2); // some of a facet's reflections would go below the surface
    }
    sr_guide_destroy(g);
}

/* The estimate's square that each share would have had, from a direction that was drawn otherwise. */
TEST(records_tell_what_other_shares_would_have_been_worth)
{
    struct sr_guide *g = learned(false);
    sr_vec3 p = {-0.5f, 0.5f, 0.5f}, up = {0, 1, 0};
    struct sr_guide_record r = {
        .pdf = 0.3f, .pdf_bsdf = 0.1f, .pdf_guide = 0.9f, .noise = 1, .place = sr_guide_place(g, p, up), .kind = 1};
    r.cell = sr_guide_find(g, &r.place);
    const struct sr_guide_cell *cell = sr_guide_cell(g, r.cell);
    EXPECT(cell->has_light && cell->moments[1][0] == 0);
    sr_guide_add(g, &r);
    for (int k = 0; k < SR_GUIDE_SHARES; ++k) {
        double a = (double)sr_guide_shares[k], pdf = (1 - a) * 0.1 + a * 0.9;
        EXPECT_RELATIVE((double)cell->moments[1][k] / (double)cell->moments[1][0], 0.1 / pdf, 1e-6);
    }
    sr_guide_destroy(g);
}

TEST(guides_know_where_light_comes_from_and_where_it_pays_to_know)
{
    struct sr_guide *g = learned(false);
    sr_vec3 there = {1, 0, 0}, elsewhere = {-1, 0, 0};
    const struct sr_guide_cell *dark = cell_at(g, -0.5f), *even = cell_at(g, 0.5f);
    EXPECT(sr_guide_cell_count(g) > 8);
    printf("  toward the light %.3g, elsewhere %.3g\n", (double)sr_guide_pdf(g, dark, there),
           (double)sr_guide_pdf(g, dark, elsewhere));
    EXPECT(sr_guide_pdf(g, dark, there) > 4 * SR_INV_PI / 4);
    EXPECT(sr_guide_pdf(g, dark, elsewhere) <
           0.5f * SR_INV_PI / 4); // what earlier rounds have seen from larger cells fades
    EXPECT_RELATIVE(sr_guide_pdf(g, even, elsewhere), SR_INV_PI / 4, 0.3);
    EXPECT(dark->share[0] == sr_guide_shares[SR_GUIDE_SHARES - 1]);
    EXPECT(even->share[0] == 0); // all directions are as good: the guide is not worth its price
    sr_guide_destroy(g);
}

TEST(guides_do_not_depend_on_the_order_of_records)
{
    struct sr_guide *a = learned(false), *b = learned(true);
    EXPECT_EQUAL_INT(sr_guide_cell_count(a), sr_guide_cell_count(b));
    for (uint32_t i = 0; i < 2000; ++i) {
        struct sr_rng rng = sr_rng_seed(i, 5);
        sr_vec3 w = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        float x = 2 * sr_rng_float(&rng) - 1;
        const struct sr_guide_cell *ca = cell_at(a, x), *cb = cell_at(b, x);
        EXPECT(sr_guide_pdf(a, ca, w) == sr_guide_pdf(b, cb, w));
        EXPECT(ca->share[0] == cb->share[0]);
    }
    sr_guide_destroy(a);
    sr_guide_destroy(b);
}

/* Lambert's surfaces with x < 0 bring 0 or 8, by half each, for 2; those with x > 0 always 1 for 4; others are never
 * met. */
static struct sr_guide *returned(bool is_reversed)
{
    struct sr_box bounds = {{-1, 0, 0}, {1, 1, 1}};
    struct sr_guide *g = sr_guide_create(&bounds, 2.5, 16.5);
    EXPECT(g != NULL);
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        uint32_t n = 2000u << round;
        for (uint32_t i = 0; i < n; ++i) {
            struct sr_rng rng = sr_rng_seed(is_reversed ? n - 1 - i : i, round);
            sr_vec3 p = {2 * sr_rng_float(&rng) - 1, sr_rng_float(&rng), sr_rng_float(&rng)}, up = {0, 1, 0};
            struct sr_guide_place place = sr_guide_place(g, p, up);
            double brought = p.x > 0 ? 1 : sr_rng_float(&rng) < 0.5f ? 8 : 0;
            sr_guide_add_return(g, sr_guide_find(g, &place), &place, 0, brought, p.x > 0 ? 4 : 2);
        }
        EXPECT(sr_guide_refine(g));
    }
    return g;
}

TEST(guides_know_what_going_on_brings_and_costs)
{
    struct sr_guide *g = returned(false), *other = returned(true);
    const struct sr_guide_cell *left = cell_at(g, -0.5f), *right = cell_at(g, 0.5f);
    EXPECT(sr_guide_cell_count(g) > 8);
    EXPECT_RELATIVE(left->mean[0], 4, 0.1);
    EXPECT_RELATIVE(left->worth[0], sqrt(32.0 / 2), 0.1);
    EXPECT_RELATIVE(right->mean[0], 1, 0.15);
    EXPECT_RELATIVE(right->worth[0], sqrt(1.0 / 4), 0.3); // where few have been, the mean of all has a say
    EXPECT(isinf(left->worth[1]) && left->mean[1] == 0);
    for (float x = -0.99f; x < 1; x += 0.05f) {
        EXPECT(cell_at(g, x)->mean[0] == cell_at(other, x)->mean[0]);
        EXPECT(cell_at(g, x)->worth[0] == cell_at(other, x)->worth[0]);
    }
    sr_guide_destroy(g);
    sr_guide_destroy(other);
}
