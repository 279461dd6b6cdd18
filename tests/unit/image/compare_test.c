/* SPDX-License-Identifier: MIT */
/* Comparison against sums done by hand, and z against the normal distribution. */
#include "make.h"

TEST(differences_are_those_computed_by_hand)
{
    static const char *const names_a[] = {"R", "G"}, *const names_b[] = {"G", "R"};
    struct sr_image *a = make_image(2, 2, 2, names_a), *b = make_image(2, 2, 2, names_b);
    struct sr_image_comparison c;
    struct sr_error error = {0};
    float ra[4] = {1, 2, 3, 6}, rb[4] = {1, 1, 5, 1};
    for (int i = 0; i < 4; i++) {
        a->floats[2 * i] = ra[i];
        b->floats[2 * i + 1] = rb[i];
    }
    EXPECT(sr_image_compare(a, b, &c, &error) == SR_OK);
    EXPECT_EQUAL_INT(c.channel_count, 2);
    struct sr_image_difference *r = &c.channels[0];
    EXPECT_EQUAL_TEXT(r->name, "R");
    EXPECT_EQUAL_INT(r->count, 4);
    EXPECT_NEAR(r->mean_a, 3, 0);
    EXPECT_NEAR(r->mean_b, 2, 0);
    EXPECT_NEAR(r->mean_ratio, 1.5, 1e-15);
    EXPECT_NEAR(r->bias, 1, 0);
    EXPECT_NEAR(r->rmse, sqrt((0 + 1 + 4 + 25) / 4.0), 1e-12);
    // epsilon = 0.01 * 2^2
    EXPECT_NEAR(r->rel_mse, (1 / 1.04 + 4 / 25.04 + 25 / 1.04) / 4, 1e-12);
    EXPECT_NEAR(r->max_difference, 5, 0);
    EXPECT(r->max_x == 1 && r->max_y == 1 && !r->has_z);
    // two black channels do not differ
    EXPECT_NEAR(c.channels[1].rel_mse, 0, 0);
    EXPECT_NEAR(c.channels[1].mean_ratio, 1, 0);
    EXPECT_NEAR(c.rmse, sqrt(7.5 / 2), 1e-12);
    sr_image_comparison_free(&c);
    a->floats[0] = NAN;
    b->floats[3] = INFINITY;
    EXPECT(sr_image_compare(a, b, &c, &error) == SR_OK);
    EXPECT_EQUAL_INT(c.channels[0].count, 2);
    EXPECT_EQUAL_INT(c.channels[0].skipped_count, 2);
    EXPECT_NEAR(c.channels[0].rmse, sqrt((4 + 25) / 2.0), 1e-12);
    sr_image_comparison_free(&c);
    sr_image_free(a);
    sr_image_free(b);
}

TEST(z_of_two_pixels_by_hand)
{
    static const char *const names_a[] = {"Y", "SE.Y"}, *const names_b[] = {"Y", "stderr.Y"};
    struct sr_image *a = make_image(2, 1, 2, names_a), *b = make_image(2, 1, 2, names_b);
    float va[4] = {10, 3, 7, 0.3f}, vb[4] = {5, 4, 5, 0.4f};
    memcpy(a->floats, va, sizeof va);
    memcpy(b->floats, vb, sizeof vb);
    struct sr_image_comparison c;
    struct sr_error error = {0};
    EXPECT(sr_image_compare(a, b, &c, &error) == SR_OK);
    EXPECT_EQUAL_INT(c.channel_count, 1);
    // errors 5 and 0.5: z = 1 and 4; the mean's z = 7 / sqrt(25.25)
    EXPECT(c.channels[0].has_z);
    EXPECT_NEAR(c.channels[0].max_z, 4, 1e-6);
    EXPECT_NEAR(c.channels[0].mean_z, 7 / sqrt(25.25), 1e-6);
    EXPECT_NEAR(c.channels[0].share_above_3, 0.5, 0);
    EXPECT_NEAR(c.channels[0].chi2_per_pixel, 8.5, 1e-5);
    sr_image_comparison_free(&c);
    sr_image_free(a);
    sr_image_free(b);
}

