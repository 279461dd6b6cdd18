/* SPDX-License-Identifier: MIT */
/* Plain text, one measurement a line; and ASTM E1392's, which has a header before much the same lines.
 *
 *     # quantity: bsdf | cosine | factor        f, f cos_theta_o, or pi f; where nothing is said: f [1/sr]
 *     # angles: degrees | radians               where nothing is said: degrees if any is above 2 pi
 *     theta_i phi_i theta_o phi_o lambda f      names of the columns, in any order; without them this is their order
 *     0 0 30 0 550 0.31                         separated by blanks, commas or semicolons
 *
 * Columns: theta_i, phi_i (none: 0), theta_o or theta_s, phi_o or phi_s (none: 0), lambda [nm], f; or, without lambda,
 * one column for each wavelength (550nm), or R G B (linear sRGB), or X Y Z (Y = 1 for a perfect reflector). Names that
 * begin otherwise are skipped. With a column lambda all pairs of directions must have the same wavelengths. Azimuths
 * are those of directions away from the surface. ASTM: lines KEY value up to "VARS theta_i,phi_i,theta_s,phi_s,…";
 * angles in radians unless one is above 2 pi (ASTM E1392-96, as stray-light programs write it). */
#include "measured/private.h"

#include <stdio.h>
#include <stdlib.h>

enum role { ROLE_THETA_I, ROLE_PHI_I, ROLE_THETA_O, ROLE_PHI_O, ROLE_LAMBDA, ROLE_SKIP, ROLE_VALUE };
enum { MAX_COLUMNS = 1024 };

struct columns {
    int count, values;
    bool has_lambda, is_rgb, is_xyz;
    uint16_t role[MAX_COLUMNS]; // ROLE_VALUE + k for the k-th value
    float lambda[MAX_COLUMNS];  // [nm] of each value; 0: it has none
};

static void add_value(struct columns *c, float lambda)
{
    c->lambda[c->values] = lambda;
    c->role[c->count++] = (uint16_t)(ROLE_VALUE + c->values++);
}

static bool ends_with_nm(const char *word)
{
    size_t n = strlen(word);
    return n > 2 && word[0] >= '0' && word[0] <= '9' && text_equal(word + n - 2, "nm");
}

static sr_status name_columns(const struct source *s, int line, struct scan t, struct columns *c)
{
    static const struct {
        const char *name;
        enum role role;
    } names[] = {
        {"theta_i", ROLE_THETA_I}, {"thetai", ROLE_THETA_I},  {"phi_i", ROLE_PHI_I},     {"phii", ROLE_PHI_I},
        {"theta_o", ROLE_THETA_O}, {"theta_s", ROLE_THETA_O}, {"theta_r", ROLE_THETA_O}, {"phi_o", ROLE_PHI_O},
        {"phi_s", ROLE_PHI_O},     {"phi_r", ROLE_PHI_O},     {"lambda", ROLE_LAMBDA},   {"wavelength", ROLE_LAMBDA},
        {"f", ROLE_VALUE},         {"bsdf", ROLE_VALUE},      {"brdf", ROLE_VALUE},      {"btdf", ROLE_VALUE},
        {"value", ROLE_VALUE},     {"ccbsdf", ROLE_VALUE},    {"factor", ROLE_VALUE},    {"r", ROLE_VALUE},
        {"g", ROLE_VALUE},         {"b", ROLE_VALUE},         {"x", ROLE_VALUE},         {"y", ROLE_VALUE},
        {"z", ROLE_VALUE},         {NULL, ROLE_SKIP}};
    char word[64], letters[4] = "";
    *c = (struct columns){0};
    unsigned have = 0;
    for (scan_separators(&t); t.at < t.end; scan_separators(&t)) {
        if (!scan_word(&t, word, sizeof word))
            return fail_at(s, line, "the name of a column is expected, not '%c'",
                           *t.at >= 32 && *t.at < 127 ? *t.at : '?');
        if (c->count == MAX_COLUMNS)
            return fail_at(s, line, "more than %d columns", MAX_COLUMNS);
        double nm;
        struct scan digits = {.at = word, .end = word + strlen(word) - (ends_with_nm(word) ? 2 : 0)};
        if (ends_with_nm(word) && scan_number(&digits, &nm)) {
            add_value(c, (float)nm);
            continue;
        }
        int k = 0;
        while (names[k].name && !text_equal(names[k].name, word))
            ++k;
        if (names[k].role == ROLE_VALUE) {
            if (c->values < 3)
                letters[c->values] = (char)(word[0] & ~32);
            add_value(c, 0);
            continue;
        }
        if (names[k].role < ROLE_SKIP && (have & 1u << names[k].role))
            return fail_at(s, line, "a second column %s", word);
        have |= 1u << names[k].role;
        c->role[c->count++] = (uint16_t)names[k].role;
    }
    c->has_lambda = have & 1u << ROLE_LAMBDA;
    c->is_rgb = c->values == 3 && strcmp(letters, "RGB") == 0;
    c->is_xyz = c->values == 3 && strcmp(letters, "XYZ") == 0;
    if (!(have & 1u << ROLE_THETA_I) || !(have & 1u << ROLE_THETA_O) || c->values == 0)
        return fail_at(s, line, "columns theta_i, theta_o and f (or one a wavelength, as 550nm) are expected");
    int with_lambda = 0;
    for (int i = 0; i < c->values; ++i)
        with_lambda += c->lambda[i] > 0;
    if ((c->has_lambda && c->values != 1) ||
        (!c->has_lambda && !c->is_rgb && !c->is_xyz && c->values > 1 && with_lambda < c->values))
        return fail_at(
            s, line, "%d columns of values: one beside lambda, R G B, X Y Z, or each with its wavelength are expected",
            c->values);
    return SR_OK;
}

