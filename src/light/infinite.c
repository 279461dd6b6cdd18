/* SPDX-License-Identifier: MIT */
/* The sky: light from all directions outside the scene, uniform or as an image says.
 *
 *     uniform:  L(w) = L                                  E = pi L              [lx], of the hemisphere
 *     image:    L(w) = rgb(square(w)) * white * scale     p(w) = p(square(w)) / (4 pi)      [1/sr]
 *
 * The image is an equal-area octahedral map (Clarberg 2008), looked up without interpolation as pbrt-v4 does, so that
 * its texels are exactly the cells of the density. With `illuminance` the brightness is scaled so that a surface that
 * faces the light's +z receives scale * illuminance.
 *
 * The density is compensated for the directions that surfaces choose themselves (Karlik, Sik, Vevoda, Skrivan,
 * Krivanek, "MIS compensation", 2019): p ~ max(f - mean(f), 0); where it is 0 light still comes, found with weight 1 by
 * the surface's own choice. A uniform sky is never drawn at all, for the same reason. Estimators without such a choice
 * must not use it. */
#include "light/infinite.h"

enum { MOST_CELLS = 1 << 22 }; // 80 MiB

const struct sr_param sr_infinite_params[] = {
    {SR_PARAM_ILLUMINANT, "L", "cd/m^2", 0, INFINITY, NAN, offsetof(struct sr_infinite, L),
     "radiance; only its shape counts, rgb its brightness, too"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct sr_infinite, scale), "factor"},
    {SR_PARAM_FLOAT, "illuminance", "lx", -INFINITY, INFINITY, NAN, offsetof(struct sr_infinite, illuminance),
     "of a surface that faces the light's +z, if above 0"},
    {SR_PARAM_FILE, "filename", "1", 0, 0, 0, offsetof(struct sr_infinite, filename),
     "image: square, an equal-area octahedral map, or 2 x 1, latitude and longitude"},
    {SR_PARAM_POINT3S, "portal", "m", -INFINITY, INFINITY, NAN, offsetof(struct sr_infinite, portal),
     "corners in the world of a rectangle through which alone the light comes: the side of (p3 - p0) x (p1 - p0) is outside"},
    {.name = NULL},
};

static void set_directions(struct sr_infinite *m)
{
    m->turn = sr_light_turn_of(&m->common.light_to_world);
    const sr_vec3 *columns = m->turn.columns;
    m->is_rotation = true;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
            m->is_rotation &= fabsf(sr_dot(columns[i], columns[j]) - (float)(i == j)) < 1e-6f;
}

// illuminance on the side of +z, were the factor 1 [lx]
static double upper_illuminance(const struct sr_texels *t)
{
    double sum = 0;
    for (uint32_t y = 0; y < t->height; ++y)
        for (uint32_t x = 0; x < t->width; ++x) {
            sr_vec2 p = {((float)x + 0.5f) / (float)t->width, ((float)y + 0.5f) / (float)t->height};
            float cos_theta = sr_equal_area_square_to_sphere(p).z;
            if (cos_theta > 0)
                sum += (double)cos_theta * sr_light_texel_luminance(t, x, y);
        }
    return sum * 4 * (double)SR_PI / ((double)t->width * t->height);
}

static struct cell cell_of(const struct sr_infinite *m, size_t i)
{
    const struct sr_texels *t = &m->common.texels;
    struct sr_spd s =
        sr_spd_from_rgb_illuminant(t->space, sr_light_texel(t, (uint32_t)(i % t->width), (uint32_t)(i / t->width)));
    sr_vec2 centre = {((float)(i % t->width) + 0.5f) / (float)t->width,
                      ((float)(i / t->width) + 0.5f) / (float)t->height};
    return (struct cell){s.sigmoid, s.scale * m->factor, sr_piecewise2_pdf(&m->density, centre)};
}

