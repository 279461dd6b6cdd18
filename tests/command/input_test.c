/* SPDX-License-Identifier: MIT */
/* Files that are wrong: an exit code, a sentence with file:line:column, and nothing left behind. */
#include "run.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define FILM "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 \"string filename\" \"left.exr\"\n"
#define HEAD                                                                                                           \
    FILM "Sampler \"zsobol\" \"integer pixelsamples\" 4\nCamera \"perspective\"\nWorldBegin\nLightSource "             \
         "\"infinite\"\n"
#define QUAD "\"point3 P\" [ -1 -1 3  1 -1 3  1 1 3  -1 1 3 ] \"integer indices\" [ 0 1 2  0 2 3 ]\n"

static void expect_nothing_left(void)
{
    EXPECT_EQUAL_INT(count_files("left"), 0);
    EXPECT_EQUAL_INT(count_files(".part-"), 0);
}

/* A scene that must be refused, by info and by render alike. */
static void expect_refused(const char *text, const char *where, const char *what)
{
    put_file("bad.pbrt", text);
    static const char *const lines[] = {"render bad.pbrt", "render bad.pbrt -o left.png", "info bad.pbrt"};
    for (int i = 0; i < 3; ++i) {
        const struct said *s = run_expecting(3, lines[i]);
        EXPECT_SAYS(s->err, where);
        EXPECT_SAYS(s->err, what);
        EXPECT_EQUAL_TEXT(s->out, "");
        expect_nothing_left();
    }
}

TEST(input_missing_scene)
{
    EXPECT_SAYS(run_expecting(3, "render nowhere.pbrt -o left.exr")->err, "nowhere.pbrt: cannot be opened");
    EXPECT_SAYS(run_expecting(3, "info nowhere.pbrt")->err, "nowhere.pbrt: cannot be opened");
    EXPECT_SAYS(run_expecting(3, "info nowhere.exr")->err, "nowhere.exr: cannot be opened");
    expect_nothing_left();
}

TEST(input_folder_for_a_scene)
{
    EXPECT_SAYS(run_expecting(3, "render . -o left.exr")->err, "folder");
    EXPECT_SAYS(run_expecting(3, "info .")->err, "folder");
    expect_nothing_left();
}

TEST(input_scene_without_world)
{
    expect_refused("", "bad.pbrt", "WorldBegin");
    expect_refused(FILM "Camera \"perspective\"\n", "bad.pbrt", "WorldBegin");
}

TEST(input_truncated_mesh)
{
    put_file("cut.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 2\nproperty list uchar int vertex_indices\nend_header\n-1 -1 3\n1 -1 3\n");
    expect_refused(HEAD "Shape \"plymesh\" \"string filename\" \"cut.ply\"\n", "cut.ply", "vert");
    put_file("cut.ply",
             "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\nproperty float x\nproperty float y\n"
             "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n12345");
    expect_refused(HEAD "Shape \"plymesh\" \"string filename\" \"cut.ply\"\n", "cut.ply", "");
}

TEST(input_missing_mesh_and_texture)
{
    expect_refused(HEAD "Shape \"plymesh\" \"string filename\" \"nowhere.ply\"\n", "bad.pbrt:6:", "nowhere.ply");
    expect_refused(HEAD "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"nowhere.png\"\n"
                        "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"trianglemesh\" " QUAD,
                   "bad.pbrt:6:", "nowhere.png");
}

TEST(input_transform_that_is_no_number)
{
    expect_refused(HEAD "Translate 0 nan 1\nShape \"sphere\"\n", "bad.pbrt:6:", "");
    expect_refused(HEAD "Scale 0 1 1\nShape \"sphere\"\n", "bad.pbrt:", "");
}

TEST(input_unsupported_and_unknown_things)
{
    expect_refused(HEAD "Shape \"hyperboloid\"\n", "bad.pbrt:6:1", "hyperboloid");
    expect_refused(HEAD "Texture \"t\" \"float\" \"ptex\"\nShape \"sphere\" \"texture alpha\" \"t\"\n", "bad.pbrt:6:1",
                   "Ptex");
    expect_refused(HEAD "Shapes \"sphere\"\n", "bad.pbrt:6:1", "Shape");
    expect_refused("Camera \"realistic\"\nWorldBegin\n", "bad.pbrt:1:1", "realistic");
}

