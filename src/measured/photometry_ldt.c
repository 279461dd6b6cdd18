/* SPDX-License-Identifier: MIT */
/* EULUMDAT: one item a line, intensities for a thousand lumens of lamps.
 *
 *     I = number * conversion_factor * Phi_lamps / 1000 lm                                            [cd]
 *
 * Lines 1 to 26 tell the luminaire, six more each set of lamps (the first is taken), ten direct ratios follow, then Mc
 * C-planes, Ng angles, and the planes that the symmetry Isym keeps: 0 all, 1 one, 2 C0 … C180, 3 C270 … C90 through C0,
 * 4 C0 … C90. A negative number of lamps is absolute photometry. A. W. Stockmar 1990, 1998. Limits: the direct ratios
 * are read over and written as 0. */
#include "measured/photometry_private.h"

/* ---- reading ---- */

struct lines {
    const struct source *s;
    struct scan scan;
};

static bool next_line(struct lines *l, const char **begin, const char **end, const char *what)
{
    if (scan_line(&l->scan, begin, end))
        return true;
    fail_at(l->s, l->scan.line, "the file ends where %s is expected", what);
    return false;
}

/* The line's number, with a point or a comma; empty: `missing`, NaN where there must be one. */
static bool next_value(struct lines *l, double *value, double missing, const char *what)
{
    const char *begin, *end;
    char number[64];
    if (!next_line(l, &begin, &end, what))
        return false;
    while (begin < end && (unsigned char)*begin <= ' ')
        ++begin;
    while (end > begin && (unsigned char)end[-1] <= ' ')
        --end;
    *value = missing;
    if (begin == end && !isnan(missing))
        return true;
    size_t n = (size_t)(end - begin) < sizeof number ? (size_t)(end - begin) : sizeof number;
    for (size_t i = 0; i < n; ++i)
        number[i] = begin[i] == ',' ? '.' : begin[i];
    struct scan scan = scan_start(number, n);
    if (n == sizeof number || !scan_number(&scan, value) || scan.at != scan.end) {
        fail_at(l->s, l->scan.line, "%s is expected, not \"%.*s\"", what, (int)(n < 20 ? n : 20), begin);
        return false;
    }
    return true;
}

static bool next_whole(struct lines *l, double least, double most, const char *what, uint32_t *out)
{
    double value;
    if (!next_value(l, &value, (double)NAN, what))
        return false;
    if (!(value >= least && value <= most && value == floor(value))) {
        fail_at(l->s, l->scan.line, "%s is %g: a whole number from %g to %g is expected", what, value, least, most);
        return false;
    }
    *out = (uint32_t)value;
    return true;
}

static bool next_word(struct lines *l, struct photometry_draft *d, const char *key, const char *what)
{
    const char *begin, *end;
    if (!next_line(l, &begin, &end, what))
        return false;
    while (begin < end && (unsigned char)*begin <= ' ')
        ++begin;
    if (begin == end || photometry_add_word(l->s, d, key, begin, end))
        return true;
    sr_fail(l->s->error, SR_ERROR_RESOURCE, "%s: not enough memory", l->s->name);
    return false;
}

