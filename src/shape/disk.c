/* SPDX-License-Identifier: MIT */
/* A disk at a height, or the part of it outside an inner radius and within an angle around z:
 *
 *     p = (rho cos phi, rho sin phi, h) [m]   u = phi / phi_max   v = (r - rho) / (r - r_inner) [1]   n = +z
 *
 * Drawn uniformly by area: concentric squares (P. Shirley, K. Chiu 1997) for a whole disk, else rho^2 uniform. An
 * affine transform leaves it uniform. */
#include "shape/quadric.h"

#define D struct sr_shape_disk
static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "height", "m", -INFINITY, INFINITY, 0, offsetof(D, height), "place along z"},
    {SR_PARAM_FLOAT, "radius", "m", 0, INFINITY, 1, offsetof(D, radius), "outer radius"},
    {SR_PARAM_FLOAT, "innerradius", "m", 0, INFINITY, 0, offsetof(D, inner_radius), "radius of the hole"},
    {SR_PARAM_FLOAT, "phimax", "deg", 0, 360, 360, offsetof(D, phi_max), "angle around z that is swept"},
    {0},
};
#undef D

static sr_status prepare(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error)
{
    (void)arena;
    struct sr_shape_disk *d = self;
    if (!(d->radius > 0) || !isfinite(d->radius) || !isfinite(d->height))
        return sr_fail(error, SR_ERROR_INPUT, "disk: \"radius\" is %g, expected a positive number", (double)d->radius);
    if (!(d->inner_radius >= 0 && d->inner_radius < d->radius))
        return sr_fail(error, SR_ERROR_INPUT, "disk: \"innerradius\" is %g, expected 0 to less than \"radius\" %g",
                       (double)d->inner_radius, (double)d->radius);
    d->object_to_world = placement->object_to_world;
    sr_status status = sr_quadric_angle("disk", d->phi_max, &d->phi_max_rad, error);
    return status != SR_OK ? status : sr_quadric_place(&d->quadric, "disk", placement, &d->flip_normals, error);
}

static uint32_t primitive_count(const void *self)
{
    (void)self;
    return 1;
}

static struct sr_box bounds(const void *self, uint32_t primitive)
{
    (void)primitive;
    const struct sr_shape_disk *d = self;
    double r = (double)d->radius;
    return sr_quadric_box(&d->quadric, (sr_dvec3){0, 0, (double)d->height}, (sr_dvec3){r, r, 0}, true);
}

static double object_area(const struct sr_shape_disk *d)
{
    double r = (double)d->radius, hole = (double)d->inner_radius;
    return 0.5 * (double)d->phi_max_rad * (r - hole) * (r + hole);
}

static const sr_dvec3 up = {0, 0, 1};

static float area(const void *self, uint32_t primitive)
{
    (void)primitive;
    const struct sr_shape_disk *d = self;
    return (float)(object_area(d) * sr_quadric_area_scale(&d->quadric, up));
}

static bool intersect(const void *self, uint32_t primitive, sr_vec3 o, sr_vec3 d, float t_min, float t_max, float *t,
                      sr_vec2 *hit)
{
    (void)primitive;
    const struct sr_shape_disk *k = self;
    sr_dvec3 p = sr_affine(k->quadric.to_object, sr_dvec(o), 1), w = sr_affine(k->quadric.to_object, sr_dvec(d), 0);
    if (w.z == 0)
        return false;
    double at = ((double)k->height - p.z) / w.z;
    if (!(at > (double)t_min && at < (double)t_max))
        return false;
    double x = p.x + at * w.x, y = p.y + at * w.y, rho2 = x * x + y * y, r = (double)k->radius,
           hole = (double)k->inner_radius;
    if (rho2 > r * r || rho2 < hole * hole || (k->phi_max < 360 && sr_quadric_phi(x, y) > (double)k->phi_max_rad))
        return false;
    *t = (float)at;
    *hit = (sr_vec2){(float)x, (float)y};
    return true;
}

static sr_vec2 coordinates(const struct sr_shape_disk *d, double x, double y)
{
    float rho = (float)sqrt(x * x + y * y);
    return (sr_vec2){sr_clamp(sr_quadric_phif(x, y) / d->phi_max_rad, 0, 1),
                     sr_clamp((d->radius - rho) / (d->radius - d->inner_radius), 0, 1)};
}

static void point(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x)
{
    (void)primitive;
    const struct sr_shape_disk *d = self;
    struct sr_quadric_point o;
    double px = (double)hit.x, py = (double)hit.y, rho = sqrt(px * px + py * py), phi_max = (double)d->phi_max_rad;
    double cos_phi = rho > 0 ? px / rho : 1, sin_phi = rho > 0 ? py / rho : 0;
    double range = (double)d->inner_radius - (double)d->radius;
    double wide = fmax(rho, 1e-5 * (double)d->radius); // in the centre dpdu would vanish, and with it the frame
    o.p = (sr_dvec3){px, py, (double)d->height};
    o.n = up;
    o.dpdu = (sr_dvec3){-phi_max * wide * sin_phi, phi_max * wide * cos_phi, 0};
    o.dpdv = (sr_dvec3){range * cos_phi, range * sin_phi, 0};
    o.dndu = o.dndv = (sr_dvec3){0, 0, 0};
    o.uv = coordinates(d, px, py);
    sr_quadric_surface(&d->quadric, &o, x);
}

static sr_vec2 uv(const void *self, uint32_t primitive, sr_vec2 hit)
{
    (void)primitive;
    return coordinates(self, (double)hit.x, (double)hit.y);
}

static bool sample(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec2 u,
                   struct sr_shape_sample *s)
{
    (void)primitive;
    const struct sr_shape_disk *d = self;
    double x, y;
    if (d->inner_radius == 0 && d->phi_max == 360) {
        sr_vec2 c = sr_warp_disk(u);
        x = (double)(c.x * d->radius);
        y = (double)(c.y * d->radius);
    } else {
        float rho = sqrtf(sr_lerp(u.x, sr_sqr(d->inner_radius), sr_sqr(d->radius))), phi = u.y * d->phi_max_rad;
        x = (double)(rho * cosf(phi));
        y = (double)(rho * sinf(phi));
    }
    return sr_quadric_sample(&d->quadric, (sr_dvec3){x, y, (double)d->height}, up, coordinates(d, x, y),
                             1 / object_area(d), reference, s);
}

static float pdf(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec3 wi,
                 const struct sr_point *there)
{
    (void)primitive;
    (void)wi;
    const struct sr_shape_disk *d = self;
    return sr_quadric_pdf(&d->quadric, up, 1 / object_area(d), reference, there);
}

static void normals(const void *self, uint32_t primitive, sr_vec3 *axis, float *cos_theta)
{
    (void)primitive;
    const struct sr_shape_disk *d = self;
    struct sr_point x;
    point(d, 0, (sr_vec2){d->radius, 0}, &x);
    *axis = x.n;
    *cos_theta = 1;
}

const struct sr_shape_model sr_shape_disk = {
    .name = "disk",
    .params = params,
    .size = sizeof(struct sr_shape_disk),
    .prepare = prepare,
    .primitive_count = primitive_count,
    .bounds = bounds,
    .area = area,
    .intersect = intersect,
    .point = point,
    .uv = uv,
    .sample = sample,
    .pdf = pdf,
    .normals = normals,
};
