/* SPDX-License-Identifier: MIT */
/* What the parts of steradian measure share: the arguments, and a scene that is measured. */
#ifndef SR_TOOLS_MEASURE_H
#define SR_TOOLS_MEASURE_H

#include "command.h"

#include "import/import.h"
#include "render/render.h"

enum { MEASURE_MAX_METERS = 64 };
enum measure_input { MEASURE_METERS, MEASURE_RAYS, MEASURE_POINTS };

struct measure_arguments {
    const char *scene, *outfile;
    const char *meters[MEASURE_MAX_METERS]; // by name; none: all
    int meter_count;
    enum measure_input input;
    struct sr_import_options import;
    struct sr_measure_settings settings;
    bool systems[SR_SYSTEM_COUNT];       // those to print
    double lambda[2];                    // [nm]
    struct sr_spectrometer spectrometer; // asked for on the command line
    double spectrum[3], fwhm;            // [nm]
    enum sr_meter_bandpass bandpass;
    bool has_bandpass;
    bool has_spectrum, colour, has_seed, list, balance, budget, json, quiet;
    uint64_t seed, threads;
    const char *sampler;
};

/* "E_v,cyl" of a meter in a system. */
const char *measure_symbol(const struct sr_meter *meter, enum sr_system system, char text[64]);
/* What the meter's detector shows: of the file, or as the command line says. */
bool measure_wants_colour(const struct measure_arguments *a, const struct sr_meter *meter);
sr_status measure_spectrometer(const struct measure_arguments *a, const struct sr_meter *meter,
                               struct sr_spectrometer *s, struct sr_error *error);

/* measure_print.c */
void measure_print(const struct measure_arguments *a, const struct sr_meter *meter, const struct sr_spectrometer *s,
                   const struct sr_measurement *m, int width);
json_t *measure_json(const struct measure_arguments *a, const struct sr_meter *meter, const struct sr_spectrometer *s,
                     const struct sr_measurement *m);

/* measure_adjoint.c: what particles from the lights tell; an exit code, and the table of a meter of the far field to
 * a->outfile */
int measure_balance(const struct measure_arguments *a, const struct sr_render_job *job);
sr_status measure_write_intensity(const struct measure_arguments *a, const struct sr_render_job *job,
                                  const struct sr_meter *meter, struct sr_error *error);

/* measure_budget.c: what contributes to the uncertainty of each chosen meter; the exit code */
int measure_budget(const struct measure_arguments *a, const struct sr_import_result *scene, const bool *chosen);

/* measure.c */
struct sr_render_job measure_job(const struct measure_arguments *a, const struct sr_import_result *scene);

/* measure_stream.c: lines from standard input; the exit code */
int measure_stream(const struct measure_arguments *a, const struct sr_render_job *job);

#endif
