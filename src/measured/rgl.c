/* SPDX-License-Identifier: MIT */
/* RGL's adaptive measurements: for each direction of view a map that spends its cells where the microfacets are seen.
 *
 *     m = (wo + wi) / |wo + wi|,  u_m = (sqrt(2 theta_m / pi), (phi_m + pi) / (2 pi));  isotropic: phi_m - phi_o
 *     s = position of u_m under the marginal and conditional distributions of vndf(. | phi_o, theta_o)
 *     f |cos_theta_i| = spectra(s | phi_o, theta_o, lambda) [ndf(u_m) / (4 sigma(u_o)) where jacobian = 1]
 *
 * J. Dupuy & W. Jakob, An adaptive parameterization for efficient material acquisition and rendering, 2018. The product
 * contains the cosine. Slices are linear in phi_o and theta_o; phi that covers 1/2 or 1/4 of a turn stands for all of
 * it by symmetry. Fields: theta_i, phi_i, ndf, sigma, vndf [phi, theta, y, x], spectra [phi, theta, lambda, y, x] with
 * wavelengths, or rgb [phi, theta, 3, y, x]; jacobian; luminance is what others draw directions by, here guide.c does.
 */
#include "measured/private.h"

#define LEAST_COSINE                                                                                                   \
    0.02f // closer to grazing no instrument looks, and interpolated products do not vanish as the cosine does

struct map { // a bilinear function of the unit square
    int nx, ny;
    float *values;
};

struct warp { // slices of a bilinear density and its integrals, in units of cells
    int nx, ny;
    float *density;     // slice, y, x
    float *conditional; // integral of a row up to x
    float *marginal;    // integral of all rows up to y; 1 at the end
};

struct rgl {
    int thetas, phis, reduction;
    float *theta, *phi;
    bool is_isotropic, has_jacobian;
    struct map ndf, sigma;
    struct warp vndf;
    int nx, ny; // of spectra
    float *spectra;
    struct channels channels;
};

static float map_at(const struct map *m, float x, float y)
{
    x = sr_clamp(x, 0, 1) * (float)(m->nx - 1);
    y = sr_clamp(y, 0, 1) * (float)(m->ny - 1);
    int i = (int)x < m->nx - 2 ? (int)x : m->nx - 2, j = (int)y < m->ny - 2 ? (int)y : m->ny - 2;
    x -= (float)i;
    y -= (float)j;
    const float *v = m->values + j * m->nx + i;
    return (1 - y) * ((1 - x) * v[0] + x * v[1]) + y * ((1 - x) * v[m->nx] + x * v[m->nx + 1]);
}

/* Integrals of each slice; false: a slice is zero everywhere. The density is normalised in place. */
static bool warp_finish(struct warp *w, int slices)
{
    size_t cells = (size_t)w->nx * (size_t)w->ny;
    for (int s = 0; s < slices; ++s) {
        float *density = w->density + (size_t)s * cells, *conditional = w->conditional + (size_t)s * cells;
        float *marginal = w->marginal + (size_t)s * (size_t)w->ny;
        double total = 0, before = 0;
        for (int y = 0; y < w->ny; ++y) {
            double row = 0;
            for (int x = 0; x < w->nx; ++x) {
                row += x ? 0.5 * ((double)density[y * w->nx + x - 1] + (double)density[y * w->nx + x]) : 0;
                conditional[y * w->nx + x] = (float)row;
            }
            total += y ? 0.5 * (before + row) : 0;
            marginal[y] = (float)total;
            before = row;
        }
        if (!(total > 0) || !isfinite(total))
            return false;
        for (size_t k = 0; k < cells; ++k) {
            density[k] = (float)((double)density[k] / total);
            conditional[k] = (float)((double)conditional[k] / total);
        }
        for (int y = 0; y < w->ny; ++y)
            marginal[y] = (float)((double)marginal[y] / total);
    }
    return true;
}

