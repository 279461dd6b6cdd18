/* SPDX-License-Identifier: MIT */
/* Polarised measurements: Mueller matrices over half and difference angles. Their intensity, for unpolarised light.
 *
 *     f = M_00(phi_d, theta_d, theta_h, lambda)     [1/sr]
 *
 * fields theta_h, theta_d, phi_d [rad], wvls [nm, uint16], M [phi_d, theta_d, theta_h, wvls, 4, 4]. S.-H. Baek et al.,
 * Image-based acquisition and modeling of polarimetric reflectance, 2020. Linear between; what is not a number lies
 * below the horizon and counts as 0, so does what is negative. Files that name no angles have them evenly from 0 to 90
 * deg, phi_d from -180 to 180. */
#include "measured/private.h"

struct polarised {
    int n[3]; // phi_d, theta_d, theta_h
    float *axes[3];
    float *values;
    struct channels channels;
};

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct polarised *p = data;
    struct half_difference a = half_difference_of(wo, wi);
    float x[3] = {a.phi_d, a.theta_d, a.theta_h}, t[3];
    int lo[3];
    for (int i = 0; i < 3; ++i)
        lo[i] = axis_find(p->axes[i], p->n[i], x[i], &t[i]);
    struct corners at = {0};
    for (int k = 0; k < 8; ++k) {
        float w = (k & 4 ? t[0] : 1 - t[0]) * (k & 2 ? t[1] : 1 - t[1]) * (k & 1 ? t[2] : 1 - t[2]);
        if (!(w > 0))
            continue;
        size_t cell =
            ((size_t)(lo[0] + (k >> 2)) * (size_t)p->n[1] + (size_t)(lo[1] + (k >> 1 & 1))) * (size_t)p->n[2] +
            (size_t)(lo[2] + (k & 1));
        at.base[at.count] = cell * (size_t)p->channels.count;
        at.weight[at.count++] = w;
    }
    return channels_eval(&p->channels, p->values, &at, lambda);
}

static sr_status read_axis(const struct tensor_file *t, const char *name, float lo, float hi, uint64_t count,
                           float **axis, bool *is_silent)
{
    const struct source *s = t->source;
    const struct tensor_field *field = tensor_need(t, name, TENSOR_F32, 2);
    if (!field)
        return SR_ERROR_INPUT;
    if (field->shape[1] != count || count < 2 || field->shape[0] > 1)
        return fail_at(s, 0, "field %s is of %llu x %llu angles, 1 x %llu are expected by the shape of M", name,
                       (unsigned long long)field->shape[0], (unsigned long long)field->shape[1],
                       (unsigned long long)count);
    if (field->shape[0] == 1) {
        *axis = tensor_floats(t, field, -7);
        for (uint64_t i = 1; *axis && i < count; ++i)
            if (!((*axis)[i] > (*axis)[i - 1]))
                return fail_at(s, 0, "field %s does not increase at element %llu", name, (unsigned long long)i);
        return *axis ? SR_OK : SR_ERROR_INPUT;
    }
    *is_silent = true;
    *axis = sr_arena_alloc(s->arena, count * sizeof(float));
    for (uint64_t i = 0; *axis && i < count; ++i)
        (*axis)[i] = lo + (hi - lo) * (float)i / (float)(count - 1);
    return *axis ? SR_OK : sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
}

sr_status read_polarised(const struct tensor_file *t, struct sr_measured *m)
{
    const struct source *s = t->source;
    const struct tensor_field *M = tensor_need(t, "M", TENSOR_F32, 6), *wvls = tensor_need(t, "wvls", TENSOR_U16, 1);
    struct polarised *p = sr_arena_alloc(s->arena, sizeof *p);
    if (!M || !wvls || !p)
        return M && wvls ? sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name) : SR_ERROR_INPUT;
    if (M->shape[3] != wvls->count || wvls->count == 0 || wvls->count > MAX_CHANNELS || M->shape[4] != 4 ||
        M->shape[5] != 4)
        return fail_at(s, 0,
                       "field M holds %llu x %llu matrices at %llu wavelengths, 4 x 4 at the %llu of wvls are expected",
                       (unsigned long long)M->shape[4], (unsigned long long)M->shape[5],
                       (unsigned long long)M->shape[3], (unsigned long long)wvls->count);
    static const char *const names[3] = {"phi_d", "theta_d", "theta_h"};
    bool is_silent = false;
    for (int i = 0; i < 3; ++i) {
        p->n[i] = (int)M->shape[i];
        sr_status status =
            read_axis(t, names[i], i ? 0 : -SR_PI, i ? SR_PI / 2 : SR_PI, M->shape[i], &p->axes[i], &is_silent);
        if (status != SR_OK)
            return status;
    }
    uint64_t count = M->count / 16;
    float *lambda = sr_arena_alloc(s->arena, wvls->count * sizeof(float));
    p->values = sr_arena_alloc(s->arena, (count + 1) * sizeof(float));
    if (!lambda || !p->values)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    for (uint64_t i = 0; i < wvls->count; ++i) {
        uint16_t nm;
        memcpy(&nm, wvls->data + 2 * i, sizeof nm);
        lambda[i] = nm;
    }
    if (!channels_set_lambda(&p->channels, lambda, (int)wvls->count))
        return fail_at(s, 0, "field wvls does not increase");
    p->channels.stride = 1;
    for (uint64_t i = 0; i < count; ++i) {
        float v;
        memcpy(&v, M->data + 64 * i, sizeof v);
        if (v > 1e15f)
            return fail_at(s, 0, "byte %llu: an intensity of %g",
                           (unsigned long long)((size_t)(M->data - s->data) + 64 * i), (double)v);
        m->invalid += !(v >= 0);
        p->values[i] = v >= 0 ? v : 0;
    }
    if (m->invalid == count)
        return fail_at(s, 0, "field M has no valid intensity");
    m->format = SR_MEASURED_POLARISED;
    m->data = p;
    m->f = f;
    m->channels = p->channels;
    m->values = count;
    m->sides = SR_MEASURED_REFLECTION;
    m->is_isotropic = true;
    m->theta_i[1] = m->theta_o[1] = SR_PI / 2;
    m->coverage = 1 - (double)m->invalid / (double)count;
    m->note = is_silent ? "the file names no angles: taken as even, theta 0 to 90 deg, phi_d -180 to 180 deg" : "";
    return SR_OK;
}
