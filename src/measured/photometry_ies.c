/* SPDX-License-Identifier: MIT */
/* IES LM-63: words in brackets, TILT, ten numbers and three, angles, candelas.
 *
 *     lamps lumens/lamp multiplier n_vertical n_horizontal type units width length height
 *     ballast_factor future_use watts
 *     I = number * multiplier * ballast_factor [* the twelfth number, before 1995]                    [cd]
 *
 * Type C: vertical angles from nadir, horizontal ones counter-clockwise. Types B and A have other axes:
 *     B: d = (cos H sin V, -sin H, -cos H cos V)        A: d = (cos V cos H, -cos V sin H, sin V)     [1]
 * which is nadir at H = 0, V = 0 and at V = -90, as the standard has it; they are resampled. LM-63-1986, -1991, -1995,
 * -2002 and -2019. Limits: TILT=INCLUDE is read, but the luminaire is taken to hang as it was measured; TILT=file is
 * refused. */
#include "measured/photometry_private.h"

/* ---- reading ---- */

static bool no_memory(const struct source *s)
{
    sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    return false;
}

/* "[KEY] text" or a line of plain text */
static bool add_line(const struct source *s, struct photometry_draft *d, const char *begin, const char *end)
{
    char key[64] = "";
    while (begin < end && (*begin == ' ' || *begin == '\t'))
        ++begin;
    const char *close = begin < end && *begin == '[' ? memchr(begin, ']', (size_t)(end - begin)) : NULL;
    if (close && close - begin - 1 < (int)sizeof key) {
        for (const char *c = begin + 1; c < close; ++c)
            key[c - begin - 1] = *c > ' ' && *c < 127 ? *c : '_';
        key[close - begin - 1] = 0;
        begin = close + 1;
    }
    return photometry_add_word(s, d, key, begin, end) || no_memory(s);
}

static int year_of(const char *begin, const char *end)
{
    static const struct {
        const char *line;
        int year;
    } known[] = {{"IESNA91", 1991}, {"IESNA:LM-63-1995", 1995}, {"IESNA:LM-63-2002", 2002}, {"IES:LM-63-2019", 2019}};
    for (int i = 0; i < 4; ++i)
        if (text_has_prefix(begin, end, known[i].line))
            return known[i].year;
    return 0;
}

/* The next number, over ends of lines; counts lines. */
static bool next_number(struct scan *t, double *value)
{
    while (t->at < t->end && (*t->at == ' ' || *t->at == '\t' || *t->at == ',' || *t->at == '\r' || *t->at == '\n')) {
        t->line += *t->at == '\n';
        t->at++;
    }
    return scan_number(t, value);
}

static bool read_numbers(const struct source *s, struct scan *t, double *out, size_t count, const char *what)
{
    for (size_t i = 0; i < count; ++i)
        if (!next_number(t, &out[i])) {
            if (t->at < t->end)
                fail_at(s, t->line, "%s %zu of %zu: a number is expected, not \"%.*s\"", what, i + 1, count,
                        (int)(t->end - t->at < 12 ? t->end - t->at : 12), t->at);
            else
                fail_at(s, t->line, "the file ends after %zu of %zu %s", i, count, what);
            return false;
        }
    return true;
}

/* Positive count that the rest of the file has room for. */
static bool as_count(const struct source *s, const struct scan *t, double value, double least, const char *what,
                     uint32_t *out)
{
    double room = (double)(t->end - t->at) / 2 + 1;
    if (!(value >= least && value == floor(value)) || value > room) {
        fail_at(s, t->line,
                value > room && value == floor(value) ? "%g %s do not fit into the rest of the file"
                                                      : "%g %s: a whole number is expected",
                value, what);
        return false;
    }
    *out = (uint32_t)value;
    return true;
}

