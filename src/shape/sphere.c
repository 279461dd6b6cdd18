/* SPDX-License-Identifier: MIT */
/* A sphere, or the part of it between two heights and within an angle around z:
 *
 *     p = r (sin theta cos phi, sin theta sin phi, cos theta) [m]     u = phi / phi_max [1]
 *     v = (theta - theta(z_min)) / (theta(z_max) - theta(z_min)) [1]  n = p / r
 *
 * A full sphere is drawn from outside uniformly within its cone:
 *
 *     pdf = 1 / (2 pi (1 - cos theta_max)) [1/sr],   1 - cos theta_max = s^2 / (1 + sqrt(1 - s^2)),   s = R / distance
 *
 * which keeps its accuracy however small s is. From inside, or if it is partial or scaled to an ellipsoid, by area in
 * object space, uniformly over the part that exists. The hit is the direction p / r in octahedral coordinates (Z.
 * Cigolle et al. 2014): floats near the +z pole are dense there, so a planet may be touched at its pole. */
#include "shape/quadric.h"

static const double pi = 3.14159265358979323846;

#define S struct sr_shape_sphere
static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "radius", "m", 0, INFINITY, 1, offsetof(S, radius), "radius"},
    {SR_PARAM_FLOAT, "zmin", "m", -INFINITY, INFINITY, NAN, offsetof(S, z_min), "lower end; -radius if not given"},
    {SR_PARAM_FLOAT, "zmax", "m", -INFINITY, INFINITY, NAN, offsetof(S, z_max), "upper end; radius if not given"},
    {SR_PARAM_FLOAT, "phimax", "deg", 0, 360, 360, offsetof(S, phi_max), "angle around z that is swept"},
    {0},
};
#undef S

static sr_status prepare(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error)
{
    (void)arena;
    struct sr_shape_sphere *s = self;
    if (!(s->radius > 0) || !isfinite(s->radius))
        return sr_fail(error, SR_ERROR_INPUT, "sphere: \"radius\" is %g, expected a positive number",
                       (double)s->radius);
    float r = s->radius, a = isnan(s->z_min) ? -r : s->z_min, b = isnan(s->z_max) ? r : s->z_max;
    s->z_min = sr_clamp(sr_min(a, b), -r, r);
    s->z_max = sr_clamp(sr_max(a, b), -r, r);
    if (!(s->z_min < s->z_max))
        return sr_fail(error, SR_ERROR_INPUT,
                       "sphere: nothing is left between \"zmin\" %g and \"zmax\" %g of radius %g", (double)a, (double)b,
                       (double)r);
    sr_status status = sr_quadric_angle("sphere", s->phi_max, &s->phi_max_rad, error);
    if (status == SR_OK)
        status = sr_quadric_place(&s->quadric, "sphere", placement, &s->flip_normals, error);
    if (status != SR_OK)
        return status;
    s->object_to_world = placement->object_to_world;
    s->theta_z_min = acosf(s->z_min / r);
    s->theta_z_max = acosf(s->z_max / r);
    s->is_full = s->z_min == -r && s->z_max == r && s->phi_max == 360;

    // columns of equal length, at right angles: rotations, mirrors and uniform scales
    const double(*m)[4] = s->quadric.to_world;
    double scale2 = cbrt(s->quadric.determinant * s->quadric.determinant), deviation = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            double d = m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
            deviation = fmax(deviation, fabs(d / scale2 - (i == j)));
        }
    }
    s->is_rigid = deviation < 1e-5;
    s->centre = (sr_vec3){(float)m[0][3], (float)m[1][3], (float)m[2][3]};
    s->world_radius = (float)((double)r * sqrt(scale2));
    return SR_OK;
}

static uint32_t primitive_count(const void *self)
{
    (void)self;
    return 1;
}

