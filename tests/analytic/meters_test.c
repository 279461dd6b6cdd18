/* SPDX-License-Identifier: MIT */
/* Every kind of meter in scenes whose readings are known: point sources at an angle, uniform skies, disks of light, by
 * closed forms or by quadrature in double. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)
static const double pi = 3.14159265358979323846;
static const double meter_goal = 2e-3; // relative standard error; STERADIAN_TEST_EFFORT brings it down to GOAL

/* Measures the first meter of a scene by path tracing, and by an estimator that does not weigh what meters find. */
static void read_meter(const struct row *row, enum sr_system system, double n, const char *scene)
{
    static const char *const ways[] = {"path", "simplepath"};
    for (int i = 0; i < 2; ++i) {
        struct world w = world_of("Integrator \"%s\" \"integer maxdepth\" 1\nWorldBegin\n%s", ways[i], scene);
        struct sr_measure_settings s = {
            .samples = (uint64_t)samples(n) * REPLICATES, .replicates = REPLICATES, .system = system};
        struct sr_arena arena = {0};
        struct sr_measurement m;
        struct sr_error error = {0};
        EXPECT(w.scene.meter_count == 1 && sr_measure(&w.job, &w.scene.meters[0], &s, &arena, &m, &error) == SR_OK);
        const struct sr_quantity *q = &m.value[system];
        check(row, ways[i], (struct estimate){q->value, q->u, q->degrees}, i ? 2e-2 : meter_goal);
        sr_arena_free(&arena);
        world_free(&w);
    }
}

/* ---- definitions, once more and in double: response of a body toward unit w ---- */

struct vec {
    double x, y, z;
};
static double dot(struct vec a, struct vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

enum body { IRRADIANCE, CYLINDER, HALF_CYLINDER, HEMISPHERE, SPHERE, FLUENCE };
static const struct vec axis = {0.36, -0.48, 0.8}, facing = {0.8, 0.6, 0}; // square to each other
static const char *const bodies[] = {
    "\"irradiance\" \"normal n\" [0.36 -0.48 0.8]",
    "\"cylindrical\" \"vector3 axis\" [0.36 -0.48 0.8]",
    "\"semicylindrical\" \"vector3 axis\" [0.36 -0.48 0.8] \"vector3 facing\" [0.8 0.6 0]",
    "\"hemispherical\" \"normal n\" [0.36 -0.48 0.8]",
    "\"spherical\"",
    "\"fluence\"",
};
static double response(enum body body, struct vec w)
{
    double c = dot(w, axis), s = sqrt(fmax(0, 1 - c * c));
    switch (body) {
    case IRRADIANCE:
        return fmax(0, c);
    case CYLINDER:
        return s / pi;
    case HALF_CYLINDER:
        return (s + dot(w, facing)) / pi;
    case HEMISPHERE:
        return (1 + c) / 4;
    case SPHERE:
        return 0.25;
    default:
        return 1;
    }
}

/* INTEGRAL of the response over the cone of half angle a around unit d. */
static double over_cone(enum body body, struct vec d, double a)
{
    enum { N = 200 };
    double z[N], wz[N], sum = 0;
    struct vec t = fabs(d.x) < 0.5 ? (struct vec){1, 0, 0} : (struct vec){0, 1, 0};
    double k = dot(t, d);
    t = (struct vec){t.x - k * d.x, t.y - k * d.y, t.z - k * d.z};
    k = sqrt(dot(t, t));
    t = (struct vec){t.x / k, t.y / k, t.z / k};
    struct vec b = {d.y * t.z - d.z * t.y, d.z * t.x - d.x * t.z, d.x * t.y - d.y * t.x};
    sr_gauss_legendre(N, cos(a), 1, z, wz);
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < 4 * N; ++j) {
            double s = sqrt(1 - z[i] * z[i]), phi = 2 * pi * (j + 0.5) / (4 * N), x = s * cos(phi), y = s * sin(phi);
            struct vec w = {z[i] * d.x + x * t.x + y * b.x, z[i] * d.y + x * t.y + y * b.y,
                            z[i] * d.z + x * t.z + y * b.z};
            sum += wz[i] * 2 * pi / (4 * N) * response(body, w);
        }
    return sum;
}