static bool read_tilt(const struct source *s, struct scan *t, struct photometry_draft *d, const char *begin,
                      const char *end)
{
    while (begin < end && (*begin == ' ' || *begin == '='))
        ++begin;
    while (end > begin && (unsigned char)end[-1] <= ' ')
        --end;
    if (end - begin == 4 && text_has_prefix(begin, end, "NONE"))
        return true;
    if (!(end - begin == 7 && text_has_prefix(begin, end, "INCLUDE"))) {
        fail_at(
            s, t->line,
            "TILT=%.*s: how the lamp's output changes as it tilts stands in another file, which is not read; TILT=NONE or TILT=INCLUDE is expected",
            (int)(end - begin < 60 ? end - begin : 60), begin);
        return false;
    }
    t->line++;
    double head[2], pair;
    uint32_t count;
    if (!read_numbers(s, t, head, 2, "numbers of TILT") || !as_count(s, t, head[1], 1, "angles of TILT", &count))
        return false;
    for (uint32_t i = 0; i < 2 * count; ++i)
        if (!read_numbers(s, t, &pair, 1, "numbers of TILT"))
            return false;
    photometry_note(d, "TILT factors (%u) are left aside: the luminaire hangs as it was measured", count);
    t->line--;
    return true;
}

/* Types A and B: intensity toward d, bilinear in V and H; a grid that begins at 0 is mirrored in H. [cd] */
struct other_type {
    int type;
    uint32_t nv, nh;
    const float *v, *h, *candela;
};
static double other_intensity(const struct other_type *o, sr_vec3 d)
{
    double v, h;
    if (o->type == 2) {
        h = -asin(fmax(-1, fmin(1, (double)d.y))) * 180 / PI;
        v = atan2((double)d.x, -(double)d.z) * 180 / PI;
    } else {
        h = -atan2((double)d.y, (double)d.x) * 180 / PI;
        v = asin(fmax(-1, fmin(1, (double)d.z))) * 180 / PI;
    }
    if (o->h[0] >= 0)
        h = fabs(h);
    const double edge = 1e-3;
    if (v < (double)o->v[0] - edge || v > (double)o->v[o->nv - 1] + edge || h < (double)o->h[0] - edge ||
        h > (double)o->h[o->nh - 1] + edge)
        return 0;
    float s = 0, t = 0;
    size_t i = o->nh > 1 ? (size_t)axis_find(o->h, (int)o->nh, (float)h, &s) : 0,
           j = o->nv > 1 ? (size_t)axis_find(o->v, (int)o->nv, (float)v, &t) : 0;
    size_t right = o->nh > 1 ? o->nv : 0, up = o->nv > 1;
    const float *at = o->candela + i * o->nv + j;
    return (1 - (double)s) * ((1 - (double)t) * (double)at[0] + (double)t * (double)at[up]) +
           (double)s * ((1 - (double)t) * (double)at[right] + (double)t * (double)at[right + up]);
}

static bool resample(const struct source *s, struct photometry_draft *d, const struct other_type *o)
{
    enum { PLANES = 72, GAMMAS = 181 };
    for (int axis = 0; axis < 2; ++axis) {
        const float *a = axis ? o->h : o->v;
        for (uint32_t i = 0; i < (axis ? o->nh : o->nv); ++i)
            if (!(fabsf(a[i]) <= 180) || (i > 0 && !(a[i] > a[i - 1]))) {
                fail_at(s, 0, "%s angle %u is %g deg: increasing angles from -180 to 180 are expected",
                        axis ? "horizontal" : "vertical", i + 1, (double)a[i]);
                return false;
            }
    }
    float *c = sr_arena_alloc(s->arena, PLANES * sizeof *c), *gamma = sr_arena_alloc(s->arena, GAMMAS * sizeof *gamma),
          *candela = sr_arena_alloc(s->arena, (size_t)PLANES * GAMMAS * sizeof *candela);
    if (!c || !gamma || !candela)
        return no_memory(s);
    for (int i = 0; i < PLANES; ++i)
        c[i] = 360.0f * (float)i / PLANES;
    for (int j = 0; j < GAMMAS; ++j)
        gamma[j] = (float)j;
    for (int i = 0; i < PLANES; ++i)
        for (int j = 0; j < GAMMAS; ++j) {
            double g = j * PI / 180, a = (double)c[i] * PI / 180;
            sr_vec3 w = {(float)(sin(g) * cos(a)), (float)(sin(g) * sin(a)), (float)-cos(g)};
            candela[i * GAMMAS + j] = (float)other_intensity(o, w);
        }
    d->p.symmetry = SR_PHOTOMETRY_ALL_PLANES;
    d->p.c_count = PLANES;
    d->p.gamma_count = GAMMAS;
    d->p.c = c;
    d->p.gamma = gamma;
    d->p.candela = candela;
    photometry_note(d, "type %c photometry, resampled to C-planes by 5 deg and angles by 1 deg",
                    o->type == 2 ? 'B' : 'A');
    return true;
}