/* Without names: 4 angles, then lambda and f, or f, or R G B. */
static sr_status guess_columns(const struct source *s, int line, int numbers, struct columns *c)
{
    *c = (struct columns){0};
    if (numbers < 5 || numbers > 7)
        return fail_at(s, line,
                       "%d numbers: theta_i phi_i theta_o phi_o with lambda f, with f or with R G B are expected, or "
                       "names of columns",
                       numbers);
    for (; c->count < 4; ++c->count)
        c->role[c->count] = (uint16_t)(ROLE_THETA_I + c->count);
    c->has_lambda = numbers == 6;
    if (c->has_lambda)
        c->role[c->count++] = ROLE_LAMBDA;
    for (int k = numbers == 7 ? 3 : 1; k > 0; --k)
        add_value(c, 0);
    c->is_rgb = numbers == 7;
    return SR_OK;
}

struct one { // a line with a wavelength
    float angles[4], lambda, value;
};

static int compare_ones(const void *a, const void *b)
{
    const struct one *p = a, *q = b;
    for (int i = 0; i < 4; ++i)
        if (p->angles[i] != q->angles[i])
            return p->angles[i] < q->angles[i] ? -1 : 1;
    return p->lambda < q->lambda ? -1 : p->lambda > q->lambda;
}

/* Lines of one wavelength each become measurements of a spectrum each. */
static sr_status gather(const struct source *s, struct sr_array *ones, struct rows *rows, struct sr_array *angles,
                        struct sr_array *values)
{
    struct one *o = ones->data;
    size_t n = 0;
    qsort(o, ones->count, sizeof *o, compare_ones);
    while (n < ones->count && memcmp(o[n].angles, o[0].angles, sizeof o->angles) == 0)
        ++n;
    if (n > MAX_CHANNELS)
        return fail_at(s, 0, "more than %d lines for one pair of directions", MAX_CHANNELS);
    if (ones->count % n)
        return fail_at(s, 0,
                       "%zu lines of which the first pair of directions has %zu wavelengths: each pair is expected to "
                       "have the same",
                       ones->count, n);
    float *lambda = sr_arena_alloc(s->arena, n * sizeof(float));
    if (!lambda)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    for (size_t i = 0; i < n; ++i)
        lambda[i] = o[i].lambda;
    if (!channels_set_lambda(&rows->channels, lambda, (int)n))
        return fail_at(s, 0, "the first pair of directions has a wavelength twice, or one that is not positive");
    rows->count = ones->count / n;
    if (!sr_array_reserve(angles, 4 * rows->count, sizeof(float)) ||
        !sr_array_reserve(values, ones->count, sizeof(float)))
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    for (size_t k = 0; k < ones->count; ++k) {
        if (o[k].lambda != lambda[k % n] || memcmp(o[k].angles, o[k - k % n].angles, sizeof o->angles) != 0)
            return fail_at(s, 0,
                           "theta_i = %g, phi_i = %g, theta_o = %g, phi_o = %g: its wavelengths are not those of the "
                           "first pair of directions",
                           (double)o[k].angles[0], (double)o[k].angles[1], (double)o[k].angles[2],
                           (double)o[k].angles[3]);
        ((float *)values->data)[k] = o[k].value;
        memcpy((float *)angles->data + 4 * (k / n), o[k].angles, sizeof o->angles);
    }
    return SR_OK;
}

