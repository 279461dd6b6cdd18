/* SPDX-License-Identifier: MIT */
/* steradian measure --points, --rays: a line in, a reading out, while both go on. */
#include "measure_command.h"
#include "render_command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STREAM_SAMPLES = 4096, LONGEST_LINE = 1024 };

/* Six numbers and nothing else; true also of lines without any, which *is_empty tells. */
static bool read_line(const char *line, double v[6], bool *is_empty)
{
    const char *p = line + strspn(line, " \t\r\n");
    *is_empty = *p == 0 || *p == '#';
    for (int i = 0; i < 6 && !*is_empty; ++i) {
        char *end;
        v[i] = strtod(p, &end);
        if (end == p || !isfinite(v[i]))
            return false;
        p = end + strspn(end, " \t\r\n,");
    }
    return *is_empty || *p == 0 || *p == '#';
}

static void print_line(const struct measure_arguments *a, const struct sr_measurement *m, uint64_t number,
                       const double v[6])
{
    if (a->json) {
        json_t *readings = json_object();
        for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
            if (a->systems[i])
                json_object_set_new(readings, sr_system_name((enum sr_system)i), command_json_measured(&m->value[i]));
        json_t *j = json_pack("{s:I, s:[f,f,f], s:[f,f,f], s:o, s:o}", "line", (json_int_t)number, "p_m", v[0], v[1],
                              v[2], a->input == MEASURE_RAYS ? "direction" : "normal", v[3], v[4], v[5], "readings",
                              readings, "remark", m->remark_count ? command_json_text(m->remarks[0]) : json_null());
        json_dumpf(j, stdout, JSON_COMPACT | JSON_REAL_PRECISION(9));
        json_decref(j);
    } else {
        const char *space = "";
        for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
            if (a->systems[i]) {
                printf("%s%.9g %.3g", space, m->value[i].value, sr_quantity_expanded(&m->value[i], 0.95));
                space = " ";
            }
    }
    putchar('\n');
    fflush(stdout);
}

static int bad_line(uint64_t number, const struct measure_arguments *a, const char *why)
{
    struct sr_error error = {0};
    sr_fail(&error, SR_ERROR_INPUT, "standard input:%llu: %s: expected six numbers, %s", (unsigned long long)number,
            why, a->input == MEASURE_RAYS ? "x y z dx dy dz" : "x y z nx ny nz");
    return command_fail("measure", &error);
}

int measure_stream(const struct measure_arguments *a, const struct sr_render_job *job)
{
    char line[LONGEST_LINE];
    struct sr_measure_settings s = a->settings;
    bool is_on_target = true;
    s.samples = s.samples || s.error > 0 || s.time_s > 0 ? s.samples : STREAM_SAMPLES;
    for (uint64_t number = 1; !atomic_load(&render_interrupted) && fgets(line, sizeof line, stdin); ++number) {
        double v[6];
        bool is_empty;
        if (strlen(line) + 1 == sizeof line)
            return bad_line(number, a, "this line is too long");
        if (!read_line(line, v, &is_empty))
            return bad_line(number, a, "this line cannot be read");
        if (is_empty)
            continue;
        sr_vec3 p = sr_render_place(job, v), d = {(float)v[3], (float)v[4], (float)v[5]};
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        struct sr_meter meter =
            a->input == MEASURE_RAYS ? sr_meter_radiance_along(&arena, p, d, 0) : sr_meter_irradiance_at(&arena, p, d);
        struct sr_measurement m;
        s.stream = (uint32_t)number;
        if (!meter.model) {
            sr_arena_free(&arena);
            return bad_line(number, a, "the last three numbers are no direction");
        }
        sr_status status = sr_measure(job, &meter, &s, &arena, &m, &error);
        sr_arena_free(&arena);
        if (status != SR_OK && status != SR_CANCELLED)
            return command_fail("measure", &error);
        if (m.samples == 0)
            break;
        is_on_target = is_on_target && m.is_on_target;
        print_line(a, &m, number, v);
        for (uint32_t i = 0; i < m.remark_count && !a->quiet && !a->json; ++i)
            fprintf(stderr, "warning: standard input:%llu: %s\n", (unsigned long long)number, m.remarks[i]);
    }
    if (atomic_load(&render_interrupted)) {
        fprintf(stderr, "steradian measure: interrupted; what there was has been printed\n");
        return render_interrupt_exit();
    }
    return is_on_target ? 0 : 1;
}
