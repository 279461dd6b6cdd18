/* SPDX-License-Identifier: MIT */
/* The sky as it shines through a rectangle, the portal, alone: a window that light sampling looks through.
 *
 *     L(x, wi) = sky(wi) where the ray from x toward wi crosses the portal from inside, else 0
 *     Phi      = A INTEGRAL sky(w) cos_theta dw over the outer hemisphere                                        [lm]
 *
 * In the portal's frame, z outward, directions are (alpha, beta) = (atan2(x, z), atan2(y, z)) [rad], in which the
 * portal is an upright rectangle as seen from anywhere, dw = (1 + tx^2)(1 + ty^2) / (1 + tx^2 + ty^2)^(3/2) dalpha
 * dbeta with t the tangents. A piecewise constant density over (alpha, beta) is drawn within that rectangle through its
 * summed area table (Bitterli, Wyman, Pharr, Shirley, Lefohn, Jarosz, "Portal-masked environment map sampling", 2015;
 * Pharr, Jakob & Humphreys 2023, 12.5.3). A uniform sky is drawn evenly by solid angle instead. Unlike pbrt-v4, which
 * resamples the image, the radiance is that of the sky's own texels: the table is for drawing only. Limits: light that
 * would come in elsewhere is dropped, as the scene asks; places outside the portal receive none. */
#include "light/infinite.h"
#include "light/pixels.h"

struct portal {
    struct sr_infinite sky;
    // derived
    sr_vec3 corner, ex, ey; // [m] p0, p3 - p0, p1 - p0
    struct sr_frame frame;  // z outward
    float width, height;    // [m]
    uint32_t n;             // cells along each side of the table
    const double *table;    // (n + 1)^2: integral of the density over alpha, beta below, each 0 … 1 of pi
    float flux, choice;     // [lm]
};

// ---- the table ----

// dw / d(a, b) of the unit square [sr]
static float solid_angle_density(float tx, float ty)
{
    float s = 1 + tx * tx + ty * ty;
    return SR_PI * SR_PI * (1 + tx * tx) * (1 + ty * ty) / (s * sqrtf(s));
}

static float tangent(float a)
{
    return tanf(SR_PI * (sr_clamp(a, 1e-6f, 1 - 1e-6f) - 0.5f));
}

static double below(const struct portal *m, double a, double b)
{
    double x = fmin(fmax(a, 0), 1) * m->n, y = fmin(fmax(b, 0), 1) * m->n;
    uint32_t i = (uint32_t)x < m->n ? (uint32_t)x : m->n - 1, j = (uint32_t)y < m->n ? (uint32_t)y : m->n - 1;
    const double *t = m->table + (size_t)j * (m->n + 1) + i, *u = t + m->n + 1;
    double dx = x - i, dy = y - j;
    return (1 - dy) * ((1 - dx) * t[0] + dx * t[1]) + dy * ((1 - dx) * u[0] + dx * u[1]);
}

struct window {
    double a0, a1, b0, b1;
};

static double inside(const struct portal *m, struct window w)
{
    return below(m, w.a1, w.b1) - below(m, w.a0, w.b1) - below(m, w.a1, w.b0) + below(m, w.a0, w.b0);
}

static double cell_value(const struct portal *m, double a, double b)
{
    uint32_t i = a * m->n < m->n ? (uint32_t)(a * m->n) : m->n - 1,
             j = b * m->n < m->n ? (uint32_t)(b * m->n) : m->n - 1;
    const double *t = m->table + (size_t)j * (m->n + 1) + i, *u = t + m->n + 1;
    return (u[1] - u[0] - t[1] + t[0]) * m->n * m->n;
}

/* Where the integral over the window's part below x is the share u of the whole: along a, or along b. It is linear
 * within a cell. */
static double invert(const struct portal *m, struct window w, bool along_a, double u)
{
    double lo = along_a ? w.a0 : w.b0, hi = along_a ? w.a1 : w.b1, whole = inside(m, w), wanted = u * whole;
    uint32_t first = (uint32_t)(lo * m->n), last = (uint32_t)(hi * m->n);
    double f_lo = 0, f_hi = whole;
    while (first < last) { // borders of cells in (lo, hi)
        uint32_t middle = first + (last - first + 1) / 2;
        double x = (double)middle / m->n;
        struct window part = along_a ? (struct window){w.a0, x, w.b0, w.b1} : (struct window){w.a0, w.a1, w.b0, x};
        double f = x < hi ? inside(m, part) : whole;
        if (f <= wanted && x < hi) {
            lo = fmax(x, lo);
            f_lo = f;
            first = middle;
        } else {
            hi = fmin(x, hi);
            f_hi = f;
            last = middle - 1;
        }
    }
    double share = f_hi > f_lo ? (wanted - f_lo) / (f_hi - f_lo) : 0.5;
    return lo + fmin(fmax(share, 0), 1) * (hi - lo);
}

