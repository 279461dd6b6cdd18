/* SPDX-License-Identifier: MIT */
/* Quadrics in the world: positions by M, normals by M^-T, areas by the Jacobian
 *
 *     dA_world / dA_object = |det M| |M^-T n|        [1]
 *     dn/du of n = s / |s|:  (ds/du - n (n . ds/du)) / |s|,   s = M^-T n_object
 *
 * All is computed in double and rounded once, so the error of p is half an ulp of p, wherever the object lies. */
#include "shape/quadric.h"
#include "shape/mesh.h"

sr_status sr_quadric_place(struct sr_shape_quadric *q, const char *name, const struct sr_shape_placement *placement,
                           bool *flip_normals, struct sr_error *error)
{
    const struct sr_transform *t = &placement->object_to_world;
    if (!sr_transform_is_valid(t))
        return sr_fail(error, SR_ERROR_INPUT, "%s: the transform must be finite and invertible", name);
    if (t->m[3][0] != 0 || t->m[3][1] != 0 || t->m[3][2] != 0 || t->m[3][3] != 1)
        return sr_fail(error, SR_ERROR_INPUT, "%s: the transform must be affine, its last row 0 0 0 1", name);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j)
            q->to_world[i][j] = (double)t->m[i][j];
    }
    double(*m)[4] = q->to_world, (*inverse)[4] = q->to_object;
    double determinant = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) { // cofactors, with indices that go round
            int r0 = (j + 1) % 3, r1 = (j + 2) % 3, c0 = (i + 1) % 3, c1 = (i + 2) % 3;
            inverse[i][j] = m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
        }
    }
    for (int j = 0; j < 3; ++j)
        determinant += m[0][j] * inverse[j][0];
    if (!(fabs(determinant) > 0))
        return sr_fail(error, SR_ERROR_INPUT, "%s: the transform must be invertible", name);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            inverse[i][j] /= determinant;
        inverse[i][3] = -(inverse[i][0] * m[0][3] + inverse[i][1] * m[1][3] + inverse[i][2] * m[2][3]);
    }
    q->determinant = fabs(determinant);
    q->side = placement->reverse_orientation ? -1 : 1;
    *flip_normals = placement->reverse_orientation != (determinant < 0);
    return SR_OK;
}

sr_status sr_quadric_angle(const char *name, float phi_max_deg, float *phi_max_rad, struct sr_error *error)
{
    if (!(phi_max_deg > 0 && phi_max_deg <= 360))
        return sr_fail(error, SR_ERROR_INPUT, "%s: \"phimax\" is %g, expected more than 0 and at most 360 degrees",
                       name, (double)phi_max_deg);
    *phi_max_rad = phi_max_deg == 360 ? 2 * SR_PI : sr_radians(phi_max_deg);
    return SR_OK;
}

