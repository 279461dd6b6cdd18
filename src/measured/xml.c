/* SPDX-License-Identifier: MIT */
/* LBNL's BSDF XML (WINDOW, Radiance): what is in the file, by Expat; klems.c and tree.c make sense of it.
 *
 * WindowElement / Optical / Layer / Material, DataDefinition (IncidentDataStructure, AngleBasis), and WavelengthData
 * for each wavelength and direction: Wavelength, WavelengthDataBlock (WavelengthDataDirection, ColumnAngleBasis,
 * RowAngleBasis or AngleBasis, ScatteringData). Read are Visible (Y), CIE-X and CIE-Z, CIE-u and CIE-v; others, such as
 * Solar, only where no Visible is there. Documents with a DOCTYPE are refused: BSDF files have none, entities only
 * serve mischief. */
#include "measured/private.h"

#include <expat.h>

enum component { COMPONENT_Y, COMPONENT_X, COMPONENT_Z, COMPONENT_U, COMPONENT_V };

struct parsing {
    struct xml_file *x;
    XML_Parser parser;
    struct sr_array text; // of the element that is open
    int depth, block_line;
    bool failed, in_basis, in_block, has_root, keeps_text;
    char wavelength[64], direction[64];
    struct xml_block block;
    bool has_visible;
    struct xml_basis basis;
    double theta_lower, theta_upper;
    int phis;
};

static int line_of(const struct parsing *p)
{
    return (int)XML_GetCurrentLineNumber(p->parser);
}

#define FAIL(p, ...)                                                                                                   \
    do {                                                                                                               \
        if (!(p)->failed)                                                                                              \
            fail_at((p)->x->source, line_of(p), __VA_ARGS__);                                                          \
        (p)->failed = true;                                                                                            \
        XML_StopParser((p)->parser, XML_FALSE);                                                                        \
    } while (0)

static const char *const kept[] = {"IncidentDataStructure",
                                   "AngleBasisName",
                                   "LowerTheta",
                                   "UpperTheta",
                                   "nPhis",
                                   "Wavelength",
                                   "WavelengthDataDirection",
                                   "ColumnAngleBasis",
                                   "RowAngleBasis",
                                   "AngleBasis",
                                   "ScatteringData",
                                   "Name",
                                   "Manufacturer",
                                   NULL};

static const char *local(const char *name) // without a namespace's prefix
{
    const char *colon = strrchr(name, ':');
    return colon ? colon + 1 : name;
}

static void XMLCALL start(void *user, const XML_Char *name, const XML_Char **attributes)
{
    struct parsing *p = user;
    (void)attributes;
    if (p->failed)
        return;
    name = local(name);
    if (p->depth == 0) {
        p->has_root = strcmp(name, "WindowElement") == 0;
        if (!p->has_root)
            FAIL(p, "the document is a <%.40s>, a <WindowElement> is expected", name);
    }
    if (++p->depth > 64)
        FAIL(p, "elements are nested more than 64 deep");
    p->keeps_text = false;
    for (int i = 0; kept[i]; ++i)
        p->keeps_text = p->keeps_text || strcmp(kept[i], name) == 0;
    p->text.count = 0;
    if (strcmp(name, "WavelengthDataBlock") == 0) {
        p->in_block = true;
        p->direction[0] = 0;
        p->block = (struct xml_block){0};
    } else if (strcmp(name, "AngleBasis") == 0 && !p->in_block) {
        p->in_basis = true;
        p->basis = (struct xml_basis){0};
    } else if (strcmp(name, "AngleBasisBlock") == 0) {
        p->theta_lower = p->theta_upper = NAN;
        p->phis = 0;
    } else if (strcmp(name, "WavelengthData") == 0)
        p->wavelength[0] = 0;
    else if (strcmp(name, "ScatteringData") == 0)
        p->block_line = line_of(p);
}