// density [1] over the unit square
static bool draw(const struct portal *m, struct window w, sr_vec2 u, sr_vec2 *ab, float *pdf)
{
    double whole = inside(m, w);
    if (!(whole > 0))
        return false;
    double a = invert(m, w, true, (double)u.x);
    uint32_t i = (uint32_t)fmin(a * m->n, m->n - 1);
    struct window strip = {fmax((double)i / m->n, w.a0), fmin((double)(i + 1) / m->n, w.a1), w.b0, w.b1};
    if (!(strip.a1 > strip.a0)) // an edge of the window on that of a cell
        return false;
    double b = invert(m, strip, false, (double)u.y);
    *ab = (sr_vec2){(float)a, (float)b};
    *pdf = (float)(cell_value(m, (double)ab->x, (double)ab->y) / whole);
    return *pdf > 0;
}

// ---- places and directions ----

// the portal as x sees it; false: from outside or from its own plane
static bool window_of(const struct portal *m, sr_vec3 x, struct window *w)
{
    sr_vec3 p = sr_to_local(&m->frame, sr_sub(m->corner, x));
    if (!(p.z > 0))
        return false;
    double z = (double)p.z, pi = 3.14159265358979323846;
    *w = (struct window){atan2((double)p.x, z) / pi + 0.5, atan2((double)p.x + (double)m->width, z) / pi + 0.5,
                         atan2((double)p.y, z) / pi + 0.5, atan2((double)p.y + (double)m->height, z) / pi + 0.5};
    return w->a1 > w->a0 && w->b1 > w->b0;
}

static bool is_through(const struct portal *m, sr_vec3 from, sr_vec3 wi)
{
    sr_vec3 d = sr_to_local(&m->frame, wi), p = sr_to_local(&m->frame, sr_sub(from, m->corner));
    if (!(d.z > 0 && p.z < 0))
        return false;
    float t = -p.z / d.z, x = p.x + t * d.x, y = p.y + t * d.y;
    return x >= 0 && x <= m->width && y >= 0 && y <= m->height;
}

static sr_vec3 direction_of(const struct portal *m, sr_vec2 ab, float *solid_angle)
{
    float tx = tangent(ab.x), ty = tangent(ab.y);
    *solid_angle = solid_angle_density(tx, ty);
    return sr_to_world(&m->frame, sr_normalize((sr_vec3){tx, ty, 1}));
}

static sr_vec2 place_of(const struct portal *m, sr_vec3 wi, float *solid_angle)
{
    sr_vec3 d = sr_to_local(&m->frame, wi);
    *solid_angle = solid_angle_density(d.x / d.z, d.y / d.z);
    return (sr_vec2){atan2f(d.x, d.z) * SR_INV_PI + 0.5f, atan2f(d.y, d.z) * SR_INV_PI + 0.5f};
}

// ---- making it ----

static sr_status set_frame(struct portal *m, struct sr_error *error)
{
    const struct sr_slice *s = &m->sky.portal;
    const sr_vec3 *p = s->data;
    if (s->count != 4)
        return sr_fail(error, SR_ERROR_INPUT, "\"portal\" has %u corners: expected the 4 of a rectangle", s->count);
    m->corner = p[0];
    m->ex = sr_sub(p[3], p[0]);
    m->ey = sr_sub(p[1], p[0]);
    m->width = sr_length(m->ex);
    m->height = sr_length(m->ey);
    float size = sr_max(m->width, m->height);
    bool closes = sr_length(sr_sub(sr_add(p[1], m->ex), p[2])) < 2e-3f * size;
    if (!(m->width > 0 && m->height > 0 && isfinite(size)) || !closes ||
        !(fabsf(sr_dot(m->ex, m->ey)) < 1e-3f * m->width * m->height))
        return sr_fail(error, SR_ERROR_INPUT,
                       "\"portal\" is no rectangle: expected 4 corners in turn, with right angles between its sides");
    m->frame = sr_frame_from_zx(sr_normalize(sr_cross(m->ex, m->ey)), sr_scale(1 / m->width, m->ex));
    return SR_OK;
}

