/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700
#include "test.h"

#include "temporary.h"

#include <ftw.h>
#include <setjmp.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#define MAX_TESTS 1024
static struct CMUnitTest tests[MAX_TESTS];
static size_t test_count;

double test_processor_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// slow tests say so, for whoever wants the suite to be faster
static void run(void **state)
{
    double start = test_processor_s();
    (*(void (**)(void))state)();
    double taken = test_processor_s() - start;
    if (taken >= 2)
        fprintf(stderr, "             %.1f s of processor time\n", taken);
}

void test_register(const char *file, const char *name, void (*run_test)(void))
{
    (void)file;
    if (test_count == MAX_TESTS)
        abort();
    void *initial;
    memcpy(&initial, &run_test, sizeof initial);
    tests[test_count++] = (struct CMUnitTest){.name = name, .test_func = run, .initial_state = initial};
}

void test_fail(const char *file, int line, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    test_print_failure(file, line, format, arguments);
    va_end(arguments);
    _fail(file, line);
    abort();
}

void test_skip(const char *why)
{
    fprintf(stderr, "skipped: %s\n", why);
    _skip(__FILE__, __LINE__);
    abort();
}

void test_near(const char *file, int line, const char *what, double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        test_fail(file, line, "%s = %.12g, expected %.12g within %.3g, off by %.3g", what, value, expected, tolerance,
                  value - expected);
}

void test_equal_int(const char *file, int line, const char *what, long long value, long long expected)
{
    if (value != expected)
        test_fail(file, line, "%s = %lld, expected %lld", what, value, expected);
}

void test_equal_text(const char *file, int line, const char *what, const char *value, const char *expected)
{
    if (!value || strcmp(value, expected) != 0)
        test_fail(file, line, "%s = \"%s\", expected \"%s\"", what, value ? value : "(null)", expected);
}

void test_mean(const char *file, int line, const char *what, const struct sr_tally *tally, double expected)
{
    double se = sr_tally_standard_error(tally);
    // floats are added: a constant is never off by less
    double rounding = 4 * (double)SR_MACHINE_EPSILON * fabs(expected);
    if (tally->n < 100 || !(fabs(tally->mean - expected) <= 4.9 * se + rounding))
        test_fail(file, line, "%s: mean %.9g +- %.3g (n = %llu), expected %.9g, z = %.2f", what, tally->mean, se,
                  (unsigned long long)tally->n, expected, (tally->mean - expected) / se);
}

void test_chi2(const char *file, int line, const double *observed, const double *expected, size_t cells)
{
    double chi2;
    int degrees;
    double p = sr_chi2_test(observed, expected, cells, 5, &chi2, &degrees);
    if (!(p > 1e-6))
        test_fail(file, line, "chi2 = %.2f with %d degrees of freedom, p = %.3g", chi2, degrees, p);
}

const char *test_reference_file(const char *name)
{
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", SR_TEST_REFERENCE_DIR, name);
    if (access(path, R_OK) != 0) {
        fprintf(stderr, "%s is not there: ", name);
        test_skip("set STERADIAN_REFERENCE_DIR to the folder of reference scenes");
    }
    return path;
}

size_t test_address_space_B(void)
{
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (f) {
        if (fscanf(f, "%lu", &pages) != 1)
            pages = 0;
        fclose(f);
    }
    return (size_t)pages * (size_t)sysconf(_SC_PAGESIZE);
}

static char folder[512];

const char *test_folder(void)
{
    if (!folder[0] && !make_temporary_folder("test", folder))
        abort();
    return folder;
}

static int remove_entry(const char *path, const struct stat *status, int type, struct FTW *place)
{
    (void)status;
    (void)type;
    (void)place;
    return remove(path);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct CMUnitTest *)a)->name, ((const struct CMUnitTest *)b)->name);
}

int main(int argc, char **argv)
{
    if (argc > 1) // only the tests of that name; * and ? stand for anything
        cmocka_set_test_filter(argv[1]);
    qsort(tests, test_count, sizeof tests[0], by_name);
    int failed = _cmocka_run_group_tests("steradian", tests, test_count, NULL, NULL);
    if (!failed && folder[0]) // else it tells more than the message
        nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    return failed;
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define IS_SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED 1
#endif

bool is_slow_build(void)
{
#ifdef IS_SANITIZED
    return true;
#else
    return false;
#endif
}
