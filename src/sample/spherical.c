/* SPDX-License-Identifier: MIT */
/* Directions drawn evenly from the solid angle of a triangle or a rectangle, pdf = 1 / Omega [1/sr].
 *
 * Triangle: with edges e1, e2, corners A, B, C seen from p, lengths a, b, c,
 *     tan(Omega / 2) = A.(e1 x e2) / (a b c + (A.B) c + (B.C) a + (C.A) b)
 * A point C' at angle s from A on the arc AC cuts off the share u of the area where, with t the unit tangent of the arc
 * at A, T = tan(u Omega / 2), V = t.(A x B), k = 1 + A.B (all of unit length), tan(s / 2) = T k / (V - T B.t). The
 * height within B C' is linear in 1 - cos. All is kept as differences from A or B: small triangles lose no digits.
 *
 * Rectangle: at distance z, in coordinates of its plane, with beta_i = y_i / sqrt(y_i^2 + z^2) and sigma = x / sqrt(x^2
 * + z^2), Omega(x0 … x) = theta(x) - theta(x0),    theta = asin(beta_1 sigma) - asin(beta_0 sigma) which inverts to
 * sigma = sin theta / sqrt(beta_0^2 + beta_1^2 - 2 beta_0 beta_1 cos theta);   y is linear in its sine.
 *
 * The maps are those of J. Arvo, Stratified Sampling of Spherical Triangles, 1995, and C. Urena, M. Fajardo & A. King,
 * An Area-Preserving Parametrization for Spherical Rectangles, 2013, solved without inverse cosines; the solid angle
 * is by A. Van Oosterom & J. Strackee, 1983. Seen edge-on or from a corner there is no solid angle: pdf 0. */
#include "sample/sample.h"

struct corners {
    sr_vec3 A, B, C, e1, e2; // [m] as seen from p
    float a, b, c;           // [m] distances
    float volume;            // [m^3]
};

static struct corners see(const sr_vec3 v[3], sr_vec3 p)
{
    struct corners t = {.A = sr_sub(v[0], p), .B = sr_sub(v[1], p), .C = sr_sub(v[2], p)};
    t.e1 = sr_sub(v[1], v[0]);
    t.e2 = sr_sub(v[2], v[0]);
    t.a = sr_length(t.A);
    t.b = sr_length(t.B);
    t.c = sr_length(t.C);
    t.volume = fabsf(sr_dot(t.A, sr_cross(t.e1, t.e2)));
    return t;
}

static float solid_angle(float volume, sr_vec3 A, sr_vec3 B, sr_vec3 C, float a, float b, float c)
{
    return 2 * atan2f(volume, a * b * c + sr_dot(A, B) * c + sr_dot(B, C) * a + sr_dot(C, A) * b);
}

// B / b - A / a, where e = B - A
static sr_vec3 unit_difference(sr_vec3 A, sr_vec3 B, sr_vec3 e, float a, float b)
{
    float longer = sr_dot(e, sr_add(A, B)) / (a + b); // b - a
    return sr_scale(1 / b, sr_mad(e, -longer / a, A));
}

// the part of d across the unit vector `from`, at whose tip d begins and on whose sphere it ends, at unit length
static sr_vec3 tangent(sr_vec3 from, sr_vec3 d)
{
    return sr_normalize(sr_mad(d, 0.5f * sr_length2(d), from));
}

// not edge-on, nor p within the triangle itself, where directions do not tell points apart
static bool is_usable(float omega)
{
    return omega > 1e-30f && omega < 6.2831f;
}

float sr_spherical_triangle_pdf(const sr_vec3 v[3], sr_vec3 p)
{
    struct corners t = see(v, p);
    float omega = solid_angle(t.volume, t.A, t.B, t.C, t.a, t.b, t.c);
    return is_usable(omega) ? 1 / omega : 0;
}

void sr_spherical_triangle_sample(const sr_vec3 v[3], sr_vec3 p, sr_vec2 u, float barycentric[3], float *pdf)
{
    struct corners t = see(v, p);
    float omega = solid_angle(t.volume, t.A, t.B, t.C, t.a, t.b, t.c);
    *pdf = 0;
    barycentric[0] = barycentric[1] = barycentric[2] = 1.0f / 3;
    if (!is_usable(omega))
        return;

    sr_vec3 a = sr_scale(1 / t.a, t.A), b = sr_scale(1 / t.b, t.B);
    sr_vec3 ab = unit_difference(t.A, t.B, t.e1, t.a, t.b), ac = unit_difference(t.A, t.C, t.e2, t.a, t.c);
    sr_vec3 along = tangent(a, ac);
    float S, C;
    sr_sin_cos_turn(u.x * omega * (0.25f * SR_INV_PI), &S, &C);
    float height = fabsf(sr_dot(along, sr_cross(a, ab)));
    float P = S * (1 + sr_dot(a, b)), Q = sr_max(0, C * height - S * sr_dot(ab, along));
    float size = P * P + Q * Q;
    // u.x = 0 leaves P = 0; where the arc is too short for floats, so is the triangle
    sr_vec3 ac2 =
        size > 0 ? sr_add(sr_scale(-2 * P * P / size, a), sr_scale(2 * P * Q / size, along)) : (sr_vec3){0, 0, 0};

    sr_vec3 chord = sr_sub(ac2, ab); // from b to c'
    float fall = 0.5f * u.y * sr_length2(chord);
    sr_vec3 dw = sr_sub(sr_scale(sr_safe_sqrt(fall * (2 - fall)), tangent(b, chord)), sr_scale(fall, b));
    sr_vec3 w = sr_add(b, dw);

    float whole = sr_dot(w, sr_cross(t.e1, t.e2));
    float alpha = sr_dot(dw, sr_cross(t.B, sr_sub(t.e2, t.e1))) / whole;
    float gamma = sr_dot(dw, sr_cross(t.A, t.e1)) / whole;
    if (!isfinite(alpha) || !isfinite(gamma))
        return;
    alpha = sr_clamp(alpha, 0, 1);
    gamma = sr_clamp(gamma, 0, 1 - alpha);
    barycentric[0] = alpha;
    barycentric[1] = 1 - alpha - gamma;
    barycentric[2] = gamma;
    *pdf = 1 / omega;
}

