/* SPDX-License-Identifier: MIT */
/* Single measurements (theta_i, phi_i, theta_o, phi_o; values): checked, then made a grid where they fill one, else a
 * cloud.
 *
 * Angles are in radians from +z; theta_o above 90 deg is light that has passed through. Where all measurements share
 * one phi_i the data are isotropic, and only phi_o - phi_i counts. */
#include "measured/private.h"

static sr_status check(const struct source *s, struct rows *rows, struct sr_measured *m)
{
    const float eps = 1e-3f;
    m->theta_i[0] = m->theta_o[0] = INFINITY;
    m->theta_i[1] = m->theta_o[1] = 0;
    bool same_phi = true;
    for (size_t k = 0; k < rows->count; ++k) {
        float *a = rows->angles + 4 * k;
        for (int i = 0; i < 4; ++i)
            if (!isfinite(a[i]) || fabsf(a[i]) > 4 * SR_PI + eps)
                return fail_at(s, 0, "measurement %zu: an angle of %g rad, at most two turns are expected", k + 1,
                               (double)a[i]);
        for (int i = 0; i < 4; i += 2)
            if (a[i] < 0) { // the plane of incidence is often told with signed polar angles
                a[i] = -a[i];
                a[i + 1] += SR_PI;
            }
        if (a[0] > SR_PI / 2 + eps)
            return fail_at(s, 0, "measurement %zu: light comes from theta_i = %.4g deg, 0 to 90 are expected", k + 1,
                           (double)a[0] * 180 / PI);
        if (a[2] > SR_PI + eps)
            return fail_at(s, 0, "measurement %zu: light leaves to theta_o = %.4g deg, 0 to 180 are expected", k + 1,
                           (double)a[2] * 180 / PI);
        bool through = a[2] > SR_PI / 2 + 1e-4f;
        m->sides |= through ? SR_MEASURED_TRANSMISSION : SR_MEASURED_REFLECTION;
        m->theta_i[0] = sr_min(m->theta_i[0], a[0]);
        m->theta_i[1] = sr_max(m->theta_i[1], a[0]);
        float o = through ? SR_PI - a[2] : a[2];
        m->theta_o[0] = sr_min(m->theta_o[0], o);
        m->theta_o[1] = sr_max(m->theta_o[1], o);
        same_phi = same_phi && fabsf(a[1] - rows->angles[1]) < 1e-4f;
    }
    m->is_isotropic = same_phi;
    if (same_phi)
        for (size_t k = 0; k < rows->count; ++k) {
            rows->angles[4 * k + 3] -= rows->angles[4 * k + 1];
            rows->angles[4 * k + 1] = 0;
        }
    size_t n = rows->count * (size_t)rows->channels.count;
    for (size_t k = 0; k < n; ++k) {
        if (!isfinite(rows->values[k]) || fabsf(rows->values[k]) > 1e15f)
            return fail_at(s, 0, "measurement %zu: a value of %g, a finite one up to 1e15 is expected",
                           k / (size_t)rows->channels.count + 1, (double)rows->values[k]);
        if (rows->values[k] < 0) { // noise about zero
            rows->values[k] = 0;
            m->invalid++;
        }
    }
    if (m->invalid > n / 2)
        return fail_at(s, 0, "%llu of %zu values are negative: these are no scattering data",
                       (unsigned long long)m->invalid, n);
    m->values = n;
    double i = (double)(cosf(m->theta_i[0]) * cosf(m->theta_i[0]) - cosf(m->theta_i[1]) * cosf(m->theta_i[1]));
    double o = (double)(cosf(m->theta_o[0]) * cosf(m->theta_o[0]) - cosf(m->theta_o[1]) * cosf(m->theta_o[1]));
    m->coverage = i * o;
    return SR_OK;
}

sr_status rows_finish(const struct source *s, struct rows *rows, struct sr_measured *m)
{
    if (rows->count == 0)
        return fail_at(s, 0, "holds no measurement, at least one is expected");
    sr_status status = check(s, rows, m);
    if (status != SR_OK)
        return status;
    m->channels = rows->channels;
    bool no_memory = false;
    if (grid_build(s, rows, m, &no_memory))
        return SR_OK;
    if (no_memory)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory for its %zu measurements", s->name,
                       rows->count);
    return cloud_build(s, rows, m);
}
