/* SPDX-License-Identifier: MIT */
/* The certificate of a specimen or of a model: sets of parameters are looked at, in parallel, and the worst is told.
 *
 * Statistical tests share one significance: with T tests in all, each may fail with the probability significance / T
 * (Bonferroni), so that a sound model fails its certificate with less than the significance asked for. What every set
 * shows a little of, none alone would prove: lost samples and the bias of the light are also summed over all sets. */
#include "lab/certificate.h"

#include <stdio.h>
#include <string.h>

/* What the checks are called, what they measure, and what is allowed. */
static const struct {
    const char *name, *unit;
    double limit;       // NaN: depends
    bool is_comparison; // 0: equal
} kinds[CHECKS] = {
    [CHECK_FINITE] = {"finite", "1", 0, false},
    [CHECK_NON_NEGATIVE] = {"non-negative", "1/sr", 0, false},
    [CHECK_RECIPROCITY] = {"reciprocity", "1", 2e-3, true},
    [CHECK_ADJOINT] = {"adjoint", "1", 2e-3, true},
    [CHECK_ENERGY] = {"energy", "1", 1, false},
    [CHECK_ALBEDO] = {"albedo", "1", (double)NAN, true},
    [CHECK_NORMALISATION] = {"normalisation", "1", 1.0005, false},
    [CHECK_LOST] = {"lost samples", "1", (double)NAN, false},
    [CHECK_SAMPLING] = {"sampling", "1", (double)NAN, false},
    [CHECK_LIGHT] = {"light", "1", (double)NAN, false},
    [CHECK_F_PDF] = {"f_pdf", "1", 0, true},
    [CHECK_SAMPLE] = {"sample", "1", 2e-3, true},
    [CHECK_SUPPORT] = {"support", "1/sr", 0, false},
    [CHECK_LOBES] = {"lobes", "1", 0, false},
    [CHECK_DOUBLE] = {"double", "1", 2e-3, true},
    [CHECK_GRAZING] = {"grazing", "1", 1, false},
    [CHECK_NORMAL] = {"normal incidence", "1", 0.05, false},
    [CHECK_ENDS] = {"range ends", "1", 1, false},
};

void lab_find(struct certifying *c, enum check check, double measured, bool failed, const char *format, ...)
{
    struct finding *f = &c->findings->of[check];
    bool is_worse = f->count == 0 || (failed && !f->failed) || (failed == f->failed && !(measured <= f->measured));
    ++f->count;
    if (!is_worse)
        return;
    f->measured = measured;
    f->failed = failed;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(f->text, sizeof f->text, format, arguments);
    va_end(arguments);
    size_t n = strlen(f->text);
    if (n > 2 && strcmp(f->text + n - 2, "; ") == 0) // no parameters to tell
        f->text[n - 2] = 0;
}

void lab_skip(struct certifying *c, enum check check, const char *why)
{
    struct finding *f = &c->findings->of[check];
    if (f->count == 0 && !f->text[0])
        snprintf(f->text, sizeof f->text, "%s", why);
}

static void merge(struct findings *all, const struct findings *more)
{
    for (int i = 0; i < CHECKS; ++i) {
        struct finding *a = &all->of[i];
        const struct finding *b = &more->of[i];
        bool is_worse = b->count && (a->count == 0 || (b->failed && !a->failed) ||
                                     (a->failed == b->failed && !(b->measured <= a->measured)));
        uint64_t count = a->count + b->count;
        if (is_worse || (count == 0 && !a->text[0]))
            *a = *b;
        a->count = count;
    }
    all->lost += more->lost;
    all->lost_variance += more->lost_variance;
    all->lost_slack += more->lost_slack;
    all->light_z += more->light_z;
    all->light_count += more->light_count;
    all->evaluations += more->evaluations;
}

/* ---- one set of parameters ---- */

