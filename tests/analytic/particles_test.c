/* SPDX-License-Identifier: MIT */
/* Particles of light: where the power of a scene goes, and the far field of luminaires, against closed forms; and
 * meters that paths from the lights are joined to. |z| < 4.9 of 16 replicates, relative standard errors of at most 1 %
 * (but in slow builds, which draw few samples). */
#include "analytic/analytic.h"

#define WORLD                                                                                                          \
    "LookAt 0 0 -3  0 0 0  0 1 0 Camera \"perspective\" Film \"rgb\" \"string filename\" \"a.exr\" Integrator \"path\" \"integer maxdepth\" 100\nWorldBegin\n"
static const double pi = 3.14159265358979323846;

static void expect(const char *what, const struct sr_quantity *q, double value)
{
    double z = q->u > 0 ? fabs(q->value - value) / q->u : 0;
    printf("  %-44s %.6g +- %.2g, known %.6g, z %.2f\n", what, q->value, q->u, value, z);
    EXPECT(q->u <= 0.01 * fmax(fabs(value), fabs(q->value)) || value == 0 || is_slow_build());
    EXPECT(fabs(q->value - value) < 4.9 * q->u + 2e-5 * fabs(value) ||
           (z < 8 && sr_student_p_two_sided(z, q->degrees) > 1e-6));
}

