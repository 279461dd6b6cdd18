/* SPDX-License-Identifier: MIT */
/* Bilinear patches, ruled surfaces through four vertices:
 *
 *     p(u, v) = (1-u)(1-v) p00 + u (1-v) p10 + (1-u) v p01 + u v p11     [m]
 *     n = dpdu x dpdv / |...|, turned if flipped; where there are N, on the side of the interpolated N instead
 *
 * A ray o + t d meets the line of constant u where (p(u,0) - o) . (d x (p(u,1) - p(u,0))) = 0, a quadratic in u (GARP:
 * A. Reshetov, Cool Patches, Ray Tracing Gems 2019); solved in double.
 *
 * Sampled toward a point: rectangles uniformly in solid angle (C. Urena et al. 2013) times the bilinear weight of the
 * receiver's cosine; all others, and rectangles that look small, by area: uniformly if parallelograms, else with the
 * density of |dpdu x dpdv| at the corners, bilinearly between (M. Pharr, W. Jakob, G. Humphreys, Physically Based
 * Rendering, 4th ed. 2023, 6.6). A patch without area is never sampled. */
#include "shape/mesh.h"
#include "shape/quadric.h"

#include <float.h>

enum kind { GENERAL, PARALLELOGRAM, RECTANGLE, EMPTY };
static const float small_extent2 = 1.5f; // (diagonal / distance)^2 below which area sampling is taken
static const float min_solid_angle = 3e-4f, max_solid_angle = 6.22f; // [sr]

#define B struct sr_shape_patches
static const struct sr_param params[] = {
    {SR_PARAM_INTS, "indices", "1", 0, INT32_MAX, NAN, offsetof(B, indices),
     "four vertices a patch, at (u,v) = (0,0) (1,0) (0,1) (1,1); 0 1 2 3 if there are but four P"},
    {SR_PARAM_POINT3S, "P", "m", -INFINITY, INFINITY, NAN, offsetof(B, P), "positions of the vertices"},
    {SR_PARAM_NORMAL3S, "N", "1", -INFINITY, INFINITY, NAN, offsetof(B, N), "shading normals; their side is outside"},
    {SR_PARAM_POINT2S, "uv", "1", -INFINITY, INFINITY, NAN, offsetof(B, uv), "texture coordinates"},
    {SR_PARAM_INTS, "faceIndices", "1", 0, INT32_MAX, NAN, offsetof(B, face_indices),
     "number of the face that each patch came from"},
    {SR_PARAM_FILE, "emissionfilename", "1", 0, 0, NAN, offsetof(B, emission_filename),
     "nothing: where an area light's image is bright, points are drawn anyway"},
    {0},
};
#undef B

static const int32_t *corners(const struct sr_shape_patches *m, uint32_t primitive)
{
    return (const int32_t *)m->indices.data + 4 * (size_t)primitive;
}

static void vertices(const struct sr_shape_patches *m, uint32_t primitive, sr_vec3 v[4])
{
    const int32_t *c = corners(m, primitive);
    for (int i = 0; i < 4; ++i)
        v[i] = ((const sr_vec3 *)m->P.data)[c[i]];
}

static void weights(sr_vec2 h, float b[4])
{
    b[0] = (1 - h.x) * (1 - h.y);
    b[1] = h.x * (1 - h.y);
    b[2] = (1 - h.x) * h.y;
    b[3] = h.x * h.y;
}

static sr_vec3 mix(const sr_vec3 v[4], const float b[4])
{
    return sr_add(sr_add(sr_scale(b[0], v[0]), sr_scale(b[1], v[1])),
                  sr_add(sr_scale(b[2], v[2]), sr_scale(b[3], v[3])));
}

/* Derivatives by u at v = t, and by v at u = t. */
static sr_vec3 along_u(const sr_vec3 v[4], float t)
{
    return sr_add(sr_scale(1 - t, sr_sub(v[1], v[0])), sr_scale(t, sr_sub(v[3], v[2])));
}
static sr_vec3 along_v(const sr_vec3 v[4], float t)
{
    return sr_add(sr_scale(1 - t, sr_sub(v[2], v[0])), sr_scale(t, sr_sub(v[3], v[1])));
}
static sr_vec3 normal_vector(const sr_vec3 v[4], sr_vec2 h)
{
    return sr_cross(along_u(v, h.y), along_v(v, h.x));
}

