/* SPDX-License-Identifier: MIT */
/* The public laboratory: it parts words, checks the arguments and calls the laboratory, one wavelength at a time. */
#include <steradian/bsdf.h>

#include "api/private.h"
#include "lab/lab.h"

#include <string.h>

enum { WORDS = 256 };

struct sr_brdf {
    struct sr_arena arena;
    struct sr_specimen specimen;
    bool is_random; // f is a random walk: each evaluation has a seed of its own
};

/* ---- the list ---- */

const char *sr_brdf_model(int index)
{
    for (int i = 0; i <= index; ++i)
        if (!sr_bsdf_models[i])
            return NULL;
    return index >= 0 ? sr_bsdf_models[index]->name : NULL;
}

const char *sr_brdf_model_title(const char *model)
{
    const struct sr_bsdf_model *m = sr_bsdf_model_find(model);
    return m ? m->title : NULL;
}

const char *sr_brdf_model_source(const char *model)
{
    const struct sr_bsdf_model *m = sr_bsdf_model_find(model);
    return m ? m->source : NULL;
}

const char *sr_brdf_model_limits(const char *model)
{
    const struct sr_bsdf_model *m = sr_bsdf_model_find(model);
    return m ? m->limits : NULL;
}

static enum sr_brdf_parameter_kind public_kind(enum sr_param_kind kind)
{
    return kind == SR_PARAM_FLOAT  ? SR_BRDF_NUMBER
           : kind == SR_PARAM_INT  ? SR_BRDF_INTEGER
           : kind == SR_PARAM_BOOL ? SR_BRDF_SWITCH
           : kind == SR_PARAM_ENUM ? SR_BRDF_CHOICE
           : kind == SR_PARAM_FILE ? SR_BRDF_FILE
                                   : SR_BRDF_SPECTRUM;
}

bool sr_brdf_model_parameter(const char *model, int index, struct sr_brdf_parameter *parameter)
{
    const struct sr_bsdf_model *m = sr_bsdf_model_find(model);
    for (int i = 0; m && i <= index; ++i)
        if (!m->params[i].name)
            return false;
    if (!m || index < 0)
        return false;
    const struct sr_param *p = &m->params[index];
    *parameter =
        (struct sr_brdf_parameter){public_kind(p->kind), p->name, p->unit, p->text, p->min, p->max, p->initial};
    return true;
}

/* ---- one of them ---- */

sr_status sr_brdf_create(const char *words, struct sr_brdf **brdf, char *error, size_t error_size)
{
    struct sr_error e = {0};
    struct sr_brdf *b = sr_alloc(sizeof *b);
    *brdf = NULL;
    if (!b) {
        sr_fail(&e, SR_ERROR_RESOURCE, "not enough memory");
        return api_tell(&e, error, error_size);
    }
    const char *list[WORDS];
    int count = 0;
    char *text = sr_arena_string(&b->arena, words), *rest = text;
    for (char *word; text && count < WORDS && (word = strtok_r(rest, " \t\n", &rest));)
        list[count++] = word;
    if (!text)
        sr_fail(&e, SR_ERROR_RESOURCE, "not enough memory");
    else if (count == WORDS)
        sr_fail(&e, SR_ERROR_USAGE, "a BRDF is described by fewer than %d words", WORDS);
    else
        sr_specimen_read(&b->arena, count, list, &b->specimen, (struct sr_log){0}, &e);
    if (e.status != SR_OK) {
        sr_brdf_destroy(b);
        return api_tell(&e, error, error_size);
    }
    for (int i = 0; i < b->specimen.part_count; ++i)
        b->is_random |= !b->specimen.parts[i].model || b->specimen.parts[i].model->is_random;
    *brdf = b;
    return SR_OK;
}

void sr_brdf_destroy(struct sr_brdf *brdf)
{
    if (!brdf)
        return;
    sr_arena_free(&brdf->arena);
    sr_free(brdf);
}

static sr_vec3 direction(const float w[3])
{
    return (sr_vec3){w[0], w[1], w[2]};
}

void sr_brdf_evaluate(const struct sr_brdf *brdf, double lambda_nm, size_t count, const float (*wo)[3],
                      const float (*wi)[3], float *f, float *pdf)
{
    struct sr_specimen_at at;
    for (size_t i = 0; i < count; ++i) {
        if (i == 0 || brdf->is_random)
            sr_specimen_at(&brdf->specimen, SR_BLACK + (float)lambda_nm, (uint32_t)i, &at);
        float density;
        sr_spectrum value = sr_bsdf_f_pdf(&at.bsdf, direction(wo[i]), direction(wi[i]), SR_RADIANCE, &density);
        if (f)
            f[i] = value[0];
        if (pdf)
            pdf[i] = density;
    }
}

