/* SPDX-License-Identifier: MIT */
/* Light on a film behind a lens of many surfaces, each ray refracted by all of them.
 *
 *     E(film) = integral over the rear plane of T L cos^4(theta) / z^2 dA              [as L, times sr]
 *
 * z is the rear surface's distance from the film, theta the ray's angle there, T 1 where the ray gets through, or what
 * the aperture's image says at the stop. Points are drawn in a rectangle about the exit pupil as a film point at that
 * distance from the axis sees it, all directions round alike: of apertures that are not round, the disk about them. The
 * lens is moved so that focusdistance from the film is sharp, by the Gaussian equation of its principal planes: u (K -
 * u) = f K, u from film to rear principal plane, K the sum of image and object distance. C. Kolb, D. Mitchell & P.
 * Hanrahan, A realistic camera model, 1995. Space: the film at z = 0, the scene toward +z. Limits: one index for all
 * wavelengths, no reflections within the lens; nobody knows which rays see a given point, so that paths from lights
 * cannot be told to it. */
#include "sensor/private.h"

enum { RINGS = 64, GRID = 64 };

struct surface {         // in the order of a ray from the film
    double radius;       // [m] > 0: bulges toward the scene; 0: the stop
    double z, aperture2; // [m] vertex, [m^2] square of the largest distance from the axis
    double eta_rear, eta_front;
};

struct pupil {
    float x0, x1, y0, y1; // [m] on the rear plane, for a film point on the x axis
};

struct realistic {
    struct sr_sensor_common common;
    struct sr_sensor_lens lens;
    const char *lens_file, *aperture;
    float aperture_diameter; // [mm]
    float focus_distance;    // [m]
    // derived
    struct surface *surfaces;
    uint32_t count;
    struct pupil pupils[RINGS];
    double stop_reach2;          // [1] in squares of the stop's radius
    float half_x, half_y, reach; // [m] of the film; its largest distance from the axis
};

static const struct sr_param params[] = {
    {SR_PARAM_FILE, "lensfile", "1", 0, 0, NAN, offsetof(struct realistic, lens_file),
     "surfaces from the front: radius, thickness [mm], index, diameter [mm]"},
    {SR_PARAM_FLOAT, "aperturediameter", "mm", 0, INFINITY, 1, offsetof(struct realistic, aperture_diameter),
     "of the stop"},
    {SR_PARAM_FLOAT, "focusdistance", "m", 0, INFINITY, 10, offsetof(struct realistic, focus_distance),
     "from the film to what is sharp"},
    {SR_PARAM_STRING, "aperture", "1", 0, 0, NAN, offsetof(struct realistic, aperture),
     "shape of the stop: gaussian, square, pentagon, star, or an image; round if not given"},
    SENSOR_SHUTTER_ROWS(struct realistic),
    {0},
};

struct line {
    double o[3], d[3];
};

static bool normalize(double d[3])
{
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int i = 0; i < 3; ++i)
        d[i] /= length;
    return length > 0;
}

/* To the surface; n against the ray. */
static bool meet(const struct surface *s, struct line *r, double n[3])
{
    double t;
    if (s->radius == 0) {
        t = (s->z - r->o[2]) / r->d[2];
    } else {
        double c[3] = {r->o[0], r->o[1], r->o[2] - (s->z - s->radius)};
        double b = c[0] * r->d[0] + c[1] * r->d[1] + c[2] * r->d[2],
               q = c[0] * c[0] + c[1] * c[1] + c[2] * c[2] - s->radius * s->radius;
        double root = b * b - q;
        if (root < 0)
            return false;
        t = -b + ((r->d[2] > 0) == (s->radius > 0) ? sqrt(root) : -sqrt(root)); // the side of the vertex
    }
    if (!(t >= 0) || !isfinite(t))
        return false;
    for (int i = 0; i < 3; ++i)
        r->o[i] += t * r->d[i];
    if (s->radius != 0) {
        for (int i = 0; i < 3; ++i)
            n[i] = (r->o[i] - (i == 2 ? s->z - s->radius : 0)) / s->radius;
        double side = n[0] * r->d[0] + n[1] * r->d[1] + n[2] * r->d[2] > 0 ? -1 : 1;
        for (int i = 0; i < 3; ++i)
            n[i] *= side;
    }
    return true;
}

