/* SPDX-License-Identifier: MIT */
/* A luminaire's intensity between the measured angles, its flux, its report, and draws in proportion to it.
 *
 *     I(C, gamma) = bilinear in C and gamma between the neighbours, C folded by the symmetry          [cd]
 *     INTEGRAL_a^b (p + q gamma) sin gamma dgamma = [-(p + q gamma) cos gamma + q sin gamma]_a^b      [cd]
 *
 * The second is exact for the first: fluxes have no error of quadrature. Beam and field angles: CIE 121 and IES LM-79,
 * at 50 % and 10 % of the plane's peak. */
#include "measured/photometry_private.h"

#include <stdio.h>
#include <stdlib.h>

#define DEGREE (PI / 180)

/* ---- evaluating ---- */

/* C as the kept planes have it [deg] */
static double fold(enum sr_photometry_symmetry symmetry, double c)
{
    c -= 360 * floor(c / 360);
    switch (symmetry) {
    case SR_PHOTOMETRY_ALL_PLANES:
        return c;
    case SR_PHOTOMETRY_AXIAL:
        return 0;
    case SR_PHOTOMETRY_C0_C180:
        return c > 180 ? 360 - c : c;
    case SR_PHOTOMETRY_C90_C270:
        return c < 90 ? 180 - c : c > 270 ? 540 - c : c;
    case SR_PHOTOMETRY_QUADRANT:
        c = c > 180 ? 360 - c : c;
        return c > 90 ? 180 - c : c;
    }
    return c;
}

/* The two planes that C lies between, and the share of the second. */
static void find_planes(const struct sr_photometry *p, double c, uint32_t plane[2], double *share)
{
    plane[0] = plane[1] = 0;
    *share = 0;
    if (p->c_count < 2)
        return;
    c = fold(p->symmetry, c);
    uint32_t last = p->c_count - 1;
    if (p->symmetry == SR_PHOTOMETRY_ALL_PLANES && (c >= (double)p->c[last] || c < (double)p->c[0])) {
        double gap = (double)p->c[0] + 360 - (double)p->c[last];
        plane[0] = last;
        *share = (c - (double)p->c[last] + (c < (double)p->c[0] ? 360 : 0)) / gap;
        return;
    }
    float t;
    plane[0] = (uint32_t)axis_find(p->c, (int)p->c_count, (float)c, &t);
    plane[1] = plane[0] + 1;
    *share = (double)t;
}

double sr_photometry_intensity(const struct sr_photometry *p, double c, double gamma)
{
    uint32_t plane[2], last = p->gamma_count - 1;
    double share;
    if (!(gamma >= (double)p->gamma[0] - 1e-4 && gamma <= (double)p->gamma[last] + 1e-4))
        return 0;
    float t = 0;
    uint32_t row = last ? (uint32_t)axis_find(p->gamma, (int)p->gamma_count, (float)gamma, &t) : 0;
    find_planes(p, c, plane, &share);
    double value[2];
    for (int k = 0; k < 2; ++k) {
        const float *at = p->candela + (size_t)plane[k] * p->gamma_count + row;
        value[k] = (1 - (double)t) * (double)at[0] + (last ? (double)t * (double)at[1] : 0);
    }
    return (1 - share) * value[0] + share * value[1];
}

static void angles_of(sr_vec3 d, double *c, double *gamma)
{
    *c = atan2((double)d.y, (double)d.x) / DEGREE;
    *gamma = atan2(hypot((double)d.x, (double)d.y), -(double)d.z) / DEGREE;
}

double sr_photometry_intensity_along(const struct sr_photometry *p, sr_vec3 d)
{
    double c, gamma;
    angles_of(d, &c, &gamma);
    return sr_photometry_intensity(p, c, gamma);
}

/* ---- flux ---- */

