/* SPDX-License-Identifier: MIT */
/* Which medium is where: surfaces tell what is on their two sides, and nothing else does.
 *
 * A point's medium is that of the first surface with media along any ray from it. But files set a medium for the world
 * outside of all that follows, so that opaque things are vacuum inside, sheets too: their backs tell nothing. Limits:
 * surfaces that contradict each other are not noticed; a ray that slips between them finds what is around the scene;
 * nor is the vacuum inside of glass found. */
#include "scene/private.h"

enum { MOST_PASSED = 1000 };

void sr_scene_set_sensor_medium(struct sr_scene *scene, struct sr_medium medium)
{
    scene->sensor_medium = medium;
}

bool sr_scene_has_media(const struct sr_scene *scene)
{
    return scene->has_media;
}

bool sr_scene_has_interfaces(const struct sr_scene *scene)
{
    return scene->has_interfaces;
}

const struct sr_medium *sr_scene_sensor_medium(const struct sr_scene *scene)
{
    return scene->sensor_medium.model ? &scene->sensor_medium : NULL;
}

// seen along d
static bool tells(const struct sr_hit *hit, sr_vec3 d)
{
    return hit->media && (!hit->material || hit->media->inside.model || sr_dot(hit->point.n, d) < 0);
}

const struct sr_medium *sr_scene_medium_at(const struct sr_scene *scene, const struct sr_ray *ray)
{
    struct sr_ray next = *ray;
    struct sr_hit hit;
    next.t_max = INFINITY;
    for (int passed = 0; scene->has_media && passed < MOST_PASSED && sr_raycast_bare(scene, &next, &hit); ++passed) {
        if (tells(&hit, ray->d))
            return sr_hit_medium(&hit, sr_neg(ray->d), NULL);
        next.o = sr_point_offset(&hit.point, ray->d);
    }
    return scene->around;
}

/* What is around the scene: seen from outside of it, along rays to where surfaces with media are. */
void scene_find_media(struct sr_scene *scene)
{
    scene->has_media |= scene->sensor_medium.model != NULL;
    scene->around = sr_scene_sensor_medium(scene);
    sr_vec3 centre;
    float radius;
    sr_box_bounding_sphere(scene->bounds, &centre, &radius);
    for (uint32_t i = 0; scene->has_media && i < scene->world->shape_count; ++i) {
        const struct placed_shape *s = &scene->world->shapes[i];
        if (!s->media)
            continue;
        sr_vec3 target = sr_box_centre(s->shape.model->bounds(s->shape.self, 0));
        sr_vec3 d = sr_sub(centre, target);
        d = sr_length2(d) > 0 ? sr_normalize(d) : (sr_vec3){0, 0, -1};
        struct sr_ray ray = {.o = sr_mad(target, -3 * radius, d), .d = d, .t_max = INFINITY};
        struct sr_hit hit;
        for (int passed = 0; passed < MOST_PASSED && sr_raycast_bare(scene, &ray, &hit); ++passed) {
            if (tells(&hit, d)) {
                scene->around = sr_hit_medium(&hit, sr_neg(d), NULL);
                return;
            }
            ray.o = sr_point_offset(&hit.point, d);
        }
    }
}