static bool refract(struct line *r, const double n[3], double eta) // eta: of here over there
{
    double cosine = -(n[0] * r->d[0] + n[1] * r->d[1] + n[2] * r->d[2]), sine2 = eta * eta * (1 - cosine * cosine);
    if (sine2 >= 1)
        return false;
    double change = eta * cosine - sqrt(1 - sine2);
    for (int i = 0; i < 3; ++i)
        r->d[i] = eta * r->d[i] + change * n[i];
    return normalize(r->d);
}

// bilinear, 0 outside
static double aperture_at(const struct sr_sensor_lens *l, double x, double y)
{
    double u = 0.5 * (x + 1) * l->aperture_width - 0.5, v = 0.5 * (y + 1) * l->aperture_height - 0.5, sum = 0;
    int i = (int)floor(u), j = (int)floor(v);
    for (int k = 0; k < 4; ++k) {
        int a = i + (k & 1), b = j + (k >> 1);
        double share = (k & 1 ? u - i : 1 - (u - i)) * (k >> 1 ? v - j : 1 - (v - j));
        if (a >= 0 && b >= 0 && a < (int)l->aperture_width && b < (int)l->aperture_height)
            sum += share * (double)l->aperture[(size_t)b * l->aperture_width + (size_t)a];
    }
    return sum;
}

/* How far from its middle a picture of the stop lets anything through, squared [1]; 1: the radius. */
static double reach_of(const struct sr_sensor_lens *l)
{
    double reach2 = 0;
    for (uint32_t j = 0; j < l->aperture_height; ++j)
        for (uint32_t i = 0; i < l->aperture_width; ++i) {
            // half a texel more, and as much again where it fades into the next
            double x = fabs(2 * (i + 0.5) / l->aperture_width - 1) + 2.0 / l->aperture_width,
                   y = fabs(2 * (j + 0.5) / l->aperture_height - 1) + 2.0 / l->aperture_height;
            if (l->aperture[(size_t)j * l->aperture_width + i] > 0)
                reach2 = fmax(reach2, x * x + y * y);
        }
    return reach2;
}

/* Through the lens, from the film or from the scene; what share gets through. As a whole: the stop is the disk about
 * its shape. */
static double pass(const struct realistic *s, struct line *r, bool from_film, bool as_whole)
{
    double share = 1, n[3];
    for (uint32_t k = 0; k < s->count; ++k) {
        const struct surface *e = &s->surfaces[from_film ? k : s->count - 1 - k];
        if (!meet(e, r, n))
            return 0;
        double distance2 = r->o[0] * r->o[0] + r->o[1] * r->o[1];
        if (e->radius == 0 && s->lens.aperture && !as_whole) {
            double radius = sqrt(e->aperture2);
            share *= aperture_at(&s->lens, r->o[0] / radius, r->o[1] / radius);
            if (!(share > 0))
                return 0;
        } else if (distance2 > e->aperture2 * (e->radius == 0 ? s->stop_reach2 : 1)) {
            return 0;
        }
        if (e->radius != 0 && !refract(r, n, from_film ? e->eta_rear / e->eta_front : e->eta_front / e->eta_rear))
            return 0;
    }
    return share;
}

/* ---- focus ---- */

static sr_status read_surfaces(struct realistic *s, struct sr_arena *arena, struct sr_error *error)
{
    const float *v = s->lens.surfaces;
    s->count = s->lens.surface_count;
    s->surfaces = sr_arena_alloc(arena, s->count * sizeof *s->surfaces);
    if (!s->surfaces)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a lens");
    double z = 0;
    for (uint32_t k = 0; k < s->count; ++k) {
        const float *e = v + 4 * (size_t)(s->count - 1 - k), *before = k + 1 < s->count ? e - 4 : NULL;
        double radius = 5e-4 * (double)(e[0] == 0 ? sr_min(e[3], s->aperture_diameter) : e[3]);
        z += 1e-3 * (double)e[1];
        s->surfaces[k] = (struct surface){.radius = 1e-3 * (double)e[0],
                                          .z = z,
                                          .aperture2 = radius * radius,
                                          .eta_rear = e[2] == 0 ? 1 : (double)e[2],
                                          .eta_front = before && before[2] != 0 ? (double)before[2] : 1};
    }
    return SR_OK;
}

/* Where a ray that comes in parallel to the axis crosses it (focus), and where its two straight parts meet (principal
 * plane). */
