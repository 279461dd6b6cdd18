/* SPDX-License-Identifier: MIT */
/* Triangles, parallelograms and spheres as the room of lights draws them itself where they look small: against the
 * closed forms of their solid angle and irradiance, and against their own densities.
 *
 *     polygon (J. H. Lambert 1760):  E = L / 2 SUM over edges  angle(v_i, v_i+1) n . unit(v_i x v_i+1)       [lx]
 *     sphere straight ahead:         E = pi L (R / d)^2,   Omega = 2 pi (1 - sqrt(1 - (R / d)^2))            [sr] */
#include "scenery.h"

static const double pi = 3.14159265358979323846;

static double polygon_E(const sr_vec3 *v, int n, sr_vec3 p, sr_vec3 normal)
{
    double E = 0;
    for (int i = 0; i < n; ++i) {
        sr_vec3 a = sr_normalize(sr_sub(v[i], p)), b = sr_normalize(sr_sub(v[(i + 1) % n], p));
        E += 0.5 * (double)sr_angle_between(a, b) * (double)sr_dot(normal, sr_normalize(sr_cross(a, b)));
    }
    return fabs(E);
}

/* What draws from a light say: mean of 1 / pdf (its solid angle) and of cos / pdf, and that pdf agrees with each draw.
 */
static void draw(struct sr_light light, const struct sr_point *x, struct sr_tally *solid_angle, struct sr_tally *E)
{
    struct sr_wavelengths w = scenery_wavelengths(20);
    struct sr_rng rng = sr_rng_seed(4, 1);
    for (int i = 0; i < 20000; ++i) {
        struct sr_light_sample s;
        sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
        if (!sr_light_draw(light, x, u, &w, &s)) {
            test_fail(__FILE__, __LINE__, "nothing drawn");
            return;
        }
        sr_tally_add(solid_angle, 1 / (double)s.pdf);
        sr_tally_add(E, (double)(s.L[3] / s.pdf) * (double)sr_dot(s.wi, x->n));
        struct sr_point there = {.p = s.p, .n = sr_neg(s.wi)};
        const struct sr_light_area *m = light.self;
        if (m->kind == SR_LIGHT_FLAT)
            there.n = m->flat.n;
        EXPECT_RELATIVE(light.model->pdf(light.self, x, s.wi, &there), (double)s.pdf, 1e-4);
        EXPECT_RELATIVE(s.distance, (double)sr_length(sr_sub(s.p, x->p)), 1e-5);
    }
}

static struct sr_light glowing(struct sr_shape shape, uint32_t primitive, const struct sr_light_emission *e)
{
    struct sr_light_area *m = sr_arena_alloc(&scenery_arena, sizeof *m);
    *m = sr_light_area_of(shape, primitive, e, false);
    return (struct sr_light){&sr_light_area, m};
}

static struct sr_light_emission shining(void)
{
    struct sr_light_emission e = scenery_emission();
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 1, &scenery_arena, &error) == SR_OK);
    return e;
}

static double radiance(const struct sr_light_emission *e)
{
    struct sr_wavelengths w = scenery_wavelengths(20);
    return (double)sr_spd_eval(&e->emitted, w.lambda)[3];
}

static const struct sr_shape_placement in_place = {
    .object_to_world = {.m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}},
                        .inverse = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}};

