/* SPDX-License-Identifier: MIT */
/* What every BSDF promises, tested on all models with random parameters from their tables.
 *
 * Where f is itself an estimate (is_random), it is compared in the mean, over many seeds; where a sample's density is
 * only proportional, the share of light that the sampler sends somewhere is compared with what f says. */
#include "bsdf/bsdf.h"
#include "test.h"

#define PI 3.14159265358979324
#define LAST (SR_LAMBDA_COUNT - 1)

static float uniform(struct sr_rng *rng)
{
    return sr_rng_float(rng);
}
static sr_vec2 square(struct sr_rng *rng)
{
    float x = uniform(rng);
    return (sr_vec2){x, uniform(rng)};
}
static sr_vec3 sphere(struct sr_rng *rng)
{
    float z = 1 - 2 * uniform(rng), phi = 2 * SR_PI * uniform(rng);
    return sr_spherical_direction(sqrtf(1 - z * z), z, phi);
}
/* directions that a quadrature can look from: not closer to grazing than 75 deg */
static sr_vec3 viewer(struct sr_rng *rng)
{
    sr_vec3 w;
    do
        w = sphere(rng);
    while (fabsf(w.z) < 0.25f);
    return w;
}

/* Lets the model see its parameters, as a material does at each hit. */
static void get_ready(struct sr_bsdf *b, uint32_t seed)
{
    struct sr_bsdf_at at = {.seed = seed};
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        at.lambda[i] = 400 + 300 * (float)i / LAST;
    if (b->model->ready)
        b->model->ready(b->data, &at);
}
/* a new random walk, where f is one */
static void reseed(struct sr_bsdf *b, uint32_t seed)
{
    if (b->model->is_random)
        get_ready(b, seed);
}
/* A model that is nothing without its file has tests of its own. */
static bool needs_files(const struct sr_bsdf_model *m)
{
    bool has_files = false;
    for (const struct sr_param *p = m->params; p->name; ++p)
        has_files |= p->kind == SR_PARAM_FILE;
    if (!has_files || !m->load)
        return has_files;
    struct sr_bsdf b = {.model = m};
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    sr_status status = m->load(b.data, &arena, &error);
    sr_arena_free(&arena);
    return status != SR_OK;
}

static float narrowest = 0.2f; // [1] slope width that is drawn where not sharp

/* Draws parameters. Slopes: sharp with that probability (a mirror or narrower than quadratures resolve), else from
 * the narrowest to 1, and indices not near 1, where refraction is as sharp as a mirror. Walks as long as the table
 * allows, so that f and sample are truncated alike. */