struct slices { // neighbours in phi_o and theta_o
    int count, slice[4];
    float weight[4];
};

static float mixed(const float *values, size_t stride, const struct slices *s, size_t at)
{
    float sum = 0;
    for (int k = 0; k < s->count; ++k)
        sum += s->weight[k] * values[(size_t)s->slice[k] * stride + at];
    return sum;
}

/* Where u lies: the share of the mass below its row, and that of the mass before it in its row. */
static sr_vec2 warp_invert(const struct warp *w, const struct slices *s, sr_vec2 u)
{
    float x = sr_clamp(u.x, 0, 1) * (float)(w->nx - 1), y = sr_clamp(u.y, 0, 1) * (float)(w->ny - 1);
    int i = (int)x < w->nx - 2 ? (int)x : w->nx - 2, j = (int)y < w->ny - 2 ? (int)y : w->ny - 2;
    x -= (float)i;
    y -= (float)j;
    size_t stride = (size_t)w->nx * (size_t)w->ny, at = (size_t)j * (size_t)w->nx + (size_t)i, up = at + (size_t)w->nx;
    size_t end = (size_t)j * (size_t)w->nx + (size_t)w->nx - 1;
    float a = (1 - y) * mixed(w->density, stride, s, at) + y * mixed(w->density, stride, s, up);
    float b = (1 - y) * mixed(w->density, stride, s, at + 1) + y * mixed(w->density, stride, s, up + 1);
    float before = (1 - y) * mixed(w->conditional, stride, s, at) + y * mixed(w->conditional, stride, s, up);
    float r0 = mixed(w->conditional, stride, s, end), r1 = mixed(w->conditional, stride, s, end + (size_t)w->nx);
    float row = (1 - y) * r0 + y * r1;
    float below = mixed(w->marginal, (size_t)w->ny, s, (size_t)j);
    return (sr_vec2){row > 0 ? sr_min(1, (before + x * (a + 0.5f * x * (b - a))) / row) : 0,
                     sr_min(1, below + y * (r0 + 0.5f * y * (r1 - r0)))};
}

