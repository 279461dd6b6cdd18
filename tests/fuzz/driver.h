/* SPDX-License-Identifier: MIT */
/* What fuzz programs whose seeds are files share: libFuzzer's entry, and a driver of our own where the compiler has none. Included last,
 * once, after
 *
 *     static void judge(const uint8_t *bytes, size_t size);     aborts where a reader does what it must not
 *     static void make_seed(int number, struct seed *seed);
 *     static const char *seed_name(int number); */
#ifndef SR_TESTS_FUZZ_DRIVER_H
#define SR_TESTS_FUZZ_DRIVER_H

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    judge(data, size);
    return 0;
}

static struct seed seed;

static int write_seed(const char *path)
{
    FILE *file = fopen(path, "wb");
    make_seed(FUZZ_SEED, &seed);
    bool ok = file && fwrite(seed.data, 1, seed.size, file) == seed.size;
    return file && fclose(file) == 0 && ok ? 0 : 1;
}

#ifdef FUZZ_LIBFUZZER
int LLVMFuzzerInitialize(int *count, char ***words);
int LLVMFuzzerInitialize(int *count, char ***words)
{
    if (*count == 3 && strcmp((*words)[1], "--seed") == 0)
        exit(write_seed((*words)[2]));
    return 0;
}
#else
static struct seed damaged;

int main(int count, char **words)
{
    if (count == 3 && strcmp(words[1], "--seed") == 0)
        return write_seed(words[2]);
    double seconds = count > 1 ? atof(words[1]) : 10, start = sr_clock_s();
    uint64_t state = count > 2 ? strtoull(words[2], NULL, 10) : 1, runs = 0;
    make_seed(FUZZ_SEED, &seed);
    judge(seed.data, seed.size);
    for (; sr_clock_s() - start < seconds; ++runs) {
        damaged = seed;
        if (runs)
            seed_damage(&damaged, &state);
        uint8_t *exact = malloc(damaged.size ? damaged.size : 1); // so that the sanitizer sees a read past the end
        if (!exact)
            return 4;
        memcpy(exact, damaged.data, damaged.size);
        judge(exact, damaged.size);
        free(exact);
    }
    printf("%s: %llu files in %.0f s, no finding\n", seed_name(FUZZ_SEED), (unsigned long long)runs, seconds);
    return 0;
}
#endif

#endif
