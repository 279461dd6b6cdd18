/* SPDX-License-Identifier: MIT */
/* Images that are damaged, and images that lie about their size: read, or refused with a reason, in memory that follows
 * from the bytes of the file: 16 times those and 64 MiB, and as much as the pixels that are there.
 *
 * Each is read in a process whose address space is limited. */
#define _GNU_SOURCE
#include "test.h"

#include "fuzz/image_seeds.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

/* 0: read; 1: refused for its bytes; else wrong. */
static int judge(const char *label, const void *data, size_t size)
{
    struct sr_error error = {0};
    struct sr_image *image;
    uint8_t *exact = malloc(size ? size : 1); // so that a sanitizer sees a read past the end
    if (!exact)
        return 3;
    memcpy(exact, data, size);
    sr_status status = sr_image_decode(label, exact, size, SR_IMAGE_SRGB, &image, &error);
    sr_image_free(image);
    free(exact);
    if (status == SR_OK)
        return 0;
    if (status != SR_ERROR_INPUT || !error.text[0])
        fprintf(stderr, "%s: %s\n", label, error.text);
    return status == SR_ERROR_INPUT && error.text[0] ? 1 : 2;
}

/* In a process of its own, with free_B more than there is. */
static int judge_alone(const char *label, const void *data, size_t size, size_t free_B)
{
    int status;
    fflush(NULL);
    pid_t pid = fork();
    if (pid == 0) {
        for (int s = 1; s < 32; ++s)
            signal(s, SIG_DFL);
        alarm(TEST_FOREVER_S);
        struct rlimit r = {test_address_space_B() + 16 * size + free_B, RLIM_INFINITY};
        if (!is_slow_build()) // sanitizers need the space
            setrlimit(RLIMIT_AS, &r);
        _exit(judge(label, data, size));
    }
    if (waitpid(pid, &status, 0) != pid || WIFSIGNALED(status))
        test_fail(__FILE__, __LINE__, "%s: signal %d", label, WTERMSIG(status));
    return WEXITSTATUS(status);
}

static const size_t free_B = (size_t)80 << 20; // 64 MiB of pixels, and what the libraries need themselves

TEST(damaged_images_are_read_or_refused)
{
    static struct seed whole, damaged;
    int rounds = is_slow_build() ? 150 : 1500;
    for (int i = 0; i < 7; ++i) {
        char label[32];
        snprintf(label, sizeof label, "image%s", seed_image_endings[i]);
        image_seed(i, &whole);
        EXPECT_EQUAL_INT(judge(label, whole.data, whole.size), 0);
        uint64_t state = (uint64_t)i + 1;
        for (int k = 0; k < rounds; ++k) {
            damaged = whole;
            if (k < 300)
                damaged.size = whole.size * (size_t)k / 300;
            else
                seed_damage(&damaged, &state);
            if (judge(label, damaged.data, damaged.size) > 1)
                test_fail(__FILE__, __LINE__, "%s, damage %d", label, k);
        }
    }
}

/* ---- liars ---- */

struct liar {
    const char *label;
    size_t size;
    uint8_t data[4096];
};

static void put_chunk(struct liar *l, const char *type, const uint8_t *data, uint32_t size)
{
    uint8_t *p = l->data + l->size;
    uint32_t words[2] = {__builtin_bswap32(size), 0};
    memcpy(p, words, 4);
    memcpy(p + 4, type, 4);
    if (size)
        memcpy(p + 8, data, size);
    words[0] = __builtin_bswap32((uint32_t)crc32(0, p + 4, size + 4));
    memcpy(p + 8 + size, words, 4);
    l->size += size + 12;
}

/* depth bits a channel; type 0 grey, 2 RGB, 3 palette, 6 RGBA; and the few rows that deflate makes of 1 MB of zeros. */
static void make_png(struct liar *l, uint32_t width, uint32_t height, uint8_t depth, uint8_t type, uint8_t interlace)
{
    uint8_t header[13] = {0, 0, 0, 0, 0, 0, 0, 0, depth, type, 0, 0, interlace}, packed[2048];
    uint32_t size[2] = {__builtin_bswap32(width), __builtin_bswap32(height)};
    uLongf n = sizeof packed;
    void *zeros = calloc(1, 1 << 20);
    if (!zeros || compress(packed, &n, zeros, 1 << 20) != Z_OK)
        abort();
    free(zeros);
    memcpy(header, size, 8);
    *l = (struct liar){.label = "liar.png"};
    memcpy(l->data, "\x89PNG\r\n\x1a\n", 8);
    l->size = 8;
    put_chunk(l, "IHDR", header, 13);
    if (type == 3)
        put_chunk(l, "PLTE", (const uint8_t *)"\0\0\0\377\377\377", 6);
    put_chunk(l, "IDAT", packed, (uint32_t)n);
    put_chunk(l, "IEND", NULL, 0);
}

static void make_text(struct liar *l, const char *label, const char *text)
{
    *l = (struct liar){.label = label, .size = strlen(text)};
    memcpy(l->data, text, l->size);
}

static void make_seeded(struct liar *l, int which, const char *label)
{
    static struct seed s;
    image_seed(which, &s);
    *l = (struct liar){.label = label, .size = s.size < sizeof l->data ? s.size : sizeof l->data};
    memcpy(l->data, s.data, l->size);
}

