/* SPDX-License-Identifier: MIT */
/* A certificate is worth what it refuses: models that are wrong by design, each in one way, and the check that must say
 * so.
 *
 * Each is a good model whose functions are replaced by wrong ones. The good ones must pass, by the same options. */
#include "lab/lab.h"
#include "test.h"

enum { SETS = SR_LAMBDA_COUNT < 8 ? 16 : 8 }; // each wavelength tries spectra of its own
static const struct sr_certificate_options options = {.sets = SETS, .samples = 16384, .seed = 5, .significance = 1e-6};

static const struct sr_check *find(const struct sr_certificate *c, const char *name)
{
    for (int i = 0; i < c->count; ++i)
        if (strcmp(c->checks[i].name, name) == 0)
            return &c->checks[i];
    test_fail(__FILE__, __LINE__, "there is no check \"%s\"", name);
}

/* The certificate fails, by this check, with this in its words. */
static void expect_failure_of(const struct sr_bsdf_model *m, const struct sr_certificate_options *o, const char *check,
                              const char *words)
{
    struct sr_certificate c;
    struct sr_error error = {0};
    EXPECT(sr_certify_model(m, o, &c, &error) == SR_OK);
    const struct sr_check *k = find(&c, check);
    if (c.passed || k->verdict != SR_FAILED)
        test_fail(__FILE__, __LINE__, "%s: %s was not refused: measured %g, limit %g: %s", m->name, check, k->measured,
                  k->limit, k->text);
    if (!strstr(k->text, words))
        test_fail(__FILE__, __LINE__, "%s: %s says \"%s\", not \"%s\"", m->name, check, k->text, words);
}

static void expect_failure(const struct sr_bsdf_model *m, const char *check, const char *words)
{
    expect_failure_of(m, &options, check, words);
}

static void expect_pass(const struct sr_bsdf_model *m, const struct sr_certificate_options *o)
{
    struct sr_certificate c;
    struct sr_error error = {0};
    if (sr_certify_model(m, o, &c, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", m->name, error.text);
    for (int i = 0; i < c.count; ++i)
        if (c.checks[i].verdict == SR_FAILED)
            test_fail(__FILE__, __LINE__, "%s: %s: measured %g, limit %g: %s", m->name, c.checks[i].name,
                      c.checks[i].measured, c.checks[i].limit, c.checks[i].text);
    EXPECT(c.passed);
}

/* ---- Lambert's model, broken ---- */

/* What stands in a broken model's functions: all but what is replaced is of the good one. */
static sr_spectrum good_f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return sr_bsdf_diffuse.f(self, wo, wi, mode);
}

static float pdf_without_cosine(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)self, (void)mode;
    return sr_same_hemisphere(wo, wi) ? SR_INV_PI : 0;
}

TEST(broken_the_pdf_forgets_the_cosine)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.pdf = pdf_without_cosine;
    expect_failure(&m, "normalisation", "INTEGRAL pdf = 2");
    expect_failure(&m, "sampling", "chi2");
    expect_failure(&m, "sample", "a sample's pdf");
}

static float pdf_of_swapped(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return sr_bsdf_diffuse.pdf(self, wi, wo, mode); // the cosine of the wrong direction
}
static bool sample_by_swapped_pdf(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                  struct sr_bsdf_sample *s)
{
    bool drawn = sr_bsdf_diffuse.sample(self, wo, u_lobe, u, mode, s);
    if (drawn)
        s->pdf = pdf_of_swapped(self, wo, s->wi, mode);
    return drawn && s->pdf > 0;
}

TEST(broken_wi_and_wo_are_swapped_in_the_pdf_and_the_sampler)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.pdf = pdf_of_swapped;
    m.sample = sample_by_swapped_pdf; // both agree with each other: only statistics see it
    expect_failure(&m, "sampling", "chi2");
    expect_failure(&m, "light", "drawn");
}

static bool sample_that_loses(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                              struct sr_bsdf_sample *s)
{
    return u.x > 0.002f && sr_bsdf_diffuse.sample(self, wo, u_lobe, u, mode, s);
}

TEST(broken_the_sampler_loses_two_in_a_thousand)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.sample = sample_that_loses;
    expect_failure(&m, "lost samples", "lost");
}

static sr_spectrum f_of_one_percent_more(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return good_f(self, wo, wi, mode) * 1.01f;
}
static bool sample_of_one_percent_more(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                       struct sr_bsdf_sample *s)
{
    bool drawn = sr_bsdf_diffuse.sample(self, wo, u_lobe, u, mode, s);
    s->f *= 1.01f;
    return drawn;
}

