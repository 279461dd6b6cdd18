/* SPDX-License-Identifier: MIT */
/* Where light that enters a translucent body comes out of it.
 *
 *     L(po, wo) has the part  T(wo) INTEGRAL_A S_r(|po - pi|) INTEGRAL S_w(wi) L(pi, wi) |cos theta_i| dwi dA
 *
 * A point of the surface is found by a chord: an axis of the frame at po (the normal by 1/2, each tangent by 1/4), a
 * wavelength, a distance r of its profile and an angle give a line, and of its n meetings with the same material inside
 * of the profile's reach one is taken. The density of a point, by area, is the mean over the wavelengths i and the sum
 * over the axes a,
 *
 *     pdf = 1/n SUM_i 1/8 SUM_a P_a pdf_i(distance of po and pi seen along a) |n_i . a|
 *         [1/m^2], over those i alone within whose reach pi lies
 *
 * King, Kulla, Conty & Fajardo 2013; Pharr, Jakob & Humphreys 2016, 15.4.1. Once dispersion has ended the other
 * wavelengths, the first alone counts. Limits: the body is locally flat and deep; reach leaves out 1e-4 of a profile.
 */
#include "integrator/integrator.h"

enum { MOST_MEETINGS = 256 }; // of one chord

// density per chord by area at the displacement d from po, in the frame, where the surface's normal is n
static float density(const struct sr_bssrdf *b, sr_vec3 d, sr_vec3 n, float distance, int wavelengths)
{
    const float across[3] = {d.y * d.y + d.z * d.z, d.x * d.x + d.z * d.z, d.x * d.x + d.y * d.y};
    const float share[3] = {0.25f * fabsf(n.x), 0.25f * fabsf(n.y), 0.5f * fabsf(n.z)};
    sr_spectrum sum = SR_BLACK, pdf;
    for (int a = 0; a < 3; ++a) {
        sr_bssrdf_profile(b, sqrtf(across[a]), &pdf);
        sum += share[a] * pdf;
    }
    float mean = 0;
    for (int i = 0; i < wavelengths; ++i)
        if (distance <= sr_bssrdf_reach(b, i))
            mean += sum[i] / (float)wavelengths;
    return mean;
}

bool sr_subsurface_step(const struct sr_scene *scene, const struct sr_bssrdf *b, sr_u4 u, struct sr_hit *x,
                        const struct sr_wavelengths *w, struct sr_worker *worker, sr_spectrum *beta,
                        struct sr_bsdf *bsdf, struct sr_frame *frame)
{
    int wavelengths = sr_wavelengths_secondary_terminated(w) ? 1 : SR_LAMBDA_COUNT;
    int i = (int)(u[3] * (float)wavelengths);
    float u_choice = u[3] * (float)wavelengths - (float)i; // which of the meetings
    float r = sr_bssrdf_sample(b, i, u[0]), reach = sr_bssrdf_reach(b, i);
    if (!(r >= 0 && r < reach))
        return false;

    // the chord: along `along`, at the distance r from it in the plane of the other two axes
    struct sr_frame local = sr_frame_from_z(x->point.ns);
    sr_vec3 along = local.z, s = local.x, t = local.y;
    if (u[2] < 0.25f) {
        along = local.x;
        s = local.z;
    } else if (u[2] < 0.5f) {
        along = local.y;
        t = local.z;
    }
    float sine, cosine, half = sqrtf((reach - r) * (reach + r));
    sr_sin_cos_turn(u[1], &sine, &cosine);
    sr_vec3 o = sr_mad(sr_mad(sr_mad(x->point.p, r * cosine, s), r * sine, t), -half, along);
    struct sr_ray ray = {.o = o, .d = along, .time = x->point.time, .t_max = 2 * half};

    struct sr_hit met, exit = *x;
    int count = 0;
    for (int k = 0; k < MOST_MEETINGS && sr_trace(scene, &ray, &met, worker); ++k) {
        if (met.material == x->material) { // the n-th stays with probability 1 / n
            ++count;
            float first = 1 / (float)count;
            if (u_choice < first) {
                exit = met;
                u_choice /= first;
            } else {
                u_choice = (u_choice - first) / (1 - first);
            }
        }
        struct sr_ray next = sr_leave(&met.point, along);
        next.t_max = 2 * half - sr_dot(sr_sub(next.o, o), along);
        ray = next;
        if (!(ray.t_max > 0))
            break;
    }
    if (count == 0)
        return false;
    sr_vec3 d = sr_sub(exit.point.p, x->point.p);
    float distance = sr_length(d);
    float pdf = density(b, sr_to_local(&local, d), sr_to_local(&local, exit.point.n), distance, wavelengths);
    if (!(pdf > 0))
        return false;
    *beta *= sr_bssrdf_profile(b, distance, NULL) * ((float)count / pdf);
    exit.t = x->t;
    *x = exit;
    sr_bsdf_exit_make(bsdf, b->eta);
    *frame = sr_frame_from_z(x->point.ns);
    return sr_spectrum_any(*beta > 0.0f);
}
