/* SPDX-License-Identifier: MIT */
/* Draws directions in proportion to the data: a table of half vectors for each of some directions of view.
 *
 *     p(wi) = SUM over slices s of w_s [ 0.9 P_s(cell of m) / (Omega_cell 4 |wo.m|) + 0.1 |cos_theta_i| / (pi sides) ]
 *
 * in sr^-1, with m = (wo + wi) / |wo + wi|; where light passes through, wi is mirrored in the surface first, so that
 * light that goes straight on has m = n. The weights w_s interpolate between the slices next to wo, and add up to 1:
 * drawing one slice by w_s draws by p exactly. A cell's probability P_s is the share of f |cos_theta_i|, mean over
 * wavelengths, that falls into it; inside a cell m is uniform in solid angle. Cells are even in u = sqrt(2 theta_m /
 * pi) and in phi_m - phi_o (data that know an x axis: phi_m), like those of MERL. The cosine keeps p > 0 wherever f >
 * 0. */
#include "measured/private.h"

#define COSINE_SHARE 0.1f
#define LAST_THETA 1.553f // [rad] 89 deg: of the slice closest to grazing

struct view { // wo in the guide's frame, and the slices next to it
    sr_vec3 wo;
    float phi;
    int slice[4];
    float weight[4];
    int count;
    bool flipped;
};

static struct view view_of(const struct guide *g, sr_vec3 wo)
{
    struct view v = {.wo = wo, .flipped = wo.z < 0};
    int face = g->faces > 1 && v.flipped;
    v.wo.z = fabsf(wo.z);
    v.phi = wo.x != 0 || wo.y != 0 ? atan2f(wo.y, wo.x) : 0;
    float theta = atan2f(sqrtf(wo.x * wo.x + wo.y * wo.y), v.wo.z) / g->theta_step;
    int row = theta < (float)(g->thetas - 1) ? (int)theta : g->thetas - 2;
    float t = sr_clamp(theta - (float)row, 0, 1);
    int columns[2] = {0, 0};
    float s = 0;
    if (g->phis > 1) {
        float p = (v.phi + SR_PI) / g->phi_step;
        int column = (int)p;
        s = p - (float)column;
        columns[0] = column % g->phis;
        columns[1] = (column + 1) % g->phis;
    }
    for (int k = 0; k < (g->phis > 1 ? 4 : 2); ++k) {
        float w = (k & 1 ? t : 1 - t) * (g->phis > 1 ? (k & 2 ? s : 1 - s) : 1);
        if (w > 0) {
            v.slice[v.count] = (face * g->thetas + row + (k & 1)) * g->phis + columns[k >> 1];
            v.weight[v.count++] = w;
        }
    }
    return v;
}

static int side_count(const struct guide *g)
{
    return g->sides == (SR_MEASURED_REFLECTION | SR_MEASURED_TRANSMISSION) ? 2 : 1;
}
/* the block of rows of a table that belongs to a side; -1: none */
static int side_block(const struct guide *g, bool transmitted)
{
    if (transmitted)
        return g->sides & SR_MEASURED_TRANSMISSION ? side_count(g) - 1 : -1;
    return g->sides & SR_MEASURED_REFLECTION ? 0 : -1;
}

