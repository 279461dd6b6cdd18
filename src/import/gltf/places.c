/* SPDX-License-Identifier: MIT */
/* Meshes where nodes show them: as shapes of the world, or, where several nodes show one mesh in one pose, as an object
 * and its instances. What glows is of the world always, for objects cannot. Primitives of one form (forms.c) become
 * objects that are like one another.
 *
 * Where a material looks for several coordinates, or the vertices have colours, each triangle gets vertices of its own,
 * with barycentric coordinates as (u, v) and its number as the face: textures find their values by these (texture
 * "attribute"). The order of the corners is such that dp/du x dp/dv is on the side that the normal map's coordinates
 * say. A mirrored placement turns neither outside nor normals (glTF 2.0, 3.7.4). */
#include "import/gltf/gltf.h"

#include <string.h>

enum { SHAPE_B = 1200, INSTANCE_B = 420 }; // what a description takes for each

struct place { // where a mesh is to be shown
    struct sr_gltf *g;
    const struct sr_transform *to_world; // count of them
    uint32_t count;
    uint32_t object1; // or the object that it becomes a part of
    const struct sr_gltf_pose *pose;
    bool is_posed;        // by the node
    struct sr_box bounds; // of what was added, where it lies before it is placed [m]
};
enum kind { PLAIN = 1, GLOWING = 2, FORMED = 4 };

/* ---- tangents ---- */

/* dp/du of the triangles around a vertex, summed by area. */
static sr_vec3 *derive_tangents(struct sr_gltf *g, const struct sr_gltf_at *at, const struct sr_gltf_mesh *m,
                                const sr_vec2 *uv)
{
    sr_vec3 *S = sr_gltf_array_for(g, at, &g->c.d->words, m->vertex_count, sizeof *S);
    for (size_t t = 0; t < m->triangle_count && S; ++t) {
        const int32_t *c = m->indices + 3 * t;
        sr_vec3 e = sr_sub(m->P[c[1]], m->P[c[0]]), f = sr_sub(m->P[c[2]], m->P[c[0]]);
        float eu = uv[c[1]].x - uv[c[0]].x, ev = uv[c[1]].y - uv[c[0]].y, fu = uv[c[2]].x - uv[c[0]].x,
              fv = uv[c[2]].y - uv[c[0]].y;
        float side = eu * fv - ev * fu < 0 ? -1.0f : 1.0f;
        sr_vec3 along = sr_sub(sr_scale(side * fv, e), sr_scale(side * ev, f));
        float length = sr_length(along), weight = length > 0 ? sr_length(sr_cross(e, f)) / length : 0;
        for (int k = 0; k < 3 && isfinite(weight); ++k)
            S[c[k]] = sr_mad(S[c[k]], weight, along);
    }
    return S;
}

/* Turned by angle [rad] about the normals, counterclockwise. */
static void turn_tangents(struct sr_gltf_mesh *m, float angle)
{
    for (uint32_t i = 0; i < m->vertex_count && m->S && m->N; ++i) {
        float length2 = sr_length2(m->N[i]);
        sr_vec3 n = sr_scale(length2 > 0 ? 1 / sqrtf(length2) : 0, m->N[i]);
        m->S[i] = sr_mad(sr_scale(cosf(angle), m->S[i]), sinf(angle), sr_cross(n, m->S[i]));
    }
}

/* ---- vertices of their own ---- */

static void split_triangle(const struct sr_gltf_mesh *m, size_t t, const int slots[3], struct sr_gltf_mesh *to,
                           struct sr_gltf_surface *s)
{
    static const sr_vec2 place_of_slot[3] = {{0, 0}, {1, 0}, {0, 1}};
    for (int k = 0; k < 3; ++k) {
        int32_t v = m->indices[3 * t + (size_t)k];
        size_t corner = 3 * t + (size_t)k, slot = 3 * t + (size_t)slots[k];
        to->P[corner] = m->P[v];
        if (m->N)
            to->N[corner] = m->N[v];
        if (m->S)
            to->S[corner] = m->S[v];
        to->uv[0][corner] = place_of_slot[slots[k]];
        to->indices[corner] = (int32_t)corner;
        for (int set = 0; set < SR_GLTF_UV_SETS; ++set)
            if (m->uv[set])
                ((sr_vec2 *)(uintptr_t)s->corner_uv[set])[slot] = m->uv[set][v];
        if (m->colours)
            memcpy((float *)(uintptr_t)s->corner_colours + 4 * slot, m->colours + 4 * (size_t)v, 4 * sizeof(float));
    }
}

