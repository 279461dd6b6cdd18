/* SPDX-License-Identifier: MIT */
/* A projector: a point that throws an image along +z.
 *
 *     (u, v) = place in the image of w / w.z,      I(w) = rgb(u, v) * white * scale          [cd]
 *     Phi    = SUM over texels I_i Omega_i         [lm]; Omega [sr] of a rectangle at z = 1 is the sum, with signs,
 *                                                  of atan(x y / sqrt(1 + x^2 + y^2)) at its corners
 *     p(w)   = p(u, v) / (A cos^3 theta)           A = 4 tan^2(fov / 2) * longer side / shorter  [m^2 at 1 m]
 *
 * fov is that of the shorter side; the first row of texels is on the side of +y, the first column on that of -x, as
 * pbrt-v4. The image is looked up without interpolation. With `power` Phi = scale * power. The texels are intensities:
 * a white image makes an even sphere about the point, not an even wall. Limits: a point, everything is in focus. */
#include "light/pixels.h"

struct projection {
    struct sr_light_common common;
    float scale, power, fov; // [1] [lm] [deg]
    const char *filename;
    // derived
    sr_vec3 p;    // [m]
    sr_vec3 axis; // [1]
    sr_vec2 half; // [m] of the image's sides at 1 m
    struct sr_light_turn turn;
    struct sr_light_pixels pixels;
    struct sr_piecewise2 density; // over the image, in proportion to what leaves
    float cos_reach;              // of the corner farthest from the axis
    float flux, choice;           // [lm] [cd]
    bool is_black;
};

static const struct sr_param params[] = {
    {SR_PARAM_FILE, "filename", "1", 0, 0, 0, offsetof(struct projection, filename), "the image"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct projection, scale),
     "luminous intensity of white [cd], or factor of power"},
    {SR_PARAM_FLOAT, "power", "lm", -INFINITY, INFINITY, NAN, offsetof(struct projection, power),
     "luminous flux of the whole light, if above 0"},
    {SR_PARAM_FLOAT, "fov", "deg", 0, 180, 90, offsetof(struct projection, fov),
     "angle across the image's shorter side"},
    {.name = NULL},
};

// from the axis to the point (x, y) of the plane at 1 m [sr]
static double quarter(double x, double y)
{
    return atan(x * y / sqrt(1 + x * x + y * y));
}

static double texel_solid_angle(const struct projection *m, uint32_t i, uint32_t j)
{
    const struct sr_texels *t = &m->common.texels;
    double x0 = (2.0 * i / t->width - 1) * (double)m->half.x, x1 = (2.0 * (i + 1) / t->width - 1) * (double)m->half.x;
    double y0 = (2.0 * j / t->height - 1) * (double)m->half.y, y1 = (2.0 * (j + 1) / t->height - 1) * (double)m->half.y;
    return quarter(x1, y1) - quarter(x0, y1) - quarter(x1, y0) + quarter(x0, y0);
}

static sr_status build_density(struct projection *m, double *flux, float *grey, struct sr_arena *arena,
                               struct sr_error *error)
{
    const struct sr_texels *t = &m->common.texels;
    size_t n = (size_t)t->width * t->height;
    float *f = sr_alloc(n * sizeof *f);
    double sum = 0, sum_grey = 0;
    for (size_t i = 0; f && i < n; ++i) {
        uint32_t x = (uint32_t)(i % t->width), y = (uint32_t)(i / t->width);
        double angle = texel_solid_angle(m, x, y);
        sum += angle * sr_light_texel_luminance(t, x, y);
        sum_grey += (double)sr_light_grey(t, x, y) / (double)n;
        f[i] = (float)angle * (float)n * sr_light_grey(t, x, y);
    }
    bool is_built = f && sr_piecewise2_build(arena, f, t->width, t->height, &m->density);
    sr_free(f);
    *flux = sum;
    *grey = (float)sum_grey;
    m->is_black = !(sum_grey > 0);
    return is_built ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "no memory for the density of %s", m->filename);
}