static void XMLCALL characters(void *user, const XML_Char *text, int length)
{
    struct parsing *p = user;
    if (p->failed || !p->keeps_text || length <= 0)
        return;
    if (!sr_array_reserve(&p->text, p->text.count + (size_t)length, 1)) {
        sr_fail(p->x->source->error, SR_ERROR_RESOURCE, "%s: not enough memory", p->x->source->name);
        p->failed = true;
        XML_StopParser(p->parser, XML_FALSE);
        return;
    }
    memcpy((char *)p->text.data + p->text.count, text, (size_t)length);
    p->text.count += (size_t)length;
}

/* the text of the element without blanks around it, cut to size; only what can be printed */
static void copy_text(const struct parsing *p, char *to, size_t size)
{
    const char *a = p->text.data, *b = a ? a + p->text.count : a;
    while (a < b && (unsigned char)*a <= ' ')
        ++a;
    while (b > a && (unsigned char)b[-1] <= ' ')
        --b;
    size_t n = (size_t)(b - a) < size - 1 ? (size_t)(b - a) : size - 1;
    for (size_t i = 0; i < n; ++i)
        to[i] = a[i] >= ' ' && a[i] < 127 ? a[i] : ' ';
    to[n] = 0;
}

static double number_of(struct parsing *p, const char *what)
{
    char word[64];
    copy_text(p, word, sizeof word);
    struct scan s = {.at = word, .end = word + strlen(word)};
    double v;
    if (!scan_number(&s, &v) || s.at < s.end) {
        FAIL(p, "%s is \"%.20s\", a number is expected", what, word);
        return NAN;
    }
    return v;
}

static void end_ring(struct parsing *p)
{
    struct xml_basis *b = &p->basis;
    double before = b->rings ? (double)b->upper[b->rings - 1] * 180 / PI : 0;
    if (b->rings == XML_RINGS)
        FAIL(p, "an angle basis of more than %d rings", XML_RINGS);
    else if (!(p->theta_upper > before + 1e-3 && p->theta_upper < 90.01) || !(fabs(p->theta_lower - before) < 0.02) ||
             p->phis < 1 || p->phis > 4096)
        FAIL(p, "a ring from %g to %g deg of %d patches: one from %g on, up to 90, of 1 to 4096 is expected",
             p->theta_lower, p->theta_upper, p->phis, before);
    else {
        b->upper[b->rings] = (float)(p->theta_upper * PI / 180);
        b->phis[b->rings] = p->phis;
        b->first[b->rings++] = b->total;
        b->total += p->phis;
    }
}

static void end_basis(struct parsing *p)
{
    struct xml_file *x = p->x;
    p->in_basis = false;
    if (p->basis.rings == 0 || p->basis.name[0] == 0)
        return;
    if (p->basis.upper[p->basis.rings - 1] < 1.5707f)
        FAIL(p, "angle basis %s ends at %g deg, 90 is expected", p->basis.name,
             (double)p->basis.upper[p->basis.rings - 1] * 180 / PI);
    else if (x->basis_count < XML_BASES)
        x->bases[x->basis_count++] = p->basis;
}

static void end_block(struct parsing *p)
{
    static const char *const directions[4] = {"Transmission Front", "Transmission Back", "Reflection Front",
                                              "Reflection Back"};
    static const char *const components[XML_COMPONENTS] = {"Visible", "CIE-X", "CIE-Z", "CIE-u", "CIE-v"};
    struct xml_file *x = p->x;
    p->in_block = false;
    int direction = 0, component = 0;
    while (direction < 4 && !text_equal(directions[direction], p->direction))
        ++direction;
    if (direction == 4) {
        FAIL(p, "WavelengthDataDirection is \"%s\", Transmission or Reflection, Front or Back, is expected",
             p->direction);
        return;
    }
    while (component < XML_COMPONENTS && !text_equal(components[component], p->wavelength))
        ++component;
    bool is_visible = component == COMPONENT_Y;
    if (component == XML_COMPONENTS) { // Solar, NIR, …: stands in for Visible where there is none
        if (p->has_visible || (x->wavelength[0] && !text_equal(x->wavelength, p->wavelength)))
            return;
        component = COMPONENT_Y;
    }
    if (is_visible && !p->has_visible) {
        p->has_visible = true;
        for (int i = 0; i < 4; ++i)
            x->blocks[i][COMPONENT_Y] = (struct xml_block){0};
    }
    if (component == COMPONENT_Y)
        memcpy(x->wavelength, p->wavelength, sizeof x->wavelength);
    if (!p->block.text)
        FAIL(p, "%s has no ScatteringData", p->direction);
    else
        x->blocks[direction][component] = p->block;
}