/* Lines 13 to 26 and the lamps: *factor makes candelas of what follows. */
static bool read_luminaire(struct lines *l, struct photometry_draft *d, double *factor, double told[2])
{
    static const char *const names[] = {"the luminaire's length [mm]",
                                        "its width [mm]",
                                        "its height [mm]",
                                        "the luminous length [mm]",
                                        "the luminous width [mm]",
                                        "the luminous height at C0 [mm]",
                                        "that at C90 [mm]",
                                        "that at C180 [mm]",
                                        "that at C270 [mm]",
                                        "the downward flux fraction [%]",
                                        "the light output ratio [%]",
                                        "the conversion factor",
                                        "the tilt [deg]"};
    struct sr_photometry *p = &d->p;
    double v[13];
    for (int i = 0; i < 13; ++i) {
        if (!next_value(l, &v[i], i == 11 ? 1 : 0, names[i]))
            return false;
        if (!(fabs(v[i]) < 1e7))
            return fail_at(l->s, l->scan.line, "%s is %g", names[i], v[i]), false;
    }
    p->is_round = v[3] > 0 && v[4] == 0;
    p->along_c90 = (float)(fabs(v[3]) / 1000);
    p->along_c0 = p->is_round ? p->along_c90 : (float)(fabs(v[4]) / 1000);
    p->height = (float)(fmax(fmax(v[5], v[6]), fmax(v[7], v[8])) / 1000);
    told[0] = v[9];
    told[1] = v[10];
    if (v[11] < 0)
        return fail_at(l->s, l->scan.line - 1, "the conversion factor is %g: a positive one is expected", v[11]), false;
    if (v[12] != 0)
        photometry_note(d, "measured with a tilt of %g deg, which is left to whoever places it", v[12]);
    uint32_t sets;
    if (!next_whole(l, 0, 20, "the number of sets of lamps", &sets))
        return false;
    double flux = 0;
    for (uint32_t k = 0; k < sets; ++k) {
        const char *begin, *end;
        double count, lumens, watts;
        for (int i = 0; k > 0 && i < 6; ++i)
            if (!next_line(l, &begin, &end, "another set of lamps"))
                return false;
        if (k > 0)
            continue;
        if (!next_value(l, &count, 1, "the number of lamps") || !next_word(l, d, "LAMP", "the type of lamps") ||
            !next_value(l, &lumens, 0, "the flux of the lamps [lm]") ||
            !next_word(l, d, "_COLOUR_TEMPERATURE", "the colour of the lamps") ||
            !next_word(l, d, "_COLOUR_RENDERING", "the colour rendering of the lamps") ||
            !next_value(l, &watts, 0, "the power of the lamps [W]"))
            return false;
        if (!(lumens >= 0 && lumens < 1e12) || !(fabs(count) < 1e6) || !(watts < 1e9))
            return fail_at(l->s, l->scan.line, "%g lamps of %g lm and %g W in all", count, lumens, watts), false;
        flux = lumens;
        p->lamp_count = (uint32_t)fabs(count);
        p->lamp_flux = count < 0 || lumens == 0 ? NAN : (float)lumens;
        p->power_W = watts > 0 ? (float)watts : 0;
    }
    if (sets > 1)
        photometry_note(d, "%u sets of lamps, of which the first is taken", sets);
    if (!(flux > 0)) {
        photometry_note(d, "the flux of the lamps is not told; 1000 lm are taken");
        flux = 1000;
        p->lamp_flux = NAN;
    }
    *factor = (v[11] > 0 ? v[11] : 1) * flux / 1000;
    return true;
}

/* How many planes a file keeps. */
static uint32_t copies_of(enum sr_photometry_symmetry symmetry, uint32_t planes)
{
    return symmetry == SR_PHOTOMETRY_AXIAL        ? 1
           : symmetry == SR_PHOTOMETRY_QUADRANT   ? planes / 4 + 1
           : symmetry == SR_PHOTOMETRY_ALL_PLANES ? planes
                                                  : planes / 2 + 1;
}

static bool read_planes(struct lines *l, struct photometry_draft *d, uint32_t planes, uint32_t angles, double factor)
{
    struct sr_photometry *p = &d->p;
    enum sr_photometry_symmetry sym = p->symmetry;
    uint32_t whole = sym == SR_PHOTOMETRY_C0_C180                                     ? 2
                     : sym == SR_PHOTOMETRY_C90_C270 || sym == SR_PHOTOMETRY_QUADRANT ? 4
                                                                                      : 1;
    if (planes % whole)
        return fail_at(l->s, 4, "%u C-planes: a multiple of %u is expected for the symmetry %d", planes, whole,
                       (int)sym),
               false;
    uint32_t count = copies_of(sym, planes);
    float *c = sr_arena_alloc(l->s->arena, (planes + 1) * sizeof *c),
          *kept = sr_arena_alloc(l->s->arena, count * sizeof *kept),
          *gamma = sr_arena_alloc(l->s->arena, angles * sizeof *gamma),
          *I = sr_arena_alloc(l->s->arena, (size_t)count * angles * sizeof *I);
    if (!c || !kept || !gamma || !I) {
        sr_fail(l->s->error, SR_ERROR_RESOURCE, "%s: not enough memory", l->s->name);
        return false;
    }
    double value;
    for (uint32_t i = 0; i < planes; ++i) {
        if (!next_value(l, &value, (double)NAN, "the angle of a C-plane [deg]"))
            return false;
        c[i] = (float)value;
    }
    for (uint32_t j = 0; j < angles; ++j) {
        if (!next_value(l, &value, (double)NAN, "an angle gamma [deg]"))
            return false;
        gamma[j] = (float)value;
    }
    bool is_turned = sym == SR_PHOTOMETRY_C90_C270; // stored from C270 by C0 to C90: the mirror images of C270 … C90
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t to = is_turned ? count - 1 - i : i;
        float angle = c[is_turned ? (3 * planes / 4 + i) % planes : i];
        kept[to] = is_turned ? angle > 180 ? 540 - angle : 180 - angle : sym == SR_PHOTOMETRY_AXIAL ? 0 : angle;
        for (uint32_t j = 0; j < angles; ++j) {
            if (!next_value(l, &value, (double)NAN, "an intensity [cd/klm]"))
                return false;
            if (!(value >= 0 && value * factor < 1e12))
                return fail_at(l->s, l->scan.line, "an intensity of %g cd/klm: 0 to 1e12 cd are expected", value),
                       false;
            I[(size_t)to * angles + j] = (float)(value * factor);
        }
    }
    p->c_count = count;
    p->gamma_count = angles;
    p->c = kept;
    p->gamma = gamma;
    p->candela = I;
    return true;
}

