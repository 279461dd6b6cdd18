/* SPDX-License-Identifier: MIT */
/* Numbers and words of text files, whatever the locale, never past the end. */
#include "measured/private.h"

#include <stdio.h>

struct scan scan_start(const char *data, size_t size)
{
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0) {
        data += 3;
        size -= 3;
    }
    return (struct scan){.at = data, .end = data + size, .line_start = data, .line = 0};
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool scan_number(struct scan *s, double *value)
{
    const char *p = s->at, *end = s->end;
    bool negative = p < end && *p == '-';
    p += p < end && (*p == '-' || *p == '+');
    // up to 19 digits are kept exactly, more only shift the point
    uint64_t mantissa = 0;
    int exponent = 0, digits = 0;
    bool any = false, point = false;
    for (; p < end && (is_digit(*p) || (*p == '.' && !point)); ++p) {
        if (*p == '.') {
            point = true;
            continue;
        }
        any = true;
        if (digits < 19) {
            mantissa = mantissa * 10 + (uint64_t)(*p - '0');
            digits += mantissa > 0;
            exponent -= point;
        } else if (exponent < 100000)
            exponent += !point;
    }
    if (!any)
        return false;
    if (p < end && (*p == 'e' || *p == 'E' || *p == 'd' || *p == 'D')) {
        const char *q = p + 1;
        bool down = q < end && *q == '-';
        q += q < end && (*q == '-' || *q == '+');
        if (q < end && is_digit(*q)) {
            int e = 0;
            for (; q < end && is_digit(*q); ++q)
                e = e < 100000 ? e * 10 + (*q - '0') : e;
            exponent += down ? -e : e;
            p = q;
        }
    }
    if (p < end && ((*p >= 'a' && *p <= 'z') || (*p >= 'A' && *p <= 'Z') || *p == '_' || *p == '.'))
        return false; // 3rd, 1.2.3
    double v = (double)mantissa;
    if (v > 0 && exponent)
        v = exponent < 0 && exponent > -300 ? v / pow(10, -exponent) : v * pow(10, exponent);
    *value = negative ? -v : v;
    s->at = p;
    return true;
}

bool scan_line(struct scan *s, const char **begin, const char **end)
{
    if (s->line_start >= s->end)
        return false;
    *begin = s->line_start;
    const char *p = *begin;
    while (p < s->end && *p != '\n' && *p != '\r')
        ++p;
    *end = p;
    if (p < s->end && *p == '\r' && p + 1 < s->end && p[1] == '\n')
        ++p;
    s->line_start = p < s->end ? p + 1 : p;
    s->line++;
    return true;
}

void scan_separators(struct scan *s)
{
    while (s->at < s->end && (*s->at == ' ' || *s->at == '\t' || *s->at == ',' || *s->at == ';'))
        s->at++;
}

bool scan_word(struct scan *s, char *word, size_t size)
{
    size_t n = 0;
    const char *p = s->at;
    for (;
         p < s->end && (is_digit(*p) || (*p >= 'a' && *p <= 'z') || (*p >= 'A' && *p <= 'Z') || *p == '_' || *p == '.');
         ++p)
        if (n + 1 < size)
            word[n++] = *p;
    word[n] = 0;
    bool found = p > s->at;
    s->at = p;
    return found;
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

bool text_equal(const char *a, const char *b)
{
    for (; *a && lower(*a) == lower(*b); ++a)
        ++b;
    return !*a && !*b;
}

bool text_has_prefix(const char *at, const char *end, const char *prefix)
{
    for (; *prefix; ++prefix, ++at)
        if (at >= end || lower(*at) != lower(*prefix))
            return false;
    return true;
}

sr_status fail_at(const struct source *s, int line, const char *format, ...)
{
    char text[700];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (line > 0)
        return sr_fail(s->error, SR_ERROR_INPUT, "%s:%d: %s", s->name, line, text);
    return sr_fail(s->error, SR_ERROR_INPUT, "%s: %s", s->name, text);
}
