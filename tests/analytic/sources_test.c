/* SPDX-License-Identifier: MIT */
/* Point, distant and area sources: irradiance of a point by every estimator that can see the source. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)
static const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};

static void point_normal(const struct row *row)
{
    check_irradiance(row, origin, up, "LightSource \"point\" \"point3 from\" [0 0 2] \"float power\" 1000\n",
                     (struct effort){.path = 256, .lights = 256}, 1);
}

static void point_tilted(const struct row *row)
{
    check_irradiance(row, (const double[]){4, 0, 0}, up,
                     "LightSource \"point\" \"point3 from\" [0 0 3] \"float power\" 1000\n",
                     (struct effort){.path = 256, .lights = 256}, 1);
}

static void distant(const struct row *row)
{
    char text[256];
    snprintf(text, sizeof text,
             "LightSource \"distant\" \"float illuminance\" 1000 \"point3 from\" [%.9g 0 %.9g] \"point3 to\" [0 0 0]\n",
             sin(row->a * DEGREE), cos(row->a * DEGREE));
    check_irradiance(row, origin, up, text, (struct effort){.path = 256, .lights = 256}, 1);
}

/* Points on the cap of a sphere around the lamp, where all of its light arrives: flux = area of the cap times mean E.
 */
static const double cap_cos = 0.85;
static struct drawn onto_cap(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)v;
    double z = 1 - (1 - cap_cos) * (double)u.x, r = sqrt(1 - z * z), phi = 2 * (double)SR_PI * (double)u.y;
    sr_vec3 d = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)z};
    return (struct drawn){sr_scale(0.99f, d), d, 1};
}

static struct drawn onto_plane(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)v;
    double r = 0.62 * sqrt((double)u.x), phi = 2 * (double)SR_PI * (double)u.y; // tan 30 deg = 0.577
    return (struct drawn){{(float)(r * cos(phi)), (float)(r * sin(phi)), 0.999f}, {0, 0, 1}, 1};
}

static void spot_flux(const struct row *row)
{
    static const char *const ways[] = {"path", "simplepath"};
    for (int plane = 0; plane < 2; ++plane)
        for (int i = 0; i < 2; ++i) {
            struct world w = world_of(
                "Integrator \"%s\" \"integer maxdepth\" 1\nWorldBegin\n" GREY
                "LightSource \"spot\" \"float scale\" 100 \"float coneangle\" 30 \"float conedeltaangle\" 10 \"point3 to\" [0 0 1]\n%s",
                ways[i], plane ? "Shape \"disk\" \"float height\" 1" : "Shape \"sphere\" \"float radius\" 1");
            double area = plane ? (double)SR_PI * 0.62 * 0.62 : 2 * (double)SR_PI * (1 - cap_cos);
            struct estimate L = mean_luminance(&w.job, plane ? onto_plane : onto_cap, NULL, 4096);
            check(row,
                  plane ? (i ? "lights/pl." : "path/plane")
                  : i   ? "lights"
                        : "path",
                  scaled(L, (double)SR_PI / RECEIVER_RHO * area), GOAL);
            world_free(&w);
        }
}

// the hemisphere is sampled twice, by the meter and by the grey receiver: the second for some of the shapes only
static const struct effort usual = {.meter = 8192, .path = 2048, .lights = 2048};
static const struct effort all = {.meter = 8192, .path = 2048, .lights = 2048, .surface = 65536};
static const struct effort small = {.meter = 32768, .path = 2048, .lights = 2048}; // sources that few rays meet

static const char disk_above[] = BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 2 \"float radius\" 1\n";

static void disk(const struct row *row)
{
    check_irradiance(row, (const double[]){row->a, 0, 0},
                     (const double[]){-sin(row->b * DEGREE), 0, cos(row->b * DEGREE)}, disk_above,
                     row->a == 0   ? all
                     : row->b == 0 ? small
                                   : usual,
                     1);
}

