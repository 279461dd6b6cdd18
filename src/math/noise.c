/* SPDX-License-Identifier: MIT */
/* Gradient noise, and sums of its octaves.
 *
 *     noise(p)      = the gradients of the 8 corners of p's cell, each times the way from its corner,
 *                     mixed by 6 t^5 - 15 t^4 + 10 t^3
 *     fbm(p)        = sum_i w^i  noise(1.99^i p)
 *     turbulence(p) = sum_i w^i |noise(1.99^i p)|
 *
 * Perlin, "Improving noise", 2002, with its permutation. Octaves finer than the footprint are left out; the last one
 * fades, as in PBRT4 10.6, whose numbers these are: a scene's marble has its veins where pbrt-v4 draws them. */
#include "math/math.h"

// clang-format off
static const uint8_t permutation[256] = {
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99,
    37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27, 166,
    77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86,
    164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70,
    221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107,
    49, 192, 214, 31, 181, 199, 106, 157, 184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
};
// clang-format on

static inline uint8_t next(int x)
{
    return permutation[x & 255];
}

/* One of Perlin's 12 gradients (4 of them twice), the middles of a cube's edges, times (x, y, z). From a table: which
 * it is cannot be foretold, and a wrong branch costs more than the sum. */
static inline float along_gradient(uint8_t hash, float x, float y, float z)
{
    static const float gradients[16][4] = {
        {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
        {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {-1, 1, 0}, {0, 1, -1}, {0, -1, -1},
    };
    const float *g = gradients[hash & 15];
    return x * g[0] + y * g[1] + z * g[2];
}

static inline float fade(float t)
{
    return t * t * t * (10 + t * (-15 + t * 6));
}

/* The lower corner of x's cell, and the way from it; coordinates beyond 2^30 are folded, for they must fit an int. */
static int cell(float x, float *rest)
{
    const float most = 0x1p30f;
    if (!(fabsf(x) < most))
        x = isfinite(x) ? fmodf(x, most) : 0;
    float lower = floorf(x);
    *rest = x - lower;
    return (int)lower;
}

float sr_noise(sr_vec3 p)
{
    float x, y, z, corner[2][2][2];
    int ix = cell(p.x, &x), iy = cell(p.y, &y), iz = cell(p.z, &z);
    for (int i = 0; i < 2; ++i) {
        int hx = next(ix + i);
        for (int j = 0; j < 2; ++j) {
            int hy = next(hx + iy + j);
            for (int k = 0; k < 2; ++k)
                corner[i][j][k] = along_gradient(next(hy + iz + k), x - (float)i, y - (float)j, z - (float)k);
        }
    }
    float tx = fade(x), ty = fade(y), tz = fade(z), plane[2];
    for (int k = 0; k < 2; ++k)
        plane[k] =
            sr_lerp(ty, sr_lerp(tx, corner[0][0][k], corner[1][0][k]), sr_lerp(tx, corner[0][1][k], corner[1][1][k]));
    return sr_lerp(tz, plane[0], plane[1]);
}

static const float finer = 1.99f; // not 2, or the zeros of all octaves would fall together

/* How many octaves the footprint can show: half the inverse of its length is the finest frequency. */
static float octaves_shown(sr_vec3 dpdx, sr_vec3 dpdy, int octaves)
{
    float length2 = sr_max(sr_length2(dpdx), sr_length2(dpdy));
    return length2 > 0 ? sr_clamp(-1 - 0.5f * log2f(length2), 0, (float)octaves) : (float)octaves;
}

/* 0 below share 0.3 of an octave, 1 above 0.7, smooth between. */
static float shown_share(float share)
{
    float t = sr_clamp((share - 0.3f) / 0.4f, 0, 1);
    return t * t * (3 - 2 * t);
}

float sr_fbm(sr_vec3 p, sr_vec3 dpdx, sr_vec3 dpdy, float omega, int octaves)
{
    float shown = octaves_shown(dpdx, dpdy, octaves), sum = 0, frequency = 1, weight = 1;
    int whole = (int)shown;
    for (int i = 0; i < whole; ++i) {
        sum += weight * sr_noise(sr_scale(frequency, p));
        frequency *= finer;
        weight *= omega;
    }
    float share = shown_share(shown - (float)whole);
    return share > 0 ? sum + weight * share * sr_noise(sr_scale(frequency, p)) : sum;
}

float sr_turbulence(sr_vec3 p, sr_vec3 dpdx, sr_vec3 dpdy, float omega, int octaves)
{
    const float mean = 0.2f; // of |noise|, roughly: what stands for an octave that is not shown
    float shown = octaves_shown(dpdx, dpdy, octaves), sum = 0, frequency = 1, weight = 1;
    int whole = (int)shown;
    for (int i = 0; i < whole; ++i) {
        sum += weight * fabsf(sr_noise(sr_scale(frequency, p)));
        frequency *= finer;
        weight *= omega;
    }
    float share = shown_share(shown - (float)whole);
    sum += weight * (share > 0 ? sr_lerp(share, mean, fabsf(sr_noise(sr_scale(frequency, p)))) : mean);
    for (int i = whole; i < octaves; ++i) { // the fading octave counts once more here, as in pbrt
        sum += weight * mean;
        weight *= omega;
    }
    return sum;
}
