/* SPDX-License-Identifier: MIT */
/* From a material and a point to a BSDF and its frame: mix, then bump or normal map, then the model.
 *
 * Bump: the surface p' = p + d ns has the derivatives, to first order in the displacement d [m] (Blinn 1978),
 *
 *     dp'/du = dp/du + (dd/du) ns + d dns/du          and the same for v;          ns' = dp'/du x dp'/dv, normalised
 *
 * dd/du is a difference over half a footprint, so that detail finer than a pixel is not taken for slopes; without a
 * footprint over 0.0005. Pharr, Jakob & Humphreys 2023, 10.5.3. Where the shading normal is interpolated, the
 * derivatives that count are those of the smooth surface: dp/du and dp/dv less their parts along ns.
 *
 * Normal map: 2 rgb - 1 is the normal in the frame of tangent, bitangent and ns; texels are numbers, not light, so
 * bytes are read as byte / 255 whatever their decode table says. If a material has both maps the normal map is used, as
 * in pbrt.
 *
 * Normal textures: three numbers are the normal, each from a texture of its own; its second axis is on the side of
 * dp/dv, so that mirrored texture coordinates need no other map (glTF 2.0, 3.9.3).
 *
 * In all ns' stays on the side of the geometric normal n. */
#include "material/private.h"

#include <string.h>

#define MIX_DEPTH 32 // mixes of mixes; named materials refer to earlier ones, so a scene cannot have a circle

static float texel(const struct sr_texels *t, uint32_t x, uint32_t y, uint32_t channel)
{
    size_t i = ((size_t)y * t->width + x) * t->channels + (t->channels >= 3 ? channel : 0);
    return t->floats ? t->floats[i] : (float)t->bytes[i] * (1 / 255.0f);
}

// the repeated image at (u, 1 - v), bilinear, as a vector
static sr_vec3 normal_at(const struct sr_texels *t, sr_vec2 uv)
{
    float u = uv.x - floorf(uv.x), v = 1 - uv.y;
    v -= floorf(v);
    float x = (u >= 0 ? u : 0) * (float)t->width - 0.5f, y = (v >= 0 ? v : 0) * (float)t->height - 0.5f; // NaN: 0
    float fx = floorf(x), fy = floorf(y), dx = x - fx, dy = y - fy;
    uint32_t x0 = fx < 0 ? t->width - 1 : (uint32_t)fx, y0 = fy < 0 ? t->height - 1 : (uint32_t)fy;
    x0 = x0 < t->width ? x0 : 0; // u may round to 1
    y0 = y0 < t->height ? y0 : 0;
    uint32_t x1 = x0 + 1 < t->width ? x0 + 1 : 0, y1 = y0 + 1 < t->height ? y0 + 1 : 0;
    float n[3];
    for (uint32_t k = 0; k < 3; ++k) {
        float value = (1 - dy) * ((1 - dx) * texel(t, x0, y0, k) + dx * texel(t, x1, y0, k)) +
                      dy * ((1 - dx) * texel(t, x0, y1, k) + dx * texel(t, x1, y1, k));
        n[k] = 2 * value - 1;
    }
    return (sr_vec3){n[0], n[1], n[2]};
}

static sr_vec3 normal_of(const struct sr_texture normal[3], const struct sr_point *x)
{
    sr_vec3 n = {sr_texture_float(normal[0], x), sr_texture_float(normal[1], x), sr_texture_float(normal[2], x)};
    if (sr_dot(sr_cross(x->dpdu, x->dpdv), x->n) < 0)
        n.y = -n.y;
    return n;
}

static void turn_normal(sr_vec3 local, struct sr_point *x)
{
    if (!(sr_length2(local) > 0))
        return;
    struct sr_frame frame = sr_frame_from_zx(x->ns, x->dpdus);
    sr_vec3 ns = sr_to_world(&frame, sr_normalize(local));
    // the tangent follows: what is left of it perpendicular to the new normal (also where that is turned around)
    sr_vec3 tangent = sr_mad(x->dpdus, -sr_dot(x->dpdus, ns), ns);
    float length2 = sr_length2(tangent);
    if (length2 > 0)
        x->dpdus = sr_scale(sqrtf(sr_length2(x->dpdus) / length2), tangent);
    x->ns = sr_face_forward(ns, x->n);
}

static sr_vec3 on_tangent_plane(sr_vec3 v, sr_vec3 n)
{
    return sr_mad(v, -sr_dot(v, n), n);
}

static void bump(struct sr_texture displacement, struct sr_point *x)
{
    float du = 0.5f * (fabsf(x->dudx) + fabsf(x->dudy)), dv = 0.5f * (fabsf(x->dvdx) + fabsf(x->dvdy));
    if (!(du > 0))
        du = 0.0005f;
    if (!(dv > 0))
        dv = 0.0005f;
    sr_vec3 dpdu = on_tangent_plane(x->dpdu, x->ns), dpdv = on_tangent_plane(x->dpdv, x->ns);
    float d = sr_texture_float(displacement, x);
    struct sr_point shifted = *x;
    shifted.p = sr_mad(x->p, du, dpdu);
    shifted.uv.x = x->uv.x + du;
    float slope_u = (sr_texture_float(displacement, &shifted) - d) / du;
    shifted.p = sr_mad(x->p, dv, dpdv);
    shifted.uv = (sr_vec2){x->uv.x, x->uv.y + dv};
    float slope_v = (sr_texture_float(displacement, &shifted) - d) / dv;

    dpdu = sr_mad(sr_mad(dpdu, slope_u, x->ns), d, x->dndu);
    dpdv = sr_mad(sr_mad(dpdv, slope_v, x->ns), d, x->dndv);
    sr_vec3 normal = sr_cross(dpdu, dpdv);
    float length2 = sr_length2(normal);
    if (!(length2 > 0) || !isfinite(length2))
        return; // no area: nothing to tilt
    x->ns = sr_face_forward(sr_scale(1 / sqrtf(length2), normal), x->n);
    x->dpdus = dpdu;
}

