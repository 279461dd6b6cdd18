/* SPDX-License-Identifier: MIT */
/* What glows: emissive materials as area lights, and unlit ones, which show their colour as light.
 *
 *     L = emissiveFactor emissiveStrength texel       [cd/m^2], of white
 *
 * A grey factor is a scale of the image; a coloured one makes an image of its own. */
#include "import/gltf/gltf.h"

#include "image/image.h"

#include <stdio.h>
#include <string.h>

/* The image of a texture, decoded. NULL: an error. */
static struct sr_image *decode(struct sr_gltf *g, const struct sr_gltf_texture *t)
{
    const char *name = sr_gltf_image(g, t->image1 - 1);
    const struct sr_pbrt_memory_file *memory = sr_pbrt_memory_file(g->c.d, name);
    char *path = sr_path_beside(&g->scratch, g->c.path, name), *file = NULL;
    size_t size = memory ? memory->size : 0;
    struct sr_error inner = {0};
    struct sr_image *image = NULL;
    if (sr_gltf_is_well(g) && path && !memory)
        sr_file_read(path, (size_t)16 << 30, &file, &size, &inner);
    if (sr_gltf_is_well(g) && inner.status == SR_OK)
        sr_image_decode(name, memory ? memory->data : file, size, SR_IMAGE_SRGB, &image, &inner);
    sr_free(file);
    if (image && sr_image_to_float(image, &inner) != SR_OK) {
        sr_image_free(image);
        image = NULL;
    }
    if (!image)
        sr_gltf_fail(g, &t->info, "%s", inner.text);
    return image;
}

static struct sr_rgb texel(const struct sr_image *image, const int rgb[3], size_t pixel)
{
    const float *v = image->floats + pixel * image->channel_count;
    return (struct sr_rgb){v[rgb[0]], v[rgb[1]], v[rgb[2]]};
}

/* An image in memory with the factor in it, as PFM, whose rows begin at the bottom. Its name. */
static const char *tinted(struct sr_gltf *g, const struct sr_gltf_look *m, const struct sr_gltf_surface *s)
{
    struct sr_image *image = decode(g, &m->emission_texture);
    if (!image)
        return "";
    const char *slash = strrchr(g->c.path, '/'),
               *name = sr_compose_printf(&g->c, "%s#%s.emission.pfm", slash ? slash + 1 : g->c.path, s->name);
    char head[64];
    int length = snprintf(head, sizeof head, "PF\n%u %u\n-1.0\n", image->width, image->height), rgb[3];
    size_t row = 3 * (size_t)image->width, size = (size_t)length + row * image->height * sizeof(float);
    char *bytes = sr_arena_alloc(&g->c.d->words, size);
    float *line = sr_arena_alloc(&g->scratch, row * sizeof *line);
    sr_image_find_rgb(image, rgb);
    if (bytes && line) {
        memcpy(bytes, head, (size_t)length);
        for (uint32_t y = 0; y < image->height; ++y) {
            for (uint32_t x = 0; x < image->width; ++x) {
                struct sr_rgb c = texel(image, rgb, (size_t)(image->height - 1 - y) * image->width + x);
                line[3 * x] = c.r * (float)m->emission[0];
                line[3 * x + 1] = c.g * (float)m->emission[1];
                line[3 * x + 2] = c.b * (float)m->emission[2];
            }
            memcpy(bytes + length + y * row * sizeof(float), line, row * sizeof(float));
        }
        sr_compose_file(&g->c, name, bytes, size);
    } else
        sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
    sr_image_free(image);
    return name;
}

static struct sr_rgb mean(struct sr_gltf *g, const struct sr_gltf_look *m)
{
    struct sr_image *image = decode(g, &m->emission_texture);
    double sum[3] = {0, 0, 0};
    int rgb[3];
    size_t count = image ? (size_t)image->width * image->height : 1;
    if (image)
        sr_image_find_rgb(image, rgb);
    for (size_t i = 0; i < count && image; ++i) {
        struct sr_rgb c = texel(image, rgb, i);
        sum[0] += (double)c.r;
        sum[1] += (double)c.g;
        sum[2] += (double)c.b;
    }
    sr_image_free(image);
    double n = (double)count;
    return (struct sr_rgb){(float)(sum[0] / n * m->emission[0]), (float)(sum[1] / n * m->emission[1]),
                           (float)(sum[2] / n * m->emission[2])};
}

uint32_t sr_gltf_emission(struct sr_gltf *g, const struct sr_gltf_look *m, const struct sr_gltf_surface *s)
{
    struct sr_compose *to = &g->c;
    const double *e = m->emission;
    bool is_grey = e[0] == e[1] && e[1] == e[2], has_image = m->emission_texture.info.json;
    if (m->is_double_sided || m->is_unlit)
        sr_compose_bool(to, "twosided", true);
    if (has_image && s->is_split) {
        sr_gltf_warn(g, &m->at,
                     "an emissive texture beside vertex colours or other coordinates: all of it shines as its mean");
        sr_compose_rgb(to, "L", mean(g, m));
    } else if (has_image) {
        if (strcmp(m->emission_texture.swrap, "repeat") == 0 || strcmp(m->emission_texture.twrap, "repeat") == 0)
            sr_gltf_note(g, "emissive textures", "do not repeat: beyond their edge they go on as there");
        sr_compose_string(to, "filename", is_grey ? sr_gltf_image(g, m->emission_texture.image1 - 1) : tinted(g, m, s));
        if (is_grey && e[0] != 1)
            sr_compose_float(to, "scale", (float)e[0]);
    } else
        sr_compose_rgb(to, "L", (struct sr_rgb){(float)e[0], (float)e[1], (float)e[2]});
    g->has_emissive = true;
    return sr_compose_area_light(to);
}
