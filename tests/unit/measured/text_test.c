/* SPDX-License-Identifier: MIT */
/* Text: tables, ASTM, Cornell's goniometer, ABg. */
#include "fixtures.h"

static struct gloss matte = {.base = 0.6f, .lobe = 0.2f, .exponent = 4};

static void compare(const struct sr_measured *m, sr_measured_source f, void *user, double tolerance)
{
    struct sr_rng rng = sr_rng_seed(1, 1);
    for (int n = 0; n < 3000; ++n) {
        sr_vec3 wo = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        if (wo.z > 0.4f && wi.z > 0.4f) // half vectors turn fast between two grazing directions
            EXPECT_NEAR(sr_measured_f(m, wo, wi, SR_BLACK + 550)[0], f(user, wo, wi, SR_BLACK + 550)[0], tolerance);
    }
}

TEST(table_over_a_grid_is_interpolated_linearly)
{
    struct bytes b = table_file(gloss_f, &matte, 5, "theta_i phi_i theta_o phi_o f\n");
    struct sr_arena arena = {0};
    const struct sr_measured *m = parse(&arena, &b);
    compare(m, gloss_f, &matte, 0.004); // step^2 / 8 times the second derivative of h_z^4
    EXPECT_NEAR(sr_measured_f(m, direction(35, 20), direction(20, 80), SR_BLACK + 550)[0],
                gloss_f(&matte, direction(35, 60), direction(20, 0), SR_BLACK + 550)[0],
                1e-6); // at a node, turned and mirrored
    struct sr_measured_report r;
    sr_measured_report(m, &r);
    EXPECT(r.is_isotropic && r.channels == 1 && !r.is_spectral);
    EXPECT_NEAR(r.theta_i_max, 85, 1e-3);
    EXPECT(strstr(r.note, "degrees"));
    sr_arena_free(&arena);
    drop(&b);
}

/* The same numbers in another convention differ by the factor that is known. */
TEST(table_conventions_are_taken_from_the_file_or_from_the_options)
{
    struct bytes plain = table_file(gloss_f, &matte, 15, "theta_i phi_i theta_o phi_o f\n");
    struct bytes cosine = table_file(gloss_f, &matte, 15, "# quantity: cosine\n# angles: degrees\n");
    struct bytes factor = table_file(gloss_f, &matte, 15, "# quantity: factor\n");
    struct sr_arena arena = {0};
    sr_vec3 wo = direction(30, 0), wi = direction(45, 90);
    float f = sr_measured_f(parse(&arena, &plain), wo, wi, SR_BLACK + 550)[0];
    EXPECT(f > 0.1f);
    EXPECT_RELATIVE(sr_measured_f(parse(&arena, &cosine), wo, wi, SR_BLACK + 550)[0], (double)f / cos(PI / 6), 1e-5);
    EXPECT_RELATIVE(sr_measured_f(parse(&arena, &factor), wo, wi, SR_BLACK + 550)[0], (double)f / PI, 1e-5);
    EXPECT_RELATIVE(
        sr_measured_f(parse_with(&arena, &plain, (struct sr_measured_options){.quantity = SR_MEASURED_FACTOR}), wo, wi,
                      SR_BLACK + 550)[0],
        (double)f / PI, 1e-5);
    EXPECT_RELATIVE(
        sr_measured_f(parse_with(&arena, &factor, (struct sr_measured_options){.quantity = SR_MEASURED_BSDF}), wo, wi,
                      SR_BLACK + 550)[0],
        f, 1e-5);
    struct sr_measured_report r;
    sr_measured_report(parse(&arena, &cosine), &r);
    EXPECT_EQUAL_TEXT(r.quantity, "BSDF times cosine");
    EXPECT_EQUAL_TEXT(r.note, "");
    drop(&plain);
    drop(&cosine);
    drop(&factor);
    sr_arena_free(&arena);
}

