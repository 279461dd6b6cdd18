/* SPDX-License-Identifier: MIT */
/* Shapes made in one line, random numbers, and what every sampler must satisfy. */
#ifndef SHAPE_TEST_COMMON_H
#define SHAPE_TEST_COMMON_H

#include "shape/shape.h"
#include "test.h"

static inline float uniform(struct sr_rng *rng)
{
    return sr_rng_float(rng);
}
static inline sr_vec3 random_direction(struct sr_rng *rng)
{
    float z = 2 * uniform(rng) - 1, phi = 2 * SR_PI * uniform(rng), r = sr_safe_sqrt(1 - z * z);
    return (sr_vec3){r * cosf(phi), r * sinf(phi), z};
}
static inline struct sr_shape_placement placed(struct sr_transform t)
{
    return (struct sr_shape_placement){t, false};
}
static inline struct sr_shape_placement here(void)
{
    return placed(sr_transform_identity());
}
static inline struct sr_transform then(struct sr_transform a, struct sr_transform b) // first b, then a
{
    return sr_transform_multiply(&a, &b);
}
#define SLICE(array) ((struct sr_slice){array, sizeof(array) / sizeof(array[0])})

/* Prepares, or fails the test. The arena lives as long as the program. */
extern struct sr_arena test_arena;
#define PREPARE(shape, self, placement) prepare_or_fail(&(shape), self, placement)
static inline struct sr_shape prepare_or_fail(const struct sr_shape_model *model, void *self,
                                              struct sr_shape_placement placement)
{
    struct sr_error error = {0};
    if (model->prepare(self, &placement, &test_arena, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return (struct sr_shape){model, self};
}

struct sr_shape make_sphere(float radius, struct sr_shape_placement placement);
struct sr_shape make_partial_sphere(float radius, float z_min, float z_max, float phi_max,
                                    struct sr_shape_placement placement);
struct sr_shape make_disk(float height, float radius, float inner_radius, float phi_max,
                          struct sr_shape_placement placement);
struct sr_shape make_cylinder(float radius, float z_min, float z_max, float phi_max,
                              struct sr_shape_placement placement);
struct sr_shape make_triangle(sr_vec3 a, sr_vec3 b, sr_vec3 c, struct sr_shape_placement placement);
struct sr_shape make_patch(sr_vec3 p00, sr_vec3 p10, sr_vec3 p01, sr_vec3 p11, struct sr_shape_placement placement);

/* The triangle's nearest meeting by Cramer's rule in double; for others, the model's own. */
bool cast(struct sr_shape s, sr_vec3 o, sr_vec3 d, float *t, sr_vec2 *hit);
struct sr_point receiver(sr_vec3 p, sr_vec3 n); // n zero: a point in a volume

/* SUM over primitives of the irradiance [W/m^2] that radiance 1 from both sides sends to the reference, each primitive
 * drawn n times: mean of cos / pdf. */
struct sr_tally irradiance(struct sr_shape s, uint32_t primitive, const struct sr_point *x, int n, uint64_t seed);
/* mean of 1 / pdf: the solid angle (of nonconvex shapes counted with the number of meetings) */
struct sr_tally solid_angle(struct sr_shape s, uint32_t primitive, const struct sr_point *x, int n, uint64_t seed);
/* pdf() of what sample() drew is what sample() said: greatest relative deviation over n draws */
double pdf_deviation(struct sr_shape s, uint32_t primitive, const struct sr_point *x, int n, uint64_t seed);

#endif
