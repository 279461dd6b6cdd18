/* SPDX-License-Identifier: MIT */
/* Segments to lamps, asked again beside where they may have slipped out of a closed mesh: they are free if double
 * precision says so, and never meet the lamp that they aim at. The receivers are within the box of a closed mesh, the
 * lamps are not. */
#include "agree/render_helper.h"

/* Two closed cells far away, one mesh, whose box is -0.1 to 0.4 along z and holds the floor. */
#define CELLS                                                                                                          \
    "Shape \"trianglemesh\" \"integer indices\" [0 2 1 0 1 3 1 2 3 2 0 3  4 6 5 4 5 7 5 6 7 6 4 7] "                   \
    "\"point3 P\" [-9 -9 -0.1  -8 -9 -0.1  -9 -8 -0.1  -9 -9 0  9 9 0.4  8 9 0.4  9 8 0.4  9 9 0.3]\n"
/* A wall, and a cell that stretches its box over the floor: -1 ... 0.5 along x, -4 ... 4 along y. */
#define WALL                                                                                                           \
    "Shape \"trianglemesh\" \"integer indices\" [0 2 1 1 2 3 4 5 6 5 7 6 0 1 4 1 5 4 2 6 3 3 6 7 0 4 2 2 4 6 1 3 5 3 " \
    "7 5  8 10 9 8 9 11 9 10 11 10 8 11] "                                                                             \
    "\"point3 P\" [0.3 -4 -0.1  0.5 -4 -0.1  0.3 4 -0.1  0.5 4 -0.1  0.3 -4 0.5  0.5 -4 0.5  0.3 4 0.5  0.5 4 0.5  "   \
    "-1 0 -0.1  -0.99 0 -0.1  -1 0.01 -0.1  -1 0 -0.09]\n"
#define FLOOR "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-5 -5 0  5 -5 0  5 5 0  -5 5 0]\n"
#define SHINES "AreaLightSource \"diffuse\" \"float scale\" 1\n"

