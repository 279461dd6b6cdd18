/* SPDX-License-Identifier: MIT */
/* What a realistic camera has in files: the surfaces of its lens, and the shape of its aperture.
 *
 * A lens file has four numbers for each surface, from the front to the rear: radius of curvature [mm] (0: the stop),
 * distance to the next surface or to the film [mm], index of what is behind it (0: air), diameter [mm]; # begins a
 * comment. The aperture's image is scaled so that its mean is pi / 4, that of the disk in its square. */
#include "import/number.h"
#include "import/pbrt/build.h"

#include <string.h>

enum { SIDE = 256, MOST_SURFACES = 1000 };

static sr_status read_surfaces(struct sr_pbrt_build *b, const char *path, struct sr_location where,
                               struct sr_sensor_lens *lens)
{
    char *text;
    size_t size;
    struct sr_error inner = {0};
    if (sr_file_read(path, 1 << 20, &text, &size, &inner) != SR_OK)
        return sr_pbrt_fail(b->d, where, b->error, inner.status, "%s", inner.text);
    b->hash = sr_pbrt_hash(b->hash, text, size);
    float *values = sr_arena_alloc(b->arena, 4 * MOST_SURFACES * sizeof *values);
    uint32_t count = 0, line = 1;
    const char *p = text, *bad = NULL;
    while (values && !bad && p < text + size) {
        if (*p == '#') {
            while (p < text + size && *p != '\n')
                ++p;
        } else if (*p == ' ' || *p == '\t' || *p == '\n' || *p == '\r') {
            line += *p++ == '\n';
        } else {
            char word[64];
            size_t n = strcspn(p, " \t\r\n#");
            double v;
            memcpy(word, p, n < sizeof word ? n : 0);
            word[n < sizeof word ? n : 0] = 0;
            const char *end = sr_number_read(word, &v);
            if (!end || *end || end == word || !isfinite(v) || count == 4 * MOST_SURFACES)
                bad = p;
            else
                values[count++] = (float)v;
            p += n;
        }
    }
    lens->surfaces = values;
    lens->surface_count = count / 4;
    sr_status status = SR_OK;
    if (!values)
        status = sr_pbrt_no_memory(b);
    else if (bad)
        status = sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT, "%s:%u: expected a number, of at most %d surfaces",
                              path, line, MOST_SURFACES);
    else if (count % 4 || count == 0)
        status = sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT,
                              "%s: %u numbers: expected four for each surface of the lens", path, count);
    sr_free(text);
    return status;
}

// whether a ray toward +x crosses the polygon's border an odd number of times
static bool is_within(const float (*corner)[2], int n, float x, float y)
{
    bool odd = false;
    for (int i = 0; i < n; ++i) {
        const float *p = corner[i], *q = corner[(i + 1) % n];
        if ((p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]))
            odd = !odd;
    }
    return odd;
}

static bool draw(const char *shape, float *out)
{
    float corner[10][2];
    int n = 0;
    bool is_gaussian = strcmp(shape, "gaussian") == 0, is_square = strcmp(shape, "square") == 0;
    if (strcmp(shape, "pentagon") == 0)
        for (; n < 5; ++n) {
            float angle = SR_PI * (0.5f + 0.4f * (float)n);
            corner[n][0] = 0.8f * cosf(angle);
            corner[n][1] = 0.8f * sinf(angle);
        }
    else if (strcmp(shape, "star") == 0)
        for (; n < 10; ++n) {
            float angle = SR_PI * 0.2f * (float)n, r = n & 1 ? 1 : cosf(0.4f * SR_PI) / cosf(0.2f * SR_PI);
            corner[n][0] = r * cosf(angle);
            corner[n][1] = r * sinf(angle);
        }
    else if (!is_gaussian && !is_square)
        return false;
    for (int j = 0; j < SIDE; ++j)
        for (int i = 0; i < SIDE; ++i) {
            float x = ((float)i + 0.5f) * (2.0f / SIDE) - 1, y = ((float)j + 0.5f) * (2.0f / SIDE) - 1;
            out[j * SIDE + i] = is_gaussian ? sr_max(0, expf(-x * x - y * y) - expf(-1))
                                : is_square ? fabsf(x) < 0.5f && fabsf(y) < 0.5f
                                            : is_within((const float(*)[2])corner, n, x, y);
        }
    return true;
}

