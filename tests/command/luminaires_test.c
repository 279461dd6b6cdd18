/* SPDX-License-Identifier: MIT */
/* Luminaires, false colours, glare and goniometers as a user meets them. */
#include "run.h"

static double value_of(json_t *object, const char *name)
{
    return json_number_value(json_object_get(json_object_get(object, name), "value"));
}

#define LAMP                                                                                                           \
    "IESNA:LM-63-2002\n[MANUFAC] Formula & Sons\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 5\n0 45 90\n0\n100 100 0\n"
#define ROOM                                                                                                           \
    "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 40\nSampler \"independent\" \"integer pixelsamples\" 4\n"

TEST(info_tells_and_plots_a_luminaire)
{
    put_file("lamp.ies", LAMP);
    json_t *j = json_of(run_expecting(0, "info lamp.ies --json --plot lamp.svg"));
    // 2 pi (1 - cos 45) 100, and a slope down to the horizon: (100 / 45 deg) (90 - gamma)
    EXPECT_RELATIVE(value_of(j, "flux"), 184.0302 + 209.9737, 1e-3);
    EXPECT_RELATIVE(value_of(j, "efficacy"), (184.0302 + 209.9737) / 5, 1e-3);
    EXPECT_NEAR(value_of(json_object_get(j, "beam_angle"), "C0-C180"), 135, 0.01);
    json_decref(j);
    EXPECT_EQUAL_INT(count_files("lamp.svg"), 1);
    EXPECT_SAYS(run_expecting(0, "info lamp.ies -o lamp.ldt")->out, "Formula & Sons");
    j = json_of(run_expecting(0, "info lamp.ldt -o again.ies --json"));
    EXPECT_RELATIVE(value_of(j, "flux"), 184.0302 + 209.9737, 1e-3);
    json_decref(j);
    EXPECT_SAYS(run_expecting(0, "info again.ies")->out, "Formula & Sons");
    EXPECT_SAYS(run_expecting(2, "info lamp.ies -o lamp.txt")->err, ".ies or .ldt");
    remove_file("lamp.ldt");
    remove_file("again.ies");
    put_file("lamp.ies", "IESNA91\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 x\n");
    EXPECT_SAYS(run_expecting(3, "info lamp.ies")->err, "lamp.ies:7: candela values: a number is expected, not \"x");
    put_file("none.png", "");
    EXPECT_SAYS(run_expecting(2, "info none.png --plot a.svg")->err, "--plot and -o are for luminaires");
    remove_file("none.png");
    remove_file("lamp.svg");
    remove_file("lamp.ies");
}

