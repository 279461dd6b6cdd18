/* SPDX-License-Identifier: MIT */
#include "common.h"

struct sr_arena test_arena;

static void *keep(const void *data, size_t size)
{
    return sr_arena_copy(&test_arena, data, size);
}

struct sr_shape make_partial_sphere(float radius, float z_min, float z_max, float phi_max,
                                    struct sr_shape_placement placement)
{
    struct sr_shape_sphere s = {.radius = radius, .z_min = z_min, .z_max = z_max, .phi_max = phi_max};
    return PREPARE(sr_shape_sphere, keep(&s, sizeof(s)), placement);
}

struct sr_shape make_sphere(float radius, struct sr_shape_placement placement)
{
    return make_partial_sphere(radius, NAN, NAN, 360, placement);
}

struct sr_shape make_disk(float height, float radius, float inner_radius, float phi_max,
                          struct sr_shape_placement placement)
{
    struct sr_shape_disk d = {.height = height, .radius = radius, .inner_radius = inner_radius, .phi_max = phi_max};
    return PREPARE(sr_shape_disk, keep(&d, sizeof(d)), placement);
}

struct sr_shape make_cylinder(float radius, float z_min, float z_max, float phi_max,
                              struct sr_shape_placement placement)
{
    struct sr_shape_cylinder c = {.radius = radius, .z_min = z_min, .z_max = z_max, .phi_max = phi_max};
    return PREPARE(sr_shape_cylinder, keep(&c, sizeof(c)), placement);
}

struct sr_shape make_triangle(sr_vec3 a, sr_vec3 b, sr_vec3 c, struct sr_shape_placement placement)
{
    sr_vec3 P[3] = {a, b, c};
    struct sr_shape_mesh m = {.P = {keep(P, sizeof(P)), 3}};
    return PREPARE(sr_shape_trianglemesh, keep(&m, sizeof(m)), placement);
}

struct sr_shape make_patch(sr_vec3 p00, sr_vec3 p10, sr_vec3 p01, sr_vec3 p11, struct sr_shape_placement placement)
{
    sr_vec3 P[4] = {p00, p10, p01, p11};
    struct sr_shape_patches m = {.P = {keep(P, sizeof(P)), 4}};
    return PREPARE(sr_shape_bilinearmesh, keep(&m, sizeof(m)), placement);
}

static bool cast_triangle(const struct sr_shape_mesh *m, sr_vec3 o, sr_vec3 d, float *t, sr_vec2 *hit)
{
    const sr_vec3 *v = m->P.data;
    double e[3] = {v[1].x - v[0].x, v[1].y - v[0].y, v[1].z - v[0].z},
           f[3] = {v[2].x - v[0].x, v[2].y - v[0].y, v[2].z - v[0].z};
    double r[3] = {o.x - v[0].x, o.y - v[0].y, o.z - v[0].z}, w[3] = {d.x, d.y, d.z};
    double wf[3] = {w[1] * f[2] - w[2] * f[1], w[2] * f[0] - w[0] * f[2], w[0] * f[1] - w[1] * f[0]};
    double re[3] = {r[1] * e[2] - r[2] * e[1], r[2] * e[0] - r[0] * e[2], r[0] * e[1] - r[1] * e[0]};
    double det = e[0] * wf[0] + e[1] * wf[1] + e[2] * wf[2];
    double a = (r[0] * wf[0] + r[1] * wf[1] + r[2] * wf[2]) / det,
           b = (w[0] * re[0] + w[1] * re[1] + w[2] * re[2]) / det;
    double k = (f[0] * re[0] + f[1] * re[1] + f[2] * re[2]) / det;
    if (!(a >= 0 && b >= 0 && a + b <= 1 && k > 0))
        return false;
    *t = (float)k;
    *hit = (sr_vec2){(float)a, (float)b};
    return true;
}

bool cast(struct sr_shape s, sr_vec3 o, sr_vec3 d, float *t, sr_vec2 *hit)
{
    if (s.model == &sr_shape_trianglemesh)
        return cast_triangle(s.self, o, d, t, hit);
    return s.model->intersect(s.self, 0, o, d, 0, INFINITY, t, hit);
}

struct sr_point receiver(sr_vec3 p, sr_vec3 n)
{
    return (struct sr_point){.p = p, .n = n, .ns = n};
}

struct sr_tally irradiance(struct sr_shape s, uint32_t primitive, const struct sr_point *x, int n, uint64_t seed)
{
    struct sr_tally E = {0};
    struct sr_rng rng = sr_rng_seed(seed, 1);
    for (int i = 0; i < n; ++i) {
        struct sr_shape_sample y;
        sr_vec2 u = {uniform(&rng), uniform(&rng)};
        double term = 0;
        if (s.model->sample(s.self, primitive, x, u, &y)) {
            sr_vec3 wi = sr_normalize(sr_sub(y.p, x->p));
            // a closed surface is met at the near side only
            bool is_seen = s.model != &sr_shape_sphere || sr_dot(wi, y.n) < 0;
            term = is_seen ? fmax(0, (double)sr_dot(wi, x->n)) / (double)y.pdf : 0;
        }
        sr_tally_add(&E, term);
    }
    return E;
}

struct sr_tally solid_angle(struct sr_shape s, uint32_t primitive, const struct sr_point *x, int n, uint64_t seed)
{
    struct sr_tally omega = {0};
    struct sr_rng rng = sr_rng_seed(seed, 2);
    for (int i = 0; i < n; ++i) {
        struct sr_shape_sample y;
        sr_vec2 u = {uniform(&rng), uniform(&rng)};
        sr_tally_add(&omega, s.model->sample(s.self, primitive, x, u, &y) ? 1 / (double)y.pdf : 0);
    }
    return omega;
}

double pdf_deviation(struct sr_shape s, uint32_t primitive, const struct sr_point *x, int n, uint64_t seed)
{
    struct sr_rng rng = sr_rng_seed(seed, 3);
    double worst = 0;
    for (int i = 0; i < n; ++i) {
        struct sr_shape_sample y;
        sr_vec2 u = {uniform(&rng), uniform(&rng)};
        if (!s.model->sample(s.self, primitive, x, u, &y))
            continue;
        struct sr_point there = {.p = y.p, .p_error = y.p_error, .n = y.n, .ns = y.n, .uv = y.uv};
        sr_vec3 wi = sr_normalize(sr_sub(y.p, x->p));
        double pdf = (double)s.model->pdf(s.self, primitive, x, wi, &there);
        worst = fmax(worst, fabs(pdf - (double)y.pdf) / (double)y.pdf);
    }
    return worst;
}