TEST(table_of_lines_for_each_wavelength_becomes_spectra)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    print(&b, "lambda;f;theta_o;phi_o;theta_i\r\n");
    for (int l = 700; l >= 400; l -= 100) // in any order
        for (int i = 0; i <= 80; i += 40)
            for (int o = 0; o <= 80; o += 40)
                for (int p = 0; p <= 180; p += 90)
                    print(&b, "%d; %g; %d; %d; %d\r\n", l, 0.001 * l, o, p, i);
    const struct sr_measured *m = parse(&arena, &b);
    EXPECT_NEAR(sr_measured_f(m, direction(20, 0), direction(30, 0), SR_BLACK + 550)[0], 0.55, 1e-5);
    EXPECT_NEAR(sr_measured_f(m, direction(20, 0), direction(30, 0), SR_BLACK + 350)[0], 0.4, 1e-5);
    EXPECT_NEAR(sr_measured_f(m, direction(20, 0), direction(30, 0), SR_BLACK + 900)[0], 0.7, 1e-5);
    print(&b, "450; 1; 0; 0; 0\n");
    expect_refused(&b, "wavelengths");
    drop(&b);
    sr_arena_free(&arena);
}

TEST(table_with_light_that_passes_keeps_both_sides_apart)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    print(&b, "theta_i,phi_i,theta_o,phi_o,f\n");
    for (int i = 0; i <= 80; i += 20)
        for (int o = 0; o <= 180; o += 20)
            for (int p = 0; p <= 180; p += 60)
                print(&b, "%d,0,%d,%d,%g\n", i, o, p, o < 90 ? 0.2 : 0.05);
    const struct sr_measured *m = parse(&arena, &b);
    EXPECT_EQUAL_INT(sr_measured_sides(m), SR_MEASURED_REFLECTION | SR_MEASURED_TRANSMISSION);
    for (int o = 1; o < 180; o += 4) {
        EXPECT_NEAR(sr_measured_f(m, direction(o, 33), direction(50, 0), SR_BLACK + 550)[0], o < 90 ? 0.2 : 0.05, 1e-6);
        EXPECT_NEAR(sr_measured_f(m, direction(o, 33), direction(130, 0), SR_BLACK + 550)[0], o > 90 ? 0.2 : 0.05,
                    1e-6);
    }
    EXPECT_NEAR(sr_measured_albedo(m, direction(30, 0), SR_MEASURED_TRANSMISSION, SR_BLACK + 550, 64)[0], 0.05 * PI,
                2e-4);
    drop(&b);
    sr_arena_free(&arena);
}

static sr_spectrum grooved_f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    (void)user;
    (void)lambda;
    float through = wo.z * wi.z < 0 ? 0.3f : 1;
    sr_vec3 h = {wo.x + wi.x, wo.y + wi.y, fabsf(wo.z) + fabsf(wi.z)};
    h = sr_normalize(h);
    return SR_BLACK + through * 0.3f * (0.2f + 0.3f * h.x + h.y * h.y);
}

TEST(table_written_reads_back_isotropic_and_not)
{
    char path[512];
    snprintf(path, sizeof path, "%s/table.txt", test_folder());
    struct sr_error error = {0};
    struct sr_arena arena = {0};
    const struct sr_measured *m;
    struct sr_measured_table_grid grid = {
        .theta_count = 24, .phi_count = 25, .lambda_count = 3, .lambda_min = 400, .lambda_max = 700};
    EXPECT(sr_measured_write_table(path, &grid, gloss_f, &matte, &error) == SR_OK);
    EXPECT(sr_measured_read(path, NULL, &arena, &m, &error) == SR_OK);
    compare(m, gloss_f, &matte, 0.0025);
    grid = (struct sr_measured_table_grid){
        .theta_count = 12, .phi_count = 24, .lambda_count = 1, .is_anisotropic = true, .has_transmission = true};
    EXPECT(sr_measured_write_table(path, &grid, grooved_f, NULL, &error) == SR_OK);
    EXPECT(sr_measured_read(path, NULL, &arena, &m, &error) == SR_OK);
    EXPECT_EQUAL_INT(sr_measured_sides(m), SR_MEASURED_REFLECTION | SR_MEASURED_TRANSMISSION);
    struct sr_rng rng = sr_rng_seed(4, 1);
    for (int n = 0; n < 2000; ++n) {
        sr_vec3 wo = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        wo.z = n & 1 ? -wo.z : wo.z;
        if (fabsf(wo.z) > 0.4f && wi.z > 0.4f)
            EXPECT_NEAR(sr_measured_f(m, wo, wi, SR_BLACK + 550)[0], grooved_f(NULL, wo, wi, SR_BLACK)[0],
                        0.012); // steps of 8 and 15 deg
    }
    EXPECT(sr_measured_write_table(path, &(struct sr_measured_table_grid){.phi_count = 1}, gloss_f, &matte, &error) ==
           SR_ERROR_USAGE);
    remove(path);
    sr_arena_free(&arena);
}

