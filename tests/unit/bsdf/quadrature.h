/* SPDX-License-Identifier: MIT */
/* For the tests of models: a specimen out of words, and the light that it reflects by quadrature in double precision.
 *
 *     struct sr_bsdf b = specimen("ward", "alpha_x", 0.2, "alpha_y", 0.2, "specular", 1.0, NULL);
 *     EXPECT_RELATIVE(albedo_toward(&b, direction(60, 0), 1, 400), 0.458850939, 1e-5);
 *
 * Spectra are constant; an ENUM, INT or BOOL is given as its number; all that is not named has its default. */
#ifndef SR_TESTS_UNIT_BSDF_QUADRATURE_H
#define SR_TESTS_UNIT_BSDF_QUADRATURE_H

#include "bsdf/bsdf.h"
#include "test.h"

#define QUADRATURE_PI 3.14159265358979324

__attribute__((unused)) static sr_vec3 direction(double theta_deg, double phi_deg)
{
    double t = theta_deg * QUADRATURE_PI / 180, p = phi_deg * QUADRATURE_PI / 180;
    return (sr_vec3){(float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)cos(t)};
}

/* Lets the model see its parameters at one wavelength [nm], in all components. */
__attribute__((unused)) static void specimen_ready(struct sr_bsdf *b, float lambda)
{
    if (b->model->ready)
        b->model->ready(b->data, &(struct sr_bsdf_at){.lambda = SR_BLACK + lambda, .seed = 1});
}

/* Pairs of a parameter's name and a double, then NULL; ready at 550 nm. */
__attribute__((unused)) static struct sr_bsdf specimen(const char *name, ...)
{
    struct sr_bsdf b = {.model = sr_bsdf_model_find(name)};
    if (!b.model)
        test_fail(__FILE__, __LINE__, "no model %s", name);
    for (int pass = 0;; ++pass) { // defaults first
        va_list args;
        va_start(args, name);
        const char *word = NULL;
        if (pass > 0)
            for (int skipped = 1; (word = va_arg(args, const char *)) && skipped < pass; ++skipped)
                (void)va_arg(args, double);
        if (pass > 0 && !word) {
            va_end(args);
            break;
        }
        double given = pass > 0 ? va_arg(args, double) : 0;
        va_end(args);
        bool found = pass == 0;
        for (const struct sr_param *p = b.model->params; p->name; ++p) {
            if (pass > 0 && strcmp(p->name, word) != 0)
                continue;
            found = true;
            double v = pass > 0 ? given : p->initial;
            void *at = b.data + p->offset;
            sr_spectrum even = SR_BLACK + (float)v;
            if (p->kind == SR_PARAM_FLOAT)
                memcpy(at, &(float){(float)v}, sizeof(float));
            else if (p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED)
                memcpy(at, &even, sizeof even);
            else if (p->kind == SR_PARAM_BOOL)
                memcpy(at, &(bool){v != 0}, sizeof(bool));
            else if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM)
                memcpy(at, &(int32_t){(int32_t)v}, sizeof(int32_t));
        }
        if (!found)
            test_fail(__FILE__, __LINE__, "%s has no %s", name, word);
    }
    static struct sr_arena tables; // what models compute once lasts as long as the tests
    struct sr_error error = {0};
    if (b.model->load && b.model->load(b.data, &tables, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", name, error.text);
    specimen_ready(&b, 550);
    return b;
}

/* INTEGRAL g(wi) dwi over the hemisphere z > 0 (side 1) or z < 0 (side -1): Gauss-Legendre in theta, in panels of 8, and
 * the trapezoidal rule in phi, n points by 2 n. n is a multiple of 8. */
__attribute__((unused)) static double hemisphere_integral(double (*g)(const void *, sr_vec3), const void *context,
                                                          int side, int n)
{
    double x[8], w[8], sum = 0;
    for (int panel = 0; panel < n / 8; ++panel) {
        double step = QUADRATURE_PI / 2 / (n / 8);
        sr_gauss_legendre(8, panel * step, (panel + 1) * step, x, w);
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 2 * n; ++j) {
                double phi = (j + 0.5) * QUADRATURE_PI / n;
                sr_vec3 wi = {(float)(sin(x[i]) * cos(phi)), (float)(sin(x[i]) * sin(phi)), (float)(side * cos(x[i]))};
                sum += g(context, wi) * w[i] * sin(x[i]) * QUADRATURE_PI / n;
            }
    }
    return sum;
}

struct albedo_query {
    const struct sr_bsdf *bsdf;
    sr_vec3 wo;
};
__attribute__((unused)) static double albedo_integrand(const void *context, sr_vec3 wi)
{
    const struct albedo_query *q = context;
    return (double)(sr_bsdf_f(q->bsdf, q->wo, wi, SR_IMPORTANCE)[0] * fabsf(wi.z));
}
__attribute__((unused)) static double pdf_integrand(const void *context, sr_vec3 wi)
{
    const struct albedo_query *q = context;
    return (double)sr_bsdf_pdf(q->bsdf, q->wo, wi, SR_IMPORTANCE);
}

/* Share of the light that comes from wo which leaves on wo's side (side 1) or on the other (-1), in the form for
 * importance; the first wavelength. */
__attribute__((unused)) static double albedo_toward(const struct sr_bsdf *b, sr_vec3 wo, int side, int n)
{
    return hemisphere_integral(albedo_integrand, &(struct albedo_query){b, wo}, wo.z < 0 ? -side : side, n);
}

/* The same as the mean weight of samples, on a lattice of 3 dimensions (Roberts 2018) of n points. */
__attribute__((unused)) static double albedo_by_samples(const struct sr_bsdf *b, sr_vec3 wo, int side, int n)
{
    double sum = 0;
    for (int k = 1; k <= n; ++k) {
        double a = k * 0.8191725133961645, c = k * 0.6710436067037893, d = k * 0.5497004779019703;
        sr_vec2 u = {(float)(c - floor(c)) * SR_ONE_MINUS_EPSILON, (float)(d - floor(d)) * SR_ONE_MINUS_EPSILON};
        struct sr_bsdf_sample s;
        if (sr_bsdf_sample(b, wo, (float)(a - floor(a)) * SR_ONE_MINUS_EPSILON, u, SR_IMPORTANCE, &s) &&
            sr_same_hemisphere(wo, s.wi) == (side > 0))
            sum += (double)(s.f[0] * fabsf(s.wi.z) / s.pdf);
    }
    return sum / n;
}

#endif
