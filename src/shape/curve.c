/* SPDX-License-Identifier: MIT */
/* Curves: strips about cubic Bézier segments that turn to whoever looks, as pbrt-v4 means them.
 *
 *     c(u) = a0 + a1 u + a2 u^2 + a3 u^3 [m],  u in 0 … 1 along each segment;  v in 0 … 1 across
 *     p = c(u) + (v - 1/2) h(u) b [m]
 *     b = d x c'(u) / |...|                    across, seen along d
 *     h = h0 + (h1 - h0) u                     the width [m]
 *
 * h is linear in u along the whole curve. n = dp/du x dp/dv, which for flat curves points away from the viewer. Of
 * cylinders dp/dv is turned by 180 deg (1/2 - v) about c', so that n is that of a tube; p stays in the strip. Of
 * ribbons h is narrowed to h |N . d|, N going from one end's normal to the other's on the great circle, and dp/dv = h N
 * x c' / |...|. A ray meets the strip where the projection of c along d is nearest to it, found on chords no further
 * than h/20 from c and two steps of Newton beyond. M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering, 4th
 * ed. 2023, section 6.7; K. Nakamaru and Y. Ohno, Ray tracing for curves primitive, 2002. Limits: rays leave from a
 * whole width off the strip, so that it never meets them anew. No light is drawn from curves. */
#include "shape/shape.h"

#include <string.h>

enum { BEZIER, BSPLINE };
enum { FLAT, RIBBON, CYLINDER };
enum { MAX_SEGMENTS = 1 << 27, MAX_CHORDS_LOG2 = 10 };

#define C struct sr_shape_curves
static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "width", "m", 0, INFINITY, 1, offsetof(C, one.width), "width"},
    {SR_PARAM_FLOAT, "width0", "m", 0, INFINITY, NAN, offsetof(C, one.width0), "width at the start, instead of width"},
    {SR_PARAM_FLOAT, "width1", "m", 0, INFINITY, NAN, offsetof(C, one.width1), "width at the end, instead of width"},
    {SR_PARAM_INT, "degree", "1", 2, 3, 3, offsetof(C, one.degree), "degree of the curve"},
    {SR_PARAM_ENUM, "basis", "1", 0, 1, BEZIER, offsetof(C, one.basis), "bezier|bspline"},
    {SR_PARAM_POINT3S, "P", "m", -INFINITY, INFINITY, NAN, offsetof(C, one.P),
     "control points: degree + 1, and for each further segment degree (bezier) or one (bspline)"},
    {SR_PARAM_ENUM, "type", "1", 0, 2, FLAT, offsetof(C, one.type), "flat|ribbon|cylinder"},
    {SR_PARAM_NORMAL3S, "N", "1", -INFINITY, INFINITY, NAN, offsetof(C, one.N),
     "normals at the segments' ends, of ribbons"},
    {SR_PARAM_INT, "splitdepth", "1", 0, 10, 3, offsetof(C, one.split_depth), "at most 2^splitdepth boxes a segment"},
    {0},
};
#undef C

struct sr_shape_curve_segment {
    sr_vec3 a[4];     // [m] of the powers of u
    float width0, dh; // [m] width at u = 0, and how much more it is at u = 1
    float bend;       // [m] of c: over du it strays from its chord by no more than bend du^2
};
struct ribbon_normals {
    sr_vec3 n[2]; // [1]
};

static sr_vec3 larger3(sr_vec3 a, sr_vec3 b) // of the absolute values
{
    return (sr_vec3){sr_max(fabsf(a.x), fabsf(b.x)), sr_max(fabsf(a.y), fabsf(b.y)), sr_max(fabsf(a.z), fabsf(b.z))};
}

/* ---- from control points to segments ---- */

