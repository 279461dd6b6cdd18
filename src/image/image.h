/* SPDX-License-Identifier: MIT */
/* Pixels with named channels and units: EXR, PFM, PNG, HDR, JPEG, QOI and TGA files, comparison, statistics, tone
 * mapping.
 *
 * The top row comes first; pixel (x, y) covers [x, x+1) × [y, y+1) of the image plane. An image owns everything
 * that it points to. Images do not change behind anyone's back: whoever reads one on several threads needs no
 * lock. */
#ifndef SR_IMAGE_IMAGE_H
#define SR_IMAGE_IMAGE_H

#include "base/base.h"

/* What the whole numbers of an image mean. Alpha ("A") is linear in both. */
enum sr_image_encoding {
    SR_IMAGE_SRGB,   // IEC 61966-2-1
    SR_IMAGE_LINEAR, // value / 255 (or 65535)
};

enum sr_image_type { SR_IMAGE_FLOATS, SR_IMAGE_BYTES };

struct sr_image_channel {
    char name[64]; // "R", "G", "B", "A", "Y", "X", "Z", "SE.R", "normal.X", …
    char unit[32]; // "cd/m^2", "1", …; empty where nobody said
};

struct sr_image_attribute {
    const char *name;
    const char *text;
};

struct sr_image {
    uint32_t width, height;            // [pixel] of what is stored
    uint32_t channel_count;            // [1]
    struct sr_image_channel *channels; // channel_count of them
    float *floats;                     // [unit of the channel] (y*width + x)*channel_count + c; or NULL:
    uint8_t *bytes;                    // [1] the same order, in `encoding`; exactly one of the two is there
    enum sr_image_encoding encoding;   // of bytes
    struct sr_image_attribute *attributes;
    uint32_t attribute_count;         // [1]
    bool has_chromaticities;          // otherwise the primaries of sRGB, white D65
    double chromaticities[4][2];      // [1] CIE 1931 x and y of red, green, blue, white
    int32_t x0, y0;                   // [pixel] where the stored part lies in the full picture
    uint32_t full_width, full_height; // [pixel] of the full picture
    struct sr_arena arena;            // holds channels and attributes
};

/* ---- life ---- */

/* names: channel_count of them, or NULL for Y, YA, RGB, RGBA (by their count), C0, C1, … beyond. Pixels are zero.
 * Fails with SR_ERROR_INPUT where a side or the channel count is 0, a side is above 2^30 or channels above 65536,
 * and with SR_ERROR_RESOURCE where it needs more than the memory of the machine. *image is NULL after a failure. */
sr_status sr_image_create(uint32_t width, uint32_t height, uint32_t channel_count, const char *const *names,
                          enum sr_image_type type, struct sr_image **image, struct sr_error *error);
void sr_image_free(struct sr_image *image); // NULL is fine
/* The pixels x … x+width-1, y … y+height-1, with all names and attributes; x0 and y0 follow. */
sr_status sr_image_crop(const struct sr_image *image, uint32_t x, uint32_t y, uint32_t width, uint32_t height,
                        struct sr_image **cropped, struct sr_error *error);

int sr_image_find_channel(const struct sr_image *image, const char *name);          // index, or -1
const char *sr_image_get_attribute(const struct sr_image *image, const char *name); // or NULL
sr_status sr_image_set_attribute(struct sr_image *image, const char *name, const char *text, struct sr_error *error);
void sr_image_set_unit(struct sr_image *image, uint32_t channel, const char *unit); // cut at 31 bytes
/* The indices of "R","G","B", or of "Y" three times, or of the first channel three times. False: it is not a
 * colour. */
bool sr_image_find_rgb(const struct sr_image *image, int rgb[3]);

/* Luminance is the sum of weight times channel: of R, G, B by their primaries, of X, Y, Z, of Y, or of the only
 * channel. False: the picture has no colour. */
bool sr_image_luminance_weights(const struct sr_image *image, int channel[3], double weight[3]);

