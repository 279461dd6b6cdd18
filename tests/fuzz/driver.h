/* SPDX-License-Identifier: MIT */
/* What fuzz programs whose seeds are files share: libFuzzer's entry, and a driver of our own where the compiler has
 * none. Included last, once, after
 *
 *     static void judge(const uint8_t *bytes, size_t size);     aborts where a reader does what it must not
 *     static void make_seed(int number, struct seed *seed);
 *     static const char *seed_name(int number);
 *
 * With FUZZ_VARIANTS, there are as many seeds as it tells, and `variant` says which is asked for. With
 * FUZZ_DICTIONARY, libFuzzer is given words. */
#ifndef SR_TESTS_FUZZ_DRIVER_H
#define SR_TESTS_FUZZ_DRIVER_H

#include "fuzz/watch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    watch_input();
    judge(data, size);
    return 0;
}

#ifndef FUZZ_VARIANTS
#define FUZZ_VARIANTS 1
static int variant;
#endif

static struct seed seed;

/* One file, or PATH0, PATH1, … */
static int write_seed(const char *path)
{
    for (variant = 0; variant < FUZZ_VARIANTS; ++variant) {
        char name[1024], number[12] = "";
        if (FUZZ_VARIANTS > 1)
            snprintf(number, sizeof number, "%d", variant);
        snprintf(name, sizeof name, "%s%s", path, number);
        FILE *file = fopen(name, "wb");
        make_seed(FUZZ_SEED, &seed);
        bool ok = file && fwrite(seed.data, 1, seed.size, file) == seed.size;
        if (!file || fclose(file) != 0 || !ok)
            return 1;
    }
    return 0;
}

#ifdef FUZZ_LIBFUZZER
#ifndef FUZZ_DICTIONARY
#define FUZZ_DICTIONARY(file) ((void)(file)) // writes lines such as "word", quotes and all
#endif

static int write_dictionary(const char *path)
{
    FILE *file = fopen(path, "w");
    if (!file)
        return 1;
    FUZZ_DICTIONARY(file);
    return fclose(file) == 0 ? 0 : 1;
}

__attribute__((unused)) static const char *(*const name_of_seed)(int) = seed_name;

int LLVMFuzzerInitialize(int *count, char ***words);
int LLVMFuzzerInitialize(int *count, char ***words)
{
    if (*count == 3 && strcmp((*words)[1], "--seed") == 0)
        exit(write_seed((*words)[2]));
    if (*count == 3 && strcmp((*words)[1], "--dictionary") == 0)
        exit(write_dictionary((*words)[2]));
    return 0;
}
#else
static struct seed damaged, seeds[FUZZ_VARIANTS];

int main(int count, char **words)
{
    if (count == 3 && strcmp(words[1], "--seed") == 0)
        return write_seed(words[2]);
    double seconds = count > 1 ? atof(words[1]) : 10, start = sr_clock_s();
    uint64_t state = count > 2 ? strtoull(words[2], NULL, 10) : 1, runs = 0;
    for (variant = 0; variant < FUZZ_VARIANTS; ++variant) {
        make_seed(FUZZ_SEED, &seeds[variant]);
        judge(seeds[variant].data, seeds[variant].size);
    }
    for (; sr_clock_s() - start < seconds; ++runs) {
        damaged = seeds[runs % FUZZ_VARIANTS];
        if (runs)
            seed_damage(&damaged, &state);
        uint8_t *exact = malloc(damaged.size ? damaged.size : 1); // so that the sanitizer sees a read past the end
        if (!exact)
            return 4;
        memcpy(exact, damaged.data, damaged.size);
        watch_input();
        judge(exact, damaged.size);
        free(exact);
    }
    printf("%s: %llu files in %.0f s, no finding\n", seed_name(FUZZ_SEED), (unsigned long long)runs, seconds);
    return 0;
}
#endif

#endif
