/* SPDX-License-Identifier: MIT */
/* What a certificate finds by looking at pairs of directions: no statistics, each deviation counts.
 *
 *     reciprocity         f(a, b) = f(b, a) on one side of the surface                            (Helmholtz)
 *     adjoint             f(a, b) = f*(b, a) across it, f in the form for radiance, f* for importance (Veach 1997, 5.2)
 *     support             pdf(a, b) > 0 wherever f(a, b) > 0, or light is lost
 *
 * Floats of narrow lobes have few digits: two values that ought to be equal may differ by 0.2 %, or by what f changes
 * when the coordinates of a direction change by 2e-7 (two or three roundings). What is reported is the excess over that
 * change, as a share of the larger value. */
#include "lab/certificate.h"

#include <stdio.h>
#include <string.h>

// not made a unit vector again: the length of one is off by as much
static sr_vec3 moved(sr_vec3 w, float x, float y, float z)
{
    return sr_add(w, (sr_vec3){x, y, z});
}

void lab_sensitivity(const struct subject *s, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode, sr_spectrum *df,
                     float *dpdf)
{
    float pdf, p;
    sr_spectrum f = sr_bsdf_f_pdf(s->b, wo, wi, mode, &pdf);
    *df = SR_BLACK;
    *dpdf = 0;
    for (int i = 0; i < 16; ++i) {
        bool is_small = i & 8; // one rounding of wi alone: half vectors at grazing have peaks that 2e-7 steps over
        float e = is_small ? 6e-8f : 2e-7f;
        float x = i & 1 ? e : -e, y = i & 2 ? e : -e, z = i & 4 ? e : -e;
        sr_spectrum g = sr_bsdf_f_pdf(s->b, is_small ? wo : moved(wo, y, z, -x), moved(wi, x, y, z), mode, &p);
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            (*df)[k] = sr_max((*df)[k], 4 * fabsf(g[k] - f[k]));
        *dpdf = sr_max(*dpdf, 4 * fabsf(p - pdf));
    }
}

double lab_apart(double a, double b, double slack)
{
    double larger = fmax(fabs(a), fabs(b)), d = fabs(a - b) - slack;
    return !(d <= 1e30) ? 1 : d > 0 && larger > 1e-12 ? d / larger : 0;
}

/* ---- numbers that are none, or below 0 ---- */

static void tell_value(struct certifying *c, enum check check, double value, const char *what, sr_vec3 wo, sr_vec3 wi,
                       int k)
{
    char set[100];
    lab_describe(c->subject, k, set, sizeof set);
    lab_find(c, check, check == CHECK_NON_NEGATIVE && isfinite(value) ? -value : 1, true,
             "%s = %.4g at theta_o %.5g, theta_i %.5g deg; %s", what, value, lab_theta_deg(wo), lab_theta_deg(wi), set);
}

/* One value; true: it is good. */
static bool look_at(struct certifying *c, enum check finite, enum check negative, double value, const char *what,
                    sr_vec3 wo, sr_vec3 wi, int k)
{
    if (SR_LIKELY(value >= 0 && value < (double)INFINITY))
        return true;
    tell_value(c, isfinite(value) ? negative : finite, value, what, wo, wi, k);
    return false;
}

static bool look_at_all(struct certifying *c, enum check finite, enum check negative, sr_spectrum f, float pdf,
                        const char *what_f, const char *what_pdf, sr_vec3 wo, sr_vec3 wi)
{
    bool ok = look_at(c, finite, negative, (double)pdf, what_pdf, wo, wi, 0);
    if (SR_LIKELY(!sr_spectrum_any(~((f >= 0) & (f < INFINITY)))))
        return ok;
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
        ok &= look_at(c, finite, negative, (double)f[k], what_f, wo, wi, k);
    return ok;
}

