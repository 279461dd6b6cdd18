/* SPDX-License-Identifier: MIT */
/* OpenEXR through the OpenEXRCore C interface, read from memory.
 *
 * "OpenEXR File Layout" of the OpenEXR project. The data window becomes a plain image, with (x0, y0) its place in
 * the display window. Half and uint samples become floats (uint above 2^24 loses its last digits). Limits: only the
 * first part and level 0 are read; deep data and subsampled channels are refused; names of channels beyond 63 bytes are
 * cut. */
#include "image/exr.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

static bool is_mine(const uint8_t *data, size_t size)
{
    return size >= 4 && memcmp(data, "\x76\x2f\x31\x01", 4) == 0;
}

/* Of this thread. The library may hold its lock while it complains, so that asking it for its user data could wait for
 * ever. */
static _Thread_local struct sr_exr_job *current_job;

static void on_error(exr_const_context_t context, exr_result_t code, const char *text)
{
    struct sr_exr_job *job = current_job;
    (void)context;
    (void)code;
    if (job && !job->message[0])
        snprintf(job->message, sizeof job->message, "%s", text);
}

void *sr_exr_alloc(size_t size)
{
    void *p = sr_alloc(size);
    if (!p && current_job)
        current_job->has_no_memory = true;
    return p;
}

static int64_t take(exr_const_context_t context, void *user, void *buffer, uint64_t size, uint64_t offset,
                    exr_stream_error_func_ptr_t complain)
{
    const struct sr_image_source *source = ((struct sr_exr_job *)user)->source;
    (void)context;
    (void)complain;
    // the header is read in blocks that may end behind a small file: less is then told, and the library judges
    uint64_t left = offset < source->size ? source->size - offset : 0;
    size_t n = (size_t)(size < left ? size : left);
    memcpy(buffer, source->data + (n ? offset : 0), n);
    return (int64_t)n;
}

static int64_t source_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((struct sr_exr_job *)user)->source->size;
}

struct sr_exr_job *sr_exr_enter(struct sr_exr_job *job)
{
    struct sr_exr_job *before = current_job;
    current_job = job;
    return before;
}

exr_context_initializer_t sr_exr_begin(struct sr_exr_job *job)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    current_job = job;
    init.error_handler_fn = on_error;
    init.alloc_fn = sr_exr_alloc;
    init.free_fn = sr_free;
    init.user_data = job;
    init.flags = EXR_CONTEXT_FLAG_SILENT_HEADER_PARSE;
    return init;
}

/* ---- reading ---- */

/* R, G, B, A go first, in this order; all others keep theirs. */
static void order_channels(const exr_attr_chlist_t *list, uint32_t *place, const char **names)
{
    static const char *const first[4] = {"R", "G", "B", "A"};
    uint32_t n = 0, count = (uint32_t)list->num_channels;
    for (uint32_t c = 0; c < count; c++)
        place[c] = UINT32_MAX;
    for (int f = 0; f < 4; f++)
        for (uint32_t c = 0; c < count; c++)
            if (place[c] == UINT32_MAX && strcmp(list->entries[c].name.str, first[f]) == 0)
                place[c] = n++;
    for (uint32_t c = 0; c < count; c++) {
        if (place[c] == UINT32_MAX)
            place[c] = n++;
        names[place[c]] = list->entries[c].name.str;
    }
}