sr_vec2 sr_spherical_triangle_invert(const sr_vec3 v[3], sr_vec3 p, sr_vec3 w)
{
    struct corners t = see(v, p);
    float omega = solid_angle(t.volume, t.A, t.B, t.C, t.a, t.b, t.c);
    sr_vec3 b = sr_scale(1 / t.b, t.B), dw = sr_sub(w, b);
    float alpha = sr_dot(dw, sr_cross(t.B, sr_sub(t.e2, t.e1))), gamma = sr_dot(dw, sr_cross(t.A, t.e1));
    float share = alpha + gamma != 0 ? sr_clamp(gamma / (alpha + gamma), 0, 1) : 0;

    // where the great circle of b and w meets the arc from a to c
    sr_vec3 C2 = sr_mad(t.A, share, t.e2), e2 = sr_scale(share, t.e2);
    float c2 = sr_length(C2);
    float omega2 = solid_angle(share * t.volume, t.A, t.B, C2, t.a, t.b, c2);
    sr_vec3 chord = sr_sub(unit_difference(t.A, C2, e2, t.a, c2), unit_difference(t.A, t.B, t.e1, t.a, t.b));
    float chord2 = sr_length2(chord);
    float x = omega > 0 ? omega2 / omega : 0, y = chord2 > 0 ? sr_length2(dw) / chord2 : 0;
    return (sr_vec2){sr_clamp(x, 0, SR_ONE_MINUS_EPSILON), sr_clamp(y, 0, SR_ONE_MINUS_EPSILON)};
}

double sr_spherical_triangle_area(sr_vec3 a, sr_vec3 b, sr_vec3 c)
{
    double A[3] = {(double)a.x, (double)a.y, (double)a.z}, B[3] = {(double)b.x, (double)b.y, (double)b.z};
    double C[3] = {(double)c.x, (double)c.y, (double)c.z}, ab = 0, bc = 0, ca = 0, volume = 0;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        volume += A[i] * ((B[j] - A[j]) * (C[k] - A[k]) - (B[k] - A[k]) * (C[j] - A[j]));
        ab += A[i] * B[i];
        bc += B[i] * C[i];
        ca += C[i] * A[i];
    }
    return 2 * atan2(fabs(volume), 1 + ab + bc + ca);
}

/* The rectangle in its own coordinates, whose origin is p's foot on the plane. */
struct rectangle {
    double x0, x1, y0, y1, z; // [m]
    double width2, height2;   // [m^2] squared lengths of the edges
    double beta0, beta1;
    double sin0, cos0; // of theta(x0)
    float omega;       // [sr]
};

static double dot(sr_vec3 a, const double b[3])
{
    return (double)a.x * b[0] + (double)a.y * b[1] + (double)a.z * b[2];
}

static void theta(const struct rectangle *r, double sigma, double *s, double *c)
{
    double sin_p = r->beta1 * sigma, sin_q = r->beta0 * sigma;
    double cos_p = sqrt(fmax(0, 1 - sin_p * sin_p)), cos_q = sqrt(fmax(0, 1 - sin_q * sin_q));
    *s = sin_p * cos_q - cos_p * sin_q;
    *c = cos_p * cos_q + sin_p * sin_q;
}