uint32_t sr_shape_curve_segments(const struct sr_shape_curve *c, struct sr_error *error)
{
    uint32_t n = c->P.count, degree = (uint32_t)c->degree;
    bool is_bezier = c->basis == BEZIER;
    uint32_t segments = n < degree + 1 ? 0 : is_bezier ? (n - 1) / degree : n - degree;
    if (segments == 0 || (is_bezier && (n - 1) % degree != 0)) {
        sr_fail(error, SR_ERROR_INPUT, "curve: %u \"P\", expected %u%s of degree %u", n, degree + 1,
                is_bezier ? (degree == 2 ? " or 2 more for each further Bézier segment"
                                         : " or 3 more for each further Bézier segment")
                          : " or more for a B-spline",
                degree);
        return 0;
    }
    if (c->type == RIBBON && c->N.count != segments + 1) {
        sr_fail(error, SR_ERROR_INPUT, "curve: %u \"N\", expected %u, one at each end of the %u segments of a ribbon",
                c->N.count, segments + 1, segments);
        return 0;
    }
    const float *p = c->P.data, *normals = c->N.data;
    bool is_finite = isfinite(c->width) && !isinf(c->width0) && !isinf(c->width1);
    for (uint32_t i = 0; i < 3 * n; ++i)
        is_finite &= isfinite(p[i]) != 0;
    for (uint32_t i = 0; c->type == RIBBON && i < 3 * c->N.count; ++i)
        is_finite &= isfinite(normals[i]) != 0;
    for (uint32_t i = 0; c->type == RIBBON && i < c->N.count; ++i)
        is_finite &= sr_length2(((const sr_vec3 *)c->N.data)[i]) > 0;
    if (!is_finite) {
        sr_fail(error, SR_ERROR_INPUT,
                "curve: \"P\" and widths must be finite numbers, and so must \"N\", of which none is 0");
        return 0;
    }
    return segments;
}

static sr_vec3 combine(const sr_vec3 *p, int n, const float *w)
{
    sr_vec3 r = {0, 0, 0};
    for (int i = 0; i < n; ++i)
        r = sr_mad(r, w[i], p[i]);
    return r;
}

/* Coefficients of the powers of u, one row each, of the control points. */
static void powers(const struct sr_shape_curve *c, const sr_vec3 *p, sr_vec3 a[4])
{
    static const float sixth = 1.0f / 6;
    static const float cubic[2][4][4] = {
        {{1, 0, 0, 0}, {-3, 3, 0, 0}, {3, -6, 3, 0}, {-1, 3, -3, 1}},
        {{sixth, 4 * sixth, sixth, 0}, {-0.5f, 0, 0.5f, 0}, {0.5f, -1, 0.5f, 0}, {-sixth, 0.5f, -0.5f, sixth}}};
    static const float quadratic[2][3][3] = {{{1, 0, 0}, {-2, 2, 0}, {1, -2, 1}},
                                             {{0.5f, 0.5f, 0}, {-1, 1, 0}, {0.5f, -1, 0.5f}}};
    a[3] = (sr_vec3){0, 0, 0};
    for (int k = 0; k <= c->degree; ++k)
        a[k] = combine(p, c->degree + 1, c->degree == 3 ? cubic[c->basis][k] : quadratic[c->basis][k]);
}

static struct sr_shape_curve_segment segment_of(const struct sr_shape_curve *c, uint32_t i, uint32_t segments)
{
    struct sr_shape_curve_segment s;
    float width0 = isnan(c->width0) ? c->width : c->width0, width1 = isnan(c->width1) ? c->width : c->width1;
    uint32_t first = c->basis == BEZIER ? i * (uint32_t)c->degree : i;
    powers(c, (const sr_vec3 *)c->P.data + first, s.a);
    float start = sr_lerp((float)i / (float)segments, width0, width1),
          end = sr_lerp((float)(i + 1) / (float)segments, width0, width1);
    s.width0 = start;
    s.dh = end - start;
    s.bend = 0.2501f * sqrtf(sr_max(sr_length2(s.a[2]), sr_length2(sr_mad(s.a[2], 3, s.a[3])))); // |c''| / 8
    return s;
}

