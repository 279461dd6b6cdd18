/* SPDX-License-Identifier: MIT */
/* Triangles: p = b0 p0 + b1 p1 + b2 p2 [m], uv and normals likewise.
 *
 *     n  = (p1 - p0) x (p2 - p0) / |...|             the winding is counterclockwise seen from outside,
 *                                                    turned if flipped; where there are N, on the side of the
 *                                                    interpolated N instead
 *     |error of p| <= gamma(7) SUM |b_i p_i|         [m]
 *     + 32 u w_x w_y w_z / |(p1 - p0) x (p2 - p0)|   [m] along n: how far from its plane a ray caster that computes in
 *                                                    floats may believe a hit to lie; w: the box's size,
 *                                                    u = 2^-24 (docs/decisions/0024-leaving-triangles.md)
 *     du12 dpdu + dv12 dpdv = p1 - p2, and so on     solved for dpdu, dpdv [m]
 *
 * Sampled toward a point: uniformly in the solid angle Omega (J. Arvo 1995), times the bilinear weight of the
 * receiver's cosine at the corners; by area, pdf = r^2 / (A |cos theta|) [1/sr], where the triangle looks small (that
 * is cheaper and as good) or fills nearly a hemisphere. M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering,
 * 4th ed. 2023, 6.5. A triangle without area is never sampled. */
#include "shape/mesh.h"

static const float min_solid_angle = 3e-4f,
                   max_solid_angle = 6.22f; // [sr] within, the spherical triangle is well-conditioned
// (longest edge / distance)^2 below which area sampling is taken at once: 15 % faster for 1 % more variance
static const float small_extent2 = 1.5f;

#define T struct sr_shape_mesh
static const struct sr_param params[] = {
    {SR_PARAM_INTS, "indices", "1", 0, INT32_MAX, NAN, offsetof(T, indices),
     "three vertices a triangle; 0 1 2 if there are but three P"},
    {SR_PARAM_POINT3S, "P", "m", -INFINITY, INFINITY, NAN, offsetof(T, P), "positions of the vertices"},
    {SR_PARAM_NORMAL3S, "N", "1", -INFINITY, INFINITY, NAN, offsetof(T, N), "shading normals; their side is outside"},
    {SR_PARAM_VECTOR3S, "S", "1", -INFINITY, INFINITY, NAN, offsetof(T, S), "shading tangents"},
    {SR_PARAM_POINT2S, "uv", "1", -INFINITY, INFINITY, NAN, offsetof(T, uv), "texture coordinates"},
    {SR_PARAM_INTS, "faceIndices", "1", 0, INT32_MAX, NAN, offsetof(T, face_indices),
     "number of the face that each triangle came from"},
    {0},
};
#undef T

/* A vertex and the number behind it, to be worked on with one instruction. */
typedef float quad __attribute__((vector_size(16)));
typedef int32_t quad_bits __attribute__((vector_size(16)));

static inline quad load(const sr_vec3 *p)
{
    quad a;
    __builtin_memcpy(&a, p, sizeof a);
    return a;
}

static inline sr_vec3 three(quad a)
{
    return (sr_vec3){a[0], a[1], a[2]};
}

static inline quad magnitude(quad a)
{
    return (quad)((quad_bits)a & INT32_MAX);
}

/* sr_cross, lane by lane: a b - c d without cancellation. */
static inline quad cross(quad a, quad b)
{
    quad a1 = __builtin_shufflevector(a, a, 1, 2, 0, 3), a2 = __builtin_shufflevector(a, a, 2, 0, 1, 3);
    quad b1 = __builtin_shufflevector(b, b, 2, 0, 1, 3), b2 = __builtin_shufflevector(b, b, 1, 2, 0, 3);
    quad c = a2 * b2, difference, error;
    for (int i = 0; i < 4; ++i)
        difference[i] = fmaf(a1[i], b1[i], -c[i]);
    for (int i = 0; i < 4; ++i)
        error[i] = fmaf(-a2[i], b2[i], c[i]);
    return difference + error;
}

