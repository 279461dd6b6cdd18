/* SPDX-License-Identifier: MIT */
/* Fresnel's reflectances, panes, refraction and basic radiance, as a ray of a camera sees them. */
#include "analytic/analytic.h"

#define DEGREE (3.14159265358979323846 / 180)

/* One ray, theta from the normal of the plane z = 0, that meets it in the origin; from below if it starts there. */
static struct drawn slanted(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)u, (void)v;
    double theta = *(const double *)context * DEGREE;
    sr_vec3 d = {(float)sin(theta), 0, (float)-cos(theta)};
    return (struct drawn){sr_scale(-0.5f, d), d, 1};
}

#define ABOVE "Shape \"disk\" \"float height\" 1 \"float radius\" 1e4\n"
#define BELOW "Shape \"disk\" \"float height\" -1 \"float radius\" 1e4\n"

/* Radiance of the ray when the plane is of the material and a glowing sheet is above or below; averaged over what
 * chance there is. */
static struct estimate plane(const char *material, bool glows_above, double theta, double n)
{
    struct world w = world_of("Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nAttributeBegin\n" BLACK GLOW_BOTH
                              "%sAttributeEnd\n"
                              "Material %s\nShape \"disk\" \"float radius\" 1e3\n",
                              glows_above ? ABOVE : BELOW, material);
    struct estimate e = mean_luminance(&w.job, slanted, &theta, n);
    world_free(&w);
    return e;
}

static void reflected(const struct row *row)
{
    check(row, "mirror", plane("\"dielectric\" \"float eta\" 1.5", true, row->a, 32768), GOAL);
}
/* At Brewster's angle light of one polarisation is not reflected at all: the mean of the two is half of the other. */
static void brewster(const struct row *row)
{
    check(row, "mirror", scaled(plane("\"dielectric\" \"float eta\" 1.5", true, 56.309932474, 16384), 2), GOAL);
}
static void metal(const struct row *row)
{
    check(row, "mirror",
          plane("\"conductor\" \"spectrum eta\" [360 0.43 830 0.43] \"spectrum k\" [360 2.455 830 2.455]", true, row->a,
                256),
          GOAL);
}
static void pane(const struct row *row)
{
    check(row, "pane", plane("\"thindielectric\" \"float eta\" 1.52 \"bool unbiased\" true", false, row->a, 8192),
          GOAL);
    struct estimate R = plane("\"thindielectric\" \"float eta\" 1.52 \"bool unbiased\" true", true, row->a, 16384);
    check(row, "1 - R", (struct estimate){1 - R.mean, R.error, R.degrees}, GOAL);
}
static void single_pane(const struct row *row)
{
    check(row, "pane", plane("\"thindielectric\" \"float eta\" 1.5 \"bool unbiased\" true", true, row->a, 16384), GOAL);
}
/* Lambertian incidence: the mean reflectance, weighted with the cosine. a < 0: from inside. */
static struct drawn cosine(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)u;
    sr_vec3 d = sr_neg(sr_warp_cosine_hemisphere(v));
    if (*(const double *)context < 0)
        d.z = -d.z;
    return (struct drawn){sr_scale(-0.5f, d), d, 1};
}
static void diffuse_reflectance(const struct row *row)
{
    bool is_inside = row->a < 0;
    struct world w = world_of("Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nAttributeBegin\n" BLACK GLOW_BOTH
                              "%sAttributeEnd\n"
                              "Material \"dielectric\" \"float eta\" 1.5\nShape \"disk\" \"float radius\" 1e6\n",
                              is_inside ? "Shape \"disk\" \"float height\" -1 \"float radius\" 1e6\n"
                                        : "Shape \"disk\" \"float height\" 1 \"float radius\" 1e6\n");
    check(row, "mirror", mean_luminance(&w.job, cosine, &row->a, 65536), is_inside ? 3 * GOAL : 16 * GOAL);
    world_free(&w);
}
/* A smooth coat over a Lambertian base under a uniform sky. */
static void coated(const struct row *row)
{
    struct world w = world_of(
        "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nLightSource \"infinite\" \"float scale\" 1\n"
        "Material \"coateddiffuse\" \"spectrum reflectance\" [360 0.5 830 0.5] \"float roughness\" 0 \"float eta\" 1.5 "
        "\"float thickness\" 1e-6 \"integer maxdepth\" 1000\nShape \"disk\"\n");
    check(row, "sky", mean_luminance(&w.job, slanted, &row->a, 65536), 2 * GOAL);
    world_free(&w);
}

