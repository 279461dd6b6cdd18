/* SPDX-License-Identifier: MIT */
/* Spectra for RGB come back as that RGB: integrated under the space's illuminant by 1 nm sums. */
#include "sample/sample.h"
#include "spectrum/spectrum.h"
#include "test.h"

static void come_back(enum sr_colour_space_id id, const struct sr_spd *s, float out[3])
{
    const struct sr_colour_space *space = sr_colour_space(id);
    struct sr_spd light = {.kind = SR_SPD_TABLE, .scale = 1, .table = space->illuminant};
    double xyz[3] = {0};
    for (int l = 360; l <= 830; ++l) {
        double bar[3], value = (double)sr_spd_at(s, (float)l);
        if (s->kind != SR_SPD_ILLUMINANT)
            value *= (double)sr_spd_at(&light, (float)l);
        sr_observer_1931(l, bar);
        for (int k = 0; k < 3; ++k)
            xyz[k] += bar[k] * value / space->illuminant_luminous_integral;
    }
    struct sr_rgb rgb = sr_rgb_from_xyz(space, (struct sr_xyz){(float)xyz[0], (float)xyz[1], (float)xyz[2]});
    out[0] = rgb.r;
    out[1] = rgb.g;
    out[2] = rgb.b;
}

static void random_rgb(uint32_t i, float v[3])
{
    for (uint32_t k = 0; k < 3; ++k)
        v[k] = sr_u32_to_float(sr_hash_combine(i, 100 + k));
}

/* Which colours can a reflectance have? Those of the convex solid of optimal colours: in every direction n of XYZ
 *     n . T <= INTEGRAL max(0, n . w) dlambda,   w(lambda) = illuminant * observer / Y of the white
 * (Schroedinger 1920). `reach` says how far from the solid's centre, half the white, T lies: 1 is the surface. */
enum { DIRECTIONS = 2000 };
struct solid {
    double n[DIRECTIONS][3], support[DIRECTIONS], centre[3];
};

static void solid_of(const struct sr_colour_space *space, struct solid *solid)
{
    struct sr_spd light = {.kind = SR_SPD_TABLE, .scale = 1, .table = space->illuminant};
    memset(solid, 0, sizeof(*solid));
    for (int d = 0; d < DIRECTIONS; ++d) {
        double z = 1 - (2 * d + 1.0) / DIRECTIONS, phi = d * 2.399963229728653, r = sqrt(1 - z * z);
        solid->n[d][0] = r * cos(phi);
        solid->n[d][1] = r * sin(phi);
        solid->n[d][2] = z;
    }
    for (int l = 360; l <= 830; ++l) {
        double bar[3], power = (double)sr_spd_at(&light, (float)l) / space->illuminant_luminous_integral;
        sr_observer_1931(l, bar);
        for (int k = 0; k < 3; ++k)
            solid->centre[k] += bar[k] * power / 2;
        for (int d = 0; d < DIRECTIONS; ++d)
            solid->support[d] +=
                power * fmax(0, bar[0] * solid->n[d][0] + bar[1] * solid->n[d][1] + bar[2] * solid->n[d][2]);
    }
}

static double reach(const struct solid *solid, struct sr_xyz T)
{
    double far = 0;
    for (int d = 0; d < DIRECTIONS; ++d) {
        const double *n = solid->n[d], *c = solid->centre;
        double centre = n[0] * c[0] + n[1] * c[1] + n[2] * c[2];
        double at = n[0] * (double)T.x + n[1] * (double)T.y + n[2] * (double)T.z;
        far = fmax(far, (at - centre) / (solid->support[d] - centre));
    }
    return far;
}

static void round_trip(enum sr_colour_space_id id, double reachable)
{
    static struct solid solid;
    solid_of(sr_colour_space(id), &solid);
    double sum = 0, worst = 0;
    int count = 0;
    for (uint32_t i = 0; i < 4000; ++i) {
        float v[3], out[3];
        random_rgb(i, v);
        struct sr_rgb rgb = {v[0], v[1], v[2]};
        if (reach(&solid, sr_xyz_from_rgb(sr_colour_space(id), rgb)) > reachable)
            continue;
        struct sr_spd s = sr_spd_from_rgb_albedo(id, rgb);
        come_back(id, &s, out);
        for (int k = 0; k < 3; ++k) {
            double error = fabs((double)(out[k] - v[k]));
            sum += error;
            worst = fmax(worst, error);
            ++count;
        }
    }
    printf("%-10s round trip: mean %.2g, worst %.2g of %d\n", sr_colour_space(id)->name, sum / count, worst, count / 3);
    EXPECT(count > 1000);
    EXPECT_NEAR(sum / count, 0, 0.002);
    EXPECT_NEAR(worst, 0, 0.01);
}