static bool split(struct sr_gltf *g, const struct sr_gltf_at *at, const struct sr_gltf_mesh *m, const sr_vec2 *sided,
                  struct sr_gltf_mesh *to, struct sr_gltf_surface *s)
{
    uint64_t n = 3 * (uint64_t)m->triangle_count;
    struct sr_arena *words = &g->c.d->words, *data = g->c.d->data;
    *to = (struct sr_gltf_mesh){.vertex_count = (uint32_t)n, .triangle_count = m->triangle_count};
    s->is_split = true;
    s->corner_count = (uint32_t)n;
    to->P = sr_gltf_array_for(g, at, words, n, sizeof(sr_vec3));
    to->N = m->N ? sr_gltf_array_for(g, at, words, n, sizeof(sr_vec3)) : NULL;
    to->S = m->S ? sr_gltf_array_for(g, at, words, n, sizeof(sr_vec3)) : NULL;
    to->indices = sr_gltf_array_for(g, at, data, n, sizeof(int32_t));
    to->uv[0] = sr_gltf_array_for(g, at, data, n, sizeof(sr_vec2));
    for (int set = 0; set < SR_GLTF_UV_SETS; ++set)
        s->corner_uv[set] = m->uv[set] ? sr_gltf_array_for(g, at, data, n, sizeof(sr_vec2)) : NULL;
    s->corner_colours = m->colours ? sr_gltf_array_for(g, at, data, n, 4 * sizeof(float)) : NULL;
    if (!sr_gltf_is_well(g))
        return false;
    for (size_t t = 0; t < m->triangle_count; ++t) {
        static const int straight[3] = {0, 1, 2}, crossed[3] = {0, 2, 1};
        const int32_t *c = m->indices + 3 * t;
        bool is_mirrored = false; // v counts downward in the file
        if (sided)
            is_mirrored = (sided[c[1]].x - sided[c[0]].x) * (sided[c[2]].y - sided[c[0]].y) -
                              (sided[c[1]].y - sided[c[0]].y) * (sided[c[2]].x - sided[c[0]].x) >
                          0;
        split_triangle(m, t, is_mirrored ? crossed : straight, to, s);
    }
    return true;
}

/* (u, v) of the file to those of the mesh: F U */
static void place_uv(sr_vec2 *uv, uint32_t count, const double u[6], bool is_emission)
{
    float lo[2] = {INFINITY, INFINITY};
    for (uint32_t i = 0; i < count; ++i) {
        double s = u[0] * (double)uv[i].x + u[1] * (double)uv[i].y + u[2],
               t = u[3] * (double)uv[i].x + u[4] * (double)uv[i].y + u[5];
        uv[i] = (sr_vec2){(float)s, (float)(1 - t)};
        lo[0] = sr_min(lo[0], uv[i].x);
        lo[1] = sr_min(lo[1], uv[i].y);
    }
    for (uint32_t i = 0; i < count && is_emission; ++i) { // images of lights do not repeat
        uv[i].x -= floorf(lo[0] + 1e-4f);
        uv[i].y -= floorf(lo[1] + 1e-4f);
    }
}

/* ---- primitives ---- */

