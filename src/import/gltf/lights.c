/* SPDX-License-Identifier: MIT */
/* Lights without extent (KHR_lights_punctual).
 *
 *     point, spot: intensity in cd; directional: illuminance in lx of a surface that faces it;
 *     all of white light, times colour
 *
 * Lights shine along their node's -z. Spots fall off between their cones as pbrt's do, smoothly in the cosine; glTF
 * only recommends its own way. */
#include "import/gltf/gltf.h"

#include <string.h>

enum { LIGHT_B = 900 };

static struct sr_rgb colour_of(struct sr_gltf *g, const struct sr_gltf_at *light)
{
    double c[3] = {1, 1, 1};
    sr_gltf_numbers(g, light, "color", 3, c);
    return (struct sr_rgb){(float)fmax(c[0], 0), (float)fmax(c[1], 0), (float)fmax(c[2], 0)};
}

static void place_spot(struct sr_gltf *g, const struct sr_gltf_at *light)
{
    struct sr_gltf_at spot = sr_gltf_object(g, light, "spot");
    double outer = sr_gltf_number(g, &spot, "outerConeAngle", 0.78539816339744831, 0, 1.5707963267948966 + 1e-6);
    double inner = sr_gltf_number(g, &spot, "innerConeAngle", 0, 0, 1.5707963267948966),
           degrees = 180 / 3.14159265358979323846;
    inner = fmin(inner, outer);
    sr_compose_float(&g->c, "coneangle", (float)(outer * degrees));
    sr_compose_float(&g->c, "conedeltaangle", (float)((outer - inner) * degrees));
}

static void place_light(struct sr_gltf *g, const struct sr_gltf_at *light, const double world[4][4])
{
    const char *type = sr_gltf_string(g, light, "type");
    double intensity = sr_gltf_number(g, light, "intensity", 1, 0, 1e30);
    struct sr_rgb colour = colour_of(g, light);
    bool is_spot = type && strcmp(type, "spot") == 0, is_point = type && strcmp(type, "point") == 0;
    if (!is_spot && !is_point && !(type && strcmp(type, "directional") == 0))
        sr_gltf_fail(g, light, "expected a \"type\", point, spot or directional");
    if (json_object_get(light->json, "range"))
        sr_gltf_note(g, "range of a light", "not used, for light has no end");
    struct sr_transform t = sr_gltf_transform_of(world);
    ++g->light_count;
    if (!sr_gltf_charge(g, light, LIGHT_B) || intensity == 0 || colour.r + colour.g + colour.b == 0 ||
        (!is_point && !sr_transform_is_valid(&t)))
        return;
    double no_turn[4][4] = {{1, 0, 0, world[0][3]}, {0, 1, 0, world[1][3]}, {0, 0, 1, world[2][3]}, {0, 0, 0, 1}};
    struct sr_transform place = is_point ? sr_gltf_transform_of(no_turn) : t;
    g->c.transform = sr_compose_transform(&g->c, &place);
    sr_compose_rgb(&g->c, is_point || is_spot ? "I" : "L", colour);
    sr_compose_float(&g->c, "scale", (float)intensity);
    if (is_spot)
        place_spot(g, light);
    if (!is_point) {
        sr_compose_tuple(&g->c, SR_PBRT_POINT3, "from", (sr_vec3){0, 0, 0});
        sr_compose_tuple(&g->c, SR_PBRT_POINT3, "to", (sr_vec3){0, 0, -1});
    }
    sr_compose_light(&g->c, is_point ? "point" : is_spot ? "spot" : "distant");
    g->c.transform = 0;
}

void sr_gltf_place_lights(struct sr_gltf *g)
{
    struct sr_gltf_at root = {.json = g->root}, all = sr_gltf_extension(g, &root, "KHR_lights_punctual"),
                      list = sr_gltf_array(g, &all, "lights");
    for (uint32_t i = 0; i < g->node_count && sr_gltf_is_well(g); ++i) {
        struct sr_gltf_at node = sr_gltf_entry(g, "nodes", i), own = sr_gltf_extension(g, &node, "KHR_lights_punctual");
        uint32_t light1 = g->nodes[i].is_of_scene ? sr_gltf_index1(g, &own, "light", sr_gltf_count(&list)) : 0;
        if (!light1)
            continue;
        struct sr_gltf_at light = sr_gltf_element(g, &list, light1 - 1);
        place_light(g, &light, (const double(*)[4])g->nodes[i].world);
    }
}
