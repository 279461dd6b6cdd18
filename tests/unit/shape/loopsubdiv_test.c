/* SPDX-License-Identifier: MIT */
/* Loop's subdivision: the limit of a vertex is the same whichever level it is told from, and known in closed form. */
#include "common.h"

#include <string.h>

static struct sr_shape_mesh *subdivide(const sr_vec3 *P, uint32_t vertices, const int32_t *indices, uint32_t corners,
                                       int levels)
{
    struct sr_shape_loopsubdiv *l = sr_arena_alloc(&test_arena, sizeof *l);
    *l = (struct sr_shape_loopsubdiv){
        .levels = levels, .unbiased = true, .indices = {indices, corners}, .P = {P, vertices}};
    PREPARE(sr_shape_loopsubdiv, l, here());
    return &l->mesh;
}

static void expect_same(sr_vec3 a, sr_vec3 b, double tolerance)
{
    EXPECT_NEAR((double)a.x, (double)b.x, tolerance);
    EXPECT_NEAR((double)a.y, (double)b.y, tolerance);
    EXPECT_NEAR((double)a.z, (double)b.z, tolerance);
}

static const sr_vec3 octahedron[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
static const int32_t octahedron_faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

TEST(loopsubdiv_octahedron_limit_by_closed_form)
{
    // n = 4: gamma = 1/8, the neighbours' sum is 0: p/2; an edge's middle after one step is (3/8 1/8) sums, then n = 6
    for (int levels = 0; levels < 5; ++levels) {
        const struct sr_shape_mesh *m = subdivide(octahedron, 6, octahedron_faces, 24, levels);
        EXPECT_EQUAL_INT((int)m->indices.count, 24 << (2 * levels));
        EXPECT_EQUAL_INT((int)m->P.count, (4 << (2 * levels)) + 2); // Euler: F = 2 (V - 2)
        const sr_vec3 *P = m->P.data, *N = m->N.data;
        for (int i = 0; i < 6; ++i) {
            expect_same(P[i], sr_scale(0.5f, octahedron[i]), 1e-6);
            expect_same(N[i], sr_neg(octahedron[i]), 1e-5); // wound outward, so that N is inward
        }
    }
}

/* An open mesh with vertices of valence 2, 3, 5 and more on its boundary, and of 3, 5 and 7 inside. */
enum { OPEN_VERTICES = 19 };
static sr_vec3 open_mesh[OPEN_VERTICES];
static int32_t open_faces[3 * 40];
static uint32_t open_corners;

static void face(int a, int b, int c)
{
    int32_t f[3] = {a, b, c};
    memcpy(open_faces + open_corners, f, sizeof f);
    open_corners += 3;
}

static void make_open_mesh(void)
{
    struct sr_rng rng = sr_rng_seed(7, 1);
    open_corners = 0;
    for (int i = 0; i < 7; ++i) { // two rings about a centre of valence 7
        float a = 2 * SR_PI * (float)i / 7;
        open_mesh[1 + i] = (sr_vec3){cosf(a), sinf(a), 0};
        open_mesh[8 + i] = (sr_vec3){2.2f * cosf(a + 0.4f), 2.2f * sinf(a + 0.4f), 0};
        face(0, 1 + i, 1 + (i + 1) % 7);
        face(1 + i, 8 + i, 1 + (i + 1) % 7);
        if (i != 6) // a notch
            face(8 + i, 8 + (i + 1) % 7, 1 + (i + 1) % 7);
    }
    for (int i = 0; i < 3; ++i) { // ears of valence 2
        float a = 2 * SR_PI * ((float)i + 0.5f) / 7 + 0.4f;
        open_mesh[15 + i] = (sr_vec3){3.5f * cosf(a), 3.5f * sinf(a), 0};
        face(8 + i, 15 + i, 8 + i + 1);
    }
    open_mesh[18] = (sr_vec3){0.6f, 0.3f, 0}; // valence 3 inside of the first triangle
    int32_t first[3] = {open_faces[0], open_faces[1], open_faces[2]};
    open_faces[2] = 18;
    face(first[1], first[2], 18);
    face(first[2], first[0], 18);
    for (int i = 0; i < OPEN_VERTICES; ++i)
        open_mesh[i].z = uniform(&rng) - 0.5f;
}

TEST(loopsubdiv_limit_does_not_depend_on_level)
{
    make_open_mesh();
    const struct sr_shape_mesh *coarse = subdivide(open_mesh, OPEN_VERTICES, open_faces, open_corners, 0);
    const sr_vec3 *P0 = coarse->P.data, *N0 = coarse->N.data;
    for (int levels = 1; levels < 5; ++levels) {
        const struct sr_shape_mesh *m = subdivide(open_mesh, OPEN_VERTICES, open_faces, open_corners, levels);
        const sr_vec3 *P = m->P.data, *N = m->N.data;
        for (int i = 0; i < OPEN_VERTICES; ++i) {
            expect_same(P[i], P0[i], 3e-6);
            expect_same(N[i], N0[i], 1e-4);
        }
    }
}

TEST(loopsubdiv_normals_are_those_of_the_triangles_in_the_limit)
{
    make_open_mesh();
    const struct sr_shape_mesh *m = subdivide(open_mesh, OPEN_VERTICES, open_faces, open_corners, 6);
    const sr_vec3 *P = m->P.data, *N = m->N.data;
    const int32_t *c = m->indices.data;
    double worst = 1;
    for (uint32_t i = 0; i < m->indices.count; i += 3) {
        sr_vec3 n = sr_normalize(sr_cross(sr_sub(P[c[i + 1]], P[c[i]]), sr_sub(P[c[i + 2]], P[c[i]])));
        for (int k = 0; k < 3; ++k)
            worst = fmin(worst, -(double)sr_dot(n, N[c[i + (uint32_t)k]]));
    }
    EXPECT(worst > 0.97); // one part in 64 of the control triangle's bend
}

TEST(loopsubdiv_planes_stay_planes_and_affine_maps_commute)
{
    make_open_mesh();
    sr_vec3 flat[OPEN_VERTICES], mapped[OPEN_VERTICES];
    for (int i = 0; i < OPEN_VERTICES; ++i) {
        sr_vec3 p = open_mesh[i];
        flat[i] = (sr_vec3){p.x, p.y, 0.25f * p.x - 0.5f * p.y + 3};
        mapped[i] = (sr_vec3){2 * p.x + p.z + 1, p.y - p.x - 2, 0.5f * p.z + 0.25f * p.y + 7};
    }
    const struct sr_shape_mesh *m = subdivide(flat, OPEN_VERTICES, open_faces, open_corners, 3);
    const sr_vec3 *P = m->P.data, *N = m->N.data;
    sr_vec3 n = sr_normalize((sr_vec3){0.25f, -0.5f, -1});
    for (uint32_t i = 0; i < m->P.count; ++i) {
        EXPECT_NEAR((double)P[i].z, (double)(0.25f * P[i].x - 0.5f * P[i].y + 3), 2e-6);
        expect_same(N[i], n, 3e-5);
    }
    const struct sr_shape_mesh *a = subdivide(open_mesh, OPEN_VERTICES, open_faces, open_corners, 3);
    const struct sr_shape_mesh *b = subdivide(mapped, OPEN_VERTICES, open_faces, open_corners, 3);
    const sr_vec3 *A = a->P.data, *B = b->P.data;
    for (uint32_t i = 0; i < a->P.count; ++i) {
        sr_vec3 p = A[i];
        expect_same(B[i], (sr_vec3){2 * p.x + p.z + 1, p.y - p.x - 2, 0.5f * p.z + 0.25f * p.y + 7}, 5e-6);
    }
}

/* The boundary is the uniform cubic B-spline of the boundary's control vertices alone: two surfaces that share them
 * meet. */
TEST(loopsubdiv_boundary_is_a_cubic_spline)
{
    const sr_vec3 P[5] = {{0, 0, 0}, {1, 0, 1}, {1, 1, 0}, {0, 1, 0.5f}, {0.4f, 0.6f, 3}};
    const int32_t faces[12] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
    const struct sr_shape_mesh *m = subdivide(P, 5, faces, 12, 4);
    const sr_vec3 *Q = m->P.data;
    const int32_t *c = m->indices.data;
    int along = 0, inside = 0;
    for (uint32_t h = 0; h < m->indices.count; ++h) {
        int32_t a = c[h], b = c[h % 3 == 2 ? h - 2 : h + 1];
        int twins = 0;
        for (uint32_t k = 0; k < m->indices.count; ++k)
            twins += c[k] == b && c[k % 3 == 2 ? k - 2 : k + 1] == a;
        EXPECT(twins <= 1);
        inside += twins;
        if (twins)
            continue;
        ++along;
        double nearest = INFINITY;
        for (int i = 0; i < 4; ++i)
            for (int s = 0; s <= 16; ++s) {
                double t = s / 16.0, w[4] = {(1 - t) * (1 - t) * (1 - t) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                                             (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
                double p[3] = {0};
                for (int k = 0; k < 4; ++k) {
                    sr_vec3 v = P[(i + k) % 4];
                    p[0] += w[k] * (double)v.x, p[1] += w[k] * (double)v.y, p[2] += w[k] * (double)v.z;
                }
                double d[3] = {p[0] - (double)Q[a].x, p[1] - (double)Q[a].y, p[2] - (double)Q[a].z};
                nearest = fmin(nearest, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            }
        EXPECT(nearest < 1e-11);
    }
    EXPECT_EQUAL_INT(along, 4 * 16);
    EXPECT_EQUAL_INT(inside, 3 * 4 * 256 - 4 * 16);
}

static void expect_refused(const sr_vec3 *P, uint32_t vertices, const int32_t *indices, uint32_t corners, int levels,
                           const char *says)
{
    struct sr_shape_loopsubdiv l = {
        .levels = levels, .unbiased = true, .indices = {indices, corners}, .P = {P, vertices}};
    struct sr_shape_placement placement = here();
    struct sr_error error = {0};
    EXPECT(sr_shape_loopsubdiv.prepare(&l, &placement, &test_arena, &error) != SR_OK);
    if (!strstr(error.text, says))
        test_fail(__FILE__, __LINE__, "expected \"%s\" in \"%s\"", says, error.text);
}

TEST(loopsubdiv_refuses_what_is_no_surface)
{
    const sr_vec3 P[7] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {2, 1, 1}, {2, 2, 2}};
    expect_refused(P, 7, (int32_t[]){0, 1, 2, 1, 0, 3, 0, 1, 4}, 9, 1, "belongs to triangles 0, 1 and 2");
    expect_refused(P, 7, (int32_t[]){0, 1, 2, 0, 1, 3}, 6, 1, "not wound alike");
    expect_refused(P, 7, (int32_t[]){0, 1, 2, 0, 3, 4}, 6, 1, "vertex 0 joins");
    expect_refused(P, 7, (int32_t[]){0, 1, 2, 0, 3, 4, 0, 5, 6}, 9, 1, "vertex 0 joins");
    expect_refused(P, 7, (int32_t[]){0, 1, 1}, 3, 1, "twice");
    expect_refused(P, 7, (int32_t[]){0, 1, 7}, 3, 1, "out of range");
    expect_refused(P, 7, (int32_t[]){0, 1, -1}, 3, 1, "out of range");
    expect_refused(P, 7, (int32_t[]){0, 1}, 2, 1, "multiple of 3");
    expect_refused(P, 7, NULL, 0, 1, "\"indices\" is missing");
    expect_refused(NULL, 0, (int32_t[]){0, 1, 2}, 3, 1, "\"P\" is missing");
    expect_refused(P, 7, (int32_t[]){0, 1, 2}, 3, 13, "at most");
    expect_refused(P, 7, (int32_t[]){0, 1, 2}, 3, 30, "at most");
    expect_refused((sr_vec3[]){{0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}}, 3, (int32_t[]){0, 1, 2}, 3, 1, "not finite");
}

TEST(loopsubdiv_leaves_unused_vertices_alone)
{
    const sr_vec3 P[5] = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {8, 8, 8}};
    const struct sr_shape_mesh *m = subdivide(P, 5, (int32_t[]){1, 2, 3}, 3, 2);
    expect_same(((const sr_vec3 *)m->P.data)[0], P[0], 0);
    EXPECT_EQUAL_INT((int)m->indices.count, 48);
}
