/* SPDX-License-Identifier: MIT */
/* JPEG through libjpeg, read only: grey and colour become bytes in sRGB.
 *
 * ITU-T T.81 (1992), baseline and progressive. Limits: CMYK, lossless and 12-bit files are refused, as are files of
 * more than 500 scans (they cost time without end) and files that end early, which libjpeg alone would fill with
 * grey. */
#include "image/codec.h"

#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>

enum { MAX_SCANS = 500 };

static bool is_mine(const uint8_t *data, size_t size)
{
    return size >= 3 && data[0] == 0xff && data[1] == 0xd8 && data[2] == 0xff;
}

/* All that has to live across a longjmp stays behind one pointer. */
struct job {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    const struct sr_image_source *source;
    struct sr_image *image;
    struct sr_error *error;
    sr_status status;
    jmp_buf escape;
};

static struct job *job_of(j_common_ptr jpeg)
{
    return jpeg->client_data;
}

static void on_error(j_common_ptr jpeg)
{
    struct job *job = job_of(jpeg);
    char text[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, text);
    if (job->status == SR_OK)
        job->status = sr_fail(job->error, SR_ERROR_INPUT, "%s: the JPEG library says: %s", job->source->label, text);
    longjmp(job->escape, 1);
}

static void on_message(j_common_ptr jpeg, int level)
{
    struct job *job = job_of(jpeg);
    if (level >= 0 || (jpeg->err->msg_code != JWRN_JPEG_EOF && jpeg->err->msg_code != JWRN_HIT_MARKER))
        return;
    job->status = sr_fail(job->error, SR_ERROR_INPUT, "%s: is damaged or cut short: more of a JPEG image was expected",
                          job->source->label);
    longjmp(job->escape, 1);
}

static void be_silent(j_common_ptr jpeg)
{
    (void)jpeg;
}

static void watch(j_common_ptr jpeg)
{
    struct job *job = job_of(jpeg);
    if (job->jpeg.input_scan_number <= MAX_SCANS)
        return;
    job->status = sr_fail(job->error, SR_ERROR_INPUT, "%s: has more than %d scans, an image was expected",
                          job->source->label, (int)MAX_SCANS);
    longjmp(job->escape, 1);
}

static void read_all(struct job *job)
{
    struct jpeg_decompress_struct *jpeg = &job->jpeg;
    jpeg_create_decompress(jpeg);
    jpeg->progress = &job->progress;
    jpeg_mem_src(jpeg, job->source->data, (unsigned long)job->source->size);
    jpeg_read_header(jpeg, TRUE);
    if (jpeg->num_components != 1 && jpeg->num_components != 3) {
        job->status = sr_fail(job->error, SR_ERROR_INPUT, "%s: has %d colour components, 1 (grey) or 3 were expected",
                              job->source->label, jpeg->num_components);
        return;
    }
    uint32_t channels = (uint32_t)jpeg->num_components;
    jpeg->out_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    job->status = sr_image_create_for(job->source, jpeg->image_width, jpeg->image_height, channels, NULL,
                                      SR_IMAGE_BYTES, &job->image, job->error);
    if (job->status != SR_OK)
        return;
    // coefficients of progressive files
    jpeg->mem->max_memory_to_use = (long)(((size_t)64 << 20) + 64 * job->source->size);
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < jpeg->output_height) {
        JSAMPROW row = sr_image_row(job->source, job->image, jpeg->output_scanline);
        jpeg_read_scanlines(jpeg, &row, 1);
    }
    jpeg_finish_decompress(jpeg);
}

static sr_status decode(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error)
{
    struct job *job = sr_alloc(sizeof *job);
    if (!job)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", source->label);
    job->source = source;
    job->error = error;
    job->jpeg.err = jpeg_std_error(&job->errors);
    job->jpeg.client_data = job;
    job->errors.error_exit = on_error;
    job->errors.emit_message = on_message;
    job->errors.output_message = be_silent;
    job->progress.progress_monitor = watch;
    if (setjmp(job->escape) == 0)
        read_all(job);
    jpeg_destroy_decompress(&job->jpeg);
    sr_status status = job->status;
    *image = job->image;
    if (status != SR_OK) {
        sr_image_free(job->image);
        *image = NULL;
    }
    sr_free(job);
    return status;
}

const struct sr_image_codec sr_image_codec_jpeg = {"JPEG", {".jpg", ".jpeg"}, is_mine, decode, NULL};
