/* SPDX-License-Identifier: MIT */
/* Participating media whose light is known: absorbers, single scattering, half-spaces and slabs with all orders of
 * scattering, the infinite medium, glowing spheres; and two laws that hold whatever the medium: the furnace, and the
 * mean length of paths.
 *
 * What depends on single-scattering albedo alone is measured in a medium of another density at each wavelength, too. */
#include "analytic/analytic.h"

static const double pi = 3.14159265358979323846;

/* ---- scenes ---- */

/* A medium: albedo, and sigma_t at the observer's two ends [1/m]. */
struct matter {
    double albedo, red, violet;
};
static const struct matter grey = {.red = 1, .violet = 1}, coloured = {.red = 0.6, .violet = 3};

static const char *medium_text(struct matter m)
{
    static char text[512];
    snprintf(
        text, sizeof text,
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 %.9g 830 %.9g] \"spectrum sigma_s\" [360 %.9g 830 %.9g]\n",
        (1 - m.albedo) * m.violet, (1 - m.albedo) * m.red, m.albedo * m.violet, m.albedo * m.red);
    return text;
}

#define PLANE(z)                                                                                                       \
    "Shape \"trianglemesh\" \"point3 P\" [-4000 -4000 " z " 4000 -4000 " z " 4000 4000 " z " -4000 4000 " z            \
    "] \"integer indices\" [0 1 2 0 2 3]\n"
#define SURFACE "Material \"interface\" MediumInterface \"m\" \"\" " PLANE("0")
#define BOTTOM "Material \"interface\" MediumInterface \"\" \"m\" " PLANE("-1")
#define SKY "LightSource \"infinite\" \"float scale\" 1\n"
#define FLOOR "MediumInterface \"\" \"\" " BLACK PLANE("-3")

static const char *sun_text(double mu)
{
    static char text[256];
    snprintf(text, sizeof text,
             "LightSource \"distant\" \"float illuminance\" 1 \"point3 from\" [%.9g 0 %.9g] \"point3 to\" [0 0 0]\n",
             sqrt(1 - mu * mu), mu);
    return text;
}

static struct world scene_of(const char *integrator, int depth, struct matter m, const char *content)
{
    return world_of("Integrator \"%s\" \"integer maxdepth\" %d\nWorldBegin\n%s%s", integrator, depth, medium_text(m),
                    content);
}

/* One ray, seen under mu from z = 1, or from z = -2 looking up (mu < 0); or diffusely where mu is 0. */
struct look {
    double mu;
    bool is_below;
};

static struct drawn look(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)v;
    const struct look *l = context;
    float s = sqrtf(1 - (float)(l->mu * l->mu));
    sr_vec3 d = l->mu > 0 ? (sr_vec3){0, s, (float)l->mu} : sr_warp_cosine_hemisphere(u);
    d.z = l->is_below ? d.z : -d.z;
    return (struct drawn){{0.3f, 0.2f, l->is_below ? -2 : 1}, d, 1};
}

static struct estimate seen(struct world *w, double mu, bool is_below, double n)
{
    struct look l = {mu, is_below};
    struct estimate e = mean_luminance(&w->job, look, &l, n);
    world_free(w);
    return e;
}

