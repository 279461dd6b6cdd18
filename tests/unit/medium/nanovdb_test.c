/* SPDX-License-Identifier: MIT */
/* NanoVDB: files of our own writing against the function that they hold; and damaged ones, which are refused. The
 * reader has also been held against what OpenVDB's own library writes (spheres and tori of fog as float, Fp4, Fp8, Fp16
 * and FpN, plain and zipped): 3000 interpolated values each within 5e-6. */
#include "medium/sparse.h"
#include "nanovdb_writer.h"
#include "scenery.h"

#include <zlib.h>

static float wavy(int i, int j, int k)
{
    return fmaxf(0, 1.5f + sinf(0.4f * (float)i) + cosf(0.3f * (float)j) * sinf(0.07f * (float)k));
}
static float steps(int i, int j, int k) // constant in leaves, and in a block
{
    return i >= 128 && j >= 0 && k >= 0 ? 2 : (float)((vdb_floor(i, 8) + vdb_floor(j, 16)) / 8 % 3 == 0);
}
static float hot(int i, int j, int k)
{
    (void)i, (void)j;
    return 1000 + 10 * (float)k;
}

static const struct nanovdb_spec plain = {.name = "density",
                                          .type = 1,
                                          .lo = {-5, 120, -140},
                                          .hi = {20, 131, 12},
                                          .value = wavy,
                                          .matrix = {0.5, 0, 0, 0, 0.25, 0, 0, 0, 0.5},
                                          .shift = {1, 2, 3}};

static struct nanovdb_file write_one(const struct nanovdb_spec *s)
{
    struct nanovdb_file f = {0};
    nanovdb_write(&f, s);
    return f;
}

static sr_status parse(const struct nanovdb_file *f, const char *name, struct sr_sparse *g, struct sr_error *error)
{
    *error = (struct sr_error){0};
    return sr_sparse_parse("f.nvdb", f->data, f->size, name, true, true, g, scenery_arena(), error);
}

