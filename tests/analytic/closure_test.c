/* SPDX-License-Identifier: MIT */
/* Energy closure of a box: what is emitted is absorbed or escapes.
 *
 *     Phi = sum over walls of (1 - rho) A E  +  A_port E_port          [lm]
 *
 * The six faces have different reflectances, one is open, a lamp hangs inside. Irradiances are means over random
 * points of each face; closure error and standard uncertainty are printed. */
#include "analytic/analytic.h"

struct wall {
    double rho;
    sr_vec3 corner, ex, ey, n; // [m] [m] [m] [1], n into the box
};

/* unit cube; the last face is open */
static const struct wall walls[6] = {
    {0.8, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},  {0.2, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
    {0.5, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},  {0.7, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}},
    {0.3, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {0, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
};

static struct drawn onto_wall(const void *context, sr_vec2 u, sr_vec2 v)
{
    const struct wall *w = context;
    sr_vec3 p = sr_mad(sr_mad(w->corner, u.x, w->ex), u.y, w->ey);
    if (w->rho > 0) // seen from inside with the grey that it has
        return (struct drawn){sr_mad(p, 1e-4f, w->n), sr_neg(w->n), (double)SR_PI / w->rho};
    struct sr_frame f = sr_frame_from_z(w->n);
    return (struct drawn){p, sr_to_world(&f, sr_warp_cosine_hemisphere(v)), (double)SR_PI};
}

/* Flux of the point lamp that leaves through the open face without meeting anything: intensity times solid angle of the
 * unit square at z = 1. Rays cannot find a point, so this part is known only by its closed form. */
static double straight_out(sr_vec3 p, double flux)
{
    double solid_angle = 0, h = 1 - (double)p.z;
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2; ++k) {
            double a = i ? 1 - (double)p.x : (double)p.x, b = k ? 1 - (double)p.y : (double)p.y;
            solid_angle += atan(a * b / (h * sqrt(a * a + b * b + h * h)));
        }
    return flux * solid_angle / (4 * (double)SR_PI);
}

/* A point lamp and others; lamp_flux is of the others. */
static void expect_closure(const char *what, sr_vec3 point, double point_flux, const char *lamp, double lamp_flux,
                           double n, double goal)
{
    char text[4096];
    int at = 0;
    for (int i = 0; i < 5; ++i) {
        const struct wall *w = &walls[i];
        sr_vec3 p[4] = {w->corner, sr_add(w->corner, w->ex), sr_add(w->corner, w->ey),
                        sr_add(sr_add(w->corner, w->ex), w->ey)};
        at += snprintf(
            text + at, sizeof text - (size_t)at,
            "Material \"diffuse\" \"spectrum reflectance\" [360 %g 830 %g] Shape \"bilinearmesh\" \"point3 P\" [",
            w->rho, w->rho);
        for (int k = 0; k < 4; ++k)
            at += snprintf(text + at, sizeof text - (size_t)at, "%g %g %g ", (double)p[k].x, (double)p[k].y,
                           (double)p[k].z);
        at += snprintf(text + at, sizeof text - (size_t)at, "]\n");
    }
    struct world w = world_of(
        "Integrator \"path\" \"integer maxdepth\" 200\nWorldBegin\nLightSource \"point\" \"point3 from\" [%.9g %.9g %.9g] \"float power\" %.9g \"float scale\" %d\n"
        "%sAttributeBegin\n%sAttributeEnd\n",
        (double)point.x, (double)point.y, (double)point.z, point_flux, point_flux > 0, text, lamp);
    double sum = straight_out(point, point_flux), variance = 0, flux = point_flux + lamp_flux;
    printf("  straight out through the open face: %.6f lm\n", sum);
    for (int i = 0; i < 6; ++i) {
        struct estimate E = scaled(mean_luminance(&w.job, onto_wall, &walls[i], n), 1 - walls[i].rho); // areas are 1
        printf("  face %d: %-8s %.6f +- %.6f lm\n", i, walls[i].rho > 0 ? "absorbs" : "lets out", E.mean, E.error);
        sum += E.mean;
        variance += E.error * E.error;
    }
    world_free(&w);
    struct row row = {.id = what, .value = flux};
    check(&row, "closure", (struct estimate){sum, sqrt(variance), REPLICATES - 1}, goal);
    EXPECT(fabs(sum - flux) < 4.9 * sqrt(variance) + 1e-5 * flux);
}

TEST(light_in_a_box_is_absorbed_or_escapes)
{
    printf("closure: lumens emitted against absorbed and escaped\n");
    expect_closure("point", (sr_vec3){0.4f, 0.6f, 0.3f}, 100, "", 0, 4096, 16 * GOAL);
    // lamps with a surface reflect all that falls on them, so that nothing is lost there
    expect_closure(
        "white ball", (sr_vec3){0.4f, 0.6f, 0.3f}, 0,
        "Translate 0.5 0.45 0.6 Material \"diffuse\" \"spectrum reflectance\" [360 1 830 1] AreaLightSource \"diffuse\" "
        "\"float power\" 100 Shape \"sphere\" \"float radius\" 0.15\n",
        100, 4096, 32 * GOAL);
    expect_closure(
        "two lamps", (sr_vec3){0.1f, 0.1f, 0.9f}, 30,
        "Translate 0.5 0.5 0.3 "
        "Material \"diffuse\" \"spectrum reflectance\" [360 1 830 1] AreaLightSource \"diffuse\" \"float power\" 70 Shape \"disk\" "
        "\"float radius\" 0.3\n",
        70, 4096, 32 * GOAL);
}