/* Text as it is, numbers in decimal; names "unit.X" become the unit of channel X. */
static sr_status keep_attribute(struct sr_image *image, const exr_attribute_t *a, struct sr_error *error)
{
    char number[40];
    const char *text = number;
    if (a->type == EXR_ATTR_STRING)
        text = a->string->str ? a->string->str : "";
    else if (a->type == EXR_ATTR_FLOAT)
        snprintf(number, sizeof number, "%.9g", (double)a->f);
    else if (a->type == EXR_ATTR_DOUBLE)
        snprintf(number, sizeof number, "%.17g", a->d);
    else if (a->type == EXR_ATTR_INT)
        snprintf(number, sizeof number, "%d", a->i);
    else if (a->type == EXR_ATTR_ENVMAP)
        text = a->uc == EXR_ENVMAP_CUBE ? "cube" : "latlong";
    else
        return SR_OK;
    static const char *const structural[] = {"type",       "pixelAspectRatio", "screenWindowWidth",
                                             "chunkCount", "version",          "name"};
    for (size_t i = 0; i < sizeof structural / sizeof *structural; i++)
        if (strcmp(a->name, structural[i]) == 0)
            return SR_OK;
    int channel = strncmp(a->name, "unit.", 5) == 0 ? sr_image_find_channel(image, a->name + 5) : -1;
    if (channel < 0)
        return sr_image_set_attribute(image, a->name, text, error);
    sr_image_set_unit(image, (uint32_t)channel, text);
    return SR_OK;
}

static sr_status read_attributes(exr_context_t exr, struct sr_image *image, struct sr_error *error)
{
    int32_t count = 0;
    sr_status status = SR_OK;
    exr_get_attribute_count(exr, 0, &count);
    for (int32_t i = 0; i < count && status == SR_OK; i++) {
        const exr_attribute_t *attribute;
        if (exr_get_attribute_by_index(exr, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute) == EXR_ERR_SUCCESS)
            status = keep_attribute(image, attribute, error);
    }
    exr_attr_chromaticities_t k;
    if (exr_attr_get_chromaticities(exr, 0, "chromaticities", &k) == EXR_ERR_SUCCESS) {
        image->has_chromaticities = true;
        memcpy(image->chromaticities,
               (double[4][2]){{k.red_x, k.red_y}, {k.green_x, k.green_y}, {k.blue_x, k.blue_y}, {k.white_x, k.white_y}},
               sizeof image->chromaticities);
    }
    return status;
}

struct chunks {
    exr_context_t exr;
    struct sr_image *image;
    const uint32_t *place;
    bool is_trial; // chunks are unpacked and left
    exr_decode_pipeline_t pipeline;
    bool is_started;
    exr_result_t (*decompress)(exr_decode_pipeline_t *);
};

/* A chunk that B44 could not make smaller is stored as it is; versions of the library up to 3.1 unpack it all the
 * same. */
static exr_result_t decompress_b44(exr_decode_pipeline_t *pipeline)
{
    struct chunks *k = pipeline->decoding_user_data;
    size_t size = (size_t)pipeline->chunk.unpacked_size;
    if (pipeline->chunk.packed_size != size)
        return k->decompress(pipeline);
    if (pipeline->unpacked_alloc_size >= size) {
        memcpy(pipeline->unpacked_buffer, pipeline->packed_buffer, size);
        return EXR_ERR_SUCCESS;
    }
    // the library's own sign for "the same bytes": both pointers are equal, and the second owns nothing
    if (pipeline->unpacked_alloc_size > 0)
        sr_free(pipeline->unpacked_buffer);
    pipeline->unpacked_buffer = pipeline->packed_buffer;
    pipeline->unpacked_alloc_size = 0;
    return EXR_ERR_SUCCESS;
}

