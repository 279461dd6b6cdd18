/* SPDX-License-Identifier: MIT */
/* Luminaire files: formulas written, read, converted and judged; and files that are wrong. */
#include "luminaires.h"

#include <math.h>

static const struct {
    enum sr_photometry_symmetry symmetry;
    intensity_of *I;
    uint32_t c_steps;
    double flux; // [lm]
} shapes[] = {
    {SR_PHOTOMETRY_ALL_PLANES, lopsided, 72, 200 * 3.14159265358979},
    {SR_PHOTOMETRY_AXIAL, lambertian, 0, 100},
    {SR_PHOTOMETRY_C0_C180, c0_symmetric, 36, 200 * 3.14159265358979},
    {SR_PHOTOMETRY_C90_C270, c90_symmetric, 36, 200 * 3.14159265358979},
    {SR_PHOTOMETRY_QUADRANT, quadrant, 18, 200 * 3.14159265358979},
    {SR_PHOTOMETRY_AXIAL, cos20, 0, 2000 * 3.14159265358979 / 21},
    {SR_PHOTOMETRY_AXIAL, isotropic, 0, 100},
};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

static struct sr_photometry shape(struct sr_arena *arena, int i)
{
    return luminaire_make(arena, shapes[i].symmetry, shapes[i].I, shapes[i].c_steps, 180);
}

