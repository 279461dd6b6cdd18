/* SPDX-License-Identifier: MIT */
/* Cornell's irregular goniometer data: text, isotropic, a spectrum for each pair of directions.
 *
 *     # num wls          the count n
 *     # wls              n wavelengths [nm]
 *     # theta i, phi i, theta s, phi s, spectral sample values      4 angles [rad] and n values of f [1/sr], many times
 *
 * Both azimuths belong to directions away from the surface: the mirror direction is at phi_s = phi_i + pi. Program of
 * Computer Graphics, Cornell University; the light measurement laboratory of S. Foo 1997. */
#include "measured/private.h"

static bool next_number(struct scan *s, double *value)
{
    for (;;) {
        while (s->at < s->end &&
               (*s->at == ' ' || *s->at == '\t' || *s->at == '\r' || *s->at == '\n' || *s->at == ',')) {
            s->line += *s->at == '\n';
            s->at++;
        }
        if (s->at >= s->end || *s->at != '#')
            break;
        while (s->at < s->end && *s->at != '\n')
            s->at++;
    }
    return scan_number(s, value);
}

sr_status read_cornell(const struct source *s, struct sr_measured *m)
{
    struct scan t = scan_start(s->data, s->size);
    t.line = 1;
    double value;
    if (!next_number(&t, &value) || value < 1 || value > MAX_CHANNELS || value != floor(value))
        return fail_at(s, t.line, "the number of wavelengths is expected, 1 to %d", MAX_CHANNELS);
    int n = (int)value;
    float lambda[MAX_CHANNELS];
    for (int i = 0; i < n; ++i) {
        if (!next_number(&t, &value))
            return fail_at(s, t.line, "%d wavelengths in nm are expected, %d are there", n, i);
        lambda[i] = (float)value;
    }
    struct rows rows = {0};
    float *kept = sr_arena_copy(s->arena, lambda, (size_t)n * sizeof(float));
    if (!kept)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    if (!channels_set_lambda(&rows.channels, kept, n))
        return fail_at(s, t.line, "the wavelengths do not increase");
    rows.channels.stride = 1;
    struct sr_array angles = {0}, values = {0};
    sr_status status = SR_OK;
    for (int column = 0; status == SR_OK; column = column == 3 + n ? 0 : column + 1) {
        if (!next_number(&t, &value)) {
            if (t.at < t.end)
                status = fail_at(s, t.line, "a number is expected, not \"%.*s\"",
                                 (int)(t.end - t.at < 12 ? t.end - t.at : 12), t.at);
            else if (column != 0)
                status = fail_at(
                    s, t.line,
                    "the file ends inside a measurement: 4 angles and %d values are expected, %d numbers are there", n,
                    column);
            break;
        }
        float *at = sr_array_push(column < 4 ? &angles : &values, sizeof(float));
        if (!at)
            status = sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
        else
            *at = (float)value;
    }
    rows.count = angles.count / 4;
    rows.angles = angles.data;
    rows.values = values.data;
    if (status == SR_OK)
        status = rows_finish(s, &rows, m);
    sr_array_free(&angles);
    sr_array_free(&values);
    return status;
}
