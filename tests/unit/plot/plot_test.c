/* SPDX-License-Identifier: MIT */
/* Figures: nice ticks, even colours, bytes that are always the same, and no text that cannot be read. */
#include "plot/plot.h"
#include "test.h"

/* ---- ticks ---- */

static struct sr_plot_ticks ticks_of(struct sr_plot_axis axis, int wanted)
{
    struct sr_plot_ticks ticks;
    sr_plot_ticks(&axis, wanted, &ticks);
    return ticks;
}

TEST(ticks_step_by_one_two_or_five)
{
    struct sr_plot_ticks t = ticks_of((struct sr_plot_axis){.from = 0, .to = 1}, 5);
    EXPECT_EQUAL_INT(t.count, 6);
    EXPECT_NEAR(t.at[1], 0.2, 1e-12);
    EXPECT_EQUAL_TEXT(t.label[0], "0.0");
    EXPECT_EQUAL_TEXT(t.label[5], "1.0");
    t = ticks_of((struct sr_plot_axis){.from = -0.03, .to = 0.12}, 4);
    EXPECT_EQUAL_INT(t.count, 3);
    EXPECT_NEAR(t.at[0], 0, 1e-12);
    EXPECT_EQUAL_TEXT(t.label[2], "0.10");
    t = ticks_of((struct sr_plot_axis){.from = -7, .to = 12}, 4);
    EXPECT_EQUAL_TEXT(t.label[0], "−5");
}

TEST(ticks_of_degrees_divide_a_right_angle)
{
    struct sr_plot_ticks t = ticks_of((struct sr_plot_axis){.from = 0, .to = 90, .unit = "°"}, 6);
    EXPECT_EQUAL_INT(t.count, 7);
    EXPECT_NEAR(t.at[3], 45, 1e-12);
    t = ticks_of((struct sr_plot_axis){.from = -90, .to = 90, .unit = "°"}, 6);
    EXPECT_NEAR(t.at[1] - t.at[0], 30, 1e-12);
}

TEST(ticks_of_logarithms_are_powers_of_ten)
{
    struct sr_plot_ticks t = ticks_of((struct sr_plot_axis){.from = 1e-6, .to = 1e2, .is_log = true}, 10);
    EXPECT_EQUAL_INT(t.count, 9);
    EXPECT_EQUAL_TEXT(t.label[0], "10^{−6}");
    EXPECT_EQUAL_TEXT(t.label[6], "1");
    EXPECT_EQUAL_INT(t.minor_count, 64);
    t = ticks_of((struct sr_plot_axis){.from = 1e-12, .to = 1, .is_log = true}, 5); // every third
    EXPECT_EQUAL_INT(t.count, 5);
    t = ticks_of((struct sr_plot_axis){.from = 1, .to = 60, .is_log = true}, 5);
    EXPECT_EQUAL_INT(t.count, 6); // 1 2 5 10 20 50
}

TEST(ticks_of_large_and_small_numbers_share_a_power_of_ten)
{
    struct sr_plot_ticks t = ticks_of((struct sr_plot_axis){.from = 0, .to = 4e6}, 4);
    EXPECT_EQUAL_INT(t.exponent, 6);
    EXPECT_EQUAL_TEXT(t.label[1], "1");
    t = ticks_of((struct sr_plot_axis){.from = 0, .to = 5e-5}, 5);
    EXPECT_EQUAL_INT(t.exponent, -5);
}

TEST(ticks_of_nonsense_are_none)
{
    EXPECT_EQUAL_INT(ticks_of((struct sr_plot_axis){.from = 1, .to = 1}, 5).count, 0);
    EXPECT_EQUAL_INT(ticks_of((struct sr_plot_axis){.from = 0, .to = INFINITY}, 5).count, 0);
    EXPECT_EQUAL_INT(ticks_of((struct sr_plot_axis){.from = 0, .to = 1, .is_log = true}, 5).count, 0);
}

/* ---- colours ---- */

TEST(oklab_and_back_is_the_same_colour)
{
    for (int i = 0; i < 512; ++i) {
        struct sr_plot_colour c = {(float)(i % 8) / 7, (float)(i / 8 % 8) / 7, (float)(i / 64) / 7, 1};
        double lab[3];
        sr_plot_oklab_from_colour(c, lab);
        struct sr_plot_colour d = sr_plot_colour_from_oklab(lab);
        EXPECT_NEAR(d.r, c.r, 2e-4);
        EXPECT_NEAR(d.g, c.g, 2e-4);
        EXPECT_NEAR(d.b, c.b, 2e-4);
    }
    double white[3];
    sr_plot_oklab_from_colour((struct sr_plot_colour){1, 1, 1, 1}, white);
    EXPECT_NEAR(white[0], 1, 1e-6);
    EXPECT_NEAR(white[1], 0, 1e-6);
}