/* The symmetry that the horizontal angles tell; the plane at 360 deg is the one at 0. */
static bool set_symmetry(const struct source *s, struct photometry_draft *d, float *h, uint32_t count)
{
    struct sr_photometry *p = &d->p;
    float first = h[0], last = h[count - 1];
    p->c_count = count;
#define IS(x, y) (fabsf((x) - (y)) < 0.01f)
    if (count == 1) {
        if (!IS(first, 0))
            photometry_note(d, "the only C-plane is at %g deg, taken for all", (double)first);
        h[0] = 0;
        p->symmetry = SR_PHOTOMETRY_AXIAL;
    } else if (IS(first, 90) && IS(last, 270))
        p->symmetry = SR_PHOTOMETRY_C90_C270;
    else if (!IS(first, 0))
        return fail_at(s, 0, "the first horizontal angle is %g deg: 0 is expected, or 90 to 270", (double)first), false;
    else if (IS(last, 90))
        p->symmetry = SR_PHOTOMETRY_QUADRANT;
    else if (IS(last, 180))
        p->symmetry = SR_PHOTOMETRY_C0_C180;
    else if (IS(last, 360)) {
        p->symmetry = SR_PHOTOMETRY_ALL_PLANES;
        p->c_count = count - 1;
        if (count == 2) // 0 and 360 are the same plane
            p->symmetry = SR_PHOTOMETRY_AXIAL;
    } else if (last > 180 && last < 360) {
        p->symmetry = SR_PHOTOMETRY_ALL_PLANES;
        photometry_note(d,
                        "the last horizontal angle is %g deg, without the plane at 360, which is taken to be that at 0",
                        (double)last);
    } else
        return fail_at(s, 0, "the last horizontal angle is %g deg: 0, 90, 180 or 360 is expected", (double)last), false;
#undef IS
    return true;
}

