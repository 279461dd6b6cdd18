/* SPDX-License-Identifier: MIT */
/* Klems' matrices and tensor trees: sums over patches that are known. */
#include "fixtures.h"

static const struct {
    const char *name;
    int count;
} bases[3] = {{"LBNL/Klems Full", 145}, {"LBNL/Klems Half", 77}, {"LBNL/Klems Quarter", 41}};

static void matrix(struct bytes *b, const char *wavelength, const char *way, int basis, double diagonal, double other)
{
    xml_block_begin(b, wavelength, way, bases[basis].name, false);
    for (int i = 0; i < bases[basis].count; ++i)
        for (int j = 0; j < bases[basis].count; ++j)
            print(b, "%.7g%s", i == j ? diagonal : other, j + 1 < bases[basis].count ? ", " : ",\n");
    xml_block_end(b);
}

/* Projected solid angles add up to pi: the same number everywhere is Lambert's law. */
TEST(klems_constant_matrix_is_lambert_in_each_basis)
{
    for (int basis = 0; basis < 3; ++basis) {
        struct bytes b = {0};
        struct sr_arena arena = {0};
        xml_begin(&b, "Columns");
        matrix(&b, "Visible", "Reflection Front", basis, 0.6 / PI, 0.6 / PI);
        matrix(&b, "Solar", "Reflection Front", basis, 9, 9);
        matrix(&b, "Visible", "Transmission Front", basis, 0.3 / PI, 0.3 / PI);
        xml_end(&b);
        const struct sr_measured *m = parse(&arena, &b);
        EXPECT_EQUAL_INT(sr_measured_sides(m), SR_MEASURED_REFLECTION | SR_MEASURED_TRANSMISSION);
        for (int theta = 0; theta < 90; theta += 11) {
            EXPECT_NEAR(sr_measured_albedo(m, direction(theta, 70), SR_MEASURED_REFLECTION, SR_BLACK + 500, 8)[0], 0.6,
                        1e-5);
            EXPECT_NEAR(sr_measured_albedo(m, direction(theta, 70), SR_MEASURED_TRANSMISSION, SR_BLACK + 500, 8)[0],
                        0.3, 1e-5);
            // from behind nothing was measured but what passes, which is the same both ways
            EXPECT_NEAR(sr_measured_albedo(m, direction(180 - theta, 70), SR_MEASURED_REFLECTION, SR_BLACK + 500, 8)[0],
                        0, 0);
            EXPECT_NEAR(
                sr_measured_albedo(m, direction(180 - theta, 70), SR_MEASURED_TRANSMISSION, SR_BLACK + 500, 8)[0], 0.3,
                1e-5);
        }
        EXPECT_NEAR(sr_measured_f(m, direction(20, 0), direction(50, 200), SR_BLACK + 500)[0], 0.6 / PI, 1e-6);
        EXPECT_NEAR(sr_measured_f(m, direction(130, 0), direction(50, 200), SR_BLACK + 500)[0], 0.3 / PI, 1e-6);
        sr_arena_free(&arena);
        drop(&b);
    }
}

/* The diagonal holds the mirror direction, and behind the sheet the straight way on; E = B Omega of the patch. */
TEST(klems_diagonal_is_the_mirror_and_the_straight_way)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    xml_begin(&b, "Columns");
    matrix(&b, "Visible", "Reflection Front", 0, 10, 0);
    matrix(&b, "Visible", "Reflection Back", 0, 5, 0);
    matrix(&b, "Visible", "Transmission Back", 0, 20, 0);
    xml_end(&b);
    const struct sr_measured *m = parse(&arena, &b);
    static const double theta[] = {0, 10, 20, 40, 70, 82},
                        edges[][2] = {{0, 5}, {5, 15}, {15, 25}, {35, 45}, {65, 75}, {75, 90}};
    static const int phis[] = {1, 8, 16, 24, 16, 12};
    for (int i = 0; i < 6; ++i)
        for (int p = 0; p < phis[i]; ++p) {
            double phi = 360.0 * p / phis[i], lo = cos(edges[i][0] * PI / 180), hi = cos(edges[i][1] * PI / 180);
            sr_vec3 w = direction(theta[i], phi), mirror = {-w.x, -w.y, w.z}, through = {-w.x, -w.y, -w.z},
                    below = {w.x, w.y, -w.z};
            EXPECT_NEAR(sr_measured_f(m, mirror, w, SR_BLACK + 500)[0], 10, 1e-6);
            EXPECT_NEAR(sr_measured_f(m, through, below, SR_BLACK + 500)[0], 5, 1e-6);
            EXPECT_NEAR(sr_measured_f(m, w, through, SR_BLACK + 500)[0], 20, 1e-6);
            EXPECT_NEAR(sr_measured_f(m, through, w, SR_BLACK + 500)[0], 20, 1e-6); // by reciprocity
            EXPECT_RELATIVE(sr_measured_albedo(m, w, SR_MEASURED_REFLECTION, SR_BLACK + 500, 8)[0],
                            10 * PI * (lo * lo - hi * hi) / phis[i], 1e-5);
            if (i)
                EXPECT_NEAR(sr_measured_f(m, w, w, SR_BLACK + 500)[0], 0, 0);
        }
    sr_arena_free(&arena);
    drop(&b);
}

