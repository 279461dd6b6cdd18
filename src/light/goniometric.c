/* SPDX-License-Identifier: MIT */
/* A point whose intensity is an image of all directions.
 *
 *     I(w) = I Y(square(w)),   Phi = 4 pi I mean(Y)    [cd] [lm];   p(w) = Y / (4 pi mean(Y))  [1/sr] where paths begin
 *
 * The image is an equal-area octahedral map (Clarberg 2008), looked up without interpolation; Y is the mean of R, G and
 * B, or the only channel. The map's pole is the light's +y: its (x, y, z) is (x, z, y) here, as pbrt-v4 has it. I is
 * scaled to the luminous intensity `scale` where Y is 1, or so that Phi = scale * power. Limits: far field; one colour.
 */
#include "light/pixels.h"

struct goniometric {
    struct sr_light_common common;
    struct sr_spd I;
    float scale, power; // [1] [lm]
    const char *filename;
    // derived
    sr_vec3 p;                    // [m]
    struct sr_light_turn turn;    // to the map's axes
    struct sr_piecewise2 density; // over the square
    float flux, choice;           // [lm] [cd] of the brightest texel
    float mean;                   // of Y
};

static const struct sr_param params[] = {
    {SR_PARAM_FILE, "filename", "1", 0, 0, 0, offsetof(struct goniometric, filename),
     "square image: equal-area octahedral map of the intensity"},
    {SR_PARAM_ILLUMINANT, "I", "cd", 0, INFINITY, NAN, offsetof(struct goniometric, I),
     "intensity where the image is 1; only its shape counts, rgb its brightness, too"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct goniometric, scale), "factor"},
    {SR_PARAM_FLOAT, "power", "lm", -INFINITY, INFINITY, NAN, offsetof(struct goniometric, power),
     "luminous flux of the whole light, if above 0"},
    {.name = NULL},
};

static sr_status check_image(const struct goniometric *m, struct sr_error *error)
{
    const struct sr_texels *t = &m->common.texels;
    if (!m->filename || !t->width)
        return sr_fail(error, SR_ERROR_INPUT, "a goniometric light needs the parameter \"filename\"");
    if (t->width != t->height)
        return sr_fail(
            error, SR_ERROR_INPUT,
            "%s: the image of a goniometric light must be square, an equal-area octahedral map, or a latitude-longitude "
            "map of 2 x 1, but is %u x %u",
            m->filename, t->width, t->height);
    return sr_light_check_finite(t, m->filename, error);
}

static sr_status build_density(struct goniometric *m, float *peak, struct sr_arena *arena, struct sr_error *error)
{
    const struct sr_texels *t = &m->common.texels;
    size_t n = (size_t)t->width * t->height;
    float *f = sr_alloc(n * sizeof *f);
    *peak = 0;
    for (size_t i = 0; f && i < n; ++i) {
        f[i] = sr_light_grey(t, (uint32_t)(i % t->width), (uint32_t)(i / t->width));
        *peak = sr_max(*peak, f[i]);
    }
    bool is_built = f && sr_piecewise2_build(arena, f, t->width, t->height, &m->density);
    sr_free(f);
    m->mean = (float)m->density.integral;
    return is_built ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "no memory for the density of %s", m->filename);
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct goniometric *m = self;
    float peak;
    if (check_image(m, error) != SR_OK || build_density(m, &peak, arena, error) != SR_OK)
        return error->status;
    if (!(m->mean > 0) && m->power > 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is black, so that it cannot be scaled to a power", m->filename);
    if (sr_light_set_brightness(&m->I, m->common.space, m->common.is_absolute, m->scale,
                                m->power / (4 * SR_PI * m->mean), error))
        return error->status;
    const struct sr_transform *t = &m->common.light_to_world;
    static const float swap[4][4] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};
    struct sr_transform pole_up = sr_transform_from_matrix(swap), from_map = sr_transform_multiply(t, &pole_up);
    m->turn = sr_light_turn_of(&from_map);
    m->p = sr_transform_point(t, (sr_vec3){0, 0, 0});
    if (!sr_is_finite(m->p))
        return sr_fail(error, SR_ERROR_INPUT, "the place of a goniometric light is not finite");
    m->flux = 4 * SR_PI * m->mean * (float)sr_spd_luminous_integral(&m->I);
    m->choice = sr_light_choice_weight(&m->I) * peak;
    return isfinite(m->flux) && isfinite(m->choice)
               ? SR_OK
               : sr_fail(error, SR_ERROR_INPUT, "%s: the emission is not finite", m->filename);
}

static float along(const struct goniometric *m, sr_vec3 w, float *jacobian)
{
    const struct sr_texels *t = &m->common.texels;
    sr_vec2 uv = sr_equal_area_sphere_to_square(sr_light_turned(&m->turn, w, jacobian));
    return sr_light_grey(t, sr_light_texel_index(uv.x, t->width), sr_light_texel_index(uv.y, t->height));
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    (void)u;
    const struct goniometric *m = self;
    sr_vec3 d = sr_sub(m->p, reference->p);
    float r2 = sr_length2(d), r = sqrtf(r2), jacobian;
    if (!(r2 > 0))
        return false;
    sr_vec3 wi = sr_scale(1 / r, d);
    float Y = along(m, sr_neg(wi), &jacobian);
    if (!(Y > 0))
        return false;
    *s = (struct sr_light_sample){
        .L = sr_spd_eval(&m->I, w->lambda) * (Y / r2), .wi = wi, .distance = r, .p = m->p, .pdf = 1, .is_delta = true};
    return true;
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)n;
    const struct goniometric *m = self;
    float jacobian, Y = along(m, w, &jacobian);
    *pdf_area = 1;
    *pdf_direction = m->mean > 0 ? Y / m->mean * jacobian * (SR_INV_PI / 4) : 0;
}

static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    (void)u_place;
    const struct goniometric *m = self;
    float unused;
    sr_vec2 uv = sr_piecewise2_sample(&m->density, u_direction, &unused);
    sr_vec3 out = sr_light_turned_back(&m->turn, sr_equal_area_square_to_sphere(uv));
    *ray = (struct sr_light_ray){.from = {.p = m->p}, .w = out, .L = sr_spd_along(&m->I, w) * along(m, out, &unused)};
    emit_pdf(self, ray->from.n, out, &ray->pdf_area, &ray->pdf_direction);
    return ray->pdf_direction > 0 && !sr_spectrum_is_black(ray->L);
}

static float emit_weight(const void *self)
{
    const struct goniometric *m = self;
    return 4 * SR_PI * m->mean * sr_light_choice_weight(&m->I);
}

static float power(const void *self)
{
    return ((const struct goniometric *)self)->flux;
}

static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct goniometric *m = self;
    *b = (struct sr_light_bounds){
        .box = {m->p, m->p}, .axis = {0, 0, 1}, .cos_theta_o = -1, .cos_theta_e = 0, .power = 4 * SR_PI * m->choice};
    return true;
}

const struct sr_light_model sr_light_goniometric = {
    .name = "goniometric",
    .params = params,
    .size = sizeof(struct goniometric),
    .is_delta = true,
    .wants_octahedral_map = true,
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
