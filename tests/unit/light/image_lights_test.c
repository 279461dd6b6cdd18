/* SPDX-License-Identifier: MIT */
/* Lights whose intensity is an image: against their definition direction by direction, flux by quadrature, and maps
 * made square. */
#include "scenery.h"

#define SIDE 12u
static const double pi = 3.14159265358979323846;

static const float *texels(int channels, uint32_t w, uint32_t h)
{
    static float t[3 * 4096];
    for (uint32_t i = 0; i < w * h; ++i)
        for (int k = 0; k < channels; ++k)
            t[(uint32_t)channels * i + (uint32_t)k] =
                i % 7 == 0 ? 0 : 0.1f + 0.8f * (float)((i * (uint32_t)(k + 3)) % 17) / 17 + (i == 40 ? 9 : 0);
    return t;
}

static struct sr_transform placed(bool is_rotation)
{
    struct sr_transform turn = sr_transform_rotate(70, (sr_vec3){1, 2, 3}),
                        move = sr_transform_translate((sr_vec3){1, -2, 0.5f});
    struct sr_transform other = is_rotation ? sr_transform_identity() : sr_transform_scale((sr_vec3){1.5f, -0.5f, 1});
    struct sr_transform both = sr_transform_multiply(&turn, &other);
    return sr_transform_multiply(&move, &both);
}

static struct sr_light light_of(const char *name, struct sr_texels t, struct sr_transform place, float scale,
                                float power)
{
    const struct sr_light_model *m = sr_light_model_find(name);
    struct sr_light_common *self = scenery_new(m);
    self->texels = t;
    self->light_to_world = place;
    scenery_set(m, self, "filename", &(const char *){"image.exr"}, sizeof(char *));
    SCENERY_FLOAT(m, self, "scale", scale);
    SCENERY_FLOAT(m, self, "power", power);
    return scenery_finish(m, self);
}

// [cd] toward w, by the light sampler at a distance
static double intensity(struct sr_light light, sr_vec3 place, sr_vec3 w)
{
    const float r = 3;
    double sum = 0;
    for (int g = 0; g < SCENERY_GROUPS; ++g) {
        struct sr_wavelengths waves = scenery_wavelengths(g);
        struct sr_point x = {.p = sr_mad(place, r, w)};
        struct sr_light_sample s;
        if (!sr_light_draw(light, &x, (sr_vec2){0.5f, 0.5f}, &waves, &s))
            return 0;
        EXPECT(s.is_delta && s.pdf == 1);
        sum += (double)(r * r) * scenery_luminous(s.L, &waves);
    }
    return sum;
}

TEST(a_goniometric_light_is_its_map_with_the_pole_along_y)
{
    struct sr_texels t = {SIDE, SIDE, 3, NULL, texels(3, SIDE, SIDE), NULL, SR_SRGB};
    for (int k = 0; k < 2; ++k) {
        struct sr_transform place = placed(k == 0);
        struct sr_light light = light_of("goniometric", t, place, 5, NAN);
        struct sr_rng rng = sr_rng_seed(7, 1);
        for (int i = 0; i < 100; ++i) {
            sr_vec2 uv = {sr_rng_float(&rng), sr_rng_float(&rng)};
            size_t at = ((size_t)(uv.y * SIDE) * SIDE + (size_t)(uv.x * SIDE)) * 3;
            sr_vec3 d = sr_equal_area_square_to_sphere(uv),
                    out = sr_normalize(sr_transform_vector(&place, (sr_vec3){d.x, d.z, d.y}));
            double Y = ((double)t.floats[at] + (double)t.floats[at + 1] + (double)t.floats[at + 2]) / 3;
            EXPECT_NEAR(intensity(light, sr_transform_point(&place, (sr_vec3){0, 0, 0}), out), 5 * Y,
                        1e-3 * 5 * Y + 1e-9);
        }
    }
    // power is the flux of the whole light, and what a texel sends is its share
    struct sr_light light = light_of("goniometric", t, sr_transform_identity(), 2, 300);
    EXPECT_RELATIVE(light.model->power(light.self), 600, 1e-5);
    double flux = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; ++i) {
        sr_vec3 d = sr_equal_area_square_to_sphere(
            (sr_vec2){((float)(i % SIDE) + 0.5f) / SIDE, ((float)(i / SIDE) + 0.5f) / SIDE});
        flux += 4 * pi / (SIDE * SIDE) * intensity(light, (sr_vec3){0, 0, 0}, (sr_vec3){d.x, d.z, d.y});
    }
    EXPECT_RELATIVE(flux, 600, 1e-3);
}