static sr_status build_cells(struct sr_infinite *m, struct sr_arena *arena, struct sr_error *error)
{
    const struct sr_texels *t = &m->common.texels;
    size_t n = (size_t)t->width * t->height;
    if (n > MOST_CELLS)
        return SR_OK;
    struct cell *cells = sr_arena_alloc(arena, n * sizeof *cells);
    if (!cells)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the spectra of %s", m->filename);
    for (size_t i = 0; i < n; ++i)
        cells[i] = cell_of(m, i);
    m->cells = cells;
    return SR_OK;
}

static sr_status build_density(struct sr_infinite *m, struct sr_arena *arena, struct sr_error *error)
{
    const struct sr_texels *t = &m->common.texels;
    size_t n = (size_t)t->width * t->height;
    float *f = sr_alloc(n * sizeof *f);
    if (!f)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the density of %s", m->filename);
    double sum = 0, max = 0;
    for (size_t i = 0; i < n; ++i) {
        f[i] = sr_light_grey(t, (uint32_t)(i % t->width), (uint32_t)(i / t->width));
        sum += (double)f[i];
        max = fmax(max, (double)f[i]);
    }
    // what hardly rises above its mean would leave rounding errors: then the plain density
    float mean = (float)(sum / (double)n);
    m->choice = m->factor * mean;
    if (max > 1.001 * (double)mean)
        for (size_t i = 0; i < n; ++i)
            f[i] = sr_max(f[i] - mean, 0);
    bool is_built = sr_piecewise2_build(arena, f, t->width, t->height, &m->density);
    sr_free(f);
    return is_built ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "no memory for the density of %s", m->filename);
}

sr_status sr_infinite_prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct sr_infinite *m = self;
    const struct sr_texels *t = &m->common.texels;
    set_directions(m);
    if (!sr_infinite_is_image(m)) {
        if (sr_light_set_brightness(&m->L, m->common.space, m->common.is_absolute, m->scale, m->illuminance * SR_INV_PI,
                                    error))
            return error->status;
        m->luminance = (float)sr_spd_luminous_integral(&m->L);
        return SR_OK;
    }
    if (m->L.kind != SR_SPD_NONE)
        return sr_fail(error, SR_ERROR_INPUT, "an infinite light takes \"L\" or \"filename\" (%s), not both",
                       m->filename);
    if (t->width != t->height)
        return sr_fail(
            error, SR_ERROR_INPUT,
            "%s: an environment image must be square, an equal-area octahedral map, or a latitude-longitude map of 2 x 1, but is %u x %u",
            m->filename, t->width, t->height);
    if (sr_light_check_texels(t, m->filename, error))
        return error->status;
    double factor = (double)m->scale / sr_colour_space(t->space)->illuminant_luminous_integral;
    if (m->illuminance > 0) {
        double given = upper_illuminance(t);
        if (!(given > 0))
            return sr_fail(error, SR_ERROR_INPUT,
                           "%s: no light from above, so that it cannot be scaled to an illuminance", m->filename);
        factor *= (double)m->illuminance / given;
    }
    m->factor = (float)factor;
    m->white = sr_colour_space(t->space)->illuminant;
    m->luminance =
        (float)(factor * sr_colour_space(t->space)->illuminant_luminous_integral * sr_light_mean_luminance(t));
    return build_density(m, arena, error) == SR_OK ? build_cells(m, arena, error) : error->status;
}

static void place(void *self, sr_vec3 scene_centre, float scene_radius)
{
    struct sr_infinite *m = self;
    m->centre = scene_centre;
    m->radius = scene_radius;
}

// unit direction in the world to the square; *jacobian: solid angle of the image over that of the world
static sr_vec2 square(const struct sr_infinite *m, sr_vec3 wi, float *jacobian)
{
    if (SR_UNLIKELY(!m->is_rotation))
        return sr_equal_area_sphere_to_square(sr_light_turned(&m->turn, wi, jacobian));
    *jacobian = 1;
    const sr_vec3 *rows = m->turn.rows;
    return sr_equal_area_sphere_to_square((sr_vec3){sr_dot(rows[0], wi), sr_dot(rows[1], wi), sr_dot(rows[2], wi)});
}