struct work {
    const struct sr_bsdf_model *model;  // drawn from, or
    const struct sr_specimen *specimen; // as it is
    const struct sr_certificate_options *options;
    uint32_t sets, ends, samples, directions;
    double p, z;
    struct findings *findings; // one a set, then one an end
    struct sr_error *errors;
    struct sr_arena *arenas;
};

static void certify_set(void *context, uint64_t i)
{
    struct work *w = context;
    struct subject *s = sr_alloc(sizeof *s);
    if (!s) {
        sr_fail(&w->errors[i], SR_ERROR_RESOURCE, "not enough memory for a certificate");
        return;
    }
    struct certifying c = {.options = w->options,
                           .findings = &w->findings[i],
                           .error = &w->errors[i],
                           .subject = s,
                           .rng = sr_rng_seed(w->options->seed, i + 1),
                           .samples = w->samples,
                           .directions = w->directions,
                           .p = w->p,
                           .z = w->z};
    sr_status status = SR_OK;
    bool is_end = i >= w->sets;
    int row = (int)(i - w->sets) / 4, which = (int)(i - w->sets) % 4;
    struct lab_drawing how = {.row = is_end ? row : -1, .at_max = which & 1, .plain = which < 2};
    if (w->specimen)
        lab_subject_of_specimen(w->specimen, s);
    else
        status = lab_draw(w->model, &c.rng, how, &w->arenas[i], s, &w->errors[i]);
    if (status == SR_OK) {
        if (s->is_random)
            c.samples = w->samples / 8 > 2048 ? w->samples / 8 : 2048;
        if (is_end)
            lab_check_end(&c, w->model->params[row].name, which & 1);
        else {
            lab_check_pairs(&c);
            lab_check_extremes(&c);
            lab_check_double(&c);
            lab_check_energy(&c);
            how.broad = true;
            if (!w->specimen)
                status = lab_draw(w->model, &c.rng, how, &w->arenas[i], s, &w->errors[i]);
            if (status == SR_OK)
                lab_check_sampling(&c);
        }
    }
    sr_free(s);
}

/* ---- verdicts ---- */

/* Deviations that no set alone would show. */
static void judge_sums(struct findings *all, const struct work *w)
{
    struct certifying c = {.findings = all};
    double excess = fabs(all->lost) - all->lost_slack, z = excess / sqrt(all->lost_variance + 1);
    double n = (double)all->of[CHECK_LOST].count * w->samples;
    if (all->of[CHECK_LOST].count > 1 && excess > 0 && sr_normal_p_two_sided(z) < w->p)
        lab_find(
            &c, CHECK_LOST, fabs(all->lost) / n, true,
            "of %.0f samples in all sets %.0f %s are lost than the density leaves over: a share of %.2g (z = %.1f)", n,
            fabs(all->lost), all->lost > 0 ? "more" : "fewer", fabs(all->lost) / n, z);
    z = all->light_z / sqrt(fmax(all->light_count, 1));
    if (all->light_count > 1 && fabs(z) > w->z)
        lab_find(&c, CHECK_LIGHT, fabs(z), true, "all sets together: drawn light is %s than described, z = %.1f",
                 z > 0 ? "more" : "less", z);
}

static void judge(const struct findings *all, const struct work *w, double asymmetry, double largest_albedo,
                  struct sr_certificate *out)
{
    *out = (struct sr_certificate){.passed = true};
    for (int i = 0; i < CHECKS; ++i) {
        const struct finding *f = &all->of[i];
        struct sr_check *check = &out->checks[out->count++];
        *check = (struct sr_check){.name = kinds[i].name,
                                   .measured = f->count ? f->measured : (double)NAN,
                                   .limit = kinds[i].limit,
                                   .unit = kinds[i].unit,
                                   .verdict = f->count == 0 ? SR_SKIPPED
                                              : f->failed   ? SR_FAILED
                                                            : SR_PASSED};
        check->count = f->count;
        bool equals = check->verdict == SR_PASSED && f->measured == 0 && kinds[i].is_comparison;
        snprintf(check->text, sizeof check->text, "%s", equals ? "equal everywhere" : f->text);
        if (i == CHECK_LIGHT)
            check->limit = w->z;
        if ((i == CHECK_RECIPROCITY || i == CHECK_ADJOINT) && f->count && asymmetry > 0) {
            // a law that the model breaks by its nature: what is allowed is what its table tells
            check->limit = asymmetry;
            check->verdict = f->measured <= kinds[i].limit ? SR_PASSED
                             : f->measured <= asymmetry    ? SR_DOCUMENTED
                                                           : SR_FAILED;
        }
        if ((i == CHECK_ENERGY || i == CHECK_ENDS || i == CHECK_GRAZING) && f->count && largest_albedo > 1) {
            check->limit = largest_albedo;
            if (!f->failed && f->measured > 1 + 1e-4)
                check->verdict = SR_DOCUMENTED;
        }
        out->passed &= check->verdict != SR_FAILED;
    }
    out->evaluations = all->evaluations;
}

