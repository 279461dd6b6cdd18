/* SPDX-License-Identifier: MIT */
/* Parts of a picture: any partition of the samples, rendered by any threads and tiles, merged in any order, is the
 * picture of one render, to the last bit; what does not belong together is refused. */
#include "import/import.h"
#include "render/render.h"
#include "store/store.h"
#include "test.h"

#define FILM(name)                                                                                                     \
    "Film \"" name "\" \"integer xresolution\" 13 \"integer yresolution\" 9 \"string filename\" \"p.exr\"\n"
#define SOBOL "Sampler \"sobol\" \"integer pixelsamples\" 64\n"
static const char front[] = "LookAt 0 3 -4  0 0.4 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n";
static const char room[] =
    "WorldBegin\nAttributeBegin\nTranslate 0.5 3 0\nAreaLightSource \"diffuse\" \"rgb L\" [9 8 7]\nShape \"sphere\" \"float radius\" 0.3\nAttributeEnd\n"
    "LightSource \"infinite\" \"rgb L\" [0.2 0.3 0.4]\n"
    "AttributeBegin\nTranslate 0 0.6 0\nMaterial \"dielectric\" \"spectrum eta\" \"glass-BK7\"\nShape \"sphere\" \"float radius\" 0.6\nAttributeEnd\n"
    "Material \"diffuse\" \"rgb reflectance\" [0.5 0.6 0.2]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-2 0 -2  2 0 -2  -2 0 2  2 0 2]\n";