TEST(astm_header_names_columns_and_angles_are_radians)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    print(&b, "ASTM E1392\nNUM_POINTS 36\nMATERIAL paint\nVARS=theta_i,phi_i,theta_s,phi_s,450nm,650nm\n");
    for (int i = 0; i < 3; ++i)
        for (int o = 0; o < 4; ++o)
            for (int p = 0; p < 3; ++p)
                print(&b, "%g,0,%g,%g,%g,%g\n", 0.5 * i, 0.4 * o, PI / 2 * p, 0.1 + 0.1 * i, 0.2 + 0.1 * o);
    const struct sr_measured *m = parse(&arena, &b);
    struct sr_measured_report r;
    sr_measured_report(m, &r);
    EXPECT_EQUAL_TEXT(r.format, "ASTM text");
    EXPECT_NEAR(r.theta_i_max, 180 / PI, 1e-3);
    EXPECT_NEAR(sr_measured_f(m, direction(0.4 * 180 / PI, 50), direction(0.75 * 180 / PI, 0), SR_BLACK + 450)[0], 0.25,
                1e-5);
    EXPECT_NEAR(sr_measured_f(m, direction(0.6 * 180 / PI, 50), direction(0.75 * 180 / PI, 0), SR_BLACK + 650)[0], 0.35,
                1e-5);
    drop(&b);
    sr_arena_free(&arena);
}

/* pi A ln(1 + 1/B) for g = 2 at normal incidence; and four reflectances computed elsewhere for g = 1.8. */
TEST(abg_scatters_what_its_integral_says)
{
    struct sr_arena arena = {0};
    struct bytes b = {0};
    print(&b, "ABg\n# polished\n0.002 0.0004 2\n");
    EXPECT_RELATIVE(
        sr_measured_albedo(parse(&arena, &b), direction(0, 0), SR_MEASURED_REFLECTION, SR_BLACK + 550, 128)[0],
        PI * 0.002 * log(1 + 1 / 0.0004), 1e-4);
    drop(&b);
    print(&b, "ABg\nA = 0.0025\nB = 0.001\ng = 1.8\n");
    const struct sr_measured *m = parse(&arena, &b);
    static const double theta[4] = {0, 30, 60, 80}, E[4] = {0.041339, 0.039358, 0.032576, 0.023885};
    for (int i = 0; i < 4; ++i)
        EXPECT_RELATIVE(sr_measured_albedo(m, direction(theta[i], 0), SR_MEASURED_REFLECTION, SR_BLACK + 550, 128)[0],
                        E[i], 5e-4);
    drop(&b);
    print(&b, "ABg BTDF\n500 0.001 0.01 0\n600 0.003 0.01 0\n"); // g = 0: Lambert, A / (B + 1)
    m = parse(&arena, &b);
    EXPECT_NEAR(sr_measured_f(m, direction(140, 0), direction(20, 0), SR_BLACK + 550)[0], 0.002 / 1.01, 1e-7);
    EXPECT_NEAR(sr_measured_f(m, direction(40, 0), direction(20, 0), SR_BLACK + 550)[0], 0, 0);
    drop(&b);
    static const char *const wrong[][2] = {{"ABg\n", "ends before"},       {"ABg\n1 2\n", "2 numbers"},
                                           {"ABg\n1 0 1\n", "B >= 1e-12"}, {"ABg\n500 1 1 1\n400 1 1 1\n", "increase"},
                                           {"ABg\nC = 2\n", "\"C\""},      {"ABg\n1 1 1\n1 1 1\n", "further"}};
    for (int i = 0; i < 6; ++i) {
        print(&b, "%s", wrong[i][0]);
        expect_refused(&b, wrong[i][1]);
        drop(&b);
    }
    sr_arena_free(&arena);
}

