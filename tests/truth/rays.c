/* SPDX-License-Identifier: MIT */
/* Scenes of one surface, made by calls, so that coordinates are what they are said to be, and rays that know their
 * answer. */
#include "truth/rays.h"

#include <string.h>

const char *const body_names[BODIES] = {"ball", "spikes", "cube"};
const char *const aim_names[AIMS] = {"anywhere",     "at vertices", "at edges", "along axes", "along axes at vertices",
                                     "within planes"};
const char *const convex_names[CONVEXES] = {"sphere",    "disk",   "cylinder",         "patch",
                                            "triangles", "ribbon", "ball of triangles"};

static const struct sr_material *grey(struct sr_scene *scene)
{
    struct sr_arena *arena = sr_scene_arena(scene);
    const struct sr_material_model *model = sr_material_model_find("diffuse");
    void *self = sr_arena_alloc(arena, model->size); // never looked at
    struct sr_material *material = sr_arena_alloc(arena, sizeof *material);
    *material = (struct sr_material){.model = model, .self = self};
    return material;
}

static void place(struct sr_scene *scene, struct sr_shape shape, bool is_instance, const struct sr_transform *turn)
{
    struct sr_shape_def def = {.shape = shape, .material = grey(scene)};
    if (is_instance) {
        def.object = sr_scene_add_object(scene);
        sr_scene_add_instance(scene, def.object, turn);
    }
    sr_scene_add_shape(scene, &def);
    if (sr_scene_finish(scene, 1, 0) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", sr_scene_error(scene)->text);
}

static struct sr_shape mesh_shape(struct sr_scene *scene, const sr_vec3 *P, uint32_t vertices, const int32_t *indices,
                                  uint32_t triangles)
{
    struct sr_shape_mesh *m = sr_arena_alloc(sr_scene_arena(scene), sizeof *m);
    *m = (struct sr_shape_mesh){.indices = {indices, 3 * triangles}, .P = {P, vertices}};
    struct sr_shape_placement placement = {sr_transform_identity(), false};
    if (sr_shape_trianglemesh.prepare(m, &placement, sr_scene_arena(scene), sr_scene_error(scene)) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", sr_scene_error(scene)->text);
    return (struct sr_shape){&sr_shape_trianglemesh, m};
}

/* A globe's mesh: rings of 2 rings vertices, one vertex at each pole; radius_of of a vertex. */
static void globe(struct closed_mesh *m, struct sr_arena *arena, int rings, bool has_spikes)
{
    int round = 2 * rings;
    m->vertices = (uint32_t)((rings - 1) * round + 2);
    m->triangles = (uint32_t)(2 * round * (rings - 1));
    sr_vec3 *P = sr_arena_alloc(arena, m->vertices * sizeof *P);
    int32_t *t = sr_arena_alloc(arena, 3 * m->triangles * sizeof *t);
    struct sr_rng rng = sr_rng_seed(5, 0);
    int north = (int)m->vertices - 2, south = north + 1;
    for (int v = 0; v < (int)m->vertices; ++v) {
        double theta = v == north   ? 0
                       : v == south ? M_PI
                                    : M_PI * (1 + v / round) / rings,
               phi = M_PI * (v % round) / rings;
        double r = m->radius * (has_spikes ? 0.7 + 0.3 * (double)sr_rng_float(&rng) : 1),
               s = v >= north ? 0 : sin(theta);
        P[v] = (sr_vec3){(float)(m->centre + r * s * cos(phi)), (float)(m->centre + r * s * sin(phi)),
                         (float)(m->centre + r * cos(theta))};
    }
    int n = 0;
    for (int i = 0; i < rings; ++i)
        for (int k = 0; k < round; ++k) {
            int a = (i - 1) * round + k, b = (i - 1) * round + (k + 1) % round, c = a + round, d = b + round;
            if (i > 0)
                memcpy(&t[n], (int32_t[]){a, i == rings - 1 ? south : d, b}, 3 * sizeof *t), n += 3;
            if (i < rings - 1)
                memcpy(&t[n], (int32_t[]){i == 0 ? north : a, c, d}, 3 * sizeof *t), n += 3;
        }
    m->P = P;
    m->indices = t;
}

static void cube(struct closed_mesh *m, struct sr_arena *arena)
{
    static const int32_t corners[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    m->vertices = 8;
    m->triangles = 12;
    sr_vec3 *P = sr_arena_alloc(arena, 8 * sizeof *P);
    for (int i = 0; i < 8; ++i)
        P[i] = (sr_vec3){(float)(m->centre + (i & 1 ? m->radius : -m->radius)),
                         (float)(m->centre + (i & 2 ? m->radius : -m->radius)),
                         (float)(m->centre + (i & 4 ? m->radius : -m->radius))};
    m->P = P;
    m->indices = corners;
}

struct closed_mesh make_closed_mesh(enum body body, int rings, double radius, double offset, bool is_instance)
{
    struct closed_mesh m = {.scene = sr_scene_create(), .centre = is_instance ? 0 : offset * radius, .radius = radius};
    struct sr_arena *arena = sr_scene_arena(m.scene);
    if (body == BODY_CUBE)
        cube(&m, arena);
    else
        globe(&m, arena, rings, body == BODY_SPIKES);
    float c = (float)(offset * radius);
    struct sr_transform turn = sr_transform_rotate(33, (sr_vec3){1, 2, 3}),
                        away = sr_transform_translate((sr_vec3){c, c, c}),
                        to_world = sr_transform_multiply(&away, &turn);
    place(m.scene, mesh_shape(m.scene, m.P, m.vertices, m.indices, m.triangles), is_instance, &to_world);
    if (is_instance) {
        sr_vec3 *P = sr_arena_alloc(arena, m.vertices * sizeof *P);
        for (uint32_t i = 0; i < m.vertices; ++i)
            P[i] = sr_transform_point(&to_world, m.P[i]);
        m.P = P;
        m.centre = offset * radius;
    }
    return m;
}

void free_closed_mesh(struct closed_mesh *m)
{
    sr_scene_destroy(m->scene);
}

static uint32_t pick(struct sr_rng *rng, uint32_t n)
{
    uint32_t i = (uint32_t)(sr_rng_float(rng) * (float)n);
    return i < n ? i : n - 1;
}

static float signed_zero(struct sr_rng *rng)
{
    return sr_rng_float(rng) < 0.5f ? 0.0f : -0.0f;
}

struct leaks cast_from_inside(const struct closed_mesh *m, enum aim aim, uint64_t begin, uint64_t end)
{
    struct leaks out = {.rays = end - begin};
    float c = (float)m->centre, R = (float)m->radius;
    for (uint64_t i = begin; i < end; ++i) {
        struct sr_rng rng = sr_rng_seed(i, (uint64_t)aim + 1);
        sr_vec3 in = sr_scale(R * 0.4f * sr_rng_float(&rng),
                              sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}));
        sr_vec3 o = sr_add((sr_vec3){c, c, c}, in), d;
        uint32_t t = pick(&rng, m->triangles), k = pick(&rng, 3);
        sr_vec3 a = m->P[m->indices[3 * t + k]], b = m->P[m->indices[3 * t + (k + 1) % 3]];
        switch (aim) {
        case AIM_VERTEX:
        case AIM_EDGE:
            d = sr_sub(aim == AIM_VERTEX ? a : sr_mad(a, sr_rng_float(&rng), sr_sub(b, a)), o);
            if (!(sr_length2(d) > 0)) // they fell together, far from the origin
                d = (sr_vec3){1, 0, 0};
            if (i & 1)
                d = sr_normalize(d);
            break;
        case AIM_AXIS:
        case AIM_AXIS_VERTEX: { // from where it looks straight along an axis at the vertex, if that is near the middle
            uint32_t axis = pick(&rng, 3);
            float way = sr_rng_float(&rng) < 0.5f ? 1.0f : -1.0f;
            d = (sr_vec3){signed_zero(&rng), signed_zero(&rng), signed_zero(&rng)};
            (&d.x)[axis] = way;
            if (aim == AIM_AXIS_VERTEX) {
                sr_vec3 from = a;
                (&from.x)[axis] = (&o.x)[axis];
                float x = from.x - c, y = from.y - c, z = from.z - c;
                if (x * x + y * y + z * z < 0.2f * R * R)
                    o = from;
            }
            break;
        }
        case AIM_PLANE: {
            uint32_t axis = pick(&rng, 3);
            float phi = 2 * SR_PI * sr_rng_float(&rng);
            (&d.x)[axis] = signed_zero(&rng);
            (&d.x)[(axis + 1) % 3] = cosf(phi);
            (&d.x)[(axis + 2) % 3] = sinf(phi);
            break;
        }
        default:
            d = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        }
        struct sr_ray ray = {.o = o, .d = d, .t_max = INFINITY};
        struct sr_hit hit;
        bool leaks = !sr_raycast_bare(m->scene, &ray, &hit), shadow_leaks = i % 8 == 0 && sr_is_free(m->scene, &ray);
        if (i % 8 == 1) { // to a place outside
            ray.t_max = 4 * R / sr_length(d);
            shadow_leaks = sr_is_free(m->scene, &ray);
        }
        out.leaks += leaks;
        out.shadows += shadow_leaks;
        if (leaks || shadow_leaks)
            out.last = i;
    }
    return out;
}

/* ---- surfaces that see nothing of themselves ---- */

static void *keep(struct sr_arena *arena, const void *self, size_t size)
{
    return sr_arena_copy(arena, self, size);
}

static struct sr_shape convex_shape(struct sr_scene *scene, enum convex kind)
{
    static const sr_vec3 square[4] = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}},
                         line[4] = {{-1.5f, -1, 0}, {-0.5f, -0.4f, 0}, {0.5f, 0.3f, 0}, {1.5f, 0.9f, 0}},
                         up[2] = {{0, 0, 1}, {0, 0, 1}};
    static const int32_t halves[6] = {0, 1, 3, 0, 3, 2}, whole[4] = {0, 1, 2, 3};
    struct sr_arena *arena = sr_scene_arena(scene);
    switch (kind) {
    case CONVEX_DISK: {
        struct sr_shape_disk disk = {.radius = 1, .phi_max = 360};
        return (struct sr_shape){&sr_shape_disk, keep(arena, &disk, sizeof disk)};
    }
    case CONVEX_CYLINDER: {
        struct sr_shape_cylinder cylinder = {.radius = 1, .z_min = -1, .z_max = 1, .phi_max = 360};
        return (struct sr_shape){&sr_shape_cylinder, keep(arena, &cylinder, sizeof cylinder)};
    }
    case CONVEX_PATCH: {
        struct sr_shape_patches patches = {.indices = {whole, 4}, .P = {square, 4}};
        return (struct sr_shape){&sr_shape_bilinearmesh, keep(arena, &patches, sizeof patches)};
    }
    case CONVEX_TRIANGLES: {
        struct sr_shape_mesh mesh = {.indices = {halves, 6}, .P = {square, 4}};
        return (struct sr_shape){&sr_shape_trianglemesh, keep(arena, &mesh, sizeof mesh)};
    }
    case CONVEX_BALL: {
        struct closed_mesh ball = {.radius = 1};
        globe(&ball, arena, 12, false);
        struct sr_shape_mesh mesh = {.indices = {ball.indices, 3 * ball.triangles}, .P = {ball.P, ball.vertices}};
        return (struct sr_shape){&sr_shape_trianglemesh, keep(arena, &mesh, sizeof mesh)};
    }
    case CONVEX_RIBBON: {
        struct sr_shape_curves curves = {.one = {.width = 1,
                                                 .width0 = NAN,
                                                 .width1 = NAN,
                                                 .degree = 3,
                                                 .type = 1,
                                                 .split_depth = 3,
                                                 .P = {line, 4},
                                                 .N = {up, 2}}};
        return (struct sr_shape){&sr_shape_curve, keep(arena, &curves, sizeof curves)};
    }
    default: {
        struct sr_shape_sphere sphere = {.radius = 1, .z_min = NAN, .z_max = NAN, .phi_max = 360};
        return (struct sr_shape){&sr_shape_sphere, keep(arena, &sphere, sizeof sphere)};
    }
    }
}