static struct sr_bsdf draw(const struct sr_bsdf_model *model, struct sr_rng *rng, float sharp)
{
    struct sr_bsdf b = {.model = model};
    sr_spectrum spent = SR_BLACK; // what other reflectances have taken
    float kind = uniform(rng), slope[2] = {0, 0};
    for (int i = 0; i < 2; ++i)
        slope[i] = powf(narrowest, uniform(rng));
    for (const struct sr_param *p = model->params; p->name; ++p) {
        void *at = b.data + p->offset;
        float lo = (float)p->min, hi = (float)p->max;
        if (p->kind == SR_PARAM_FLOAT) {
            float v = lo + (hi - lo) * uniform(rng);
            if (strstr(p->name, "alpha")) {
                v = slope[strstr(p->name, "_y") != NULL];
                if (strstr(p->name, "base_"))
                    v = sqrtf(v);
                if (kind < sharp)
                    v = kind < sharp / 2 ? 0 : v * 0.02f;
                else if (strstr(p->name, "coat_") && kind > 0.5f + sharp / 2)
                    v = 0; // half of the coats are smooth
            } else if (strstr(p->text, "square root of the slope"))
                v = kind < sharp ? v : sqrtf(slope[0]);
            else if (strstr(p->name, "gloss"))
                v *= kind < sharp ? 1 : 0.8f;
            else if (strcmp(p->name, "thickness") == 0)
                v = powf(10, -2.5f + 3 * uniform(rng));
            else if (strncmp(p->name, "exponent", 8) == 0)
                v = powf(10, (kind < sharp || narrowest < 0.1f ? 4 : 1.7f) *
                                 uniform(rng)); // else broad enough for quadratures
            else if (strcmp(p->name, "tau") == 0 && kind >= sharp)
                v = sr_min(v, 4); // waves are diffracted by what varies over that many um: narrower lobes else
            if (strcmp(p->name, "eta") == 0 && kind >= sharp && v > 0.67f && v < 1.5f)
                v = v < 1 ? 0.67f : 1.5f;
            v = sr_clamp(v, lo, hi);
            memcpy(at, &v, sizeof v);
        } else if (p->kind == SR_PARAM_INT) {
            int32_t v = strcmp(p->name, "sample_count") == 0 ? 1 : (int32_t)p->max;
            memcpy(at, &v, sizeof v);
        } else if (p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED) {
            sr_spectrum v = SR_BLACK;
            bool medium = strcmp(p->name, "albedo") == 0, black = medium && uniform(rng) < 0.5f;
            for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
                v[i] = black ? 0 : lo + (hi - lo) * uniform(rng);
            if (p->kind == SR_PARAM_ALBEDO && !medium) {
                v *= 1 - spent;
                spent += v;
            }
            memcpy(at, &v, sizeof v);
        } else if (p->kind == SR_PARAM_ENUM) {
            int32_t choices = 1;
            for (const char *c = p->text; *c; ++c)
                choices += *c == '|';
            int32_t v = (int32_t)(uniform(rng) * (float)choices);
            memcpy(at, &v, sizeof v);
        } else if (p->kind == SR_PARAM_BOOL) {
            bool v = uniform(rng) < 0.5f;
            memcpy(at, &v, sizeof v);
        } else if (p->kind != SR_PARAM_FILE) // none
            test_fail(__FILE__, __LINE__, "%s.%s: no rule to draw this kind", model->name, p->name);
    }
    static struct sr_arena tables; // what models compute once lasts as long as the tests
    struct sr_error error = {0};
    if (model->load && model->load(b.data, &tables, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", model->name, error.text);
    get_ready(&b, 1);
    return b;
}

/* is f of these parameters a random estimate? Not where all is smooth but a matte base, and nothing scatters between */
static bool is_random(struct sr_bsdf b)
{
    const struct sr_bsdf_coated *c = (const void *)b.data;
    if (!b.model->is_random)
        return false;
    bool smooth =
        sr_ggx_is_smooth(c->coat_ggx) && (b.model == &sr_bsdf_coated_diffuse || sr_ggx_is_smooth(c->base_ggx));
    return !smooth || !sr_spectrum_is_black(c->albedo);
}

static double luminous(sr_spectrum f) // one number for a spectrum: two wavelengths, so that mixing them up is seen
{
    return (double)f[0] + 2 * (double)f[LAST];
}

#define FOR_EACH_MODEL(m)                                                                                              \
    for (int m##_i = 0; sr_bsdf_models[m##_i]; ++m##_i)                                                                \
        for (const struct sr_bsdf_model *m = sr_bsdf_models[m##_i], *once = m; once; once = NULL)                      \
            if (!needs_files(m))

TEST(bsdf_tables_describe_their_structs)
{
    FOR_EACH_MODEL(m)
    {
        EXPECT(m->size > 0 && m->size <= SR_BSDF_SIZE);
        EXPECT(sr_bsdf_model_find(m->name) == m);
        for (const struct sr_param *p = m->params; p->name; ++p) {
            size_t size = p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED ? sizeof(sr_spectrum)
                          : p->kind == SR_PARAM_BOOL                                  ? sizeof(bool)
                          : p->kind == SR_PARAM_FILE                                  ? sizeof(char *)
                                                                                      : sizeof(float);
            EXPECT(p->offset + size <= m->size);
            EXPECT(p->kind == SR_PARAM_FILE || (p->min < p->max && p->initial >= p->min && p->initial <= p->max));
        }
    }
    EXPECT(!sr_bsdf_model_find("nothing"));
}

/* f(wo, wi) of radiance is f(wi, wo) of importance: light does not care which way we follow it (Veach 1997). */
TEST(bsdf_radiance_and_importance_are_adjoint)
{
    FOR_EACH_MODEL(m)
    {
        struct sr_rng rng = sr_rng_seed(11, 1);
        for (int set = 0; set < 64 && !(m->asymmetry > 0); ++set) {
            struct sr_bsdf b = draw(m, &rng, 0.2f);
            if (!is_random(b)) {
                for (int i = 0; i < 200; ++i) {
                    sr_vec3 wo = sphere(&rng), wi = sphere(&rng);
                    sr_spectrum f = sr_bsdf_f(&b, wo, wi, SR_RADIANCE), g = sr_bsdf_f(&b, wi, wo, SR_IMPORTANCE);
                    for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                        if (fabsf(f[k] - g[k]) > 5e-3f * fmaxf(f[k], g[k]) + 1e-5f)
                            test_fail(__FILE__, __LINE__, "%s: f(wo, wi) = %g but f*(wi, wo) = %g", m->name,
                                      (double)f[k], (double)g[k]);
                }
            } else if (set < 24) {
                sr_vec3 wo = viewer(&rng), wi = viewer(&rng);
                wo.z = copysignf(wo.z, wi.z);
                struct sr_tally t = {0};
                for (uint32_t i = 0; i < 8000; ++i) {
                    reseed(&b, i);
                    sr_tally_add(&t,
                                 luminous(sr_bsdf_f(&b, wo, wi, SR_RADIANCE) - sr_bsdf_f(&b, wi, wo, SR_IMPORTANCE)));
                }
                if (!(fabs(t.mean) <= 4.9 * sr_tally_standard_error(&t) + 1e-9))
                    test_fail(__FILE__, __LINE__, "%s, set %d: f(wo, wi) - f*(wi, wo) = %g +- %g", m->name, set, t.mean,
                              sr_tally_standard_error(&t));
            }
        }
    }
}

/* No surface returns more light than arrives: E = mean of f |cos| / pdf <= 1 at each wavelength. */
TEST(bsdf_does_not_make_light)
{
    FOR_EACH_MODEL(m)
    {
        struct sr_rng rng = sr_rng_seed(12, 1);
        for (int set = 0; set < 64; ++set) {
            struct sr_bsdf b = draw(m, &rng, 0.3f);
            sr_vec3 wo = sphere(&rng);
            struct sr_tally E[SR_LAMBDA_COUNT] = {0};
            sr_spectrum known = SR_BLACK + NAN;
            if (m->albedo)
                known = m->albedo(b.data, wo);
            for (uint32_t i = 0; i < 2000; ++i) {
                struct sr_bsdf_sample s;
                reseed(&b, i);
                float u = uniform(&rng);
                sr_spectrum weight = SR_BLACK;
                if (sr_bsdf_sample(&b, wo, u, square(&rng), SR_IMPORTANCE, &s))
                    weight = s.f * fabsf(s.wi.z) / s.pdf;
                for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                    sr_tally_add(&E[k], (double)weight[k]);
            }
            for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
                if (!(E[k].mean <= (double)sr_max(1, m->largest_albedo) + 1e-5 + 4.9 * sr_tally_standard_error(&E[k])))
                    test_fail(__FILE__, __LINE__, "%s, set %d: E = %g +- %g", m->name, set, E[k].mean,
                              sr_tally_standard_error(&E[k]));
                double error = 1e-5 + 4.9 * sr_tally_standard_error(&E[k]);
                if (isfinite(known[k]) && !(fabs(E[k].mean - (double)known[k]) <= error))
                    test_fail(__FILE__, __LINE__, "%s, set %d: E = %g, but its closed form says %g", m->name, set,
                              E[k].mean, (double)known[k]);
            }
        }
    }
}

/* Cells of the sphere that are the smaller the more samples fall there, so that a lobe is seen however narrow it is: a
 * tree of rectangles of s = 1 - cos theta and phi, which are even in solid angle. */
enum { CELLS = 40000, SEEDS = 20000, FULL = 50, LEAST_DEPTH = 3, MOST_DEPTH = 26 };
struct cell {
    double s, phi, ds, dphi; // begin and extent
    int children, seeds;     // children: index of the first of four, 0: a leaf
};
static struct cell cells[CELLS];
static int cell_count;

static void split_cell(int i)
{
    cells[i].children = cell_count;
    double ds = cells[i].ds / 2, dphi = cells[i].dphi / 2;
    for (int k = 0; k < 4; ++k)
        cells[cell_count++] = (struct cell){cells[i].s + (k & 1) * ds, cells[i].phi + (k >> 1) * dphi, ds, dphi, 0, 0};
}
static int cell_of(sr_vec3 w, int *depth)
{
    double r2 = (double)w.x * (double)w.x + (double)w.y * (double)w.y;
    double s = w.z > 0 ? r2 / (1 + (double)w.z) : 2 - r2 / (1 - (double)w.z);
    double phi = atan2((double)w.y, (double)w.x);
    phi += phi < 0 ? 2 * PI : 0;
    int i = 0;
    for (*depth = 0; cells[i].children; ++*depth)
        i = cells[i].children + (s >= cells[i].s + cells[i].ds / 2) + 2 * (phi >= cells[i].phi + cells[i].dphi / 2);
    return i;
}
static void make_cells(const struct sr_bsdf *b, sr_vec3 wo, struct sr_rng *rng)
{
    cell_count = 1;
    cells[0] = (struct cell){0, 0, 2, 2 * PI, 0, 0};
    for (int i = 0, depth = 0; depth < LEAST_DEPTH; ++depth)
        for (int end = cell_count; i < end; ++i)
            split_cell(i);
    for (int n = 0; n < SEEDS; ++n) {
        struct sr_bsdf_sample s;
        int depth;
        float u = uniform(rng);
        if (!sr_bsdf_sample(b, wo, u, square(rng), SR_RADIANCE, &s) || (s.lobe & SR_LOBE_SPECULAR))
            continue;
        int i = cell_of(s.wi, &depth);
        if (++cells[i].seeds > FULL && depth < MOST_DEPTH && cell_count + 4 <= CELLS)
            split_cell(i);
    }
}

/* INTEGRAL pdf over a rectangle: Gauss's 4 by 4 points, and where four quarters say something else, these. */
static double gauss_of(const struct sr_bsdf *b, sr_vec3 wo, double s0, double phi0, double ds, double dphi)
{
    static const double x[4] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263},
                        w[4] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};
    double sum = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            double s = s0 + x[i] * ds, r = sqrt(s * (2 - s)), phi = phi0 + x[j] * dphi;
            sr_vec3 wi = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)(1 - s)};
            sum += w[i] * w[j] * (double)sr_bsdf_pdf(b, wo, wi, SR_RADIANCE);
        }
    return sum * ds * dphi;
}
static double probability_of(const struct sr_bsdf *b, sr_vec3 wo, double s, double phi, double ds, double dphi,
                             double whole, int depth, int least_depth)
{
    double quarter[4], sum = 0;
    ds /= 2;
    dphi /= 2;
    for (int k = 0; k < 4; ++k)
        sum += quarter[k] = gauss_of(b, wo, s + (k & 1) * ds, phi + (k >> 1) * dphi, ds, dphi);
    if (depth == 7 || (depth >= least_depth && fabs(sum - whole) < 1e-6 + 2e-3 * sum))
        return sum;
    sum = 0;
    for (int k = 0; k < 4; ++k)
        sum += probability_of(b, wo, s + (k & 1) * ds, phi + (k >> 1) * dphi, ds, dphi, quarter[k], depth + 1,
                              least_depth);
    return sum;
}

