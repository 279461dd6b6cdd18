/* SPDX-License-Identifier: MIT */
/* What every medium owes a path: segments in order and without gaps where it is not empty, majorants that hold, and a
 * transmittance that is that of its sigma_t. Checked over random media, boxes, transforms and rays. */
#include "scenery.h"

#define BOX_LO (-0.7f)
#define BOX_HI 1.9f

static float random_float(struct sr_rng *rng, float lo, float hi)
{
    return lo + (hi - lo) * sr_rng_float(rng);
}

static sr_vec3 random_direction(struct sr_rng *rng)
{
    sr_vec2 u = {sr_rng_float(rng), sr_rng_float(rng)};
    return sr_equal_area_square_to_sphere(u);
}

static float *random_values(struct sr_rng *rng, size_t n, float share_empty, float largest)
{
    float *v = sr_arena_alloc(scenery_arena(), n * sizeof *v);
    for (size_t i = 0; i < n; ++i)
        v[i] = sr_rng_float(rng) < share_empty ? 0 : largest * sr_rng_float(rng);
    return v;
}

static struct sr_transform random_transform(struct sr_rng *rng)
{
    struct sr_transform move =
        sr_transform_translate((sr_vec3){random_float(rng, -3, 3), random_float(rng, -3, 3), random_float(rng, -3, 3)});
    struct sr_transform turn = sr_transform_rotate(random_float(rng, 0, 360), random_direction(rng));
    struct sr_transform scale = sr_transform_scale(
        (sr_vec3){random_float(rng, 0.3f, 2), -random_float(rng, 0.3f, 2), random_float(rng, 0.3f, 2)});
    struct sr_transform a = sr_transform_multiply(&move, &turn);
    return sr_transform_multiply(&a, &scale);
}

enum kind { UNIFORM, RGB, CLOUD, KINDS };

static struct sr_medium random_medium(enum kind kind, struct sr_rng *rng, struct sr_transform *t)
{
    static const char *const names[] = {"uniformgrid", "rgbgrid", "cloud"};
    static const int sizes[] = {1, 2, 3, 5, 17, 40};
    const struct sr_medium_model *model = sr_medium_model_find(names[kind]);
    void *self = scenery_medium(model);
    *t = sr_rng_float(rng) < 0.3f ? sr_transform_identity() : random_transform(rng);
    ((struct sr_medium_common *)self)->medium_to_world = *t;
    *(sr_vec3 *)scenery_member(model, self, "p0") = (sr_vec3){BOX_LO, BOX_HI, BOX_LO};
    *(sr_vec3 *)scenery_member(model, self, "p1") = (sr_vec3){BOX_HI, BOX_LO, BOX_HI};
    if (kind != CLOUD) {
        int32_t n[3];
        for (int k = 0; k < 3; ++k)
            n[k] = sizes[sr_rng_u32(rng) % 6];
        *(int32_t *)scenery_member(model, self, "nx") = n[0];
        *(int32_t *)scenery_member(model, self, "ny") = n[1];
        *(int32_t *)scenery_member(model, self, "nz") = n[2];
        uint32_t count = (uint32_t)(n[0] * n[1] * n[2]);
        if (kind == UNIFORM)
            *(struct sr_slice *)scenery_member(model, self, "density") =
                (struct sr_slice){random_values(rng, count, 0.6f, 2), count};
        else {
            *(struct sr_slice *)scenery_member(model, self, "sigma_a") =
                (struct sr_slice){random_values(rng, 3 * count, 0.6f, 1), count};
            if (sr_rng_float(rng) < 0.7f)
                *(struct sr_slice *)scenery_member(model, self, "sigma_s") =
                    (struct sr_slice){random_values(rng, 3 * count, 0.6f, 1), count};
        }
    }
    if (kind != RGB)
        *(struct sr_spd *)scenery_member(model, self, "sigma_s") =
            sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){0.2f, 0.5f, 1.5f});
    return scenery_prepare(model, self);
}

struct line {
    sr_vec3 o, d;
    float t_max;
    double in, out;           // where it is in the box; in > out: nowhere
    double from[3], speed[3]; // in the medium's space
};

