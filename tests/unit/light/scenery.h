/* SPDX-License-Identifier: MIT */
/* What the tests of lights share: filling a light by its table, parallelograms, sums over wavelengths. */
#ifndef TEST_LIGHT_SCENERY_H
#define TEST_LIGHT_SCENERY_H

#include "light/light.h"
#include "test.h"

static struct sr_arena scenery_arena __attribute__((unused));

/* A light's self with every parameter at its default, untransformed. Set parameters with scenery_set. */
static inline void *scenery_new(const struct sr_light_model *model)
{
    char *self = sr_arena_alloc(&scenery_arena, model->size);
    *(struct sr_transform *)(void *)(self + sr_light_transform_offset(model)) = sr_transform_identity();
    for (const struct sr_param *p = model->params; p->name; ++p) {
        float v = (float)p->initial;
        if (p->kind == SR_PARAM_FLOAT)
            memcpy(self + p->offset, &v, sizeof v);
        if (p->kind == SR_PARAM_POINT3)
            memcpy(self + p->offset, (float[]){v, v, v}, 3 * sizeof v);
    }
    return self;
}

static inline void scenery_set(const struct sr_light_model *model, void *self, const char *name, const void *value,
                               size_t size)
{
    for (const struct sr_param *p = model->params; p->name; ++p)
        if (strcmp(p->name, name) == 0) {
            memcpy((char *)self + p->offset, value, size);
            return;
        }
    test_fail(__FILE__, __LINE__, "no parameter %s", name);
}
#define SCENERY_FLOAT(model, self, name, value) scenery_set(model, self, name, &(float){value}, sizeof(float))
#define SCENERY_POINT(model, self, name, x, y, z) scenery_set(model, self, name, &(sr_vec3){x, y, z}, sizeof(sr_vec3))
#define SCENERY_SPD(model, self, name, spd)                                                                            \
    scenery_set(model, self, name, &(struct sr_spd[]){spd}, sizeof(struct sr_spd))

