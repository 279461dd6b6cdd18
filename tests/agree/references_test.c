/* SPDX-License-Identifier: MIT */
/* Agreement with images that another renderer, pbrt-v4, made of real scenes.
 *
 * Each row has the mean of two pictures of different seeds, and half their difference as means over blocks of 16 x 16
 * pixels. Two pictures of ours give the same pair. A scene agrees when
 *   - each channel's mean is within 0.5 % + 3 standard errors of both,
 *   - at least 99 % of the blocks (97 % where the reference's own mean is uncertain by more than 0.2 %) are within four
 *     combined standard errors, an error being pooled over 3 x 3 blocks, with a floor of 0.1 % of the block.
 * At the few samples taken here for time's sake, one difference of two seeds knows the error of a block badly where
 * lamps are small or glass disperses light; so our own error is the larger of that and of what our error bars say.
 * SR_TEST_SPP sets another number of samples. */
#include "agree/render_helper.h"

enum { BLOCK = 16 };

struct blocks {
    int w, h;
    double *v; // h * w * 3
};

static struct blocks make_blocks(int w, int h)
{
    return (struct blocks){w, h, sr_alloc((size_t)w * (size_t)h * 3 * sizeof(double))};
}

static double *at(const struct blocks *b, int x, int y, int c)
{
    return &b->v[(y * b->w + x) * 3 + c];
}

static struct blocks blocks_of(const struct sr_image *image)
{
    struct blocks b = make_blocks((int)image->width / BLOCK, (int)image->height / BLOCK);
    for (int y = 0; y < b.h * BLOCK; ++y)
        for (int x = 0; x < b.w * BLOCK; ++x)
            for (int c = 0; c < 3; ++c)
                *at(&b, x / BLOCK, y / BLOCK, c) +=
                    (double)image->floats[sr_image_index(image, (uint32_t)x, (uint32_t)y) + (size_t)c] /
                    (BLOCK * BLOCK);
    return b;
}

/* mean square of the half difference over 3 x 3 blocks, edges repeated */
static double pooled(const struct blocks *half, int x, int y, int c)
{
    double sum = 0;
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            int xx = x + i < 0          ? 0
                     : x + i >= half->w ? half->w - 1
                                        : x + i,
                yy = y + j < 0          ? 0
                     : y + j >= half->h ? half->h - 1
                                        : y + j;
            double d = *at(half, xx, yy, c);
            sum += d * d;
        }
    return sum / 9;
}

/* Variance of a block's mean over both pictures, by their error bars: pixels are independent. */
static double told(struct sr_image *const ours[2], int x, int y, int c)
{
    char name[8] = "SE.R";
    name[3] = "RGB"[c];
    double sum = 0;
    for (int k = 0; k < 2; ++k) {
        int channel = sr_image_find_channel(ours[k], name);
        EXPECT(channel >= 0);
        for (int j = 0; j < BLOCK; ++j)
            for (int i = 0; i < BLOCK; ++i) {
                double se = (double)ours[k]
                                ->floats[sr_image_index(ours[k], (uint32_t)(x * BLOCK + i), (uint32_t)(y * BLOCK + j)) +
                                         (size_t)channel];
                sum += se * se;
            }
    }
    return sum / (4.0 * BLOCK * BLOCK * BLOCK * BLOCK);
}

static void image_means(const struct sr_image *image, double mean[3])
{
    for (int c = 0; c < 3; ++c) {
        mean[c] = 0;
        for (size_t i = 0; i < (size_t)image->width * image->height; ++i)
            mean[c] += (double)image->floats[i * image->channel_count + (size_t)c];
        mean[c] /= (double)image->width * image->height;
    }
}

struct row {
    char scene[256], mean_image[256], half_image[256];
    double mean[3], se[3];
};

