/* SPDX-License-Identifier: MIT */
/* Rays that leave lights: flux against closed forms and against `power`, densities against counts, radiance against Le.
 */
#include "scenery.h"

enum { RAYS = 200000, COS_CELLS = 8, PHI_CELLS = 16 };

struct case_of {
    const char *name;
    struct sr_light light;
    double flux; // [lm]
    sr_vec3 n;   // of a flat light's surface, for its density; 0: of none
    bool is_delta_direction;
    double flux_error; // [1] relative, of the light's own tables
};

static double luminous(sr_spectrum L, const struct sr_wavelengths *w)
{
    return (double)sr_spectrum_to_xyz(L, w).y;
}

static void check(struct case_of c)
{
    struct sr_rng rng = sr_rng_seed(11, 3);
    struct sr_tally flux = {0};
    static double observed[COS_CELLS * PHI_CELLS], expected[COS_CELLS * PHI_CELLS];
    memset(observed, 0, sizeof observed);
    memset(expected, 0, sizeof expected);
    double lost = 0;
    for (int i = 0; i < RAYS; ++i) {
        struct sr_wavelengths w =
            sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, sr_rng_float(&rng));
        sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)}, v = {sr_rng_float(&rng), sr_rng_float(&rng)};
        struct sr_light_ray r;
        if (!c.light.model->emit(c.light.self, u, v, &w, &r)) {
            sr_tally_add(&flux, 0);
            lost += 1;
            continue;
        }
        EXPECT_NEAR(sr_length(r.w), 1, 1e-5);
        bool has_surface = sr_length2(r.from.n) > 0;
        double cosine = has_surface ? fabs((double)sr_dot(r.from.n, r.w)) : 1;
        sr_tally_add(&flux, luminous(r.L, &w) * cosine / ((double)r.pdf_area * (double)r.pdf_direction));
        float pdf_area, pdf_direction;
        c.light.model->emit_pdf(c.light.self, r.from.n, r.w, &pdf_area, &pdf_direction);
        if (pdf_direction > 1e-4f)
            EXPECT_RELATIVE(pdf_direction, r.pdf_direction, 1e-3);
        if (!c.light.model->is_delta) {
            sr_spectrum Le = c.light.model->Le(c.light.self, has_surface ? &r.from : NULL, r.w, &w);
            EXPECT(!sr_spectrum_any(sr_spectrum_abs(Le - r.L) > 1e-4f * sr_spectrum_max(Le)) ||
                   c.light.model->is_infinite);
        }
        int a = (int)((r.w.z + 1) / 2 * COS_CELLS), b = (int)(sr_angle_of(r.w.y, r.w.x) / (2 * SR_PI) * PHI_CELLS);
        observed[(a < COS_CELLS ? a : COS_CELLS - 1) * PHI_CELLS + (b < PHI_CELLS ? b : PHI_CELLS - 1)] += 1;
    }
    double se = sr_tally_standard_error(&flux);
    printf("    %-28s %.5g lm +- %.1g, known %.5g lm\n", c.name, flux.mean, se, c.flux);
    EXPECT(fabs(flux.mean - c.flux) < 4.9 * se + (c.flux_error + 1e-4) * c.flux);
    if (c.is_delta_direction || lost > 0)
        return;
    enum { FINE = 48 }; // of each cell's side
    for (int a = 0; a < COS_CELLS * FINE; ++a)
        for (int b = 0; b < PHI_CELLS * FINE; ++b) {
            float z = ((float)a + 0.5f) / (COS_CELLS * FINE) * 2 - 1,
                  phi = ((float)b + 0.5f) / (PHI_CELLS * FINE) * 2 * SR_PI, pdf_area, pdf;
            c.light.model->emit_pdf(c.light.self, c.n, sr_spherical_direction(sqrtf(1 - z * z), z, phi), &pdf_area,
                                    &pdf);
            expected[a / FINE * PHI_CELLS + b / FINE] +=
                (double)pdf * 4 * (double)SR_PI / (COS_CELLS * PHI_CELLS * FINE * FINE) * RAYS;
        }
    EXPECT_CHI2(observed, expected, COS_CELLS * PHI_CELLS);
}