/* Irregular measurements: exact where they were made, reciprocal everywhere, and near the formula between. */
TEST(goniometer_data_are_exact_at_the_measurements_and_reciprocal)
{
    struct bytes b = cornell_file(gloss_f, &matte);
    struct sr_arena arena = {0};
    const struct sr_measured *m = parse(&arena, &b);
    EXPECT_RELATIVE(sr_measured_f(m, direction(8.5 * 4, -180.0 * 3 / 8), direction(23, 0), SR_BLACK + 600)[0],
                    gloss_f(&matte, direction(8.5 * 4, -180.0 * 3 / 8), direction(23, 0), SR_BLACK + 600)[0], 1e-3);
    struct sr_measured_report r;
    sr_measured_report(m, &r);
    EXPECT(r.reciprocity_max < 1e-3 && r.is_spectral && r.channels == 4);
    struct sr_rng rng = sr_rng_seed(1, 1);
    double sum = 0, difference = 0;
    for (int n = 0; n < 3000; ++n) {
        sr_vec3 wo = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
        if (wo.z < 0.2f || wi.z < 0.2f)
            continue;
        double should = (double)gloss_f(&matte, wo, wi, SR_BLACK + 550)[0];
        sum += should;
        difference += fabs(should - (double)sr_measured_f(m, wo, wi, SR_BLACK + 550)[0]);
    }
    EXPECT(difference < 0.03 * sum);
    sr_arena_free(&arena);
    drop(&b);
}

TEST(cornells_own_paints_are_read)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    const struct sr_measured *m;
    EXPECT(sr_measured_read(test_reference_file("brdf/cornell_irregular/cayman.brdf"), NULL, &arena, &m, &error) ==
           SR_OK);
    // the high gloss at 0.872665 rad, and the measurement in the line before it
    EXPECT_NEAR(
        sr_measured_f(m, direction(0.876298 * 180 / PI, 180), direction(0.872665 * 180 / PI, 0), SR_BLACK + 500)[0],
        8.384361, 0.01);
    EXPECT_NEAR(
        sr_measured_f(m, direction(0.573513 * 180 / PI, 0), direction(0.872665 * 180 / PI, 0), SR_BLACK + 450)[0],
        0.006421, 2e-5);
    sr_arena_free(&arena);
}

TEST(text_that_makes_no_sense_is_refused_with_the_line)
{
    static const char *const wrong[][2] = {
        {"theta_i theta_o\n", "columns theta_i, theta_o and f"},
        {"theta_i theta_o f\n1 2\n", ":2: ends after 2 numbers"},
        {"theta_i theta_o f\n1 2 3 4\n", ":2: goes on"},
        {"theta_i theta_o f\n1 2 nan\n", ":2: a number is expected, not \"nan\""},
        {"theta_i theta_o f\n1 2 1e300\n", "a finite one"},
        {"theta_i theta_o f\n95 2 1\n", "theta_i = 95 deg"},
        {"theta_i theta_o f\n1 999 1\n", "two turns"},
        {"theta_i theta_o f\n1 200 1\n", "0 to 180"},
        {"theta_i theta_o f\n1 20 -1\n", "negative"},
        {"theta_i theta_o theta_o f\n", "second column"},
        {"# angles: deg\ntheta_i theta_o f\n1 2 3\n4 5 6\n", "fewer than the 16"},
        {"theta_i theta_o 500nm 400nm\n1 2 3 4\n", "increase"},
        {"theta_i theta_o f f\n", "2 columns of values"},
        {"1 2 3\n", "3 numbers"},
        {"\n# nothing\n", "no measurement"},
        {"NUM_POINTS 3\nVAR x\n", "VARS"},
        {"# num wls\n2\n# wls\n500 400\n", "increase"},
        {"# num wls\n1e9\n", "1 to 4096"},
        {"# num wls\n2\n400 500\n0.1 0 0.1 0 1\n", "inside a measurement"},
        {"# num wls\n2\n400 500\n0.1 0 0.1 0 1 x\n", "not \"x"},
        {"", "empty"},
        {" \n ", "empty"},
        {"\x01\x02\x03", "no BSDF data"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
        struct bytes b = {0};
        put(&b, wrong[i][0], strlen(wrong[i][0]));
        expect_refused(&b, wrong[i][1]);
        drop(&b);
    }
    struct bytes b = {0}; // a format that says what its numbers are takes no other quantity
    print(&b, "ABg\n1 1 1\n");
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    const struct sr_measured *m;
    EXPECT(sr_measured_parse("x", b.data, b.size, &(struct sr_measured_options){.quantity = SR_MEASURED_FACTOR}, &arena,
                             &m, &error) == SR_ERROR_INPUT);
    drop(&b);
    sr_arena_free(&arena);
}
