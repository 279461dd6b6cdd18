/* SPDX-License-Identifier: MIT */
/* From a point of a surface to the plane of a texture, with the footprint of a pixel there.
 *
 *     uv            s = uscale u + udelta                    t = vscale v + vdelta
 *     spherical     s = theta / pi                           t = phi / (2 pi)
 *     cylindrical   s = (pi + atan2(y, x)) / (2 pi)          t = z
 *     planar        s = udelta + q . v1                      t = vdelta + q . v2
 *
 * all [1], of q = (x, y, z), the point in the texture's space. Derivatives by the chain rule: dsdx = (ds/dq) . dqdx.
 * Pharr, Jakob & Humphreys 2023, 10.2. On the axis of the sphere or cylinder s jumps and the footprint is taken as 0.
 * */
#include "texture/private.h"

#define OFFSET(member) offsetof(struct sr_mapping, member)
const struct sr_param sr_mapping_params[] = {
    {SR_PARAM_ENUM, "mapping", "1", 0, 3, 0, OFFSET(kind), "uv|spherical|cylindrical|planar"},
    {SR_PARAM_FLOAT, "uscale", "1", -INFINITY, INFINITY, 1, OFFSET(uscale), "uv: factor of u"},
    {SR_PARAM_FLOAT, "vscale", "1", -INFINITY, INFINITY, 1, OFFSET(vscale), "uv: factor of v"},
    {SR_PARAM_FLOAT, "udelta", "1", -INFINITY, INFINITY, 0, OFFSET(udelta), "uv, planar: added to s"},
    {SR_PARAM_FLOAT, "vdelta", "1", -INFINITY, INFINITY, 0, OFFSET(vdelta), "uv, planar: added to t"},
    {SR_PARAM_VECTOR3, "v1", "m^-1", -INFINITY, INFINITY, NAN, OFFSET(v1), "planar: gradient of s, (1,0,0) by default"},
    {SR_PARAM_VECTOR3, "v2", "m^-1", -INFINITY, INFINITY, NAN, OFFSET(v2), "planar: gradient of t, (0,1,0) by default"},
    {0},
};

static bool is_given(sr_vec3 v)
{
    return sr_is_finite(v) && sr_length2(v) > 0;
}

sr_status sr_mapping_prepare(struct sr_mapping *m, struct sr_error *error)
{
    if (m->kind < SR_MAPPING_UV || m->kind > SR_MAPPING_PLANAR)
        return sr_fail(error, SR_ERROR_INPUT,
                       "a texture's mapping is unknown: expected uv, spherical, cylindrical or planar");
    if (!is_given(m->v1))
        m->v1 = (sr_vec3){1, 0, 0};
    if (!is_given(m->v2))
        m->v2 = (sr_vec3){0, 1, 0};
    return SR_OK;
}

struct sr_mapped sr_mapping_apply(const struct sr_mapping *m, const struct sr_point *x)
{
    if (SR_LIKELY(m->kind == SR_MAPPING_UV))
        return (struct sr_mapped){
            .st = {m->uscale * x->uv.x + m->udelta, m->vscale * x->uv.y + m->vdelta},
            .dsdx = m->uscale * x->dudx,
            .dsdy = m->uscale * x->dudy,
            .dtdx = m->vscale * x->dvdx,
            .dtdy = m->vscale * x->dvdy,
        };

    sr_vec3 q = sr_transform_point(&m->world_to_texture, x->p);
    sr_vec3 dqdx = sr_transform_vector(&m->world_to_texture, x->dpdx);
    sr_vec3 dqdy = sr_transform_vector(&m->world_to_texture, x->dpdy);
    float rho2 = q.x * q.x + q.y * q.y;
    sr_vec2 st;
    sr_vec3 dsdq, dtdq;
    // gradient of phi is (-y, x, 0) / rho^2
    float inv_rho2 = rho2 > 0 ? 1 / rho2 : 0;
    sr_vec3 dphidq = {-q.y * inv_rho2, q.x * inv_rho2, 0};
    if (m->kind == SR_MAPPING_SPHERICAL) {
        float rho = sqrtf(rho2), r2 = rho2 + q.z * q.z;
        float phi = atan2f(q.y, q.x);
        st = (sr_vec2){atan2f(rho, q.z) * SR_INV_PI, (phi < 0 ? phi + 2 * SR_PI : phi) * (0.5f * SR_INV_PI)};
        float k = rho2 > 0 ? SR_INV_PI / (rho * r2) : 0;
        dsdq = (sr_vec3){k * q.x * q.z, k * q.y * q.z, -k * rho2};
        dtdq = sr_scale(0.5f * SR_INV_PI, dphidq);
    } else if (m->kind == SR_MAPPING_CYLINDRICAL) {
        st = (sr_vec2){(SR_PI + atan2f(q.y, q.x)) * (0.5f * SR_INV_PI), q.z};
        dsdq = sr_scale(0.5f * SR_INV_PI, dphidq);
        dtdq = (sr_vec3){0, 0, 1};
    } else {
        st = (sr_vec2){m->udelta + sr_dot(q, m->v1), m->vdelta + sr_dot(q, m->v2)};
        dsdq = m->v1;
        dtdq = m->v2;
    }
    return (struct sr_mapped){st, sr_dot(dsdq, dqdx), sr_dot(dsdq, dqdy), sr_dot(dtdq, dqdx), sr_dot(dtdq, dqdy)};
}
