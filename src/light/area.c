/* SPDX-License-Identifier: MIT */
/* A surface that glows evenly in all directions.
 *
 *     L(x, w) = L         on the outside, or on both sides            Phi = pi A L        [lm] a side
 *
 * L is scaled to the luminance `scale` [cd/m^2], or so that the whole shape gives off scale * power. With an image the
 * radiance is rgb(u, 1-v) of the image, bilinear between texel centres, times the white of its colour space; its mean
 * over (u, v) is taken as the mean over the surface. J. H. Lambert, Photometria, 1760. Of patches whose (u, v) are
 * their own, one half of the points is drawn in proportion to the image, as M. Pharr, W. Jakob and G. Humphreys draw
 * all of them (Physically Based Rendering, 4th ed. 2023, section 6.6), the other by solid angle or area. Limits: power
 * is exact for an image only where (u, v) maps area evenly. */
#include "light/emission.h"

const struct sr_param sr_light_emission_params[] = {
    {SR_PARAM_ILLUMINANT, "L", "cd/m^2", 0, INFINITY, NAN, offsetof(struct sr_light_emission, L),
     "radiance; only its shape counts, rgb its brightness, too"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct sr_light_emission, scale), "factor"},
    {SR_PARAM_BOOL, "twosided", "1", 0, 1, 0, offsetof(struct sr_light_emission, two_sided), "both sides glow"},
    {SR_PARAM_FLOAT, "power", "lm", -INFINITY, INFINITY, NAN, offsetof(struct sr_light_emission, power),
     "luminous flux of the whole shape, if above 0"},
    {SR_PARAM_FILE, "filename", "1", 0, 0, 0, offsetof(struct sr_light_emission, filename),
     "image over the surface instead of L"},
    {.name = NULL},
};

/* What a cell between texel centres shines by bilinear interpolation: the tent's mean, nowhere 0 where there is light.
 */
static float blurred(const struct sr_texels *t, uint32_t x, uint32_t y)
{
    static const float w[3] = {0.125f, 0.75f, 0.125f};
    float sum = 0;
    for (uint32_t j = 0; j < 3; ++j)
        for (uint32_t i = 0; i < 3; ++i) {
            uint32_t xx = x + i < 1              ? 0
                          : x + i - 1 < t->width ? x + i - 1
                                                 : t->width - 1,
                     yy = y + j < 1               ? 0
                          : y + j - 1 < t->height ? y + j - 1
                                                  : t->height - 1;
            struct sr_rgb c = sr_light_texel(t, xx, yy);
            sum += w[i] * w[j] * (c.r + c.g + c.b);
        }
    return sum;
}

static sr_status build_picture(struct sr_light_emission *e, struct sr_arena *arena, struct sr_error *error)
{
    const struct sr_texels *t = &e->texels;
    size_t n = (size_t)t->width * t->height;
    float *f = sr_alloc(n * sizeof *f);
    double sum = 0, most = 0;
    for (size_t i = 0; f && i < n; ++i) {
        f[i] = blurred(t, (uint32_t)(i % t->width), (uint32_t)(i / t->width));
        sum += (double)f[i];
        most = fmax(most, (double)f[i]);
    }
    bool is_built = f != NULL;
    if (most > 1.1 * sum / (double)n) { // else drawing by solid angle alone is better
        struct sr_piecewise2 *d = sr_arena_alloc(arena, sizeof *d);
        is_built = is_built && d && sr_piecewise2_build(arena, f, t->width, t->height, d);
        e->picture = d;
    }
    sr_free(f);
    return is_built ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "no memory for the density of %s", e->filename);
}

