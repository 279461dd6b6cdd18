/* SPDX-License-Identifier: MIT */
/* The gonioreflectometer against what is known: a flat Lambertian patch, grooves of mirrors, a random surface of
 * mirrors and the microfacet model. */
#include "import/import.h"
#include "render/render.h"
#include "test.h"

#include <stdarg.h>

#define PI 3.14159265358979323846
#define MIRROR "Material \"conductor\" \"spectrum reflectance\" [200 1 900 1] \"float roughness\" 0\n"

static struct sr_import_result world(const char *text)
{
    struct sr_error error = {0};
    struct sr_log silent = {0};
    struct sr_import_options options = {0};
    struct sr_import_result result;
    char path[512];
    snprintf(path, sizeof path, "%s/gonio.pbrt", test_folder());
    if (sr_file_write(path, text, strlen(text), &error) != SR_OK ||
        sr_import_pbrt(path, &options, &result, &silent, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return result;
}

static struct sr_gonio gonio(const struct sr_import_result *w, uint32_t samples)
{
    return (struct sr_gonio){.scene = w->scene, .seed = 3, .samples = samples, .replicates = 16, .threads = 2};
}

static struct sr_gonio_beam beam(double half, double theta_deg, double phi_deg, uint32_t thetas, uint32_t phis)
{
    struct sr_gonio_beam b = {.x0 = -half,
                              .x1 = half,
                              .y0 = -half,
                              .y1 = half,
                              .theta_i = (float)(theta_deg * PI / 180),
                              .phi_i = (float)(phi_deg * PI / 180),
                              .theta_count = thetas,
                              .phi_count = phis};
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        b.lambda[i] = 400 + 320.0f / SR_LAMBDA_COUNT * (float)i;
    return b;
}

static struct sr_gonio_scatter scatter(const struct sr_gonio *g, const struct sr_gonio_beam *b, struct sr_arena *arena)
{
    struct sr_error error = {0};
    struct sr_gonio_scatter s;
    if (sr_gonio_scatter(g, b, arena, &s, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return s;
}

/* By Student's distribution of 16 replicates. */
static void expect_mean(double value, double error, double expected)
{
    double t = (value - expected) / error;
    if (!(error > 0 ? sr_student_p_two_sided(t, 15) > 1e-6 : fabs(value - expected) <= 1e-9 + 1e-6 * fabs(expected)))
        test_fail(__FILE__, __LINE__, "%g +- %g, expected %g", value, error, expected);
}

TEST(flat_lambertian_patch_has_rho_over_pi_in_all_directions)
{
    struct sr_import_result w = world("WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [360 0.2 830 0.67]\n"
                                      "Shape \"bilinearmesh\" \"point3 P\" [-9 -9 0  9 -9 0  -9 9 0  9 9 0]\n");
    struct sr_arena arena = {0};
    struct sr_gonio g = gonio(&w, 4096);
    for (int isotropic = 0; isotropic < 2; ++isotropic) {
        struct sr_gonio_beam b = beam(1, 50, 30, 6, 8);
        b.is_isotropic = isotropic;
        struct sr_gonio_scatter s = scatter(&g, &b, &arena);
        EXPECT_NEAR(s.missed, 0, 0);
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
            double rho = 0.2 + ((double)b.lambda[i] - 360) * 1e-3;
            EXPECT_NEAR(s.reflected[i], rho, 1e-5);
            EXPECT_NEAR(s.transmitted[i], 0, 0);
            for (size_t c = 0; c < s.cells; ++c) {
                expect_mean(s.f[c * SR_LAMBDA_COUNT + (size_t)i], s.f_error[c * SR_LAMBDA_COUNT + (size_t)i], rho / PI);
                EXPECT(s.f_error[c * SR_LAMBDA_COUNT + (size_t)i] < 0.03);
            }
        }
    }
    // four times the paths, half the error, or less: nets are smoother than chance
    struct sr_gonio_beam b = beam(1, 50, 30, 6, 8);
    double few = scatter(&g, &b, &arena).f_error[20 * SR_LAMBDA_COUNT];
    g.samples *= 16;
    EXPECT(scatter(&g, &b, &arena).f_error[20 * SR_LAMBDA_COUNT] < 0.4 * few);
    sr_arena_free(&arena);
    sr_import_result_free(&w);
}

/* Right-angled grooves along y turn light back across them and mirror it along them. */
TEST(right_angled_grooves_of_mirrors_reflect_twice)
{
    struct sr_array text = {0};
    sr_array_reserve(&text, 1 << 16, 1);
    char *at = text.data;
    at += sprintf(at, "WorldBegin\n" MIRROR);
    for (int k = -10; k < 10; ++k)
        at += sprintf(
            at,
            "Shape \"bilinearmesh\" \"point3 P\" [%d -50 0  %g -50 -0.5  %d 50 0  %g 50 -0.5]\nShape \"bilinearmesh\" \"point3 P\" [%g -50 -0.5  %d -50 0  %g 50 -0.5  %d 50 0]\n",
            k, k + 0.5, k, k + 0.5, k + 0.5, k + 1, k + 0.5, k + 1);
    struct sr_import_result w = world(text.data);
    struct sr_arena arena = {0};
    struct sr_gonio g = gonio(&w, 1000);
    // [theta_i, phi_i] -> cell of the direction that it leaves in
    static const double in[][2] = {{3, 91}, {25, 90.001}, {61, 90.001}}; // beside the borders of cells
    for (int k = 0; k < 3; ++k) {
        struct sr_gonio_beam b = beam(3, in[k][0], in[k][1], 9, 8);
        struct sr_gonio_scatter s = scatter(&g, &b, &arena);
        double x = -sin(in[k][0] * PI / 180) * cos(in[k][1] * PI / 180),
               y = sin(in[k][0] * PI / 180) * sin(in[k][1] * PI / 180);
        double phi = fmod(atan2(-y, -x) * 180 / PI + 360, 360); // x back to where it came from, y mirrored
        size_t cell = (size_t)(in[k][0] / 10) * 8 + (size_t)(phi / 45);
        double lower = sin((floor(in[k][0] / 10)) * PI / 18), upper = sin((floor(in[k][0] / 10) + 1) * PI / 18),
               projected = PI / 4 * (upper * upper - lower * lower) / 2;
        EXPECT_NEAR(s.reflected[0], 1, 4e-3); // two reflections of a metal that is nearly perfect
        EXPECT_RELATIVE(s.f[cell * SR_LAMBDA_COUNT] * projected, s.reflected[0],
                        k == 0 ? 0.15 : 1e-3); // askew, some leave after one
        EXPECT_NEAR(s.missed, 0, 0);
    }
    sr_array_free(&text);
    sr_arena_free(&arena);
    sr_import_result_free(&w);
}

/* Heights of a grid, normally distributed: the slopes of its triangles are normal, too, with variance 2 s^2 / d^2 along
 * x and y and covariance s^2 / d^2. Without shadows f = P(p, q) / (4 cos_theta_i cos_theta_o cos_theta_h^4), per
 * projected area. */
TEST(random_mirrors_scatter_as_the_microfacet_model_says)
{
    enum { N = 56, THETAS = 15, PHIS = 8 };
    static double height[N + 1][N + 1];
    const double d = 1, s = 0.06;
    struct sr_rng rng = sr_rng_seed(5, 9);
    struct sr_array text = {0};
    sr_array_reserve(&text, 1 << 20, 1);
    char *at = text.data;
    at += sprintf(at, "WorldBegin\n" MIRROR "Shape \"trianglemesh\" \"point3 P\" [");
    for (int j = 0; j <= N; ++j)
        for (int i = 0; i <= N; ++i) {
            height[j][i] = s * sr_normal_quantile((double)sr_rng_float(&rng) * 0.999998 + 1e-6);
            at += sprintf(at, "%g %g %.7g\n", (i - N / 2) * d, (j - N / 2) * d, height[j][i]);
        }
    at += sprintf(at, "] \"integer indices\" [");
    for (int j = 0; j < N; ++j)
        for (int i = 0; i < N; ++i) {
            int k = j * (N + 1) + i;
            at += sprintf(at, "%d %d %d %d %d %d\n", k, k + 1, k + N + 1, k + N + 2, k + N + 1, k + 1);
        }
    sprintf(at, "]\n");
    struct sr_import_result w = world(text.data);
    struct sr_arena arena = {0};
    struct sr_gonio g = gonio(&w, 60000);
    struct sr_gonio_beam b = beam((N / 2 - 1) * d, 12, 20, THETAS, PHIS);
    struct sr_gonio_scatter measured = scatter(&g, &b, &arena);

    // what each facet of these does, and what the model says of them all, in the same cells
    static double exact[THETAS * PHIS], model[THETAS * PHIS];
    memset(exact, 0, sizeof exact), memset(model, 0, sizeof model);
    double wi[3] = {sin(12 * PI / 180) * cos(20 * PI / 180), sin(12 * PI / 180) * sin(20 * PI / 180),
                    cos(12 * PI / 180)},
           facets = 0;
    enum { Q = 300 };
    double variance = 2 * s * s / (d * d);
    for (int pass = 0; pass < 2; ++pass)
        for (int a = 0; a < (pass ? Q : 2 * N); ++a)
            for (int c = 0; c < (pass ? Q : N); ++c) {
                double p, q, share;
                if (pass) { // slopes over five deviations
                    p = sqrt(variance) * (10.0 * (a + 0.5) / Q - 5), q = sqrt(variance) * (10.0 * (c + 0.5) / Q - 5);
                    share = exp(-(p * p - p * q + q * q) / (variance * 0.75 * 2)); // correlation 1/2
                } else {
                    int j = a / 2, i = c;
                    bool is_upper = a & 1;
                    p = is_upper ? height[j + 1][i + 1] - height[j + 1][i] : height[j][i + 1] - height[j][i];
                    q = is_upper ? height[j + 1][i + 1] - height[j][i + 1] : height[j + 1][i] - height[j][i];
                    share = i >= 1 && i < N - 1 && j >= 1 && j < N - 1;
                    facets += share;
                }
                double length = sqrt(1 + p * p + q * q), n[3] = {-p / length, -q / length, 1 / length};
                double cosine = n[0] * wi[0] + n[1] * wi[1] + n[2] * wi[2], wo[3];
                for (int k = 0; k < 3; ++k)
                    wo[k] = 2 * cosine * n[k] - wi[k];
                share *= cosine * length; // of the beam on the facet
                double theta = acos(wo[2]) * 180 / PI, phi = fmod(atan2(wo[1], wo[0]) * 180 / PI + 360, 360);
                size_t cell = (size_t)(theta / 90 * THETAS) * PHIS + (size_t)(phi / 360 * PHIS);
                (pass ? model : exact)[cell] += share;
            }
    double sum_exact = 0, sum_model = 0;
    for (size_t c = 0; c < THETAS * PHIS; ++c) {
        sum_exact += exact[c];
        sum_model += model[c];
    }
    EXPECT_NEAR(measured.reflected[0], 1, 2e-3);
    int tested = 0;
    for (size_t c = 0; c < THETAS * PHIS; ++c) {
        double lower = sin(PI / 2 * (double)(c / PHIS) / THETAS), upper = sin(PI / 2 * (double)(c / PHIS + 1) / THETAS),
               projected = PI / PHIS * (upper * upper - lower * lower);
        double share = measured.f[c * SR_LAMBDA_COUNT] * projected,
               error = measured.f_error[c * SR_LAMBDA_COUNT] * projected;
        double facet = exact[c] / sum_exact, law = model[c] / sum_model;
        EXPECT_NEAR(share, facet,
                    6 * error + 0.01 * facet +
                        1e-4); // the beam's edge cuts other facets than the sum's; G is not quite 1
        EXPECT_NEAR(share, law,
                    6 * error + 5 * sqrt(2 * law / facets) +
                        1e-4); // facets share vertices: half as many are independent
        tested += law > 0.01;
    }
    EXPECT(tested >= 12);
    sr_array_free(&text);
    sr_arena_free(&arena);
    sr_import_result_free(&w);
}
