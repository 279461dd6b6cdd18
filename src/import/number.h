/* SPDX-License-Identifier: MIT */
/* Decimal text to numbers, fast: the digits as an integer, times a power of ten.
 *
 *     value = m 10^e,   m < 10^19
 *
 * Exact up to one rounding where m <= 2^53 and |e| <= 22 (Clinger 1990), within 2 ulp of a double elsewhere, so that
 * the nearest float is missed only where the decimal lies within 1e-8 of an ulp of the middle between two. Digits
 * beyond the 19th are dropped. The text must be followed by a NUL. Knows no locale. */
#ifndef SR_IMPORT_NUMBER_H
#define SR_IMPORT_NUMBER_H

#include "base/base.h"

double sr_number_scale10(uint64_t m, int exponent); // m 10^exponent

/* Reads one number at p; NULL if there is none. Returns where it ends. */
static inline const char *sr_number_read(const char *p, double *value)
{
    bool is_negative = *p == '-';
    p += *p == '-' || *p == '+';
    uint64_t m = 0;
    const char *start = p;
    unsigned digit;
    while ((digit = (unsigned)(unsigned char)*p - '0') < 10) {
        m = m * 10 + digit;
        ++p;
    }
    int digits = p - start > 1 << 20 ? 1 << 20 : (int)(p - start), exponent = 0;
    const char *point = p;
    if (*p == '.') {
        ++p;
        while ((digit = (unsigned)(unsigned char)*p - '0') < 10) {
            m = m * 10 + digit;
            ++p;
        }
        int decimals = p - point - 1 > 1 << 20 ? 1 << 20 : (int)(p - point - 1);
        digits += decimals;
        exponent = -decimals;
    }
    if (digits == 0)
        return NULL;
    if (SR_UNLIKELY(digits > 19)) { // may have overflowed: once more, with the first 19 significant digits
        m = 0;
        exponent = 0;
        int kept = 0;
        for (const char *q = start; q < p; ++q) {
            if (*q == '.')
                continue;
            if (kept < 19) {
                m = m * 10 + (unsigned)(*q - '0');
                kept += m > 0;
                exponent -= q > point;
            } else
                exponent += q < point;
        }
    }
    if (*p == 'e' || *p == 'E') {
        const char *q = p + 1;
        bool is_small = *q == '-';
        q += *q == '-' || *q == '+';
        if ((unsigned)(*q - '0') < 10) {
            int e = 0;
            for (; (digit = (unsigned)(unsigned char)*q - '0') < 10; ++q)
                e = e < 100000 ? e * 10 + (int)digit : e;
            exponent += is_small ? -e : e;
            p = q;
        }
    }
    double v = exponent == 0 ? (double)m : sr_number_scale10(m, exponent);
    *value = is_negative ? -v : v;
    return p;
}

/* "0x1F": sets *value and returns where it ends; NULL if there is none. */
const char *sr_number_read_hex(const char *p, double *value);

#endif