sr_status sr_light_emission_prepare(struct sr_light_emission *e, float total_area, struct sr_arena *arena,
                                    struct sr_error *error)
{
    bool has_image = e->texels.width > 0;
    double mean = 1; // luminance over that of white
    if (has_image) {
        if (e->L.kind != SR_SPD_NONE)
            return sr_fail(error, SR_ERROR_INPUT, "an area light takes \"L\" or \"filename\" (%s), not both",
                           e->filename);
        if (sr_light_check_texels(&e->texels, e->filename, error))
            return error->status;
        mean = sr_light_mean_luminance(&e->texels);
        if (build_picture(e, arena, error))
            return error->status;
    }
    double luminance = (double)e->scale, share = 0;
    if (e->power > 0) {
        double flux = (double)SR_PI * (double)total_area * mean * (e->two_sided ? 2 : 1);
        if (!(flux > 0))
            return sr_fail(error, SR_ERROR_INPUT,
                           "an area light with \"power\" needs an area and an image that is not black");
        share = (double)e->power / flux;
        luminance *= share;
    }
    e->emitted = e->L;
    enum sr_colour_space_id space = has_image ? e->texels.space : e->space;
    if (sr_light_set_brightness(&e->emitted, space, e->is_absolute, e->scale, (float)share, error))
        return error->status;
    if (has_image) {
        e->derived_scale = (float)(luminance / sr_colour_space(space)->illuminant_luminous_integral);
        e->luminance = (float)(luminance * mean);
        e->choice_luminance = e->luminance;
    } else {
        e->derived_scale = e->L.scale != 0 ? e->emitted.scale / e->L.scale : e->emitted.scale;
        e->luminance = (float)sr_spd_luminous_integral(&e->emitted);
        e->choice_luminance = sr_light_choice_weight(&e->emitted);
    }
    return SR_OK;
}

static sr_spectrum image_radiance(const struct sr_light_emission *e, sr_vec2 uv, const struct sr_wavelengths *w)
{
    const struct sr_texels *t = &e->texels;
    float x = sr_clamp(uv.x * (float)t->width - 0.5f, 0, (float)(t->width - 1));
    float y = sr_clamp((1 - uv.y) * (float)t->height - 0.5f, 0, (float)(t->height - 1));
    uint32_t x0 = (uint32_t)x, y0 = (uint32_t)y;
    uint32_t x1 = x0 + 1 < t->width ? x0 + 1 : x0, y1 = y0 + 1 < t->height ? y0 + 1 : y0;
    float fx = x - (float)x0, fy = y - (float)y0;
    struct sr_rgb a = sr_light_texel(t, x0, y0), b = sr_light_texel(t, x1, y0), c = sr_light_texel(t, x0, y1),
                  d = sr_light_texel(t, x1, y1);
    struct sr_rgb rgb = {sr_lerp(fy, sr_lerp(fx, a.r, b.r), sr_lerp(fx, c.r, d.r)),
                         sr_lerp(fy, sr_lerp(fx, a.g, b.g), sr_lerp(fx, c.g, d.g)),
                         sr_lerp(fy, sr_lerp(fx, a.b, b.b), sr_lerp(fx, c.b, d.b))};
    if (rgb.r + rgb.g + rgb.b <= 0)
        return SR_BLACK;
    struct sr_spd s = sr_spd_from_rgb_illuminant(t->space, rgb);
    return sr_spd_along(&s, w) * e->derived_scale;
}

static sr_spectrum radiance(const struct sr_light_emission *e, sr_vec3 n, sr_vec2 uv, sr_vec3 w,
                            const struct sr_wavelengths *wavelengths)
{
    if (!e->two_sided && sr_dot(n, w) <= 0)
        return SR_BLACK;
    return e->texels.width ? image_radiance(e, uv, wavelengths) : sr_spd_along(&e->emitted, wavelengths);
}

static sr_spectrum Le(const void *self, const struct sr_point *there, sr_vec3 w,
                      const struct sr_wavelengths *wavelengths)
{
    return radiance(((const struct sr_light_area *)self)->emission, there->n, there->uv, w, wavelengths);
}

static void prepare_flat(struct sr_light_area *m)
{
    const struct sr_shape_flat *a = &m->flat;
    sr_vec3 across = sr_sub(a->f, a->e), diagonal = sr_add(a->e, a->f);
    sr_vec3 largest = {fabsf(a->corner.x) + fabsf(a->e.x) + fabsf(a->f.x),
                       fabsf(a->corner.y) + fabsf(a->e.y) + fabsf(a->f.y),
                       fabsf(a->corner.z) + fabsf(a->e.z) + fabsf(a->f.z)};
    float extent = sqrtf(
        sr_max(sr_length2(across), a->is_triangle ? sr_max(sr_length2(a->e), sr_length2(a->f)) : sr_length2(diagonal)));
    m->kind = SR_LIGHT_FLAT;
    m->centre = sr_mad(a->corner, a->is_triangle ? 1.0f / 3 : 0.5f, diagonal);
    m->far2 = sr_sqr(1.5f * extent);
    m->inverse_area = 1 / m->area;
    // corner + u e + v f is rounded as often as gamma(8) allows, and once more where it is moved off
    m->off =
        10 * SR_MACHINE_EPSILON * (fabsf(a->n.x) * largest.x + fabsf(a->n.y) * largest.y + fabsf(a->n.z) * largest.z) +
        2 * SR_MACHINE_EPSILON * sr_max_component(largest) + 1e-37f;
}