struct convex_surface make_convex(enum convex kind, double scale, bool is_instance)
{
    struct convex_surface s = {.scene = sr_scene_create(), .kind = kind, .scale = scale};
    struct sr_arena *arena = sr_scene_arena(s.scene);
    float f = (float)scale;
    struct sr_transform size = sr_transform_scale((sr_vec3){f, f, f}),
                        turn = sr_transform_rotate(33, (sr_vec3){1, 2, 3}),
                        turned = sr_transform_multiply(&turn, &size), one = sr_transform_identity();
    if (is_instance) { // small and large at once: an object of unit size
        struct sr_transform away = sr_transform_translate((sr_vec3){3 * f, -2 * f, f});
        turned = sr_transform_multiply(&away, &turned);
        s.centre = (sr_vec3){3 * f, -2 * f, f};
    }
    struct sr_shape_placement placement = {is_instance ? one : turned, false};
    struct sr_shape shape = convex_shape(s.scene, kind);
    if (shape.model->prepare((void *)(uintptr_t)shape.self, &placement, arena, sr_scene_error(s.scene)) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", sr_scene_error(s.scene)->text);
    place(s.scene, shape, is_instance, &turned);
    return s;
}

void free_convex(struct convex_surface *s)
{
    sr_scene_destroy(s->scene);
}

/* Cosines below this are left out: along a curved surface the normal's own rounding decides. */
#define LEAST_COSINE 1e-6f

struct self_hits leave_convex(const struct convex_surface *s, uint64_t begin, uint64_t end)
{
    struct self_hits out = {0};
    float f = (float)s->scale;
    for (uint64_t i = begin; i < end; ++i) {
        struct sr_rng rng = sr_rng_seed(i, 77);
        sr_vec3 from = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 at =
            sr_mad(s->centre, f * 0.6f, sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}));
        struct sr_ray ray = {.o = sr_mad(at, 5 * f, from), .d = sr_neg(from), .t_max = INFINITY};
        struct sr_hit hit, again;
        if (!(i & 1 ? sr_raycast(s->scene, &ray, &hit) : sr_raycast_bare(s->scene, &ray, &hit)))
            continue;
        bool is_inside = s->kind == CONVEX_CYLINDER && sr_dot(hit.point.n, from) < 0; // in through an end
        if (is_inside)
            continue;
        // several directions of one point
        for (int k = 0; k < 8; ++k) {
            sr_vec3 n = sr_face_forward(hit.point.n, from);
            struct sr_frame frame = sr_frame_from_z(n);
            sr_vec3 w = sr_warp_uniform_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
            if (k & 1) // near grazing
                w = (sr_vec3){w.x, w.y, w.z * w.z * w.z * w.z};
            w = sr_normalize(w);
            if (!(w.z > LEAST_COSINE))
                continue;
            struct sr_ray leaving = sr_leave(&hit.point, sr_to_world(&frame, w));
            ++out.rays;
            out.hits += k & 2 ? !sr_is_free(s->scene, &leaving) : sr_raycast(s->scene, &leaving, &again);
            if (s->kind == CONVEX_SPHERE || s->kind == CONVEX_BALL) {
                struct sr_ray entering = sr_leave(&hit.point, sr_to_world(&frame, (sr_vec3){w.x, w.y, -w.z}));
                ++out.inward;
                out.missed += !sr_raycast(s->scene, &entering, &again);
            }
        }
    }
    return out;
}

