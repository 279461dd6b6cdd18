/* SPDX-License-Identifier: MIT */
/* PNG through libpng: up to 8 bits become bytes, 16 bits become linear floats; written as 8-bit sRGB.
 *
 * ISO/IEC 15948:2004. Whole numbers are taken as sRGB unless the caller says linear; gAMA, cHRM and iCCP are not
 * used. Limits: text chunks are neither read nor written. */
#include "image/codec.h"

#include <png.h>
#include <setjmp.h>
#include <string.h>

static bool is_mine(const uint8_t *data, size_t size)
{
    return size >= 8 && memcmp(data, "\x89PNG\r\n\x1a\n", 8) == 0;
}

/* All that has to live across a longjmp stays behind one pointer, so that no local can be clobbered. */
struct job {
    const struct sr_image_source *source;
    size_t at; // [B] read so far
    struct sr_image *image;
    struct sr_array *out;
    struct sr_error *error;
    sr_status status;
    jmp_buf escape;
};

static void on_error(png_structp png, png_const_charp text)
{
    struct job *job = png_get_error_ptr(png);
    const char *label = job->source ? job->source->label : "PNG";
    if (job->status == SR_OK)
        job->status = sr_fail(job->error, job->source ? SR_ERROR_INPUT : SR_ERROR_RESOURCE,
                              "%s: the PNG library says: %s", label, text);
    longjmp(job->escape, 1);
}

static void on_warning(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static png_voidp allocate(png_structp png, png_alloc_size_t size)
{
    void *p = sr_alloc(size);
    struct job *job = png_get_error_ptr(png);
    if (!p && job && job->status == SR_OK) // the library may not say it so
        job->status =
            sr_fail(job->error, SR_ERROR_RESOURCE, "%s: not enough memory", job->source ? job->source->label : "PNG");
    return p;
}

static void release(png_structp png, png_voidp p)
{
    (void)png;
    sr_free(p);
}

static void take(png_structp png, png_bytep to, size_t size)
{
    struct job *job = png_get_io_ptr(png);
    if (job->source->size - job->at < size) {
        job->status =
            sr_fail(job->error, SR_ERROR_INPUT, "%s: is cut short after %zu bytes: more of a PNG image was expected",
                    job->source->label, job->source->size);
        png_error(png, "cut short");
    }
    memcpy(to, job->source->data + job->at, size);
    job->at += size;
}

static void put(png_structp png, png_bytep from, size_t size)
{
    struct job *job = png_get_io_ptr(png);
    if (!sr_image_put(job->out, from, size))
        png_error(png, "not enough memory");
}

static void flush(png_structp png)
{
    (void)png;
}

/* Two bytes a number, kept in the second half of the row that they become. */
static void read_wide(png_structp png, struct job *job, uint32_t channels, int passes)
{
    struct sr_image *image = job->image;
    size_t n = (size_t)image->width * channels;
    for (; passes > 0; passes--)
        for (uint32_t y = 0; y < image->height; y++)
            png_read_row(png, (png_bytep)sr_image_row(job->source, image, y) + 2 * n, NULL);
    for (uint32_t y = 0; y < image->height; y++) {
        float *row = sr_image_row(job->source, image, y);
        const uint8_t *wide = (const uint8_t *)row + 2 * n; // the float overwrites only what has been read
        for (size_t i = 0; i < n; i++) {
            float v = (float)((unsigned)wide[2 * i] << 8 | wide[2 * i + 1]) / 65535;
            bool is_alpha = (channels & 1) == 0 && i % channels == channels - 1;
            row[i] = job->source->encoding == SR_IMAGE_SRGB && !is_alpha ? sr_image_decode_srgb(v) : v;
        }
    }
}

static void read_all(png_structp png, png_infop info, struct job *job)
{
    png_set_read_fn(png, job, take);
    png_set_user_limits(png, 1 << 30, 1 << 30);
    png_set_chunk_malloc_max(png, 64 << 20);
    png_set_chunk_cache_max(png, 1000);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, 0);
    png_read_info(png, info);
    png_set_expand(png); // palettes to RGB, 1 to 4 bits to 8, transparent colours to alpha
    int depth = png_get_bit_depth(png, info), type = png_get_color_type(png, info);
    bool has_alpha = (type & PNG_COLOR_MASK_ALPHA) || png_get_valid(png, info, PNG_INFO_tRNS);
    uint32_t channels = ((type & PNG_COLOR_MASK_COLOR) ? 3 : 1) + has_alpha;
    uint32_t width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    job->status = sr_image_create_for(job->source, width, height, channels, NULL,
                                      depth == 16 ? SR_IMAGE_FLOATS : SR_IMAGE_BYTES, &job->image, job->error);
    if (job->status != SR_OK)
        png_error(png, "too large");
    int passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    if (png_get_rowbytes(png, info) != (size_t)width * channels * (depth == 16 ? 2 : 1))
        png_error(png, "the rows have an unexpected length");
    if (depth == 16) {
        read_wide(png, job, channels, passes);
        job->image->encoding = SR_IMAGE_LINEAR;
    }
    for (; depth < 16 && passes > 0; passes--)
        for (uint32_t y = 0; y < height; y++)
            png_read_row(png, sr_image_row(job->source, job->image, y), NULL);
    png_read_end(png, NULL);
}