float sr_measured_pdf(const struct sr_measured *m, sr_vec3 wo, sr_vec3 wi)
{
    if (m->pdf) {
        if (!m->has_back && wo.z < 0) {
            wo.z = -wo.z;
            wi.z = -wi.z;
        }
        return wo.z != 0 && wi.z != 0 ? m->pdf(m->data, wo, wi) : 0;
    }
    const struct guide *g = &m->guide;
    int block = side_block(g, wo.z * wi.z < 0);
    if (wo.z == 0 || wi.z == 0 || block < 0)
        return 0;
    struct view v = view_of(g, wo);
    wi.z = fabsf(wi.z);
    sr_vec3 h = sr_add(v.wo, wi);
    float length2 = sr_length2(h);
    if (!(length2 > 0))
        return 0;
    h = sr_scale(1 / sqrtf(length2), h);
    float u = sqrtf(atan2f(sqrtf(h.x * h.x + h.y * h.y), h.z) * (2 / SR_PI));
    float turn = h.x != 0 || h.y != 0 ? atan2f(h.y, h.x) : 0;
    turn = (turn - (g->phis > 1 ? 0 : v.phi)) * (0.5f * SR_INV_PI);
    turn -= floorf(turn);
    int row = (int)(sr_min(u, SR_ONE_MINUS_EPSILON) * (float)g->nu);
    int column = (int)(sr_min(turn, SR_ONE_MINUS_EPSILON) * (float)g->nv);
    int rows = g->nu * side_count(g);
    sr_vec2 cell = {((float)column + 0.5f) / (float)g->nv, ((float)(row + block * g->nu) + 0.5f) / (float)rows};
    float density = 0;
    for (int k = 0; k < v.count; ++k)
        density += v.weight[k] * sr_piecewise2_pdf(&g->slices[v.slice[k]], cell);
    density *= (1 - COSINE_SHARE) / ((float)(rows * g->nv) * g->omega[row] * 4 * sr_dot(v.wo, h));
    return density + COSINE_SHARE * SR_INV_PI * wi.z / (float)side_count(g);
}

bool sr_measured_sample(const struct sr_measured *m, sr_vec3 wo, float u_lobe, sr_vec2 u, sr_vec3 *wi, float *pdf)
{
    const struct guide *g = &m->guide;
    if (wo.z == 0)
        return false;
    if (m->sample) {
        bool flips = !m->has_back && wo.z < 0;
        bool drawn = m->sample(m->data, (sr_vec3){wo.x, wo.y, flips ? -wo.z : wo.z}, u_lobe, u, wi);
        if (drawn && flips)
            wi->z = -wi->z;
        *pdf = drawn ? sr_measured_pdf(m, wo, *wi) : 0;
        return *pdf > 0 && isfinite(*pdf);
    }
    struct view v = view_of(g, wo);
    bool transmitted;
    if (u_lobe < COSINE_SHARE) {
        transmitted = side_count(g) > 1 ? u_lobe >= COSINE_SHARE / 2 : !(g->sides & SR_MEASURED_REFLECTION);
        *wi = sr_warp_cosine_hemisphere(u);
    } else {
        u_lobe = (u_lobe - COSINE_SHARE) / (1 - COSINE_SHARE);
        int k = 0;
        for (; k < v.count - 1 && u_lobe >= v.weight[k]; ++k)
            u_lobe -= v.weight[k];
        float unused;
        sr_vec2 p = sr_piecewise2_sample(&g->slices[v.slice[k]], u, &unused);
        int rows = g->nu * side_count(g);
        float y = sr_min(p.y, SR_ONE_MINUS_EPSILON) * (float)rows;
        int row = (int)y;
        float share = y - (float)row;
        transmitted = side_block(g, true) >= 0 && row >= g->nu * side_block(g, true);
        row %= g->nu;
        // uniform in cos_theta between the edges, which are told as 1 - cos_theta = 2 sin^2(theta / 2)
        float a = (float)row / (float)g->nu, b = (float)(row + 1) / (float)g->nu;
        float lo = sinf(SR_PI / 4 * a * a), hi = sinf(SR_PI / 4 * b * b);
        float below = 2 * (lo * lo + share * (hi - lo) * (hi + lo));
        float phi = 2 * SR_PI * p.x + (g->phis > 1 ? 0 : v.phi);
        sr_vec3 h = sr_spherical_direction(sr_safe_sqrt(below * (2 - below)), 1 - below, phi);
        float cos_d = sr_dot(v.wo, h);
        *wi = sr_normalize(sr_sub(sr_scale(2 * cos_d, h), v.wo));
        if (!(cos_d > 0 && wi->z > 0))
            return false;
    }
    if (v.flipped != transmitted)
        wi->z = -wi->z;
    *pdf = sr_measured_pdf(m, wo, *wi);
    return *pdf > 0 && isfinite(*pdf) && wi->z != 0;
}

static sr_spectrum overview(void) // wavelengths [nm] by whose mean directions are drawn
{
    sr_spectrum lambda;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        lambda[i] = 430 + 250 * (float)i / (SR_LAMBDA_COUNT - 1);
    return lambda;
}