uint32_t sr_gltf_material_of(struct sr_gltf *g, const struct sr_gltf_at *primitive)
{
    uint32_t count = sr_gltf_root_count(g, "materials"), material1 = sr_gltf_index1(g, primitive, "material", count);
    struct sr_gltf_at variants = sr_gltf_extension(g, primitive, "KHR_materials_variants"),
                      mappings = sr_gltf_array(g, &variants, "mappings");
    for (uint32_t i = 0; i < sr_gltf_count(&mappings) && g->variant1; ++i) {
        struct sr_gltf_at mapping = sr_gltf_element(g, &mappings, i), list = sr_gltf_array(g, &mapping, "variants");
        for (uint32_t k = 0; k < sr_gltf_count(&list); ++k)
            if (json_integer_value(json_array_get(list.json, k)) == (json_int_t)g->variant1 - 1)
                return sr_gltf_index1(g, &mapping, "material", count);
    }
    return material1;
}

static void add_shapes(struct place *p, const struct sr_gltf_mesh *m, const struct sr_gltf_surface *s,
                       const char *alpha)
{
    struct sr_gltf *g = p->g;
    struct sr_compose *to = &g->c;
    size_t corners = 3 * (size_t)m->triangle_count, vertices = m->vertex_count;
    int32_t *faces = s->is_split ? sr_gltf_array_for(g, NULL, to->d->data, m->triangle_count, sizeof *faces) : NULL;
    for (uint32_t i = 0; i < m->triangle_count && faces; ++i)
        faces[i] = (int32_t)i;
    struct sr_box box = sr_box_empty();
    for (uint32_t i = 0; i < vertices; ++i)
        box = sr_box_add(box, m->P[i]);
    p->bounds = sr_box_union(p->bounds, box);
    for (uint32_t k = 0; k < (p->object1 ? 1 : p->count) && sr_gltf_is_well(g); ++k) {
        bool is_moved = !p->object1 && !sr_transform_is_identity(&p->to_world[k]);
        if (!p->object1 && !sr_transform_is_valid(&p->to_world[k]))
            continue; // shrunk to nothing
        to->transform = is_moved ? sr_compose_transform(to, &p->to_world[k]) : 0;
        to->object1 = p->object1;
        sr_compose_ints(to, "indices", m->indices, corners);
        sr_compose_floats(to, SR_PBRT_POINT3, "P", &m->P[0].x, 3 * vertices);
        if (m->N)
            sr_compose_floats(to, SR_PBRT_NORMAL, "N", &m->N[0].x, 3 * vertices);
        if (m->S)
            sr_compose_floats(to, SR_PBRT_VECTOR3, "S", &m->S[0].x, 3 * vertices);
        if (m->uv[0])
            sr_compose_floats(to, SR_PBRT_POINT2, "uv", &m->uv[0][0].x, 2 * vertices);
        if (faces)
            sr_compose_ints(to, "faceIndices", faces, m->triangle_count);
        if (alpha)
            sr_compose_texture_name(to, "alpha", alpha);
        sr_compose_shape(to, "trianglemesh");
        if (!p->object1)
            g->bounds = sr_box_union(g->bounds, sr_box_transform(&p->to_world[k], box));
    }
    to->transform = to->object1 = to->area_light1 = 0;
    to->inside = NULL;
}

static bool has_attribute(struct sr_gltf *g, const struct sr_gltf_at *primitive, const char *format, uint32_t i)
{
    struct sr_gltf_at attributes = sr_gltf_object(g, primitive, "attributes");
    char name[24] = "TEXCOORD_0";
    name[9] = (char)('0' + i);
    return attributes.json && json_object_get(attributes.json, format ? format : name);
}