/* The extent of the triangle's box. */
static inline quad box_size(quad v0, quad v1, quad v2)
{
    quad lo, hi;
    for (int i = 0; i < 4; ++i) {
        lo[i] = v0[i] < v1[i] ? v0[i] : v1[i];
        hi[i] = v0[i] > v1[i] ? v0[i] : v1[i];
    }
    for (int i = 0; i < 4; ++i) {
        lo[i] = lo[i] < v2[i] ? lo[i] : v2[i];
        hi[i] = hi[i] > v2[i] ? hi[i] : v2[i];
    }
    return hi - lo;
}

/* Needles, whose normal is known no better than that, do not leave more than 2^-10 of their size between them and a
 * ray. */
static inline float plane_error(float of_normal, quad w)
{
    return sr_min(32 * SR_MACHINE_EPSILON * of_normal, 0x1p-10f * (w[0] + w[1] + w[2]));
}

/* Where squares of areas are too small or too large for floats. */
static struct sr_shape_plane extreme_plane(sr_vec3 c, quad w)
{
    double l = sqrt((double)c.x * (double)c.x + (double)c.y * (double)c.y + (double)c.z * (double)c.z);
    float of_normal = l > 0 ? (float)((double)w[0] * (double)w[1] * (double)w[2] / l) : 0;
    return (struct sr_shape_plane){sr_unit_normal(c), plane_error(of_normal, w)};
}

/* By the winding; of triangles without area (0,0,1). */
static inline struct sr_shape_plane plane_of(quad v0, quad v1, quad v2)
{
    sr_vec3 c = three(cross(v0 - v2, v1 - v2));
    quad w = box_size(v0, v1, v2);
    float l2 = sr_dot(c, c);
    if (SR_UNLIKELY(!(l2 > 1e-30f && l2 < 1e30f)))
        return extreme_plane(c, w);
    float inverse = 1 / sqrtf(l2);
    return (struct sr_shape_plane){sr_scale(inverse, c), plane_error(inverse * w[0] * w[1] * w[2], w)};
}

/* What each hit would take a root and a quotient to find. Large meshes have no room for that. */
enum { MOST_PLANES = 1024 };
void sr_mesh_keep_planes(struct sr_shape_mesh *m, struct sr_arena *arena)
{
    uint32_t n = m->indices.count / 3;
    struct sr_shape_plane *planes = n <= MOST_PLANES ? sr_arena_alloc(arena, n * sizeof *planes) : NULL;
    const int32_t *c = m->indices.data;
    const sr_vec3 *P = m->P.data;
    for (uint32_t i = 0; planes && i < n; ++i, c += 3)
        planes[i] = plane_of(load(P + c[0]), load(P + c[1]), load(P + c[2]));
    m->planes = planes;
}

static inline struct sr_shape_plane find_plane(const struct sr_shape_mesh *m, uint32_t primitive, quad v0, quad v1,
                                               quad v2)
{
    return m->planes ? m->planes[primitive] : plane_of(v0, v1, v2);
}

static sr_status prepare(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error)
{
    struct sr_shape_mesh *m = self;
    const struct sr_mesh_arrays a = {"trianglemesh", 3,      &m->indices,      &m->P,       &m->N,
                                     &m->S,          &m->uv, &m->face_indices, &m->left_out};
    sr_status status = sr_mesh_place(&a, placement, &m->flip_normals, arena, error);
    if (status == SR_OK)
        sr_mesh_keep_planes(m, arena);
    return status;
}

static uint32_t primitive_count(const void *self)
{
    return ((const struct sr_shape_mesh *)self)->indices.count / 3;
}

static const int32_t *corners(const struct sr_shape_mesh *m, uint32_t primitive)
{
    return (const int32_t *)m->indices.data + 3 * (size_t)primitive;
}

static void vertices(const struct sr_shape_mesh *m, uint32_t primitive, sr_vec3 v[3])
{
    const int32_t *c = corners(m, primitive);
    const sr_vec3 *P = m->P.data;
    for (int i = 0; i < 3; ++i)
        v[i] = P[c[i]];
}

static struct sr_box bounds(const void *self, uint32_t primitive)
{
    sr_vec3 v[3];
    vertices(self, primitive, v);
    return sr_box_add(sr_box_add(sr_box_add(sr_box_empty(), v[0]), v[1]), v[2]);
}