static inline struct sr_light scenery_finish(const struct sr_light_model *model, void *self)
{
    struct sr_error error = {0};
    if (model->prepare(self, &scenery_arena, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "prepare: %s", error.text);
    if (model->place)
        model->place(self, (sr_vec3){0, 0, 0}, 2);
    return (struct sr_light){model, self};
}

/* The 1 nm steps of the observer's range, eight at a time. */
#define SCENERY_GROUPS ((471 + SR_LAMBDA_COUNT - 1) / SR_LAMBDA_COUNT)
static inline struct sr_wavelengths scenery_wavelengths(int group)
{
    struct sr_wavelengths w = {.pdf = SR_ONE};
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
        w.lambda[k] = SR_LAMBDA_MIN + (float)(group * SR_LAMBDA_COUNT + k);
    return w;
}
static inline double scenery_luminous(sr_spectrum L, const struct sr_wavelengths *w)
{
    double sum = 0, xyz[3];
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
        if (w->lambda[k] <= SR_LAMBDA_MAX) {
            sr_observer_1931((double)w->lambda[k], xyz);
            sum += (double)L[k] * xyz[1];
        }
    return sum;
}
/* Luminous integral of what a light of one possible sample sends to x: illuminance across the direction of the light.
 */
static inline double scenery_illuminance(struct sr_light light, sr_vec3 p, struct sr_light_sample *s)
{
    struct sr_point x = {.p = p};
    double sum = 0;
    for (int g = 0; g < SCENERY_GROUPS; ++g) {
        struct sr_wavelengths w = scenery_wavelengths(g);
        if (!sr_light_draw(light, &x, (sr_vec2){0.5f, 0.5f}, &w, s))
            return 0;
        sum += scenery_luminous(s->L, &w);
    }
    return sum;
}
static inline double scenery_luminance(struct sr_light light, const struct sr_point *there, sr_vec3 direction)
{
    double sum = 0;
    for (int g = 0; g < SCENERY_GROUPS; ++g) {
        struct sr_wavelengths w = scenery_wavelengths(g);
        sum += scenery_luminous(light.model->Le(light.self, there, direction, &w), &w);
    }
    return sum;
}

/* ---- parallelograms: a shape of many primitives, drawn by area ---- */

struct scenery_quad {
    sr_vec3 corner, ex, ey;
};

static inline struct sr_box scenery_quad_bounds(const void *self, uint32_t i)
{
    const struct scenery_quad *q = (const struct scenery_quad *)self + i;
    struct sr_box b = {q->corner, q->corner};
    b = sr_box_add(b, sr_add(q->corner, q->ex));
    b = sr_box_add(b, sr_add(q->corner, q->ey));
    return sr_box_add(b, sr_add(sr_add(q->corner, q->ex), q->ey));
}
static inline float scenery_quad_area(const void *self, uint32_t i)
{
    const struct scenery_quad *q = (const struct scenery_quad *)self + i;
    return sr_length(sr_cross(q->ex, q->ey));
}
static inline sr_vec3 scenery_quad_normal(const struct scenery_quad *q)
{
    return sr_normalize(sr_cross(q->ex, q->ey));
}
static inline bool scenery_quad_sample(const void *self, uint32_t i, const struct sr_point *x, sr_vec2 u,
                                       struct sr_shape_sample *s)
{
    const struct scenery_quad *q = (const struct scenery_quad *)self + i;
    *s = (struct sr_shape_sample){.p = sr_add(sr_add(q->corner, sr_scale(u.x, q->ex)), sr_scale(u.y, q->ey)),
                                  .n = scenery_quad_normal(q),
                                  .uv = u,
                                  .pdf = 1 / scenery_quad_area(self, i)};
    if (!x)
        return true;
    sr_vec3 d = sr_sub(s->p, x->p);
    float r2 = sr_length2(d), cosine = fabsf(sr_dot(s->n, sr_normalize(d)));
    s->pdf *= r2 / cosine;
    return cosine > 0;
}
static inline float scenery_quad_pdf(const void *self, uint32_t i, const struct sr_point *x, sr_vec3 wi,
                                     const struct sr_point *there)
{
    return sr_length2(sr_sub(there->p, x->p)) / (fabsf(sr_dot(there->n, wi)) * scenery_quad_area(self, i));
}
static inline void scenery_quad_normals(const void *self, uint32_t i, sr_vec3 *axis, float *cos_theta)
{
    *axis = scenery_quad_normal((const struct scenery_quad *)self + i);
    *cos_theta = 1;
}
static const struct sr_shape_model scenery_quads __attribute__((unused)) = {
    .name = "test quads",
    .bounds = scenery_quad_bounds,
    .area = scenery_quad_area,
    .sample = scenery_quad_sample,
    .pdf = scenery_quad_pdf,
    .normals = scenery_quad_normals,
};

static inline struct sr_light_emission scenery_emission(void)
{
    return (struct sr_light_emission){.L = sr_spd_constant(3), .scale = 1, .power = NAN};
}
static inline struct sr_light scenery_quad_light(const struct scenery_quad *quads, uint32_t i,
                                                 const struct sr_light_emission *e)
{
    struct sr_light_area *a = sr_arena_alloc(&scenery_arena, sizeof *a);
    *a = (struct sr_light_area){
        .shape = {&scenery_quads, quads}, .primitive = i, .emission = e, .area = scenery_quad_area(quads, i)};
    return (struct sr_light){&sr_light_area, a};
}

/* sums |cos| L / pdf over draws: the irradiance of a surface with normal n, per wavelength */
static inline sr_vec3 scenery_unit(struct sr_rng *rng)
{
    return sr_warp_uniform_sphere((sr_vec2){sr_rng_float(rng), sr_rng_float(rng)});
}

#endif