bool lab_check_values(struct certifying *c, enum check finite, enum check negative, sr_vec3 wo, sr_vec3 wi)
{
    const struct subject *s = c->subject;
    enum sr_transport mode = lab_u(&c->rng) < 0.5f ? SR_RADIANCE : SR_IMPORTANCE;
    float pdf;
    sr_spectrum f = sr_bsdf_f_pdf(s->b, wo, wi, mode, &pdf);
    c->findings->evaluations += 2;
    bool ok = look_at_all(c, finite, negative, f, pdf, "f", "pdf", wo, wi);
    struct sr_bsdf_sample sample;
    float u = lab_u(&c->rng), kind = lab_u(&c->rng);
    sr_vec2 square = lab_square(&c->rng);
    if (kind < 0.05f) // the edges of the square
        square = (sr_vec2){kind < 0.025f ? 0 : SR_ONE_MINUS_EPSILON, kind < 0.0125f ? 0 : square.y};
    if (!sr_bsdf_sample(s->b, wo, u, square, mode, &sample))
        return ok;
    ok &= look_at_all(c, finite, negative, sample.f, sample.pdf, "a sample's f", "a sample's pdf", wo, sample.wi);
    if (ok && !(sample.pdf > 0)) {
        tell_value(c, finite, (double)sample.pdf, "a sample's pdf", wo, sample.wi, 0);
        ok = false;
    }
    if (!sr_is_finite(sample.wi)) {
        tell_value(c, finite, (double)NAN, "a sample's direction", wo, wo, 0);
        ok = false;
    }
    return ok;
}

/* ---- laws ---- */

static void check_reciprocity(struct certifying *c, sr_vec3 wo, sr_vec3 wi)
{
    const struct subject *s = c->subject;
    enum check check = wo.z * wi.z < 0 ? CHECK_ADJOINT : CHECK_RECIPROCITY;
    sr_spectrum f = sr_bsdf_f(s->b, wo, wi, SR_RADIANCE);
    sr_spectrum g = sr_bsdf_f(s->b, wi, wo, check == CHECK_ADJOINT ? SR_IMPORTANCE : SR_RADIANCE);
    if (sr_spectrum_is_black(f) && sr_spectrum_is_black(g))
        return;
    sr_spectrum slack = SR_BLACK, other;
    float unused;
    double worst = 0;
    int at = 0;
    for (int pass = 0; pass < 2; ++pass) { // the second time with the slack, where it matters
        worst = 0;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
            double d = lab_apart((double)f[k], (double)g[k], (double)slack[k]);
            if (d > worst) {
                worst = d;
                at = k;
            }
        }
        if (worst <= LAB_EQUAL || pass)
            break;
        lab_sensitivity(s, wo, wi, SR_RADIANCE, &slack, &unused);
        lab_sensitivity(s, wi, wo, check == CHECK_ADJOINT ? SR_IMPORTANCE : SR_RADIANCE, &other, &unused);
        slack += other;
    }
    char set[90];
    lab_describe(s, at, set, sizeof set);
    lab_find(c, check, worst, worst > LAB_EQUAL, "f %.5g, reversed %.5g at theta %.4g and %.4g, phi %.4g deg; %s",
             (double)f[at], (double)g[at], lab_theta_deg(wo), lab_theta_deg(wi), lab_phi_deg(wi) - lab_phi_deg(wo),
             set);
}

#define UNSEEN 3e-4 // [1/sr] a thousandth of white paper

/* f itself is random: the mean difference over seeds, as deviations of its error. Far from the lobes of narrow slopes f
 * is the sum of rare bright walks, one in 1e6 of them at times, which 4000 do not meet: what is less than UNSEEN is
 * judged by check_exchange, whose summands are bounded. */
