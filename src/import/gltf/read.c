/* SPDX-License-Identifier: MIT */
/* A glTF file to a description: container, nodes, meshes with their materials, lights, camera; and the end of it. */
#include "import/framing.h"
#include "import/gltf/gltf.h"

#include <stdlib.h>
#include <string.h>

/* The material variant by its name, or by its number from 1. */
static void choose_variant(struct sr_gltf *g)
{
    struct sr_gltf_at root = {.json = g->root}, all = sr_gltf_extension(g, &root, "KHR_materials_variants"),
                      list = sr_gltf_array(g, &all, "variants");
    const char *word = g->options->variant;
    for (uint32_t i = 0; i < sr_gltf_count(&list) && sr_gltf_is_well(g); ++i) {
        struct sr_gltf_at variant = sr_gltf_element(g, &list, i);
        char *end = NULL;
        if (word && !g->variant1 &&
            (strcmp(word, sr_gltf_name(g, &variant)) == 0 || (strtoul(word, &end, 10) == i + 1 && *word && !*end)))
            g->variant1 = i + 1;
        if (i < 100)
            sr_log(g->c.d->log, SR_INFO, "%s: variant %u \"%s\"%s", g->c.path, i + 1, sr_gltf_name(g, &variant),
                   g->variant1 == i + 1 ? ", used" : "");
    }
    if (word && !g->variant1 && sr_gltf_is_well(g))
        sr_gltf_fail(g, NULL, "there is no variant \"%.60s\": the file has %u", word, sr_gltf_count(&list));
}

static void build(struct sr_gltf *g, const char *bytes, size_t size)
{
    if (!sr_gltf_open(g, bytes, size))
        return;
    choose_variant(g);
    sr_gltf_place_nodes(g);
    if (sr_gltf_root_count(g, "animations"))
        sr_gltf_note(g, "animations", "everything stands as at rest");
    if (sr_gltf_is_well(g))
        sr_gltf_place_meshes(g);
    if (sr_gltf_is_well(g))
        sr_gltf_place_lights(g);
    sr_vec3 key;
    if (sr_gltf_is_well(g))
        sr_gltf_place_camera(g, &key);
    if (sr_gltf_is_well(g) && g->light_count == 0)
        sr_frame_sky(&g->c, key, (sr_vec3){0, 1, 0});
    sr_compose_setting(&g->c, "Integrator", g->c.d->media.count ? "volpath" : "path");
}

sr_status sr_gltf_read_bytes(const char *label, const char *bytes, size_t size, const struct sr_import_options *options,
                             struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                             struct sr_error *error)
{
    struct sr_gltf g = {.options = options};
    sr_compose_begin(&g.c, label, data, log, out, error);
    g.c.path = g.c.where.file = sr_compose_word(&g.c, label);
    if (error->status == SR_OK)
        build(&g, bytes, size);
    out->text_B = g.input_B;
    json_decref(g.root);
    sr_arena_free(&g.scratch);
    sr_array_free(&g.told);
    sr_array_free(&g.worn);
    sr_array_free(&g.forms);
    sr_pbrt_names_free(&g.made);
    sr_pbrt_names_free(&g.worn_names);
    sr_pbrt_names_free(&g.form_names);
    return sr_compose_end(&g.c);
}

sr_status sr_gltf_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                       struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error)
{
    char *bytes;
    size_t size;
    *out = (struct sr_pbrt_description){0};
    if (sr_file_read(path, (size_t)16 << 30, &bytes, &size, error) != SR_OK)
        return error->status;
    sr_status status = sr_gltf_read_bytes(path, bytes, size, options, data, log, out, error);
    sr_free(bytes);
    return status;
}
