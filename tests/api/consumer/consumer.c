/* SPDX-License-Identifier: MIT */
/* A stranger's program: it knows the installed headers only. Loads a scene, renders it, measures in it, and is told
 * what is wrong with a file that is not there. Compiled as C and as C++.
 *
 * Usage: consumer SCENE */
#include <steradian/steradian.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures;

static void expect(int condition, const char *what)
{
    if (!condition) {
        fprintf(stderr, "failed: %s\n", what);
        failures += 1;
    }
}

static void look_at_picture(const struct sr_picture *picture)
{
    uint32_t width = sr_picture_width(picture), height = sr_picture_height(picture),
             count = sr_picture_channel_count(picture);
    uint32_t red = count, error_of_red = count;
    for (uint32_t c = 0; c < count; ++c) {
        if (strcmp(sr_picture_channel_name(picture, c), "R") == 0)
            red = c;
        if (strcmp(sr_picture_channel_name(picture, c), "SE.R") == 0)
            error_of_red = c;
    }
    expect(width == 512 && height == 512, "the picture has the scene's size");
    expect(red < count && error_of_red < count, "the picture has the channels R and SE.R");
    if (failures)
        return;
    expect(strcmp(sr_picture_channel_unit(picture, red), "cd/m^2") == 0, "R is in cd/m^2");
    expect(sr_picture_channel_name(picture, count) == NULL, "no name past the last channel");
    expect(isnan(sr_picture_value(picture, width, 0, red)), "NaN outside the picture");

    double sum = 0;
    int is_finite = 1;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            float value = sr_picture_value(picture, x, y, red);
            is_finite = is_finite && isfinite(value);
            sum += (double)value;
        }
    expect(is_finite && sum > 0, "the picture is finite and not black");
    expect(sr_picture_values(picture)[red] == sr_picture_value(picture, 0, 0, red), "values and value agree");
    printf("mean of R: %.4g %s\n", sum / ((double)width * height), sr_picture_channel_unit(picture, red));
}

static void measure(const struct sr_world *world)
{
    const double floor_m[3] = {0.278, 0, 0.2796}, up[3] = {0, 1, 0};
    struct sr_quantity E_v, E_e;
    expect(sr_world_irradiance(world, floor_m, up, 256, 16, &E_v, &E_e) == SR_OK, "irradiance is measured");
    char text[128];
    expect(strcmp(sr_unit_text(E_v.unit, text, sizeof text), "lx") == 0, "illuminance has a unit");
    expect(strcmp(sr_unit_text(E_e.unit, text, sizeof text), "W/m^2") == 0, "irradiance has a unit");
    expect(E_v.value > 0 && E_e.value > 0, "there is light on the floor");
    expect(E_v.u > 0 && E_v.u < 0.1 * E_v.value, "a reading has an uncertainty");
    expect(E_v.degrees == 15, "16 replicates have 15 degrees of freedom");
    expect(fabs(sr_quantity_expanded(&E_v, 0.95) / E_v.u - 2.131449546) < 1e-6, "Student's factor of 15 degrees");
    puts(sr_quantity_text("E_v", &E_v, text, sizeof text));
}

int main(int argc, char **argv)
{
    char error[256] = "";
    struct sr_world *world = NULL;
    expect(sr_world_load("no/such/file.pbrt", NULL, NULL, &world, error, sizeof error) != SR_OK,
           "a missing file is an error");
    expect(world == NULL && strstr(error, "no/such/file.pbrt") != NULL, "the error names the file");
    printf("steradian %s; of a missing file it says: %s\n", sr_version(), error);

    if (argc < 2 || sr_world_load(argv[1], NULL, NULL, &world, error, sizeof error) != SR_OK) {
        fprintf(stderr, "failed: the scene is loaded: %s\n", error);
        return 1;
    }
    struct sr_render_settings settings;
    memset(&settings, 0, sizeof settings);
    settings.spp = 1;
    struct sr_picture *picture = NULL;
    expect(sr_world_render(world, &settings, &picture, error, sizeof error) == SR_OK && picture != NULL,
           "the scene is rendered");
    if (picture)
        look_at_picture(picture);
    sr_picture_destroy(picture);
    measure(world);
    sr_world_destroy(world);
    return failures ? 1 : 0;
}