/* Where does the refracted ray land, 1 m below the surface? A black-white edge is moved until it meets the ray. */
static void snell(const struct row *row)
{
    double lo = 0, hi = 2, theta = 60;
    for (int i = 0; i < 24; ++i) {
        double edge = (lo + hi) / 2;
        struct world w =
            world_of("Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nAttributeBegin\n" BLACK GLOW_BOTH
                     "Shape \"bilinearmesh\" \"point3 P\" [%.9g -1 -1 10 -1 -1 %.9g 1 -1 10 1 -1]\nAttributeEnd\n"
                     "Material \"dielectric\" \"float eta\" 1.5 Shape \"disk\" \"float radius\" 1e3\n",
                     edge, edge);
        *(mean_luminance(&w.job, slanted, &theta, 8).mean > 0 ? &lo : &hi) = edge;
        world_free(&w);
    }
    check(row, "edge", (struct estimate){atan(lo) / DEGREE, 0, 1}, GOAL);
}
/* A camera in glass looks out, and one outside looks in. */
static struct drawn out_of_glass(const void *context, sr_vec2 u, sr_vec2 v)
{
    (void)context, (void)u, (void)v;
    return (struct drawn){{0, 0, -0.5f}, {0, 0, 1}, 1};
}
static void basic_radiance(const struct row *row)
{
    struct world w =
        world_of("Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nAttributeBegin\n" BLACK GLOW_BOTH ABOVE
                 "AttributeEnd\n"
                 "Material \"dielectric\" \"float eta\" 1.5\nShape \"disk\" \"float radius\" 1e3\n");
    check(row, "from glass", mean_luminance(&w.job, out_of_glass, NULL, 16384), GOAL);
    world_free(&w);
}

const struct row fresnel_rows[] = {
    {"G1.0", "dielectric n = 1.5, 0 deg", 0.04, reflected, 0, 0},
    {"G1.45", "45 deg", 0.0502399110122, reflected, 45, 0},
    {"G1.80", "80 deg", 0.387704354691, reflected, 80, 0},
    {"G2s", "Rs at Brewster's angle, which is G2", 0.147928994083, brewster, 0, 0},
    {"G3.Au.0", "conductor n = 0.43, k = 2.455, 0 deg", 0.786915760491, metal, 0, 0},
    {"G3.Au.60", "60 deg", 0.788131903203, metal, 60, 0},
    {"G4", "diffuse external reflectance, n = 1.5", 0.0917779593424, diffuse_reflectance, 1, 0},
    {"G5", "diffuse internal reflectance, n = 1.5", 0.596345759708, diffuse_reflectance, -1, 0},
    {"G6.0", "smooth coat over Lambert 0.5, 0 deg", 0.316070886659, coated, 0, 0},
    {"G6.60", "60 deg", 0.351112787571, coated, 60, 0},
    {"G7.1", "pane n = 1.5 [R, mean of G7.1s and G7.1p], 60 deg", (0.300145787776 + 0.00359739276616) / 2, single_pane,
     60, 0},
    {"G9.0", "pane n = 1.52: transmittance, 0 deg", 0.918318028033, pane, 0, 0},
    {"G9.30", "30 deg", 0.91595731338, pane, 30, 0},
    {"G9.45", "45 deg", 0.902528262167, pane, 45, 0},
    {"G9.60", "60 deg", 0.843470671821, pane, 60, 0},
    {"G11", "refraction of 60 deg into n = 1.5 [deg]", 35.2643896828, snell, 0, 0},
    {"G12", "basic radiance in glass, normal", 2.16, basic_radiance, 0, 0},
    {.id = NULL},
};

TEST(fresnel_surfaces_pass_and_turn_back_what_the_closed_forms_say)
{
    run_rows("fresnel", fresnel_rows);
}