static inline struct cell look_up(const struct sr_infinite *m, sr_vec2 p)
{
    const struct sr_texels *t = &m->common.texels;
    size_t i = (size_t)sr_light_texel_index(p.y, t->height) * t->width + sr_light_texel_index(p.x, t->width);
    return m->cells ? m->cells[i] : cell_of(m, i);
}

static inline sr_spectrum cell_Le(const struct sr_infinite *m, struct cell c, const struct sr_wavelengths *w)
{
    struct sr_spd s = {.kind = SR_SPD_ILLUMINANT, .scale = c.scale, .sigmoid = c.sigmoid, .table = m->white};
    return sr_spd_along(&s, w);
}

sr_spectrum sr_infinite_Le(const struct sr_infinite *m, sr_vec3 wi, const struct sr_wavelengths *w)
{
    if (!sr_infinite_is_image(m))
        return sr_spd_along(&m->L, w);
    float jacobian;
    return cell_Le(m, look_up(m, square(m, wi, &jacobian)), w);
}

float sr_infinite_blurred_grey(const struct sr_infinite *m, sr_vec3 wi)
{
    const struct sr_texels *t = &m->common.texels;
    float jacobian, sum = 0;
    sr_vec2 p = square(m, wi, &jacobian);
    float x = sr_max(p.x * (float)t->width - 0.5f, 0), y = sr_max(p.y * (float)t->height - 0.5f, 0);
    uint32_t i = (uint32_t)x, j = (uint32_t)y;
    float dx = x - (float)i, dy = y - (float)j;
    for (uint32_t k = 0; k < 4; ++k) {
        uint32_t ix = i + (k & 1), iy = j + (k >> 1);
        sum += (k & 1 ? dx : 1 - dx) * (k >> 1 ? dy : 1 - dy) *
               sr_light_grey(t, ix < t->width ? ix : t->width - 1, iy < t->height ? iy : t->height - 1);
    }
    return sum;
}

static sr_spectrum Le(const void *self, const struct sr_point *there, sr_vec3 w,
                      const struct sr_wavelengths *wavelengths)
{
    (void)there;
    return sr_infinite_Le(self, sr_neg(w), wavelengths);
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    (void)reference;
    const struct sr_infinite *m = self;
    if (!sr_infinite_is_image(m))
        return false;
    float pdf;
    sr_vec2 p = sr_piecewise2_sample(&m->density, u, &pdf);
    if (!(pdf > 0))
        return false;
    sr_vec3 d = sr_equal_area_square_to_sphere(p);
    const sr_vec3 *columns = m->turn.columns;
    sr_vec3 wi = sr_add(sr_add(sr_scale(d.x, columns[0]), sr_scale(d.y, columns[1])), sr_scale(d.z, columns[2]));
    float jacobian = 1;
    if (SR_UNLIKELY(!m->is_rotation)) { // |A d| = 1 / |A^-1 wi| for the unit vector wi along A d
        float length = sr_length(wi);
        jacobian = m->turn.determinant * length * length * length;
        wi = sr_scale(1 / length, wi);
    }
    *s = (struct sr_light_sample){
        .L = cell_Le(m, look_up(m, p), w), .wi = wi, .distance = INFINITY, .pdf = pdf * jacobian / (4 * SR_PI)};
    return !sr_spectrum_is_black(s->L);
}

static float pdf(const void *self, const struct sr_point *reference, sr_vec3 wi, const struct sr_point *there)
{
    (void)reference, (void)there;
    const struct sr_infinite *m = self;
    if (!sr_infinite_is_image(m))
        return 0;
    float jacobian;
    sr_vec2 p = square(m, wi, &jacobian);
    return sr_piecewise2_pdf(&m->density, p) * jacobian / (4 * SR_PI);
}