static sr_vec3 centre_at(const sr_vec3 a[4], float u)
{
    return sr_mad(a[0], u, sr_mad(a[1], u, sr_mad(a[2], u, a[3])));
}
static sr_vec3 tangent_at(const sr_vec3 a[4], float u)
{
    return sr_mad(a[1], u, sr_mad(sr_scale(2, a[2]), u, sr_scale(3, a[3])));
}

static sr_vec3 bend_at(const sr_vec3 a[4], float u)
{
    return sr_mad(sr_scale(2, a[2]), 6 * u, a[3]);
}

/* ---- pieces: what has a box of its own ---- */

struct piece {
    const struct sr_shape_curve_segment *segment;
    uint32_t index; // of the segment
    float u0, u1;
};

static struct piece piece_of(const struct sr_shape_curves *m, uint32_t primitive)
{
    uint32_t index = primitive >> m->split, part = primitive & ((1u << m->split) - 1);
    float du = 1 / (float)(1u << m->split);
    return (struct piece){&m->segments[index], index, du * (float)part, du * (float)(part + 1)};
}

static struct sr_box box_of(const struct sr_shape_curves *m, const struct piece *p)
{
    const struct sr_shape_curve_segment *s = p->segment;
    float third = (p->u1 - p->u0) / 3;
    sr_vec3 start = centre_at(s->a, p->u0), end = centre_at(s->a, p->u1);
    struct sr_box b = sr_box_add(sr_box_add(sr_box_empty(), start), end);
    b = sr_box_add(sr_box_add(b, sr_mad(start, third, tangent_at(s->a, p->u0))),
                   sr_mad(end, -third, tangent_at(s->a, p->u1)));
    float half = 0.5f * sr_max(s->width0 + p->u0 * s->dh, s->width0 + p->u1 * s->dh);
    float largest = sr_max_component(larger3(b.lo, b.hi));
    half += 8 * SR_MACHINE_EPSILON * (largest + half) + 1e-37f;
    b.lo = sr_sub(b.lo, (sr_vec3){half, half, half});
    b.hi = sr_add(b.hi, (sr_vec3){half, half, half});
    return m->is_here ? b : sr_box_transform(&m->object_to_world, b);
}

/* As many halvings as make the boxes much smaller: those of slanted hairs shrink, those along an axis do not. */
static uint32_t choose_split(struct sr_shape_curves *m, int32_t most)
{
    enum { looked_at = 512 };
    uint32_t step = m->count / looked_at + 1;
    double before = INFINITY;
    for (m->split = 0;; ++m->split) {
        double surface = 0;
        for (uint32_t i = 0; i < m->count; i += step)
            for (uint32_t k = 0; k < 1u << m->split; ++k) {
                struct piece p = piece_of(m, (i << m->split) + k);
                sr_vec3 e = sr_box_diagonal(box_of(m, &p));
                surface += (double)e.x * (double)e.y + (double)e.y * (double)e.z + (double)e.z * (double)e.x;
            }
        if (surface > 0.7 * before)
            return m->split - 1;
        if (m->split == (uint32_t)most || m->count >= 1u << (30 - m->split))
            return m->split;
        before = surface;
    }
}

/* ---- making ---- */

/* Whether the transform keeps shapes and handedness: then all may live in the world. */
static bool is_similarity(const struct sr_transform *t, float *scale)
{
    const float(*m)[4] = t->m;
    sr_vec3 c[3];
    for (int i = 0; i < 3; ++i)
        c[i] = (sr_vec3){m[0][i], m[1][i], m[2][i]};
    float l2 = sr_dot(c[0], c[0]), tolerance = 1e-5f * l2;
    *scale = sqrtf(l2);
    return m[3][0] == 0 && m[3][1] == 0 && m[3][2] == 0 && m[3][3] == 1 && !sr_transform_swaps_handedness(t) &&
           fabsf(sr_dot(c[1], c[1]) - l2) <= tolerance && fabsf(sr_dot(c[2], c[2]) - l2) <= tolerance &&
           fabsf(sr_dot(c[0], c[1])) <= tolerance && fabsf(sr_dot(c[1], c[2])) <= tolerance &&
           fabsf(sr_dot(c[2], c[0])) <= tolerance;
}

