/* SPDX-License-Identifier: MIT */
/* Files that are damaged: cut at every byte of their headers, and changed at random, always in the same way. */
#include "fixtures.h"
#include "fuzz/seeds.h"
#include "measured/private.h"

static struct seed seed, damaged;

/* exactly the bytes, so that a sanitizer sees each step beyond */
static sr_status load(const struct seed *s, size_t size, struct sr_arena *arena, struct sr_measured **m,
                      struct sr_error *error)
{
    unsigned char *exact = malloc(size ? size : 1);
    EXPECT(exact);
    memcpy(exact, s->data, size);
    sr_status status = measured_load("file", exact, size, NULL, arena, m, error);
    free(exact);
    return status;
}

TEST(every_seed_is_a_valid_file)
{
    for (int i = 0; i < SEED_COUNT; ++i) {
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        struct sr_measured *m;
        seed_make(i, &seed);
        if (load(&seed, seed.size, &arena, &m, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s: %s", seed_names[i], error.text);
        sr_arena_free(&arena);
    }
}

TEST(files_cut_at_each_byte_of_their_header_are_refused_with_a_reason)
{
    for (int i = 0; i < SEED_COUNT; ++i) {
        seed_make(i, &seed);
        for (size_t size = 0; size < seed.header; ++size) {
            struct sr_arena arena = {0};
            struct sr_error error = {0};
            struct sr_measured *m;
            sr_status status = load(&seed, size, &arena, &m, &error);
            // a text of numbers may end anywhere and still be a shorter one
            if (status == SR_OK && i != SEED_ABG)
                test_fail(__FILE__, __LINE__, "%s of %zu of its %zu bytes was read", seed_names[i], size, seed.size);
            if (status != SR_OK &&
                (status != SR_ERROR_INPUT || strncmp(error.text, "file", 4) != 0 || strlen(error.text) < 15))
                test_fail(__FILE__, __LINE__, "%s cut at %zu: status %d \"%s\"", seed_names[i], size, status,
                          error.text);
            sr_arena_free(&arena);
        }
    }
}

TEST(damaged_files_are_refused_or_give_what_is_finite_within_memory_bounds)
{
    uint64_t state = 1;
    int read = 0, refused = 0;
    for (int n = 0; n < 40000; ++n) {
        seed_make(n % SEED_COUNT, &seed);
        damaged = seed;
        seed_damage(&damaged, &state);
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        struct sr_measured *m;
        sr_status status = load(&damaged, damaged.size, &arena, &m, &error);
        EXPECT(arena.total <= 64 * damaged.size + (1u << 20));
        EXPECT((status == SR_OK) == (error.text[0] == 0));
        if (status == SR_OK) {
            ++read;
            sr_spectrum f = sr_measured_f(m, direction(40, n), direction(n % 80, 0), wavelengths());
            for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                if (!(f[k] >= 0 && isfinite(f[k])))
                    test_fail(__FILE__, __LINE__, "%s, file %d: f = %g", seed_names[n % SEED_COUNT], n, (double)f[k]);
        } else {
            EXPECT_EQUAL_INT(status, SR_ERROR_INPUT);
            ++refused;
        }
        sr_arena_free(&arena);
    }
    EXPECT(read > 2000 && refused > 2000); // both happen
}

/* Sizes that a header may claim, each above what the file has. */
TEST(absurd_sizes_ask_for_no_memory)
{
    static const uint64_t sizes[] = {1u << 31, UINT32_MAX, (uint64_t)1 << 40, UINT64_MAX / 4 + 1, UINT64_MAX};
    seed_make(SEED_RGL, &seed);
    int refused = 0;
    for (size_t at = 14; at + 8 <= seed.header; ++at)
        for (int k = 0; k < 5; ++k) {
            damaged = seed;
            memcpy(damaged.data + at, &sizes[k], 8);
            struct sr_arena arena = {0};
            struct sr_error error = {0};
            struct sr_measured *m;
            refused += load(&damaged, damaged.size, &arena, &m, &error) != SR_OK;
            EXPECT(arena.total < 64 * seed.size + 65536);
            sr_arena_free(&arena);
        }
    EXPECT(refused > 1500);
}
