/* SPDX-License-Identifier: MIT */
/* The mantle of a cylinder between two heights and within an angle around z; it has no lids:
 *
 *     p = (r cos phi, r sin phi, z) [m]   u = phi / phi_max   v = (z - z_min) / (z_max - z_min) [1]
 *     n points away from the axis
 *
 * The hit is (u, v). Drawn uniformly by area in object space; under unequal scales the density follows the Jacobian. */
#include "shape/quadric.h"

#define C struct sr_shape_cylinder
static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "radius", "m", 0, INFINITY, 1, offsetof(C, radius), "radius"},
    {SR_PARAM_FLOAT, "zmin", "m", -INFINITY, INFINITY, -1, offsetof(C, z_min), "lower end"},
    {SR_PARAM_FLOAT, "zmax", "m", -INFINITY, INFINITY, 1, offsetof(C, z_max), "upper end"},
    {SR_PARAM_FLOAT, "phimax", "deg", 0, 360, 360, offsetof(C, phi_max), "angle around z that is swept"},
    {0},
};
#undef C

static sr_status prepare(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error)
{
    (void)arena;
    struct sr_shape_cylinder *c = self;
    if (!(c->radius > 0) || !isfinite(c->radius))
        return sr_fail(error, SR_ERROR_INPUT, "cylinder: \"radius\" is %g, expected a positive number",
                       (double)c->radius);
    float a = isnan(c->z_min) ? -1 : c->z_min, b = isnan(c->z_max) ? 1 : c->z_max;
    c->z_min = sr_min(a, b);
    c->z_max = sr_max(a, b);
    if (!(c->z_min < c->z_max) || !isfinite(c->z_max - c->z_min))
        return sr_fail(error, SR_ERROR_INPUT, "cylinder: \"zmin\" %g and \"zmax\" %g must be finite and differ",
                       (double)a, (double)b);
    c->object_to_world = placement->object_to_world;
    sr_status status = sr_quadric_angle("cylinder", c->phi_max, &c->phi_max_rad, error);
    return status != SR_OK ? status : sr_quadric_place(&c->quadric, "cylinder", placement, &c->flip_normals, error);
}

static uint32_t primitive_count(const void *self)
{
    (void)self;
    return 1;
}

static struct sr_box bounds(const void *self, uint32_t primitive)
{
    (void)primitive;
    const struct sr_shape_cylinder *c = self;
    double r = (double)c->radius, lo = (double)c->z_min, hi = (double)c->z_max;
    return sr_quadric_box(&c->quadric, (sr_dvec3){0, 0, (lo + hi) / 2}, (sr_dvec3){r, r, (hi - lo) / 2}, true);
}

static double object_area(const struct sr_shape_cylinder *c)
{
    return (double)c->phi_max_rad * (double)c->radius * ((double)c->z_max - (double)c->z_min);
}

static float area(const void *self, uint32_t primitive)
{
    (void)primitive;
    const struct sr_shape_cylinder *c = self;
    enum { nodes = 256 };
    double phi[nodes], w[nodes], mean = 0;
    sr_gauss_legendre(nodes, 0, (double)c->phi_max_rad, phi, w);
    for (int i = 0; i < nodes; ++i)
        mean += w[i] * sr_quadric_area_scale(&c->quadric, (sr_dvec3){cos(phi[i]), sin(phi[i]), 0});
    return (float)(object_area(c) * mean / (double)c->phi_max_rad);
}

static bool intersect(const void *self, uint32_t primitive, sr_vec3 o, sr_vec3 d, float t_min, float t_max, float *t,
                      sr_vec2 *hit)
{
    (void)primitive;
    const struct sr_shape_cylinder *c = self;
    sr_dvec3 p = sr_affine(c->quadric.to_object, sr_dvec(o), 1), w = sr_affine(c->quadric.to_object, sr_dvec(d), 0);
    double r = (double)c->radius, a = w.x * w.x + w.y * w.y, b = p.x * w.x + p.y * w.y;
    double distance = sqrt(p.x * p.x + p.y * p.y), roots[2];
    if (a == 0)
        return false;
    double nearest = fabs(p.x * w.y - p.y * w.x) / sqrt(a); // of the ray to the axis
    if (!sr_quadric_roots(a, b, (distance - r) * (distance + r), a * (r - nearest) * (r + nearest), roots))
        return false;
    for (int i = 0; i < 2; ++i) {
        double z = p.z + roots[i] * w.z;
        if (!(roots[i] > (double)t_min && roots[i] < (double)t_max) || z < (double)c->z_min || z > (double)c->z_max)
            continue;
        double phi = sr_quadric_phi(p.x + roots[i] * w.x, p.y + roots[i] * w.y);
        if (c->phi_max < 360 && phi > (double)c->phi_max_rad)
            continue;
        *t = (float)roots[i];
        *hit = (sr_vec2){sr_min(1, (float)(phi / (double)c->phi_max_rad)),
                         (float)((z - (double)c->z_min) / ((double)c->z_max - (double)c->z_min))};
        return true;
    }
    return false;
}