static float area(const void *self, uint32_t primitive)
{
    sr_vec3 v[3];
    vertices(self, primitive, v);
    double e[3] = {(double)v[1].x - (double)v[0].x, (double)v[1].y - (double)v[0].y, (double)v[1].z - (double)v[0].z};
    double f[3] = {(double)v[2].x - (double)v[0].x, (double)v[2].y - (double)v[0].y, (double)v[2].z - (double)v[0].z};
    double c[3] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
    return (float)(0.5 * sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]));
}

/* Corners and their weights in the order of the file. */
static void turn_back(const struct sr_shape_mesh *m, uint32_t primitive, const int32_t **corner, float b[3],
                      int32_t turned[3])
{
    int turn = m->turns[primitive & m->turn_mask];
    float w[3] = {b[0], b[1], b[2]};
    for (int i = 0; i < 3; ++i) {
        turned[i] = (*corner)[(i + turn) % 3];
        b[i] = w[(i + turn) % 3];
    }
    *corner = turned;
}

static sr_vec3 blend(const sr_vec3 *a, const int32_t *c, float b0, float b1, float b2)
{
    return sr_add(sr_add(sr_scale(b0, a[c[0]]), sr_scale(b1, a[c[1]])), sr_scale(b2, a[c[2]]));
}

static const float gamma7 = 7.1f * SR_MACHINE_EPSILON; // gamma(7), rounded up

/* Of the point, and of where the ray caster sees the plane. */
static inline sr_vec3 error_bound(quad a, quad b, quad c, struct sr_shape_plane k)
{
    return three(gamma7 * (magnitude(a) + magnitude(b) + magnitude(c)) +
                 k.error * magnitude((quad){k.n.x, k.n.y, k.n.z, 0}));
}

/* From differences along two edges to derivatives by the texture coordinates. */
struct slope {
    float u02, v02, u12, v12, inverse; // differences of uv to vertex 2, one over their determinant
};
static void solve(const struct slope *k, sr_vec3 x02, sr_vec3 x12, sr_vec3 *dxdu, sr_vec3 *dxdv)
{
    *dxdu = sr_scale(k->inverse, sr_sub(sr_scale(k->v12, x02), sr_scale(k->v02, x12)));
    *dxdv = sr_scale(k->inverse, sr_sub(sr_scale(k->u02, x12), sr_scale(k->u12, x02)));
}