static struct sr_import_result world(const char *settings)
{
    struct sr_error error = {0};
    struct sr_log silent = {0};
    struct sr_import_options options = {.threads = 1};
    struct sr_import_result result;
    char path[512], text[4096];
    snprintf(path, sizeof path, "%s/part.pbrt", test_folder());
    snprintf(text, sizeof text, "%s%s%s", front, settings, room);
    if (sr_file_write(path, text, strlen(text), &error) != SR_OK ||
        sr_import_pbrt(path, &options, &result, &silent, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return result;
}

static struct sr_render_job job_of(const struct sr_import_result *w, uint32_t replicates)
{
    return (struct sr_render_job){.scene = w->scene,
                                  .sensor = w->sensor,
                                  .filter = w->filter,
                                  .integrator = w->integrator,
                                  .film = w->film,
                                  .sampler = w->sampler,
                                  .seed = 4,
                                  .spp = w->spp,
                                  .replicates = replicates,
                                  .lambda = {360, 830},
                                  .jitter_pixel = true,
                                  .jitter_lambda = true,
                                  .with_aov = true,
                                  .threads = 2,
                                  .tile = 5};
}

static struct sr_render_part *part_of(const struct sr_render_job *job, uint32_t begin, uint32_t end)
{
    struct sr_error error = {0};
    struct sr_render_part *part;
    struct sr_render_report report;
    struct sr_render_job own = *job;
    own.threads = 1 + (int)(begin % 3);
    own.tile = 3 + (int)(end % 14);
    if (sr_render_samples(&own, (struct sr_render_range){begin, end}, &part, &report, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%u-%u: %s", begin, end, error.text);
    return part;
}

/* The same part, by way of a file. */
static struct sr_render_part *written_and_read(struct sr_render_part *part)
{
    struct sr_error error = {0};
    struct sr_render_part *again = NULL;
    char path[512];
    snprintf(path, sizeof path, "%s/part.srp", test_folder());
    if (sr_render_part_write(part, "key value\n", "name text\n", path, &error) != SR_OK ||
        sr_render_part_read(path, &again, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    EXPECT_EQUAL_TEXT(sr_render_part_identity(again), "key value\n");
    EXPECT_EQUAL_TEXT(sr_render_part_about(again), "name text\n");
    sr_render_part_destroy(part);
    return again;
}

#define EXPECT_SAME_ARRAY(a, b, count) EXPECT(!(a) == !(b) && (!(a) || memcmp(a, b, (count) * sizeof *(a)) == 0))

static void expect_same(const struct sr_film *a, const struct sr_film *b)
{
    size_t n = (size_t)a->width * a->height;
    EXPECT_SAME_ARRAY(a->pixels, b->pixels, n);
    EXPECT_SAME_ARRAY(a->aov, b->aov, n);
    EXPECT_SAME_ARRAY(a->buckets, b->buckets, n * a->settings.buckets);
    EXPECT(!a->splats == !b->splats);
    if (!a->splats)
        return;
    EXPECT(a->splats->groups == b->splats->groups && a->splats->dropped == b->splats->dropped);
    EXPECT_SAME_ARRAY(a->splats->paths, b->splats->paths, a->splats->groups);
    EXPECT_SAME_ARRAY(a->splats->words, b->splats->words, n * 3 * a->splats->groups * 2);
}

/* Cuts at the numbers of `cuts`, which begin with 0 and end with spp, merged from `start` on in steps of `step`. */
static void expect_partition_is_whole(const struct sr_render_job *job, const struct sr_film *whole,
                                      const uint32_t *cuts, uint32_t pieces, uint32_t start, uint32_t step)
{
    struct sr_error error = {0};
    struct sr_render_part *all = NULL;
    for (uint32_t i = 0; i < pieces; ++i) {
        uint32_t k = (start + i * step) % pieces;
        struct sr_render_part *part = part_of(job, cuts[k], cuts[k + 1]);
        if (i < 3)
            part = written_and_read(part);
        EXPECT(!all || !sr_render_part_is_complete(all));
        if (!all) {
            all = part;
            continue;
        }
        if (sr_render_part_add(all, part, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        sr_render_part_destroy(part);
        if (i == pieces / 2)
            all = written_and_read(all);
    }
    EXPECT(sr_render_part_is_complete(all));
    expect_same(sr_render_part_film(all), whole);
    EXPECT_EQUAL_INT(sr_render_part_report(all)->paths, (long long)job->spp * whole->width * whole->height);
    sr_render_part_destroy(all);
}

/* All partitions of a picture of 64 samples, or less of them in slow builds. */
static void expect_any_partition_is_whole(const char *settings, uint32_t replicates, bool has_splats)
{
    struct sr_import_result w = world(settings);
    struct sr_render_job job = job_of(&w, replicates);
    struct sr_error error = {0};
    struct sr_film *whole;
    struct sr_render_report report;
    EXPECT(job.spp == 64);
    if (sr_render(&job, &whole, &report, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    EXPECT(!whole->splats == !has_splats && sr_scene_has_mirrors(w.scene));
    uint32_t singles[65];
    for (uint32_t i = 0; i < 65; ++i)
        singles[i] = i;
    expect_partition_is_whole(&job, whole, (uint32_t[]){0, 64}, 1, 0, 1);
    expect_partition_is_whole(&job, whole, (uint32_t[]){0, 32, 64}, 2, 1, 1);
    expect_partition_is_whole(&job, whole, (uint32_t[]){0, 13, 39, 64}, 3, 1, 2);
    if (!is_slow_build())
        expect_partition_is_whole(&job, whole, singles, 64, 5, 27);
    sr_film_destroy(whole);
    sr_import_result_free(&w);
}

TEST(any_partition_of_path_traced_samples_is_the_whole)
{
    expect_any_partition_is_whole("Integrator \"volpath\"\n" SOBOL FILM("rgb"), 0, false);
}

TEST(any_partition_of_replicates_is_the_whole)
{
    expect_any_partition_is_whole("Integrator \"path\"\n" SOBOL FILM("rgb"), 16, false);
}

TEST(any_partition_of_independent_samples_is_the_whole)
{
    expect_any_partition_is_whole(
        "Integrator \"path\"\nSampler \"independent\" \"integer pixelsamples\" 64\n" FILM("gbuffer"), 0, false);
}

TEST(any_partition_of_spectra_is_the_whole)
{
    expect_any_partition_is_whole("Integrator \"path\"\n" SOBOL FILM("spectral"), 4, false);
}

TEST(any_partition_of_bidirectional_samples_is_the_whole)
{
    expect_any_partition_is_whole("Integrator \"bdpt\"\n" SOBOL FILM("rgb"), 0, true);
}

TEST(any_partition_of_paths_from_the_lights_is_the_whole)
{
    expect_any_partition_is_whole("Integrator \"lightpath\"\n" SOBOL FILM("rgb"), 32, true);
}

TEST(any_partition_of_caustics_is_the_whole)
{
    expect_any_partition_is_whole("Integrator \"caustics\"\n" SOBOL FILM("rgb"), 0, false);
}

/* ---- parts that are interrupted ---- */

struct stopper {
    atomic_bool cancel;
    int left; // units until it is set
};

static void stop(void *user, const struct sr_render_progress *p)
{
    struct stopper *s = user;
    (void)p;
    if (--s->left <= 0)
        atomic_store(&s->cancel, true);
}

static void expect_resumed_parts_are_whole(const char *settings, uint32_t replicates)
{
    struct sr_import_result w = world(settings);
    struct sr_render_job job = job_of(&w, replicates);
    struct sr_error error = {0};
    struct sr_film *whole;
    struct sr_render_report report, uncut;
    if (sr_render(&job, &whole, &uncut, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    char path[512];
    snprintf(path, sizeof path, "%s/part.srk", test_folder());
    struct sr_render_part *all = part_of(&job, 0, 21), *part = NULL;
    struct stopper stopper;
    struct sr_render_keep keep = {.path = path, .identity = "samples 21-64\n", .interval_s = 0.001, .resumes = true};
    job.keep = &keep;
    job.progress = stop;
    job.user = &stopper;
    job.cancel = &stopper.cancel;
    int stops = 0;
    for (sr_status status = SR_CANCELLED; status == SR_CANCELLED; ++stops) {
        stopper = (struct stopper){.left = 3 + stops};
        job.tile = 3 + stops % 4;
        job.threads = 1 + stops % 3;
        status = sr_render_samples(&job, (struct sr_render_range){21, 64}, &part, &report, &error);
        if (status != SR_OK && status != SR_CANCELLED)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        EXPECT((status == SR_OK) == (part != NULL));
    }
    EXPECT(stops > 3 && report.kept.resumed_share > 0);
    EXPECT(sr_render_part_add(all, part, &error) == SR_OK && sr_render_part_is_complete(all));
    expect_same(sr_render_part_film(all), whole);
    EXPECT_EQUAL_INT(sr_render_part_report(all)->paths, (long long)uncut.paths);
    sr_render_part_destroy(part);
    // a part that could not be written, and the checkpoint of another range
    job.cancel = NULL;
    part = part_of(&job, 21, 64);
    EXPECT(sr_render_part_checkpoint(&job, part, &report, &error) == SR_OK);
    sr_render_part_destroy(part);
    EXPECT(sr_render_samples(&job, (struct sr_render_range){21, 64}, &part, &report, &error) == SR_OK &&
           report.kept.resumed_share == 1);
    sr_render_part_destroy(part);
    keep.identity = "samples 21-60\n";
    EXPECT(sr_render_samples(&job, (struct sr_render_range){21, 60}, &part, &report, &error) == SR_ERROR_INPUT &&
           strstr(error.text, "samples"));
    sr_render_forget(&keep);
    sr_render_part_destroy(all);
    sr_film_destroy(whole);
    sr_import_result_free(&w);
}

TEST(interrupted_parts_go_on_to_the_same_sums)
{
    expect_resumed_parts_are_whole("Integrator \"path\"\n" SOBOL FILM("rgb"), 0);
    expect_resumed_parts_are_whole("Integrator \"bdpt\"\n" SOBOL FILM("rgb"), 16);
    expect_resumed_parts_are_whole("Integrator \"path\"\n" SOBOL FILM("spectral"), 0);
}

/* ---- what is refused ---- */

static const char plain[] =
    "Integrator \"path\" \"integer maxdepth\" 2\nSampler \"sobol\" \"integer pixelsamples\" 10\n" FILM("rgb");

TEST(blocks_that_are_no_full_trees_are_folded_as_one_render_does)
{
    struct sr_import_result w = world(plain);
    for (uint32_t spp = 1; spp <= 29; spp += 4) {
        struct sr_render_job job = job_of(&w, spp % 5 == 0 ? 5 : 0);
        struct sr_error error = {0};
        struct sr_film *whole;
        struct sr_render_report report;
        job.spp = spp;
        EXPECT(sr_render(&job, &whole, &report, &error) == SR_OK);
        for (uint32_t cut = 1; cut < spp; cut += 3)
            expect_partition_is_whole(&job, whole, (uint32_t[]){0, cut, spp}, 2, cut % 2, 1);
        sr_film_destroy(whole);
    }
    sr_import_result_free(&w);
}

TEST(ranges_that_make_no_sense_are_refused)
{
    struct sr_import_result w = world(plain);
    struct sr_render_job job = job_of(&w, 0);
    static const struct sr_render_range wrong[] = {{0, 0}, {5, 5}, {6, 5}, {0, 11}, {10, 11}};
    struct sr_render_part *part;
    struct sr_render_report report;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        struct sr_error error = {0};
        EXPECT(sr_render_samples(&job, wrong[i], &part, &report, &error) == SR_ERROR_USAGE && !part);
    }
    struct sr_error error = {0};
    job.adaptive.is_on = true;
    EXPECT(sr_render_samples(&job, (struct sr_render_range){0, 5}, &part, &report, &error) == SR_ERROR_USAGE &&
           strstr(error.text, "adaptive"));
    sr_import_result_free(&w);
}

TEST(parts_with_samples_in_common_are_refused_and_nothing_is_lost)
{
    struct sr_import_result w = world(plain);
    struct sr_render_job job = job_of(&w, 0);
    struct sr_render_part *a = part_of(&job, 0, 6), *b = part_of(&job, 5, 10), *c = part_of(&job, 6, 10);
    struct sr_error error = {0};
    EXPECT(sr_render_part_add(a, b, &error) == SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "samples 5-6 are in both parts");
    struct sr_render_range r;
    EXPECT(sr_render_part_range(a, 0, &r) && r.begin == 0 && r.end == 6 && !sr_render_part_range(a, 1, &r));
    error = (struct sr_error){0};
    EXPECT(sr_render_part_add(a, c, &error) == SR_OK && sr_render_part_is_complete(a));
    struct sr_film *whole;
    struct sr_render_report report;
    EXPECT(sr_render(&job, &whole, &report, &error) == SR_OK);
    expect_same(sr_render_part_film(a), whole);
    sr_film_destroy(whole);
    sr_render_part_destroy(a);
    sr_render_part_destroy(b);
    sr_render_part_destroy(c);
    sr_import_result_free(&w);
}

TEST(parts_of_another_shape_are_refused)
{
    struct sr_import_result w = world(plain);
    struct sr_render_job job = job_of(&w, 0), other = job, bare = job;
    other.spp = 12;
    bare.with_aov = false;
    struct sr_render_part *a = part_of(&job, 0, 5), *b = part_of(&other, 6, 10), *c = part_of(&bare, 5, 10);
    struct sr_error error = {0};
    EXPECT(sr_render_part_add(a, b, &error) == SR_ERROR_INPUT);
    error = (struct sr_error){0};
    EXPECT(sr_render_part_add(a, c, &error) == SR_ERROR_INPUT);
    sr_render_part_destroy(a);
    sr_render_part_destroy(b);
    sr_render_part_destroy(c);
    sr_import_result_free(&w);
}

/* A store whose checksums are right, but whose sections are not those of a part. */
TEST(files_that_lie_are_refused)
{
    struct sr_import_result w = world(plain);
    struct sr_render_job job = job_of(&w, 0);
    struct sr_render_part *part = part_of(&job, 2, 9), *again;
    struct sr_error error = {0};
    char path[512], lie[512];
    snprintf(path, sizeof path, "%s/true.srp", test_folder());
    snprintf(lie, sizeof lie, "%s/lie.srp", test_folder());
    EXPECT(sr_render_part_write(part, "a 1\n", "b 2\n", path, &error) == SR_OK);
    sr_render_part_destroy(part);
    struct sr_store_in *in;
    EXPECT(sr_store_open(path, "part", &in, &error) == SR_OK);
    const char *name;
    size_t size;
    int sections = 0, refused = 0, tried = 0;
    for (uint32_t victim = 0; sr_store_section(in, victim, &name, &size); ++victim, ++sections)
        // left out, cut short, or a number of it changed
        for (int how = -2; how < 4 * 40; ++how) {
            static const uint32_t values[4] = {0, 1, 0x7fffffff, 0xffffffff};
            bool has_numbers = strcmp(name, "head") == 0 || strcmp(name, "nodes") == 0;
            if (how >= 0 && (!has_numbers || (size_t)how >= size))
                break;
            struct sr_store_out *out;
            EXPECT(sr_store_create(lie, "part", &out, &error) == SR_OK);
            const char *other;
            size_t B;
            for (uint32_t i = 0; sr_store_section(in, i, &other, &B); ++i) {
                char *data = sr_alloc(B + 1);
                memcpy(data, sr_store_get(in, other, &B), B);
                if (i == victim && how >= 0)
                    memcpy(data + how / 4 * 4, &values[how % 4], 4);
                if (i != victim || how != -2)
                    EXPECT(sr_store_put(out, other, data, B - (i == victim && how == -1), &error) == SR_OK);
                sr_free(data);
            }
            EXPECT(sr_store_finish(out, false, &error) == SR_OK);
            struct sr_error told = {0};
            ++tried;
            if (sr_render_part_read(lie, &again, &told) ==
                SR_OK) { // numbers that only describe the picture: it can be had
                struct sr_image *image;
                EXPECT(sr_render_image(sr_render_part_film(again), true, sr_render_part_is_replicated(again), &image,
                                       &told) == SR_OK);
                sr_image_free(image);
                sr_render_part_destroy(again);
            } else
                refused += told.status == SR_ERROR_INPUT && strstr(told.text, "lie.srp");
        }
    EXPECT(sections >= 10 && tried > 2 * sections + 160);
    EXPECT(refused >= 2 * sections + 60);
    sr_store_close(in);
    sr_import_result_free(&w);
}

TEST(a_part_that_is_cancelled_is_none)
{
    struct sr_import_result w = world(plain);
    struct sr_render_job job = job_of(&w, 0);
    atomic_bool cancel = true;
    job.cancel = &cancel;
    struct sr_render_part *part;
    struct sr_render_report report;
    struct sr_error error = {0};
    EXPECT(sr_render_samples(&job, (struct sr_render_range){0, 5}, &part, &report, &error) == SR_CANCELLED && !part);
    sr_import_result_free(&w);
}
