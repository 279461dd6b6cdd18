/* SPDX-License-Identifier: MIT */
/* Light that goes to and fro: closed enclosures, the integrating sphere, the Lambertian cube.
 *
 *     L = Le / (1 - rho)                  in a closed enclosure of any shape whose walls glow with Le
 *     L = rho / (1 - rho (1 - f)) Phi / (pi A)    in a sphere with a port of share f, lit evenly from its centre */
#include "analytic/analytic.h"

static struct drawn from_inside(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)v;
    return (struct drawn){{0.11f, -0.07f, 0.05f}, sr_warp_uniform_sphere(u), 1};
}

/* A closed mesh like a potato with bumps: radius 1 + 0.25 sin(3 theta) cos(4 phi). */
static const char *bumpy_mesh(void)
{
    static char text[1 << 17];
    enum { ROWS = 16, COLUMNS = 32 };
    int at = snprintf(text, sizeof text, "Shape \"trianglemesh\" \"point3 P\" [");
    for (int i = 0; i <= ROWS; ++i)
        for (int j = 0; j < COLUMNS; ++j) {
            double theta = (double)SR_PI * i / ROWS, phi = 2 * (double)SR_PI * j / COLUMNS;
            double r = 1 + (i == 0 || i == ROWS ? 0 : 0.25 * sin(3 * theta) * cos(4 * phi)),
                   s = i == 0 || i == ROWS ? 0 : sin(theta);
            at += snprintf(text + at, sizeof text - (size_t)at, "%.9g %.9g %.9g ", r * s * cos(phi), r * s * sin(phi),
                           r * cos(theta));
        }
    at += snprintf(text + at, sizeof text - (size_t)at, "] \"integer indices\" [");
    for (int i = 0; i < ROWS; ++i)
        for (int j = 0; j < COLUMNS; ++j) {
            int a = i * COLUMNS + j, b = i * COLUMNS + (j + 1) % COLUMNS;
            if (i > 0)
                at += snprintf(text + at, sizeof text - (size_t)at, "%d %d %d ", a, b, a + COLUMNS);
            if (i < ROWS - 1)
                at += snprintf(text + at, sizeof text - (size_t)at, "%d %d %d ", b, b + COLUMNS, a + COLUMNS);
        }
    snprintf(text + at, sizeof text - (size_t)at, "]\n");
    return text;
}

static const char cube[] =
    "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 1] "
    "\"integer indices\" [0 1 2 3 4 5 6 7 0 1 4 5 2 3 6 7 0 2 4 6 1 3 5 7]\n";

static const char *shape_text(int i)
{
    return i == 0 ? cube : i == 1 ? "Shape \"sphere\" \"float radius\" 1.3\n" : bumpy_mesh();
}

static struct world furnace(const char *integrator, double rho, const char *shape)
{
    return world_of(
        "Integrator %s\nWorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [360 %.9g 830 %.9g]\n" GLOW_BOTH "%s",
        integrator, rho, rho, shape);
}

/* a: reflectance, b: most bounces (0: all that matter). Without light sampling and roulette every path gives the
 * answer. */
static void closed(const struct row *row)
{
    static const char *const names[] = {"cube", "sphere", "mesh"};
    double depth = row->b > 0 ? row->b : row->a > 0 ? ceil(log(1e-8) / log(row->a)) : 1;
    for (int shape = 0; shape < 3; ++shape)
        for (int way = 0; way < 3; ++way) {
            // light sampling has chance in it, and the longer the paths the more: a wider goal, which more effort
            // brings down
            double n = way == 0 ? (row->a < 0.9 ? 64 : 8) : row->a < 0.9 ? 1024 : 64;
            double goal = way == 0       ? (row->a < 0.9 ? GOAL : 4 * GOAL)
                          : row->a < 0.2 ? 6 * GOAL
                          : row->a < 0.6 ? 16 * GOAL
                          : row->a < 0.9 ? 40 * GOAL
                                         : 240 * GOAL;
            if (way && (row->a > 0.9 || row->b > 0) && shape != 1)
                continue;
            char text[128], how[32];
            static const char *const ways[] = {"\"simplepath\" \"integer maxdepth\" %.0f \"bool samplelights\" false",
                                               "\"path\" \"integer maxdepth\" %.0f",
                                               "\"simplepath\" \"integer maxdepth\" %.0f"};
            snprintf(text, sizeof text, way == 0 ? ways[0] : way == 1 ? ways[1] : ways[2], depth);
            snprintf(how, sizeof how, "%s%s", names[shape], way == 0 ? "" : way == 1 ? "/path" : "/light");
            struct world w = furnace(text, row->a, shape_text(shape));
            check(row, how, mean_luminance(&w.job, from_inside, NULL, n), goal);
            world_free(&w);
        }
}

