/* SPDX-License-Identifier: MIT */
/* One fuzz target a reader: whatever the bytes, it says what is wrong or gives an f that is finite and not negative.
 *
 * FUZZ_SEED is the format's number in seeds.h. With libFuzzer (clang) this is its target; without, a driver of our own
 * damages the seed over and over for the seconds that are told: fuzz_X SECONDS [RANDOM SEED]. With libFuzzer: fuzz_X
 * --seed FILE writes the seed for the corpus. */
#include "fuzz/seeds.h"
#include "measured/private.h"

#include <stdio.h>
#include <stdlib.h>

static void judge(const uint8_t *data, size_t size)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_measured *m;
    sr_status status = measured_load("file", data, size, NULL, &arena, &m, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status != SR_OK && !error.text[0]))
        abort(); // a refusal has a reason
    if (arena.total > 64 * size + (1u << 20))
        abort(); // memory by what the file says, not by what it is
    if (status == SR_OK) {
        static const float z[] = {1, 0.8f, 0.3f, 0.01f, -0.5f, -1};
        sr_spectrum lambda;
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            lambda[i] = 360 + 60 * (float)i;
        uint32_t hash = (uint32_t)sr_hash_bytes(data, size, 0);
        for (int i = 0; i < 36; ++i) {
            float a = sqrtf(1 - z[i % 6] * z[i % 6]), b = sqrtf(1 - z[i / 6] * z[i / 6]),
                  phi = (float)((hash >> (i % 16)) & 1023);
            sr_vec3 wo = {a * cosf(phi), a * sinf(phi), z[i % 6]}, wi = {b, 0, z[i / 6]};
            sr_spectrum f = sr_measured_f(m, wo, wi, lambda);
            for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                if (!(f[k] >= 0) || !isfinite(f[k]))
                    abort();
        }
        if (hash % 4096 == 0 && guide_build(m, &arena) == SR_OK) { // slow
            sr_vec3 wo = {0.6f, 0, 0.8f}, wi;
            float pdf;
            for (int i = 0; i < 64; ++i)
                if (sr_measured_sample(m, wo, (float)i / 64,
                                       (sr_vec2){(float)(i * 7 % 64) / 64, (float)(i * 29 % 64) / 64}, &wi, &pdf) &&
                    !(pdf > 0 && isfinite(pdf)))
                    abort();
        }
    }
    sr_arena_free(&arena);
}

static void make_seed(int number, struct seed *seed)
{
    seed_make(number, seed);
}

static const char *seed_name(int number)
{
    return seed_names[number];
}

#include "fuzz/driver.h"
