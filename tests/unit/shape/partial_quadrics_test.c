/* SPDX-License-Identifier: MIT */
/* All combinations of the cuts of spheres, cylinders and disks, under four transforms, against cubature over their own
 * coordinates and against the quadratic solved plainly in double. */
#include "common.h"

#include <string.h>

enum kind { SPHERE, CYLINDER, DISK };

struct part {
    enum kind kind;
    double radius, lo, hi; // [m] heights; of the disk the radii
    double phi_max;        // [deg]
};

static struct sr_transform transform_of(int k)
{
    struct sr_transform turn = sr_transform_rotate(50, (sr_vec3){1, 2, 3});
    return k == 0   ? sr_transform_identity()
           : k == 1 ? then(sr_transform_translate((sr_vec3){1, -2, 0.5f}), turn)
           : k == 2 ? then(turn, sr_transform_scale((sr_vec3){1, 2, 0.5f}))
                    : then(sr_transform_translate((sr_vec3){0, 1, 0}), sr_transform_scale((sr_vec3){-1.5f, 1, 1}));
}

static struct sr_shape make(struct part p, struct sr_transform t, bool swapped)
{
    float lo = (float)(swapped ? p.hi : p.lo), hi = (float)(swapped ? p.lo : p.hi), r = (float)p.radius,
          phi = (float)p.phi_max;
    return p.kind == SPHERE     ? make_partial_sphere(r, lo, hi, phi, placed(t))
           : p.kind == CYLINDER ? make_cylinder(r, lo, hi, phi, placed(t))
                                : make_disk(0.3f, (float)p.hi, (float)p.lo, phi, placed(t));
}

static int make_parts(struct part *parts)
{
    static const double phi[4] = {360, 270, 100, 1},
                        z[7][2] = {{-1, 1}, {-1, 0.3}, {-0.5, 1}, {-0.6, 0.4}, {0.2, 0.21}, {0.9, 1}, {-1, -0.7}};
    static const double radii[3][2] = {{0, 1}, {0.4, 1}, {0.98, 1}};
    int n = 0;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 7; ++k) {
            parts[n++] = (struct part){SPHERE, 1, z[k][0], z[k][1], phi[i]};
            parts[n++] = (struct part){CYLINDER, 0.7, z[k][0], z[k][1], phi[i]};
        }
        for (int k = 0; k < 3; ++k)
            parts[n++] = (struct part){DISK, 1, radii[k][0], radii[k][1], phi[i]};
    }
    return n;
}
enum { MOST_PARTS = 80 };

/* The point at shares a, b of the surface, and its derivatives, in object space. */
static void coordinates(struct part p, double a, double b, double x[3], double da[3], double db[3])
{
    double phi_max = p.phi_max * (double)SR_PI / 180, phi = b * phi_max, c = cos(phi), s = sin(phi),
           h = p.lo + a * (p.hi - p.lo), r, dr, z, dz;
    if (p.kind == DISK) {
        r = h, dr = p.hi - p.lo, z = (double)0.3f, dz = 0;
    } else if (p.kind == CYLINDER) {
        r = p.radius, dr = 0, z = h, dz = p.hi - p.lo;
    } else { // by the angle from the axis, which is smooth at the poles
        double t0 = acos(p.lo / p.radius), t1 = acos(p.hi / p.radius), t = t0 + a * (t1 - t0);
        r = p.radius * sin(t), dr = p.radius * cos(t) * (t1 - t0), z = p.radius * cos(t),
        dz = -p.radius * sin(t) * (t1 - t0);
    }
    x[0] = r * c, x[1] = r * s, x[2] = z;
    da[0] = dr * c, da[1] = dr * s, da[2] = dz;
    db[0] = -r * s * phi_max, db[1] = r * c * phi_max, db[2] = 0;
}

static void apply(const struct sr_transform *t, const double v[3], double w, double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] =
            (double)t->m[i][0] * v[0] + (double)t->m[i][1] * v[1] + (double)t->m[i][2] * v[2] + w * (double)t->m[i][3];
}