static sr_status decode(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error)
{
    struct job *job = sr_alloc(sizeof *job);
    png_structp png =
        job ? png_create_read_struct_2(PNG_LIBPNG_VER_STRING, job, on_error, on_warning, NULL, allocate, release)
            : NULL;
    png_infop info = png ? png_create_info_struct(png) : NULL;
    sr_status status =
        info ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", source->label);
    if (info) {
        job->source = source;
        job->error = error;
        if (setjmp(job->escape) == 0)
            read_all(png, info, job);
        status = job->status;
        *image = job->image;
        if (status != SR_OK) {
            sr_image_free(job->image);
            *image = NULL;
        }
    }
    png_destroy_read_struct(png ? &png : NULL, info ? &info : NULL, NULL);
    sr_free(job);
    return status;
}

/* ---- writing ---- */

static void write_all(png_structp png, png_infop info, struct job *job)
{
    const struct sr_image *image = job->image;
    static const int types[5] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                 PNG_COLOR_TYPE_RGB_ALPHA};
    png_set_write_fn(png, job, put, flush);
    png_set_user_limits(png, 1 << 30, 1 << 30);
    png_set_IHDR(png, info, image->width, image->height, 8, types[image->channel_count], PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (image->encoding == SR_IMAGE_SRGB)
        png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (uint32_t y = 0; y < image->height; y++)
        png_write_row(png, image->bytes + sr_image_index(image, 0, y));
    png_write_end(png, NULL);
}

/* Bytes whose channels are Y, YA, RGB or RGBA in this order can be written as they are. */
static bool is_plain(const struct sr_image *image)
{
    static const char *const usual[5] = {"", "Y", "YA", "RGB", "RGBA"};
    if (!image->bytes || image->channel_count > 4)
        return false;
    for (uint32_t c = 0; c < image->channel_count; c++)
        if (image->channels[c].name[0] != usual[image->channel_count][c] || image->channels[c].name[1])
            return false;
    return true;
}

static sr_status encode(const struct sr_image *image, const struct sr_image_write_options *options,
                        struct sr_array *out, struct sr_error *error)
{
    struct sr_image *mapped = NULL;
    sr_status status = is_plain(image) ? SR_OK : sr_image_tone_map(image, &options->tone, &mapped, error);
    if (status != SR_OK)
        return status;
    struct job *job = sr_alloc(sizeof *job);
    png_structp png =
        job ? png_create_write_struct_2(PNG_LIBPNG_VER_STRING, job, on_error, on_warning, NULL, allocate, release)
            : NULL;
    png_infop info = png ? png_create_info_struct(png) : NULL;
    status = info ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to write a PNG file");
    if (info) {
        job->image = mapped ? mapped : (struct sr_image *)(uintptr_t)image;
        job->error = error;
        job->out = out;
        if (setjmp(job->escape) == 0)
            write_all(png, info, job);
        status = job->status;
    }
    png_destroy_write_struct(png ? &png : NULL, info ? &info : NULL);
    sr_free(job);
    sr_image_free(mapped);
    return status;
}

const struct sr_image_codec sr_image_codec_png = {"PNG", {".png"}, is_mine, decode, encode};
