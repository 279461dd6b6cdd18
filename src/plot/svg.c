/* SPDX-License-Identifier: MIT */
/* cairo's SVG made shorter, and always the same.
 *
 * Surfaces and images bear names with numbers that cairo counts up through the life of a process: they are counted anew
 * from
 * 1. Coordinates are rounded to 0.01 px, and styles that are SVG's defaults are left out: a third of the bytes. */
#include "plot/private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES = 64 };

struct renaming {
    unsigned long known[NAMES];
    int count;
};

void sr_plot_bytes_add(struct plot_bytes *bytes, const void *data, size_t length)
{
    size_t at = bytes->array.count;
    if (at + length > bytes->array.capacity && !sr_array_reserve(&bytes->array, 2 * (at + length), 1)) {
        bytes->is_full = true;
        return;
    }
    memcpy((char *)bytes->array.data + at, data, length);
    bytes->array.count += length;
}

static bool begins(const char *p, const char *word)
{
    return strncmp(p, word, strlen(word)) == 0;
}

/* If a counted name such as surface17 begins at p, where an id or a reference to one stands: its letters' length. */
static size_t counted_name(const char *p, const char *begin)
{
    bool is_id = p - begin >= 4 && memcmp(p - 4, "id=\"", 4) == 0, is_reference = p > begin && p[-1] == '#';
    size_t length = begins(p, "surface") ? 7 : begins(p, "image") ? 5 : 0;
    return (is_id || is_reference) && length && p[length] >= '0' && p[length] <= '9' ? length : 0;
}

static int new_number(struct renaming *names, unsigned long number)
{
    int k = 0;
    while (k < names->count && names->known[k] != number)
        ++k;
    if (k == names->count && k < NAMES)
        names->known[names->count++] = number;
    return k + 1;
}

/* The length of a style at p that says what holds anyway. */
static size_t default_style(const char *p)
{
    static const char *const styles[] = {"stroke-linecap:butt;",  "stroke-linejoin:miter;", "stroke-opacity:1;",
                                         "stroke-miterlimit:10;", "fill-rule:nonzero;",     "fill-opacity:1;"};
    for (size_t i = 0; i < sizeof styles / sizeof styles[0]; ++i)
        if (begins(p, styles[i]))
            return strlen(styles[i]);
    return 0;
}

static void add_rounded(struct plot_bytes *out, double value)
{
    char text[64];
    int n = snprintf(text, sizeof text, "%.2f", value);
    while (text[n - 1] == '0')
        --n;
    if (text[n - 1] == '.')
        --n;
    if (n == 2 && text[0] == '-' && text[1] == '0')
        sr_plot_bytes_add(out, "0", 1);
    else
        sr_plot_bytes_add(out, text, (size_t)n);
}

void sr_plot_shorten_svg(const char *svg, struct plot_bytes *out)
{
    struct renaming names = {0};
    bool is_path = false; // inside d="…"
    for (const char *p = svg; *p;) {
        size_t length = *p == 's' || *p == 'i' ? counted_name(p, svg) : 0,
               style = *p == 's' || *p == 'f' ? default_style(p) : 0;
        if (begins(p, " d=\"")) {
            is_path = true;
            sr_plot_bytes_add(out, p, 4);
            p += 4;
        } else if (length) {
            char *after, number[24];
            int digits = snprintf(number, sizeof number, "%d", new_number(&names, strtoul(p + length, &after, 10)));
            sr_plot_bytes_add(out, p, length);
            sr_plot_bytes_add(out, number, (size_t)digits);
            p = after;
        } else if (style) {
            p += style;
        } else if (is_path && ((*p >= '0' && *p <= '9') || *p == '-')) {
            char *after;
            add_rounded(out, strtod(p, &after));
            p = after;
        } else if (is_path && *p == ' ' && (p[1] == ' ' || p[1] == '"')) {
            ++p;
        } else {
            is_path &= *p != '"';
            sr_plot_bytes_add(out, p++, 1);
        }
    }
}
