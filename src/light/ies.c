/* SPDX-License-Identifier: MIT */
/* A point that shines as a luminaire was measured to: IES LM-63 or EULUMDAT.
 *
 *     I(d) = scale I_file(C, gamma) s(lambda),   INTEGRAL s ybar dlambda = 1          [cd]
 *     Phi  = scale INTEGRAL I_file dw, or with `power`: Phi = scale * power           [lm]; [W] of absolute spectra
 *
 * The luminaire hangs in its own space: gamma 0 along -z, C 0 along +x, C 90 along +y; scenes whose up is y turn it by
 * Rotate -90 1 0 0. Limits: far field: without extent, so that receivers nearer than about five times the luminaire's
 * size get another amount than from the real one; one colour in all directions; a transform that is no similarity bends
 * the distribution. */
#include "light/emission.h"
#include "measured/measured.h"

struct ies {
    struct sr_light_common common;
    struct sr_spd I;
    float scale, power; // [1] [lm]
    const char *filename;
    sr_vec3 from;
    const struct sr_photometry *photometry; // derived
    sr_vec3 p;                              // [m]
    sr_vec3 axis;                           // [1] local -z
    float flux, choice;                     // [lm], [cd] of the peak
    struct sr_photometry_guide guide;       // to draw directions where paths begin
    float determinant;                      // of world to light: a transform that is no rotation squeezes solid angles
    float cos_reach;                        // of the cone around the axis beyond which there is no light
};

static const struct sr_param params[] = {
    {SR_PARAM_FILE, "filename", "1", 0, 0, 0, offsetof(struct ies, filename), "IES LM-63 or EULUMDAT file"},
    {SR_PARAM_ILLUMINANT, "I", "cd", 0, INFINITY, NAN, offsetof(struct ies, I),
     "spectrum; only its shape counts, rgb its brightness, too"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct ies, scale), "factor"},
    {SR_PARAM_FLOAT, "power", "lm", -INFINITY, INFINITY, NAN, offsetof(struct ies, power),
     "luminous flux of the whole light instead of the file's, if above 0"},
    {SR_PARAM_POINT3, "from", "m", -INFINITY, INFINITY, 0, offsetof(struct ies, from), "where it is"},
    {.name = NULL},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct ies *m = self;
    if (!m->filename || !m->filename[0])
        return sr_fail(error, SR_ERROR_INPUT, "an ies light needs the parameter \"filename\"");
    if (sr_photometry_read(m->filename, arena, &m->photometry, error) != SR_OK)
        return error->status;
    const struct sr_photometry *p = m->photometry;
    double flux = sr_photometry_flux(p, 0, 180), peak = 0;
    float reach = 0;
    for (size_t i = 0; i < (size_t)p->c_count * p->gamma_count; ++i) {
        size_t row = i % p->gamma_count;
        peak = fmax(peak, (double)p->candela[i]);
        if (p->candela[i] > 0) // linear down to the next angle
            reach = sr_max(reach, p->gamma[row + 1 < p->gamma_count ? row + 1 : row]);
    }
    m->cos_reach = cosf(sr_min(sr_radians(reach) + 1e-3f, SR_PI));
    m->p = sr_transform_point(&m->common.light_to_world, m->from);
    m->axis = sr_normalize(sr_transform_vector(&m->common.light_to_world, (sr_vec3){0, 0, -1}));
    if (!sr_is_finite(m->p) || !sr_is_finite(m->axis))
        return sr_fail(error, SR_ERROR_INPUT, "the place of an ies light is not finite");
    // the file is in candela; where a power is given, that is in the scene's unit, and the file is a shape
    sr_status status = m->power > 0 ? sr_light_set_brightness(&m->I, m->common.space, m->common.is_absolute, m->scale,
                                                              (float)((double)m->power / flux), error)
                                    : sr_light_normalise(&m->I, m->common.space, m->scale, error);
    if (status != SR_OK)
        return status;
    if (!sr_photometry_guide_build(p, arena, &m->guide))
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the density of %s", m->filename);
    const struct sr_transform *t = &m->common.light_to_world;
    sr_vec3 rows[3];
    for (int i = 0; i < 3; ++i)
        rows[i] = (sr_vec3){t->inverse[i][0], t->inverse[i][1], t->inverse[i][2]};
    m->determinant = fabsf(sr_dot(rows[0], sr_cross(rows[1], rows[2])));
    m->flux = (float)(sr_spd_luminous_integral(&m->I) * flux);
    m->choice = (float)((double)sr_light_choice_weight(&m->I) * peak);
    return isfinite(m->flux) && isfinite(m->choice)
               ? SR_OK
               : sr_fail(error, SR_ERROR_INPUT, "%s: the emission is not finite", m->filename);
}

/* of the file toward w in the world [cd] */
static float intensity(const struct ies *m, sr_vec3 w)
{
    sr_vec3 d = sr_inverse_vector(&m->common.light_to_world, w);
    return (float)sr_photometry_intensity_along(m->photometry, d);
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    (void)u;
    const struct ies *m = self;
    sr_vec3 d = sr_sub(m->p, reference->p);
    float r2 = sr_length2(d), r = sqrtf(r2);
    if (!(r2 > 0))
        return false;
    sr_vec3 wi = sr_scale(1 / r, d);
    float I = intensity(m, sr_neg(wi));
    if (!(I > 0))
        return false;
    *s = (struct sr_light_sample){
        .L = sr_spd_eval(&m->I, w->lambda) * (I / r2), .wi = wi, .distance = r, .p = m->p, .pdf = 1, .is_delta = true};
    return true;
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)n;
    const struct ies *m = self;
    sr_vec3 d = sr_inverse_vector(&m->common.light_to_world, w);
    float length = sr_length(d);
    *pdf_area = 1;
    *pdf_direction =
        sr_photometry_pdf(&m->guide, sr_scale(1 / length, d)) * m->determinant / (length * length * length);
}

static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    (void)u_place;
    const struct ies *m = self;
    float unused;
    sr_vec3 d = sr_photometry_sample(&m->guide, u_direction, &unused),
            out = sr_normalize(sr_transform_vector(&m->common.light_to_world, d));
    *ray = (struct sr_light_ray){.from = {.p = m->p}, .w = out, .L = sr_spd_along(&m->I, w) * intensity(m, out)};
    emit_pdf(self, ray->from.n, out, &ray->pdf_area, &ray->pdf_direction);
    return ray->pdf_direction > 0 && !sr_spectrum_is_black(ray->L);
}

static float emit_weight(const void *self)
{
    return ((const struct ies *)self)->flux;
}

static float power(const void *self)
{
    return ((const struct ies *)self)->flux;
}

static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct ies *m = self;
    *b = (struct sr_light_bounds){.box = {m->p, m->p},
                                  .axis = m->axis,
                                  .cos_theta_o = m->cos_reach,
                                  .cos_theta_e = 1,
                                  .power = 4 * SR_PI * m->choice};
    return true;
}

const struct sr_light_model sr_light_ies = {
    .name = "ies",
    .params = params,
    .size = sizeof(struct ies),
    .is_delta = true,
    .reads_own_file = true,
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
