/* SPDX-License-Identifier: MIT */
/* Files cut anywhere, with words swapped, with sizes blown up: each is read, or refused with a reason; nothing crashes,
 * nothing takes more than 16 times the file's size and 64 MiB, nothing takes long.
 *
 * Each file is damaged in a process of its own, in a folder whose other entries lead to those of the file's own folder,
 * so that meshes and images are found. Reading is held by a limit of the address space; building (some of the damaged
 * files) by the memory that was in use, in which the ray caster's hierarchy counts as well. */
#define _GNU_SOURCE
#include "import/describe.h"
#include "import/pbrt/description.h"
#include "test.h"

#include <dirent.h>
#include <ftw.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { SANITIZED = 1, CUTS = 12, SWAPS = 4, BLOWS = 4, BUILDS = 2 };
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
enum { SANITIZED = 1, CUTS = 12, SWAPS = 4, BLOWS = 4, BUILDS = 2 };
#else
enum { SANITIZED = 0, CUTS = 100, SWAPS = 20, BLOWS = 20, BUILDS = 4 };
#endif
#else
enum { SANITIZED = 0, CUTS = 100, SWAPS = 20, BLOWS = 20, BUILDS = 4 };
#endif
enum { VARIANTS = CUTS + SWAPS + BLOWS, SECONDS = SANITIZED ? 200 : 10 };
static const size_t free_B = (size_t)64 << 20;

static char work[1024]; // the folder of the file at work
static uint64_t state;

static uint32_t draw(uint32_t below)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return below ? (uint32_t)(state >> 33) % below : 0;
}

/* ---- damage ---- */

struct bytes {
    char *data;
    size_t size;
};

static bool is_text(const struct bytes *b)
{
    return !memchr(b->data, 0, b->size < 4096 ? b->size : 4096);
}

static bool is_gap(char c)
{
    return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == ',';
}

/* a word at random: where it begins and how long it is */
static size_t pick_word(const struct bytes *b, size_t *length)
{
    size_t at = draw((uint32_t)b->size), end;
    while (at > 0 && !is_gap(b->data[at - 1]))
        --at;
    while (at < b->size && is_gap(b->data[at]))
        ++at;
    for (end = at; end < b->size && !is_gap(b->data[end]) && end - at < 60; ++end)
        ;
    *length = end - at;
    return at;
}

static void replace(struct bytes *b, size_t at, size_t length, const char *word, size_t word_length)
{
    char *now = malloc(b->size - length + word_length + 1);
    if (!now)
        return;
    memcpy(now, b->data, at);
    memcpy(now + at, word, word_length);
    memcpy(now + at + word_length, b->data + at + length, b->size - at - length);
    b->size += word_length - length;
    now[b->size] = 0;
    free(b->data);
    b->data = now;
}

static void swap_words(struct bytes *b)
{
    size_t n, m, first = pick_word(b, &n), second = pick_word(b, &m);
    char one[64], other[64];
    if (first > second || first + n > second)
        return;
    memcpy(one, b->data + first, n);
    memcpy(other, b->data + second, m);
    replace(b, second, m, one, n);
    replace(b, first, n, other, m);
}

/* a number that is much too large, in place of one that is there */
static void blow_up(struct bytes *b)
{
    static const char *const huge[] = {"4294967295", "2147483647", "-1",         "99999999999999999999",
                                       "1e38",       "1e308",      "1000000000", "nan"};
    if (!is_text(b)) {
        static const uint32_t words[] = {0xffffffffu, 0x7fffffffu, 0x10000000u, 0x7f800000u, 100000000u};
        if (b->size > 8)
            memcpy(b->data +
                       (draw(2) ? draw(256 < b->size - 4 ? 256 : (uint32_t)b->size - 4) : draw((uint32_t)b->size - 4)),
                   &words[draw(5)], 4);
        return;
    }
    for (int tries = 0; tries < 50; ++tries) {
        size_t n, at = pick_word(b, &n), digits = 0;
        while (digits < n && !(b->data[at + digits] >= '0' && b->data[at + digits] <= '9'))
            ++digits;
        size_t end = digits;
        while (end < n && b->data[at + end] >= '0' && b->data[at + end] <= '9')
            ++end;
        if (end > digits) {
            const char *word = huge[draw(sizeof huge / sizeof *huge)];
            replace(b, at + digits, end - digits, word, strlen(word));
            return;
        }
    }
}

static struct bytes damage(const struct bytes *whole, int variant)
{
    struct bytes b = {malloc(whole->size + 1), whole->size};
    if (!b.data)
        return b;
    memcpy(b.data, whole->data, whole->size);
    if (variant < CUTS)
        b.size = whole->size * (size_t)variant / CUTS;
    b.data[b.size] = 0;
    if (variant >= CUTS && b.size > 16) {
        if (variant < CUTS + SWAPS && is_text(&b))
            swap_words(&b);
        else
            blow_up(&b);
    }
    return b;
}

