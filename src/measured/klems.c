/* SPDX-License-Identifier: MIT */
/* Klems' matrices: one number of the BSDF for each pair of patches of the two hemispheres.
 *
 *     f = B[patch of light leaving][patch of light arriving]      [1/sr], constant over both patches
 *
 * A basis divides the polar angle into rings and each ring into n patches, the first of them centred at phi = 0; a
 * patch's projected solid angle is pi (cos^2 theta_1 - cos^2 theta_2) / n. The patch of arriving light is that of the
 * opposite azimuth, so that the diagonal holds the mirror direction and the straight way through. J. H. Klems 1994;
 * conventions of LBNL's WINDOW and of Radiance (G. Ward). WINDOW's front is our side of +z. Directions are drawn
 * exactly: a patch by B Omega_p, inside of it by the cosine, so that p(wi) = f |cos_theta_i| / SUM of B Omega_p. Narrow
 * peaks are spread over their patch, 10 deg or so wide. */
#include "measured/private.h"

struct matrix {
    const struct xml_basis *in, *out;
    float *values; // out, in, channel; NULL: not measured
};

/* Where light may come from, seen from one face: sums of B Omega over the patches of wi, a row for each patch of wo. */
struct chooser {
    const struct matrix *matrix; // NULL: from nowhere
    bool is_reversed;            // the matrix knows the other way only: wo is where its light arrives
    int rows, columns;
    float *sums; // columns + 1 a row
};

struct klems {
    struct chooser choosers[2][2]; // face of wo, passing through
    struct xml_basis bases[XML_BASES + 3];
    int basis_count;
    struct matrix matrices[4]; // enum xml_direction
    struct channels channels;
};

static void known_basis(struct xml_basis *b, const char *name, int rings, const float *edges, const int *phis)
{
    *b = (struct xml_basis){.rings = rings};
    memcpy(b->name, name, strlen(name));
    for (int i = 0; i < rings; ++i) {
        b->upper[i] = (float)((double)edges[i + 1] * PI / 180);
        b->phis[i] = phis[i];
        b->first[i] = b->total;
        b->total += phis[i];
    }
}

static int patch(const struct xml_basis *b, float x, float y, float z)
{
    float theta = atan2f(sqrtf(x * x + y * y), fabsf(z));
    float turn = x != 0 || y != 0 ? atan2f(y, x) * (0.5f * SR_INV_PI) : 0;
    turn -= floorf(turn);
    int ring = 0;
    while (ring < b->rings - 1 && theta >= b->upper[ring])
        ++ring;
    int k = (int)(turn * (float)b->phis[ring] + 0.5f);
    return b->first[ring] + (k >= b->phis[ring] ? k - b->phis[ring] : k);
}

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct klems *k = data;
    bool through = wo.z * wi.z < 0;
    const struct matrix *matrix = &k->matrices[(through ? XML_TRANSMISSION_FRONT : XML_REFLECTION_FRONT) + (wi.z < 0)];
    if (!matrix->values && through) { // the same both ways, by reciprocity
        sr_vec3 w = wo;
        wo = wi;
        wi = w;
        matrix = &k->matrices[XML_TRANSMISSION_FRONT + (wi.z < 0)];
    }
    if (!matrix->values && !through)
        matrix = &k->matrices[XML_REFLECTION_FRONT + (wi.z > 0)]; // one-sided data; others are refused before
    if (!matrix->values)
        return SR_BLACK;
    int in = patch(matrix->in, -wi.x, -wi.y, wi.z), out = patch(matrix->out, wo.x, wo.y, wo.z);
    struct corners at = {1, {((size_t)out * (size_t)matrix->in->total + (size_t)in) * (size_t)k->channels.count}, {1}};
    return channels_eval(&k->channels, matrix->values, &at, lambda);
}

static float omega_of(const struct xml_basis *b, int ring) // [sr] projected
{
    float lo = ring ? cosf(b->upper[ring - 1]) : 1, hi = cosf(b->upper[ring]);
    return SR_PI * (lo - hi) * (lo + hi) / (float)b->phis[ring];
}

static int ring_of(const struct xml_basis *b, int patch_index)
{
    int ring = 0;
    while (ring < b->rings - 1 && patch_index >= b->first[ring + 1])
        ++ring;
    return ring;
}

