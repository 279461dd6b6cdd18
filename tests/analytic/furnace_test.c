/* SPDX-License-Identifier: MIT */
/* The white furnace: under a uniform sky L = 1 all around, a surface shows its own albedo, neither more nor less.
 *
 *     L(wo) = integral f(wo, wi) |cos theta_i| dwi       over both sides, in the form for radiance
 *
 * The path tracer's answer against uniform directions and f alone, which share neither its sampling nor its weights;
 * smooth materials against Fresnel's formulas. The inside of a furnace is the rows D1. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)
#define CONSTANT(x) "[360 " x " 830 " x "]"

static struct drawn from_above(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)u, (void)v;
    double theta = *(const double *)context * DEGREE;
    sr_vec3 d = {(float)sin(theta), 0, (float)-cos(theta)};
    return (struct drawn){sr_scale(-0.5f, d), d, 1};
}

struct albedo {
    const struct sr_scene *scene;
    double theta;
    uint32_t n;
    double sums[REPLICATES];
};

static void albedo_replicate(void *context, uint64_t r)
{
    struct albedo *a = context;
    struct drawn d = from_above(&a->theta, (sr_vec2){0, 0}, (sr_vec2){0, 0});
    struct sr_ray ray = {.o = d.o, .d = d.d, .t_max = INFINITY};
    for (uint32_t i = 0; i < a->n; ++i) {
        struct sr_sampler sampler = sr_sampler_start(SR_SAMPLER_SOBOL, 77, 3, 3, (uint32_t)r, i);
        sr_u4 u = sr_sample4(&sampler, 9);
        struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, u[3]);
        struct sr_hit hit;
        struct sr_bsdf bsdf;
        struct sr_frame frame;
        if (!sr_raycast(a->scene, &ray, &hit))
            return;
        sr_material_shade(hit.material, &hit.point, sr_neg(ray.d), u[2], sr_hash_combine(i, (uint32_t)r), &w, &bsdf,
                          &frame);
        sr_vec3 wi = sr_warp_uniform_sphere((sr_vec2){u[0], u[1]});
        sr_spectrum f = sr_bsdf_f(&bsdf, sr_to_local(&frame, sr_neg(ray.d)), wi, SR_RADIANCE);
        a->sums[r] += (double)(f[0] * sr_abs_cos_theta(wi) * 4 * SR_PI) / a->n; // all wavelengths are alike here
    }
}

static void expect_albedo(const char *name, const char *material, double theta, double known)
{
    struct world w =
        world_of("Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nLightSource \"infinite\" \"float scale\" 1\n"
                 "%s Shape \"disk\" \"float radius\" 10\n",
                 material);
    bool is_walk = strstr(name, "coated") != NULL; // f is a random walk: dear, and with chance in it
    struct estimate L = mean_luminance(&w.job, from_above, &theta, is_walk ? 4096 : 16384), expected = {known, 0, 1};
    if (isnan(known)) {
        struct albedo a = {.scene = w.job.scene, .theta = theta, .n = samples(is_walk ? 8192 : 65536)};
        sr_parallel_for(sr_thread_count(), REPLICATES, albedo_replicate, &a);
        struct sr_tally tally = {0};
        for (int r = 0; r < REPLICATES; ++r)
            sr_tally_add(&tally, a.sums[r]);
        expected = (struct estimate){tally.mean, sr_tally_standard_error(&tally), REPLICATES - 1};
    }
    world_free(&w);
    double error = hypot(L.error, expected.error), z = (L.mean - expected.mean) / error;
    bool is_right = fabs(z) < 4.9 || fabs(L.mean - expected.mean) < FLOAT_GOAL * expected.mean;
    printf("  %-24s %2.0f deg  %.7f +- %.1e   albedo %.7f +- %.1e  z %6.2f%s\n", name, theta, L.mean, L.error,
           expected.mean, expected.error, z, is_right ? "" : "  WRONG");
    EXPECT(is_right);
    EXPECT(is_slow_build() || error < 5e-3 * expected.mean / sqrt(fmin(1, effort())));
    EXPECT(expected.mean < 1 + 5 * error + 1e-5);
}

TEST(a_furnace_shows_each_material_s_albedo)
{
#define ROUGH "\"float roughness\" 0.4 \"bool remaproughness\" false "
#define COAT "\"integer maxdepth\" 100 \"bool unbiased\" true "
#define METAL "\"spectrum conductor.eta\" " CONSTANT("0.43") " \"spectrum conductor.k\" " CONSTANT("2.455") " "
    static const struct {
        const char *name, *material;
    } rough[] = {
        {"diffuse", "Material \"diffuse\" \"spectrum reflectance\" " CONSTANT("0.7")},
        {"diffusetransmission", "Material \"diffusetransmission\" \"spectrum reflectance\" " CONSTANT(
                                    "0.3") " \"spectrum transmittance\" " CONSTANT("0.5")},
        {"conductor",
         "Material \"conductor\" \"spectrum eta\" " CONSTANT("0.43") " \"spectrum k\" " CONSTANT("2.455") " " ROUGH},
        {"dielectric", "Material \"dielectric\" \"float eta\" 1.5 " ROUGH},
        {"coateddiffuse smooth",
         "Material \"coateddiffuse\" \"spectrum reflectance\" " CONSTANT("0.8") " \"float thickness\" 1e-6 " COAT},
        {"coateddiffuse rough", "Material \"coateddiffuse\" \"spectrum reflectance\" " CONSTANT(
                                    "0.8") " \"float thickness\" 0.01 " COAT ROUGH},
        {"coatedconductor rough",
         "Material \"coatedconductor\" " METAL COAT
         "\"float interface.roughness\" 0.4 \"float conductor.roughness\" 0.5 \"bool remaproughness\" false"},
        {"mix", "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"spectrum reflectance\" " CONSTANT(
                    "0.2") " MakeNamedMaterial \"b\" \"string type\" \"diffusetransmission\" "
                           "\"spectrum reflectance\" " CONSTANT("0.6") " \"spectrum transmittance\" " CONSTANT(
                               "0.3") " Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.3"},
    };
    setvbuf(stdout, NULL, _IOLBF, 0);
    printf("white furnace: radiance of the path tracer, and the albedo from f alone\n");
    for (size_t i = 0; i < sizeof rough / sizeof rough[0]; ++i)
        for (int k = 0; k < 2; ++k) {
            double theta = k ? 60 : 20, known = NAN;
            if (strcmp(rough[i].name, "coateddiffuse smooth") == 0) {
                // the coat's mirror is a delta function, which f does not have: its part is known
                double r0 = (double)sr_fresnel_dielectric((float)cos(theta * DEGREE), 1.5f),
                       ri = 1 - (1 - sr_fresnel_diffuse(1.5)) / 2.25;
                known = r0 + (1 - r0) * 0.8 * (1 - ri) / (1 - 0.8 * ri);
            }
            expect_albedo(rough[i].name, rough[i].material, theta, known);
        }
    for (int k = 0; k < 2; ++k) {
        double theta = k ? 60 : 20;
        float c = (float)cos(theta * DEGREE);
        double R = (double)sr_fresnel_dielectric(c, 1.5f);
        expect_albedo("dielectric smooth", "Material \"dielectric\" \"float eta\" 1.5", theta, R + (1 - R) / 2.25);
        expect_albedo("thindielectric", "Material \"thindielectric\" \"float eta\" 1.5", theta, 1);
        expect_albedo("conductor smooth",
                      "Material \"conductor\" \"spectrum eta\" " CONSTANT("0.43") " \"spectrum k\" " CONSTANT("2.455"),
                      theta, (double)sr_fresnel_conductor(c, SR_BLACK + 0.43f, SR_BLACK + 2.455f)[0]);
    }
}
