/* SPDX-License-Identifier: MIT */
/* What a certificate looks at: a specimen as it is, or a model with parameters drawn from its table.
 *
 * Numbers are uniform over their range; over its logarithm where the range spans decades (widths, exponents,
 * thicknesses); one in eight is at either end, because laws break there first. Reflectances that share one incident
 * light (reflectance, transmittance, specular, diffuse) are drawn so that they do not sum above 1. */
#include "lab/certificate.h"

#include <stdio.h>
#include <string.h>

sr_vec3 lab_sphere(struct sr_rng *rng)
{
    float z = 1 - 2 * lab_u(rng), phi = 2 * SR_PI * lab_u(rng);
    return sr_spherical_direction(sqrtf(1 - z * z), z, phi);
}

sr_vec3 lab_anywhere(struct sr_rng *rng)
{
    float kind = lab_u(rng);
    if (kind < 0.5f)
        return lab_sphere(rng);
    float small = powf(10, -4 * lab_u(rng)), phi = 2 * SR_PI * lab_u(rng);
    float sign = lab_u(rng) < 0.5f ? -1.0f : 1.0f;
    float s = kind < 0.8f ? sqrtf(1 - small * small) : small, z = kind < 0.8f ? small : sqrtf(1 - small * small);
    return sr_spherical_direction(s, sign * z, phi);
}

bool lab_can_draw(const struct sr_bsdf_model *model)
{
    for (const struct sr_param *p = model->params; p->name; ++p)
        if (p->kind == SR_PARAM_FILE || p->kind == SR_PARAM_STRING)
            return false;
    return true;
}

/* ---- parameters ---- */

static bool has(const char *name, const char *part)
{
    return strstr(name, part) != NULL;
}

static double upper(const struct sr_param *p)
{
    return isfinite(p->max) ? p->max : p->min + 10 * (1 + fabs(p->initial));
}

static float draw_number(const struct sr_param *p, struct sr_rng *rng)
{
    double lo = p->min, hi = upper(p), u = (double)lab_u(rng), end = (double)lab_u(rng);
    if (end < 0.125)
        return (float)lo;
    if (end < 0.25)
        return (float)hi;
    if (lo > 0 && hi / lo > 50)
        return (float)(lo * pow(hi / lo, u));
    if (lo == 0 &&
        (has(p->name, "alpha") || has(p->name, "roughness") || has(p->name, "thickness") || has(p->name, "exponent")))
        return (float)(hi * pow(10, -3 * u));
    return (float)(lo + (hi - lo) * u);
}

/* Of one incident light. A medium's albedo, tints and the like may each be 1. */
static bool shares_light(const char *name)
{
    static const char *const words[] = {"reflectance", "transmittance", "specular", "diffuse", "ks", "kd"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; ++i)
        if (strcmp(name, words[i]) == 0)
            return true;
    return false;
}

static int choices_of(const struct sr_param *p)
{
    int n = 1;
    for (const char *c = p->text; *c; ++c)
        n += *c == '|';
    return n;
}

static sr_spectrum draw_spectrum(const struct sr_param *p, struct sr_rng *rng)
{
    double lo = p->min, hi = upper(p);
    float end = lab_u(rng);
    sr_spectrum v = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        v[i] = (float)(end < 0.125f ? lo : end < 0.25f ? hi : lo + (hi - lo) * (double)lab_u(rng));
    return v;
}