/* One chunk, whose first pixel is (x, y) of the image, straight into the interleaved floats. */
static exr_result_t read_chunk(struct chunks *k, const exr_chunk_info_t *info, uint32_t x, uint32_t y)
{
    struct sr_image *image = k->image;
    if (x >= image->width || y >= image->height || info->width <= 0 || info->height <= 0 ||
        (uint32_t)info->width > image->width - x || (uint32_t)info->height > image->height - y)
        return EXR_ERR_CORRUPT_CHUNK;
    if (info->unpacked_size / 1100 > info->packed_size + 64) // no method packs better: it would be memory for nothing
        return EXR_ERR_CORRUPT_CHUNK;
    exr_result_t result = k->is_started ? exr_decoding_update(k->exr, 0, info, &k->pipeline)
                                        : exr_decoding_initialize(k->exr, 0, info, &k->pipeline);
    bool is_first = !k->is_started;
    k->is_started = true;
    if (result != EXR_ERR_SUCCESS)
        return result;
    if ((uint32_t)k->pipeline.channel_count != image->channel_count)
        return EXR_ERR_CORRUPT_CHUNK;
    for (int16_t c = 0; c < k->pipeline.channel_count; c++) {
        exr_coding_channel_info_t *channel = &k->pipeline.channels[c];
        channel->decode_to_ptr =
            k->is_trial ? NULL : (uint8_t *)(image->floats + sr_image_index(image, x, y) + k->place[c]);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = 4;
        channel->user_pixel_stride = (int32_t)(image->channel_count * 4);
        channel->user_line_stride = (int32_t)(image->channel_count * 4 * image->width);
    }
    if (is_first)
        result = exr_decoding_choose_default_routines(k->exr, 0, &k->pipeline);
    if (is_first && k->pipeline.decompress_fn &&
        (info->compression == EXR_COMPRESSION_B44 || info->compression == EXR_COMPRESSION_B44A)) {
        k->decompress = k->pipeline.decompress_fn;
        k->pipeline.decoding_user_data = k;
        k->pipeline.decompress_fn = decompress_b44;
    }
    return result == EXR_ERR_SUCCESS ? exr_decoding_run(k->exr, 0, &k->pipeline) : result;
}

static exr_result_t read_lines(struct chunks *k, const exr_attr_box2i_t *window)
{
    int32_t lines = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(k->exr, 0, &lines);
    if (result == EXR_ERR_SUCCESS && lines <= 0)
        return EXR_ERR_CORRUPT_CHUNK;
    for (int64_t y = window->min.y; y <= window->max.y && result == EXR_ERR_SUCCESS; y += lines) {
        exr_chunk_info_t info;
        result = exr_read_scanline_chunk_info(k->exr, 0, (int)y, &info);
        if (result == EXR_ERR_SUCCESS)
            result = read_chunk(k, &info, 0, (uint32_t)(y - window->min.y));
    }
    return result;
}

static exr_result_t read_tiles(struct chunks *k)
{
    int32_t tile_width = 0, tile_height = 0;
    exr_result_t result = exr_get_tile_sizes(k->exr, 0, 0, 0, &tile_width, &tile_height);
    if (result == EXR_ERR_SUCCESS && (tile_width <= 0 || tile_height <= 0))
        return EXR_ERR_CORRUPT_CHUNK;
    for (uint64_t y = 0; y < k->image->height && result == EXR_ERR_SUCCESS; y += (uint32_t)tile_height)
        for (uint64_t x = 0; x < k->image->width && result == EXR_ERR_SUCCESS; x += (uint32_t)tile_width) {
            exr_chunk_info_t info;
            result = exr_read_tile_chunk_info(k->exr, 0, (int)(x / (uint32_t)tile_width),
                                              (int)(y / (uint32_t)tile_height), 0, 0, &info);
            if (result == EXR_ERR_SUCCESS)
                result = read_chunk(k, &info, (uint32_t)x, (uint32_t)y);
        }
    return result;
}

static const char *refusal(exr_storage_t storage, const exr_attr_chlist_t *list, uint64_t width)
{
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return "holds deep data, a plain image was expected";
    if (list->num_channels <= 0 || list->num_channels > INT16_MAX)
        return "has no channels, or more than 32767";
    for (int c = 0; c < list->num_channels; c++)
        if (list->entries[c].x_sampling != 1 || list->entries[c].y_sampling != 1)
            return "has subsampled channels, which are not read";
    return width * (uint64_t)list->num_channels * 4 > INT32_MAX ? "has rows of more than 2 GiB" : NULL;
}

static sr_status fail(const struct sr_exr_job *job, struct sr_error *error, const char *what, exr_result_t result)
{
    if (job->has_no_memory)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", job->source->label);
    return sr_fail(error, SR_ERROR_INPUT, "%s: %s: %s", job->source->label, what,
                   job->message[0] ? job->message : exr_get_default_error_message(result));
}

