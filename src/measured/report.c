/* SPDX-License-Identifier: MIT */
/* What data are worth: how much light they return, whether they are reciprocal, what they cover.
 *
 *     E(wi) = INTEGRAL f |cos_theta_o| dwo = INTEGRAL f |cos_theta_o| 4 |wi.m| dm,   dm = sin_theta_m pi u 2 pi du dv
 *
 * over half vectors m, theta_m = u^2 pi / 2, so that nodes lie close where lobes are narrow: Gauss-Legendre in u, even
 * in v. Data that are constant over patches are summed patch by patch instead. */
#include "measured/private.h"

enum { MAX_NODES = 128 };

sr_spectrum sr_measured_albedo(const struct sr_measured *m, sr_vec3 wi, uint32_t side, sr_spectrum lambda, int n)
{
    double u[MAX_NODES], weight[MAX_NODES];
    n = n < 4 ? 4 : n > MAX_NODES ? MAX_NODES : n;
    sr_gauss_legendre(n, 0, 1, u, weight);
    sr_spectrum sum = SR_BLACK;
    if (wi.z == 0 || !(sr_measured_sides(m) & side))
        return sum;
    if (m->albedo) {
        wi.z = m->has_back ? wi.z : fabsf(wi.z);
        return (wi.z < 0 ? m->back_sides : m->sides | (m->has_back ? 0 : m->back_sides)) & side
                   ? m->albedo(m->data, wi, side, lambda)
                   : sum;
    }
    sr_vec3 up = {wi.x, wi.y, fabsf(wi.z)};
    float phi_i = wi.x != 0 || wi.y != 0 ? atan2f(wi.y, wi.x) : 0;
    for (int i = 0; i < n; ++i) {
        double theta = PI / 2 * u[i] * u[i];
        float share = (float)(weight[i] * sin(theta) * PI * u[i] * 2 * PI / n);
        for (int j = 0; j < n; ++j) {
            float phi = phi_i + 2 * SR_PI * ((float)j + 0.5f) / (float)n;
            sr_vec3 h = sr_spherical_direction((float)sin(theta), (float)cos(theta), phi);
            float c = sr_dot(up, h);
            sr_vec3 wo = sr_sub(sr_scale(2 * c, h), up);
            if (!(c > 0 && wo.z > 0))
                continue;
            float weight_here = share * wo.z * 4 * c;
            if ((wi.z < 0) != (side == SR_MEASURED_TRANSMISSION))
                wo.z = -wo.z;
            sum += sr_measured_f(m, wo, wi, lambda) * weight_here;
        }
    }
    return sum;
}

static sr_vec3 direction(double theta_deg, double phi_deg, bool is_back)
{
    double t = theta_deg * PI / 180, p = phi_deg * PI / 180;
    return (sr_vec3){(float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)(is_back ? -cos(t) : cos(t))};
}

static void measure_energy(const struct sr_measured *m, sr_spectrum lambda, struct sr_measured_report *r)
{
    bool has_front = m->sides != 0;
    for (int i = 0; i < SR_MEASURED_REPORT_ANGLES; ++i) {
        r->scatter[i].theta = 10.0 * i;
        sr_vec3 wi = direction(10.0 * i, 0, !has_front);
        r->scatter[i].reflected =
            (double)sr_spectrum_mean(sr_measured_albedo(m, wi, SR_MEASURED_REFLECTION, lambda, 64));
        r->scatter[i].transmitted =
            (double)sr_spectrum_mean(sr_measured_albedo(m, wi, SR_MEASURED_TRANSMISSION, lambda, 64));
    }
    int phis = m->is_isotropic ? 1 : 8;
    for (int face = 0; face < (m->has_back ? 2 : 1); ++face)
        for (int i = 0; i <= 18; ++i)
            for (int j = 0; j < (i ? phis : 1); ++j) {
                double theta = i < 18 ? 5.0 * i : 88, phi = 45.0 * j;
                sr_vec3 wi = direction(theta, phi, face);
                sr_spectrum E = sr_measured_albedo(m, wi, SR_MEASURED_REFLECTION, lambda, 48) +
                                sr_measured_albedo(m, wi, SR_MEASURED_TRANSMISSION, lambda, 48);
                for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                    if ((double)E[k] > r->largest_albedo) {
                        r->largest_albedo = (double)E[k];
                        r->largest_theta = face ? 180 - theta : theta;
                        r->largest_phi = phi;
                        r->largest_lambda = (double)lambda[k];
                    }
            }
}

