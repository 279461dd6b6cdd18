/* SPDX-License-Identifier: MIT */
/* Nicodemus' nine reflectances: against published figures, closed forms and each other. */
#include "specimens.h"

static struct sr_reflectance cubature(const char *words, const char *from, const char *to, double tolerance)
{
    struct sr_specimen s = specimen(words);
    struct sr_beam i = beam(from), r = beam(to);
    struct sr_reflectance out = {0};
    struct sr_error error = {0};
    if (sr_reflectance_cubature(&s, SR_BLACK + 550, &i, &r, tolerance, &out, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", words, error.text);
    return out;
}

static struct sr_reflectance monte_carlo(const char *words, const char *from, const char *to, uint64_t samples)
{
    struct sr_specimen s = specimen(words);
    struct sr_beam i = beam(from), r = beam(to);
    struct sr_reflectance out = {0};
    struct sr_error error = {0};
    if (sr_reflectance_monte_carlo(&s, SR_BLACK + 550, &i, &r, samples, 5, &out, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", words, error.text);
    return out;
}

/* Trowbridge-Reitz, alpha = 0.3, F = 1, height-correlated: light from 30 deg, cones of 5 deg, the second about the
 * mirror's direction. Figures to ten digits by two grids of a product quadrature, made for this comparison by other
 * code. */
#define GGX "microfacet distribution=ggx masking=smith fresnel=one alpha_x=0.3 alpha_y=0.3"
static const struct nine {
    const char *from, *to;
    double value;
} nine[] = {
    {"direction:30", "direction:30,180", 1.1616298162}, {"direction:30", "cone:30,180,5", 0.0235212103},
    {"direction:30", "hemisphere", 0.8638728955},       {"cone:30,0,5", "direction:30,180", 1.1381176095},
    {"cone:30,0,5", "cone:30,180,5", 0.0230671691},     {"cone:30,0,5", "hemisphere", 0.8637267097},
    {"hemisphere", "direction:30,180", 0.2749792831},   {"hemisphere", "cone:30,180,5", 0.0056819708},
    {"hemisphere", "hemisphere", 0.8468714436},
};

TEST(nine_reflectances_to_eight_digits)
{
    for (int k = 0; k < 9; ++k) {
        struct sr_reflectance r = cubature(GGX, nine[k].from, nine[k].to, 1e-8);
        EXPECT(r.has_converged);
        double digits = k == 1 || k == 4 || k == 7 ? 0.6e-10 : 0;
        EXPECT_NEAR(r.value[0], nine[k].value, fmax(4e-9 * nine[k].value, digits));
        EXPECT_NEAR(r.value[SR_LAMBDA_COUNT - 1], r.value[0], 1e-15);
    }
}

TEST(nine_reflectances_by_monte_carlo)
{
    for (int k = 0; k < 9; ++k) {
        struct sr_reflectance r = monte_carlo(GGX, nine[k].from, nine[k].to, 40000);
        EXPECT(fabs(r.value[0] - nine[k].value) <= 4 * r.error[0] + 2e-7 * nine[k].value);
        EXPECT(r.error[0] < 0.02 * nine[k].value);
        EXPECT(k == 0 || r.error[0] > 0);
    }
}

/* Reciprocity: #7 pi = #3 and #8 pi / Omega_r = #6; #4 = #2 / Omega_r in this symmetric geometry; #9 is the mean of #3;
 * narrow cones tend to #1. */
TEST(nine_reflectances_obey_their_identities)
{
    double value[9], projected = PI * pow(sin(5 * PI / 180), 2) * cos(30 * PI / 180);
    for (int k = 0; k < 9; ++k) {
        struct sr_reflectance r = cubature(GGX, nine[k].from, nine[k].to, 1e-6);
        value[k] = r.value[0];
        double to = k % 3 == 0 ? 0 : k % 3 == 1 ? projected : PI, from = k / 3 == 0 ? 0 : k / 3 == 1 ? projected : PI;
        EXPECT_NEAR(r.projected_to, to, 1e-15);
        EXPECT_NEAR(r.projected_from, from, 1e-15);
        EXPECT_RELATIVE(r.factor[0], value[k] * PI / (to > 0 ? to : 1), 1e-12);
        EXPECT_EQUAL_TEXT(r.unit, k % 3 == 0 ? "sr^-1" : "1");
    }
    EXPECT_RELATIVE(value[6] * PI, value[2], 2e-6);
    EXPECT_RELATIVE(value[7] * PI / projected, value[5], 2e-6);
    EXPECT_RELATIVE(value[1] / projected, value[3], 2e-6);
    double x[16], w[16], mean = 0;
    sr_gauss_legendre(16, 0, 1, x, w); // over sin^2 theta
    for (int i = 0; i < 16; ++i) {
        char from[40];
        snprintf(from, sizeof from, "direction:%.17g", asin(sqrt(1 - x[i] * x[i])) * 180 / PI);
        mean += w[i] * 2 * x[i] * cubature(GGX, from, "hemisphere", 1e-8).value[0];
    }
    EXPECT_RELATIVE(mean, value[8], 2e-6);
    double before = 1;
    for (double half = 2; half > 0.1; half /= 2) {
        char from[40], to[40];
        snprintf(from, sizeof from, "cone:30,0,%g", half);
        snprintf(to, sizeof to, "cone:30,180,%g", half);
        struct sr_reflectance r = cubature(GGX, from, to, 1e-5);
        double away = fabs(r.value[0] / r.projected_to / value[0] - 1);
        EXPECT(away < 0.3 * before); // as half^2
        before = away;
    }
}

TEST(names_of_nine)
{
    EXPECT_EQUAL_TEXT(cubature(GGX, "direction:30", "direction:30,180", 1e-3).name, "bidirectional reflectance");
    EXPECT_EQUAL_TEXT(cubature(GGX, "direction:30", "cone:30,180,5", 1e-3).name, "directional-conical reflectance");
    EXPECT_EQUAL_TEXT(cubature(GGX, "direction:30", "hemisphere", 1e-3).name, "directional-hemispherical reflectance");
    EXPECT_EQUAL_TEXT(cubature(GGX, "cone:30,0,5", "direction:30,180", 1e-3).name, "conical-directional reflectance");
    EXPECT_EQUAL_TEXT(cubature("diffuse", "cone:30,0,5", "cone:30,180,5", 1e-2).name, "biconical reflectance");
    EXPECT_EQUAL_TEXT(cubature("diffuse", "cone:30,0,5", "hemisphere", 1e-2).name, "conical-hemispherical reflectance");
    EXPECT_EQUAL_TEXT(cubature("diffuse", "hemisphere", "direction:30", 1e-3).name,
                      "hemispherical-directional reflectance");
    EXPECT_EQUAL_TEXT(cubature("diffuse", "hemisphere", "cone:30,180,5", 1e-2).name,
                      "hemispherical-conical reflectance");
    EXPECT_EQUAL_TEXT(cubature("diffuse", "hemisphere", "hemisphere", 1e-2).name, "bihemispherical reflectance");
}

/* Lambert: A / pi, A Omega_r / pi or A; the factor is A in every geometry. */
TEST(lambert_has_one_factor)
{
    static const char *const beams[] = {"direction:20,70", "cone:50,10,15", "cone:75,200,15", "hemisphere"};
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            struct sr_reflectance r = cubature("diffuse reflectance=0.3", beams[i], beams[j], 1e-7);
            EXPECT(r.has_converged);
            EXPECT_RELATIVE(r.factor[0], 0.3, 1e-8);
            r = monte_carlo("diffuse reflectance=0.3", beams[i], beams[j], 2000);
            EXPECT(fabs(r.factor[0] - 0.3) <= 4 * r.error[0] * r.factor[0] / r.value[0] + 1e-6);
        }
    struct sr_reflectance r = cubature("diffuse reflectance=0.5", "direction:30", "cone:30,180,5", 1e-9);
    EXPECT_NEAR(r.value[0], 0.0032892180, 0.6e-10);
}

/* A smooth conductor and a pane: Fresnel's figure where the mirror's direction is gathered, nothing beside it. */
TEST(mirrors_are_counted_where_they_land)
{
    const char *metal = "conductor eta=0.43 k=2.455";
    const double R0 = 0.786915760491, R60 = 0.788131903203; // complex Fresnel formulas
    EXPECT_RELATIVE(cubature(metal, "direction:0", "hemisphere", 1e-9).value[0], R0, 1e-9);
    EXPECT_RELATIVE(cubature(metal, "direction:60,15", "hemisphere", 1e-9).value[0], R60, 1e-9);
    EXPECT_RELATIVE(cubature(metal, "direction:60", "cone:60,180,1", 1e-9).value[0], R60, 1e-9);
    EXPECT_NEAR(cubature(metal, "direction:60", "cone:60,178,1", 1e-9).value[0], 0, 1e-12);
    EXPECT_RELATIVE(cubature(metal, "hemisphere", "direction:60", 1e-9).value[0], R60 / PI, 1e-9);
    EXPECT_NEAR(cubature(metal, "direction:60", "direction:20", 1e-9).value[0], 0, 0);
    // from a cone into the mirrored one everything, into one twice as wide the same, into half of it less
    double same = cubature(metal, "cone:60,0,2", "cone:60,180,2", 1e-7).value[0];
    double wide = cubature(metal, "cone:60,0,2", "cone:60,180,4", 1e-7).value[0];
    double narrow = cubature(metal, "cone:60,0,2", "cone:60,180,1", 1e-7).value[0];
    EXPECT_RELATIVE(same, R60, 1e-3);
    EXPECT_RELATIVE(wide, same, 1e-6);
    EXPECT_RELATIVE(narrow, R60 * pow(sin(1 * PI / 180) / sin(2 * PI / 180), 2), 1e-3);
    struct sr_reflectance mc = monte_carlo(metal, "cone:60,0,2", "cone:60,180,1", 20000);
    EXPECT(fabs(mc.value[0] - narrow) < 4 * mc.error[0]);

    struct sr_specimen s = specimen(metal);
    struct sr_beam from = beam("direction:60"), to = beam("direction:60,180");
    struct sr_reflectance out;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_reflectance_cubature(&s, SR_BLACK + 550, &from, &to, 1e-6, &out, &error), SR_ERROR_USAGE);
    EXPECT(strstr(error.text, "delta") != NULL);
}

/* F + (1 - F) rho (1 - Fi) / (1 - rho Fi): a clear smooth coat of n = 1.5 over rho = 0.5 (Saunderson 1942). */
TEST(coated_paint_by_both_ways)
{
    const char *paint = "coated_diffuse reflectance=0.5 thickness=0 coat_eta=1.5 max_depth=100";
    static const double theta[] = {0, 60}, expected[] = {0.316070886659, 0.351112787571};
    for (int k = 0; k < 2; ++k) {
        char from[40];
        snprintf(from, sizeof from, "direction:%g", theta[k]);
        struct sr_reflectance r = cubature(paint, from, "hemisphere", 1e-7);
        EXPECT(r.has_converged);
        EXPECT_RELATIVE(r.value[0], expected[k], 1e-5);
        struct sr_reflectance mc = monte_carlo(paint, from, "hemisphere", 20000);
        EXPECT(fabs(mc.value[0] - r.value[0]) <= 4 * mc.error[0] + 1e-6);
    }
}

/* What is random is refused by cubature and measured by Monte Carlo: a lacquer that scatters, below a white base,
 * absorbs nothing, so that all light returns. */
TEST(random_walks_go_by_monte_carlo)
{
    const char *lacquer = "coated_diffuse reflectance=1 albedo=1 thickness=0.5 max_depth=100";
    struct sr_specimen s = specimen(lacquer);
    struct sr_beam from = beam("direction:30"), to = beam("hemisphere");
    struct sr_reflectance out;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_reflectance_cubature(&s, SR_BLACK + 550, &from, &to, 1e-4, &out, &error), SR_ERROR_USAGE);
    EXPECT(strstr(error.text, "random") != NULL);
    struct sr_reflectance hemisphere = monte_carlo(lacquer, "direction:30", "hemisphere", 20000);
    EXPECT(fabs(hemisphere.value[0] - 1) < 0.002 + 4 * hemisphere.error[0]);
    // the hemisphere by cones of 90 degrees, which f itself is asked for
    struct sr_reflectance cone = monte_carlo(lacquer, "direction:30", "cone:0,0,90", 40000);
    EXPECT(fabs(cone.value[0] - hemisphere.value[0]) < 4 * hypot(cone.error[0], hemisphere.error[0]));
}

/* Light adds up: the reflectance of a sum is the sum of the reflectances. */
TEST(sums_add_up)
{
    static const char *const to[] = {"direction:40,150", "cone:40,180,10", "hemisphere"};
    for (int k = 0; k < 3; ++k) {
        double a = cubature("diffuse reflectance=0.8", "direction:40", to[k], 1e-8).value[0];
        double b = cubature(GGX, "direction:40", to[k], 1e-8).value[0];
        double both = cubature("0.25*diffuse reflectance=0.8 + 0.5*" GGX, "direction:40", to[k], 1e-8).value[0];
        EXPECT_RELATIVE(both, 0.25 * a + 0.5 * b, 3e-8);
    }
}

/* Narrow lobes are found: the albedo of ever smoother facets tends to 1. */
TEST(narrow_lobes_are_found)
{
    static const double alpha[] = {0.1, 0.01, 0.002};
    for (int k = 0; k < 3; ++k)
        for (int theta = 0; theta < 80; theta += 26) {
            char words[200], from[40];
            snprintf(words, sizeof words, "microfacet fresnel=one alpha_x=%g alpha_y=%g", alpha[k], alpha[k]);
            snprintf(from, sizeof from, "direction:%d,33", theta);
            struct sr_reflectance r = cubature(words, from, "hemisphere", 1e-6);
            struct sr_reflectance mc = monte_carlo(words, from, "hemisphere", 4000);
            EXPECT(r.has_converged);
            EXPECT(fabs(r.value[0] - mc.value[0]) <=
                   4 * mc.error[0] + 8.0 / 4000); // a loss may be too rare to be drawn
            EXPECT(r.value[0] < 1 + 1e-6 && r.value[0] > 1 - 6 * alpha[k]);
        }
}

/* Grey stays grey: XYZ of a reflectance of 0.3 is 0.3 of the illuminant's white; gold is yellow. */
TEST(colour_under_an_illuminant)
{
    struct sr_spd d65 = sr_spd_named("stdillum-D65");
    struct sr_beam from = beam("direction:8"), to = beam("hemisphere"), cone = beam("cone:45,0,10");
    struct sr_specimen grey = specimen("diffuse reflectance=0.3"),
                       gold = specimen("conductor eta=metal-Au-eta k=metal-Au-k");
    struct sr_reflectance_colour c;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_reflectance_colour(&grey, &d65, &from, &cone, 1e-6, &c, &error), SR_OK);
    EXPECT_RELATIVE(c.xyz[1], 0.3, 1e-7);
    EXPECT_RELATIVE(c.xyz[0], 0.3 * 0.95047, 2e-4); // CIE's white point of D65
    EXPECT_RELATIVE(c.xyz[2], 0.3 * 1.08883, 2e-4);
    EXPECT_RELATIVE(c.luminous, 0.3 * pow(sin(10 * PI / 180), 2) * cos(PI / 4), 1e-7);
    EXPECT_EQUAL_INT(sr_reflectance_colour(&gold, &d65, &from, &to, 1e-6, &c, &error), SR_OK);
    EXPECT(c.has_converged && c.luminous > 0.6 && c.luminous < 0.9);
    EXPECT_RELATIVE(c.luminous, c.xyz[1], 1e-12);
    EXPECT(c.xyz[2] / 1.08883 < 0.6 * c.xyz[1]);
}

