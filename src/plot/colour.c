/* SPDX-License-Identifier: MIT */
/* Colours of curves, and scales of colours for maps, even to the eye.
 *
 * A scale is a path through OKLab: lightness L runs evenly from dark to light, so that equal steps of the value look
 * equal and a grey print keeps the order; hue and chroma only help to name the places. In OKLab
 *
 *     linear sRGB --M1--> cone responses --cube root--> --M2--> L, a, b                                          [1]
 *
 * B. Ottosson, A perceptual color space for image processing, 2020. Palette: M. Okabe, K. Ito, Color universal design,
 * 2008. Colours out of sRGB's gamut are cut; the scales here stay within it. */
#include "plot/plot.h"

struct sr_plot_colour sr_plot_palette(int i)
{
    static const uint8_t rgb[8][3] = {{0, 114, 178},  {213, 94, 0},  {0, 158, 115}, {204, 121, 167},
                                      {86, 180, 233}, {230, 159, 0}, {120, 94, 60}, {0, 0, 0}};
    const uint8_t *c = rgb[((i % 8) + 8) % 8];
    return (struct sr_plot_colour){(float)c[0] / 255, (float)c[1] / 255, (float)c[2] / 255, 1};
}

static double encode(double v)
{
    v = v < 0 ? 0 : v > 1 ? 1 : v;
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static double decode(double v)
{
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

struct sr_plot_colour sr_plot_colour_from_oklab(const double lab[3])
{
    double l = lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2];
    double m = lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2];
    double s = lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2];
    l *= l * l;
    m *= m * m;
    s *= s * s;
    return (struct sr_plot_colour){(float)encode(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
                                   (float)encode(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
                                   (float)encode(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), 1};
}

void sr_plot_oklab_from_colour(struct sr_plot_colour colour, double lab[3])
{
    double r = decode((double)colour.r), g = decode((double)colour.g), b = decode((double)colour.b);
    double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    double m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    double s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

struct sr_plot_colour sr_plot_scale_colour(enum sr_plot_scale scale, double t)
{
    if (isnan(t))
        return (struct sr_plot_colour){0.82f, 0.82f, 0.82f, 1};
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    double lightness, chroma, hue;
    if (scale == SR_PLOT_PERCEPTUAL) {
        // indigo, plum, terracotta, amber, pale yellow; chroma goes to nearly nothing at both ends, where the gamut
        // does
        lightness = 0.16 + 0.81 * t;
        chroma = 0.045 + 0.105 * sin(3.14159265358979 * pow(t, 0.85));
        hue = (280 + 185 * t) * 3.14159265358979 / 180; // through magenta, red and orange
    } else {
        double side = 2 * t - 1, off = fabs(side);
        lightness = 0.97 - 0.55 * off;
        chroma = 0.155 * sin(1.5707963267949 * pow(off, 0.9));
        hue = (side < 0 ? 255 : 29) * 3.14159265358979 / 180;
    }
    return sr_plot_colour_from_oklab((double[3]){lightness, chroma * cos(hue), chroma * sin(hue)});
}