static bool cardinal_points(const struct realistic *s, bool from_film, double x, double *focus, double *plane)
{
    double front = s->surfaces[s->count - 1].z;
    struct line r = {{x, 0, from_film ? s->surfaces[0].z - 1 : front + 1}, {0, 0, from_film ? 1 : -1}};
    if (pass(s, &r, from_film, true) == 0 || r.d[0] == 0)
        return false;
    *focus = r.o[2] - r.o[0] / r.d[0] * r.d[2];
    *plane = r.o[2] + (x - r.o[0]) / r.d[0] * r.d[2];
    return true;
}

static sr_status focus(struct realistic *s, struct sr_error *error)
{
    double rear_focus, rear_plane, front_focus, front_plane, x = 0.001 * (double)s->lens.diagonal;
    if (!cardinal_points(s, false, x, &rear_focus, &rear_plane) ||
        !cardinal_points(s, true, x, &front_focus, &front_plane))
        return sr_fail(error, SR_ERROR_INPUT, "lensfile: rays near the axis do not get through the lens");
    double f = rear_plane - rear_focus, K = (double)s->focus_distance + rear_plane - front_plane;
    if (!(f > 0) || !(K > 4 * f))
        return sr_fail(
            error, SR_ERROR_INPUT,
            "focusdistance %g m is too short for a lens of the focal length %.4g mm: expected more than %.4g m",
            (double)s->focus_distance, 1e3 * f, 4 * f - rear_plane + front_plane);
    double shift = 0.5 * (K - sqrt(K * (K - 4 * f))) - rear_plane;
    if (!(s->surfaces[0].z + shift > 0))
        return sr_fail(error, SR_ERROR_INPUT, "lensfile: to be sharp at %g m the lens would stand behind the film",
                       (double)s->focus_distance);
    for (uint32_t k = 0; k < s->count; ++k)
        s->surfaces[k].z += shift;
    return SR_OK;
}

/* ---- exit pupils ---- */

static bool sees(const struct realistic *s, double film, double x, double y)
{
    struct line r = {{film, 0, 0}, {x - film, y, s->surfaces[0].z}};
    normalize(r.d);
    return pass(s, &r, true, true) > 0;
}

/* Bounds of what gets through, on a grid over a rectangle; film points are spread over the ring. */
static bool bound(const struct realistic *s, double r0, double r1, struct pupil in, struct pupil *out)
{
    *out = (struct pupil){INFINITY, -INFINITY, INFINITY, -INFINITY};
    float dx = (in.x1 - in.x0) / GRID, dy = (in.y1 - in.y0) / GRID;
    for (int j = 0; j < GRID; ++j)
        for (int i = 0; i < GRID; ++i) {
            float x = in.x0 + ((float)i + 0.5f) * dx, y = in.y0 + ((float)j + 0.5f) * dy;
            bool is_within = x >= out->x0 && x <= out->x1 && y >= out->y0 && y <= out->y1;
            if (is_within || !(sees(s, r0, (double)x, (double)y) || sees(s, r1, (double)x, (double)y) ||
                               sees(s, 0.5 * (r0 + r1), (double)x, (double)y)))
                continue;
            *out = (struct pupil){sr_min(out->x0, x), sr_max(out->x1, x), sr_min(out->y0, y), sr_max(out->y1, y)};
        }
    if (!(out->x0 <= out->x1))
        return false;
    // between two points of the grid the pupil may reach on
    *out = (struct pupil){out->x0 - 2 * dx, out->x1 + 2 * dx, out->y0 - 2 * dy, out->y1 + 2 * dy};
    return true;
}

static void find_pupils(struct realistic *s)
{
    float rear = 1.5f * (float)sqrt(s->surfaces[0].aperture2);
    struct pupil all = {-rear, rear, -rear, rear}, rough;
    for (int i = 0; i < RINGS; ++i) {
        double r0 = (double)s->reach * i / RINGS, r1 = (double)s->reach * (i + 1) / RINGS;
        if (!bound(s, r0, r1, all, &rough) || !bound(s, r0, r1, rough, &s->pupils[i]))
            s->pupils[i] = all;
    }
}

