/* SPDX-License-Identifier: MIT */
/* Real files of other programs, where the reference folder is present: sizes, channels, plausible values. */
#include "make.h"

#include <dirent.h>

struct expected {
    const char *name;
    uint32_t width, height, channels;
    bool is_bytes;
};

TEST(named_files_have_their_size_and_channels)
{
    static const struct expected files[] = {
        {"envmaps/bitterli_envmap.hdr", 1024, 512, 3, false},
        {"envmaps/grace_latlong.exr", 1024, 512, 3, false},
        {"scenes/bathroom/textures/wood.exr", 910, 2048, 3, false},
        {"scenes/teapot/textures/envmap.pfm", 512, 512, 3, false},
        {"scenes/staircase2/textures/Tiles.tga", 894, 894, 3, true},
        {"scenes/staircase2/textures/Wallpaper.tga", 512, 512, 3, true},
        {"scenes/staircase2/textures/wood5.tga", 1600, 1200, 3, true},
        {"references/cornell-box__scene-v4.mean.pfm", 256, 256, 3, false},
        {"references/cornell-box__scene-v4.half.pfm", 16, 16, 3, false},
        {"gltf/ClearCoatTest/FirstRow.jpg", 880, 386, 3, true},
        {"gltf/BoxTextured/glTF/CesiumLogoFlat.png", 256, 256, 3, true},
        {"spectra/colour_science_io/BiSpectral.exr", 16, 16, 864, false},
        {"spectra/colour_science_io/Polarised.exr", 32, 32, 36, false},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        struct sr_image *image = read_or_fail(test_reference_file(files[i].name));
        if (image->width != files[i].width || image->height != files[i].height ||
            image->channel_count != files[i].channels || (image->bytes != NULL) != files[i].is_bytes)
            test_fail(__FILE__, __LINE__, "%s: %u x %u, %u channels", files[i].name, image->width, image->height,
                      image->channel_count);
        sr_image_free(image);
    }
}

/* Every row and column differs from its neighbours by less than from a row far away: a flipped, sheared or swapped
 * image, or one read with the wrong stride, would not be smooth. */
static void expect_smooth(const char *name, const struct sr_image *image)
{
    double near = 0, far = 0;
    for (uint32_t y = 0; y + 1 < image->height; y++)
        for (uint32_t x = 0; x + 1 < image->width; x++) {
            double v[3];
            uint32_t far_y = (y + image->height / 2) % image->height, far_x = (x + image->width / 2) % image->width;
            size_t at[3] = {sr_image_index(image, x, y), sr_image_index(image, x + 1, y + 1),
                            sr_image_index(image, far_x, far_y)};
            for (int k = 0; k < 3; k++)
                v[k] = image->floats ? tanh((double)image->floats[at[k]]) : image->bytes[at[k]] / 255.0;
            near += fabs(v[1] - v[0]);
            far += fabs(v[2] - v[0]);
        }
    if (!(near < 0.75 * far))
        test_fail(__FILE__, __LINE__, "%s: is not smooth: %g from pixel to pixel, %g across", name, near, far);
}

TEST(photographs_are_smooth)
{
    static const char *const names[] = {"envmaps/bitterli_envmap.hdr",
                                        "envmaps/grace_latlong.exr",
                                        "scenes/teapot/textures/envmap.pfm",
                                        "scenes/staircase2/textures/wood5.tga",
                                        "gltf/ClearCoatTest/FirstRow.jpg",
                                        "gltf/BoxTextured/glTF/CesiumLogoFlat.png",
                                        "references/veach-mis__scene-v4.mean.pfm"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct sr_image *image = read_or_fail(test_reference_file(names[i]));
        expect_smooth(names[i], image);
        sr_image_free(image);
    }
}

TEST(a_rendering_of_the_cornell_box_has_red_left_and_green_right)
{
    struct sr_image *image = read_or_fail(test_reference_file("references/cornell-box__scene-v4.mean.pfm"));
    double left[3] = {0}, right[3] = {0};
    for (uint32_t y = 100; y < 156; y++)
        for (uint32_t x = 8; x < 24; x++)
            for (int c = 0; c < 3; c++) {
                left[c] += (double)image->floats[sr_image_index(image, x, y) + (size_t)c];
                right[c] += (double)image->floats[sr_image_index(image, 255 - x, y) + (size_t)c];
            }
    EXPECT(left[0] > 2 * left[1] && right[1] > 1.5 * right[0]);
    // the lamp is on the ceiling: the brightest pixel is in the upper half
    size_t brightest = 0;
    for (size_t p = 0; p < 256 * 256; p++)
        if (image->floats[3 * p] > image->floats[3 * brightest])
            brightest = p;
    EXPECT(brightest / 256 < 128);
    sr_image_free(image);
}

static bool is_image(const char *name)
{
    static const char *const endings[] = {".exr", ".png", ".jpg", ".jpeg", ".tga", ".pfm", ".hdr"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (sr_path_has_ending(name, endings[i]))
            return true;
    return false;
}

static int read_folder(const char *folder)
{
    DIR *open = opendir(folder);
    int n = 0;
    for (struct dirent *entry; open && (entry = readdir(open));) {
        char path[4096];
        if (entry->d_name[0] == '.' || snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) >= (int)sizeof path)
            continue;
        if (!is_image(entry->d_name)) {
            n += entry->d_type == DT_DIR ? read_folder(path) : 0;
            continue;
        }
        struct sr_image *image = read_or_fail(path);
        for (size_t i = 0; image->floats && i < (size_t)image->width * image->height * image->channel_count; i++)
            if (!isfinite(image->floats[i]))
                test_fail(__FILE__, __LINE__, "%s: value %zu is not finite", path, i);
        sr_image_free(image);
        n++;
    }
    if (open)
        closedir(open);
    return n;
}

TEST(every_image_of_the_reference_folder_is_read)
{
    static const char *const folders[] = {"scenes", "envmaps", "references", "gltf", "spectra", "meshes"};
    int n = 0;
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
        n += read_folder(test_reference_file(folders[i]));
    EXPECT(n >= 100);
}
