/* SPDX-License-Identifier: MIT */
/* steradian measure: the power balance of a scene, and the table of a goniophotometer. */
#include "measure_command.h"
#include "render_command.h"

#include "measured/measured.h"

#include <stdio.h>
#include <string.h>

/* ---- balance ---- */

static void print_quantity(const char *name, const char *symbol, const struct sr_quantity *q)
{
    char text[256], unit[32];
    sr_unit_text(q->unit, unit, sizeof unit);
    if (q->value == 0 && q->u == 0)
        printf("%-16s %s = 0 %s\n", name, symbol, unit);
    else
        printf("%-16s %s\n", name, sr_quantity_text(symbol, q, text, sizeof text));
}

static void print_line(const struct measure_arguments *a, const char *name, const struct sr_quantity q[2])
{
    bool is_photopic = a->systems[SR_PHOTOPIC] || !a->systems[SR_RADIOMETRIC];
    if (is_photopic)
        print_quantity(name, sr_kind_symbol(SR_KIND_FLUX, SR_PHOTOPIC), &q[0]);
    if (a->systems[SR_RADIOMETRIC])
        print_quantity(name, sr_kind_symbol(SR_KIND_FLUX, SR_RADIOMETRIC), &q[1]);
}

static json_t *both(const struct sr_quantity q[2])
{
    return json_pack("{s:o, s:o}", "photopic", command_json_measured(&q[0]), "radiometric",
                     command_json_measured(&q[1]));
}

static json_t *all_of(const struct sr_quantity (*q)[2], uint32_t count)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; ++i) {
        json_t *j = both(q[i]);
        json_object_set_new(j, "number", json_integer(i + 1));
        json_array_append_new(list, j);
    }
    return list;
}

int measure_balance(const struct measure_arguments *a, const struct sr_render_job *job)
{
    struct sr_arena arena = {0};
    struct sr_balance b;
    struct sr_error error = {0};
    sr_status status = sr_measure_balance(job, &a->settings, &arena, &b, &error);
    if (status != SR_OK) {
        sr_arena_free(&arena);
        return status == SR_CANCELLED ? render_interrupt_exit() : command_fail("measure", &error);
    }
    int code = 0;
    if (a->json) {
        json_t *j = json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:I}", "emitted", both(b.emitted),
                              "absorbed", both(b.absorbed), "escaped", both(b.escaped), "given_up", both(b.given_up),
                              "absorbed_in_media", both(b.in_media), "closure", both(b.closure), "absorbed_by_material",
                              all_of((const struct sr_quantity(*)[2])b.by_material, b.materials), "absorbed_by_object",
                              all_of((const struct sr_quantity(*)[2])b.by_object, b.objects), "samples",
                              (json_int_t)b.samples, "dropped_samples", (json_int_t)b.dropped);
        code = command_print_json("measure", json_pack("{s:s, s:o, s:o}", "version", SR_VERSION, "scene",
                                                       command_json_text(a->scene), "balance", j));
    } else {
        print_line(a, "emitted", b.emitted);
        print_line(a, "absorbed", b.absorbed);
        if (sr_scene_has_media(job->scene))
            print_line(a, "  in media", b.in_media);
        char name[32];
        for (uint32_t i = 0; i < b.materials && b.materials > 1; ++i) {
            snprintf(name, sizeof name, "  material %u", i + 1);
            print_line(a, name, b.by_material[i]);
        }
        for (uint32_t i = 0; i < b.objects && b.objects > 1 && b.objects <= 32; ++i) {
            snprintf(name, sizeof name, "  shape %u", i + 1);
            print_line(a, name, b.by_object[i]);
        }
        print_line(a, "escaped", b.escaped);
        if (b.given_up[0].value != 0)
            print_line(a, "given up", b.given_up);
        print_line(a, "closure", b.closure);
        if (b.objects > 32 && !a->quiet)
            fprintf(stderr, "note: the shares of %u shapes are in --json\n", b.objects);
    }
    sr_arena_free(&arena);
    return code;
}

/* ---- goniophotometer ---- */

static sr_status write_table(const char *path, const char *scene, const struct sr_intensity_table *t,
                             struct sr_error *error)
{
    if (sr_path_has_ending(path, ".ies") || sr_path_has_ending(path, ".ldt")) {
        char test[100];
        snprintf(test, sizeof test, "computed, %llu paths", (unsigned long long)t->samples);
        const struct sr_photometry_word words[] = {
            {"TEST", test}, {"TESTLAB", "steradian " SR_VERSION}, {"LUMINAIRE", scene}};
        struct sr_photometry p = {.symmetry = t->c_count == 1 ? SR_PHOTOMETRY_AXIAL : SR_PHOTOMETRY_ALL_PLANES,
                                  .words = words,
                                  .word_count = 3,
                                  .c_count = t->c_count,
                                  .gamma_count = t->gamma_count,
                                  .c = t->c,
                                  .gamma = t->gamma,
                                  .candela = t->I,
                                  .lamp_count = 1,
                                  .lamp_flux = NAN,
                                  .note = ""};
        return sr_photometry_write(path, &p, error);
    }
    struct sr_array text = {0};
    char line[128], unit[32];
    sr_unit_text(t->unit, unit, sizeof unit);
    int n = snprintf(line, sizeof line, "C [deg],gamma [deg],I [%s],u [%s]\n", unit, unit);
    bool is_whole = true;
    for (uint32_t k = 0;; ++k) {
        for (int i = 0; i < n && is_whole; ++i) {
            char *c = sr_array_push(&text, 1);
            if (c)
                *c = line[i];
            is_whole = c != NULL;
        }
        if (k == t->c_count * t->gamma_count)
            break;
        uint32_t plane = k / t->gamma_count, row = k % t->gamma_count;
        n = snprintf(line, sizeof line, "%g,%g,%.7g,%.3g\n", (double)t->c[plane], (double)t->gamma[row],
                     (double)t->I[k], (double)t->u[k]);
    }
    sr_status status = is_whole ? sr_file_write(path, text.data, text.count, error)
                                : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %s", path);
    sr_array_free(&text);
    return status;
}

sr_status measure_write_intensity(const struct measure_arguments *a, const struct sr_render_job *job,
                                  const struct sr_meter *meter, struct sr_error *error)
{
    struct sr_arena arena = {0};
    struct sr_intensity_table t;
    struct sr_measure_settings s = a->settings;
    if (!sr_path_has_ending(a->outfile, ".ies") && !sr_path_has_ending(a->outfile, ".ldt") &&
        !sr_path_has_ending(a->outfile, ".csv"))
        return sr_fail(error, SR_ERROR_USAGE,
                       "%s: the ending .ies, .ldt or .csv was expected for an intensity distribution", a->outfile);
    sr_status status = sr_measure_intensity(job, meter, &s, &arena, &t, error);
    if (status == SR_OK && write_table(a->outfile, a->scene, &t, error) == SR_OK && !a->quiet)
        fprintf(stderr, "note: %u planes of %u angles of \"%s\" written to %s\n", t.c_count, t.gamma_count,
                sr_meter_common(meter)->name, a->outfile);
    sr_arena_free(&arena);
    return error->status ? error->status : status;
}