static struct sr_box bounds(const void *self, uint32_t primitive)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    double r = (double)s->radius, lo = (double)s->z_min, hi = (double)s->z_max;
    struct sr_box whole = sr_quadric_box(&s->quadric, (sr_dvec3){0, 0, 0}, (sr_dvec3){r, r, r}, false);
    // a partial one lies in the whole one's box and in that of the cylinder around it
    double widest = lo > 0 ? sqrt((r - lo) * (r + lo)) : hi < 0 ? sqrt((r - hi) * (r + hi)) : r;
    struct sr_box b =
        sr_quadric_box(&s->quadric, (sr_dvec3){0, 0, (lo + hi) / 2}, (sr_dvec3){widest, widest, (hi - lo) / 2}, true);
    return (struct sr_box){{sr_max(whole.lo.x, b.lo.x), sr_max(whole.lo.y, b.lo.y), sr_max(whole.lo.z, b.lo.z)},
                           {sr_min(whole.hi.x, b.hi.x), sr_min(whole.hi.y, b.hi.y), sr_min(whole.hi.z, b.hi.z)}};
}

/* [m^2] in object space: Archimedes' hat box */
static double object_area(const struct sr_shape_sphere *s)
{
    return (double)s->phi_max_rad * (double)s->radius * ((double)s->z_max - (double)s->z_min);
}

static float area(const void *self, uint32_t primitive)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    if (s->is_rigid)
        return (float)(object_area(s) * (double)s->world_radius * (double)s->world_radius /
                       ((double)s->radius * (double)s->radius));
    enum { nodes = 96 };
    double z[nodes], wz[nodes], phi[nodes], w_phi[nodes], sum = 0;
    sr_gauss_legendre(nodes, (double)s->theta_z_max, (double)s->theta_z_min, z, wz);
    sr_gauss_legendre(nodes, 0, (double)s->phi_max_rad, phi, w_phi);
    for (int i = 0; i < nodes; ++i) {
        double rho = sin(z[i]), c = cos(z[i]);
        for (int j = 0; j < nodes; ++j)
            sum += wz[i] * w_phi[j] * rho *
                   sr_quadric_area_scale(&s->quadric, (sr_dvec3){rho * cos(phi[j]), rho * sin(phi[j]), c});
    }
    return (float)(sum * (double)s->radius * (double)s->radius);
}

static sr_vec2 octahedral(sr_dvec3 d)
{
    double k = 1 / (fabs(d.x) + fabs(d.y) + fabs(d.z)), x = d.x * k, y = d.y * k;
    if (d.z < 0)
        return (sr_vec2){(float)copysign(1 - fabs(y), x), (float)copysign(1 - fabs(x), y)};
    return (sr_vec2){(float)x, (float)y};
}

static sr_dvec3 unit(sr_dvec3 d)
{
    return sr_dscale(1 / sqrt(sr_ddot(d, d)), d);
}

static sr_dvec3 direction(sr_vec2 h)
{
    double x = (double)h.x, y = (double)h.y, z = 1 - fabs(x) - fabs(y);
    if (z < 0) {
        double folded = copysign(1 - fabs(y), x);
        y = copysign(1 - fabs(x), y);
        x = folded;
    }
    return unit((sr_dvec3){x, y, z});
}

static sr_vec2 coordinates(const struct sr_shape_sphere *s, sr_dvec3 n)
{
    float theta = sr_angle_of((float)sqrt(n.x * n.x + n.y * n.y), (float)n.z);
    return (sr_vec2){sr_clamp(sr_quadric_phif(n.x, n.y) / s->phi_max_rad, 0, 1),
                     sr_clamp((theta - s->theta_z_min) / (s->theta_z_max - s->theta_z_min), 0, 1)};
}

static bool exists(const struct sr_shape_sphere *s, sr_dvec3 p)
{
    if (s->is_full)
        return true;
    float r = s->radius;
    if ((s->z_min > -r && p.z < (double)s->z_min) || (s->z_max < r && p.z > (double)s->z_max))
        return false;
    return s->phi_max == 360 || sr_quadric_phi(p.x, p.y) <= (double)s->phi_max_rad;
}