/* The integrating sphere: an open cap, a point source at the centre. a: reflectance. */
static struct drawn at_wall(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)v;
    double half_angle = 16.2602047083 * 3.14159265358979323846 / 180,
           z = -1 + (1 + cos(half_angle)) * (double)u.x * 0.999; // not the port, at +z
    double r = sqrt(1 - z * z), phi = 2 * (double)SR_PI * (double)u.y;
    sr_vec3 d = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)z};
    return (struct drawn){sr_scale(0.149f, d), d, 1};
}

static struct estimate sphere_radiance(double rho, double n)
{
    double z = 0.15 * (1 - 2 * 0.02);
    struct world w = world_of(
        "Integrator \"path\" \"integer maxdepth\" 2000\nWorldBegin\nLightSource \"point\" \"float power\" 1\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 %.9g 830 %.9g] Shape \"sphere\" \"float radius\" 0.15 \"float zmax\" %.9g\n",
        rho, rho, z);
    struct estimate e = mean_luminance(&w.job, at_wall, NULL, n);
    world_free(&w);
    return e;
}

static struct estimate L990;
static void integrating_sphere(const struct row *row)
{
    L990 = sphere_radiance(0.99, 512);
    check(row, "path", L990, 96 * GOAL);
}
static void multiplier(const struct row *row)
{
    check(row, "path", scaled(L990, (double)SR_PI * 4 * (double)SR_PI * 0.15 * 0.15), 96 * GOAL);
}
static void amplification(const struct row *row)
{
    // the same random numbers: most of the chance cancels, which is not counted here
    struct estimate L989 = sphere_radiance(0.989, 512);
    check(row, "path",
          (struct estimate){L989.mean / L990.mean,
                            L989.mean / L990.mean * hypot(L989.error / L989.mean, L990.error / L990.mean),
                            REPLICATES - 1},
          100 * GOAL);
}

/* The unit cube whose ceiling gives off 1 and reflects nothing, floor and walls reflect 1/2: mean irradiance of a face.
 */
struct face {
    int which; // 0 floor, 1 wall, 2 ceiling
};
static struct drawn at_face(const void *context, sr_vec2 u, sr_vec2 v)
{
    const struct face *face = context;
    sr_vec3 p = {u.x, u.y, 0}, n = {0, 0, 1};
    if (face->which == 1)
        p = (sr_vec3){u.x, 0, u.y}, n = (sr_vec3){0, 1, 0};
    else if (face->which == 2)
        p = (sr_vec3){u.x, u.y, 1}, n = (sr_vec3){0, 0, -1};
    if (face->which < 2) // seen from above, with the grey that it has
        return (struct drawn){sr_mad(p, 1e-4f, n), sr_neg(n), (double)SR_PI / RECEIVER_RHO};
    struct sr_frame f = sr_frame_from_z(n);
    return (struct drawn){sr_mad(p, 2e-6f, n), sr_to_world(&f, sr_warp_cosine_hemisphere(v)), (double)SR_PI};
}

static void lambertian_cube(const struct row *row)
{
    static const char *const ways[] = {"path", "simplepath"};
    for (int i = 0; i < 2; ++i) {
        struct world w =
            world_of("Integrator \"%s\" \"integer maxdepth\" 28\nWorldBegin\n" GREY
                     "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1] "
                     "\"integer indices\" [0 1 2 3 0 1 4 5 2 3 6 7 0 2 4 6 1 3 5 7]\n" BLACK
                     "AreaLightSource \"diffuse\" \"float power\" 1 ReverseOrientation "
                     "Shape \"bilinearmesh\" \"point3 P\" [0 0 1 1 0 1 0 1 1 1 1 1]\n",
                     ways[i]);
        struct face face = {(int)row->a};
        check(row, i ? "lights" : "path", mean_luminance(&w.job, at_face, &face, i ? 1024 : 8192),
              i ? 20 * GOAL : 10 * GOAL);
        world_free(&w);
    }
}

/* CIE 171, test case 5.8: a room of 4 m with a point source of 10 000 lm; only the mean over all surfaces is known. */
static struct drawn at_room(const void *context, sr_vec2 u, sr_vec2 v)
{
    const double *rho = context;
    int face = (int)(6 * v.x), axis = face / 2;
    float c[3], side = face & 1 ? 1 : -1;
    c[axis] = side;
    c[(axis + 1) % 3] = 2 * u.x - 1;
    c[(axis + 2) % 3] = 2 * u.y - 1;
    sr_vec3 p = {2 * c[0], 2 * c[1], 2 * c[2]}, n = {axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0};
    return (struct drawn){sr_mad(p, -1e-4f, n), n, (double)SR_PI / *rho};
}

