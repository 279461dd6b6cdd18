/* SPDX-License-Identifier: MIT */
/* steradian brdf plot: every model can be shown in every kind, legibly; mistakes are told. */
#include "run.h"

#include "bsdf/bsdf.h"

static long size_of(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    FILE *file = fopen(path, "rb");
    if (!file)
        return -1;
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    fclose(file);
    return size;
}

TEST(brdf_plot_shows_every_model)
{
    for (int i = 0; sr_bsdf_models[i]; ++i) {
        const struct sr_bsdf_model *m = sr_bsdf_models[i];
        bool needs_file = false;
        for (const struct sr_param *p = m->params; p->name; ++p)
            needs_file |= p->kind == SR_PARAM_FILE;
        if (needs_file)
            continue;
        char line[256];
        // random walks take their time: what is drawn alone tells enough of them
        snprintf(line, sizeof line, "brdf plot %s -k %s --samples 1 -o plot.svg", m->name,
                 m->is_random ? "lobe" : "lobe,lobe-log,theta,half,albedo,sampling,body,slice");
        const struct said *s = run_expecting(0, line);
        if (s->err[0])
            test_fail(__FILE__, __LINE__, "%s: %s", line, s->err); // what cannot be read is a warning
        EXPECT(size_of("plot.svg") > 5000);
        remove_file("plot.svg");
    }
}

TEST(brdf_plot_overlays_models_and_wavelengths)
{
    const struct said *s =
        run_expecting(0, "brdf plot diffuse --name matte --vs conductor alpha_x=.2 alpha_y=.2 --name "
                         "metal -k theta,albedo --log --lambda 450,650 -o two.svg");
    EXPECT_EQUAL_TEXT(s->err, "");
    EXPECT(size_of("two.svg") > 5000);
    run_expecting(0,
                  "brdf plot conductor eta=metal-Au-eta k=metal-Au-k alpha_x=.2 alpha_y=.2 --colour -k body,slice,ball "
                  "--samples 1 --light point -o colour.png --scale 2");
    struct sr_image *image = get_image("colour.png");
    EXPECT_EQUAL_INT(image->width, 2 * 1040);
    sr_image_free(image);
}

TEST(brdf_plot_draws_the_classic_figure)
{
    run_expecting(0, "brdf plot --classic classic");
    struct sr_image *image = get_image("classic/classic.png");
    EXPECT(image->width > 900 && image->height > 600);
    sr_image_free(image);
    EXPECT(size_of("classic/classic.svg") > 50000);
}

TEST(brdf_plot_writes_the_same_bytes_again)
{
    const char *const kinds = "brdf plot conductor alpha_x=.3 alpha_y=.1 -k body,ball --samples 4 -o";
    char line[256], a[512], b[512];
    struct sr_error error = {0};
    char *first, *second;
    size_t first_size, second_size;
    snprintf(line, sizeof line, "%s first.png", kinds);
    run_expecting(0, line);
    snprintf(line, sizeof line, "%s second.png", kinds);
    run_expecting(0, line);
    snprintf(a, sizeof a, "%s/first.png", test_folder());
    snprintf(b, sizeof b, "%s/second.png", test_folder());
    EXPECT_EQUAL_INT(sr_file_read(a, 1 << 24, &first, &first_size, &error), SR_OK);
    EXPECT_EQUAL_INT(sr_file_read(b, 1 << 24, &second, &second_size, &error), SR_OK);
    EXPECT(first_size == second_size && memcmp(first, second, first_size) == 0);
    sr_free(first);
    sr_free(second);
}

TEST(brdf_plot_tells_mistakes)
{
    EXPECT_SAYS(run_expecting(2, "brdf plot diffuse")->err, "-o FILE");
    EXPECT_SAYS(run_expecting(2, "brdf plot -o a.png")->err, "a model");
    EXPECT_SAYS(run_expecting(2, "brdf plot diffuse --vs -o a.png")->err, "a model");
    EXPECT_SAYS(run_expecting(2, "brdf plot diffuse -o a.gif")->err, ".svg or .png");
    EXPECT_SAYS(run_expecting(2, "brdf plot diffuse -k lobes -o a.png")->err, "did you mean lobe");
    EXPECT_SAYS(run_expecting(2, "brdf plot diffuse --wi 95 -o a.png")->err, "from above");
    EXPECT_SAYS(run_expecting(2, "brdf plot diffuse --colr -o a.png")->err, "--colour");
    EXPECT_SAYS(run_expecting(3, "brdf plot difuse -o a.png")->err, "diffuse");
    EXPECT_SAYS(run_expecting(3, "brdf plot diffuse reflectance=2 -o a.png")->err, "reflectance=2");
    EXPECT(size_of("a.png") < 0);
    run_expecting(4, "brdf plot diffuse -k lobe -o no/such/folder/a.png");
}
