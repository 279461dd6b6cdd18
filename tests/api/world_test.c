/* SPDX-License-Identifier: MIT */
/* The public interface, through the public headers: what callers may leave out, how they stop a render, and that a
 * world may be used by several threads at a time. */
#include "test.h"

#include <steradian/steradian.h>

#include <pthread.h>

/* A diffuse floor of reflectance 0.5 under a uniform sky of 100 cd/m^2: E = pi 100 lx, and L = 50 cd/m^2 as far as the
 * floor goes. */
static const char *const floor_and_sky =
    "LookAt 0 1 0  0 0 0  0 0 1\n"
    "Camera \"perspective\" \"float fov\" 45\n"
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16 \"string filename\" \"out.exr\"\n"
    "PixelFilter \"box\"\n"
    "Sampler \"zsobol\" \"integer pixelsamples\" 16\n"
    "Integrator \"path\" \"integer maxdepth\" 3\n"
    "WorldBegin\n"
    "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ] \"float scale\" 100\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -9 0 -9  9 0 -9  -9 0 9  9 0 9 ]\n";

static const char *write_scene(const char *name, const char *text)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    FILE *file = fopen(path, "w");
    EXPECT(file && fputs(text, file) >= 0 && fclose(file) == 0);
    return path;
}

static struct sr_world *load(const char *path)
{
    char error[256] = "";
    struct sr_world *world;
    if (sr_world_load(path, NULL, NULL, &world, error, sizeof error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error);
    return world;
}

static struct sr_world *load_floor_and_sky(void)
{
    return load(write_scene("floor_and_sky.pbrt", floor_and_sky));
}

static uint32_t find_channel(const struct sr_picture *picture, const char *name)
{
    for (uint32_t c = 0; c < sr_picture_channel_count(picture); ++c)
        if (strcmp(sr_picture_channel_name(picture, c), name) == 0)
            return c;
    test_fail(__FILE__, __LINE__, "there is no channel %s", name);
}

static size_t value_count(const struct sr_picture *picture)
{
    return (size_t)sr_picture_width(picture) * sr_picture_height(picture) * sr_picture_channel_count(picture);
}

static bool are_same(const struct sr_picture *a, const struct sr_picture *b)
{
    return value_count(a) == value_count(b) &&
           memcmp(sr_picture_values(a), sr_picture_values(b), value_count(a) * sizeof(float)) == 0;
}

TEST(zeroed_settings_and_no_settings_are_the_scenes_own)
{
    struct sr_world *world = load_floor_and_sky();
    struct sr_render_settings zeroed = {0};
    struct sr_picture *a, *b;
    EXPECT_EQUAL_INT(sr_world_render(world, &zeroed, &a, NULL, 0), SR_OK);
    EXPECT_EQUAL_INT(sr_world_render(world, NULL, &b, NULL, 0), SR_OK);
    EXPECT_EQUAL_INT(sr_picture_width(a), 24);
    EXPECT_EQUAL_INT(sr_picture_height(a), 16);
    EXPECT_NEAR(sr_picture_value(a, 0, 0, find_channel(a, "samples")), 16, 0);
    EXPECT_EQUAL_TEXT(sr_picture_channel_unit(a, find_channel(a, "G")), "cd/m^2");
    EXPECT(are_same(a, b));
    sr_picture_destroy(a);
    sr_picture_destroy(b);
    sr_world_destroy(world);
}

TEST(pictures_are_in_candela_per_square_metre)
{
    struct sr_world *world = load_floor_and_sky();
    struct sr_picture *picture;
    EXPECT_EQUAL_INT(sr_world_render(world, &(struct sr_render_settings){.spp = 64}, &picture, NULL, 0), SR_OK);
    const uint32_t channel[3] = {find_channel(picture, "R"), find_channel(picture, "G"), find_channel(picture, "B")};
    const double y_of_rgb[3] = {0.2126, 0.7152, 0.0722}; // of sRGB
    double sum = 0, pixels = 24 * 16;
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 24; ++x)
            for (int c = 0; c < 3; ++c)
                sum += y_of_rgb[c] * (double)sr_picture_value(picture, x, y, channel[c]);
    EXPECT_RELATIVE(sum / pixels, 50, 2e-3); // 24576 samples of 8 wavelengths each
    sr_picture_destroy(picture);
    sr_world_destroy(world);
}

