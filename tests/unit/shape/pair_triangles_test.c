/* SPDX-License-Identifier: MIT */
/* Triangles put in pairs are the same triangles: every point of every one is found again, with its uv and face. */
#include "common.h"

#include <string.h>

enum { SIDE = 9, VERTICES = (SIDE + 1) * (SIDE + 1), MOST = 2 * SIDE * SIDE };

/* A wavy sheet whose squares are cut in two; every `alone`-th loses its second half (0: none does), corners begin
 * anywhere. */
static struct sr_shape_mesh sheet(struct sr_rng *rng, int alone, bool has_uv)
{
    sr_vec3 P[VERTICES];
    sr_vec2 uv[VERTICES];
    int32_t indices[3 * MOST], faces[MOST];
    uint32_t n = 0;
    for (int i = 0; i < VERTICES; ++i) {
        P[i] = (sr_vec3){(float)(i % (SIDE + 1)), (float)(i / (SIDE + 1)), uniform(rng)};
        uv[i] = (sr_vec2){uniform(rng), uniform(rng)};
    }
    for (int s = 0; s < SIDE * SIDE; ++s) {
        int a = s / SIDE * (SIDE + 1) + s % SIDE, b = a + 1, c = b + SIDE + 1, d = c - 1;
        int halves[2][3] = {{a, b, d}, {c, d, b}};
        for (int h = 0; h < (alone && s % alone == 0 ? 1 : 2); ++h, ++n) {
            int first = (int)(3 * uniform(rng));
            for (int k = 0; k < 3; ++k)
                indices[3 * n + (uint32_t)k] = halves[h][(first + k) % 3];
            faces[n] = (int32_t)(1000 + n);
        }
    }
    struct sr_shape_mesh m = {.indices = {indices, 3 * n}, .P = SLICE(P), .face_indices = {faces, n}};
    if (has_uv)
        m.uv = (struct sr_slice)SLICE(uv);
    PREPARE(sr_shape_trianglemesh, &m, here());
    return m;
}

static bool near(sr_vec3 a, sr_vec3 b, float tolerance)
{
    return sr_length(sr_sub(a, b)) <= tolerance * (1 + sr_length(a));
}

static void expect_same_surface(int alone, bool has_uv)
{
    struct sr_rng rng = sr_rng_seed(31, (uint64_t)alone);
    struct sr_shape_mesh plain = sheet(&rng, alone, has_uv), paired = plain;
    struct sr_error error = {0};
    uint32_t n = plain.indices.count / 3, whole = alone ? SIDE * SIDE - (SIDE * SIDE + alone - 1) / alone : SIDE * SIDE;
    paired.indices.data = sr_arena_copy(&test_arena, plain.indices.data, plain.indices.count * sizeof(int32_t));
    paired.face_indices.data = sr_arena_copy(&test_arena, plain.face_indices.data, n * sizeof(int32_t));
    EXPECT_EQUAL_INT(sr_shape_count_pairs(&plain), whole);
    EXPECT_EQUAL_INT(sr_shape_pair_triangles(&paired, &test_arena, &error), SR_OK);
    EXPECT_EQUAL_INT(paired.pairs, whole);
    bool seen[MOST] = {false};
    const sr_vec3 *P = plain.P.data;
    for (uint32_t quad = 0; quad < n - whole; ++quad) {
        const int32_t *q = (const int32_t *)paired.indices.data + 6 * (size_t)quad + 1; // of a pair
        for (int i = 0; i < 50; ++i) {
            sr_vec2 at = {uniform(&rng), uniform(&rng)};
            uint32_t primitive = whole + quad;
            sr_vec3 expected = {0, 0, 0};
            if (quad < whole) { // by the corners of the quad
                bool second = at.x + at.y > 1;
                sr_vec3 corner = P[q[second ? 2 : 0]], along = P[q[second ? 3 : 1]], across = P[q[second ? 1 : 3]];
                float u = second ? 1 - at.x : at.x, v = second ? 1 - at.y : at.y;
                expected =
                    sr_add(corner, sr_add(sr_scale(u, sr_sub(along, corner)), sr_scale(v, sr_sub(across, corner))));
                primitive = 2 * quad + sr_shape_half_of_pair(&at);
            } else if (at.x + at.y > 1)
                at = (sr_vec2){1 - at.x, 1 - at.y};
            struct sr_point x, y;
            sr_shape_trianglemesh.point(&paired, primitive, at, &x);
            sr_shape_trianglemesh.bare_point(&paired, primitive, at, &y);
            EXPECT(near(x.n, y.n, 1e-6f)); // kept normals do not outlive the order of triangles
            uint32_t old = (uint32_t)x.face - 1000;
            EXPECT(old < n && (quad >= whole || near(x.p, expected, 1e-6f)));
            seen[old] = true;
            // where the old triangle has the same point: its corners begin elsewhere
            const int32_t *c = (const int32_t *)plain.indices.data + 3 * (size_t)old,
                          *d = (const int32_t *)paired.indices.data + 3 * (size_t)primitive;
            float w[3] = {1 - at.x - at.y, at.x, at.y}, b[3] = {0};
            for (int k = 0; k < 9; ++k)
                b[k / 3] += c[k / 3] == d[k % 3] ? w[k % 3] : 0;
            sr_shape_trianglemesh.point(&plain, old, (sr_vec2){b[1], b[2]}, &y);
            sr_vec2 uv = sr_shape_trianglemesh.uv(&paired, primitive, at);
            EXPECT(near(x.p, y.p, 1e-6f) && near(x.n, y.n, 1e-5f) && near(x.dpdu, y.dpdu, 1e-4f) &&
                   near(x.dpdv, y.dpdv, 1e-4f));
            EXPECT(fabsf(x.uv.x - y.uv.x) < 1e-5f && fabsf(x.uv.y - y.uv.y) < 1e-5f && fabsf(uv.x - y.uv.x) < 1e-5f &&
                   fabsf(uv.y - y.uv.y) < 1e-5f);
        }
    }
    for (uint32_t i = 0; i < n; ++i)
        EXPECT(seen[i]);
}

TEST(pairs_are_the_same_surface)
{
    for (int alone = 0; alone < 5; alone += 2) {
        expect_same_surface(alone, true);
        expect_same_surface(alone, false);
    }
}

/* Nor do those that walk their edge in one direction make a pair. */
TEST(triangles_without_neighbours_stay)
{
    sr_vec3 P[6] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    int32_t apart[6] = {0, 1, 2, 3, 4, 5},
            same_way[6] = {0, 1, 2, 0, 1, 3}; // walked in one direction: no surface of two sides
    struct sr_shape_mesh m = {.indices = SLICE(apart), .P = SLICE(P)}, k = {.indices = SLICE(same_way), .P = SLICE(P)};
    PREPARE(sr_shape_trianglemesh, &m, here());
    PREPARE(sr_shape_trianglemesh, &k, here());
    EXPECT_EQUAL_INT(sr_shape_count_pairs(&m), 0);
    EXPECT_EQUAL_INT(sr_shape_count_pairs(&k), 0);
}
