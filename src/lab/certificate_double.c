/* SPDX-License-Identifier: MIT */
/* Floats measured by doubles: f and pdf against the same model compiled in double precision, with the same parameters
 * and the same directions.
 *
 * What counts is what the model loses by its own arithmetic: the part of the deviation that a change of the directions
 * by a few roundings does not explain. Where f is below some 1e-4 of a white Lambertian, its digits do not matter. */
#include "lab/certificate.h"

#define NOTHING 3e-5 // [1/sr]

void lab_check_double(struct certifying *c)
{
    struct subject *s = c->subject;
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    const struct sr_twin *twin = NULL;
    if (s->is_random)
        lab_skip(c, CHECK_DOUBLE, "f is a random estimate: its walks part ways");
    else if (sr_twin_make(&arena, s->b, s->at.lambda, SR_TWIN_SAME, &twin, &error) == SR_ERROR_RESOURCE)
        *c->error = error;
    else if (error.status != SR_OK)
        lab_find(c, CHECK_DOUBLE, 1, true, "%s", error.text);
    for (int i = 0; i < 300 && twin; ++i) {
        sr_vec3 wo = lab_anywhere(&c->rng), wi = lab_partner(c, wo);
        enum sr_transport mode = i & 1 ? SR_RADIANCE : SR_IMPORTANCE;
        double o[3] = {(double)wo.x, (double)wo.y, (double)wo.z}, w[3] = {(double)wi.x, (double)wi.y, (double)wi.z};
        double exact[SR_LAMBDA_COUNT], exact_pdf = sr_twin_pdf(twin, o, w, mode);
        sr_twin_f(twin, o, w, mode, exact);
        float pdf, dpdf = 0;
        sr_spectrum f = sr_bsdf_f_pdf(s->b, wo, wi, mode, &pdf), df = SR_BLACK;
        c->findings->evaluations += 2;
        double worst = 0, of_pdf = 0;
        int at = 0;
        for (int pass = 0; pass < 2; ++pass) {
            of_pdf = lab_apart((double)pdf, exact_pdf, (double)dpdf + NOTHING);
            worst = 0;
            for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
                double d = lab_apart((double)f[k], exact[k], (double)df[k] + NOTHING);
                if (d > worst) {
                    worst = d;
                    at = k;
                }
            }
            if (fmax(worst, of_pdf) <= 1e-5 || pass)
                break;
            lab_sensitivity(s, wo, wi, mode, &df, &dpdf);
        }
        bool by_pdf = of_pdf > worst;
        char set[80];
        lab_describe(s, at, set, sizeof set);
        lab_find(c, CHECK_DOUBLE, fmax(worst, of_pdf), fmax(worst, of_pdf) > LAB_EQUAL,
                 "%s %.7g, in double %.7g at theta_o %.5g, theta_i %.5g deg; %s", by_pdf ? "pdf" : "f",
                 by_pdf ? (double)pdf : (double)f[at], by_pdf ? exact_pdf : exact[at], lab_theta_deg(wo),
                 lab_theta_deg(wi), set);
    }
    lab_skip(c, CHECK_DOUBLE, "there is no twin of this model in double precision");
    sr_arena_free(&arena);
}