static float mean_value(const struct klems *k, const struct matrix *m, int in, int out)
{
    const float *v = m->values + ((size_t)out * (size_t)m->in->total + (size_t)in) * (size_t)k->channels.count;
    return k->channels.count == 3 ? (v[0] + v[1] + v[2]) / 3 : v[0];
}

static const float *row_of(const struct chooser *c, sr_vec3 wo)
{
    if (!c->matrix)
        return NULL;
    int row = c->is_reversed ? patch(c->matrix->in, -wo.x, -wo.y, wo.z) : patch(c->matrix->out, wo.x, wo.y, wo.z);
    return c->sums + (size_t)row * (size_t)(c->columns + 1);
}

static float pdf(const void *data, sr_vec3 wo, sr_vec3 wi)
{
    const struct klems *k = data;
    const struct chooser *choosers = k->choosers[wo.z < 0], *c = &choosers[wo.z * wi.z < 0];
    if (!c->matrix)
        return 0;
    const float *reflected = row_of(&choosers[0], wo), *passed = row_of(&choosers[1], wo);
    float total = (reflected ? reflected[choosers[0].columns] : 0) + (passed ? passed[choosers[1].columns] : 0);
    if (!(total > 0))
        return 0;
    int in = c->is_reversed ? patch(c->matrix->in, -wo.x, -wo.y, wo.z) : patch(c->matrix->in, -wi.x, -wi.y, wi.z);
    int out = c->is_reversed ? patch(c->matrix->out, wi.x, wi.y, wi.z) : patch(c->matrix->out, wo.x, wo.y, wo.z);
    return mean_value(k, c->matrix, in, out) * fabsf(wi.z) / total;
}

static bool sample(const void *data, sr_vec3 wo, float u_lobe, sr_vec2 u, sr_vec3 *wi)
{
    const struct klems *k = data;
    const struct chooser *choosers = k->choosers[wo.z < 0];
    const float *rows[2] = {row_of(&choosers[0], wo), row_of(&choosers[1], wo)};
    float mass[2] = {rows[0] ? rows[0][choosers[0].columns] : 0, rows[1] ? rows[1][choosers[1].columns] : 0};
    if (!(mass[0] + mass[1] > 0))
        return false;
    int side = u_lobe * (mass[0] + mass[1]) >= mass[0];
    const struct chooser *c = &choosers[side];
    const float *sums = rows[side];
    float target = u.x * mass[side];
    int lo = 0, hi = c->columns;
    while (hi - lo > 1) {
        int middle = (lo + hi) / 2;
        if (sums[middle] <= target)
            lo = middle;
        else
            hi = middle;
    }
    float width = sums[lo + 1] - sums[lo], share = width > 0 ? sr_clamp((target - sums[lo]) / width, 0, 1) : 0.5f;
    const struct xml_basis *b = c->is_reversed ? c->matrix->out : c->matrix->in;
    int ring = ring_of(b, lo);
    float s0 = ring ? sinf(b->upper[ring - 1]) : 0, s1 = sinf(b->upper[ring]);
    float sin2 = s0 * s0 + share * (s1 - s0) * (s1 + s0);
    float phi = 2 * SR_PI * ((float)(lo - b->first[ring]) + u.y - 0.5f) / (float)b->phis[ring];
    sr_vec3 w = sr_spherical_direction(sqrtf(sin2), sr_safe_sqrt(1 - sin2), phi);
    if (!c->is_reversed) { // patches of arriving light lie opposite
        w.x = -w.x;
        w.y = -w.y;
    }
    w.z = (wo.z < 0) != (side == 1) ? -w.z : w.z;
    *wi = w;
    return w.z != 0;
}