static inline size_t sr_image_index(const struct sr_image *image, uint32_t x, uint32_t y)
{
    return ((size_t)y * image->width + x) * image->channel_count;
}

float sr_image_decode_srgb(float v); // [1] encoded 0 … 1 to linear
float sr_image_encode_srgb(float v); // [1] linear to encoded
/* In place: bytes become linear floats, floats stay. */
sr_status sr_image_to_float(struct sr_image *image, struct sr_error *error);

/* ---- files ---- */

/* The format is told by the first bytes, and where they say nothing (TGA) by the file's ending. What is read:
 *   EXR   scan lines and tiles (level 0) of the first part; half, float, uint; all compressions of
 *         the library (DWAA and DWAB not before its version 3.2); every channel, in the file's
 *         (alphabetic) order except that R, G, B, A come in this order and first; text attributes, chromaticities;
 *         attributes "unit.NAME" become units. Deep data and subsampled channels are refused.
 *   PNG   8 bits or fewer become bytes; 16 bits become linear floats. Grey, RGB, palette, alpha.
 *         gAMA and iCCP are not used.
 *   JPEG  grey and RGB bytes (CMYK is refused).      TGA  8, 15, 16, 24, 32 bits, palettes, run lengths, any origin.
 *   PFM   floats, both byte orders.                   HDR  RGBE and XYZE (converted), all run lengths; rows, not
 *         columns. EXPOSURE is divided out, a PFM scale is multiplied in.
 *   QOI   RGB and RGBA bytes.
 * Headers may lie, so memory follows the bytes of the file: up to 64 MiB + 16 times its size are taken at once. An
 * image that needs more, as honest ones of few colours do, is unpacked twice: first a row at a time, to see that all
 * its pixels are there, and then for good. Beyond sr_image_limit_B it is refused. */
sr_status sr_image_read(const char *path, struct sr_image **image, struct sr_error *error);
/* The same, where the caller knows what whole numbers in the file mean (normal maps and roughness are linear). */
size_t sr_image_limit_B(size_t file_B); // [B] that the pixels of a file of that size may take: 256 MiB + 2000 file_B
sr_status sr_image_read_as(const char *path, enum sr_image_encoding encoding, struct sr_image **image,
                           struct sr_error *error);
/* From memory; label stands for the path in messages and its ending. */
sr_status sr_image_decode(const char *label, const void *data, size_t size, enum sr_image_encoding encoding,
                          struct sr_image **image, struct sr_error *error);

enum sr_tone_operator {
    SR_TONE_LINEAR,   // v, cut at 1
    SR_TONE_REINHARD, // of luminance: Y (1 + Y/16) / (1 + Y), white at 4 (Reinhard et al. 2002, eq. 4)
    SR_TONE_FILMIC,   // a rational S-curve per channel (Hable 2010), white at 11.2
};
struct sr_tone {
    enum sr_tone_operator op;
    bool is_auto;      // the exposure is sr_image_auto_exposure + exposure_EV
    float exposure_EV; // [EV] linear values are multiplied by 2^exposure_EV first
};
struct sr_image_write_options {
    struct sr_tone tone; // how floats become the bytes of a PNG
};

/* By ending: .exr (float32, ZIP, all channels, units as attributes "unit.NAME"), .pfm (R,G,B or one channel), .hdr
 * (R,G,B), .png (8-bit sRGB: floats go through the tone curve, bytes as they are). options may be NULL: linear at 0
 * EV. The file is written beside and renamed: no half-written file ever bears the name. */
sr_status sr_image_write(const char *path, const struct sr_image *image, const struct sr_image_write_options *options,
                         struct sr_error *error);
/* To memory; ending such as ".png". Free *data with sr_free. */
sr_status sr_image_encode(const char *ending, const struct sr_image *image,
                          const struct sr_image_write_options *options, void **data, size_t *size,
                          struct sr_error *error);

/* ---- tone mapping ---- */