static void check_mean_reciprocity(struct certifying *c, sr_vec3 wo, sr_vec3 wi)
{
    struct subject *s = c->subject;
    enum check check = wo.z * wi.z < 0 ? CHECK_ADJOINT : CHECK_RECIPROCITY;
    enum { WALKS = 4000 };
    struct sr_tally difference = {0}, sum = {0};
    double largest = 0;
    for (uint32_t i = 0; i < WALKS; ++i) {
        lab_reseed(s, sr_rng_u32(&c->rng));
        sr_spectrum f = sr_bsdf_f(s->b, wo, wi, SR_RADIANCE);
        lab_reseed(s, sr_rng_u32(&c->rng));
        sr_spectrum g = sr_bsdf_f(s->b, wi, wo, check == CHECK_ADJOINT ? SR_IMPORTANCE : SR_RADIANCE);
        double d = (double)(sr_spectrum_mean(f) - sr_spectrum_mean(g));
        largest = fmax(largest, fabs(d) / WALKS);
        sr_tally_add(&difference, d);
        sr_tally_add(&sum, (double)(sr_spectrum_mean(f) + sr_spectrum_mean(g)) / 2);
    }
    double error = sr_tally_standard_error(&difference), z = error > 0 ? difference.mean / error : 0;
    double share = fmax(fabs(difference.mean) - fmax(c->z * error + lab_bernstein(c, largest), UNSEEN), 0) /
                   fmax(sum.mean, UNSEEN);
    char set[100];
    lab_describe(s, 0, set, sizeof set);
    lab_find(c, check, share, share > LAB_EQUAL,
             "means of 4000 walks: %.4g of f = %.4g at theta %.4g and %.4g deg, z = %.2f; %s", difference.mean,
             sum.mean, lab_theta_deg(wo), lab_theta_deg(wi), z, set);
}

/* What a sends to b, b sends to a: for a by the cosine law and b drawn from it, weight = f |cos_theta_b| / pdf,
 *
 *     E[ weight (h(a, b) - h(b, a)) ]
 *         = 1 / pi INTEGRAL INTEGRAL f(a, b) (h(a, b) - h(b, a)) |cos_theta_a| |cos_theta_b| da db = 0
 *
 * for every h. The second term is drawn in the form for importance. Weights of walks are at most about 1. */
static void check_exchange(struct certifying *c)
{
    struct subject *s = c->subject;
    enum { MOMENTS = 4 };
    static const char *const names[MOMENTS] = {"|a.z|", "a.z^2", "a.x^2", "a.x b.y"};
    struct sr_tally differences[MOMENTS] = {0}, total = {0};
    for (uint32_t i = 0; i < 4 * c->samples; ++i) {
        lab_reseed(s, sr_rng_u32(&c->rng));
        sr_vec3 a = sr_warp_cosine_hemisphere(lab_square(&c->rng));
        a.z = i & 1 ? -a.z : a.z;
        float u = lab_u(&c->rng);
        sr_vec2 square = lab_square(&c->rng);
        float d[MOMENTS] = {0}, whole = 0;
        for (int mode = 0; mode < 2 && a.z != 0; ++mode) {
            struct sr_bsdf_sample drawn;
            if (!sr_bsdf_sample(s->b, a, u, square, (enum sr_transport)mode, &drawn))
                continue;
            sr_vec3 b = drawn.wi;
            float weight = sr_spectrum_mean(drawn.f) * fabsf(b.z) / drawn.pdf * (mode ? -1.0f : 1.0f);
            sr_vec3 x = mode ? b : a, y = mode ? a : b;
            const float h[MOMENTS] = {fabsf(x.z), x.z * x.z, x.x * x.x, x.x * y.y};
            for (int k = 0; k < MOMENTS; ++k)
                d[k] += weight * h[k];
            whole += fabsf(weight) / 2;
        }
        for (int k = 0; k < MOMENTS; ++k)
            sr_tally_add(&differences[k], (double)d[k]);
        sr_tally_add(&total, (double)whole);
    }
    c->findings->evaluations += 8 * c->samples;
    char set[100];
    lab_describe(s, 0, set, sizeof set);
    for (int k = 0; k < MOMENTS; ++k) {
        double error = sr_tally_standard_error(&differences[k]), z = error > 0 ? differences[k].mean / error : 0;
        double share = fmax(fabs(differences[k].mean) - c->z * error, 0) / fmax(total.mean, 1e-6);
        lab_find(c, CHECK_RECIPROCITY, share, share > LAB_EQUAL,
                 "light exchanged: moment %s differs by %.4g of %.4g, z = %.2f; %s", names[k], differences[k].mean,
                 total.mean, z, set);
    }
}