// mean over a cell of the sky's grey times solid angle
static double density_of_cell(const struct portal *m, uint32_t i, uint32_t j, int looks, double floor)
{
    double sum = 0;
    for (int k = 0; k < looks * looks; ++k) {
        sr_vec2 ab = {((float)i + ((float)(k % looks) + 0.5f) / (float)looks) / (float)m->n,
                      ((float)j + ((float)(k / looks) + 0.5f) / (float)looks) / (float)m->n};
        float solid_angle;
        // reaches beyond small suns
        double grey = (double)sr_infinite_blurred_grey(&m->sky, direction_of(m, ab, &solid_angle));
        sum += (double)solid_angle * (grey + floor);
    }
    return sum / (looks * looks);
}

// INTEGRAL sky cos_theta dw over the outer hemisphere, in four parts of each texel, where white is 1 [sr]
static double passing(const struct portal *m)
{
    const struct sr_texels *t = &m->sky.common.texels;
    struct sr_light_turn turn = sr_light_turn_of(&m->sky.common.light_to_world);
    uint32_t side = 2 * t->width;
    double sum = 0;
    for (size_t k = 0; k < (size_t)side * side; ++k) {
        uint32_t x = (uint32_t)(k % side), y = (uint32_t)(k / side);
        sr_vec3 d =
            sr_equal_area_square_to_sphere((sr_vec2){((float)x + 0.5f) / (float)side, ((float)y + 0.5f) / (float)side});
        sr_vec3 wi = sr_light_turned_back(&turn, d);
        float cos_theta = sr_dot(wi, m->frame.z), jacobian;
        if (cos_theta <= 0)
            continue;
        sr_light_turned(&turn, wi, &jacobian);
        sum += (double)(cos_theta / jacobian) * sr_light_texel_luminance(t, x / 2, y / 2);
    }
    return sum * 4 * (double)SR_PI / ((double)side * side);
}

static sr_status build_table(struct portal *m, struct sr_arena *arena, struct sr_error *error)
{
    // as fine as the image near the portal's axis, for (pi / n)^2 = 4 pi / side^2; each texel is met by some look
    uint32_t side = m->sky.common.texels.width, n = side < 16 ? 16 : side < 1024 ? side : 1024;
    int looks = side <= 2 * n ? 3 : 4;
    double *t = sr_arena_alloc(arena, (size_t)(n + 1) * (n + 1) * sizeof *t);
    if (!t)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the density of %s", m->sky.filename);
    m->n = n;
    m->table = t;
    double floor = 0.02 * sr_light_mean_luminance(&m->sky.common.texels); // what no look has met is drawn, too
    for (uint32_t j = 0; j < n; ++j) {
        double row = 0;
        for (uint32_t i = 0; i < n; ++i) {
            row += density_of_cell(m, i, j, looks, floor);
            t[(size_t)(j + 1) * (n + 1) + i + 1] = t[(size_t)j * (n + 1) + i + 1] + row;
        }
    }
    for (size_t k = 0; k < (size_t)(n + 1) * (n + 1); ++k)
        t[k] /= (double)n * n;
    double white = (double)m->sky.factor * sr_colour_space(m->sky.common.texels.space)->illuminant_luminous_integral;
    m->flux = (float)(white * passing(m)) * m->width * m->height;
    return SR_OK;
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct portal *m = self;
    if (set_frame(m, error) != SR_OK || sr_infinite_prepare(&m->sky, arena, error) != SR_OK)
        return error->status;
    float area = m->width * m->height;
    if (!sr_infinite_is_image(&m->sky)) {
        m->flux = SR_PI * area * m->sky.luminance;
        m->choice = SR_PI * area * sr_light_choice_weight(&m->sky.L);
        return SR_OK;
    }
    sr_status status = build_table(m, arena, error);
    m->choice = sr_max(m->flux, 1e-3f * SR_PI * area * m->sky.choice);
    return status;
}

// ---- light ----