/* ---- bodies ---- */

/* A point source of 50 cd at (1, 2, 4) seen from (0, 0, 1): r^2 = 14. row->a: the body. */
static void of_point(const struct row *row)
{
    char text[1024];
    struct row exact = *row;
    struct vec w = {1 / sqrt(14), 2 / sqrt(14), 3 / sqrt(14)};
    exact.value = response((enum body)row->a, w) * 50 / 14;
    snprintf(text, sizeof text,
             "LightSource \"point\" \"point3 from\" [1 2 4] \"float power\" %.15g\n#@ Meter %s \"point3 p\" [0 0 1]\n",
             4 * pi * 50, bodies[(int)row->a]);
    read_meter(&exact, SR_PHOTOPIC, 64, text);
}

/* A sky of 1 cd/m^2 from everywhere: pi for all bodies, 4 pi of fluence. */
static void of_sky(const struct row *row)
{
    char text[512];
    snprintf(text, sizeof text, "LightSource \"infinite\" \"float scale\" 1\n#@ Meter %s\n", bodies[(int)row->a]);
    read_meter(row, SR_PHOTOPIC, 1024, text);
}

/* A disk of 3 cd/m^2 that fills a cone of 25 degrees around (2, -1, 2)/3, partly below the horizon of none of the
 * bodies. */
static void of_disk(const struct row *row)
{
    char text[1024];
    struct row exact = *row;
    struct vec d = {2 / 3., -1 / 3., 2 / 3.};
    exact.value = 3 * over_cone((enum body)row->a, d, 25 * DEGREE);
    snprintf(
        text, sizeof text,
        "AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" 3 \"bool twosided\" true\nRotate %.9g 1 2 0 Shape \"disk\" \"float height\" 2 \"float radius\" %.9g\n"
        "AttributeEnd\n#@ Meter %s\n",
        acos(2 / 3.) / DEGREE, 2 * tan(25 * DEGREE), bodies[(int)row->a]);
    read_meter(&exact, SR_PHOTOPIC, 4096, text);
}

/* Straight above, where the forms are closed: a of 25 degrees; the meter in a moved and turned frame of its own. */
static void of_disk_above(const struct row *row)
{
    static const char *const straight[] = {
        "\"irradiance\"", "\"cylindrical\"", "\"semicylindrical\"", "\"hemispherical\"", "\"spherical\"", "\"fluence\"",
    };
    char text[1024];
    snprintf(
        text, sizeof text,
        "Translate 5 1 2 Rotate 63 1 4 2\nAttributeBegin\nAreaLightSource \"diffuse\" \"bool twosided\" true Shape \"disk\" \"float height\" 2 "
        "\"float radius\" %.9g\nAttributeEnd\n#@ Meter %s\n",
        2 * tan(25 * DEGREE), straight[(int)row->a]);
    read_meter(row, SR_PHOTOPIC, 4096, text);
}

/* ---- radiance ---- */

/* A disk of 8 cd/m^2 and 5 degrees in a cone of acceptance of 12 degrees. */
static void cone(const struct row *row)
{
    char text[512];
    struct row exact = *row;
    exact.value = 8 * (1 - cos(5 * DEGREE)) / (1 - cos(row->a * DEGREE));
    snprintf(
        text, sizeof text,
        "AreaLightSource \"diffuse\" \"float scale\" 8 \"bool twosided\" true Shape \"disk\" \"float height\" 2 \"float radius\" %.9g\n"
        "#@ Meter \"radiance\" \"vector3 d\" [0 0 1] \"float halfangle\" %.9g\n",
        2 * tan(5 * DEGREE), row->a);
    read_meter(&exact, SR_PHOTOPIC, 8192, text);
}