static float area(const void *self, uint32_t primitive)
{
    sr_vec3 v[4];
    vertices(self, primitive, v);
    enum { nodes = 12 };
    double x[nodes], w[nodes], sum = 0;
    sr_gauss_legendre(nodes, 0, 1, x, w);
    sr_dvec3 e0 = sr_dvec(sr_sub(v[1], v[0])), e1 = sr_dvec(sr_sub(v[3], v[2])), f0 = sr_dvec(sr_sub(v[2], v[0])),
             f1 = sr_dvec(sr_sub(v[3], v[1]));
    for (int i = 0; i < nodes; ++i) {
        double a = x[i];
        sr_dvec3 f = {f0.x + a * (f1.x - f0.x), f0.y + a * (f1.y - f0.y), f0.z + a * (f1.z - f0.z)};
        for (int j = 0; j < nodes; ++j) {
            double b = x[j];
            sr_dvec3 e = {e0.x + b * (e1.x - e0.x), e0.y + b * (e1.y - e0.y), e0.z + b * (e1.z - e0.z)};
            sr_dvec3 c = {e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
            sum += w[i] * w[j] * sqrt(sr_ddot(c, c));
        }
    }
    return (float)sum;
}

static enum kind classify(const sr_vec3 v[4])
{
    sr_vec3 e = sr_sub(v[1], v[0]), f = sr_sub(v[2], v[0]);
    sr_vec3 rest = sr_sub(sr_sub(v[3], v[1]), f);
    float extent = sr_max(sr_length(e), sr_length(f));
    bool has_area = false;
    for (int i = 0; i < 4; ++i) {
        sr_vec3 n = normal_vector(v, (sr_vec2){(float)(i & 1), (float)(i >> 1)});
        has_area |= n.x != 0 || n.y != 0 || n.z != 0;
    }
    if (!has_area)
        return EMPTY;
    if (sr_length(rest) > 1e-6f * extent)
        return GENERAL;
    return fabsf(sr_dot(e, f)) <= 1e-6f * sr_length(e) * sr_length(f) ? RECTANGLE : PARALLELOGRAM;
}

static sr_status prepare(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error)
{
    struct sr_shape_patches *m = self;
    const struct sr_mesh_arrays a = {"bilinearmesh", 4,      &m->indices,      &m->P,       &m->N,
                                     NULL,           &m->uv, &m->face_indices, &m->left_out};
    sr_status status = sr_mesh_place(&a, placement, &m->flip_normals, arena, error);
    if (status != SR_OK)
        return status;
    uint32_t count = m->indices.count / 4;
    uint8_t *kinds = sr_arena_alloc(arena, count);
    if (!kinds)
        return sr_fail(error, SR_ERROR_RESOURCE, "bilinearmesh: no memory for %u patches", count);
    for (uint32_t i = 0; i < count; ++i) {
        sr_vec3 v[4];
        vertices(m, i, v);
        kinds[i] = (uint8_t)classify(v);
    }
    m->kinds = kinds;
    return SR_OK;
}

static uint32_t primitive_count(const void *self)
{
    return ((const struct sr_shape_patches *)self)->indices.count / 4;
}

/* A patch lies within the hull of its vertices; the margin covers the rounding of points computed on it. */
static struct sr_box bounds(const void *self, uint32_t primitive)
{
    sr_vec3 v[4];
    vertices(self, primitive, v);
    struct sr_box b = sr_box_empty();
    for (int i = 0; i < 4; ++i)
        b = sr_box_add(b, v[i]);
    return sr_quadric_box_outward(sr_dvec(b.lo), sr_dvec(b.hi));
}

struct meeting {
    double u, v, t;
};

static sr_dvec3 minus(sr_dvec3 a, sr_dvec3 b)
{
    return (sr_dvec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static sr_dvec3 cross(sr_dvec3 a, sr_dvec3 b)
{
    return (sr_dvec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* All meetings of the line o + t d with the patch (at most two), u and v within `slack` of 0 … 1. */
static int meet(const sr_vec3 vertex[4], sr_vec3 o, sr_vec3 direction, double slack, struct meeting m[2])
{
    sr_dvec3 d = sr_dvec(direction), origin = sr_dvec(o);
    sr_dvec3 a = minus(sr_dvec(vertex[0]), origin), a1 = minus(sr_dvec(vertex[1]), origin);
    sr_dvec3 e = minus(a1, a), f = minus(sr_dvec(vertex[2]), sr_dvec(vertex[0])),
             f1 = minus(sr_dvec(vertex[3]), sr_dvec(vertex[1]));
    sr_dvec3 g = minus(f1, f);
    // (a + u e) . (d x (f + u g)) = 0
    sr_dvec3 df = cross(d, f), dg = cross(d, g);
    double k0 = sr_ddot(a, df), k1 = sr_ddot(e, df) + sr_ddot(a, dg), k2 = sr_ddot(e, dg);
    double us[2];
    int roots = 0, found = 0;
    if (fabs(k2) <= 1e-14 * fabs(k1)) { // the second root is far outside
        if (k1 == 0)
            return 0;
        us[roots++] = -k0 / k1;
    } else if (sr_quadric_roots(k2, k1 / 2, k0, k1 * k1 / 4 - k2 * k0, us)) {
        roots = 2;
    }
    for (int i = 0; i < roots; ++i) {
        double u = us[i];
        if (!(u >= -slack && u <= 1 + slack))
            continue;
        sr_dvec3 at = {a.x + u * e.x, a.y + u * e.y, a.z + u * e.z},
                 line = {f.x + u * g.x, f.y + u * g.y, f.z + u * g.z};
        sr_dvec3 across = cross(d, line);
        double length2 = sr_ddot(across, across);
        if (!(length2 > 0))
            continue;
        double v = sr_ddot(cross(at, d), across) / length2;
        if (!(v >= -slack && v <= 1 + slack))
            continue;
        m[found++] = (struct meeting){u, v, sr_ddot(cross(at, line), across) / length2};
    }
    return found;
}

static bool intersect(const void *self, uint32_t primitive, sr_vec3 o, sr_vec3 d, float t_min, float t_max, float *t,
                      sr_vec2 *hit)
{
    sr_vec3 v[4];
    vertices(self, primitive, v);
    struct meeting m[2];
    int found = meet(v, o, d, 0, m), best = -1;
    // a ray that starts exactly on the patch (a floor at y = 0) meets it at a t of rounding only
    double reach = 0;
    for (int i = 0; i < 4; ++i) {
        sr_vec3 to = sr_sub(v[i], o);
        reach = fmax(reach, (double)(fabsf(to.x) + fabsf(to.y) + fabsf(to.z)));
    }
    double nearest = fmax((double)t_min, 256 * DBL_EPSILON * reach / sqrt((double)sr_length2(d)));
    for (int i = 0; i < found; ++i) {
        if (m[i].t > nearest && m[i].t < (double)t_max && (best < 0 || m[i].t < m[best].t))
            best = i;
    }
    if (best < 0)
        return false;
    *t = (float)m[best].t;
    *hit = (sr_vec2){(float)m[best].u, (float)m[best].v};
    return true;
}

static sr_vec3 error_bound(const sr_vec3 v[4], const float b[4])
{
    const float g = 7.1f * SR_MACHINE_EPSILON; // two products and three sums a term, gamma(6), rounded up
    sr_vec3 sum = {0, 0, 0};
    for (int i = 0; i < 4; ++i)
        sum = sr_add(sum, (sr_vec3){b[i] * fabsf(v[i].x), b[i] * fabsf(v[i].y), b[i] * fabsf(v[i].z)});
    return sr_scale(g, sum);
}

static sr_vec2 uv(const void *self, uint32_t primitive, sr_vec2 hit)
{
    const struct sr_shape_patches *m = self;
    if (!m->uv.count)
        return hit;
    const int32_t *c = corners(m, primitive);
    const sr_vec2 *t = m->uv.data;
    float b[4];
    weights(hit, b);
    return (sr_vec2){b[0] * t[c[0]].x + b[1] * t[c[1]].x + b[2] * t[c[2]].x + b[3] * t[c[3]].x,
                     b[0] * t[c[0]].y + b[1] * t[c[1]].y + b[2] * t[c[2]].y + b[3] * t[c[3]].y};
}

static bool has_shading_normal(const struct sr_shape_patches *m, uint32_t primitive, const float b[4], sr_vec3 N[4],
                               sr_vec3 *s)
{
    if (!m->N.count)
        return false;
    const int32_t *c = corners(m, primitive);
    for (int i = 0; i < 4; ++i)
        N[i] = ((const sr_vec3 *)m->N.data)[c[i]];
    *s = mix(N, b);
    return sr_dot(*s, *s) > 1e-12f;
}

/* The unit normal by the parameters; where an edge has shrunk to a point, that of a place nearby. */
static sr_vec3 flat_normal(const sr_vec3 v[4], sr_vec2 h)
{
    sr_vec3 n = normal_vector(v, h);
    if (SR_UNLIKELY(n.x == 0 && n.y == 0 && n.z == 0))
        n = normal_vector(v, (sr_vec2){sr_lerp(1e-3f, h.x, 0.5f), sr_lerp(1e-3f, h.y, 0.5f)});
    return sr_unit_normal(n);
}

static sr_vec3 outside(const struct sr_shape_patches *m, uint32_t primitive, const sr_vec3 v[4], sr_vec2 h)
{
    sr_vec3 n = flat_normal(v, h), N[4], s;
    float b[4];
    weights(h, b);
    if (has_shading_normal(m, primitive, b, N, &s))
        return sr_face_forward(n, s);
    return m->flip_normals ? sr_neg(n) : n;
}

static void point(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x)
{
    const struct sr_shape_patches *m = self;
    sr_vec3 v[4], N[4], s;
    vertices(m, primitive, v);
    float b[4];
    weights(hit, b);
    x->p = mix(v, b);
    x->p_error = error_bound(v, b);
    x->face = m->face_indices.count ? ((const int32_t *)m->face_indices.data)[primitive] : 0;
    x->uv = uv(m, primitive, hit);
    sr_vec3 n = flat_normal(v, hit), dpdu = along_u(v, hit.y), dpdv = along_v(v, hit.x);
    bool is_smooth = has_shading_normal(m, primitive, b, N, &s);
    sr_vec3 dndu = {0, 0, 0}, dndv = {0, 0, 0};
    if (is_smooth) {
        float inverse = 1 / sr_length(s);
        x->ns = sr_scale(inverse, s);
        x->n = sr_face_forward(n, x->ns);
        sr_vec3 su = along_u(N, hit.y), sv = along_v(N, hit.x);
        dndu = sr_scale(inverse, sr_mad(su, -sr_dot(su, x->ns), x->ns));
        dndv = sr_scale(inverse, sr_mad(sv, -sr_dot(sv, x->ns), x->ns));
    } else {
        x->n = x->ns = m->flip_normals ? sr_neg(n) : n;
        // n = c / |c|, c = dpdu x dpdv:  dn = (dc - n (n . dc)) / |c|, and p has but the mixed second derivative
        sr_vec3 c = sr_cross(dpdu, dpdv), mixed = sr_sub(sr_sub(v[3], v[1]), sr_sub(v[2], v[0]));
        float length = sr_length(c);
        if (m->kinds[primitive] == GENERAL && length > 0) {
            float k = (m->flip_normals ? -1.0f : 1.0f) / length;
            sr_vec3 cu = sr_cross(dpdu, mixed), cv = sr_cross(mixed, dpdv);
            dndu = sr_scale(k, sr_mad(cu, -sr_dot(cu, n), n));
            dndv = sr_scale(k, sr_mad(cv, -sr_dot(cv, n), n));
        }
    }

    if (m->uv.count) {
        // from the patch's parameters (a, b) to texture coordinates: d/du = da/du d/da + db/du d/db
        const int32_t *c = corners(m, primitive);
        const sr_vec2 *t = m->uv.data;
        sr_vec2 t0 = t[c[0]], t1 = t[c[1]], t2 = t[c[2]], t3 = t[c[3]];
        float ua = sr_lerp(hit.y, t1.x - t0.x, t3.x - t2.x), va = sr_lerp(hit.y, t1.y - t0.y, t3.y - t2.y);
        float ub = sr_lerp(hit.x, t2.x - t0.x, t3.x - t1.x), vb = sr_lerp(hit.x, t2.y - t0.y, t3.y - t1.y);
        float determinant = sr_difference_of_products(ua, vb, va, ub);
        if (fabsf(determinant) > 1e-9f * (fabsf(ua * vb) + fabsf(va * ub)) && fabsf(determinant) > 1e-30f) {
            float k = 1 / determinant;
            sr_vec3 pa = dpdu, na = dndu;
            dpdu = sr_scale(k, sr_sub(sr_scale(vb, pa), sr_scale(va, dpdv)));
            dpdv = sr_scale(k, sr_sub(sr_scale(ua, dpdv), sr_scale(ub, pa)));
            dndu = sr_scale(k, sr_sub(sr_scale(vb, na), sr_scale(va, dndv)));
            dndv = sr_scale(k, sr_sub(sr_scale(ua, dndv), sr_scale(ub, na)));
        }
    }
    if (!(sr_length2(dpdu) > 0) || !(sr_length2(dpdv) > 0)) { // in a corner where an edge has shrunk to a point
        struct sr_frame f = sr_frame_from_z(n);
        dpdu = f.x;
        dpdv = f.y;
    }
    x->dpdu = x->dpdus = dpdu;
    x->dpdv = dpdv;
    x->dndu = dndu;
    x->dndv = dndv;
}

/* Whether the patch is drawn by solid angle as seen from p, and with which density [1/sr]. The same in sample and pdf.
 */
static inline bool by_solid_angle(const struct sr_shape_patches *m, uint32_t primitive, const sr_vec3 v[4], sr_vec3 p,
                                  float *pdf)
{
    if (m->kinds[primitive] != RECTANGLE)
        return false;
    float a2 = sr_length2(sr_sub(v[0], p)), b2 = sr_length2(sr_sub(v[1], p)), c2 = sr_length2(sr_sub(v[2], p)),
          d2 = sr_length2(sr_sub(v[3], p));
    if (sr_length2(sr_sub(v[3], v[0])) < small_extent2 * sr_min(sr_min(a2, b2), sr_min(c2, d2)))
        return false;
    *pdf = sr_spherical_rectangle_pdf(p, v[0], sr_sub(v[1], v[0]), sr_sub(v[2], v[0]));
    return *pdf * min_solid_angle < 1 && *pdf * max_solid_angle > 1;
}

static void corner_weights(const struct sr_point *reference, const sr_vec3 v[4], float w[4])
{
    for (int i = 0; i < 4; ++i) {
        sr_vec3 d = sr_sub(v[i], reference->p);
        w[i] = sr_receiver_weight(reference, d, 1 / sr_max(sr_length(d), 1e-30f));
    }
}

static void area_weights(const sr_vec3 v[4], float w[4])
{
    float most = 0;
    for (int i = 0; i < 4; ++i) {
        sr_dvec3 c = sr_dvec(normal_vector(v, (sr_vec2){(float)(i & 1), (float)(i >> 1)}));
        w[i] = (float)sqrt(sr_ddot(c, c));
        most = sr_max(most, w[i]);
    }
    for (int i = 0; i < 4; ++i) // nowhere zero, for a patch may have area within though none at its corners
        w[i] = sr_max(w[i], 1e-2f * most);
}

/* Density by area [1/m^2] at the parameters h; 0 where the patch has no area. */
static float area_density(const struct sr_shape_patches *m, uint32_t primitive, const sr_vec3 v[4], sr_vec2 h)
{
    sr_dvec3 c = sr_dvec(normal_vector(v, h));
    float stretch = (float)sqrt(sr_ddot(c, c));
    if (!(stretch > 0))
        return 0;
    if (m->kinds[primitive] != GENERAL)
        return 1 / stretch;
    float w[4];
    area_weights(v, w);
    return sr_warp_bilinear_pdf(h, w) / stretch;
}

static bool sample(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec2 u,
                   struct sr_shape_sample *s)
{
    const struct sr_shape_patches *m = self;
    if (m->kinds[primitive] == EMPTY)
        return false;
    sr_vec3 v[4];
    vertices(m, primitive, v);
    sr_vec2 h = u;
    float w[4], b[4], pdf;
    bool is_spherical = reference && by_solid_angle(m, primitive, v, reference->p, &pdf);
    if (is_spherical) {
        if (sr_has_normal(reference)) {
            corner_weights(reference, v, w);
            u = sr_warp_bilinear(u, w);
            pdf *= sr_warp_bilinear_pdf(u, w);
        }
        float same;
        sr_vec3 e = sr_sub(v[1], v[0]), f = sr_sub(v[2], v[0]);
        sr_vec3 q = sr_sub(sr_spherical_rectangle_sample(reference->p, v[0], e, f, u, &same), v[0]);
        h = (sr_vec2){sr_clamp(sr_dot(q, e) / sr_dot(e, e), 0, 1), sr_clamp(sr_dot(q, f) / sr_dot(f, f), 0, 1)};
    } else {
        if (m->kinds[primitive] == GENERAL) {
            area_weights(v, w);
            h = sr_warp_bilinear(u, w);
        }
        pdf = area_density(m, primitive, v, h);
    }
    weights(h, b);
    s->p = mix(v, b);
    s->p_error = error_bound(v, b);
    s->n = outside(m, primitive, v, h);
    s->uv = uv(m, primitive, h);
    s->pdf = reference && !is_spherical ? sr_density_seen_from(reference->p, s->p, s->n, pdf) : pdf;
    return s->pdf > 0 && isfinite(s->pdf);
}

/* Density by area [1/m^2] at `there`. */
static float area_pdf(const void *self, uint32_t primitive, const struct sr_point *there)
{
    const struct sr_shape_patches *m = self;
    if (m->kinds[primitive] == EMPTY)
        return 0;
    sr_vec3 v[4];
    vertices(m, primitive, v);
    sr_vec2 h = {0.5f, 0.5f};
    if (m->kinds[primitive] == GENERAL) {
        // where on the patch `there` is: the meeting nearest to it of the line through it along its normal
        struct meeting at[2];
        int found = meet(v, there->p, there->n, 1e-3, at);
        if (found == 0)
            return 0;
        const struct meeting *k = &at[found == 2 && fabs(at[1].t) < fabs(at[0].t) ? 1 : 0];
        h = (sr_vec2){sr_clamp((float)k->u, 0, 1), sr_clamp((float)k->v, 0, 1)};
    }
    return area_density(m, primitive, v, h);
}

static float pdf(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec3 wi,
                 const struct sr_point *there)
{
    (void)wi;
    const struct sr_shape_patches *m = self;
    if (m->kinds[primitive] == EMPTY)
        return 0;
    sr_vec3 v[4];
    vertices(m, primitive, v);
    float density;
    if (by_solid_angle(m, primitive, v, reference->p, &density)) {
        if (!sr_has_normal(reference))
            return density;
        float w[4];
        corner_weights(reference, v, w);
        sr_vec2 u = sr_spherical_rectangle_invert(reference->p, v[0], sr_sub(v[1], v[0]), sr_sub(v[2], v[0]), there->p);
        return density * sr_warp_bilinear_pdf(u, w);
    }
    return sr_density_seen_from(reference->p, there->p, there->n, area_pdf(m, primitive, there));
}

/* dpdu x dpdv is bilinear in (u, v), so all normals lie in the hull of the four at the corners. */
static void normals(const void *self, uint32_t primitive, sr_vec3 *axis, float *cos_theta)
{
    const struct sr_shape_patches *m = self;
    sr_vec3 v[4], n[4], sum = {0, 0, 0};
    vertices(m, primitive, v);
    for (int i = 0; i < 4; ++i) {
        n[i] = outside(m, primitive, v, (sr_vec2){(float)(i & 1), (float)(i >> 1)});
        sum = sr_add(sum, n[i]);
    }
    *axis = (sr_vec3){0, 0, 1};
    *cos_theta = -1;
    if (!(sr_length2(sum) > 1e-6f))
        return;
    *axis = sr_normalize(sum);
    float narrowest = 1;
    for (int i = 0; i < 4; ++i)
        narrowest = sr_min(narrowest, sr_dot(n[i], *axis));
    if (m->kinds[primitive] == RECTANGLE || m->kinds[primitive] == PARALLELOGRAM)
        *cos_theta = narrowest > 0.999f ? 1 : -1;
    else if (narrowest > 0.01f && m->kinds[primitive] == GENERAL)
        *cos_theta = sr_max(-1, narrowest - 1e-5f);
}

static bool flat(const void *self, uint32_t primitive, struct sr_shape_flat *flat)
{
    const struct sr_shape_patches *m = self;
    sr_vec3 v[4];
    vertices(m, primitive, v);
    float cos_theta;
    *flat = (struct sr_shape_flat){.corner = v[0], .e = sr_sub(v[1], v[0]), .f = sr_sub(v[2], v[0])};
    normals(self, primitive, &flat->n, &cos_theta);
    return cos_theta == 1 && (m->kinds[primitive] == RECTANGLE || m->kinds[primitive] == PARALLELOGRAM);
}

const struct sr_shape_model sr_shape_bilinearmesh = {
    .name = "bilinearmesh",
    .params = params,
    .size = sizeof(struct sr_shape_patches),
    .prepare = prepare,
    .primitive_count = primitive_count,
    .bounds = bounds,
    .area = area,
    .intersect = intersect,
    .point = point,
    .uv = uv,
    .sample = sample,
    .pdf = pdf,
    .area_pdf = area_pdf,
    .normals = normals,
    .flat = flat,
};