static struct sr_balance balance_of(const struct world *w, struct sr_arena *arena, double n)
{
    struct sr_measure_settings s = {.samples = 16 * samples(n / 16)};
    struct sr_balance b;
    struct sr_error error = {0};
    if (sr_measure_balance(&w->job, &s, arena, &b, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    EXPECT_EQUAL_INT(b.dropped, 0);
    return b;
}

// a closed uniform enclosure absorbs all that it emits, each wall by its area
TEST(a_closed_box_absorbs_what_it_emits)
{
    struct world w = world_of(
        WORLD
        "Material \"diffuse\" \"spectrum reflectance\" [360 .8 830 .8]\nReverseOrientation AreaLightSource \"diffuse\" \"float power\" 60\n"
        "Shape \"sphere\" \"float radius\" 2\n");
    struct sr_arena arena = {0};
    struct sr_balance b = balance_of(&w, &arena, 40000);
    expect("D1: emitted", &b.emitted[0], 60);
    expect("D1: absorbed", &b.absorbed[0], 60);
    expect("D1: escaped", &b.escaped[0], 0);
    EXPECT(b.escaped[0].value == 0 && b.given_up[0].value == 0);
    expect("D1: closure", &b.closure[0], 0);
    expect("D1: closure of watts", &b.closure[1], 0);
    sr_arena_free(&arena);
    world_free(&w);
}

/* A sphere with a port of the share f of its area, a small lamp within: of light that has met the wall once, each
 * bounce meets the wall with 1 - f and the port with f, so that escaped = rho f / (1 - rho (1 - f)) of what the wall
 * receives first. */
TEST(an_integrating_sphere_lets_the_known_share_escape)
{
    const double rho = 0.9, f = 0.02, cos_port = 1 - 2 * f;
    struct world w = world_of(
        WORLD
        "AttributeBegin Material \"diffuse\" \"spectrum reflectance\" [360 %g 830 %g]\n"
        "Shape \"sphere\" \"float radius\" 1 \"float zmax\" %.9g AttributeEnd\n"
        "LightSource \"spot\" \"float power\" 100 \"point3 from\" [0 0 0] \"point3 to\" [0 0 -1] \"float coneangle\" 60\n",
        rho, rho, cos_port);
    struct sr_arena arena = {0};
    struct sr_balance b = balance_of(&w, &arena, 60000);
    double escaped = 100 * rho * f / (1 - rho * (1 - f));
    expect("D2: escaped through the port", &b.escaped[0], escaped);
    expect("D2: absorbed by the wall", &b.absorbed[0], 100 - escaped);
    expect("D2: the wall alone", &b.by_material[0][0], 100 - escaped);
    expect("D2: closure", &b.closure[0], 0);
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(clear_glass_absorbs_nothing_and_black_all_of_the_rest)
{
    struct world w = world_of(
        WORLD
        "LightSource \"point\" \"float power\" 50 \"point3 from\" [0 0 2]\n"
        "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\" Shape \"sphere\" \"float radius\" 1\n"
        "Material \"dielectric\" \"float eta\" 1.5 \"float roughness\" 0 AttributeBegin Translate 0 0 3.5 Shape \"sphere\" \"float radius\" 1 AttributeEnd\n" BLACK
        "AttributeBegin Translate 0 0 -1.5 Shape \"disk\" \"float radius\" 100 AttributeEnd\n");
    struct sr_arena arena = {0};
    struct sr_balance b = balance_of(&w, &arena, 60000);
    expect("glass: closure", &b.closure[0], 0);
    EXPECT(fabs(b.by_material[0][0].value) < 1e-4 * 50 && fabs(b.by_material[1][0].value) < 1e-4 * 50);
    expect("glass: black takes what does not escape", &b.by_material[2][0], b.emitted[0].value - b.escaped[0].value);
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(an_open_scene_under_a_sky_balances)
{
    struct world w =
        world_of(WORLD "LightSource \"infinite\" \"float scale\" 2\n" GREY "Shape \"sphere\" \"float radius\" 1\n");
    struct sr_arena arena = {0};
    struct sr_balance b = balance_of(&w, &arena, 60000);
    // the sphere around the box of a sphere has the radius sqrt(3); a convex body of area A receives pi L A and returns
    // half
    expect("sky: what enters the scene", &b.emitted[0], 4 * pi * pi * 3 * 2);
    expect("sky: absorbed by a grey ball", &b.absorbed[0], 0.5 * pi * 2 * 4 * pi);
    expect("sky: closure", &b.closure[0], 0);
    sr_arena_free(&arena);
    world_free(&w);
}

/* ---- far field ---- */

static struct sr_intensity_table table_of(const struct world *w, struct sr_arena *arena, double n)
{
    struct sr_measure_settings s = {.samples = 16 * samples(n / 16), .system = SR_PHOTOPIC};
    struct sr_intensity_table t;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(w->scene.meter_count, 1);
    if (sr_measure_intensity(&w->job, &w->scene.meters[0], &s, arena, &t, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return t;
}

// mean over a cell of an intensity that depends on gamma alone
static double cell_mean(double (*I)(double cosine), double gamma, double step)
{
    double lo = fmax(0, gamma - step / 2) * pi / 180, hi = fmin(180, gamma + step / 2) * pi / 180, sum = 0;
    enum { N = 200 };
    for (int i = 0; i < N; ++i) {
        double z = cos(hi) + (i + 0.5) / N * (cos(lo) - cos(hi));
        sum += I(z) / N;
    }
    return sum;
}

static void expect_table(const char *what, const struct sr_intensity_table *t, double (*I)(double))
{
    double chi2 = 0, worst = 0;
    int cells = 0;
    for (uint32_t g = 0; g < t->gamma_count; ++g) {
        double known = cell_mean(I, (double)t->gamma[g], 180.0 / (t->gamma_count - 1));
        for (uint32_t c = 0; c < t->c_count; ++c) {
            size_t i = (size_t)c * t->gamma_count + g;
            if (c > 0 && (g == 0 || g == t->gamma_count - 1)) {
                EXPECT(t->I[i] == t->I[g]); // the pole is the same in all planes
                continue;
            }
            double off = fabs((double)t->I[i] - known);
            if (off <= 2e-5 * known)
                continue;
            EXPECT(t->u[i] > 0);
            double p = sr_student_p_two_sided(off / (double)t->u[i], 15), z = -sr_normal_quantile(fmax(p / 2, 1e-300));
            worst = fmax(worst, z);
            chi2 += z * z;
            ++cells;
        }
    }
    printf("  %-28s I(0) = %.4g +- %.1g, %d cells: worst |z| %.2f, chi2 p %.3g\n", what, (double)t->I[0],
           (double)t->u[0], cells, worst, sr_chi2_p(chi2, cells));
    EXPECT(worst < 5.5 && sr_chi2_p(chi2, cells) > 1e-6);
}

static double lambertian(double z) // 100 lm
{
    return z > 0 ? 100 / pi * z : 0;
}
static double spot(double z) // cone 60 deg, rim 30 deg: as light/spot.c says
{
    double lo = 0.5, hi = cos(pi / 6), t = z >= hi ? 1 : z <= lo ? 0 : (z - lo) / (hi - lo);
    return 10 * t * t * (3 - 2 * t);
}
static double even(double z) // 100 lm
{
    (void)z;
    return 100 / (4 * pi);
}

TEST(a_lambertian_lamp_of_hundred_lumens_has_31_83_cd_on_axis)
{
#define METER "#@ Meter \"intensity\" \"float cstep\" 45 \"float gammastep\" 10\n"
    struct sr_arena arena = {0};
    struct world w = world_of(WORLD METER "AttributeBegin AreaLightSource \"diffuse\" \"float power\" 100\n" BLACK
                                          "Rotate 180 1 0 0 Shape \"disk\" \"float radius\" .5 AttributeEnd\n");
    struct sr_intensity_table t = table_of(&w, &arena, 200000);
    expect_table("Lambertian disk", &t, lambertian);
    expect("Lambertian disk: flux", &t.flux, 100);
    world_free(&w);

    w = world_of(
        WORLD METER
        "LightSource \"spot\" \"float scale\" 10 \"float coneangle\" 60 \"float conedeltaangle\" 30 \"point3 from\" [0 0 1] \"point3 to\" [0 0 -1]\n");
    t = table_of(&w, &arena, 200000);
    expect_table("spot", &t, spot);
    world_free(&w);

    w = world_of(
        WORLD METER
        "LightSource \"point\" \"float power\" 100\nMaterial \"thindielectric\" \"float eta\" 1 Shape \"sphere\" \"float radius\" 1\n");
    t = table_of(&w, &arena, 200000);
    expect_table("point in a shell of air", &t, even);
    world_free(&w);

    // a perfect diffuser under a point throws half of its light back up
    w = world_of(
        WORLD METER
        "LightSource \"point\" \"float power\" 100 \"point3 from\" [0 0 .001]\nMaterial \"diffuse\" \"spectrum reflectance\" [360 1 830 1] Shape \"disk\" \"float radius\" 50\n");
    t = table_of(&w, &arena, 200000);
    expect("point over white: flux", &t.flux, 100);
    double up = 0;
    for (uint32_t c = 0; c < t.c_count; ++c)
        up += (double)t.I[(size_t)c * t.gamma_count + 12] / t.c_count; // gamma 120: 50/pi cos 60 deg + 100/(4 pi)
    printf("  point over white: I(120) = %.3f cd\n", up);
    EXPECT_NEAR(up, 50 / pi * cos(pi / 3) + 100 / (4 * pi), 0.25);
    world_free(&w);
    sr_arena_free(&arena);
}

TEST(skies_are_no_luminaires)
{
    struct sr_arena arena = {0};
    struct world w = world_of(WORLD METER "LightSource \"infinite\" \"float scale\" 2\n" GREY
                                          "Shape \"sphere\" \"float radius\" 1\n");
    struct sr_measure_settings s = {.samples = 1600, .system = SR_PHOTOPIC};
    struct sr_intensity_table t;
    struct sr_error error = {0};
    EXPECT(sr_measure_intensity(&w.job, &w.scene.meters[0], &s, &arena, &t, &error) == SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "light from outside"));
    world_free(&w);
    sr_arena_free(&arena);
}

/* ---- meters of paths from both ends ---- */

TEST(meters_read_the_same_by_paths_from_the_lights)
{
    static const char *const meters[] = {
        "\"irradiance\" \"point3 p\" [.3 -.999 .2] \"normal n\" [0 1 0]",
        "\"cylindrical\" \"point3 p\" [.3 0 .2] \"vector3 axis\" [0 1 0]",
        "\"spherical\" \"point3 p\" [.3 0 .2]",
        "\"flux\" \"point3 p\" [-.5 -.99 -.5] \"vector3 u\" [0 0 1] \"vector3 v\" [1 0 0]",
    };
    for (size_t i = 0; i < sizeof meters / sizeof *meters; ++i) {
        struct world w = world_of(
            "LookAt 0 0 -3  0 0 0  0 1 0 Camera \"perspective\" Film \"rgb\" \"string filename\" \"a.exr\" Integrator \"path\" \"integer maxdepth\" 6\nWorldBegin\n#@ Meter %s\n"
            "Material \"diffuse\" \"spectrum reflectance\" [360 .6 830 .6]\n"
            "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 -1  1 -1 -1  -1 -1 1  1 -1 1]\nShape \"bilinearmesh\" \"point3 P\" [-1 1 -1  1 1 -1  -1 1 1  1 1 1]\n"
            "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 1  1 -1 1  -1 1 1  1 1 1]\n"
            "AttributeBegin AreaLightSource \"diffuse\" \"float power\" 50 Shape \"bilinearmesh\" \"point3 P\" [-.3 .9 -.3  .3 .9 -.3  -.3 .9 .3  .3 .9 .3] AttributeEnd\n"
            "LightSource \"point\" \"point3 from\" [-.6 .2 -.5] \"float power\" 20\n",
            meters[i]);
        static const char *const names[] = {"path", "lightpath", "bdpt"};
        struct sr_quantity by[3];
        struct sr_arena arena = {0};
        for (int k = 0; k < 3; ++k) {
            struct sr_measure_settings s = {.samples = 16 * samples(k == 2 ? 400 : 1600),
                                            .replicates = 16,
                                            .system = SR_PHOTOPIC,
                                            .stream = (uint32_t)k};
            struct sr_measurement m;
            struct sr_error error = {0};
            struct sr_render_job job = w.job;
            int32_t self[64] = {0};
            self[0] = 6; // maxdepth is the first of all three
            EXPECT(w.job.integrator.model->params[0].offset == 0);
            job.integrator = (struct sr_integrator){sr_integrator_model_find(names[k]), self};
            EXPECT(job.integrator.model->params[0].offset == 0 &&
                   strcmp(job.integrator.model->params[0].name, "maxdepth") == 0);
            if (sr_measure(&job, &w.scene.meters[0], &s, &arena, &m, &error) != SR_OK)
                test_fail(__FILE__, __LINE__, "%s", error.text);
            by[k] = m.value[SR_PHOTOPIC];
        }
        for (int k = 1; k < 3; ++k) {
            struct sr_quantity difference = by[k];
            difference.u = hypot(by[k].u, by[0].u);
            difference.degrees = 15;
            char what[96];
            snprintf(what, sizeof what, "%.18s by %s", meters[i], names[k]);
            expect(what, &difference, by[0].value);
        }
        sr_arena_free(&arena);
        world_free(&w);
    }
}
