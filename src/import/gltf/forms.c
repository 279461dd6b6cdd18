/* SPDX-License-Identifier: MIT */
/* Forms: what primitives of several meshes share. glTF binds the material to the primitive, so a file that shows one
 * body in many materials has a mesh for each, of the same accessors. Where that is worth it they are read once, and
 * become objects that are like one another.
 *
 * Two primitives have one form when the arrays that shapes take from them are the same: accessors, mode, and what the
 * material's textures make of the coordinates. Those with vertices of their own, in a pose, or glowing, have none. */
#include "import/gltf/gltf.h"

#include <stdio.h>
#include <string.h>

enum { FEW = 256, MANY = 4096 }; // triangles of a form; triangles saved

/* The number of an accessor as the file has it, -1: none; whoever reads it checks it. */
static long long number_of(const struct sr_gltf_at *at, const char *key)
{
    json_t *value = at->json ? json_object_get(at->json, key) : NULL;
    return json_is_integer(value) ? (long long)json_integer_value(value) : -1;
}

static uint32_t triangles_of(struct sr_gltf *g, const struct sr_gltf_at *primitive, const struct sr_gltf_at *attributes)
{
    bool is_indexed = json_object_get(primitive->json, "indices");
    struct sr_gltf_accessor a =
        is_indexed ? sr_gltf_accessor(g, primitive, "indices", 1) : sr_gltf_accessor(g, attributes, "POSITION", 3);
    return a.count / 3;
}

static void find_form(struct sr_gltf *g, const struct sr_gltf_at *primitive, struct sr_gltf_part *part)
{
    struct sr_gltf_look look;
    sr_gltf_read_look(g, sr_gltf_material_of(g, primitive), &look);
    struct sr_gltf_needs n = sr_gltf_needs_of(&look);
    struct sr_gltf_at attributes = sr_gltf_object(g, primitive, "attributes");
    bool is_turned = look.anisotropy > 0 && look.anisotropy_rotation != 0;
    if (!sr_gltf_is_well(g) || !attributes.json || look.is_emissive || is_turned || (n.uv_sets & ~(1u << n.mesh_set)) ||
        json_object_get(attributes.json, "COLOR_0") || number_of(&attributes, "POSITION") < 0)
        return;
    uint32_t triangles = triangles_of(g, primitive, &attributes);
    if (triangles < FEW)
        return;
    char set[24];
    snprintf(set, sizeof set, "TEXCOORD_%u", n.mesh_set);
    const double *t = n.uv_transform;
    const char *key =
        sr_compose_printf(&g->c, "%lld %lld %lld %lld %lld %lld %a %a %a %a %a %a", number_of(primitive, "mode"),
                          number_of(primitive, "indices"), number_of(&attributes, "POSITION"),
                          number_of(&attributes, "NORMAL"), n.tangents ? number_of(&attributes, "TANGENT") : -1,
                          n.uv_sets ? number_of(&attributes, set) : -1, t[0], t[1], t[2], t[3], t[4], t[5]);
    part->form1 = sr_pbrt_names_find(&g->form_names, key);
    if (!part->form1) {
        struct sr_gltf_form *form = sr_array_push(&g->forms, sizeof *form);
        part->form1 = (uint32_t)g->forms.count;
        if (!form || !sr_pbrt_names_add(&g->form_names, key, part->form1)) {
            sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
            return;
        }
        *form = (struct sr_gltf_form){.triangles = triangles};
    }
    ++((struct sr_gltf_form *)g->forms.data)[part->form1 - 1].uses;
}

void sr_gltf_find_forms(struct sr_gltf *g)
{
    for (uint32_t i = 0; i < sr_gltf_root_count(g, "meshes") && sr_gltf_is_well(g); ++i) {
        struct sr_gltf_object *o = &g->objects[i];
        if (!o->uses)
            continue;
        struct sr_gltf_at mesh = sr_gltf_entry(g, "meshes", i), primitives = sr_gltf_array(g, &mesh, "primitives");
        uint32_t count = sr_gltf_count(&primitives);
        if (json_object_get(mesh.json, "weights") ||
            !(o->parts = sr_gltf_array_for(g, &primitives, &g->scratch, count, sizeof *o->parts)))
            continue;
        for (uint32_t k = 0; k < count && sr_gltf_is_well(g); ++k) {
            struct sr_gltf_at primitive = sr_gltf_element(g, &primitives, k);
            find_form(g, &primitive, &o->parts[k]);
        }
    }
}

struct sr_gltf_form *sr_gltf_form_of(struct sr_gltf *g, uint32_t mesh, uint32_t primitive)
{
    const struct sr_gltf_part *parts = g->objects[mesh].parts;
    struct sr_gltf_form *form =
        parts && parts[primitive].form1 ? &((struct sr_gltf_form *)g->forms.data)[parts[primitive].form1 - 1] : NULL;
    return form && form->uses > 1 && (uint64_t)form->triangles * (form->uses - 1) >= MANY ? form : NULL;
}