TEST(broken_energy_is_gained_by_one_percent)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.f = f_of_one_percent_more;
    m.sample = sample_of_one_percent_more;
    expect_failure(&m, "energy", "E = 1.0"); // reflectance 0.998 at most
    expect_failure(&m, "range ends", "albedo 1.01");
    expect_failure(&m, "albedo", "closed form"); // what the model says of itself is wrong, too
}

TEST(broken_a_sample_tells_another_f)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.sample = sample_of_one_percent_more;
    expect_failure(&m, "sample", "a sample's f");
}

static sr_spectrum f_of_one_way(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return good_f(self, wo, wi, mode) * (1 - 0.01f * fabsf(wo.z));
}
static bool sample_of_one_way(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                              struct sr_bsdf_sample *s)
{
    bool drawn = sr_bsdf_diffuse.sample(self, wo, u_lobe, u, mode, s);
    if (drawn)
        s->f = f_of_one_way(self, wo, s->wi, mode);
    return drawn;
}

TEST(broken_not_reciprocal_by_one_percent)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.f = f_of_one_way;
    m.sample = sample_of_one_way;
    m.albedo = NULL;
    expect_failure(&m, "reciprocity", "reversed");
    m.asymmetry = 0.005f; // documented, but less than it is
    expect_failure(&m, "reciprocity", "reversed");
    m.asymmetry = 0.011f;
    struct sr_certificate c;
    struct sr_error error = {0};
    EXPECT(sr_certify_model(&m, &options, &c, &error) == SR_OK);
    EXPECT_EQUAL_INT(find(&c, "reciprocity")->verdict, SR_DOCUMENTED);
    EXPECT_NEAR(find(&c, "reciprocity")->measured, 0.01, 0.002);
    EXPECT(find(&c, "reciprocity")->limit > 0.0109);
}

static sr_spectrum f_below_nought(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return good_f(self, wo, wi, mode) * (wo.z * wi.z < 0.01f ? -1.0f : 1.0f);
}

TEST(broken_f_is_negative_at_grazing)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.f = f_below_nought;
    expect_failure(&m, "non-negative", "f = -");
}

static sr_spectrum f_not_a_number(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float tan2 = (1 - wo.z * wo.z) / (wo.z * wo.z); // infinite at the horizon, and 0 times infinity is none
    return good_f(self, wo, wi, mode) * (1 + 0 * tan2);
}

TEST(broken_f_is_no_number_at_grazing)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.f = f_not_a_number;
    // the horizon itself must be black; a diffuse surface is, so that only f within is multiplied
    expect_failure(&m, "finite", "f = ");
}

static sr_spectrum f_pdf_of_another(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode, float *pdf)
{
    *pdf = sr_bsdf_diffuse.pdf(self, wo, wi, mode);
    return good_f(self, wo, wi, mode) * 1.001f;
}

TEST(broken_f_pdf_is_not_f_and_pdf)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.f_pdf = f_pdf_of_another;
    expect_failure(&m, "f_pdf", "but f_pdf");
}

static bool sample_of_wrong_lobe(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                 struct sr_bsdf_sample *s)
{
    bool drawn = sr_bsdf_diffuse.sample(self, wo, u_lobe, u, mode, s);
    s->lobe = SR_LOBE_TRANSMISSION | SR_LOBE_DIFFUSE;
    return drawn;
}
static uint32_t lobes_of_both(const void *self)
{
    return sr_bsdf_diffuse.lobes(self) ? SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION | SR_LOBE_DIFFUSE : 0;
}

TEST(broken_a_lobe_is_called_what_it_is_not)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.sample = sample_of_wrong_lobe;
    expect_failure(&m, "lobes", "lobes() does not tell");
    m.lobes = lobes_of_both;
    expect_failure(&m, "lobes", "same side is called a transmission");
}

static bool sample_of_half(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                           struct sr_bsdf_sample *s)
{
    u.x *= 0.5f; // sees a part of the disk only
    bool drawn = sr_bsdf_diffuse.sample(self, wo, u_lobe, u, mode, s);
    s->pdf *= 2;
    return drawn;
}
static float pdf_of_half(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return wi.x < 0 ? 2 * sr_bsdf_diffuse.pdf(self, wo, wi, mode) : 0;
}

TEST(broken_the_sampler_never_looks_where_light_is)
{
    struct sr_bsdf_model m = sr_bsdf_diffuse;
    m.sample = sample_of_half;
    m.pdf = pdf_of_half;
    expect_failure(&m, "support", "but pdf = 0");
    expect_failure(&m, "light", "drawn");
}

/* ---- metals, broken ---- */

static sr_spectrum f_without_a_quarter(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return sr_bsdf_conductor.f(self, wo, wi, mode) * (4 / SR_PI); // 1 / pi in the place of 1 / 4, as printed in 1982
}
static bool sample_without_a_quarter(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                     struct sr_bsdf_sample *s)
{
    bool drawn = sr_bsdf_conductor.sample(self, wo, u_lobe, u, mode, s);
    s->f *= 4 / SR_PI;
    return drawn;
}

