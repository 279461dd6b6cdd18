/* SPDX-License-Identifier: MIT */
/* Materials of glTF files made here. */
#include "gltf_made.h"

#define IMAGE                                                                                                          \
    "\"images\":[{\"uri\":\"t%%20.png\"}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648,\"magFilter\":9728}],\"textures\":[{\"source\":0,\"sampler\":0}]"

static void put_textured(const char *material)
{
    static char rest[3000];
    put_triangle();
    size_t uv = PUT(float, 0, 0, 1, 0, 0, 1);
    snprintf(rest, sizeof rest,
             VIEWS
             ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":24}]," ACCESSORS
             ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"material\":0}]}]," IMAGE
             ",\"materials\":[%s]," SHOWN,
             uv, material);
    describe(rest);
}

static const struct sr_pbrt_entity *texture_of(const struct sr_pbrt_param *p, bool is_float)
{
    EXPECT(p && p->type == SR_PBRT_TEXTURE);
    uint32_t index1 = sr_pbrt_names_find(is_float ? &d.float_textures : &d.spectrum_textures, p->strings[0]);
    EXPECT(index1 != 0);
    return &SR_PBRT_AT(d.textures, struct sr_pbrt_texture, index1 - 1)->entity;
}

static const char *text_of(const struct sr_pbrt_entity *e, const char *name)
{
    const struct sr_pbrt_param *p = sr_pbrt_find(&e->params, name);
    return p ? p->strings[0] : "";
}

TEST(gltf_metallic_roughness_textures)
{
    put_textured(
        "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.25,1],\"baseColorTexture\":{\"index\":0},\"metallicFactor\":0.5,"
        "\"metallicRoughnessTexture\":{\"index\":0}}}");
    const struct sr_pbrt_entity *base = texture_of(material_param("material0", "base_color"), false);
    EXPECT_EQUAL_TEXT(text_of(base, "filename"), "t .png");
    EXPECT_EQUAL_TEXT(text_of(base, "swrap"), "clamp");
    EXPECT_EQUAL_TEXT(text_of(base, "twrap"), "mirror");
    EXPECT_EQUAL_TEXT(text_of(base, "filter"), "point");
    EXPECT_NEAR(sr_pbrt_find(&base->params, "factor")->floats[2], 0.25, 0);
    const struct sr_pbrt_entity *metal = texture_of(material_param("material0", "base_metalness"), true);
    EXPECT_EQUAL_TEXT(text_of(metal, "channel"), "b");
    EXPECT_EQUAL_TEXT(text_of(metal, "encoding"), "linear");
    EXPECT_NEAR(sr_pbrt_find(&metal->params, "scale")->floats[0], 0.5, 0);
    EXPECT_EQUAL_TEXT(text_of(texture_of(material_param("material0", "specular_roughness"), true), "channel"), "g");
    const float *uv = floats_of(0, "uv", 6); // v upward
    EXPECT(uv[1] == 1 && uv[5] == 0);
    done();
}

TEST(gltf_texture_transform)
{
    put_textured(
        "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":"
        "{\"offset\":[0.1,0.2],\"rotation\":0.5235987755982988,\"scale\":[2,3]}}}}}");
    const float *m =
        sr_pbrt_find(&texture_of(material_param("material0", "base_color"), false)->params, "transform")->floats;
    // (u, v) = (0.3, 0.6) of the file: scaled to (0.6, 1.8), turned by 30 degrees, moved
    double s = 0.6 * sqrt(0.75) + 1.8 * 0.5 + 0.1, t = -0.6 * 0.5 + 1.8 * sqrt(0.75) + 0.2, u = 0.3, v = 1 - 0.6;
    EXPECT_NEAR((double)m[0] * u + (double)m[1] * v + (double)m[2], s, 1e-6);
    EXPECT_NEAR(1 - ((double)m[3] * u + (double)m[4] * v + (double)m[5]), t, 1e-6);
    done();
}

TEST(gltf_emission_is_an_area_light)
{
    put_textured(
        "{\"emissiveFactor\":[1,0.5,0],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":40}},\"doubleSided\":true}");
    EXPECT_EQUAL_INT(shape(0)->area_light1, 1);
    const struct sr_pbrt_entity *light = SR_PBRT_AT(d.area_lights, struct sr_pbrt_entity, 0);
    const struct sr_pbrt_param *L = sr_pbrt_find(&light->params, "L"),
                               *sides = sr_pbrt_find(&light->params, "twosided");
    EXPECT(L && L->floats[0] == 40 && L->floats[1] == 20 && L->floats[2] == 0 && sides && sides->ints[0]);
    done();
}

TEST(gltf_alpha_modes)
{
    put_textured(
        "{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.3,\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.8],\"baseColorTexture\":{\"index\":0}}}");
    const struct sr_pbrt_entity *mask = texture_of(sr_pbrt_find(&shape(0)->entity.params, "alpha"), true);
    EXPECT_EQUAL_TEXT(mask->model, "threshold");
    EXPECT_NEAR(sr_pbrt_find(&mask->params, "cutoff")->floats[0], 0.3f, 0);
    const struct sr_pbrt_entity *alpha = texture_of(sr_pbrt_find(&mask->params, "tex"), true);
    EXPECT_EQUAL_TEXT(text_of(alpha, "channel"), "a");
    EXPECT_NEAR(sr_pbrt_find(&alpha->params, "scale")->floats[0], 0.8f, 0);
    sr_pbrt_description_free(&d);
    put_textured("{\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.25]}}");
    const struct sr_pbrt_entity *blend = texture_of(sr_pbrt_find(&shape(0)->entity.params, "alpha"), true);
    EXPECT_EQUAL_TEXT(blend->model, "constant");
    sr_pbrt_description_free(&d);
    put_textured("{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.25]}}"); // opaque
    EXPECT(!sr_pbrt_find(&shape(0)->entity.params, "alpha"));
    done();
}

TEST(gltf_vertex_colours_give_each_triangle_its_vertices)
{
    put_triangle();
    size_t colours = PUT(uint8_t, 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 51);
    char rest[1024];
    snprintf(
        rest, sizeof rest,
        VIEWS
        ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":12}]," ACCESSORS
        ",{\"bufferView\":1,\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC4\"}],"
        "\"materials\":[{\"alphaMode\":\"BLEND\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},\"material\":0}]}]," SHOWN,
        colours);
    describe(rest);
    EXPECT_EQUAL_TEXT(shape(0)->material.name, "material0.mesh0.0");
    const struct sr_pbrt_entity *colour = texture_of(material_param("material0.mesh0.0", "base_color"), false);
    EXPECT_EQUAL_TEXT(colour->model, "attribute");
    const struct sr_pbrt_param *values = sr_pbrt_find(&colour->params, "values");
    EXPECT(values->count == 12 && values->floats[0] == 1 && values->floats[5] == 1 && values->floats[10] == 1 &&
           fabsf(values->floats[11] - 0.2f) < 1e-6f);
    const float *uv = floats_of(0, "uv", 6);
    EXPECT(uv[0] == 0 && uv[2] == 1 && uv[5] == 1);
    EXPECT(sr_pbrt_find(&shape(0)->entity.params, "alpha") != NULL);
    done();
}