static void place(struct sr_shape_curves *m, struct sr_shape_curve_segment *s, struct ribbon_normals *normals)
{
    const struct sr_transform *t = &m->object_to_world;
    float scale;
    m->is_here = is_similarity(t, &scale);
    if (!m->is_here)
        return;
    for (uint32_t i = 0; i < m->count; ++i) {
        s[i].a[0] = sr_transform_point(t, s[i].a[0]);
        for (int k = 1; k < 4; ++k)
            s[i].a[k] = sr_transform_vector(t, s[i].a[k]);
        s[i].width0 *= scale;
        s[i].dh *= scale;
        s[i].bend *= 1.0001f * scale;
        for (int k = 0; normals && k < 2; ++k)
            normals[i].n[k] = sr_normalize(sr_transform_vector(t, normals[i].n[k]));
    }
}

sr_status sr_shape_curves_make(const struct sr_shape_curve *curves, uint32_t count,
                               const struct sr_shape_placement *placement, struct sr_arena *arena,
                               struct sr_shape_curves *out, struct sr_error *error)
{
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t n = sr_shape_curve_segments(&curves[i], error);
        if (n == 0)
            return error->status;
        total += n;
    }
    if (total > MAX_SEGMENTS)
        return sr_fail(error, SR_ERROR_INPUT, "curve: %llu segments, expected at most %d", (unsigned long long)total,
                       MAX_SEGMENTS);
    if (!sr_transform_is_valid(&placement->object_to_world))
        return sr_fail(error, SR_ERROR_INPUT, "curve: the transform must be finite and invertible");
    bool is_ribbon = curves[0].type == RIBBON;
    struct sr_shape_curve_segment *s = sr_arena_alloc(arena, total * sizeof *s);
    struct ribbon_normals *normals = is_ribbon ? sr_arena_alloc(arena, total * sizeof *normals) : NULL;
    if (!s || (is_ribbon && !normals))
        return sr_fail(error, SR_ERROR_RESOURCE, "curve: no memory for %llu segments", (unsigned long long)total);
    uint32_t at = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t n = sr_shape_curve_segments(&curves[i], error);
        const sr_vec3 *N = curves[i].N.data;
        for (uint32_t k = 0; k < n; ++k, ++at) {
            s[at] = segment_of(&curves[i], k, n);
            for (uint32_t end = 0; is_ribbon && end < 2; ++end)
                normals[at].n[end] = sr_normalize(N[k + end]);
        }
    }
    out->type = curves[0].type;
    out->count = at;
    out->segments = s;
    out->normals = normals;
    out->object_to_world = placement->object_to_world;
    out->flip_normals = placement->reverse_orientation != sr_transform_swaps_handedness(&placement->object_to_world);
    place(out, s, normals);
    out->split = choose_split(out, curves[0].split_depth);
    return SR_OK;
}

static sr_status prepare(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error)
{
    struct sr_shape_curves *m = self;
    struct sr_shape_curve one = m->one;
    return sr_shape_curves_make(&one, 1, placement, arena, m, error);
}

/* ---- answers ---- */

static uint32_t primitive_count(const void *self)
{
    const struct sr_shape_curves *m = self;
    return m->count << m->split;
}

static struct sr_box bounds(const void *self, uint32_t primitive)
{
    struct piece p = piece_of(self, primitive);
    return box_of(self, &p);
}