TEST(a_seed_makes_another_picture_and_the_same_seed_the_same)
{
    struct sr_world *world = load_floor_and_sky();
    struct sr_picture *pictures[3];
    const uint32_t seeds[3] = {1, 1, 2};
    for (int i = 0; i < 3; ++i)
        EXPECT_EQUAL_INT(
            sr_world_render(world, &(struct sr_render_settings){.has_seed = true, .seed = seeds[i], .threads = 1 + i},
                            &pictures[i], NULL, 0),
            SR_OK);
    EXPECT(are_same(pictures[0], pictures[1]));
    EXPECT(!are_same(pictures[0], pictures[2]));
    for (int i = 0; i < 3; ++i)
        sr_picture_destroy(pictures[i]);
    sr_world_destroy(world);
}

/* How far a bump map tilts the surface depends on the footprint that it is read with, so that must not depend on how
 * often a pixel is sampled. */
TEST(more_samples_do_not_change_what_a_bump_map_is_expected_to_look_like)
{
    static const char *const waves =
        "LookAt 0 3 -1  0 0 0  0 1 0\n"
        "Camera \"perspective\" \"float fov\" 45\n"
        "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16 \"string filename\" \"out.exr\"\n"
        "PixelFilter \"box\"\n"
        "Integrator \"path\" \"integer maxdepth\" 1\n"
        "WorldBegin\n"
        "LightSource \"distant\" \"rgb L\" [ 1 1 1 ] \"float scale\" 100 \"point3 from\" [ 1 0.5 0 ] \"point3 to\" [ 0 0 0 ]\n"
        "Texture \"waves\" \"float\" \"checkerboard\" \"float uscale\" 150 \"float vscale\" 150 \"float tex1\" 0.1 \"float tex2\" 0\n"
        "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ] \"texture displacement\" \"waves\"\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ -9 0 -9  9 0 -9  -9 0 9  9 0 9 ]\n";
    struct sr_world *world = load(write_scene("waves.pbrt", waves));
    double mean[2] = {0, 0}, variance[2] = {0, 0};
    for (int i = 0; i < 2; ++i) {
        struct sr_picture *picture;
        uint32_t spp = i ? 256 : 4;
        EXPECT_EQUAL_INT(sr_world_render(world, &(struct sr_render_settings){.spp = spp}, &picture, NULL, 0), SR_OK);
        uint32_t green = find_channel(picture, "G"), error = find_channel(picture, "SE.G"),
                 w = sr_picture_width(picture), h = sr_picture_height(picture);
        for (uint32_t y = 0; y < h; ++y)
            for (uint32_t x = 0; x < w; ++x) {
                double e = (double)sr_picture_value(picture, x, y, error) / (w * h);
                mean[i] += (double)sr_picture_value(picture, x, y, green) / (w * h);
                variance[i] += e * e;
            }
        sr_picture_destroy(picture);
    }
    double error = sqrt(variance[0] + variance[1]);
    EXPECT(error < 0.04 * mean[1]);
    EXPECT_NEAR(mean[0], mean[1], 4.9 * error);
    sr_world_destroy(world);
}

TEST(what_may_be_null_is_null)
{
    sr_world_destroy(NULL);
    sr_picture_destroy(NULL);
    struct sr_world *world;
    EXPECT_EQUAL_INT(sr_world_load("no/such/scene.pbrt", NULL, NULL, &world, NULL, 0), SR_ERROR_INPUT);
    EXPECT(!world);
    struct sr_picture *picture;
    EXPECT(sr_picture_read("no/such/picture.exr", &picture, NULL, 0) != SR_OK && !picture);

    world = load_floor_and_sky();
    const double point_m[3] = {0, 0, 0}, up[3] = {0, 2, 0};
    EXPECT_EQUAL_INT(sr_world_irradiance(world, point_m, up, 16, 2, NULL, NULL), SR_OK);
    sr_world_destroy(world);
}

