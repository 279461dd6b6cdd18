/* SPDX-License-Identifier: MIT */
/* Files of BSDF data: told apart by their content, made one kind of object.
 *
 *     f = number / (1, |cos_theta_o|, pi)   for numbers that are the BSDF, the BSDF times cosine,
 *         or a reflectance factor
 *
 * Data of one side serve for both: directions are mirrored in the surface. */
#include "measured/private.h"

#define LEAST_COSINE 1e-3f // by which numbers that contain the cosine are divided at least

const char *sr_measured_format_name(enum sr_measured_format format)
{
    static const char *const names[] = {[SR_MEASURED_MERL] = "MERL binary",
                                        [SR_MEASURED_RGL] = "RGL tensor file",
                                        [SR_MEASURED_POLARISED] = "polarised tensor file",
                                        [SR_MEASURED_KLEMS] = "BSDF XML, Klems matrices",
                                        [SR_MEASURED_TREE] = "BSDF XML, tensor tree",
                                        [SR_MEASURED_CORNELL] = "Cornell goniometer text",
                                        [SR_MEASURED_ASTM] = "ASTM text",
                                        [SR_MEASURED_ABG] = "ABg coefficients",
                                        [SR_MEASURED_TABLE] = "text table"};
    return names[format];
}

static bool is_text(const struct source *s)
{
    size_t n = s->size < 4096 ? s->size : 4096;
    for (size_t i = 0; i < n; ++i) {
        unsigned char c = (unsigned char)s->data[i];
        if (c < 32 && c != '\n' && c != '\r' && c != '\t')
            return false;
    }
    return true;
}

/* What kind of text: by its first words. */
static enum sr_measured_format text_format(const struct source *s)
{
    struct scan lines = scan_start(s->data, s->size);
    const char *begin, *end;
    for (int n = 0; n < 200 && scan_line(&lines, &begin, &end); ++n) {
        struct scan t = {.at = begin, .end = end};
        char word[32];
        scan_separators(&t);
        if (t.at >= t.end)
            continue;
        if (*t.at == '#') {
            t.at++;
            scan_separators(&t);
            if (text_has_prefix(t.at, end, "num wls"))
                return SR_MEASURED_CORNELL;
            continue;
        }
        scan_word(&t, word, sizeof word);
        if (text_equal(word, "ABg"))
            return SR_MEASURED_ABG;
        if (text_equal(word, "VARS") || text_equal(word, "NUM_POINTS"))
            return SR_MEASURED_ASTM;
        double v;
        t = (struct scan){.at = begin, .end = end};
        scan_separators(&t);
        if (scan_number(&t, &v) || text_has_prefix(word, word + strlen(word), "theta"))
            return SR_MEASURED_TABLE;
    }
    return SR_MEASURED_TABLE;
}

