/* SPDX-License-Identifier: MIT */
/* Every set of sampling strategies against closed forms, and against each other: the same integral in the hemisphere's
 * form and in the area's, so that a lost cosine, a wrong conversion or light that is counted twice shows. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)
#define STRATEGY_GOAL 0.01

static const char *const sets[] = {
    "uniform-hemisphere",
    "cosine-hemisphere",
    "bsdf",
    "uniform-area",
    "light-area",
    "light-solid-angle",
    "bsdf+light-solid-angle",
    "uniform-hemisphere+uniform-area",
    "cosine-hemisphere+light-area",
    "uniform-area+light-area+light-solid-angle",
    "uniform-hemisphere+cosine-hemisphere+bsdf",
    "uniform-hemisphere+cosine-hemisphere+bsdf+uniform-area+light-area+light-solid-angle",
};
enum { SET_COUNT = sizeof sets / sizeof *sets };
static const char *const heuristics[] = {"balance", "power", "mean"};

// short names: U C B for directions; A, L, S for areas
static const char *short_name(int set, int heuristic)
{
    static char text[32];
    static const struct {
        const char *word;
        char letter;
    } letters[] = {{"uniform-hemisphere", 'U'}, {"cosine-hemisphere", 'C'}, {"bsdf", 'B'},
                   {"uniform-area", 'A'},       {"light-area", 'L'},        {"light-solid-angle", 'S'}};
    int n = 0;
    for (const char *p = sets[set]; *p; p += strcspn(p, "+"), p += *p == '+')
        for (size_t i = 0; i < 6; ++i)
            if (strlen(letters[i].word) == strcspn(p, "+") && strncmp(p, letters[i].word, strcspn(p, "+")) == 0)
                text[n++] = letters[i].letter;
    snprintf(text + n, sizeof text - (size_t)n, "%s", heuristic == 0 ? "" : heuristic == 1 ? " pow" : " mean");
    return text;
}

static bool has_choice(int set) // of one light: points and distant lights are found
{
    return strstr(sets[set], "light-area") || strstr(sets[set], "light-solid-angle");
}

static const char *integrator_text(int set, int heuristic, int depth)
{
    static char text[256];
    snprintf(
        text, sizeof text,
        "Integrator \"estimator\" \"string strategies\" \"%s\" \"string heuristic\" \"%s\" \"integer maxdepth\" %d\n",
        sets[set], heuristics[heuristic], depth);
    return text;
}

static double count_for(int set) // [samples a replicate] few rays meet small lights
{
    return has_choice(set) || strstr(sets[set], "uniform-area") ? 384 : 2048;
}

/* ---- receivers ---- */

static float cosine_response(const void *self, sr_vec3 wi)
{
    (void)self;
    return wi.z > 0 ? wi.z : 0;
}
static float cosine_sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    (void)self;
    *wi = sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]});
    return sr_warp_cosine_hemisphere_pdf(wi->z);
}
static float cosine_pdf(const void *self, sr_vec3 wi)
{
    (void)self;
    return sr_warp_cosine_hemisphere_pdf(wi.z);
}

struct reading {
    const struct sr_render_job *job;
    struct sr_receiver receiver;
    uint32_t n;
    double sums[REPLICATES];
};

static void read_replicate(void *context, uint64_t r)
{
    struct reading *m = context;
    const struct sr_render_job *job = m->job;
    struct sr_worker worker = {0};
    for (uint32_t i = 0; i < m->n; ++i) {
        struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, 3, 5, (uint32_t)r, i);
        struct sr_wavelengths w = sr_wavelengths_sample(job->lambda, sr_sample4(&sampler, SR_USE_FILM)[2]);
        sr_spectrum E =
            job->integrator.model->gather(job->integrator.self, job->scene, &m->receiver, &sampler, &w, &worker);
        m->sums[r] += (double)sr_spectrum_to_xyz(E, &w).y / m->n;
    }
}

