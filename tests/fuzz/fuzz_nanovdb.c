/* SPDX-License-Identifier: MIT */
/* Sparse volumes: however a NanoVDB file is damaged, the reader says what is wrong or gives a grid that is finite
 * everywhere, and takes no more memory than such a file may.
 *
 * A tree is 300 kB long, most of it zeros, so the input is not the file but damage to a valid one: four bytes say where
 * it is cut (0: nowhere), then eight at a time a place and what stands there. With libFuzzer this is its target;
 * without, a driver of our own makes the damage for the seconds that are told: fuzz_nanovdb SECONDS [RANDOM SEED]. */
#include "base/base.h"
#include "fuzz/watch.h"
#include "medium/sparse.h"
#include "sample/sample.h"
#include "unit/medium/nanovdb_writer.h"

#include <stdio.h>

static struct nanovdb_file file;

static float value(int i, int j, int k)
{
    return (float)((i * 7 + j * 5 + k * 3) & 15);
}

static void make_file(void)
{
    struct nanovdb_spec spec = {.name = "density",
                                .type = 1,
                                .lo = {100, 0, 0},
                                .hi = {140, 9, 17},
                                .value = value,
                                .has_tiles = true,
                                .matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    struct nanovdb_spec packed = spec;
    packed.name = "temperature";
    packed.type = 16;
    nanovdb_write(&file, &packed);
    nanovdb_write(&file, &spec);
}

static void judge_grid(const uint8_t *data, size_t size, const char *name)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_sparse g;
    sr_status status = sr_sparse_parse("file", data, size, name, true, true, &g, &arena, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status != SR_OK && !error.text[0]))
        abort(); // a refusal has a reason
    if (arena.total > 16 * size + (64u << 20))
        abort(); // memory by what the file says, not by what it is
    if (status == SR_OK) {
        struct sr_rng rng = sr_rng_seed(size, 1);
        for (int i = 0; i < 200; ++i) {
            float wide = i % 8 ? 300 : 1e9f;
            sr_vec3 p = {wide * (sr_rng_float(&rng) - 0.5f), wide * (sr_rng_float(&rng) - 0.5f),
                         wide * (sr_rng_float(&rng) - 0.5f)};
            const double lo[3] = {(double)p.x, (double)p.y, (double)p.z},
                         hi[3] = {(double)p.x + 9, (double)p.y + 3, (double)p.z + 1};
            float v = sr_sparse_at(&g, p);
            if (!isfinite(v) || v > sr_sparse_largest(&g, lo, hi) * 1.0001f + 1e-30f)
                abort();
        }
    }
    sr_arena_free(&arena);
}

static void judge(const uint8_t *input, size_t size)
{
    if (!file.data)
        make_file();
    uint32_t cut = 0;
    if (size >= 4)
        memcpy(&cut, input, 4);
    size_t kept = cut ? cut % file.size : file.size;
    uint8_t *data = malloc(kept ? kept : 1); // so that the sanitizer sees a read past the end
    if (!data)
        abort();
    memcpy(data, file.data, kept);
    for (size_t at = 4; at + 8 <= size; at += 8) {
        uint32_t place;
        memcpy(&place, input + at, 4);
        place %= (uint32_t)file.size;
        if (place + 4 <= kept)
            memcpy(data + place, input + at + 4, 4);
    }
    judge_grid(data, kept, "density");
    judge_grid(data, kept, "temperature");
    free(data);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    watch_input();
    judge(data, size);
    return 0;
}

/* Damage where it hurts: headers, root, and those entries of the nodes that are in use. */
static size_t make_damage(uint8_t input[128], struct sr_rng *rng)
{
    static const uint32_t starts[] = {0, VDB_META + VDB_META_B};
    static const uint32_t words[] = {0,          1,          0x7fffffff, 0x80000000, 0xffffffff,
                                     0x7f800000, 0x7fc00000, 0xff7fffff, 0xe0000000};
    size_t size = 4;
    memset(input, 0, 128);
    if (sr_rng_u32(rng) % 8 == 0) {
        uint32_t cut = sr_rng_u32(rng);
        memcpy(input, &cut, 4);
    }
    uint32_t second = (uint32_t)(file.size / 2), count = 1 + sr_rng_u32(rng) % 6;
    for (uint32_t i = 0; i < count; ++i, size += 8) {
        uint32_t which = sr_rng_u32(rng) % 4, place = starts[which % 2] + sr_rng_u32(rng) % 1024 / 4 * 4,
                 word = words[sr_rng_u32(rng) % 9];
        if (which == 2) // anywhere that is not 0 already, nearly
            for (int trial = 0; trial < 4000; ++trial) {
                place = sr_rng_u32(rng) % (uint32_t)file.size;
                if (file.data[place])
                    break;
            }
        if (which == 3)
            place = sr_rng_u32(rng) % (uint32_t)file.size;
        place += sr_rng_u32(rng) % 2 ? second : 0;
        place %= (uint32_t)file.size;
        if (sr_rng_u32(rng) % 2)
            memcpy(&word, file.data + (place < file.size - 4 ? place : 0), 4), word ^= 1u << sr_rng_u32(rng) % 32;
        if (sr_rng_u32(rng) % 4 == 0)
            word = sr_rng_u32(rng);
        memcpy(input + size, &place, 4);
        memcpy(input + size + 4, &word, 4);
    }
    return size;
}

#ifdef FUZZ_LIBFUZZER
int LLVMFuzzerInitialize(int *count, char ***words);
int LLVMFuzzerInitialize(int *count, char ***words)
{
    make_file();
    if (*count == 3 && strcmp((*words)[1], "--seed") == 0) {
        struct sr_rng rng = sr_rng_seed(1, 1);
        uint8_t input[128];
        size_t size = make_damage(input, &rng);
        FILE *out = fopen((*words)[2], "wb");
        exit(out && fwrite(input, 1, size, out) == size && fclose(out) == 0 ? 0 : 1);
    }
    return 0;
}
#else
int main(int count, char **words)
{
    double seconds = count > 1 ? atof(words[1]) : 10, start = sr_clock_s();
    struct sr_rng rng = sr_rng_seed(count > 2 ? strtoull(words[2], NULL, 10) : 1, 7);
    uint64_t runs = 0;
    make_file();
    judge((const uint8_t[4]){0}, 4);
    for (; sr_clock_s() - start < seconds; ++runs) {
        uint8_t input[128];
        watch_input();
        judge(input, make_damage(input, &rng));
    }
    printf("nanovdb: %llu files in %.0f s, no finding\n", (unsigned long long)runs, seconds);
    free(file.data);
    return 0;
}
#endif
