/* SPDX-License-Identifier: MIT */
/* Stores: what is put comes back; what is damaged is found; what was on the disk stays until the new is there. */
#include "store/store.h"
#include "test.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

static struct sr_arena names;

static const char *in_folder(const char *name)
{
    return sr_arena_printf(&names, "%s/%s", test_folder(), name);
}

/* Bytes that look like chance, the same for a seed. */
static void fill(unsigned char *bytes, size_t n, uint64_t seed)
{
    for (size_t i = 0; i < n; ++i) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        bytes[i] = (unsigned char)(seed >> 56);
    }
}

/* Sections "a" of a bytes, "none", "b" of b bytes. */
static void write_store(const char *path, size_t a, size_t b, uint64_t seed)
{
    struct sr_error error = {0};
    struct sr_store_out *out;
    unsigned char *bytes = sr_alloc(a + b);
    fill(bytes, a + b, seed);
    EXPECT(sr_store_create(path, "trial", &out, &error) == SR_OK);
    EXPECT(sr_store_put(out, "a", bytes, a, &error) == SR_OK);
    EXPECT(sr_store_put(out, "none", NULL, 0, &error) == SR_OK);
    EXPECT(sr_store_put(out, "b", bytes + a, b, &error) == SR_OK);
    EXPECT(sr_store_finish(out, true, &error) == SR_OK);
    sr_free(bytes);
}

static bool opens(const char *path, struct sr_error *error)
{
    *error = (struct sr_error){0};
    struct sr_store_in *in;
    bool ok = sr_store_open(path, "trial", &in, error) == SR_OK;
    EXPECT(ok == (in != NULL) && ok == (error->text[0] == 0));
    sr_store_close(in);
    return ok;
}

static bool has_seed(const char *path, size_t a, size_t b, uint64_t seed)
{
    struct sr_error error = {0};
    struct sr_store_in *in;
    if (sr_store_open(path, NULL, &in, &error) != SR_OK)
        return false;
    size_t size_a, size_b, size_none;
    const void *data_a = sr_store_get(in, "a", &size_a), *data_b = sr_store_get(in, "b", &size_b),
               *none = sr_store_get(in, "none", &size_none);
    unsigned char *bytes = sr_alloc(a + b);
    fill(bytes, a + b, seed);
    bool ok = data_a && data_b && none && size_a == a && size_b == b && size_none == 0 &&
              memcmp(data_a, bytes, a) == 0 && memcmp(data_b, bytes + a, b) == 0 && (uintptr_t)data_b % 64 == 0;
    EXPECT(!sr_store_get(in, "c", &size_none));
    sr_store_close(in);
    sr_free(bytes);
    return ok;
}

static void flip(int fd, uint64_t bit)
{
    unsigned char byte;
    EXPECT(pread(fd, &byte, 1, (off_t)(bit / 8)) == 1);
    byte ^= (unsigned char)(1 << bit % 8);
    EXPECT(pwrite(fd, &byte, 1, (off_t)(bit / 8)) == 1);
}

TEST(what_is_put_comes_back)
{
    static const size_t sizes[] = {0, 1, 63, 64, 65, 65535, 65536, 65537, 200000};
    const char *path = in_folder("back");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        write_store(path, sizes[i], 1000, i);
        EXPECT(has_seed(path, sizes[i], 1000, i));
    }
    write_store(path, 5 << 20, 100, 9); // checked by several threads
    EXPECT(has_seed(path, 5 << 20, 100, 9));
    struct sr_error error;
    int fd = open(path, O_RDWR);
    EXPECT(fd >= 0);
    flip(fd, 8 * (4 << 20));
    EXPECT(!opens(path, &error) && strstr(error.text, "section \"a\""));
    close(fd);
    EXPECT(sr_store_is_store(path) && !sr_store_is_store(test_folder()) && !sr_store_is_store(in_folder("absent")));
    EXPECT(!sr_file_exists(in_folder("back.new")));
}

TEST(sections_can_be_listed)
{
    const char *path = in_folder("list"), *name;
    struct sr_store_in *in;
    struct sr_error error = {0};
    size_t size;
    write_store(path, 10, 20, 1);
    EXPECT(sr_store_open(path, "trial", &in, &error) == SR_OK);
    EXPECT_EQUAL_TEXT(sr_store_kind(in), "trial");
    EXPECT(sr_store_section(in, 2, &name, &size) && strcmp(name, "b") == 0 && size == 20);
    EXPECT(!sr_store_section(in, 3, &name, &size));
    sr_store_close(in);
}

static void expect_found(const char *path, int fd, uint64_t bit)
{
    struct sr_error error;
    flip(fd, bit);
    if (opens(path, &error))
        test_fail(__FILE__, __LINE__, "bit %llu flipped, and not found", (unsigned long long)bit);
    EXPECT(strstr(error.text, path));
    flip(fd, bit);
}

TEST(every_flipped_bit_is_found)
{
    const char *path = in_folder("flips");
    struct sr_error error;
    struct stat st;
    write_store(path, 3000, 4100, 2);
    int fd = open(path, O_RDWR);
    EXPECT(fd >= 0 && fstat(fd, &st) == 0);
    for (uint64_t bit = 0; bit < 4096 * 8; bit += is_slow_build() ? 7 : 1)
        expect_found(path, fd, bit);
    uint64_t chance = 3, bits = (uint64_t)st.st_size * 8;
    int count = is_slow_build() ? 2000 : getenv("STERADIAN_TEST_EFFORT") ? 100000 : 20000;
    for (int i = 0; i < count; ++i) {
        chance = chance * 6364136223846793005u + 1442695040888963407u;
        expect_found(path, fd, (chance >> 20) % bits);
    }
    close(fd);
    EXPECT(opens(path, &error)); // as it was
}

