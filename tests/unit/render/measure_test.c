/* SPDX-License-Identifier: MIT */
/* Measuring as statistics: no bias from stopping, intervals that cover, the same numbers from any threads, and plain
 * words where nothing can be trusted. */
#include "import/import.h"
#include "render/render.h"
#include "test.h"

struct bench {
    struct sr_import_result scene;
    struct sr_render_job job;
    struct sr_arena arena;
};

static struct bench bench_of(const char *text)
{
    struct bench b = {0};
    char path[512];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/bench.pbrt", test_folder());
    if (sr_file_write(path, text, strlen(text), &error) != SR_OK ||
        sr_import_pbrt(path, NULL, &b.scene, NULL, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    b.job = (struct sr_render_job){.scene = b.scene.scene,
                                   .integrator = b.scene.integrator,
                                   .sampler = b.scene.sampler,
                                   .seed = 1,
                                   .lambda = {SR_LAMBDA_MIN, SR_LAMBDA_MAX},
                                   .jitter_lambda = true};
    return b;
}

static void bench_free(struct bench *b)
{
    sr_import_result_free(&b->scene);
    sr_arena_free(&b->arena);
}

static struct sr_measurement measure(struct bench *b, struct sr_measure_settings s, sr_status expected)
{
    struct sr_measurement m;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(b->scene.meter_count, 1);
    EXPECT_EQUAL_INT(sr_measure(&b->job, &b->scene.meters[0], &s, &b->arena, &m, &error), expected);
    return m;
}

/* Light from 1 % of the directions' measure: a disk that glows with 100 and is met by chance alone, so that E = pi. */
#define RARE                                                                                                             \
    "Sampler \"independent\" Integrator \"simplepath\" \"bool samplelights\" false \"integer maxdepth\" 0\nWorldBegin\n" \
    "AreaLightSource \"diffuse\" \"float scale\" 100 \"bool twosided\" true\n"                                           \
    "Shape \"disk\" \"float height\" 1 \"float radius\" 0.10050378152592121\n"                                           \
    "#@ Meter \"irradiance\"\n"

static const double pi = 3.14159265358979323846;

TEST(a_target_is_reached_without_bias_where_one_path_in_a_hundred_brings_light)
{
    struct bench b = bench_of(RARE);
    struct sr_tally mean = {0}, naive = {0};
    int covered = 0, on_target = 0;
    enum { RUNS = 400 };
    b.job.threads = 1;
    for (uint32_t i = 0; i < RUNS; ++i) {
        struct sr_measure_settings s = {.error = 0.2, .stream = i, .system = SR_PHOTOPIC};
        struct sr_measurement m = measure(&b, s, SR_OK);
        const struct sr_quantity *q = &m.value[SR_PHOTOPIC];
        sr_tally_add(&mean, q->value);
        covered += fabs(q->value - pi) <= sr_quantity_expanded(q, 0.95);
        on_target += m.is_on_target;
        // what stopping at the first good look would have done: rounds of 16, the error of 16 samples looked at
        struct sr_tally looked = {0};
        for (uint32_t k = 0; k < 64; ++k) {
            struct sr_measure_settings little = {
                .samples = 16, .replicates = 16, .stream = i * 64 + k + 100000, .system = SR_PHOTOPIC};
            struct sr_measurement one = measure(&b, little, SR_OK);
            sr_tally_add(&looked, one.value[SR_PHOTOPIC].value);
            if (k >= 1 && sr_tally_standard_error(&looked) <= 0.1 * looked.mean)
                break;
        }
        sr_tally_add(&naive, looked.mean);
    }
    printf("  mean / truth %.4f +- %.4f, covered %.3f, on target %.2f; naive %.3f +- %.3f\n", mean.mean / pi,
           sr_tally_standard_error(&mean) / pi, covered / (double)RUNS, on_target / (double)RUNS, naive.mean / pi,
           sr_tally_standard_error(&naive) / pi);
    EXPECT_MEAN(mean, pi);
    EXPECT(covered >= 0.9 * RUNS); // 95 % nominal
    EXPECT(on_target >= 0.8 * RUNS);
    EXPECT(naive.mean < 0.9 * pi); // the case is hard enough to show the difference
    bench_free(&b);
}

TEST(threads_change_no_bit_and_streams_are_independent)
{
    struct bench b = bench_of(
        "WorldBegin LightSource \"point\" \"point3 from\" [0 0 2]\n"
        "AreaLightSource \"diffuse\" Shape \"sphere\" \"float radius\" 3\n#@ Meter \"spherical\" \"point3 p\" [0 1 0]\n");
    struct sr_measure_settings s = {.samples = 20000, .system = SR_PHOTOPIC};
    sr_spectrometer_prepare(400, 10, 700, NAN, SR_BAND_TRIANGULAR, &s.spectrometer, NULL);
    struct sr_measurement first = {0}, m;
    for (int threads = 1; threads <= 5; threads += 2) {
        b.job.threads = threads;
        m = measure(&b, s, SR_OK);
        if (threads == 1)
            first = m;
        for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
            EXPECT(memcmp(&m.value[i].value, &first.value[i].value, sizeof(double)) == 0 &&
                   memcmp(&m.value[i].u, &first.value[i].u, sizeof(double)) == 0);
        EXPECT(memcmp(m.spectrum, first.spectrum, 31 * sizeof *m.spectrum) == 0);
    }
    s.stream = 1;
    m = measure(&b, s, SR_OK);
    EXPECT(m.value[SR_PHOTOPIC].value != first.value[SR_PHOTOPIC].value);
    EXPECT_EQUAL_INT(m.samples, 20000);
    bench_free(&b);
}

static bool says(const struct sr_measurement *m, const char *part)
{
    for (uint32_t i = 0; i < m->remark_count; ++i)
        if (strstr(m->remarks[i], part))
            return true;
    for (uint32_t i = 0; i < m->remark_count; ++i)
        printf("  said: %s\n", m->remarks[i]);
    return false;
}

TEST(nothing_found_is_a_bound_and_a_sentence)
{
    struct sr_measure_settings s = {.samples = 4096, .system = SR_PHOTOPIC};
    struct bench b = bench_of("WorldBegin Shape \"sphere\"\n#@ Meter \"spherical\" \"point3 p\" [0 0 0.2]\n");
    struct sr_measurement m = measure(&b, s, SR_OK);
    EXPECT(says(&m, "no lights") && m.hits == 0);
    bench_free(&b);

    // a lamp outside of a closed ball; the brightest light everywhere would read pi 7
    b = bench_of(
        "WorldBegin Shape \"sphere\"\nAreaLightSource \"diffuse\" \"float scale\" 7 Translate 0 0 3 Shape \"disk\"\n"
        "CoordSysTransform \"world\"\n#@ Meter \"spherical\" \"point3 p\" [0 0 0.2]\n");
    m = measure(&b, s, SR_OK);
    EXPECT(says(&m, "no light found in 4096 samples; below") && says(&m, "inside shape number 1"));
    EXPECT_RELATIVE(m.value[SR_PHOTOPIC].upper, 3 * pi * 7 / 4096, 1e-3);
    EXPECT(m.value[SR_RADIOMETRIC].upper > 0 && m.value[SR_RADIOMETRIC].upper < m.value[SR_PHOTOPIC].upper);
    EXPECT_NEAR(m.value[SR_PHOTOPIC].value, 0, 0);
    bench_free(&b);

    // what a delta light would bring is not known
    b = bench_of(
        "WorldBegin Shape \"sphere\"\nLightSource \"point\" \"point3 from\" [0 0 3]\n#@ Meter \"spherical\"\n");
    m = measure(&b, s, SR_OK);
    EXPECT(says(&m, "there is no bound") && !(m.value[SR_PHOTOPIC].upper > 0));
    bench_free(&b);
}

TEST(what_cannot_be_trusted_is_told)
{
    struct bench b = bench_of(RARE);
    struct sr_measure_settings s = {.samples = 1024, .system = SR_PHOTOPIC};
    struct sr_measurement m = measure(&b, s, SR_OK);
    EXPECT(says(&m, "samples have found light"));
    bench_free(&b);
    // most of the light comes from one direction in a thousand, the rest from everywhere
    b = bench_of(
        "Sampler \"independent\" Integrator \"simplepath\" \"bool samplelights\" false \"integer maxdepth\" 0\nWorldBegin\n"
        "LightSource \"infinite\" \"float scale\" 0.01\n"
        "AreaLightSource \"diffuse\" \"float scale\" 3000 \"bool twosided\" true Shape \"disk\" \"float height\" 1 \"float radius\" 0.03\n"
        "#@ Meter \"irradiance\"\n");
    m = measure(&b, s, SR_OK);
    EXPECT(says(&m, "of the reading: the interval cannot be trusted"));
    bench_free(&b);
    b = bench_of(
        "WorldBegin LightSource \"infinite\" Material \"diffuse\" Shape \"disk\" \"float height\" 0.00001 \"float radius\" 0.2\n"
        "Shape \"disk\" \"float height\" -3\n#@ Meter \"irradiance\"\n");
    m = measure(&b, s, SR_OK);
    EXPECT(says(&m, "other side"));
    bench_free(&b);
}

TEST(limits_are_kept_and_missed_targets_told)
{
    struct bench b = bench_of(RARE);
    struct sr_measure_settings s = {.samples = 8192, .error = 1e-4, .system = SR_PHOTOPIC};
    double start_s = sr_clock_s();
    struct sr_measurement m = measure(&b, s, SR_OK);
    double took_s = sr_clock_s() - start_s; // what the machine can do
    EXPECT(!m.is_on_target && m.samples <= 8192 && says(&m, "was asked for"));
    s = (struct sr_measure_settings){.error = 1e-6, .time_s = 0.2, .system = SR_PHOTOPIC};
    start_s = sr_clock_s();
    m = measure(&b, s, SR_OK);
    EXPECT(!m.is_on_target && m.pilot_samples > 0 && sr_clock_s() - start_s < 5 + 20 * took_s);
    s = (struct sr_measure_settings){.replicates = 1, .system = SR_PHOTOPIC};
    measure(&b, s, SR_ERROR_USAGE);
    bench_free(&b);
}

TEST(a_cancelled_measurement_is_what_there_is)
{
    struct bench b = bench_of(RARE);
    atomic_bool stop = true;
    b.job.cancel = &stop;
    struct sr_measure_settings s = {.samples = 8192, .system = SR_PHOTOPIC};
    struct sr_measurement m = measure(&b, s, SR_CANCELLED);
    EXPECT(!m.is_complete && m.samples == 0 && isnan(m.value[SR_PHOTOPIC].value));
    bench_free(&b);
}

TEST(maps_are_their_cells)
{
    struct bench b = bench_of(
        "WorldBegin LightSource \"point\" \"point3 from\" [0 0 1] \"float power\" 12.566370614359172\n"
        "#@ Meter \"irradiancemap\" \"point3 p\" [-1 -1 0] \"vector3 u\" [4 0 0] \"vector3 v\" [0 2 0] \"integer nx\" 8 \"integer ny\" 3\n");
    struct sr_image *image;
    struct sr_error error = {0};
    struct sr_measure_settings s = {.system = SR_PHOTOPIC};
    EXPECT_EQUAL_INT(sr_measure_map(&b.job, &b.scene.meters[0], &s, &image, &error), SR_OK);
    EXPECT(image->width == 8 && image->height == 3);
    for (uint32_t j = 0; j < 3; ++j)
        for (uint32_t i = 0; i < 8; ++i) {
            enum { N = 16 };
            double x[N], wx[N], y[N], wy[N], E = 0; // h / r^3, mean over the cell
            sr_gauss_legendre(N, -1 + 0.5 * i, -0.5 + 0.5 * i, x, wx);
            sr_gauss_legendre(N, -1 + j * 2 / 3., -1 + (j + 1) * 2 / 3., y, wy);
            for (int k = 0; k < N * N; ++k)
                E += wx[k % N] * wy[k / N] * pow(1 + x[k % N] * x[k % N] + y[k / N] * y[k / N], -1.5) / (0.5 * 2 / 3);
            const float *pixel = image->floats + sr_image_index(image, i, 2 - j);
            EXPECT(pixel[1] > 0 && pixel[1] < 0.01f * pixel[0]);
            EXPECT_NEAR(pixel[0], E, 10 * (double)pixel[1] + 2e-6 * E);
        }
    sr_image_free(image);
    bench_free(&b);
}

TEST(maps_of_shapes_follow_their_texture_coordinates)
{
    // a ball of radius 2 around the origin in the light of a distant source from +z, E = 10: 10 cos(theta) outside, by
    // v = theta
    struct bench b = bench_of(
        "WorldBegin LightSource \"distant\" \"float illuminance\" 10 \"point3 from\" [0 0 1] \"point3 to\" [0 0 0]\n"
        "#@ Name \"ball\"\nShape \"sphere\" \"float radius\" 2\n"
        "#@ Meter \"irradiancemap\" \"string surface\" \"ball\" \"integer nx\" 3 \"integer ny\" 6\n");
    struct sr_image *image;
    struct sr_error error = {0};
    struct sr_measure_settings s = {.system = SR_PHOTOPIC, .samples = 4096};
    EXPECT_EQUAL_INT(sr_measure_map(&b.job, &b.scene.meters[0], &s, &image, &error), SR_OK);
    double total = 0;
    for (uint32_t j = 0; j < 6; ++j)
        for (uint32_t i = 0; i < 3; ++i) {
            // v runs from the pole at -z: mean of max(0, -cos) over the band of theta = pi v
            double a = pi * j / 6, z0 = cos(a), z1 = cos(a + pi / 6),
                   E = j < 3 ? 0 : 10 * (z1 * z1 - z0 * z0) / 2 / (z0 - z1);
            const float *pixel = image->floats + sr_image_index(image, i, 5 - j);
            EXPECT_NEAR(pixel[0], E, 6 * (double)pixel[1] + 1e-5);
            EXPECT(pixel[1] < 0.05f);
            total += (double)pixel[0] * (z0 - z1) / 2 / 3;
        }
    EXPECT_NEAR(total, 2.5, 0.02); // E / 4 over the whole ball
    sr_image_free(image);
    bench_free(&b);
}