sr_status read_ldt(const struct source *s, struct photometry_draft *d)
{
    struct sr_photometry *p = &d->p;
    struct lines l = {s, scan_start(s->data, s->size)};
    uint32_t type, symmetry, planes, angles;
    double step, factor, told[2], ratio;
    // each number takes a line of its own
    double room = (double)s->size / 2;
    if (!next_word(&l, d, "MANUFAC", "the company") || !next_whole(&l, 0, 9, "the type of the luminaire", &type) ||
        !next_whole(&l, 0, 4, "the symmetry", &symmetry) ||
        !next_whole(&l, 1, fmin(100000, room), "the number of C-planes", &planes) ||
        !next_value(&l, &step, 0, "the distance of C-planes [deg]") ||
        !next_whole(&l, 2, fmin(100000, room), "the number of angles gamma", &angles) ||
        !next_value(&l, &step, 0, "the distance of angles gamma [deg]") ||
        !next_word(&l, d, "TEST", "the number of the report") ||
        !next_word(&l, d, "LUMINAIRE", "the luminaire's name") ||
        !next_word(&l, d, "LUMCAT", "the luminaire's number") || !next_word(&l, d, "_FILE", "the file's name") ||
        !next_word(&l, d, "ISSUEDATE", "the date") || !read_luminaire(&l, d, &factor, told))
        return s->error->status;
    p->symmetry = (enum sr_photometry_symmetry)symmetry;
    if (symmetry == SR_PHOTOMETRY_ALL_PLANES && planes == 1)
        p->symmetry = SR_PHOTOMETRY_AXIAL;
    if ((double)copies_of(p->symmetry, planes) * angles > room)
        return fail_at(s, 4, "%u C-planes of %u angles do not fit into the file", planes, angles);
    for (int k = 0; k < 10; ++k)
        if (!next_value(&l, &ratio, 0, "a direct ratio"))
            return s->error->status;
    if (!read_planes(&l, d, planes, angles, factor))
        return s->error->status;
    sr_status status = photometry_check(p, s->name, s->error);
    if (status != SR_OK)
        return status;
    double flux = sr_photometry_flux(p, 0, 180), down = sr_photometry_flux(p, 0, 90);
    if (flux > 0 && told[0] > 0 && fabs(100 * down / flux - told[0]) > 2)
        photometry_note(d, "the file tells %g %% of the flux downward, its intensities make %.1f %%", told[0],
                        100 * down / flux);
    if (p->lamp_flux > 0 && told[1] > 0 && fabs(100 * flux / (double)p->lamp_flux - told[1]) > 2)
        photometry_note(d, "the file tells a light output ratio of %g %%, its intensities make %.1f %%", told[1],
                        100 * flux / (double)p->lamp_flux);
    return SR_OK;
}

/* ---- writing ---- */

static bool put_word(struct sr_array *text, const struct sr_photometry *p, const char *key, const char *otherwise)
{
    const char *word = sr_photometry_word(p, key);
    return text_put(text, "%.78s\n", word ? word : otherwise);
}

static double even_step(const float *a, uint32_t count)
{
    for (uint32_t i = 2; i < count; ++i)
        if (fabsf(a[i] - a[i - 1] - (a[1] - a[0])) > 1e-3f)
            return 0;
    return count > 1 ? (double)(a[1] - a[0]) : 0;
}