/* The light and the camera of comments are those of directives; pbrt does not see them. */
TEST(luminaires_light_scenes_and_fisheyes_judge_their_glare)
{
    put_file("lamp.ies", LAMP);
    put_file(
        "room.pbrt", ROOM
        "LookAt 0 0 0  0 1 0  0 0 1\nCamera \"perspective\"\n#@ Camera \"fisheye\" \"string mapping\" \"equisolid\"\nWorldBegin\n"
        "#@ Meter \"irradiance\" \"string name\" \"below\" \"point3 p\" [0 0 -2] \"normal n\" [0 0 1]\n"
        "AttributeBegin\n#@ LightSource \"ies\" \"string filename\" \"lamp.ies\" \"float scale\" 4\nAttributeEnd\n"
        "AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" 5000\nTranslate 0 3 1 Shape \"sphere\" \"float radius\" 0.4\nAttributeEnd\n"
        "Material \"diffuse\" Shape \"sphere\" \"float radius\" 50\n");
    EXPECT_SAYS(run_expecting(0, "measure room.pbrt --samples 1024 --quiet")->out, "below");
    run_expecting(0, "render room.pbrt -o room.exr --quiet");
    struct sr_image *image = get_image("room.exr");
    EXPECT(strstr(sr_image_get_attribute(image, "steradian.camera"), "fisheye; mapping equisolid; fov 180"));
    sr_image_free(image);
    json_t *j = json_of(run_expecting(0, "glare room.exr --json --threshold 2000 -o sources.png"));
    EXPECT_RELATIVE(value_of(j, "solid_angle"), 6.283185307, 1e-5);
    json_t *sources = json_object_get(j, "sources");
    EXPECT_EQUAL_INT(json_array_size(sources), 1);
    EXPECT_NEAR(value_of(json_array_get(sources, 0), "sigma"), 18.43, 1);
    EXPECT_NEAR(value_of(json_array_get(sources, 0), "tau"), 0, 3);
    EXPECT(value_of(j, "E_v") > 0 && value_of(json_object_get(j, "indices"), "UGR") > 10);
    json_decref(j);
    EXPECT_SAYS(run_expecting(2, "glare room.exr --projection square")->err, "equisolid");
    run_expecting(0, "image room.exr --channel R -o red.exr --quiet");
    run_expecting(0, "image room.exr --false-colour --log --contours --scale 1,10000 -o false.png --quiet");
    image = get_image("false.png");
    EXPECT(image->width > 400 && image->height > 400);
    sr_image_free(image);
    EXPECT_SAYS(run_expecting(2, "image room.exr --log -o a.png")->err, "belong to --false-colour");
    EXPECT_SAYS(run_expecting(2, "image room.exr --false-colour --scale 5,1 -o a.png")->err, "LO below HI");
    static const char *const files[] = {"lamp.ies", "room.pbrt", "room.exr", "red.exr", "sources.png", "false.png"};
    for (int i = 0; i < 6; ++i)
        remove_file(files[i]);
}

TEST(pictures_of_other_cameras_are_no_field_of_view)
{
    put_file("room.pbrt", ROOM "WorldBegin\nLightSource \"infinite\"\n");
    run_expecting(0, "render room.pbrt -o room.exr --quiet");
    EXPECT_SAYS(run_expecting(3, "glare room.exr")->err, "its camera is no fisheye");
    json_t *j = json_of(run_expecting(0, "glare room.exr --projection orthographic --json")); // taken at the word
    EXPECT_RELATIVE(value_of(j, "E_v"), 3.14159265, 1e-3);
    json_decref(j);
    remove_file("room.pbrt");
    remove_file("room.exr");
}

TEST(geometry_becomes_a_table_and_a_lamp_a_file)
{
    put_file(
        "flat.pbrt",
        "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [360 0.4 830 0.4]\nShape \"bilinearmesh\" \"point3 P\" [-9 -9 0  9 -9 0  -9 9 0  9 9 0]\n");
    EXPECT_SAYS(run_expecting(
                    0, "brdf measure flat.pbrt -o flat.txt --patch -1,1,-1,1 --samples 64000 --incidence 3 --cells 6,6")
                    ->out,
                "0.40000");
    json_t *j = json_of(run_expecting(0, "brdf info flat.txt --json")),
           *f = json_array_get(json_object_get(j, "files"), 0);
    EXPECT_NEAR(value_of(json_array_get(json_object_get(f, "scatter"), 4), "reflected"), 0.4, 0.02);
    json_decref(j);
    EXPECT_SAYS(run_expecting(2, "brdf measure flat.pbrt -o flat.txt")->err, "--patch");
    // 500 lm, measured, written and read
    put_file(
        "lamp.pbrt",
        "WorldBegin\nLightSource \"point\" \"float power\" 500\n#@ Meter \"intensity\" \"string name\" \"far\" \"float cstep\" 360 \"float gammastep\" 10\n");
    run_expecting(0, "measure lamp.pbrt -o lamp.ldt --samples 100000 --quiet");
    j = json_of(run_expecting(0, "info lamp.ldt --json"));
    EXPECT_RELATIVE(value_of(j, "flux"), 500, 0.01);
    EXPECT_RELATIVE(value_of(json_object_get(j, "peak"), "intensity"), 500 / (4 * 3.14159265), 0.03);
    json_decref(j);
    static const char *const files[] = {"flat.pbrt", "flat.txt", "lamp.pbrt", "lamp.ldt"};
    for (int i = 0; i < 4; ++i)
        remove_file(files[i]);
}