/* ---- floors ---- */

enum { FLOOR_FACE = 1, LID_FACE, OTHER_FACE, OTHERS = 2100 };

static void set_corners(struct tilted_floor *f, uint64_t number)
{
    static const sr_vec3 known[4] = {{-2.13123f, 0, 70.0611f},
                                     {-71.502f, -8.75425e-6f, -2.15457f},
                                     {0.713687f, 0, -71.5254f},
                                     {70.0845f, 8.75425e-6f, 0.690351f}};
    struct sr_rng rng = sr_rng_seed(number, 3);
    f->span = number == 0 ? 71 : pow(10, 4 * (double)sr_rng_float(&rng));
    f->is_needle = number % 4 == 3;
    bool is_level = number % 4 != 1;
    double width = f->is_needle ? pow(10, -3 * (double)sr_rng_float(&rng)) : 1,
           tilt = pow(10, -7 + 5 * (double)sr_rng_float(&rng)), shift = sr_rng_float(&rng) < 0.5f ? 0 : 0.5 * f->span,
           along = 2 * M_PI * (double)sr_rng_float(&rng), turn = 2 * M_PI * (double)sr_rng_float(&rng);
    for (int k = 0; k < 4; ++k) {
        double phi = M_PI / 2 * k + 0.3 * (double)sr_rng_float(&rng), x = f->span * cos(phi),
               z = f->span * width * sin(phi);
        double X = x * cos(along) - z * sin(along) + shift, Z = x * sin(along) + z * cos(along), Y = tilt * X;
        if (!is_level) {
            double Y0 = Y;
            Y = cos(turn) * Y0 - sin(turn) * X;
            X = sin(turn) * Y0 + cos(turn) * X;
        }
        f->corners[k] = number == 0 ? known[k] : (sr_vec3){(float)X, (float)Y, (float)Z};
    }
}

