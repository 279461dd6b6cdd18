/* SPDX-License-Identifier: MIT */
#include "import/ply.h"
#include "test.h"

#include <zlib.h>

/* A file in memory that is being written. */
struct bytes {
    char data[1 << 16];
    size_t size;
};

static void put_text(struct bytes *b, const char *text)
{
    memcpy(b->data + b->size, text, strlen(text));
    b->size += strlen(text);
}

static void put(struct bytes *b, const void *value, size_t size, bool is_swapped)
{
    for (size_t i = 0; i < size; ++i)
        b->data[b->size + i] = ((const char *)value)[is_swapped ? size - 1 - i : i];
    b->size += size;
}

static void put_float(struct bytes *b, float v, bool is_swapped)
{
    put(b, &v, 4, is_swapped);
}

static sr_status decode(const struct bytes *b, struct sr_ply_mesh *mesh, struct sr_error *error)
{
    char *copy = malloc(b->size + 1); // of its own size, so that a sanitizer sees the end
    EXPECT(copy != NULL);
    memcpy(copy, b->data, b->size);
    copy[b->size] = 0;
    *error = (struct sr_error){0};
    sr_status status = sr_ply_decode("m.ply", copy, b->size, mesh, error);
    free(copy);
    return status;
}

static const char ascii[] = "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement vertex 5\r\nproperty double "
                            "x\r\nproperty float y\r\nproperty float z\r\n"
                            "property uchar red\r\nproperty float nx\r\nproperty float ny\r\nproperty float "
                            "nz\r\nproperty float s\r\nproperty float t\r\n"
                            "element material 1\r\nproperty list uchar float list\r\nelement face 3\r\nproperty list "
                            "uchar int vertex_indices\r\nproperty int face_indices\r\nend_header\r\n"
                            "0 0 0 255 0 0 1 0 0\r\n1 0 0 255 0 0 1 1 0\r\n1 1 0 255 0 0 1 1 1\r\n0 1e0 0 255 0 0 1 0 "
                            "1\r\n-.5 .5 0 255 0 0 1 0 .5\r\n"
                            "3 1 2 3\r\n3 0 1 2 7\r\n4 0 1 2 3 8\r\n5 0 1 2 3 4 9";

