/* SPDX-License-Identifier: MIT */
/* Spectra for RGB values, out of tables that were fitted while the library was built (fit/fit_rgb.c).
 *
 *     s(lambda) = 1/2 + x / (2 sqrt(1 + x^2)),   x = c0 lambda^2 + c1 lambda + c2
 *
 * The coefficients are trilinear between the table's knots: the largest component z, and the other two divided by z.
 * Greys are exact: s = v everywhere needs c2 = (v - 1/2) / sqrt(v (1 - v)).
 * W. Jakob and J. Hanika, A Low-Dimensional Function Space for Efficient Spectral Upsampling, 2019. */
#include "spectrum/data.h"

#define SURE 0x1p30f // x at which the sigmoid is exactly 1 in float, or at -x exactly 0

static const struct sr_rgb_table *const tables[SR_COLOUR_SPACE_COUNT] = {
    [SR_SRGB] = &sr_rgb_table_srgb,
    [SR_DCI_P3] = &sr_rgb_table_dci_p3,
    [SR_REC2020] = &sr_rgb_table_rec2020,
    [SR_ACES2065_1] = &sr_rgb_table_aces2065_1,
};

static struct sr_sigmoid grey(float v)
{
    float c2 = v <= 0 ? -SURE : v >= 1 ? SURE : sr_clamp((v - 0.5f) / sqrtf(v * (1 - v)), -SURE, SURE);
    return (struct sr_sigmoid){0, 0, c2};
}

// the last knot k <= SR_RGB_RESOLUTION - 2 with knots[k] <= z
static int find_knot(const float *knots, float z)
{
    int k = 0;
    for (int step = SR_RGB_RESOLUTION / 2; step > 0; step /= 2)
        k += knots[k + step] <= z ? step : 0;
    return k < SR_RGB_RESOLUTION - 2 ? k : SR_RGB_RESOLUTION - 2;
}

typedef float quad __attribute__((vector_size(16)));

// three coefficients and one more float: the table has padding
static inline quad load(const float *p)
{
    quad a;
    __builtin_memcpy(&a, p, sizeof a);
    return a;
}

static inline quad mix(float t, quad a, quad b)
{
    return (1 - t) * a + t * b;
}

struct sr_sigmoid sr_rgb_to_sigmoid(enum sr_colour_space_id space, struct sr_rgb rgb)
{
    float v[3] = {sr_clamp(rgb.r, 0, 1), sr_clamp(rgb.g, 0, 1), sr_clamp(rgb.b, 0, 1)};
    if (v[0] == v[1] && v[1] == v[2])
        return grey(v[0]);

    // no branches: which one is largest cannot be foretold
    int largest = v[0] > v[1] ? 0 : 1;
    float z = v[0] > v[1] ? v[0] : v[1];
    largest = z > v[2] ? largest : 2;
    z = z > v[2] ? z : v[2];
    float next = largest == 0   ? v[1]
                 : largest == 1 ? v[2]
                                : v[0],
          last = largest == 0   ? v[2]
                 : largest == 1 ? v[0]
                                : v[1];
    const struct sr_rgb_table *table = tables[space];
    const int n = SR_RGB_RESOLUTION;
    float x = next / z * (float)(n - 1), y = last / z * (float)(n - 1);
    int i = x < n - 2 ? (int)x : n - 2, j = y < n - 2 ? (int)y : n - 2;
    int k = z == 0.5f ? n / 2 - 1 : find_knot(table->knots, z); // what shines is scaled to that
    float tx = x - (float)i, ty = y - (float)j, tz = (z - table->knots[k]) / (table->knots[k + 1] - table->knots[k]);

    const float *p = table->coefficients[largest][k][j][i], *q = p + 3 * n, *r = p + 3 * n * n, *s = r + 3 * n;
    quad near = mix(ty, mix(tx, load(p), load(p + 3)), mix(tx, load(q), load(q + 3)));
    quad far = mix(ty, mix(tx, load(r), load(r + 3)), mix(tx, load(s), load(s + 3)));
    quad c = mix(tz, near, far);
    return (struct sr_sigmoid){c[0], c[1], c[2]};
}

struct sr_spd sr_spd_from_rgb_albedo(enum sr_colour_space_id space, struct sr_rgb rgb)
{
    return (struct sr_spd){.kind = SR_SPD_SIGMOID, .scale = 1, .sigmoid = sr_rgb_to_sigmoid(space, rgb)};
}

// half way up the sigmoid there is room for any hue; a black keeps scale 0
static struct sr_spd scaled(enum sr_colour_space_id space, struct sr_rgb rgb)
{
    float most = rgb.r > rgb.g ? rgb.r : rgb.g;
    float scale = 2 * (most > rgb.b ? most : rgb.b);
    if (!(scale > 0))
        return sr_spd_constant(0);
    struct sr_rgb share = {rgb.r / scale, rgb.g / scale, rgb.b / scale};
    return (struct sr_spd){.kind = SR_SPD_SIGMOID, .scale = scale, .sigmoid = sr_rgb_to_sigmoid(space, share)};
}

struct sr_spd sr_spd_from_rgb_unbounded(enum sr_colour_space_id space, struct sr_rgb rgb)
{
    return scaled(space, rgb);
}

struct sr_spd sr_spd_from_rgb_illuminant(enum sr_colour_space_id space, struct sr_rgb rgb)
{
    struct sr_spd s = scaled(space, rgb);
    if (s.kind == SR_SPD_SIGMOID) {
        s.kind = SR_SPD_ILLUMINANT;
        s.table = sr_data_colour_spaces[space].illuminant;
    }
    return s;
}