static float angle_from_z(sr_vec3 w)
{
    return atan2f(sqrtf(w.x * w.x + w.y * w.y), w.z);
}

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct rgl *r = data;
    if (r->reduction >= 2) {
        float sy = wo.y > 0 ? -1 : 1, sx = r->reduction == 4 ? (wo.x > 0 ? -1.f : 1.f) : sy;
        wo = (sr_vec3){wo.x * sx, wo.y * sy, wo.z};
        wi = (sr_vec3){wi.x * sx, wi.y * sy, wi.z};
    }
    sr_vec3 m = sr_add(wo, wi);
    float length2 = sr_length2(m);
    if (!(length2 > 0) || !(wi.z > 0))
        return SR_BLACK;
    m = sr_scale(1 / sqrtf(length2), m);
    float theta_o = angle_from_z(wo), phi_o = wo.x != 0 || wo.y != 0 ? atan2f(wo.y, wo.x) : 0;
    float phi_m = m.x != 0 || m.y != 0 ? atan2f(m.y, m.x) : 0, t[2];
    sr_vec2 u_o = {sqrtf(theta_o * (2 / SR_PI)), (phi_o + SR_PI) * (0.5f * SR_INV_PI)};
    sr_vec2 u_m = {sqrtf(angle_from_z(m) * (2 / SR_PI)),
                   ((r->is_isotropic ? phi_m - phi_o : phi_m) + SR_PI) * (0.5f * SR_INV_PI)};
    u_m.y -= floorf(u_m.y);
    int j = axis_find(r->theta, r->thetas, theta_o, &t[0]), i = 0;
    t[1] = 0;
    if (!r->is_isotropic)
        i = axis_find(r->phi, r->phis, phi_o, &t[1]);
    struct slices s = {0};
    for (int k = 0; k < 4; ++k) {
        float w = (k & 1 ? t[0] : 1 - t[0]) * (k & 2 ? t[1] : 1 - t[1]);
        if (w > 0) {
            s.slice[s.count] = (i + (k >> 1)) * r->thetas + j + (k & 1);
            s.weight[s.count++] = w;
        }
    }
    sr_vec2 p = warp_invert(&r->vndf, &s, u_m);
    float x = p.x * (float)(r->nx - 1), y = p.y * (float)(r->ny - 1);
    int ix = (int)x < r->nx - 2 ? (int)x : r->nx - 2, iy = (int)y < r->ny - 2 ? (int)y : r->ny - 2;
    x -= (float)ix;
    y -= (float)iy;
    struct corners at = {0};
    size_t slice = (size_t)r->nx * (size_t)r->ny * (size_t)r->channels.count;
    for (int k = 0; k < 4 * s.count; ++k) {
        float w = s.weight[k >> 2] * (k & 1 ? x : 1 - x) * (k & 2 ? y : 1 - y);
        if (!(w > 0))
            continue;
        at.base[at.count] =
            (size_t)s.slice[k >> 2] * slice + (size_t)(iy + (k >> 1 & 1)) * (size_t)r->nx + (size_t)(ix + (k & 1));
        at.weight[at.count++] = w;
    }
    float scale = 1 / sr_max(wi.z, LEAST_COSINE);
    if (r->has_jacobian) {
        float sigma = map_at(&r->sigma, u_o.x, u_o.y);
        scale = sigma > 0 ? scale * map_at(&r->ndf, u_m.x, u_m.y) / (4 * sigma) : 0;
    }
    scale = sr_min(scale, 1e12f); // of a sigma that makes no sense
    return scale > 0 ? channels_eval(&r->channels, r->spectra, &at, lambda) * scale : SR_BLACK;
}

static bool read_map(const struct tensor_file *t, const char *name, struct map *map)
{
    const struct tensor_field *field = tensor_need(t, name, TENSOR_F32, 2);
    if (!field)
        return false;
    if (field->shape[0] < 2 || field->shape[1] < 2 || field->count > 1u << 28) {
        fail_at(t->source, 0, "field %s is of %llu x %llu values, at least 2 x 2 are expected", name,
                (unsigned long long)field->shape[0], (unsigned long long)field->shape[1]);
        return false;
    }
    map->ny = (int)field->shape[0];
    map->nx = (int)field->shape[1];
    map->values = tensor_floats(t, field, 0);
    return map->values != NULL;
}

static bool read_angles(const struct tensor_file *t, const char *name, float lo, float hi, int *count, float **angles)
{
    const struct tensor_field *field = tensor_need(t, name, TENSOR_F32, 1);
    if (!field)
        return false;
    *angles = tensor_floats(t, field, lo);
    if (!*angles)
        return false;
    *count = (int)field->count;
    bool ok = field->count >= 1 && field->count < 100000 && (*angles)[field->count - 1] <= hi;
    for (uint64_t i = 1; ok && i < field->count; ++i)
        ok = (*angles)[i] > (*angles)[i - 1];
    if (!ok)
        fail_at(t->source, 0, "field %s: one or more angles are expected, increasing, up to %g rad", name, (double)hi);
    return ok;
}

/* vndf and spectra must fit to the angles */
static bool fits(const struct tensor_file *t, const struct rgl *r, const struct tensor_field *field)
{
    bool ok = field->shape[0] == (uint64_t)r->phis && field->shape[1] == (uint64_t)r->thetas &&
              field->shape[field->dimensions - 1] >= 2 && field->shape[field->dimensions - 2] >= 2 &&
              field->count < 1u << 31;
    if (!ok)
        fail_at(t->source, 0,
                "field %s: its first sizes are %llu and %llu, %d of phi_i and %d of theta_i are expected, then maps of "
                "at least 2 x 2",
                field->name, (unsigned long long)field->shape[0], (unsigned long long)field->shape[1], r->phis,
                r->thetas);
    return ok;
}

