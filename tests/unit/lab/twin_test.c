/* SPDX-License-Identifier: MIT */
/* The double-precision twins say what the models say, and more exactly. */
#include "lab/lab.h"
#include "test.h"

static struct sr_arena arena;

static sr_spectrum lambdas(void)
{
    sr_spectrum l = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        l[i] = 400 + 40 * (float)i;
    return l;
}

static void set(struct sr_bsdf *b, const char *name, float value)
{
    for (const struct sr_param *p = b->model->params; p->name; ++p)
        if (strcmp(p->name, name) == 0) {
            sr_spectrum s = SR_BLACK + value;
            if (p->kind == SR_PARAM_FLOAT)
                memcpy(b->data + p->offset, &value, sizeof value);
            else
                memcpy(b->data + p->offset, &s, sizeof s);
            return;
        }
    test_fail(__FILE__, __LINE__, "%s has no %s", b->model->name, name);
}

static struct sr_bsdf defaults(const struct sr_bsdf_model *model)
{
    struct sr_bsdf b = {.model = model};
    for (const struct sr_param *p = model->params; p->name; ++p) {
        void *member = b.data + p->offset;
        sr_spectrum s = SR_BLACK + (float)p->initial;
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i) // a spectrum that is not grey
            s[i] += (i % 2 ? 0.01f : -0.01f) * (float)i *
                    sr_min((float)(p->max - p->initial), (float)(p->initial - p->min));
        if (p->kind == SR_PARAM_FLOAT)
            memcpy(member, &(float){(float)p->initial}, sizeof(float));
        else if (p->kind == SR_PARAM_BOOL)
            memcpy(member, &(bool){p->initial != 0}, sizeof(bool));
        else if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM)
            memcpy(member, &(int32_t){(int32_t)p->initial}, sizeof(int32_t));
        else if (p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED)
            memcpy(member, &s, sizeof s);
    }
    return b;
}

static void prepare(struct sr_bsdf *b)
{
    struct sr_error error = {0};
    if (b->model->load && b->model->load(b->data, &arena, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", b->model->name, error.text);
    if (b->model->ready)
        b->model->ready(b->data, &(struct sr_bsdf_at){.lambda = lambdas()});
}

static bool reads_files(const struct sr_bsdf_model *m)
{
    for (const struct sr_param *p = m->params; p->name; ++p)
        if (p->kind == SR_PARAM_FILE)
            return true;
    return false;
}

/* With the defaults of its table, and all slopes broad, every model agrees with its twin to what floats can hold. */
TEST(every_model_has_a_twin_that_agrees)
{
    for (int m = 0; sr_bsdf_models[m]; ++m) {
        struct sr_bsdf b = defaults(sr_bsdf_models[m]);
        for (const struct sr_param *p = b.model->params; p->name; ++p)
            if (strstr(p->name, "alpha"))
                set(&b, p->name, 0.4f);
        struct sr_error error = {0};
        if (reads_files(b.model) && b.model->load(b.data, &arena, &error) != SR_OK)
            continue; // nothing but what a file says
        prepare(&b);
        const struct sr_twin *twin;
        sr_status status = sr_twin_make(&arena, &b, lambdas(), SR_TWIN_SAME, &twin, &error);
        EXPECT_EQUAL_INT(status, SR_OK);
        EXPECT(twin != NULL);
        if (!twin || b.model->is_random)
            continue;
        struct sr_rng rng = sr_rng_seed(11, (uint64_t)m);
        int seen = 0;
        for (int n = 0; n < 200; ++n) {
            float zo = 0.1f + 0.9f * sr_rng_float(&rng), po = 6.28f * sr_rng_float(&rng);
            float zi = 0.1f + 0.9f * sr_rng_float(&rng), pi = 6.28f * sr_rng_float(&rng);
            sr_vec3 wo = sr_spherical_direction(sqrtf(1 - zo * zo), zo, po);
            sr_vec3 wi = sr_spherical_direction(sqrtf(1 - zi * zi), n % 4 ? zi : -zi, pi);
            const double o[3] = {(double)wo.x, (double)wo.y, (double)wo.z};
            const double i[3] = {(double)wi.x, (double)wi.y, (double)wi.z};
            float pdf;
            sr_spectrum f = sr_bsdf_f_pdf(&b, wo, wi, SR_RADIANCE, &pdf);
            double twin_f[SR_LAMBDA_COUNT];
            sr_twin_f(twin, o, i, SR_RADIANCE, twin_f);
            for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
                if (fabs((double)f[l] - twin_f[l]) > 3e-4 * fabs(twin_f[l]) + 1e-6)
                    test_fail(__FILE__, __LINE__, "%s: f = %.9g, twin %.15g", b.model->name, (double)f[l], twin_f[l]);
            double twin_pdf = sr_twin_pdf(twin, o, i, SR_RADIANCE);
            if (fabs((double)pdf - twin_pdf) > 3e-4 * twin_pdf + 1e-6)
                test_fail(__FILE__, __LINE__, "%s: pdf = %.9g, twin %.15g", b.model->name, (double)pdf, twin_pdf);
            seen += f[0] > 0;
        }
        EXPECT(seen > 0 || (sr_bsdf_lobes(&b) & SR_LOBE_SPECULAR));
    }
}

/* Lambert's 0.3 / pi: in floats good to 7 digits, in the twin to 15; typed decimals are read as typed. */
TEST(twin_is_exact_where_floats_are_not)
{
    struct sr_bsdf b = {.model = &sr_bsdf_diffuse};
    set(&b, "reflectance", 0.3f);
    prepare(&b);
    struct sr_error error = {0};
    const struct sr_twin *same, *typed;
    EXPECT_EQUAL_INT(sr_twin_make(&arena, &b, lambdas(), SR_TWIN_SAME, &same, &error), SR_OK);
    EXPECT_EQUAL_INT(sr_twin_make(&arena, &b, lambdas(), SR_TWIN_DECIMAL, &typed, &error), SR_OK);
    const double wo[3] = {0.6, 0, 0.8}, wi[3] = {0, 0.8, 0.6};
    double f[SR_LAMBDA_COUNT];
    sr_twin_f(same, wo, wi, SR_RADIANCE, f);
    EXPECT_RELATIVE(f[0], (double)0.3f / 3.14159265358979324, 1e-15);
    sr_twin_f(typed, wo, wi, SR_RADIANCE, f);
    EXPECT_RELATIVE(f[SR_LAMBDA_COUNT - 1], 0.3 / 3.14159265358979324, 1e-15);
    EXPECT_RELATIVE(sr_twin_pdf(typed, wo, wi, SR_RADIANCE), 0.6 / 3.14159265358979324, 1e-15);
}