struct reading {
    const struct source *source;
    struct columns *columns;
    struct sr_array angles, values, ones;
    int32_t quantity, angle_unit;
    float largest; // [rad or deg] of all angles
};

/* "# quantity: cosine" and "# angles: degrees" */
static void directive(struct reading *r, const char *begin, const char *end)
{
    while (begin < end && (*begin == '#' || *begin == ' ' || *begin == '\t'))
        ++begin;
    bool angles = text_has_prefix(begin, end, "angles:");
    if (!angles && !text_has_prefix(begin, end, "quantity:"))
        return;
    struct scan t = {.at = begin + (angles ? 7 : 9), .end = end};
    char word[16];
    scan_separators(&t);
    scan_word(&t, word, sizeof word);
    if (angles)
        r->angle_unit = text_has_prefix(word, word + strlen(word), "deg")   ? SR_MEASURED_DEGREES
                        : text_has_prefix(word, word + strlen(word), "rad") ? SR_MEASURED_RADIANS
                                                                            : SR_MEASURED_ANGLES_AUTO;
    else
        r->quantity = text_equal(word, "bsdf")     ? SR_MEASURED_BSDF
                      : text_equal(word, "cosine") ? SR_MEASURED_TIMES_COSINE
                      : text_equal(word, "factor") ? SR_MEASURED_FACTOR
                                                   : SR_MEASURED_AUTO;
}

static sr_status line_read(struct reading *r, int line, struct scan t)
{
    const struct columns *c = r->columns;
    struct one one = {0};
    bool ok = true;
    float *values = NULL;
    if (!c->has_lambda) {
        ok = sr_array_reserve(&r->values, r->values.count + (size_t)c->values, sizeof(float));
        values = ok ? (float *)r->values.data + r->values.count : NULL;
    }
    for (int i = 0; ok && i < c->count; ++i) {
        double v;
        scan_separators(&t);
        if (t.at >= t.end)
            return fail_at(r->source, line, "ends after %d numbers, %d are expected", i, c->count);
        if (!scan_number(&t, &v))
            return fail_at(r->source, line, "a number is expected, not \"%.*s\"",
                           (int)(t.end - t.at < 12 ? t.end - t.at : 12), t.at);
        if (c->role[i] < ROLE_LAMBDA) {
            one.angles[c->role[i]] = (float)v;
            r->largest = sr_max(r->largest, fabsf((float)v));
        } else if (c->role[i] == ROLE_LAMBDA)
            one.lambda = (float)v;
        else if (c->role[i] >= ROLE_VALUE) {
            if (values)
                values[c->role[i] - ROLE_VALUE] = (float)v;
            else
                one.value = (float)v;
        }
    }
    scan_separators(&t);
    if (ok && t.at < t.end && *t.at != '#')
        return fail_at(r->source, line, "goes on after the %d numbers that are expected", c->count);
    if (c->has_lambda) {
        struct one *at = sr_array_push(&r->ones, sizeof one);
        ok = ok && at;
        if (at)
            *at = one;
    } else {
        ok = ok && sr_array_reserve(&r->angles, r->angles.count + 4, sizeof(float));
        if (ok) {
            memcpy((float *)r->angles.data + r->angles.count, one.angles, sizeof one.angles);
            r->angles.count += 4;
            r->values.count += (size_t)c->values;
        }
    }
    return ok ? SR_OK : sr_fail(r->source->error, SR_ERROR_RESOURCE, "%s: not enough memory", r->source->name);
}