static struct line random_line(struct sr_rng *rng, const struct sr_transform *t)
{
    sr_vec3 o = {random_float(rng, -2, 3), random_float(rng, -2, 3), random_float(rng, -2, 3)},
            d = random_direction(rng);
    uint32_t fate = sr_rng_u32(rng) % 8;
    float *c = &o.x;
    if (fate == 0) // starts within
        o = (sr_vec3){random_float(rng, BOX_LO, BOX_HI), random_float(rng, BOX_LO, BOX_HI),
                      random_float(rng, BOX_LO, BOX_HI)};
    if (fate == 1 || fate == 2) { // parallel to an axis
        uint32_t axis = sr_rng_u32(rng) % 3;
        d = (sr_vec3){axis == 0, axis == 1, axis == 2};
        if (fate == 2)
            d = sr_neg(d);
    }
    if (fate == 3) { // parallel to a plane, and in a face or on the middle, which is the side of a cell
        uint32_t axis = sr_rng_u32(rng) % 3;
        (&d.x)[axis] = 0;
        c[axis] = sr_rng_u32(rng) % 2 ? BOX_HI : 0.6f;
    }
    if (fate == 4) // from afar
        o = sr_mad(o, -1000, d);
    if (fate == 5) // through a corner
        o = sr_mad((sr_vec3){BOX_LO, BOX_HI, BOX_LO}, -2, d);
    struct line line = {.o = sr_transform_point(t, o),
                        .d = sr_transform_vector(t, d),
                        .t_max = fate == 6 ? random_float(rng, 0, 1) : 1e6f};
    line.d = sr_normalize(line.d);
    o = sr_inverse_point(t, line.o);
    d = sr_inverse_vector(t, line.d);
    line.in = 0;
    line.out = (double)line.t_max;
    for (int k = 0; k < 3; ++k) {
        double from = line.from[k] = (double)sr_component(o, k), speed = line.speed[k] = (double)sr_component(d, k);
        double a = ((double)BOX_LO - from) / speed, b = ((double)BOX_HI - from) / speed;
        if (speed == 0)
            a = from >= (double)BOX_LO && from <= (double)BOX_HI ? -INFINITY : INFINITY, b = -a;
        line.in = fmax(line.in, fmin(a, b));
        line.out = fmin(line.out, fmax(a, b));
    }
    return line;
}

static float sigma_t_at(struct sr_medium m, const struct line *line, double t, const struct sr_wavelengths *w, int lane)
{
    struct sr_medium_at at;
    sr_vec3 p = {(float)((double)line->o.x + t * (double)line->d.x), (float)((double)line->o.y + t * (double)line->d.y),
                 (float)((double)line->o.z + t * (double)line->d.z)};
    m.model->at(m.self, p, w, &at);
    return at.sigma_a[lane] + at.sigma_s[lane];
}

/* How far within the box the point is; below 0: outside. */
static double depth_within(const struct line *line, double t)
{
    double depth = INFINITY;
    for (int k = 0; k < 3; ++k) {
        double x = line->from[k] + t * line->speed[k];
        depth = fmin(depth, fmin(x - (double)BOX_LO, (double)BOX_HI - x));
    }
    return depth;
}

/* The segments come in order and lie within the box; between them, before and after them the medium is empty; in them
 * sigma_t is below the majorant. Rays that graze a face are in or out by rounding. */
static void check_line(struct sr_medium m, const struct line *line, struct sr_rng *rng)
{
    struct sr_wavelengths w = scenery_wavelengths();
    struct sr_medium_walk walk;
    struct sr_medium_segment s;
    double before = fmax(0, line->in), off = 2e-6 * (fabs(line->in) + 10);
    m.model->begin(m.self, line->o, line->d, line->t_max, &w, &walk);
    for (bool more = true, is_first = true; more; is_first = false) {
        more = m.model->next(m.self, &walk, &s);
        double until = more ? (double)s.t0 : line->out;
        for (int i = 0; i < 2 && until - before > 4 * off; ++i) { // a gap
            double t = before + off + (until - before - 2 * off) * (double)sr_rng_float(rng);
            for (int lane = 0; lane < SR_LAMBDA_COUNT && depth_within(line, t) > off; lane += 3)
                if (sigma_t_at(m, line, t, &w, lane) > 1e-4f)
                    test_fail(__FILE__, __LINE__, "%s: sigma_t = %g at t = %.9g, between segments (%.9g to %.9g)",
                              m.model->name, (double)sigma_t_at(m, line, t, &w, lane), t, before, until);
        }
        if (!more)
            break;
        EXPECT(s.t1 > s.t0 && s.t0 >= 0 && s.t1 <= line->t_max);
        EXPECT(is_first || (double)s.t0 >= before);
        EXPECT(depth_within(line, (double)s.t0) > -off && depth_within(line, (double)s.t1) > -off);
        for (int i = 0; i < 4; ++i) {
            double t = (double)s.t0 + (double)(s.t1 - s.t0) * (double)sr_rng_float(rng);
            for (int lane = 0; lane < SR_LAMBDA_COUNT; lane += 3) {
                float sigma_t = sigma_t_at(m, line, t, &w, lane);
                if (!(sigma_t <= s.majorant[lane]) || !(sigma_t >= 0))
                    test_fail(__FILE__, __LINE__,
                              "%s: sigma_t = %.9g is not below its majorant %.9g at t = %.9g in %.9g to %.9g",
                              m.model->name, (double)sigma_t, (double)s.majorant[lane], t, (double)s.t0, (double)s.t1);
            }
        }
        before = (double)s.t1;
    }
}