TEST(sparse_grids_hold_what_was_written)
{
    static const struct {
        uint32_t type;
        bool has_tiles;
        double tolerance;
    } cases[] = {{1, false, 1e-6}, {1, true, 1e-6},   {13, false, 0.14},
                 {14, true, 0.01}, {15, false, 4e-5}, {16, false, 0.6}};
    for (int n = 0; n < 6; ++n) {
        struct nanovdb_spec spec = plain;
        spec.type = cases[n].type;
        spec.has_tiles = cases[n].has_tiles;
        spec.has_checksum = n < 2;
        spec.elsewhere = n % 2 ? 4.5f : 0; // as OpenVDB's library leaves of level sets
        if (spec.has_tiles) {
            spec.value = steps;
            memcpy(spec.lo, (int[]){-20, -16, -9}, sizeof spec.lo);
            memcpy(spec.hi, (int[]){255, 140, 130}, sizeof spec.hi);
        }
        struct nanovdb_file f = write_one(&spec);
        struct sr_sparse g;
        struct sr_error error;
        if (parse(&f, "density", &g, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(g.lo[k], plain.shift[k] + plain.matrix[4 * k] * spec.lo[k], 1e-9);
            EXPECT_NEAR(g.hi[k], plain.shift[k] + plain.matrix[4 * k] * (spec.hi[k] + 1), 1e-9);
        }
        struct sr_rng rng = sr_rng_seed(3, (uint64_t)n);
        for (int trial = 0; trial < 4000; ++trial) {
            double x[3], f3[3], expected = 0, lo[3], hi[3];
            int i[3];
            for (int k = 0; k < 3; ++k) { // at a whole number and between
                x[k] = spec.lo[k] - 3 + (spec.hi[k] - spec.lo[k] + 6) * (double)sr_rng_float(&rng);
                x[k] = trial % 4 == 0 ? floor(x[k]) : (double)(float)x[k];
                i[k] = (int)floor(x[k]);
                f3[k] = x[k] - i[k];
            }
            for (int c = 0; c < 8; ++c)
                expected += (c & 1 ? f3[0] : 1 - f3[0]) * (c & 2 ? f3[1] : 1 - f3[1]) * (c & 4 ? f3[2] : 1 - f3[2]) *
                            (double)vdb_value(&spec, i[0] + (c & 1), i[1] + (c >> 1 & 1), i[2] + (c >> 2));
            EXPECT_NEAR(sr_sparse_at(&g, (sr_vec3){(float)x[0], (float)x[1], (float)x[2]}), expected,
                        1e-4 + cases[n].tolerance);
            if (trial % 40)
                continue;
            double largest = -INFINITY; // of a small box, which may reach outside
            for (int k = 0; k < 3; ++k) {
                lo[k] = x[k];
                hi[k] = x[k] + 11 * (double)sr_rng_float(&rng);
            }
            for (int a = (int)floor(lo[0]); a <= (int)ceil(hi[0]); ++a)
                for (int b = (int)floor(lo[1]); b <= (int)ceil(hi[1]); ++b)
                    for (int c = (int)floor(lo[2]); c <= (int)ceil(hi[2]); ++c)
                        largest = fmax(largest, (double)vdb_value(&spec, a, b, c));
            EXPECT_NEAR(sr_sparse_largest(&g, lo, hi), largest, cases[n].tolerance);
        }
        EXPECT_NEAR(sr_sparse_at(&g, (sr_vec3){1e20f, 0, 0}), 0, 0);
        free(f.data);
    }
}

static const char *write_file(const struct nanovdb_file *f, const char *name)
{
    struct sr_error error = {0};
    char *path = sr_arena_printf(scenery_arena(), "%s/%s", test_folder(), name);
    EXPECT(sr_file_write(path, f->data, f->size, &error) == SR_OK);
    return path;
}

static struct sr_medium medium_of(const char *path, const struct sr_transform *t)
{
    const struct sr_medium_model *model = sr_medium_model_find("nanovdb");
    void *self = scenery_medium(model);
    *(const char **)scenery_member(model, self, "filename") = path;
    *(struct sr_spd *)scenery_member(model, self, "sigma_s") = sr_spd_constant(2);
    *(float *)scenery_member(model, self, "temperaturescale") = 2;
    *(float *)scenery_member(model, self, "Lescale") = 0.5f;
    ((struct sr_medium_common *)self)->medium_to_world = *t;
    return scenery_prepare(model, self);
}

/* An oblique map and an oblique transform: values where they belong, majorants that hold, and the transmittance of the
 * walk. */
TEST(sparse_media_stand_where_the_map_and_the_transform_put_them)
{
    struct nanovdb_spec spec = {.name = "density",
                                .type = 1,
                                .lo = {-7, 3, -30},
                                .hi = {30, 25, 9},
                                .value = wavy,
                                .matrix = {0.2, 0.05, 0, -0.05, 0.2, 0.02, 0, 0.03, 0.1},
                                .shift = {4, -1, 2}};
    struct nanovdb_spec temperature = {.name = "temperature",
                                       .type = 1,
                                       .lo = {0, 0, 0},
                                       .hi = {15, 40, 15},
                                       .value = hot,
                                       .matrix = {0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3},
                                       .shift = {3, 0, 1}};
    struct nanovdb_file f = {0};
    nanovdb_write(&f, &temperature);
    nanovdb_write(&f, &spec);
    struct sr_transform turn = sr_transform_rotate(30, (sr_vec3){1, 2, 3}),
                        move = sr_transform_translate((sr_vec3){-2, 1, 5}), t = sr_transform_multiply(&move, &turn);
    struct sr_medium m = medium_of(write_file(&f, "oblique.nvdb"), &t);
    EXPECT(m.model->glows(m.self));
    struct sr_wavelengths w = scenery_wavelengths();
    struct sr_medium_at at;
    for (int i = -6; i < 30; i += 3)
        for (int j = 3; j < 25; j += 4)
            for (int k = -29; k < 9; k += 5) {
                sr_vec3 p = {(float)(4 + 0.2 * i + 0.05 * j), (float)(-1 - 0.05 * i + 0.2 * j + 0.02 * k),
                             (float)(2 + 0.03 * j + 0.1 * k)};
                m.model->at(m.self, sr_transform_point(&t, p), &w, &at);
                EXPECT_NEAR(at.sigma_s[1], 2 * wavy(i, j, k), 1e-3);
                EXPECT_NEAR(at.sigma_a[1], wavy(i, j, k), 1e-3);
            }
    m.model->at(m.self, sr_transform_point(&t, (sr_vec3){3 + 0.3f * 4, 0.3f * 8, 1 + 0.3f * 10.5f}), &w, &at);
    struct sr_spd planck = sr_spd_blackbody(2 * (1000 + 105));
    EXPECT_RELATIVE(at.Le[2], 0.5 * (double)sr_spd_eval(&planck, w.lambda)[2], 1e-3);

    struct sr_rng rng = sr_rng_seed(8, 8);
    int met = 0;
    for (int n = 0; n < 3000; ++n) {
        sr_vec3 o = {7 * sr_rng_float(&rng) + 2, 8 * sr_rng_float(&rng) - 2, 5 * sr_rng_float(&rng) - 1},
                d = sr_equal_area_square_to_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        o = sr_transform_point(&t, sr_mad(o, n % 2 ? -10 : 0, d));
        d = sr_transform_vector(&t, d);
        struct sr_medium_walk walk;
        struct sr_medium_segment s;
        double depth = 0, expected = 0;
        m.model->begin(m.self, o, d, 20, &w, &walk);
        while (m.model->next(m.self, &walk, &s)) {
            ++met;
            for (int i = 0; i < 16; ++i) {
                float x = s.t0 + (s.t1 - s.t0) * ((float)i + 0.5f) / 16;
                m.model->at(m.self, sr_mad(o, x, d), &w, &at);
                EXPECT(at.sigma_s[0] + at.sigma_a[0] <= s.majorant[0]);
                depth += (double)((s.t1 - s.t0) / 16 * at.sigma_s[0]);
            }
        }
        if (n < 200) { // nothing is left out: the same sum over all of the ray, in the box
            for (int i = 0; i < 8000; ++i) {
                sr_vec3 p = sr_mad(o, ((float)i + 0.5f) * 20 / 8000, d), q = sr_inverse_point(&t, p);
                double index[3] = {(double)q.x, (double)q.y, (double)q.z};
                bool is_within = true;
                for (int k = 0; k < 3; ++k) { // of the box around both grids
                    double lo = k == 0   ? 4 + 0.2 * -7 + 0.05 * 3
                                : k == 1 ? -1 - 0.05 * 31 + 0.2 * 3 - 0.02 * 30
                                         : 2 + 0.03 * 3 - 0.1 * 30;
                    double hi = k == 0   ? 4 + 0.2 * 31 + 0.05 * 26
                                : k == 1 ? -1 + 0.05 * 7 + 0.2 * 26 + 0.02 * 10
                                         : 2 + 0.03 * 26 + 0.1 * 10;
                    lo = fmin(lo, k == 0 ? 3 : k == 1 ? 0 : 1);
                    hi = fmax(hi, k == 0 ? 3 + 0.3 * 16 : k == 1 ? 0.3 * 41 : 1 + 0.3 * 16);
                    is_within &= index[k] >= lo && index[k] <= hi;
                }
                m.model->at(m.self, p, &w, &at);
                expected += is_within ? 20.0 / 8000 * (double)at.sigma_s[0] : 0;
            }
            EXPECT_NEAR(depth, expected, 0.02 + 0.01 * expected);
        }
    }
    EXPECT(met > 3000);
    free(f.data);
}

TEST(packed_files_and_files_of_several_grids_are_read)
{
    struct nanovdb_file f = write_one(&plain), both = {0};
    size_t head = VDB_META + VDB_META_B + 8, grid_B = f.size - head;
    uLongf packed_B = compressBound(grid_B);
    struct nanovdb_file zipped = {malloc(head + 8 + packed_B), 0};
    memcpy(zipped.data, f.data, head);
    EXPECT(compress(zipped.data + head + 8, &packed_B, f.data + head, grid_B) == Z_OK);
    vdb_put64(zipped.data + head, packed_B);
    vdb_put64(zipped.data + 24, packed_B + 8);
    zipped.data[16 + 168] = 1;
    zipped.size = head + 8 + packed_B;
    struct sr_sparse g;
    struct sr_error error;
    EXPECT(parse(&zipped, "density", &g, &error) == SR_OK);
    EXPECT_NEAR(sr_sparse_at(&g, (sr_vec3){3, 125, -100}), wavy(3, 125, -100), 1e-6);
    zipped.data[16 + 168] = 2;
    EXPECT(parse(&zipped, "density", &g, &error) == SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "f.nvdb: is packed by BLOSC: write it with the codec ZIP or NONE");
    zipped.data[16 + 168] = 1;
    zipped.data[head + 8 + packed_B / 2] ^= 0x55;
    EXPECT(parse(&zipped, "density", &g, &error) == SR_ERROR_INPUT);
    vdb_put64(zipped.data + 16, 1ull << 50); // what it unpacks to
    EXPECT(parse(&zipped, "density", &g, &error) == SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "f.nvdb: is damaged: the size of a packed grid cannot be");

    struct nanovdb_spec other = plain;
    other.name = "flames";
    other.value = hot;
    nanovdb_write(&both, &plain);
    nanovdb_write(&both, &other);
    EXPECT(parse(&both, "flames", &g, &error) == SR_OK);
    EXPECT_NEAR(sr_sparse_at(&g, (sr_vec3){3, 125, -100}), 0, 0); // T < 0: as densities are read
    EXPECT_NEAR(sr_sparse_at(&g, (sr_vec3){3, 125, 10}), 1100, 1e-3);
    EXPECT(parse(&both, "smoke", &g, &error) == SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "f.nvdb: has no grid \"smoke\"; it has \"density\", \"flames\"");
    free(f.data), free(both.data), free(zipped.data);
}

static void expect_damage(size_t at, uint64_t value, size_t size, const char *message)
{
    struct nanovdb_file f = write_one(&plain);
    struct sr_sparse g;
    struct sr_error error;
    vdb_put(f.data + at, &value, size);
    EXPECT(parse(&f, "density", &g, &error) == SR_ERROR_INPUT);
    if (!strstr(error.text, message))
        test_fail(__FILE__, __LINE__, "expected \"%s\": %s", message, error.text);
    free(f.data);
}

TEST(damaged_files_are_refused)
{
    const size_t grid = VDB_META + VDB_META_B + 8, root = grid + VDB_ROOT, upper = root + 64 + 32 * 4;
    struct nanovdb_file whole = write_one(&plain);
    struct sr_sparse g;
    struct sr_error error;
    for (size_t size = 0; size < whole.size; size += size < 2048 ? 1 : 9973) { // cut anywhere
        uint8_t *exact = malloc(size + 1);
        memcpy(exact, whole.data, size);
        struct nanovdb_file cut = {exact, size};
        EXPECT(parse(&cut, "density", &g, &error) == SR_ERROR_INPUT);
        free(exact);
    }
    EXPECT_EQUAL_INT(whole.data[root + 24], 4); // root tiles, so that `upper` is right
    free(whole.data);
    expect_damage(0, 0, 8, "is no NanoVDB file");
    expect_damage(8, 33u << 21, 4, "is of version 33");
    expect_damage(16 + 136, 0xffffffff, 4, "cut short");
    expect_damage(16 + 136, 0, 4, "does not end");
    expect_damage(grid, 1, 8, "does not begin");
    expect_damage(grid + 32, 1ull << 60, 8, "does not begin or end");
    expect_damage(grid + 636, 6, 4, "values of type 6");
    expect_damage(grid + 632, 1, 4, "class 1");
    expect_damage(grid + 8, 12345, 4, "checksum");
    expect_damage(grid + 560, 0x7ff8000000000000ull, 8, "no bounding box");
    expect_damage(grid + 296 + 160, 0x7ff0000000000000ull, 8, "no place in space");
    expect_damage(grid + 672 + 24, 1ull << 40, 8, "no root");
    expect_damage(grid + 672 + 24, (uint64_t)-200, 8, "no root");
    expect_damage(root + 24, 0xffffff, 4, "root reaches beyond");
    expect_damage(root + 64 + 8, 1ull << 40, 8, "child outside");
    expect_damage(root + 64 + 8, 1ull << 63, 8, "child outside");
    expect_damage(root + 64 + 4, 0x100, 4, "spans"); // a tile far away
    expect_damage(upper + 8256, 0x7f800000, 4, "infinite");
}