TEST(errors_say_where_and_what_and_never_overflow)
{
    struct sr_world *world;
    char error[512];
    const char *path = write_scene("wrong.pbrt", "WorldBegin\nShape \"sphre\"\n");
    EXPECT_EQUAL_INT(sr_world_load(path, NULL, NULL, &world, error, sizeof error), SR_ERROR_INPUT);
    EXPECT(!world && strstr(error, "wrong.pbrt:2:") && strstr(error, "sphre") && strstr(error, "sphere"));
    char small[8] = "xxxxxxx";
    EXPECT_EQUAL_INT(sr_world_load(path, NULL, NULL, &world, small, sizeof small), SR_ERROR_INPUT);
    EXPECT_EQUAL_INT(strlen(small), sizeof small - 1);
}

static void remember(void *user, const char *text)
{
    snprintf(user, 512, "%s", text);
}

TEST(warnings_reach_the_caller)
{
    char text[1024], heard[512] = "";
    snprintf(text, sizeof text, "%s", floor_and_sky);
    strncat(text, "Shape \"sphere\" \"float radus\" 1\n", sizeof text - strlen(text) - 1);
    struct sr_world *world;
    EXPECT_EQUAL_INT(sr_world_load(write_scene("warned.pbrt", text), remember, heard, &world, NULL, 0), SR_OK);
    EXPECT(strstr(heard, "radus"));
    sr_world_destroy(world);
}

TEST(senseless_settings_are_refused)
{
    struct sr_world *world = load_floor_and_sky();
    struct sr_picture *picture;
    char error[256] = "";
    EXPECT_EQUAL_INT(sr_world_render(world, &(struct sr_render_settings){.lambda_min_nm = 700, .lambda_max_nm = 400},
                                     &picture, error, sizeof error),
                     SR_ERROR_USAGE);
    EXPECT(!picture && strstr(error, "700"));
    EXPECT_EQUAL_INT(
        sr_world_render(world, &(struct sr_render_settings){.replicates = 1}, &picture, error, sizeof error),
        SR_ERROR_USAGE);
    EXPECT(!picture && strstr(error, "replicate"));

    const double point_m[3] = {0, 0, 0}, up[3] = {0, 1, 0}, nowhere[3] = {0, 0, 0};
    struct sr_quantity E;
    EXPECT_EQUAL_INT(sr_world_irradiance(world, point_m, up, 16, 1, &E, NULL), SR_ERROR_USAGE);
    EXPECT_EQUAL_INT(sr_world_irradiance(world, point_m, up, 0, 2, &E, NULL), SR_ERROR_USAGE);
    EXPECT_EQUAL_INT(sr_world_irradiance(world, point_m, nowhere, 16, 2, &E, NULL), SR_ERROR_USAGE);
    sr_world_destroy(world);
}

static bool stop_at_once(void *user, double share)
{
    *(double *)user = share;
    return false;
}

TEST(a_render_that_is_stopped_gives_what_there_is)
{
    struct sr_world *world = load(SR_TEST_SOURCE_DIR "/scenes/cornell-box.pbrt");
    double share = -1;
    struct sr_render_settings settings = {
        .spp = 4096, .progress = stop_at_once, .user = &share}; // half an hour, uninterrupted
    struct sr_picture *picture;
    EXPECT_EQUAL_INT(sr_world_render(world, &settings, &picture, NULL, 0), SR_CANCELLED);
    EXPECT(picture && sr_picture_width(picture) == 512 && share >= 0 && share < 1);
    uint32_t samples = find_channel(picture, "samples");
    double sum = 0;
    for (uint32_t y = 0; y < 512; ++y)
        for (uint32_t x = 0; x < 512; ++x)
            sum += (double)sr_picture_value(picture, x, y, samples);
    EXPECT(sum > 0 && sum < 512.0 * 512 * 4096);
    sr_picture_destroy(picture);
    sr_world_destroy(world);
}

struct rendering {
    const struct sr_world *world;
    struct sr_picture *picture;
    struct sr_quantity E;
    sr_status status;
};