/* Two noisy estimates of one picture; errors of a per-pixel size that spans three decades. `told` scales what a
 * says. */
static struct sr_image_difference compare_noise(uint64_t seed, double told, double bias, bool only_a)
{
    enum { SIDE = 300 };
    static const char *const names[] = {"Y", "SE.Y"};
    struct sr_image *a = make_image(SIDE, SIDE, 2, names), *b = make_image(SIDE, SIDE, only_a ? 1 : 2, names);
    uint64_t state = seed;
    for (size_t p = 0; p < SIDE * SIDE; p++) {
        double truth = next_uniform(&state), se_a = 0.1 * pow(10, -3 * next_uniform(&state)),
               se_b = 0.05 * next_uniform(&state) + 1e-3;
        a->floats[2 * p] = (float)(truth + bias + se_a * next_gaussian(&state));
        a->floats[2 * p + 1] = (float)(told * se_a);
        if (only_a) {
            b->floats[p] = (float)truth;
        } else {
            b->floats[2 * p] = (float)(truth + se_b * next_gaussian(&state));
            b->floats[2 * p + 1] = (float)(told * se_b);
        }
    }
    struct sr_image_comparison c;
    struct sr_error error = {0};
    EXPECT(sr_image_compare(a, b, &c, &error) == SR_OK);
    struct sr_image_difference r = c.channels[0];
    sr_image_comparison_free(&c);
    sr_image_free(a);
    sr_image_free(b);
    return r;
}

static void expect_rate(double share, double p, double n)
{
    EXPECT_NEAR(share, p, 4.9 * sqrt(p * (1 - p) / n));
}

/* A picture of one sample a pixel does not know its errors: they are not 0. */
TEST(errors_that_are_not_known_tell_nothing_of_noise)
{
    static const char *const names[] = {"Y", "SE.Y"};
    struct sr_image *a = make_image(2, 1, 2, names), *b = make_image(2, 1, 2, names);
    float va[4] = {10, NAN, 7, 0.3f}, vb[4] = {5, 0.1f, 5, 0.4f};
    memcpy(a->floats, va, sizeof va);
    memcpy(b->floats, vb, sizeof vb);
    struct sr_image_comparison c;
    struct sr_error error = {0};
    EXPECT(sr_image_compare(a, b, &c, &error) == SR_OK);
    EXPECT(c.channels[0].count == 2 && c.channels[0].z_count == 1);
    EXPECT_NEAR(c.channels[0].max_z, 4, 1e-6);
    EXPECT_NEAR(c.channels[0].mean_z, 4, 1e-6);
    sr_image_comparison_free(&c);
    a->floats[3] = INFINITY;
    EXPECT(sr_image_compare(a, b, &c, &error) == SR_OK);
    EXPECT(!c.channels[0].has_z);
    sr_image_comparison_free(&c);
    sr_image_free(a);
    sr_image_free(b);
}

TEST(pictures_without_a_finite_pixel_have_no_mean)
{
    static const char *const names[] = {"Y"};
    struct sr_image *a = make_image(1, 1, 1, names);
    a->floats[0] = NAN;
    struct sr_image_comparison c;
    struct sr_image_statistics s;
    struct sr_error error = {0};
    EXPECT(sr_image_compare(a, a, &c, &error) == SR_OK);
    EXPECT(c.channels[0].count == 0 && isnan(c.channels[0].mean_a) && isnan(c.channels[0].rmse));
    EXPECT(isnan(c.channels[0].max_difference));
    sr_image_comparison_free(&c);
    EXPECT(sr_image_statistics(a, 0, &s, &error) == SR_OK);
    EXPECT(s.count == 0 && s.nan_count == 1 && isnan(s.mean) && isnan(s.min) && isnan(s.max) && isnan(s.percentile_50));
    sr_image_free(a);
}