static const struct sr_photometry *round_trip(struct sr_arena *arena, const struct sr_photometry *p,
                                              enum sr_photometry_format format)
{
    struct sr_error error = {0};
    char *text;
    size_t size;
    const struct sr_photometry *out;
    if (sr_photometry_print(p, format, &text, &size, &error) != SR_OK ||
        sr_photometry_parse("file", text, size, arena, &out, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    sr_free(text);
    return out;
}

TEST(fluxes_are_those_of_the_formulas)
{
    struct sr_arena arena = {0};
    for (int i = 0; i < SHAPES; ++i) {
        struct sr_photometry p = shape(&arena, i);
        EXPECT_RELATIVE(sr_photometry_flux(&p, 0, 180), shapes[i].flux, 1.5e-3);
        EXPECT_RELATIVE(sr_photometry_flux(&p, 0, 37.3) + sr_photometry_flux(&p, 37.3, 180),
                        sr_photometry_flux(&p, 0, 180), 1e-12);
    }
    // 2 pi (25 + 15) of the hemisphere below: 50 and 30 cos gamma
    struct sr_photometry p = shape(&arena, 0);
    EXPECT_RELATIVE(sr_photometry_flux(&p, 0, 90), 2 * 3.14159265358979 * (50 + 15), 1e-3);
    sr_arena_free(&arena);
}

TEST(flux_is_the_integral_of_the_intensity_between_the_angles)
{
    struct sr_arena arena = {0};
    // coarse: the interpolant counts
    struct sr_photometry p = luminaire_make(&arena, SR_PHOTOMETRY_ALL_PLANES, lopsided, 7, 5);
    enum { N = 40 };
    double x[N], w[N], sum = 0;
    for (int segment = 0; segment < 5; ++segment) {
        sr_gauss_legendre(N, 36 * segment, 36 * (segment + 1), x, w);
        for (int i = 0; i < N; ++i)
            for (int k = 0; k < 7 * 200; ++k)
                sum += w[i] * RADIANS * sin(x[i] * RADIANS) *
                       sr_photometry_intensity(&p, (k + 0.5) * 360 / 1400, x[i]) * 360 / 1400 * RADIANS;
    }
    EXPECT_RELATIVE(sr_photometry_flux(&p, 0, 180), sum, 1e-6);
    sr_arena_free(&arena);
}

TEST(intensity_follows_the_formula_in_all_directions)
{
    struct sr_arena arena = {0};
    for (int i = 0; i < SHAPES; ++i) {
        struct sr_photometry p = shape(&arena, i);
        for (int k = 0; k < 2000; ++k) {
            double c = fmod(k * 137.5, 360), gamma = 0.5 + fmod(k * 61.3, 179), expected = shapes[i].I(c, gamma);
            EXPECT_NEAR(sr_photometry_intensity(&p, c, gamma), expected, 0.06 + 4e-3 * expected);
            double g = gamma * RADIANS, a = c * RADIANS;
            sr_vec3 d = {(float)(sin(g) * cos(a)), (float)(sin(g) * sin(a)), (float)-cos(g)};
            EXPECT_NEAR(sr_photometry_intensity_along(&p, d), sr_photometry_intensity(&p, c, gamma), 2e-3);
        }
    }
    sr_arena_free(&arena);
}

TEST(files_keep_their_numbers_through_ies_and_eulumdat_and_back)
{
    static const int years[] = {1986, 1991, 1995, 2002, 2019};
    struct sr_arena arena = {0};
    for (int i = 0; i < SHAPES; ++i)
        for (int absolute = 0; absolute < 2; ++absolute)
            for (int y = 0; y < 5; ++y) {
                struct sr_photometry p = shape(&arena, i);
                p.year = years[y];
                p.is_round = y == 3;
                p.along_c0 = p.is_round ? p.along_c90 : p.along_c0;
                p.lamp_flux = absolute ? NAN : p.lamp_flux;
                const struct sr_photometry *first = round_trip(&arena, &p, SR_PHOTOMETRY_IES);
                const struct sr_photometry *second = round_trip(&arena, first, SR_PHOTOMETRY_LDT),
                                           *third = round_trip(&arena, second, SR_PHOTOMETRY_IES);
                EXPECT_EQUAL_INT(first->year, years[y]);
                EXPECT_EQUAL_TEXT(first->note, "");
                const struct sr_photometry *all[] = {first, second, third};
                for (int k = 0; k < 3; ++k) {
                    const struct sr_photometry *q = all[k];
                    EXPECT_EQUAL_INT(q->symmetry, p.symmetry);
                    EXPECT_EQUAL_INT(q->c_count, p.c_count);
                    EXPECT_EQUAL_INT(q->gamma_count, p.gamma_count);
                    EXPECT_EQUAL_INT(q->lamp_count, 2);
                    EXPECT_EQUAL_INT(q->is_round, p.is_round);
                    EXPECT(absolute ? isnan(q->lamp_flux) : fabsf(q->lamp_flux - 1200) < 1e-3f);
                    EXPECT_RELATIVE(q->power_W, 12.5, 1e-6);
                    EXPECT_RELATIVE(q->along_c0, p.along_c0, 1e-6);
                    EXPECT_RELATIVE(q->along_c90, p.along_c90, 1e-6);
                    EXPECT_RELATIVE(q->height, p.height, 1e-6);
                    for (uint32_t n = 0; n < p.c_count; ++n)
                        EXPECT_NEAR(q->c[n], p.c[n], 1e-4);
                    for (uint32_t n = 0; n < p.gamma_count * p.c_count; ++n)
                        EXPECT_NEAR(q->candela[n], p.candela[n], 1e-6 * (double)p.candela[n] + 1e-12);
                    if (years[y] >= 1991)
                        EXPECT_EQUAL_TEXT(sr_photometry_word(q, "MANUFAC"), "Formula & Sons");
                }
            }
    sr_arena_free(&arena);
}

static const struct sr_photometry *parse(struct sr_arena *arena, const char *text)
{
    struct sr_error error = {0};
    const struct sr_photometry *p;
    if (sr_photometry_parse("lamp", text, strlen(text), arena, &p, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return p;
}

TEST(factors_units_and_editions_are_applied)
{
    struct sr_arena arena = {0};
    // feet, two factors; the third counts before 1995 only
    const struct sr_photometry *p = parse(
        &arena, "IESNA:LM-63-2002\n[TEST] 1\nTILT=NONE\n2 500 2 3 1 1 1 1 2 0.5\n0.9 0.5 20\n0 45,90\n0\n100 50 0\n");
    EXPECT_RELATIVE(sr_photometry_intensity(p, 12, 0), 180, 1e-6);
    EXPECT_RELATIVE(sr_photometry_intensity(p, 12, 22.5), 135, 1e-6);
    EXPECT_NEAR(sr_photometry_intensity(p, 12, 91), 0, 0);
    EXPECT_RELATIVE(p->lamp_flux, 1000, 1e-6);
    EXPECT_RELATIVE(p->along_c90, 0.3048, 1e-6); // width
    EXPECT_RELATIVE(p->along_c0, 0.6096, 1e-6);  // length
    EXPECT_RELATIVE(p->height, 0.1524, 1e-6);
    p = parse(
        &arena,
        "an old file\nTILT=INCLUDE\n1\n2\n0 90\n1 0.8\n1 500 2 3 1 1 2 -0.2 0 0\n0.9 0.5 20\n0 45\n90 0 100\n50 0\n");
    EXPECT_EQUAL_INT(p->year, 1986);
    EXPECT_RELATIVE(sr_photometry_intensity(p, 0, 0), 90, 1e-6);
    EXPECT(p->is_round && fabsf(p->along_c0 - 0.2f) < 1e-6f && strstr(p->note, "TILT"));
    // EULUMDAT: decimal commas, a conversion factor, 1500 lm
    p = parse(
        &arena,
        "Maker\n1\n1\n1\n0\n3\n45\nreport\nname\nnumber\nfile\ndate\n100\n0\n50\n80,5\n0\n0\n0\n0\n0\n100\n80\n1,5\n0\n1\n1\nLED\n1500\n3000K\n80\n10\n"
        "0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n45\n90\n100,5\n50\n0\n");
    EXPECT_RELATIVE(sr_photometry_intensity(p, 200, 0), 100.5 * 1.5 * 1.5, 1e-6);
    EXPECT_RELATIVE(p->along_c0, 0.0805, 1e-6);
    EXPECT(p->is_round && strstr(p->note, "light output ratio"));
    sr_arena_free(&arena);
}

/* Type B and A of a formula that knows directions only: the same in all systems. */
static double toward(sr_vec3 d)
{
    return 40 + 20 * (double)d.x - 10 * (double)d.y - 15 * (double)d.z;
}

TEST(types_a_and_b_point_where_the_standard_says)
{
    struct sr_arena arena = {0};
    for (int type = 2; type <= 3; ++type) {
        struct sr_array text = {0};
        sr_array_reserve(&text, 1 << 20, 1);
        char *at = text.data;
        at += sprintf(at, "IESNA:LM-63-1995\nTILT=NONE\n1 -1 1 37 37 %d 2 0 0 0\n1 1 0\n", type);
        for (int k = 0; k < 2; ++k)
            for (int i = -18; i <= 18; ++i)
                at += sprintf(at, "%d%s", i * 5, i == 18 ? "\n" : " ");
        for (int i = -18; i <= 18; ++i)
            for (int j = -18; j <= 18; ++j) {
                double h = i * 5 * RADIANS, v = j * 5 * RADIANS;
                sr_vec3 d = type == 2 ? (sr_vec3){(float)(cos(h) * sin(v)), (float)-sin(h), (float)(-cos(h) * cos(v))}
                                      : (sr_vec3){(float)(cos(v) * cos(h)), (float)(-cos(v) * sin(h)), (float)sin(v)};
                at += sprintf(at, "%.5f\n", toward(d));
            }
        const struct sr_photometry *p = parse(&arena, text.data);
        EXPECT(strstr(p->note, "resampled"));
        for (int k = 0; k < 500; ++k) {
            double c = fmod(k * 137.5, 360), gamma = fmod(k * 61.3, 180), g = gamma * RADIANS, a = c * RADIANS;
            sr_vec3 d = {(float)(sin(g) * cos(a)), (float)(sin(g) * sin(a)), (float)-cos(g)};
            bool is_inside = type == 2 ? d.z < -0.1f : d.x > 0.1f, is_outside = type == 2 ? d.z > 0.1f : d.x < -0.1f;
            if (is_inside)
                EXPECT_NEAR(sr_photometry_intensity(p, c, gamma), toward(d), 0.15);
            if (is_outside)
                EXPECT_NEAR(sr_photometry_intensity(p, c, gamma), 0, 0);
        }
        sr_array_free(&text);
    }
    sr_arena_free(&arena);
}

TEST(reports_tell_beam_field_and_efficacy)
{
    struct sr_arena arena = {0};
    struct sr_photometry p = luminaire_make(&arena, SR_PHOTOMETRY_AXIAL, cos20, 0, 360);
    struct sr_photometry_report r;
    sr_photometry_report(&p, &r);
    EXPECT_NEAR(r.peak, 1000, 1e-3);
    EXPECT_NEAR(r.peak_gamma, 0, 0);
    for (int k = 0; k < 2; ++k) {
        EXPECT_NEAR(r.beam[k], 2 * acos(pow(0.5, 1 / 20.0)) / RADIANS, 0.02);
        EXPECT_NEAR(r.field[k], 2 * acos(pow(0.1, 1 / 20.0)) / RADIANS, 0.02);
    }
    EXPECT_RELATIVE(r.efficacy, 2000 * 3.14159265358979 / 21 / 12.5, 1e-3);
    EXPECT_RELATIVE(r.light_output_ratio, 2000 * 3.14159265358979 / 21 / 1200, 1e-3);
    EXPECT_RELATIVE(r.flux_down, r.flux, 1e-9);
    sr_arena_free(&arena);
}

TEST(directions_are_drawn_as_the_density_says)
{
    struct sr_arena arena = {0};
    for (int i = 0; i < SHAPES; ++i) {
        struct sr_photometry p = shape(&arena, i);
        struct sr_photometry_guide guide;
        EXPECT(sr_photometry_guide_build(&p, &arena, &guide));
        enum { NC = 12, NG = 18, DRAWS = 200000 };
        static double seen[NC * NG], expected[NC * NG];
        memset(seen, 0, sizeof seen);
        // expected by quadrature of the density over each cell
        for (int cell = 0; cell < NC * NG; ++cell) {
            double sum = 0;
            for (int k = 0; k < 40 * 40; ++k) {
                double c = (cell % NC + (k % 40 + 0.5) / 40) * 360 / NC * RADIANS,
                       g = (cell / NC + (k / 40 + 0.5) / 40) * 180 / NG * RADIANS;
                sr_vec3 d = {(float)(sin(g) * cos(c)), (float)(sin(g) * sin(c)), (float)-cos(g)};
                sum += (double)sr_photometry_pdf(&guide, d) * sin(g);
            }
            expected[cell] = sum / 1600 * (360.0 / NC * RADIANS) * (180.0 / NG * RADIANS) * DRAWS;
        }
        struct sr_rng rng = sr_rng_seed(7, (uint64_t)i);
        struct sr_tally flux = {0};
        int differing = 0;
        for (int n = 0; n < DRAWS; ++n) {
            float pdf;
            sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
            sr_vec3 d = sr_photometry_sample(&guide, u, &pdf);
            differing += fabsf(sr_photometry_pdf(&guide, d) - pdf) > 1e-3f * pdf;
            double c = atan2((double)d.y, (double)d.x) / RADIANS,
                   gamma = acos(fmax(-1, fmin(1, -(double)d.z))) / RADIANS;
            int x = (int)(fmod(c + 360, 360) / 360 * NC), y = (int)(gamma / 180 * NG);
            seen[(y < NG ? y : NG - 1) * NC + (x < NC ? x : NC - 1)] += 1;
            sr_tally_add(&flux, sr_photometry_intensity_along(&p, d) / (double)pdf);
        }
        EXPECT(differing < DRAWS / 1000); // where rounding puts a direction beyond a border of cells
        EXPECT_CHI2(seen, expected, NC * NG);
        EXPECT_MEAN(flux, sr_photometry_flux(&p, 0, 180));
        // by importance: the weights hardly vary
        EXPECT(sr_tally_standard_error(&flux) * sqrt(DRAWS) < 0.1 * flux.mean);
    }
    sr_arena_free(&arena);
}

static void refused(const char *text, const char *reason)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    const struct sr_photometry *p;
    sr_status status = sr_photometry_parse("lamp", text, strlen(text), &arena, &p, &error);
    if (status != SR_ERROR_INPUT || !strstr(error.text, reason))
        test_fail(__FILE__, __LINE__, "\"%s\" where \"%s\" was expected", error.text, reason);
    sr_arena_free(&arena);
}

TEST(wrong_files_are_told_with_line_and_reason)
{
    refused("", "lamp:1: is neither");
    refused("a\nb\nc\n", "is neither");
    refused("IESNA91\n[TEST] x\n", "lamp:2: the file ends before a line TILT=");
    refused("x\nTILT=lamp.tlt\n1 1 1\n", "lamp:2: TILT=lamp.tlt: how the lamp's output");
    refused("x\nTILT=NONE\n1 1 1 2 1 1 2 0 0\n1 1 x\n", "lamp:4: numbers of the ballast 2 of 3");
    refused("x\nTILT=NONE\n1 1 1 2 1 4 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n", "lamp:4: photometric type 4");
    refused("x\nTILT=NONE\n1 1 1 2 1 1 3 0 0 0\n1 1 1\n0 90\n0\n1 1\n", "units type 3");
    refused("x\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1\n", "the file ends after 1 of 2 candela values");
    refused("x\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 -3\n", "lamp:7: candela value 2 is -3");
    refused("x\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n90 0\n0\n1 1\n", "increasing angles");
    refused("x\nTILT=NONE\n1 1 1 2 2 1 2 0 0 0\n1 1 1\n0 90\n0 45\n1 1 1 1\n", "the last horizontal angle is 45 deg");
    refused("x\nTILT=NONE\n1 1 0 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n", "multiplier 0");
    refused("x\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n0 0\n", "all intensities are 0");
    refused("x\nTILT=NONE\n1 1 1 2000000000 2000000000 1 2 0 0 0\n1 1 1\n0 90\n0\n0 0\n",
            "do not fit into the rest of the file");
    refused("Maker\n1\n5\n", "lamp:3: the symmetry is 5");
    refused("Maker\n1\n1\n1\n0\n3\n45\nr\n", "the file ends where the luminaire's name is expected");
    refused(
        "Maker\n1\n2\n3\n0\n3\n45\nr\nn\n1\nf\nd\n1\n1\n1\n1\n1\n0\n0\n0\n0\n100\n100\n1\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n",
        "lamp:4: 3 C-planes: a multiple of 2");
}

/* Every prefix of a file is refused with a reason, or is a shorter file; nothing is read beyond its end. */
TEST(files_cut_anywhere_do_no_harm)
{
    struct sr_arena arena = {0};
    struct sr_photometry p = luminaire_make(&arena, SR_PHOTOMETRY_QUADRANT, quadrant, 2, 6);
    for (int format = 0; format < 2; ++format) {
        struct sr_error error = {0};
        char *text;
        size_t size;
        EXPECT_EQUAL_INT(sr_photometry_print(&p, (enum sr_photometry_format)format, &text, &size, &error), SR_OK);
        for (size_t cut = 0; cut + 2 < size; ++cut) { // the last digit is no loss that anybody could see
            struct sr_arena scratch = {0};
            struct sr_error reason = {0};
            const struct sr_photometry *out;
            char *exact = malloc(cut ? cut : 1);
            EXPECT(exact);
            memcpy(exact, text, cut);
            sr_status status = sr_photometry_parse("file", exact, cut, &scratch, &out, &reason);
            free(exact);
            bool is_last_number = !memchr(text + cut, '\n', size - cut - 1) && !memchr(text + cut, ' ', size - cut - 1);
            if (status == SR_OK
                    ? !is_last_number
                    : (status != SR_ERROR_INPUT || strncmp(reason.text, "file", 4) != 0 || strlen(reason.text) < 15))
                test_fail(__FILE__, __LINE__, "cut at %zu of %zu: status %d, \"%s\"", cut, size, status, reason.text);
            EXPECT(scratch.total <= 64 * cut + (1u << 18));
            sr_arena_free(&scratch);
        }
        sr_free(text);
    }
    sr_arena_free(&arena);
}