static void XMLCALL end(void *user, const XML_Char *name)
{
    struct parsing *p = user;
    struct xml_file *x = p->x;
    if (p->failed)
        return;
    name = local(name);
    --p->depth;
    if (strcmp(name, "IncidentDataStructure") == 0)
        copy_text(p, x->structure, sizeof x->structure);
    else if (strcmp(name, "Name") == 0 && p->depth == 4)
        copy_text(p, x->title, sizeof x->title);
    else if (strcmp(name, "AngleBasisName") == 0)
        copy_text(p, p->basis.name, sizeof p->basis.name);
    else if (strcmp(name, "LowerTheta") == 0)
        p->theta_lower = number_of(p, "LowerTheta");
    else if (strcmp(name, "UpperTheta") == 0)
        p->theta_upper = number_of(p, "UpperTheta");
    else if (strcmp(name, "nPhis") == 0) {
        double n = number_of(p, "nPhis");
        p->phis = n >= 1 && n <= 4096 ? (int)n : 0;
    } else if (strcmp(name, "AngleBasisBlock") == 0)
        end_ring(p);
    else if (strcmp(name, "AngleBasis") == 0 && p->in_basis)
        end_basis(p);
    else if (strcmp(name, "AngleBasis") == 0)
        copy_text(p, p->block.basis, sizeof p->block.basis);
    else if (strcmp(name, "Wavelength") == 0)
        copy_text(p, p->wavelength, sizeof p->wavelength);
    else if (strcmp(name, "WavelengthDataDirection") == 0)
        copy_text(p, p->direction, sizeof p->direction);
    else if (strcmp(name, "ColumnAngleBasis") == 0)
        copy_text(p, p->block.column, sizeof p->block.column);
    else if (strcmp(name, "RowAngleBasis") == 0)
        copy_text(p, p->block.row, sizeof p->block.row);
    else if (strcmp(name, "ScatteringData") == 0 && p->in_block) {
        p->block.text = sr_arena_alloc(x->source->arena, p->text.count + 1);
        p->block.size = p->text.count;
        p->block.line = p->block_line;
        if (p->block.text && p->text.count)
            memcpy(p->block.text, p->text.data, p->text.count);
        else if (!p->block.text) {
            sr_fail(x->source->error, SR_ERROR_RESOURCE, "%s: not enough memory", x->source->name);
            p->failed = true;
        }
    } else if (strcmp(name, "WavelengthDataBlock") == 0)
        end_block(p);
    p->keeps_text = false;
    p->text.count = 0;
}

static void XMLCALL doctype(void *user, const XML_Char *name, const XML_Char *system, const XML_Char *public,
                            int internal)
{
    struct parsing *p = user;
    (void)name;
    (void)system;
    (void)public;
    (void)internal;
    FAIL(p, "a DOCTYPE: BSDF files are expected to have none");
}

int xml_components(const struct xml_file *x, int kind[3])
{
    bool has_xz = true, has_uv = true;
    for (int d = 0; d < 4; ++d)
        if (x->blocks[d][COMPONENT_Y].text) {
            has_xz = has_xz && x->blocks[d][COMPONENT_X].text && x->blocks[d][COMPONENT_Z].text;
            has_uv = has_uv && x->blocks[d][COMPONENT_U].text && x->blocks[d][COMPONENT_V].text;
        }
    kind[0] = COMPONENT_Y;
    kind[1] = has_xz ? COMPONENT_X : COMPONENT_U;
    kind[2] = has_xz ? COMPONENT_Z : COMPONENT_V;
    return has_xz || has_uv ? 3 : 1;
}