/* INTEGRAL of a plane's intensity times sin gamma from `from` to `to` [cd] */
static double plane_integral(const struct sr_photometry *p, uint32_t plane, double from, double to)
{
    const float *I = p->candela + (size_t)plane * p->gamma_count;
    double sum = 0;
    for (uint32_t k = 0; k + 1 < p->gamma_count; ++k) {
        double a = (double)p->gamma[k], b = (double)p->gamma[k + 1];
        double slope = ((double)I[k + 1] - (double)I[k]) / (b - a), at_zero = (double)I[k] - slope * a;
        double lo = fmax(a, from), hi = fmin(b, to);
        if (!(hi > lo))
            continue;
        double x = lo * DEGREE, y = hi * DEGREE, q = slope / DEGREE;
        // cos x - cos y and its like as products, so that narrow steps keep their digits
        double cosines = 2 * sin((x + y) / 2) * sin((y - x) / 2), sines = 2 * cos((x + y) / 2) * sin((y - x) / 2);
        sum += (at_zero + slope * lo) * cosines + q * (sines - (y - x) * cos(y));
    }
    return sum;
}

/* What each plane's neighbourhood is worth [rad]: trapezoids around the turn. */
static double plane_weight(const struct sr_photometry *p, uint32_t k)
{
    if (p->c_count < 2)
        return 2 * PI;
    static const double copies[] = {1, 1, 2, 2, 4};
    uint32_t last = p->c_count - 1;
    bool turns = p->symmetry == SR_PHOTOMETRY_ALL_PLANES;
    double before = k > 0   ? (double)p->c[k] - (double)p->c[k - 1]
                    : turns ? (double)p->c[0] + 360 - (double)p->c[last]
                            : 0;
    double after = k < last ? (double)p->c[k + 1] - (double)p->c[k]
                   : turns  ? (double)p->c[0] + 360 - (double)p->c[last]
                            : 0;
    return copies[p->symmetry] * (before + after) / 2 * DEGREE;
}

double sr_photometry_flux(const struct sr_photometry *p, double from, double to)
{
    double sum = 0;
    for (uint32_t k = 0; k < p->c_count; ++k)
        sum += plane_weight(p, k) * plane_integral(p, k, from, to);
    return sum;
}

/* ---- report ---- */

/* The full angle [deg] around the peak of the planes C and C + 180 where the intensity stays above the share of that
 * peak. */
static double width_at(const struct sr_photometry *p, double c, double share)
{
    enum { STEPS = 3600 }; // 0.1 deg from -180 to 180
    double peak = 0;
    int at = 0;
#define ALONG(i) sr_photometry_intensity(p, (i) < 0 ? c + 180 : c, fabs((double)(i)) * 0.1)
    for (int k = 0; k <= STEPS; ++k) { // from the middle outward, so that of equal ones the innermost counts
        int i = k & 1 ? -(k + 1) / 2 : k / 2;
        double I = ALONG(i);
        if (I > peak * (1 + 1e-9)) {
            peak = I;
            at = i;
        }
    }
    if (!(peak > 0))
        return 0;
    double edge[2];
    for (int side = 0; side < 2; ++side) {
        int step = side ? 1 : -1, i = at;
        while (abs(i + step) <= STEPS / 2 && ALONG(i + step) >= share * peak)
            i += step;
        edge[side] = i;
        if (abs(i + step) <= STEPS / 2) {
            double inner = ALONG(i), outer = ALONG(i + step);
            edge[side] += step * (inner - share * peak) / (inner - outer);
        }
    }
#undef ALONG
    return (edge[1] - edge[0]) * 0.1;
}

void sr_photometry_report(const struct sr_photometry *p, struct sr_photometry_report *r)
{
    *r =
        (struct sr_photometry_report){.flux = sr_photometry_flux(p, 0, 180), .flux_down = sr_photometry_flux(p, 0, 90)};
    for (size_t i = 0; i < (size_t)p->c_count * p->gamma_count; ++i)
        if ((double)p->candela[i] > r->peak) {
            r->peak = (double)p->candela[i];
            r->peak_c = (double)p->c[i / p->gamma_count];
            r->peak_gamma = (double)p->gamma[i % p->gamma_count];
        }
    for (int k = 0; k < 2; ++k) {
        r->beam[k] = width_at(p, 90 * k, 0.5);
        r->field[k] = width_at(p, 90 * k, 0.1);
    }
    r->efficacy = p->power_W > 0 ? r->flux / (double)p->power_W : (double)NAN;
    r->light_output_ratio = p->lamp_flux > 0 ? r->flux / (double)p->lamp_flux : (double)NAN;
}