static sr_vec3 middle_of(const struct tilted_floor *f)
{
    return sr_scale(0.25f, sr_add(sr_add(f->corners[0], f->corners[1]), sr_add(f->corners[2], f->corners[3])));
}

static sr_vec3 up_of(const struct tilted_floor *f)
{
    sr_vec3 n = sr_normalize(sr_cross(sr_sub(f->corners[2], f->corners[0]), sr_sub(f->corners[3], f->corners[1])));
    return n.y < 0 ? sr_neg(n) : n;
}

struct tilted_floor make_floor(uint64_t number, bool is_paired, bool has_lid)
{
    struct tilted_floor f = {.scene = sr_scene_create(), .has_lid = has_lid};
    set_corners(&f, number);
    struct sr_arena *arena = sr_scene_arena(f.scene);
    uint32_t quads = 1 + has_lid + (is_paired ? OTHERS : 0);
    sr_vec3 *P = sr_arena_alloc(arena, 4 * quads * sizeof *P), *p = P, up = up_of(&f), middle = middle_of(&f);
    int32_t *t = sr_arena_alloc(arena, 6 * quads * sizeof *t),
            *faces = sr_arena_alloc(arena, 2 * quads * sizeof *faces);
    float d = (float)f.span;
    for (uint32_t q = 0; q < quads; ++q, p += 4) {
        bool is_floor = q == 0, is_lid = q == 1 && has_lid;
        uint32_t i = q % 50, k = q / 50;
        for (uint32_t c = 0; c < 4; ++c)
            p[c] = is_floor ? f.corners[c]
                   : is_lid ? sr_mad(sr_add(middle, sr_scale(0.9f, sr_sub(f.corners[c], middle))), 1e-5f * d, up)
                            : (sr_vec3){d * (0.02f * (float)i + (c == 1 || c == 2 ? 0.01f : 0)), -20 * d,
                                        d * (0.02f * (float)k + (c > 1 ? 0.01f : 0))};
        int32_t o = 4 * (int32_t)q, turn = (int32_t)((number + q) % 3); // any corner may be the first
        int32_t first[3] = {o, o + 1, o + 2}, second[3] = {o, o + 2, o + 3};
        for (int32_t c = 0; c < 3; ++c) {
            t[6 * q + (uint32_t)c] = first[(c + turn) % 3];
            t[6 * q + 3 + (uint32_t)c] = second[(c + turn) % 3];
        }
        faces[2 * q] = faces[2 * q + 1] = is_floor ? FLOOR_FACE : is_lid ? LID_FACE : OTHER_FACE;
    }
    struct sr_shape_mesh *m = sr_arena_alloc(arena, sizeof *m);
    *m = (struct sr_shape_mesh){.indices = {t, 6 * quads}, .P = {P, 4 * quads}, .face_indices = {faces, 2 * quads}};
    struct sr_shape_placement placement = {sr_transform_identity(), false};
    if (sr_shape_trianglemesh.prepare(m, &placement, arena, sr_scene_error(f.scene)) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", sr_scene_error(f.scene)->text);
    place(f.scene, (struct sr_shape){&sr_shape_trianglemesh, m}, false, NULL);
    EXPECT(m->pairs == (is_paired ? quads : 0));
    return f;
}

void free_floor(struct tilted_floor *f)
{
    sr_scene_destroy(f->scene);
}

struct self_hits leave_floor(const struct tilted_floor *f, uint64_t begin, uint64_t end)
{
    struct self_hits out = {0};
    sr_vec3 up = up_of(f), middle = middle_of(f);
    float d = (float)f->span;
    for (uint64_t i = begin; i < end; ++i) {
        struct sr_rng rng = sr_rng_seed(i, 11);
        // within the quad around the middle, so that what is looked for lies within the lid, too
        uint32_t k = pick(&rng, 4);
        sr_vec2 b = sr_warp_triangle((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 e = sr_sub(f->corners[k], middle), g = sr_sub(f->corners[(k + 1) % 4], middle),
                at = sr_mad(sr_mad(middle, 0.85f * b.x, e), 0.85f * b.y, g);
        bool is_below = i & 2;
        sr_vec3 from = sr_warp_uniform_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        struct sr_frame frame = sr_frame_from_z(is_below ? sr_neg(up) : up);
        from = sr_to_world(&frame, from);
        struct sr_ray ray = {.o = sr_mad(at, d, from), .d = sr_neg(from), .t_max = INFINITY};
        struct sr_hit hit, again;
        if (!sr_raycast(f->scene, &ray, &hit) || hit.point.face == OTHER_FACE)
            continue;
        int32_t face = hit.point.face;
        if (i & 1)
            sr_raycast_bare(f->scene, &ray, &hit);
        sr_vec3 n = sr_face_forward(hit.point.n, from);
        frame = sr_frame_from_z(n);
        for (int c = 0; c < 8; ++c) {
            float z = c & 1 ? sr_rng_float(&rng) : powf(10, -6 * sr_rng_float(&rng)), r = sqrtf(1 - z * z),
                  phi = 2 * SR_PI * sr_rng_float(&rng);
            struct sr_ray leaving =
                sr_leave(&hit.point, sr_to_world(&frame, (sr_vec3){r * cosf(phi), r * sinf(phi), z}));
            ++out.rays;
            out.hits += sr_raycast(f->scene, &leaving, &again) && again.point.face == face;
        }
        if (f->has_lid) {
            struct sr_ray through = sr_leave(&hit.point, sr_neg(n));
            ++out.inward;
            out.missed += !sr_raycast(f->scene, &through, &again) || again.point.face != LID_FACE + FLOOR_FACE - face;
        }
    }
    return out;
}