/* Samples fall as the density says (Pearson's chi-square); the rest are mirrored or absorbed. Half of the lobes are as
 * narrow as alpha = 0.01. */
TEST(bsdf_sampler_follows_its_pdf)
{
    FOR_EACH_MODEL(m)
    {
        struct sr_rng rng = sr_rng_seed(13, 1);
        int tested = 0;
        for (int set = 0; set < 32 && tested < 16; ++set) {
            narrowest = set & 1 ? 0.01f : 0.2f;
            struct sr_bsdf b = draw(m, &rng, 0);
            narrowest = 0.2f;
            sr_vec3 wo = viewer(&rng);
            const int n = 100000;
            static double expected[CELLS + 1], observed[CELLS + 1];
            if (is_random(b))
                continue; // its pdf serves for weighing only
            make_cells(&b, wo, &rng);
            double total = 0;
            for (int i = 0; i < cell_count; ++i) {
                const struct cell *c = &cells[i];
                observed[i] = expected[i] = 0;
                if (c->children)
                    continue;
                double whole = gauss_of(&b, wo, c->s, c->phi, c->ds, c->dphi);
                int least = whole * SEEDS < 0.5 * c->seeds ? 4 : 0; // more is there than these points see
                total += expected[i] = probability_of(&b, wo, c->s, c->phi, c->ds, c->dphi, whole, 0, least);
            }
            if (!(total <= 1 + 5e-4))
                test_fail(__FILE__, __LINE__, "%s, set %d: the pdf integrates to %g", m->name, set, total);
            ++tested;
            observed[cell_count] = 0; // elsewhere
            for (int i = 0; i < n; ++i) {
                struct sr_bsdf_sample s;
                int depth;
                float u = uniform(&rng);
                bool drawn = sr_bsdf_sample(&b, wo, u, square(&rng), SR_RADIANCE, &s);
                EXPECT(!drawn || !s.pdf_is_proportional);
                observed[drawn && !(s.lobe & SR_LOBE_SPECULAR) ? cell_of(s.wi, &depth) : cell_count] += 1;
            }
            for (int i = 0; i < cell_count; ++i)
                if (!cells[i].children)
                    expected[i] = n * expected[i] + 1e-4; // a sliver of a cell may have escaped all points
            double elsewhere = n * (1 - total);
            expected[cell_count] = elsewhere > 1e-2 * sqrt(n) ? elsewhere : 1e-9 * n;
            if (elsewhere <= 1e-2 * sqrt(n) && observed[cell_count] == 0)
                expected[cell_count] = 0;
            double chi2, p;
            int degrees;
            p = sr_chi2_test(observed, expected, (size_t)cell_count + 1, 5, &chi2, &degrees);
            if (!(p > 1e-6))
                test_fail(__FILE__, __LINE__, "%s, set %d: chi2 = %g of %d degrees, p = %g; %g of %g elsewhere",
                          m->name, set, chi2, degrees, p, observed[cell_count], elsewhere);
        }
    }
}