static struct estimate read_irradiance(const struct sr_render_job *job, const double p[3], const double n[3],
                                       double count)
{
    sr_vec3 z = sr_normalize((sr_vec3){(float)n[0], (float)n[1], (float)n[2]});
    struct reading m = {.job = job,
                        .n = samples(count),
                        .receiver = {.x = {.p = {(float)p[0], (float)p[1], (float)p[2]}, .n = z, .ns = z},
                                     .frame = sr_frame_from_z(z),
                                     .response = cosine_response,
                                     .sample = cosine_sample,
                                     .pdf = cosine_pdf,
                                     .is_upper = true}};
    sr_parallel_for(sr_thread_count(), REPLICATES, read_replicate, &m);
    struct sr_tally tally = {0};
    for (int r = 0; r < REPLICATES; ++r)
        sr_tally_add(&tally, m.sums[r]);
    return (struct estimate){tally.mean, sr_tally_standard_error(&tally), REPLICATES - 1};
}

/* ---- closed forms ---- */

/* By a grey patch that a camera sees, and by a receiver. */
static void by_all_sets(const struct row *row, const double p[3], const double n[3], const char *content,
                        bool has_surface)
{
    for (int i = 0; i < SET_COUNT; ++i)
        for (int h = 0; h < (strchr(sets[i], '+') ? 3 : 1); ++h) {
            if (!has_surface && !has_choice(i))
                continue;
            struct world w = world_of("%s%s%s", integrator_text(i, h, 1), receiver_text(p, n), content);
            EXPECT(!w.job.integrator.model->blind(w.job.integrator.self, w.job.scene));
            check(
                row, short_name(i, h),
                scaled(pixel_mean(&w.job, 0, 0, count_for(i), (const double[]){0, 1, 0}), (double)SR_PI / RECEIVER_RHO),
                STRATEGY_GOAL);
            world_free(&w);
            w = world_of("%sWorldBegin\n%s", integrator_text(i, h, 0), content);
            check(row, short_name(i, h), read_irradiance(&w.job, p, n, count_for(i)), STRATEGY_GOAL);
            world_free(&w);
        }
}

static const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};

static void point(const struct row *row)
{
    by_all_sets(row, origin, up, "LightSource \"point\" \"point3 from\" [0 0 2] \"float power\" 1000\n", false);
}

static void distant(const struct row *row)
{
    by_all_sets(
        row, origin, up,
        "LightSource \"distant\" \"float illuminance\" 1000 \"point3 from\" [0.8660254 0 0.5] \"point3 to\" [0 0 0]\n",
        false);
}

static void disk(const struct row *row)
{
    by_all_sets(row, (const double[]){row->a, 0, 0}, (const double[]){-sin(row->b * DEGREE), 0, cos(row->b * DEGREE)},
                BLACK GLOW "ReverseOrientation Shape \"disk\" \"float height\" 2 \"float radius\" 1\n", true);
}

static void sphere(const struct row *row)
{
    by_all_sets(row, origin, up, BLACK GLOW "Translate 1.92836 0 2.29813 Shape \"sphere\" \"float radius\" 1\n", true);
}

static void square(const struct row *row)
{
    by_all_sets(
        row, origin, up,
        row->a > 0 ? BLACK GLOW
            "ReverseOrientation Shape \"bilinearmesh\" \"point3 P\" [-.5 -.5 1 .5 -.5 1 -.5 .5 1 .5 .5 1]\n"
                   : BLACK GLOW
            "ReverseOrientation Shape \"trianglemesh\" \"point3 P\" [-.5 -.5 1 .5 -.5 1 -.5 .5 1 .5 .5 1] \"integer indices\" [0 1 2 2 1 3]\n",
        true);
}

static void triangle(const struct row *row)
{
    by_all_sets(row, origin, up,
                BLACK GLOW_BOTH
                "Shape \"trianglemesh\" \"point3 P\" [1 0 1 -1 2 1.5 -1 -1 2] \"integer indices\" [0 1 2]\n",
                true);
}

static void sky(const struct row *row)
{
    by_all_sets(row, origin, (const double[]){sin(row->a * DEGREE), 0, cos(row->a * DEGREE)},
                "LightSource \"infinite\" \"float scale\" 1\n" BLACK
                "Shape \"disk\" \"float height\" -0.1 \"float radius\" 1e5\n",
                true);
}