TEST(a_small_triangle_and_a_joined_parallelogram_give_lamberts_illuminance)
{
    // wound so that below is outside
    sr_vec3 P[4] = {{0, 0, 3}, {0.3f, 1, 3.2f}, {1.2f, 1.1f, 3.1f}, {0.9f, 0.1f, 2.9f}};
    int32_t indices[6] = {0, 1, 2, 0, 2, 3};
    struct sr_shape_mesh mesh = {.indices = {indices, 6}, .P = {P, 4}};
    struct sr_shape_patches joined;
    struct sr_error error = {0};
    EXPECT(sr_shape_trianglemesh.prepare(&mesh, &in_place, &scenery_arena, &error) == SR_OK);
    EXPECT(sr_shape_join_triangles(&mesh, &scenery_arena, &joined, &error));
    struct sr_light_emission e = shining();
    struct sr_light half = glowing((struct sr_shape){&sr_shape_trianglemesh, &mesh}, 0, &e),
                    whole = glowing((struct sr_shape){&sr_shape_bilinearmesh, &joined}, 0, &e);
    EXPECT(((const struct sr_light_area *)half.self)->kind == SR_LIGHT_FLAT);
    EXPECT(((const struct sr_light_area *)whole.self)->kind == SR_LIGHT_FLAT);
    struct sr_point x = {.n = {0, 0, 1}, .ns = {0, 0, 1}};
    struct sr_tally omega = {0}, E = {0}, omega2 = {0}, E2 = {0};
    draw(half, &x, &omega, &E);
    draw(whole, &x, &omega2, &E2);
    sr_vec3 v[4];
    for (int i = 0; i < 4; ++i)
        v[i] = sr_normalize(P[i]);
    double first = sr_spherical_triangle_area(v[0], v[1], v[2]), second = sr_spherical_triangle_area(v[0], v[2], v[3]);
    EXPECT_MEAN(omega, first);
    EXPECT_MEAN(omega2, first + second);
    EXPECT_MEAN(E, radiance(&e) * polygon_E(P, 3, x.p, x.n));
    EXPECT_MEAN(E2, radiance(&e) * polygon_E(P, 4, x.p, x.n));

    struct sr_wavelengths w = scenery_wavelengths(20);
    struct sr_light_sample s;
    struct sr_point above = {.p = {0.5f, 0.5f, 9}, .n = {0, 0, -1}, .ns = {0, 0, -1}};
    EXPECT(!sr_light_draw(half, &above, (sr_vec2){0.4f, 0.6f}, &w, &s)); // the back is dark
    EXPECT(!sr_light_draw(whole, &above, (sr_vec2){0.4f, 0.6f}, &w, &s));
}

TEST(only_halves_of_parallelograms_are_joined)
{
    struct sr_error error = {0};
    struct sr_shape_patches joined;
    sr_vec3 P[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1.01f, 0}};
    int32_t indices[6] = {0, 1, 2, 0, 2, 3}, other_way[6] = {0, 1, 2, 0, 3, 2};
    struct sr_shape_mesh crooked = {.indices = {indices, 6}, .P = {P, 4}};
    EXPECT(!sr_shape_join_triangles(&crooked, &scenery_arena, &joined, &error));
    P[3].y = 1;
    struct sr_shape_mesh square = crooked, turned = {.indices = {other_way, 6}, .P = {P, 4}},
                         single = {.indices = {indices, 3}, .P = {P, 4}};
    EXPECT(sr_shape_join_triangles(&square, &scenery_arena, &joined, &error));
    EXPECT_RELATIVE(sr_shape_bilinearmesh.area(&joined, 0), 1, 1e-6);
    EXPECT(!sr_shape_join_triangles(&turned, &scenery_arena, &joined, &error)); // outside is not on one side
    EXPECT(!sr_shape_join_triangles(&single, &scenery_arena, &joined, &error));
}

TEST(a_sphere_drawn_by_its_cone_gives_pi_L_sine_squared)
{
    struct sr_light_emission e = shining();
    for (int k = 0; k < 4; ++k) {
        float radius = (float[]){0.001f, 0.1f, 1, 2.9f}[k];
        struct sr_shape_sphere sphere = {.radius = radius, .z_min = NAN, .z_max = NAN, .phi_max = 360};
        struct sr_shape_placement up = in_place;
        up.object_to_world = sr_transform_translate((sr_vec3){0, 0, 3});
        struct sr_error error = {0};
        EXPECT(sr_shape_sphere.prepare(&sphere, &up, &scenery_arena, &error) == SR_OK);
        struct sr_light light = glowing((struct sr_shape){&sr_shape_sphere, &sphere}, 0, &e);
        EXPECT(((const struct sr_light_area *)light.self)->kind == SR_LIGHT_ROUND);
        struct sr_point x = {.n = {0, 0, 1}, .ns = {0, 0, 1}};
        struct sr_tally omega = {0}, E = {0};
        draw(light, &x, &omega, &E);
        double s2 = (double)radius * (double)radius / 9;
        EXPECT_RELATIVE(omega.mean, 2 * pi * s2 / (1 + sqrt(1 - s2)), 1e-5); // the density is constant
        if (k > 0)
            EXPECT_MEAN(E, radiance(&e) * pi * s2);
        else
            EXPECT_RELATIVE(E.mean, radiance(&e) * pi * s2, 1e-5); // hardly any deviation but rounding
    }
}