/* Drawn light is the light that f describes: mean of f |cos| g / pdf over samples = INTEGRAL f |cos| g dwi, for three
 * functions g of wi (1, wi.x, wi.z), the integral by directions that do not know the BSDF. Delta lobes left out. */
TEST(bsdf_sampler_sends_light_where_f_says)
{
    FOR_EACH_MODEL(m)
    {
        struct sr_rng rng = sr_rng_seed(14, 1);
        for (int set = 0; set < 24; ++set) {
            struct sr_bsdf b = draw(m, &rng, 0);
            sr_vec3 wo = viewer(&rng);
            const uint32_t n = 20000;
            struct sr_tally drawn[3] = {0}, described[3] = {0};
            for (uint32_t i = 0; i < n; ++i) {
                reseed(&b, i);
                struct sr_bsdf_sample s;
                float u = uniform(&rng);
                double w = 0, g[3] = {1, 0, 0};
                if (sr_bsdf_sample(&b, wo, u, square(&rng), SR_IMPORTANCE, &s) && !(s.lobe & SR_LOBE_SPECULAR)) {
                    w = luminous(s.f) * (double)(fabsf(s.wi.z) / s.pdf);
                    g[1] = (double)s.wi.x;
                    g[2] = (double)s.wi.z;
                }
                // uniform in cos^2 on either side, with density |cos| / (2 pi)
                sr_vec3 wi = sr_warp_cosine_hemisphere(square(&rng));
                if (i & 1)
                    wi = sr_neg(wi);
                double v = 2 * PI * luminous(sr_bsdf_f(&b, wo, wi, SR_IMPORTANCE)),
                       h[3] = {1, (double)wi.x, (double)wi.z};
                for (int k = 0; k < 3; ++k) {
                    sr_tally_add(&drawn[k], w * g[k]);
                    sr_tally_add(&described[k], v * h[k]);
                }
            }
            for (int k = 0; k < 3; ++k) {
                double error = hypot(sr_tally_standard_error(&drawn[k]), sr_tally_standard_error(&described[k]));
                if (!(fabs(drawn[k].mean - described[k].mean) <= 4.9 * error + 1e-5))
                    test_fail(__FILE__, __LINE__, "%s, set %d, moment %d: drawn %g, described %g, z = %.1f", m->name,
                              set, k, drawn[k].mean, described[k].mean, (drawn[k].mean - described[k].mean) / error);
            }
        }
    }
}