/* Along a ray that ends at a grey wall under a distant light: L = rho E / pi. */
static void ray(const struct row *row)
{
    read_meter(row, SR_PHOTOPIC, 64,
               "LightSource \"distant\" \"float illuminance\" 10 \"point3 from\" [0 0 1] \"point3 to\" [0 0 0]\n" GREY
               "Shape \"disk\"\n#@ Meter \"radiance\" \"point3 p\" [0.3 0 2] \"point3 to\" [0.1 0.1 0]\n");
}

/* ---- flux ---- */

static void flux(const struct row *row)
{
    static const struct {
        const char *scene;
        double n;
    } cases[] = {
        // 100 cd at the origin
        {"LightSource \"point\" \"float power\" 1256.6370614359172\n#@ Meter \"flux\" \"string shape\" \"sphere\" \"point3 p\" [3 0 0] \"float radius\" 1\n",
         65536},
        {"LightSource \"point\" \"float power\" 1256.6370614359172\n#@ Meter \"flux\" \"string shape\" \"disk\" \"point3 p\" [0 0 1] \"normal n\" [0 0 -1] \"float radius\" 2\n",
         8192},
        {"LightSource \"point\" \"float power\" 1256.6370614359172\n#@ Meter \"flux\" \"string shape\" \"sphere\" \"point3 p\" [0.3 0 0] \"float radius\" 1 \"string side\" \"net\"\n",
         8192},
        {"LightSource \"point\" \"float power\" 1256.6370614359172\n#@ Meter \"flux\" \"string shape\" \"sphere\" \"point3 p\" [0.3 0 0] \"float radius\" 1 \"string side\" \"back\"\n",
         8192},
        // a sky of 2 cd/m^2 onto a black ball of radius 0.5: pi L A
        {"LightSource \"infinite\" \"float scale\" 2\n" BLACK
         "#@ Name \"ball\"\nShape \"sphere\" \"float radius\" 0.5\n#@ Meter \"flux\" \"string surface\" \"ball\"\n",
         1024},
        // the same through both sides of a rectangle of 2 x 3 that is not there
        {"LightSource \"infinite\" \"float scale\" 2\n#@ Meter \"flux\" \"vector3 u\" [2 0 0] \"vector3 v\" [0 0 3] \"string side\" \"both\"\n",
         1024},
        // C1: opposed unit squares, gap 1; the glowing one is above. Named, of two triangles
        {GLOW_BOTH
         "Shape \"bilinearmesh\" \"point3 P\" [0 0 1 1 0 1 0 1 1 1 1 1]\nAreaLightSource \"none\"\n"
         "#@ Name \"floor\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer indices\" [0 1 2 0 2 3]\n#@ Meter \"flux\" \"string surface\" \"floor\"\n",
         16384},
        // onto the outside of a cylinder (radius 1, height 2) from a distant light square to its axis: E 2 r h
        {"LightSource \"distant\" \"float illuminance\" 5 \"point3 from\" [1 0 0] \"point3 to\" [0 0 0]\n" BLACK
         "#@ Name \"mast\"\nShape \"cylinder\" \"float radius\" 1 \"float zmin\" 0 \"float zmax\" 2\n#@ Meter \"flux\" \"string surface\" \"mast\"\n",
         16384},
    };
    char scene[1024];
    snprintf(scene, sizeof scene, "%s", cases[(int)row->a].scene);
    char *none = strstr(scene, "AreaLightSource \"none\"\n");
    if (none) { // the lamp alone glows
        char text[1024];
        snprintf(text, sizeof text, "AttributeBegin\n%.*sAttributeEnd\n%s", (int)(none - scene), scene,
                 none + strlen("AreaLightSource \"none\"\n"));
        snprintf(scene, sizeof scene, "%s", text);
    }
    read_meter(row, SR_PHOTOPIC, cases[(int)row->a].n, scene);
}

/* ---- systems ---- */

