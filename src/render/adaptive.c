/* SPDX-License-Identifier: MIT */
/* More samples where a picture is noisy, without bias.
 *
 *     n_A(p) = n (0.1 + 0.9 sigma_B(p) / mean sigma_B),   picture = (mean_A + mean_B) / 2,
 *         and the same with A and B changed
 *
 * sigma^2: variance of a sample's luminance in the pilot, averaged over 7 x 7 pixels, so that a pixel whose pilot found
 * nothing still gets what its neighbours need. Given B's pilot, n_A is a number, so that E[mean_A] is what it is for
 * any number: the halves cross over once, for a second decision would know of A's own values through B's counts. For a
 * relative root mean square error T of a picture of mean Y:  n = mean(sigma^2 / (0.1 + 0.9 sigma / mean sigma)) / (T
 * Y)^2. Crossed halves against the bias of stopping rules: D. Kirk & J. Arvo 1991 describe the bias; C. Stein 1945 the
 * two stages. Limits: the error that was aimed at is reached as far as the pilot knows sigma. */
#include "render/private.h"

enum { REPLICATES = 4, MOST_PILOT = 64, REACH = 3 }; // replicates of a half's pilot, and of what follows; reach [pixel]
static const double even_share = 0.1;
#define PILOT_SHARE 0.05 // of the work, for progress: each half's pilot

/* Half a picture. */
struct half {
    struct sr_film *film;
    double Y, sigma, cost; // means: luminance, deviation of a sample, sigma^2 / (even share + …) [cd/m^2, squared]
    float *deviation;      // of a sample, for each pixel [cd/m^2]
    uint32_t *counts;      // further samples of each pixel and replicate
};

/* Deviations over windows, by running sums along rows, then along columns. */
static bool find_deviations(struct half *h, const double w[3])
{
    uint32_t width = h->film->width, height = h->film->height;
    size_t count = (size_t)width * height;
    double *rows = sr_alloc(count * sizeof *rows), *variance = sr_alloc(count * sizeof *variance);
    if (rows && variance)
        for (size_t i = 0; i < count; ++i) {
            struct sr_film_mean m = sr_film_region_mean(h->film, (uint32_t)(i % width), (uint32_t)(i / width),
                                                        (uint32_t)(i % width) + 1, (uint32_t)(i / width) + 1, w);
            h->Y += m.mean / (double)count;
            variance[i] = isfinite(m.standard_error) ? m.standard_error * m.standard_error * h->film->pixels[i].n : 0;
        }
    for (size_t i = 0; rows && variance && i < count; ++i) {
        uint32_t x = (uint32_t)(i % width), lo = x > REACH ? x - REACH : 0,
                 hi = x + REACH < width ? x + REACH : width - 1;
        for (uint32_t k = lo; k <= hi; ++k)
            rows[i] += variance[i - x + k] / (hi - lo + 1);
    }
    for (size_t i = 0; rows && variance && i < count; ++i) {
        uint32_t y = (uint32_t)(i / width), lo = y > REACH ? y - REACH : 0,
                 hi = y + REACH < height ? y + REACH : height - 1;
        double sum = 0;
        for (uint32_t k = lo; k <= hi; ++k)
            sum += rows[i % width + (size_t)k * width] / (hi - lo + 1);
        h->deviation[i] = (float)sqrt(sum);
        h->sigma += sqrt(sum) / (double)count;
    }
    for (size_t i = 0; rows && variance && i < count && h->sigma > 0; ++i) {
        double s = (double)h->deviation[i];
        h->cost += s * s / (even_share + (1 - even_share) * s / h->sigma) / (double)count;
    }
    bool is_done = rows && variance;
    sr_free(rows);
    sr_free(variance);
    return is_done;
}

/* Samples per pixel on average that `by` asks for, of both halves together. */
static double wanted_spp(const struct sr_render_job *job, const struct half *by, uint32_t pilot, double pilot_s)
{
    double n = job->spp, error = job->adaptive.error * by->Y;
    if (error > 0)
        n = fmin(n, by->cost / (error * error));
    else if (job->adaptive.error > 0) // nothing was found: a longer look, but not the longest
        n = fmin(n, 16.0 * pilot);
    if (job->adaptive.time_s > 0 && pilot_s > 0)
        n = fmin(n, pilot * job->adaptive.time_s / pilot_s);
    return n;
}

/* Further samples of a half's replicates, as the other half sees fit. */
static void share_out(struct half *h, const struct half *by, double spp, uint32_t pilot)
{
    size_t count = (size_t)h->film->width * h->film->height;
    for (size_t i = 0; i < count; ++i) {
        double relative = by->sigma > 0 ? (double)by->deviation[i] / by->sigma : 1;
        double n = spp * (even_share + (1 - even_share) * relative), left = (n - pilot) / (2 * REPLICATES);
        h->counts[i] = left > 1 ? left < 1e9 ? (uint32_t)ceil(left) : 1000000000u : 1;
    }
}

