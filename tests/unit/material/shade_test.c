/* SPDX-License-Identifier: MIT */
/* Frames, bump maps, normal maps. */
#include "make.h"

static void expect_direction(sr_vec3 v, sr_vec3 expected, double tolerance)
{
    expected = sr_normalize(expected);
    EXPECT_NEAR(v.x, expected.x, tolerance);
    EXPECT_NEAR(v.y, expected.y, tolerance);
    EXPECT_NEAR(v.z, expected.z, tolerance);
}

static void expect_orthonormal(const struct sr_frame *f)
{
    EXPECT_NEAR(sr_length(f->x), 1, 1e-6);
    EXPECT_NEAR(sr_length(f->y), 1, 1e-6);
    EXPECT_NEAR(sr_dot(f->x, f->z), 0, 1e-6);
    EXPECT_NEAR(sr_dot(f->y, f->z), 0, 1e-6);
    EXPECT_NEAR(sr_dot(sr_cross(f->x, f->y), f->z), 1, 1e-6);
}

TEST(the_frame_has_the_shading_normal_for_z_and_the_tangent_for_x)
{
    struct made m = make("diffuse");
    struct sr_material material = made_material(&m);
    struct sr_point x = point();
    x.ns = sr_normalize((sr_vec3){0.2f, 0.3f, 1});
    x.dpdus = (sr_vec3){5, 1, 0.4f};
    struct shaded s = shade(&material, x, 0);
    expect_orthonormal(&s.frame);
    expect_direction(s.frame.z, x.ns, 1e-6);
    EXPECT(sr_dot(s.frame.x, x.dpdus) > 0);
    EXPECT_NEAR(sr_dot(s.frame.y, x.dpdus), 0, 1e-5);
    x.dpdus = (sr_vec3){0, 0, 0}; // no tangent: any frame will do
    s = shade(&material, x, 0);
    expect_orthonormal(&s.frame);
    sr_arena_free(&m.arena);
}

/* z = d(u, v) with x = 2 u, y = 3 v has the normal (-d_u / 2, -d_v / 3, 1), exactly where d is linear. */
TEST(a_linear_displacement_tilts_the_normal_exactly)
{
    struct made m = make("diffuse");
    struct sr_material material = made_material(&m);
    material.displacement = ramp(&m.arena, 0.1f, 0.5f, -0.9f);
    struct sr_point x = point();
    struct shaded s = shade(&material, x, 0);
    expect_direction(s.x.ns, (sr_vec3){-0.25f, 0.3f, 1}, 2e-4); // differences over 0.0005 lose digits
    x.dudx = 0.25f, x.dvdy = -0.5f;
    s = shade(&material, x, 0);
    expect_direction(s.x.ns, (sr_vec3){-0.25f, 0.3f, 1}, 1e-6);
    expect_direction(s.frame.z, (sr_vec3){-0.25f, 0.3f, 1}, 1e-6);
    expect_direction(s.frame.x, (sr_vec3){2, 0, 0.5f}, 1e-6);
    expect_orthonormal(&s.frame);

    // seen as the inside of something: n below. The bump still rises along n
    x.n = x.ns = (sr_vec3){0, 0, -1};
    s = shade(&material, x, 0);
    expect_direction(s.x.ns, (sr_vec3){-0.25f, 0.3f, -1}, 1e-6);
    sr_arena_free(&m.arena);
}

/* On a sphere dn/du = dp/du / r: a constant displacement only makes it larger. */
TEST(a_constant_displacement_of_a_sphere_turns_nothing)
{
    struct made m = make("diffuse");
    struct sr_material material = made_material(&m);
    material.displacement = sr_texture_constant_float(&m.arena, 0.3f);
    struct sr_point x = point();
    x.dndu = sr_scale(1 / 1.5f, x.dpdu);
    x.dndv = sr_scale(1 / 1.5f, x.dpdv);
    struct shaded s = shade(&material, x, 0);
    expect_direction(s.x.ns, (sr_vec3){0, 0, 1}, 1e-7);
    EXPECT_NEAR(s.x.dpdus.x, 2 * (1 + 0.3 / 1.5), 1e-6);
    sr_arena_free(&m.arena);
}

TEST(a_normal_map_of_128_128_255_turns_nothing_but_by_its_quantisation)
{
    static const uint8_t flat[3] = {128, 128, 255};
    static float decode[256]; // all zero: it must not be used, normals are numbers
    struct made m = make("diffuse");
    struct sr_material material = made_material(&m);
    material.normal_map = (struct sr_texels){.width = 1, .height = 1, .channels = 3, .bytes = flat, .decode = decode};
    struct sr_point x = point();
    x.ns = sr_normalize((sr_vec3){0.1f, -0.2f, 1});
    struct shaded s = shade(&material, x, 0);
    EXPECT_NEAR(sr_angle_between(s.x.ns, x.ns), sqrt(2) / 255, 1e-4); // 2 * 128/255 - 1 = 1/255 in each of x and y
    expect_orthonormal(&s.frame);
    EXPECT_NEAR(sr_length(s.x.dpdus), 2, 1e-5);
    sr_arena_free(&m.arena);
}

TEST(a_normal_map_is_read_in_the_frame_of_the_tangent_with_v_upward)
{
    // the upper texel leans to +tangent, the lower to -bitangent
    static const float map[6] = {0.8f, 0.5f, 0.9f, 0.5f, 0.2f, 0.9f};
    struct made m = make("diffuse");
    struct sr_material material = made_material(&m);
    material.normal_map = (struct sr_texels){.width = 1, .height = 2, .channels = 3, .floats = map};
    struct sr_point x = point();
    x.dpdu = x.dpdus = (sr_vec3){0, 2, 0}; // tangent y, bitangent z cross y = -x
    x.dpdv = (sr_vec3){-2, 0, 0};
    x.uv.y = 0.75f;
    expect_direction(shade(&material, x, 0).x.ns, (sr_vec3){0, 0.6f, 0.8f}, 1e-6);
    x.uv.y = 0.25f;
    expect_direction(shade(&material, x, 0).x.ns, (sr_vec3){0.6f, 0, 0.8f}, 1e-6);
    x.uv.y = 0.5f; // between: the mean, normalised
    expect_direction(shade(&material, x, 0).x.ns, (sr_vec3){0.3f, 0.3f, 0.8f}, 1e-6);
    x.uv = (sr_vec2){-7.3f, 3.75f}; // repeated
    expect_direction(shade(&material, x, 0).x.ns, (sr_vec3){0, 0.6f, 0.8f}, 1e-5);
    sr_arena_free(&m.arena);
}