void sr_brdf_draw(const struct sr_brdf *brdf, double lambda_nm, size_t count, const float (*wo)[3], const float (*u)[3],
                  struct sr_brdf_sample *samples)
{
    struct sr_specimen_at at;
    for (size_t i = 0; i < count; ++i) {
        if (i == 0 || brdf->is_random)
            sr_specimen_at(&brdf->specimen, SR_BLACK + (float)lambda_nm, (uint32_t)i, &at);
        struct sr_bsdf_sample s;
        samples[i] = (struct sr_brdf_sample){.pdf = 0};
        bool is_sound = sr_is_finite(direction(wo[i]));
        for (int k = 0; k < 3; ++k)
            is_sound &= u[i][k] >= 0 && u[i][k] < 1;
        if (is_sound &&
            sr_bsdf_sample(&at.bsdf, direction(wo[i]), u[i][0], (sr_vec2){u[i][1], u[i][2]}, SR_RADIANCE, &s))
            samples[i] = (struct sr_brdf_sample){{s.wi.x, s.wi.y, s.wi.z}, s.f[0], s.pdf, s.lobe & SR_LOBE_SPECULAR};
    }
}

/* ---- reflectance ---- */

sr_status sr_brdf_reflectance(const struct sr_brdf *brdf, double lambda_nm, const char *from, const char *to,
                              double tolerance, struct sr_brdf_reflectance *out, char *error, size_t error_size)
{
    struct sr_error e = {0};
    struct sr_beam beams[2];
    struct sr_reflectance r;
    if (!(lambda_nm >= 100 && lambda_nm <= 20000))
        sr_fail(&e, SR_ERROR_USAGE, "a wavelength of %g nm: 100 to 20000 was expected", lambda_nm);
    else if (!(tolerance >= 1e-14 && tolerance <= 0.1))
        sr_fail(&e, SR_ERROR_USAGE, "a tolerance of %g: 1e-14 to 0.1 was expected", tolerance);
    else if (sr_beam_read(from, &beams[0], &e) == SR_OK && sr_beam_read(to, &beams[1], &e) == SR_OK &&
             sr_reflectance_cubature(&brdf->specimen, SR_BLACK + (float)lambda_nm, &beams[0], &beams[1], tolerance, &r,
                                     &e) == SR_OK)
        *out = (struct sr_brdf_reflectance){r.name, r.unit, r.value[0], r.error[0], r.factor[0]};
    return e.status == SR_OK ? SR_OK : api_tell(&e, error, error_size);
}

double sr_brdf_albedo(const struct sr_brdf *brdf, double lambda_nm, double theta_deg, double phi_deg, uint32_t samples,
                      double *standard_error)
{
    double theta = theta_deg * 3.14159265358979324 / 180, phi = phi_deg * 3.14159265358979324 / 180;
    sr_vec3 wo = {(float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta)};
    struct sr_rng rng = sr_rng_seed(1, samples);
    struct sr_tally t = {0};
    struct sr_specimen_at at;
    for (uint32_t i = 0; i < samples && sr_is_finite(wo); ++i) {
        if (i == 0 || brdf->is_random)
            sr_specimen_at(&brdf->specimen, SR_BLACK + (float)lambda_nm, i, &at);
        struct sr_bsdf_sample s;
        float u_lobe = sr_rng_float(&rng), u = sr_rng_float(&rng), v = sr_rng_float(&rng);
        bool is_drawn = sr_bsdf_sample(&at.bsdf, wo, u_lobe, (sr_vec2){u, v}, SR_IMPORTANCE, &s);
        sr_tally_add(&t, is_drawn ? (double)(s.f[0] * fabsf(s.wi.z) / s.pdf) : 0);
    }
    if (standard_error)
        *standard_error = t.n > 1 ? sr_tally_standard_error(&t) : NAN;
    return t.n > 0 ? t.mean : NAN;
}

/* ---- the certificate ---- */

sr_status sr_brdf_check(const struct sr_brdf *brdf, uint32_t sets, uint32_t seed,
                        void (*tell)(void *user, const char *check, enum sr_brdf_verdict verdict, double measured,
                                     double limit, const char *text),
                        void *user, char *error, size_t error_size)
{
    struct sr_error e = {0};
    struct sr_certificate c;
    struct sr_certificate_options options = {.sets = sets, .samples = 100000, .seed = seed, .significance = 1e-6};
    if (sr_certify(&brdf->specimen, &options, &c, &e) != SR_OK)
        return api_tell(&e, error, error_size);
    for (int i = 0; i < c.count && tell; ++i)
        tell(user, c.checks[i].name, (enum sr_brdf_verdict)c.checks[i].verdict, c.checks[i].measured, c.checks[i].limit,
             c.checks[i].text);
    if (!c.passed) {
        sr_fail(&e, SR_ERROR_CHECK, "%s: a check failed", brdf->specimen.title);
        return api_tell(&e, error, error_size);
    }
    return SR_OK;
}