/* Reads the scene's meter. */
static struct estimate metered(struct world *w, double n)
{
    struct sr_measure_settings s = {
        .samples = (uint64_t)samples(n) * REPLICATES, .replicates = REPLICATES, .system = SR_PHOTOPIC};
    struct sr_arena arena = {0};
    struct sr_measurement m;
    struct sr_error error = {0};
    if (w->scene.meter_count != 1 || sr_measure(&w->job, &w->scene.meters[0], &s, &arena, &m, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "no reading: %s", error.text);
    struct estimate e = {m.value[SR_PHOTOPIC].value, m.value[SR_PHOTOPIC].u, m.value[SR_PHOTOPIC].degrees};
    sr_arena_free(&arena);
    world_free(w);
    return e;
}

/* ---- rows ---- */

#define LAMP "AreaLightSource \"diffuse\" \"float scale\" 1 \"bool twosided\" true Material \"diffuse\" "

/* A lamp behind 2.5 m of fog of 0.7 / m, in which the camera stands, too; and through a box of it. */
static void transmittance(const struct row *row)
{
    static const char *const fog =
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nMediumInterface \"\" \"m\"\nLookAt 0 0 0 0 0 1 0 1 0 "
        "Camera \"perspective\" \"float fov\" 0.01\n";
    static const char *const ways[] = {"absorber", "scatterer", "twin", "box"};
    for (int i = 0; i < 4; ++i) {
        struct matter m = {i == 1 ? 0.8 : i == 2 ? 0.5 : 0, i == 3 ? 1.75 : 0.7, i == 3 ? 1.75 : 0.7};
        struct world w;
        if (i < 3)
            w = world_of("%s%sIntegrator \"%s\" \"integer maxdepth\" 0\nWorldBegin\n" LAMP
                         "Translate 0 0 2.5 Shape \"disk\"\n",
                         medium_text(m), fog, i == 2 ? "simplevolpath" : "volpath");
        else
            w = scene_of("volpath", 0, m, SURFACE BOTTOM "MediumInterface \"\" \"\" " LAMP PLANE("-2.5"));
        struct estimate e =
            i < 3 ? pixel_mean(&w.job, 0, 0, i ? 2048 : 1024, (const double[]){0, 1, 0}) : seen(&w, 1, false, 1024);
        if (i < 3)
            world_free(&w);
        check(row, ways[i], e, i == 1 ? 1e-3 : i == 2 ? 3e-2 : GOAL);
    }
}

static void point_in_absorber(const struct row *row)
{
    static const char *const around[] = {
        "", "Material \"interface\" MediumInterface \"m\" \"\" Shape \"sphere\" \"float radius\" 5\n"};
    for (int i = 0; i < 2; ++i) {
        struct world w = world_of(
            "%s%s\nCamera \"perspective\"\nIntegrator \"volpath\"\nWorldBegin\nLightSource \"point\" \"float power\" 125.663706144\n%s"
            "#@ Meter \"irradiance\" \"string name\" \"E\" \"point3 p\" [0 0 2] \"normal n\" [0 0 -1]\n",
            medium_text((struct matter){0, 0.3, 0.3}), i ? "" : "MediumInterface \"m\"", around[i]);
        check(row, i ? "ball" : "fog", metered(&w, 1024), GOAL);
    }
}

/* a: mu, negative where the light is transmitted. */
static void single_scattering(const struct row *row)
{
    char content[1024];
    snprintf(content, sizeof content, "%s%s", sun_text(0.6), SURFACE BOTTOM);
    struct world w = scene_of("volpath", 1, (struct matter){0.8, 1, 1}, content);
    check(row, "volpath", seen(&w, fabs(row->a), row->a < 0, 16384), 1e-3);
}

static struct matter of_albedo(struct matter m, double albedo)
{
    m.albedo = albedo;
    return m;
}

/* a: albedo, b: mu of the sun and of the eye. L = a / (8 pi) H^2. */
static void chandrasekhar(const struct row *row)
{
    char content[1024];
    snprintf(content, sizeof content, "%s%s", sun_text(row->b), SURFACE);
    for (int i = 0; i < 2; ++i) {
        struct world w = scene_of("volpath", 100000, of_albedo(i ? coloured : grey, row->a), content);
        struct estimate L = seen(&w, row->b, false, 1024);
        double H = sqrt(8 * pi * L.mean / row->a);
        check(row, i ? "coloured" : "grey", (struct estimate){H, H / 2 * L.error / L.mean, L.degrees}, 4e-3);
    }
}

/* a: albedo, b: mu, 0: diffuse. What a half-space reflects of light from mu, it sends to mu of an even sky's. */
static void half_space(const struct row *row)
{
    static const char *const ways[] = {"grey", "coloured", "twin"};
    for (int i = 0; i < (row->b > 0 || row->a > 0.9 ? 2 : 3); ++i) {
        struct world w = scene_of(i == 2 ? "simplevolpath" : "volpath", 100000,
                                  of_albedo(i == 1 ? coloured : grey, row->a), SURFACE SKY);
        check(row, ways[i], seen(&w, row->b, false, 1024), i == 2 ? 3e-2 : 1.6e-2);
    }
}

/* a: albedo (negative: transmitted, with what comes straight through), b: mu, 0: diffuse. */
static void slab(const struct row *row)
{
    static const char *const ways[] = {"volpath", "twin"};
    for (int i = 0; i < (row->b > 0 ? 1 : 2); ++i) {
        struct world w =
            scene_of(i ? "simplevolpath" : "volpath", 100000, of_albedo(grey, fabs(row->a)), SURFACE BOTTOM FLOOR SKY);
        check(row, ways[i], seen(&w, row->b, row->a < 0, 1024), 1.2e-2);
    }
}

static void absorbing_slab(const struct row *row)
{
    struct world w = scene_of("volpath", 1, grey, SURFACE BOTTOM FLOOR SKY);
    check(row, "rays", seen(&w, 0, true, 1024), GOAL);
    w = scene_of("volpath", 1, grey,
                 SURFACE BOTTOM FLOOR SKY
                 "#@ Meter \"irradiance\" \"string name\" \"E\" \"point3 p\" [0 0 -2] \"normal n\" [0 0 1]\n");
    check(row, "meter", scaled(metered(&w, 1024), 1 / pi), GOAL);
}

static void point_in_infinite_medium(const struct row *row)
{
    struct world w = world_of(
        "%sMediumInterface \"m\"\nCamera \"perspective\"\nIntegrator \"volpath\" \"integer maxdepth\" 100000\nWorldBegin\n"
        "LightSource \"point\" \"float power\" 1\n#@ Meter \"fluence\" \"string name\" \"E\" \"point3 p\" [0 0 1]\n",
        medium_text((struct matter){0.9, 1, 1}));
    check(row, "meter", metered(&w, 2048), 5e-2); // near the source, light falls off as 1/r^2: the tail is heavy
}

/* ---- glowing spheres, and the mean length of paths ---- */

/* Onto a body from outside, evenly over its surface and by the cosine: the unit sphere, or the unit cube. */
static struct drawn onto(const void *context, sr_vec2 u, sr_vec2 v)
{
    bool is_cube = *(const bool *)context;
    sr_vec3 n = sr_warp_uniform_sphere(v), p = sr_scale(1.000001f, n), d = sr_warp_cosine_hemisphere(u);
    if (is_cube) {
        int side = (int)(v.x * 6);
        float a = v.x * 6 - (float)side - 0.5f, b = v.y - 0.5f, c = side & 1 ? 0.500001f : -0.500001f;
        p = side < 2 ? (sr_vec3){c, a, b} : side < 4 ? (sr_vec3){b, c, a} : (sr_vec3){a, b, c};
        n = side < 2 ? (sr_vec3){c, 0, 0} : side < 4 ? (sr_vec3){0, c, 0} : (sr_vec3){0, 0, c};
        n = sr_normalize(n);
    }
    struct sr_frame frame = sr_frame_from_z(sr_neg(n));
    return (struct drawn){p, sr_to_world(&frame, d), 1};
}

static const char unit_cube[] =
    "Shape \"bilinearmesh\" \"point3 P\" [-.5 -.5 -.5 .5 -.5 -.5 -.5 .5 -.5 .5 .5 -.5 -.5 -.5 .5 .5 -.5 .5 -.5 .5 .5 .5 .5 .5] "
    "\"integer indices\" [2 3 0 1 4 5 6 7 0 1 4 5 6 7 2 3 4 6 0 2 1 3 5 7]\n";

static struct estimate glow_of(bool is_cube, double sigma_a, double sigma_s, double Le, const char *integrator,
                               double n)
{
    struct world w = world_of(
        "Integrator \"%s\" \"integer maxdepth\" 1000000\nWorldBegin\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" "
        "\"spectrum sigma_a\" [300 %.9g 900 %.9g] \"spectrum sigma_s\" [300 %.9g 900 %.9g] \"spectrum Le\" [300 1 900 1] \"float Lescale\" %.9g\n"
        "Material \"interface\" MediumInterface \"m\" \"\" %s",
        integrator, sigma_a, sigma_a, sigma_s, sigma_s, Le, is_cube ? unit_cube : "Shape \"sphere\"\n");
    struct estimate e = mean_luminance(&w.job, onto, &is_cube, n);
    world_free(&w);
    return e;
}

/* a: optical radius. A sphere's emissivity is what it shines with, on the mean over its surface and by the cosine. */
static void isothermal(const struct row *row)
{
    check(row, "volpath", glow_of(false, row->a, 0, 1, "volpath", 2048), GOAL);
    check(row, "twin", glow_of(false, row->a, 0, 1, "simplevolpath", 2048), 3e-2);
}

/* Whatever scatters, the mean length of paths is 4 V / S (Dirac 1943; Blanco & Fournier 2003). a: cube, b: sigma_s. A
 * trace of glowing absorber measures it. */
static void mean_chord(const struct row *row)
{
    for (int i = 0; i < 3; ++i) {
        double sigma_s = i == 0 ? 0 : i == 1 ? 1 : 10;
        static const char *const ways[] = {"empty", "thin", "thick"};
        check(row, ways[i], glow_of(row->a != 0, 1e-7, sigma_s, 1e7, "volpath", 2048),
              i == 0   ? 8 * GOAL
              : i == 1 ? 5e-3
                       : 1.5e-2);
    }
}

const struct row media_rows[] = {
    {"H1", "transmittance of 2.5 m of 0.7 / m", 0.17377394345, transmittance, 0, 0},
    {"H2", "point source in an absorber", 1.37202909024, point_in_absorber, 0, 0},
    {"H3r", "slab, scattered once, reflected", 0.0338370979045, single_scattering, 0.5, 0},
    {"H3t", "slab, scattered once, transmitted", 0.0204508956461, single_scattering, -0.5, 0},
    {"H5.0.5.0.5", "Chandrasekhar's H", 1.18773513267, chandrasekhar, 0.5, 0.5},
    {"H5.0.5.1.0", "Chandrasekhar's H", 1.25125956338, chandrasekhar, 0.5, 1},
    {"H5.0.9.0.5", "Chandrasekhar's H", 1.55603380202, chandrasekhar, 0.9, 0.5},
    {"H5.0.9.1.0", "Chandrasekhar's H", 1.85009851677, chandrasekhar, 0.9, 1},
    {"H5.0.99.0.5", "Chandrasekhar's H", 1.84860101645, chandrasekhar, 0.99, 0.5},
    {"H5.0.99.1.0", "Chandrasekhar's H", 2.4727928284, chandrasekhar, 0.99, 1},
    {"H6.0.5.0.5", "half-space, light from 60 deg", 0.160144433435, half_space, 0.5, 0.5},
    {"H6.0.5.1.0", "half-space, light from above", 0.115225877707, half_space, 0.5, 1},
    {"H6.0.9.0.5", "half-space, light from 60 deg", 0.50793890694, half_space, 0.9, 0.5},
    {"H6.0.9.1.0", "half-space, light from above", 0.414947479131, half_space, 0.9, 1},
    {"H6.0.99.0.5", "half-space, light from 60 deg", 0.815139898355, half_space, 0.99, 0.5},
    {"H6.0.99.1.0", "half-space, light from above", 0.75272071716, half_space, 0.99, 1},
    {"H8.0.5", "half-space, diffuse light", 0.14654438124, half_space, 0.5, 0},
    {"H8.0.9", "half-space, diffuse light", 0.478024489661, half_space, 0.9, 0},
    {"H8.0.99", "half-space, diffuse light", 0.794563653052, half_space, 0.99, 0},
    {"H9.0.1", "glowing sphere", 0.123845184679, isothermal, 0.1, 0},
    {"H9.1.0", "glowing sphere", 0.703002924855, isothermal, 1, 0},
    {"H9.5.0", "glowing sphere", 0.980009987985, isothermal, 5, 0},
    {"H10", "absorbing slab, diffuse light", 0.219383934396, absorbing_slab, 0, 0},
    {"H11.1.1.None", "slab, diffuse light, reflected", 0.446594007196, slab, 1, 0},
    {"H11t.1.1.None", "slab, diffuse light, transmitted", 0.553405992759, slab, -1, 0},
    {"H11.1.1.1.0", "slab, light from above, reflected", 0.341328760066, slab, 1, 1},
    {"H11t.1.1.1.0", "slab, light from above, transmitted", 0.658671239934, slab, -1, 1},
    {"H11.1.0.9.0.5", "slab, light from 60 deg, reflected", 0.393661658837, slab, 0.9, 0.5},
    {"H11t.1.0.9.0.5", "slab, light from 60 deg, transmitted", 0.414839902926, slab, -0.9, 0.5},
    {"H12.1", "point source in an infinite medium", 0.143283861525, point_in_infinite_medium, 0, 0},
    {"C12", "mean length of paths in the unit sphere", 1.33333333333, mean_chord, 0, 0},
    {"C13", "mean length of paths in the unit cube", 0.666666666667, mean_chord, 1, 0},
    {.id = NULL},
};

TEST(media_are_those_of_the_closed_forms)
{
    run_rows("media", media_rows);
}

/* ---- laws, and the estimator against others ---- */

static void expect_same(const char *what, struct estimate a, struct estimate b, double goal)
{
    double error = hypot(a.error, b.error), z = error > 0 ? (a.mean - b.mean) / error : 0;
    printf("  %-10s %.6g +- %.1e, expected %.6g +- %.1e, z = %.2f\n", what, a.mean, a.error, b.mean, b.error, z);
    EXPECT(fabs(a.mean - b.mean) <= FLOAT_GOAL * fabs(b.mean) || fabs(z) < (is_slow_build() ? 10 : 4.9));
    EXPECT(is_slow_build() || error <= goal * fabs(b.mean));
}

TEST(a_medium_that_absorbs_nothing_is_not_seen_in_an_even_sky)
{
    static const char *const ways[] = {"grey", "coloured", "twin"};
    for (int i = 0; i < 3; ++i) {
        struct matter m = i ? (struct matter){1, 0.5, 8} : (struct matter){1, 4, 4};
        struct world w = scene_of(i == 2 ? "simplevolpath" : "volpath", 1000000, m,
                                  "Material \"interface\" MediumInterface \"m\" \"\" Shape \"sphere\"\n" SKY);
        bool is_cube = false;
        struct estimate e = mean_luminance(&w.job, onto, &is_cube, 1024);
        world_free(&w);
        expect_same(ways[i], e, (struct estimate){1, 0, 0}, 0.02);
    }
}

static struct drawn from_within(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)v;
    return (struct drawn){{0.5f, 0.2f, -0.3f}, sr_warp_uniform_sphere(u), 1};
}

