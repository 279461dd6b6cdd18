/* SPDX-License-Identifier: MIT */
#include "import/number.h"
#include "import/pbrt/lexer.h"
#include "test.h"

static struct sr_arena arena;

static struct sr_pbrt_lexer start(const char *text)
{
    return sr_pbrt_lexer_start("a.pbrt", text, strlen(text), &arena);
}

TEST(tokens_know_kind_line_and_column)
{
    struct sr_pbrt_lexer l = start("Shape \"sphere\" # a [comment]\n\t\"float radius\" [ .5 ]\r\n#last");
    static const struct {
        enum sr_pbrt_token_kind kind;
        const char *text;
        int line, column;
    } expected[] = {
        {SR_PBRT_WORD, "Shape", 1, 1}, {SR_PBRT_STRING, "sphere", 1, 7}, {SR_PBRT_STRING, "float radius", 2, 2},
        {SR_PBRT_OPEN, "[", 2, 17},    {SR_PBRT_WORD, ".5", 2, 19},      {SR_PBRT_CLOSE, "]", 2, 22},
        {SR_PBRT_END, "", 3, 6}};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; ++i) {
        struct sr_pbrt_token t;
        struct sr_error e = {0};
        EXPECT_EQUAL_INT(sr_pbrt_lexer_next(&l, &t, &e), SR_OK);
        EXPECT_EQUAL_INT(t.kind, expected[i].kind);
        EXPECT_EQUAL_INT(t.length, strlen(expected[i].text));
        EXPECT(memcmp(t.text, expected[i].text, t.length) == 0);
        EXPECT_EQUAL_INT(t.where.line, expected[i].line);
        EXPECT_EQUAL_INT(t.where.column, expected[i].column);
    }
}

TEST(strings_resolve_their_escapes)
{
    struct sr_pbrt_lexer l = start("\"a\\\"b\\\\c\\n\\t\\'\"");
    struct sr_pbrt_token t;
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_pbrt_lexer_next(&l, &t, &e), SR_OK);
    EXPECT_EQUAL_INT(t.length, 8);
    EXPECT(memcmp(t.text, "a\"b\\c\n\t'", 8) == 0);
    sr_arena_free(&arena);
}

TEST(broken_strings_tell_where)
{
    struct sr_pbrt_lexer l = start("\n  \"abc\n\"");
    struct sr_pbrt_token t;
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_pbrt_lexer_next(&l, &t, &e), SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(e.text, "a.pbrt:2:3: this string has no closing \" on its line");
    e = (struct sr_error){0};
    l = start("\"a\\q\"");
    EXPECT_EQUAL_INT(sr_pbrt_lexer_next(&l, &t, &e), SR_ERROR_INPUT);
    EXPECT(strncmp(e.text, "a.pbrt:1:3: unknown escape", 26) == 0);
}

static double number(const char *text)
{
    double v = NAN;
    const char *end = sr_number_read(text, &v);
    return end && *end == 0 ? v : (double)NAN;
}

TEST(numbers_are_those_of_the_c_library)
{
    static const char *const texts[] = {"0",
                                        "-0",
                                        "1",
                                        "+7",
                                        ".5",
                                        "5.",
                                        "-.25e1",
                                        "1e10",
                                        "1E-10",
                                        "3.14159265358979323846",
                                        "0.1",
                                        "123456789012345678901234567890",
                                        "1e22",
                                        "1e-22",
                                        "1.7976931348623157e308",
                                        "0.000000000000000000000000000001234567890123456789012345",
                                        "4.37114e-8",
                                        "33554433",
                                        "16777217",
                                        "3.4028235e38",
                                        "1.4e-45",
                                        "9007199254740993",
                                        "00000000000000000000000001.5"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i)
        EXPECT_RELATIVE(number(texts[i]), strtod(texts[i], NULL), 4e-16);
    uint64_t state = 1;
    for (int i = 0; i < 100000; ++i) { // random floats in the digits that programs write
        state = state * 6364136223846793005u + 1442695040888963407u;
        uint32_t bits = (uint32_t)(state >> 32);
        float f;
        memcpy(&f, &bits, sizeof f);
        char text[64];
        snprintf(text, sizeof text, i % 2 ? "%.9g" : "%.17g", (double)f);
        if (isfinite(f) && (float)number(text) != f)
            test_fail(__FILE__, __LINE__, "%s became %.9g", text, number(text));
    }
}

TEST(what_is_no_number_is_refused)
{
    static const char *const texts[] = {"", "-", ".", "e5", "1x", "--1", "1.2.3", "abc"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i)
        EXPECT(isnan(number(texts[i])));
    EXPECT_EQUAL_INT(number("1e400") > 1e308, 1);
    EXPECT_NEAR(number("1e-400"), 0, 0);
    double v;
    EXPECT(sr_number_read_hex("0x1F", &v) && v == 31);
    EXPECT(!sr_number_read_hex("0x", &v));
}