/* Even lightness also says that no colour had to be cut to the gamut. */
TEST(perceptual_scale_grows_lighter_in_even_steps)
{
    double before = 0;
    for (int i = 0; i <= 100; ++i) {
        double lab[3];
        sr_plot_oklab_from_colour(sr_plot_scale_colour(SR_PLOT_PERCEPTUAL, i / 100.0), lab);
        if (i > 0)
            EXPECT_NEAR(lab[0] - before, 0.0081, 0.0012);
        before = lab[0];
    }
}

TEST(diverging_scale_is_symmetric_in_lightness)
{
    for (int i = 0; i < 50; ++i) {
        double lo[3], hi[3];
        sr_plot_oklab_from_colour(sr_plot_scale_colour(SR_PLOT_DIVERGING, i / 100.0), lo);
        sr_plot_oklab_from_colour(sr_plot_scale_colour(SR_PLOT_DIVERGING, 1 - i / 100.0), hi);
        EXPECT_NEAR(lo[0], hi[0], 0.02);
        EXPECT(lo[2] < hi[2]);
    }
}

TEST(palette_colours_differ_to_any_eye)
{
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < i; ++k) {
            double a[3], b[3];
            sr_plot_oklab_from_colour(sr_plot_palette(i), a);
            sr_plot_oklab_from_colour(sr_plot_palette(k), b);
            // lightness, and blue against yellow: what is left to those who confuse red and green
            EXPECT(hypot(a[0] - b[0], a[2] - b[2]) > 0.03);
        }
}

/* ---- figures ---- */

enum { N = 181, ROWS = 12, COLUMNS = 25 };
static double x[N], angle[N], wave[N], decay[N], low[N], high[N], values[ROWS * COLUMNS], bowl[ROWS * COLUMNS][3];
static uint8_t pixels[30 * 20 * 3];

static void fill(void)
{
    for (int i = 0; i < N; ++i) {
        x[i] = i / 2.0;
        angle[i] = i - 90;
        wave[i] = 0.3 + 0.1 * sin(i * 0.05);
        decay[i] = exp(-i * 0.06);
        low[i] = 0.9 * wave[i];
        high[i] = 1.1 * wave[i];
    }
    for (int j = 0; j < ROWS; ++j)
        for (int i = 0; i < COLUMNS; ++i) {
            double t = j * 1.5707963 / (ROWS - 1), p = i * 6.2831853 / (COLUMNS - 1);
            values[j * COLUMNS + i] = i == 3 ? NAN : cos(t) * (1.5 + cos(p));
            bowl[j * COLUMNS + i][0] = sin(t) * cos(p);
            bowl[j * COLUMNS + i][1] = sin(t) * sin(p);
            bowl[j * COLUMNS + i][2] = cos(t);
        }
    for (size_t i = 0; i < sizeof pixels; ++i)
        pixels[i] = (uint8_t)(i * 7);
}

static const struct sr_plot_curve curves[] = {
    {.label = "a model with parameters=0.25", .x = x, .y = wave, .low = low, .high = high, .count = N},
    {.label = "another", .x = x, .y = decay, .count = N, .dash = SR_PLOT_DASHED},
};
static const struct sr_plot_curve lobes[] = {
    {.label = "a model with parameters=0.25", .x = angle, .y = wave, .count = N},
    {.label = "another", .x = angle, .y = decay, .count = N},
};
static const struct sr_plot_mark marks[] = {{"mirror", 40}};
static const struct sr_plot_body bodies[] = {
    {.points = bowl, .rows = ROWS, .columns = COLUMNS, .fill = {0.2f, 0.5f, 0.8f, 1}, .edge = {0, 0, 0, 1}}};
static const struct sr_plot_arrow arrows[] = {
    {.to = {-1.2, 0, 1.2}, .label = "ω_{i}", .colour = {0.8f, 0.3f, 0, 1}, .points_back = true},
    {.to = {0, 0, 1.6}, .label = "n", .colour = {0, 0, 0, 1}}};
#define ANGLE                                                                                                          \
    {                                                                                                                  \
        .label = "θ_{o}", .unit = "°"                                                                                 \
    }