/* by pairs, half of them even over both hemispheres, half of them drawn from the data */
static void measure_reciprocity(const struct sr_measured *m, sr_spectrum lambda, struct sr_measured_report *r)
{
    enum { PAIRS = 8000 };
    struct sr_rng rng = sr_rng_seed(1, 1);
    double difference = 0, sum = 0;
    for (int n = 0; n < PAIRS; ++n) {
        float u[6];
        for (int i = 0; i < 6; ++i)
            u[i] = sr_rng_float(&rng);
        sr_vec3 a = sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]}),
                b = sr_warp_cosine_hemisphere((sr_vec2){u[2], u[3]});
        a.z *= m->has_back && u[5] < 0.5f ? -1.f : 1.f;
        float pdf = 1;
        if (n & 1 && !sr_measured_sample(m, a, u[4], (sr_vec2){u[2], u[3]}, &b, &pdf))
            continue;
        if (!(n & 1) && sr_measured_sides(m) & SR_MEASURED_TRANSMISSION && u[4] < 0.5f)
            b.z = -b.z;
        if (fabsf(a.z) < 0.1f || fabsf(b.z) < 0.1f)
            continue; // where data end
        double forth = (double)sr_spectrum_mean(sr_measured_f(m, a, b, lambda));
        double back = (double)sr_spectrum_mean(sr_measured_f(m, b, a, lambda));
        double error = fabs(forth - back), greater = fmax(forth, back);
        if (!(n & 1)) {
            difference += error;
            sum += greater;
        }
        if (greater > 0 && error / greater > r->reciprocity_max) {
            const sr_vec3 w[2] = {a, b};
            r->reciprocity_max = error / greater;
            for (int k = 0; k < 2; ++k) {
                r->reciprocity_theta[k] = acos((double)sr_clamp(w[k].z, -1, 1)) * 180 / PI;
                r->reciprocity_phi[k] = atan2((double)w[k].y, (double)w[k].x) * 180 / PI;
            }
        }
    }
    r->reciprocity_mean = sum > 0 ? difference / sum : 0;
}

void sr_measured_report(const struct sr_measured *m, struct sr_measured_report *out)
{
    static const char *const quantities[] = {"", "BSDF", "BSDF times cosine", "reflectance factor"};
    sr_spectrum lambda;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        lambda[i] = 430 + 250 * (float)i / (SR_LAMBDA_COUNT - 1);
    *out = (struct sr_measured_report){
        .format = sr_measured_format_name(m->format),
        .description = m->description,
        .quantity = quantities[m->format == SR_MEASURED_RGL ? SR_MEASURED_TIMES_COSINE : m->quantity],
        .note = m->note,
        .sides = sr_measured_sides(m),
        .channels = m->channels.count,
        .is_spectral = m->channels.kind == CHANNEL_SPECTRAL,
        .is_isotropic = m->is_isotropic,
        .values = m->values,
        .invalid = m->invalid,
        .theta_i_min = m->theta_i[0] * (180 / SR_PI),
        .theta_i_max = m->theta_i[1] * (180 / SR_PI),
        .theta_o_min = m->theta_o[0] * (180 / SR_PI),
        .theta_o_max = m->theta_o[1] * (180 / SR_PI),
        .coverage = m->coverage};
    if (out->is_spectral) {
        out->lambda_min = m->channels.lambda[0];
        out->lambda_max = m->channels.lambda[m->channels.count - 1];
    }
    measure_energy(m, lambda, out);
    measure_reciprocity(m, lambda, out);
}