static struct drawn from_inside(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)v;
    return (struct drawn){{0.11f, -0.07f, 0.05f}, sr_warp_uniform_sphere(u), 1};
}

/* A hollow sphere that glows and reflects: L = Le (1 - rho^(depth + 1)) / (1 - rho), light in view of the camera.
 * Within a sphere cos cos' / r^2 is the same everywhere, so that the area form, too, has a finite variance. */
static void furnace(const struct row *row)
{
    for (int i = 0; i < SET_COUNT; ++i)
        for (int h = 0; h < (strchr(sets[i], '+') ? 3 : 1); ++h) {
            struct world w = world_of("%sWorldBegin\n" GREY GLOW_BOTH "Shape \"sphere\"\n", integrator_text(i, h, 4));
            check(row, short_name(i, h), mean_luminance(&w.job, from_inside, NULL, 512), STRATEGY_GOAL);
            world_free(&w);
        }
}

static const struct row strategy_rows[] = {
    {"A1", "isotropic point, 1000 lm, 2 m, normal incidence [lx]", 19.8943678865, point, 0, 0},
    {"A3", "distant light of 1000, 60 deg from the normal [lx]", 500.0, distant, 0, 0},
    {"B1", "disk R = 1 on axis, h = 2", 0.628318530718, disk, 0, 0},
    {"B4", "disk, 1.5 off axis, receiver tilted by 35 deg", 0.381493863441, disk, 1.5, 35},
    {"B5", "sphere R = 1, D = 3, 40 deg", 0.267399954981, sphere, 0, 0},
    {"B8p", "square 1 x 1 at 1, a patch", 0.752274688454, square, 1, 0},
    {"B8t", "square 1 x 1 at 1, two triangles", 0.752274688454, square, 0, 0},
    {"B10", "triangle that glows on both sides", 0.875254739837, triangle, 0, 0},
    {"B12.60", "uniform dome, receiver tilted by 60 deg", 2.35619449019, sky, 60, 0},
    {"D1.4", "furnace, rho = 0.5, four bounces", 1.9375, furnace, 0, 0},
    {.id = NULL},
};

TEST(strategies_give_the_irradiance_of_the_closed_forms)
{
    run_rows("strategies", strategy_rows);
}

/* ---- against each other, where nobody knows the answer ---- */

/* Each set against path tracing, whose code shares nothing with it but the scene. */
static void agree(const char *id, const char *content, int depth, double n)
{
    struct world w = world_of("Integrator \"path\" \"integer maxdepth\" %d\n%s", depth, content);
    struct estimate path = pixel_mean(&w.job, 0, 0, 4 * n, (const double[]){0, 1, 0});
    world_free(&w);
    int wrong = 0;
    for (int i = 0; i < SET_COUNT; ++i)
        for (int h = 0; h < (strchr(sets[i], '+') ? 3 : 1); ++h) {
            w = world_of("%s%s", integrator_text(i, h, depth), content);
            if (!w.job.integrator.model->blind(w.job.integrator.self, w.job.scene)) {
                struct estimate e = pixel_mean(&w.job, 0, 0, n, (const double[]){0, 1, 0});
                double z = (e.mean - path.mean) / sqrt(e.error * e.error + path.error * path.error);
                bool is_right = fabs(z) < 4.9;
                printf("  %-12s %-10s %-16.9g %-16.9g +- %-9.2e z %6.2f %s\n", id, short_name(i, h), path.mean, e.mean,
                       e.error / e.mean, z, is_right ? "" : "WRONG");
                wrong += !is_right;
            }
            world_free(&w);
        }
    EXPECT_EQUAL_INT(wrong, 0);
}

#define VIEW                                                                                                                                       \
    "LookAt 0 -3 1.6  0 0 0.4  0 0 1\nCamera \"perspective\" \"float fov\" 60\nFilm \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\n" \
    "PixelFilter \"box\"\nWorldBegin\n"

