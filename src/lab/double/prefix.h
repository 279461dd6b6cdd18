/* SPDX-License-Identifier: MIT */
/* Read before each file of the double-precision twins: float is double from here on.
 *
 * The models' files, and what they stand on, are compiled a second time behind this header. Constants have lost their
 * suffix f before (see cmake/double.cmake); every external name of theirs gets the ending _double by a generated
 * header, which also has read all system headers first, because those must not see the words below. */
#ifndef SR_LAB_DOUBLE_PREFIX_H
#define SR_LAB_DOUBLE_PREFIX_H

#include "double_system.h"

#define SR_DOUBLE 1
#define float double

#define acosf acos
#define acoshf acosh
#define asinf asin
#define asinhf asinh
#define atan2f atan2
#define atanf atan
#define atanhf atanh
#define cabsf cabs
#define cargf carg
#define cbrtf cbrt
#define ccosf ccos
#define ceilf ceil
#define cexpf cexp
#define cimagf cimag
#define clogf clog
#define conjf conj
#define copysignf copysign
#define cosf cos
#define coshf cosh
#define cpowf cpow
#define crealf creal
#define csinf csin
#define csqrtf csqrt
#define erfcf erfc
#define erff erf
#define exp2f exp2
#define expf exp
#define expm1f expm1
#define fabsf fabs
#define fdimf fdim
#define floorf floor
#define fmaf fma
#define fmaxf fmax
#define fminf fmin
#define fmodf fmod
#define frexpf frexp
#define hypotf hypot
#define ilogbf ilogb
#define j0f j0
#define j1f j1
#define jnf jn
#define ldexpf ldexp
#define lgammaf lgamma
#define llrintf llrint
#define llroundf llround
#define log10f log10
#define log1pf log1p
#define log2f log2
#define logbf logb
#define logf log
#define lrintf lrint
#define lroundf lround
#define modff modf
#define nearbyintf nearbyint
#define nextafterf nextafter
#define powf pow
#define remainderf remainder
#define rintf rint
#define roundf round
#define scalbnf scalbn
#define sinf sin
#define sinhf sinh
#define sqrtf sqrt
#define strtof strtod
#define tanf tan
#define tanhf tanh
#define tgammaf tgamma
#define truncf trunc

#include "double_names.h"

#endif
