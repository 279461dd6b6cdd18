/* SPDX-License-Identifier: MIT */
#include "make.h"

static struct sr_point point_at(sr_vec3 p)
{
    return (struct sr_point){.p = p, .dpdx = {0.3f, -0.2f, 0.1f}, .dpdy = {-0.1f, 0.25f, 0.4f}};
}

// the derivative is the limit of the difference: here a central one over 2 h, error O(h^2)
static void expect_derivatives(const struct sr_mapping *m, struct sr_point x)
{
    const float h = 2e-3f;
    struct sr_mapped f = sr_mapping_apply(m, &x);
    for (int axis = 0; axis < 2; ++axis) {
        sr_vec3 d = axis == 0 ? x.dpdx : x.dpdy;
        struct sr_point ahead = x, behind = x;
        ahead.p = sr_mad(x.p, h, d);
        behind.p = sr_mad(x.p, -h, d);
        sr_vec2 a = sr_mapping_apply(m, &ahead).st, b = sr_mapping_apply(m, &behind).st;
        EXPECT_NEAR(axis == 0 ? f.dsdx : f.dsdy, (a.x - b.x) / (2 * h), 2e-4);
        EXPECT_NEAR(axis == 0 ? f.dtdx : f.dtdy, (a.y - b.y) / (2 * h), 2e-4);
    }
}

TEST(uv_mapping_scales_and_shifts)
{
    struct sr_mapping m = {.uscale = 3, .vscale = -2, .udelta = 0.5f, .vdelta = 0.25f};
    struct sr_point x = {.uv = {0.5f, 0.75f}, .dudx = 1, .dudy = 2, .dvdx = 3, .dvdy = 4};
    struct sr_mapped f = sr_mapping_apply(&m, &x);
    EXPECT_NEAR(f.st.x, 2, 1e-7);
    EXPECT_NEAR(f.st.y, -1.25, 1e-7);
    EXPECT_NEAR(f.dsdx, 3, 0);
    EXPECT_NEAR(f.dsdy, 6, 0);
    EXPECT_NEAR(f.dtdx, -6, 0);
    EXPECT_NEAR(f.dtdy, -8, 0);
}

TEST(spherical_mapping_gives_the_angles_as_shares_of_pi_and_two_pi)
{
    struct sr_mapping m = {.kind = SR_MAPPING_SPHERICAL, .world_to_texture = sr_transform_identity()};
    struct sr_point x = point_at((sr_vec3){0, -2, 2}); // theta = pi / 4, phi = 3 pi / 2
    struct sr_mapped f = sr_mapping_apply(&m, &x);
    EXPECT_NEAR(f.st.x, 0.25, 1e-6);
    EXPECT_NEAR(f.st.y, 0.75, 1e-6);
    x = point_at((sr_vec3){0, 0, 3}); // the pole: no footprint, and no NaN
    f = sr_mapping_apply(&m, &x);
    EXPECT_NEAR(f.dsdx, 0, 0);
    EXPECT_NEAR(f.dtdy, 0, 0);
}

TEST(cylindrical_mapping_counts_the_angle_from_minus_x_and_the_height_in_metres)
{
    struct sr_mapping m = {.kind = SR_MAPPING_CYLINDRICAL, .world_to_texture = sr_transform_identity()};
    struct sr_point x = point_at((sr_vec3){0, 5, -1.5f}); // atan2 = pi / 2
    struct sr_mapped f = sr_mapping_apply(&m, &x);
    EXPECT_NEAR(f.st.x, 0.75, 1e-6);
    EXPECT_NEAR(f.st.y, -1.5, 1e-6);
}

TEST(planar_mapping_projects_on_its_axes)
{
    struct sr_mapping m = {.kind = SR_MAPPING_PLANAR,
                           .udelta = 1,
                           .vdelta = 2,
                           .v1 = {1, 2, 3},
                           .v2 = {0, 1, 0},
                           .world_to_texture = sr_transform_translate((sr_vec3){1, 0, 0})};
    struct sr_point x = point_at((sr_vec3){1, 1, 1});
    struct sr_mapped f = sr_mapping_apply(&m, &x);
    EXPECT_NEAR(f.st.x, 1 + 2 + 2 + 3, 1e-6);
    EXPECT_NEAR(f.st.y, 3, 1e-6);
}

TEST(derivatives_of_all_mappings_agree_with_differences)
{
    struct sr_transform turn = sr_transform_rotate(35, (sr_vec3){1, 2, 3}),
                        stretch = sr_transform_scale((sr_vec3){1, 2, 0.5f});
    for (int kind = SR_MAPPING_SPHERICAL; kind <= SR_MAPPING_PLANAR; ++kind) {
        struct sr_mapping m = {.kind = kind,
                               .v1 = {1, 0.5f, 2},
                               .v2 = {0, 1, -1},
                               .world_to_texture = sr_transform_multiply(&turn, &stretch)};
        expect_derivatives(&m, point_at((sr_vec3){1, 2, 0.5f}));
        expect_derivatives(&m, point_at((sr_vec3){-1.2f, 0.8f, 1.5f}));
    }
}