/* ---- judging ---- */

static void limit(size_t bytes)
{
    struct rlimit r = {bytes, RLIM_INFINITY};
    if (!SANITIZED)
        setrlimit(RLIMIT_AS, &r);
}

static const char *judge(sr_status status, const struct sr_error *error)
{
    if (status == SR_OK)
        return error->status == SR_OK ? NULL : "read, with an error";
    if (status == SR_ERROR_RESOURCE)
        return "it took too much memory";
    if (status != SR_ERROR_INPUT)
        return "another status than input";
    return error->text[0] ? NULL : "refused without a reason";
}

static const char *read_one(const char *path, size_t size, bool builds)
{
    static const struct sr_import_options nothing;
    struct sr_error error = {0};
    struct sr_arena data = {0};
    struct sr_pbrt_description d = {0};
    if (!builds && test_address_space_B())
        limit(test_address_space_B() + 16 * size + free_B);
    sr_status status = sr_describe(path, &nothing, &data, NULL, &d, &error);
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
    if (!builds)
        limit(RLIM_INFINITY);
    const char *verdict = judge(status, &error);
    if (verdict || status != SR_OK || !builds)
        return verdict;
    struct sr_import_result result;
    struct sr_import_options options = {.threads = 1, .width = 4, .height = 3, .spp = 1};
    error = (struct sr_error){0};
    status = sr_import_pbrt(path, &options, &result, NULL, &error);
    sr_import_result_free(&result);
    return judge(status, &error);
}

/* What the file and its neighbours hold, as far as scenes read it. */
static size_t folder_B;
static int add_size(const char *path, const struct stat *status, int type, struct FTW *place)
{
    (void)path;
    (void)place;
    folder_B += type == FTW_F ? (size_t)status->st_size : 0;
    return 0;
}

/* In a process of its own; the verdict goes to standard error. */
static void torture(const char *path, const char *copy, const struct bytes *whole)
{
    const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; ++i) // the test library would go on with the next test
        signal(signals[i], SIG_DFL);
    bool is_gltf = sr_path_has_ending(path, ".gltf"); // its buffers are other files
    for (int v = 0; v < VARIANTS; ++v) {
        struct bytes b = damage(whole, v);
        FILE *f = b.data ? fopen(copy, "wb") : NULL;
        if (!f || fwrite(b.data, 1, b.size, f) != b.size || fclose(f) != 0)
            _exit(2);
        free(b.data);
        bool builds = v % ((VARIANTS + BUILDS - 1) / BUILDS) == 5 % ((VARIANTS + BUILDS - 1) / BUILDS) &&
                      whole->size + folder_B < (size_t)4 << 20;
        setitimer(ITIMER_PROF, &(struct itimerval){.it_value = {.tv_sec = SECONDS}}, NULL); // of the processor
        const char *verdict = read_one(copy, b.size + (is_gltf ? folder_B : 0), builds);
        if (verdict) {
            fprintf(stderr, "%s, damaged in way %d: %s\n", path, v, verdict);
            _exit(1);
        }
    }
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    size_t peak = (size_t)usage.ru_maxrss << 10, most = 16 * (whole->size + folder_B) + free_B;
    if (!SANITIZED && peak > most + ((size_t)32 << 20) /* the program itself, with its tables */) {
        fprintf(stderr, "%s: %zu MiB at the peak, of %zu MiB that are allowed\n", path, peak >> 20, most >> 20);
        _exit(1);
    }
    _exit(0);
}

static void link_neighbours(const char *folder)
{
    DIR *dir = opendir(folder);
    for (struct dirent *e; dir && (e = readdir(dir));) {
        char from[4096], to[4096];
        if (e->d_name[0] == '.' || snprintf(from, sizeof from, "%s/%s", folder, e->d_name) >= (int)sizeof from ||
            snprintf(to, sizeof to, "%s/%s", work, e->d_name) >= (int)sizeof to)
            continue;
        if (symlink(from, to) != 0)
            test_fail(__FILE__, __LINE__, "%s cannot be linked", e->d_name);
    }
    if (dir)
        closedir(dir);
}

static void remove_links(void)
{
    DIR *dir = opendir(work);
    for (struct dirent *e; dir && (e = readdir(dir));) {
        char path[4096];
        if (e->d_name[0] != '.' && snprintf(path, sizeof path, "%s/%s", work, e->d_name) < (int)sizeof path)
            unlink(path);
    }
    if (dir)
        closedir(dir);
    rmdir(work);
}

static int files;