static sr_status recognise(const struct source *s, enum sr_measured_format *format)
{
    static const char magic[12] = "tensor_file";
    size_t blank = s->size >= 3 && memcmp(s->data, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (blank < s->size &&
           (s->data[blank] == ' ' || s->data[blank] == '\n' || s->data[blank] == '\r' || s->data[blank] == '\t'))
        ++blank;
    int32_t n[3] = {0};
    if (s->size >= sizeof n)
        memcpy(n, s->data, sizeof n);
    if (s->size == 0 || blank == s->size)
        return fail_at(s, 0, "is empty, BSDF data are expected");
    if (memcmp(s->data, magic, s->size < sizeof magic ? s->size : sizeof magic) == 0 && s->size >= 6)
        *format = SR_MEASURED_RGL;
    else if (s->data[blank] == '<')
        *format = SR_MEASURED_KLEMS;
    else if (n[0] == 90 || (n[0] > 0 && n[1] > 0 && n[2] > 0 && n[0] <= 4096 && n[1] <= 4096 && n[2] <= 4096))
        *format = SR_MEASURED_MERL;
    else if (is_text(s))
        *format = text_format(s);
    else
        return fail_at(s, 0,
                       "is no BSDF data that is known: MERL binary, RGL tensor file, BSDF XML, or text is expected");
    return SR_OK;
}

sr_status measured_load(const char *name, const void *data, size_t size, const struct sr_measured_options *options,
                        struct sr_arena *arena, struct sr_measured **out, struct sr_error *error)
{
    static sr_status (*const readers[])(const struct source *,
                                        struct sr_measured *) = {[SR_MEASURED_MERL] = read_merl,
                                                                 [SR_MEASURED_RGL] = read_tensor_file,
                                                                 [SR_MEASURED_POLARISED] = read_tensor_file,
                                                                 [SR_MEASURED_KLEMS] = read_xml,
                                                                 [SR_MEASURED_TREE] = read_xml,
                                                                 [SR_MEASURED_CORNELL] = read_cornell,
                                                                 [SR_MEASURED_ASTM] = read_astm,
                                                                 [SR_MEASURED_ABG] = read_abg,
                                                                 [SR_MEASURED_TABLE] = read_table};
    struct source s = {.name = name, .data = data, .size = size, .arena = arena, .error = error};
    if (options)
        s.options = *options;
    *out = NULL;
    struct sr_measured *m = sr_arena_alloc(arena, sizeof *m);
    if (!m)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", name);
    m->description = m->note = "";
    sr_status status = recognise(&s, &m->format);
    if (status == SR_OK)
        status = readers[m->format](&s, m);
    if (status != SR_OK)
        return status;
    bool is_open = m->format == SR_MEASURED_TABLE || m->format == SR_MEASURED_ASTM || m->format == SR_MEASURED_CORNELL;
    if (!is_open && s.options.quantity > SR_MEASURED_BSDF)
        return fail_at(&s, 0, "a %s says what its numbers are: no other quantity can be chosen",
                       sr_measured_format_name(m->format));
    if (m->quantity == SR_MEASURED_AUTO)
        m->quantity = s.options.quantity ? s.options.quantity : SR_MEASURED_BSDF;
    *out = m;
    return SR_OK;
}

sr_status sr_measured_parse(const char *name, const void *data, size_t size, const struct sr_measured_options *options,
                            struct sr_arena *arena, const struct sr_measured **out, struct sr_error *error)
{
    struct sr_measured *m;
    *out = NULL;
    sr_status status = measured_load(name, data, size, options, arena, &m, error);
    if (status == SR_OK && guide_build(m, arena) != SR_OK)
        status = sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", name);
    if (status == SR_OK)
        *out = m;
    return status;
}

sr_status sr_measured_read(const char *path, const struct sr_measured_options *options, struct sr_arena *arena,
                           const struct sr_measured **out, struct sr_error *error)
{
    char *data;
    size_t size;
    *out = NULL;
    sr_status status = sr_file_read(path, (size_t)1 << 32, &data, &size, error);
    if (status == SR_OK) {
        status = sr_measured_parse(path, data, size, options, arena, out, error);
        sr_free(data);
    }
    return status;
}

uint32_t sr_measured_sides(const struct sr_measured *m)
{
    return m->sides | m->back_sides;
}

sr_spectrum sr_measured_f(const struct sr_measured *m, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    float product = wo.z * wi.z;
    uint32_t side = product < 0 ? SR_MEASURED_TRANSMISSION : SR_MEASURED_REFLECTION;
    if (!m->has_back && wi.z < 0) {
        wi.z = -wi.z;
        wo.z = -wo.z;
    }
    if (!((m->has_back && wi.z < 0 ? m->back_sides : m->sides) & side) && !(!m->has_back && m->back_sides & side))
        return SR_BLACK;
    if (!(product != 0))
        return SR_BLACK;
    sr_spectrum f = m->f(m->data, wo, wi, lambda);
    if (m->quantity == SR_MEASURED_TIMES_COSINE)
        f /= sr_max(fabsf(wo.z), LEAST_COSINE);
    else if (m->quantity == SR_MEASURED_FACTOR)
        f *= SR_INV_PI;
    return f;
}
