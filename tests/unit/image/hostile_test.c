/* SPDX-License-Identifier: MIT */
/* Files that are cut short, damaged or made to hurt: a message with the name, no crash, no leak, no huge
 * allocation. */
#include "make.h"

struct seed {
    void *data;
    size_t size;
    const char *label;
};

static struct seed encode_seed(const char *ending, bool is_byte)
{
    struct sr_image *image = is_byte ? make_bytes(40, 30, 4) : make_image(40, 30, 3, NULL);
    uint64_t state = 11;
    for (size_t i = 0; image->floats && i < 40 * 30 * 3; i++)
        image->floats[i] = i < 1200 ? 1.0f : (float)next_uniform(&state);
    struct seed seed = {.label = ending};
    struct sr_error error = {0};
    EXPECT(sr_image_encode(ending, image, NULL, &seed.data, &seed.size, &error) == SR_OK);
    sr_image_free(image);
    return seed;
}

/* Run-length true colour; the run lengths make every cut matter. */
static struct seed tga_seed(void)
{
    uint8_t file[18 + 4 * 300] = {0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 30, 0, 20, 0, 24, 0x20};
    for (int i = 0; i < 300; i++)
        memcpy(file + 18 + 4 * i, (uint8_t[4]){0x81, (uint8_t)i, 2, 3}, 4);
    struct seed seed = {sr_alloc(sizeof file), sizeof file, "seed.tga"};
    memcpy(seed.data, file, sizeof file);
    return seed;
}

static struct seed file_seed(const char *name)
{
    struct seed seed = {.label = name};
    struct sr_error error = {0};
    char *data;
    if (sr_file_read(test_reference_file(name), 1 << 24, &data, &seed.size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    seed.data = data;
    return seed;
}

static struct sr_image *try(const char *label, const uint8_t *data, size_t size, sr_status *status,
                            struct sr_error *error)
{
    // a copy of exactly this length, so that a sanitizer sees a read behind it
    uint8_t *copy = sr_alloc(size);
    memcpy(copy, data, size);
    struct sr_image *image;
    *error = (struct sr_error){0};
    *status = sr_image_decode(label, copy, size, SR_IMAGE_SRGB, &image, error);
    sr_free(copy);
    return image;
}

static void cut_and_damage(struct seed seed)
{
    sr_status status;
    struct sr_error error;
    struct sr_image *image = try(seed.label, seed.data, seed.size, &status, &error);
    if (!image)
        test_fail(__FILE__, __LINE__, "%s: %s", seed.label, error.text);
    sr_image_free(image);
    for (size_t i = 0; i < 100; i++) {
        size_t size = i < 50 ? i * seed.size / 50 : seed.size - 1 - (i - 50);
        image = try(seed.label, seed.data, size, &status, &error);
        if (image || status == SR_OK || !strstr(error.text, seed.label))
            test_fail(__FILE__, __LINE__, "%s: %zu of %zu bytes: status %d '%s'", seed.label, size, seed.size,
                      (int)status, error.text);
    }
    uint64_t state = 99;
    uint8_t *damaged = sr_alloc(seed.size);
    for (int i = 0; i < 400; i++) {
        memcpy(damaged, seed.data, seed.size);
        size_t reach = i % 2 && seed.size > 400 ? 400 : seed.size; // half of the damage goes to the header
        for (int k = 0; k < 1 + i % 4; k++)
            damaged[next_random(&state) % reach] = (uint8_t)(i % 3 ? next_random(&state) >> 24 : 0xff);
        image = try(seed.label, damaged, seed.size, &status, &error);
        if ((status == SR_OK) != (image != NULL) || (status != SR_OK && !error.text[0]))
            test_fail(__FILE__, __LINE__, "%s: status %d without a reason", seed.label, (int)status);
        sr_image_free(image);
    }
    sr_free(damaged);
    sr_free(seed.data);
}

TEST(damaged_exr_does_no_harm)
{
    cut_and_damage(encode_seed(".exr", false));
}
TEST(damaged_pfm_does_no_harm)
{
    cut_and_damage(encode_seed(".pfm", false));
}
TEST(damaged_hdr_does_no_harm)
{
    cut_and_damage(encode_seed(".hdr", false));
}
TEST(damaged_png_does_no_harm)
{
    cut_and_damage(encode_seed(".png", true));
}
TEST(damaged_tga_does_no_harm)
{
    cut_and_damage(tga_seed());
}
TEST(damaged_jpeg_does_no_harm)
{
    cut_and_damage(file_seed("gltf/EmissiveStrengthTest/screenshot-x150.jpg"));
}
TEST(damaged_real_exr_does_no_harm)
{
    cut_and_damage(file_seed("spectra/colour_science_io/Ohta1997.exr"));
}

static void expect_refused(const char *label, const void *data, size_t size)
{
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_image_decode(label, data, size, SR_IMAGE_SRGB, &image, &error), SR_ERROR_INPUT);
    EXPECT(image == NULL && strstr(error.text, label));
}

TEST(headers_that_promise_too_much_are_refused)
{
    static const char pfm[] = "PF\n100000 100000\n-1\n\0\0\0\0", none[] = "PF\n0 5\n-1\n",
                      negative[] = "PF\n-3 5\n-1\n    ";
    static const char huge[] = "PF\n99999999999999999999 1\n-1\n    ", scale[] = "Pf\n1 1\n0\n    ",
                      nan_scale[] = "Pf\n1 1\nnan\n    ";
    static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000000000 +X 4000000000\n";
    static const char column[] = "#?RADIANCE\n\n+X 10 -Y 10\n";
    static const uint8_t tga[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255, 24, 0};
    expect_refused("a.pfm", pfm, sizeof pfm);
    expect_refused("b.pfm", none, sizeof none);
    expect_refused("c.pfm", negative, sizeof negative);
    expect_refused("d.pfm", huge, sizeof huge);
    expect_refused("e.pfm", scale, sizeof scale);
    expect_refused("f.pfm", nan_scale, sizeof nan_scale);
    expect_refused("g.hdr", hdr, sizeof hdr - 1);
    expect_refused("h.hdr", column, sizeof column - 1);
    expect_refused("i.tga", tga, sizeof tga);
    expect_refused("j.exr", "", 0);
    expect_refused("k.txt", "some text", 9);
}

TEST(what_is_no_file_is_told_by_name)
{
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_image_read("/absent/picture.exr", &image, &error), SR_ERROR_INPUT);
    EXPECT(image == NULL && strstr(error.text, "/absent/picture.exr"));
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_read(test_folder(), &image, &error), SR_ERROR_INPUT);
    EXPECT(image == NULL && strstr(error.text, "folder"));
}