TEST(ascii_ply_gives_triangles_quads_and_fans)
{
    struct bytes b = {.size = 0};
    struct sr_ply_mesh m;
    struct sr_error e;
    put_text(&b, ascii);
    if (decode(&b, &m, &e) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", e.text);
    EXPECT_EQUAL_INT(m.vertex_count, 5);
    EXPECT_EQUAL_INT(m.triangle_count, 4);
    EXPECT_EQUAL_INT(m.quad_count, 1);
    EXPECT_EQUAL_INT(m.fan_count, 1);
    EXPECT_NEAR(m.P[4].x, -0.5, 0);
    EXPECT_NEAR(m.N[2].z, 1, 0);
    EXPECT_NEAR(m.uv[3].y, 1, 0);
    static const int32_t triangles[] = {0, 1, 2, 0, 1, 2, 0, 2, 3, 0, 3, 4}, faces[] = {7, 9, 9, 9, 8},
                         quad[] = {0, 1, 2, 3};
    EXPECT(memcmp(m.triangles, triangles, sizeof triangles) == 0);
    EXPECT(memcmp(m.quads, quad, sizeof quad) == 0);
    EXPECT(memcmp(m.face_indices, faces, sizeof faces) == 0);
    sr_ply_free(&m);
}

/* the kinds of faces decide which way through the reader is taken */
enum { TRIANGLES = 1, QUADS = 2, EXTRA = 4, WIDE = 8 };

static void make_binary(struct bytes *b, bool is_big, int kinds)
{
    b->size = 0;
    put_text(b, is_big ? "ply\nformat binary_big_endian 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
    put_text(
        b,
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\n");
    put_text(b, kinds == 3 || kinds == 7 ? "element face 2\n" : "element face 1\n");
    put_text(b, kinds & WIDE ? "property list uint ushort vertex_index\n" : "property list uint8 int vertex_indices\n");
    put_text(b, kinds & EXTRA ? "property short other\nend_header\n" : "end_header\n");
    for (int i = 0; i < 4; ++i) {
        put_float(b, (float)(i & 1), is_big);
        put_float(b, (float)(i >> 1), is_big);
        put_float(b, 0.25f, is_big);
        put_float(b, 0.125f * (float)i, is_big);
        put_float(b, 1, is_big);
    }
    for (int corners = 3; corners <= 4; ++corners) {
        if (!(kinds & (corners == 3 ? TRIANGLES : QUADS)))
            continue;
        uint32_t n = (uint32_t)corners;
        uint8_t small = (uint8_t)corners;
        put(b, kinds & WIDE ? (void *)&n : (void *)&small, kinds & WIDE ? 4 : 1, is_big);
        for (int32_t k = 0; k < corners; ++k) {
            uint16_t k16 = (uint16_t)k;
            put(b, kinds & WIDE ? (void *)&k16 : (void *)&k, kinds & WIDE ? 2 : 4, is_big);
        }
        int16_t other = -1;
        if (kinds & EXTRA)
            put(b, &other, 2, is_big);
    }
}

TEST(binary_ply_of_both_byte_orders_says_the_same)
{
    for (int is_big = 0; is_big < 2; ++is_big)
        for (int kinds = 1; kinds < 16; ++kinds) {
            if (!(kinds & 3) || (kinds & WIDE && (kinds & 3) == 3))
                continue;
            struct bytes b;
            struct sr_ply_mesh m;
            struct sr_error e;
            make_binary(&b, is_big, kinds);
            if (decode(&b, &m, &e) != SR_OK)
                test_fail(__FILE__, __LINE__, "big %d kinds %d: %s", is_big, kinds, e.text);
            EXPECT_EQUAL_INT(m.triangle_count, kinds & TRIANGLES ? 1 : 0);
            EXPECT_EQUAL_INT(m.quad_count, kinds & QUADS ? 1 : 0);
            EXPECT(m.P[3].x == 1 && m.P[3].y == 1 && m.P[3].z == 0.25f && m.N == NULL && m.uv[3].x == 0.375f &&
                   m.uv[0].y == 1);
            for (int32_t k = 0; k < 3 && kinds & TRIANGLES; ++k)
                EXPECT_EQUAL_INT(m.triangles[k], k);
            for (int32_t k = 0; k < 4 && kinds & QUADS; ++k)
                EXPECT_EQUAL_INT(m.quads[k], k);
            sr_ply_free(&m);
        }
}

TEST(ply_packed_by_gzip_is_read)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/mesh.ply.gz", test_folder());
    gzFile f = gzopen(path, "wb");
    EXPECT(f && gzwrite(f, ascii, sizeof ascii - 1) == (int)sizeof ascii - 1);
    gzclose(f);
    struct sr_ply_mesh m;
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_ply_read(path, &m, &e), SR_OK);
    EXPECT_EQUAL_INT(m.triangle_count, 4);
    sr_ply_free(&m);
    EXPECT_EQUAL_INT(sr_ply_read("/nowhere/x.ply", &m, &e), SR_ERROR_INPUT);
}

TEST(ply_cut_anywhere_is_refused_with_a_reason)
{
    for (int kinds = 0; kinds < 8; ++kinds) {
        struct bytes b = {.size = 0}, part;
        struct sr_ply_mesh m;
        struct sr_error e;
        if (kinds & 3)
            make_binary(&b, kinds & 4, kinds & 3);
        else
            put_text(&b, ascii);
        for (size_t n = 0; n + 1 < b.size; ++n) {
            part = b;
            part.size = n;
            EXPECT_EQUAL_INT(decode(&part, &m, &e), SR_ERROR_INPUT);
            EXPECT(strncmp(e.text, "m.ply:", 6) == 0);
        }
    }
}

TEST(ply_with_bytes_changed_never_harms)
{
    uint32_t state = 7;
    for (int i = 0; i < 4000; ++i) {
        struct bytes b = {.size = 0};
        struct sr_ply_mesh m;
        struct sr_error e;
        if (i % 4 == 0)
            put_text(&b, ascii);
        else
            make_binary(&b, i % 4 == 1, 1 + i % 3);
        for (int k = 0; k <= i % 3; ++k) {
            state = state * 1664525u + 1013904223u;
            b.data[(state >> 8) % b.size] = (char)(state >> 2);
        }
        if (decode(&b, &m, &e) == SR_OK) {
            for (uint32_t k = 0; k < 3 * m.triangle_count; ++k)
                EXPECT((uint32_t)m.triangles[k] < m.vertex_count);
            for (uint32_t k = 0; k < 4 * m.quad_count; ++k)
                EXPECT((uint32_t)m.quads[k] < m.vertex_count);
            sr_ply_free(&m);
        } else
            EXPECT(e.text[0] != 0);
    }
}

static void expect_refusal(const char *text, const char *message)
{
    struct bytes b = {.size = 0};
    struct sr_ply_mesh m;
    struct sr_error e;
    put_text(&b, text);
    EXPECT_EQUAL_INT(decode(&b, &m, &e), SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(e.text, message);
}

#define VERTEX "property float x\nproperty float y\nproperty float z\n"

TEST(lies_about_sizes_are_found_before_memory_is_asked_for)
{
    expect_refusal("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n" VERTEX
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n1234",
                   "m.ply: is cut short: its head promises 4000000000 of element \"vertex\", at least 12 bytes each, "
                   "but 4 bytes are left");
    expect_refusal("ply\nformat ascii 1.0\nelement vertex 99999999999999\n" VERTEX
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3",
                   "m.ply: is cut short: its head promises 99999999999999 of element \"vertex\", at least 6 bytes "
                   "each, but 5 bytes are left");
    expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\n" VERTEX
                   "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n4000000000 0 0",
                   "m.ply: face 1 says that it has 4000000000 corners, more than the file holds");
    expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\n" VERTEX
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 1\n",
                   "m.ply: a face names vertex 1, expected 0 to 0");
    expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\n" VERTEX
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 -1\n",
                   "m.ply: a face names vertex -1, expected 0 to 0");
    expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nelement face "
                   "0\nproperty list uchar int vertex_indices\nend_header\n0 0\n",
                   "m.ply: its vertices have no x, y and z");
    expect_refusal("ply\nformat ascii 1.0\nelement vertex 1\n" VERTEX
                   "element face 1\nproperty list float int vertex_indices\nend_header\n",
                   "m.ply:8: expected \"property TYPE NAME\" or \"property list INTEGER_TYPE TYPE NAME\"");
    expect_refusal("solid\n", "m.ply: expected a PLY file, which begins with the line \"ply\"");
    expect_refusal("ply\nformat ascii 1.0\n", "m.ply: the head is cut short: expected \"end_header\"");
}

