/* SPDX-License-Identifier: MIT */
/* The public pictures: they check the arguments and call the image room. */
#include <steradian/picture.h>

#include "api/private.h"

#include <math.h>
#include <stdio.h>

const char *sr_version(void)
{
    return SR_VERSION;
}

sr_status api_tell(const struct sr_error *error, char *text, size_t size)
{
    if (text && size)
        snprintf(text, size, "%s", error->text);
    return error->status;
}

sr_status api_wrap_image(struct sr_image *image, struct sr_picture **picture, struct sr_error *error)
{
    *picture = sr_alloc(sizeof **picture);
    if (!*picture) {
        sr_image_free(image);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a picture");
    }
    (*picture)->image = image;
    return SR_OK;
}

uint32_t sr_picture_width(const struct sr_picture *picture)
{
    return picture->image->width;
}

uint32_t sr_picture_height(const struct sr_picture *picture)
{
    return picture->image->height;
}

uint32_t sr_picture_channel_count(const struct sr_picture *picture)
{
    return picture->image->channel_count;
}

const char *sr_picture_channel_name(const struct sr_picture *picture, uint32_t channel)
{
    return channel < picture->image->channel_count ? picture->image->channels[channel].name : NULL;
}

const char *sr_picture_channel_unit(const struct sr_picture *picture, uint32_t channel)
{
    return channel < picture->image->channel_count ? picture->image->channels[channel].unit : NULL;
}

float sr_picture_value(const struct sr_picture *picture, uint32_t x, uint32_t y, uint32_t channel)
{
    const struct sr_image *image = picture->image;
    if (x >= image->width || y >= image->height || channel >= image->channel_count)
        return NAN;
    return image->floats[sr_image_index(image, x, y) + channel];
}

const float *sr_picture_values(const struct sr_picture *picture)
{
    return picture->image->floats;
}

sr_status sr_picture_read(const char *path, struct sr_picture **picture, char *error, size_t error_size)
{
    struct sr_error e = {0};
    struct sr_image *image;
    *picture = NULL;
    if (sr_image_read(path, &image, &e) != SR_OK)
        return api_tell(&e, error, error_size);
    if (sr_image_to_float(image, &e) != SR_OK) {
        sr_image_free(image);
        return api_tell(&e, error, error_size);
    }
    return api_wrap_image(image, picture, &e) == SR_OK ? SR_OK : api_tell(&e, error, error_size);
}

sr_status sr_picture_write(const struct sr_picture *picture, const char *path, char *error, size_t error_size)
{
    struct sr_error e = {0};
    struct sr_image_write_options options = {.tone = {.op = SR_TONE_LINEAR, .is_auto = true}};
    return sr_image_write(path, picture->image, &options, &e) == SR_OK ? SR_OK : api_tell(&e, error, error_size);
}

void sr_picture_destroy(struct sr_picture *picture)
{
    if (!picture)
        return;
    sr_image_free(picture->image);
    sr_free(picture);
}