/* Irradiance of one wavelength band under a sky that is flat in wavelength: E_p / E_e is lambda / (h c N_A). */
static void photons(const struct row *row)
{
    struct world w =
        world_of("WorldBegin\nLightSource \"infinite\" \"spectrum L\" [360 1 830 1]\n#@ Meter \"irradiance\"\n");
    struct sr_measure_settings s = {
        .samples = (uint64_t)samples(2048) * REPLICATES, .replicates = REPLICATES, .system = SR_PHOTON};
    struct sr_arena arena = {0};
    struct sr_measurement m;
    struct sr_error error = {0};
    w.job.lambda = (struct sr_lambda_range){(float)row->a - 0.05f, (float)row->a + 0.05f};
    EXPECT_EQUAL_INT(sr_measure(&w.job, &w.scene.meters[0], &s, &arena, &m, &error), SR_OK);
    double ratio = m.value[SR_PHOTON].value / m.value[SR_RADIOMETRIC].value;
    double u = hypot(m.value[SR_PHOTON].u / m.value[SR_PHOTON].value,
                     m.value[SR_RADIOMETRIC].u / m.value[SR_RADIOMETRIC].value);
    check(row, "path", (struct estimate){ratio, ratio * u, REPLICATES - 1}, meter_goal);
    sr_arena_free(&arena);
    world_free(&w);
}

/* The spectrum of an illuminant through a sky: bins at 450 and 650 nm, their ratio that of illuminant A's formula. */
static void bins(const struct row *row)
{
    struct world w =
        world_of("WorldBegin\nLightSource \"infinite\" \"spectrum L\" \"stdillum-A\"\n#@ Meter \"irradiance\"\n");
    struct sr_measure_settings s = {
        .samples = (uint64_t)samples(16384) * REPLICATES, .replicates = REPLICATES, .system = SR_RADIOMETRIC};
    struct sr_arena arena = {0};
    struct sr_measurement m;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_spectrometer_prepare(450, 200, 650, 5, row->a == 0 ? SR_BAND_TRIANGULAR : SR_BAND_RECTANGULAR,
                                             &s.spectrometer, &error),
                     SR_OK);
    EXPECT_EQUAL_INT(sr_measure(&w.job, &w.scene.meters[0], &s, &arena, &m, &error), SR_OK);
    struct sr_quantity ratio = sr_quantity_ratio(&m.spectrum[1], &m.spectrum[0]);
    check(row, "path", (struct estimate){ratio.value, ratio.u, ratio.degrees}, 1e-2);
    sr_arena_free(&arena);
    world_free(&w);
}