/* 1.1 million triangles, as vertices of 12 bytes and faces of 13: 21 MB, in no more than twenty times what it takes to
 * look at each byte, whatever the machine. */
TEST(large_binary_ply_is_copied_in_bulk)
{
    uint32_t side = 742, vertices = side * side, faces = 2 * (side - 1) * (side - 1);
    char head[512];
    int n = snprintf(head, sizeof head,
                     "ply\nformat binary_little_endian 1.0\nelement vertex %u\n" VERTEX
                     "element face %u\nproperty list uchar int vertex_indices\nend_header\n",
                     vertices, faces);
    size_t size = (size_t)n + vertices * 12ull + faces * 13ull;
    char *data = sr_alloc(size + 1), *p = data;
    EXPECT(data != NULL);
    memcpy(p, head, (size_t)n);
    p += n;
    for (uint32_t i = 0; i < vertices; ++i, p += 12)
        memcpy(p, (float[3]){(float)(i % side), (float)(i / side), 0}, 12);
    for (uint32_t i = 0; i < faces; ++i, p += 13) {
        uint32_t cell = i / 2, v = cell / (side - 1) * side + cell % (side - 1);
        p[0] = 3;
        memcpy(p + 1, (int32_t[3]){(int32_t)v, (int32_t)(v + (i & 1 ? side : 1)), (int32_t)(v + side + 1)}, 12);
    }
    struct sr_ply_mesh m;
    struct sr_error e = {0};
    uint32_t sum = 0;
    double start_s = test_processor_s();
    for (size_t i = 0; i < size; ++i)
        sum = 31 * sum + (uint8_t)data[i];
    double looked_s = test_processor_s() - start_s;
    start_s = test_processor_s();
    EXPECT_EQUAL_INT(sr_ply_decode("big.ply", data, size, &m, &e), SR_OK);
    double took_s = test_processor_s() - start_s;
    printf("[   NOTE   ] %u triangles, %.0f MB: %.1f ms; bytes alone (%08x) %.1f ms\n", faces, (double)size * 1e-6,
           1e3 * took_s, sum, 1e3 * looked_s);
    EXPECT_EQUAL_INT(m.triangle_count, faces);
    EXPECT(m.triangles[3 * faces - 1] == (int32_t)vertices - 1 && m.P[vertices - 1].x == (float)(side - 1));
    EXPECT(took_s < 20 * looked_s + 0.1);
    sr_ply_free(&m);
    sr_free(data);
}