static bool read_spectra(const struct tensor_file *t, struct rgl *r, struct sr_measured *m)
{
    const struct source *s = t->source;
    const struct tensor_field *spectra = tensor_find(t, "spectra"), *rgb = tensor_find(t, "rgb");
    const struct tensor_field *field = tensor_need(t, spectra || !rgb ? "spectra" : "rgb", TENSOR_F32, 5);
    if (!field || !fits(t, r, field))
        return false;
    if (spectra) {
        const struct tensor_field *wavelengths = tensor_need(t, "wavelengths", TENSOR_F32, 1);
        float *lambda = wavelengths ? tensor_floats(t, wavelengths, 0) : NULL;
        if (!lambda)
            return false;
        if (wavelengths->count == 0 || wavelengths->count > MAX_CHANNELS || wavelengths->count != field->shape[2] ||
            !channels_set_lambda(&r->channels, lambda, (int)wavelengths->count)) {
            fail_at(s, 0, "field wavelengths: %llu increasing ones are expected by the shape of spectra",
                    (unsigned long long)field->shape[2]);
            return false;
        }
    } else {
        r->channels = (struct channels){.kind = CHANNEL_RGB, .count = 3};
        if (field->shape[2] != 3) {
            fail_at(s, 0, "field rgb has %llu channels, 3 are expected", (unsigned long long)field->shape[2]);
            return false;
        }
    }
    r->ny = (int)field->shape[3];
    r->nx = (int)field->shape[4];
    r->channels.stride = (size_t)r->nx * (size_t)r->ny;
    r->spectra = tensor_floats(t, field, -1e15f);
    for (uint64_t k = 0; r->spectra && k < field->count; ++k)
        if (r->spectra[k] < 0) { // noise about zero
            r->spectra[k] = 0;
            m->invalid++;
        }
    m->values = field->count;
    return r->spectra != NULL;
}

static void read_description(const struct tensor_file *t, struct sr_measured *m)
{
    const struct tensor_field *d = tensor_find(t, "description");
    if (!d || d->type != TENSOR_U8 || d->count > 4096)
        return;
    char *text = sr_arena_alloc(t->source->arena, d->count + 1);
    for (uint64_t i = 0; text && i < d->count; ++i)
        text[i] = d->data[i] >= 32 && d->data[i] < 127 ? d->data[i] : ' ';
    m->description = text ? text : "";
}

