/* SPDX-License-Identifier: MIT */
/* Help, and arguments that make no sense: exit 2, and a way out. */
#include "run.h"

static const char *const names[] = {"render", "info", "compare", "image"};

TEST(usage_help_has_examples_for_every_subcommand)
{
    EXPECT_SAYS(run_expecting(0, "--help")->out, "Exit codes:");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        char line[64];
        EXPECT_SAYS(run_expecting(0, "--help")->out, names[i]);
        snprintf(line, sizeof line, "%s --help", names[i]);
        const struct said *s = run_expecting(0, line);
        EXPECT_SAYS(s->out, "Examples:");
        EXPECT_SAYS(s->out, "Usage: steradian");
        EXPECT_EQUAL_TEXT(s->err, "");
    }
}

TEST(usage_version_and_nothing)
{
    EXPECT_SAYS(run_expecting(0, "--version")->out, "steradian ");
    EXPECT_SAYS(run_expecting(2, "")->err, "Usage:");
}

TEST(usage_typos_get_suggestions)
{
    static const char *const lines[][2] = {
        {"rendr", "did you mean \"render\"?"},
        {"comapre a b", "did you mean \"compare\"?"},
        {"render --ssp 3 x", "did you mean --spp"},
        {"compare --max-rmes 1 a b", "did you mean --max-rmse"},
        {"image --exposre 1 a", "did you mean --exposure"},
        {"info --jsn x", "did you mean --json"},
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i)
        EXPECT_SAYS(run_expecting(2, lines[i][0])->err, lines[i][1]);
}

TEST(usage_errors_exit_with_2_and_tell_what_was_expected)
{
    static const char *const lines[][2] = {
        {"quite-another-word", "no subcommand"},
        {"render", "a scene file was expected"},
        {"render a.pbrt b.pbrt", "there are 2"},
        {"render x --spp", "a value was expected"},
        {"render x --spp 0", "whole number from 1"},
        {"render x --spp 12x", "whole number"},
        {"render x --spp -1", "whole number"},
        {"render x --seed 99999999999", "whole number"},
        {"render x --resolution 10", "2 numbers"},
        {"render x --resolution nan,3", "numbers"},
        {"render x --resolution 0,3", "from 1 up"},
        {"render x --lambda 800,400", "LO < HI"},
        {"render x --cropwindow 0.5,0.5,0,1", "X0 < X1"},
        {"render x --sampler halton", "sobol or independent"},
        {"render x --sample 3", "--pixel"},
        {"render x.pbrt --camera 2", "glTF"},
        {"render x.pbrt --variant red", "glTF"},
        {"converge x --resolution 1e300,4", "from 1 to 4096"},
        {"render x --json=yes", "takes no value"},
        {"render x -z", "no option -z"},
        {"render x -o picture.tga", "ending"},
        {"render x -o picture", "ending"},
        {"compare a.exr", "two pictures"},
        {"compare a.exr b.exr --all --channel R", "together"},
        {"compare a.exr b.exr --max-z -1", "number from 0"},
        {"image", "a picture was expected"},
        {"image a.exr -o b.jpg", "ending"},
        {"image a.exr -o b.exr --exposure 1", ".png"},
        {"image a.exr -o b.png --tone hable", "filmic"},
        {"image a.exr --crop 1,2,3", "4 numbers"},
        {"image a.exr --crop 0,0,0,4", "whole pixels"},
        {"info", "a file was expected"},
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i) {
        const struct said *s = run_expecting(2, lines[i][0]);
        EXPECT_SAYS(s->err, lines[i][1]);
        EXPECT_SAYS(s->err, "--help");
        EXPECT_EQUAL_TEXT(s->out, "");
    }
}
