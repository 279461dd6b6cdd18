/* SPDX-License-Identifier: MIT */
/* MERL binary: 100 isotropic materials' format, a table over half and difference angles.
 *
 *     int32 n_h, n_d, n_p (90, 90, 180); then 3 n_h n_d n_p doubles: all of red, all of green, all of blue
 *     cell (i, j, k): theta_h = ((i + 1/2) / n_h)^2 pi/2, theta_d = (j + 1/2) / n_d pi/2, phi_d = (k + 1/2) / n_p pi
 *     f [1/sr] = (1, 1.15, 1.66) / 1500 times the number
 *
 * W. Matusik, H. Pfister, M. Brand & L. McMillan 2003; angles of S. Rusinkiewicz 1998; phi_d + pi is the same by
 * reciprocity. Between the cells' centres f is linear. Negative numbers mark what was not measured or lies below the
 * horizon: they take no part, are counted, and are 0 only where all neighbours are. Near grazing (above some 80 deg)
 * the published data are extrapolated, and some metals reflect more than they receive: that is reported, and left as it
 * is. */
#include "measured/private.h"

static const double scale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

struct merl {
    int n[3];
    float *values; // three a cell; the first is negative where the cell is invalid
    struct channels channels;
};

struct half_difference half_difference_of(sr_vec3 wo, sr_vec3 wi)
{
    sr_vec3 h = sr_add(wo, wi);
    float length2 = sr_length2(h);
    if (!(length2 > 1e-12f))
        return (struct half_difference){SR_PI / 2, SR_PI / 2, 0};
    h = sr_scale(1 / sqrtf(length2), h);
    float sin_h = sqrtf(h.x * h.x + h.y * h.y);
    // axes of the frame of h: along theta and along phi
    float cos_phi = sin_h > 0 ? h.x / sin_h : 1, sin_phi = sin_h > 0 ? h.y / sin_h : 0;
    sr_vec3 t = {h.z * cos_phi, h.z * sin_phi, -sin_h}, b = {-sin_phi, cos_phi, 0};
    float x = sr_dot(wi, t), y = sr_dot(wi, b);
    return (struct half_difference){atan2f(sin_h, h.z), atan2f(sqrtf(x * x + y * y), sr_dot(wi, h)),
                                    x != 0 || y != 0 ? atan2f(y, x) : 0};
}

/* phi_h = 0 */
void half_difference_directions(double theta_h, double theta_d, double phi_d, sr_vec3 *wo, sr_vec3 *wi)
{
    double sh = sin(theta_h), ch = cos(theta_h), sd = sin(theta_d), cd = cos(theta_d);
    double x = sd * cos(phi_d), y = sd * sin(phi_d);
    *wi = (sr_vec3){(float)(x * ch + cd * sh), (float)y, (float)(cd * ch - x * sh)};
    *wo = (sr_vec3){(float)(-x * ch + cd * sh), (float)-y, (float)(cd * ch + x * sh)};
}

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct merl *m = data;
    struct half_difference a = half_difference_of(wo, wi);
    float x[3] = {(float)m->n[0] * sqrtf(a.theta_h * (2 / SR_PI)) - 0.5f,
                  (float)m->n[1] * a.theta_d * (2 / SR_PI) - 0.5f,
                  (float)m->n[2] * (a.phi_d < 0 ? a.phi_d * SR_INV_PI + 1 : a.phi_d * SR_INV_PI) - 0.5f};
    int index[3][2];
    float share[3][2];
    for (int i = 0; i < 3; ++i) {
        float floor_x = floorf(x[i]);
        int lo = (int)floor_x;
        share[i][1] = x[i] - floor_x;
        share[i][0] = 1 - share[i][1];
        for (int k = 0; k < 2; ++k)
            index[i][k] = i == 2              ? (lo + k + m->n[2]) % m->n[2]
                          : lo + k < 0        ? 0
                          : lo + k >= m->n[i] ? m->n[i] - 1
                                              : lo + k;
    }
    struct corners at = {0};
    float sum = 0;
    for (int k = 0; k < 8; ++k) {
        size_t cell = ((size_t)index[0][k >> 2] * (size_t)m->n[1] + (size_t)index[1][k >> 1 & 1]) * (size_t)m->n[2] +
                      (size_t)index[2][k & 1];
        float w = share[0][k >> 2] * share[1][k >> 1 & 1] * share[2][k & 1];
        if (!(w > 0) || m->values[3 * cell] < 0)
            continue;
        at.base[at.count] = 3 * cell;
        at.weight[at.count++] = w;
        sum += w;
    }
    if (at.count == 0)
        return SR_BLACK;
    for (int k = 0; k < at.count; ++k)
        at.weight[k] /= sum;
    return channels_eval(&m->channels, m->values, &at, lambda);
}