TEST(z_of_gaussian_noise_is_standard_normal)
{
    struct sr_tally mean_z = {0};
    for (uint64_t seed = 1; seed <= 100; seed++) {
        struct sr_image_difference r = compare_noise(seed * 977, 1, 0, seed % 2);
        double n = (double)r.z_count;
        sr_tally_add(&mean_z, r.mean_z);
        EXPECT(r.has_z && r.z_count == 90000);
        expect_rate(r.share_above_2, sr_normal_p_two_sided(2), n);
        expect_rate(r.share_above_3, sr_normal_p_two_sided(3), n);
        expect_rate(r.share_above_4, sr_normal_p_two_sided(4), n);
        EXPECT_NEAR(r.chi2_per_pixel, 1, 4.9 * sqrt(2 / n));
        EXPECT(r.max_z > 3 && r.max_z < 7);
    }
    // 100 draws of a standard normal: mean 0 +- 0.1, variance 1 +- 0.14
    EXPECT_MEAN(mean_z, 0);
    EXPECT_NEAR(sr_tally_variance(&mean_z), 1, 4.9 * sqrt(2.0 / 99));
}

TEST(z_finds_a_bias_and_errors_told_too_small)
{
    struct sr_image_difference biased = compare_noise(5, 1, 0.003, false), modest = compare_noise(6, 0.5, 0, false);
    // error of the mean: root mean square of the two, about 0.049 / 300
    EXPECT(biased.mean_z > 10);
    EXPECT_NEAR(modest.chi2_per_pixel, 4, 0.15);
    expect_rate(modest.share_above_2, sr_normal_p_two_sided(1), (double)modest.z_count);
}

TEST(images_that_do_not_match_are_refused)
{
    static const char *const depth[] = {"Z"};
    struct sr_image *a = make_image(2, 2, 3, NULL), *b = make_image(2, 3, 3, NULL), *c = make_image(2, 2, 1, depth),
                    *picture;
    struct sr_image_comparison r;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_image_compare(a, b, &r, &error), SR_ERROR_INPUT);
    EXPECT(r.channels == NULL);
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_compare(a, c, &r, &error), SR_ERROR_INPUT);
    EXPECT(r.channels == NULL && strstr(error.text, "'Z'"));
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_difference_picture(a, b, 0, &picture, NULL, &error), SR_ERROR_INPUT);
    EXPECT(picture == NULL);
    sr_image_free(a);
    sr_image_free(b);
    sr_image_free(c);
}

TEST(bytes_are_compared_linear)
{
    struct sr_image *a = make_bytes(1, 1, 1), *b = make_image(1, 1, 1, NULL);
    struct sr_image_comparison c;
    struct sr_error error = {0};
    a->bytes[0] = 128;
    b->floats[0] = 0.2f;
    EXPECT(sr_image_compare(a, b, &c, &error) == SR_OK);
    EXPECT_NEAR(c.channels[0].rmse, 0.21586050 - 0.2, 1e-6);
    sr_image_comparison_free(&c);
    sr_image_free(a);
    sr_image_free(b);
}

TEST(the_difference_picture_is_red_for_more_and_blue_for_less)
{
    struct sr_image *a = make_image(4, 1, 1, NULL), *b = make_image(4, 1, 1, NULL), *picture;
    float va[4] = {1, 3, -1, NAN};
    for (int i = 0; i < 4; i++) {
        a->floats[i] = va[i];
        b->floats[i] = 1;
    }
    struct sr_error error = {0};
    double scale;
    EXPECT(sr_image_difference_picture(a, b, 2, &picture, &scale, &error) == SR_OK);
    EXPECT_NEAR(scale, 2, 0);
    EXPECT(memcmp(picture->bytes, "\xff\xff\xff\xff\0\0\0\0\xff\0\xff\0", 12) == 0);
    sr_image_free(picture);
    EXPECT(sr_image_difference_picture(a, b, 0, &picture, &scale, &error) == SR_OK);
    EXPECT_NEAR(scale, 2, 0);
    sr_image_free(picture);
    EXPECT(sr_image_difference_picture(b, b, 0, &picture, &scale, &error) == SR_OK);
    EXPECT_NEAR(scale, 1, 0);
    EXPECT(picture->bytes[0] == 255 && picture->bytes[1] == 255 && picture->bytes[2] == 255);
    sr_image_free(picture);
    sr_image_free(a);
    sr_image_free(b);
}
