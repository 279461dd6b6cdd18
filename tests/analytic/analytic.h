/* SPDX-License-Identifier: MIT */
/* Closed forms against the finished program: scene text, import, lights, geometry, estimators, film, all in the loop.
 *
 * A row is a case whose answer is known. Monte Carlo: |z| < 4.9 and a relative standard error of at most 1.25e-4 (finds
 * a bias of 0.1 % with a power of 99.9 %), or within 1e-5, the resolution of float. STERADIAN_TEST_EFFORT=n takes n
 * times the samples: rows that state a wider goal come down to 1.25e-4 with it. STERADIAN_TEST_ROWS=D1 measures only
 * the rows whose ids begin so. */
#ifndef SR_TESTS_ANALYTIC_ANALYTIC_H
#define SR_TESTS_ANALYTIC_ANALYTIC_H

#include "test.h"

#include "import/import.h"
#include "render/render.h"

#define GOAL 1.25e-4    // relative standard error
#define FLOAT_GOAL 1e-5 // relative error of what is computed in float without chance
enum { REPLICATES = 32 };

struct estimate {
    double mean, error, degrees;
};

struct row {
    const char *id, *what;
    double value;
    void (*measure)(const struct row *row);
    double a, b; // what the measurement wants to know of the case: an angle, a reflectance
};

extern const struct row source_rows[], exchange_rows[], enclosure_rows[], fresnel_rows[], photometry_rows[],
    camera_rows[], media_rows[]; // end with id NULL

/* Measures all rows, prints them, fails if one does. */
void run_rows(const char *title, const struct row *rows);
/* One verdict; goal is the relative standard error that must be reached. */
void check(const struct row *row, const char *how, struct estimate e, double goal);
uint32_t samples(double n); // the number wanted, by effort and sanitizer
double effort(void);
double z_of(struct estimate e, double value); // of Student's t, as a normal deviate of the same probability

/* A scene from text; fails the test where it does not import. */
struct world {
    struct sr_import_result scene;
    struct sr_render_job job;
};
struct world world_of(const char *format, ...) __attribute__((format(printf, 1, 2)));
void world_free(struct world *w);
/* Text of the surroundings of a point receiver: a camera that sees it obliquely from 1 cm, and a grey patch of 2 mm. */
const char *receiver_text(const double p[3], const double n[3]);
#define RECEIVER_RHO 0.5
#define BLACK "Material \"diffuse\" \"spectrum reflectance\" [360 0 830 0]\n"
#define GREY "Material \"diffuse\" \"spectrum reflectance\" [360 0.5 830 0.5]\n"
#define GLOW "AreaLightSource \"diffuse\" \"float scale\" 1\n"
#define GLOW_BOTH "AreaLightSource \"diffuse\" \"float scale\" 1 \"bool twosided\" true\n"

/* Mean luminance of rays that a function draws, each by replicates of a scrambled net. scale multiplies. */
struct drawn {
    sr_vec3 o, d;
    double weight; // of the luminance
};
typedef struct drawn draw_ray(const void *context, sr_vec2 u, sr_vec2 v);
struct estimate mean_luminance(const struct sr_render_job *job, draw_ray *draw, const void *context, double n_samples);
/* A pixel's luminance, or another linear form of its XYZ (y: {0, 1, 0}), from the samples that a render takes. */
struct estimate pixel_mean(const struct sr_render_job *job, uint32_t x, uint32_t y, double n_samples,
                           const double xyz[3]);
struct estimate scaled(struct estimate e, double factor);

/* Irradiance of a point by four estimators: rays over the hemisphere (meter), light and surface weighed together
 * (path), light alone (simplepath), surface alone (simplepath without light sampling). n: samples a replicate; 0: not
 * by this. */
struct effort {
    double meter, path, lights, surface;
};
void check_irradiance(const struct row *row, const double p[3], const double n[3], const char *content,
                      struct effort n_samples, double value_over_irradiance);

#endif
