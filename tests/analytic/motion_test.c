/* SPDX-License-Identifier: MIT */
/* What moves while the shutter is open: means over time in closed form or by quadrature, and no rays lost at surfaces
 * that turn. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)

static const double luminance[3] = {0, 1, 0};
static const double goal = 1e-3; // STERADIAN_TEST_EFFORT brings it down to GOAL

#define SKY "LightSource \"infinite\" \"float scale\" 1\n"
#define WINDOW                                                                                                         \
    "Integrator \"path\" \"integer maxdepth\" 0\n"                                                                     \
    "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nPixelFilter \"box\"\n"

static void see(const struct row *row, double n, const char *scene)
{
    struct world w = world_of("%s", scene);
    check(row, "path", pixel_mean(&w.job, 0, 0, n, luminance), goal);
    world_free(&w);
}

/* The area of a convex polygon within |x| <= 1, |y| <= 1: Sutherland & Hodgman, 1974. */
static double clipped_area(const double (*corner)[2], int n)
{
    double a[16][2], b[16][2], area = 0;
    memcpy(a, corner, (size_t)n * sizeof *a);
    for (int side = 0; side < 4; ++side) {
        int axis = side / 2, m = 0;
        double sign = side % 2 ? -1 : 1;
        for (int i = 0; i < n; ++i) {
            const double *p = a[i], *q = a[(i + 1) % n];
            double dp = 1 - sign * p[axis], dq = 1 - sign * q[axis];
            if (dp >= 0)
                memcpy(b[m++], p, sizeof b[0]);
            if ((dp >= 0) != (dq >= 0)) {
                double t = dp / (dp - dq);
                b[m][0] = p[0] + t * (q[0] - p[0]);
                b[m++][1] = p[1] + t * (q[1] - p[1]);
            }
        }
        memcpy(a, b, (size_t)m * sizeof *a);
        n = m;
    }
    for (int i = 0; i < n; ++i)
        area += 0.5 * (a[i][0] * a[(i + 1) % n][1] - a[(i + 1) % n][0] * a[i][1]);
    return fabs(area);
}

/* What a window 2 wide sees of the sky past a rectangle that has turned by an angle [deg], its middle 0.66 off the
 * axis. */
static double sky(double angle)
{
    static const double x[4] = {0.2, 1.0, 1.0, 0.2}, y[4] = {-0.7, -0.7, 0.7, 0.7};
    double c = cos(angle * DEGREE), s = sin(angle * DEGREE), corner[4][2];
    for (int k = 0; k < 4; ++k) {
        corner[k][0] = 1.1 * (c * x[k] - s * y[k]);
        corner[k][1] = 1.1 * (s * x[k] + c * y[k]);
    }
    return 1 - clipped_area((const double(*)[2])corner, 4) / 4;
}
static double mean_sky(double angle)
{
    enum { N = 20000 };
    double sum = 0;
    for (int i = 0; i < N; ++i)
        sum += sky(angle * (i + 0.5) / N);
    return sum / N;
}

#define RECTANGLE                                                                                                      \
    BLACK                                                                                                              \
    "Scale 1.1 1.1 1.1 Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [0.2 -0.7 0  1 -0.7 0  1 0.7 0  0.2 0.7 0]\n"
/* a: the whole turn [deg]; b: what turns. */
static void turning(const struct row *row)
{
    char text[2048];
    static const char *const scenes[] = {
        "Translate 0 0 3 Camera \"orthographic\"\n" WINDOW "WorldBegin\n" SKY
        "ActiveTransform EndTime Rotate %g 0 0 1 ActiveTransform All\n" RECTANGLE,
        "Translate 0 0 3 ActiveTransform EndTime Rotate %g 0 0 1 ActiveTransform All Camera \"orthographic\"\n" WINDOW
        "WorldBegin\n" SKY RECTANGLE,
        "Translate 0 0 3 Camera \"orthographic\"\n" WINDOW "WorldBegin\n" SKY "ObjectBegin \"a\"\n" RECTANGLE
        "ObjectEnd\n"
        "ActiveTransform EndTime Rotate %g 0 0 1 ActiveTransform All ObjectInstance \"a\"\n",
        "Translate 0 0 3 Camera \"orthographic\"\n" WINDOW "WorldBegin\n" SKY
        "ObjectBegin \"a\" ActiveTransform EndTime Rotate %g 0 0 1 ActiveTransform All\n" RECTANGLE
        "ObjectEnd\nActiveTransform EndTime Rotate %g 0 0 1 ActiveTransform All ObjectInstance \"a\"\n",
        // over the shutter's middle half, within times of its own
        "TransformTimes 2.25 2.75 Translate 0 0 3 Camera \"orthographic\" \"float shutteropen\" 2 \"float shutterclose\" 3\n" WINDOW
        "WorldBegin\n" SKY "ActiveTransform EndTime Rotate %g 0 0 1 ActiveTransform All\n" RECTANGLE,
    };
    int kind = (int)row->b;
    snprintf(text, sizeof text, scenes[kind], kind == 3 ? row->a / 2 : row->a, row->a / 2);
    struct row known = *row;
    known.value = mean_sky(row->a);
    if (kind == 4)
        known.value = 0.25 * sky(0) + 0.5 * known.value + 0.25 * sky(row->a);
    see(&known, 16384, text);
}