static sr_status understand(struct xml_file *x, struct sr_measured *m)
{
    const struct source *s = x->source;
    static const uint32_t sides[4] = {SR_MEASURED_TRANSMISSION, SR_MEASURED_TRANSMISSION, SR_MEASURED_REFLECTION,
                                      SR_MEASURED_REFLECTION};
    for (int d = 0; d < 4; ++d)
        if (x->blocks[d][COMPONENT_Y].text)
            *(d & 1 ? &m->back_sides : &m->sides) |= sides[d];
    if (!(m->sides | m->back_sides))
        return fail_at(s, 0, "has no WavelengthDataBlock with ScatteringData for Visible light");
    if ((m->sides | m->back_sides) & SR_MEASURED_TRANSMISSION) { // what is known one way is known both ways
        m->sides |= SR_MEASURED_TRANSMISSION;
        m->back_sides |= SR_MEASURED_TRANSMISSION;
    }
    // a sheet of which one side only was measured, and only in reflection, is taken to be opaque and the same on both
    // sides
    m->has_back = (m->sides | m->back_sides) != SR_MEASURED_REFLECTION || (m->sides && m->back_sides);
    m->note = !m->has_back ? "only one side was measured: the other was taken to be like it"
              : text_equal(x->wavelength, "Visible")
                  ? "WINDOW's front is the side of the normal"
                  : "no Visible light in the file: its first other wavelength range was taken";
    size_t n = strlen(x->title);
    char *title = sr_arena_alloc(s->arena, n + 1);
    if (!title)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    memcpy(title, x->title, n);
    m->description = title;
    m->theta_i[1] = m->theta_o[1] = SR_PI / 2;
    m->coverage = 1;
    if (text_equal(x->structure, "TensorTree3") || text_equal(x->structure, "TensorTree4"))
        return read_tree(x, x->structure[10] - '0', m);
    if (text_equal(x->structure, "Columns") || text_equal(x->structure, "Rows"))
        return read_klems(x, m);
    return fail_at(s, 0, "IncidentDataStructure is \"%s\", Columns, Rows, TensorTree3 or TensorTree4 is expected",
                   x->structure);
}

sr_status read_xml(const struct source *s, struct sr_measured *m)
{
    struct xml_file *x = sr_alloc(sizeof *x);
    struct parsing p = {.x = x, .parser = XML_ParserCreate(NULL)};
    sr_status status = SR_OK;
    if (!x || !p.parser)
        status = sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    else {
        x->source = s;
        XML_SetUserData(p.parser, &p);
        XML_SetElementHandler(p.parser, start, end);
        XML_SetCharacterDataHandler(p.parser, characters);
        XML_SetStartDoctypeDeclHandler(p.parser, doctype);
        for (size_t at = 0; status == SR_OK && at < s->size;) {
            size_t chunk = s->size - at < 1u << 20 ? s->size - at : 1u << 20;
            bool ok = XML_Parse(p.parser, s->data + at, (int)chunk, at + chunk == s->size) == XML_STATUS_OK;
            if (!ok && !p.failed)
                fail_at(s, line_of(&p), "column %d: %s", (int)XML_GetCurrentColumnNumber(p.parser) + 1,
                        XML_ErrorString(XML_GetErrorCode(p.parser)));
            if (!ok || p.failed)
                status = SR_ERROR_INPUT;
            at += chunk;
        }
        if (status == SR_OK)
            status = understand(x, m);
    }
    if (p.parser)
        XML_ParserFree(p.parser);
    sr_array_free(&p.text);
    sr_free(x);
    return status;
}
