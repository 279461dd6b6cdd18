/* SPDX-License-Identifier: MIT */
/* How large a pixel is on a surface: a square of s by s [rad^2] at distance r covers s^2 r^2 / |cos theta| of it. */
#include "integrator/integrator.h"
#include "test.h"

static const float s = 2e-4f; // [rad]

static struct sr_path_start start_toward(sr_vec3 d)
{
    struct sr_frame f = sr_frame_from_z(sr_normalize(d));
    return (struct sr_path_start){
        .ray = {.o = {1, 2, 3}, .d = f.z, .t_max = INFINITY}, .dddx = sr_scale(s, f.x), .dddy = sr_scale(s, f.y)};
}

static struct sr_point point_at(sr_vec3 p, sr_vec3 n)
{
    struct sr_frame f = sr_frame_from_z(sr_normalize(n));
    return (struct sr_point){.p = p, .n = f.z, .ns = f.z, .dpdu = f.x, .dpdv = f.y, .dpdus = f.x};
}

static void expect_area(const struct sr_point *x, sr_vec3 o)
{
    sr_vec3 way = sr_sub(x->p, o);
    float r = sr_length(way), cosine = fabsf(sr_dot(way, x->n)) / r, expected = s * s * r * r / cosine;
    EXPECT_NEAR(sr_length(sr_cross(x->dpdx, x->dpdy)), expected, 0.01 * (double)expected);
    EXPECT_NEAR(fabsf(x->dudx * x->dvdy - x->dudy * x->dvdx), expected, 0.01 * (double)expected); // |dpdu x dpdv| = 1
    EXPECT_NEAR(sr_dot(x->dpdx, x->n), 0, 1e-2 * (double)r * (double)s);
}

TEST(the_first_surface_has_the_footprint_of_its_pixel)
{
    struct sr_path_start start = start_toward((sr_vec3){0.3f, -0.2f, 1});
    struct sr_point x = point_at(sr_mad(start.ray.o, 7, start.ray.d), (sr_vec3){0.5f, 0.1f, -1}), again = x;
    sr_first_footprint(&start, &x);
    expect_area(&x, start.ray.o);
    sr_seen_footprint(&start, &again);
    EXPECT_NEAR(sr_length(sr_sub(again.dpdx, x.dpdx)), 0, 1e-6);
    EXPECT_NEAR(sr_length(sr_sub(again.dpdy, x.dpdy)), 0, 1e-6);
}

TEST(a_later_surface_has_the_footprint_of_a_pixel_that_sees_it_straight_on)
{
    struct sr_path_start start = start_toward((sr_vec3){0.3f, -0.2f, 1});
    sr_vec3 behind = sr_mad(start.ray.o, -4, start.ray.d); // no rotation is the smallest one
    const sr_vec3 places[] = {{4, 5, 6}, {-3, 2, 1}, {1, 2, -9}, {1, 30, 3}, behind};
    for (int i = 0; i < 5; ++i) {
        struct sr_point x = point_at(places[i], (sr_vec3){0.9f, 0.4f, -1});
        sr_seen_footprint(&start, &x);
        expect_area(&x, start.ray.o);
    }
}

TEST(a_surface_at_the_eye_has_a_finite_footprint)
{
    struct sr_path_start start = start_toward((sr_vec3){0, 0, 1});
    struct sr_point x = point_at(start.ray.o, (sr_vec3){0, 0, 1});
    sr_seen_footprint(&start, &x);
    EXPECT(isfinite(sr_length(x.dpdx)) && isfinite(x.dudx));
}