static void point(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x)
{
    const struct sr_shape_mesh *m = self;
    const int32_t *c = corners(m, primitive);
    const sr_vec3 *P = m->P.data;
    for (int i = 0; m->N.count && i < 3; ++i) // all misses at once
        __builtin_prefetch((const sr_vec3 *)m->N.data + c[i]);
    for (int i = 0; m->uv.count && i < 3; ++i)
        __builtin_prefetch((const sr_vec2 *)m->uv.data + c[i]);
    float b1 = hit.x, b2 = hit.y, b0 = 1 - b1 - b2;
    int32_t turned[3];
    if (SR_UNLIKELY(m->turns)) {
        float b[3] = {b0, b1, b2};
        turn_back(m, primitive, &c, b, turned);
        b0 = b[0], b1 = b[1], b2 = b[2];
    }
    quad v0 = load(P + c[0]), v1 = load(P + c[1]), v2 = load(P + c[2]);
    quad a = b0 * v0, b = b1 * v1, d = b2 * v2;
    x->p = three(a + b + d);
    struct sr_shape_plane plane = find_plane(m, primitive, v0, v1, v2);
    x->p_error = error_bound(a, b, d, plane);
    x->face = m->face_indices.count ? ((const int32_t *)m->face_indices.data)[primitive] : 0;
    sr_vec3 p02 = three(v0 - v2), p12 = three(v1 - v2), n = plane.n;

    struct slope k = {-1, -1, 0, -1, 1}; // of uv (0,0) (1,0) (1,1)
    bool has_slope = true;
    if (m->uv.count) {
        const sr_vec2 *uv = m->uv.data;
        sr_vec2 t0 = uv[c[0]], t1 = uv[c[1]], t2 = uv[c[2]];
        x->uv = (sr_vec2){b0 * t0.x + b1 * t1.x + b2 * t2.x, b0 * t0.y + b1 * t1.y + b2 * t2.y};
        k = (struct slope){t0.x - t2.x, t0.y - t2.y, t1.x - t2.x, t1.y - t2.y, 0};
        float determinant = sr_difference_of_products(k.u02, k.v12, k.v02, k.u12);
        has_slope =
            fabsf(determinant) > 1e-9f * (fabsf(k.u02 * k.v12) + fabsf(k.v02 * k.u12)) && fabsf(determinant) > 1e-30f;
        k.inverse = has_slope ? 1 / determinant : 0;
    } else {
        x->uv = (sr_vec2){b1 + b2, b2};
    }
    if (SR_LIKELY(has_slope)) {
        solve(&k, p02, p12, &x->dpdu, &x->dpdv);
    } else {
        struct sr_frame f = sr_frame_from_z(n);
        x->dpdu = f.x;
        x->dpdv = f.y;
    }
    x->dndu = x->dndv = (sr_vec3){0, 0, 0};
    x->dpdus = x->dpdu;

    if (m->N.count) {
        const sr_vec3 *N = m->N.data;
        sr_vec3 s = blend(N, c, b0, b1, b2);
        float l2 = sr_dot(s, s);
        if (SR_LIKELY(l2 > 1e-12f)) {
            // the unit normal's derivative is that of s, less its part along s, over |s|
            float inverse = 1 / sqrtf(l2);
            sr_vec3 ns = sr_scale(inverse, s);
            x->ns = ns;
            x->n = sr_scale(copysignf(1, sr_dot(n, ns)), n); // no branch to mispredict
            if (has_slope) {
                sr_vec3 dsdu, dsdv;
                solve(&k, sr_sub(N[c[0]], N[c[2]]), sr_sub(N[c[1]], N[c[2]]), &dsdu, &dsdv);
                x->dndu = sr_scale(inverse, sr_mad(dsdu, -sr_dot(dsdu, ns), ns));
                x->dndv = sr_scale(inverse, sr_mad(dsdv, -sr_dot(dsdv, ns), ns));
            }
        } else {
            x->n = x->ns = m->flip_normals ? sr_neg(n) : n;
        }
    } else {
        x->n = x->ns = m->flip_normals ? sr_neg(n) : n;
    }
    if (m->S.count) {
        sr_vec3 s = blend(m->S.data, c, b0, b1, b2);
        if (sr_dot(s, s) > 0)
            x->dpdus = s;
    }
}

static void bare_point(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x)
{
    const struct sr_shape_mesh *m = self;
    const int32_t *c = corners(m, primitive);
    const sr_vec3 *P = m->P.data;
    for (int i = 0; m->N.count && i < 3; ++i) // all misses at once
        __builtin_prefetch((const sr_vec3 *)m->N.data + c[i]);
    quad v0 = load(P + c[0]), v1 = load(P + c[1]), v2 = load(P + c[2]);
    float b1 = hit.x, b2 = hit.y, b0 = 1 - b1 - b2;
    quad a = b0 * v0, b = b1 * v1, d = b2 * v2;
    x->p = three(a + b + d);
    struct sr_shape_plane plane = find_plane(m, primitive, v0, v1, v2);
    x->p_error = error_bound(a, b, d, plane);
    sr_vec3 n = plane.n;
    if (m->N.count) {
        sr_vec3 s = blend(m->N.data, c, b0, b1, b2);
        float l2 = sr_dot(s, s);
        if (SR_LIKELY(l2 > 1e-12f)) {
            x->ns = sr_scale(1 / sqrtf(l2), s);
            x->n = sr_scale(copysignf(1, sr_dot(n, x->ns)), n); // no branch to mispredict
            return;
        }
    }
    n = sr_scale(m->flip_normals ? -1 : 1, n);
    x->n = n;
    x->ns = n;
}

