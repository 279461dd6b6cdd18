/* SPDX-License-Identifier: MIT */
/* A thin layer over cmocka: tests are sentences, statistics have verdicts with a known error rate.
 *
 *     TEST(lambert_looks_equally_bright_from_everywhere)
 *     {
 *         EXPECT_NEAR(value, 0.5, 1e-7);
 *     }
 *
 * Every *.c of a folder is linked into one program; its tests register themselves and run in the order of their names.
 */
#ifndef SR_TEST_H
#define SR_TEST_H

#include "math/math.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void test_register(const char *file, const char *name, void (*run)(void));
void test_fail(const char *file, int line, const char *format, ...) __attribute__((format(printf, 3, 4), noreturn));
/* Its message alone, for programs that fail in another way. */
static inline void test_print_failure(const char *file, int line, const char *format, va_list arguments)
{
    fprintf(stderr, "%s:%d: ", file, line);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
}
void test_skip(const char *why) __attribute__((noreturn));

#define TEST(name)                                                                                                     \
    static void test_##name(void);                                                                                     \
    __attribute__((constructor)) static void register_##name(void)                                                     \
    {                                                                                                                  \
        test_register(__FILE__, #name, test_##name);                                                                   \
    }                                                                                                                  \
    static void test_##name(void)

#define EXPECT(condition)                                                                                              \
    do {                                                                                                               \
        if (!(condition))                                                                                              \
            test_fail(__FILE__, __LINE__, "%s", #condition);                                                           \
    } while (0)

/* |value - expected| <= tolerance (absolute), or a failure that tells both */
#define EXPECT_NEAR(value, expected, tolerance)                                                                        \
    test_near(__FILE__, __LINE__, #value, (double)(value), (double)(expected), (double)(tolerance))
#define EXPECT_RELATIVE(value, expected, tolerance)                                                                    \
    test_near(__FILE__, __LINE__, #value, (double)(value), (double)(expected),                                         \
              fabs((double)(expected)) * (double)(tolerance))
#define EXPECT_EQUAL_INT(value, expected)                                                                              \
    test_equal_int(__FILE__, __LINE__, #value, (long long)(value), (long long)(expected))
#define EXPECT_EQUAL_TEXT(value, expected) test_equal_text(__FILE__, __LINE__, #value, value, expected)
/* the tally's mean against its expectation: |z| < 4.9 (one false alarm in a million), and at least n = 100 draws */
#define EXPECT_MEAN(tally, expected) test_mean(__FILE__, __LINE__, #tally, &(tally), (double)(expected))
/* Pearson's chi-square with p > 1e-6 */
#define EXPECT_CHI2(observed, expected, cells) test_chi2(__FILE__, __LINE__, observed, expected, cells)

void test_near(const char *file, int line, const char *what, double value, double expected, double tolerance);
void test_equal_int(const char *file, int line, const char *what, long long value, long long expected);
void test_equal_text(const char *file, int line, const char *what, const char *value, const char *expected);
void test_mean(const char *file, int line, const char *what, const struct sr_tally *tally, double expected);
void test_chi2(const char *file, int line, const double *observed, const double *expected, size_t cells);

/* Whether a sanitizer slows everything down: then tests look for faults of memory, and statistics make do with less. */
bool is_slow_build(void);
/* A file of the optional reference folder; skips the test with a message where it is absent. Static buffer. */
const char *test_reference_file(const char *name);
/* Who waits for so many seconds [s] waits for what never comes: no machine is so slow, nor so busy. */
enum { TEST_FOREVER_S = 900 };
/* What this process has had of processors: limits of time are of that, as other processes take of the clock's. */
double test_processor_s(void);
/* What this process has of its address space, for limits upon that. */
size_t test_address_space_B(void);
/* A fresh temporary folder for this test program; it stays where a test fails. */
const char *test_folder(void);

#endif
