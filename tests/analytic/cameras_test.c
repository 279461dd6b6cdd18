/* SPDX-License-Identifier: MIT */
/* Cameras: what arrives on a film behind a lens, the circle of confusion, and solid angles of pixels.
 *
 *     E = integral over the pupil of L cos theta cos theta' / d^2 dA = B2's disk formula, not the cos^4 law
 *
 * An ideal lens of a uniform field is a disk that glows with the field's radiance. Lengths here: 50 mm are 1 m. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)

static const struct effort both = {.path = 4096, .lights = 4096};

/* a: angle off axis [deg], b: radius of the pupil over its distance */
static void pupil(const struct row *row)
{
    char text[256];
    snprintf(text, sizeof text,
             BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 1 \"float radius\" %.9g\n", row->b);
    check_irradiance(row, (const double[]){tan(row->a * DEGREE), 0, 0}, (const double[]){0, 0, 1}, text, both, 1);
}
/* The same with a true hole: a diaphragm before a bright sky; nothing but rays can find it. */
static void hole(const struct row *row)
{
    struct world w = world_of(
        "Integrator \"path\" \"integer maxdepth\" 0\nWorldBegin\nLightSource \"infinite\" \"float scale\" 1\n" BLACK
        "Shape \"disk\" \"float height\" 1 \"float innerradius\" %.9g \"float radius\" 1e5\n",
        row->b);
    struct sr_irradiance E = sr_render_irradiance(&w.job, (sr_vec3){(float)tan(row->a * DEGREE), 0, 0},
                                                  (sr_vec3){0, 0, 1}, samples(131072), REPLICATES);
    check(row, "hole", (struct estimate){E.E_v, E.E_v_error, E.degrees}, 8 * GOAL);
    world_free(&w);
}
static void pupil_and_hole(const struct row *row)
{
    pupil(row);
    hole(row);
}
static void pinhole_ratio(const struct row *row)
{
    char text[256];
    snprintf(text, sizeof text,
             BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 1 \"float radius\" %.9g\n", row->b);
    check_irradiance(row, (const double[]){tan(row->a * DEGREE), 0, 0}, (const double[]){0, 0, 1}, text, both,
                     1 / ((double)SR_PI * row->b * row->b));
}

/* f/2 of 50 mm focused at 2 m, a small disk that glows at 4 m: its picture is a disk of the diameter c, whose second
 * moment is c^2 / 16 for each axis, widened by the picture of the disk itself, r^2 / 4, and by the pixel, step^2 / 12.
 */
static void confusion(const struct row *row)
{
    static const double object_m = 4, focus_m = 2, f_m = 0.05, D_m = 0.025, disk_m = 1e-3;
    enum { N = 40 };
    double image_m = f_m * focus_m / (focus_m - f_m),
           fov = 2 * atan(0.4e-3 / 2 / image_m) / DEGREE; // the picture is 0.4 mm wide
    struct world w =
        world_of("Integrator \"path\" \"integer maxdepth\" 0\n"
                 "Camera \"perspective\" \"float fov\" %.12g \"float lensradius\" %.9g \"float focaldistance\" %.9g\n"
                 "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nPixelFilter \"box\"\nWorldBegin\n"
                 "Translate 0 0 %.9g " BLACK GLOW_BOTH "Shape \"disk\" \"float radius\" %.9g\n",
                 fov, D_m / 2, focus_m, N, N, object_m, disk_m);
    double own_mm2 = 1e6 * pow(disk_m * image_m / object_m, 2) / 4, step = 0.4 / N;
    struct sr_tally tally = {0};
    for (uint32_t r = 0; r < REPLICATES; ++r) {
        struct sr_render_job job = w.job;
        job.seed = r;
        job.spp = samples(64);
        struct sr_film *film;
        struct sr_render_report report;
        struct sr_error error = {0};
        if (sr_render(&job, &film, &report, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        double sum = 0, moment = 0;
        for (uint32_t y = 0; y < N; ++y)
            for (uint32_t x = 0; x < N; ++x) {
                double mean[3], px = (x + 0.5 - N / 2) * step, py = (y + 0.5 - N / 2) * step;
                sr_film_pixel_mean(film, x, y, mean);
                sum += mean[1];
                moment += mean[1] * (px * px + py * py - step * step / 6);
            }
        sr_tally_add(&tally, 4 * sqrt((moment / sum) / 2 - own_mm2));
        sr_film_destroy(film);
    }
    check(row, "picture", (struct estimate){tally.mean, sr_tally_standard_error(&tally), REPLICATES - 1}, 40 * GOAL);
    world_free(&w);
}

/* Solid angles of the pixels of 36 x 24 mm at 50 mm, from the rays through their corners. */
static void pixels(const struct row *row)
{
    enum { W = 36, H = 24 };
    struct world w = world_of(
        "Camera \"perspective\" \"float fov\" %.12g\nFilm \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nWorldBegin\nShape \"sphere\"\n",
        2 * atan(12.0 / 50) / DEGREE, W, H);
    double sum = 0;
    for (int y = 0; y < H; ++y)
        for (int x = 0; x < W; ++x) {
            sr_vec3 d[4];
            for (int k = 0; k < 4; ++k) {
                struct sr_sensor_ray r;
                EXPECT(w.job.sensor.model->ray(w.job.sensor.self,
                                               (sr_vec2){(float)(x + (k & 1)), (float)(y + (k >> 1))},
                                               (sr_vec2){0.5f, 0.5f}, 0, &r));
                d[k] = r.ray.d;
            }
            sum +=
                fabs(sr_spherical_triangle_area(d[0], d[1], d[2])) + fabs(sr_spherical_triangle_area(d[2], d[1], d[3]));
        }
    check(row, "rays", (struct estimate){sum, 0, 1}, GOAL);
    world_free(&w);
}

const struct row camera_rows[] = {
    {"J1", "f/2, on axis, object far away", 0.184799567858, pupil_and_hole, 0, 0.25},
    {"J2.15", "15 deg off axis", 0.163249931822, pupil_and_hole, 15, 0.25},
    {"J2.40", "40 deg off axis", 0.0681550144293, pupil_and_hole, 40, 0.25},
    {"J3", "pinhole at 40 deg, relative to pi (R/f)^2", 0.344362511235, pinhole_ratio, 40, 1e-3},
    {"J5", "circle of confusion [mm]", 0.320512820513, confusion, 0, 0},
    {"J6", "solid angle of all pixels [sr]", 0.316522070564, pixels, 0, 0},
    {.id = NULL},
};

TEST(cameras_gather_what_the_closed_forms_say)
{
    run_rows("cameras", camera_rows);
}
