/* SPDX-License-Identifier: MIT */
/* Memory, files, errors, threads. */
#include "test.h"

#include <stdatomic.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

static const char *in_folder(const char *name)
{
    static char path[2][512];
    static int turn;
    turn ^= 1;
    snprintf(path[turn], sizeof path[turn], "%s/%s", test_folder(), name);
    return path[turn];
}

TEST(allocations_are_aligned_zeroed_and_counted)
{
    uint64_t before = sr_alloc_count();
    char *p = sr_alloc(100);
    EXPECT(p && (uintptr_t)p % 64 == 0);
    for (int i = 0; i < 100; ++i)
        EXPECT(p[i] == 0);
    memset(p, 7, 100);
    p = sr_realloc(p, 100, 1000);
    EXPECT(p[99] == 7 && p[100] == 0 && p[999] == 0);
    EXPECT_EQUAL_INT(sr_alloc_count() - before, 2);
    EXPECT(sr_realloc(p, 1000, SIZE_MAX / 2) == NULL);
    EXPECT(p[99] == 7); // still valid
    sr_free(p);
    sr_free(NULL);
    EXPECT(sr_alloc(SIZE_MAX - 10) == NULL);
    p = sr_alloc(0);
    EXPECT(p);
    sr_free(p);
}

TEST(arenas_hand_out_disjoint_zeroed_aligned_pieces)
{
    struct sr_arena arena = {0};
    enum { PIECES = 3000 };
    static unsigned char *piece[PIECES];
    static size_t size[PIECES];
    size_t sum = 0;
    for (size_t i = 0; i < PIECES; ++i) {
        size[i] = i % 97 == 5 ? 40000 * (i % 7) : i % 300;
        piece[i] = sr_arena_alloc(&arena, size[i]);
        EXPECT(piece[i] && (uintptr_t)piece[i] % 64 == 0);
        for (size_t k = 0; k < size[i]; ++k)
            EXPECT(piece[i][k] == 0);
        memset(piece[i], (int)(i % 255) + 1, size[i]);
        sum += size[i];
    }
    for (size_t i = 0; i < PIECES; ++i)
        for (size_t k = 0; k < size[i]; ++k)
            EXPECT(piece[i][k] == i % 255 + 1);
    EXPECT(arena.total >= sum && arena.total < sum + 64 * PIECES);
    EXPECT(sr_arena_alloc(&arena, SIZE_MAX - 5) == NULL);
    EXPECT_EQUAL_TEXT(sr_arena_string(&arena, "light"), "light");
    EXPECT_EQUAL_TEXT(sr_arena_printf(&arena, "%d lx at %s", 500, "the desk"), "500 lx at the desk");
    int value = 42, *copy = sr_arena_copy(&arena, &value, sizeof value);
    EXPECT(copy != &value && *copy == 42);
    sr_arena_free(&arena);
    EXPECT(arena.blocks == NULL && arena.total == 0);
    EXPECT(sr_arena_alloc(&arena, 10)); // an emptied arena works again
    sr_arena_free(&arena);
}

TEST(arrays_grow_and_keep_their_elements)
{
    struct sr_array array = {0};
    for (int i = 0; i < 10000; ++i) {
        int *element = sr_array_push(&array, sizeof *element);
        EXPECT(element && *element == 0);
        *element = i * i;
    }
    EXPECT_EQUAL_INT(array.count, 10000);
    for (int i = 0; i < 10000; ++i)
        EXPECT_EQUAL_INT(((int *)array.data)[i], i * i);
    EXPECT(!sr_array_reserve(&array, SIZE_MAX / 16, sizeof(int)));
    EXPECT(array.count == 10000 && ((int *)array.data)[3] == 9);
    sr_array_free(&array);
    EXPECT(array.data == NULL && array.count == 0);
}

TEST(the_first_error_sticks)
{
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_fail(&error, SR_ERROR_INPUT, "line %d", 7), SR_ERROR_INPUT);
    EXPECT_EQUAL_INT(sr_fail(&error, SR_ERROR_RESOURCE, "later"), SR_ERROR_RESOURCE);
    EXPECT_EQUAL_INT(error.status, SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "line 7");
    EXPECT_EQUAL_INT(sr_fail(NULL, SR_ERROR_USAGE, "nobody listens"), SR_ERROR_USAGE);
    struct sr_error full = {0};
    sr_fail(&full, SR_ERROR_INPUT, "%2000d", 1);
    EXPECT_EQUAL_INT(strlen(full.text), sizeof full.text - 1);
}