#define VALUE                                                                                                          \
    {                                                                                                                  \
        .label = "f", .unit = "sr^{-1}"                                                                                \
    }
#define RIGHT_ANGLE(name)                                                                                              \
    {                                                                                                                  \
        .label = name, .unit = "°", .from = 0, .to = 90                                                                \
    }
static const struct sr_plot_panel panels[] = {
    {.kind = SR_PLOT_LINES,
     .title = "lines",
     .x = ANGLE,
     .y = VALUE,
     .curves = curves,
     .curve_count = 2,
     .marks = marks,
     .mark_count = 1},
    {.kind = SR_PLOT_LINES,
     .title = "logarithms",
     .x = {.label = "N", .is_log = true, .from = 1, .to = 90},
     .y = {.label = "f", .unit = "sr^{-1}", .is_log = true},
     .curves = curves,
     .curve_count = 2},
    {.kind = SR_PLOT_POLAR,
     .title = "half a disc",
     .x = ANGLE,
     .y = VALUE,
     .curves = lobes,
     .curve_count = 2,
     .marks = marks,
     .mark_count = 1},
    {.kind = SR_PLOT_POLAR,
     .title = "a disc",
     .x = {.label = "θ_{o}", .from = -180, .to = 180},
     .y = {.label = "f", .unit = "sr^{-1}", .is_log = true},
     .curves = lobes,
     .curve_count = 2},
    {.kind = SR_PLOT_MAP,
     .title = "a map",
     .x = RIGHT_ANGLE("θ_{h}"),
     .y = RIGHT_ANGLE("θ_{d}"),
     .z = VALUE,
     .values = values,
     .rows = ROWS,
     .columns = COLUMNS},
    {.kind = SR_PLOT_SURFACE,
     .title = "a bowl",
     .bodies = bodies,
     .body_count = 1,
     .arrows = arrows,
     .arrow_count = 2,
     .view = {-60, 25, 0}},
    {.kind = SR_PLOT_PICTURE, .title = "a picture", .pixels = pixels, .rows = 20, .columns = 30},
};
enum { PANELS = sizeof panels / sizeof panels[0] };
static const struct sr_plot_figure all = {.title = "Each kind of panel",
                                          .subtitle = "λ = 550 nm",
                                          .panels = panels,
                                          .panel_count = PANELS,
                                          .columns = 3,
                                          .legend = curves,
                                          .legend_count = 2};

