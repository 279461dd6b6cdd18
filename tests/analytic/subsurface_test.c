/* SPDX-License-Identifier: MIT */
/* Translucent bodies: a flat half space under a uniform sky L = 1 shows
 *
 *     L(wo) = F(wo) + (1 - F(wo)) e,        e: all of the profile, the table's own integral
 *
 * whatever the distances over which light wanders. Where the medium is coloured, e is weighed by the observer. Two
 * estimators that share nothing but the step through the body, path and volpath, must agree where that holds no longer:
 * on a sphere. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)
#define CONSTANT(x) "[360 " x " 830 " x "]"

static struct drawn from_above(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)u, (void)v;
    double theta = *(const double *)context * DEGREE;
    sr_vec3 d = {(float)sin(theta), 0, (float)-cos(theta)};
    return (struct drawn){sr_scale(-0.5f, d), d, 1};
}

/* e weighed by the observer's ybar: the material's own albedos, its table's integral. */
static double weighed_share(const struct sr_scene *scene)
{
    struct sr_ray ray = {.o = {0, 0, 1}, .d = {0, 0, -1}, .t_max = INFINITY};
    struct sr_hit hit;
    EXPECT(sr_raycast(scene, &ray, &hit));
    double sum = 0, total = 0;
    for (int lambda = 360; lambda <= 830; ++lambda) {
        struct sr_wavelengths w = {.lambda = SR_BLACK + (float)lambda, .pdf = SR_ONE};
        struct sr_bssrdf b;
        double xyz[3];
        EXPECT(sr_material_bssrdf(hit.material, &hit.point, (sr_vec3){0, 0, 1}, 0, 1, &w, &b));
        sr_observer_1931(lambda, xyz);
        sum += xyz[1] * (double)sr_diffusion_effective(b.diffusion, b.albedo[0]);
        total += xyz[1];
    }
    return sum / total;
}

static void expect_half_space(const char *name, const char *material, double theta, double eta, double known)
{
    struct world w =
        world_of("Integrator \"path\" \"integer maxdepth\" 2 \"bool subsurface\" true\nWorldBegin\n"
                 "LightSource \"infinite\" \"spectrum L\" " CONSTANT("1") "\n%s Shape \"disk\" \"float radius\" 50\n",
                 material);
    double F = (double)sr_fresnel_dielectric((float)cos(theta * DEGREE), (float)eta),
           e = isnan(known) ? weighed_share(w.job.scene) : known;
    struct estimate L = mean_luminance(&w.job, from_above, &theta, 4096);
    double expected = F + (1 - F) * e, z = (L.mean - expected) / L.error;
    bool is_right = fabs(z) < 4.9 || fabs(L.mean - expected) < 2e-4 * expected; // reach leaves out 1e-4
    printf("  %-22s %2.0f deg  %.6f +- %.1e   known %.6f  z %6.2f%s\n", name, theta, L.mean, L.error, expected, z,
           is_right ? "" : "  WRONG");
    world_free(&w);
    EXPECT(is_right);
    EXPECT(is_slow_build() || L.error < 6e-3 * expected / sqrt(fmin(1, effort())));
}

TEST(a_half_space_returns_what_its_profile_holds)
{
    static const char thin[] =
        "Material \"subsurface\" \"spectrum sigma_a\" " CONSTANT("2") " \"spectrum sigma_s\" " CONSTANT("18");
    static const char dense[] = "Material \"subsurface\" \"spectrum sigma_a\" " CONSTANT(
        "0.2") " \"spectrum sigma_s\" " CONSTANT("199.8") " \"float scale\" 2 \"float eta\" 1.5";
    static const char coloured[] =
        "Material \"subsurface\" \"spectrum sigma_a\" [400 10 550 1 700 0.02] \"spectrum sigma_s\" [400 20 700 60]";
    static const char wanted[] = "Material \"subsurface\" \"spectrum reflectance\" " CONSTANT(
        "0.6") " \"spectrum mfp\" " CONSTANT("0.02") " \"float eta\" 1.4";
    static const char forward[] = "Material \"subsurface\" \"spectrum reflectance\" " CONSTANT(
        "0.3") " \"spectrum mfp\" [400 0.002 700 0.05] \"float g\" 0.7";
    expect_half_space("thin", thin, 0, 1.33, NAN);
    expect_half_space("thin", thin, 70, 1.33, NAN);
    expect_half_space("dense, scaled", dense, 30, 1.5, NAN);
    expect_half_space("coloured", coloured, 45, 1.33, NAN);
    expect_half_space("a wanted reflectance", wanted, 20, 1.4, 0.6);
    expect_half_space("the same, g 0.7", forward, 20, 1.33, 0.3);
}