static struct sr_light area_light(const char *shape, const struct sr_light_emission *e, struct sr_transform t,
                                  sr_vec3 *n)
{
    const struct sr_shape_model *model = sr_shape_model_find(shape);
    struct sr_error error = {0};
    char *self = sr_arena_alloc(&scenery_arena, model->size);
    for (const struct sr_param *p = model->params; p->name; ++p)
        if (p->kind == SR_PARAM_FLOAT)
            *(float *)(void *)(self + p->offset) = (float)p->initial;
    static const sr_vec3 P[4] = {{-.5f, -.3f, 0}, {.6f, -.3f, .1f}, {-.5f, .4f, 0}, {.6f, .4f, .1f}};
    static const int32_t quad[] = {0, 1, 2, 3}, triangle[] = {0, 1, 2};
    if (model == &sr_shape_bilinearmesh)
        *(struct sr_shape_patches *)(void *)self = (struct sr_shape_patches){.P = {P, 4}, .indices = {quad, 4}};
    if (model == &sr_shape_trianglemesh)
        *(struct sr_shape_mesh *)(void *)self = (struct sr_shape_mesh){.P = {P, 4}, .indices = {triangle, 3}};
    struct sr_shape_placement placement = {.object_to_world = t};
    if (model->prepare(self, &placement, &scenery_arena, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_light_area *a = sr_arena_alloc(&scenery_arena, sizeof *a);
    *a = sr_light_area_of((struct sr_shape){model, self}, 0, e, false);
    struct sr_shape_sample s;
    EXPECT(model->sample(self, 0, NULL, (sr_vec2){.5f, .5f}, &s));
    *n = s.n;
    return (struct sr_light){&sr_light_area, a};
}

TEST(flux_that_leaves_is_the_power_of_the_light)
{
    struct sr_error error = {0};
    const struct sr_light_model *m = sr_light_model_find("point");
    void *self = scenery_new(m);
    SCENERY_FLOAT(m, self, "power", 300);
    check((struct case_of){.name = "point", .light = scenery_finish(m, self), .flux = 300});
    m = sr_light_model_find("spot");
    for (int soft = 0; soft < 2; ++soft) {
        self = scenery_new(m);
        SCENERY_FLOAT(m, self, "scale", 7);
        SCENERY_FLOAT(m, self, "coneangle", 50);
        SCENERY_FLOAT(m, self, "conedeltaangle", soft ? 40 : 5);
        SCENERY_POINT(m, self, "to", 1, 2, 3);
        double c50 = cos(50 * acos(-1) / 180), c10 = cos((soft ? 10 : 45) * acos(-1) / 180);
        check((struct case_of){.name = soft ? "spot, soft rim" : "spot",
                               .light = scenery_finish(m, self),
                               .flux = 2 * acos(-1) * 7 * (1 - (c10 + c50) / 2)});
    }
    m = sr_light_model_find("distant"); // the scene's sphere has the radius 2
    self = scenery_new(m);
    SCENERY_FLOAT(m, self, "illuminance", 5);
    SCENERY_POINT(m, self, "from", 1, 1, 1);
    check((struct case_of){
        .name = "distant", .light = scenery_finish(m, self), .flux = acos(-1) * 4 * 5, .is_delta_direction = true});
    m = sr_light_model_find("infinite");
    self = scenery_new(m);
    SCENERY_FLOAT(m, self, "scale", 3);
    check((struct case_of){
        .name = "infinite", .light = scenery_finish(m, self), .flux = 4 * acos(-1) * acos(-1) * 4 * 3});

    for (int two_sided = 0; two_sided < 2; ++two_sided) {
        struct sr_light_emission e = {.L = {.kind = SR_SPD_NONE}, .scale = 2, .power = NAN, .two_sided = two_sided};
        EXPECT(sr_light_emission_prepare(&e, 1, &scenery_arena, &error) == SR_OK);
        struct sr_transform t = sr_transform_rotate(40, (sr_vec3){1, 2, 3}),
                            stretch = sr_transform_scale((sr_vec3){1, 2, .5f});
        struct sr_transform both = sr_transform_multiply(&t, &stretch);
        static const char *const names[] = {"sphere", "disk", "cylinder", "trianglemesh", "bilinearmesh"};
        for (int i = 0; i < 5; ++i) {
            sr_vec3 n;
            struct sr_light light = area_light(names[i], &e, i < 3 ? both : t, &n);
            double area = (double)((const struct sr_light_area *)light.self)->area, sides = two_sided ? 2 : 1;
            bool is_flat = i == 1 || i == 3 || i == 4;
            check((struct case_of){.name = names[i],
                                   .light = light,
                                   .flux = acos(-1) * area * 2 * sides,
                                   .n = n,
                                   .is_delta_direction = !is_flat,
                                   .flux_error = 1e-4});
            EXPECT_RELATIVE(light.model->power(light.self), acos(-1) * area * 2 * sides, 1e-4);
        }
    }
}

TEST(flux_of_an_environment_image_is_its_mean)
{
    enum { SIDE = 16 };
    static float texels[SIDE * SIDE * 3];
    for (int i = 0; i < SIDE * SIDE * 3; ++i)
        texels[i] = i / 3 == 70 ? 40 : (float)(i / 3 % 5) * .2f; // a sun, and texels that are dark
    const struct sr_light_model *m = sr_light_model_find("infinite");
    void *self = scenery_new(m);
    struct sr_light_common *common = self;
    common->texels =
        (struct sr_texels){.width = SIDE, .height = SIDE, .channels = 3, .floats = texels, .space = SR_SRGB};
    common->light_to_world = sr_transform_rotate(50, (sr_vec3){1, 1, 0});
    struct sr_light light = scenery_finish(m, self);
    check((struct case_of){
        .name = "infinite, image", .light = light, .flux = (double)light.model->power(light.self), .flux_error = 5e-3});
}

TEST(flux_of_a_light_that_throws_an_image_is_that_of_its_texels)
{
    enum { SIDE = 12 };
    static float texels[SIDE * SIDE * 3];
    for (int i = 0; i < SIDE * SIDE * 3; ++i)
        texels[i] = i / 3 == 70 ? 10 : (float)(i / 3 % 5) * .2f; // a beam, and texels that are dark
    static const char *const names[] = {"goniometric", "projection"};
    for (int k = 0; k < 4; ++k) {
        const struct sr_light_model *m = sr_light_model_find(names[k / 2]);
        void *self = scenery_new(m);
        struct sr_light_common *common = self;
        common->texels =
            (struct sr_texels){.width = SIDE, .height = SIDE, .channels = 3, .floats = texels, .space = SR_SRGB};
        common->light_to_world = sr_transform_rotate(k == 2 ? 0 : 50, (sr_vec3){1, 1, 0});
        struct sr_transform stretch = sr_transform_scale((sr_vec3){1, 2, -1});
        if (k % 2)
            common->light_to_world = sr_transform_multiply(&common->light_to_world, &stretch);
        scenery_set(m, self, "filename", &(const char *){"image.exr"}, sizeof(char *));
        struct sr_light light = scenery_finish(m, self);
        double flux = (double)light.model->power(light.self);
        if (k % 2) { // squeezed directions: by quadrature over the sphere
            flux = 0;
            enum { N = 120 };
            for (int i = 0; i < N * N; ++i) {
                sr_vec3 d =
                    sr_equal_area_square_to_sphere((sr_vec2){((float)(i % N) + .5f) / N, ((float)(i / N) + .5f) / N});
                struct sr_point x = {.p = sr_add(d, sr_transform_point(&common->light_to_world, (sr_vec3){0, 0, 0}))};
                struct sr_light_sample s;
                for (int g = 0; g < SCENERY_GROUPS; ++g) {
                    struct sr_wavelengths w = scenery_wavelengths(g);
                    if (sr_light_draw(light, &x, (sr_vec2){.5f, .5f}, &w, &s))
                        flux += 4 * acos(-1) / (N * N) * scenery_luminous(s.L, &w);
                }
            }
        }
        check((struct case_of){.name = names[k / 2],
                               .light = light,
                               .flux = flux,
                               .flux_error = k % 2 ? 2e-2 : 5e-3,
                               .is_delta_direction = k == 3}); // its corners touch cells between the points of the grid
    }
}

TEST(lights_begin_paths_by_their_power)
{
    struct sr_error error = {0};
    struct sr_light lights[3];
    const double power[3] = {10, 0, 30};
    for (int i = 0; i < 3; ++i) {
        const struct sr_light_model *m = sr_light_model_find(i == 2 ? "spot" : "point");
        void *self = scenery_new(m);
        SCENERY_FLOAT(m, self, power[i] > 0 ? "power" : "scale", (float)power[i]);
        lights[i] = scenery_finish(m, self);
    }
    struct sr_lights all;
    EXPECT(sr_lights_build(&scenery_arena, lights, 3, SR_LIGHTS_BVH, &all, &error) == SR_OK);
    struct sr_rng rng = sr_rng_seed(5, 5);
    double observed[3] = {0}, expected[3] = {.25 * RAYS, 0, .75 * RAYS};
    for (int i = 0; i < RAYS; ++i) {
        struct sr_wavelengths w =
            sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, sr_rng_float(&rng));
        struct sr_light_ray r;
        EXPECT(sr_lights_emit(&all, sr_rng_float(&rng), (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)},
                              (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &r));
        EXPECT_RELATIVE(r.pmf, r.light == 0 ? .25 : .75, 1e-5);
        EXPECT(r.pmf == sr_lights_emit_pmf(&all, r.light));
        observed[r.light] += 1;
    }
    EXPECT_CHI2(observed, expected, 3);
    EXPECT(sr_lights_emit_pmf(&all, 1) == 0);
}