static sr_vec2 uv(const void *self, uint32_t primitive, sr_vec2 hit)
{
    const struct sr_shape_mesh *m = self;
    float b1 = hit.x, b2 = hit.y, b0 = 1 - b1 - b2;
    const int32_t *c = corners(m, primitive);
    if (!m->uv.count && m->turns) {
        float b[3] = {b0, b1, b2};
        int32_t turned[3];
        turn_back(m, primitive, &c, b, turned);
        return (sr_vec2){b[1] + b[2], b[2]};
    }
    if (!m->uv.count)
        return (sr_vec2){b1 + b2, b2};
    const sr_vec2 *t = m->uv.data;
    return (sr_vec2){b0 * t[c[0]].x + b1 * t[c[1]].x + b2 * t[c[2]].x,
                     b0 * t[c[0]].y + b1 * t[c[1]].y + b2 * t[c[2]].y};
}

/* The outside unit normal at barycentrics. */
static sr_vec3 outside(const struct sr_shape_mesh *m, const int32_t *c, sr_vec3 n, float b0, float b1, float b2)
{
    if (m->N.count) {
        sr_vec3 s = blend(m->N.data, c, b0, b1, b2);
        if (sr_dot(s, s) > 1e-12f)
            return sr_face_forward(n, s);
    }
    return m->flip_normals ? sr_neg(n) : n;
}

/* Whether the triangle is drawn by solid angle as seen from p, and if so its solid angle [sr] (Van Oosterom & Strackee
 * 1983). The same in sample and pdf. */
static bool by_solid_angle(const sr_vec3 v[3], sr_vec3 p, float *solid_angle)
{
    sr_vec3 a = sr_sub(v[0], p), b = sr_sub(v[1], p), c = sr_sub(v[2], p);
    sr_vec3 e0 = sr_sub(v[1], v[0]), e1 = sr_sub(v[2], v[1]), e2 = sr_sub(v[2], v[0]);
    float a2 = sr_dot(a, a), b2 = sr_dot(b, b), c2 = sr_dot(c, c);
    float nearest2 = sr_min(a2, sr_min(b2, c2));
    float extent2 = sr_max(sr_dot(e0, e0), sr_max(sr_dot(e1, e1), sr_dot(e2, e2)));
    if (extent2 < small_extent2 * nearest2 || !(nearest2 > 1e-30f))
        return false;
    // of directions, so that no scale overflows
    sr_vec3 A = sr_scale(1 / sqrtf(a2), a), B = sr_scale(1 / sqrtf(b2), b), C = sr_scale(1 / sqrtf(c2), c);
    float volume = fabsf(sr_dot(A, sr_cross(e0, e2))) / sqrtf(b2 * c2);
    *solid_angle = 2 * atan2f(volume, 1 + sr_dot(A, B) + sr_dot(B, C) + sr_dot(C, A));
    return *solid_angle > min_solid_angle && *solid_angle < max_solid_angle;
}

/* The receiver's cosine where the square's corners (0,0) (1,0) (0,1) (1,1) go: vertices 1, 1, 0, 2. */
static void corner_weights(const struct sr_point *reference, const sr_vec3 v[3], float w[4])
{
    float k[3];
    for (int i = 0; i < 3; ++i) {
        sr_vec3 d = sr_sub(v[i], reference->p);
        k[i] = sr_receiver_weight(reference, d, 1 / sr_length(d));
    }
    w[0] = w[1] = k[1];
    w[2] = k[0];
    w[3] = k[2];
}

/* The normal by the winding, and the area [m^2], of one vector product. */
static inline sr_vec3 normal_and_area(const sr_vec3 v[3], float *area)
{
    sr_vec3 c = sr_cross(sr_sub(v[0], v[2]), sr_sub(v[1], v[2]));
    float l2 = sr_dot(c, c);
    if (SR_LIKELY(l2 > 1e-30f && l2 < 1e30f)) {
        float l = sqrtf(l2);
        *area = 0.5f * l;
        return sr_scale(1 / l, c);
    }
    *area = (float)(0.5 * sqrt((double)c.x * (double)c.x + (double)c.y * (double)c.y + (double)c.z * (double)c.z));
    return sr_unit_normal(c);
}

