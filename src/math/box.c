/* SPDX-License-Identifier: MIT */
/* Boxes with sides along the axes, given by two corners [m]; lo > hi in some axis means empty. */
#include "math/math.h"

struct sr_box sr_box_empty(void)
{
    return (struct sr_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

struct sr_box sr_box_add(struct sr_box b, sr_vec3 p)
{
    return sr_box_union(b, (struct sr_box){p, p});
}

struct sr_box sr_box_union(struct sr_box a, struct sr_box b)
{
    return (struct sr_box){
        {sr_min(a.lo.x, b.lo.x), sr_min(a.lo.y, b.lo.y), sr_min(a.lo.z, b.lo.z)},
        {sr_max(a.hi.x, b.hi.x), sr_max(a.hi.y, b.hi.y), sr_max(a.hi.z, b.hi.z)},
    };
}

struct sr_box sr_box_transform(const struct sr_transform *t, struct sr_box b)
{
    struct sr_box r = sr_box_empty();
    if (sr_box_is_empty(b))
        return r;
    for (int corner = 0; corner < 8; ++corner) {
        sr_vec3 p = {corner & 1 ? b.hi.x : b.lo.x, corner & 2 ? b.hi.y : b.lo.y, corner & 4 ? b.hi.z : b.lo.z};
        r = sr_box_add(r, sr_transform_point(t, p));
    }
    return r;
}

bool sr_box_is_empty(struct sr_box b)
{
    return !(b.lo.x <= b.hi.x && b.lo.y <= b.hi.y && b.lo.z <= b.hi.z);
}

bool sr_box_contains(struct sr_box b, sr_vec3 p)
{
    return b.lo.x <= p.x && p.x <= b.hi.x && b.lo.y <= p.y && p.y <= b.hi.y && b.lo.z <= p.z && p.z <= b.hi.z;
}

sr_vec3 sr_box_centre(struct sr_box b)
{
    return (sr_vec3){0.5f * b.lo.x + 0.5f * b.hi.x, 0.5f * b.lo.y + 0.5f * b.hi.y, 0.5f * b.lo.z + 0.5f * b.hi.z};
}

sr_vec3 sr_box_diagonal(struct sr_box b)
{
    return sr_sub(b.hi, b.lo);
}

void sr_box_bounding_sphere(struct sr_box b, sr_vec3 *centre, float *radius)
{
    bool empty = sr_box_is_empty(b);
    *centre = empty ? (sr_vec3){0, 0, 0} : sr_box_centre(b);
    // a little more than the distance, for its rounding
    *radius = empty ? 0 : sr_length(sr_sub(b.hi, *centre)) * (1 + 8 * SR_MACHINE_EPSILON);
}
