/* SPDX-License-Identifier: MIT */
/* Form factors: F = mean over the receiver of E / (pi L), once by light sampling at random points of it, once by rays
 * that leave it at random. */
#include "analytic/analytic.h"

typedef void point_on(sr_vec2 u, sr_vec3 *p, sr_vec3 *n);

struct surface {
    point_on *point;
    bool by_rays;
};

static struct drawn draw(const void *context, sr_vec2 u, sr_vec2 v)
{
    const struct surface *s = context;
    sr_vec3 p, n;
    s->point(u, &p, &n);
    if (!s->by_rays)
        return (struct drawn){sr_mad(p, 1e-4f, n), sr_neg(n), 1 / RECEIVER_RHO};
    struct sr_frame f = sr_frame_from_z(n);
    return (struct drawn){sr_mad(p, 2e-6f, n), sr_to_world(&f, sr_warp_cosine_hemisphere(v)), 1};
}

/* factor: from the mean of E / (pi L) to the value of the row */
static struct estimate exchange(const struct row *row, point_on *point, const char *emitter, const char *receiver,
                                double factor)
{
    struct estimate best = {0, INFINITY, REPLICATES - 1};
    for (int by_rays = 0; by_rays < 2; ++by_rays) {
        struct surface s = {point, by_rays};
        if (!by_rays && !receiver)
            continue;
        struct world w =
            world_of("Integrator \"path\" \"integer maxdepth\" %d\nWorldBegin\n" BLACK "AttributeBegin\n" GLOW_BOTH
                     "%s\nAttributeEnd\nAttributeBegin\n" GREY "%s\nAttributeEnd\n",
                     !by_rays, emitter, by_rays ? "" : receiver);
        struct estimate e = scaled(mean_luminance(&w.job, draw, &s, by_rays ? 131072 : 4096), factor);
        check(row, by_rays ? "rays" : "path", e, by_rays ? 3 * GOAL : 12 * GOAL);
        if (e.error < best.error)
            best = e;
        world_free(&w);
    }
    return best;
}

static void unit_square(sr_vec2 u, sr_vec3 *p, sr_vec3 *n)
{
    *p = (sr_vec3){u.x, u.y, 0};
    *n = (sr_vec3){0, 0, 1};
}
static void two_by_one(sr_vec2 u, sr_vec3 *p, sr_vec3 *n)
{
    *p = (sr_vec3){2 * u.x, u.y, 0};
    *n = (sr_vec3){0, 0, 1};
}
static void unit_disk(sr_vec2 u, sr_vec3 *p, sr_vec3 *n)
{
    sr_vec2 d = sr_warp_disk(u);
    *p = (sr_vec3){d.x, d.y, 0};
    *n = (sr_vec3){0, 0, 1};
}
static void disk_of_sphere(sr_vec2 u, sr_vec3 *p, sr_vec3 *n)
{
    sr_vec2 d = sr_warp_disk(u);
    *p = (sr_vec3){1.5f * d.x, 1.5f * d.y, 2};
    *n = (sr_vec3){0, 0, -1};
}
static void outer_sphere(sr_vec2 u, sr_vec3 *p, sr_vec3 *n)
{
    sr_vec3 d = sr_warp_uniform_sphere(u);
    *p = sr_scale(2, d);
    *n = sr_neg(d);
}
static void strip(sr_vec2 u, sr_vec3 *p, sr_vec3 *n)
{
    *p = (sr_vec3){u.x, 0, 0};
    *n = (sr_vec3){0, 0, 1};
}

#define PATCH "Shape \"bilinearmesh\" \"point3 P\" "
static const char square_below[] = PATCH "[0 0 0 1 0 0 0 1 0 1 1 0]",
                  square_above[] = PATCH "[0 0 1 1 0 1 0 1 1 1 1 1]",
                  square_aside[] = PATCH "[0 0 0 1 0 0 0 0 1 1 0 1]";
static struct estimate opposed_F, adjacent_F;

static void opposed(const struct row *row)
{
    opposed_F = exchange(row, unit_square, square_above, square_below, 1);
}
static void opposed_rectangles(const struct row *row)
{
    exchange(row, two_by_one, PATCH "[0 0 0.5 2 0 0.5 0 1 0.5 2 1 0.5]", PATCH "[0 0 0 2 0 0 0 1 0 2 1 0]", 1);
}
static void adjacent(const struct row *row)
{
    adjacent_F = exchange(row, unit_square, square_aside, square_below, 1);
}
static void closure(const struct row *row)
{
    if (opposed_F.degrees == 0 || adjacent_F.degrees == 0)
        return; // not measured this time
    check(row, "C1 + 4 C3",
          (struct estimate){opposed_F.mean + 4 * adjacent_F.mean, hypot(opposed_F.error, 4 * adjacent_F.error),
                            REPLICATES - 1},
          2 * GOAL);
}
static void disks(const struct row *row)
{
    exchange(row, unit_disk, "Shape \"disk\" \"float height\" 1", "Shape \"disk\"", 1);
}
static void sphere_to_disk(const struct row *row)
{
    exchange(row, disk_of_sphere, "Shape \"sphere\"", "Shape \"disk\" \"float height\" 2 \"float radius\" 1.5",
             2.25 / 4);
}
static void spheres(const struct row *row)
{
    exchange(row, outer_sphere,
             "Shape \"sphere\" \"float radius\" 2\nAttributeEnd\nAttributeBegin\n" BLACK "Shape \"sphere\"", NULL, 1);
}
static void strips(const struct row *row)
{
    exchange(row, strip, PATCH "[0 -4000 1 1 -4000 1 0 4000 1 1 4000 1]", NULL, 1);
}
static void cylinder(const struct row *row)
{
    exchange(row, unit_disk, "Shape \"cylinder\" \"float zmin\" 0 \"float zmax\" 2", "Shape \"disk\"", 1);
}

const struct row exchange_rows[] = {
    {"C1", "opposed unit squares, gap 1", 0.199824895698, opposed, 0, 0},
    {"C2", "opposed rectangles 2 x 1, gap 0.5", 0.508988669041, opposed_rectangles, 0, 0},
    {"C3", "perpendicular unit squares with a common edge", 0.200043776075, adjacent, 0, 0},
    {"C5", "coaxial disks, r1 = r2 = h", 0.38196601125, disks, 0, 0},
    {"C7", "sphere to a coaxial disk", 0.1, sphere_to_disk, 0, 0},
    {"C8", "outer of two concentric spheres to itself", 0.75, spheres, 0, 0},
    {"C9", "infinite parallel strips", 0.414213562373, strips, 0, 0},
    {"C11", "end of a cylinder to its side", 0.828427124746, cylinder, 0, 0},
    {"D11c", "closure of a cube's form factors", 1.0, closure, 0, 0},
    {.id = NULL},
};

TEST(exchange_factors_are_those_of_the_closed_forms)
{
    run_rows("exchange", exchange_rows);
}