static sr_status check_surfaces(const struct sr_sensor_lens *l, struct sr_error *error)
{
    if (l->surface_count < 1)
        return sr_fail(error, SR_ERROR_INPUT,
                       "expected \"string lensfile\", with four numbers for each surface of the lens");
    for (uint32_t i = 0; i < l->surface_count; ++i) {
        const float *e = l->surfaces + 4 * (size_t)i;
        if (!isfinite(e[0]) || !(e[1] >= 0) || !isfinite(e[1]) || !(e[2] == 0 || (e[2] >= 1 && e[2] < 10)) ||
            !(e[3] > 0) || !isfinite(e[3]))
            return sr_fail(
                error, SR_ERROR_INPUT,
                "lensfile: surface %u is %g %g %g %g: expected a radius, a thickness of 0 or more [mm], an index of 1 to 10 or 0 "
                "for air, and a positive diameter [mm]",
                (unsigned)i + 1, (double)e[0], (double)e[1], (double)e[2], (double)e[3]);
    }
    return SR_OK;
}

static sr_status prepare(void *self, struct sr_sensor_raster raster, const struct sr_transform *camera_to_world,
                         struct sr_arena *arena, struct sr_error *error)
{
    struct realistic *s = self;
    if (sensor_common_prepare(&s->common, raster, camera_to_world, error) != SR_OK ||
        check_surfaces(&s->lens, error) != SR_OK)
        return error->status;
    if (!(s->aperture_diameter > 0) || !(s->lens.diagonal > 0) || !isfinite(s->lens.diagonal))
        return sr_fail(error, SR_ERROR_INPUT, "aperturediameter %g mm and the film's diagonal %g mm must be positive",
                       (double)s->aperture_diameter, 1e3 * (double)s->lens.diagonal);
    float width = (float)raster.width, height = (float)raster.height, pixel = s->lens.diagonal / hypotf(width, height);
    s->stop_reach2 = s->lens.aperture ? reach_of(&s->lens) : 1;
    s->half_x = 0.5f * pixel * width;
    s->half_y = 0.5f * pixel * height;
    s->reach = 0.5f * s->lens.diagonal + 8 * pixel; // filters look over the border
    if (read_surfaces(s, arena, error) != SR_OK || focus(s, error) != SR_OK)
        return error->status;
    find_pupils(s);
    return SR_OK;
}

/* ---- rays ---- */

static bool bare_ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    const struct realistic *s = self;
    float x = s->half_x * (1 - 2 * raster.x / (float)s->common.raster.width),
          y = s->half_y * (2 * raster.y / (float)s->common.raster.height - 1);
    float r = hypotf(x, y), c = r > 0 ? x / r : 1, sine = r > 0 ? y / r : 0;
    int ring = (int)(r / s->reach * RINGS);
    const struct pupil *p = &s->pupils[ring < RINGS ? ring : RINGS - 1];
    float a = sr_lerp(u_lens.x, p->x0, p->x1), b = sr_lerp(u_lens.y, p->y0, p->y1), z = (float)s->surfaces[0].z;
    struct line l = {{(double)x, (double)y, 0},
                     {(double)(c * a - sine * b - x), (double)(sine * a + c * b - y), (double)z}};
    normalize(l.d);
    float cosine = (float)l.d[2], share = (float)pass(s, &l, true, false);
    if (!(share > 0))
        return false;
    const struct sr_transform *t = &s->common.camera_to_world;
    sr_vec3 o = {(float)l.o[0], (float)l.o[1], (float)l.o[2]}, d = {(float)l.d[0], (float)l.d[1], (float)l.d[2]};
    *out = (struct sr_sensor_ray){
        .ray = {.o = sr_transform_point(t, o),
                .d = sr_normalize(sr_transform_vector(t, d)),
                .time = u_time,
                .t_max = INFINITY},
        .weight = share * sr_sqr(sr_sqr(cosine)) * (p->x1 - p->x0) * (p->y1 - p->y0) / (z * z),
    };
    return true;
}

static bool ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    if (!bare_ray(self, raster, u_lens, u_time, out))
        return false;
    struct sr_sensor_ray next;
    if (bare_ray(self, (sr_vec2){raster.x + 1, raster.y}, u_lens, u_time, &next)) {
        out->dodx = sr_sub(next.ray.o, out->ray.o);
        out->dddx = sr_sub(next.ray.d, out->ray.d);
    }
    if (bare_ray(self, (sr_vec2){raster.x, raster.y + 1}, u_lens, u_time, &next)) {
        out->dody = sr_sub(next.ray.o, out->ray.o);
        out->dddy = sr_sub(next.ray.d, out->ray.d);
    }
    return true;
}

const struct sr_sensor_model sr_sensor_realistic = {
    .name = "realistic",
    .params = params,
    .size = sizeof(struct realistic),
    .wants_lens = true,
    .prepare = prepare,
    .ray = ray,
    .bare_ray = bare_ray,
};