static bool chooser_build(struct klems *k, struct chooser *c, struct sr_arena *arena)
{
    const struct xml_basis *over = c->is_reversed ? c->matrix->out : c->matrix->in;
    c->rows = c->is_reversed ? c->matrix->in->total : c->matrix->out->total;
    c->columns = over->total;
    c->sums = sr_arena_alloc(arena, (size_t)c->rows * (size_t)(c->columns + 1) * sizeof(float));
    for (int row = 0; c->sums && row < c->rows; ++row) {
        float *sums = c->sums + (size_t)row * (size_t)(c->columns + 1);
        double sum = 0;
        for (int ring = 0; ring < over->rings; ++ring)
            for (int p = over->first[ring]; p < over->first[ring] + over->phis[ring]; ++p) {
                sum += (double)omega_of(over, ring) *
                       (double)mean_value(k, c->matrix, c->is_reversed ? row : p, c->is_reversed ? p : row);
                sums[p + 1] = (float)sum;
            }
    }
    return c->sums != NULL;
}

static bool choosers_build(struct klems *k, const struct sr_measured *m, struct sr_arena *arena)
{
    for (int face = 0; face < 2; ++face)
        for (int through = 0; through < 2; ++through) {
            struct chooser *c = &k->choosers[face][through];
            const struct matrix *of = &k->matrices[through ? XML_TRANSMISSION_FRONT : XML_REFLECTION_FRONT];
            int from_back = through ? !face : face; // where light for this view comes from
            c->matrix = &of[from_back];
            if (!c->matrix->values && (through || !m->has_back)) {
                c->matrix = &of[!from_back];
                c->is_reversed = through;
            }
            if (!c->matrix->values)
                c->matrix = NULL;
            if (c->matrix && !chooser_build(k, c, arena))
                return false;
        }
    return true;
}

/* SUM over patches of light leaving of B Omega_p, Omega_p = pi (cos^2 theta_1 - cos^2 theta_2) / n */
static sr_spectrum albedo(const void *data, sr_vec3 wi, uint32_t side, sr_spectrum lambda)
{
    const struct klems *k = data;
    bool through = side == SR_MEASURED_TRANSMISSION, reversed = false;
    const struct matrix *matrix = &k->matrices[(through ? XML_TRANSMISSION_FRONT : XML_REFLECTION_FRONT) + (wi.z < 0)];
    if (!matrix->values) {
        matrix = &k->matrices[(through ? XML_TRANSMISSION_FRONT : XML_REFLECTION_FRONT) + (wi.z > 0)];
        reversed = through;
    }
    sr_spectrum sum = SR_BLACK;
    if (!matrix->values)
        return sum;
    const struct xml_basis *over = reversed ? matrix->in : matrix->out;
    int fixed = reversed ? patch(matrix->out, wi.x, wi.y, wi.z) : patch(matrix->in, -wi.x, -wi.y, wi.z);
    for (int ring = 0; ring < over->rings; ++ring) {
        float omega = omega_of(over, ring);
        for (int p = over->first[ring]; p < over->first[ring] + over->phis[ring]; ++p) {
            size_t out = (size_t)(reversed ? fixed : p), in = (size_t)(reversed ? p : fixed);
            struct corners at = {1, {(out * (size_t)matrix->in->total + in) * (size_t)k->channels.count}, {1}};
            sum += channels_eval(&k->channels, matrix->values, &at, lambda) * omega;
        }
    }
    return sum;
}

static const struct xml_basis *basis_of(const struct klems *k, const char *name)
{
    for (int i = 0; i < k->basis_count; ++i)
        if (text_equal(k->bases[i].name, name))
            return &k->bases[i];
    return NULL;
}

/* Numbers of one component into every channels-th place. */
static sr_status read_block(const struct source *s, const struct xml_block *block, bool by_rows, struct matrix *m,
                            int channel, int channels, uint64_t *negative)
{
    struct scan t = scan_start(block->text, block->size);
    t.line = block->line;
    size_t rows = (size_t)m->out->total, columns = (size_t)m->in->total, n = rows * columns;
    for (size_t k = 0; k < n; ++k) {
        double v;
        while (t.at < t.end && (*t.at == ' ' || *t.at == '\t' || *t.at == '\n' || *t.at == '\r' || *t.at == ',')) {
            t.line += *t.at == '\n';
            t.at++;
        }
        if (!scan_number(&t, &v))
            return t.at < t.end ? fail_at(s, t.line, "ScatteringData: a number is expected, not \"%.*s\"",
                                          (int)(t.end - t.at < 12 ? t.end - t.at : 12), t.at)
                                : fail_at(s, t.line, "ScatteringData ends after %zu numbers, %zu x %zu are expected", k,
                                          rows, columns);
        if (!(fabs(v) < 1e15))
            return fail_at(s, t.line, "ScatteringData: a value of %g, a finite one is expected", v);
        *negative += v < 0;
        size_t at = by_rows ? k % rows * columns + k / rows : k;
        m->values[at * (size_t)channels + (size_t)channel] = v > 0 ? (float)v : 0;
    }
    while (t.at < t.end && ((unsigned char)*t.at <= ' ' || *t.at == ','))
        t.at++;
    if (t.at < t.end)
        return fail_at(s, t.line, "ScatteringData goes on after the %zu x %zu numbers that are expected", rows,
                       columns);
    return SR_OK;
}