TEST(input_misspelt_parameter_is_warned_about_with_a_suggestion)
{
    put_file("misspelt.pbrt", HEAD "Shape \"sphere\" \"float raduis\" 2\n");
    const struct said *s = run_expecting(0, "render misspelt.pbrt -o ok.pfm --quiet");
    EXPECT_SAYS(s->err, "misspelt.pbrt:6:");
    EXPECT_SAYS(s->err, "raduis");
    EXPECT_SAYS(s->err, "\"radius\"");
    EXPECT_SAYS(run_expecting(0, "info misspelt.pbrt")->out, "1 warning\n");
}

TEST(input_mesh_without_area_renders_and_is_counted)
{
    put_file("flat.pbrt",
             HEAD "Shape \"trianglemesh\" \"point3 P\" [ 0 0 3  1 1 3  2 2 3 ] \"integer indices\" [ 0 1 2 ]\n");
    json_t *j = json_of(run_expecting(0, "render flat.pbrt -o flat.pfm --json -q"));
    EXPECT_EQUAL_INT(json_integer_value(json_object_get(json_object_get(j, "counts"), "primitives_without_area")), 1);
    json_decref(j);
    // what is left is the sky alone: every pixel as bright as the next
    struct sr_image *image = get_image("flat.pfm");
    struct sr_image_statistics stats;
    struct sr_error error = {0};
    EXPECT(sr_image_statistics(image, 1, &stats, &error) == SR_OK);
    EXPECT(stats.mean > 0);
    EXPECT(stats.nan_count + stats.infinite_count == 0);
    sr_image_free(image);
}

TEST(input_scene_without_shapes_renders_black)
{
    put_file("empty.pbrt", FILM "Sampler \"zsobol\" \"integer pixelsamples\" 4\nCamera \"perspective\"\nWorldBegin\n");
    const struct said *s = run_expecting(0, "render empty.pbrt -o empty.exr -o empty.png");
    EXPECT_SAYS(s->err, "empty");
    struct sr_image *image = get_image("empty.exr");
    for (uint32_t c = 0; c < 3; ++c)
        for (uint32_t p = 0; p < 64; ++p)
            EXPECT_NEAR(image->floats[p * image->channel_count + c], 0, 0);
    sr_image_free(image);
    expect_nothing_left();
}

TEST(input_pictures_too_large_are_refused_at_once)
{
    EXPECT_SAYS(run_expecting(4, "render " CORNELL " -o left.exr --resolution 1000000000,1000000000")->err,
                "too large");
    EXPECT_SAYS(run_expecting(4, "render " CORNELL " -o left.exr --resolution 1000000,1000000")->err, "memory");
    expect_refused("Film \"rgb\" \"integer xresolution\" 1000000000 \"integer yresolution\" 1000000000\nCamera "
                   "\"perspective\"\nWorldBegin\n",
                   "bad.pbrt:1:", "xresolution");
    expect_nothing_left();
}

TEST(output_that_cannot_be_written_is_found_before_rendering)
{
    char folder[512];
    snprintf(folder, sizeof folder, "%s/folder.exr", test_folder());
    EXPECT(mkdir(folder, 0777) == 0);
    // so many samples that rendering first would not end
    EXPECT_SAYS(run_expecting(4, "render " CORNELL " --spp 1000000 -o folder.exr")->err,
                "folder.exr: cannot be written: it is a folder");
    EXPECT_SAYS(run_expecting(4, "render " CORNELL " --spp 1000000 -o no/such/left.exr")->err,
                "no/such/left.exr: cannot be written");
    EXPECT_SAYS(run_expecting(4, "render " CORNELL " --spp 1000000 -o ok.exr -o /proc/left.exr")->err,
                "/proc/left.exr: cannot be written");
    put_file("elsewhere.pbrt",
             "Film \"rgb\" \"string filename\" \"no/such/left.exr\"\nCamera \"perspective\"\nWorldBegin\n");
    EXPECT_SAYS(run_expecting(4, "render elsewhere.pbrt --spp 1000000")->err, "no/such/left.exr: cannot be written");
    put_file("ending.pbrt", "Film \"rgb\" \"string filename\" \"left.tga\"\nCamera \"perspective\"\nWorldBegin\n");
    EXPECT_SAYS(run_expecting(3, "render ending.pbrt --spp 1000000")->err, "use -o");
    rmdir(folder);
    expect_nothing_left();
}

