/* SPDX-License-Identifier: MIT */
/* Rounds of samples: R independently scrambled replicates give the mean and Student's interval.
 *
 *     X = 1/R SUM X_r,    u^2 = 1/(R (R - 1)) SUM (X_r - X)^2,    nu = R - 1
 *
 * To a target: rounds grow, each with random numbers of its own; how many samples the last one takes follows from the
 * rounds before it, and it alone is the result (the two stages of Stein 1945, of which the first may be repeated).
 * Whoever stopped as soon as the error looks small would keep the runs that have missed the bright paths. */
#include "render/measure.h"

#include <string.h>

enum { UNIT = 256, MOST_UNITS = 64, DEFAULT_REPLICATES = 16, DEFAULT_SAMPLES = 65536, PILOT = 256 };
static const uint64_t most_per_replicate = (uint64_t)1 << 31;

/* ---- a round ---- */

struct batch {
    const struct measuring *m;
    uint64_t begin, end; // samples of each replicate
    uint32_t units;
    struct measure_sums *sums; // of replicate r and unit k: sums[r * units + k]
};

static void run_unit(void *context, uint64_t i)
{
    const struct batch *b = context;
    uint64_t r = i / b->units, k = i % b->units, begin = b->begin + k * UNIT,
             end = begin + UNIT < b->end ? begin + UNIT : b->end;
    if (!measure_is_cancelled(b->m->job))
        measure_run(b->m, (uint32_t)r, begin, end, &b->sums[i]);
}

/* Sums over n samples of each replicate: channels[r * m->channels + c]. Units are merged in their order, so that the
 * result does not depend on threads. Cancelled: what whole batches have brought. */
static void run_round(const struct measuring *m, uint64_t n, struct measure_sums *units, double *unit_channels,
                      struct measure_sums *total)
{
    double *channels = total->channels;
    *total = (struct measure_sums){.least = INFINITY, .channels = channels};
    memset(channels, 0, (size_t)m->replicates * m->channels * sizeof *channels);
    int threads = m->job->threads > 0 ? m->job->threads : sr_thread_count();
    uint32_t batch_units = 1;
    for (uint64_t begin = 0; begin < n && !measure_is_cancelled(m->job);) {
        uint64_t end = begin + (uint64_t)batch_units * UNIT < n ? begin + (uint64_t)batch_units * UNIT : n;
        struct batch b = {
            .m = m, .begin = begin, .end = end, .units = (uint32_t)((end - begin + UNIT - 1) / UNIT), .sums = units};
        uint32_t count = b.units * m->replicates;
        memset(unit_channels, 0, (size_t)count * m->channels * sizeof *unit_channels);
        for (uint32_t i = 0; i < count; ++i)
            units[i] = (struct measure_sums){.least = INFINITY, .channels = unit_channels + (size_t)i * m->channels};
        double start_s = sr_clock_s();
        sr_parallel_for(threads, count, run_unit, &b);
        if (measure_is_cancelled(m->job))
            return;
        for (uint32_t i = 0; i < count; ++i) {
            const struct measure_sums *u = &units[i];
            total->samples += u->samples;
            total->hits += u->hits;
            total->dropped += u->dropped;
            total->total += u->total;
            total->largest = fmax(total->largest, u->largest);
            total->least = fmin(total->least, u->least);
            for (uint32_t c = 0; c < m->channels; ++c)
                channels[(i / b.units) * m->channels + c] += u->channels[c];
        }
        begin = end;
        if (sr_clock_s() - start_s < 0.1 && batch_units < MOST_UNITS)
            batch_units *= 2;
    }
}

/* ---- readings ---- */

/* What float arithmetic leaves of a value's digits, as a standard uncertainty of type B: 1e-6 of it. */
static struct sr_quantity with_rounding(struct sr_quantity q, double rounding)
{
    double u[2] = {q.u, rounding}, degrees[2] = {q.degrees, INFINITY};
    if (!(rounding > 0))
        return q;
    double effective = floor(sr_effective_degrees(u, degrees, 2) + 1e-6); // GUM G.4.1: to the next lower integer
    q.degrees = effective < 1e4 ? effective : INFINITY;
    q.u = hypot(q.u, rounding);
    return q;
}