/* On a sphere of radius R, pi d^2 of the surface lies within the chord d of any point: what comes out, all of it into
 * the sky, is INTEGRAL_0^2R 2 pi d S_r(d) dd. Chords along tangents matter here, and cosines between them and the
 * surface. */
TEST(a_small_ball_returns_what_its_profile_holds_within_its_diameter)
{
    static const double radii[] = {0.03, 0.2, 1}; // mean free path 0.1
    for (int i = 0; i < 6; ++i) {
        double R = radii[i / 2], theta = i % 2 ? 60 : 0;
        struct world w = world_of(
            "Integrator \"path\" \"integer maxdepth\" 2 \"bool subsurface\" true\nWorldBegin\n"
            "LightSource \"infinite\" \"spectrum L\" " CONSTANT(
                "1") "\n"
                     "Material \"subsurface\" \"spectrum sigma_a\" " CONSTANT("0.5") " \"spectrum sigma_s\" " CONSTANT(
                         "9.5") "\n"
                                "Translate 0 0 %g Shape \"sphere\" \"float radius\" %g\n",
            -R, R);
        struct sr_ray ray = {.o = {0, 0, 1}, .d = {0, 0, -1}, .t_max = INFINITY};
        struct sr_hit hit;
        struct sr_wavelengths all = {.lambda = SR_BLACK + 550, .pdf = SR_ONE};
        struct sr_bssrdf b;
        EXPECT(sr_raycast(w.job.scene, &ray, &hit) &&
               sr_material_bssrdf(hit.material, &hit.point, (sr_vec3){0, 0, 1}, 0, 1, &all, &b));
        double x[200], weights[200], e = 0;
        sr_gauss_legendre(200, 0, sqrt(2 * R), x, weights);
        for (int k = 0; k < 200; ++k) // d = x^2
            e += weights[k] * 2 * x[k] * 2 * M_PI * x[k] * x[k] *
                 (double)sr_bssrdf_profile(&b, (float)(x[k] * x[k]), NULL)[0];
        struct estimate L = mean_luminance(&w.job, from_above, &theta, 4096);
        double F = (double)sr_fresnel_dielectric((float)cos(theta * DEGREE), 1.33f), expected = F + (1 - F) * e,
               z = (L.mean - expected) / L.error;
        bool is_right = fabs(z) < 4.9 || fabs(L.mean - expected) < 2e-4 * expected;
        printf("  radius %.2f, %2.0f deg  %.6f +- %.1e   known %.6f  z %6.2f%s\n", R, theta, L.mean, L.error, expected,
               z, is_right ? "" : "  WRONG");
        world_free(&w);
        EXPECT(is_right);
        EXPECT(is_slow_build() || L.error < 1e-2 * expected / sqrt(fmin(1, effort())));
    }
}

static struct estimate ball(const char *integrator)
{
    struct world w = world_of(
        "%s\nWorldBegin\nLightSource \"distant\" \"point3 from\" [1 0 1] \"float illuminance\" 3\n"
        "LightSource \"infinite\" \"spectrum L\" " CONSTANT(
            "0.3") "\n"
                   "Material \"subsurface\" \"string name\" \"Skin1\" \"float scale\" 4 \"float roughness\" 0.1\n"
                   "AttributeBegin Shape \"sphere\" \"float radius\" 0.3 AttributeEnd\n"
                   "Material \"diffuse\" Translate 0 0 -0.3 Shape \"disk\" \"float radius\" 2\n",
        integrator);
    double theta = 50;
    struct estimate e = mean_luminance(&w.job, from_above, &theta, 4096);
    world_free(&w);
    return e;
}

