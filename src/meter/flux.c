/* SPDX-License-Identifier: MIT */
/* Flux onto a shape of the scene, or through a surface that is the meter's own and that light passes as if it were not
 * there.
 *
 *     Phi = INTEGRAL over the area, INTEGRAL over the side's hemisphere of L |cos(theta)| dw dA       [lm], [W]
 *
 * "front" counts what arrives on the side of the normal (of a shape: at its outside), "back" the other, "both" the sum,
 * "net" front minus back: what goes through against the normal, of a closed surface what its inside absorbs less what
 * it emits. */
#include "meter/private.h"

enum { FRONT, BACK, BOTH, NET };

struct flux {
    struct sr_meter_common common;
    struct meter_surface_params surface;
    int32_t side;
};

static const struct sr_param params[] = {
    METER_SURFACE_ROWS(struct flux, surface),
    {SR_PARAM_ENUM, "side", "1", 0, 0, FRONT, offsetof(struct flux, side), "front|back|both|net"},
    {.name = NULL},
};

static sr_status prepare(void *self, const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error)
{
    struct flux *m = self;
    return meter_surface_prepare(&m->common, &m->surface, t, arena, error);
}

static bool place(const void *self, sr_vec2 u, struct sr_meter_place *out)
{
    const struct flux *m = self;
    struct sr_point x;
    float density = m->common.surface.draw(m->common.surface.self, u, &x);
    if (!(density > 0))
        return false;
    meter_place_on(&x, 1 / density, out);
    if (m->side == BACK || m->side == BOTH ||
        m->side == NET) // lights behind the surface count: their choice must not look at it
        out->x.ns = (sr_vec3){0, 0, 0};
    return true;
}

static float response(const void *self, sr_vec3 wi)
{
    switch (((const struct flux *)self)->side) {
    case FRONT:
        return sr_max(wi.z, 0);
    case BACK:
        return sr_max(-wi.z, 0);
    case BOTH:
        return fabsf(wi.z);
    default:
        return wi.z;
    }
}

static float pdf(const void *self, sr_vec3 wi)
{
    switch (((const struct flux *)self)->side) {
    case FRONT:
        return sr_warp_cosine_hemisphere_pdf(wi.z);
    case BACK:
        return sr_warp_cosine_hemisphere_pdf(-wi.z);
    default:
        return 0.5f * SR_INV_PI * fabsf(wi.z);
    }
}

static float sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    int32_t side = ((const struct flux *)self)->side;
    *wi = sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]});
    if (side == BACK || (side != FRONT && u[2] < 0.5f))
        wi->z = -wi->z;
    return pdf(self, *wi);
}

static double extent(const void *self)
{
    const struct flux *m = self;
    return (m->side == FRONT || m->side == BACK ? 1 : 2) * (double)SR_PI * m->common.surface.area;
}

const struct sr_meter_model meter_flux = {
    .name = "flux",
    .what = "flux",
    .law = "∫∫ L |cos θ| dω dA",
    .suffix = "",
    .kind = SR_KIND_FLUX,
    .params = params,
    .size = sizeof(struct flux),
    .wants_surface = true,
    .prepare = prepare,
    .place = place,
    .response = response,
    .sample = sample,
    .pdf = pdf,
    .extent = extent,
};