/* f_pdf gives the bits of f and of pdf; both are pure functions; a sample tells the f and pdf of its direction. */
TEST(bsdf_functions_agree_with_each_other)
{
    FOR_EACH_MODEL(m)
    {
        struct sr_rng rng = sr_rng_seed(15, 1);
        for (int set = 0; set < 64; ++set) {
            struct sr_bsdf b = draw(m, &rng, 0.3f);
            bool sharp = false;
            for (const struct sr_param *p = m->params; p->name; ++p)
                sharp |= strstr(p->name, "alpha") && *(const float *)(const void *)(b.data + p->offset) < 0.05f;
            for (int i = 0; i < 100; ++i) {
                enum sr_transport mode = i & 1 ? SR_RADIANCE : SR_IMPORTANCE;
                sr_vec3 wo = sphere(&rng), wi = sphere(&rng);
                float pdf;
                sr_spectrum both = sr_bsdf_f_pdf(&b, wo, wi, mode, &pdf), f = sr_bsdf_f(&b, wo, wi, mode);
                EXPECT(memcmp(&both, &f, sizeof f) == 0);
                EXPECT(pdf == sr_bsdf_pdf(&b, wo, wi, mode));
                EXPECT(pdf > 0 || sr_spectrum_is_black(f)); // what f shows can be weighed

                struct sr_bsdf_sample s;
                float u = uniform(&rng);
                if (!sr_bsdf_sample(&b, wo, u, square(&rng), mode, &s))
                    continue;
                EXPECT_NEAR(sr_length2(s.wi), 1, 1e-5);
                EXPECT((s.lobe & ~sr_bsdf_lobes(&b)) == 0);
                EXPECT(!!(s.lobe & SR_LOBE_TRANSMISSION) == !sr_same_hemisphere(wo, s.wi));
                EXPECT(s.pdf > 0 && s.pdf < INFINITY && sr_spectrum_is_finite(s.f));
                if ((s.lobe & SR_LOBE_SPECULAR) || s.pdf_is_proportional || sharp || fabsf(s.wi.z) < 1e-2f ||
                    fabsf(wo.z) < 1e-2f)
                    continue;
                f = sr_bsdf_f_pdf(&b, wo, s.wi, mode, &pdf);
                EXPECT_RELATIVE(pdf, s.pdf, 5e-3);
                for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                    EXPECT_NEAR(f[k], s.f[k], 5e-3f * s.f[k] + 1e-7f);
            }
        }
    }
}

