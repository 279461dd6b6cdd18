/* SPDX-License-Identifier: MIT */
/* Do error bars keep their word?
 *
 * (a) Measurements, R = 16 replicates: Student's 95 % intervals cover the truth in 93.5 to 96.5 % of 1000 seeds or more
 * where tails are light (a binomial allowance on both sides), 92 % always. (b) Ordinary images, m +- 1.96 u: at least
 * 95 %, and u at most twice the standard deviation that seeds really show. (c) What replicates cost: the mean square
 * error of 16 replicates over that of one net of as many samples. */
#include "analytic/analytic.h"

/* Y of each pixel from each of many seeds, and what the film says of its error. */
struct trials {
    uint32_t seeds, pixels;
    double *mean, *error; // seeds * pixels
};

static struct trials render_many(struct sr_render_job job, uint32_t seeds, uint32_t spp, uint32_t replicates)
{
    job.spp = spp;
    job.replicates = replicates;
    struct trials t = {.seeds = seeds};
    for (uint32_t s = 0; s < seeds; ++s) {
        struct sr_film *film;
        struct sr_render_report report;
        struct sr_error error = {0};
        job.seed = 1000 + s;
        if (sr_render(&job, &film, &report, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        if (!t.mean) {
            t.pixels = film->width * film->height;
            t.mean = sr_alloc((size_t)seeds * t.pixels * sizeof(double));
            t.error = sr_alloc((size_t)seeds * t.pixels * sizeof(double));
        }
        for (uint32_t i = 0; i < t.pixels; ++i) {
            double mean[3], se[3];
            sr_film_pixel_mean(film, i % film->width, i / film->width, mean);
            sr_film_errors(film, i % film->width, i / film->width, i % film->width + 1, i / film->width + 1,
                           replicates == 0, se);
            t.mean[(size_t)s * t.pixels + i] = mean[1];
            t.error[(size_t)s * t.pixels + i] = se[1];
        }
        sr_film_destroy(film);
    }
    return t;
}

static void trials_free(struct trials *t)
{
    sr_free(t->mean);
    sr_free(t->error);
}

struct verdict {
    double coverage, low, high; // [1] of trials; intervals that end below, begin above the truth
    double ratio;               // root mean square of the errors told, over the standard deviation shown; over pixels
    double ratio_of_means;      // mean of the errors told over the standard deviation shown
    double variance;            // mean over pixels
    double trials;
};

/* truth: NULL: the mean over the seeds themselves, whose own error is small beside one seed's. */
static struct verdict judge(const struct trials *t, const double *truth, double k)
{
    struct verdict v = {0};
    double told = 0, told2 = 0, shown = 0, pixels = 0;
    for (uint32_t p = 0; p < t->pixels; ++p) {
        struct sr_tally tally = {0};
        for (uint32_t s = 0; s < t->seeds; ++s)
            sr_tally_add(&tally, t->mean[(size_t)s * t->pixels + p]);
        if (sr_tally_variance(&tally) < 1e-12 * tally.mean * tally.mean || tally.mean == 0)
            continue; // no chance in it: nothing to cover
        double expected = truth ? truth[p] : tally.mean;
        // with the seeds' own mean for truth each deviation is smaller by sqrt(1 - 1/n)
        double stretch = truth ? 1 : sqrt(t->seeds / (t->seeds - 1.0));
        for (uint32_t s = 0; s < t->seeds; ++s) {
            double m = t->mean[(size_t)s * t->pixels + p], u = t->error[(size_t)s * t->pixels + p],
                   d = (m - expected) * stretch;
            // float's own resolution of a pixel is not part of the question
            double reach = k * u + 1e-6 * fabs(expected);
            v.low += d < -reach;
            v.high += d > reach;
            told += u;
            told2 += u * u;
        }
        shown += sr_tally_variance(&tally);
        ++pixels;
        v.ratio_of_means += sqrt(sr_tally_variance(&tally)); // for now: sum of deviations
    }
    double n = t->seeds * pixels;
    v.low /= n;
    v.high /= n;
    v.coverage = 1 - v.low - v.high;
    v.ratio = sqrt(told2 / n / (shown / pixels));
    v.ratio_of_means = told / n / (v.ratio_of_means / pixels);
    v.variance = shown / pixels;
    v.trials = n;
    return v;
}

#define FILM "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"\n"

static const struct {
    const char *name, *text;
    double most_ratio; // of the error told over the one shown
} scenes[] = {
    {"disk",
     "LookAt 0 -2 1  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 30\n" FILM
     "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\n" GREY "Shape \"disk\" \"float radius\" 10\n" BLACK GLOW
     "ReverseOrientation Shape \"disk\" \"float height\" 1.5 \"float radius\" 1\n",
     2.1},
    {"shadow",
     "LookAt 0 -2 1  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 40\n" FILM
     "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\n" GREY
     "Shape \"disk\" \"float radius\" 10\nAttributeBegin\nTranslate 0 0 0.3 Shape \"sphere\" \"float radius\" 0.25\nAttributeEnd\n" BLACK
         GLOW "ReverseOrientation Shape \"disk\" \"float height\" 1.5 \"float radius\" 0.5\n",
     2},
    {"furnace",
     "Camera \"perspective\" \"float fov\" 40\n" FILM "Integrator \"path\" \"integer maxdepth\" 60\nWorldBegin\n"
     "Material \"diffuse\" \"spectrum reflectance\" [360 0.5 830 0.5]\n" GLOW_BOTH
     "Shape \"sphere\" \"float radius\" 2\n",
     2},
    {"edges",
     "LookAt 0 0 3  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n" FILM
     "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\n"
     "AttributeBegin\n" BLACK GLOW_BOTH "Shape \"disk\" \"float radius\" 0.8\nAttributeEnd\n",
     2.5},
    {"room",
     "LookAt 0.5 0.05 0.5  0.5 1 0.4  0 0 1\nCamera \"perspective\" \"float fov\" 70\n" FILM
     "Integrator \"path\" \"integer maxdepth\" 8\nWorldBegin\n" GREY
     "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1] "
     "\"integer indices\" [0 1 2 3 4 5 6 7 0 1 4 5 2 3 6 7 0 2 4 6 1 3 5 7]\n" BLACK GLOW "ReverseOrientation "
     "Shape \"bilinearmesh\" \"point3 P\" [0.4 0.4 0.99 0.6 0.4 0.99 0.4 0.6 0.99 0.6 0.6 0.99]\n",
     2},
};
enum { SCENES = sizeof scenes / sizeof scenes[0] };

static uint32_t seeds_of(double n)
{
    return (uint32_t)(is_slow_build() ? fmin(n, 12) : n);
}

TEST(intervals_of_replicates_cover_the_truth)
{
    static const uint32_t spp[] = {64, 256};
    printf("replicates, R = 16: coverage of Student's 95 %% intervals\n  %-8s %5s %8s %9s %8s %8s %8s\n", "scene",
           "spp", "trials", "covered", "too low", "too high", "told/sd");
    bool is_right = true;
    for (int i = 0; i < SCENES; ++i)
        for (int k = 0; k < (is_slow_build() ? 1 : 2); ++k) {
            struct world w = world_of("%s", scenes[i].text);
            struct trials t = render_many(w.job, seeds_of(k ? 60 : 120), spp[k], 16);
            struct verdict v = judge(&t, NULL, sr_student_quantile(0.975, 15));
            double n = v.trials, allowance = 4 * sqrt(0.05 * 0.95 / n);
            printf("  %-8s %5u %8.0f %8.2f%% %7.2f%% %7.2f%% %8.3f\n", scenes[i].name, spp[k], n, 100 * v.coverage,
                   100 * v.low, 100 * v.high, v.ratio);
            // four samples a replicate are a skewed law yet, for which nothing is promised
            is_right = is_right && (is_slow_build() ||
                                    (v.coverage > (k ? 0.92 : 0.89) - allowance && v.coverage < 0.965 + allowance));
            trials_free(&t);
            world_free(&w);
        }
    EXPECT(is_right);
}

/* Single pixels with a closed form, 1000 seeds each: laws with light tails. */
TEST(intervals_of_replicates_cover_closed_forms)
{
    static const struct {
        const char *name, *content;
        double p[3], E; // [lx]
    } cases[] = {
        {"B1", BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 2\n", {0, 0, 0}, 0.628318530718},
        {"B2", BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 2\n", {1.5, 0, 0}, 0.321335102752},
        {"B8",
         BLACK GLOW
         "ReverseOrientation Shape \"bilinearmesh\" \"point3 P\" [-0.5 -0.5 1 0.5 -0.5 1 -0.5 0.5 1 0.5 0.5 1]\n",
         {0, 0, 0},
         0.752274688454},
        {"B14.15",
         BLACK GLOW "Translate 0 0 1 Shape \"sphere\" \"float radius\" 0.258819045\n",
         {0, 0, 0},
         0.210446803619},
    };
    // green of the light's white, whose luminance is 1
    struct world white = world_of(
        "Camera \"perspective\" \"float fov\" 10\nFilm \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\n"
        "Integrator \"path\" \"integer maxdepth\" 0\nWorldBegin\nLightSource \"infinite\" \"float scale\" 1\n");
    struct trials w1 = render_many(white.job, 4, 65536, 0);
    double green = w1.mean[0];
    trials_free(&w1);
    world_free(&white);
    printf("replicates, R = 16: coverage of closed forms by Student's 95 %% intervals, 1000 seeds\n");
    bool is_right = true;
    for (int i = 0; i < 4; ++i)
        for (int by_surface = 0; by_surface < 2; ++by_surface) {
            if (by_surface && i == 3)
                continue; // one ray in fifteen meets it: a law that is skewed
            struct world w = world_of("Integrator \"simplepath\" \"integer maxdepth\" 1 \"bool samplelights\" %s\n%s%s",
                                      by_surface ? "false" : "true",
                                      receiver_text(cases[i].p, (const double[]){0, 0, 1}), cases[i].content);
            struct trials t = render_many(w.job, seeds_of(1000), 256, 16);
            double truth = cases[i].E * RECEIVER_RHO / (double)SR_PI * green;
            struct verdict v = judge(&t, &truth, sr_student_quantile(0.975, 15));
            double allowance = 4 * sqrt(0.05 * 0.95 / v.trials);
            printf("  %-8s %-8s %8.2f%% %7.2f%% %7.2f%% %8.3f\n", cases[i].name, by_surface ? "surface" : "lights",
                   100 * v.coverage, 100 * v.low, 100 * v.high, v.ratio);
            is_right = is_right && (is_slow_build() || fabs(v.coverage - 0.95) < 0.015 + allowance);
            trials_free(&t);
            world_free(&w);
        }
    EXPECT(is_right);
}

#define UP                                                                                                             \
    {                                                                                                                  \
        0, 0, 1                                                                                                        \
    }
#define DISK "ReverseOrientation Shape \"disk\" \"float height\" 2\n"
#define SPHERE_AT(x, y, z, r) "Translate " #x " " #y " " #z " Shape \"sphere\" \"float radius\" " #r "\n"

/* Meters with a closed form: what a reading says of itself, over 1000 seeds. */
TEST(readings_of_meters_cover_closed_forms)
{
    static const struct {
        const char *name, *content;
        double p[3], n[3], E; // [lx]
    } cases[] = {
        {"B1 disk", BLACK GLOW DISK, {0, 0, 0}, UP, 0.628318530718},
        {"B2 disk, off axis", BLACK GLOW DISK, {1.5, 0, 0}, UP, 0.321335102752},
        {"B4 disk, tilted", BLACK GLOW DISK, {1.5, 0, 0}, {-0.573576436, 0, 0.819152044}, 0.381493863441},
        {"B5 sphere, tilted",
         BLACK GLOW SPHERE_AT(0, 0, 3, 1),
         {0, 0, 0},
         {0.642787610, 0, 0.766044443},
         0.267399954981},
        {"B6.80 sphere, cut",
         BLACK GLOW SPHERE_AT(0, 0, 2, 1),
         {0, 0, 0},
         {0.984807753, 0, 0.173648178},
         0.171831975127},
        {"B6.90 sphere, cut", BLACK GLOW SPHERE_AT(0, 0, 2, 1), {0, 0, 0}, {1, 0, 0}, 0.0905860737061},
        {"B7 rectangle",
         BLACK GLOW "ReverseOrientation Shape \"bilinearmesh\" \"point3 P\" [0 0 1 2 0 1 0 1 1 2 1 1]\n",
         {0, 0, 0},
         UP,
         0.525824101542},
        {"B8 square",
         BLACK GLOW
         "ReverseOrientation Shape \"bilinearmesh\" \"point3 P\" [-0.5 -0.5 1 0.5 -0.5 1 -0.5 0.5 1 0.5 0.5 1]\n",
         {0, 0, 0},
         UP,
         0.752274688454},
        {"B10 triangle",
         BLACK GLOW_BOTH "Shape \"trianglemesh\" \"point3 P\" [1 0 1 -1 2 1.5 -1 -1 2] \"integer indices\" [0 1 2]\n",
         {0, 0, 0},
         UP,
         0.875254739837},
        {"B14.15 cap", BLACK GLOW SPHERE_AT(0, 0, 1, 0.258819045), {0, 0, 0}, UP, 0.210446803619},
        {"D1 sphere, rho 0.5",
         GREY GLOW_BOTH "Shape \"sphere\" \"float radius\" 2\n",
         {0.5, 0, -0.5},
         UP,
         6.28318530718},
        {"D1 sphere, rho 0.8",
         "Material \"diffuse\" \"spectrum reflectance\" [360 0.8 830 0.8]\n" GLOW_BOTH
         "Shape \"sphere\" \"float radius\" 2\n",
         {0.5, 0, -0.5},
         UP,
         15.7079632679},
        {"B12.60 sky, grey ground",
         "LightSource \"infinite\" \"float scale\" 1\n" GREY
         "Translate 0 0 -1 Shape \"disk\" \"float radius\" 100000\n",
         {0, 0, 0},
         {0.866025404, 0, 0.5},
         2.74889357189},
    };
    printf("meters, R = 16: coverage of closed forms by Student's 95 %% intervals (too low, too high)\n");
    bool is_right = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        struct world w = world_of("Integrator \"path\" \"integer maxdepth\" 60\nWorldBegin\n%s", cases[i].content);
        const double *p = cases[i].p, *n = cases[i].n;
        w.job.threads = 1;
        printf("  %-24s", cases[i].name);
        for (int by_nets = 0; by_nets < 2; ++by_nets) {
            uint32_t seeds = seeds_of(by_nets ? 100 : 1000);
            double low = 0, high = 0;
            w.job.sampler = by_nets ? SR_SAMPLER_SOBOL : SR_SAMPLER_INDEPENDENT;
            for (uint32_t s = 0; s < seeds; ++s) {
                w.job.seed = 5000 + s;
                struct sr_irradiance E = sr_render_irradiance(&w.job, (sr_vec3){(float)p[0], (float)p[1], (float)p[2]},
                                                              (sr_vec3){(float)n[0], (float)n[1], (float)n[2]}, 32, 16);
                double reach = sr_student_quantile(0.975, 15) * E.E_v_error + 1e-6 * cases[i].E;
                low += E.E_v < cases[i].E - reach;
                high += E.E_v > cases[i].E + reach;
            }
            double covered = 1 - (low + high) / seeds, allowance = 4 * sqrt(0.05 * 0.95 / seeds);
            printf(" %s %6.2f%% (%.2f%%, %.2f%%)", by_nets ? "nets" : "independent", 100 * covered, 100 * low / seeds,
                   100 * high / seeds);
            // a meter's u has a floor beside few samples of a net, so that its intervals may be wide
            is_right = is_right && (is_slow_build() || (covered > (by_nets ? 0.92 : 0.935) - allowance &&
                                                        (by_nets || covered < 0.965 + allowance)));
        }
        printf("\n");
        world_free(&w);
    }
    EXPECT(is_right);
}

TEST(error_bars_of_ordinary_images_are_wide_enough_and_not_too_wide)
{
    static const uint32_t spp[] = {16, 64, 256};
    printf("ordinary images: m +- 1.96 u\n  %-8s %5s %8s %9s %8s %8s %8s %8s\n", "scene", "spp", "trials", "covered",
           "too low", "too high", "rms/sd", "mean/sd");
    bool is_right = true;
    for (int i = 0; i < SCENES; ++i)
        for (int k = 0; k < (is_slow_build() ? 1 : 3); ++k) {
            struct world w = world_of("%s", scenes[i].text);
            struct trials t = render_many(w.job, seeds_of(k == 2 ? 40 : 120), spp[k], 0);
            struct verdict v = judge(&t, NULL, 1.96);
            printf("  %-8s %5u %8.0f %8.2f%% %7.2f%% %7.2f%% %8.2f %8.2f\n", scenes[i].name, spp[k], v.trials,
                   100 * v.coverage, 100 * v.low, 100 * v.high, v.ratio, v.ratio_of_means);
            is_right = is_right && (is_slow_build() || (v.coverage > 0.95 && v.ratio < scenes[i].most_ratio));
            trials_free(&t);
            world_free(&w);
        }
    EXPECT(is_right);
}

TEST(what_replicates_cost_is_known)
{
    static const uint32_t spp[] = {64, 256, 1024};
    printf("mean square error of 16 replicates over one net\n  %-8s %8s %8s %8s\n", "scene", "spp 64", "256", "1024");
    for (int i = 0; i < SCENES; ++i) {
        printf("  %-8s", scenes[i].name);
        for (int k = 0; k < (is_slow_build() ? 1 : 3); ++k) {
            struct world w = world_of("%s", scenes[i].text);
            struct trials one = render_many(w.job, seeds_of(16), spp[k], 0),
                          many = render_many(w.job, seeds_of(16), spp[k], 16);
            double ratio = judge(&many, NULL, 2).variance / judge(&one, NULL, 2).variance;
            printf(" %8.2f", ratio);
            EXPECT(ratio > 0.5 && ratio < 64); // nets are no worse than their parts
            trials_free(&one);
            trials_free(&many);
            world_free(&w);
        }
        printf("\n");
    }
}