static void try_file(const char *path, size_t most_B)
{
    char folder[4096], copy[4096];
    const char *slash = strrchr(path, '/');
    struct bytes whole = {0};
    struct sr_error error = {0};
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
    snprintf(work, sizeof work, "%s/damaged", test_folder());
    if (mkdir(work, 0777) != 0 || sr_file_read(path, (size_t)1 << 30, &whole.data, &whole.size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", path, error.text);
    if (whole.size > 0 && whole.size <= most_B) {
        link_neighbours(folder);
        folder_B = 0;
        nftw(folder, add_size, 16, FTW_PHYS);
        snprintf(copy, sizeof copy, "%s/damaged-%s", work, slash + 1);
        state = whole.size;
        ++files;
        int status;
        fflush(NULL);
        pid_t pid = fork();
        if (pid == 0)
            torture(path, copy, &whole);
        EXPECT(waitpid(pid, &status, 0) == pid);
        remove_links();
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
            test_fail(__FILE__, __LINE__, "%s: %s %d", path, WIFEXITED(status) ? "code" : "signal",
                      WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
    } else
        remove_links();
    sr_free(whole.data);
}

static int per_folder;
static char last_folder[4096];

static int visit(const char *path, const struct stat *status, int type, struct FTW *place)
{
    static const char *const endings[] = {".pbrt", ".gltf", ".glb", ".obj", ".stl", ".ply"};
    if (type != FTW_F || sr_path_has_ending(path, ".ref.pbrt"))
        return 0;
    if (strncmp(last_folder, path, (size_t)place->base) != 0 || last_folder[place->base] != 0) {
        snprintf(last_folder, sizeof last_folder, "%.*s", place->base, path);
        per_folder = 0;
    }
    bool is_mesh = sr_path_has_ending(path, ".ply") || sr_path_has_ending(path, ".glb");
    for (size_t i = 0; i < sizeof endings / sizeof *endings; ++i)
        if (sr_path_has_ending(path, endings[i]) &&
            (!sr_path_has_ending(path, ".ply") || per_folder++ < 2)) // some meshes of each scene are enough
            try_file(path, is_mesh ? (size_t)600 << 10 : (size_t)2 << 20);
    (void)status;
    return 0;
}

TEST(damaged_scenes_of_our_own_are_read_or_refused)
{
    files = 0;
    nftw(SR_TEST_SOURCE_DIR "/scenes", visit, 16, FTW_PHYS);
    EXPECT(files >= 4);
}

TEST(damaged_reference_scenes_are_read_or_refused)
{
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", test_reference_file("scenes"));
    files = 0;
    nftw(folder, visit, 16, FTW_PHYS);
    EXPECT(files >= 20);
}

TEST(damaged_gltf_models_are_read_or_refused)
{
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", test_reference_file("gltf"));
    files = 0;
    nftw(folder, visit, 16, FTW_PHYS);
    EXPECT(files >= 20);
}

/* ---- formats that no reference scene has ---- */

static void put(const char *name, const void *data, size_t size)
{
    char path[1024];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    EXPECT(sr_file_write(path, data, size, &error) == SR_OK);
    try_file(path, (size_t)2 << 20);
    unlink(path);
}

TEST(damaged_meshes_of_other_formats_are_read_or_refused)
{
    enum { N = 40 };
    char *text = malloc(1 << 20), *p = text;
    EXPECT(text != NULL);
    if (!text)
        return;
    p += sprintf(p, "mtllib none.mtl\n");
    for (int i = 0; i < N * N; ++i)
        p += sprintf(p, "v %g %g %g\nvt %g %g\nvn 0 0 1\n", i % N * 0.1, i / N * 0.1, (i * 37 % 11) * 0.01,
                     i % N / 40.0, i / N / 40.0);
    for (int i = 0; i + N + 1 < N * N; ++i) {
        if (i % 200 == 0)
            p += sprintf(p, "g part%d\nusemtl m%d\n", i, i % 3);
        p += sprintf(p, "f %d/%d/%d %d/%d/%d -%d %d//%d\n", i + 1, i + 1, i + 1, i + 2, i + 2, i + 2, N * N - i - N - 1,
                     i + N + 1, 1);
    }
    p += sprintf(p, "f");
    for (int i = 1; i < 600; ++i)
        p += sprintf(p, " %d", i * 7 % 1600 + 1);
    p += sprintf(p, "\n");
    put("grid.obj", text, (size_t)(p - text));
    p = text + sprintf(text, "solid grid\n");
    for (int i = 0; i < 500; ++i)
        p += sprintf(
            p, "facet normal 0 0 1\nouter loop\nvertex %d 0 0\nvertex %d 1 0\nvertex %d 0.5 1\nendloop\nendfacet\n", i,
            i, i + 1);
    put("text.stl", text, (size_t)(p - text));
    memset(text, 0, 84 + 50 * 500);
    text[80] = (char)(500 & 255);
    text[81] = (char)(500 >> 8);
    for (int i = 0; i < 500; ++i)
        for (int k = 0; k < 9; ++k) {
            float v = (float)((i * 31 + k * 17) % 100);
            memcpy(text + 84 + 50 * i + 12 + 4 * k, &v, 4);
        }
    put("binary.stl", text, 84 + 50 * 500);
    free(text);
}