static sr_status set_place(struct projection *m, struct sr_error *error)
{
    const struct sr_transform *t = &m->common.light_to_world;
    const struct sr_texels *texels = &m->common.texels;
    float aspect = (float)texels->width / (float)texels->height, tangent = tanf(sr_radians(m->fov) / 2);
    m->half = aspect > 1 ? (sr_vec2){tangent * aspect, tangent} : (sr_vec2){tangent, tangent / aspect};
    m->turn = sr_light_turn_of(t);
    m->p = sr_transform_point(t, (sr_vec3){0, 0, 0});
    m->axis = sr_normalize(sr_transform_vector(t, (sr_vec3){0, 0, 1}));
    if (!sr_is_finite(m->p) || !sr_is_finite(m->axis))
        return sr_fail(error, SR_ERROR_INPUT, "the place of a projection light is not finite");
    m->cos_reach = 1;
    for (int i = 0; i < 4; ++i) {
        sr_vec3 corner = sr_light_turned_back(
            &m->turn, (sr_vec3){i & 1 ? m->half.x : -m->half.x, i & 2 ? m->half.y : -m->half.y, 1});
        m->cos_reach = sr_min(m->cos_reach, sr_dot(corner, m->axis) - 1e-4f);
    }
    return SR_OK;
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct projection *m = self;
    const struct sr_texels *t = &m->common.texels;
    double flux;
    float grey;
    if (!m->filename || !t->width)
        return sr_fail(error, SR_ERROR_INPUT, "a projection light needs the parameter \"filename\"");
    if (!(m->fov > 0 && m->fov < 180))
        return sr_fail(error, SR_ERROR_INPUT, "\"fov\" of a projection light must be above 0 and below 180, not %g",
                       (double)m->fov);
    if (sr_light_check_texels(t, m->filename, error) != SR_OK || set_place(m, error) != SR_OK ||
        build_density(m, &flux, &grey, arena, error) != SR_OK)
        return error->status;
    if (m->power > 0 && !(flux > 0))
        return sr_fail(error, SR_ERROR_INPUT, "%s: is black, so that it cannot be scaled to a power", m->filename);
    double intensity = (double)m->scale * (m->power > 0 ? (double)m->power / flux : 1); // of white [cd]
    m->flux = (float)(intensity * flux);
    m->choice = (float)intensity * grey;
    if (!isfinite(m->flux) || !isfinite(m->choice))
        return sr_fail(error, SR_ERROR_INPUT, "%s: the emission is not finite", m->filename);
    return sr_light_pixels_build(&m->pixels, t,
                                 (float)(intensity / sr_colour_space(t->space)->illuminant_luminous_integral),
                                 m->filename, arena, error);
}

/* Where the image is met by light that leaves toward w; false: beside it. *jacobian: area of the unit square of (u, v)
 * over solid angle of the world. */
static bool place_in_image(const struct projection *m, sr_vec3 w, sr_vec2 *uv, float *jacobian)
{
    sr_vec3 d = sr_light_turned(&m->turn, w, jacobian);
    if (!(d.z > 1e-6f))
        return false;
    *uv = (sr_vec2){0.5f + 0.5f * d.x / (d.z * m->half.x), 0.5f - 0.5f * d.y / (d.z * m->half.y)};
    *jacobian *= 1 / (4 * m->half.x * m->half.y * d.z * d.z * d.z);
    return uv->x >= 0 && uv->x <= 1 && uv->y >= 0 && uv->y <= 1;
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    (void)u;
    const struct projection *m = self;
    sr_vec3 d = sr_sub(m->p, reference->p);
    float r2 = sr_length2(d), r = sqrtf(r2), jacobian;
    if (!(r2 > 0))
        return false;
    sr_vec3 wi = sr_scale(1 / r, d);
    sr_vec2 uv;
    if (!place_in_image(m, sr_neg(wi), &uv, &jacobian))
        return false;
    *s = (struct sr_light_sample){
        .L = sr_light_pixel_at(&m->pixels, uv, w) / r2, .wi = wi, .distance = r, .p = m->p, .pdf = 1, .is_delta = true};
    return !sr_spectrum_is_black(s->L);
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)n;
    const struct projection *m = self;
    sr_vec2 uv;
    float jacobian;
    *pdf_area = 1;
    *pdf_direction =
        !m->is_black && place_in_image(m, w, &uv, &jacobian) ? sr_piecewise2_pdf(&m->density, uv) * jacobian : 0;
}

static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    (void)u_place;
    const struct projection *m = self;
    float unused;
    sr_vec2 uv = sr_piecewise2_sample(&m->density, u_direction, &unused);
    sr_vec3 out = sr_light_turned_back(&m->turn, (sr_vec3){(2 * uv.x - 1) * m->half.x, (1 - 2 * uv.y) * m->half.y, 1});
    *ray = (struct sr_light_ray){.from = {.p = m->p}, .w = out};
    emit_pdf(self, ray->from.n, out, &ray->pdf_area, &ray->pdf_direction);
    if (!(ray->pdf_direction > 0) || !place_in_image(m, out, &uv, &unused))
        return false;
    ray->L = sr_light_pixel_at(&m->pixels, uv, w);
    return !sr_spectrum_is_black(ray->L);
}

static float power(const void *self)
{
    return ((const struct projection *)self)->flux;
}

// the tree compares intensities, so power is that of a point light as bright as the image's mean
static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct projection *m = self;
    *b = (struct sr_light_bounds){.box = {m->p, m->p},
                                  .axis = m->axis,
                                  .cos_theta_o = 1,
                                  .cos_theta_e = m->cos_reach,
                                  .power = 4 * SR_PI * m->choice};
    return true;
}

static float emit_weight(const void *self)
{
    const struct projection *m = self;
    return sr_max(m->flux, m->choice * 4 * (float)quarter((double)m->half.x, (double)m->half.y));
}

const struct sr_light_model sr_light_projection = {
    .name = "projection",
    .params = params,
    .size = sizeof(struct projection),
    .is_delta = true,
    .prepare = prepare,
    .sample = sample,
    .pdf = sr_light_delta_pdf,
    .Le = sr_light_delta_Le,
    .bounds = bounds,
    .emit = emit,
    .emit_pdf = emit_pdf,
    .emit_weight = emit_weight,
    .power = power,
};
