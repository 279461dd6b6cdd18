/* SPDX-License-Identifier: MIT */
/* A world: a scene, the sensor that looks at it, and how it is to be rendered, as a pbrt-v4 file describes them.
 *
 * Load it once; from then on it never changes, and any number of threads may render it or measure in it at a time. */
#ifndef STERADIAN_WORLD_H
#define STERADIAN_WORLD_H

#include "base.h"
#include "picture.h"
#include "quantity.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct sr_world;

/* Reads a scene file; "-" is standard input. warn may be NULL; it is told one sentence at a time. On failure *world is
 * NULL and error (if not NULL, of size error_size) holds one sentence: file:line:column: what, and what was expected.
 */
SR_API sr_status sr_world_load(const char *path, void (*warn)(void *user, const char *text), void *user,
                               struct sr_world **world, char *error, size_t error_size);
SR_API void sr_world_destroy(struct sr_world *world); /* NULL is fine */

/* How to render. Zeroed members leave the scene's own settings: struct sr_render_settings s = {0}; is always valid,
 * and so is NULL in its place. */
struct sr_render_settings {
    uint32_t spp;        /* samples per pixel, in all, up to 2^30; 0: the scene's */
    uint32_t replicates; /* R >= 2 independently scrambled nets, for Student's intervals, R divides spp; 0: one net,
                          * conservative errors */
    bool has_seed;
    uint32_t seed;
    int threads;         /* 0: all processors */
    float lambda_min_nm; /* [nm] 0: 360 */
    float lambda_max_nm; /* [nm] 0: 830 */
    bool with_auxiliary; /* also albedo, normals, position, depth, texture coordinates, numbers */

    /* Called now and then from a working thread with the share of the work that is done; return false to stop. */
    bool (*progress)(void *user, double share); /* [1] */
    void *user;
};

/* Renders a new picture: R G B in cd/m^2 (without a unit where the film has a camera's sensor, an exposure, a white
 * balance or a limit), SE.R SE.G SE.B, samples. SR_CANCELLED: the picture holds what there is. */
SR_API sr_status sr_world_render(const struct sr_world *world, const struct sr_render_settings *settings,
                                 struct sr_picture **picture, char *error, size_t error_size);

/* ---- meters ----
 *
 * A scene file may hold meters, in comments (docs/guide/measure.md): they are numbered from 0 in the order of the file.
 */

SR_API size_t sr_world_meter_count(const struct sr_world *world);

/* What a meter is. The texts live as long as the world. */
struct sr_world_meter {
    const char *name;       /* of the file, or "meter 1" */
    const char *kind;       /* "cylindrical" */
    const char *quantity;   /* "cylindrical irradiance" */
    const char *definition; /* "1/pi INTEGRAL L sin(theta) dw …", in UTF-8 */
    uint32_t width, height; /* cells of a map; 0: no map */
};
/* false: there is no such meter. */
SR_API bool sr_world_meter(const struct sr_world *world, size_t index, struct sr_world_meter *meter);

/* How to measure; NULL, and zeroed members, are the defaults. */
struct sr_measure_options {
    uint64_t samples;      /* in all; 0: 65536, of a map 1024 a cell. With error or time_s: the most, 0: no limit */
    uint32_t replicates;   /* independently scrambled nets, for Student's interval; 0: 16 */
    double error;          /* [1] relative expanded uncertainty (95 %) to reach; 0: none */
    double time_s;         /* [s] that it may take, about; 0: as long as it takes */
    enum sr_system system; /* whose uncertainty counts, and which a map holds; 0 is radiometric */
    bool has_seed;
    uint32_t seed;
    int threads;         /* 0: all processors */
    float lambda_min_nm; /* [nm] 0: 360 */
    float lambda_max_nm; /* [nm] 0: 830 */
    /* Spectral readings at first, first + step, …, weighed by a triangle of that width at half its height (0: step). */
    double spectrum_first_nm, spectrum_step_nm, spectrum_fwhm_nm; /* [nm] */
    size_t spectrum_count;
    struct sr_quantity *spectrum; /* room for spectrum_count of them */
};

struct sr_world_reading {
    struct sr_quantity
        value[SR_SYSTEM_COUNT];           /* in every system; nothing found: 0, with `upper` where a bound is known */
    uint64_t samples, samples_with_light; /* that the reading rests on */
    double elapsed_s;                     /* [s] */
    bool is_on_target;                    /* true also where no error was asked for */
    char remarks[1024];                   /* sentences, one a line, about what cannot be trusted; or "" */
};

/* Measures one meter. */
SR_API sr_status sr_world_measure(const struct sr_world *world, size_t index, const struct sr_measure_options *options,
                                  struct sr_world_reading *reading, char *error, size_t error_size);
/* A map as a picture: Y in the options' system and SE.Y, its standard error. */
SR_API sr_status sr_world_measure_map(const struct sr_world *world, size_t index,
                                      const struct sr_measure_options *options, struct sr_picture **picture,
                                      char *error, size_t error_size);

/* Illuminance and irradiance on a surface element at point_m with that normal (any length but zero), by at least 2
 * replicates of samples each. Either may be NULL. */
SR_API sr_status sr_world_irradiance(const struct sr_world *world, const double point_m[3], const double normal[3],
                                     uint32_t samples, uint32_t replicates, struct sr_quantity *E_v /* [lx] */,
                                     struct sr_quantity *E_e /* [W/m^2] */);

#ifdef __cplusplus
}
#endif

#endif