sr_status read_rgl(const struct tensor_file *t, struct sr_measured *m)
{
    const struct source *s = t->source;
    struct rgl *r = sr_arena_alloc(s->arena, sizeof *r);
    if (!r)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    if (!read_angles(t, "theta_i", 0, 1.5709f, &r->thetas, &r->theta) ||
        !read_angles(t, "phi_i", -6.2833f, 6.2833f, &r->phis, &r->phi) || !read_map(t, "ndf", &r->ndf) ||
        !read_map(t, "sigma", &r->sigma))
        return SR_ERROR_INPUT;
    const struct tensor_field *vndf = tensor_need(t, "vndf", TENSOR_F32, 4), *jacobian = tensor_find(t, "jacobian");
    if (!vndf || !fits(t, r, vndf) || !read_spectra(t, r, m))
        return SR_ERROR_INPUT;
    r->is_isotropic = r->phis <= 2;
    r->has_jacobian = !jacobian || jacobian->type != TENSOR_U8 || jacobian->count != 1 || jacobian->data[0] != 0;
    float turns = r->is_isotropic ? 1 : rintf(2 * SR_PI / (r->phi[r->phis - 1] - r->phi[0]));
    if (turns != 1 && turns != 2 && turns != 4) // compared as it is: angles that nearly meet make it larger than an int
        return fail_at(s, 0, "field phi_i covers 1/%.0f of a turn, 1/1, 1/2 or 1/4 are expected", (double)turns);
    r->reduction = (int)turns;
    int slices = r->phis * r->thetas;
    r->vndf = (struct warp){.nx = (int)vndf->shape[3], .ny = (int)vndf->shape[2]};
    r->vndf.density = tensor_floats(t, vndf, 0);
    if (!r->vndf.density)
        return SR_ERROR_INPUT;
    r->vndf.conditional = sr_arena_alloc(s->arena, vndf->count * sizeof(float));
    r->vndf.marginal = sr_arena_alloc(s->arena, (size_t)slices * (size_t)r->vndf.ny * sizeof(float));
    if (!r->vndf.conditional || !r->vndf.marginal)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    if (!warp_finish(&r->vndf, slices))
        return fail_at(s, 0, "field vndf is zero everywhere in a slice");
    read_description(t, m);
    m->format = SR_MEASURED_RGL;
    m->data = r;
    m->f = f;
    m->channels = r->channels;
    m->sides = SR_MEASURED_REFLECTION;
    m->is_isotropic = r->is_isotropic;
    m->theta_i[0] = r->theta[0];
    m->theta_i[1] = r->theta[r->thetas - 1];
    m->theta_o[1] = SR_PI / 2;
    m->coverage = sr_sqr(sinf(m->theta_i[1])) - sr_sqr(sinf(m->theta_i[0]));
    m->note =
        jacobian ? "" : "the file does not say whether it contains the Jacobian: taken as 1, as in the published ones";
    return SR_OK;
}

/* ---- writing ---- */

/* u for a position s: the inverse of warp_invert, for one slice */
static sr_vec2 warp_sample(const struct warp *w, int slice, sr_vec2 s)
{
    const float *density = w->density + (size_t)slice * (size_t)w->nx * (size_t)w->ny;
    const float *conditional = w->conditional + (size_t)slice * (size_t)w->nx * (size_t)w->ny;
    const float *marginal = w->marginal + (size_t)slice * (size_t)w->ny;
    int j = 0, i = 0;
    while (j < w->ny - 2 && marginal[j + 1] <= s.y)
        ++j;
    double r0 = (double)conditional[j * w->nx + w->nx - 1], r1 = (double)conditional[(j + 1) * w->nx + w->nx - 1];
    double rest = (double)s.y - (double)marginal[j]; // = y r0 + y^2 (r1 - r0) / 2
    double y = rest > 0 ? 2 * rest / (r0 + sqrt(fmax(r0 * r0 + 2 * rest * (r1 - r0), 0))) : 0;
    y = y < 1 ? y : 1;
    const float *a = density + j * w->nx, *c = conditional + j * w->nx;
    double target = (double)s.x * ((1 - y) * r0 + y * r1);
    while (i < w->nx - 2 && (1 - y) * (double)c[i + 1] + y * (double)c[i + 1 + w->nx] <= target)
        ++i;
    double d0 = (1 - y) * (double)a[i] + y * (double)a[i + w->nx],
           d1 = (1 - y) * (double)a[i + 1] + y * (double)a[i + 1 + w->nx];
    rest = target - ((1 - y) * (double)c[i] + y * (double)c[i + w->nx]);
    double x = rest > 0 ? 2 * rest / (d0 + sqrt(fmax(d0 * d0 + 2 * rest * (d1 - d0), 0))) : 0;
    x = x < 1 ? x : 1;
    return (sr_vec2){(float)((i + x) / (w->nx - 1)), (float)((j + y) / (w->ny - 1))};
}

struct plan { // the arrays of a file to be
    struct sr_measured_rgl_grid g;
    int n; // cells of ndf, sigma and vndf along each axis
    float *theta, *lambda, *ndf, *sigma, *vndf, *luminance, *spectra;
};

static sr_vec3 polar(double theta, double phi)
{
    return (sr_vec3){(float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta)};
}