static void prepare_round(struct sr_light_area *m)
{
    sr_vec3 c = m->round.centre;
    float radius = m->round.radius, largest = sr_max(fabsf(c.x), sr_max(fabsf(c.y), fabsf(c.z))) + radius;
    m->kind = SR_LIGHT_ROUND;
    m->centre = c;
    m->off = 12 * SR_MACHINE_EPSILON * largest + 4e-7f * radius;
    m->far2 = sr_sqr(1.001f * radius + 4 * m->off); // not at the surface itself
}

struct sr_light_area sr_light_area_of(struct sr_shape shape, uint32_t primitive,
                                      const struct sr_light_emission *emission, bool is_ghost)
{
    struct sr_light_area m = {.shape = shape,
                              .primitive = primitive,
                              .emission = emission,
                              .is_ghost = is_ghost,
                              .area = shape.model->area(shape.self, primitive)};
    bool has_own_uv =
        shape.model == &sr_shape_bilinearmesh && ((const struct sr_shape_patches *)shape.self)->uv.count == 0;
    if (emission->picture && has_own_uv && m.area > 0) {
        m.kind = SR_LIGHT_PICTURE;
        m.far2 = INFINITY;
    }
    if (emission->texels.width || !(m.area > 0)) // images want (u, v)
        return m;
    if (shape.model->flat && shape.model->flat(shape.self, primitive, &m.flat))
        prepare_flat(&m);
    else if (shape.model->round && shape.model->round(shape.self, primitive, &m.round))
        prepare_round(&m);
    return m;
}

// by area: pdf = r^2 / (A |cos theta|)
static inline bool sample_flat(const struct sr_light_area *m, sr_vec3 from, sr_vec2 u, const struct sr_wavelengths *w,
                               struct sr_light_sample *s)
{
    const struct sr_shape_flat *a = &m->flat;
    if (a->is_triangle)
        u = sr_warp_triangle(u);
    sr_vec3 p = sr_mad(sr_mad(a->corner, u.x, a->e), u.y, a->f), d = sr_sub(p, from);
    float height = sr_dot(a->n, d), r2 = sr_length2(d); // below the surface [m]
    if (height >= 0 && !m->emission->two_sided)         // seen from behind: no spectrum is needed to know
        return false;
    float r = sqrtf(r2);
    if (!(fabsf(height) > 1e-7f * r))
        return false;
    s->L = sr_spd_along(&m->emission->emitted, w);
    s->wi = sr_scale(1 / r, d);
    s->distance = r;
    s->p = sr_mad(p, height < 0 ? m->off : -m->off, a->n);
    s->n = a->n;
    s->pdf = r2 * r * m->inverse_area / fabsf(height);
    s->is_delta = m->is_ghost;
    return s->pdf < INFINITY;
}

// 1 - cos of the half angle under which a sphere is seen from the squared distance d2
static inline float cone(float radius, float d2)
{
    float s2 = radius * radius / d2;
    return s2 / (1 + sr_safe_sqrt(1 - s2));
}

/* By solid angle within the cone of the sphere: pdf = 1 / (2 pi (1 - cos theta_max)). theta: at the receiver, from the
 * axis; beta: on the sphere, between ray and radius; alpha = beta - theta: at the centre, where the point is seen. */
