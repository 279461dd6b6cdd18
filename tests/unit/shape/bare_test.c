/* SPDX-License-Identifier: MIT */
/* What is asked of surfaces without texture is the same as what is asked of all. */
#include "common.h"

TEST(a_bare_point_is_the_point)
{
    sr_vec3 P[3] = {{0.1f, 0.2f, 5}, {1.3f, 0.1f, 5.5f}, {0.4f, 1.7f, 4.2f}},
            N[3] = {{0, 0.1f, 1}, {0.2f, 0, 1}, {0, -0.3f, 1}};
    int32_t indices[3] = {0, 1, 2};
    struct sr_shape_mesh flat = {.indices = SLICE(indices), .P = SLICE(P)},
                         smooth = {.indices = SLICE(indices), .P = SLICE(P), .N = SLICE(N)};
    struct sr_shape_sphere ball = {.radius = 2, .z_min = NAN, .z_max = NAN, .phi_max = 360};
    struct sr_shape shapes[3] = {PREPARE(sr_shape_trianglemesh, &flat, here()),
                                 PREPARE(sr_shape_trianglemesh, &smooth, here()),
                                 PREPARE(sr_shape_sphere, &ball, here())};
    struct sr_rng rng = sr_rng_seed(12, 1);
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 200; ++i) {
            sr_vec2 hit = {uniform(&rng), uniform(&rng)};
            if (hit.x + hit.y > 1)
                hit = (sr_vec2){1 - hit.x, 1 - hit.y};
            struct sr_point x, bare;
            shapes[k].model->point(shapes[k].self, 0, hit, &x);
            shapes[k].model->bare_point(shapes[k].self, 0, hit, &bare);
            EXPECT(sr_length(sr_sub(x.p, bare.p)) <= 1e-6f && sr_length(sr_sub(x.p_error, bare.p_error)) <= 1e-9f);
            EXPECT(sr_length(sr_sub(x.n, bare.n)) <= 1e-6f && sr_length(sr_sub(x.ns, bare.ns)) <= 1e-6f);
        }
}