const char *sr_photometry_word(const struct sr_photometry *p, const char *key)
{
    for (uint32_t i = 0; i < p->word_count; ++i)
        if (text_equal(p->words[i].key, key))
            return p->words[i].text;
    return NULL;
}

/* ---- reading ---- */

void photometry_note(struct photometry_draft *d, const char *format, ...)
{
    size_t n = strlen(d->note);
    if (n > 0 && n + 2 < sizeof d->note) {
        memcpy(d->note + n, "; ", 3);
        n += 2;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(d->note + n, sizeof d->note - n, format, arguments);
    va_end(arguments);
}

bool photometry_add_word(const struct source *s, struct photometry_draft *d, const char *key, const char *begin,
                         const char *end)
{
    while (begin < end && (unsigned char)*begin <= ' ')
        ++begin;
    while (end > begin && (unsigned char)end[-1] <= ' ')
        --end;
    if (d->p.word_count == PHOTOMETRY_WORDS || (begin == end && !*key))
        return true;
    size_t n = end - begin < 1000 ? (size_t)(end - begin) : 1000;
    char *text = sr_arena_alloc(s->arena, n + 1);
    char *kept = sr_arena_string(s->arena, key);
    if (!text || !kept)
        return false;
    for (size_t i = 0; i < n; ++i)
        text[i] = (unsigned char)begin[i] < ' ' || begin[i] == 127 ? ' ' : begin[i];
    d->words[d->p.word_count++] = (struct sr_photometry_word){kept, text};
    return true;
}

sr_status photometry_check(const struct sr_photometry *p, const char *name, struct sr_error *error)
{
    static const float first[] = {0, 0, 0, 90, 0}, last[] = {360, 0, 180, 270, 90};
    if (p->c_count == 0 || p->gamma_count < 2 || (p->symmetry == SR_PHOTOMETRY_AXIAL) != (p->c_count == 1))
        return sr_fail(error, SR_ERROR_INPUT, "%s: %u C-planes of %u angles do not make a distribution", name,
                       p->c_count, p->gamma_count);
    for (int axis = 0; axis < 2; ++axis) {
        const float *a = axis ? p->gamma : p->c;
        for (uint32_t i = 0; i < (axis ? p->gamma_count : p->c_count); ++i)
            if (!(a[i] >= 0 && a[i] <= (axis ? 180 : 360)) || (i > 0 && !(a[i] - a[i - 1] > 1e-3f)))
                return sr_fail(error, SR_ERROR_INPUT,
                               "%s: %s %u is %g deg: increasing angles from 0 to %d are expected", name,
                               axis ? "vertical angle" : "C-plane", i + 1, (double)a[i], axis ? 180 : 360);
    }
    float end = p->c[p->c_count - 1];
    if (p->symmetry == SR_PHOTOMETRY_ALL_PLANES
            ? end >= last[0]
            : fabsf(p->c[0] - first[p->symmetry]) > 0.01f || fabsf(end - last[p->symmetry]) > 0.01f)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: C-planes from %g to %g deg do not suit the symmetry: %g to %g are expected", name,
                       (double)p->c[0], (double)end, (double)first[p->symmetry], (double)last[p->symmetry]);
    for (size_t i = 0; i < (size_t)p->c_count * p->gamma_count; ++i)
        if (!(p->candela[i] >= 0 && p->candela[i] < 1e12f))
            return sr_fail(
                error, SR_ERROR_INPUT, "%s: the intensity at C %g deg, gamma %g deg is %g cd: 0 to 1e12 are expected",
                name, (double)p->c[i / p->gamma_count], (double)p->gamma[i % p->gamma_count], (double)p->candela[i]);
    return SR_OK;
}

/* A line of the first ones that begins with TILT= ends an IES file's words; EULUMDAT's second and third are small
 * numbers. */
static int format_of(const char *data, size_t size)
{
    struct scan scan = scan_start(data, size);
    const char *begin, *end;
    if (text_has_prefix(scan.at, scan.end, "IES"))
        return SR_PHOTOMETRY_IES;
    bool small[2] = {false, false};
    while (scan.line < 400 && scan_line(&scan, &begin, &end)) {
        while (begin < end && *begin == ' ')
            ++begin;
        if (text_has_prefix(begin, end, "TILT"))
            return SR_PHOTOMETRY_IES;
        while (end > begin && (end[-1] == ' ' || end[-1] == '\t'))
            --end;
        if (scan.line == 2 || scan.line == 3)
            small[scan.line - 2] = end - begin == 1 && *begin >= '0' && *begin <= '9';
    }
    return small[0] && small[1] ? SR_PHOTOMETRY_LDT : -1;
}