TEST(strategies_agree_where_matter_is_glossy_clear_and_mixed)
{
    agree(
        "mixed",
        VIEW
        "LightSource \"infinite\" \"float scale\" 0.3\n"
        "AttributeBegin " BLACK GLOW_BOTH
        "Translate 0.5 0.3 1.5 Rotate 30 1 0 0 Shape \"disk\" \"float radius\" 0.6 AttributeEnd\n"
        "AttributeBegin Material \"diffuse\" \"rgb reflectance\" [0.3 0.5 0.7] Shape \"disk\" \"float radius\" 5 AttributeEnd\n"
        "AttributeBegin Material \"conductor\" \"float roughness\" 0.3 Translate -0.8 0 0.4 Shape \"sphere\" \"float radius\" 0.4 AttributeEnd\n"
        "AttributeBegin Material \"coateddiffuse\" \"float roughness\" 0 Translate 0 0 0.4 Shape \"sphere\" \"float radius\" 0.4 AttributeEnd\n"
        "AttributeBegin Material \"dielectric\" \"float roughness\" 0.2 Translate 0.8 0 0.4 Shape \"sphere\" \"float radius\" 0.4 AttributeEnd\n"
        "AttributeBegin Material \"dielectric\" Translate 0.4 -0.7 0.3 Shape \"sphere\" \"float radius\" 0.3 AttributeEnd\n"
        "AttributeBegin Material \"diffusetransmission\" Translate -0.4 -0.7 0.3 Shape \"sphere\" \"float radius\" 0.3 AttributeEnd\n",
        4, 1024);
}

TEST(strategies_agree_on_lights_whose_points_are_not_even_by_area)
{
    agree(
        "shapes",
        VIEW
        "AttributeBegin Material \"diffuse\" Shape \"disk\" \"float radius\" 5 AttributeEnd\n"
        "AttributeBegin " GREY GLOW
        "Translate -1 0 1 Scale 1 0.4 0.2 Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n"
        "AttributeBegin " GREY GLOW
        "Translate 0.2 0 1 Rotate 40 1 1 0 Scale 1 0.3 1 Shape \"cylinder\" \"float radius\" 0.3 \"float zmin\" -0.3 \"float zmax\" 0.3 AttributeEnd\n"
        "AttributeBegin " GREY GLOW_BOTH
        "Translate 1 0 1 Shape \"bilinearmesh\" \"point3 P\" [-.3 -.3 0 .5 -.3 .4 -.3 .3 .3 .2 .6 -.2] AttributeEnd\n"
        "AttributeBegin " GREY GLOW
        "Translate 0 1 1 Shape \"sphere\" \"float radius\" 0.4 \"float zmin\" -0.1 \"float phimax\" 250 AttributeEnd\n",
        3, 1024);
}

/* An image of the sky that is dark but for some texels, and a lamp at a point. */
TEST(strategies_agree_on_images_of_the_sky_and_on_points)
{
    char path[512], text[2048];
    static float sky[16][16][3];
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c)
                sky[y][x][c] = (x == 9 && y == 6 ? 40 : x > 9 ? 0.3f : 0) * (c == 0 ? 1 : 0.8f);
    snprintf(path, sizeof path, "%s/strategies_sky.pfm", test_folder());
    char data[64 + sizeof sky];
    size_t head = (size_t)snprintf(data, 64, "PF\n16 16\n-1.0\n");
    memcpy(data + head, sky, sizeof sky);
    struct sr_error error = {0};
    EXPECT(sr_file_write(path, data, head + sizeof sky, &error) == SR_OK);
    snprintf(
        text, sizeof text,
        VIEW
        "LightSource \"infinite\" \"string filename\" \"%s\"\n"
        "AttributeBegin Material \"diffuse\" Shape \"disk\" \"float radius\" 5 AttributeEnd\n"
        "AttributeBegin Material \"conductor\" \"float roughness\" 0.3 Translate -0.8 0 0.4 Shape \"sphere\" \"float radius\" 0.4 AttributeEnd\n"
        "AttributeBegin " GREY GLOW_BOTH "Translate 0.5 0.3 1 Shape \"disk\" \"float radius\" 0.4 AttributeEnd\n",
        path);
    agree("sky", text, 3, 1024);
    strcat(text, "LightSource \"point\" \"point3 from\" [0 -1 2] \"float scale\" 0.3\n");
    agree("sky+point", text, 3, 1024);
}