TEST(glowing_walls_are_as_bright_through_a_white_medium)
{
    // found by light samples and by directions, whose weights must add up to 1
    static const char *const names[] = {"grey", "coloured"};
    for (int i = 0; i < 2; ++i) {
        struct matter m = i ? (struct matter){1, 0.1, 2} : (struct matter){1, 0.8, 0.8};
        struct world w =
            scene_of("volpath", 1000000, m, "MediumInterface \"m\" \"\" " BLACK GLOW_BOTH "Shape \"sphere\"\n");
        struct estimate e = mean_luminance(&w.job, from_within, NULL, 1024);
        world_free(&w);
        expect_same(names[i], e, (struct estimate){1, 0, 0}, 1e-2);
    }
}

/* Luminance-like means at eight wavelengths, by paths that carry all of them, or each alone. */
enum { LANES = SR_LAMBDA_COUNT };
static void spectral(const struct sr_render_job *job, int alone, int n, struct sr_tally tallies[LANES])
{
    struct sr_worker worker = {0};
    for (int k = 0; k < n; ++k) {
        struct sr_sampler sampler =
            sr_sampler_start(SR_SAMPLER_INDEPENDENT, alone < 0 ? 1 : 2 + (uint32_t)alone, 0, 0, 0, (uint32_t)k);
        struct sr_wavelengths w = {.pdf = SR_ONE};
        int shift = (int)(sr_sample4(&sampler, SR_USE_FILM)[0] * LANES); // any of them may be the first
        for (int i = 0; i < LANES; ++i)
            w.lambda[i] = 400 + 40 * (float)(alone < 0 ? (i + shift) % LANES : alone);
        struct sr_path_start start = {
            .ray = {.o = {0.2f, 0.3f, 3}, .d = sr_normalize((sr_vec3){-0.1f, -0.12f, -1}), .t_max = INFINITY}};
        sr_spectrum L = job->integrator.model->L(job->integrator.self, job->scene, &start, &sampler, &w, NULL, &worker);
        if (alone >= 0)
            sr_tally_add(&tallies[alone], (double)sr_spectrum_mean(L));
        for (int i = 0; i < LANES && alone < 0; ++i)
            sr_tally_add(&tallies[(i + shift) % LANES], (double)L[i]);
    }
}