bool sr_photometry_is(const void *data, size_t size)
{
    return format_of(data, size) >= 0;
}

sr_status sr_photometry_parse(const char *name, const void *data, size_t size, struct sr_arena *arena,
                              const struct sr_photometry **out, struct sr_error *error)
{
    *out = NULL;
    struct source s = {.name = name, .data = data, .size = size, .arena = arena, .error = error};
    struct photometry_draft *d = sr_alloc(sizeof *d);
    if (!d)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", name);
    int format = format_of(data, size);
    sr_status status =
        format == SR_PHOTOMETRY_IES ? read_ies(&s, d)
        : format == SR_PHOTOMETRY_LDT
            ? read_ldt(&s, d)
            : fail_at(
                  &s, 1,
                  "is neither an IES LM-63 file (no line TILT=) nor a EULUMDAT file (lines 2 and 3 are no single digits)");
    if (status == SR_OK)
        status = photometry_check(&d->p, name, error);
    if (status == SR_OK && !(sr_photometry_flux(&d->p, 0, 180) > 0))
        status = fail_at(&s, 0, "all intensities are 0");
    struct sr_photometry *p = status == SR_OK ? sr_arena_copy(arena, &d->p, sizeof *p) : NULL;
    if (p) {
        p->format = (enum sr_photometry_format)format;
        p->note = sr_arena_string(arena, d->note);
        p->words = sr_arena_copy(arena, d->words, (p->word_count + 1) * sizeof *p->words);
    }
    sr_free(d);
    if (status == SR_OK && (!p || !p->note || !p->words))
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", name);
    *out = p;
    return status;
}

sr_status sr_photometry_read(const char *path, struct sr_arena *arena, const struct sr_photometry **out,
                             struct sr_error *error)
{
    char *data;
    size_t size;
    *out = NULL;
    sr_status status = sr_file_read(path, (size_t)1 << 30, &data, &size, error);
    if (status == SR_OK) {
        status = sr_photometry_parse(path, data, size, arena, out, error);
        sr_free(data);
    }
    return status;
}

/* ---- writing ---- */

bool text_put(struct sr_array *text, const char *format, ...)
{
    char piece[1200];
    va_list arguments;
    va_start(arguments, format);
    int n = vsnprintf(piece, sizeof piece, format, arguments);
    va_end(arguments);
    size_t length = n < (int)sizeof piece ? (size_t)n : sizeof piece - 1;
    if (text->count + length + 1 > text->capacity && !sr_array_reserve(text, 2 * (text->count + length + 1), 1))
        return false;
    memcpy((char *)text->data + text->count, piece, length + 1);
    text->count += length;
    return true;
}

bool text_number(struct sr_array *text, double value, const char *after)
{
    char number[48];
    snprintf(number, sizeof number, "%.7g", value);
    for (char *c = number; *c; ++c)
        *c = *c == ',' ? '.' : *c; // some locales
    return text_put(text, "%s%s", number, after);
}

sr_status sr_photometry_print(const struct sr_photometry *p, enum sr_photometry_format format, char **out, size_t *size,
                              struct sr_error *error)
{
    struct sr_array text = {0};
    *out = NULL;
    *size = 0;
    if (photometry_check(p, "the luminaire", error) != SR_OK)
        return error->status;
    sr_status status = format == SR_PHOTOMETRY_IES ? print_ies(p, &text) : print_ldt(p, &text);
    if (status != SR_OK) {
        sr_array_free(&text);
        return sr_fail(
            error, status,
            status == SR_ERROR_INPUT
                ? "EULUMDAT does not keep C-planes that begin elsewhere than at 0 deg or whose number is not whole by symmetry"
                : "not enough memory to write a luminaire");
    }
    *out = text.data;
    *size = text.count;
    return SR_OK;
}