static void sphere_at(const struct row *row, double distance, double tilt, double radius, struct effort n)
{
    char text[512];
    snprintf(text, sizeof text, BLACK GLOW "Translate %.9g 0 %.9g Shape \"sphere\" \"float radius\" %.9g\n",
             distance * sin(tilt * DEGREE), distance * cos(tilt * DEGREE), radius);
    check_irradiance(row, origin, up, text, n, 1);
}

static void sphere(const struct row *row)
{
    sphere_at(row, row->a, row->b, 1,
              row->b == 90 ? (struct effort){.meter = 65536, .path = 2048, .lights = 2048} : small);
}

static void cap(const struct row *row)
{
    // a source of half a degree is not met by chance often enough
    sphere_at(row, 1, 0, sin(row->a * DEGREE), row->a < 1 ? (struct effort){.path = 2048, .lights = 2048} : all);
}

static void rectangle(const struct row *row)
{
    char text[2048];
    double x0 = row->a, x1 = row->b, y0 = row->a, y1 = x0 < 0 ? x1 : 1;
    static const char *const shapes[] = {"bilinearmesh\" \"integer indices\" [0 1 2 3]",
                                         "trianglemesh\" \"integer indices\" [0 1 2 2 1 3]"};
    for (int i = 0; i < 2; ++i) {
        snprintf(text, sizeof text,
                 BLACK GLOW "ReverseOrientation Shape \"%s \"point3 P\" [%g %g 1 %g %g 1 %g %g 1 %g %g 1]\n", shapes[i],
                 x0, y0, x1, y0, x0, y1, x1, y1);
        check_irradiance(row, origin, up, text, i ? all : (struct effort){.path = 2048, .lights = 2048}, 1);
    }
}

static const char triangle_text[] =
    BLACK GLOW_BOTH "Shape \"trianglemesh\" \"point3 P\" [1 0 1 -1 2 1.5 -1 -1 2] \"integer indices\" [0 1 2]\n";

static void triangle(const struct row *row)
{
    check_irradiance(row, origin, up, triangle_text, usual, 1);
}

/* The light vector: its components are differences of the irradiances of the two sides. */
static void light_vector(const struct row *row)
{
    struct estimate side[2][3], length = {0, 0, REPLICATES - 1};
    for (int k = 0; k < 2; ++k)
        for (int axis = 0; axis < 3; ++axis) {
            double n[3] = {0};
            n[axis] = k ? -1 : 1;
            struct world w =
                world_of("Integrator \"path\" \"integer maxdepth\" 1\n%s%s", receiver_text(origin, n), triangle_text);
            side[k][axis] =
                scaled(pixel_mean(&w.job, 0, 0, 4096, (const double[]){0, 1, 0}), (double)SR_PI / RECEIVER_RHO);
            world_free(&w);
        }
    for (int axis = 0; axis < 3; ++axis) {
        double d = side[0][axis].mean - side[1][axis].mean;
        length.mean += d * d;
        length.error += d * d * (pow(side[0][axis].error, 2) + pow(side[1][axis].error, 2));
    }
    length.mean = sqrt(length.mean);
    length.error = sqrt(length.error) / length.mean;
    check(row, "path", length, GOAL);
}

static void tilted(const struct row *row)
{
    const double n[3] = {sin(row->a * DEGREE), 0, cos(row->a * DEGREE)};
    static const char sky[] = "LightSource \"infinite\" \"float scale\" 1\n" BLACK
                              "Shape \"disk\" \"float height\" -0.1 \"float radius\" 1e5\n";
    static const char plane[] =
        BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 0.1 \"float radius\" 1e5\n";
    check_irradiance(row, origin, n, sky, (struct effort){.path = 65536}, 1);
    check_irradiance(row, origin, n, plane, (struct effort){.meter = 32768}, 1);
}