static void room(const struct row *row)
{
    struct world w = world_of(
        "Integrator \"path\" \"integer maxdepth\" 400\nWorldBegin\nLightSource \"point\" \"float power\" 10000\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 %.9g 830 %.9g]\nScale 2 2 2 %s",
        row->a, row->a, cube);
    check(row, "path", mean_luminance(&w.job, at_room, &row->a, row->a < 0.8 ? 4096 : 1024),
          row->a < 0.2   ? 2 * GOAL
          : row->a < 0.4 ? 8 * GOAL
          : row->a < 0.8 ? 16 * GOAL
                         : 40 * GOAL);
    world_free(&w);
}

/* From the centre of a bowl, half a sphere, into it. The bowl sees itself and the sky by halves: L = rho / (2 - rho)
 * below a sky of 1. Paths that end by lot must lose none of the sky's light, nor find it twice; some go through a sheet
 * that does not scatter. a: reflectance. */
static struct drawn into_bowl(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)v;
    sr_vec3 d = sr_warp_uniform_hemisphere(u);
    return (struct drawn){{0, 0, 0}, sr_neg(d), 1};
}

static void bowl(const struct row *row)
{
    static const char *const ways[] = {"path", "caustics", "bdpt"};
    for (size_t way = 0; way < sizeof ways / sizeof *ways; ++way) {
        struct world w = world_of("Integrator \"%s\" \"integer maxdepth\" 40\nWorldBegin\n"
                                  "LightSource \"infinite\" \"float scale\" 1\n"
                                  "Material \"diffuse\" \"spectrum reflectance\" [360 %.9g 830 %.9g]\n"
                                  "Shape \"sphere\" \"float radius\" 1 \"float zmax\" 0\n"
                                  "Material \"interface\" Shape \"disk\" \"float height\" 0.1 \"float radius\" 1\n",
                                  ways[way], row->a, row->a);
        check(row, ways[way], mean_luminance(&w.job, into_bowl, NULL, 4096), 24 * GOAL);
        world_free(&w);
    }
}

const struct row enclosure_rows[] = {
    {"D6.0.1", "bowl below the sky, rho = 0.1", 0.1 / 1.9, bowl, 0.1, 0},
    {"D6.0.5", "bowl below the sky, rho = 0.5", 0.5 / 1.5, bowl, 0.5, 0},
    {"D6.0.9", "bowl below the sky, rho = 0.9", 0.9 / 1.1, bowl, 0.9, 0},
    {"D1.0.1", "closed enclosure, rho = 0.1", 1.11111111111, closed, 0.1, 0},
    {"D1.0.5", "closed enclosure, rho = 0.5", 2, closed, 0.5, 0},
    {"D1", "closed enclosure, rho = 0.8", 5.0, closed, 0.8, 0},
    {"D1.0.99", "closed enclosure, rho = 0.99", 100, closed, 0.99, 0},
    {"D1b", "closed enclosure, rho = 0.8, ten bounces", 4.5705032704, closed, 0.8, 10},
    {"D3", "integrating sphere: wall radiance", 37.400436915, integrating_sphere, 0, 0},
    {"D2", "integrating sphere: multiplier", 33.2214765101, multiplier, 0, 0},
    {"D5", "integrating sphere: rho 0.990 to 0.989", 0.967183203051, amplification, 0, 0},
    {"D13.floor", "Lambertian cube, continuous: floor", 0.31034917, lambertian_cube, 0, 0},
    {"D13.wall", "wall", 0.32798491, lambertian_cube, 1, 0},
    {"D13.ceiling", "ceiling", 0.18885559, lambertian_cube, 2, 0},
    {"CIE5.8.0.1", "room, mean illuminance, rho = 0.1 [lx]", 115.740741, room, 0.1, 0},
    {"CIE5.8.0.3", "rho = 0.3", 148.809524, room, 0.3, 0},
    {"CIE5.8.0.5", "rho = 0.5", 208.333333, room, 0.5, 0},
    {"CIE5.8.0.7", "rho = 0.7", 347.222222, room, 0.7, 0},
    {"CIE5.8.0.9", "rho = 0.9", 1041.666667, room, 0.9, 0},
    {.id = NULL},
};

TEST(enclosures_hold_the_light_that_the_closed_forms_say)
{
    run_rows("enclosures", enclosure_rows);
}
