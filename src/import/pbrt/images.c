/* SPDX-License-Identifier: MIT */
/* Images of textures, lights and normal maps as texels; each file is read once.
 *
 * Bytes stay bytes, with a table of 256 linear values: sRGB, linear, or (byte / 255)^gamma. */
#include "import/number.h"
#include "import/pbrt/build.h"

#include <string.h>

struct sr_pbrt_image {
    const char *path;
    float gamma; // read so: matters for whole numbers of 16 bits
    struct sr_image *image;
    int channels[4], channel_count; // which of the image's channels are used
    enum sr_colour_space_id space;
    struct sr_texels kept; // copy in the scene's arena; width 0: none yet
    const void *dense;     // the chosen channels, if not all in order; in the scratch arena
};

void sr_pbrt_images_free(struct sr_pbrt_build *b)
{
    for (size_t i = 0; i < b->images.count; ++i)
        sr_image_free(SR_PBRT_AT(b->images, struct sr_pbrt_image, i)->image);
    sr_array_free(&b->images);
}

/* The colour space whose primaries and white the file names, within what 4 decimals say; otherwise sRGB. */
static enum sr_colour_space_id find_space(const struct sr_image *image)
{
    for (int id = 0; id < SR_COLOUR_SPACE_COUNT && image->has_chromaticities; ++id) {
        const struct sr_colour_space *space = sr_colour_space((enum sr_colour_space_id)id);
        double largest = 0;
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < 2; ++k)
                largest = fmax(largest, fabs(space->xy[i][k] - image->chromaticities[i][k]));
        if (largest < 2e-3)
            return (enum sr_colour_space_id)id;
    }
    return SR_SRGB;
}

static void choose_channels(struct sr_pbrt_image *i)
{
    int rgb[3], alpha = sr_image_find_channel(i->image, "A");
    i->channel_count = 1;
    i->channels[0] = 0;
    if (!sr_image_find_rgb(i->image, rgb))
        return;
    bool is_grey = rgb[0] == rgb[1] && rgb[1] == rgb[2];
    i->channel_count = is_grey ? 1 : alpha >= 0 ? 4 : 3;
    for (int c = 0; c < i->channel_count; ++c)
        i->channels[c] = c < 3 ? rgb[c] : alpha;
}

/* The chosen channels side by side. */
static sr_status make_dense(struct sr_pbrt_build *b, struct sr_pbrt_image *i)
{
    const struct sr_image *im = i->image;
    bool is_dense = i->channel_count == (int)im->channel_count;
    for (int c = 0; c < i->channel_count; ++c)
        is_dense = is_dense && i->channels[c] == c;
    i->dense = im->bytes ? (const void *)im->bytes : im->floats;
    if (is_dense)
        return SR_OK;
    size_t pixels = (size_t)im->width * im->height, n = (size_t)i->channel_count, size = im->bytes ? 1 : sizeof(float);
    char *to = sr_arena_alloc(&b->scratch, pixels * n * size);
    if (!to)
        return sr_pbrt_no_memory(b);
    const char *from = i->dense;
    for (size_t p = 0; p < pixels; ++p)
        for (size_t c = 0; c < n; ++c)
            memcpy(to + (p * n + c) * size, from + (p * im->channel_count + (size_t)i->channels[c]) * size, size);
    i->dense = to;
    return SR_OK;
}

/* ---- reading ---- */

struct job {
    const char *path;
    const struct sr_pbrt_memory_file *memory; // or NULL: on disk
    float gamma;
    struct sr_location where;
    struct sr_image *image;
    struct sr_error error;
    uint64_t hash;
};

/* 16-bit numbers, read as linear, to the power of gamma; alpha stays. */
static void bend(struct sr_image *image, float gamma)
{
    size_t n = (size_t)image->width * image->height, channels = image->channel_count;
    for (size_t c = 0; c < channels; ++c)
        for (size_t i = 0; i < n && strcmp(image->channels[c].name, "A") != 0; ++i)
            image->floats[i * channels + c] = powf(image->floats[i * channels + c], gamma);
}

static void read_image(void *context, uint64_t k)
{
    struct job *j = &((struct job *)context)[k];
    char *file = NULL;
    size_t size = j->memory ? j->memory->size : 0;
    if (!j->memory && sr_file_read(j->path, (size_t)16 << 30, &file, &size, &j->error) != SR_OK)
        return;
    const void *data = j->memory ? j->memory->data : file;
    j->hash = sr_pbrt_hash(0, data, size);
    sr_image_decode(j->path, data, size, j->gamma > 0 ? SR_IMAGE_LINEAR : SR_IMAGE_SRGB, &j->image, &j->error);
    if (j->image && j->image->floats && j->gamma > 0 && j->gamma != 1 && size > 4 && memcmp(data, "\x89PNG", 4) == 0)
        bend(j->image, j->gamma);
    sr_free(file);
}