static void fill(const struct sr_param *p, struct sr_rng *rng, struct lab_drawing how, bool is_chosen,
                 unsigned char *data)
{
    void *at = data + p->offset;
    double end = how.at_max ? upper(p) : p->min;
    bool is_initial = how.row >= 0 && how.plain && !is_chosen;
    if (p->kind == SR_PARAM_FLOAT) {
        float v = draw_number(p, rng);
        if (how.broad && (has(p->name, "alpha") || has(p->name, "roughness")) && v < 0.01f && p->max > 0.01)
            v = 0.01f;
        memcpy(at, &(float){is_chosen ? (float)end : is_initial ? (float)p->initial : v}, sizeof(float));
    } else if (p->kind == SR_PARAM_INT) {
        double hi = p->max < p->min + 63 ? p->max : p->min + 63;
        double v = floor(p->min + (hi - p->min + 1) * (double)lab_u(rng));
        if (strcmp(p->name, "sample_count") == 0) // of one estimate: the mean does not depend on it
            v = 1;
        if (strcmp(p->name, "max_depth") == 0) // f and sample are cut short alike only in the limit
            v = p->max;
        memcpy(at, &(int32_t){(int32_t)(is_initial ? p->initial : v)}, sizeof(int32_t));
    } else if (p->kind == SR_PARAM_ENUM) {
        double v = floor((double)choices_of(p) * (double)lab_u(rng));
        memcpy(at, &(int32_t){(int32_t)(is_initial ? p->initial : v)}, sizeof(int32_t));
    } else if (p->kind == SR_PARAM_BOOL) {
        bool v = lab_u(rng) < 0.5f;
        memcpy(at, &(bool){is_initial ? p->initial > 0 : v}, sizeof(bool));
    } else if (p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED) {
        sr_spectrum v = draw_spectrum(p, rng);
        if (is_chosen)
            v = SR_BLACK + (float)end;
        else if (is_initial)
            v = SR_BLACK + (float)p->initial;
        memcpy(at, &v, sizeof v);
    }
}

/* Takes from each what others have taken before, beginning at a random one (or at the one whose end is wanted). */
static void share_light(const struct sr_bsdf_model *model, struct sr_rng *rng, struct lab_drawing how,
                        unsigned char *data)
{
    int rows = 0;
    while (model->params[rows].name)
        ++rows;
    int first = how.row >= 0 ? how.row : (int)(lab_u(rng) * (float)rows);
    sr_spectrum left = SR_ONE;
    for (int k = 0; k < rows; ++k) {
        const struct sr_param *p = &model->params[(first + k) % rows];
        if ((p->kind != SR_PARAM_ALBEDO && p->kind != SR_PARAM_FLOAT) || !shares_light(p->name) || p->max > 1)
            continue;
        if (p->kind == SR_PARAM_FLOAT) {
            float v;
            memcpy(&v, data + p->offset, sizeof v);
            float least = left[0];
            for (int i = 1; i < SR_LAMBDA_COUNT; ++i)
                least = sr_min(least, left[i]);
            v = sr_max(sr_min(v, least), (float)p->min);
            memcpy(data + p->offset, &v, sizeof v);
            left -= v;
            continue;
        }
        sr_spectrum v;
        memcpy(&v, data + p->offset, sizeof v);
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            v[i] = sr_max(sr_min(v[i], left[i]), (float)p->min);
        memcpy(data + p->offset, &v, sizeof v);
        left -= v;
    }
}

static sr_spectrum wavelengths(void)
{
    sr_spectrum lambda = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        lambda[i] = 400 + 300 * (float)i / (SR_LAMBDA_COUNT - 1);
    return lambda;
}

/* What the checks must know beforehand. */
static void look(struct subject *s)
{
    struct sr_rng rng = sr_rng_seed(77, 7);
    s->b = &s->at.bsdf;
    s->transmits = (sr_bsdf_lobes(s->b) & SR_LOBE_TRANSMISSION) != 0;
    s->is_random = s->is_proportional = false;
    for (uint32_t i = 0; s->b->model->is_random && i < 64; ++i) {
        sr_vec3 wo = lab_sphere(&rng), wi = lab_sphere(&rng);
        if (!s->transmits)
            wi.z = copysignf(wi.z, wo.z);
        lab_reseed(s, 1);
        sr_spectrum a = sr_bsdf_f(s->b, wo, wi, SR_RADIANCE);
        lab_reseed(s, 2 + i);
        sr_spectrum b = sr_bsdf_f(s->b, wo, wi, SR_RADIANCE);
        s->is_random |= sr_spectrum_any(a != b);
        struct sr_bsdf_sample sample;
        float u = lab_u(&rng);
        s->is_proportional |=
            sr_bsdf_sample(s->b, wo, u, lab_square(&rng), SR_RADIANCE, &sample) && sample.pdf_is_proportional;
    }
}