TEST(flipped_bits_of_a_large_file_are_found)
{
    const char *path = in_folder("large");
    struct stat st;
    write_store(path, 150000, 70000, 2);
    int fd = open(path, O_RDWR);
    EXPECT(fd >= 0 && fstat(fd, &st) == 0);
    uint64_t chance = 4, bits = (uint64_t)st.st_size * 8;
    for (int i = 0; i < (is_slow_build() ? 100 : 1000); ++i) {
        chance = chance * 6364136223846793005u + 1442695040888963407u;
        expect_found(path, fd, (chance >> 20) % bits);
    }
    close(fd);
}

TEST(damage_is_located)
{
    const char *path = in_folder("where");
    struct sr_error error;
    write_store(path, 150000, 70000, 2);
    int fd = open(path, O_RDWR);
    EXPECT(fd >= 0);
    flip(fd, (64 + 64 + 65536 + 100) * 8); // in the second block of "a"
    EXPECT(!opens(path, &error) && error.status == SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "section \"a\"") && strstr(error.text, "block at byte 65664 "));
    close(fd);
}

TEST(blocks_in_each_others_place_are_found)
{
    const char *path = in_folder("swapped");
    struct sr_error error;
    write_store(path, 2 * SR_STORE_BLOCK, 10, 2);
    int fd = open(path, O_RDWR);
    static unsigned char blocks[2][SR_STORE_BLOCK];
    uint32_t sums[2];
    const off_t data = 128, checksums = 128 + 2 * SR_STORE_BLOCK;
    EXPECT(fd >= 0 && pread(fd, blocks, sizeof blocks, data) == sizeof blocks &&
           pread(fd, sums, sizeof sums, checksums) == sizeof sums);
    uint32_t swapped[2] = {sums[1], sums[0]};
    EXPECT(pwrite(fd, blocks[1], SR_STORE_BLOCK, data) == SR_STORE_BLOCK &&
           pwrite(fd, blocks[0], SR_STORE_BLOCK, data + SR_STORE_BLOCK) == SR_STORE_BLOCK);
    EXPECT(pwrite(fd, swapped, sizeof swapped, checksums) == sizeof swapped);
    EXPECT(!opens(path, &error));
    close(fd);
}

TEST(every_length_but_its_own_is_found)
{
    const char *path = in_folder("cut");
    struct sr_error error;
    struct stat st;
    write_store(path, 1500, 700, 2);
    EXPECT(stat(path, &st) == 0);
    for (off_t n = st.st_size - 1; n >= 0; --n) {
        EXPECT(truncate(path, n) == 0);
        if (opens(path, &error))
            test_fail(__FILE__, __LINE__, "cut to %lld bytes, and not found", (long long)n);
    }
    write_store(path, 1500, 700, 2);
    EXPECT(truncate(path, st.st_size + 1) == 0 && !opens(path, &error));
    EXPECT(truncate(path, st.st_size) == 0 && opens(path, &error));
}

TEST(the_previous_generation_is_kept)
{
    const char *path = in_folder("generations"), *previous = in_folder("generations~");
    write_store(path, 100, 100, 1);
    EXPECT(!sr_file_exists(previous));
    write_store(path, 100, 100, 2);
    write_store(path, 100, 100, 3);
    EXPECT(has_seed(path, 100, 100, 3) && has_seed(previous, 100, 100, 2));
    struct sr_error error = {0};
    struct sr_store_out *out, *other;
    EXPECT(sr_store_create(path, "trial", &out, &error) == SR_OK);
    EXPECT(sr_store_create(path, "trial", &other, &error) == SR_ERROR_RESOURCE && !other &&
           strstr(error.text, "another process"));
    sr_store_abandon(out);
    EXPECT(has_seed(path, 100, 100, 3) && has_seed(previous, 100, 100, 2) &&
           !sr_file_exists(in_folder("generations.new")));
    error = (struct sr_error){0};
    EXPECT(sr_store_create(path, "trial", &out, &error) == SR_OK && sr_store_finish(out, false, &error) == SR_OK);
    EXPECT(!has_seed(path, 100, 100, 3) && opens(path, &error) && has_seed(previous, 100, 100, 2));
}

TEST(files_of_others_are_refused)
{
    struct sr_error error = {0};
    struct sr_store_in *in;
    const char *path = in_folder("other");
    EXPECT(sr_file_write(path, "PLY", 3, &error) == SR_OK && !opens(path, &error) &&
           strstr(error.text, "no checkpoint or part"));
    write_store(path, 1, 1, 1);
    error = (struct sr_error){0};
    EXPECT(sr_store_open(path, "part", &in, &error) == SR_ERROR_INPUT && !in);
    EXPECT(strstr(error.text, "is a trial, and a part was expected"));
    EXPECT(!opens(in_folder("absent"), &error) && strstr(error.text, "cannot be opened"));
    EXPECT(!opens(test_folder(), &error));
    struct sr_store_out *out;
    error = (struct sr_error){0};
    EXPECT(sr_store_create(in_folder("no/folder"), "trial", &out, &error) == SR_ERROR_RESOURCE && !out);
}