static bool read_distribution(const struct source *s, struct scan *t, struct photometry_draft *d, const double head[10],
                              double factor)
{
    struct sr_photometry *p = &d->p;
    uint32_t nv, nh, type = (uint32_t)head[5];
    if (!as_count(s, t, head[3], 2, "vertical angles", &nv) || !as_count(s, t, head[4], 1, "horizontal angles", &nh))
        return false;
    if ((double)nv * nh > (double)(t->end - t->at) / 2 + 1)
        return fail_at(s, t->line, "%u by %u intensities do not fit into the rest of the file", nv, nh), false;
    size_t n = (size_t)nv * nh;
    float *v = sr_arena_alloc(s->arena, nv * sizeof *v), *h = sr_arena_alloc(s->arena, nh * sizeof *h),
          *I = sr_arena_alloc(s->arena, n * sizeof *I);
    if (!v || !h || !I)
        return no_memory(s);
    struct {
        float *to;
        size_t count;
        double factor;
        const char *what;
    } runs[] = {{v, nv, 1, "vertical angles"}, {h, nh, 1, "horizontal angles"}, {I, n, factor, "candela values"}};
    for (int k = 0; k < 3; ++k)
        for (size_t i = 0; i < runs[k].count; ++i) {
            double value;
            if (!next_number(t, &value)) {
                if (t->at < t->end)
                    fail_at(s, t->line, "%s: a number is expected, not \"%.*s\"", runs[k].what,
                            (int)(t->end - t->at < 12 ? t->end - t->at : 12), t->at);
                else
                    fail_at(s, t->line, "the file ends after %zu of %zu %s", i, runs[k].count, runs[k].what);
                return false;
            }
            if (k == 2 && !(value >= 0 && value * factor < 1e12))
                return fail_at(s, t->line, "candela value %zu is %g: 0 to 1e12 cd are expected", i + 1, value), false;
            runs[k].to[i] = (float)(value * runs[k].factor);
        }
    while (t->at < t->end && (unsigned char)*t->at <= ' ')
        ++t->at;
    if (t->at < t->end && *t->at != 26) // DOS ends files by it
        photometry_note(d, "what follows the intensities is left aside");
    if (type != 1)
        return resample(s, d, &(struct other_type){(int)type, nv, nh, v, h, I});
    p->gamma_count = nv;
    p->gamma = v;
    p->c = h;
    p->candela = I;
    if (v[0] > 0.01f && fabsf(v[0] - 90) > 0.01f)
        photometry_note(d, "no light is told below gamma %g deg", (double)v[0]);
    if (v[nv - 1] < 179.99f && fabsf(v[nv - 1] - 90) > 0.01f)
        photometry_note(d, "no light is told above gamma %g deg", (double)v[nv - 1]);
    return set_symmetry(s, d, h, nh);
}

sr_status read_ies(const struct source *s, struct photometry_draft *d)
{
    struct sr_photometry *p = &d->p;
    struct scan lines = scan_start(s->data, s->size);
    const char *begin, *end;
    bool has_tilt = false;
    p->year = 1986;
    while (!has_tilt && scan_line(&lines, &begin, &end)) {
        int year = lines.line == 1 ? year_of(begin, end) : 0;
        const char *word = begin;
        while (word < end && *word == ' ')
            ++word;
        if (year)
            p->year = year;
        else if (lines.line == 1 && text_has_prefix(begin, end, "IES"))
            photometry_note(d, "the first line names an unknown edition of LM-63, read as that of 2002"),
                p->year = 2002;
        else if (text_has_prefix(word, end, "TILT"))
            has_tilt = true;
        else if (!add_line(s, d, begin, end))
            return s->error->status;
    }
    if (!has_tilt)
        return fail_at(s, lines.line, "the file ends before a line TILT=");
    struct scan t = lines;
    t.at = lines.line_start;
    if (!read_tilt(s, &t, d, begin + (text_has_prefix(begin, end, "TILT") ? 4 : 0), end))
        return s->error->status;
    t.line++;
    double head[10], rest[3];
    if (!read_numbers(s, &t, head, 10, "numbers after TILT") || !read_numbers(s, &t, rest, 3, "numbers of the ballast"))
        return s->error->status;
    if (head[5] != 1 && head[5] != 2 && head[5] != 3)
        return fail_at(s, t.line, "photometric type %g: 1 (C), 2 (B) or 3 (A) is expected", head[5]);
    if (head[6] != 1 && head[6] != 2)
        return fail_at(s, t.line, "units type %g: 1 (feet) or 2 (metres) is expected", head[6]);
    if (!(head[0] >= 0 && head[0] < 1e6) || !(fabs(head[1]) < 1e12))
        return fail_at(s, t.line, "%g lamps of %g lm", head[0], head[1]);
    double factor = head[2] * rest[0] * (p->year < 1995 ? rest[1] : 1);
    if (!(factor > 0 && factor < 1e9))
        return fail_at(s, t.line, "multiplier %g, ballast factor %g and lamp factor %g: positive ones are expected",
                       head[2], rest[0], rest[1]);
    double metre = head[6] == 1 ? 0.3048 : 1;
    for (int k = 7; k < 10; ++k)
        if (!(fabs(head[k]) < 1e4))
            return fail_at(s, t.line, "an opening of %g by %g by %g", head[7], head[8], head[9]);
    p->lamp_count = (uint32_t)head[0];
    p->lamp_flux = head[1] > 0 ? (float)(head[0] * head[1]) : NAN;
    p->is_round = head[7] < 0 || head[8] < 0;
    // before 2002 a disc was told by its width alone
    double width = fabs(head[7]), length = p->is_round && head[8] == 0 ? width : fabs(head[8]);
    p->along_c90 = (float)((p->is_round && head[7] == 0 ? length : width) * metre);
    p->along_c0 = (float)(length * metre);
    p->height = (float)(fabs(head[9]) * metre);
    p->power_W = rest[2] > 0 && rest[2] < 1e9 ? (float)rest[2] : 0;
    return read_distribution(s, &t, d, head, factor) ? SR_OK : s->error->status;
}