static sr_spectrum Le_pdf(const void *self, sr_vec3 from, sr_vec3 wi, const struct sr_wavelengths *w, float *density)
{
    (void)from;
    const struct sr_infinite *m = self;
    *density = 0;
    if (!sr_infinite_is_image(m))
        return sr_spd_along(&m->L, w);
    float jacobian;
    struct cell c = look_up(m, square(m, wi, &jacobian));
    *density = c.density * jacobian / (4 * SR_PI);
    return cell_Le(m, c, w);
}

/* Half of the rays leave as `sample` draws them, half evenly: no ray carries more than twice the mean flux, and none
 * that carries anything has no chance. */
static float emit_density(const struct sr_infinite *m, sr_vec3 wi)
{
    if (!sr_infinite_is_image(m))
        return SR_INV_PI / 4;
    float jacobian;
    sr_vec2 p = square(m, wi, &jacobian);
    return (0.5f + 0.5f * sr_piecewise2_pdf(&m->density, p)) * jacobian * (SR_INV_PI / 4);
}

static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    const struct sr_infinite *m = self;
    if (!(m->radius > 0))
        return false;
    sr_vec2 p = u_direction;
    bool is_even = p.x < 0.5f;
    p.x = sr_min(is_even ? 2 * p.x : 2 * p.x - 1, SR_ONE_MINUS_EPSILON);
    float unused;
    if (sr_infinite_is_image(m) && !is_even)
        p = sr_piecewise2_sample(&m->density, p, &unused);
    sr_vec3 d = sr_equal_area_square_to_sphere(sr_infinite_is_image(m) ? p : u_direction);
    sr_vec3 wi = d;
    if (sr_infinite_is_image(m))
        wi = sr_light_turned_back(&m->turn, d);
    *ray = (struct sr_light_ray){.from = {.p = sr_light_outside(m->centre, m->radius, wi, u_place)},
                                 .w = sr_neg(wi),
                                 .L = sr_infinite_is_image(m) ? cell_Le(m, look_up(m, p), w) : sr_spd_along(&m->L, w),
                                 .pdf_area = SR_INV_PI / sr_sqr(m->radius),
                                 .pdf_direction = emit_density(m, wi)};
    return ray->pdf_direction > 0 && !sr_spectrum_is_black(ray->L);
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)n;
    const struct sr_infinite *m = self;
    *pdf_area = m->radius > 0 ? SR_INV_PI / sr_sqr(m->radius) : 0;
    *pdf_direction = emit_density(m, sr_neg(w));
}

// of what enters the scene's sphere, whether it is drawn by receivers or not
static float emit_weight(const void *self)
{
    const struct sr_infinite *m = self;
    return 4 * SR_PI * SR_PI * sr_sqr(m->radius) *
           (sr_infinite_is_image(m) ? sr_max(m->luminance, m->choice) : sr_light_choice_weight(&m->L));
}

static float power(const void *self)
{
    const struct sr_infinite *m = self;
    return sr_infinite_is_image(m) ? 4 * SR_PI * SR_PI * m->radius * m->radius * m->luminance : 0;
}

static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct sr_infinite *m = self;
    float radius = m->radius > 0 ? m->radius : 1; // a scene without extent is lit, too
    *b = (struct sr_light_bounds){
        .power = sr_infinite_is_image(m) ? 4 * SR_PI * SR_PI * radius * radius * sr_max(m->luminance, m->choice) : 0};
    return false;
}

const struct sr_light_model sr_light_infinite = {
    .name = "infinite",
    .params = sr_infinite_params,
    .size = sizeof(struct sr_infinite),
    .is_infinite = true,
    .wants_octahedral_map = true,
    .prepare = sr_infinite_prepare,
    .place = place,
    .sample = sample,
    .pdf = pdf,
    .Le = Le,
    .Le_pdf = Le_pdf,
    .bounds = bounds,
    .emit = emit,
    .emit_pdf = emit_pdf,
    .emit_weight = emit_weight,
    .power = power,
};