TEST(majorants_hold_and_segments_leave_nothing_out)
{
    struct sr_rng rng = sr_rng_seed(11, 3);
    for (int k = 0; k < KINDS; ++k)
        for (int i = 0; i < 40; ++i) {
            struct sr_transform t;
            struct sr_medium m = random_medium(k, &rng, &t);
            for (int j = 0; j < 200; ++j) {
                struct line line = random_line(&rng, &t);
                check_line(m, &line, &rng);
            }
        }
}

/* Where no cell is empty, the segments leave no gap at all. */
TEST(segments_cover_a_full_box_without_gaps)
{
    struct sr_rng rng = sr_rng_seed(4, 4);
    const struct sr_medium_model *model = sr_medium_model_find("uniformgrid");
    for (int i = 0; i < 20; ++i) {
        struct sr_transform t = random_transform(&rng);
        void *self = scenery_medium(model);
        float *one = random_values(&rng, 40 * 30 * 20, 0, 1);
        for (int k = 0; k < 40 * 30 * 20; ++k)
            one[k] += 0.5f;
        *(struct sr_slice *)scenery_member(model, self, "density") = (struct sr_slice){one, 40 * 30 * 20};
        *(int32_t *)scenery_member(model, self, "nx") = 40;
        *(int32_t *)scenery_member(model, self, "ny") = 30;
        *(int32_t *)scenery_member(model, self, "nz") = 20;
        *(sr_vec3 *)scenery_member(model, self, "p0") = (sr_vec3){BOX_LO, BOX_LO, BOX_LO};
        *(sr_vec3 *)scenery_member(model, self, "p1") = (sr_vec3){BOX_HI, BOX_HI, BOX_HI};
        ((struct sr_medium_common *)self)->medium_to_world = t;
        scenery_prepare(model, self);
        struct sr_wavelengths w = scenery_wavelengths();
        for (int j = 0; j < 200; ++j) {
            struct line line = random_line(&rng, &t);
            struct sr_medium_walk walk;
            struct sr_medium_segment s;
            float before = -1, first = -1;
            model->begin(self, line.o, line.d, line.t_max, &w, &walk);
            while (model->next(self, &walk, &s)) {
                EXPECT(before < 0 || s.t0 == before);
                first = before < 0 ? s.t0 : first;
                before = s.t1;
            }
            if (line.out - line.in > 0.01 && depth_within(&line, (line.in + line.out) / 2) > 0.01) {
                double off = 1e-6 * (fabs(line.out) + 10);
                EXPECT_NEAR(first, line.in, 100 * off);
                EXPECT_NEAR(before, line.out, 100 * off);
            }
        }
    }
}

/* T = exp(-integral of sigma_t), by Simpson's rule of many pieces, against ratio tracking through the segments */
TEST(transmittance_by_the_walk_is_that_of_sigma_t)
{
    struct sr_rng rng = sr_rng_seed(5, 8);
    struct sr_wavelengths w = scenery_wavelengths();
    for (int k = 0; k < KINDS; ++k)
        for (int i = 0; i < 6; ++i) {
            struct sr_transform transform;
            struct sr_medium m = random_medium(k, &rng, &transform);
            struct line line;
            do
                line = random_line(&rng, &transform);
            while (line.out - line.in < 0.2 ||
                   depth_within(&line, (line.in + line.out) / 2) < 0.01); // in a face rounding decides
            enum { PIECES = 4000 };
            double depth = 0, step = (line.out - line.in) / PIECES;
            for (int j = 0; j <= PIECES; ++j)
                depth += (j == 0 || j == PIECES ? 1
                          : j % 2               ? 4
                                                : 2) *
                         step / 3 * (double)sigma_t_at(m, &line, line.in + j * step, &w, 0);
            struct sr_tally T = {0};
            for (int j = 0; j < 4000; ++j) {
                struct sr_medium_walk walk;
                struct sr_medium_segment s;
                double ratio = 1;
                m.model->begin(m.self, line.o, line.d, line.t_max, &w, &walk);
                while (m.model->next(m.self, &walk, &s))
                    for (double t = (double)s.t0;;) {
                        t -= log1p(-(double)sr_rng_float(&rng)) / (double)s.majorant[0];
                        if (!(t < (double)s.t1))
                            break;
                        ratio *= 1 - (double)(sigma_t_at(m, &line, t, &w, 0) / s.majorant[0]);
                    }
                sr_tally_add(&T, ratio);
            }
            EXPECT_MEAN(T, exp(-depth));
        }
}