/* Nets count evenly: of n samples that are a or b, all replicates may hold the same number of each, although the share
 * of b is no multiple of 1/n. What such replicates cannot show is at most what 3 samples in all would change (the rule
 * of three at 95 %, as where nothing is found), so that u is taken to be half of that at least. [1] of the value */
static double resolution(const struct measure_sums *total)
{
    return total->total > 0 ? 1.5 * (total->largest - total->least) / total->total : 0;
}

static struct sr_quantity reading_of(const struct measuring *m, const struct measure_sums *total, uint32_t channel,
                                     struct sr_unit unit)
{
    struct sr_tally tally = {0};
    double n = (double)total->samples / m->replicates;
    for (uint32_t r = 0; r < m->replicates; ++r)
        sr_tally_add(&tally, total->channels[(size_t)r * m->channels + channel] / n);
    struct sr_quantity q = sr_quantity_of_tally(&tally, unit);
    q.u = fmax(q.u, resolution(total) * fabs(q.value));
    return with_rounding(q, 1e-6 * fabs(q.value));
}

/* Ratios of X, Y, Z: from the sums of all replicates, with the uncertainty of the jackknife (Quenouille 1956, Tukey
 * 1958). */
static void read_colour(const struct measuring *m, const struct measure_sums *total, struct sr_measurement *out)
{
    static const uint32_t channel[3] = {MEASURE_X, SR_PHOTOPIC, MEASURE_Z};
    uint32_t R = m->replicates;
    double n = (double)total->samples / R, all[3] = {0}, mean[SR_COLOUR_COUNT] = {0}, m2[SR_COLOUR_COUNT] = {0},
           c[SR_COLOUR_COUNT];
    for (uint32_t r = 0; r < R; ++r)
        for (int i = 0; i < 3; ++i)
            all[i] += total->channels[(size_t)r * m->channels + channel[i]];
    for (uint32_t r = 0; r < R; ++r) {
        for (int i = 0; i < 3; ++i)
            c[i] = (all[i] - total->channels[(size_t)r * m->channels + channel[i]]) / (n * (R - 1));
        sr_colour_of(c);
        for (int i = 0; i < SR_COLOUR_COUNT; ++i) {
            double d = c[i] - mean[i];
            mean[i] += d / (r + 1);
            m2[i] += d * (c[i] - mean[i]);
        }
    }
    for (int i = 0; i < 3; ++i)
        c[i] = all[i] / (n * R);
    sr_colour_of(c);
    for (int i = 0; i < SR_COLOUR_COUNT; ++i) {
        struct sr_quantity q = {.value = c[i],
                                .u = sqrt(m2[i] * (R - 1) / R),
                                .degrees = R - 1,
                                .unit =
                                    i <= SR_COLOUR_Z ? out->value[SR_PHOTOPIC].unit : (struct sr_unit){.second = 0}};
        out->colour[i] = with_rounding(q, i == SR_COLOUR_DUV   ? 1e-6
                                          : i == SR_COLOUR_CCT ? 1e-5 * c[i]
                                                               : 1e-6 * fabs(c[i]));
    }
}

static void read_all(const struct measuring *m, const struct measure_sums *total, struct sr_measurement *out)
{
    enum sr_kind kind = m->meter->model->kind;
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
        out->value[i] = reading_of(m, total, (uint32_t)i, sr_unit_of(kind, (enum sr_system)i, false));
    if (m->settings->with_colour)
        read_colour(m, total, out);
    for (uint32_t k = 0; k < m->settings->spectrometer.count; ++k)
        out->spectrum[k] = reading_of(m, total, MEASURE_BINS + k, sr_unit_of(kind, SR_RADIOMETRIC, true));
    out->samples = total->samples;
    out->hits = total->hits;
    out->dropped = total->dropped;
    out->largest_share = total->total > 0 ? total->largest / total->total : 0;
}

/* ---- rounds ---- */