/* Not inlined: gcc 12 takes the bytes for the variable that has pointed to them. */
__attribute__((noinline)) static char *encoded(const struct sr_plot_figure *figure, enum sr_plot_format format,
                                               size_t *size, struct sr_plot_check *check)
{
    struct sr_error error = {0};
    char *data;
    fill();
    if (sr_plot_encode(figure, format, &data, size, check, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return data;
}

TEST(the_same_figure_is_the_same_bytes)
{
    for (int format = SR_PLOT_SVG; format <= SR_PLOT_PNG; ++format) {
        size_t a_size, b_size;
        char *a = encoded(&all, (enum sr_plot_format)format, &a_size, NULL);
        char *b = encoded(&all, (enum sr_plot_format)format, &b_size, NULL); // in the same process: names start anew
        EXPECT(a_size == b_size && memcmp(a, b, a_size) == 0);
        sr_free(a);
        sr_free(b);
    }
}

static uint32_t big_endian(const char *p)
{
    const unsigned char *u = (const unsigned char *)p;
    return (uint32_t)u[0] << 24 | (uint32_t)u[1] << 16 | (uint32_t)u[2] << 8 | u[3];
}

TEST(png_has_the_asked_size_times_its_scale)
{
    struct sr_plot_figure figure = {.panels = panels, .panel_count = 1, .width = 300, .height = 200, .scale = 1.5};
    size_t size;
    char *png = encoded(&figure, SR_PLOT_PNG, &size, NULL);
    EXPECT(size > 1000 && memcmp(png, "\x89PNG\r\n\x1a\n", 8) == 0);
    EXPECT_EQUAL_INT(big_endian(png + 16), 450);
    EXPECT_EQUAL_INT(big_endian(png + 20), 300);
    sr_free(png);
}

/* Every element that is opened is closed in its turn; each reference is to an id that stands in the file. */
TEST(svg_is_well_formed)
{
    size_t size;
    char *svg = encoded(&all, SR_PLOT_SVG, &size, NULL);
    const char *open[64];
    size_t length[64];
    int depth = 0, elements = 0;
    for (const char *p = svg; (p = strchr(p, '<')) != NULL; ++p) {
        const char *end = strchr(p, '>');
        EXPECT(end != NULL);
        if (p[1] == '?' || p[1] == '!')
            continue;
        size_t name = strcspn(p + 1 + (p[1] == '/'), " \n/>");
        if (p[1] == '/') {
            EXPECT(depth > 0 && name == length[depth - 1] && memcmp(open[depth - 1], p + 2, name) == 0);
            --depth;
        } else if (end[-1] != '/') {
            EXPECT(depth < 64);
            open[depth] = p + 1;
            length[depth++] = name;
            ++elements;
        }
    }
    EXPECT_EQUAL_INT(depth, 0);
    EXPECT(elements > 20);
    EXPECT(strstr(svg, "width=\"1260px\"") != NULL || strstr(svg, "width=\"1260\"") != NULL);
    for (const char *p = svg; (p = strchr(p, '#')) != NULL; ++p) {
        char id[80];
        snprintf(id, sizeof id, "id=\"%.*s\"", (int)strcspn(p + 1, "\")"), p + 1);
        if (p[-1] == '"' || p[-1] == '(')
            EXPECT(strstr(svg, id) != NULL);
    }
    sr_free(svg);
}

TEST(no_text_is_cut_or_hidden)
{
    struct sr_plot_check check;
    size_t size;
    sr_free(encoded(&all, SR_PLOT_SVG, &size, &check));
    EXPECT(check.texts > 80);
    if (check.outside || check.overlaps)
        test_fail(__FILE__, __LINE__, "%s", check.offender);
    for (int i = 0; i < PANELS; ++i) // and alone, small
    {
        struct sr_plot_figure figure = {.panels = &panels[i], .panel_count = 1, .width = 320, .height = 260};
        sr_free(encoded(&figure, SR_PLOT_PNG, &size, &check));
        if (check.outside || check.overlaps)
            test_fail(__FILE__, __LINE__, "panel %d: %s", i, check.offender);
    }
}

TEST(a_check_sees_what_cannot_be_read)
{
    struct sr_plot_panel panel = panels[0];
    panel.title = "a title that is far too long for so narrow a figure, whatever the size of its letters may be";
    struct sr_plot_figure figure = {.panels = &panel, .panel_count = 1, .width = 150, .height = 150};
    struct sr_plot_check check;
    size_t size;
    sr_free(encoded(&figure, SR_PLOT_PNG, &size, &check));
    EXPECT(check.outside > 0 && check.offender[0]);
}

static sr_status try(const struct sr_plot_panel *panel)
{
    struct sr_plot_figure figure = {.panels = panel, .panel_count = 1};
    struct sr_error error = {0};
    char *data;
    size_t size;
    sr_plot_encode(&figure, SR_PLOT_SVG, &data, &size, NULL, &error);
    sr_free(data);
    return error.status;
}

TEST(nothing_to_show_is_an_error)
{
    static const double nothing[3] = {(double)NAN, (double)NAN, (double)INFINITY}, place[3] = {1, 2, 3},
                        below[3] = {0, -1, -2};
    struct sr_plot_curve c = {.x = place, .y = nothing, .count = 3};
    struct sr_plot_panel panel = {.kind = SR_PLOT_LINES, .curves = &c, .curve_count = 1};
    EXPECT_EQUAL_INT(try(&panel), SR_ERROR_INPUT);
    panel.kind = SR_PLOT_POLAR;
    EXPECT_EQUAL_INT(try(&panel), SR_ERROR_INPUT);
    c.y = below;
    panel.kind = SR_PLOT_LINES;
    EXPECT_EQUAL_INT(try(&panel), SR_OK);
    panel.y.is_log = true;
    EXPECT_EQUAL_INT(try(&panel), SR_ERROR_INPUT);
    struct sr_plot_panel map = {.kind = SR_PLOT_MAP, .x.to = 1, .y.to = 1, .values = nothing, .rows = 1, .columns = 3};
    EXPECT_EQUAL_INT(try(&map), SR_ERROR_INPUT);
    struct sr_plot_panel picture = {.kind = SR_PLOT_PICTURE};
    EXPECT_EQUAL_INT(try(&picture), SR_ERROR_INPUT);
    struct sr_plot_panel surface = {.kind = SR_PLOT_SURFACE};
    EXPECT_EQUAL_INT(try(&surface), SR_ERROR_INPUT);
}

TEST(a_constant_and_a_single_point_can_be_shown)
{
    static const double one[1] = {1}, seven[1] = {7};
    struct sr_plot_curve c = {.x = one, .y = seven, .count = 1, .has_points = true};
    struct sr_plot_panel panel = {.kind = SR_PLOT_LINES, .curves = &c, .curve_count = 1};
    EXPECT_EQUAL_INT(try(&panel), SR_OK);
    panel.y.is_log = true;
    EXPECT_EQUAL_INT(try(&panel), SR_OK);
}

TEST(a_figure_is_written_by_its_ending)
{
    struct sr_plot_figure figure = {.panels = panels, .panel_count = 1};
    struct sr_error error = {0};
    char path[512];
    fill();
    snprintf(path, sizeof path, "%s/figure.svg", test_folder());
    EXPECT_EQUAL_INT(sr_plot_write(&figure, path, &error), SR_OK);
    EXPECT(sr_file_exists(path));
    EXPECT_EQUAL_INT(sr_plot_write(&figure, "figure.gif", &error), SR_ERROR_USAGE);
}

static bool comes_before(const char *text, const char *a, const char *b)
{
    const char *first = strstr(text, a), *second = strstr(text, b);
    return first && second && first < second;
}

/* The near side hides the far side: in the picture of two plates, the middle pixel is that of the one nearer the eye.
 */
TEST(near_bodies_hide_far_ones)
{
    static double lower[4][3] = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}};
    static double upper[4][3] = {{-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}};
    const struct sr_plot_colour red = {1, 0, 0, 1}, blue = {0, 0, 1, 1};
    for (int order = 0; order < 2; ++order) {
        struct sr_plot_body plates[2] = {{.points = (const double(*)[3])(order ? lower : upper),
                                          .rows = 2,
                                          .columns = 2,
                                          .is_flat = true,
                                          .fill = order ? red : blue},
                                         {.points = (const double(*)[3])(order ? upper : lower),
                                          .rows = 2,
                                          .columns = 2,
                                          .is_flat = true,
                                          .fill = order ? blue : red}};
        struct sr_plot_panel panel = {.kind = SR_PLOT_SURFACE, .bodies = plates, .body_count = 2, .view = {-90, 80, 0}};
        struct sr_plot_figure figure = {.panels = &panel, .panel_count = 1, .width = 100, .height = 100};
        size_t size;
        char *svg = encoded(&figure, SR_PLOT_SVG, &size, NULL);
        bool is_hidden = comes_before(svg, "100%,0%,0%", "0%,0%,100%");
        sr_free(svg);
        EXPECT(is_hidden);
    }
}