/* form: where its mesh is, or goes to; NULL: none. */
static void add_primitive(struct place *p, const struct sr_gltf_at *primitive, uint32_t mesh, uint32_t number,
                          struct sr_gltf_form *form)
{
    struct sr_gltf *g = p->g;
    uint32_t material1 = sr_gltf_material_of(g, primitive), present = 0;
    struct sr_gltf_look look;
    sr_gltf_read_look(g, material1, &look);
    struct sr_gltf_needs needs = sr_gltf_needs_of(&look);
    for (uint32_t set = 0; set < SR_GLTF_UV_SETS; ++set)
        if (needs.uv_sets >> set & 1) {
            if (has_attribute(g, primitive, NULL, set))
                present |= 1u << set;
            else if (needs.uv_sets != 1 || look.base_texture.info.json)
                sr_gltf_warn(g, primitive,
                             "has no TEXCOORD_%u, where textures of its material lie: they are read in one place", set);
        }
    bool has_colours = has_attribute(g, primitive, "COLOR_0", 0);
    bool is_split = has_colours || (needs.uv_sets & ~(1u << needs.mesh_set));
    struct sr_arena own = {0};
    struct sr_gltf_stores stores = {&g->c.d->words, g->c.d->data, needs.tangents, has_colours};
    if (is_split)
        stores.words = stores.data = &own;
    uint64_t made_B = g->made_B;
    struct sr_gltf_mesh m = form ? form->mesh : (struct sr_gltf_mesh){0}, apart;
    bool is_read = form && form->is_read;
    if (!sr_gltf_charge(g, primitive, (uint64_t)SHAPE_B * (p->object1 ? 1 : p->count)) ||
        (!is_read && !sr_gltf_read_mesh(g, primitive, p->pose, present, stores, &m))) {
        sr_arena_free(&own);
        return;
    }
    uint64_t own_B = is_split ? g->made_B - made_B : 0;
    uint32_t normal_set = look.normal_texture.info.json ? look.normal_texture.set : needs.mesh_set;
    if (needs.tangents && !m.S && m.uv[normal_set] && (is_split || look.anisotropy_rotation != 0))
        m.S = derive_tangents(g, primitive, &m, m.uv[normal_set]);
    if (look.anisotropy > 0 && look.anisotropy_rotation != 0)
        turn_tangents(&m, (float)look.anisotropy_rotation);
    struct sr_gltf_surface s = {.name = material1 ? sr_compose_printf(&g->c, "material%u", material1 - 1) : "material"};
    memcpy(s.uv_transform, needs.uv_transform, sizeof s.uv_transform);
    if (is_split) {
        s.name = sr_compose_printf(&g->c, "%s.mesh%u.%u", s.name, mesh, number);
        split(g, primitive, &m, needs.tangents ? m.uv[normal_set] : NULL, &apart, &s);
        for (int set = 0; set < SR_GLTF_UV_SETS; ++set) // where there are none: all in one place
            if (!s.corner_uv[set] && sr_gltf_is_well(g) && needs.uv_sets >> set & 1)
                s.corner_uv[set] = sr_gltf_array_for(g, primitive, g->c.d->data, apart.vertex_count, sizeof(sr_vec2));
        m = apart;
        g->made_B -= own_B;
    } else if (!is_read) {
        m.uv[0] = m.uv[needs.mesh_set];
        if (m.uv[0])
            place_uv(m.uv[0], m.vertex_count, needs.uv_transform, look.emission_texture.info.json != NULL);
    }
    if (form) {
        form->mesh = m;
        form->is_read = true;
    }
    const char *alpha = NULL;
    g->c.where.file = sr_compose_printf(&g->c, "%s: /materials/%d", g->c.path, (int)material1 - 1);
    if (sr_gltf_is_well(g))
        sr_gltf_wear(g, &look, &s, &alpha);
    g->c.where.file = sr_compose_printf(&g->c, "%s: %s", g->c.path, primitive->pointer);
    if (sr_gltf_is_well(g))
        add_shapes(p, &m, &s, alpha);
    g->c.where.file = g->c.path;
    sr_arena_free(&own);
}

static void add_instances(struct place *p, const char *object, struct sr_box bounds)
{
    struct sr_gltf *g = p->g;
    for (uint32_t i = 0; i < p->count && object && sr_gltf_is_well(g); ++i) {
        if (!sr_transform_is_valid(&p->to_world[i]) || !sr_gltf_charge(g, NULL, INSTANCE_B))
            continue;
        g->c.transform = sr_compose_transform(&g->c, &p->to_world[i]);
        sr_compose_instance(&g->c, object);
        g->c.transform = 0;
        g->bounds = sr_box_union(g->bounds, sr_box_transform(&p->to_world[i], bounds));
    }
}