TEST(a_projection_throws_its_image_upright_along_z)
{
    for (int k = 0; k < 3; ++k) {
        uint32_t w = k == 1 ? 6 : 20, h = k == 1 ? 16 : 10;
        double fov = k == 2 ? 130 : 60, tangent = tan(fov * pi / 360);
        double hx = w > h ? tangent * w / h : tangent, hy = w > h ? tangent : tangent * h / w;
        struct sr_texels t = {w, h, 3, NULL, texels(3, w, h), NULL, SR_SRGB};
        struct sr_transform place = placed(k != 1);
        const struct sr_light_model *m = sr_light_model_find("projection");
        struct sr_light light = light_of("projection", t, place, 4, NAN);
        SCENERY_FLOAT(m, (void *)(uintptr_t)light.self, "fov", (float)fov);
        light = scenery_finish(m, (void *)(uintptr_t)light.self);
        sr_vec3 p = sr_transform_point(&place, (sr_vec3){0, 0, 0});
        const double *y_of_rgb = sr_colour_space(SR_SRGB)->xyz_from_rgb[1];
        double flux = 0;
        for (uint32_t i = 0; i < w * h; ++i) {
            double x = (2 * (i % w + 0.4) / w - 1) * hx, y = (1 - 2 * (i / w + 0.7) / h) * hy;
            sr_vec3 d = sr_normalize(sr_transform_vector(&place, (sr_vec3){(float)x, (float)y, 1}));
            double Y = 0;
            for (int c = 0; c < 3; ++c)
                Y += y_of_rgb[c] * (double)t.floats[3 * i + (uint32_t)c];
            if (i % 3 == 0)
                EXPECT_NEAR(intensity(light, p, d), 4 * Y, 3e-3 * 4 * Y + 1e-9);
            for (int s = 0; s < 64; ++s) { // INTEGRAL cos^3 dA over the texel
                double sx = (2 * (i % w + (s % 8 + 0.5) / 8) / w - 1) * hx,
                       sy = (1 - 2 * (i / w + (s / 8 + 0.5) / 8) / h) * hy;
                flux += 4 * Y * pow(1 + sx * sx + sy * sy, -1.5) * 4 * hx * hy / (w * h) / 64;
            }
        }
        EXPECT_RELATIVE(light.model->power(light.self), flux, 2e-3);
        sr_vec3 beside = sr_normalize(sr_transform_vector(&place, (sr_vec3){(float)(1.01 * hx), 0, 1}));
        EXPECT(intensity(light, p, beside) == 0);
        sr_vec3 behind = sr_normalize(sr_transform_vector(&place, (sr_vec3){0, 0, -1}));
        EXPECT(intensity(light, p, behind) == 0);
        struct sr_light_bounds b;
        EXPECT(light.model->bounds(light.self, &b) && b.power > 0 && b.box.lo.x == p.x);
        struct sr_light powered = light_of("projection", t, place, 0.5f, 80);
        EXPECT_RELATIVE(powered.model->power(powered.self), 40, 1e-5);
    }
}