TEST(lamps_hang_and_maps_without_frames_keep_their_proportions)
{
    struct sr_plot_panel two[] = {
        {.kind = SR_PLOT_POLAR,
         .x = {.label = "γ", .unit = "°"},
         .y = {.label = "I", .unit = "cd"},
         .curves = lobes,
         .curve_count = 2,
         .points_down = true},
        {.kind = SR_PLOT_MAP,
         .values = values,
         .rows = ROWS,
         .columns = COLUMNS,
         .has_no_frame = true,
         .has_contours = true,
         .z = {.label = "L_{v}", .unit = "cd/m^{2}"}},
    };
    struct sr_plot_figure figure = {.panels = two, .panel_count = 2};
    struct sr_plot_check check;
    size_t size, plain;
    char *data = encoded(&figure, SR_PLOT_SVG, &size, &check);
    EXPECT(check.texts > 10);
    if (check.outside || check.overlaps)
        test_fail(__FILE__, __LINE__, "%s", check.offender);
    sr_free(data);
    two[1].has_contours = false; // they are drawn
    data = encoded(&figure, SR_PLOT_SVG, &plain, &check);
    EXPECT(plain < size);
    sr_free(data);
}

TEST(a_figure_is_whole_or_an_error_when_memory_ends)
{
    size_t size;
    uint64_t before = sr_alloc_count();
    char *whole = encoded(&all, SR_PLOT_SVG, &size, NULL);
    uint64_t count = sr_alloc_count() - before;
    for (uint64_t i = 0; i < count; ++i) {
        struct sr_error error = {0};
        char *data = NULL;
        size_t now = 0;
        sr_alloc_fail(i, 1);
        sr_status status = sr_plot_encode(&all, SR_PLOT_SVG, &data, &now, NULL, &error);
        sr_alloc_fail(0, 0);
        EXPECT(status == SR_OK || status == SR_ERROR_RESOURCE);
        EXPECT(status != SR_OK || (now == size && memcmp(data, whole, size) == 0));
        sr_free(data);
    }
    sr_free(whole);
}