/* Two ways that share nothing but the model: its twin integrated, and its floats sampled. */
TEST(every_model_by_both_ways)
{
    static const char *const to[] = {"hemisphere", "cone:40,200,25"};
    int compared = 0;
    for (int m = 0; sr_bsdf_models[m]; ++m)
        for (int k = 0; k < 2; ++k) {
            const char *name = sr_bsdf_models[m]->name;
            static struct sr_arena arena;
            struct sr_specimen s;
            struct sr_error error = {0};
            struct sr_beam i = beam("direction:50,20"), r = beam(to[k]);
            struct sr_reflectance a, b;
            if (sr_specimen_read(&arena, 1, &name, &s, (struct sr_log){0}, &error) != SR_OK)
                continue; // it needs a file
            if (sr_reflectance_cubature(&s, SR_BLACK + 550, &i, &r, 1e-5, &a, &error) != SR_OK)
                continue; // random
            EXPECT_EQUAL_INT(sr_reflectance_monte_carlo(&s, SR_BLACK + 550, &i, &r, 20000, 3, &b, &error), SR_OK);
            if (!a.has_converged || fabs(a.value[0] - b.value[0]) > 4.5 * b.error[0] + 2e-5 * a.value[0])
                test_fail(__FILE__, __LINE__, "%s into %s: %.8g +- %.1e by cubature, %.6g +- %.1e by drawing", name,
                          to[k], a.value[0], a.error[0], b.value[0], b.error[0]);
            ++compared;
        }
    EXPECT(compared >= 60);
}

