/* SPDX-License-Identifier: MIT */
/* Images of lights: each texel's spectrum, once; latitude-longitude maps made octahedral.
 *
 *     s(lambda) = factor * scale * sigmoid(lambda) * white(lambda)
 *     square texel = mean over its solid angle of L(theta, phi),    u = phi / (2 pi), v = theta / pi of the map
 *
 * Equal-area octahedral maps: Clarberg 2008. What is converted is scaled by one factor near 1, so that its luminance
 * over the whole sphere is that of the map, to rounding. */
#include "light/pixels.h"

enum { MOST_CELLS = 1 << 22 };

struct sr_light_turn sr_light_turn_of(const struct sr_transform *light_to_world)
{
    struct sr_light_turn t;
    for (int i = 0; i < 3; ++i) {
        t.rows[i] =
            (sr_vec3){light_to_world->inverse[i][0], light_to_world->inverse[i][1], light_to_world->inverse[i][2]};
        t.columns[i] = (sr_vec3){light_to_world->m[0][i], light_to_world->m[1][i], light_to_world->m[2][i]};
    }
    t.determinant = fabsf(sr_dot(t.rows[0], sr_cross(t.rows[1], t.rows[2])));
    return t;
}

static struct sr_light_pixel pixel_of(const struct sr_light_pixels *p, uint32_t x, uint32_t y)
{
    struct sr_spd s = sr_spd_from_rgb_illuminant(p->texels->space, sr_light_texel(p->texels, x, y));
    return (struct sr_light_pixel){s.sigmoid, s.scale * p->factor};
}

sr_status sr_light_pixels_build(struct sr_light_pixels *p, const struct sr_texels *texels, float factor,
                                const char *filename, struct sr_arena *arena, struct sr_error *error)
{
    *p = (struct sr_light_pixels){
        .texels = texels, .white = sr_colour_space(texels->space)->illuminant, .factor = factor};
    size_t n = (size_t)texels->width * texels->height;
    if (n > MOST_CELLS)
        return SR_OK;
    p->cells = sr_arena_alloc(arena, n * sizeof *p->cells);
    if (!p->cells)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the spectra of %s", filename);
    for (size_t i = 0; i < n; ++i)
        p->cells[i] = pixel_of(p, (uint32_t)(i % texels->width), (uint32_t)(i / texels->width));
    return SR_OK;
}

sr_spectrum sr_light_pixel_at(const struct sr_light_pixels *p, sr_vec2 uv, const struct sr_wavelengths *w)
{
    uint32_t x = sr_light_texel_index(uv.x, p->texels->width), y = sr_light_texel_index(uv.y, p->texels->height);
    struct sr_light_pixel c = p->cells ? p->cells[(size_t)y * p->texels->width + x] : pixel_of(p, x, y);
    struct sr_spd s = {.kind = SR_SPD_ILLUMINANT, .scale = c.scale, .sigmoid = c.sigmoid, .table = p->white};
    return sr_spd_along(&s, w);
}

/* ---- latitude-longitude maps ---- */

enum { SUB = 4 }; // looks into the map along each side of a square texel

struct conversion {
    const struct sr_texels *map;
    float *square;
    uint32_t side;
};

static void convert_row(void *context, uint64_t y)
{
    const struct conversion *c = context;
    for (uint32_t x = 0; x < c->side; ++x) {
        struct sr_rgb sum = {0};
        for (int k = 0; k < SUB * SUB; ++k) {
            sr_vec2 uv = {((float)x + ((float)(k % SUB) + 0.5f) / SUB) / (float)c->side,
                          ((float)y + ((float)(k / SUB) + 0.5f) / SUB) / (float)c->side};
            sr_vec3 d = sr_equal_area_square_to_sphere(uv);
            float u = sr_angle_of(d.y, d.x) / (2 * SR_PI),
                  v = sr_angle_of(sr_safe_sqrt(d.x * d.x + d.y * d.y), d.z) / SR_PI;
            struct sr_rgb t =
                sr_light_texel(c->map, sr_light_texel_index(u, c->map->width), sr_light_texel_index(v, c->map->height));
            sum = (struct sr_rgb){sum.r + t.r, sum.g + t.g, sum.b + t.b};
        }
        float *out = c->square + ((size_t)y * c->side + x) * 3;
        out[0] = sum.r / (SUB * SUB);
        out[1] = sum.g / (SUB * SUB);
        out[2] = sum.b / (SUB * SUB);
    }
}

// mean over the sphere: rows count by their solid angle
static double mean_of_map(const struct sr_texels *t)
{
    double sum = 0;
    for (uint32_t y = 0; y < t->height; ++y) {
        double share = (cos((double)SR_PI * y / t->height) - cos((double)SR_PI * (y + 1) / t->height)) / 2, row = 0;
        for (uint32_t x = 0; x < t->width; ++x)
            row += sr_light_texel_luminance(t, x, y);
        sum += share * row / t->width;
    }
    return sum;
}

bool sr_light_is_latitude_longitude(const struct sr_texels *t)
{
    return t->height > 1 && t->width == 2 * t->height;
}

sr_status sr_light_make_square(struct sr_texels *t, struct sr_arena *arena, struct sr_error *error)
{
    // of the map's resolution at its equator: 4 pi / side^2 = (pi / height)^2, rounded up to a multiple of 4
    uint32_t side = ((uint32_t)(1.1284 * t->height) / 4 + 1) * 4;
    size_t n = (size_t)side * side * 3;
    struct sr_texels square = {.width = side, .height = side, .channels = 3, .space = t->space};
    float *texels = sr_arena_alloc(arena, n * sizeof *texels);
    if (!texels)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for an octahedral map of %u x %u", side, side);
    square.floats = texels;
    sr_parallel_for(sr_thread_count(), side, convert_row, &(struct conversion){t, texels, side});
    double before = mean_of_map(t), after = sr_light_mean_luminance(&square);
    for (size_t i = 0; i < n && after > 0; ++i)
        texels[i] *= (float)(before / after);
    *t = square;
    return SR_OK;
}