/* One number is not symmetric: light from the patch about (10, 0) deg leaves to the patch about the normal, not back.
 */
TEST(klems_columns_are_where_light_comes_from_and_rows_turn_that_round)
{
    for (int rows = 0; rows < 2; ++rows) {
        struct bytes b = {0};
        struct sr_arena arena = {0};
        xml_begin(&b, rows ? "Rows" : "Columns");
        xml_block_begin(&b, "Visible", "Reflection Front", bases[0].name, false);
        for (int i = 0; i < 145 * 145; ++i)
            print(&b, "%d ", i == 1); // first row, second column
        xml_block_end(&b);
        xml_end(&b);
        const struct sr_measured *m = parse(&arena, &b);
        sr_vec3 n = direction(0, 0), w = direction(10, 0), opposite = direction(10, 180);
        EXPECT_NEAR(sr_measured_f(m, n, opposite, SR_BLACK + 500)[0], !rows, 1e-6);
        EXPECT_NEAR(sr_measured_f(m, w, n, SR_BLACK + 500)[0], rows, 1e-6);
        sr_arena_free(&arena);
        drop(&b);
    }
}

TEST(klems_xyz_becomes_colour)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    xml_begin(&b, "Columns");
    matrix(&b, "CIE-X", "Reflection Front", 2, 0.95047 * 0.5 / PI, 0.95047 * 0.5 / PI);
    matrix(&b, "Visible", "Reflection Front", 2, 0.5 / PI, 0.5 / PI);
    matrix(&b, "CIE-Z", "Reflection Front", 2, 1.08883 * 0.5 / PI, 1.08883 * 0.5 / PI);
    xml_end(&b);
    const struct sr_measured *m = parse(&arena, &b);
    sr_spectrum f = sr_measured_f(m, direction(10, 0), direction(50, 0), wavelengths());
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        EXPECT_RELATIVE(f[i], 0.5 / PI, 0.005);
    struct sr_measured_report r;
    sr_measured_report(m, &r);
    EXPECT_EQUAL_INT(r.channels, 3);
    EXPECT_EQUAL_TEXT(r.description, "A sheet");
    sr_arena_free(&arena);
    drop(&b);
}

/* A leaf grid of 4^3 over (incidence, c, d) that rises with incidence; and a tree whose halves differ in c. */
TEST(tensor_tree_of_rank_3_is_looked_up_where_light_comes_from)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    xml_begin(&b, "TensorTree3");
    xml_block_begin(&b, "Visible", "Reflection Front", "LBNL/Shirley-Chiu", true);
    print(&b, "{ ");
    for (int i = 0; i < 64; ++i)
        print(&b, "%d ", i / 16);
    print(&b, "}\n");
    xml_block_end(&b);
    xml_end(&b);
    const struct sr_measured *m = parse(&arena, &b);
    // 1/2 - sin(theta) / 2 lies in 1/4 … 1/2 for theta < 30 deg, below 1/4 beyond
    EXPECT_NEAR(sr_measured_f(m, direction(60, 10), direction(20, 90), SR_BLACK + 500)[0], 1, 1e-6);
    EXPECT_NEAR(sr_measured_f(m, direction(60, 10), direction(40, 90), SR_BLACK + 500)[0], 0, 1e-6);
    EXPECT_NEAR(sr_measured_albedo(m, direction(20, 90), SR_MEASURED_REFLECTION, SR_BLACK + 500, 8)[0], PI, 1e-4);
    drop(&b);

    xml_begin(&b, "TensorTree3");
    xml_block_begin(&b, "Visible", "Reflection Front", "LBNL/Shirley-Chiu", true);
    print(&b, "{ {7} {7} {2} {2} {7} {7} {2} {2} }\n"); // bit 1: the second half of c, away from where light comes from
    xml_block_end(&b);
    xml_end(&b);
    m = parse(&arena, &b);
    for (int phi = 0; phi < 360; phi += 30) {
        EXPECT_NEAR(sr_measured_f(m, direction(40, phi + 180), direction(30, phi), SR_BLACK + 500)[0], 2, 1e-6);
        EXPECT_NEAR(sr_measured_f(m, direction(40, phi), direction(30, phi), SR_BLACK + 500)[0], 7, 1e-6);
        EXPECT_NEAR(sr_measured_albedo(m, direction(30, phi), SR_MEASURED_REFLECTION, SR_BLACK + 500, 8)[0], 4.5 * PI,
                    1e-4);
    }
    sr_arena_free(&arena);
    drop(&b);
}