sr_status read_klems(const struct xml_file *x, struct sr_measured *m)
{
    static const float full[] = {0, 5, 15, 25, 35, 45, 55, 65, 75, 90},
                       half[] = {0, 6.5f, 19.5f, 32.5f, 45.5f, 58.5f, 71.5f, 90}, quarter[] = {0, 9, 27, 45, 63, 90};
    static const int full_phis[] = {1, 8, 16, 20, 24, 24, 24, 16, 12}, half_phis[] = {1, 8, 12, 16, 20, 12, 8},
                     quarter_phis[] = {1, 8, 12, 12, 8};
    const struct source *s = x->source;
    struct klems *k = sr_arena_alloc(s->arena, sizeof *k);
    if (!k)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    for (int i = 0; i < x->basis_count; ++i)
        k->bases[k->basis_count++] = x->bases[i];
    known_basis(&k->bases[k->basis_count++], "LBNL/Klems Full", 9, full, full_phis);
    known_basis(&k->bases[k->basis_count++], "LBNL/Klems Half", 7, half, half_phis);
    known_basis(&k->bases[k->basis_count++], "LBNL/Klems Quarter", 5, quarter, quarter_phis);
    int kind[3], components = xml_components(x, kind);
    if (components == 3 && kind[1] != 1)
        components = 1; // u and v belong to trees
    k->channels =
        (struct channels){.kind = components == 3 ? CHANNEL_RGB : CHANNEL_GREY, .count = components, .stride = 1};
    bool by_rows = text_equal(x->structure, "Rows");
    for (int d = 0; d < 4; ++d) {
        const struct xml_block *first = &x->blocks[d][0];
        if (!first->text)
            continue;
        struct matrix *matrix = &k->matrices[d];
        matrix->in = basis_of(k, by_rows ? first->row : first->column);
        matrix->out = basis_of(k, by_rows ? first->column : first->row);
        if (!matrix->in || !matrix->out)
            return fail_at(
                s, first->line,
                "angle bases \"%s\" and \"%s\": those that the file defines or Klems Full, Half, Quarter are expected",
                first->column, first->row);
        size_t n = (size_t)matrix->in->total * (size_t)matrix->out->total;
        if (first->size <
            2 * n - 1) // each number takes a character and a separator: no memory for what cannot be there
            return fail_at(s, first->line, "ScatteringData has %zu characters, %d x %d numbers are expected",
                           first->size, matrix->out->total, matrix->in->total);
        matrix->values = sr_arena_alloc(s->arena, n * (size_t)components * sizeof(float));
        if (!matrix->values)
            return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
        for (int c = 0; c < components; ++c) {
            sr_status status = read_block(s, &x->blocks[d][kind[c]], by_rows, matrix, c, components, &m->invalid);
            if (status != SR_OK)
                return status;
        }
        if (components == 3)
            for (size_t i = 0; i < n; ++i) {
                struct sr_rgb rgb =
                    rgb_of_xyz(matrix->values[3 * i + 1], matrix->values[3 * i], matrix->values[3 * i + 2]);
                memcpy(matrix->values + 3 * i, (float[3]){rgb.r, rgb.g, rgb.b}, 3 * sizeof(float));
            }
        m->values += n * (size_t)components;
    }
    m->format = SR_MEASURED_KLEMS;
    m->data = k;
    m->f = f;
    m->albedo = albedo;
    m->pdf = pdf;
    m->sample = sample;
    if (!choosers_build(k, m, s->arena))
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    m->channels = k->channels;
    m->is_isotropic = false;
    return SR_OK;
}