/* Masses of the cells of one slice, by 2 x 2 points a cell. */
static bool slice_build(const struct sr_measured *m, sr_vec3 wo, struct sr_arena *arena, float *mass,
                        struct sr_piecewise2 *slice)
{
    const struct guide *g = &m->guide;
    float phi_o = g->phis > 1 || (wo.x == 0 && wo.y == 0) ? 0 : atan2f(wo.y, wo.x);
    sr_vec3 up = {wo.x, wo.y, fabsf(wo.z)};
    for (int side = 0; side < 2; ++side) {
        int block = side_block(g, side == 1);
        if (block < 0)
            continue;
        for (int i = 0; i < g->nu; ++i)
            for (int j = 0; j < g->nv; ++j) {
                float sum = 0;
                for (int k = 0; k < 4; ++k) {
                    float u = ((float)i + 0.25f + 0.5f * (float)(k & 1)) / (float)g->nu;
                    float theta = SR_PI / 2 * u * u;
                    float phi = phi_o + 2 * SR_PI * ((float)j + 0.25f + 0.5f * (float)(k >> 1)) / (float)g->nv;
                    sr_vec3 h = sr_spherical_direction(sinf(theta), cosf(theta), phi);
                    float cos_d = sr_dot(up, h);
                    sr_vec3 wi = sr_sub(sr_scale(2 * cos_d, h), up);
                    if (!(cos_d > 0 && wi.z > 0))
                        continue;
                    float cos_i = wi.z;
                    if ((wo.z < 0) != (side == 1))
                        wi.z = -wi.z;
                    float f = sr_spectrum_mean(sr_measured_f(m, wo, wi, overview()));
                    sum += f * cos_i * 4 * cos_d;
                }
                mass[(size_t)(block * g->nu + i) * (size_t)g->nv + (size_t)j] = sum * g->omega[i];
            }
    }
    return sr_piecewise2_build(arena, mass, (uint32_t)g->nv, (uint32_t)(g->nu * side_count(g)), slice);
}

sr_status guide_build(struct sr_measured *m, struct sr_arena *arena)
{
    struct guide *g = &m->guide;
    if (m->pdf)
        return SR_OK;
    *g = (struct guide){.faces = m->has_back ? 2 : 1,
                        .thetas = m->is_isotropic ? 16 : 9,
                        .phis = m->is_isotropic ? 1 : 12,
                        .nu = m->is_isotropic ? 32 : 20,
                        .nv = m->is_isotropic ? 32 : 24,
                        .sides = m->sides | m->back_sides};
    g->theta_step = LAST_THETA / (float)(g->thetas - 1);
    g->phi_step = 2 * SR_PI / (float)g->phis;
    int count = g->faces * g->thetas * g->phis;
    g->omega = sr_arena_alloc(arena, (size_t)g->nu * sizeof(float));
    g->slices = sr_arena_alloc(arena, (size_t)count * sizeof *g->slices);
    float *mass = sr_alloc((size_t)(2 * g->nu * g->nv) * sizeof(float));
    bool ok = g->omega && g->slices && mass;
    for (int i = 0; ok && i < g->nu; ++i) {
        double a = PI / 2 * i * i / (g->nu * g->nu), b = PI / 2 * (i + 1) * (i + 1) / (g->nu * g->nu);
        g->omega[i] = (float)(2 * PI / g->nv * 2 * sin((a + b) / 2) * sin((b - a) / 2));
    }
    for (int k = 0; ok && k < count; ++k) {
        int phi_index = k % g->phis, theta_index = k / g->phis % g->thetas, face = k / g->phis / g->thetas;
        float theta = (float)theta_index * g->theta_step,
              phi = g->phis > 1 ? (float)phi_index * g->phi_step - SR_PI : 0;
        sr_vec3 wo = sr_spherical_direction(sinf(theta), cosf(theta), phi);
        wo.z = face ? -wo.z : wo.z;
        ok = slice_build(m, wo, arena, mass, &g->slices[k]);
    }
    sr_free(mass);
    return ok ? SR_OK : SR_ERROR_RESOURCE;
}