TEST(tensor_tree_of_rank_4_knows_both_directions)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    xml_begin(&b, "TensorTree4");
    xml_block_begin(&b, "Visible", "Transmission Front", "LBNL/Shirley-Chiu", true);
    print(&b, "{ ");
    for (int i = 0; i < 16; ++i) // bit 0: x of -wi, bit 1: y of -wi, bit 2: x of wo, bit 3: y of wo
        print(&b, "{ %d } ", i);
    print(&b, "}\n");
    xml_block_end(&b);
    xml_end(&b);
    const struct sr_measured *m = parse(&arena, &b);
    // light from (+, +) is in the half of -; it leaves below to (+, -)
    EXPECT_NEAR(sr_measured_f(m, direction(140, -45), direction(40, 45), SR_BLACK + 500)[0], 0 + 0 + 4 + 0, 1e-6);
    EXPECT_NEAR(sr_measured_f(m, direction(140, 135), direction(40, -135), SR_BLACK + 500)[0], 1 + 2 + 0 + 8, 1e-6);
    sr_arena_free(&arena);
    drop(&b);
}

TEST(bsdf_xml_samples_return_no_more_light_than_they_receive)
{
    static const char *const files[] = {"2011-SA1.XML", "CS-TBK7-12_112916.xml", "SingleClear.xml",
                                        "radiance_sawtooth.xml"};
    for (int i = 0; i < 4; ++i) {
        char name[128];
        snprintf(name, sizeof name, "brdf/bsdf_xml/%s", files[i]);
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        const struct sr_measured *m;
        if (sr_measured_read(test_reference_file(name), NULL, &arena, &m, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        struct sr_measured_report r;
        sr_measured_report(m, &r);
        EXPECT(r.largest_albedo > 0.5 && r.largest_albedo <= 1);
        if (i == 2) { // a pane of 3 mm: 0.90 passes and 0.08 is reflected at normal incidence
            EXPECT_NEAR(r.scatter[0].transmitted, 0.897, 0.005);
            EXPECT_NEAR(r.scatter[0].reflected, 0.082, 0.005);
        }
        sr_arena_free(&arena);
    }
}

TEST(bsdf_xml_that_makes_no_sense_is_refused_with_the_line)
{
    struct bytes b = {0};
    print(&b, "<html></html>");
    expect_refused(&b, "WindowElement");
    drop(&b);
    print(&b, "<!DOCTYPE x [<!ENTITY a \"b\">]><WindowElement>&a;</WindowElement>");
    expect_refused(&b, "DOCTYPE");
    drop(&b);
    xml_begin(&b, "Columns");
    size_t begun = b.size;
    expect_refused(&b, "no element found");
    xml_end(&b);
    expect_refused(&b, "no WavelengthDataBlock");
    b.size = begun;
    matrix(&b, "Visible", "Reflection Front", 2, 1, 1);
    b.data[b.size - 100] = 'x';
    xml_end(&b);
    expect_refused(&b, "ScatteringData: a number is expected");
    b.size = begun;
    xml_block_begin(&b, "Visible", "Reflection Front", "LBNL/Klems Full", false);
    for (int i = 0; i < 145 * 145 - 1; ++i)
        print(&b, "0.25 ");
    xml_block_end(&b);
    xml_end(&b);
    expect_refused(&b, "21024 numbers");
    b.size = begun;
    xml_block_begin(&b, "Visible", "Sideways", "LBNL/Klems Full", false);
    xml_block_end(&b);
    xml_end(&b);
    expect_refused(&b, "Sideways");
    drop(&b);
    static const char *const trees[][2] = {{"{ 1 2 3 }", "power of 8"},  {"{ {1} {2}", "'{' is expected"},
                                           {"1", "'{' is expected"},     {"{ nan }", "values in a cell"},
                                           {"{ 1 } 2", "after the end"}, {"{ 1e99 }", "finite"}};
    for (int i = 0; i < 6; ++i) {
        xml_begin(&b, "TensorTree3");
        xml_block_begin(&b, "Visible", "Reflection Front", "LBNL/Shirley-Chiu", true);
        print(&b, "%s", trees[i][0]);
        xml_block_end(&b);
        xml_end(&b);
        expect_refused(&b, trees[i][1]);
        drop(&b);
    }
    xml_begin(&b, "TensorTree4");
    xml_block_begin(&b, "Visible", "Reflection Front", "LBNL/Shirley-Chiu", true);
    for (int i = 0; i < 100000; ++i)
        print(&b, "{");
    xml_block_end(&b);
    xml_end(&b);
    expect_refused(&b, "levels");
    drop(&b);
}