/* Purity, f_pdf, and that what shines can be drawn. */
static void check_agreement(struct certifying *c, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct subject *s = c->subject;
    const struct sr_bsdf_model *m = s->b->model;
    float pdf, again, alone = m->pdf(s->b->data, wo, wi, mode);
    sr_spectrum f = m->f(s->b->data, wo, wi, mode), both = sr_bsdf_f_pdf(s->b, wo, wi, mode, &pdf);
    sr_bsdf_f_pdf(s->b, wo, wi, mode, &again);
    double worst = lab_apart((double)pdf, (double)alone, 0);
    if (pdf != again || memcmp(&f, &both, sizeof f) != 0 || pdf != alone) {
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            worst = fmax(worst, lab_apart((double)f[k], (double)both[k], 0));
        worst = fmax(worst, pdf != again ? 1 : 1e-9);
    }
    lab_find(c, CHECK_F_PDF, worst, worst > 0,
             "f %.6g but f_pdf %.6g; pdf %.6g but f_pdf %.6g at theta %.4g and %.4g deg", (double)f[0], (double)both[0],
             (double)alone, (double)pdf, lab_theta_deg(wo), lab_theta_deg(wi));
    float brightest = sr_spectrum_max(f);
    bool lost = !(pdf > 0) && brightest > 0;
    char set[90];
    lab_describe(s, 0, set, sizeof set);
    lab_find(c, CHECK_SUPPORT, lost ? (double)brightest : 0, lost,
             "f = %.4g 1/sr but pdf = 0 at theta_o %.4g, theta_i %.4g deg; %s", (double)brightest, lab_theta_deg(wo),
             lab_theta_deg(wi), set);
}

/* ---- samples ---- */

static const char *wrong_lobe(const struct subject *s, sr_vec3 wo, const struct sr_bsdf_sample *sample)
{
    bool crosses = wo.z * sample->wi.z < 0, transmits = (sample->lobe & SR_LOBE_TRANSMISSION) != 0;
    bool reflects = (sample->lobe & SR_LOBE_REFLECTION) != 0;
    uint32_t kind = sample->lobe & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY | SR_LOBE_SPECULAR);
    if (sample->lobe & ~sr_bsdf_lobes(s->b))
        return "a sample is of a lobe that lobes() does not tell";
    if (transmits == reflects)
        return "a sample is of both reflection and transmission, or of neither";
    if (transmits != crosses)
        return crosses ? "a sample on the other side is called a reflection"
                       : "a sample on the same side is called a transmission";
    if (!kind || (kind & (kind - 1)))
        return "a sample is not of just one of diffuse, glossy and specular";
    if (reflects && sample->eta != 1)
        return "a reflection has a relative index other than 1";
    return NULL;
}

/* A delta lobe in both forms: radiance is compressed by eta^2 where light goes on in another medium. */
static void check_delta_adjoint(struct certifying *c, sr_vec3 wo, float u, sr_vec2 square,
                                const struct sr_bsdf_sample *radiance)
{
    struct sr_bsdf_sample other;
    if (!(radiance->lobe & SR_LOBE_TRANSMISSION) ||
        !sr_bsdf_sample(c->subject->b, wo, u, square, SR_IMPORTANCE, &other))
        return;
    double worst = 0, eta2 = (double)radiance->eta * (double)radiance->eta;
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
        if (other.f[k] > 0 || radiance->f[k] > 0)
            worst = fmax(worst, lab_apart((double)radiance->f[k] * eta2 / (double)radiance->pdf,
                                          (double)(other.f[k] / other.pdf), 0));
    lab_find(c, CHECK_ADJOINT, worst, worst > LAB_EQUAL,
             "a refraction's weight times eta^2 = %.5g is not its weight for importance, at theta %.4g deg", eta2,
             lab_theta_deg(wo));
}

