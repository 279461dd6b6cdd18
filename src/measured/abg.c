/* SPDX-License-Identifier: MIT */
/* Coefficients A, B, g of optical polish, in a line for each wavelength.
 *
 *     f = A / (B + |s_i + s_o|^g)       [1/sr],    s = (x, y) of a direction: zero toward the mirror direction
 *
 * The file begins with the word ABg; then "BTDF" if light passes through (about the straight way on), and lines of A B
 * g or of lambda A B g, or A = …, B = …, g = …; # begins a comment. The specular light that is not scattered is not
 * part of it. The form of stray-light programs; only r enters, so that it is reciprocal and invariant under shifts in s
 * (Harvey 1976). */
#include "measured/private.h"

struct abg_row {
    float lambda, A, B, g;
};
enum { MAX_ROWS = 256 };
struct abg {
    int count;
    bool through;
    struct abg_row rows[MAX_ROWS];
    float lambda[MAX_ROWS];
};

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct abg *a = data;
    float x = wi.x + wo.x, y = wi.y + wo.y, r2 = x * x + y * y;
    if (a->count == 1)
        return SR_BLACK + a->rows[0].A / (a->rows[0].B + powf(r2, 0.5f * a->rows[0].g));
    sr_spectrum value = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float t;
        int k = axis_find(a->lambda, a->count, lambda[i], &t);
        const struct abg_row *p = &a->rows[k], *q = p + 1;
        value[i] = sr_lerp(t, p->A / (p->B + powf(r2, 0.5f * p->g)), q->A / (q->B + powf(r2, 0.5f * q->g)));
    }
    return value;
}

static sr_status check(const struct source *s, int line, struct abg *a, const double v[4], bool has_lambda)
{
    if (!(v[1] > 0 && v[2] >= 1e-12 && v[3] >= 0 && v[1] < 1e12 && v[2] < 1e12 && v[3] <= 20))
        return fail_at(s, line, "A = %g, B = %g, g = %g: A > 0, B >= 1e-12 and g in 0 ... 20 are expected", v[1], v[2],
                       v[3]);
    if (has_lambda && !(v[0] > (a->count ? (double)a->rows[a->count - 1].lambda : 0) && v[0] < 1e6))
        return fail_at(s, line, "a wavelength of %g nm: they are expected to increase", v[0]);
    if (a->count == MAX_ROWS || (!has_lambda && a->count > 0))
        return fail_at(s, line, "a further line of coefficients: %s",
                       has_lambda ? "256 are the most" : "without wavelengths one is expected");
    a->lambda[a->count] = (float)v[0];
    a->rows[a->count++] = (struct abg_row){(float)v[0], (float)v[1], (float)v[2], (float)v[3]};
    return SR_OK;
}

sr_status read_abg(const struct source *s, struct sr_measured *m)
{
    struct abg *a = sr_arena_alloc(s->arena, sizeof *a);
    if (!a)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    struct scan lines = scan_start(s->data, s->size);
    const char *begin, *end;
    double named[4] = {0, NAN, NAN, NAN};
    bool has_named = false;
    while (scan_line(&lines, &begin, &end)) {
        for (const char *p = begin; p < end; ++p)
            if (*p == '#')
                end = p;
        struct scan t = {.at = begin, .end = end};
        double v[4];
        int n = 0;
        for (;;) {
            char word[16];
            scan_separators(&t);
            if (t.at >= t.end)
                break;
            if (n < 4 && scan_number(&t, &v[n])) {
                ++n;
                continue;
            }
            if (n > 0 || !scan_word(&t, word, sizeof word))
                return fail_at(s, lines.line, "numbers A B g or lambda A B g are expected");
            if (text_equal(word, "ABg") || text_equal(word, "BRDF"))
                continue;
            if (text_equal(word, "BTDF")) {
                a->through = true;
                continue;
            }
            int which = strcmp(word, "A") == 0 ? 1 : strcmp(word, "B") == 0 ? 2 : text_equal(word, "g") ? 3 : 0;
            scan_separators(&t);
            if (t.at < t.end && (*t.at == '=' || *t.at == ':'))
                t.at++;
            scan_separators(&t);
            if (!which || !scan_number(&t, &named[which]))
                return fail_at(s, lines.line,
                               "\"%s\" is not known here: ABg, BRDF, BTDF, or A, B, g with a number are expected",
                               word);
            has_named = true;
        }
        if (n == 0)
            continue;
        if (n < 3)
            return fail_at(s, lines.line, "%d numbers, three (A B g) or four (lambda A B g) are expected", n);
        double row[4] = {n == 4 ? v[0] : 0, v[n - 3], v[n - 2], v[n - 1]};
        if (a->count > 0 && (a->lambda[0] > 0) != (n == 4))
            return fail_at(s, lines.line, "some lines have a wavelength and some have none");
        sr_status status = check(s, lines.line, a, row, n == 4);
        if (status != SR_OK)
            return status;
    }
    if (has_named) {
        sr_status status = check(s, 0, a, named, false);
        if (status != SR_OK)
            return status;
    }
    if (a->count == 0)
        return fail_at(s, 0, "ends before the coefficients A, B, g");
    m->data = a;
    m->f = f;
    m->channels = (struct channels){.kind = CHANNEL_GREY, .count = 1};
    if (a->count > 1 && !channels_set_lambda(&m->channels, a->lambda, a->count))
        return fail_at(s, 0, "the wavelengths do not increase");
    m->values = 3 * (uint64_t)a->count;
    m->sides = a->through ? SR_MEASURED_TRANSMISSION : SR_MEASURED_REFLECTION;
    m->is_isotropic = true;
    m->theta_i[1] = m->theta_o[1] = SR_PI / 2;
    m->coverage = 1;
    return SR_OK;
}