/* Area, and the irradiance of a receiver that nothing hides, both sides having radiance 1. */
static double cubature(struct part p, const struct sr_transform *t, const struct sr_point *x, double *area)
{
    enum { nodes = 160 };
    double E = 0;
    *area = 0;
    for (int i = 0; i < nodes; ++i)
        for (int j = 0; j < nodes; ++j) {
            double o[3], da[3], db[3], q[3], u[3], v[3];
            coordinates(p, (i + 0.5) / nodes, (j + 0.5) / nodes, o, da, db);
            apply(t, o, 1, q), apply(t, da, 0, u), apply(t, db, 0, v);
            double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                           u[0] * v[1] - u[1] * v[0]}; // length: the area's share
            double d[3] = {q[0] - (double)x->p.x, q[1] - (double)x->p.y, q[2] - (double)x->p.z},
                   d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            double facing = d[0] * (double)x->n.x + d[1] * (double)x->n.y + d[2] * (double)x->n.z;
            *area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / ((double)nodes * nodes);
            E += fmax(0, facing) * fabs(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]) / (d2 * d2) / ((double)nodes * nodes);
        }
    return E;
}

static bool is_whole_sphere(struct part p)
{
    return p.kind == SPHERE && p.lo == -1 && p.hi == 1 && p.phi_max == 360;
}

TEST(partial_quadrics_have_the_area_and_send_the_irradiance_of_their_parts)
{
    struct part parts[MOST_PARTS];
    int n = make_parts(parts);
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < 4; ++k) {
            struct sr_transform t = transform_of(k);
            struct sr_shape s = make(parts[i], t, i % 2);
            struct sr_point x = receiver((sr_vec3){2.5f, 0.4f, 3}, sr_normalize((sr_vec3){-1, 0, -1}));
            double area, E = cubature(parts[i], &t, &x, &area);
            EXPECT_RELATIVE(s.model->area(s.self, 0), area, 2e-4);
            struct sr_tally drawn = {0};
            struct sr_rng rng = sr_rng_seed(40, 1);
            for (int j = 0; j < 2000; ++j) {
                struct sr_shape_sample y;
                double term = 0;
                if (s.model->sample(s.self, 0, &x, (sr_vec2){uniform(&rng), uniform(&rng)}, &y)) {
                    EXPECT(sr_box_contains(s.model->bounds(s.self, 0), y.p));
                    term = fmax(0, (double)sr_dot(sr_normalize(sr_sub(y.p, x.p)), x.n)) / (double)y.pdf;
                }
                sr_tally_add(&drawn, term);
            }
            if (is_whole_sphere(parts[i]) && k != 2 && k != 3) // drawn within its cone: the near side alone
                continue;
            EXPECT_NEAR(drawn.mean, E, 4.9 * sr_tally_standard_error(&drawn) + 1e-4 * E);
            EXPECT(pdf_deviation(s, 0, &x, 50, 3) < 2e-3);
        }
}

/* Nearest meeting by the plain quadratic; false also where it is too close to an edge to tell. */
static bool expected_meeting(struct part p, const double o[3], const double d[3], double *t, bool *is_doubtful)
{
    double roots[2];
    *is_doubtful = false;
    if (p.kind == DISK) {
        roots[0] = roots[1] = ((double)0.3f - o[2]) / d[2];
    } else {
        double w = p.kind == SPHERE, a = d[0] * d[0] + d[1] * d[1] + w * d[2] * d[2],
               b = o[0] * d[0] + o[1] * d[1] + w * o[2] * d[2];
        double r = (double)(float)p.radius, c = o[0] * o[0] + o[1] * o[1] + w * o[2] * o[2] - r * r, q = b * b - a * c;
        *is_doubtful = fabs(q) < 1e-4 * a;
        if (q < 0)
            return false;
        roots[0] = (-b - sqrt(q)) / a, roots[1] = (-b + sqrt(q)) / a;
    }
    for (int i = 0; i < 2; ++i) {
        double x = o[0] + roots[i] * d[0], y = o[1] + roots[i] * d[1], z = o[2] + roots[i] * d[2],
               phi = atan2(y, x) * 180 / (double)SR_PI;
        phi += phi < 0 ? 360 : 0;
        double h = p.kind == DISK ? sqrt(x * x + y * y) : z;
        *is_doubtful |= fabs(h - p.lo) < 1e-4 || fabs(h - p.hi) < 1e-4 ||
                        (p.phi_max < 360 && (fabs(phi - p.phi_max) < 0.01 || phi < 0.01 || phi > 359.99));
        *is_doubtful |= fabs(roots[i]) < 1e-4;
        if (roots[i] > 0 && h >= p.lo && h <= p.hi && phi <= p.phi_max) {
            *t = roots[i];
            return true;
        }
    }
    return false;
}