TEST(info_tells_what_it_understands)
{
    put_file("scene.gltf", "{}");
    EXPECT_SAYS(run_expecting(3, "info scene.gltf")->err, "scene.gltf: /asset: ");
    put_file("mesh.ply", "ply\n");
    EXPECT_SAYS(run_expecting(3, "info mesh.ply")->err, "end_header");
    put_file("notes.txt", "words\n");
    EXPECT_SAYS(run_expecting(3, "info notes.txt")->err, ".pbrt.gz");
    put_file("broken.exr", "no image");
    EXPECT_SAYS(run_expecting(3, "info broken.exr")->err, "broken.exr");
    EXPECT_SAYS(run_expecting(3, "compare broken.exr broken.exr")->err, "broken.exr");
    EXPECT_SAYS(run_expecting(3, "image broken.exr -o left.png")->err, "broken.exr");
    expect_nothing_left();
}

/* What stands where a page or a checkpoint is to go is overwritten only if it is one. */
TEST(output_spares_devices_and_foreign_files)
{
    char path[600];
    struct stat st;
    snprintf(path, sizeof path, "%s/pipe", test_folder());
    EXPECT(mkfifo(path, 0600) == 0);
    int reader = open(path, O_RDONLY | O_NONBLOCK); // or the writer would wait
    char words[1400];
    snprintf(words, sizeof words,
             "validate " SR_TEST_SOURCE_DIR "/validation/cases.tsv --case B8 --samples 256 --markdown %s", path);
    EXPECT_SAYS(run_expecting(0, words)->out, "1 of 1 cases pass");
    EXPECT(stat(path, &st) == 0 && S_ISFIFO(st.st_mode));
    close(reader);
    unlink(path);

    if (access("/dev/full", W_OK) == 0) { // what is printed, too
        EXPECT_EQUAL_INT(WEXITSTATUS(system("'" SR_TEST_COMMAND "' brdf list >/dev/full 2>/dev/null")), 4);
        EXPECT_EQUAL_INT(WEXITSTATUS(system("'" SR_TEST_COMMAND "' info '" CORNELL "' >/dev/full 2>/dev/null")), 4);
    }
    put_file("notes.txt", "words\n");
    EXPECT_SAYS(run_expecting(3, "render " CORNELL " --spp 1 -o ok.pfm --checkpoint notes.txt")->err, "no checkpoint");
    EXPECT_SAYS(run_expecting(3, "info notes.txt")->err, "notes.txt");
    expect_nothing_left();
}

/* Forty textures, each made of the one before twice, would be evaluated 2^40 times; so for mixes, and for files. */
TEST(input_that_grows_twofold_again_and_again_is_refused)
{
    static const char *const kinds[2][3] = {
        {"Texture \"x0\" \"float\" \"constant\"\n",
         "Texture \"x%d\" \"float\" \"scale\" \"texture tex\" \"x%d\" \"texture scale\" \"x%d\"\n",
         "Material \"conductor\" \"texture roughness\" \"x40\"\n"},
        {"MakeNamedMaterial \"x0\" \"string type\" \"diffuse\"\n",
         "MakeNamedMaterial \"x%d\" \"string type\" \"mix\" \"string materials\" [\"x%d\" \"x%d\"]\n",
         "NamedMaterial \"x40\"\n"}};
    for (int k = 0; k < 2; ++k) {
        char text[8192];
        int n = snprintf(text, sizeof text, HEAD "%s", kinds[k][0]);
        for (int i = 1; i <= 40; ++i)
            n += snprintf(text + n, sizeof text - (size_t)n, kinds[k][1], i, i - 1, i - 1);
        snprintf(text + n, sizeof text - (size_t)n, "%sShape \"sphere\"\n", kinds[k][2]);
        put_file("laughs.pbrt", text);
        EXPECT_SAYS(run_expecting(3, "render laughs.pbrt --quiet")->err, "is made of more than 65536");
        EXPECT_SAYS(run_expecting(3, "info laughs.pbrt --quiet")->err, "laughs.pbrt:");
    }
    for (int i = 0; i < 30; ++i) { // files that include the next one twice
        char name[32], text[64];
        snprintf(name, sizeof name, "again%d.pbrt", i);
        snprintf(text, sizeof text, "Include \"again%d.pbrt\" Include \"again%d.pbrt\"\n", i + 1, i + 1);
        put_file(name, text);
    }
    put_file("again30.pbrt", "Shape \"sphere\"\n");
    put_file("laughs.pbrt", HEAD "Include \"again0.pbrt\"\n");
    EXPECT_SAYS(run_expecting(3, "render laughs.pbrt --quiet")->err, "more than 65536 files");
    EXPECT_SAYS(run_expecting(3, "convert laughs.pbrt --includes flatten -o left.pbrt")->err, "more than 65536 files");
    expect_nothing_left();
}
