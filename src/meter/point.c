/* SPDX-License-Identifier: MIT */
/* Meters at a point: a surface element and the small bodies of lighting practice.
 *
 *     irradiance       E     = INTEGRAL L cos(theta) dw               over the hemisphere of the normal
 *     cylindrical      E_cyl = 1/pi INTEGRAL L sin(theta) dw        theta from the cylinder's axis, over all directions
 *     semicylindrical  E_sc  = 1/pi INTEGRAL L sin(theta) (1 + cos(phi)) dw    phi from where the half cylinder faces
 *     hemispherical    E_hs  = 1/4 INTEGRAL L (1 + cos(theta)) dw     theta from the normal of its base
 *     spherical        E_sph = 1/4 INTEGRAL L dw                      mean over the whole surface of a small sphere
 *     fluence rate     E_o   = INTEGRAL L dw                          the same by the area of its great circle
 *
 * The first five are flux on the body by the area of its curved surface, so that a uniform field of radiance L reads pi
 * L; E_o reads 4 pi L. CIE S 017:2020 calls both spherical irradiance: the words of 17-21-066 are a mean over the
 * sphere, its note 2 divides by the great circle. EN 12665:2018, EN 13201-3:2015 (there as sums over luminaires). [lx],
 * [W m^-2] */
#include "meter/private.h"

struct point_meter {
    struct sr_meter_common common;
    sr_vec3 p;               // [m]
    sr_vec3 n, axis, facing; // [1]
    struct sr_frame frame;
    bool is_free;
};

#define MEMBER(m) offsetof(struct point_meter, m)
#define ROW_P                                                                                                          \
    {                                                                                                                  \
        SR_PARAM_POINT3, "p", "m", 0, 0, 0, MEMBER(p), "where it stands"                                               \
    }
static const struct sr_param normal_params[] = {
    ROW_P,
    {SR_PARAM_NORMAL3, "n", "1", 0, 0, NAN, MEMBER(n), "normal; none: +z"},
    {.name = NULL},
};
static const struct sr_param axis_params[] = {
    ROW_P,
    {SR_PARAM_VECTOR3, "axis", "1", 0, 0, NAN, MEMBER(axis), "the cylinder's axis; none: +z"},
    {.name = NULL},
};
static const struct sr_param facing_params[] = {
    ROW_P,
    {SR_PARAM_VECTOR3, "axis", "1", 0, 0, NAN, MEMBER(axis), "the cylinder's axis; none: +z"},
    {SR_PARAM_VECTOR3, "facing", "1", 0, 0, NAN, MEMBER(facing),
     "where the curved half looks, square to the axis; none: +x"},
    {.name = NULL},
};
static const struct sr_param point_params[] = {ROW_P, {.name = NULL}};

static sr_status prepare_at(struct point_meter *m, const struct sr_transform *t, sr_vec3 z, const char *name,
                            struct sr_error *error)
{
    m->p = sr_transform_point(t, m->p);
    if (!sr_is_finite(m->p))
        return sr_fail(error, SR_ERROR_INPUT, "\"p\" is no point: expected three finite numbers");
    sr_status status = meter_direction(name, &z, error);
    m->frame = sr_frame_from_z(z);
    return status;
}

static sr_status prepare_normal(void *self, const struct sr_transform *t, struct sr_arena *arena,
                                struct sr_error *error)
{
    (void)arena;
    struct point_meter *m = self;
    return prepare_at(m, t, sr_transform_normal(t, meter_or_z(m->n)), "n", error);
}

static sr_status prepare_hemisphere(void *self, const struct sr_transform *t, struct sr_arena *arena,
                                    struct sr_error *error)
{
    ((struct point_meter *)self)->is_free = true;
    return prepare_normal(self, t, arena, error);
}

static sr_status prepare_axis(void *self, const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct point_meter *m = self;
    m->is_free = true;
    return prepare_at(m, t, sr_transform_vector(t, meter_or_z(m->axis)), "axis", error);
}