static void remember(void *user, enum sr_severity severity, const char *text)
{
    snprintf(user, 64, "%d %s", (int)severity, text);
}

TEST(messages_reach_their_listener_and_warnings_are_counted)
{
    char heard[64] = "";
    struct sr_log log = {.write = remember, .user = heard};
    sr_log(&log, SR_WARNING, "%s is unused", "roughness");
    EXPECT_EQUAL_TEXT(heard, "1 roughness is unused");
    sr_log(&log, SR_INFO, "done");
    EXPECT_EQUAL_TEXT(heard, "0 done");
    EXPECT_EQUAL_INT(log.warning_count, 1);
    struct sr_log deaf = {0};
    sr_log(&deaf, SR_WARNING, "unheard");
    EXPECT_EQUAL_INT(deaf.warning_count, 1);
    sr_log(NULL, SR_WARNING, "silence");
}

TEST(files_are_written_whole_and_read_back)
{
    struct sr_error error = {0};
    const char *path = in_folder("whole.bin");
    static unsigned char bytes[200001];
    for (size_t i = 0; i < sizeof bytes; ++i)
        bytes[i] = (unsigned char)(i * 7 >> 3);
    size_t sizes[] = {0, 1, 65536, sizeof bytes}, size;
    char *data;
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQUAL_INT(sr_file_write(path, bytes, sizes[i], &error), SR_OK);
        EXPECT_EQUAL_INT(sr_file_read(path, 1 << 20, &data, &size, &error), SR_OK);
        EXPECT_EQUAL_INT(size, sizes[i]);
        EXPECT(memcmp(data, bytes, size) == 0 && data[size] == 0);
        sr_free(data);
    }
    EXPECT(sr_file_exists(path));
    EXPECT_EQUAL_INT(sr_file_read(path, sizeof bytes - 1, &data, &size, &error), SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "limit") && data == NULL);
    unlink(path);
}

TEST(gzip_is_unpacked_bounded_and_checked)
{
    struct sr_error error = {0};
    const char *path = in_folder("text.gz");
    static char text[300000];
    memset(text, 'a', sizeof text);
    for (int member = 0; member < 2; ++member) { // the second is appended
        gzFile gz = gzopen(path, member ? "ab" : "wb");
        EXPECT_EQUAL_INT(gzwrite(gz, text, sizeof text), sizeof text);
        gzclose(gz);
    }
    char *data;
    size_t size;
    EXPECT_EQUAL_INT(sr_file_read(path, 1 << 20, &data, &size, &error), SR_OK);
    EXPECT_EQUAL_INT(size, 2 * sizeof text);
    EXPECT(data[0] == 'a' && data[size - 1] == 'a' && data[size] == 0);
    sr_free(data);
    EXPECT_EQUAL_INT(sr_file_read(path, sizeof text, &data, &size, &error), SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "unpacks to more"));

    struct stat st;
    EXPECT(stat(path, &st) == 0 && truncate(path, st.st_size - 12) == 0);
    struct sr_error damaged = {0};
    EXPECT_EQUAL_INT(sr_file_read(path, 1 << 20, &data, &size, &damaged), SR_ERROR_INPUT);
    EXPECT(strstr(damaged.text, "cut short") && data == NULL);
    unlink(path);
}

TEST(failed_reads_and_writes_say_why_and_leave_nothing)
{
    struct sr_error error = {0};
    char *data;
    size_t size;
    EXPECT_EQUAL_INT(sr_file_read(in_folder("absent"), 100, &data, &size, &error), SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "absent") && strstr(error.text, "No such file"));
    struct sr_error folder = {0};
    EXPECT_EQUAL_INT(sr_file_read(test_folder(), 100, &data, &size, &folder), SR_ERROR_INPUT);
    EXPECT(strstr(folder.text, "folder"));
    struct sr_error write = {0};
    EXPECT_EQUAL_INT(sr_file_write(in_folder("no/such/place"), "x", 1, &write), SR_ERROR_RESOURCE);
    EXPECT(strstr(write.text, "no/such/place"));
    struct sr_error onto = {0};
    EXPECT_EQUAL_INT(sr_file_write(test_folder(), "x", 1, &onto), SR_ERROR_RESOURCE);

    // an old file stays whole until the new one takes its name, and nothing is left beside it
    const char *path = in_folder("kept");
    EXPECT_EQUAL_INT(sr_file_write(path, "old", 3, &(struct sr_error){0}), SR_OK);
    EXPECT_EQUAL_INT(sr_file_write(path, "newer", 5, &(struct sr_error){0}), SR_OK);
    EXPECT_EQUAL_INT(sr_file_read(path, 100, &data, &size, &(struct sr_error){0}), SR_OK);
    EXPECT_EQUAL_TEXT(data, "newer");
    sr_free(data);
    char beside[600];
    snprintf(beside, sizeof beside, "%s.part-%ld", path, (long)getpid());
    EXPECT(!sr_file_exists(beside));
    unlink(path);
}