TEST(wavelengths_together_find_what_each_finds_alone)
{
    // a ball of an absorbing, glowing, scattering medium of strong colour in a vessel of dispersing glass, lit by
    // everything
    static const char *const vessels[] = {"Material \"interface\"",
                                          "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\""};
    for (int v = 0; v < 2; ++v) {
        struct world w = world_of(
            "Integrator \"volpath\" \"integer maxdepth\" 100\nWorldBegin\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" "
            "\"float g\" 0.6 \"spectrum Le\" [300 1 900 2] \"float Lescale\" 0.5 \"spectrum sigma_a\" [400 0.1 550 1.5 700 0.02] "
            "\"spectrum sigma_s\" [400 5 500 0.3 700 2.5]\nMediumInterface \"m\" \"\" %s Shape \"sphere\"\nMediumInterface \"m\" \"m\" " GREY
            "Shape \"sphere\" \"float radius\" 0.2\n" SKY
            "LightSource \"distant\" \"float illuminance\" 3 \"point3 from\" [0 1 1]\n"
            "MediumInterface \"\" \"\" " LAMP "Translate 1.5 0 0.5 Shape \"sphere\" \"float radius\" 0.4\n",
            vessels[v]);
        struct sr_tally together[LANES] = {{0}}, alone[LANES] = {{0}};
        int n = (int)samples(60000);
        spectral(&w.job, -1, n, together);
        for (int i = 0; i < LANES; ++i) {
            spectral(&w.job, i, n / 4, alone);
            char what[16];
            snprintf(what, sizeof what, "%d nm", 400 + 40 * i);
            expect_same(what, (struct estimate){together[i].mean, sr_tally_standard_error(&together[i]), n},
                        (struct estimate){alone[i].mean, sr_tally_standard_error(&alone[i]), n}, 0.03);
        }
        world_free(&w);
    }
}