static void place_formed(struct place *p, const struct sr_gltf_at *primitive, uint32_t mesh, uint32_t number,
                         struct sr_gltf_form *form)
{
    struct sr_compose *to = &p->g->c;
    struct sr_gltf_part *part = &p->g->objects[mesh].parts[number];
    if (!part->is_made) {
        size_t before = to->d->shapes.count;
        struct place apart = *p;
        const char *name = sr_compose_printf(to, "mesh%u.%u", mesh, number);
        apart.bounds = sr_box_empty();
        apart.object1 = sr_compose_object(to, name);
        add_primitive(&apart, primitive, mesh, number, form);
        part->is_made = true;
        if (to->d->shapes.count > before && sr_gltf_is_well(p->g)) {
            part->name = name;
            form->bounds = apart.bounds;
            SR_PBRT_AT(to->d->objects, struct sr_pbrt_object, apart.object1 - 1)->like1 = form->object1;
            form->object1 = form->object1 ? form->object1 : apart.object1;
        }
    }
    add_instances(p, part->name, form->bounds);
}

/* kinds: those that are wanted. */
static void place_primitive(struct place *p, const struct sr_gltf_at *primitive, uint32_t mesh, uint32_t number,
                            unsigned kinds)
{
    struct sr_gltf_look look;
    sr_gltf_read_look(p->g, sr_gltf_material_of(p->g, primitive), &look);
    struct sr_gltf_form *form = p->is_posed ? NULL : sr_gltf_form_of(p->g, mesh, number);
    enum kind kind = look.is_emissive ? GLOWING : form ? FORMED : PLAIN;
    if (!(kinds & kind) || !sr_gltf_is_well(p->g))
        return;
    if (kind == FORMED)
        place_formed(p, primitive, mesh, number, form);
    else
        add_primitive(p, primitive, mesh, number, NULL);
}

/* ---- meshes ---- */

static void place_all(struct place *p, uint32_t mesh, unsigned kinds)
{
    struct sr_gltf_at at = sr_gltf_entry(p->g, "meshes", mesh), primitives = sr_gltf_array(p->g, &at, "primitives");
    for (uint32_t i = 0; i < sr_gltf_count(&primitives) && sr_gltf_is_well(p->g); ++i) {
        struct sr_gltf_at primitive = sr_gltf_element(p->g, &primitives, i);
        place_primitive(p, &primitive, mesh, i, kinds);
    }
}

static void place_object(struct place *p, uint32_t mesh)
{
    struct sr_gltf *g = p->g;
    struct sr_gltf_object *o = &g->objects[mesh];
    if (!o->is_made) {
        size_t before = g->c.d->shapes.count;
        const char *name = sr_compose_printf(&g->c, "mesh%u", mesh);
        p->object1 = sr_compose_object(&g->c, name);
        place_all(p, mesh, PLAIN);
        o->name = g->c.d->shapes.count > before ? name : NULL;
        o->bounds = p->bounds;
        o->is_made = true;
        p->object1 = 0;
    }
    place_all(p, mesh, GLOWING | FORMED);
    add_instances(p, o->name, o->bounds);
}

/* ---- nodes ---- */

/* Where a node shows its mesh: once, or as EXT_mesh_gpu_instancing says. */
static uint32_t count_places(struct sr_gltf *g, const struct sr_gltf_at *node, struct sr_gltf_accessor list[3])
{
    struct sr_gltf_at instancing = sr_gltf_extension(g, node, "EXT_mesh_gpu_instancing"),
                      attributes = sr_gltf_object(g, &instancing, "attributes");
    list[0] = sr_gltf_accessor(g, &attributes, "TRANSLATION", 3);
    list[1] = sr_gltf_accessor(g, &attributes, "ROTATION", 4);
    list[2] = sr_gltf_accessor(g, &attributes, "SCALE", 3);
    uint32_t count = 0;
    for (int k = 0; k < 3; ++k) {
        if (list[k].count && count && list[k].count != count)
            sr_gltf_fail(g, &attributes, "accessors of %u and of %u elements: expected as many", count, list[k].count);
        count = list[k].count ? list[k].count : count;
    }
    return count ? count : 1;
}