/* ---- writing ---- */

/* Numbers in lines of less than 80 characters. */
static bool put_run(struct sr_array *text, const float *values, size_t count)
{
    bool ok = true;
    size_t start = text->count;
    for (size_t i = 0; ok && i < count; ++i) {
        bool is_last = i + 1 == count || text->count - start > 60;
        ok = text_number(text, (double)values[i], is_last ? "\n" : " ");
        if (is_last)
            start = text->count;
    }
    return ok;
}

sr_status print_ies(const struct sr_photometry *p, struct sr_array *text)
{
    static const char *const wanted[] = {"TEST", "TESTLAB", "ISSUEDATE", "MANUFAC"};
    int year = p->year ? p->year : 2002;
    bool closes = p->symmetry == SR_PHOTOMETRY_ALL_PLANES && p->c[0] == 0;
    bool ok = year < 1991 || text_put(text, "%s\n",
                                      year < 1995   ? "IESNA91"
                                      : year < 2002 ? "IESNA:LM-63-1995"
                                      : year < 2019 ? "IESNA:LM-63-2002"
                                                    : "IES:LM-63-2019");
    for (uint32_t i = 0; ok && i < p->word_count; ++i)
        ok = year < 1991 || !p->words[i].key[0]
                 ? text_put(text, "%s%.240s\n", year < 1991 ? "" : "[OTHER] ", p->words[i].text)
                 : text_put(text, "[%.60s] %.180s\n", p->words[i].key, p->words[i].text);
    for (int i = 0; ok && year >= 1991 && i < 4; ++i)
        ok = sr_photometry_word(p, wanted[i]) || text_put(text, "[%s] not told\n", wanted[i]);
    double lamps = p->lamp_count ? p->lamp_count : 1;
    ok = ok && text_put(text, "TILT=NONE\n") && text_number(text, lamps, " ");
    ok = ok && text_number(text, isnan(p->lamp_flux) ? -1 : (double)p->lamp_flux / lamps, " ");
    double sign = p->is_round ? -1 : 1,
           size[3] = {sign * (double)p->along_c90, sign * (double)p->along_c0, (double)p->height};
    ok = ok && text_put(text, "1 %u %u 1 2 ", p->gamma_count, p->c_count + closes);
    for (int k = 0; ok && k < 3; ++k)
        ok = text_number(text, size[k] == 0 ? 0 : size[k], k < 2 ? " " : "\n1 1 ");
    ok = ok && text_number(text, (double)p->power_W, "\n");
    ok = ok && put_run(text, p->gamma, p->gamma_count);
    for (uint32_t i = 0; ok && i < p->c_count; ++i)
        ok = text_number(text, (double)p->c[i], i + 1 < p->c_count || closes ? (i % 10 == 9 ? "\n" : " ") : "\n");
    ok = ok && (!closes || text_put(text, "360\n"));
    for (uint32_t i = 0; ok && i < p->c_count + closes; ++i)
        ok = put_run(text, p->candela + (size_t)(i % p->c_count) * p->gamma_count, p->gamma_count);
    return ok ? SR_OK : SR_ERROR_RESOURCE;
}