/* Rounded up to a multiple of a power of two that is at most a quarter of it: nets are even there. */
static uint64_t whole_net(double n)
{
    if (n >= (double)most_per_replicate)
        return most_per_replicate;
    uint64_t whole = n < 1 ? 1 : (uint64_t)ceil(n), step = 1;
    while (step * 8 <= whole)
        step *= 2;
    return (whole + step - 1) / step * step;
}

/* How many samples of each replicate the target needs, by the round before: u^2 falls as 1/n at least. The factor makes
 * up for the chance in both rounds' u^2, so that nine of ten last rounds meet the target. */
static double needed(const struct measuring *m, const struct sr_measurement *now, uint64_t n)
{
    const struct sr_quantity *q = &now->value[m->settings->system];
    double relative = sr_quantity_expanded(q, 0.95) / fabs(q->value) / m->settings->error;
    double chance = 1 + 3.6 / sqrt(m->replicates - 1.0);
    return isfinite(relative) && now->hits ? (double)n * relative * relative * chance : INFINITY;
}

struct plan {
    uint64_t n;
    bool is_last;
};

/* What comes after a round of n samples that has taken elapsed_s in all. The last one takes no fewer: where u falls
 * faster than 1 / sqrt(n), as with nets, it rises faster too. */
static struct plan plan_next(const struct measuring *m, const struct sr_measurement *now, uint64_t n, uint64_t most,
                             double round_s, double elapsed_s)
{
    const struct sr_measure_settings *s = m->settings;
    double need = s->error > 0 ? needed(m, now, n) : INFINITY, limit = (double)most;
    if (s->time_s > 0)
        limit = fmin(limit, fmax(PILOT, 0.95 * (s->time_s - elapsed_s) * (double)n / fmax(round_s, 1e-6)));
    double grown = 8.0 * (double)n;
    bool is_last = need <= 2 * grown || limit <= 2 * grown;
    double next = is_last ? fmin(fmax(need, (double)n), limit) : grown;
    double whole = (double)whole_net(next);
    return (struct plan){(uint64_t)fmax(1, fmin(whole, limit)), is_last};
}

static sr_status check(const struct sr_measure_settings *s, struct sr_error *error)
{
    if (s->replicates < 2 || s->replicates > 4096)
        return sr_fail(error, SR_ERROR_USAGE, "%u replicates: expected 2 to 4096", (unsigned)s->replicates);
    if (!(s->error >= 0 && s->error < 1) || !(s->time_s >= 0))
        return sr_fail(error, SR_ERROR_USAGE, "a target of %g and a time of %g s: expected 0 to 1 and 0 or more",
                       s->error, s->time_s);
    return SR_OK;
}

static void run_rounds(struct measuring *m, struct measure_sums *units, double *unit_channels,
                       struct measure_sums *total, struct sr_measurement *out)
{
    const struct sr_measure_settings *s = m->settings;
    double start_s = sr_clock_s();
    bool is_planned = s->error > 0 || s->time_s > 0;
    uint64_t all = s->samples   ? s->samples
                   : is_planned ? UINT64_MAX
                                : DEFAULT_SAMPLES,
             most = all / m->replicates + (all % m->replicates != 0);
    most = most < most_per_replicate ? most : most_per_replicate;
    struct plan plan = is_planned && most > PILOT ? (struct plan){PILOT, false} : (struct plan){most, true};
    for (m->round = 0;; ++m->round) {
        double round_start_s = sr_clock_s();
        run_round(m, plan.n, units, unit_channels, total);
        out->is_complete = !measure_is_cancelled(m->job);
        if (!out->is_complete && total->samples == 0 && out->samples) { // the last whole round is what there is
            out->pilot_samples -= out->samples;
            break;
        }
        if (total->samples)
            read_all(m, total, out);
        if (plan.is_last || !out->is_complete)
            break;
        out->pilot_samples += total->samples;
        double now_s = sr_clock_s();
        plan = plan_next(m, out, plan.n, most, now_s - round_start_s, now_s - start_s);
    }
    out->elapsed_s = sr_clock_s() - start_s;
    const struct sr_quantity *q = &out->value[s->system];
    out->is_on_target = s->error == 0 || sr_quantity_expanded(q, 0.95) <= s->error * fabs(q->value);
}