/* Of the strip as it looks from the side, length times width; unequal scales count by their mean. */
static float area(const void *self, uint32_t primitive)
{
    const struct sr_shape_curves *m = self;
    struct piece p = piece_of(m, primitive);
    const float(*k)[4] = m->object_to_world.m;
    sr_vec3 x = {k[0][0], k[1][0], k[2][0]}, y = {k[0][1], k[1][1], k[2][1]}, z = {k[0][2], k[1][2], k[2][2]};
    double scale = cbrt(fabs((double)sr_dot(x, sr_cross(y, z))));
    double sum = 0;
    for (int i = 0; i < 3; ++i) { // by Simpson's rule
        float u = sr_lerp(0.5f * (float)i, p.u0, p.u1);
        sr_vec3 t = tangent_at(p.segment->a, u);
        double h = (double)(p.segment->width0 + u * p.segment->dh);
        if (!m->is_here) {
            t = sr_transform_vector(&m->object_to_world, t);
            h *= scale;
        }
        sum += (i == 1 ? 4 : 1) * (double)sr_length(t) * h;
    }
    return (float)(sum * (double)(p.u1 - p.u0) / 6);
}

/* A ribbon's normal at u, not of unit length where the ends' are opposite. */
static sr_vec3 ribbon_normal(const struct ribbon_normals *r, float u)
{
    sr_vec3 a = r->n[0], b = r->n[1], sum = sr_add(a, b), difference = sr_sub(b, a);
    float half = sr_dot(a, b) < 0 ? SR_PI / 2 - asinf(sr_min(1, sr_length(sum) / 2))
                                  : asinf(sr_min(1, sr_length(difference) / 2));
    float angle = 2 * half;
    if (angle == 0)
        return a;
    float inverse = 1 / sinf(angle);
    return sr_add(sr_scale(sinf((1 - u) * angle) * inverse, a), sr_scale(sinf(u * angle) * inverse, b));
}

static float width_at(const struct sr_shape_curves *m, const struct piece *p, float u, sr_vec3 d, sr_vec3 *n)
{
    float h = p->segment->width0 + u * p->segment->dh;
    if (m->type != RIBBON)
        return h;
    *n = ribbon_normal(&((const struct ribbon_normals *)m->normals)[p->index], u);
    return h * fabsf(sr_dot(*n, d));
}

/* A segment as the ray sees it: x along the chord's projection, y across, z along the ray, which is the line x = y = 0.
 */
struct view {
    sr_vec3 a[4];
    sr_vec3 d; // [1] unit
};

static void look(const struct sr_shape_curve_segment *s, sr_vec3 o, sr_vec3 z, sr_vec3 across, struct view *v)
{
    float l2 = sr_length2(across);
    sr_vec3 y = l2 > 1e-30f ? sr_scale(1 / sqrtf(l2), across) : sr_frame_from_z(z).y;
    sr_vec3 x = sr_cross(y, z), q = sr_sub(s->a[0], o);
    v->d = z;
    v->a[0] = (sr_vec3){sr_dot(q, x), sr_dot(q, y), sr_dot(q, z)};
    for (int k = 1; k < 4; ++k)
        v->a[k] = (sr_vec3){sr_dot(s->a[k], x), sr_dot(s->a[k], y), sr_dot(s->a[k], z)};
}

static bool is_off(float a, float b, float c, float d, float half)
{
    return sr_min(sr_min(a, b), sr_min(c, d)) > half || sr_max(sr_max(a, b), sr_max(c, d)) < -half;
}

/* How many halvings make the chords of a piece straight enough. */
static int chords_log2(const sr_vec3 a[4], float du, float half)
{
    // second differences of the Bezier control points
    sr_vec3 at_start = a[2], at_end = sr_mad(a[2], 3, a[3]);
    float most = sr_max_component(larger3(at_start, at_end)) / 3 * du * du;
    float ratio = 1.0606602f * most / (0.1f * half); // 6 sqrt(2) / 8
    int k = 0;
    for (; ratio >= 4 && k < MAX_CHORDS_LOG2; ratio /= 4)
        ++k;
    return k;
}