static bool settle_counts(const struct sr_render_job *job, struct half half[2], uint32_t pilot, double pilot_s)
{
    const struct sr_colour_space *space = sr_colour_space(job->film.space);
    for (int i = 0; i < 2; ++i)
        if (!find_deviations(&half[i], space->xyz_from_rgb[1]))
            return false;
    for (int i = 0; i < 2; ++i)
        share_out(&half[i], &half[!i], wanted_spp(job, &half[!i], pilot, pilot_s), pilot);
    return true;
}

/* Samples of a half after its pilot. */
static double count_all(const struct half *h)
{
    double sum = 0;
    size_t count = (size_t)h->film->width * h->film->height;
    for (size_t i = 0; i < count; ++i)
        sum += REPLICATES * (double)h->counts[i];
    return sum;
}

static sr_status render_halves(const struct sr_render_job *job, struct half half[2], struct sr_keeper *keeper,
                               struct sr_render_report *report, struct sr_error *error)
{
    struct sr_render_pass pass = {.keeper = keeper, .blocks = REPLICATES, .start_s = sr_clock_s() - report->render_s};
    uint32_t per_replicate = job->spp / (4 * 2 * REPLICATES), most = MOST_PILOT / (2 * REPLICATES);
    pass.per_replicate = per_replicate < 1 ? 1 : per_replicate > most ? most : per_replicate;
    uint32_t pilot = 2 * REPLICATES * pass.per_replicate;
    sr_status status;
    for (; keeper->pass < 2; ++keeper->pass) {
        uint32_t i = keeper->pass;
        pass.film = half[i].film;
        pass.first_replicate = i * REPLICATES;
        pass.share_begin = PILOT_SHARE * i;
        pass.share_end = PILOT_SHARE * (i + 1);
        status = sr_render_pass(job, &pass, report, error);
        if (status != SR_OK)
            return status;
        bool has_sums = !job->crew || !job->crew->is_helper;
        if (i == 1 && has_sums && !settle_counts(job, half, pilot, sr_clock_s() - pass.start_s))
            return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the noise of a picture");
    }
    for (int i = 0; i < 2; ++i)
        if (sr_crew_share(job, half[i].counts, (size_t)half[i].film->width * half[i].film->height, error) != SR_OK)
            return error->status;
    double sum[2] = {count_all(&half[0]), count_all(&half[1])};
    pass.blocks_before = REPLICATES;
    for (; keeper->pass < 4; ++keeper->pass) {
        uint32_t i = keeper->pass - 2;
        pass.film = half[i].film;
        pass.first_replicate = (2 + i) * REPLICATES;
        pass.counts = half[i].counts;
        double split = 2 * PILOT_SHARE + (1 - 2 * PILOT_SHARE) * sum[0] / (sum[0] + sum[1]);
        pass.share_begin = i ? split : 2 * PILOT_SHARE;
        pass.share_end = i ? 1 : split;
        status = sr_render_pass(job, &pass, report, error);
        if (status != SR_OK)
            return status;
    }
    return SR_OK;
}

sr_status sr_render_adaptive(const struct sr_render_job *job, struct sr_film **film, struct sr_render_report *report,
                             struct sr_error *error)
{
    struct half half[2] = {0};
    struct sr_keeper keeper = {.keep = job->keep, .film_count = 2};
    sr_status status = SR_OK;
    for (int i = 0; i < 2 && status == SR_OK; ++i) {
        status = sr_crew_film_create(job, &half[i].film, error);
        if (status != SR_OK)
            break;
        size_t count = (size_t)half[i].film->width * half[i].film->height;
        half[i].deviation = sr_alloc(count * sizeof *half[i].deviation);
        half[i].counts = sr_alloc(count * sizeof *half[i].counts);
        if (!half[i].deviation || !half[i].counts)
            status = sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for adaptive sampling");
        keeper.films[i] = half[i].film;
        keeper.counts[i] = half[i].counts;
    }
    if (status == SR_OK)
        status = sr_keeper_resume(&keeper, report, error);
    if (status == SR_OK)
        status = sr_crew_share_keeper(job, &keeper, error);
    if (status == SR_OK && !keeper.is_complete)
        status = render_halves(job, half, &keeper, report, error);
    sr_keeper_end(&keeper, report);
    if (status == SR_OK || status == SR_CANCELLED) {
        if (!keeper.is_complete)
            sr_film_join_halves(half[0].film, half[1].film);
        *film = half[0].film;
        half[0].film = NULL;
    }
    for (int i = 0; i < 2; ++i) {
        sr_film_destroy(half[i].film);
        sr_free(half[i].deviation);
        sr_free(half[i].counts);
    }
    return status;
}