/* Any positive density would do; this one follows f where it is large: mean of f over some pairs about each half
 * vector, times the cosine. sigma is the projected area that belongs to it, vndf the density of what is seen. */
static void plan_microfacets(struct plan *p, sr_measured_source source, void *user)
{
    int n = p->n;
    sr_spectrum lambda = SR_BLACK;
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
        lambda[k] = p->lambda[k * (p->g.lambda_count - 1) / (SR_LAMBDA_COUNT - 1)];
    double D[256], most = 0;
    for (int i = 0; i < n; ++i) {
        double u = (double)i / (n - 1), theta = PI / 2 * u * u, sum = 0;
        int pairs = 0;
        for (int k = 0; k < 6; ++k) {
            sr_vec3 wo, wi;
            half_difference_directions(fmin(theta, 1.55), 0.02 + 0.35 * (k >> 1), k & 1 ? PI / 2 : 0.3, &wo, &wi);
            if (wo.z > 0 && wi.z > 0) {
                sum += (double)sr_spectrum_mean(source(user, wo, wi, lambda));
                ++pairs;
            }
        }
        D[i] = pairs ? sum / pairs * cos(fmin(theta, 1.55)) : 0;
        most = fmax(most, D[i]);
    }
    for (int i = 0; i < n; ++i) {
        D[i] = most > 0 ? fmax(D[i], 1e-5 * most) : 1;
        for (int j = 0; j < n; ++j)
            p->ndf[j * n + i] = (float)D[i];
    }
    struct map ndf = {n, n, p->ndf};
    enum { Q = 128 };
    for (int i = 0; i < n; ++i) { // sigma(w) = INTEGRAL of D(m) max(w.m, 0) dm
        double u = (double)i / (n - 1), sum = 0;
        sr_vec3 w = polar(PI / 2 * u * u, 0);
        for (int a = 0; a < Q; ++a) {
            double v = (a + 0.5) / Q, theta = PI / 2 * v * v;
            for (int b = 0; b < Q / 2; ++b) {
                double c = (double)sr_dot(w, polar(theta, PI * (b + 0.5) / (Q / 2)));
                sum += c > 0 ? (double)map_at(&ndf, (float)v, 0.5f) * c * sin(theta) * PI * v : 0;
            }
        }
        for (int j = 0; j < n; ++j)
            p->sigma[j * n + i] = (float)(sum * 2 * PI / Q / (Q / 2));
    }
    for (int t = 0; t < p->g.theta_count; ++t) {
        sr_vec3 wo = polar((double)p->theta[t], 0);
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                double u = (double)i / (n - 1), theta = PI / 2 * u * u;
                double c = (double)sr_dot(wo, polar(theta, 2 * PI * j / (n - 1) - PI));
                p->vndf[((size_t)t * (size_t)n + (size_t)j) * (size_t)n + (size_t)i] =
                    (float)(D[i] * fmax(c, 0) * u * sin(theta) + 1e-7 * D[0]);
            }
    }
}