struct meeting {
    float u, v, z; // [1] [1] [m]
};

static float dot2(sr_vec3 a, sr_vec3 b)
{
    return a.x * b.x + a.y * b.y;
}

/* Where c seen along the ray is nearest to it, between the perpendiculars at both ends of a chord. */
static bool meet_chord(const struct sr_shape_curves *m, const struct piece *piece, const struct view *view, float u0,
                       float u1, sr_vec3 p0, sr_vec3 p1, struct meeting *x)
{
    sr_vec3 chord = sr_sub(p1, p0);
    float l2 = dot2(chord, chord);
    if (!(l2 > 0))
        return false;
    float u = sr_lerp(sr_clamp(-dot2(p0, chord) / l2, 0, 1), u0, u1);
    sr_vec3 p = centre_at(view->a, u), t = tangent_at(view->a, u), n;
    for (int i = 0; i < 2; ++i) { // Newton's steps toward p . t = 0
        float t2 = dot2(t, t), slope = sr_max(t2 + dot2(p, bend_at(view->a, u)), 0.25f * t2);
        if (!(slope > 0))
            break;
        u = sr_clamp(u - dot2(p, t) / slope, u0, u1);
        p = centre_at(view->a, u);
        t = tangent_at(view->a, u);
    }
    float h = width_at(m, piece, u, view->d, &n), distance2 = dot2(p, p);
    if (!(distance2 <= 0.25f * h * h) || !(h > 0))
        return false;
    float side = t.x * -p.y + p.x * t.y; // of the ray, toward b = d x c'
    *x = (struct meeting){u, 0.5f + copysignf(sqrtf(distance2) / h, side), p.z};
    return true;
}

static bool intersect(const void *self, uint32_t primitive, sr_vec3 o, sr_vec3 d, float t_min, float t_max, float *t,
                      sr_vec2 *hit)
{
    const struct sr_shape_curves *m = self;
    struct piece piece = piece_of(m, primitive);
    if (!m->is_here) {
        o = sr_inverse_point(&m->object_to_world, o);
        d = sr_inverse_vector(&m->object_to_world, d);
    }
    float length = sr_length(d), half = 0.5f * sr_max(piece.segment->width0 + piece.u0 * piece.segment->dh,
                                                      piece.segment->width0 + piece.u1 * piece.segment->dh);
    if (!(length > 0 && half > 0))
        return false;
    // most rays that come here pass further from the chord's line than the strip reaches
    float du = piece.u1 - piece.u0;
    sr_vec3 z = sr_scale(1 / length, d), start = centre_at(piece.segment->a, piece.u0), q = sr_sub(start, o);
    sr_vec3 across = sr_cross(z, sr_sub(centre_at(piece.segment->a, piece.u1), start));
    float reach =
        half + piece.segment->bend * du * du + 8 * SR_MACHINE_EPSILON * (fabsf(q.x) + fabsf(q.y) + fabsf(q.z));
    if (sr_sqr(sr_dot(q, across)) > reach * reach * sr_length2(across))
        return false;
    struct view view;
    look(piece.segment, o, z, across, &view);
    int halvings = chords_log2(view.a, du, half);
    du /= (float)(1 << halvings);
    float u0 = piece.u0;
    sr_vec3 p0 = centre_at(view.a, u0), t0 = tangent_at(view.a, u0);
    bool found = false;
    for (int i = 1; i <= 1 << halvings; ++i) {
        float u1 = i == 1 << halvings ? piece.u1 : piece.u0 + du * (float)i;
        sr_vec3 p1 = centre_at(view.a, u1), t1 = tangent_at(view.a, u1);
        sr_vec3 q0 = sr_mad(p0, du / 3, t0), q1 = sr_mad(p1, -du / 3, t1);
        struct meeting x;
        if (!is_off(p0.y, q0.y, q1.y, p1.y, half) && !is_off(p0.x, q0.x, q1.x, p1.x, half) && dot2(p0, t0) <= 0 &&
            dot2(p1, t1) >= 0 && meet_chord(m, &piece, &view, u0, u1, p0, p1, &x) && x.z > t_min * length &&
            x.z < t_max * length) {
            t_max = *t = x.z / length;
            *hit = (sr_vec2){x.u, x.v};
            found = true;
        }
        u0 = u1;
        p0 = p1;
        t0 = t1;
    }
    return found;
}