sr_status sr_photometry_write(const char *path, const struct sr_photometry *p, struct sr_error *error)
{
    bool is_ldt = sr_path_has_ending(path, ".ldt");
    if (!is_ldt && !sr_path_has_ending(path, ".ies"))
        return sr_fail(error, SR_ERROR_USAGE, "%s: the ending .ies or .ldt was expected", path);
    char *text;
    size_t size;
    if (sr_photometry_print(p, is_ldt ? SR_PHOTOMETRY_LDT : SR_PHOTOMETRY_IES, &text, &size, error) != SR_OK)
        return error->status;
    sr_status status = sr_file_write(path, text, size, error);
    sr_free(text);
    return status;
}

/* ---- drawing ---- */

/* Cells of a grid that is at least as fine as the data, each with the mean of its corners and its middle: constant
 * within, so that the density is exact for what is drawn, and close to the intensity. */
bool sr_photometry_guide_build(const struct sr_photometry *p, struct sr_arena *arena, struct sr_photometry_guide *guide)
{
    float narrowest = 180;
    for (uint32_t k = 0; k + 1 < p->gamma_count; ++k)
        narrowest = sr_min(narrowest, p->gamma[k + 1] - p->gamma[k]);
    uint32_t ny = (uint32_t)ceilf(180 / sr_clamp(narrowest, 0.1f, 2.5f));
    uint32_t nx = p->symmetry == SR_PHOTOMETRY_AXIAL ? 1 : 144;
    float *f = sr_alloc((size_t)nx * ny * sizeof *f);
    guide->density = sr_arena_alloc(arena, sizeof *guide->density);
    guide->cosine = sr_arena_alloc(arena, (ny + 1) * sizeof *guide->cosine);
    guide->flux = sr_photometry_flux(p, 0, 180);
    bool ok = f && guide->density && guide->cosine;
    for (uint32_t y = 0; ok && y <= ny; ++y)
        guide->cosine[y] = y == ny ? -1 : cos(PI * y / ny);
    for (uint32_t y = 0; ok && y < ny; ++y)
        for (uint32_t x = 0; x < nx; ++x) {
            double sum = 0;
            for (int k = 0; k < 9; ++k)
                sum += sr_photometry_intensity(p, 360 * (x + k % 3 / 2.0) / nx, 180 * (y + k / 3 / 2.0) / ny);
            // a grain everywhere: a peak that all nine miss is still drawn
            f[(size_t)y * nx + x] = (float)((sum / 9 + 1e-4 * guide->flux) * (guide->cosine[y] - guide->cosine[y + 1]));
        }
    ok = ok && sr_piecewise2_build(arena, f, nx, ny, guide->density);
    sr_free(f);
    return ok;
}

sr_vec3 sr_photometry_sample(const struct sr_photometry_guide *guide, sr_vec2 u, float *pdf)
{
    const struct sr_piecewise2 *density = guide->density;
    sr_vec2 at = sr_piecewise2_sample(density, u, pdf);
    float row = sr_clamp(floorf(at.y * (float)density->ny), 0, (float)density->ny - 1),
          within = sr_clamp(at.y * (float)density->ny - row, 0, 1);
    double upper = guide->cosine[(uint32_t)row], lower = guide->cosine[(uint32_t)row + 1];
    double cos_gamma = upper + (double)within * (lower - upper), sin_gamma = sqrt(fmax(0, 1 - cos_gamma * cos_gamma)),
           c = 2 * PI * (double)at.x;
    *pdf *= (float)(1 / (2 * PI * density->ny * (upper - lower)));
    return (sr_vec3){(float)(sin_gamma * cos(c)), (float)(sin_gamma * sin(c)), (float)-cos_gamma};
}

float sr_photometry_pdf(const struct sr_photometry_guide *guide, sr_vec3 d)
{
    const struct sr_piecewise2 *density = guide->density;
    double c, gamma;
    angles_of(d, &c, &gamma);
    c = (c < 0 ? c + 360 : c) / 360;
    uint32_t row = (uint32_t)fmin(gamma / 180 * density->ny, density->ny - 1);
    float y = (float)(((double)row + 0.5) / density->ny);
    return sr_piecewise2_pdf(density, (sr_vec2){(float)fmin(c, 0.9999999), y}) *
           (float)(1 / (2 * PI * density->ny * (guide->cosine[row] - guide->cosine[row + 1])));
}