static sr_status finish(struct reading *r, struct sr_measured *m)
{
    const struct source *s = r->source;
    const struct columns *c = r->columns;
    struct rows rows = {.count = r->angles.count / 4,
                        .channels = {.kind = CHANNEL_GREY, .count = c->values, .stride = 1}};
    if (c->has_lambda && r->ones.count > 0) {
        sr_status status = gather(s, &r->ones, &rows, &r->angles, &r->values);
        if (status != SR_OK)
            return status;
    } else if (c->is_rgb || c->is_xyz) {
        rows.channels.kind = CHANNEL_RGB;
    } else if (c->values > 1 || c->lambda[0] > 0) {
        float *lambda = sr_arena_copy(s->arena, c->lambda, (size_t)c->values * sizeof(float));
        if (!lambda)
            return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
        if (!channels_set_lambda(&rows.channels, lambda, c->values))
            return fail_at(s, 0, "the wavelengths of its columns do not increase");
    }
    rows.channels.stride = 1;
    rows.angles = r->angles.data;
    rows.values = r->values.data;
    int32_t unit = s->options.angles ? s->options.angles : r->angle_unit;
    if (unit == SR_MEASURED_ANGLES_AUTO) {
        unit = r->largest > 2 * SR_PI + 0.01f ? SR_MEASURED_DEGREES : SR_MEASURED_RADIANS;
        m->note = unit == SR_MEASURED_DEGREES ? "angles were taken as degrees, some are above 2 pi"
                                              : "angles were taken as radians, none is above 2 pi";
    }
    if (unit == SR_MEASURED_DEGREES)
        for (size_t k = 0; k < 4 * rows.count; ++k)
            rows.angles[k] *= SR_PI / 180;
    if (c->is_xyz)
        for (size_t k = 0; k < rows.count; ++k) {
            struct sr_rgb rgb = rgb_of_xyz(rows.values[3 * k], rows.values[3 * k + 1], rows.values[3 * k + 2]);
            memcpy(rows.values + 3 * k, (float[3]){rgb.r, rgb.g, rgb.b}, 3 * sizeof(float));
        }
    m->quantity = s->options.quantity ? s->options.quantity : r->quantity ? r->quantity : SR_MEASURED_BSDF;
    return rows_finish(s, &rows, m);
}

static sr_status read_lines(const struct source *s, struct sr_measured *m, bool is_astm)
{
    struct columns *c = sr_alloc(sizeof *c);
    struct reading r = {.source = s, .columns = c};
    sr_status status = c ? SR_OK : sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    struct scan lines = scan_start(s->data, s->size);
    const char *begin, *end;
    while (status == SR_OK && scan_line(&lines, &begin, &end)) {
        struct scan t = {.at = begin, .end = end};
        scan_separators(&t);
        if (t.at < t.end && *t.at == '#')
            directive(&r, t.at, end);
        if (t.at >= t.end || *t.at == '#')
            continue;
        double v;
        struct scan probe = t;
        bool is_number = scan_number(&probe, &v);
        if (is_astm && c->count == 0) { // the header
            if (text_has_prefix(t.at, end, "VARS")) {
                t.at += 4;
                while (t.at < t.end && (*t.at == ' ' || *t.at == '\t' || *t.at == '=' || *t.at == ':'))
                    t.at++;
                status = name_columns(s, lines.line, t, c);
            }
            continue;
        }
        if (c->count == 0 && !is_number) {
            status = name_columns(s, lines.line, t, c);
            continue;
        }
        if (c->count == 0) {
            int numbers = 0;
            for (probe = t; scan_number(&probe, &v); scan_separators(&probe))
                ++numbers;
            status = guess_columns(s, lines.line, numbers, c);
        }
        if (status == SR_OK)
            status = line_read(&r, lines.line, t);
    }
    if (status == SR_OK && c->count == 0)
        status = fail_at(s, 0,
                         is_astm ? "has no line VARS that names its columns"
                                 : "holds no measurement, at least one is expected");
    if (status == SR_OK)
        status = finish(&r, m);
    sr_array_free(&r.angles);
    sr_array_free(&r.values);
    sr_array_free(&r.ones);
    sr_free(c);
    return status;
}

sr_status read_table(const struct source *s, struct sr_measured *m)
{
    return read_lines(s, m, false);
}

sr_status read_astm(const struct source *s, struct sr_measured *m)
{
    return read_lines(s, m, true);
}

/* ---- writing ---- */

static bool put(struct sr_array *text, const char *line)
{
    size_t n = strlen(line);
    if (text->count + n > text->capacity && !sr_array_reserve(text, 2 * (text->count + n), 1))
        return false;
    memcpy((char *)text->data + text->count, line, n);
    text->count += n;
    return true;
}

