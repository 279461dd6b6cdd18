/* SPDX-License-Identifier: MIT */
/* Quantities in words: the expanded uncertainty to two significant digits, the value to the same place (GUM 7.2.6).
 *
 *     E = 19.894 lx ± 0.021 lx (95 %, k = 2.13, ν = 15)
 *
 * Limits: no more than 9 digits of the value; outside 0.001 … 1e7 both have the same power of ten. */
#include "quantity/quantity.h"

#include <stdio.h>
#include <string.h>

enum { MOST_DIGITS = 9 };

/* The decimal place of the first digit: 2 for 123. */
static int place_of(double x)
{
    return (int)floor(log10(fabs(x)));
}

/* x to the decimal place, over 10^exponent, which is then written after it. */
static void append_number(double x, int place, int exponent, char *text, size_t size)
{
    size_t used = strlen(text);
    double unit = pow(10, place), scaled = x / pow(10, exponent);
    int decimals = exponent - place;
    if (decimals < 0)
        scaled = round(x / unit) * unit / pow(10, exponent), decimals = 0;
    snprintf(text + used, size - used, exponent ? "%.*fe%d" : "%.*f", decimals, scaled, exponent);
}

SR_PRINTF(3, 4) static void append(char *text, size_t size, const char *format, ...)
{
    size_t used = strlen(text);
    va_list list;
    va_start(list, format);
    vsnprintf(text + used, size - used, format, list);
    va_end(list);
}

static void append_interval(const struct sr_quantity *q, const char *unit, char *text, size_t size)
{
    double U = sr_quantity_expanded(q, 0.95), largest = fmax(fabs(q->value), U);
    int top = place_of(largest), exponent = top >= 7 || top < -3 ? top : 0, place = top - MOST_DIGITS + 1;
    if (U > 0) {
        int second_digit = place_of(U) - 1;
        second_digit += round(U / pow(10, second_digit)) >= 100 ? 1 : 0; // 0.0996 is 0.10
        place = second_digit > place ? second_digit : place;
    }
    append_number(q->value, place, exponent, text, size);
    append(text, size, "%s ± ", unit);
    if (U > 0 && U < pow(10, place)) // less than the last digit that is shown
        append(text, size, "%.1g", U);
    else
        append_number(U, U > 0 ? place : exponent, U > 0 ? exponent : 0, text, size);
    append(text, size, "%s (95 %%, k = %.2f, ν = ", unit,
           isinf(q->degrees) ? sr_normal_quantile(0.975) : sr_student_quantile(0.975, q->degrees));
    if (isinf(q->degrees))
        append(text, size, "∞)");
    else
        append(text, size, q->degrees == floor(q->degrees) || q->degrees >= 100 ? "%.0f)" : "%.1f)", q->degrees);
}

char *sr_quantity_text(const char *name, const struct sr_quantity *q, char *text, size_t size)
{
    char unit[97] = " ";
    sr_unit_text(q->unit, unit + 1, sizeof unit - 1);
    if (strcmp(unit, " 1") == 0)
        unit[0] = 0;
    if (size == 0)
        return text;
    text[0] = 0;
    if (name)
        append(text, size, "%s %s ", name, q->upper > 0 ? "<" : "=");
    if (q->upper > 0)
        append(text, size, "%s%.2g%s (95 %%, one-sided: nothing was found)", name ? "" : "< ", q->upper, unit);
    else if (!isfinite(q->value))
        append(text, size, "%g%s (not a number that was measured)", q->value, unit);
    else if (!(q->u >= 0 && isfinite(sr_quantity_expanded(q, 0.95))) || !(q->degrees > 0))
        append(text, size, "%.6g%s (uncertainty not known)", q->value, unit);
    else if (q->u == 0 && isinf(q->degrees))
        append(text, size, "%.9g%s (exact)", q->value, unit);
    else if (q->u == 0 && q->value == 0)
        append(text, size, "0%s (nothing was found, and no bound is known)", unit);
    else
        append_interval(q, unit, text, size);
    return text;
}
