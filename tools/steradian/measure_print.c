/* SPDX-License-Identifier: MIT */
/* steradian measure: readings as lines and as JSON. */
#include "measure_command.h"

#include <stdio.h>
#include <string.h>

/* ---- lines ---- */

void measure_print(const struct measure_arguments *a, const struct sr_meter *meter, const struct sr_spectrometer *s,
                   const struct sr_measurement *m, int width)
{
    char symbol[64], text[256];
    const char *name = sr_meter_common(meter)->name;
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i) {
        if (!a->systems[i])
            continue;
        struct sr_quantity q = m->value[i];
        if (m->samples && !m->hits && !(q.upper > 0))
            q.u = 0, q.degrees = 1; // which the text tells from an uncertainty
        printf("%-*s  %s\n", width, name,
               sr_quantity_text(measure_symbol(meter, (enum sr_system)i, symbol), &q, text, sizeof text));
        name = "";
    }
    for (int i = 0; measure_wants_colour(a, meter) && i < SR_COLOUR_COUNT; ++i) {
        sr_quantity_text(sr_colour_names[i], &m->colour[i], text, sizeof text);
        char *rest = strstr(text, " (95");
        if (i == SR_COLOUR_CCT && rest) { // the one that has a unit of its own
            char plain[256];
            snprintf(plain, sizeof plain, "%.*s K%s", (int)(rest - text), text, rest);
            memcpy(text, plain, sizeof text);
        }
        printf("%-*s  %s\n", width, "", text);
    }
    for (uint32_t k = 0; k < s->count; ++k)
        printf("%-*s  %g nm  %s\n", width, "", s->first + k * s->step,
               sr_quantity_text(NULL, &m->spectrum[k], text, sizeof text));
    fflush(stdout);
}

/* ---- JSON ---- */

static json_t *spectrum_json(const struct sr_spectrometer *s, const struct sr_measurement *m)
{
    json_t *lambda = json_array(), *value = json_array(), *u = json_array();
    char unit[96] = "";
    for (uint32_t k = 0; k < s->count; ++k) {
        json_array_append_new(lambda, json_real(s->first + k * s->step));
        json_array_append_new(value, command_json_number(m->spectrum[k].value));
        json_array_append_new(u, command_json_number(m->spectrum[k].u));
        sr_unit_text(m->spectrum[k].unit, unit, sizeof unit);
    }
    return json_pack("{s:s, s:f, s:s, s:o, s:o, s:o, s:f}", "bandpass",
                     s->bandpass == SR_BAND_TRIANGULAR ? "triangular" : "rectangular", "fwhm_nm", s->fwhm, "unit", unit,
                     "lambda_nm", lambda, "value", value, "standard_uncertainty", u, "degrees_of_freedom",
                     s->count ? m->spectrum[0].degrees : 0);
}

json_t *measure_json(const struct measure_arguments *a, const struct sr_meter *meter, const struct sr_spectrometer *s,
                     const struct sr_measurement *m)
{
    json_t *readings = json_object(), *remarks = json_array();
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i) {
        char symbol[64];
        json_t *q = command_json_measured(&m->value[i]);
        json_object_set_new(q, "symbol", command_json_text(measure_symbol(meter, (enum sr_system)i, symbol)));
        json_object_set_new(readings, sr_system_name((enum sr_system)i), q);
    }
    for (uint32_t k = 0; k < m->remark_count; ++k)
        json_array_append_new(remarks, command_json_text(m->remarks[k]));
    json_t *j = json_pack("{s:o, s:s, s:s, s:s, s:o, s:I, s:I, s:I, s:I, s:o, s:b, s:b, s:f, s:o}", "name",
                          command_json_text(sr_meter_common(meter)->name), "kind", meter->model->name, "quantity",
                          meter->model->what, "definition", meter->model->law, "readings", readings, "samples",
                          (json_int_t)m->samples, "pilot_samples", (json_int_t)m->pilot_samples, "samples_with_light",
                          (json_int_t)m->hits, "dropped_samples", (json_int_t)m->dropped, "largest_share",
                          command_json_number(m->largest_share), "complete", m->is_complete, "on_target",
                          m->is_on_target, "elapsed_s", m->elapsed_s, "remarks", remarks);
    if (j && measure_wants_colour(a, meter)) {
        json_t *colour = json_object();
        for (int i = 0; i < SR_COLOUR_COUNT; ++i)
            json_object_set_new(colour, sr_colour_names[i], command_json_measured(&m->colour[i]));
        json_object_set_new(json_object_get(colour, "CCT"), "unit", json_string("K"));
        json_object_set_new(j, "colour", colour);
    }
    if (j && s->count)
        json_object_set_new(j, "spectrum", spectrum_json(s, m));
    return j;
}