static bool see_rectangle(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey, struct rectangle *r)
{
    double d[3] = {(double)s.x - (double)p.x, (double)s.y - (double)p.y, (double)s.z - (double)p.z};
    double u[3] = {(double)ex.x, (double)ex.y, (double)ex.z}, v[3] = {(double)ey.x, (double)ey.y, (double)ey.z};
    r->width2 = dot(ex, u);
    r->height2 = dot(ey, v);
    double width = sqrt(r->width2), height = sqrt(r->height2), volume = 0;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        volume += d[i] * (u[j] * v[k] - u[k] * v[j]);
    }
    double area = width * height, z = fabs(volume) / area;
    double x0 = dot(ex, d) / width, y0 = dot(ey, d) / height, x1 = x0 + width, y1 = y0 + height, z2 = z * z;
    if (!(z > 1e-9 * (fabs(x0) + fabs(y0) + width + height)) || !isfinite(z))
        return false;

    // two triangles that share the diagonal, their half angles added as a complex product
    double c00 = sqrt(x0 * x0 + y0 * y0 + z2), c10 = sqrt(x1 * x1 + y0 * y0 + z2);
    double c01 = sqrt(x0 * x0 + y1 * y1 + z2), c11 = sqrt(x1 * x1 + y1 * y1 + z2);
    double diagonal = x0 * x1 + y0 * y1 + z2, n = z * area;
    double lower = c00 * c10 * c11 + (x0 * x1 + y0 * y0 + z2) * c11 + (x1 * x1 + y0 * y1 + z2) * c00 + diagonal * c10;
    double upper = c00 * c11 * c01 + diagonal * c01 + (x0 * x1 + y1 * y1 + z2) * c00 + (x0 * x0 + y0 * y1 + z2) * c11;
    double scale = 1 / (c00 * c11 * (c10 * c11 * c00 * c01)); // keeps tiny and huge scenes within floats
    r->omega = 2 * atan2f((float)(n * (lower + upper) * scale), (float)((lower * upper - n * n) * scale));
    r->x0 = x0;
    r->x1 = x1;
    r->y0 = y0;
    r->y1 = y1;
    r->z = z;
    r->beta0 = y0 / sqrt(y0 * y0 + z2);
    r->beta1 = y1 / sqrt(y1 * y1 + z2);
    theta(r, x0 / sqrt(x0 * x0 + z2), &r->sin0, &r->cos0);
    return r->omega > 0;
}

float sr_spherical_rectangle_pdf(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey)
{
    struct rectangle r;
    return see_rectangle(p, s, ex, ey, &r) ? 1 / r.omega : 0;
}

sr_vec3 sr_spherical_rectangle_sample(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey, sr_vec2 u, float *pdf)
{
    struct rectangle r;
    *pdf = 0;
    if (!see_rectangle(p, s, ex, ey, &r))
        return sr_add(s, sr_scale(0.5f, sr_add(ex, ey)));

    float s_half, c_half;
    sr_sin_cos_turn(u.x * r.omega * (0.25f * SR_INV_PI), &s_half, &c_half);
    double sin_half = (double)s_half, cos_a = 1 - 2 * sin_half * sin_half, sin_a = 2 * sin_half * (double)c_half;
    double sin_t = sin_a * r.cos0 + cos_a * r.sin0, cos_t = cos_a * r.cos0 - sin_a * r.sin0;
    double below = r.beta0 * r.beta0 + r.beta1 * r.beta1 - 2 * r.beta0 * r.beta1 * cos_t;
    // sin^2 of the arc from the foot to x: x / z = tan
    double across = below - sin_t * sin_t;
    double x = across > 0 ? r.z * sin_t / sqrt(across) : sin_t < 0 ? r.x0 : r.x1;
    x = fmin(fmax(x, r.x0), r.x1);

    double d2 = x * x + r.z * r.z;
    double h0 = r.y0 / sqrt(r.y0 * r.y0 + d2), h1 = r.y1 / sqrt(r.y1 * r.y1 + d2), h = h0 + (double)u.y * (h1 - h0);
    double y = 1 - h * h > 0 ? h * sqrt(d2 / (1 - h * h)) : r.y1;
    y = fmin(fmax(y, r.y0), r.y1);

    *pdf = 1 / r.omega;
    float a = (float)((x - r.x0) / (r.x1 - r.x0)), b = (float)((y - r.y0) / (r.y1 - r.y0));
    return sr_mad(sr_mad(s, a, ex), b, ey);
}

sr_vec2 sr_spherical_rectangle_invert(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey, sr_vec3 on_rectangle)
{
    struct rectangle r;
    if (!see_rectangle(p, s, ex, ey, &r))
        return (sr_vec2){0.5f, 0.5f};
    double d[3] = {(double)on_rectangle.x - (double)s.x, (double)on_rectangle.y - (double)s.y,
                   (double)on_rectangle.z - (double)s.z};
    double x = r.x0 + dot(ex, d) / r.width2 * (r.x1 - r.x0), y = r.y0 + dot(ey, d) / r.height2 * (r.y1 - r.y0);
    double d2 = x * x + r.z * r.z, sin_t, cos_t;
    theta(&r, x / sqrt(d2), &sin_t, &cos_t);
    float a = atan2f((float)(sin_t * r.cos0 - cos_t * r.sin0), (float)(cos_t * r.cos0 + sin_t * r.sin0));
    a = a < -0.1f ? a + 2 * SR_PI : a;
    double h0 = r.y0 / sqrt(r.y0 * r.y0 + d2), h1 = r.y1 / sqrt(r.y1 * r.y1 + d2), h = y / sqrt(y * y + d2);
    return (sr_vec2){sr_clamp(a / r.omega, 0, SR_ONE_MINUS_EPSILON),
                     sr_clamp((float)((h - h0) / (h1 - h0)), 0, SR_ONE_MINUS_EPSILON)};
}