/* The exposure [EV] that brings the log-average of the positive luminances to 0.18 (Reinhard et al. 2002), lowered
 * where needed so that the 99th percentile stays at or below 4, and raised no further than that. Finite for every
 * image. */
float sr_image_auto_exposure(const struct sr_image *image);
/* An image of R, G, B bytes in sRGB. X, Y, Z channels are converted; NaN becomes black. tone may be NULL. Values
 * with other primaries (has_chromaticities) are converted to those of sRGB, the white point adapted by scaling
 * cones (Bradford). */
sr_status sr_image_tone_map(const struct sr_image *image, const struct sr_tone *tone, struct sr_image **mapped,
                            struct sr_error *error);

/* ---- statistics ---- */

struct sr_image_statistics {
    uint64_t count; // [1] pixels with finite values; all but the last four concern only these, and of none are NaN
    double mean, deviation, min, max;                                               // [unit of the channel]
    double percentile_1, percentile_5, percentile_50, percentile_95, percentile_99; // [unit of the channel]
    double sum;                                                                     // [unit of the channel] of none: 0
    uint64_t nan_count, infinite_count, negative_count, zero_count;                 // [1]
};
/* Of one channel; bytes are decoded to linear. */
sr_status sr_image_statistics(const struct sr_image *image, uint32_t channel, struct sr_image_statistics *statistics,
                              struct sr_error *error);

/* ---- comparison ---- */

/* The standard error of channel NAME stands in the channel "SE.NAME" ("stderr.NAME" is understood too), in the same
 * unit. Such channels are not compared themselves. Below, d = a - b; b is the reference. Pixels where either is not
 * finite are left out and counted. */
struct sr_image_difference {
    char name[64], unit[32];
    uint64_t count, skipped_count; // [1] pixels compared, and left out; where none is compared what follows is NaN
    double mean_a, mean_b;         // [unit]
    double mean_ratio;             // [1] mean_a / mean_b
    double bias;                   // [unit] mean of d
    double rmse;                   // [unit] root of the mean of d^2
    double rel_mse;                // [1] mean of d^2 / (b^2 + 0.01 mean_b^2)
    double max_difference;         // [unit] largest |d|
    uint32_t max_x, max_y;         // [pixel] where, if any was compared
    bool has_z; // a or b has standard errors: z = d / sqrt(SE_a^2 + SE_b^2), a channel that is missing counts as 0
    uint64_t z_count; // [1] pixels with a standard error above 0, and none that is not finite
    double mean_z;    // [1] mean of d over its standard error, pixels taken as independent
    double share_above_2, share_above_3, share_above_4; // [1] of z_count; Gaussian noise: 0.0455, 0.0027, 0.0000633
    double max_z;                                       // [1] largest |z|
    double chi2_per_pixel;                              // [1] mean of z^2; 1 where the errors are told rightly
};
struct sr_image_comparison {
    uint32_t channel_count;               // [1] those that both have
    struct sr_image_difference *channels; // in the order of a
    double rmse, rel_mse;                 // [1] root mean square and mean over these channels
    double max_abs_mean_z;                // [1] 0 where none has z
};
/* Fails with SR_ERROR_INPUT where the sizes differ or no channel is common. Bytes are decoded to linear. Free it. */
sr_status sr_image_compare(const struct sr_image *a, const struct sr_image *b, struct sr_image_comparison *comparison,
                           struct sr_error *error);
void sr_image_comparison_free(struct sr_image_comparison *comparison);

/* A picture of the signed difference of luminance, R,G,B bytes in sRGB: white where equal, red where a is more,
 * blue where b is; the full colour stands for `scale` [unit], or for the 99th percentile of |d| where scale is 0
 * (it is then written back where used_scale is not NULL). Green: not comparable (NaN, infinite). */
sr_status sr_image_difference_picture(const struct sr_image *a, const struct sr_image *b, double scale,
                                      struct sr_image **picture, double *used_scale, struct sr_error *error);

#endif