static inline bool sample_round(const struct sr_light_area *m, sr_vec3 from, sr_vec2 u, const struct sr_wavelengths *w,
                                struct sr_light_sample *s)
{
    if (m->round.side < 0 && !m->emission->two_sided)
        return false;
    sr_vec3 to = sr_sub(m->centre, from);
    float d2 = sr_length2(to), rest = cone(m->round.radius, d2), x = u.x * rest;
    float cos_theta = 1 - x, sin_theta = sqrtf(x * (2 - x));
    float sin2_beta = sr_min(1, u.x * (2 - x) / (2 - rest)), sin_beta = sqrtf(sin2_beta),
          cos_beta = sqrtf(1 - sin2_beta);
    float sin_alpha = sin_beta * cos_theta - cos_beta * sin_theta,
          cos_alpha = cos_beta * cos_theta + sin_beta * sin_theta;
    float sin_phi, cos_phi;
    sr_sin_cos_turn(u.y, &sin_phi, &cos_phi);
    struct sr_frame f = sr_frame_from_z(sr_scale(1 / sqrtf(d2), to));
    sr_vec3 n = sr_to_world(&f, (sr_vec3){sin_alpha * cos_phi, sin_alpha * sin_phi, -cos_alpha});
    sr_vec3 p = sr_mad(m->centre, m->round.radius + m->off, n), d = sr_sub(p, from);
    s->distance = sr_length(d);
    s->wi = sr_scale(1 / s->distance, d);
    s->p = p;
    s->n = sr_scale(m->round.side, n);
    s->L = sr_spd_along(&m->emission->emitted, w);
    s->pdf = SR_INV_PI * 0.5f / rest;
    s->is_delta = m->is_ghost;
    return s->pdf < INFINITY && s->distance > 0;
}

static inline bool is_far(const struct sr_light_area *m, sr_vec3 from)
{
    return m->kind != SR_LIGHT_ANY && sr_length2(sr_sub(m->centre, from)) > m->far2;
}

/* Density [1/sr] of drawing the patch's point (u, v) by the image: p(u, v) / |dp/du x dp/dv| by area. */
static float picture_pdf(const struct sr_light_area *m, sr_vec3 from, sr_vec2 uv, struct sr_point *x)
{
    m->shape.model->point(m->shape.self, m->primitive, uv, x);
    sr_vec3 d = sr_sub(x->p, from);
    float jacobian = sr_length(sr_cross(x->dpdu, x->dpdv)), r2 = sr_length2(d), height = fabsf(sr_dot(x->n, d));
    float pdf =
        sr_piecewise2_pdf(m->emission->picture, (sr_vec2){uv.x, 1 - uv.y}) * r2 * sqrtf(r2) / (jacobian * height);
    return pdf < INFINITY ? pdf : 0;
}

/* One half of the points by the image, the other as without it; the density is the mean of both. */
static bool draw_point(const struct sr_light_area *m, const struct sr_point *reference, sr_vec2 u,
                       struct sr_shape_sample *s)
{
    const struct sr_shape_model *shape = m->shape.model;
    if (m->kind != SR_LIGHT_PICTURE)
        return shape->sample(m->shape.self, m->primitive, reference, u, s);
    struct sr_point x;
    if (u.x >= 0.5f) {
        u.x = sr_min(2 * u.x - 1, SR_ONE_MINUS_EPSILON);
        if (!shape->sample(m->shape.self, m->primitive, reference, u, s))
            return false;
        s->pdf = 0.5f * (s->pdf + picture_pdf(m, reference->p, s->uv, &x));
        return true;
    }
    u.x = sr_min(2 * u.x, SR_ONE_MINUS_EPSILON);
    float ignored;
    sr_vec2 at = sr_piecewise2_sample(m->emission->picture, u, &ignored), uv = {at.x, 1 - at.y};
    float pdf = picture_pdf(m, reference->p, uv, &x);
    if (!(pdf > 0))
        return false;
    sr_vec3 wi = sr_normalize(sr_sub(x.p, reference->p));
    *s = (struct sr_shape_sample){.p = x.p,
                                  .p_error = x.p_error,
                                  .n = x.n,
                                  .uv = uv,
                                  .pdf = 0.5f * (pdf + shape->pdf(m->shape.self, m->primitive, reference, wi, &x))};
    return true;
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    const struct sr_light_area *m = self;
    if (m->kind == SR_LIGHT_FLAT && !m->emission->two_sided &&
        sr_dot(m->flat.n, sr_sub(reference->p, m->flat.corner)) <= 0)
        return false; // all of it is seen from behind: no point need be drawn to know
    if (is_far(m, reference->p))
        return m->kind == SR_LIGHT_FLAT ? sample_flat(m, reference->p, u, w, s)
                                        : sample_round(m, reference->p, u, w, s);
    struct sr_shape_sample x;
    if (!draw_point(m, reference, u, &x) || !(x.pdf > 0) || isinf(x.pdf))
        return false;
    sr_vec3 d = sr_sub(x.p, reference->p);
    float r = sr_length(d);
    if (!(r > 0))
        return false;
    sr_vec3 wi = sr_scale(1 / r, d);
    if (!m->emission->two_sided && sr_dot(x.n, wi) >= 0)
        return false;
    struct sr_point there = {.p = x.p, .p_error = x.p_error, .n = x.n};
    *s = (struct sr_light_sample){.L = radiance(m->emission, x.n, x.uv, sr_neg(wi), w),
                                  .wi = wi,
                                  .distance = r,
                                  .p = sr_point_offset(&there, sr_neg(wi)),
                                  .n = x.n,
                                  .pdf = x.pdf,
                                  .is_delta = m->is_ghost};
    return !sr_spectrum_is_black(s->L);
}