static sr_status keep(struct sr_pbrt_build *b, struct job *j)
{
    if (!j->image)
        return sr_pbrt_fail(b->d, j->where, b->error, j->error.status, "%s", j->error.text);
    struct sr_pbrt_image *i = sr_array_push(&b->images, sizeof *i);
    if (!i) {
        sr_image_free(j->image);
        return sr_pbrt_no_memory(b);
    }
    b->hash = sr_pbrt_hash(b->hash, &j->hash, sizeof j->hash);
    *i = (struct sr_pbrt_image){.path = j->path, .gamma = j->gamma, .image = j->image, .space = find_space(j->image)};
    choose_channels(i);
    return make_dense(b, i);
}

static struct sr_pbrt_image *find(struct sr_pbrt_build *b, const char *path, float gamma)
{
    for (size_t k = 0; k < b->images.count; ++k) {
        struct sr_pbrt_image *i = SR_PBRT_AT(b->images, struct sr_pbrt_image, k);
        if (strcmp(i->path, path) == 0 && (i->gamma == gamma || i->image->bytes))
            return i;
    }
    return NULL;
}

sr_status sr_pbrt_images_read_ahead(struct sr_pbrt_build *b)
{
    const struct sr_pbrt_late_texture *late = b->late_textures.data;
    struct job *jobs = sr_arena_alloc(&b->scratch, b->late_textures.count * sizeof *jobs);
    size_t count = 0;
    if (!jobs)
        return sr_pbrt_no_memory(b);
    for (size_t k = 0; k < b->late_textures.count; ++k) {
        bool is_known = find(b, late[k].path, late[k].gamma) != NULL;
        for (size_t i = 0; i < count && !is_known; ++i)
            is_known = strcmp(jobs[i].path, late[k].path) == 0 && jobs[i].gamma == late[k].gamma;
        if (!is_known)
            jobs[count++] = (struct job){.path = late[k].path,
                                         .memory = sr_pbrt_memory_file(b->d, late[k].path),
                                         .gamma = late[k].gamma,
                                         .where = late[k].where};
    }
    sr_parallel_for(b->threads, count, read_image, jobs);
    sr_status status = SR_OK;
    for (size_t i = 0; i < count; ++i) {
        if (status == SR_OK)
            status = keep(b, &jobs[i]);
        else
            sr_image_free(jobs[i].image);
    }
    return status;
}

static sr_status make_decode(struct sr_pbrt_build *b, float gamma, const float **out)
{
    float *table = sr_arena_alloc(b->arena, 256 * sizeof *table);
    for (int i = 0; i < 256 && table; ++i)
        table[i] = gamma == 0 ? sr_image_decode_srgb((float)i / 255) : powf((float)i / 255, gamma);
    *out = table;
    return table ? SR_OK : sr_pbrt_no_memory(b);
}

sr_status sr_pbrt_texels(struct sr_pbrt_build *b, const char *path, struct sr_location where, float gamma,
                         bool for_good, struct sr_texels *out)
{
    struct sr_pbrt_image *i = find(b, path, gamma);
    if (!i) {
        struct job j = {.path = path, .memory = sr_pbrt_memory_file(b->d, path), .gamma = gamma, .where = where};
        read_image(&j, 0);
        sr_status status = keep(b, &j);
        if (status != SR_OK)
            return status;
        i = find(b, path, gamma);
    }
    *out = (struct sr_texels){.width = i->image->width,
                              .height = i->image->height,
                              .channels = (uint32_t)i->channel_count,
                              .space = i->space};
    size_t size = (size_t)out->width * out->height * out->channels * (i->image->bytes ? 1 : sizeof(float));
    const void *data = i->dense;
    if (for_good && !i->kept.width) {
        i->kept = *out;
        void *copy = sr_arena_copy(b->arena, data, size);
        *(i->image->bytes ? (const void **)&i->kept.bytes : (const void **)&i->kept.floats) = copy;
        if (!copy)
            return sr_pbrt_no_memory(b);
    }
    if (for_good)
        data = i->image->bytes ? (const void *)i->kept.bytes : i->kept.floats;
    out->bytes = i->image->bytes ? data : NULL;
    out->floats = i->image->bytes ? NULL : data;
    return make_decode(b, gamma, &out->decode);
}

sr_status sr_pbrt_encoding(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const char *word, float *gamma)
{
    *gamma = 0;
    if (!word || strcmp(word, "sRGB") == 0 || strcmp(word, "srgb") == 0)
        return SR_OK;
    if (strcmp(word, "linear") == 0) {
        *gamma = 1;
        return SR_OK;
    }
    if (strncmp(word, "gamma ", 6) == 0) {
        double value = 0;
        const char *end = sr_number_read(word + 6, &value);
        *gamma = (float)value;
        if (end && *end == 0 && value > 0.01 && value < 100)
            return SR_OK;
    }
    return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                        "%s \"%s\": encoding \"%s\": expected sRGB, linear or \"gamma x\"", e->directive, e->model,
                        word);
}