TEST(path_and_volpath_agree_on_a_ball)
{
    struct estimate a = ball("Integrator \"path\" \"integer maxdepth\" 20 \"bool subsurface\" true");
    struct estimate b = ball("MakeNamedMedium \"nothing\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" " CONSTANT(
        "0") " \"spectrum sigma_s\" " CONSTANT("0") "\n"
                                                    "MediumInterface \"\" \"nothing\"\nIntegrator \"volpath\" \"integer maxdepth\" 20");
    double error = hypot(a.error, b.error);
    printf("  path %.5f +- %.1e, volpath %.5f +- %.1e, z %.2f\n", a.mean, a.error, b.mean, b.error,
           (a.mean - b.mean) / error);
    EXPECT(fabs(a.mean - b.mean) < 4.9 * error);
    EXPECT(is_slow_build() || error < 0.02 * a.mean / sqrt(fmin(1, effort())));
}

/* The model's limit, as its page tells it: a random walk in the same medium shows 4 % less. */
TEST(diffusion_is_a_little_brighter_than_a_random_walk)
{
    static const char medium[] = "\"spectrum sigma_a\" " CONSTANT("0.2") " \"spectrum sigma_s\" " CONSTANT("19.8");
    struct estimate e[2];
    for (int i = 0; i < 2; ++i) {
        struct world w = world_of(
            "Integrator \"volpath\" \"integer maxdepth\" 3000\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" %s\nWorldBegin\n"
            "LightSource \"infinite\" \"spectrum L\" " CONSTANT(
                "1") "\n%s Material %s Translate 0 0 -20 Shape \"sphere\" \"float radius\" 20\n",
            medium, i ? "MediumInterface \"m\" \"\"" : "",
            i ? "\"dielectric\" \"float eta\" 1.33"
              : "\"subsurface\" \"spectrum sigma_a\" " CONSTANT("0.2") " \"spectrum sigma_s\" " CONSTANT("19.8"));
        double theta = 0;
        e[i] = mean_luminance(&w.job, from_above, &theta, 1024);
        world_free(&w);
    }
    double ratio = e[0].mean / e[1].mean, error = ratio * hypot(e[0].error / e[0].mean, e[1].error / e[1].mean);
    printf("  diffusion %.4f +- %.1e, walk %.4f +- %.1e, ratio %.4f +- %.1e\n", e[0].mean, e[0].error, e[1].mean,
           e[1].error, ratio, error);
    EXPECT(fabs(ratio - 1.036) < 4.9 * error + 0.003);
    EXPECT(is_slow_build() || error < 0.02 / sqrt(fmin(1, effort())));
}

/* pbrt's path tracing takes such bodies for glass, and so does ours unless told otherwise; whoever asks hears of it. */
TEST(who_does_not_enter_bodies_says_so)
{
    struct world w = world_of(
        "Integrator \"path\"\nWorldBegin\nLightSource \"infinite\"\nMaterial \"subsurface\" Shape \"sphere\"\n");
    struct sr_error error = {0};
    static const char *const names[] = {"path", "bdpt", "simplepath", "path,subsurface=true", "volpath"};
    for (int i = 0; i < 5; ++i) {
        struct sr_integrator integrator;
        if (sr_integrator_parse(names[i], NULL, sr_scene_arena((struct sr_scene *)(uintptr_t)w.job.scene), &integrator,
                                &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        const char *blind = sr_integrator_blind(&integrator, w.job.scene);
        EXPECT((i < 3) == (blind && strstr(blind, "translucent")));
    }
    world_free(&w);
}