sr_status read_merl(const struct source *s, struct sr_measured *m)
{
    struct merl *merl = sr_arena_alloc(s->arena, sizeof *merl);
    if (!merl)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    uint64_t cells = 1;
    for (int i = 0; i < 3; ++i) {
        int32_t n;
        memcpy(&n, s->data + 4 * i, sizeof n);
        if (n < 2 || n > 4096)
            return fail_at(s, 0, "byte %d: %d cells of an angle, 2 to 4096 are expected in a MERL file", 4 * i, (int)n);
        merl->n[i] = n;
        cells *= (uint64_t)n;
    }
    if (s->size != 12 + 24 * cells)
        return fail_at(s, 0, "is %zu bytes long, a MERL file of %d x %d x %d cells has %llu", s->size, merl->n[0],
                       merl->n[1], merl->n[2], (unsigned long long)(12 + 24 * cells));
    merl->values = sr_arena_alloc(s->arena, 3 * cells * sizeof(float));
    if (!merl->values)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory for %llu cells", s->name,
                       (unsigned long long)cells);
    for (uint64_t k = 0; k < cells; ++k) {
        bool valid = true;
        for (int c = 0; c < 3; ++c) {
            double v;
            memcpy(&v, s->data + 12 + 8 * (k + (uint64_t)c * cells), sizeof v);
            if (!(fabs(v) < 1e15))
                return fail_at(s, 0, "byte %llu: a value of %g, a finite one is expected",
                               (unsigned long long)(12 + 8 * (k + (uint64_t)c * cells)), v);
            valid = valid && v >= 0;
            merl->values[3 * k + (uint64_t)c] = (float)(v * scale[c]);
        }
        if (!valid) {
            merl->values[3 * k] = -1;
            m->invalid++;
        }
    }
    // what of the pairs above the horizon was measured: z of both directions is cos_h cos_d +- sin_h sin_d cos(phi_d)
    uint64_t above = 0, measured = 0;
    for (int i = 0; i < merl->n[0]; ++i) {
        double h = (i + 0.5) * (i + 0.5) / merl->n[0] / merl->n[0] * PI / 2;
        for (int j = 0; j < merl->n[1]; ++j) {
            double d = (j + 0.5) / merl->n[1] * PI / 2, limit = cos(h) * cos(d), slope = sin(h) * sin(d);
            for (int k = 0; k < merl->n[2]; ++k)
                if (slope * fabs(cos((k + 0.5) / merl->n[2] * PI)) < limit) {
                    ++above;
                    measured +=
                        merl->values[3 * (((uint64_t)i * (uint64_t)merl->n[1] + (uint64_t)j) * (uint64_t)merl->n[2] +
                                          (uint64_t)k)] >= 0;
                }
        }
    }
    if (measured == 0)
        return fail_at(s, 0, "all of its cells are marked as invalid");
    merl->channels = (struct channels){.kind = CHANNEL_RGB, .count = 3, .stride = 1};
    m->data = merl;
    m->f = f;
    m->channels = merl->channels;
    m->values = 3 * cells;
    m->invalid *= 3;
    m->sides = SR_MEASURED_REFLECTION;
    m->is_isotropic = true;
    m->theta_i[1] = m->theta_o[1] = SR_PI / 2;
    m->coverage = (double)measured / (double)above;
    m->note = "colours were taken as linear sRGB; data beyond about 80 deg are extrapolated by their makers";
    return SR_OK;
}

sr_status sr_measured_write_merl(const char *path, sr_measured_source source, void *user, struct sr_error *error)
{
    static const int32_t n[3] = {90, 90, 180};
    size_t cells = 90 * 90 * 180, size = 12 + 24 * cells;
    char *file = sr_alloc(size);
    if (!file)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
    memcpy(file, n, sizeof n);
    struct rgb_weights weights = rgb_weights_make();
    for (size_t cell = 0; cell < cells; ++cell) {
        double i = (double)(cell / 180 / 90) + 0.5, j = (double)(cell / 180 % 90) + 0.5, k = (double)(cell % 180) + 0.5;
        sr_vec3 wo, wi;
        half_difference_directions(i * i / 8100 * PI / 2, j / 90 * PI / 2, k / 180 * PI, &wo, &wi);
        double value[3] = {-1, -1, -1};
        if (wo.z > 0 && wi.z > 0) {
            struct sr_rgb rgb = rgb_of(&weights, source, user, wo, wi);
            value[0] = (double)sr_max(rgb.r, 0) / scale[0];
            value[1] = (double)sr_max(rgb.g, 0) / scale[1];
            value[2] = (double)sr_max(rgb.b, 0) / scale[2];
        }
        for (size_t c = 0; c < 3; ++c)
            memcpy(file + 12 + 8 * (cell + c * cells), &value[c], sizeof value[c]);
    }
    sr_status status = sr_file_write(path, file, size, error);
    sr_free(file);
    return status;
}