static float pdf(const void *self, const struct sr_point *reference, sr_vec3 wi, const struct sr_point *there)
{
    const struct sr_light_area *m = self;
    if (m->is_ghost)
        return 0;
    if (!is_far(m, reference->p)) {
        float by_shape = m->shape.model->pdf(m->shape.self, m->primitive, reference, wi, there);
        struct sr_point x;
        return m->kind == SR_LIGHT_PICTURE ? 0.5f * (by_shape + picture_pdf(m, reference->p, there->uv, &x)) : by_shape;
    }
    if (m->kind == SR_LIGHT_ROUND)
        return SR_INV_PI * 0.5f / cone(m->round.radius, sr_length2(sr_sub(m->centre, reference->p)));
    sr_vec3 d = sr_sub(there->p, reference->p);
    float height = fabsf(sr_dot(m->flat.n, d)), r2 = sr_length2(d), r = sqrtf(r2);
    return height > 1e-7f * r ? r2 * r * m->inverse_area / height : 0;
}

// by area and cosine
static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    const struct sr_light_area *m = self;
    struct sr_shape_sample x;
    if (!m->shape.model->sample(m->shape.self, m->primitive, NULL, u_place, &x) || !(x.pdf > 0) || isinf(x.pdf))
        return false;
    bool is_two_sided = m->emission->two_sided, is_inside = is_two_sided && u_direction.x >= 0.5f;
    if (is_two_sided)
        u_direction.x = sr_min(is_inside ? 2 * u_direction.x - 1 : 2 * u_direction.x, SR_ONE_MINUS_EPSILON);
    sr_vec3 local = sr_warp_cosine_hemisphere(u_direction);
    struct sr_frame frame = sr_frame_from_z(is_inside ? sr_neg(x.n) : x.n);
    *ray = (struct sr_light_ray){.from = {.p = x.p, .p_error = x.p_error, .n = x.n, .ns = x.n, .uv = x.uv},
                                 .w = sr_to_world(&frame, local),
                                 .pdf_area = x.pdf,
                                 .pdf_direction = local.z * SR_INV_PI * (is_two_sided ? 0.5f : 1)};
    ray->L = radiance(m->emission, x.n, x.uv, ray->w, w);
    return ray->pdf_direction > 0 && !sr_spectrum_is_black(ray->L);
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    const struct sr_light_area *m = self;
    float cos_theta = sr_dot(n, w);
    *pdf_area = m->area > 0 ? 1 / m->area : 0;
    *pdf_direction = m->emission->two_sided ? fabsf(cos_theta) * (0.5f * SR_INV_PI) : sr_max(cos_theta, 0) * SR_INV_PI;
}

static float power(const void *self)
{
    const struct sr_light_area *m = self;
    return SR_PI * m->area * m->emission->luminance * (m->emission->two_sided ? 2 : 1);
}

static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct sr_light_area *m = self;
    *b = (struct sr_light_bounds){.box = m->shape.model->bounds(m->shape.self, m->primitive),
                                  .cos_theta_e = 0,
                                  .two_sided = m->emission->two_sided,
                                  .power = SR_PI * m->area * m->emission->choice_luminance *
                                           (m->emission->two_sided ? 2 : 1)};
    m->shape.model->normals(m->shape.self, m->primitive, &b->axis, &b->cos_theta_o);
    return true;
}

const struct sr_light_model sr_light_area = {
    .name = "diffuse",
    .params = sr_light_emission_params,
    .size = sizeof(struct sr_light_area),
    .sample = sample,
    .pdf = pdf,
    .Le = Le,
    .bounds = bounds,
    .emit = emit,
    .emit_pdf = emit_pdf,
    .power = power,
};