/* Irradiance from a sky of luminance 1 past a black disk that rises from a to b above the point, its radius r = 1: 1
 * minus what it hides, r^2 / (r^2 + h^2), of which the mean over h is (atan(b) - atan(a)) / (b - a). Times pi. */
static void rising(const struct row *row)
{
    struct row known = *row;
    known.value = (double)SR_PI * (1 - (atan(row->b) - atan(row->a)) / (row->b - row->a));
    struct world w = world_of(
        "Integrator \"path\" \"integer maxdepth\" 0\nWorldBegin\n" SKY BLACK
        "AttributeBegin Translate 0 0 %.9g ActiveTransform EndTime Translate 0 0 %.9g Shape \"disk\" AttributeEnd\n"
        "#@ Meter \"irradiance\" \"point3 p\" [0 0 0] \"normal n\" [0 0 1]\n",
        row->a, row->b - row->a);
    struct sr_measure_settings s = {
        .samples = (uint64_t)samples(32768) * REPLICATES, .replicates = REPLICATES, .system = SR_PHOTOPIC};
    struct sr_arena arena = {0};
    struct sr_measurement m;
    struct sr_error error = {0};
    EXPECT(w.scene.meter_count == 1 && sr_measure(&w.job, &w.scene.meters[0], &s, &arena, &m, &error) == SR_OK);
    const struct sr_quantity *q = &m.value[SR_PHOTOPIC];
    check(&known, "meter", (struct estimate){q->value, q->u, q->degrees}, goal);
    sr_arena_free(&arena);
    world_free(&w);
}

static const struct row rows[] = {
    {"turn-shape", "a rectangle turns by 50 degrees", 0, turning, 50, 0},
    {"turn-camera", "the camera turns instead", 0, turning, 50, 1},
    {"turn-object", "an instance turns", 0, turning, 50, 2},
    {"turn-both", "a shape turns in an instance that turns", 0, turning, 100, 3},
    {"turn-times", "it turns in the shutter's middle half", 0, turning, 170, 4},
    {"rise", "a disk rises between a point and the sky", 0, rising, 0.5, 2},
    {NULL, NULL, 0, NULL, 0, 0},
};

TEST(means_over_the_shutter_are_right)
{
    run_rows("motion", rows);
}

/* A convex grey body before a sky of luminance 1 is as bright as its reflectance, if no path meets it twice; within a
 * closed one no light is, if no path leaks out. Turned and stretched, far from the origin. */
static void look_for_leaks(const char *body, bool inside, double allowed)
{
    double from = inside ? 10.2 : 0;
    struct world w = world_of(
        "LookAt 1000 10 %.9g  1000 10 2010.5  0 1 0 Camera \"perspective\" \"float fov\" %d\nIntegrator \"path\" \"integer maxdepth\" 40\n"
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nPixelFilter \"box\"\nWorldBegin\n" SKY
        "Material \"diffuse\" \"spectrum reflectance\" [360 0.5 830 0.5]\n"
        "Translate 1000 10 2010 Rotate 30 1 2 3 ActiveTransform EndTime Rotate 77 3 -1 2 Scale 1.3 1 0.8 ActiveTransform All Scale 3 3 3 %s\n",
        2000 + from, inside ? 100 : 50, body);
    struct sr_worker worker = {0};
    uint32_t n = samples(16), bad = 0, met = 0;
    for (uint32_t y = 0; y < 64; ++y)
        for (uint32_t x = 0; x < 64; ++x)
            for (uint32_t i = 0; i < n; ++i) {
                float rgb[3];
                sr_render_sample(&w.job, x, y, 0, i, rgb, NULL, &worker);
                bad += inside ? rgb[0] != 0 || rgb[1] != 0 || rgb[2] != 0 : worker.rays > 2;
                met += worker.rays > 1;
                worker.rays = 0;
            }
    EXPECT(met > 64 * 64 * n / 5);
    if (bad > allowed * met)
        test_fail(__FILE__, __LINE__, "%u of %u rays went astray, %s, %.40s", bad, met, inside ? "inside" : "outside",
                  body);
    world_free(&w);
}

TEST(surfaces_that_turn_do_not_leak)
{
    static const char cube[] =
        "Shape \"trianglemesh\" \"point3 P\" [-1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1  -1 -1 1  1 -1 1  1 1 1  -1 1 1]\n"
        "\"integer indices\" [0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  3 6 2 3 7 6  1 2 6 1 6 5  0 4 7 0 7 3]\n";
    for (int inside = 0; inside < 2; ++inside) {
        look_for_leaks("Shape \"sphere\"", inside, 0);
        look_for_leaks(cube, inside,
                       inside ? 2e-4 : 0); // in an edge, on one face is off the other; so it is where nothing moves
    }
}