static void check_sample(struct certifying *c, sr_vec3 wo, enum check check)
{
    const struct subject *s = c->subject;
    struct sr_bsdf_sample sample, again;
    enum sr_transport mode = lab_u(&c->rng) < 0.5f ? SR_RADIANCE : SR_IMPORTANCE;
    float u = lab_u(&c->rng);
    sr_vec2 square = lab_square(&c->rng);
    ++c->findings->evaluations;
    if (!sr_bsdf_sample(s->b, wo, u, square, mode, &sample))
        return;
    char set[90];
    lab_describe(s, 0, set, sizeof set);
    double length = fabs((double)sr_length(sample.wi) - 1);
    if (!(length < 1e-5))
        lab_find(c, check, length, true, "a sampled direction has the length 1 %+.3g; %s", length, set);
    const char *wrong = wrong_lobe(s, wo, &sample);
    lab_find(c, CHECK_LOBES, wrong ? 1 : 0, wrong != NULL, "%s; %s", wrong ? wrong : "all samples are of lobes told",
             set);
    bool same = sr_bsdf_sample(s->b, wo, u, square, mode, &again) && again.pdf == sample.pdf &&
                memcmp(&again.wi, &sample.wi, sizeof again.wi) == 0;
    if (!same)
        lab_find(c, check, 1, true, "the same numbers draw another sample; %s", set);
    float pdf;
    sr_spectrum f = sr_bsdf_f_pdf(s->b, wo, sample.wi, mode, &pdf);
    if (sample.lobe & SR_LOBE_SPECULAR) {
        if (mode == SR_RADIANCE)
            check_delta_adjoint(c, wo, u, square, &sample);
        return;
    }
    if (sample.pdf_is_proportional)
        return;
    float dpdf = 0;
    sr_spectrum df = SR_BLACK;
    double of_pdf = lab_apart((double)sample.pdf, (double)pdf, 0), of_f = 0;
    int at = 0;
    for (int pass = 0; pass < 2; ++pass) {
        of_f = 0;
        for (int k = 0; k < SR_LAMBDA_COUNT && !s->is_random; ++k) {
            double d = lab_apart((double)sample.f[k], (double)f[k], (double)df[k]);
            if (d > of_f) {
                of_f = d;
                at = k;
            }
        }
        of_pdf = lab_apart((double)sample.pdf, (double)pdf, (double)dpdf);
        if ((of_f <= LAB_EQUAL && of_pdf <= LAB_EQUAL) || pass)
            break;
        lab_sensitivity(s, wo, sample.wi, mode, &df, &dpdf);
    }
    bool by_pdf = of_pdf > of_f;
    lab_find(c, check, fmax(of_f, of_pdf), fmax(of_f, of_pdf) > LAB_EQUAL,
             "a sample's %s = %.6g, but %s() = %.6g at theta_o %.4g, theta_i %.4g deg; %s", by_pdf ? "pdf" : "f",
             (double)(by_pdf ? sample.pdf : sample.f[at]), by_pdf ? "pdf" : "f", (double)(by_pdf ? pdf : f[at]),
             lab_theta_deg(wo), lab_theta_deg(sample.wi), set);
}

/* ---- all pairs ---- */

sr_vec3 lab_partner(struct certifying *c, sr_vec3 wo)
{
    float kind = lab_u(&c->rng);
    sr_vec3 wi = lab_anywhere(&c->rng);
    struct sr_bsdf_sample sample;
    if (kind < 0.4f) {
        float u = lab_u(&c->rng);
        if (sr_bsdf_sample(c->subject->b, wo, u, lab_square(&c->rng), SR_RADIANCE, &sample) &&
            sr_is_finite(sample.wi) && sr_length2(sample.wi) > 0.5f && sr_length2(sample.wi) < 2)
            return sample.wi;
    } else if (kind < 0.6f)
        wi = sr_normalize(sr_mad((sr_vec3){-wo.x, -wo.y, wo.z}, powf(10, -4 * lab_u(&c->rng)), lab_sphere(&c->rng)));
    else if (kind < 0.65f)
        wi = wo;
    if (!c->subject->transmits && kind < 0.9f)
        wi.z = copysignf(wi.z, wo.z);
    return wi;
}