static bool put_number(struct sr_array *text, double value, const char *after)
{
    char line[48];
    snprintf(line, sizeof line, "%.7g%s", value, after);
    for (char *p = line; *p; ++p)
        if (*p == ',')
            *p = '.'; // some locales
    return put(text, line);
}

sr_status sr_measured_write_table(const char *path, const struct sr_measured_table_grid *grid, sr_measured_source f,
                                  void *user, struct sr_error *error)
{
    struct sr_measured_table_grid g = grid ? *grid : (struct sr_measured_table_grid){0};
    g.theta_count = g.theta_count ? g.theta_count : 19;
    g.phi_count = g.phi_count ? g.phi_count : 25;
    g.lambda_count = g.lambda_count ? g.lambda_count : 10;
    g.lambda_min = g.lambda_min > 0 ? g.lambda_min : 380;
    g.lambda_max = g.lambda_max > 0 ? g.lambda_max : 740;
    if (g.theta_count < 2 || g.phi_count < 2 || g.lambda_count < 1 || g.theta_count > 180 || g.phi_count > 720 ||
        g.lambda_count > MAX_COLUMNS - 4 || (g.lambda_count > 1 && g.lambda_max <= g.lambda_min))
        return sr_fail(error, SR_ERROR_USAGE,
                       "%s: a grid of %d polar angles (2 ... 180), %d azimuths (2 ... 720), %d wavelengths (1 ... %d, "
                       "increasing) is expected",
                       path, g.theta_count, g.phi_count, g.lambda_count, MAX_COLUMNS - 4);
    struct sr_array text = {0};
    bool ok =
        put(&text,
            "# BSDF, one pair of directions a line\n# quantity: bsdf\n# angles: degrees\ntheta_i phi_i theta_o phi_o");
    float lambda[MAX_COLUMNS];
    for (int k = 0; k < g.lambda_count; ++k) {
        lambda[k] = g.lambda_count > 1
                        ? g.lambda_min + (g.lambda_max - g.lambda_min) * (float)k / (float)(g.lambda_count - 1)
                        : g.lambda_min;
        ok = ok && put(&text, " ") && put_number(&text, (double)lambda[k], "nm");
    }
    ok = ok && put(&text, "\n");
    int outgoing = g.theta_count * (g.has_transmission ? 2 : 1), phis_i = g.is_anisotropic ? g.phi_count : 1;
    for (int i = 0; ok && i < g.theta_count; ++i)
        for (int j = 0; j < phis_i; ++j)
            for (int k = 0; k < outgoing; ++k)
                for (int l = 0; ok && l < g.phi_count; ++l) {
                    double theta_i = 89.0 * i / (g.theta_count - 1), phi_i = 360.0 * j / g.phi_count;
                    double theta_o = k < g.theta_count ? 89.0 * k / (g.theta_count - 1)
                                                       : 180 - 89.0 * (outgoing - 1 - k) / (g.theta_count - 1);
                    double phi_o = g.is_anisotropic ? 360.0 * l / g.phi_count : 180.0 * l / (g.phi_count - 1);
                    double a[4] = {theta_i, phi_i, theta_o, phi_o};
                    for (int n = 0; n < 4; ++n)
                        ok = ok && put_number(&text, a[n], " ");
                    double ti = theta_i * PI / 180, to = theta_o * PI / 180, pi = phi_i * PI / 180,
                           po = phi_o * PI / 180;
                    sr_vec3 wi = {(float)(sin(ti) * cos(pi)), (float)(sin(ti) * sin(pi)), (float)cos(ti)};
                    sr_vec3 wo = {(float)(sin(to) * cos(po)), (float)(sin(to) * sin(po)), (float)cos(to)};
                    for (int n = 0; ok && n < g.lambda_count; n += SR_LAMBDA_COUNT) {
                        sr_spectrum at = SR_BLACK;
                        for (int c = 0; c < SR_LAMBDA_COUNT; ++c)
                            at[c] = lambda[n + c < g.lambda_count ? n + c : g.lambda_count - 1];
                        sr_spectrum value = f(user, wo, wi, at);
                        for (int c = 0; c < SR_LAMBDA_COUNT && n + c < g.lambda_count; ++c)
                            ok = ok && put_number(&text, (double)value[c], n + c + 1 < g.lambda_count ? " " : "\n");
                    }
                }
    sr_status status = ok ? sr_file_write(path, text.data, text.count, error)
                          : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
    sr_array_free(&text);
    return status;
}
