/* SPDX-License-Identifier: MIT */
/* A BSDF from words, and its directional albedo by a quadrature that minds the edges of models.
 *
 *     struct sr_bsdf b = bsdf_of("hapke albedo=0.3 version=1981");    parameters that are not named have their defaults
 *     EXPECT_ALBEDO("minnaert reflectance=0.8 k=1.5", 0.8, 0.744484, 0.565685, 0.333369)    at 0, 30, 60, 80 deg
 */
#ifndef SR_TESTS_UNIT_BSDF_ALBEDOS_H
#define SR_TESTS_UNIT_BSDF_ALBEDOS_H

#include "quadrature.h"

static inline void bsdf_set(struct sr_bsdf *b, const char *name, const char *value)
{
    for (const struct sr_param *p = b->model->params; p->name; ++p) {
        void *member = b->data + p->offset;
        float number = value ? strtof(value, NULL) : (float)p->initial;
        if (name && strcmp(p->name, name) != 0)
            continue;
        if (p->kind == SR_PARAM_ENUM && value) {
            int32_t choice = 0;
            for (const char *c = p->text; strncmp(c, value, strlen(value)) != 0; ++c, ++choice) {
                c = strchr(c, '|');
                if (!c)
                    test_fail(__FILE__, __LINE__, "%s: no choice %s", name, value);
            }
            memcpy(member, &choice, sizeof choice);
        } else if (p->kind == SR_PARAM_ENUM || p->kind == SR_PARAM_INT) {
            memcpy(member, &(int32_t){(int32_t)number}, sizeof(int32_t));
        } else if (p->kind == SR_PARAM_BOOL) {
            memcpy(member, &(bool){number != 0}, sizeof(bool));
        } else if (p->kind == SR_PARAM_FLOAT) {
            memcpy(member, &number, sizeof number);
        } else {
            sr_spectrum even = SR_BLACK + number;
            memcpy(member, &even, sizeof even);
        }
        if (name)
            return;
    }
    if (name)
        test_fail(__FILE__, __LINE__, "%s has no parameter %s", b->model->name, name);
}

static inline struct sr_bsdf bsdf_of(const char *text)
{
    char words[400], *rest = NULL;
    snprintf(words, sizeof words, "%s", text);
    struct sr_bsdf b = {.model = sr_bsdf_model_find(strtok_r(words, " ", &rest))};
    if (!b.model)
        test_fail(__FILE__, __LINE__, "no model: %s", text);
    bsdf_set(&b, NULL, NULL);
    for (char *w; (w = strtok_r(NULL, " ", &rest));) {
        char *value = strchr(w, '=');
        *value = 0;
        bsdf_set(&b, w, value + 1);
    }
    specimen_ready(&b, 550);
    return b;
}

static inline double bsdf_value(const struct sr_bsdf *b, sr_vec3 wo, sr_vec3 wi)
{
    return (double)sr_bsdf_f(b, wo, wi, SR_IMPORTANCE)[0];
}

/* INTEGRAL f |cos_theta_i| dwi over the side of wo, theta_o < 90 deg: panels of 8 Gauss points, 60 in theta (ends at
 * theta_o, where many models have an edge), 36 in phi on one side of the plane of incidence (ends across it), because
 * the other side is its mirror image. */
static inline double bsdf_albedo_in(const struct sr_bsdf *b, double theta_deg, double phi_deg, enum sr_transport mode)
{
    enum { POINTS = 8, RINGS = 60, SECTORS = 36 };
    double x[POINTS], w[POINTS], sum = 0, split = theta_deg > 1 ? theta_deg : 45;
    sr_vec3 wo = direction(theta_deg, phi_deg);
    sr_gauss_legendre(POINTS, 0, 1, x, w);
    for (int i = 0; i < RINGS; ++i) {
        bool low = i < RINGS / 2;
        double width = (low ? split : 90 - split) / (RINGS / 2),
               from = low ? i * width : split + (i - RINGS / 2) * width;
        for (int j = 0; j < POINTS; ++j) {
            double theta = from + width * x[j], ring = 0;
            for (int k = 0; k < SECTORS; ++k)
                for (int l = 0; l < POINTS; ++l)
                    ring += w[l] *
                            (double)sr_bsdf_f(b, wo, direction(theta, phi_deg + 180.0 / SECTORS * (k + x[l])), mode)[0];
            double t = theta * QUADRATURE_PI / 180;
            sum += w[j] * width * QUADRATURE_PI / 180 * ring * 2 * QUADRATURE_PI / SECTORS * sin(t) * cos(t);
        }
    }
    return sum;
}

static inline double bsdf_albedo(const struct sr_bsdf *b, double theta_deg, double phi_deg)
{
    return bsdf_albedo_in(b, theta_deg, phi_deg, SR_IMPORTANCE);
}

/* at 0, 30, 60 and 80 deg, to 1e-5 of the value and what the printed digits leave open */
static inline void expect_albedo(const char *file, int line, const char *text, double phi_deg, const double expected[4],
                                 double digits)
{
    const double theta[] = {0, 30, 60, 80};
    struct sr_bsdf b = bsdf_of(text);
    for (int i = 0; i < 4; ++i) {
        double E = bsdf_albedo(&b, theta[i], phi_deg);
        if (!(fabs(E - expected[i]) <= 1e-5 * expected[i] + digits))
            test_fail(file, line, "%s: E(%g deg) = %.9f, not %.9f", text, theta[i], E, expected[i]);
        sr_spectrum closed = SR_BLACK + NAN;
        if (b.model->albedo)
            closed = b.model->albedo(b.data, direction(theta[i], phi_deg));
        if (!isnan(closed[0]) && !(sr_bsdf_lobes(&b) & SR_LOBE_SPECULAR))
            test_near(file, line, "the closed form", (double)closed[0], expected[i], 1e-5 * expected[i] + digits);
    }
}
#define EXPECT_ALBEDO_ALONG(phi_deg, text, ...)                                                                        \
    expect_albedo(__FILE__, __LINE__, text, phi_deg, (const double[4]){__VA_ARGS__}, 1e-6)
#define EXPECT_ALBEDO(text, ...) EXPECT_ALBEDO_ALONG(0, text, __VA_ARGS__)

/* max |f(a, b) - f(b, a)| / the larger, over random pairs on one side */
static inline double bsdf_asymmetry(const struct sr_bsdf *b, int pairs)
{
    struct sr_rng rng = sr_rng_seed(21, 1);
    double worst = 0;
    for (int i = 0; i < pairs; ++i) {
        float u[4];
        for (int k = 0; k < 4; ++k)
            u[k] = sr_rng_float(&rng);
        sr_vec3 v = direction(acos((double)u[0]) * 180 / QUADRATURE_PI, 360 * (double)u[1]);
        sr_vec3 w = direction(acos((double)u[2]) * 180 / QUADRATURE_PI, 360 * (double)u[3]);
        double p = bsdf_value(b, v, w), q = bsdf_value(b, w, v), larger = p > q ? p : q;
        if (larger > 0 && fabs(p - q) / larger > worst)
            worst = fabs(p - q) / larger;
    }
    return worst;
}

#endif