// z = ns, x along the tangent: as sr_frame_from_zx, without its care for the last digits, which costs as much as a BSDF
static inline struct sr_frame frame_at(const struct sr_point *x)
{
    sr_vec3 z = x->ns, across = on_tangent_plane(x->dpdus, z);
    float length2 = sr_length2(across);
    if (!(length2 > 1e-10f * sr_length2(x->dpdus)) || SR_UNLIKELY(!(length2 < INFINITY))) // no tangent: plain surfaces
        return sr_frame_from_z(z);
    sr_vec3 t = sr_scale(1 / sqrtf(length2), across);
    return (struct sr_frame){
        .x = t, .y = {z.y * t.z - z.z * t.y, z.z * t.x - z.x * t.z, z.x * t.y - z.y * t.x}, .z = z};
}

bool sr_material_has_footprint(const struct sr_material *material)
{
    if (!material || !material->model)
        return false;
    if (material->displacement.model || material->normal || material->model->choose)
        return true;
    for (const struct sr_param *p = material->model->params; p && p->name; ++p) {
        struct sr_texture t = {NULL, NULL};
        if (p->kind == SR_PARAM_FLOAT_TEXTURE || p->kind == SR_PARAM_ALBEDO_TEXTURE ||
            p->kind == SR_PARAM_UNBOUNDED_TEXTURE)
            memcpy(&t, (const char *)material->self + p->offset, sizeof t);
        float number;
        struct sr_spd spectrum;
        if (t.model && !sr_texture_is_constant_float(t, &number) && !sr_texture_is_constant_spectrum(t, &spectrum))
            return true;
    }
    return false;
}

bool sr_material_is_plain(const struct sr_material *material)
{
    if (!material || !material->model)
        return true;
    if (!material->model->is_isotropic || material->normal_map.width > 0 || material->normal ||
        sr_material_has_footprint(material))
        return false;
    for (const struct sr_param *p = material->model->params; p && p->name; ++p) {
        struct sr_texture t = {NULL, NULL};
        if (p->kind == SR_PARAM_FLOAT_TEXTURE && (strstr(p->name, "uroughness") || strstr(p->name, "vroughness")))
            memcpy(&t, (const char *)material->self + p->offset, sizeof t);
        if (t.model)
            return false;
    }
    return true;
}

static const struct sr_material *chosen(const struct sr_material *material, struct sr_material_context *c)
{
    for (int depth = 0; material && material->model && material->model->choose; ++depth)
        material = depth < MIX_DEPTH ? material->model->choose(material->self, c) : NULL;
    return material;
}

bool sr_material_bssrdf(const struct sr_material *material, struct sr_point *x, sr_vec3 wo, float u, uint32_t seed,
                        struct sr_wavelengths *w, struct sr_bssrdf *out)
{
    struct sr_material_context c = {x, wo, w, u, seed};
    material = chosen(material, &c);
    return material && material->model && material->model->bssrdf && material->model->bssrdf(material->self, &c, out);
}

bool sr_material_has_bssrdf(const struct sr_material *material)
{
    if (!material || !material->model)
        return false;
    if (material->model->bssrdf)
        return true;
    for (const struct sr_param *p = material->model->params; p && p->name; ++p) {
        struct sr_slice parts;
        if (p->kind != SR_PARAM_MATERIALS)
            continue;
        memcpy(&parts, (const char *)material->self + p->offset, sizeof parts);
        for (uint32_t i = 0; i < parts.count; ++i)
            if (sr_material_has_bssrdf(((const struct sr_material *const *)parts.data)[i]))
                return true;
    }
    return false;
}

void sr_material_shade(const struct sr_material *material, struct sr_point *x, sr_vec3 wo, float u, uint32_t seed,
                       struct sr_wavelengths *w, struct sr_bsdf *out, struct sr_frame *frame)
{
    struct sr_material_context c = {x, wo, w, u, seed};
    material = chosen(material, &c);
    if (SR_UNLIKELY(!material || !material->model)) {
        out->model = NULL;
    } else {
        if (SR_UNLIKELY(material->normal_map.width > 0))
            turn_normal(normal_at(&material->normal_map, x->uv), x);
        else if (SR_UNLIKELY(material->normal != NULL))
            turn_normal(normal_of(material->normal, x), x);
        else if (SR_UNLIKELY(material->displacement.model != NULL))
            bump(material->displacement, x);
        material->model->bsdf(material->self, &c, out);
    }
    *frame = frame_at(x);
}
