/* SPDX-License-Identifier: MIT */
/* Image files: which format it is, told by content first and the ending second; read whole, written beside and
 * renamed. */
#include "image/codec.h"

#include <string.h>

static const struct sr_image_codec *const codecs[] = {&sr_image_codec_exr, &sr_image_codec_png, &sr_image_codec_jpeg,
                                                      &sr_image_codec_pfm, &sr_image_codec_hdr, &sr_image_codec_qoi,
                                                      &sr_image_codec_tga};
enum { CODECS = sizeof codecs / sizeof *codecs };

static const size_t MAX_FILE_B = (size_t)16 << 30;

static const struct sr_image_codec *find_by_ending(const char *path)
{
    for (int i = 0; i < CODECS; i++)
        for (int e = 0; codecs[i]->endings[e]; e++)
            if (sr_path_has_ending(path, codecs[i]->endings[e]))
                return codecs[i];
    return NULL;
}

bool sr_image_put(struct sr_array *out, const void *bytes, size_t size)
{
    if (size > SIZE_MAX / 8 || !sr_array_reserve(out, out->count + size, 1))
        return false;
    memcpy((uint8_t *)out->data + out->count, bytes, size);
    out->count += size;
    return true;
}

static sr_status decode_by(const struct sr_image_codec *codec, struct sr_image_source *source, struct sr_image **image,
                           struct sr_error *error)
{
    sr_status status = codec->decode(source, image, error);
    if (status != SR_OK || !sr_image_is_trial(source, *image))
        return status;
    sr_image_free(*image);
    *image = NULL;
    source->is_proven = true;
    return codec->decode(source, image, error);
}

sr_status sr_image_decode(const char *label, const void *data, size_t size, enum sr_image_encoding encoding,
                          struct sr_image **image, struct sr_error *error)
{
    *image = NULL;
    if (size == 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is empty, an image was expected", label);
    struct sr_image_source source = {label, data, size, encoding, false};
    for (int i = 0; i < CODECS; i++)
        if (codecs[i]->is_mine && codecs[i]->is_mine(data, size))
            return decode_by(codecs[i], &source, image, error);
    const struct sr_image_codec *codec = find_by_ending(label);
    if (codec && codec->is_mine)
        return sr_fail(error, SR_ERROR_INPUT, "%s: does not begin like a %s file, or like any image that can be read",
                       label, codec->name);
    if (!codec)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: is no image that can be read: EXR, PNG, JPEG, PFM, HDR, QOI or TGA was expected", label);
    return decode_by(codec, &source, image, error);
}

sr_status sr_image_read_as(const char *path, enum sr_image_encoding encoding, struct sr_image **image,
                           struct sr_error *error)
{
    *image = NULL;
    char *data;
    size_t size;
    sr_status status = sr_file_read(path, MAX_FILE_B, &data, &size, error);
    if (status == SR_OK)
        status = sr_image_decode(path, data, size, encoding, image, error);
    sr_free(data);
    return status;
}

sr_status sr_image_read(const char *path, struct sr_image **image, struct sr_error *error)
{
    return sr_image_read_as(path, SR_IMAGE_SRGB, image, error);
}

sr_status sr_image_encode(const char *ending, const struct sr_image *image,
                          const struct sr_image_write_options *options, void **data, size_t *size,
                          struct sr_error *error)
{
    static const struct sr_image_write_options none = {0};
    *data = NULL;
    *size = 0;
    const struct sr_image_codec *codec = find_by_ending(ending);
    if (!codec || !codec->encode)
        return sr_fail(error, SR_ERROR_USAGE, "%s: images are written as .exr, .pfm, .hdr or .png", ending);
    struct sr_array out = {0};
    sr_status status = codec->encode(image, options ? options : &none, &out, error);
    if (status != SR_OK) {
        sr_array_free(&out);
        return status;
    }
    *data = out.data;
    *size = out.count;
    return SR_OK;
}

sr_status sr_image_write(const char *path, const struct sr_image *image, const struct sr_image_write_options *options,
                         struct sr_error *error)
{
    void *data;
    size_t size;
    struct sr_error why = {0};
    sr_status status = sr_image_encode(path, image, options, &data, &size, &why);
    if (status != SR_OK)
        return sr_fail(error, status, strncmp(why.text, path, strlen(path)) == 0 ? "%.0s%s" : "%s: %s", path, why.text);
    status = sr_file_write(path, data, size, error);
    sr_free(data);
    return status;
}