TEST(the_plain_twin_finds_the_same_light)
{
    // a room full of fog, another medium in a ball of it, a glass ball of a third, a lamp, a mirror: everything but
    // delta lights
    static const char room[] =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"float g\" 0.5 \"rgb sigma_a\" [.05 .05 .1] \"rgb sigma_s\" [.4 .3 .2]\n"
        "MakeNamedMedium \"milk\" \"string type\" \"homogeneous\" \"float g\" -0.3 \"rgb sigma_a\" [.1 .2 .5] \"rgb sigma_s\" [4 4 2]\n"
        "MakeNamedMedium \"ember\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [1 1 1] \"rgb Le\" [2 1 .3]\n";
    static const char objects[] =
        "MediumInterface \"\" \"fog\" " GREY "Scale -1 1 1 Shape \"sphere\" \"float radius\" 3\nScale -1 1 1\n"
        "Material \"interface\" MediumInterface \"milk\" \"fog\" Shape \"sphere\" \"float radius\" 0.7\n"
        "Material \"dielectric\" MediumInterface \"ember\" \"fog\" AttributeBegin Translate 1.3 0 0 Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n"
        "Material \"conductor\" \"float roughness\" 0.1 MediumInterface \"\" \"fog\" AttributeBegin Translate -1.3 0 0 Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n"
        "AreaLightSource \"diffuse\" \"float scale\" 5 AttributeBegin Translate 0 2 0 Shape \"sphere\" \"float radius\" 0.6 AttributeEnd\n";
    struct estimate e[2];
    for (int i = 0; i < 2; ++i) {
        struct world w = world_of(
            "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\n%sMediumInterface \"\" \"fog\"\nLookAt 0 0 2.7 0 0 0 0 1 0 "
            "Camera \"perspective\" \"float fov\" 75\nIntegrator \"%s\" \"integer maxdepth\" 100\nWorldBegin\n%s",
            room, i ? "simplevolpath" : "volpath", objects);
        e[i] = pixel_mean(&w.job, 0, 0, i ? 2048 : 1024, (const double[]){0, 1, 0});
        world_free(&w);
    }
    expect_same("room", e[0], e[1], 2.5e-2);
}