static bool sample(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec2 u,
                   struct sr_shape_sample *s)
{
    const struct sr_shape_mesh *m = self;
    const int32_t *c = corners(m, primitive);
    sr_vec3 v[3];
    vertices(m, primitive, v);
    float b[3], pdf, a, solid_angle;
    sr_vec3 n = normal_and_area(v, &a);
    bool is_spherical = reference && by_solid_angle(v, reference->p, &solid_angle);
    if (is_spherical) {
        float pdf_warp = 1;
        if (sr_has_normal(reference)) {
            float w[4];
            corner_weights(reference, v, w);
            u = sr_warp_bilinear(u, w);
            pdf_warp = sr_warp_bilinear_pdf(u, w);
        }
        sr_spherical_triangle_sample(v, reference->p, u, b, &pdf);
        pdf *= pdf_warp;
    } else {
        if (!(a > 0))
            return false;
        pdf = 1 / a;
        sr_vec2 t = sr_warp_triangle(u);
        b[0] = t.x;
        b[1] = t.y;
        b[2] = 1 - t.x - t.y;
    }
    const sr_vec3 *P = m->P.data;
    quad v0 = load(P + c[0]), v1 = load(P + c[1]), v2 = load(P + c[2]), p0 = b[0] * v0, p1 = b[1] * v1, p2 = b[2] * v2;
    s->p = three(p0 + p1 + p2);
    s->p_error = error_bound(p0, p1, p2, find_plane(m, primitive, v0, v1, v2));
    s->n = outside(m, c, n, b[0], b[1], b[2]);
    s->uv = uv(self, primitive, (sr_vec2){b[1], b[2]});
    s->pdf = reference && !is_spherical ? sr_density_seen_from(reference->p, s->p, n, pdf) : pdf;
    return s->pdf > 0 && isfinite(s->pdf);
}

static float pdf(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec3 wi,
                 const struct sr_point *there)
{
    sr_vec3 v[3];
    vertices(self, primitive, v);
    float solid_angle;
    if (!by_solid_angle(v, reference->p, &solid_angle)) {
        float a;
        normal_and_area(v, &a);
        return a > 0 ? sr_density_seen_from(reference->p, there->p, there->n, 1 / a) : 0;
    }
    float pdf_warp = 1;
    if (sr_has_normal(reference)) {
        float w[4];
        corner_weights(reference, v, w);
        pdf_warp = sr_warp_bilinear_pdf(sr_spherical_triangle_invert(v, reference->p, wi), w);
    }
    return pdf_warp / solid_angle;
}

/* The flat normal; where shading normals of the corners disagree about its side, all directions. */
static void normals(const void *self, uint32_t primitive, sr_vec3 *axis, float *cos_theta)
{
    const struct sr_shape_mesh *m = self;
    const int32_t *c = corners(m, primitive);
    sr_vec3 v[3];
    vertices(m, primitive, v);
    sr_vec3 n = sr_unit_normal(sr_cross(sr_sub(v[0], v[2]), sr_sub(v[1], v[2])));
    *axis = outside(m, c, n, 1, 0, 0);
    *cos_theta = 1;
    if (m->N.count && (sr_dot(*axis, outside(m, c, n, 0, 1, 0)) < 0 || sr_dot(*axis, outside(m, c, n, 0, 0, 1)) < 0))
        *cos_theta = -1;
}

static bool flat(const void *self, uint32_t primitive, struct sr_shape_flat *flat)
{
    const struct sr_shape_mesh *m = self;
    sr_vec3 v[3];
    vertices(m, primitive, v);
    float cos_theta;
    *flat =
        (struct sr_shape_flat){.corner = v[0], .e = sr_sub(v[1], v[0]), .f = sr_sub(v[2], v[0]), .is_triangle = true};
    normals(self, primitive, &flat->n, &cos_theta);
    return cos_theta == 1 && area(self, primitive) > 0;
}

const struct sr_shape_model sr_shape_trianglemesh = {
    .name = "trianglemesh",
    .params = params,
    .size = sizeof(struct sr_shape_mesh),
    .prepare = prepare,
    .primitive_count = primitive_count,
    .bounds = bounds,
    .area = area,
    .point = point,
    .bare_point = bare_point,
    .uv = uv,
    .sample = sample,
    .pdf = pdf,
    .normals = normals,
    .flat = flat,
};
