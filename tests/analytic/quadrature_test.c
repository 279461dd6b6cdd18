/* SPDX-License-Identifier: MIT */
/* Cubature against closed forms, and its bound against the true error; one reflection against path tracing. */
#include "analytic/analytic.h"

#define DARK_DISK BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 2 \"float radius\" 1\n"
#define AT_ORIGIN "#@ Meter \"irradiance\" \"point3 p\" [0 0 0] \"normal n\" [0 0 1]\n"
#define FINE 2e-6 // tolerance
#define PLATE "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0 -1 1 0 1 1 0]\n"
#define TO_PLATE "#@ Meter \"radiance\" \"point3 p\" [-0.5 0 0.5] \"point3 to\" [0 0 0]\n"

static sr_status read_first(struct world *w, const struct sr_measure_settings *settings, struct sr_measurement *m,
                            struct sr_error *error)
{
    struct sr_arena arena = {0};
    EXPECT_EQUAL_INT(w->scene.meter_count, 1);
    sr_status status = sr_measure(&w->job, &w->scene.meters[0], settings, &arena, m, error);
    sr_arena_free(&arena);
    return status;
}

static struct sr_quantity by_quadrature(enum sr_system system, int depth, double tolerance, const char *scene)
{
    struct world w =
        world_of("Integrator \"quadrature\" \"integer maxdepth\" %d \"float tolerance\" %g\nWorldBegin\n%s", depth,
                 tolerance, scene);
    struct sr_measure_settings s = {.system = SR_PHOTOPIC};
    struct sr_measurement m = {.remark_count = 0};
    struct sr_error error = {0};
    if (read_first(&w, &s, &m, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    world_free(&w);
    return m.value[system];
}

/* ---- closed forms ---- */

struct known {
    const char *id, *scene;
    double value;
    int depth;
};

static const struct known closed_forms[] = {
    // values and sources as in validation/cases.tsv
    {"A1: point", "LightSource \"point\" \"point3 from\" [0 0 2] \"float power\" 1000\n" AT_ORIGIN, 19.8943678864869,
     0},
    {"A2: point", "LightSource \"point\" \"point3 from\" [-4 0 3] \"float power\" 1000\n" AT_ORIGIN, 1.90985931710274,
     0},
    {"A3: distant",
     "LightSource \"distant\" \"float illuminance\" 1000 \"point3 from\" [0.866025404 0 0.5] \"point3 to\" [0 0 0]\n" AT_ORIGIN,
     500, 0},
    {"B1: disk", DARK_DISK AT_ORIGIN, 0.628318530717959, 0},
    {"B2: disk", DARK_DISK "#@ Meter \"irradiance\" \"point3 p\" [1.5 0 0] \"normal n\" [0 0 1]\n", 0.321335102751701,
     0},
    {"B4: disk", DARK_DISK "#@ Meter \"irradiance\" \"point3 p\" [1.5 0 0] \"normal n\" [-0.573576436 0 0.819152044]\n",
     0.381493863440674, 0},
    {"B5: sphere",
     BLACK GLOW
     "AttributeBegin Translate 1.92836283 0 2.29813333 Shape \"sphere\" \"float radius\" 1 AttributeEnd\n" AT_ORIGIN,
     0.267399954980652, 0},
    {"B6.90: half a sphere",
     BLACK GLOW "AttributeBegin Translate 2 0 0 Shape \"sphere\" \"float radius\" 1 AttributeEnd\n" AT_ORIGIN,
     0.0905860737060797, 0},
    {"B7: rectangle",
     BLACK GLOW "ReverseOrientation Shape \"bilinearmesh\" \"point3 P\" [0 0 1 2 0 1 0 1 1 2 1 1]\n" AT_ORIGIN,
     0.525824101541547, 0},
    {"B8: rectangle",
     BLACK GLOW
     "ReverseOrientation Shape \"bilinearmesh\" \"point3 P\" [-0.5 -0.5 1 0.5 -0.5 1 -0.5 0.5 1 0.5 0.5 1]\n" AT_ORIGIN,
     0.752274688454107, 0},
    {"B10: triangle",
     BLACK GLOW_BOTH
     "Shape \"trianglemesh\" \"point3 P\" [1 0 1 -1 2 1.5 -1 -1 2] \"integer indices\" [0 1 2]\n" AT_ORIGIN,
     0.875254739837253, 0},
    {"B12.0: sky", "LightSource \"infinite\" \"float scale\" 1\n" AT_ORIGIN, 3.14159265358979, 0},
    {"a sum of two",
     "LightSource \"infinite\" \"float scale\" 1\nLightSource \"point\" \"point3 from\" [0 0 2] \"float power\" 1000\n" AT_ORIGIN,
     3.14159265358979 + 19.8943678864869, 0},
    {"a ray", DARK_DISK "#@ Meter \"radiance\" \"point3 p\" [0 0 0] \"vector3 d\" [0 0 1]\n", 1, 0},
    {"a grey plate below a disk: rho E / pi", GREY PLATE DARK_DISK TO_PLATE, 0.5 * 0.628318530717959 / 3.14159265358979,
     1},
    {"a grey plate below the sky", GREY PLATE "LightSource \"infinite\" \"float scale\" 1\n" TO_PLATE, 0.5, 1},
    {"a plate that lets half through, sky on both sides",
     "Material \"diffusetransmission\" \"spectrum reflectance\" [360 0.25 830 0.25] \"spectrum transmittance\" [360 0.5 830 0.5]\n" PLATE
     "LightSource \"infinite\" \"float scale\" 1\n" TO_PLATE,
     0.75, 1},
};

TEST(quadrature_meets_closed_forms_and_bounds_its_error)
{
    printf("  cubature: relative error, standard uncertainty\n");
    for (size_t i = 0; i < sizeof closed_forms / sizeof *closed_forms; ++i) {
        const struct known *k = &closed_forms[i];
        struct sr_quantity q = by_quadrature(SR_PHOTOPIC, k->depth, FINE, k->scene);
        printf("    %-52s %9.1e %9.1e\n", k->id, q.value / k->value - 1, q.u / k->value);
        EXPECT_RELATIVE(q.value, k->value, FLOAT_GOAL);
        EXPECT_NEAR(q.value, k->value, 2 * q.u);
        EXPECT(q.u <= FLOAT_GOAL * k->value);
        EXPECT(isinf(q.degrees));
    }
}

static const struct known edged[] = {
    // 1/pi INTEGRAL sin^2 theta dtheta dphi from the disk's edge on: pi less alpha - sin alpha cos alpha, tan alpha =
    // 1/2
    {"a cylinder below a black disk",
     "LightSource \"infinite\" \"float scale\" 1\n" BLACK
     "Shape \"disk\" \"float height\" 2 \"float radius\" 1\n#@ Meter \"cylindrical\" \"vector3 axis\" [0 0 1]\n",
     3.14159265358979 - (0.463647609000806 - 0.4), 0},
    {"a cone within a disk",
     DARK_DISK "#@ Meter \"radiance\" \"point3 p\" [0 0 0] \"vector3 d\" [0 0 1] \"float halfangle\" 20\n", 1, 0},
    {"a disk within a cone: its solid angle over the cone's",
     DARK_DISK "#@ Meter \"radiance\" \"point3 p\" [0 0 0] \"vector3 d\" [0 0 1] \"float halfangle\" 60\n",
     2 * (1 - 0.894427190999916), 0},
};

/* Where the integrand has an edge the bound must widen, and hold. */
TEST(quadrature_bounds_what_edges_leave)
{
    printf("  with edges: relative error, standard uncertainty\n");
    for (size_t i = 0; i < sizeof edged / sizeof *edged; ++i) {
        const struct known *k = &edged[i];
        struct sr_quantity q = by_quadrature(SR_PHOTOPIC, k->depth, 1e-3, k->scene);
        printf("    %-52s %9.1e %9.1e\n", k->id, q.value / k->value - 1, q.u / k->value);
        EXPECT_NEAR(q.value, k->value, 2 * q.u);
        EXPECT(q.u < 3e-3 * k->value);
    }
}

/* ---- another way ---- */

static const char glossy[] = "Material \"conductor\" \"float roughness\" 0.3\n" PLATE BLACK GLOW
                             "AttributeBegin Translate 0.4 0.1 0.8 Shape \"sphere\" \"float radius\" 0.2 AttributeEnd\n"
                             "LightSource \"point\" \"point3 from\" [1 1 1] \"float power\" 2\n" TO_PLATE;

TEST(quadrature_agrees_with_path_tracing_on_a_glossy_plate)
{
    struct world w = world_of("Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\n%s", glossy);
    struct sr_measure_settings s = {
        .samples = (uint64_t)samples(8192) * REPLICATES, .replicates = REPLICATES, .system = SR_PHOTOPIC};
    struct sr_measurement m;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(read_first(&w, &s, &m, &error), SR_OK);
    static const enum sr_system systems[] = {SR_PHOTOPIC,
                                             SR_RADIOMETRIC}; // the latter sees the ends of the wavelengths
    for (int i = 0; i < 2; ++i) {
        struct sr_quantity q = by_quadrature(systems[i], 1, FINE, glossy);
        const struct sr_quantity *p = &m.value[systems[i]];
        double z = z_of((struct estimate){p->value, hypot(p->u, q.u), p->degrees}, q.value);
        printf("  cubature %.7g, path %.7g, relative error %.1e, z = %.2f\n", q.value, p->value, p->u / p->value, z);
        EXPECT(fabs(z) < 4.9);
        EXPECT(p->u < 2e-3 * p->value && q.u <= 1e-5 * q.value);
    }
    world_free(&w);
}

/* ---- what it refuses ---- */

static const struct {
    const char *scene, *why;
    int depth;
} refused[] = {
    {DARK_DISK AT_ORIGIN, "reflected", 1},
    {GREY PLATE DARK_DISK TO_PLATE, "more than once", 2},
    {"Material \"conductor\" \"float roughness\" 0\n" PLATE DARK_DISK TO_PLATE, "mirror", 1},
    {DARK_DISK "#@ Meter \"flux\" \"vector3 u\" [1 0 0] \"vector3 v\" [0 1 0]\n", "area", 0},
};

TEST(quadrature_refuses_what_has_more_dimensions)
{
    for (size_t i = 0; i < sizeof refused / sizeof *refused; ++i) {
        struct world w = world_of("Integrator \"quadrature\" \"integer maxdepth\" %d\nWorldBegin\n%s", refused[i].depth,
                                  refused[i].scene);
        struct sr_measure_settings s = {.system = SR_PHOTOPIC};
        struct sr_measurement m;
        struct sr_error error = {0};
        EXPECT(read_first(&w, &s, &m, &error) == SR_ERROR_USAGE);
        if (!strstr(error.text, refused[i].why) || !strstr(error.text, "use path"))
            test_fail(__FILE__, __LINE__, "\"%s\" does not tell of \"%s\"", error.text, refused[i].why);
        struct sr_film *film;
        struct sr_render_report report;
        error = (struct sr_error){0};
        EXPECT(sr_render(&w.job, &film, &report, &error) == SR_ERROR_USAGE && !film);
        world_free(&w);
    }
}
