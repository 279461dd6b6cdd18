/* SPDX-License-Identifier: MIT */
/* OpenEXR through the OpenEXRCore C interface, written to memory: float32 scan lines, ZIP, one part, so that every bit
 * of a float is kept. */
#include "image/exr.h"

#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

static int64_t put(exr_const_context_t context, void *user, const void *buffer, uint64_t size, uint64_t offset,
                   exr_stream_error_func_ptr_t complain)
{
    struct sr_array *out = ((struct sr_exr_job *)user)->out;
    if (offset > SIZE_MAX / 8 || size > SIZE_MAX / 8 || !sr_array_reserve(out, offset + size, 1)) {
        ((struct sr_exr_job *)user)->has_no_memory = true;
        complain(context, EXR_ERR_OUT_OF_MEMORY, "not enough memory");
        return -1;
    }
    memcpy((uint8_t *)out->data + offset, buffer, size);
    if (out->count < offset + size)
        out->count = offset + size;
    return (int64_t)size;
}

static exr_result_t write_header(exr_context_t exr, const struct sr_image *image)
{
    int part = 0;
    exr_attr_v2f_t centre = {.x = 0, .y = 0};
    exr_attr_box2i_t display = {.min = {.x = 0, .y = 0},
                                .max = {.x = (int32_t)image->full_width - 1, .y = (int32_t)image->full_height - 1}};
    exr_attr_box2i_t data = {
        .min = {.x = image->x0, .y = image->y0},
        .max = {.x = image->x0 + (int32_t)image->width - 1, .y = image->y0 + (int32_t)image->height - 1}};
    exr_result_t result = exr_set_longname_support(exr, 1);
    if (result == EXR_ERR_SUCCESS)
        result = exr_add_part(exr, "image", EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS)
        result = exr_initialize_required_attr(exr, part, &display, &data, 1, &centre, 1, EXR_LINEORDER_INCREASING_Y,
                                              EXR_COMPRESSION_ZIP);
    for (uint32_t c = 0; c < image->channel_count && result == EXR_ERR_SUCCESS; c++) {
        char key[80];
        snprintf(key, sizeof key, "unit.%s", image->channels[c].name);
        result =
            exr_add_channel(exr, part, image->channels[c].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
        if (result == EXR_ERR_SUCCESS && image->channels[c].unit[0])
            result = exr_attr_set_string(exr, part, key, image->channels[c].unit);
    }
    if (result == EXR_ERR_SUCCESS && image->has_chromaticities) {
        const double(*k)[2] = image->chromaticities;
        exr_attr_chromaticities_t chromaticities = {(float)k[0][0], (float)k[0][1], (float)k[1][0], (float)k[1][1],
                                                    (float)k[2][0], (float)k[2][1], (float)k[3][0], (float)k[3][1]};
        result = exr_attr_set_chromaticities(exr, part, "chromaticities", &chromaticities);
    }
    for (uint32_t i = 0; i < image->attribute_count && result == EXR_ERR_SUCCESS; i++)
        if (strcmp(image->attributes[i].name, "name") != 0)
            result = exr_attr_set_string(exr, part, image->attributes[i].name, image->attributes[i].text);
    return result == EXR_ERR_SUCCESS ? exr_write_header(exr) : result;
}

/* Chunks are packed by all threads, some at a time, and written in their order, so that the bytes do not depend on the
 * threads. */
struct packed {
    void *data;
    size_t size; // [B]
    exr_result_t result;
};

struct packing {
    exr_context_t exr;
    const struct sr_image *image;
    const float *floats;
    uint32_t lines, begin, end; // of a chunk; the chunks that are packed now
    atomic_uint next;
    struct packed *packed;            // [end - begin]
    exr_encode_pipeline_t *pipelines; // one for each thread
    struct sr_exr_job *jobs;          // likewise
};

static exr_result_t keep_packed(exr_encode_pipeline_t *pipeline)
{
    struct packed *p = pipeline->encoding_user_data;
    p->size = pipeline->compressed_bytes;
    p->data = sr_exr_alloc(p->size);
    if (!p->data)
        return EXR_ERR_OUT_OF_MEMORY;
    memcpy(p->data, pipeline->compressed_buffer, p->size);
    return EXR_ERR_SUCCESS;
}

static exr_result_t pack_chunk(struct packing *k, uint32_t chunk, exr_encode_pipeline_t *pipeline,
                               struct packed *packed)
{
    const struct sr_image *image = k->image;
    uint32_t y = chunk * k->lines;
    bool is_first = !pipeline->channels;
    exr_chunk_info_t info;
    exr_result_t result = exr_write_scanline_chunk_info(k->exr, 0, image->y0 + (int32_t)y, &info);
    if (result == EXR_ERR_SUCCESS)
        result = is_first ? exr_encoding_initialize(k->exr, 0, &info, pipeline)
                          : exr_encoding_update(k->exr, 0, &info, pipeline);
    for (int16_t c = 0; c < pipeline->channel_count && result == EXR_ERR_SUCCESS; c++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[c];
        int place = sr_image_find_channel(image, channel->channel_name);
        if (place < 0)
            return EXR_ERR_INVALID_ARGUMENT;
        channel->encode_from_ptr = (const uint8_t *)(k->floats + sr_image_index(image, 0, y) + place);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = 4;
        channel->user_pixel_stride = (int32_t)(image->channel_count * 4);
        channel->user_line_stride = (int32_t)(image->channel_count * 4 * image->width);
    }
    if (result == EXR_ERR_SUCCESS && is_first)
        result = exr_encoding_choose_default_routines(k->exr, 0, pipeline);
    pipeline->encoding_user_data = packed;
    pipeline->yield_until_ready_fn = NULL;
    pipeline->write_fn = keep_packed;
    return result == EXR_ERR_SUCCESS ? exr_encoding_run(k->exr, 0, pipeline) : result;
}

static void pack_chunks(void *context, int thread)
{
    struct packing *k = context;
    struct sr_exr_job *before = sr_exr_enter(&k->jobs[thread]);
    for (uint32_t i; (i = atomic_fetch_add(&k->next, 1)) < k->end - k->begin;)
        k->packed[i].result = pack_chunk(k, k->begin + i, &k->pipelines[thread], &k->packed[i]);
    sr_exr_enter(before);
}

/* After a failure it only frees. */
static exr_result_t write_packed(struct packing *k, struct packed *p, uint32_t chunk, exr_result_t result)
{
    if (result == EXR_ERR_SUCCESS)
        result = p->result;
    if (result == EXR_ERR_SUCCESS)
        result = exr_write_scanline_chunk(k->exr, 0, k->image->y0 + (int32_t)(chunk * k->lines), p->data, p->size);
    sr_free(p->data);
    *p = (struct packed){0};
    return result;
}

static exr_result_t write_lines(exr_context_t exr, const struct sr_image *image, const float *floats,
                                struct sr_exr_job *job)
{
    enum { EACH = 8, SMALL = 1 << 16 };
    int32_t lines = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(exr, 0, &lines);
    if (result != EXR_ERR_SUCCESS || lines <= 0)
        return result;
    uint32_t chunks = (image->height - 1) / (uint32_t)lines + 1, threads = (uint32_t)sr_thread_count();
    if ((uint64_t)image->width * image->height * image->channel_count < SMALL)
        threads = 1;
    threads = threads < chunks ? threads : chunks;
    struct sr_arena arena = {0};
    struct packing k = {.exr = exr,
                        .image = image,
                        .floats = floats,
                        .lines = (uint32_t)lines,
                        .packed = sr_arena_alloc(&arena, (size_t)threads * EACH * sizeof *k.packed),
                        .pipelines = sr_arena_alloc(&arena, threads * sizeof *k.pipelines),
                        .jobs = sr_arena_alloc(&arena, threads * sizeof *k.jobs)};
    if (!k.packed || !k.pipelines || !k.jobs)
        result = EXR_ERR_OUT_OF_MEMORY;
    for (; k.begin < chunks && result == EXR_ERR_SUCCESS; k.begin = k.end) {
        k.end = chunks - k.begin < threads * EACH ? chunks : k.begin + threads * EACH;
        atomic_store(&k.next, 0);
        if (threads > 1)
            sr_parallel((int)threads, pack_chunks, &k);
        else
            pack_chunks(&k, 0);
        for (uint32_t i = k.begin; i < k.end; ++i)
            result = write_packed(&k, &k.packed[i - k.begin], i, result);
    }
    for (uint32_t t = 0; k.jobs && k.pipelines && t < threads; ++t) {
        if (k.pipelines[t].channels)
            exr_encoding_destroy(exr, &k.pipelines[t]);
        job->has_no_memory |= k.jobs[t].has_no_memory;
        if (!job->message[0])
            memcpy(job->message, k.jobs[t].message, sizeof job->message);
    }
    sr_arena_free(&arena);
    return result;
}

static float *decoded(const struct sr_image *image)
{
    size_t pixels = (size_t)image->width * image->height;
    float *floats = sr_alloc(pixels * image->channel_count * sizeof(float));
    for (size_t p = 0; floats && p < pixels; p++)
        for (uint32_t c = 0; c < image->channel_count; c++)
            floats[p * image->channel_count + c] = sr_image_value(image, p * image->channel_count + c, c);
    return floats;
}

sr_status sr_exr_encode(const struct sr_image *image, const struct sr_image_write_options *options,
                        struct sr_array *out, struct sr_error *error)
{
    (void)options;
    if ((uint64_t)image->width * image->channel_count * 4 > INT32_MAX || image->channel_count > INT16_MAX)
        return sr_fail(error, SR_ERROR_USAGE, "an EXR file takes rows of 2 GiB and 32767 channels at most");
    for (uint32_t c = 0; c < image->channel_count; c++)
        if (!image->channels[c].name[0] || sr_image_find_channel(image, image->channels[c].name) != (int)c)
            return sr_fail(error, SR_ERROR_USAGE, "an EXR file needs channel names that differ, channel %u is '%s'", c,
                           image->channels[c].name);
    float *floats = image->floats ? image->floats : decoded(image);
    if (!floats)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to write an EXR file");
    struct sr_exr_job job = {.out = out};
    exr_context_initializer_t init = sr_exr_begin(&job);
    init.write_fn = put;
    init.zip_level = 2; // the noise of renderings shrinks no further at higher levels
    exr_context_t exr = NULL;
    exr_result_t result = exr_start_write(&exr, "image.exr", EXR_WRITE_FILE_DIRECTLY, &init);
    if (result == EXR_ERR_SUCCESS)
        result = write_header(exr, image);
    if (result == EXR_ERR_SUCCESS)
        result = write_lines(exr, image, floats, &job);
    if (exr) {
        exr_result_t finished = exr_finish(&exr);
        result = result == EXR_ERR_SUCCESS ? finished : result;
    }
    sr_exr_enter(NULL);
    if (floats != image->floats)
        sr_free(floats);
    if (result == EXR_ERR_SUCCESS)
        return SR_OK;
    return sr_fail(error, job.has_no_memory || result == EXR_ERR_OUT_OF_MEMORY ? SR_ERROR_RESOURCE : SR_ERROR_USAGE,
                   "the EXR library says: %s", job.message[0] ? job.message : exr_get_default_error_message(result));
}