static sr_vec3 unit_across(sr_vec3 d, sr_vec3 tangent)
{
    sr_vec3 b = sr_cross(d, tangent);
    float l2 = sr_length2(b);
    return l2 > 1e-30f ? sr_scale(1 / sqrtf(l2), b) : sr_frame_from_z(d).y;
}

static void seen_point(const void *self, uint32_t primitive, sr_vec2 hit, sr_vec3 d, struct sr_point *x)
{
    const struct sr_shape_curves *m = self;
    struct piece piece = piece_of(m, primitive);
    const struct sr_transform *to_world = &m->object_to_world;
    if (!m->is_here)
        d = sr_inverse_vector(to_world, d);
    d = sr_normalize(d);
    sr_vec3 tangent = tangent_at(piece.segment->a, hit.x), n = {0, 0, 0}; // n: of ribbons
    if (!(sr_length2(tangent) > 0))
        tangent = sr_add(sr_add(piece.segment->a[1], piece.segment->a[2]), piece.segment->a[3]);
    float h = width_at(m, &piece, hit.x, d, &n), whole = piece.segment->width0 + hit.x * piece.segment->dh;
    sr_vec3 b = unit_across(d, tangent), along = sr_normalize(tangent), across = b;
    x->p = sr_mad(centre_at(piece.segment->a, hit.x), (hit.y - 0.5f) * h, b);
    if (m->type == RIBBON) {
        across = unit_across(n, along);
    } else if (m->type == CYLINDER) {
        float angle = SR_PI * (hit.y - 0.5f);
        across = sr_mad(sr_scale(cosf(angle), b), -sinf(angle), sr_cross(along, b));
    }
    sr_vec3 e = larger3(x->p, x->p), plane = sr_cross(along, across);
    x->p_error = sr_mad((sr_vec3){whole, whole, whole}, 8 * SR_MACHINE_EPSILON, e);
    x->n = sr_normalize(m->flip_normals ? sr_neg(plane) : plane);
    x->dpdu = tangent;
    x->dpdv = sr_scale(h, across);
    if (!m->is_here) {
        sr_vec3 error;
        x->p = sr_transform_point_error(to_world, x->p, x->p_error, &error);
        x->p_error = error;
        x->n = sr_normalize(sr_transform_normal(to_world, x->n));
        x->dpdu = sr_transform_vector(to_world, x->dpdu);
        x->dpdv = sr_transform_vector(to_world, x->dpdv);
    }
    x->ns = x->n;
    x->dpdus = x->dpdu;
    x->dndu = x->dndv = (sr_vec3){0, 0, 0};
    x->uv = hit;
    x->face = 0;
}

static sr_vec2 uv(const void *self, uint32_t primitive, sr_vec2 hit)
{
    (void)self;
    (void)primitive;
    return hit;
}

static void normals(const void *self, uint32_t primitive, sr_vec3 *axis, float *cos_theta)
{
    (void)self;
    (void)primitive;
    *axis = (sr_vec3){0, 0, 1};
    *cos_theta = -1;
}

const struct sr_shape_model sr_shape_curve = {
    .name = "curve",
    .params = params,
    .size = sizeof(struct sr_shape_curves),
    .prepare = prepare,
    .primitive_count = primitive_count,
    .bounds = bounds,
    .area = area,
    .intersect = intersect,
    .seen_point = seen_point,
    .uv = uv,
    .normals = normals,
};