static void *render(void *context)
{
    struct rendering *r = context;
    const double point_m[3] = {1, 0, 1}, up[3] = {0, 1, 0};
    r->status = sr_world_render(r->world, &(struct sr_render_settings){.spp = 64, .threads = 2}, &r->picture, NULL, 0);
    if (r->status == SR_OK)
        r->status = sr_world_irradiance(r->world, point_m, up, 256, 8, &r->E, NULL);
    return NULL;
}

TEST(threads_that_render_one_world_at_a_time_get_the_same_bytes)
{
    struct sr_world *world = load_floor_and_sky();
    struct rendering r[3] = {{.world = world}, {.world = world}, {.world = world}};
    pthread_t threads[2];
    for (int i = 0; i < 2; ++i)
        EXPECT(pthread_create(&threads[i], NULL, render, &r[i]) == 0);
    for (int i = 0; i < 2; ++i)
        pthread_join(threads[i], NULL);
    render(&r[2]); // alone
    for (int i = 0; i < 3; ++i)
        EXPECT_EQUAL_INT(r[i].status, SR_OK);
    EXPECT(are_same(r[0].picture, r[2].picture) && are_same(r[1].picture, r[2].picture));
    EXPECT(r[0].E.value == r[2].E.value && r[1].E.value == r[2].E.value);
    EXPECT(r[1].E.u == r[2].E.u);
    for (int i = 0; i < 3; ++i)
        sr_picture_destroy(r[i].picture);
    sr_world_destroy(world);
}

TEST(irradiance_under_a_uniform_sky_is_pi_L)
{
    struct sr_world *world = load_floor_and_sky();
    const double point_m[3] = {0.5, 0, -0.25}, up[3] = {0, 1, 0};
    struct sr_quantity E_v, E_e;
    EXPECT_EQUAL_INT(sr_world_irradiance(world, point_m, up, 512, 32, &E_v, &E_e), SR_OK);
    char unit[32];
    EXPECT_EQUAL_TEXT(sr_unit_text(E_v.unit, unit, sizeof unit), "lx");
    EXPECT_EQUAL_TEXT(sr_unit_text(E_e.unit, unit, sizeof unit), "W/m^2");
    EXPECT_NEAR(E_v.degrees, 31, 0);
    EXPECT(E_v.u > 0 && E_v.u < 0.01 * E_v.value);
    EXPECT_NEAR(E_v.value, 100 * 3.14159265358979, 6 * E_v.u);
    double efficacy = E_v.value / E_e.value; // of D65, 360 to 830 nm [lm/W]
    EXPECT(efficacy > 150 && efficacy < 300);
    sr_world_destroy(world);
}