static bool plan_spectra(struct plan *p, sr_measured_source source, void *user)
{
    int n = p->n, N = p->g.resolution;
    size_t cells = (size_t)p->g.theta_count * (size_t)n * (size_t)n;
    struct warp w = {.nx = n, .ny = n};
    w.density = sr_alloc(cells * sizeof(float));
    w.conditional = sr_alloc(cells * sizeof(float));
    w.marginal = sr_alloc((size_t)p->g.theta_count * (size_t)n * sizeof(float));
    bool ok = w.density && w.conditional && w.marginal;
    if (ok)
        memcpy(w.density, p->vndf, cells * sizeof(float));
    ok = ok && warp_finish(&w, p->g.theta_count);
    struct map ndf = {n, n, p->ndf}, sigma = {n, n, p->sigma};
    for (int t = 0; ok && t < p->g.theta_count; ++t)
        for (int j = 0; j < N; ++j)
            for (int i = 0; i < N; ++i) {
                sr_vec2 u = warp_sample(&w, t, (sr_vec2){(float)i / (float)(N - 1), (float)j / (float)(N - 1)});
                sr_vec3 wo = polar((double)p->theta[t], 0);
                double theta_m = PI / 2 * (double)u.x * (double)u.x;
                sr_vec3 m = polar(theta_m, 2 * PI * (double)u.y - PI);
                float c = sr_dot(wo, m), sum = 0;
                sr_vec3 wi = sr_sub(sr_scale(2 * c, m), wo);
                bool seen = c > 0 && wi.z > 1e-4f;
                float scale = 4 * map_at(&sigma, sqrtf(p->theta[t] * (2 / SR_PI)), 0.5f) / map_at(&ndf, u.x, u.y);
                for (int k = 0; k < p->g.lambda_count; k += SR_LAMBDA_COUNT) {
                    sr_spectrum lambda = SR_BLACK, f = SR_BLACK;
                    for (int b = 0; b < SR_LAMBDA_COUNT; ++b)
                        lambda[b] = p->lambda[k + b < p->g.lambda_count ? k + b : p->g.lambda_count - 1];
                    if (seen)
                        f = source(user, wo, wi, lambda) * (wi.z * scale);
                    for (int b = 0; b < SR_LAMBDA_COUNT && k + b < p->g.lambda_count; ++b) {
                        p->spectra[(((size_t)t * (size_t)p->g.lambda_count + (size_t)(k + b)) * (size_t)N + (size_t)j) *
                                       (size_t)N +
                                   (size_t)i] = f[b];
                        sum += f[b];
                    }
                }
                p->luminance[((size_t)t * (size_t)N + (size_t)j) * (size_t)N + (size_t)i] =
                    sr_max(sum / (float)p->g.lambda_count, 1e-6f);
            }
    sr_free(w.density);
    sr_free(w.conditional);
    sr_free(w.marginal);
    return ok;
}

struct field_to_write {
    const char *name;
    uint8_t type, dimensions;
    const void *data;
    uint64_t shape[5];
};

static void put(char **at, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; ++i)
        *(*at)++ = (char)(value >> (8 * i) & 255);
}

static sr_status write_fields(const char *path, const struct field_to_write *fields, int count, struct sr_error *error)
{
    size_t header = 12 + 2 + 4, size;
    for (int i = 0; i < count; ++i)
        header += 2 + strlen(fields[i].name) + 2 + 1 + 8 + 8 * (size_t)fields[i].dimensions;
    size = header = (header + 7) / 8 * 8;
    size_t bytes[16];
    for (int i = 0; i < count; ++i) {
        bytes[i] = fields[i].type == TENSOR_F32 ? 4 : 1;
        for (int k = 0; k < fields[i].dimensions; ++k)
            bytes[i] *= (size_t)fields[i].shape[k];
        size += (bytes[i] + 7) / 8 * 8;
    }
    char *file = sr_alloc(size), *at = file;
    if (!file)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
    memcpy(at, "tensor_file", 12);
    at += 12;
    put(&at, 1, 2);
    put(&at, (uint64_t)count, 4);
    size_t offset = header;
    for (int i = 0; i < count; ++i) {
        size_t length = strlen(fields[i].name);
        put(&at, length, 2);
        memcpy(at, fields[i].name, length);
        at += length;
        put(&at, fields[i].dimensions, 2);
        put(&at, fields[i].type, 1);
        put(&at, offset, 8);
        for (int k = 0; k < fields[i].dimensions; ++k)
            put(&at, fields[i].shape[k], 8);
        memcpy(file + offset, fields[i].data, bytes[i]);
        offset += (bytes[i] + 7) / 8 * 8;
    }
    sr_status status = sr_file_write(path, file, size, error);
    sr_free(file);
    return status;
}

