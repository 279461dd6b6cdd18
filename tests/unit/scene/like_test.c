/* SPDX-License-Identifier: MIT */
/* Objects that are like others: rays meet them where they meet objects of their own, and they wear their own material.
 */
#include "test.h"

#include "scene/scene.h"

enum { STEPS = 48, TRIANGLES = 2 * STEPS * STEPS }; // so many that they are given to the ray caster by pairs

static const struct sr_material *grey(struct sr_scene *scene)
{
    struct sr_arena *arena = sr_scene_arena(scene);
    const struct sr_material_model *model = sr_material_model_find("diffuse");
    void *self = sr_arena_alloc(arena, model->size);
    struct sr_material *material = sr_arena_alloc(arena, sizeof *material);
    *material = (struct sr_material){.model = model, .self = self};
    return material;
}

/* A hilly square, -1 to 1. */
static struct sr_shape hills(struct sr_scene *scene)
{
    static sr_vec3 P[(STEPS + 1) * (STEPS + 1)];
    static int32_t indices[3 * TRIANGLES];
    int32_t *to = indices;
    for (int y = 0; y <= STEPS; ++y)
        for (int x = 0; x <= STEPS; ++x) {
            float u = 2 * (float)x / STEPS - 1, v = 2 * (float)y / STEPS - 1;
            P[y * (STEPS + 1) + x] = (sr_vec3){u, v, 0.1f * sinf(5 * u) * cosf(3 * v)};
            int32_t at = y * (STEPS + 1) + x;
            if (x < STEPS && y < STEPS) {
                memcpy(to, (int32_t[6]){at, at + 1, at + STEPS + 2, at, at + STEPS + 2, at + STEPS + 1},
                       6 * sizeof *to);
                to += 6;
            }
        }
    struct sr_shape_mesh *m = sr_arena_alloc(sr_scene_arena(scene), sizeof *m);
    *m = (struct sr_shape_mesh){.P = {P, sizeof P / sizeof *P}, .indices = {indices, 3 * TRIANGLES}};
    struct sr_shape_placement placement = {.object_to_world = sr_transform_identity()};
    EXPECT(sr_shape_trianglemesh.prepare(m, &placement, sr_scene_arena(scene), sr_scene_error(scene)) == SR_OK);
    return (struct sr_shape){&sr_shape_trianglemesh, m};
}

/* Three of them side by side; alpha of the last. */
static struct sr_scene *make(bool is_like, float last_alpha)
{
    struct sr_scene *scene = sr_scene_create();
    struct sr_shape shape = hills(scene);
    sr_object_id first = {0};
    for (int i = 0; i < 3; ++i) {
        struct sr_shape_def def = {.shape = i && !is_like ? hills(scene) : shape, .material = grey(scene)};
        def.object = i && is_like ? sr_scene_add_object_like(scene, first) : sr_scene_add_object(scene);
        first = i ? first : def.object;
        if (i == 2 && last_alpha < 1)
            def.alpha = sr_texture_constant_float(sr_scene_arena(scene), last_alpha);
        sr_scene_add_shape(scene, &def);
        struct sr_transform place = sr_transform_translate((sr_vec3){3 * (float)i, 0, 0});
        sr_scene_add_instance(scene, def.object, &place);
    }
    if (sr_scene_finish(scene, 1, 0) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", sr_scene_error(scene)->text);
    return scene;
}

static void compare(float last_alpha)
{
    struct sr_scene *like = make(true, last_alpha), *own = make(false, last_alpha);
    uint32_t met[4] = {0};
    for (uint32_t i = 0; i < 20000; ++i) {
        float u = sr_u32_to_float(sr_hash_combine(1, i)), v = sr_u32_to_float(sr_hash_combine(2, i)),
              w = sr_u32_to_float(sr_hash_combine(3, i));
        struct sr_ray ray = {.o = {8 * u - 1, 2 * v - 1, 2}, .d = {0.3f * w - 0.15f, 0.1f * w, -1}, .t_max = INFINITY};
        struct sr_hit a, b;
        bool is_hit = sr_raycast(like, &ray, &a);
        EXPECT(is_hit == sr_raycast(own, &ray, &b));
        if (!is_hit)
            continue;
        EXPECT(a.t == b.t && memcmp(&a.point.p, &b.point.p, sizeof a.point.p) == 0 &&
               memcmp(&a.point.n, &b.point.n, sizeof a.point.n) == 0);
        EXPECT(a.material_number == b.material_number && a.object == b.object);
        ++met[a.material_number];
    }
    EXPECT(met[1] > 3000 && met[2] > 3000 && met[3] > (last_alpha < 1 ? 1000 : 3000));
    EXPECT_EQUAL_INT(sr_scene_count(like).triangles, TRIANGLES);
    EXPECT_EQUAL_INT(sr_scene_count(own).triangles, 3 * TRIANGLES);
    EXPECT(sr_scene_count(like).acceleration_B < sr_scene_count(own).acceleration_B);
    sr_scene_destroy(like);
    sr_scene_destroy(own);
}

TEST(objects_that_are_like_others_are_met_as_if_they_had_shapes_of_their_own)
{
    compare(1);
}

TEST(objects_that_are_like_others_but_have_holes_keep_them)
{
    compare(0.5f);
}
