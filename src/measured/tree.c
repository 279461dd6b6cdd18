/* SPDX-License-Identifier: MIT */
/* Tensor trees: the BSDF over squares that stand for hemispheres, divided where it varies.
 *
 *     rank 4: (a, b) of -s_i, (c, d) of s_o, with s = (x, y) of a direction,
 *             mapped from the disk to the unit square by Shirley & Chiu's concentric map, which keeps areas:
 *             a cell's projected solid angle is pi times its area
 *     rank 3: 1/2 - |s_i| / 2, then (c, d) of s_o turned so that -s_i lies along +x (isotropic)
 *
 * { … } holds 2^n nodes (bit i of a node's place is the half of coordinate i), or 2^(n k) values, the last coordinate
 * fastest; constant over each cell. G. Ward, Radiance's bsdf_t; values in 1/sr. CIE-u and -v beside Visible give
 * colour. */
#include "measured/private.h"

enum { MAX_DEPTH = 24 };

/* a node is a header, then its children's places or its values */
union word {
    uint32_t link;
    float value;
};

struct tree {
    union word *words; // node: [0] = 0 branch, 2^n links follow; [0] = 1 + k, 2^(n k) values follow
};

struct tensor_tree {
    int rank;
    struct tree trees[4][3]; // enum xml_direction; Y, and u, v or X, Z
    struct channels channels;
    bool is_xyz;
};

struct growing {
    const struct source *source;
    struct scan t;
    struct sr_array words;
    int rank;
    uint64_t values;
};

static void skip(struct scan *t)
{
    while (t->at < t->end && (*t->at == ' ' || *t->at == '\t' || *t->at == '\n' || *t->at == '\r' || *t->at == ',')) {
        t->line += *t->at == '\n';
        t->at++;
    }
}

static bool push(struct growing *g, union word w)
{
    union word *at = g->words.count < UINT32_MAX ? sr_array_push(&g->words, sizeof w) : NULL;
    if (!at) {
        sr_fail(g->source->error, SR_ERROR_RESOURCE, "%s: not enough memory for its trees", g->source->name);
        return false;
    }
    *at = w;
    return true;
}

static bool node(struct growing *g, int depth)
{
    struct scan *t = &g->t;
    skip(t);
    if (t->at >= t->end || *t->at != '{') {
        fail_at(g->source, t->line, "a tensor tree: '{' is expected");
        return false;
    }
    t->at++;
    skip(t);
    if (depth > MAX_DEPTH) {
        fail_at(g->source, t->line, "a tensor tree of more than %d levels", MAX_DEPTH);
        return false;
    }
    size_t head = g->words.count;
    if (!push(g, (union word){.link = 0}))
        return false;
    if (t->at < t->end && *t->at == '{') {
        for (int i = 0; i < 1 << g->rank; ++i)
            if (!push(g, (union word){.link = 0}))
                return false;
        for (int i = 0; i < 1 << g->rank; ++i) {
            ((union word *)g->words.data)[head + 1 + (size_t)i].link = (uint32_t)g->words.count;
            if (!node(g, depth + 1))
                return false;
        }
    } else {
        size_t count = 0;
        for (double v; skip(t), scan_number(t, &v); ++count) {
            if (!(fabs(v) < 1e15)) {
                fail_at(g->source, t->line, "a tensor tree: a value of %g, a finite one is expected", v);
                return false;
            }
            if (!push(g, (union word){.value = v > 0 ? (float)v : 0}))
                return false;
        }
        uint32_t k = 0;
        while (k * (uint32_t)g->rank < 31 && (size_t)1 << (k * (uint32_t)g->rank) < count)
            ++k;
        if (count == 0 || (size_t)1 << (k * (uint32_t)g->rank) != count) {
            fail_at(g->source, t->line, "a tensor tree: %zu values in a cell, a power of %d is expected", count,
                    1 << g->rank);
            return false;
        }
        ((union word *)g->words.data)[head].link = 1 + k;
        g->values += count;
    }
    skip(t);
    if (t->at >= t->end || *t->at != '}') {
        fail_at(g->source, t->line, "a tensor tree: '}' is expected");
        return false;
    }
    t->at++;
    return true;
}

static sr_status read_block(const struct source *s, const struct xml_block *block, int rank, struct tree *tree,
                            uint64_t *values)
{
    struct growing g = {.source = s, .t = scan_start(block->text, block->size), .rank = rank};
    g.t.line = block->line;
    bool ok = node(&g, 0);
    skip(&g.t);
    if (ok && g.t.at < g.t.end) {
        fail_at(s, g.t.line, "ScatteringData goes on after the end of the tree");
        ok = false;
    }
    if (ok) {
        tree->words = sr_arena_copy(s->arena, g.words.data, g.words.count * sizeof(union word));
        if (!tree->words)
            sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
        ok = tree->words != NULL;
        *values += g.values;
    }
    sr_array_free(&g.words);
    return ok ? SR_OK : s->error->status;
}

static float look_up(const struct tree *tree, int rank, const float position[4])
{
    float x[4];
    memcpy(x, position, sizeof x);
    const union word *w = tree->words;
    while (w->link == 0) {
        int child = 0;
        for (int i = 0; i < rank; ++i) {
            x[i] *= 2;
            if (x[i] >= 1) {
                child |= 1 << i;
                x[i] -= 1;
            }
        }
        w = tree->words + w[1 + child].link;
    }
    int bits = (int)w->link - 1;
    size_t at = 0;
    for (int i = 0; i < rank; ++i)
        at = at << bits | (size_t)(x[i] * (float)(1 << bits));
    return w[1 + at].value;
}