static void point(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x)
{
    (void)primitive;
    const struct sr_shape_cylinder *c = self;
    struct sr_quadric_point o;
    double phi_max = (double)c->phi_max_rad, phi = (double)hit.x * phi_max, r = (double)c->radius;
    double height = (double)c->z_max - (double)c->z_min;
    o.n = (sr_dvec3){cos(phi), sin(phi), 0};
    o.p = (sr_dvec3){r * o.n.x, r * o.n.y, (double)c->z_min + (double)hit.y * height};
    o.dndu = (sr_dvec3){-phi_max * o.n.y, phi_max * o.n.x, 0};
    o.dndv = (sr_dvec3){0, 0, 0};
    o.dpdu = sr_dscale(r, o.dndu);
    o.dpdv = (sr_dvec3){0, 0, height};
    o.uv = hit;
    sr_quadric_surface(&c->quadric, &o, x);
}

static sr_vec2 uv(const void *self, uint32_t primitive, sr_vec2 hit)
{
    (void)self;
    (void)primitive;
    return hit;
}

static bool sample(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec2 u,
                   struct sr_shape_sample *s)
{
    (void)primitive;
    const struct sr_shape_cylinder *c = self;
    float phi = u.x * c->phi_max_rad;
    double cos_phi = (double)cosf(phi), sin_phi = (double)sinf(phi),
           k = 1 / sqrt(cos_phi * cos_phi + sin_phi * sin_phi);
    sr_dvec3 n = {cos_phi * k, sin_phi * k, 0};
    double r = (double)c->radius, z = (double)c->z_min + (double)u.y * ((double)c->z_max - (double)c->z_min);
    return sr_quadric_sample(&c->quadric, (sr_dvec3){r * n.x, r * n.y, z}, n, u, 1 / object_area(c), reference, s);
}

static float pdf(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec3 wi,
                 const struct sr_point *there)
{
    (void)primitive;
    (void)wi;
    const struct sr_shape_cylinder *c = self;
    sr_dvec3 p = sr_affine(c->quadric.to_object, sr_dvec(there->p), 1);
    double rho = sqrt(p.x * p.x + p.y * p.y);
    if (!(rho > 0))
        return 0;
    return sr_quadric_pdf(&c->quadric, (sr_dvec3){p.x / rho, p.y / rho, 0}, 1 / object_area(c), reference, there);
}

static float area_pdf(const void *self, uint32_t primitive, const struct sr_point *there)
{
    (void)primitive;
    const struct sr_shape_cylinder *c = self;
    sr_dvec3 p = sr_affine(c->quadric.to_object, sr_dvec(there->p), 1);
    double rho = sqrt(p.x * p.x + p.y * p.y);
    return rho > 0
               ? (float)(1 / (object_area(c) * sr_quadric_area_scale(&c->quadric, (sr_dvec3){p.x / rho, p.y / rho, 0})))
               : 0;
}

static void normals(const void *self, uint32_t primitive, sr_vec3 *axis, float *cos_theta)
{
    (void)self;
    (void)primitive;
    *axis = (sr_vec3){0, 0, 1};
    *cos_theta = -1;
}

const struct sr_shape_model sr_shape_cylinder = {
    .name = "cylinder",
    .params = params,
    .size = sizeof(struct sr_shape_cylinder),
    .prepare = prepare,
    .primitive_count = primitive_count,
    .bounds = bounds,
    .area = area,
    .intersect = intersect,
    .point = point,
    .uv = uv,
    .sample = sample,
    .pdf = pdf,
    .area_pdf = area_pdf,
    .normals = normals,
};