void lab_check_pairs(struct certifying *c)
{
    struct subject *s = c->subject;
    const float tiny[] = {0, 1e-20f, 1e-8f, 1e-4f, 0.3f, 1};
    sr_vec3 w[12];
    for (int i = 0; i < 6; ++i) { // directions where formulas degenerate
        float r = sqrtf(1 - tiny[i] * tiny[i]);
        w[2 * i] = (sr_vec3){r, 0, tiny[i]};
        w[2 * i + 1] = (sr_vec3){0.6f * r, -0.8f * r, -tiny[i]};
    }
    uint64_t looked = 0;
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 24; ++j, ++looked) {
            sr_vec3 wi = j < 12 ? w[j] : (sr_vec3){-w[j - 12].x, -w[j - 12].y, w[j - 12].z};
            lab_check_values(c, CHECK_FINITE, CHECK_NON_NEGATIVE, w[i], wi);
        }
    uint32_t pairs = s->is_random ? 60 : 400;
    for (uint32_t i = 0; i < pairs; ++i, ++looked) {
        sr_vec3 wo = lab_anywhere(&c->rng), wi = lab_partner(c, wo);
        if (s->is_random)
            lab_reseed(s, i);
        if (!lab_check_values(c, CHECK_FINITE, CHECK_NON_NEGATIVE, wo, wi))
            continue; // the other laws are about numbers
        check_agreement(c, wo, wi, i & 1 ? SR_RADIANCE : SR_IMPORTANCE);
        if (!s->is_random)
            check_reciprocity(c, wo, wi);
        for (int k = 0; k < 4; ++k)
            check_sample(c, wo, CHECK_SAMPLE);
    }
    for (int i = 0; s->is_random && i < 2; ++i) {
        sr_vec3 wo = lab_sphere(&c->rng), wi = lab_sphere(&c->rng);
        if (!s->transmits || i == 0)
            wi.z = copysignf(wi.z, wo.z);
        check_mean_reciprocity(c, wo, wi);
    }
    if (s->is_random)
        check_exchange(c);
    lab_find(c, CHECK_FINITE, 0, false, "no NaN, no infinity");
    lab_find(c, CHECK_NON_NEGATIVE, 0, false, "nothing below 0");
    c->findings->of[CHECK_FINITE].count += looked - 1;
    c->findings->of[CHECK_NON_NEGATIVE].count += looked - 1;
    lab_skip(c, CHECK_RECIPROCITY, "it has delta lobes only");
    lab_skip(c, CHECK_ADJOINT, "nothing is transmitted");
    lab_skip(c, CHECK_SAMPLE, "samples know their density up to a factor only, or there are none");
    lab_skip(c, CHECK_LOBES, "nothing is ever drawn");
    lab_skip(c, CHECK_SUPPORT, "it has delta lobes only");
}

/* ---- extremes ---- */

// of a mean of chance; nothing of one that fills the square evenly
static const char *uncertainty(double error, char text[24])
{
    text[0] = 0;
    if (error > 0)
        snprintf(text, 24, " +- %.2g", error);
    return text;
}