/* Shirley & Chiu 1997, from the disk to the square */
static void disk_to_square(float x, float y, float square[2])
{
    float r = sqrtf(x * x + y * y), a = 0, b = 0;
    if (r > 0) {
        float phi = atan2f(y, x);
        phi = phi < -SR_PI / 4 ? phi + 2 * SR_PI : phi; // -pi/4 … 7 pi/4
        int quarter = (int)((phi + SR_PI / 4) / (SR_PI / 2));
        quarter = quarter < 3 ? quarter : 3; // a whole turn by rounding
        float across = r * (phi - (float)quarter * (SR_PI / 2)) * (4 / SR_PI);
        a = quarter == 0 ? r : quarter == 1 ? -across : quarter == 2 ? -r : across;
        b = quarter == 0 ? across : quarter == 1 ? r : quarter == 2 ? -across : -r;
    }
    square[0] = sr_clamp(0.5f * a + 0.5f, 0, SR_ONE_MINUS_EPSILON);
    square[1] = sr_clamp(0.5f * b + 0.5f, 0, SR_ONE_MINUS_EPSILON);
}

static sr_spectrum f(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct tensor_tree *t = data;
    bool through = wo.z * wi.z < 0;
    const struct tree *trees = t->trees[(through ? XML_TRANSMISSION_FRONT : XML_REFLECTION_FRONT) + (wi.z < 0)];
    if (!trees->words && through) { // the same both ways, by reciprocity
        sr_vec3 w = wo;
        wo = wi;
        wi = w;
        trees = t->trees[XML_TRANSMISSION_FRONT + (wi.z < 0)];
    }
    if (!trees->words && !through)
        trees = t->trees[XML_REFLECTION_FRONT + (wi.z > 0)];
    if (!trees->words)
        return SR_BLACK;
    float position[4] = {0};
    if (t->rank == 3) {
        float r = sqrtf(wi.x * wi.x + wi.y * wi.y), c = r > 0 ? -wi.x / r : 1, s = r > 0 ? -wi.y / r : 0;
        position[0] = sr_clamp(0.5f - 0.5f * r, 0, 0.5f - 1e-6f);
        disk_to_square(wo.x * c + wo.y * s, wo.y * c - wo.x * s, position + 1);
    } else {
        disk_to_square(-wi.x, -wi.y, position);
        disk_to_square(wo.x, wo.y, position + 2);
    }
    float Y = look_up(&trees[0], t->rank, position);
    if (t->channels.kind == CHANNEL_GREY || !(Y > 0))
        return SR_BLACK + Y;
    float p = look_up(&trees[1], t->rank, position), q = look_up(&trees[2], t->rank, position);
    float X = t->is_xyz ? p
              : q > 0   ? 9 * p / (4 * q) * Y
                        : Y,
          Z = t->is_xyz ? q
              : q > 0   ? (12 - 3 * p - 20 * q) / (4 * q) * Y
                        : Y;
    struct sr_rgb rgb = rgb_of_xyz(X, Y, sr_max(Z, 0));
    return uplift_at(rgb.r, rgb.g, rgb.b, lambda);
}

/* Mean over the square of light leaving, times pi: exact for trees of up to 6 levels. */
static sr_spectrum albedo(const void *data, sr_vec3 wi, uint32_t side, sr_spectrum lambda)
{
    enum { N = 64 };
    sr_spectrum sum = SR_BLACK;
    float r = sqrtf(wi.x * wi.x + wi.y * wi.y);
    bool is_turned = ((const struct tensor_tree *)data)->rank == 3 && r > 0;
    float c = is_turned ? -wi.x / r : 1, s = is_turned ? -wi.y / r : 0;
    for (int i = 0; i < N * N; ++i) {
        sr_vec3 w = sr_warp_cosine_hemisphere((sr_vec2){((float)(i % N) + 0.5f) / N, ((float)(i / N) + 0.5f) / N});
        sr_vec3 wo = {w.x * c - w.y * s, w.x * s + w.y * c,
                      (wi.z < 0) != (side == SR_MEASURED_TRANSMISSION) ? -w.z : w.z};
        sum += f(data, wo, wi, lambda);
    }
    return sum * (SR_PI / (N * N));
}

sr_status read_tree(const struct xml_file *x, int rank, struct sr_measured *m)
{
    const struct source *s = x->source;
    struct tensor_tree *t = sr_arena_alloc(s->arena, sizeof *t);
    if (!t)
        return sr_fail(s->error, SR_ERROR_RESOURCE, "%s: not enough memory", s->name);
    int kind[3], components = xml_components(x, kind);
    t->rank = rank;
    t->is_xyz = kind[1] == 1;
    t->channels =
        (struct channels){.kind = components == 3 ? CHANNEL_RGB : CHANNEL_GREY, .count = components, .stride = 1};
    for (int d = 0; d < 4; ++d)
        for (int c = 0; c < components && x->blocks[d][0].text; ++c) {
            const struct xml_block *block = &x->blocks[d][kind[c]];
            if (block->basis[0] && !text_equal(block->basis, "LBNL/Shirley-Chiu"))
                return fail_at(s, block->line, "AngleBasis is \"%s\", LBNL/Shirley-Chiu is expected for a tensor tree",
                               block->basis);
            sr_status status = read_block(s, block, rank, &t->trees[d][c], &m->values);
            if (status != SR_OK)
                return status;
        }
    m->format = SR_MEASURED_TREE;
    m->data = t;
    m->f = f;
    m->albedo = albedo;
    m->channels = t->channels;
    m->is_isotropic = rank == 3;
    return SR_OK;
}