TEST(particles_and_paths_find_the_same_light_leaving)
{
    // coloured fog around a grey ball, lit from outside: what leaves, and where the rest stays
    struct world w = world_of(
        "Integrator \"volpath\" \"integer maxdepth\" 1000\nWorldBegin\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float g\" 0.5 "
        "\"spectrum sigma_a\" [300 .3 600 0.1 900 1] \"spectrum sigma_s\" [300 2 900 .2]\nLightSource \"point\" \"point3 from\" [0 0 2.6] \"float power\" 1000\n"
        "Material \"interface\" MediumInterface \"m\" \"\" Shape \"sphere\" \"float radius\" 2\nMediumInterface \"m\" \"m\" " GREY
        "Shape \"sphere\" \"float radius\" 0.4\n#@ Meter \"flux\" \"string name\" \"F\" \"string shape\" \"sphere\" \"float radius\" 3 \"string side\" \"back\"\n");
    struct sr_measure_settings s = {.samples = (uint64_t)samples(8192) * REPLICATES, .replicates = REPLICATES};
    struct sr_arena arena = {0};
    struct sr_balance b;
    struct sr_error error = {0};
    EXPECT(sr_measure_balance(&w.job, &s, &arena, &b, &error) == SR_OK);
    struct estimate escaped = {b.escaped[0].value, b.escaped[0].u, REPLICATES - 1},
                    closure = {1000 + b.closure[0].value, b.closure[0].u, REPLICATES - 1};
    expect_same("closure", closure, (struct estimate){1000, 0, 0}, 5e-3);
    EXPECT_NEAR(b.in_media[0].value + b.by_object[1][0].value, b.absorbed[0].value, 1e-3);
    EXPECT(b.in_media[0].value > 20 && b.by_object[0][0].value == 0);
    sr_arena_free(&arena);
    expect_same("escaped", escaped, metered(&w, 8192), 5e-3);
}