TEST(partial_quadrics_are_met_where_the_plain_quadratic_says)
{
    struct part parts[MOST_PARTS];
    int n = make_parts(parts), met = 0, told = 0;
    struct sr_rng rng = sr_rng_seed(41, 1);
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < 4; ++k) {
            struct sr_transform t = transform_of(k);
            struct sr_shape s = make(parts[i], t, k % 2);
            for (int j = 0; j < 300; ++j) {
                sr_vec3 o = sr_scale(2 * uniform(&rng), random_direction(&rng)),
                        aim = sr_scale(uniform(&rng), random_direction(&rng)), d = sr_normalize(sr_sub(aim, o));
                double od[3] = {(double)o.x, (double)o.y, (double)o.z}, dd[3] = {(double)d.x, (double)d.y, (double)d.z},
                       expected = 0;
                bool is_doubtful, is_met = expected_meeting(parts[i], od, dd, &expected, &is_doubtful);
                if (is_doubtful)
                    continue;
                float at;
                sr_vec2 hit;
                bool is_found = s.model->intersect(s.self, 0, sr_transform_point(&t, o), sr_transform_vector(&t, d), 0,
                                                   INFINITY, &at, &hit);
                EXPECT_EQUAL_INT(is_found, is_met);
                ++told;
                if (!is_met)
                    continue;
                ++met;
                EXPECT_NEAR(at, expected, 2e-4);
                struct sr_point x;
                s.model->point(s.self, 0, hit, &x);
                sr_vec3 there = sr_transform_point(&t, sr_mad(o, at, d));
                EXPECT_NEAR(sr_length(sr_sub(x.p, there)), 0, 2e-3);
                EXPECT(x.uv.x >= 0 && x.uv.x <= 1 && x.uv.y >= 0 && x.uv.y <= 1);
            }
        }
    EXPECT(met > 10000 && told > 60000);
}

static void expect_refused(const struct sr_shape_model *m, void *self)
{
    struct sr_shape_placement placement = here();
    struct sr_error e = {0};
    EXPECT(m->prepare(self, &placement, &test_arena, &e) == SR_ERROR_INPUT);
    EXPECT(strstr(e.text, m->name));
}

TEST(quadrics_of_which_nothing_is_left_are_refused)
{
    const float odd[5] = {0, -1, NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 5; ++i) {
        expect_refused(&sr_shape_sphere,
                       &(struct sr_shape_sphere){.radius = odd[i], .z_min = NAN, .z_max = NAN, .phi_max = 360});
        expect_refused(&sr_shape_cylinder,
                       &(struct sr_shape_cylinder){.radius = odd[i], .z_min = -1, .z_max = 1, .phi_max = 360});
        expect_refused(&sr_shape_disk, &(struct sr_shape_disk){.radius = odd[i], .phi_max = 360});
        if (odd[i] != -1) { // phimax
            expect_refused(&sr_shape_sphere,
                           &(struct sr_shape_sphere){.radius = 1, .z_min = -1, .z_max = 1, .phi_max = odd[i]});
            expect_refused(&sr_shape_cylinder,
                           &(struct sr_shape_cylinder){.radius = 1, .z_min = -1, .z_max = 1, .phi_max = odd[i]});
            expect_refused(&sr_shape_disk, &(struct sr_shape_disk){.radius = 1, .phi_max = odd[i]});
        }
    }
    expect_refused(&sr_shape_sphere, &(struct sr_shape_sphere){.radius = 1, .z_min = 2, .z_max = 3, .phi_max = 360});
    expect_refused(&sr_shape_sphere,
                   &(struct sr_shape_sphere){.radius = 1, .z_min = 0.5f, .z_max = 0.5f, .phi_max = 360});
    expect_refused(&sr_shape_cylinder,
                   &(struct sr_shape_cylinder){.radius = 1, .z_min = 0.5f, .z_max = 0.5f, .phi_max = 360});
    expect_refused(&sr_shape_disk, &(struct sr_shape_disk){.radius = 1, .inner_radius = 1, .phi_max = 360});
    expect_refused(&sr_shape_disk, &(struct sr_shape_disk){.radius = 1, .inner_radius = -0.5f, .phi_max = 360});
}