TEST(albedos_come_back_where_a_reflectance_can_have_that_colour)
{
    // optimal colours have spectra of vertical edges, the sigmoid's are slanted: the outermost shell is out of its
    // reach
    round_trip(SR_SRGB, 1);
    round_trip(SR_DCI_P3, 0.9);
    round_trip(SR_REC2020, 0.9);
    round_trip(SR_ACES2065_1, 0.9);
}

TEST(unbounded_and_illuminant_come_back_at_any_scale)
{
    for (int id = 0; id < SR_COLOUR_SPACE_COUNT; ++id) {
        for (uint32_t i = 0; i < 300; ++i) {
            float v[3], out[3], scale = expf(20 * (float)i / 300 - 10);
            random_rgb(i, v);
            float low = 0.35f; // well inside every gamut
            struct sr_rgb rgb = {scale * (low + v[0]), scale * (low + v[1]), scale * (low + v[2])};
            struct sr_spd unbounded = sr_spd_from_rgb_unbounded((enum sr_colour_space_id)id, rgb);
            struct sr_spd illuminant = sr_spd_from_rgb_illuminant((enum sr_colour_space_id)id, rgb);
            come_back((enum sr_colour_space_id)id, &unbounded, out);
            EXPECT_NEAR(out[0], rgb.r, 0.01f * scale);
            EXPECT_NEAR(out[1], rgb.g, 0.01f * scale);
            EXPECT_NEAR(out[2], rgb.b, 0.01f * scale);
            come_back((enum sr_colour_space_id)id, &illuminant, out);
            EXPECT_NEAR(out[0], rgb.r, 0.01f * scale);
            EXPECT_NEAR(out[1], rgb.g, 0.01f * scale);
            EXPECT_NEAR(out[2], rgb.b, 0.01f * scale);
        }
    }
}

TEST(greys_are_flat)
{
    for (int i = 0; i <= 20; ++i) {
        float v = (float)i / 20;
        struct sr_spd s = sr_spd_from_rgb_albedo(SR_ACES2065_1, (struct sr_rgb){v, v, v});
        for (float lambda = 360; lambda <= 830; lambda += 47)
            EXPECT_NEAR(sr_spd_at(&s, lambda), v, i == 0 || i == 20 ? 0 : 1e-6);
    }
    struct sr_spd black = sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){0, 0, 0});
    EXPECT_NEAR(sr_spd_at(&black, 500), 0, 0);
    struct sr_spd dark = sr_spd_from_rgb_illuminant(SR_SRGB, (struct sr_rgb){0, 0, 0});
    EXPECT_NEAR(sr_spd_at(&dark, 500), 0, 0);
    struct sr_spd bright = sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){7, 7, 7});
    EXPECT_RELATIVE(sr_spd_at(&bright, 500), 7, 1e-6);
}

/* A white illuminant is the space's own illuminant. */
TEST(white_light_is_the_illuminant)
{
    for (int id = 0; id < SR_COLOUR_SPACE_COUNT; ++id) {
        const struct sr_colour_space *space = sr_colour_space((enum sr_colour_space_id)id);
        struct sr_spd s = sr_spd_from_rgb_illuminant((enum sr_colour_space_id)id, (struct sr_rgb){1, 1, 1});
        EXPECT_RELATIVE(sr_spd_luminous_integral(&s), space->illuminant_luminous_integral, 1e-6);
    }
}

TEST(every_rgb_has_a_finite_spectrum)
{
    for (int id = 0; id < SR_COLOUR_SPACE_COUNT; ++id) {
        for (int i = 0; i < 9 * 9 * 9; ++i) {
            static const float levels[] = {0, 1e-30f, 1e-6f, 1e-3f, 0.1f, 0.5f, 0.999f, SR_ONE_MINUS_EPSILON, 1};
            struct sr_rgb rgb = {levels[i % 9], levels[i / 9 % 9], levels[i / 81]};
            struct sr_sigmoid c = sr_rgb_to_sigmoid((enum sr_colour_space_id)id, rgb);
            for (float lambda = 360; lambda <= 830; lambda += 47) {
                float s = sr_sigmoid_eval(c, SR_BLACK + lambda)[0];
                EXPECT(s >= 0 && s <= 1); // false for NaN
            }
        }
    }
}