/* Whether the row agrees; a text says by how much. */
static bool compare_row(const struct row *row, struct sr_image *const ours[2], char *text, size_t size)
{
    char path[1024];
    struct sr_error error = {0};
    struct sr_image *reference, *half_image;
    snprintf(path, sizeof path, "%s/references/%s", SR_TEST_REFERENCE_DIR, row->mean_image);
    if (sr_image_read(path, &reference, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    snprintf(path, sizeof path, "%s/references/%s", SR_TEST_REFERENCE_DIR, row->half_image);
    if (sr_image_read(path, &half_image, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);

    struct blocks a = blocks_of(ours[0]), b = blocks_of(ours[1]), r = blocks_of(reference),
                  half = make_blocks(a.w, a.h), half_reference = make_blocks(a.w, a.h);
    double reference_mean[3], mean_a[3], mean_b[3];
    image_means(reference, reference_mean);
    image_means(ours[0], mean_a);
    image_means(ours[1], mean_b);
    double overall = (reference_mean[0] + reference_mean[1] + reference_mean[2]) / 3;
    for (int y = 0; y < a.h; ++y)
        for (int x = 0; x < a.w; ++x)
            for (int c = 0; c < 3; ++c) {
                *at(&half, x, y, c) = (*at(&a, x, y, c) - *at(&b, x, y, c)) / 2;
                *at(&half_reference, x, y, c) =
                    (double)half_image->floats[sr_image_index(half_image, (uint32_t)x, (uint32_t)y) + (size_t)c];
            }
    int good = 0;
    for (int y = 0; y < a.h; ++y)
        for (int x = 0; x < a.w; ++x) {
            bool is_good = true;
            for (int c = 0; c < 3; ++c) {
                double se = sqrt(fmax(pooled(&half, x, y, c), told(ours, x, y, c)) + pooled(&half_reference, x, y, c)) +
                            1e-3 * *at(&r, x, y, c) + 1e-6 * overall;
                is_good &= fabs((*at(&a, x, y, c) + *at(&b, x, y, c)) / 2 - *at(&r, x, y, c)) <= 4 * se;
            }
            good += is_good;
        }
    double n = (double)a.w * a.h, need = 0.99;
    bool ok = true;
    double ratio[3];
    for (int c = 0; c < 3; ++c) {
        double squares = 0;
        for (int i = 0; i < a.w * a.h; ++i)
            squares +=
                half.v[i * 3 + c] * half.v[i * 3 + c] + half_reference.v[i * 3 + c] * half_reference.v[i * 3 + c];
        double difference = (mean_a[c] + mean_b[c]) / 2 - reference_mean[c];
        ratio[c] = 1 + difference / reference_mean[c];
        ok &= fabs(difference) <= 0.005 * reference_mean[c] + 3 * sqrt(squares) / n;
        if (row->se[c] > 0.002 * row->mean[c])
            need = 0.97;
    }
    ok &= good >= need * n;
    snprintf(text, size, "mean ratio %.4f %.4f %.4f, blocks %.3f (at least %.2f)", ratio[0], ratio[1], ratio[2],
             good / n, need);
    sr_free(a.v), sr_free(b.v), sr_free(r.v), sr_free(half.v), sr_free(half_reference.v);
    sr_image_free(reference);
    sr_image_free(half_image);
    return ok;
}

static bool next_row(char **cursor, struct row *row)
{
    char *line = *cursor;
    if (!line || !*line)
        return false;
    char *end = strchr(line, '\n');
    *cursor = end ? end + 1 : line + strlen(line);
    if (end)
        *end = 0;
    return sscanf(line, "%255s %*d %*d %*d %lf %lf %lf %lf %lf %lf %255s %255s", row->scene, &row->mean[0],
                  &row->mean[1], &row->mean[2], &row->se[0], &row->se[1], &row->se[2], row->mean_image,
                  row->half_image) == 9;
}

TEST(scenes_agree_with_reference_images)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    uint32_t spp = 1; // only that nothing goes wrong: nothing is compared
#else
    uint32_t spp = 16;
#endif
    if (getenv("SR_TEST_SPP"))
        spp = (uint32_t)strtoul(getenv("SR_TEST_SPP"), NULL, 10);
    char *text, *cursor;
    size_t size;
    struct sr_error error = {0};
    if (sr_file_read(test_reference_file("references/manifest.tsv"), 1 << 20, &text, &size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    cursor = strchr(text, '\n') + 1;
    int rows = 0, agree = 0, unsupported = 0;
    struct row row;
    while (next_row(&cursor, &row)) {
        char path[1024], verdict[256];
        snprintf(path, sizeof path, "%s/scenes/%s", SR_TEST_REFERENCE_DIR, row.scene);
        // a lamp of 5 mm, focused by a ball of glass in fog: few samples find it
        struct sr_import_options options = {.spp = spp > 1 && strstr(row.scene, "volumetric-caustic") ? 4 * spp : spp};
        struct sr_import_result scene;
        struct sr_error import_error = {0};
        struct sr_log log = {0};
        if (sr_import_pbrt(path, &options, &scene, &log, &import_error) != SR_OK) {
            if (!strstr(import_error.text, "not supported"))
                test_fail(__FILE__, __LINE__, "%s", import_error.text);
            fprintf(stderr, "  later   %s: %s\n", row.scene, import_error.text);
            ++unsupported;
            sr_import_result_free(&scene);
            continue;
        }
        struct sr_image *images[2];
        struct sr_render_job job = sr_render_job_of(&scene);
        for (uint32_t seed = 0; seed < 2; ++seed) {
            struct sr_render_report report;
            job.seed = seed + 1;
            struct sr_film *film = render_or_fail(&job, &report);
            if (sr_render_image(film, true, false, &images[seed], &error) != SR_OK)
                test_fail(__FILE__, __LINE__, "%s", error.text);
            EXPECT_EQUAL_INT(report.dropped, 0);
            sr_film_destroy(film);
        }
        bool ok = spp < 2 || compare_row(&row, images, verdict, sizeof verdict);
        fprintf(stderr, "  %s %s: %s\n", ok ? "agrees " : "DIFFERS", row.scene, spp < 2 ? "not compared" : verdict);
        ++rows;
        agree += ok;
        sr_image_free(images[0]);
        sr_image_free(images[1]);
        sr_import_result_free(&scene);
    }
    sr_free(text);
    fprintf(stderr, "  %d of %d scenes agree; %d need what is not supported yet\n", agree, rows, unsupported);
    EXPECT_EQUAL_INT(agree, rows);
    EXPECT(rows >= 20);
}