static sr_status certify(struct work *w, struct sr_certificate *out, struct sr_error *error)
{
    const struct sr_certificate_options *o = w->options;
    w->sets = w->specimen ? 1 : o->sets ? o->sets : 1;
    w->samples = o->samples > 2048 ? o->samples : 2048;
    w->directions = w->specimen ? 24 : 2;
    for (const struct sr_param *p = w->model ? w->model->params : NULL; p && p->name; ++p)
        w->ends += 4;
    double tests = w->sets * (w->directions * 6.0 + 8) + w->ends + 2;
    w->p = (o->significance > 0 ? o->significance : 1e-6) / tests;
    w->z = -sr_normal_quantile(w->p / 2);
    uint64_t count = w->sets + w->ends;
    w->findings = sr_alloc((count + 1) * sizeof *w->findings);
    w->errors = sr_alloc(count * sizeof *w->errors);
    w->arenas = sr_alloc(count * sizeof *w->arenas);
    struct findings *all = w->findings ? &w->findings[count] : NULL;
    sr_status status = w->findings && w->errors && w->arenas
                           ? SR_OK
                           : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a certificate");
    if (status == SR_OK) {
        sr_parallel_for(sr_thread_count(), count, certify_set, w);
        for (uint64_t i = 0; i < count; ++i) {
            merge(all, &w->findings[i]);
            if (w->errors[i].status && status == SR_OK)
                status = sr_fail(error, w->errors[i].status, "%s", w->errors[i].text);
            sr_arena_free(&w->arenas[i]);
        }
    }
    if (status == SR_OK) {
        double asymmetry = 0, largest_albedo = 1;
        if (w->specimen) {
            struct subject *s = sr_alloc(sizeof *s);
            if (s) {
                lab_subject_of_specimen(w->specimen, s);
                asymmetry = s->asymmetry;
                largest_albedo = s->largest_albedo;
            } else
                status = sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a certificate");
            sr_free(s);
        } else {
            asymmetry = (double)w->model->asymmetry;
            largest_albedo = (double)sr_max(1, w->model->largest_albedo);
        }
        struct certifying c = {.findings = all};
        lab_skip(&c, CHECK_ENDS, w->specimen ? "parameters are given" : "it has no parameters");
        judge_sums(all, w);
        judge(all, w, asymmetry, largest_albedo, out);
    }
    sr_free(w->findings);
    sr_free(w->errors);
    sr_free(w->arenas);
    return status;
}

sr_status sr_certify_model(const struct sr_bsdf_model *model, const struct sr_certificate_options *options,
                           struct sr_certificate *out, struct sr_error *error)
{
    if (!lab_can_draw(model))
        return sr_fail(error, SR_ERROR_USAGE, "%s reads files: its parameters cannot be drawn at random", model->name);
    struct work w = {.model = model, .options = options};
    return certify(&w, out, error);
}

sr_status sr_certify(const struct sr_specimen *specimen, const struct sr_certificate_options *options,
                     struct sr_certificate *out, struct sr_error *error)
{
    const struct sr_bsdf_model *model = specimen->part_count == 1 ? specimen->parts[0].model : NULL;
    if (options->sets > 0 && model && lab_can_draw(model))
        return sr_certify_model(model, options, out, error);
    struct work w = {.specimen = specimen, .options = options};
    return certify(&w, out, error);
}