static bool intersect(const void *self, uint32_t primitive, sr_vec3 o, sr_vec3 d, float t_min, float t_max, float *t,
                      sr_vec2 *hit)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    sr_dvec3 p = sr_affine(s->quadric.to_object, sr_dvec(o), 1), w = sr_affine(s->quadric.to_object, sr_dvec(d), 0);
    double r = (double)s->radius, a = sr_ddot(w, w), b = sr_ddot(p, w);
    // the ray's nearest approach to the centre, l, tells b^2 - a c without subtracting great squares (Hearn & Baker)
    double k = b / a;
    sr_dvec3 l = {p.x - k * w.x, p.y - k * w.y, p.z - k * w.z};
    double nearest2 = sr_ddot(l, l), roots[2];
    if (nearest2 > r * r) // what most rays do
        return false;
    double nearest = sqrt(nearest2), distance = sqrt(sr_ddot(p, p));
    if (!sr_quadric_roots(a, b, (distance - r) * (distance + r), a * (r - nearest) * (r + nearest), roots))
        return false;
    for (int i = 0; i < 2; ++i) {
        if (!(roots[i] > (double)t_min && roots[i] < (double)t_max))
            continue;
        sr_dvec3 at = {p.x + roots[i] * w.x, p.y + roots[i] * w.y, p.z + roots[i] * w.z};
        if (!exists(s, at))
            continue;
        *t = (float)roots[i];
        *hit = octahedral(at);
        return true;
    }
    return false;
}

static void point(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    struct sr_quadric_point o;
    double r = (double)s->radius, phi_max = (double)s->phi_max_rad,
           theta_range = (double)s->theta_z_max - (double)s->theta_z_min;
    o.n = direction(hit);
    o.p = sr_dscale(r, o.n);
    double rho = sqrt(o.n.x * o.n.x + o.n.y * o.n.y);
    double cos_phi = rho > 0 ? o.n.x / rho : 1, sin_phi = rho > 0 ? o.n.y / rho : 0;
    double wide = fmax(rho, 1e-5); // at the poles dpdu would vanish, and with it the frame
    sr_dvec3 du = {-phi_max * wide * sin_phi, phi_max * wide * cos_phi, 0};
    sr_dvec3 dv = {theta_range * o.n.z * cos_phi, theta_range * o.n.z * sin_phi, -theta_range * rho};
    o.dndu = du;
    o.dndv = dv;
    o.dpdu = sr_dscale(r, du);
    o.dpdv = sr_dscale(r, dv);
    o.uv = coordinates(s, o.n);
    sr_quadric_surface(&s->quadric, &o, x);
}

static void bare_point(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    sr_dvec3 n = direction(hit);
    sr_quadric_bare_surface(&s->quadric, sr_dscale((double)s->radius, n), n, x);
}

static sr_vec2 uv(const void *self, uint32_t primitive, sr_vec2 hit)
{
    (void)primitive;
    return coordinates(self, direction(hit));
}

/* Whether the sphere is drawn by its cone; then the way to its centre [m] and (R / distance)^2. Points on the sphere,
 * to within rounding, count as inside. */
static bool by_cone(const struct sr_shape_sphere *s, const struct sr_point *reference, sr_dvec3 *to_centre,
                    double *sin2_max)
{
    if (!s->is_full || !s->is_rigid)
        return false;
    const double(*m)[4] = s->quadric.to_world;
    *to_centre = (sr_dvec3){m[0][3] - (double)reference->p.x, m[1][3] - (double)reference->p.y,
                            m[2][3] - (double)reference->p.z};
    double d2 = sr_ddot(*to_centre, *to_centre), R = (double)s->world_radius;
    *sin2_max = R * R / d2;
    return sqrt(d2) > R * (1 + 1e-6) + 2 * (double)sr_max_component(reference->p_error);
}