static void make(const char *world, struct sr_import_result *scene)
{
    char text[4096];
    snprintf(text, sizeof text,
             "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nWorldBegin\nMaterial \"diffuse\" "
             "\"float reflectance\" 0\n%s",
             world);
    struct sr_error error = {0};
    if (!import_scene(scene_file("lamps.pbrt", text), NULL, scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

/* The floor below (x, y). */
static struct sr_point floor_at(const struct sr_scene *scene, float x, float y)
{
    struct sr_ray down = {.o = {x, y, 1e-3f}, .d = {0, 0, -1}, .t_max = INFINITY};
    struct sr_hit hit;
    EXPECT(sr_raycast(scene, &down, &hit));
    return hit.point;
}

struct seen {
    uint64_t rays, hidden;
    double least; // the cosine at the lamp of the steepest ray that is hidden
};

/* Rays to every lamp from places of the floor within the box; those that graze the lamp by less than `grazing` are left
 * out. */
static struct seen look(const struct sr_scene *scene, double span, double grazing, uint32_t rays)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    struct sr_rng rng = sr_rng_seed(3, 7);
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, 0.5f);
    struct seen seen = {0};
    for (uint32_t i = 0; i < rays; ++i) {
        float a = sr_rng_float(&rng), b = sr_rng_float(&rng), c = sr_rng_float(&rng), d = sr_rng_float(&rng);
        struct sr_point x = floor_at(scene, (float)span * (2 * a - 1), (float)span * (2 * b - 1));
        struct sr_light_sample s;
        if (!sr_light_draw(lights->lights[i % lights->count], &x, (sr_vec2){c, d}, &w, &s) || s.wi.z < 1e-3f)
            continue;
        double cosine = -(double)sr_dot(s.wi, s.n);
        if (cosine < grazing)
            continue;
        ++seen.rays;
        if (!sr_visible(scene, &x, &s)) {
            ++seen.hidden;
            seen.least = fmax(seen.least, cosine);
        }
    }
    return seen;
}

TEST(no_segment_meets_the_lamp_that_it_aims_at)
{
    static const char patch[] =
        "Shape \"bilinearmesh\" \"point3 P\" [-0.5 -0.5 0  -0.5 0.5 0  0.5 -0.5 0  0.5 0.5 0]\n";
    static const char triangles[] = "Shape \"trianglemesh\" \"integer indices\" [0 2 1 0 3 2] \"point3 P\" [-0.5 -0.5 "
                                    "0  0.5 -0.5 0  0.5 0.5 0  -0.5 0.5 0]\n";
    static const char ball[] = "Shape \"sphere\" \"float radius\" 0.5\n";
    static const char tube[] = "Shape \"cylinder\" \"float radius\" 0.2 \"float zmin\" -0.5 \"float zmax\" 0.5\n";
    static const char *const lamps[] = {patch, triangles, ball, tube,
                                        "ReverseOrientation Shape \"disk\" \"float radius\" 0.5\n"};
    static const double tilts[] = {0, 30, 60, 90}; // [deg] 0: a low ceiling; 90: a wall
    for (int lamp = 0; lamp < 5; ++lamp)
        for (int way = 0; way < 32; ++way) {
            char text[2048];
            double tilt = tilts[way / 8];
            snprintf(text, sizeof text,
                     FLOOR CELLS SHINES "Translate 0 0 %g\nRotate %d 0 0 1\nTranslate 2.2 0 0\nRotate %g 0 1 0\n%s",
                     tilt > 0 ? 1.3 : 0.55, 45 * (way % 8), tilt, lamps[lamp]);
            struct sr_import_result scene;
            make(text, &scene);
            struct seen seen = look(scene.scene, 0.9, 2e-3, is_slow_build() ? 200 : 2000);
            sr_import_result_free(&scene);
            EXPECT(seen.rays > 50);
            if (seen.hidden)
                test_fail(__FILE__, __LINE__,
                          "lamp %d, way %d: of %llu segments %llu are not free; the largest cosine there is %g", lamp,
                          way, (unsigned long long)seen.rays, (unsigned long long)seen.hidden, seen.least);
        }
}

/* The lamp is at the end of a tube 0.3 mm wide, 0.5 mrad beside which there are only walls. */
TEST(a_lamp_at_the_end_of_a_narrow_tube_is_seen)
{
    struct sr_import_result scene;
    make(FLOOR CELLS "AttributeBegin\n" SHINES
                     "Shape \"bilinearmesh\" \"point3 P\" [-1e-5 -1e-5 1  -1e-5 1e-5 1  1e-5 -1e-5 1  1e-5 1e-5 1]\n"
                     "AttributeEnd\nShape \"trianglemesh\" \"integer indices\" [0 1 4 1 5 4  1 2 5 2 6 5  2 3 6 3 7 6  "
                     "3 0 7 0 4 7] \"point3 P\" "
                     "[-1.5e-4 -1.5e-4 0.5  1.5e-4 -1.5e-4 0.5  1.5e-4 1.5e-4 0.5  -1.5e-4 1.5e-4 0.5  -1.5e-4 -1.5e-4 "
                     "1  1.5e-4 -1.5e-4 1  1.5e-4 1.5e-4 1  -1.5e-4 1.5e-4 1]\n",
         &scene);
    struct seen seen = look(scene.scene, 1e-5, 0, 1000);
    sr_import_result_free(&scene);
    EXPECT_EQUAL_INT(seen.rays, 1000);
    EXPECT_EQUAL_INT(seen.hidden, 0);
}

/* Past the wall's upper edge at (0.3, y, 0.5) m: all that goes above it goes free, to places and to the sky, however it
 * is turned. The first attempts beside are up to 2^-16 [rad] away, so much is left undecided. */
TEST(no_silhouette_grows)
{
    struct sr_rng rng = sr_rng_seed(11, 1);
    uint64_t above = 0, wrong = 0, rays = is_slow_build() ? 50 : 1500;
    for (int turn = 0; turn < 96; ++turn) {
        sr_vec3 axis = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        char text[2048];
        snprintf(text, sizeof text, "Rotate %g %.9g %.9g %.9g\n" WALL, 3.75 * turn, (double)axis.x, (double)axis.y,
                 (double)axis.z);
        struct sr_import_result scene;
        make(text, &scene);
        struct sr_transform t = sr_transform_rotate(3.75f * (float)turn, axis);
        for (uint64_t i = 0; i < rays; ++i) {
            double x = -0.9 + (double)sr_rng_float(&rng), y = 2 * (double)sr_rng_float(&rng) - 1,
                   y_edge = 2 * (double)sr_rng_float(&rng) - 1;
            double over = (i & 1 ? 3e-4 : 1e-3) * (2 * (double)sr_rng_float(&rng) - 1); // [m] above the edge
            if (fabs(over) < 1e-4)
                continue;
            sr_vec3 o = {(float)x, (float)y, 0}, d = {(float)(0.3 - x), (float)(y_edge - y), (float)(0.5 + over)};
            struct sr_ray ray = {
                .o = sr_transform_point(&t, o), .d = sr_transform_vector(&t, d), .t_max = i & 1 ? INFINITY : 3};
            struct sr_hit hit;
            above += over > 0;
            wrong += sr_is_free(scene.scene, &ray) != (over > 0);
            ray.d = sr_normalize(ray.d);
            if (i & 1)
                wrong += sr_raycast(scene.scene, &ray, &hit) != (over < 0);
        }
        sr_import_result_free(&scene);
    }
    EXPECT(above > 24 * rays);
    EXPECT_EQUAL_INT(wrong, 0);
}

/* Projected solid angle of [0, x] x [0, y] at height h above the corner [sr]. */
static double corner(double x, double y, double h)
{
    double a = hypot(x, h), b = hypot(y, h);
    return 0.5 * (x / a * atan(y / a) + y / b * atan(x / b));
}

/* A lamp above the wall, which hides what is beyond the line through its edge: what is left is a rectangle. */
TEST(a_lamp_behind_a_wall_shines_as_by_its_closed_form)
{
    struct sr_import_result scene;
    make(FLOOR WALL SHINES "Shape \"bilinearmesh\" \"point3 P\" [-0.5 -0.5 1  -0.5 0.5 1  1.5 -0.5 1  1.5 0.5 1]\n",
         &scene);
    const struct sr_lights *lights = sr_scene_lights(scene.scene);
    EXPECT_EQUAL_INT(lights->count, 1);
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, 0.5f);
    struct sr_rng rng = sr_rng_seed(5, 5);
    for (int i = 0; i < 4; ++i) {
        double at = -0.4 + 0.2 * i, end = at + (0.3 - at) / 0.5;
        struct sr_point x = floor_at(scene.scene, (float)at, 0);
        struct sr_tally tally = {0};
        for (uint32_t k = 0; k < (is_slow_build() ? 4000u : 100000u); ++k) {
            struct sr_light_sample s;
            sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
            bool is_seen = sr_light_draw(lights->lights[0], &x, u, &w, &s) && sr_visible(scene.scene, &x, &s);
            sr_tally_add(&tally, is_seen ? (double)(s.wi.z / s.pdf) : 0);
        }
        double E = 2 * (corner(end - at, 0.5, 1) - corner(-0.5 - at, 0.5, 1)); // of 1 cd/m^2 [lx]
        EXPECT_MEAN(tally, E);
        EXPECT_RELATIVE(tally.mean, E, is_slow_build() ? 0.1 : 0.01);
    }
    sr_import_result_free(&scene);
}