#define CONE_A (25 * DEGREE)
static struct row meter_rows[] = {
    {"M1.irr", "point source", 0, of_point, IRRADIANCE, 0},
    {"M1.cyl", "", 0, of_point, CYLINDER, 0},
    {"M1.sc", "", 0, of_point, HALF_CYLINDER, 0},
    {"M1.hs", "", 0, of_point, HEMISPHERE, 0},
    {"M1.sph", "", 0, of_point, SPHERE, 0},
    {"M1.o", "", 0, of_point, FLUENCE, 0},
    {"M2.irr", "uniform sky", 3.14159265358979, of_sky, IRRADIANCE, 0},
    {"M2.cyl", "", 3.14159265358979, of_sky, CYLINDER, 0},
    {"M2.sc", "", 3.14159265358979, of_sky, HALF_CYLINDER, 0},
    {"M2.hs", "", 3.14159265358979, of_sky, HEMISPHERE, 0},
    {"M2.sph", "", 3.14159265358979, of_sky, SPHERE, 0},
    {"M2.o", "", 12.5663706143592, of_sky, FLUENCE, 0},
    {"M3.irr", "disk, all of them tilted", 0, of_disk, IRRADIANCE, 0},
    {"M3.cyl", "", 0, of_disk, CYLINDER, 0},
    {"M3.sc", "", 0, of_disk, HALF_CYLINDER, 0},
    {"M3.hs", "", 0, of_disk, HEMISPHERE, 0},
    {"M3.sph", "", 0, of_disk, SPHERE, 0},
    {"M3.o", "", 0, of_disk, FLUENCE, 0},
    // pi sin^2 a; a - sin a cos a twice; pi/2 (1 - cos a + sin^2 a / 2); pi/2 (1 - cos a); 2 pi (1 - cos a)
    {"M4.irr", "disk straight above", 0.561104, of_disk_above, IRRADIANCE, 0},
    {"M4.cyl", "", 0, of_disk_above, CYLINDER, 0},
    {"M4.sc", "", 0, of_disk_above, HALF_CYLINDER, 0},
    {"M4.hs", "", 0, of_disk_above, HEMISPHERE, 0},
    {"M4.sph", "", 0, of_disk_above, SPHERE, 0},
    {"M4.o", "", 0, of_disk_above, FLUENCE, 0},
    {"M5.12", "disk in a cone of acceptance", 0, cone, 12, 0},
    {"M5.40", "", 0, cone, 40, 0},
    {"M6", "ray onto a grey wall", 1.59154943091895, ray, 0, 0},
    {"M7.ball", "flux of a point onto a ball", 0, flux, 0, 0},
    {"M7.disk", "through a disk", 0, flux, 1, 0},
    {"M7.net", "net through a ball around it", -1256.6370614359172, flux, 2, 0},
    {"M7.back", "out of the ball", 1256.6370614359172, flux, 3, 0},
    {"M8.ball", "flux of a sky onto a ball", 19.7392088021787, flux, 4, 0},
    {"M8.both", "through both sides of a rectangle", 75.3982236861550, flux, 5, 0},
    {"M8.C1", "between opposed squares", 0.627768430, flux, 6, 0},
    {"M8.mast", "onto a cylinder", 20, flux, 7, 0},
    {"M9.450", "photons per joule [umol/J]", 3.76170888, photons, 450, 0},
    {"M9.700", "", 5.85154714, photons, 700, 0},
    {"M10.t", "spectrum of illuminant A", 0, bins, 0, 0},
    {"M10.r", "", 0, bins, 1, 0},
    {.id = NULL},
};

/* Illuminant A seen through a bandpass of 5 nm: it is bent enough for that to matter. */
static double illuminant_A(double middle, bool is_triangle)
{
    enum { N = 16 };
    double x[N], weight[N], sum = 0, norm = 0, reach = is_triangle ? 5 : 2.5;
    for (int half = 0; half < 2; ++half) {
        sr_gauss_legendre(N, middle + (half - 1) * reach, middle + half * reach, x, weight);
        for (int i = 0; i < N; ++i) {
            double b = weight[i] * (is_triangle ? 1 - fabs(x[i] - middle) / reach : 1);
            sum += b * pow(560 / x[i], 5) / expm1(1.435e7 / (2848 * x[i]));
            norm += b;
        }
    }
    return sum / norm;
}

TEST(meters_read_what_closed_forms_say)
{
    double a = CONE_A, C1 = 0.199824895698;
    for (struct row *r = meter_rows; r->id; ++r) {
        const double above[] = {pi * sin(a) * sin(a),  a - sin(a) * cos(a),
                                a - sin(a) * cos(a),   pi / 2 * (1 - cos(a) + sin(a) * sin(a) / 2),
                                pi / 2 * (1 - cos(a)), 2 * pi * (1 - cos(a))};
        if (r->measure == of_disk_above)
            r->value = above[(int)r->a];
        if (r->measure == flux && r->a == 0)
            r->value = 100 * 2 * pi * (1 - sqrt(1 - 1 / 9.));
        if (r->measure == flux && r->a == 1)
            r->value = 100 * 2 * pi * (1 - 1 / sqrt(5));
        if (r->measure == flux && r->a == 6)
            r->value = pi * C1;
        if (r->measure == photons)
            r->value = r->a * 1e-3 / (6.62607015e-34 * 299792458 * 6.02214076e23);
        if (r->measure == bins)
            r->value = illuminant_A(650, r->a == 0) / illuminant_A(450, r->a == 0);
    }
    run_rows("meters", meter_rows);
}