static sr_status read_part(exr_context_t exr, struct sr_exr_job *job, struct sr_image **image, struct sr_error *error)
{
    const char *label = job->source->label;
    exr_storage_t storage;
    const exr_attr_chlist_t *list = NULL;
    exr_attr_box2i_t data, display;
    if (exr_get_storage(exr, 0, &storage) != EXR_ERR_SUCCESS || exr_get_channels(exr, 0, &list) != EXR_ERR_SUCCESS ||
        exr_get_data_window(exr, 0, &data) != EXR_ERR_SUCCESS ||
        exr_get_display_window(exr, 0, &display) != EXR_ERR_SUCCESS)
        return fail(job, error, "the EXR header is damaged", EXR_ERR_MISSING_REQ_ATTR);
    int64_t width = (int64_t)data.max.x - data.min.x + 1, height = (int64_t)data.max.y - data.min.y + 1;
    int64_t full_width = (int64_t)display.max.x - display.min.x + 1,
            full_height = (int64_t)display.max.y - display.min.y + 1;
    int64_t x0 = (int64_t)data.min.x - display.min.x, y0 = (int64_t)data.min.y - display.min.y;
    // within 2^30, so that sums of a place and a size stay in 32 bits
    const int64_t most = INT32_MAX / 2;
    if (width <= 0 || height <= 0 || full_width <= 0 || full_height <= 0 || full_width > INT32_MAX ||
        full_height > INT32_MAX || x0 < -most || x0 > most || y0 < -most || y0 > most)
        return sr_fail(error, SR_ERROR_INPUT, "%s: the EXR header has a data or display window that makes no sense",
                       label);
    const char *why = refusal(storage, list, (uint64_t)width);
    if (why)
        return sr_fail(error, SR_ERROR_INPUT, "%s: %s", label, why);
    struct sr_arena scratch = {0};
    uint32_t count = (uint32_t)list->num_channels;
    uint32_t *place = sr_arena_alloc(&scratch, count * sizeof *place);
    const char **names = sr_arena_alloc(&scratch, count * sizeof *names);
    sr_status status =
        place && names ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", label);
    if (status == SR_OK) {
        order_channels(list, place, names);
        status = sr_image_create_for(job->source, (uint64_t)width, (uint64_t)height, count, names, SR_IMAGE_FLOATS,
                                     image, error);
    }
    if (status == SR_OK) {
        (*image)->encoding = SR_IMAGE_LINEAR;
        (*image)->x0 = (int32_t)x0;
        (*image)->y0 = (int32_t)y0;
        (*image)->full_width = (uint32_t)full_width;
        (*image)->full_height = (uint32_t)full_height;
        status = read_attributes(exr, *image, error);
    }
    if (status == SR_OK) {
        struct chunks k = {
            .exr = exr, .image = *image, .place = place, .is_trial = sr_image_is_trial(job->source, *image)};
        exr_result_t result = storage == EXR_STORAGE_TILED ? read_tiles(&k) : read_lines(&k, &data);
        if (k.is_started)
            exr_decoding_destroy(exr, &k.pipeline);
        if (result != EXR_ERR_SUCCESS)
            status = fail(job, error, "the EXR pixels are damaged or cut short", result);
    }
    sr_arena_free(&scratch);
    return status;
}

static sr_status decode(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error)
{
    struct sr_exr_job job = {.source = source};
    exr_context_initializer_t init = sr_exr_begin(&job);
    init.read_fn = take;
    init.size_fn = source_size;
    exr_context_t exr = NULL;
    exr_result_t result = exr_start_read(&exr, source->label, &init);
    sr_status status = result == EXR_ERR_SUCCESS ? read_part(exr, &job, image, error)
                                                 : fail(&job, error, "the EXR header is damaged or cut short", result);
    if (exr)
        exr_finish(&exr);
    current_job = NULL;
    if (status == SR_OK && job.has_no_memory) // the library leaves out an attribute that it has no memory for
        status = fail(&job, error, "", EXR_ERR_OUT_OF_MEMORY);
    if (status != SR_OK) {
        sr_image_free(*image);
        *image = NULL;
    }
    return status;
}

const struct sr_image_codec sr_image_codec_exr = {"EXR", {".exr"}, is_mine, decode, sr_exr_encode};
