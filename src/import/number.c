/* SPDX-License-Identifier: MIT */
/* The powers of ten, and the rare spellings of numbers. */
#include "import/number.h"

#include <math.h>

/* 10^0 … 10^22 are doubles without error */
static const double exact[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                               1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

double sr_number_scale10(uint64_t m, int exponent)
{
    if (SR_LIKELY(exponent >= -22 && exponent <= 22))
        return exponent < 0 ? (double)m / exact[-exponent] : (double)m * exact[exponent];
    if (m == 0 || exponent < -400)
        return 0;
    if (exponent > 400)
        return INFINITY;
    double v = (double)m;
    for (; exponent > 22; exponent -= 22)
        v *= 1e22;
    for (; exponent < -22; exponent += 22)
        v /= 1e22;
    return exponent < 0 ? v / exact[-exponent] : v * exact[exponent];
}

const char *sr_number_read_hex(const char *p, double *value)
{
    bool is_negative = *p == '-';
    p += *p == '-' || *p == '+';
    if (p[0] != '0' || (p[1] != 'x' && p[1] != 'X'))
        return NULL;
    p += 2;
    double v = 0;
    const char *start = p;
    for (;; ++p) {
        int digit = *p >= '0' && *p <= '9'                 ? *p - '0'
                    : (*p | 32) >= 'a' && (*p | 32) <= 'f' ? (*p | 32) - 'a' + 10
                                                           : -1;
        if (digit < 0)
            break;
        v = v * 16 + digit;
    }
    *value = is_negative ? -v : v;
    return p == start ? NULL : p;
}