sr_status lab_draw(const struct sr_bsdf_model *model, struct sr_rng *rng, struct lab_drawing how,
                   struct sr_arena *arena, struct subject *s, struct sr_error *error)
{
    s->specimen = NULL;
    s->model = model;
    memset(s->raw, 0, sizeof s->raw);
    for (int i = 0; model->params[i].name; ++i)
        fill(&model->params[i], rng, how, i == how.row, s->raw);
    share_light(model, rng, how, s->raw);
    if (model->load && model->load(s->raw, arena, error) != SR_OK)
        return error->status;
    s->at.lambda = wavelengths();
    s->at.bsdf.model = model;
    s->asymmetry = (double)model->asymmetry;
    s->largest_albedo = (double)sr_max(1, model->largest_albedo);
    lab_reseed(s, 1);
    look(s);
    return SR_OK;
}

void lab_subject_of_specimen(const struct sr_specimen *specimen, struct subject *s)
{
    s->specimen = specimen;
    s->model = specimen->part_count == 1 ? specimen->parts[0].model : NULL;
    sr_specimen_at(specimen, wavelengths(), 1, &s->at);
    s->asymmetry = 0;
    s->largest_albedo = 0;
    bool gains = false;
    for (int i = 0; i < specimen->part_count; ++i) {
        const struct sr_bsdf_model *m = s->at.parts[i].model;
        s->asymmetry = fmax(s->asymmetry, (double)m->asymmetry);
        s->largest_albedo += (double)(specimen->parts[i].weight * sr_max(1, m->largest_albedo));
        gains |= m->largest_albedo > 1;
    }
    s->largest_albedo = gains ? fmax(s->largest_albedo, 1) : 1;
    look(s);
}

void lab_reseed(struct subject *s, uint32_t seed)
{
    if (s->specimen) {
        if (s->b->model->is_random)
            sr_specimen_at(s->specimen, s->at.lambda, seed, &s->at);
        return;
    }
    memcpy(s->at.bsdf.data, s->raw, sizeof s->raw);
    if (s->at.bsdf.model->ready)
        s->at.bsdf.model->ready(s->at.bsdf.data, &(struct sr_bsdf_at){s->at.lambda, seed});
}

void lab_describe(const struct subject *s, int wavelength, char *text, size_t size)
{
    size_t n = 0;
    text[0] = 0;
    if (s->specimen)
        return;
    for (const struct sr_param *p = s->model->params; p->name && n + 1 < size; ++p) {
        const void *at = s->raw + p->offset;
        char value[64] = "";
        float v = 0;
        int32_t i = 0;
        bool flag = false;
        if (p->kind == SR_PARAM_FLOAT)
            memcpy(&v, at, sizeof v);
        else if (p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED)
            memcpy(&v, (const char *)at + (size_t)wavelength * sizeof v, sizeof v);
        snprintf(value, sizeof value, "%.4g", (double)v);
        if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM) {
            memcpy(&i, at, sizeof i);
            snprintf(value, sizeof value, "%d", (int)i);
        } else if (p->kind == SR_PARAM_BOOL) {
            memcpy(&flag, at, sizeof flag);
            snprintf(value, sizeof value, "%s", flag ? "true" : "false");
        }
        int more = snprintf(text + n, size - n, "%s%s = %s", n ? ", " : "", p->name, value);
        if (more < 0 || n + (size_t)more >= size) {
            text[n] = 0; // only whole words
            return;
        }
        n += (size_t)more;
    }
}