static sr_status prepare_facing(void *self, const struct sr_transform *t, struct sr_arena *arena,
                                struct sr_error *error)
{
    struct point_meter *m = self;
    sr_status status = prepare_axis(self, t, arena, error);
    sr_vec3 facing = sr_transform_vector(t, isnan(m->facing.x) ? (sr_vec3){1, 0, 0} : m->facing);
    if (status == SR_OK)
        status = meter_direction("facing", &facing, error);
    if (status == SR_OK && sr_length(sr_cross(facing, m->frame.z)) < 1e-3f)
        return sr_fail(error, SR_ERROR_INPUT, "\"facing\" is along the axis: expected a direction square to it");
    m->frame = sr_frame_from_zx(m->frame.z, facing);
    return status;
}

static sr_status prepare_free(void *self, const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    ((struct point_meter *)self)->is_free = true;
    return prepare_at(self, t, (sr_vec3){0, 0, 1}, "p", error);
}

static bool place(const void *self, sr_vec2 u, struct sr_meter_place *out)
{
    (void)u;
    const struct point_meter *m = self;
    *out = (struct sr_meter_place){.x = {.p = m->p}, .frame = m->frame, .weight = 1};
    if (!m->is_free) {
        out->x.n = out->x.ns = m->frame.z;
        out->x.p_error = meter_p_error(m->p);
    }
    return true;
}

static double extent_pi(const void *self)
{
    (void)self;
    return (double)SR_PI;
}

static float sin_theta(sr_vec3 w)
{
    return sqrtf(w.x * w.x + w.y * w.y);
}

/* ---- surface element ---- */

static float irradiance_response(const void *self, sr_vec3 wi)
{
    (void)self;
    return sr_max(wi.z, 0);
}
static float irradiance_pdf(const void *self, sr_vec3 wi)
{
    (void)self;
    return sr_warp_cosine_hemisphere_pdf(wi.z);
}
static float irradiance_sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    *wi = sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]});
    return irradiance_pdf(self, *wi);
}

/* ---- cylinder ---- */

/* cos(theta) with density proportional to sin^2(theta): that of a uniform disk's points along one of its diameters. *v:
 * what is left, uniform and independent of it. */
static float semicircle(sr_vec2 u, float *v)
{
    sr_vec2 d = sr_warp_disk(u);
    float half = sr_safe_sqrt(1 - d.x * d.x);
    *v = half > 0 ? sr_clamp(0.5f + 0.5f * d.y / half, 0, 1) : 0.5f;
    return d.x;
}

static float cylindrical_response(const void *self, sr_vec3 wi)
{
    (void)self;
    return SR_INV_PI * sin_theta(wi);
}
static float cylindrical_pdf(const void *self, sr_vec3 wi)
{
    (void)self;
    return SR_INV_PI * SR_INV_PI * sin_theta(wi);
}
static float cylindrical_sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    float v, z = semicircle((sr_vec2){u[0], u[1]}, &v);
    *wi = sr_spherical_direction(sr_safe_sqrt(1 - z * z), z, 2 * SR_PI * v);
    return cylindrical_pdf(self, *wi);
}

/* ---- half a cylinder ---- */

static float semicylindrical_response(const void *self, sr_vec3 wi)
{
    (void)self;
    return SR_INV_PI * (sin_theta(wi) + wi.x); // sin(theta) cos(phi) is x
}
static float semicylindrical_pdf(const void *self, sr_vec3 wi)
{
    (void)self;
    return SR_INV_PI * SR_INV_PI * (sin_theta(wi) + wi.x);
}
static float semicylindrical_sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    // 1 + cos(phi) = 2 cos^2(phi/2): sin(phi/2) is again spread as a disk along its diameter
    float v, z = semicircle((sr_vec2){u[0], u[1]}, &v), s = semicircle((sr_vec2){u[2], u[3]}, &v);
    *wi = sr_spherical_direction(sr_safe_sqrt(1 - z * z), z, 2 * asinf(sr_clamp(s, -1, 1)));
    return semicylindrical_pdf(self, *wi);
}

/* ---- half a sphere ---- */