void lab_check_extremes(struct certifying *c)
{
    struct subject *s = c->subject;
    char set[90], noise[24];
    lab_describe(s, 0, set, sizeof set);
    const double deg[] = {89, 89.9, 89.99, 89.9999};
    for (int i = 0; i < 4; ++i)
        for (int side = 0; side < 2; ++side) {
            double t = deg[i] * M_PI / 180, phi = 6.28 * (double)lab_u(&c->rng);
            sr_vec3 wo = {(float)(sin(t) * cos(phi)), (float)(sin(t) * sin(phi)), (float)(side ? -cos(t) : cos(t))};
            bool ok = true;
            for (int k = 0; k < 24; ++k)
                ok &= lab_check_values(c, CHECK_GRAZING, CHECK_GRAZING, wo, lab_partner(c, wo));
            int at;
            double E = ok ? lab_albedo(s, wo, 256, &at) : 0, error = 0;
            bool gains = E > s->largest_albedo * (1 + 1e-4) && lab_gains_energy(c, wo, at, &E, &error);
            lab_find(c, CHECK_GRAZING, E, gains, "albedo %.6g%s at theta_o %.6g deg; %s", E, uncertainty(error, noise),
                     deg[i], set);
        }
    for (int side = 0; side < 2; ++side) {
        sr_vec3 n = {0, 0, side ? -1.0f : 1.0f};
        bool ok = true;
        for (int k = 0; k < 64; ++k) {
            ok &= lab_check_values(c, CHECK_NORMAL, CHECK_NORMAL, n, lab_partner(c, n));
            if (ok)
                check_sample(c, n, CHECK_NORMAL);
        }
        for (int k = 0; k < 32 && ok && !s->is_random; ++k) { // nothing may jump there
            sr_vec3 wi = lab_partner(c, n);
            sr_vec3 near = {1e-5f, 0, n.z}, far = {2e-5f, 0, n.z};
            sr_spectrum f0 = sr_bsdf_f(s->b, n, wi, SR_RADIANCE), f1 = sr_bsdf_f(s->b, near, wi, SR_RADIANCE),
                        f2 = sr_bsdf_f(s->b, far, wi, SR_RADIANCE), df;
            float unused;
            lab_sensitivity(s, near, wi, SR_RADIANCE, &df, &unused);
            // narrow lobes change quickly, but evenly: a jump is what the next step does not do
            double jump = fabs((double)(f1[0] - f0[0])), step = fabs((double)(f2[0] - f1[0]));
            double excess = (jump - 8 * step - (double)df[0]) / fmax((double)sr_max(f0[0], f1[0]), 1e-6);
            // refraction by an index near 1 turns nothing, and may be narrower than these steps
            double share = excess > 0 && wi.z * n.z > 0.02f && fabsf(wi.z) < 0.999f ? excess : 0;
            lab_find(c, CHECK_NORMAL, share, share > 0.05,
                     "f jumps from %.5g to %.5g when wo leaves the normal by 6e-4 deg, theta_i %.4g deg; %s",
                     (double)f0[0], (double)f1[0], lab_theta_deg(wi), set);
        }
    }
    lab_find(c, CHECK_NORMAL, 0, false, "finite, agreeing with its samples, without a jump");
}

void lab_check_end(struct certifying *c, const char *name, bool at_max)
{
    struct subject *s = c->subject;
    char set[90], noise[24];
    lab_describe(s, 0, set, sizeof set);
    bool ok = true;
    for (int i = 0; i < 200; ++i) {
        sr_vec3 wo = lab_anywhere(&c->rng);
        ok &= lab_check_values(c, CHECK_ENDS, CHECK_ENDS, wo, lab_partner(c, wo));
        if (ok)
            check_sample(c, wo, CHECK_SAMPLE);
    }
    for (int i = 0; i < 6 && ok; ++i) {
        sr_vec3 wo = lab_anywhere(&c->rng);
        int k;
        double E = lab_albedo(s, wo, 256, &k), error = 0;
        bool gains = E > s->largest_albedo * (1 + 1e-4) && lab_gains_energy(c, wo, k, &E, &error);
        lab_find(c, CHECK_ENDS, E, gains, "%s at its %s: albedo %.6g%s at theta_o %.4g deg; %s", name,
                 at_max ? "greatest" : "least", E, uncertainty(error, noise), lab_theta_deg(wo), set);
    }
}