/* Angle of the i-th of all planes around the turn. */
static double plane_angle(const struct sr_photometry *p, uint32_t i, uint32_t planes)
{
    uint32_t last = p->c_count - 1;
    switch (p->symmetry) {
    case SR_PHOTOMETRY_ALL_PLANES:
    case SR_PHOTOMETRY_AXIAL:
        return (double)p->c[i];
    case SR_PHOTOMETRY_C0_C180:
        return i <= last ? (double)p->c[i] : 360 - (double)p->c[planes - i];
    case SR_PHOTOMETRY_QUADRANT: {
        uint32_t half = 2 * last, k = i > half ? planes - i : i;
        double angle = k <= last ? (double)p->c[k] : 180 - (double)p->c[half - k];
        return i > half ? 360 - angle : angle;
    }
    case SR_PHOTOMETRY_C90_C270: {
        // C0 is the mirror image of C180, so that there must be as many planes on both sides of it
        uint32_t quarter = planes / 4, k = (i + planes - quarter) % planes;
        double angle = k <= last ? (double)p->c[k] : 540 - (double)p->c[planes - k];
        return angle >= 360 ? angle - 360 : angle;
    }
    }
    return 0;
}

sr_status print_ldt(const struct sr_photometry *p, struct sr_array *text)
{
    static const uint32_t parts[] = {0, 0, 2, 2, 4};
    uint32_t planes = p->symmetry == SR_PHOTOMETRY_AXIAL ? 1
                      : parts[p->symmetry]               ? parts[p->symmetry] * (p->c_count - 1)
                                                         : p->c_count;
    bool is_turned = p->symmetry == SR_PHOTOMETRY_C90_C270;
    if (p->c[0] != 0 && !is_turned)
        return SR_ERROR_INPUT;
    if (is_turned && (planes % 4 || fabs(plane_angle(p, planes / 4 * 2, planes) - 180) > 0.01)) // none at C180
        return SR_ERROR_INPUT;
    double flux = sr_photometry_flux(p, 0, 180), down = sr_photometry_flux(p, 0, 90);
    bool is_absolute = isnan(p->lamp_flux);
    double lamp_flux = is_absolute ? flux : (double)p->lamp_flux;
    int type = p->symmetry == SR_PHOTOMETRY_AXIAL                                        ? 1
               : fmaxf(p->along_c0, p->along_c90) > 4 * fminf(p->along_c0, p->along_c90) ? 2
                                                                                         : 3;
    double step_c = p->symmetry == SR_PHOTOMETRY_AXIAL ? 0 : even_step(p->c, p->c_count);
    bool ok = put_word(text, p, "MANUFAC", "not told") &&
              text_put(text, "%d\n%d\n%u\n", type, (int)p->symmetry, planes) && text_number(text, step_c, "\n") &&
              text_put(text, "%u\n", p->gamma_count) && text_number(text, even_step(p->gamma, p->gamma_count), "\n") &&
              put_word(text, p, "TEST", "not told") && put_word(text, p, "LUMINAIRE", "not told") &&
              put_word(text, p, "LUMCAT", "") && put_word(text, p, "_FILE", "") && put_word(text, p, "ISSUEDATE", "");
    double height = 1000 * (double)p->height, length = 1000 * (double)p->along_c90,
           width = p->is_round ? 0 : 1000 * (double)p->along_c0;
    double numbers[] = {
        length, width, height, length, width, height, height, height, height, 100 * down / flux, 100 * flux / lamp_flux,
        1,      0};
    for (int i = 0; ok && i < 13; ++i)
        ok = text_number(text, numbers[i], "\n");
    ok = ok && text_put(text, "1\n%s%u\n", is_absolute ? "-" : "", p->lamp_count ? p->lamp_count : 1) &&
         put_word(text, p, "LAMP", "not told") && text_number(text, lamp_flux, "\n") &&
         put_word(text, p, "_COLOUR_TEMPERATURE", "") && put_word(text, p, "_COLOUR_RENDERING", "") &&
         text_number(text, (double)p->power_W, "\n") && text_put(text, "0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n");
    for (uint32_t i = 0; ok && i < planes; ++i)
        ok = text_number(text, plane_angle(p, i, planes), "\n");
    for (uint32_t j = 0; ok && j < p->gamma_count; ++j)
        ok = text_number(text, (double)p->gamma[j], "\n");
    for (uint32_t i = 0; ok && i < p->c_count; ++i) {
        const float *plane = p->candela + (size_t)(is_turned ? p->c_count - 1 - i : i) * p->gamma_count;
        for (uint32_t j = 0; ok && j < p->gamma_count; ++j)
            ok = text_number(text, (double)plane[j] * 1000 / lamp_flux, "\n");
    }
    return ok ? SR_OK : SR_ERROR_RESOURCE;
}
