/* SPDX-License-Identifier: MIT */
/* The instructions that this library was compiled for, by the levels of the x86-64 ABI (System V psABI, AMD64
 * supplement 1.0, 3.1.1).
 *
 * Where a library lies there for each level, the one that the loader has taken answers. */
#include "base/base.h"

const char *sr_isa(void)
{
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && defined(__AVX512DQ__) &&                 \
    defined(__AVX512VL__)
    return "x86-64-v4";
#elif defined(__AVX2__) && defined(__FMA__) && defined(__BMI2__) && defined(__F16C__)
    return "x86-64-v3";
#elif defined(__SSE4_2__) && defined(__POPCNT__)
    return "x86-64-v2";
#elif defined(__x86_64__)
    return "x86-64";
#elif defined(__aarch64__)
    return "aarch64";
#else
    return "other";
#endif
}