static float hemispherical_response(const void *self, sr_vec3 wi)
{
    (void)self;
    return 0.25f * (1 + wi.z);
}
static float hemispherical_pdf(const void *self, sr_vec3 wi)
{
    (void)self;
    return SR_INV_PI * 0.25f * (1 + wi.z);
}
static float hemispherical_sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    float z = 2 * sqrtf(u[0]) - 1;
    *wi = sr_spherical_direction(sr_safe_sqrt(1 - z * z), z, 2 * SR_PI * u[1]);
    return hemispherical_pdf(self, *wi);
}

/* ---- sphere ---- */

static float spherical_response(const void *self, sr_vec3 wi)
{
    (void)self;
    (void)wi;
    return 0.25f;
}
static float fluence_response(const void *self, sr_vec3 wi)
{
    (void)self;
    (void)wi;
    return 1;
}
static float sphere_pdf(const void *self, sr_vec3 wi)
{
    (void)self;
    (void)wi;
    return 0.25f * SR_INV_PI;
}
static float sphere_sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    *wi = sr_warp_uniform_sphere((sr_vec2){u[0], u[1]});
    return sphere_pdf(self, *wi);
}
static double extent_4pi(const void *self)
{
    (void)self;
    return 4 * (double)SR_PI;
}

#define POINT(name_, what_, law_, suffix_, params_, prepare_, kind_response, kind_sample, kind_pdf, extent_)           \
    {                                                                                                                  \
        .name = name_, .what = what_, .law = law_, .suffix = suffix_, .kind = SR_KIND_FLUX_DENSITY, .params = params_, \
        .size = sizeof(struct point_meter), .prepare = prepare_, .place = place, .response = kind_response,            \
        .sample = kind_sample, .pdf = kind_pdf, .extent = extent_                                                      \
    }

const struct sr_meter_model meter_irradiance =
    POINT("irradiance", "irradiance", "∫ L cos θ dω over the hemisphere of the normal", "", normal_params,
          prepare_normal, irradiance_response, irradiance_sample, irradiance_pdf, extent_pi);
const struct sr_meter_model meter_cylindrical =
    POINT("cylindrical", "cylindrical irradiance", "1/π ∫ L sin θ dω, θ from the axis", "cyl", axis_params,
          prepare_axis, cylindrical_response, cylindrical_sample, cylindrical_pdf, extent_pi);
const struct sr_meter_model meter_semicylindrical =
    POINT("semicylindrical", "semicylindrical irradiance",
          "1/π ∫ L sin θ (1 + cos φ) dω, θ from the axis, φ from where it faces", "sc", facing_params, prepare_facing,
          semicylindrical_response, semicylindrical_sample, semicylindrical_pdf, extent_pi);
const struct sr_meter_model meter_hemispherical =
    POINT("hemispherical", "hemispherical irradiance", "1/4 ∫ L (1 + cos θ) dω, θ from the normal", "hs", normal_params,
          prepare_hemisphere, hemispherical_response, hemispherical_sample, hemispherical_pdf, extent_pi);
const struct sr_meter_model meter_spherical =
    POINT("spherical", "mean spherical irradiance", "1/4 ∫ L dω: mean over a small sphere's surface", "sph",
          point_params, prepare_free, spherical_response, sphere_sample, sphere_pdf, extent_pi);
const struct sr_meter_model meter_fluence =
    POINT("fluence", "fluence rate (spherical irradiance by the area of the great circle)", "∫ L dω", "o", point_params,
          prepare_free, fluence_response, sphere_sample, sphere_pdf, extent_4pi);

struct sr_meter sr_meter_irradiance_at(struct sr_arena *arena, sr_vec3 p, sr_vec3 n)
{
    struct point_meter *m = sr_arena_alloc(arena, sizeof *m);
    struct sr_transform one = sr_transform_identity();
    struct sr_error error = {0};
    if (!m)
        return (struct sr_meter){NULL, NULL};
    m->p = p;
    m->n = n;
    m->common.fwhm = NAN;
    return prepare_normal(m, &one, arena, &error) == SR_OK ? (struct sr_meter){&meter_irradiance, m}
                                                           : (struct sr_meter){NULL, NULL};
}