static sr_status read_aperture(struct sr_pbrt_build *b, const char *name, struct sr_location where,
                               struct sr_sensor_lens *lens)
{
    float *values = sr_arena_alloc(b->arena, SIDE * SIDE * sizeof *values);
    lens->aperture_width = lens->aperture_height = SIDE;
    if (!values)
        return sr_pbrt_no_memory(b);
    if (!draw(name, values)) {
        const char *path = sr_pbrt_resolve(b, b->arena, name, where);
        struct sr_image *image = NULL;
        struct sr_error inner = {0};
        if (!path)
            return sr_pbrt_no_memory(b);
        if (sr_image_read(path, &image, &inner) != SR_OK || sr_image_to_float(image, &inner) != SR_OK) {
            sr_image_free(image);
            return sr_pbrt_fail(b->d, where, b->error, inner.status, "aperture: %s", inner.text);
        }
        uint64_t size[2] = {image->width, image->height};
        b->hash = sr_pbrt_hash(b->hash, size, sizeof size);
        b->hash = sr_pbrt_hash(b->hash, image->floats,
                               (size_t)image->width * image->height * image->channel_count * sizeof(float));
        int rgb[3] = {0, 0, 0};
        sr_image_find_rgb(image, rgb);
        lens->aperture_width = image->width;
        lens->aperture_height = image->height;
        values = sr_arena_alloc(b->arena, (size_t)image->width * image->height * sizeof *values);
        for (uint32_t y = 0; values && y < image->height; ++y)
            for (uint32_t x = 0; x < image->width; ++x) {
                const float *p = image->floats + sr_image_index(image, x, y);
                // rows from below
                values[(size_t)(image->height - 1 - y) * image->width + x] = (p[rgb[0]] + p[rgb[1]] + p[rgb[2]]) / 3;
            }
        sr_image_free(image);
        if (!values)
            return sr_pbrt_no_memory(b);
    }
    size_t n = (size_t)lens->aperture_width * lens->aperture_height;
    double sum = 0;
    for (size_t i = 0; i < n; ++i)
        sum += values[i] >= 0 ? (double)values[i] : (double)NAN;
    if (!(sum > 0) || !isfinite(sum))
        return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT,
                            "aperture \"%s\": expected an image that is somewhere bright and nowhere negative", name);
    for (size_t i = 0; i < n; ++i)
        values[i] *= (float)(0.25 * 3.14159265358979323846 * (double)n / sum);
    lens->aperture = values;
    return SR_OK;
}

sr_status sr_pbrt_lens(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_sensor_lens *lens)
{
    struct sr_pbrt_param *file = sr_pbrt_find(&e->params, "lensfile"), *aperture = sr_pbrt_find(&e->params, "aperture");
    const struct sr_pbrt_param *diameter = sr_pbrt_find(&e->params, "aperturediameter");
    lens->diagonal = b->film_diagonal;
    if (!file)
        return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT, "Camera \"%s\": expected \"string lensfile\"",
                            e->model);
    const char *path = sr_pbrt_resolve(b, b->arena, file->strings[0], file->where);
    if (!path)
        return sr_pbrt_no_memory(b);
    if (read_surfaces(b, path, file->where, lens) != SR_OK)
        return b->error->status;
    for (uint32_t i = 0; diameter && i < lens->surface_count; ++i)
        if (lens->surfaces[4 * i] == 0 && lens->surfaces[4 * i + 3] < diameter->floats[0])
            sr_pbrt_warn(b->d, diameter->where,
                         "aperturediameter %g mm is more than the stop of the lens has, which stays %g mm wide",
                         (double)diameter->floats[0], (double)lens->surfaces[4 * i + 3]);
    return aperture && aperture->strings[0][0] ? read_aperture(b, aperture->strings[0], aperture->where, lens) : SR_OK;
}