static bool sample(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec2 u,
                   struct sr_shape_sample *sample)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    sr_dvec3 c;
    double s2;
    if (!reference || !by_cone(s, reference, &c, &s2)) {
        double r = (double)s->radius, z = ((double)s->z_min + (double)u.x * ((double)s->z_max - (double)s->z_min)) / r;
        double rho = sqrt(fmax(0, (1 - z) * (1 + z)));
        float phi = u.y * s->phi_max_rad;
        sr_dvec3 n = unit((sr_dvec3){rho * (double)cosf(phi), rho * (double)sinf(phi), z});
        return sr_quadric_sample(&s->quadric, sr_dscale(r, n), n, coordinates(s, n), 1 / object_area(s), reference,
                                 sample);
    }

    // theta: at the reference, from the axis; beta: at the sphere, between ray and radius; alpha = beta - theta: at the
    // centre
    double cos_max = sqrt(1 - s2), one_minus_cos_max = s2 / (1 + cos_max), x = (double)u.x * one_minus_cos_max;
    double cos_theta = 1 - x, sin_theta = sqrt(x * (2 - x));
    double sin_beta = sqrt(fmin(1, (double)u.x * (2 - x) / (1 + cos_max))),
           cos_beta = sqrt((1 - sin_beta) * (1 + sin_beta));
    double sin_alpha = sin_beta * cos_theta - cos_beta * sin_theta,
           cos_alpha = cos_beta * cos_theta + sin_beta * sin_theta;
    float sin_phi, cos_phi;
    sr_sin_cos_turn(u.y, &sin_phi, &cos_phi);
    double a = sin_alpha * (double)cos_phi, b = sin_alpha * (double)sin_phi;
    sr_dvec3 axis = unit(c);
    struct sr_frame f = sr_frame_from_z(sr_dround(axis));
    sr_dvec3 fx = sr_dvec(f.x), fy = sr_dvec(f.y);
    sr_dvec3 radial = {a * fx.x + b * fy.x - cos_alpha * axis.x, a * fx.y + b * fy.y - cos_alpha * axis.y,
                       a * fx.z + b * fy.z - cos_alpha * axis.z};
    sr_dvec3 n = unit(sr_affine(s->quadric.to_object, radial, 0)); // on the surface to rounding, however rigid M is
    if (!sr_quadric_sample(&s->quadric, sr_dscale((double)s->radius, n), n, coordinates(s, n), 1, NULL, sample))
        return false;
    sample->pdf = (float)(1 / (2 * pi * one_minus_cos_max));
    return true;
}

static float pdf(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec3 wi,
                 const struct sr_point *there)
{
    (void)primitive;
    (void)wi;
    const struct sr_shape_sphere *s = self;
    sr_dvec3 c;
    double s2;
    if (by_cone(s, reference, &c, &s2))
        return (float)((1 + sqrt(1 - s2)) / (2 * pi * s2));
    sr_dvec3 n = unit(sr_affine(s->quadric.to_object, sr_dvec(there->p), 1));
    return sr_quadric_pdf(&s->quadric, n, 1 / object_area(s), reference, there);
}

static float area_pdf(const void *self, uint32_t primitive, const struct sr_point *there)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    sr_dvec3 n = unit(sr_affine(s->quadric.to_object, sr_dvec(there->p), 1));
    return (float)(1 / (object_area(s) * sr_quadric_area_scale(&s->quadric, n)));
}

static void normals(const void *self, uint32_t primitive, sr_vec3 *axis, float *cos_theta)
{
    (void)self;
    (void)primitive;
    *axis = (sr_vec3){0, 0, 1};
    *cos_theta = -1;
}

static bool round_(const void *self, uint32_t primitive, struct sr_shape_round *round)
{
    (void)primitive;
    const struct sr_shape_sphere *s = self;
    *round = (struct sr_shape_round){s->centre, s->world_radius, (float)s->quadric.side};
    return s->is_full && s->is_rigid;
}

const struct sr_shape_model sr_shape_sphere = {
    .name = "sphere",
    .params = params,
    .size = sizeof(struct sr_shape_sphere),
    .prepare = prepare,
    .primitive_count = primitive_count,
    .bounds = bounds,
    .area = area,
    .intersect = intersect,
    .point = point,
    .bare_point = bare_point,
    .uv = uv,
    .sample = sample,
    .pdf = pdf,
    .area_pdf = area_pdf,
    .normals = normals,
    .round = round_,
};