/* ---- the soak ---- */

struct soak {
    const struct sr_bsdf_model *model;
    const struct sr_specimen *specimen;
    const struct sr_certificate_options *options;
    uint64_t rounds;
    struct findings *findings; // one a batch
    struct sr_error *errors;
};

enum { SOAK_BATCHES = 64, SOAK_PAIRS = 1000, SOAK_CALLS = 3 }; // a pair: f and pdf together, and a sample

static void soak_batch(void *context, uint64_t batch)
{
    struct soak *w = context;
    struct subject *s = sr_alloc(sizeof *s);
    if (!s) {
        sr_fail(&w->errors[batch], SR_ERROR_RESOURCE, "not enough memory for a certificate");
        return;
    }
    struct certifying c = {.options = w->options,
                           .findings = &w->findings[batch],
                           .error = &w->errors[batch],
                           .subject = s,
                           .rng = sr_rng_seed(w->options->seed + 1000003ull, batch + 1)};
    struct sr_arena arena = {0};
    sr_status status = SR_OK;
    if (w->specimen)
        lab_subject_of_specimen(w->specimen, s);
    for (uint64_t i = batch; i < w->rounds && status == SR_OK; i += SOAK_BATCHES) {
        if (!w->specimen)
            status = lab_draw(w->model, &c.rng, (struct lab_drawing){.row = -1}, &arena, s, &w->errors[batch]);
        for (int k = 0; k < SOAK_PAIRS && status == SR_OK; ++k) {
            sr_vec3 wo = lab_anywhere(&c.rng);
            lab_check_values(&c, CHECK_FINITE, CHECK_FINITE, wo, lab_partner(&c, wo));
        }
        sr_arena_free(&arena);
    }
    sr_free(s);
}

sr_status sr_soak(const struct sr_specimen *specimen, uint64_t calls, const struct sr_certificate_options *options,
                  struct sr_certificate *certificate, struct sr_error *error)
{
    const struct sr_bsdf_model *model = specimen->part_count == 1 ? specimen->parts[0].model : NULL;
    bool draws = options->sets > 0 && model && lab_can_draw(model);
    struct soak w = {.model = draws ? model : NULL,
                     .specimen = draws ? NULL : specimen,
                     .options = options,
                     .rounds = (calls + SOAK_PAIRS * SOAK_CALLS - 1) / (SOAK_PAIRS * SOAK_CALLS),
                     .findings = sr_alloc((SOAK_BATCHES + 1) * sizeof *w.findings),
                     .errors = sr_alloc(SOAK_BATCHES * sizeof *w.errors)};
    sr_status status =
        w.findings && w.errors ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a soak");
    if (status == SR_OK) {
        sr_parallel_for(sr_thread_count(), SOAK_BATCHES, soak_batch, &w);
        struct findings *all = &w.findings[SOAK_BATCHES];
        for (int i = 0; i < SOAK_BATCHES; ++i) {
            merge(all, &w.findings[i]);
            if (w.errors[i].status && status == SR_OK)
                status = sr_fail(error, w.errors[i].status, "%s", w.errors[i].text);
        }
        const struct finding *f = &all->of[CHECK_FINITE];
        struct sr_check *check = &certificate->checks[certificate->count++];
        *check = (struct sr_check){
            .name = "soak", .unit = "1", .measured = (double)f->count, .verdict = f->count ? SR_FAILED : SR_PASSED};
        snprintf(check->text, sizeof check->text, "%s",
                 f->count ? f->text : "no NaN, no infinity, nothing below 0 in so many calls");
        certificate->passed &= f->count == 0;
        certificate->evaluations += w.rounds * SOAK_PAIRS * SOAK_CALLS;
    }
    sr_free(w.findings);
    sr_free(w.errors);
    return status;
}