TEST(beams_are_read_or_refused)
{
    struct sr_beam b;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_beam_read("direction:30", &b, &error), SR_OK);
    EXPECT(b.kind == SR_BEAM_DIRECTION && b.theta == 30 && b.phi == 0);
    EXPECT_EQUAL_INT(sr_beam_read("direction:0,-90", &b, &error), SR_OK);
    EXPECT(b.phi == -90);
    EXPECT_EQUAL_INT(sr_beam_read("cone:30,180,2.5", &b, &error), SR_OK);
    EXPECT(b.kind == SR_BEAM_CONE && b.theta == 30 && b.phi == 180 && b.half_angle == 2.5);
    EXPECT_EQUAL_INT(sr_beam_read("hemisphere", &b, &error), SR_OK);
    EXPECT(b.kind == SR_BEAM_HEMISPHERE);
    static const char *const wrong[] = {"",
                                        "30",
                                        "direction:",
                                        "direction:90",
                                        "cone:30,0",
                                        "cone:30,0,61",
                                        "cone:30,0,0",
                                        "direction:1,2,3",
                                        "cone:a,0,5",
                                        "hemispheres",
                                        "direction:-1",
                                        "direction:nan",
                                        "cone:1,2,3,4",
                                        "cone:30,0,5x"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
        struct sr_error e = {0};
        if (sr_beam_read(wrong[i], &b, &e) != SR_ERROR_USAGE)
            test_fail(__FILE__, __LINE__, "\"%s\" is taken for a beam", wrong[i]);
        EXPECT(e.text[0] != 0);
    }
}