TEST(devices_are_refused_and_pipes_are_waited_for)
{
    struct sr_error device = {0}, error = {0};
    char *data;
    size_t size;
    EXPECT_EQUAL_INT(sr_file_read("/dev/zero", SIZE_MAX / 2, &data, &size, &device), SR_ERROR_INPUT);
    EXPECT(strstr(device.text, "is a device"));

    const char *path = in_folder("pipe");
    EXPECT(mkfifo(path, 0600) == 0);
    pid_t writer = fork();
    if (writer == 0) { // comes late, and takes its time
        usleep(100000);
        FILE *pipe = fopen(path, "w");
        usleep(100000);
        _exit(pipe && fputs("late", pipe) >= 0 && fclose(pipe) == 0 ? 0 : 1);
    }
    EXPECT_EQUAL_INT(sr_file_read(path, 100, &data, &size, &error), SR_OK);
    EXPECT(size == 4 && memcmp(data, "late", 4) == 0);
    sr_free(data);
    int status;
    EXPECT(waitpid(writer, &status, 0) == writer && status == 0);
    unlink(path);
}

TEST(paths_are_seen_from_their_folder)
{
    struct sr_arena arena = {0};
    EXPECT_EQUAL_TEXT(sr_path_beside(&arena, "scenes/room/a.pbrt", "maps/b.exr"), "scenes/room/maps/b.exr");
    EXPECT_EQUAL_TEXT(sr_path_beside(&arena, "a.pbrt", "b.exr"), "b.exr");
    EXPECT_EQUAL_TEXT(sr_path_beside(&arena, "scenes/a.pbrt", "/b.exr"), "/b.exr");
    EXPECT_EQUAL_TEXT(sr_path_beside(&arena, "/a.pbrt", "b.exr"), "/b.exr");
    EXPECT(sr_path_has_ending("A.EXR", ".exr") && !sr_path_has_ending("exr", ".exr") &&
           !sr_path_has_ending("a.exr.gz", ".exr"));
    sr_arena_free(&arena);
}

struct work {
    atomic_int done[5000];
    atomic_ullong threads;
};

static void count_one(void *context, uint64_t i)
{
    atomic_fetch_add(&((struct work *)context)->done[i], 1);
}

static void count_thread(void *context, int thread)
{
    atomic_fetch_or(&((struct work *)context)->threads, 1ull << thread);
}

TEST(parallel_for_does_each_piece_once)
{
    static struct work work;
    for (int threads = 1; threads <= 9; threads += 4) {
        memset(&work, 0, sizeof work);
        sr_parallel_for(threads, 5000, count_one, &work);
        for (int i = 0; i < 5000; ++i)
            EXPECT_EQUAL_INT(atomic_load(&work.done[i]), 1);
        sr_parallel(threads, count_thread, &work);
        EXPECT_EQUAL_INT(atomic_load(&work.threads), (1ull << threads) - 1);
    }
    sr_parallel_for(3, 0, count_one, NULL);
    EXPECT(sr_thread_count() >= 1);
}

/* Address space for no more threads: the caller does their part, and still knows denormals. */
TEST(parallel_work_is_done_where_no_thread_can_be_had)
{
    if (is_slow_build())
        return; // sanitizers want address space of their own
    struct rlimit had, none;
    getrlimit(RLIMIT_AS, &had);
    none = had;
    none.rlim_cur = 1 << 20;
    static struct work work;
    sr_parallel(60, count_thread, &work); // the stack has grown to what is needed
    memset(&work, 0, sizeof work);
    setrlimit(RLIMIT_AS, &none);
    sr_parallel(60, count_thread, &work);
    setrlimit(RLIMIT_AS, &had);
    EXPECT_EQUAL_INT(atomic_load(&work.threads), (1ull << 60) - 1);
    volatile double tiny = 1e-310;
    EXPECT(tiny * 2 > 0);
}

TEST(the_clock_runs_and_memory_is_known)
{
    double t = sr_clock_s();
    EXPECT(sr_clock_s() >= t);
    EXPECT(sr_peak_memory_B() > 100000 && sr_peak_memory_B() < 1ull << 40);
}