/* ---- where density varies ---- */

#define GRID "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" "
#define SMOKE                                                                                                          \
    GRID "\"point3 p0\" [-.5 -.5 -.5] \"point3 p1\" [.5 .5 .5] \"integer nx\" 3 \"integer ny\" 3 \"integer nz\" 2 "    \
         "\"float density\" [0 0 0 .2 3 1 0 0 0  0 .5 0 0 9 0 0 .5 0] "
#define LIT                                                                                                            \
    SKY "LightSource \"distant\" \"float illuminance\" 2 \"point3 from\" [1 2 3] \"point3 to\" [0 0 0]\n" LAMP         \
        "AttributeBegin Translate 0 1.2 0 Shape \"sphere\" \"float radius\" 0.3\nAttributeEnd\n"

static struct estimate of_cube(const char *integrator, const char *medium, const char *lights, double n)
{
    struct world w = world_of(
        "Integrator \"%s\" \"integer maxdepth\" 1000\nWorldBegin\n%s%sMaterial \"interface\" MediumInterface \"m\" \"\"\n%s",
        integrator, medium, lights, unit_cube);
    bool is_cube = true;
    struct estimate e = mean_luminance(&w.job, onto, &is_cube, n);
    world_free(&w);
    return e;
}

TEST(grids_of_one_density_are_uniform_media)
{
    static const char even[] =
        "\"rgb sigma_a\" [.2 .5 2] \"rgb sigma_s\" [4 2 1] \"float g\" 0.4 \"spectrum Le\" [300 1 900 1] \"float Lescale\" 1\n";
    char uniform[512], grid[1024]; // between the middles of its voxels; outwards, a grid thins out
    snprintf(uniform, sizeof uniform, "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" %s", even);
    snprintf(
        grid, sizeof grid,
        GRID
        "\"point3 p0\" [-2 -2 -2] \"point3 p1\" [2 2 2] \"integer nx\" 2 \"integer ny\" 2 \"integer nz\" 2 \"float density\" [1 1 1 1 1 1 1 1] %s",
        even);
    expect_same("volpath", of_cube("volpath", grid, LIT, 2048), of_cube("volpath", uniform, LIT, 2048), 1e-2);
    expect_same("twin", of_cube("simplevolpath", grid, SKY, 2048), of_cube("volpath", uniform, SKY, 2048), 2e-2);
}

TEST(smoke_is_the_same_to_all_estimators)
{
    // from nothing to thick, so that most collisions are null; coloured, glowing
    static const char smoke[] = SMOKE "\"rgb sigma_a\" [.2 .5 2] "
                                      "\"rgb sigma_s\" [4 2 1] \"float g\" 0.4 \"spectrum Le\" [300 1 900 1]\n";
    static const char white[] = SMOKE "\"rgb sigma_a\" [0 0 0] "
                                      "\"rgb sigma_s\" [4 2 1] \"float g\" 0.4\n";
    static const char fire[] = SMOKE "\"rgb sigma_a\" [1 2 3] "
                                     "\"rgb sigma_s\" [0 0 0] \"spectrum Le\" [300 1 900 1]\n";
    static const char lamps[] =
        SKY LAMP "AttributeBegin Translate 0 1.2 0 Shape \"sphere\" \"float radius\" 0.3\nAttributeEnd\n";
    expect_same("smoke", of_cube("volpath", smoke, lamps, 2048), of_cube("simplevolpath", smoke, lamps, 4096), 1.5e-2);
    expect_same("fire", of_cube("volpath", fire, lamps, 2048), of_cube("simplevolpath", fire, lamps, 4096), 1.5e-2);
    expect_same("furnace", of_cube("volpath", white, SKY, 2048), (struct estimate){1, 0, 0}, 1e-2);
}