static void clear(struct sr_measurement *out, const struct measuring *m)
{
    *out = (struct sr_measurement){.spectrum = out->spectrum};
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
        out->value[i] = (struct sr_quantity){
            .value = NAN, .u = NAN, .unit = sr_unit_of(m->meter->model->kind, (enum sr_system)i, false)};
    for (int i = 0; i < SR_COLOUR_COUNT; ++i)
        out->colour[i] = (struct sr_quantity){.value = NAN, .u = NAN};
    for (uint32_t k = 0; k < m->settings->spectrometer.count; ++k)
        out->spectrum[k] = (struct sr_quantity){
            .value = NAN, .u = NAN, .unit = sr_unit_of(m->meter->model->kind, SR_RADIOMETRIC, true)};
}

sr_status sr_measure(const struct sr_render_job *job, const struct sr_meter *meter,
                     const struct sr_measure_settings *settings, struct sr_arena *arena, struct sr_measurement *out,
                     struct sr_error *error)
{
    struct sr_measure_settings s = *settings;
    s.replicates = s.replicates ? s.replicates : DEFAULT_REPLICATES;
    struct measuring m = {.job = job,
                          .meter = meter,
                          .settings = &s,
                          .replicates = s.replicates,
                          .channels = MEASURE_BINS + s.spectrometer.count,
                          .stream = UINT32_MAX - s.stream,
                          .cell = UINT32_MAX,
                          .lambda = job->lambda};
    if (s.spectrometer.count) {
        const struct sr_spectrometer *sp = &s.spectrometer;
        m.lambda.lo = fminf(m.lambda.lo, (float)fmax(1, sp->first - sp->fwhm));
        m.lambda.hi = fmaxf(m.lambda.hi, (float)(sp->first + sp->step * (sp->count - 1) + sp->fwhm));
    }
    measure_prepare(&m);
    *out = (struct sr_measurement){0};
    sr_status status = check(&s, error);
    if (status != SR_OK)
        return status;
    struct sr_arena scratch = {0};
    uint32_t units = MOST_UNITS * m.replicates;
    struct measure_sums *sums = sr_arena_alloc(&scratch, units * sizeof *sums);
    double *unit_channels = sr_arena_alloc(&scratch, (size_t)units * m.channels * sizeof *unit_channels);
    struct measure_sums total = {.channels =
                                     sr_arena_alloc(&scratch, (size_t)m.replicates * m.channels * sizeof(double))};
    if (s.spectrometer.count)
        out->spectrum = sr_arena_alloc(arena, s.spectrometer.count * sizeof *out->spectrum);
    if (!sums || !unit_channels || !total.channels || (s.spectrometer.count && !out->spectrum)) {
        sr_arena_free(&scratch);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to measure");
    }
    clear(out, &m);
    if (job->integrator.model == &sr_integrator_quadrature) {
        status = measure_by_quadrature(&m, out, error);
    } else {
        run_rounds(&m, sums, unit_channels, &total, out);
        measure_remarks(&m, out);
    }
    sr_arena_free(&scratch);
    if (status != SR_OK)
        return status;
    return out->is_complete ? SR_OK : SR_CANCELLED;
}

struct sr_irradiance sr_render_irradiance(const struct sr_render_job *job, sr_vec3 p, sr_vec3 n, uint32_t samples,
                                          uint32_t replicates)
{
    struct sr_arena arena = {0};
    struct sr_meter meter = sr_meter_irradiance_at(&arena, p, n);
    struct sr_measure_settings settings = {
        .samples = (uint64_t)samples * replicates, .replicates = replicates, .system = SR_PHOTOPIC};
    struct sr_measurement m;
    struct sr_error error = {0};
    struct sr_irradiance E = {NAN, NAN, NAN, NAN, replicates - 1}; // until measured: no memory, no number
    if (meter.model && sr_measure(job, &meter, &settings, &arena, &m, &error) == SR_OK)
        E = (struct sr_irradiance){m.value[SR_PHOTOPIC].value, m.value[SR_PHOTOPIC].u, m.value[SR_RADIOMETRIC].value,
                                   m.value[SR_RADIOMETRIC].u, replicates - 1};
    sr_arena_free(&arena);
    return E;
}
