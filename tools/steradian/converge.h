/* SPDX-License-Identifier: MIT */
/* What the parts of steradian converge share: series of errors, and what they are of. */
#ifndef SR_TOOLS_CONVERGE_H
#define SR_TOOLS_CONVERGE_H

#include "command.h"

#include "import/import.h"
#include "plot/plot.h"
#include "render/render.h"
#include "study/study.h"

enum { CONVERGE_ESTIMATORS = 12, CONVERGE_SERIES = 24, CONVERGE_OUTPUTS = 4 };

struct converge_arguments {
    const char *scene, *integral, *meter, *strip, *max_depth, *outputs[CONVERGE_OUTPUTS];
    const char *estimators[CONVERGE_ESTIMATORS];
    int estimator_count, output_count;
    bool samplers[2]; // enum sr_sampler_kind
    uint64_t first, last, factor, seeds, seed, threads, strip_spp;
    double reference; // NaN: to be computed
    double resolution[2];
    bool quiet, json, has_spp;
    struct sr_import_options import;
};

/* One estimator with one sampler: root mean square errors over independent seeds. */
struct converge_series {
    char label[200];
    const char *estimator; // or strategy
    enum sr_sampler_kind sampler;
    uint32_t count;
    double n[SR_STUDY_POINTS];      // [1] samples: of the integral, the reading or a pixel
    double error[SR_STUDY_POINTS];  // [unit of the study]
    double time_s[SR_STUDY_POINTS]; // [s] of one result
    bool has_slope;
    struct sr_study_slope slope;
};

struct converge_study {
    const char *what, *unit; // of errors
    double reference, reference_u;
    struct converge_series series[CONVERGE_SERIES];
    uint32_t series_count;
};

/* converge_scene.c: fills the series; 0 or an exit code. */
int converge_scene(const struct converge_arguments *a, struct converge_study *study, struct sr_arena *arena);
int converge_strip(const struct converge_arguments *a, struct sr_arena *arena);

/* converge_output.c */
int converge_write(const struct converge_arguments *a, const struct converge_study *study);
void converge_print(const struct converge_arguments *a, const struct converge_study *study);
int converge_print_json(const struct converge_arguments *a, const struct converge_study *study);

#endif