TEST(meters_of_a_scene_are_listed_and_read)
{
    struct sr_world *world = load(
        write_scene("meters.pbrt",
                    "WorldBegin\nLightSource \"infinite\" \"spectrum L\" [200 1 1000 1] \"float scale\" 2\n"
                    "#@ Meter \"spherical\" \"string name\" \"ball\"\n#@ Meter \"irradiancemap\" \"vector3 u\" [1 0 0] "
                    "\"vector3 v\" [0 1 0] \"integer nx\" 3 \"integer ny\" 2\n"));
    struct sr_world_meter meter;
    struct sr_world_reading reading;
    char error[256] = "";
    EXPECT_EQUAL_INT(sr_world_meter_count(world), 2);
    EXPECT(sr_world_meter(world, 0, &meter) && meter.width == 0);
    EXPECT_EQUAL_TEXT(meter.name, "ball");
    EXPECT_EQUAL_TEXT(meter.kind, "spherical");
    EXPECT(sr_world_meter(world, 1, &meter) && meter.width == 3 && meter.height == 2);
    EXPECT(!sr_world_meter(world, 2, &meter));
    EXPECT_EQUAL_INT(sr_world_measure(world, 0, NULL, &reading, error, sizeof error), SR_OK);
    EXPECT_RELATIVE(reading.value[SR_PHOTOPIC].value, 2 * 3.14159265358979, 1e-5);
    EXPECT(reading.samples == 65536 && reading.samples_with_light == 65536 && reading.is_on_target &&
           reading.remarks[0] == 0);
    struct sr_quantity bins[3];
    struct sr_measure_options options = {.error = 0.001,
                                         .system = SR_PHOTOPIC,
                                         .spectrum_first_nm = 450,
                                         .spectrum_step_nm = 100,
                                         .spectrum_count = 3,
                                         .spectrum = bins};
    EXPECT_EQUAL_INT(sr_world_measure(world, 0, &options, &reading, error, sizeof error), SR_OK);
    EXPECT(reading.is_on_target);
    // 2 cd/m^2 of a flat spectrum: 2 / (683 * 106.857) W m^-2 sr^-1 nm^-1
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(bins[i].value, 3.14159265358979 * 2 / (683 * 106.856895), 5 * bins[i].u);
    struct sr_picture *map;
    options.spectrum_count = 0;
    EXPECT_EQUAL_INT(sr_world_measure_map(world, 1, &options, &map, error, sizeof error), SR_OK);
    sr_picture_destroy(map);
    EXPECT_EQUAL_INT(sr_world_measure_map(world, 0, NULL, &map, error, sizeof error), SR_ERROR_USAGE);
    EXPECT(strstr(error, "makes no map") && map == NULL);
    EXPECT_EQUAL_INT(sr_world_measure(world, 2, NULL, &reading, error, sizeof error), SR_ERROR_USAGE);
    EXPECT(strstr(error, "there is no meter 2"));
    options.spectrum_count = 3;
    options.spectrum = NULL;
    EXPECT_EQUAL_INT(sr_world_measure(world, 0, &options, &reading, error, sizeof error), SR_ERROR_USAGE);
    sr_world_destroy(world);
}

TEST(expanded_uncertainty_uses_students_quantiles)
{
    const struct sr_quantity reading = {.value = 1, .u = 2, .degrees = 10};
    EXPECT_NEAR(sr_quantity_expanded(&reading, 0.95), 2 * 2.228138852, 1e-7); // tables of Student's t
    EXPECT_NEAR(sr_quantity_expanded(&reading, 0.99), 2 * 3.169272673, 1e-7);
}

TEST(pictures_come_back_from_files_as_they_were)
{
    struct sr_world *world = load_floor_and_sky();
    struct sr_picture *picture, *read;
    EXPECT_EQUAL_INT(
        sr_world_render(world, &(struct sr_render_settings){.spp = 4, .with_auxiliary = true}, &picture, NULL, 0),
        SR_OK);
    char path[512], error[256] = "";
    snprintf(path, sizeof path, "%s/picture.exr", test_folder());
    EXPECT_EQUAL_INT(sr_picture_write(picture, path, error, sizeof error), SR_OK);
    EXPECT_EQUAL_INT(sr_picture_read(path, &read, error, sizeof error), SR_OK);
    EXPECT_EQUAL_INT(sr_picture_channel_count(read), sr_picture_channel_count(picture));
    for (uint32_t c = 0; c < sr_picture_channel_count(picture); ++c) {
        uint32_t other = find_channel(read, sr_picture_channel_name(picture, c));
        EXPECT_EQUAL_TEXT(sr_picture_channel_unit(read, other), sr_picture_channel_unit(picture, c));
        for (uint32_t x = 0; x < 24; ++x)
            EXPECT(sr_picture_value(read, x, 7, other) == sr_picture_value(picture, x, 7, c));
    }
    EXPECT(isnan(sr_picture_value(read, 24, 0, 0)) && isnan(sr_picture_value(read, 0, 0, 1000)));
    EXPECT(!sr_picture_channel_name(read, 1000));
    EXPECT(sr_picture_write(picture, "no/such/folder/picture.exr", error, sizeof error) != SR_OK &&
           strstr(error, "no/such/folder"));
    sr_picture_destroy(read);
    sr_picture_destroy(picture);
    sr_world_destroy(world);
}