/* The attribute of an EXR header of that name and type: where its value begins. */
static uint8_t *attribute(struct liar *l, const char *name, const char *type)
{
    char key[64];
    size_t n = (size_t)snprintf(key, sizeof key, "%s", name) + 1;
    n += (size_t)snprintf(key + n, sizeof key - n, "%s", type) + 1;
    uint8_t *p = memmem(l->data, l->size, key, n);
    if (!p)
        abort();
    return p + n + 4;
}

static int liar_count;

/* What the processes that have ended have had of processors. */
static double children_s(void)
{
    struct rusage u;
    getrusage(RUSAGE_CHILDREN, &u);
    return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) + 1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static void expect_refused(const struct liar *l)
{
    ++liar_count;
    double before = children_s();
    int verdict = judge_alone(l->label, l->data, l->size, free_B);
    double took = children_s() - before;
    if (verdict != 1)
        test_fail(__FILE__, __LINE__, "%s, liar %d: verdict %d", l->label, liar_count, verdict);
    EXPECT(is_slow_build() || took < 5);
}

TEST(images_that_lie_about_their_size_are_refused_before_memory_is_taken)
{
    static struct liar l;
    static const uint32_t sides[][2] = {{1000000000, 1000000000}, {0x7fffffff, 1}, {1, 0x7fffffff}, {65535, 65535},
                                        {30000, 30000},           {8000000, 20},   {0, 5}};
    liar_count = 0;
    for (size_t i = 0; i < sizeof sides / sizeof *sides; ++i) {
        uint32_t w = sides[i][0], h = sides[i][1], big[2] = {__builtin_bswap32(w), __builtin_bswap32(h)};
        char text[128];
        make_png(&l, w, h, 8, 6, 0);
        expect_refused(&l);
        make_png(&l, w, h, 16, 2, 1);
        expect_refused(&l);
        make_png(&l, w, h, 1, 3, 0);
        if (w < 60000 || w > 70000 || h < 60000) // a bit a pixel: the rows that are there are few
            expect_refused(&l);
        snprintf(text, sizeof text, "PF\n%u %u\n-1.0\n0123456789abcdef", w, h);
        make_text(&l, "liar.pfm", text);
        expect_refused(&l);
        snprintf(text, sizeof text,
                 "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %u +X %u\n\1\2\3\4\1\1\1\377\1\1\1\377\1\1\1\377", h, w);
        make_text(&l, "liar.hdr", text);
        expect_refused(&l);
        make_seeded(&l, 5, "liar.qoi");
        memcpy(l.data + 4, big, 8);
        expect_refused(&l);
        make_seeded(&l, 0, "liar.exr");
        int32_t window[4] = {0, 0, (int32_t)w - 1, (int32_t)h - 1};
        memcpy(attribute(&l, "dataWindow", "box2i"), window, 16);
        memcpy(attribute(&l, "displayWindow", "box2i"), window, 16);
        expect_refused(&l);
    }
    make_seeded(&l, 6, "liar.tga");
    memcpy(l.data + 12, "\377\377\377\377", 4);
    expect_refused(&l);
    l.data[2] = 2; // not packed
    expect_refused(&l);
    make_seeded(&l, 2, "liar.jpg"); // progressive: the library keeps all coefficients
    uint8_t *frame = memmem(l.data, l.size, "\xff\xc2", 2);
    EXPECT(frame != NULL);
    memcpy(frame + 5, "\377\377\377\377", 4);
    expect_refused(&l);
    EXPECT(liar_count >= 30);
}

/* What is there may be large: 100 million pixels of one colour, packed a thousandfold. */
TEST(an_honest_image_of_one_colour_may_be_large)
{
    enum { SIDE = 4000 };
    size_t row = SIDE * 8 + 1, raw = row * SIDE; // 16 bits, RGBA: 128 MB, 256 as floats
    if (is_slow_build())
        test_skip("too large for this build");
    uint8_t *zeros = calloc(1, raw);
    uLongf n = compressBound(raw);
    uint8_t *packed = malloc(n), *file = malloc(n + 100);
    if (!zeros || !packed || !file || compress(packed, &n, zeros, raw) != Z_OK)
        abort();
    struct liar *l = malloc(sizeof *l);
    make_png(l, SIDE, SIDE, 16, 6, 0);
    memcpy(file, l->data, 33); // signature and IHDR
    uint32_t word = __builtin_bswap32((uint32_t)n);
    memcpy(file + 33, &word, 4);
    memcpy(file + 37, "IDAT", 4);
    memcpy(file + 41, packed, n);
    word = __builtin_bswap32((uint32_t)crc32(crc32(0, (const uint8_t *)"IDAT", 4), packed, (uInt)n));
    memcpy(file + 41 + n, &word, 4);
    memcpy(file + 45 + n, "\0\0\0\0IEND\xae\x42\x60\x82", 12);
    EXPECT_EQUAL_INT(judge_alone("honest.png", file, n + 57, free_B + ((size_t)SIDE * SIDE * 16)), 0);
    EXPECT_EQUAL_INT(judge_alone("cut.png", file, n / 2, free_B),
                     1); // half of it: refused before memory for the whole is taken
    free(l);
    free(zeros);
    free(packed);
    free(file);
}