TEST(broken_pi_in_the_place_of_four)
{
    struct sr_bsdf_model m = sr_bsdf_conductor;
    m.f = f_without_a_quarter;
    m.f_pdf = NULL;
    m.albedo = NULL;
    m.sample = sample_without_a_quarter;
    expect_failure(&m, "energy", "E = 1.");
}

static float pdf_of_half_vectors(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    sr_vec3 m = sr_normalize(sr_add(wo, wi));
    return sr_bsdf_conductor.pdf(self, wo, wi, mode) * (4 * fabsf(sr_dot(wo, m))); // density of m, not of wi
}
static bool sample_of_half_vectors(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                   struct sr_bsdf_sample *s)
{
    bool drawn = sr_bsdf_conductor.sample(self, wo, u_lobe, u, mode, s);
    if (drawn && !(s->lobe & SR_LOBE_SPECULAR))
        s->pdf = pdf_of_half_vectors(self, wo, s->wi, mode);
    return drawn && s->pdf > 0;
}

TEST(broken_the_jacobian_of_the_half_vector_is_left_out)
{
    struct sr_bsdf_model m = sr_bsdf_conductor;
    m.pdf = pdf_of_half_vectors;
    m.f_pdf = NULL;
    m.sample = sample_of_half_vectors;
    expect_failure(&m, "normalisation", "INTEGRAL pdf");
    expect_failure(&m, "sampling", "chi2");
}

TEST(broken_wards_model_does_not_tell_that_it_has_no_bound)
{
    struct sr_bsdf_model m = sr_bsdf_ward;
    m.largest_albedo = 0;
    struct sr_certificate_options o = options;
    o.samples *= SR_LAMBDA_COUNT > 8
                     ? 4
                     : 1; // few directions gain energy: which are tried is luck, and changes with the wavelengths
    expect_failure_of(&m, &o, "energy", "E = ");
}

static sr_spectrum f_without_eta2(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)mode;
    return sr_bsdf_dielectric.f(self, wo, wi, SR_IMPORTANCE);
}
static bool sample_without_eta2(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                struct sr_bsdf_sample *s)
{
    (void)mode;
    return sr_bsdf_dielectric.sample(self, wo, u_lobe, u, SR_IMPORTANCE, s);
}

TEST(broken_radiance_is_not_compressed_in_glass)
{
    struct sr_bsdf_model m = sr_bsdf_dielectric;
    m.f = f_without_eta2;
    m.f_pdf = NULL;
    m.sample = sample_without_eta2;
    expect_failure(&m, "adjoint", "");
}

/* ---- good ones ---- */

static bool reads_files(const struct sr_bsdf_model *m)
{
    for (const struct sr_param *p = m->params; p->name; ++p)
        if (p->kind == SR_PARAM_FILE || p->kind == SR_PARAM_STRING)
            return true;
    return false;
}

/* Every model keeps what it promises over a few sets; over 64 where STERADIAN_TEST_EFFORT is set (some minutes). */
TEST(every_model_has_a_certificate)
{
    bool is_long = getenv("STERADIAN_TEST_EFFORT") != NULL;
    struct sr_certificate_options o = {
        .sets = is_long ? 64 : 3, .samples = is_long ? 65536 : 4096, .seed = is_long ? 1 : 7, .significance = 1e-6};
    for (int i = 0; sr_bsdf_models[i]; ++i)
        if (!reads_files(sr_bsdf_models[i]))
            expect_pass(sr_bsdf_models[i], &o);
}

/* The copies that the broken ones begin with are good: what fails above is what was broken. */
TEST(copies_of_good_models_pass)
{
    struct sr_bsdf_model diffuse = sr_bsdf_diffuse, conductor = sr_bsdf_conductor;
    conductor.f_pdf = NULL;
    expect_pass(&diffuse, &options);
    expect_pass(&conductor, &options);
}

TEST(the_same_seed_gives_the_same_certificate)
{
    struct sr_certificate a, b;
    struct sr_error error = {0};
    struct sr_certificate_options o = {.sets = 2, .samples = 4096, .seed = 3, .significance = 1e-6};
    EXPECT(sr_certify_model(&sr_bsdf_dielectric, &o, &a, &error) == SR_OK);
    EXPECT(sr_certify_model(&sr_bsdf_dielectric, &o, &b, &error) == SR_OK);
    for (int i = 0; i < a.count; ++i) {
        EXPECT_EQUAL_TEXT(a.checks[i].text, b.checks[i].text);
        EXPECT(a.checks[i].count == b.checks[i].count);
    }
}