/* A unit of work may take hours, of few large tiles and many samples: whoever wants to stop is asked all the same. */
static bool stop_and_count(void *user, double share)
{
    *(int *)user += 1;
    EXPECT(share >= 0 && share <= 1);
    return false;
}

TEST(a_render_of_endless_units_stops_when_it_is_asked_to)
{
    struct sr_world *world = load_floor_and_sky();
    struct sr_picture *picture;
    int asked = 0;
    struct sr_render_settings settings = {.spp = 1u << 30, .progress = stop_and_count, .user = &asked};
    EXPECT_EQUAL_INT(sr_world_render(world, &settings, &picture, NULL, 0), SR_CANCELLED);
    EXPECT(asked >= 1 && picture);
    sr_picture_destroy(picture);
    sr_world_destroy(world);
}

static const char *metered(void)
{
    static char text[2048];
    snprintf(text, sizeof text, "%s#@ Meter \"spherical\"\n", floor_and_sky);
    return text;
}

TEST(threads_and_wavelengths_that_are_none_are_refused)
{
    struct sr_world *world = load(write_scene("metered.pbrt", metered()));
    const struct sr_render_settings wrong[] = {{.threads = -1},
                                               {.lambda_min_nm = NAN},
                                               {.lambda_max_nm = NAN},
                                               {.lambda_min_nm = -400},
                                               {.lambda_max_nm = INFINITY}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        char error[256] = "";
        struct sr_picture *picture;
        EXPECT_EQUAL_INT(sr_world_render(world, &wrong[i], &picture, error, sizeof error), SR_ERROR_USAGE);
        EXPECT(!picture && strstr(error, "expected"));
        struct sr_measure_options o = {.threads = wrong[i].threads,
                                       .lambda_min_nm = wrong[i].lambda_min_nm,
                                       .lambda_max_nm = wrong[i].lambda_max_nm};
        struct sr_world_reading reading;
        EXPECT_EQUAL_INT(sr_world_measure(world, 0, &o, &reading, error, sizeof error), SR_ERROR_USAGE);
    }
    struct sr_picture *picture;
    EXPECT_EQUAL_INT(sr_world_render(world, &(struct sr_render_settings){.spp = UINT32_MAX}, &picture, NULL, 0),
                     SR_ERROR_USAGE);
    EXPECT(!picture);
    sr_world_destroy(world);
}

TEST(spectra_that_make_no_sense_are_the_callers_fault)
{
    struct sr_world *world = load(write_scene("metered.pbrt", metered()));
    struct sr_quantity spectrum[4];
    const double wrong[][3] = {{400, -10, 0}, {400, 0, 0},    {NAN, 10, 0},
                               {400, 10, -1}, {400, 10, NAN}, {400, 10, INFINITY}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        struct sr_measure_options o = {.spectrum_first_nm = wrong[i][0],
                                       .spectrum_step_nm = wrong[i][1],
                                       .spectrum_fwhm_nm = wrong[i][2],
                                       .spectrum_count = 4,
                                       .spectrum = spectrum};
        struct sr_world_reading reading;
        char error[256] = "";
        EXPECT_EQUAL_INT(sr_world_measure(world, 0, &o, &reading, error, sizeof error), SR_ERROR_USAGE);
        EXPECT(strstr(error, "expected"));
    }
    sr_world_destroy(world);
}

TEST(normals_may_have_any_length_but_zero)
{
    struct sr_world *world = load_floor_and_sky();
    const double point[3] = {0, 0.5, 0}, length[] = {1, 1e-40, 1e-300, 3e38, 1e300};
    struct sr_quantity E;
    for (size_t i = 0; i < sizeof length / sizeof length[0]; ++i) {
        const double normal[3] = {0, length[i], 0};
        EXPECT_EQUAL_INT(sr_world_irradiance(world, point, normal, 64, 4, &E, NULL), SR_OK);
        EXPECT_RELATIVE(E.value, 314.159, 0.02);
    }
    const double none[3] = {0, 0, 0};
    EXPECT_EQUAL_INT(sr_world_irradiance(world, point, none, 64, 4, &E, NULL), SR_ERROR_USAGE);
    sr_world_destroy(world);
}