static sr_vec3 point_at(const struct portal *m, sr_vec2 u)
{
    return sr_add(m->corner, sr_add(sr_scale(u.x, m->ex), sr_scale(u.y, m->ey)));
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    const struct portal *m = self;
    struct window window;
    if (!window_of(m, reference->p, &window))
        return false;
    *s = (struct sr_light_sample){.distance = INFINITY};
    if (!sr_infinite_is_image(&m->sky)) {
        sr_vec3 p = sr_spherical_rectangle_sample(reference->p, m->corner, m->ex, m->ey, u, &s->pdf);
        s->wi = sr_normalize(sr_sub(p, reference->p));
    } else {
        sr_vec2 ab;
        float solid_angle;
        if (!draw(m, window, u, &ab, &s->pdf))
            return false;
        s->wi = direction_of(m, ab, &solid_angle);
        s->pdf /= solid_angle;
    }
    if (!(s->pdf > 0) || !isfinite(s->pdf))
        return false;
    s->L = sr_infinite_Le(&m->sky, s->wi, w);
    return !sr_spectrum_is_black(s->L);
}

static float density(const struct portal *m, sr_vec3 from, sr_vec3 wi)
{
    struct window window;
    if (!is_through(m, from, wi))
        return 0;
    if (!sr_infinite_is_image(&m->sky))
        return sr_spherical_rectangle_pdf(from, m->corner, m->ex, m->ey);
    if (!window_of(m, from, &window))
        return 0;
    float solid_angle;
    sr_vec2 ab = place_of(m, wi, &solid_angle);
    double whole = inside(m, window);
    return whole > 0 ? (float)(cell_value(m, (double)ab.x, (double)ab.y) / whole) / solid_angle : 0;
}

static float pdf(const void *self, const struct sr_point *reference, sr_vec3 wi, const struct sr_point *there)
{
    (void)there;
    return density(self, reference->p, wi);
}

static sr_spectrum Le(const void *self, const struct sr_point *there, sr_vec3 w,
                      const struct sr_wavelengths *wavelengths)
{
    (void)there;
    const struct portal *m = self;
    return sr_dot(w, m->frame.z) < 0 ? sr_infinite_Le(&m->sky, sr_neg(w), wavelengths) : SR_BLACK;
}

static sr_spectrum Le_pdf(const void *self, sr_vec3 from, sr_vec3 wi, const struct sr_wavelengths *w, float *pdf)
{
    const struct portal *m = self;
    *pdf = density(m, from, wi);
    return is_through(m, from, wi) ? sr_infinite_Le(&m->sky, wi, w) : SR_BLACK;
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)n;
    const struct portal *m = self;
    float cos_theta = -sr_dot(w, m->frame.z), solid_angle;
    *pdf_area = *pdf_direction = 0;
    if (!(cos_theta > 1e-5f))
        return;
    *pdf_area = 1 / (m->width * m->height * cos_theta);
    if (!sr_infinite_is_image(&m->sky)) {
        *pdf_direction = cos_theta * SR_INV_PI;
        return;
    }
    sr_vec2 ab = place_of(m, sr_neg(w), &solid_angle);
    double whole = inside(m, (struct window){0, 1, 0, 1});
    *pdf_direction = whole > 0 ? (float)(cell_value(m, (double)ab.x, (double)ab.y) / whole) / solid_angle : 0;
}

// anywhere on the portal, inward: a uniform sky by the cosine, an image by what its directions send
static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    const struct portal *m = self;
    sr_vec3 wi;
    if (sr_infinite_is_image(&m->sky)) {
        sr_vec2 ab;
        float unused;
        if (!draw(m, (struct window){0, 1, 0, 1}, u_direction, &ab, &unused))
            return false;
        wi = direction_of(m, ab, &unused);
    } else
        wi = sr_to_world(&m->frame, sr_warp_cosine_hemisphere(u_direction));
    *ray = (struct sr_light_ray){
        .from = {.p = point_at(m, u_place)}, .w = sr_neg(wi), .L = sr_infinite_Le(&m->sky, wi, w), .has_passed = true};
    emit_pdf(m, ray->from.n, ray->w, &ray->pdf_area, &ray->pdf_direction);
    return ray->pdf_direction > 0 && !sr_spectrum_is_black(ray->L);
}

static float emit_weight(const void *self)
{
    return ((const struct portal *)self)->choice;
}

static float power(const void *self)
{
    return ((const struct portal *)self)->flux;
}

static bool bounds(const void *self, struct sr_light_bounds *b)
{
    *b = (struct sr_light_bounds){.power = ((const struct portal *)self)->choice};
    return false;
}

const struct sr_light_model sr_light_portal = {
    .name = "infinite",
    .params = sr_infinite_params,
    .size = sizeof(struct portal),
    .is_infinite = true,
    .wants_octahedral_map = true,
    .prepare = prepare,
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