/* ---- variances ---- */

/* Relative standard deviation of one sample of a receiver that looks straight at a disk of half angle 10 deg. */
static double deviation(const char *strategies)
{
    struct world w =
        world_of("Integrator \"estimator\" \"string strategies\" \"%s\" \"integer maxdepth\" 0\nWorldBegin\n" BLACK GLOW
                 "ReverseOrientation Shape \"disk\" \"float height\" 1 \"float radius\" 0.176326980708\n",
                 strategies);
    struct reading m = {.receiver = {.x = {.n = {0, 0, 1}, .ns = {0, 0, 1}},
                                     .frame = sr_frame_from_z((sr_vec3){0, 0, 1}),
                                     .response = cosine_response,
                                     .sample = cosine_sample,
                                     .pdf = cosine_pdf,
                                     .is_upper = true}};
    struct sr_worker worker = {0};
    struct sr_tally tally = {0};
    for (uint32_t i = 0; i < samples(65536); ++i) {
        struct sr_sampler sampler = sr_sampler_start(SR_SAMPLER_INDEPENDENT, 1, 0, 0, 0, i);
        struct sr_wavelengths lambda = sr_wavelengths_sample(w.job.lambda, 0.5f); // the same spectrum for all
        sr_spectrum E =
            w.job.integrator.model->gather(w.job.integrator.self, w.job.scene, &m.receiver, &sampler, &lambda, &worker);
        sr_tally_add(&tally, (double)sr_spectrum_to_xyz(E, &lambda).y);
    }
    world_free(&w);
    return sqrt(sr_tally_variance(&tally)) / tally.mean;
}

TEST(strategies_have_the_variances_that_follow_from_their_densities)
{
    // tolerance: 65536 samples, of which a share of 1.5 or 3 % finds the disk: 4.9 standard errors and more
    double wide = is_slow_build() ? 8 : 1;
    EXPECT_RELATIVE(deviation("uniform-hemisphere"), 8.0513559912, 0.1 * wide);
    EXPECT_RELATIVE(deviation("cosine-hemisphere"), 5.6712818196, 0.07 * wide);
    EXPECT_RELATIVE(deviation("uniform-area"), 0.0176778085, 0.02 * wide);
    EXPECT_RELATIVE(deviation("light-area"), 0.0176778085, 0.02 * wide);
}

/* ---- what a set cannot see is told ---- */

static const char *blindness(int set, const char *content)
{
    struct world w = world_of("%sWorldBegin\n%s", integrator_text(set, 0, 1), content);
    const char *text = w.job.integrator.model->blind(w.job.integrator.self, w.job.scene);
    world_free(&w);
    return text;
}

TEST(strategies_tell_which_lights_they_cannot_find)
{
    static const char point_light[] = "LightSource \"point\"\n", area[] = GLOW "Shape \"disk\"\n",
                      dome[] = "LightSource \"infinite\"\n", invisible[] = GLOW "Shape \"disk\" \"float alpha\" 0\n";
    for (int i = 0; i < SET_COUNT; ++i) {
        EXPECT(!blindness(i, area) && !blindness(i, dome));
        EXPECT(!blindness(i, point_light) == has_choice(i));
        EXPECT(!blindness(i, invisible) == (strstr(sets[i], "area") || strstr(sets[i], "light")));
    }
}

TEST(strategies_that_do_not_exist_are_refused)
{
    static const char *const bad[] = {"", "bsdff", "bsdf+", "bsdf+bsdf", "+bsdf", "light"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        char path[512], text[256];
        snprintf(text, sizeof text, "Integrator \"estimator\" \"string strategies\" \"%s\"\nWorldBegin\n", bad[i]);
        snprintf(path, sizeof path, "%s/bad.pbrt", test_folder());
        struct sr_error error = {0};
        struct sr_log silent = {0};
        struct sr_import_options options = {0};
        struct sr_import_result scene;
        EXPECT(sr_file_write(path, text, strlen(text), &error) == SR_OK);
        EXPECT(sr_import_pbrt(path, &options, &scene, &silent, &error) == SR_ERROR_INPUT &&
               strstr(error.text, "strateg"));
    }
}