static struct sr_transform *read_places(struct sr_gltf *g, uint32_t node, const struct sr_gltf_at *at,
                                        struct sr_arena *arena, uint32_t *count)
{
    struct sr_gltf_accessor list[3];
    *count = count_places(g, at, list);
    struct sr_transform *out = sr_gltf_array_for(g, at, arena, *count, sizeof *out);
    for (uint32_t i = 0; i < *count && out; ++i) {
        float v[3][16] = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
        double d[3][4], local[4][4], world[4][4] = {{0}};
        for (int k = 0; k < 3; ++k) {
            if (list[k].count)
                sr_gltf_floats(&list[k], i, v[k]);
            for (int c = 0; c < 4; ++c)
                d[k][c] = (double)v[k][c];
        }
        sr_gltf_compose_trs(d[0], d[1], d[2], local);
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                for (int k = 0; k < 4; ++k)
                    world[r][c] += g->nodes[node].world[r][k] * local[k][c];
        out[i] = sr_gltf_transform_of(world);
    }
    return out;
}

static uint32_t mesh_of(struct sr_gltf *g, const struct sr_gltf_at *node)
{
    return sr_gltf_index1(g, node, "mesh", sr_gltf_root_count(g, "meshes"));
}

static bool has_own_pose(const struct sr_gltf_at *node)
{
    return json_object_get(node->json, "skin") || json_object_get(node->json, "weights");
}

static void place_node(struct sr_gltf *g, uint32_t node, const struct sr_gltf_at *at, uint32_t mesh)
{
    struct sr_gltf_at mesh_at = sr_gltf_entry(g, "meshes", mesh);
    struct sr_arena own = {0};
    struct sr_gltf_pose pose;
    uint64_t made_B = g->made_B;
    uint32_t count;
    struct sr_transform *places = read_places(g, node, at, &own, &count);
    if (places && sr_gltf_read_pose(g, node, &mesh_at, &own, &pose)) {
        uint64_t own_B = g->made_B - made_B;
        if (pose.joints) { // skins lie in the world already
            places[0] = sr_transform_identity();
            count = 1;
        }
        struct place p = {.g = g,
                          .to_world = places,
                          .count = count,
                          .pose = &pose,
                          .is_posed = has_own_pose(at),
                          .bounds = sr_box_empty()};
        if (g->objects[mesh].uses > 1 && !p.is_posed)
            place_object(&p, mesh);
        else
            place_all(&p, mesh, PLAIN | GLOWING | FORMED);
        g->made_B -= own_B;
    }
    sr_arena_free(&own);
}

void sr_gltf_place_meshes(struct sr_gltf *g)
{
    struct sr_gltf_accessor unused[3];
    g->objects = sr_gltf_array_for(g, NULL, &g->scratch, sr_gltf_root_count(g, "meshes"), sizeof *g->objects);
    g->images = sr_gltf_array_for(g, NULL, &g->scratch, sr_gltf_root_count(g, "images"), sizeof *g->images);
    g->bounds = sr_box_empty();
    for (int pass = 0; pass < 2; ++pass) {
        for (uint32_t i = 0; i < g->node_count && sr_gltf_is_well(g); ++i) {
            if (!g->nodes[i].is_of_scene)
                continue;
            struct sr_gltf_at at = sr_gltf_entry(g, "nodes", i);
            uint32_t mesh1 = mesh_of(g, &at);
            if (mesh1 && pass == 1)
                place_node(g, i, &at, mesh1 - 1);
            else if (mesh1 && !has_own_pose(&at)) {
                uint64_t uses = (uint64_t)g->objects[mesh1 - 1].uses + count_places(g, &at, unused);
                g->objects[mesh1 - 1].uses = uses < UINT32_MAX ? (uint32_t)uses : UINT32_MAX;
            }
        }
        if (pass == 0)
            sr_gltf_find_forms(g);
    }
}