sr_status sr_measured_write_rgl(const char *path, const struct sr_measured_rgl_grid *grid, sr_measured_source source,
                                void *user, struct sr_error *error)
{
    struct plan p = {.g = grid ? *grid : (struct sr_measured_rgl_grid){0}, .n = 64};
    struct sr_measured_rgl_grid *g = &p.g;
    g->theta_count = g->theta_count ? g->theta_count : 16;
    g->resolution = g->resolution ? g->resolution : 32;
    g->lambda_count = g->lambda_count ? g->lambda_count : 16;
    g->lambda_min = g->lambda_min > 0 ? g->lambda_min : 360;
    g->lambda_max = g->lambda_max > 0 ? g->lambda_max : 810;
    if (g->theta_count < 2 || g->theta_count > 256 || g->resolution < 2 || g->resolution > 512 || g->lambda_count < 2 ||
        g->lambda_count > 1024 || g->lambda_max <= g->lambda_min)
        return sr_fail(
            error, SR_ERROR_USAGE,
            "%s: 2 to 256 polar angles, a resolution of 2 to 512 and 2 to 1024 increasing wavelengths are expected",
            path);
    p.n = g->resolution > 64 ? (g->resolution < 256 ? g->resolution : 256) : 64;
    size_t T = (size_t)g->theta_count, N2 = (size_t)g->resolution * (size_t)g->resolution, L = (size_t)g->lambda_count,
           n2 = (size_t)p.n * (size_t)p.n;
    struct sr_arena arena = {0};
    p.theta = sr_arena_alloc(&arena, T * sizeof(float));
    p.lambda = sr_arena_alloc(&arena, L * sizeof(float));
    p.ndf = sr_arena_alloc(&arena, n2 * sizeof(float));
    p.sigma = sr_arena_alloc(&arena, n2 * sizeof(float));
    p.vndf = sr_arena_alloc(&arena, T * n2 * sizeof(float));
    p.luminance = sr_arena_alloc(&arena, T * N2 * sizeof(float));
    p.spectra = sr_arena_alloc(&arena, T * L * N2 * sizeof(float));
    bool ok = p.theta && p.lambda && p.ndf && p.sigma && p.vndf && p.luminance && p.spectra;
    for (size_t i = 0; ok && i < T; ++i)
        p.theta[i] = (float)(88.0 * PI / 180 * (double)i / (double)(T - 1));
    for (size_t i = 0; ok && i < L; ++i)
        p.lambda[i] = g->lambda_min + (g->lambda_max - g->lambda_min) * (float)i / (float)(L - 1);
    if (ok)
        plan_microfacets(&p, source, user);
    ok = ok && plan_spectra(&p, source, user);
    static const char description[] = "Isotropic, written by Steradian";
    static const uint8_t one = 1;
    static const float zero = 0;
    uint64_t n = (uint64_t)p.n, N = (uint64_t)g->resolution;
    struct field_to_write fields[] = {{"description", TENSOR_U8, 1, description, {sizeof description - 1}},
                                      {"jacobian", TENSOR_U8, 1, &one, {1}},
                                      {"theta_i", TENSOR_F32, 1, p.theta, {T}},
                                      {"phi_i", TENSOR_F32, 1, &zero, {1}},
                                      {"wavelengths", TENSOR_F32, 1, p.lambda, {L}},
                                      {"ndf", TENSOR_F32, 2, p.ndf, {n, n}},
                                      {"sigma", TENSOR_F32, 2, p.sigma, {n, n}},
                                      {"vndf", TENSOR_F32, 4, p.vndf, {1, T, n, n}},
                                      {"luminance", TENSOR_F32, 4, p.luminance, {1, T, N, N}},
                                      {"spectra", TENSOR_F32, 5, p.spectra, {1, T, L, N, N}}};
    sr_status status = ok ? write_fields(path, fields, (int)(sizeof fields / sizeof *fields), error)
                          : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
    sr_arena_free(&arena);
    return status;
}
