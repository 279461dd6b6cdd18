/* SPDX-License-Identifier: MIT */
/* For the tests of the laboratory: specimens and beams out of one line of words. */
#ifndef SR_TESTS_UNIT_LAB_SPECIMENS_H
#define SR_TESTS_UNIT_LAB_SPECIMENS_H

#include "lab/lab.h"
#include "test.h"

#define PI 3.14159265358979324

/* What it was read into lasts as long as the tests. */
__attribute__((unused)) static struct sr_specimen specimen(const char *words)
{
    static struct sr_arena arena;
    const char *list[30];
    char copy[400], *rest = NULL;
    int count = 0;
    snprintf(copy, sizeof copy, "%s", words);
    for (char *w = strtok_r(copy, " ", &rest); w && count < 30; w = strtok_r(NULL, " ", &rest))
        list[count++] = sr_arena_string(&arena, w);
    struct sr_specimen s;
    struct sr_error error = {0};
    if (sr_specimen_read(&arena, count, list, &s, (struct sr_log){0}, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", words, error.text);
    return s;
}

__attribute__((unused)) static struct sr_beam beam(const char *text)
{
    struct sr_beam b;
    struct sr_error error = {0};
    if (sr_beam_read(text, &b, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return b;
}

#endif