/* Grazing, opposite, identical and vertical directions, mirrors, and hair-thin lobes: numbers stay numbers. */
TEST(bsdf_stays_finite_where_directions_degenerate)
{
    const float tiny[] = {0, 1e-20f, 1e-8f, 1e-4f, 0.3f, 1};
    FOR_EACH_MODEL(m)
    {
        struct sr_rng rng = sr_rng_seed(16, 1);
        for (int set = 0; set < 64; ++set) {
            struct sr_bsdf b = draw(m, &rng, 0.5f);
            for (const struct sr_param *p = m->params; p->name; ++p) // spans of the table, too
                if (p->kind == SR_PARAM_FLOAT && set % 8 < 2) {
                    float v = (float)(set % 8 == 0 ? p->min : p->max);
                    memcpy(b.data + p->offset, &v, sizeof v);
                }
            get_ready(&b, 1);
            sr_vec3 w[14];
            for (int i = 0; i < 6; ++i) {
                w[2 * i] = (sr_vec3){sqrtf(1 - tiny[i] * tiny[i]), 0, tiny[i]};
                w[2 * i + 1] = (sr_vec3){0.6f * w[2 * i].x, -0.8f * w[2 * i].x, -tiny[i]};
            }
            w[12] = (sr_vec3){0, 0, 1};
            w[13] = (sr_vec3){-0.6f, 0, -0.8f};
            for (int i = 0; i < 14; ++i)
                for (int j = 0; j < 28; ++j) {
                    sr_vec3 wi = j < 14    ? w[j]
                                 : j == 14 ? sr_neg(w[i])
                                           : (sr_vec3){-w[j - 14].x, w[j - 14].y, w[j - 14].z};
                    float pdf;
                    sr_spectrum f = sr_bsdf_f_pdf(&b, w[i], wi, SR_RADIANCE, &pdf);
                    struct sr_bsdf_sample s;
                    float u = j == 0 ? 0 : j == 1 ? SR_ONE_MINUS_EPSILON : uniform(&rng);
                    sr_vec2 v = j < 2    ? (sr_vec2){u, u}
                                : j == 2 ? (sr_vec2){0, SR_ONE_MINUS_EPSILON}
                                : j == 3 ? (sr_vec2){SR_ONE_MINUS_EPSILON, 0}
                                         : square(&rng);
                    bool ok = pdf >= 0 && pdf < INFINITY;
                    for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                        ok &= f[k] >= 0 && f[k] < INFINITY;
                    if (!ok)
                        test_fail(__FILE__, __LINE__, "%s, set %d: wo %g %g %g wi %g %g %g: f %g pdf %g", m->name, set,
                                  (double)w[i].x, (double)w[i].y, (double)w[i].z, (double)wi.x, (double)wi.y,
                                  (double)wi.z, (double)f[0], (double)pdf);
                    if (sr_bsdf_sample(&b, w[i], u, v, SR_RADIANCE, &s)) {
                        ok = s.pdf > 0 && s.pdf < INFINITY && sr_is_finite(s.wi);
                        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
                            ok &= s.f[k] >= 0 && s.f[k] < INFINITY;
                        if (!ok)
                            test_fail(__FILE__, __LINE__, "%s, set %d: sample at wo.z %g: f %g pdf %g", m->name, set,
                                      (double)w[i].z, (double)s.f[0], (double)s.pdf);
                    }
                }
        }
    }
}
