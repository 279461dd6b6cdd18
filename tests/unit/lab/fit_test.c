/* SPDX-License-Identifier: MIT */
/* Fitting: what a model itself has made is found again; intervals cover what noise hides; mistakes are told. */
#include "lab/lab.h"
#include "test.h"

static struct sr_specimen read(struct sr_arena *arena, const char *words)
{
    const char *list[64];
    int count = 0;
    char *text = sr_arena_string(arena, words);
    for (char *word; (word = strtok_r(text, " ", &text));)
        list[count++] = word;
    struct sr_specimen s;
    struct sr_error error = {0};
    if (sr_specimen_read(arena, count, list, &s, (struct sr_log){0}, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", words, error.text);
    return s;
}

static struct sr_fit_options options(void)
{
    return (struct sr_fit_options){
        .lambda = SR_BLACK + 550, .lambda_count = 1, .points = 800, .starts = 4, .seed = 1, .theta_max = 80};
}

static sr_status try_to_fit(struct sr_arena *arena, const struct sr_specimen *data, const struct sr_specimen *model,
                            const struct sr_fit_options *o, struct sr_fit *fit, struct sr_error *error)
{
    struct sr_fit_point *points;
    uint32_t count;
    *error = (struct sr_error){0};
    sr_status status = sr_fit_gather(arena, data, o, &points, &count, error);
    return status == SR_OK ? sr_fit_points(arena, points, count, model, o, fit, error) : status;
}

static struct sr_fit fit_to(struct sr_arena *arena, const struct sr_specimen *data, const struct sr_specimen *model,
                            const struct sr_fit_options *o)
{
    struct sr_error error;
    struct sr_fit fit;
    if (try_to_fit(arena, data, model, o, &fit, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return fit;
}

static const struct sr_fit_parameter *find(const struct sr_fit *fit, const char *name)
{
    for (int i = 0; i < fit->count; ++i)
        if (strcmp(fit->parameters[i].name, name) == 0)
            return &fit->parameters[i];
    test_fail(__FILE__, __LINE__, "%s was not fitted", name);
}

/* Data that lies on the model: all metrics find the numbers that made it, from elsewhere. */
TEST(a_model_finds_itself)
{
    for (int metric = 0; metric < 3; ++metric) {
        struct sr_arena arena = {0};
        struct sr_fit fit;
        struct sr_specimen data = read(&arena, "conductor eta=.3 k=3 alpha_x=.25 alpha_y=.4"),
                           model = read(&arena, "conductor eta=.3 k=3 alpha_x=.6 alpha_y=.6");
        struct sr_fit_options o = options();
        static const char *const fixed[] = {"eta", "k"};
        o.metric = (enum sr_fit_metric)metric;
        o.fixed = fixed;
        o.fixed_count = 2;
        fit = fit_to(&arena, &data, &model, &o);
        EXPECT(fit.has_converged && fit.count == 2);
        EXPECT_RELATIVE(find(&fit, "alpha_x")->value, 0.25, 1e-4);
        EXPECT_RELATIVE(find(&fit, "alpha_y")->value, 0.4, 1e-4);
        EXPECT(fit.rms < 1e-4);
        struct sr_specimen again = read(&arena, fit.words); // the words are a specimen
        EXPECT(again.part_count == 1 && strstr(fit.words, "eta=.3") != NULL);
        sr_arena_free(&arena);
    }
}

/* Spectra get a value at each wavelength, and the rest is shared. */
TEST(spectra_are_fitted_by_wavelength)
{
    struct sr_arena arena = {0};
    struct sr_fit fit;
    struct sr_specimen data = read(&arena, "diffuse reflectance=450:.2,550:.5,650:.8"), model = read(&arena, "diffuse");
    struct sr_fit_options o = options();
    o.lambda_count = 3;
    o.lambda[0] = 450;
    o.lambda[2] = 650;
    fit = fit_to(&arena, &data, &model, &o);
    EXPECT_EQUAL_INT(fit.count, 3);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(fit.parameters[i].lambda, 450 + 100 * i, 0);
        EXPECT_NEAR(fit.parameters[i].value, 0.2 + 0.3 * i, 1e-5);
    }
    sr_arena_free(&arena);
}

/* A Lambertian surface measured with noise of 10 %: the intervals of 95 % hold the truth in 95 % of 400 experiments,
 * and the estimates scatter as much as the uncertainties say. */
TEST(intervals_cover_what_noise_hides)
{
    enum { RUNS = 400 };
    struct sr_rng rng = sr_rng_seed(5, 1);
    struct sr_tally covered = {0}, z2 = {0};
    for (uint32_t run = 0; run < RUNS; ++run) {
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        struct sr_fit fit;
        struct sr_fit_point *points;
        uint32_t count;
        struct sr_specimen data = read(&arena, "diffuse reflectance=.5"),
                           model = read(&arena, "diffuse reflectance=.3");
        struct sr_fit_options o = options();
        o.points = 40;
        o.starts = 1;
        o.metric = SR_FIT_LOG; // noise relative to the value is the same for all in the logarithm
        EXPECT_EQUAL_INT(sr_fit_gather(&arena, &data, &o, &points, &count, &error), SR_OK);
        for (uint32_t i = 0; i < count; ++i) {
            double noise = 0; // of four uniform numbers: near enough to Gauss's, and of standard deviation 0.1
            for (int k = 0; k < 4; ++k)
                noise += (double)sr_rng_float(&rng) - 0.5;
            points[i].data[0] *= exp(0.1 * sqrt(3) * noise);
        }
        EXPECT_EQUAL_INT(sr_fit_points(&arena, points, count, &model, &o, &fit, &error), SR_OK);
        double z = (fit.parameters[0].value - 0.5) / fit.parameters[0].standard_uncertainty;
        sr_tally_add(&covered, fabs(z) <= sr_student_quantile(0.975, fit.degrees_of_freedom));
        sr_tally_add(&z2, z * z);
        sr_arena_free(&arena);
    }
    EXPECT_MEAN(covered, 0.95);
    EXPECT_MEAN(z2, 39.0 / 37); // of Student's t with 39 degrees
}

TEST(what_cannot_be_fitted_is_told)
{
    struct sr_arena arena = {0};
    struct sr_fit fit;
    struct sr_specimen data = read(&arena, "diffuse"), sum = read(&arena, ".5*diffuse + .5*diffuse"),
                       mirror = read(&arena, "conductor");
    struct sr_fit_options o = options();
    struct sr_error error = {0};
    EXPECT(try_to_fit(&arena, &data, &sum, &o, &fit, &error) == SR_ERROR_USAGE && strstr(error.text, "one model"));
    EXPECT(try_to_fit(&arena, &mirror, &data, &o, &fit, &error) == SR_ERROR_INPUT &&
           strstr(error.text, "no f above 0"));
    static const char *const unknown[] = {"colour"}, *const all[] = {"reflectance"};
    o.fixed = unknown;
    o.fixed_count = 1;
    EXPECT(try_to_fit(&arena, &data, &data, &o, &fit, &error) == SR_ERROR_USAGE && strstr(error.text, "colour"));
    o.fixed = all;
    EXPECT(try_to_fit(&arena, &data, &data, &o, &fit, &error) == SR_ERROR_USAGE &&
           strstr(error.text, "nothing is left"));
    sr_arena_free(&arena);
}