/* A black slope of a white plain under a uniform sky: E = pi whatever its tilt. */
static void over_white_ground(const struct row *row)
{
    const double n[3] = {sin(row->a * DEGREE), 0, cos(row->a * DEGREE)};
    struct world w = world_of(
        "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nLightSource \"infinite\" \"float scale\" 1\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 1 830 1] Shape \"disk\" \"float height\" -0.1 \"float radius\" 1e5\n");
    struct sr_irradiance E = sr_render_irradiance(&w.job, (sr_vec3){0, 0, 0}, (sr_vec3){(float)n[0], 0, (float)n[2]},
                                                  samples(16384), REPLICATES);
    check(row, "meter", (struct estimate){E.E_v, E.E_v_error, E.degrees}, GOAL);
    world_free(&w);
}

/* A uniform sky through a rectangle alone: Lambert's sum over its edges. */
static void through_portal(const struct row *row)
{
    static const char *const portals[] = {"[0.2 -0.5 1  0.2 0.7 1  1.2 0.7 1  1.2 -0.5 1]",
                                          "[1.5 -0.8 0.5  1.5 -0.8 1.6  1.5 1.1 1.6  1.5 1.1 0.5]"};
    char text[256];
    snprintf(text, sizeof text, "LightSource \"infinite\" \"float scale\" 100 \"point3 portal\" %s\n",
             portals[row->a > 0]);
    check_irradiance(row, origin, up, text, usual, 1);
}

const struct row source_rows[] = {
    {"A1", "isotropic point, 1000 lm, 2 m, normal incidence [lx]", 19.8943678865, point_normal, 0, 0},
    {"A2", "isotropic point, 1000 lm, 3 m above, 4 m aside [lx]", 1.9098593171, point_tilted, 0, 0},
    {"A3", "distant light of 1000, 60 deg from the normal [lx]", 500.0, distant, 60, 0},
    {"A6", "spot of 100 cd, 20 to 30 deg: flux [lm]", 61.0354826735, spot_flux, 0, 0},
    {"B1", "disk R = 1 on axis, h = 2", 0.628318530718, disk, 0, 0},
    {"B2", "disk R = 1, h = 2, 1.5 off axis", 0.321335102752, disk, 1.5, 0},
    {"B4", "the same, receiver tilted by 35 deg", 0.381493863441, disk, 1.5, 35},
    {"B5", "sphere R = 1, D = 3, 40 deg", 0.267399954981, sphere, 3, 40},
    {"B6.80", "sphere R = 1, D = 2, cut by the horizon, 80 deg", 0.171831975127, sphere, 2, 80},
    {"B6.90", "sphere R = 1, D = 2, half above the horizon", 0.0905860737061, sphere, 2, 90},
    {"B7", "rectangle 2 x 1 at 1, under a corner", 0.525824101542, rectangle, 0, 2},
    {"B8", "square 1 x 1 at 1, under the centre", 0.752274688454, rectangle, -0.5, 0.5},
    {"B10", "triangle above the horizon", 0.875254739837, triangle, 0, 0},
    {"B10v", "its light vector", 0.888555581762, light_vector, 0, 0},
    {"B12.0", "uniform dome, and infinite plane: tilt 0 deg", 3.14159265359, tilted, 0, 0},
    {"B12.30", "tilt 30 deg", 2.93114584997, tilted, 30, 0},
    {"B12.60", "tilt 60 deg", 2.35619449019, tilted, 60, 0},
    {"B12.90", "tilt 90 deg", 1.57079632679, tilted, 90, 0},
    {"B12.120", "tilt 120 deg", 0.785398163397, tilted, 120, 0},
    {"B12w.70", "uniform sky, white ground, tilt 70 deg", 3.14159265359, over_white_ground, 70, 0},
    {"B14.0.2665", "cap of half angle 0.2665 deg", 6.79666559635e-5, cap, 0.2665, 0},
    {"B14.15", "cap of half angle 15 deg", 0.210446803619, cap, 15, 0},
    {"W.above", "sky of 100 cd/m^2 through a portal above [lx]", 49.7258841994, through_portal, 0, 0},
    {"W.aside", "sky of 100 cd/m^2 through a portal aside [lx]", 23.1915997227, through_portal, 1, 0},
    {.id = NULL},
};

TEST(sources_give_the_irradiance_of_the_closed_forms)
{
    run_rows("sources", source_rows);
}
