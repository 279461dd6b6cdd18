/* SPDX-License-Identifier: MIT */
/* A description made by calls: what a file of the same meaning gives, files in memory, the first mistake. */
#include "test.h"

#include "import/describe.h"
#include "import/pbrt/compose.h"

#include <string.h>

static const float positions[4 + 9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}; // followed by 16 readable bytes
static const int32_t indices[4 + 3] = {0, 1, 2};

static void add_red_triangle(struct sr_compose *c)
{
    sr_compose_rgb(c, "reflectance", (struct sr_rgb){1, 0, 0});
    sr_compose_material(c, "red", "diffuse");
    struct sr_transform up = sr_transform_translate((sr_vec3){0, 0, 2});
    c->transform = sr_compose_transform(c, &up);
    c->material = "red";
    sr_compose_floats(c, SR_PBRT_POINT3, "P", positions, 9);
    sr_compose_ints(c, "indices", indices, 3);
    sr_compose_named_shape(c, "sheet", "trianglemesh");
}

TEST(compose_describes_what_a_file_would)
{
    struct sr_arena data = {0};
    struct sr_error error = {0};
    struct sr_pbrt_description d;
    struct sr_compose c;
    sr_compose_begin(&c, "made.obj", &data, NULL, &d, &error);
    add_red_triangle(&c);
    struct sr_transform camera = sr_transform_translate((sr_vec3){0, 0, -5});
    sr_compose_float(&c, "fov", 30);
    sr_compose_camera(&c, "perspective", &camera);
    sr_compose_int(&c, "xresolution", 64);
    sr_compose_setting(&c, "Film", "rgb");
    sr_compose_file(&c, "made.obj#image0", "abc", 3);
    EXPECT_EQUAL_INT(sr_compose_end(&c), SR_OK);

    EXPECT(d.has_world);
    EXPECT_EQUAL_INT(d.shapes.count, 1);
    const struct sr_pbrt_shape *s = SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, 0);
    EXPECT(strcmp(s->entity.model, "trianglemesh") == 0 && strcmp(s->material.name, "red") == 0 &&
           strcmp(s->name, "sheet") == 0);
    const struct sr_pbrt_param *P = sr_pbrt_find(&s->entity.params, "P");
    EXPECT(P && P->floats == positions && P->count == 9 && P->type == SR_PBRT_POINT3);
    EXPECT_NEAR(SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, s->entity.transform)->start.m[2][3], 2, 0);
    EXPECT_EQUAL_INT(sr_pbrt_names_find(&d.material_names, "red"), 1);
    EXPECT(strcmp(SR_PBRT_AT(d.named_materials, struct sr_pbrt_entity, 0)->model, "diffuse") == 0);
    EXPECT_NEAR(SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, d.camera.transform)->start.m[2][3], 5,
                0); // world to camera
    float fov = 0;
    int32_t width = 0;
    EXPECT(sr_pbrt_get_float(&d, &d.camera.params, "fov", &fov, &error) == SR_OK && fov == 30);
    EXPECT(sr_pbrt_get_int(&d, &d.film.params, "xresolution", &width, &error) == SR_OK && width == 64);
    const struct sr_pbrt_memory_file *f = sr_pbrt_memory_file(&d, "made.obj#image0");
    EXPECT(f && f->size == 3 && !sr_pbrt_memory_file(&d, "made.obj#image1"));
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
}

TEST(compose_keeps_the_first_mistake_and_its_place)
{
    struct sr_arena data = {0};
    struct sr_error error = {0};
    struct sr_pbrt_description d;
    struct sr_compose c;
    sr_compose_begin(&c, "made.obj", &data, NULL, &d, &error);
    add_red_triangle(&c);
    c.where.line = 7;
    c.where.column = 3;
    sr_compose_material(&c, "red", "diffuse");
    sr_compose_fail(&c, SR_ERROR_INPUT, "another");
    sr_compose_shape(&c, "sphere"); // harmless
    EXPECT_EQUAL_INT(sr_compose_end(&c), SR_ERROR_INPUT);
    EXPECT(strcmp(error.text, "made.obj:7:3: the name \"red\" is taken") == 0);
    EXPECT_EQUAL_INT(d.shapes.count, 1);
    sr_pbrt_description_free(&d);

    error = (struct sr_error){0};
    sr_compose_begin(&c, "made.obj", &data, NULL, &d, &error);
    sr_compose_fail(&c, SR_ERROR_INPUT, "wrong");
    EXPECT(sr_compose_end(&c) == SR_ERROR_INPUT && strcmp(error.text, "made.obj: wrong") == 0);
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
}
