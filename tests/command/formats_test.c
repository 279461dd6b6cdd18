/* SPDX-License-Identifier: MIT */
/* The reference of the format: true to the tables, and docs/format.md true to it. */
#include "run.h"

#include <stdio.h>
#include <stdlib.h>

/* all that a stream says, to be freed */
static char *drain(FILE *file)
{
    size_t size = 0, capacity = 1 << 16;
    char *text = malloc(capacity);
    for (size_t n; text && (n = fread(text + size, 1, capacity - size - 1, file)) > 0;) {
        size += n;
        if (capacity - size < 2 && !(text = realloc(text, capacity *= 2)))
            test_fail(__FILE__, __LINE__, "no memory");
    }
    if (text)
        text[size] = 0;
    return text;
}

TEST(format_reference_is_up_to_date)
{
    FILE *now = popen("'" SR_TEST_COMMAND "' formats --markdown", "r"),
         *kept = fopen(SR_TEST_SOURCE_DIR "/docs/format.md", "rb");
    if (!now || !kept)
        test_fail(__FILE__, __LINE__, "the reference cannot be read");
    char *a = drain(now), *b = drain(kept);
    if (pclose(now) != 0)
        test_fail(__FILE__, __LINE__, "formats --markdown failed");
    fclose(kept);
    size_t i = 0, line = 1;
    for (; a[i] && a[i] == b[i]; ++i)
        line += a[i] == '\n';
    if (a[i] != b[i])
        test_fail(__FILE__, __LINE__, "docs/format.md:%zu is not what the program tells: make format-reference", line);
    free(a);
    free(b);
}

TEST(format_reference_tells_who_reads_what)
{
    EXPECT_SAYS(run_expecting(0, "formats Shape sphere")->out, "phimax");
    EXPECT_SAYS(run_expecting(0, "formats Camera fisheye")->out, "(Steradian only)");
    EXPECT_SAYS(run_expecting(0, "formats directive Rotate")->out, "axis");
    EXPECT_SAYS(run_expecting(2, "formats Shapes")->err, "there is no Shapes");
    json_t *all = json_of(run_expecting(0, "formats --json LightSource"));
    bool found = false;
    for (size_t i = 0; i < json_array_size(all); ++i) {
        json_t *one = json_array_get(all, i), *rows = json_object_get(one, "parameters");
        if (strcmp(json_string_value(json_object_get(one, "name")), "spot") != 0)
            continue;
        for (size_t k = 0; k < json_array_size(rows); ++k) {
            json_t *row = json_array_get(rows, k);
            if (strcmp(json_string_value(json_object_get(row, "name")), "coneangle") != 0)
                continue;
            found = true;
            EXPECT_EQUAL_TEXT(json_string_value(json_object_get(row, "default")), "30");
            EXPECT_EQUAL_TEXT(json_string_value(json_object_get(row, "unit")), "deg");
            if (!json_is_true(json_object_get(row, "pbrt")))
                test_fail(__FILE__, __LINE__, "pbrt reads coneangle");
        }
    }
    if (!found)
        test_fail(__FILE__, __LINE__, "the spotlight's angle is not there");
    json_decref(all);
}

/* Every directive that is read has a sentence in the reference. */
TEST(format_reference_explains_each_directive)
{
    static const char *const kinds[] = {"formats --json directive", "formats --json annotation"};
    for (int k = 0; k < 2; ++k) {
        json_t *all = json_of(run_expecting(0, kinds[k]));
        for (size_t i = 0; i < json_array_size(all); ++i) {
            const char *text = json_string_value(json_object_get(json_array_get(all, i), "text"));
            if (!text || !text[0])
                test_fail(__FILE__, __LINE__, "%s has no sentence",
                          json_string_value(json_object_get(json_array_get(all, i), "name")));
        }
        json_decref(all);
    }
}
