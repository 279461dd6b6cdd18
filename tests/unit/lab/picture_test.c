/* SPDX-License-Identifier: MIT */
/* The numbers behind pictures: means of random f, albedos, mirror lobes, colour, and the light on a ball. */
#include "lab/lab.h"
#include "test.h"

static struct sr_arena arena;

static struct sr_specimen read_specimen(const char *line)
{
    static char text[512];
    const char *words[32];
    int count = 0;
    snprintf(text, sizeof text, "%s", line);
    for (char *word = strtok(text, " "); word && count < 32; word = strtok(NULL, " "))
        words[count++] = word;
    struct sr_specimen specimen;
    struct sr_error error = {0};
    if (sr_specimen_read(&arena, count, words, &specimen, (struct sr_log){0}, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return specimen;
}

static sr_vec3 at_angle(float deg)
{
    return (sr_vec3){-sinf(sr_radians(deg)), 0, cosf(sr_radians(deg))};
}

TEST(f_of_pictures_is_the_model_s)
{
    struct sr_specimen s = read_specimen("diffuse reflectance=.5 + .5*diffuse reflectance=.25");
    sr_vec3 wo[2] = {{0, 0, 1}, at_angle(60)}, wi[2] = {at_angle(30), {0, 0, -1}};
    sr_spectrum f[2];
    sr_specimen_f(&s, SR_BLACK + 550, wo, wi, 2, 16, f);
    EXPECT_NEAR(f[0][0], 0.625 / M_PI, 1e-6);
    EXPECT_NEAR(f[1][0], 0, 0);
}

TEST(albedo_of_a_diffuser_is_its_reflectance)
{
    struct sr_specimen s = read_specimen("diffuse_transmission reflectance=.3 transmittance=.6");
    struct sr_specimen_albedo a = sr_specimen_albedo(&s, SR_BLACK + 550, at_angle(50), 4096);
    EXPECT_NEAR(a.reflected[0], 0.3, 2e-3);
    EXPECT_NEAR(a.transmitted[0], 0.6, 2e-3);
}

/* Fresnel's equations at 45 deg, n = 1.5: 0.0502397; the rest passes, as flux whatever the medium. */
TEST(delta_lobes_of_glass_are_mirror_and_refraction)
{
    struct sr_specimen s = read_specimen("dielectric eta=1.5");
    struct sr_delta d[SR_DELTAS];
    EXPECT_EQUAL_INT(sr_specimen_deltas(&s, SR_BLACK + 550, at_angle(45), d), 2);
    int up = d[0].direction.z > 0 ? 0 : 1;
    EXPECT_NEAR(d[up].direction.x, sqrt(0.5), 1e-5);
    EXPECT_NEAR(d[up].albedo[0], 0.0502397, 3e-3); // 256 draws choose between the two
    EXPECT_NEAR(d[1 - up].albedo[0], 0.9497603, 3e-3);
    EXPECT_NEAR(d[1 - up].direction.x, sqrt(0.5) / 1.5, 1e-5);
    struct sr_specimen_albedo a = sr_specimen_albedo(&s, SR_BLACK + 550, at_angle(45), 16384);
    EXPECT_NEAR(a.reflected[0], 0.0502397, 1e-3);
    struct sr_specimen matte = read_specimen("diffuse");
    EXPECT_EQUAL_INT(sr_specimen_deltas(&matte, SR_BLACK + 550, at_angle(45), d), 0);
}

TEST(colour_of_ones_is_white)
{
    double xyz[3] = {0};
    for (int set = 0; set < SR_COLOUR_SETS; ++set)
        sr_colour_add(set, SR_ONE, xyz);
    struct sr_rgb rgb =
        sr_rgb_from_xyz(sr_colour_space(SR_SRGB), (struct sr_xyz){(float)xyz[0], (float)xyz[1], (float)xyz[2]});
    EXPECT_NEAR(xyz[1], 1, 1e-9);
    EXPECT_NEAR(rgb.r, 1, 1e-4);
    EXPECT_NEAR(rgb.g, 1, 1e-4);
    EXPECT_NEAR(rgb.b, 1, 1e-4);
}

/* Against the sum of 471 wavelengths. */
TEST(colour_of_gold_is_that_of_its_spectrum)
{
    struct sr_spd d65 = sr_spd_named("stdillum-D65"), eta = sr_spd_named("metal-Au-eta"),
                  k = sr_spd_named("metal-Au-k");
    double coarse[3] = {0}, fine[3] = {0}, white = 0;
    for (int set = 0; set < SR_COLOUR_SETS; ++set) {
        sr_spectrum lambda = sr_colour_lambda(set);
        sr_colour_add(set, sr_fresnel_conductor(1, sr_spd_eval(&eta, lambda), sr_spd_eval(&k, lambda)), coarse);
    }
    for (int nm = 360; nm <= 830; ++nm) {
        double bar[3];
        sr_observer_1931(nm, bar);
        double e = (double)sr_spd_at(&d65, (float)nm);
        sr_spectrum at = SR_BLACK + (float)nm;
        double reflectance = (double)sr_fresnel_conductor(1, sr_spd_eval(&eta, at), sr_spd_eval(&k, at))[0];
        white += e * bar[1];
        for (int c = 0; c < 3; ++c)
            fine[c] += e * bar[c] * reflectance;
    }
    for (int c = 0; c < 3; ++c)
        EXPECT_RELATIVE(coarse[c], fine[c] / white, 4e-3);
}

/* Where the ball faces the sun, a white diffuser has L = 1.2 of the sky's unit; tone and encoding of that by hand. */
TEST(a_ball_is_as_bright_as_lambert_says)
{
    enum { SIZE = 64 };
    static uint8_t srgb[SIZE * SIZE * 3];
    struct sr_specimen s = read_specimen("diffuse reflectance=.5");
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_specimen_ball(&s, SR_BALL_POINT, SIZE, 256, srgb, &error), SR_OK);
    double sun[3] = {-0.55, 0.62, 0.56}, length = sqrt(0.55 * 0.55 + 0.62 * 0.62 + 0.56 * 0.56);
    int x = (int)((sun[0] / length / 2.06 + 0.5) * SIZE), y = (int)((0.5 - sun[1] / length / 2.06) * SIZE);
    double Y = 2.2 * 0.5 * 1.2, mapped = Y * (1 + Y / 16) / (1 + Y);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(srgb[3 * (y * SIZE + x) + c], 255 * (double)sr_srgb_encode((float)mapped), 4);
    EXPECT_EQUAL_INT(srgb[0], 255);                                        // the corner is paper
    EXPECT_EQUAL_INT(srgb[3 * ((SIZE * 7 / 8) * SIZE + SIZE * 5 / 8)], 0); // the far side of the sun is dark
}

/* Light goes through clear glass, and nothing is lost but what Fresnel turns back: the middle shows the ground behind.
 */
TEST(a_ball_of_glass_shows_the_sky_behind_it)
{
    enum { SIZE = 33 };
    static uint8_t glass[SIZE * SIZE * 3], black[SIZE * SIZE * 3];
    struct sr_error error = {0};
    struct sr_specimen s = read_specimen("dielectric eta=1.5"), dark = read_specimen("diffuse reflectance=0");
    EXPECT_EQUAL_INT(sr_specimen_ball(&s, SR_BALL_SKY, SIZE, 32, glass, &error), SR_OK);
    EXPECT_EQUAL_INT(sr_specimen_ball(&dark, SR_BALL_SKY, SIZE, 32, black, &error), SR_OK);
    int above = 3 * ((SIZE / 3) * SIZE + SIZE / 2), below = 3 * ((2 * SIZE / 3) * SIZE + SIZE / 2);
    EXPECT(glass[below] > glass[above] + 30); // a ball is a lens: upside down
    EXPECT_EQUAL_INT(black[above], 0);
}

TEST(an_absurd_ball_is_an_error)
{
    struct sr_specimen s = read_specimen("diffuse");
    struct sr_error error = {0};
    uint8_t none[3];
    EXPECT_EQUAL_INT(sr_specimen_ball(&s, SR_BALL_SKY, 100000, 1, none, &error), SR_ERROR_INPUT);
}