TEST(images_that_lights_cannot_use_are_refused)
{
    static const char *const names[] = {"goniometric", "projection"};
    for (int k = 0; k < 2; ++k) {
        const struct sr_light_model *m = sr_light_model_find(names[k]);
        float bad[3 * 4 * 3] = {0};
        for (int i = 0; i < 4; ++i) {
            struct sr_error error = {0};
            struct sr_light_common *self = scenery_new(m);
            self->texels =
                (struct sr_texels){i == 1 && k == 0 ? 3 : 2, 2, i == 1 && k == 1 ? 1 : 3, NULL, bad, NULL, SR_SRGB};
            scenery_set(m, self, "filename", &(const char *){i == 0 ? NULL : "image.exr"}, sizeof(char *));
            bad[4] = i == 2 ? NAN : 0;
            if (i == 3)
                SCENERY_FLOAT(m, self, "power", 5); // of a black image
            EXPECT(m->prepare(self, &scenery_arena, &error) == SR_ERROR_INPUT && error.text[0]);
        }
    }
    const struct sr_light_model *m = sr_light_model_find("projection");
    for (int i = 0; i < 2; ++i) {
        struct sr_error error = {0};
        struct sr_light_common *self = scenery_new(m);
        self->texels = (struct sr_texels){2, 2, 3, NULL, texels(3, 2, 2), NULL, SR_SRGB};
        scenery_set(m, self, "filename", &(const char *){"image.exr"}, sizeof(char *));
        SCENERY_FLOAT(m, self, "fov", i ? 180 : 0);
        EXPECT(m->prepare(self, &scenery_arena, &error) == SR_ERROR_INPUT && strstr(error.text, "fov"));
    }
}

TEST(a_latitude_longitude_map_keeps_its_directions_and_its_luminance)
{
    enum { W = 64, H = 32 };
    static float map[W * H * 3];
    const double *y_of_rgb = sr_colour_space(SR_SRGB)->xyz_from_rgb[1];
    double mean = 0;
    for (int i = 0; i < W * H; ++i)
        for (int c = 0; c < 3; ++c) {
            double theta = pi * (i / W + 0.5) / H, phi = 2 * pi * (i % W + 0.5) / W; // smooth, and a sun of one texel
            map[3 * i + c] =
                (float)(1 + 0.5 * sin(theta) * cos(phi - c) + 0.2 * cos(theta)) + (i == 9 * W + 21 ? 500 : 0);
            mean += y_of_rgb[c] * (double)map[3 * i + c] * (cos(pi * (i / W) / H) - cos(pi * (i / W + 1) / H)) / 2 / W;
        }
    struct sr_texels t = {W, H, 3, NULL, map, NULL, SR_SRGB};
    struct sr_error error = {0};
    EXPECT(sr_light_is_latitude_longitude(&t));
    EXPECT(sr_light_make_square(&t, &scenery_arena, &error) == SR_OK);
    EXPECT(t.width == t.height && t.width >= 36 && t.channels == 3 && !sr_light_is_latitude_longitude(&t));
    double sum = 0, sun = 0;
    for (uint32_t i = 0; i < t.width * t.height; ++i) {
        sr_vec3 d = sr_equal_area_square_to_sphere(
            (sr_vec2){((float)(i % t.width) + 0.5f) / (float)t.width, ((float)(i / t.width) + 0.5f) / (float)t.height});
        double theta = acos((double)d.z), phi = atan2((double)d.y, (double)d.x);
        double to_sun =
            acos(sin(theta) * sin(pi * 9.5 / H) * cos(phi - 2 * pi * 21.5 / W) + cos(theta) * cos(pi * 9.5 / H));
        for (int c = 0; c < 3; ++c) {
            double v = (double)t.floats[3 * i + (uint32_t)c];
            sum += y_of_rgb[c] * v;
            if (to_sun > 0.4)
                EXPECT_NEAR(v, 1 + 0.5 * sin(theta) * cos(phi - c) + 0.2 * cos(theta), 0.1);
            else
                sun += v;
        }
    }
    double n = (double)t.width * t.height;
    EXPECT_RELATIVE(sum / n, mean, 1e-4);
    double lost = 4 * pi / n * sun / 3, sent = 500 * (cos(pi * 9 / H) - cos(pi * 10 / H)) * 2 * pi / W;
    EXPECT_NEAR(lost, sent + 2 * pi * (1 - cos(0.4)) * 1.3, 0.15 * sent);
}
