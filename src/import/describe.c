/* SPDX-License-Identifier: MIT */
/* The list of formats. */
#include "import/describe.h"

#include "import/gltf/gltf.h"
#include "import/obj.h"

static const struct sr_import_format formats[] = {
    {".gltf", sr_gltf_read}, {".glb", sr_gltf_read},      {".obj", sr_obj_read},
    {".stl", sr_stl_read},   {".ply", sr_ply_scene_read}, {NULL, NULL},
};

const struct sr_import_format *sr_import_format_of(const char *path)
{
    for (const struct sr_import_format *f = formats; f->ending; ++f)
        if (sr_path_has_ending(path, f->ending))
            return f;
    return NULL;
}

sr_status sr_describe(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                      struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error)
{
    const struct sr_import_format *format = sr_import_format_of(path);
    return format ? format->read(path, options, data, log, out, error) : sr_pbrt_read(path, data, log, out, error);
}