struct sr_box sr_quadric_box_outward(sr_dvec3 lo, sr_dvec3 hi)
{
    double l[3] = {lo.x, lo.y, lo.z}, h[3] = {hi.x, hi.y, hi.z};
    float a[3], b[3];
    for (int i = 0; i < 3; ++i) {
        a[i] = nextafterf((float)(l[i] - 1e-12 * fabs(l[i])), -INFINITY);
        b[i] = nextafterf((float)(h[i] + 1e-12 * fabs(h[i])), INFINITY);
    }
    return (struct sr_box){{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

struct sr_box sr_quadric_box(const struct sr_shape_quadric *q, sr_dvec3 centre, sr_dvec3 half, bool is_box)
{
    sr_dvec3 c = sr_affine(q->to_world, centre, 1);
    double e[3];
    for (int i = 0; i < 3; ++i) {
        const double *m = q->to_world[i];
        double x = m[0] * half.x, y = m[1] * half.y, z = m[2] * half.z;
        // the ellipsoid's extent along axis i; a cylinder's is that of its rim and its height
        e[i] = is_box ? sqrt(x * x + y * y) + fabs(z) : sqrt(x * x + y * y + z * z);
    }
    return sr_quadric_box_outward((sr_dvec3){c.x - e[0], c.y - e[1], c.z - e[2]},
                                  (sr_dvec3){c.x + e[0], c.y + e[1], c.z + e[2]});
}

/* M^-T n, outside */
static sr_dvec3 to_world_normal(const struct sr_shape_quadric *q, sr_dvec3 n)
{
    const double(*k)[4] = q->to_object;
    return (sr_dvec3){q->side * (k[0][0] * n.x + k[1][0] * n.y + k[2][0] * n.z),
                      q->side * (k[0][1] * n.x + k[1][1] * n.y + k[2][1] * n.z),
                      q->side * (k[0][2] * n.x + k[1][2] * n.y + k[2][2] * n.z)};
}

/* Half an ulp, and the far smaller rounding of the double sum before it. */
static sr_vec3 rounding(const struct sr_shape_quadric *q, sr_dvec3 p, sr_vec3 rounded)
{
    float e[3], r[3] = {rounded.x, rounded.y, rounded.z};
    for (int i = 0; i < 3; ++i) {
        const double *m = q->to_world[i];
        double sum = fabs(m[0] * p.x) + fabs(m[1] * p.y) + fabs(m[2] * p.z) + fabs(m[3]);
        e[i] = 1.01f * SR_MACHINE_EPSILON * fabsf(r[i]) + (float)(1e-15 * sum) + 1e-37f;
    }
    return (sr_vec3){e[0], e[1], e[2]};
}

void sr_quadric_surface(const struct sr_shape_quadric *q, const struct sr_quadric_point *o, struct sr_point *x)
{
    x->p = sr_dround(sr_affine(q->to_world, o->p, 1));
    x->p_error = rounding(q, o->p, x->p);
    sr_dvec3 s = to_world_normal(q, o->n);
    double inverse = 1 / sqrt(sr_ddot(s, s));
    sr_dvec3 n = sr_dscale(inverse, s);
    x->n = x->ns = sr_dround(n);
    x->dpdu = x->dpdus = sr_dround(sr_affine(q->to_world, o->dpdu, 0));
    x->dpdv = sr_dround(sr_affine(q->to_world, o->dpdv, 0));
    sr_dvec3 su = to_world_normal(q, o->dndu), sv = to_world_normal(q, o->dndv);
    double nu = sr_ddot(n, su), nv = sr_ddot(n, sv);
    x->dndu = sr_dround(sr_dscale(inverse, (sr_dvec3){su.x - nu * n.x, su.y - nu * n.y, su.z - nu * n.z}));
    x->dndv = sr_dround(sr_dscale(inverse, (sr_dvec3){sv.x - nv * n.x, sv.y - nv * n.y, sv.z - nv * n.z}));
    x->uv = o->uv;
    x->face = 0;
}

void sr_quadric_bare_surface(const struct sr_shape_quadric *q, sr_dvec3 p, sr_dvec3 n, struct sr_point *x)
{
    x->p = sr_dround(sr_affine(q->to_world, p, 1));
    x->p_error = rounding(q, p, x->p);
    sr_dvec3 s = to_world_normal(q, n);
    x->n = x->ns = sr_dround(sr_dscale(1 / sqrt(sr_ddot(s, s)), s));
}

double sr_quadric_area_scale(const struct sr_shape_quadric *q, sr_dvec3 n)
{
    sr_dvec3 s = to_world_normal(q, n);
    return q->determinant * sqrt(sr_ddot(s, s));
}

bool sr_quadric_sample(const struct sr_shape_quadric *q, sr_dvec3 p, sr_dvec3 n, sr_vec2 uv, double pdf_object,
                       const struct sr_point *reference, struct sr_shape_sample *s)
{
    s->p = sr_dround(sr_affine(q->to_world, p, 1));
    s->p_error = rounding(q, p, s->p);
    sr_dvec3 t = to_world_normal(q, n);
    double l = sqrt(sr_ddot(t, t));
    s->n = sr_dround(sr_dscale(1 / l, t));
    s->uv = uv;
    float pdf = (float)(pdf_object / (q->determinant * l));
    s->pdf = reference ? sr_density_seen_from(reference->p, s->p, s->n, pdf) : pdf;
    return s->pdf > 0 && isfinite(s->pdf);
}

float sr_quadric_pdf(const struct sr_shape_quadric *q, sr_dvec3 n, double pdf_object, const struct sr_point *reference,
                     const struct sr_point *there)
{
    float pdf = (float)(pdf_object / sr_quadric_area_scale(q, n));
    return sr_density_seen_from(reference->p, there->p, there->n, pdf);
}
