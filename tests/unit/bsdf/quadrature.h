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

/* INTEGRAL g(wi) dwi over the hemisphere z > 0 (side 1) or z < 0 (side -1): Gauss-Legendre in theta, in panels of 8,
 * and the trapezoidal rule in phi, n points by 2 n. n is a multiple of 8. */
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

/* Points and weights on a ... b for functions that may begin and end as a square root does: u -> 3 u^2 - 2 u^3. */
enum { EASED = 40 };
__attribute__((unused)) static void eased_points(double a, double b, double x[EASED], double w[EASED])
{
    static double u[EASED], v[EASED];
    if (v[0] == 0)
        sr_gauss_legendre(EASED, 0, 1, u, v);
    for (int i = 0; i < EASED; ++i) {
        x[i] = a + (b - a) * u[i] * u[i] * (3 - 2 * u[i]);
        w[i] = (b - a) * v[i] * 6 * u[i] * (1 - u[i]);
    }
}
__attribute__((unused)) static int ascending(const void *a, const void *b)
{
    double d = *(const double *)a - *(const double *)b;
    return d < 0 ? -1 : d > 0;
}

/* The same by way of the facet m that sends wo to wi: INTEGRAL f |wi.z| |dwi/dm| dm in polar coordinates about the
 * normal, stretched by tan theta_m = alpha t / (1 - t). For surfaces that look the same from all azimuths, as narrow as
 * one likes. Split wherever the facet or wi dips below the surface, or total reflection begins: to about 1e-7, where f
 * is a float. eta: the index below over above for what passes; for side 1 what total reflection goes by, 1 where there
 * is none. */
__attribute__((unused)) static double albedo_by_facets(const struct sr_bsdf *b, sr_vec3 wo, int side, double eta,
                                                       double alpha)
{
    double zo = fabs((double)wo.z), ro = hypot((double)wo.x, (double)wo.y), theta_o = atan2(ro, zo), sum = 0;
    double phi_o = atan2((double)wo.y, (double)wo.x);
    if (wo.z < 0)
        eta = 1 / eta;
    double cos_c = eta < 1 ? sqrt(1 - eta * eta) : -1, theta_c = acos(cos_c), half_pi = QUADRATURE_PI / 2;
    double ends[10] = {0, half_pi, half_pi - theta_o, (half_pi + theta_o) / 2, (half_pi - theta_o) / 2};
    int count = 5;
    if (eta < 1) {
        ends[count++] = fabs(theta_o - theta_c);
        ends[count++] = theta_o + theta_c;
    }
    if (side < 0) { // refracted along the surface
        ends[count++] = atan2(fabs(ro - eta), zo);
        ends[count++] = atan2(ro + eta, zo);
    } else
        ends[count++] = atan(alpha); // in the midst of the lobe
    for (int i = 0; i < count; ++i) {
        double t = tan(fmin(ends[i], half_pi)) / alpha;
        ends[i] = ends[i] >= half_pi ? 1 : t / (1 + t);
    }
    qsort(ends, (size_t)count, sizeof ends[0], ascending);
    for (int e = 0; e + 1 < count; ++e) {
        double x[EASED], w[EASED];
        eased_points(ends[e], ends[e + 1], x, w);
        for (int i = 0; i < EASED && ends[e + 1] - ends[e] > 1e-12; ++i) {
            double t = alpha * x[i] / (1 - x[i]), c = 1 / sqrt(1 + t * t), s = t * c, ring = 0;
            // azimuths from wo's where cos_o = s ro cos(phi) + c zo has one of these values
            double k_z = zo / (eta * c), grazing = eta * (k_z - (1 - 1 / (eta * eta)) / k_z) / 2;
            double splits[5] = {0, QUADRATURE_PI}, values[3] = {0, side < 0 ? grazing : zo / (2 * c), cos_c};
            int n = 2;
            for (int k = 0; k < 3; ++k) {
                double q = (values[k] - c * zo) / (s * ro);
                if (q > -1 && q < 1)
                    splits[n++] = acos(q);
            }
            qsort(splits, (size_t)n, sizeof splits[0], ascending);
            for (int k = 0; k + 1 < n; ++k) {
                double phi[EASED], v[EASED];
                eased_points(splits[k], splits[k + 1], phi, v);
                for (int j = 0; j < EASED; ++j) {
                    double cos_o = s * ro * cos(phi[j]) + c * zo, cos_t2 = 1 - (1 - cos_o * cos_o) / (eta * eta);
                    if (cos_o <= 0 || (side < 0 && cos_t2 <= 0))
                        continue;
                    double cos_t = sqrt(fmax(cos_t2, 0)), along = side > 0 ? 2 * cos_o : cos_o / eta - cos_t;
                    double straight = side > 0 ? -1 : -1 / eta, jacobian = 4 * cos_o;
                    double z = straight * zo + along * c;
                    if (z * side <= 0)
                        continue;
                    if (side < 0)
                        jacobian = (cos_t - cos_o / eta) * (cos_t - cos_o / eta) / cos_t;
                    double azimuth = phi_o + phi[j];
                    sr_vec3 wi = {(float)(straight * (double)wo.x + along * s * cos(azimuth)),
                                  (float)(straight * (double)wo.y + along * s * sin(azimuth)),
                                  (float)(wo.z < 0 ? -z : z)};
                    ring += 2 * v[j] * (double)sr_bsdf_f(b, wo, wi, SR_IMPORTANCE)[0] * fabs(z) * jacobian;
                }
            }
            // dm = sin theta dtheta dphi, dtheta = alpha / (1 - x)^2 / (1 + t^2) dx
            sum += w[i] * ring * s * alpha / ((1 - x[i]) * (1 - x[i])) * c * c;
        }
    }
    return sum;
}

/* Weights of n samples that leave on wo's side (side 1) or on the other (-1): EXPECT_MEAN(weights, albedo). */
__attribute__((unused)) static struct sr_tally sampled_weights(const struct sr_bsdf *b, sr_vec3 wo, int side, int n)
{
    struct sr_rng rng = sr_rng_seed(7, 11);
    struct sr_tally weights = {0};
    for (int i = 0; i < n; ++i) {
        struct sr_bsdf_sample s;
        float u_lobe = sr_rng_float(&rng), x = sr_rng_float(&rng), y = sr_rng_float(&rng);
        bool drawn = sr_bsdf_sample(b, wo, u_lobe, (sr_vec2){x, y}, SR_IMPORTANCE, &s) &&
                     sr_same_hemisphere(wo, s.wi) == (side > 0);
        sr_tally_add(&weights, drawn ? (double)(s.f[0] * fabsf(s.wi.z) / s.pdf) : 0);
    }
    return weights;
}
#define EXPECT_SAMPLES(b, wo, side, expected)                                                                          \
    do {                                                                                                               \
        struct sr_tally weights = sampled_weights(b, wo, side, 1 << 16);                                               \
        EXPECT_MEAN(weights, expected);                                                                                \
    } while (0)

/* The same by the sampler alone: the mean weight of samples, on a lattice of 3 dimensions (Roberts 2018) of n points.
 */
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
