/* SPDX-License-Identifier: MIT */
/* Colour spaces, the sRGB transfer curve, daylight and white balance.
 *
 *     XYZ = M rgb,   the columns of M are the primaries, scaled so that rgb = (1, 1, 1) is the white with Y = 1
 *
 * IEC 61966-2-1 (sRGB curve), CIE 015:2018 (daylight), K. M. Lam, Metamerism and colour constancy, 1985 (Bradford). */
#include "spectrum/data.h"

#include <string.h>

const struct sr_colour_space *sr_colour_space(enum sr_colour_space_id id)
{
    return &sr_data_colour_spaces[id];
}

bool sr_colour_space_find(const char *name, enum sr_colour_space_id *id)
{
    for (int i = 0; i < SR_COLOUR_SPACE_COUNT; ++i) {
        if (strcmp(name, sr_data_colour_spaces[i].name) == 0) {
            *id = (enum sr_colour_space_id)i;
            return true;
        }
    }
    return false;
}

static void multiply(const double m[3][3], double a, double b, double c, double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = m[i][0] * a + m[i][1] * b + m[i][2] * c;
}

struct sr_rgb sr_rgb_from_xyz(const struct sr_colour_space *space, struct sr_xyz xyz)
{
    double v[3];
    multiply(space->rgb_from_xyz, (double)xyz.x, (double)xyz.y, (double)xyz.z, v);
    return (struct sr_rgb){(float)v[0], (float)v[1], (float)v[2]};
}

struct sr_xyz sr_xyz_from_rgb(const struct sr_colour_space *space, struct sr_rgb rgb)
{
    double v[3];
    multiply(space->xyz_from_rgb, (double)rgb.r, (double)rgb.g, (double)rgb.b, v);
    return (struct sr_xyz){(float)v[0], (float)v[1], (float)v[2]};
}

float sr_srgb_encode(float linear)
{
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f;
}

float sr_srgb_decode(float encoded)
{
    return encoded <= 0.04045f ? encoded / 12.92f : powf((encoded + 0.055f) / 1.055f, 2.4f);
}

void sr_daylight_xy(double T, double xy[2])
{
    double t = 1000 / T;
    xy[0] = T <= 7000 ? ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
                      : ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040;
    xy[1] = (-3.000 * xy[0] + 2.870) * xy[0] - 0.275;
}

// the cones' sharpened responses
static const double bradford[3][3] = {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}};

static void invert(const double m[3][3], double out[3][3])
{
    for (int i = 0; i < 3; ++i) {
        int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            out[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    }
    double det = m[0][0] * out[0][0] + m[0][1] * out[1][0] + m[0][2] * out[2][0];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[i][j] /= det;
}

void sr_white_balance(const double source_xy[2], const double target_xy[2], double matrix[3][3])
{
    double source[3], target[3], inverse[3][3];
    multiply(bradford, source_xy[0] / source_xy[1], 1, (1 - source_xy[0] - source_xy[1]) / source_xy[1], source);
    multiply(bradford, target_xy[0] / target_xy[1], 1, (1 - target_xy[0] - target_xy[1]) / target_xy[1], target);
    invert(bradford, inverse);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            matrix[i][j] = 0;
            for (int k = 0; k < 3; ++k)
                matrix[i][j] += inverse[i][k] * target[k] / source[k] * bradford[k][j];
        }
    }
}
