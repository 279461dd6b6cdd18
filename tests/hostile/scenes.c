/* SPDX-License-Identifier: MIT */
/* Writes the scenes: the seeds of the fuzz programs, under the names by which one scene asks for all of them. */
#define _GNU_SOURCE // memmem
#include "hostile/scenes.h"

#include "fuzz/gltf_seeds.h"
#include "fuzz/image_seeds.h"
#include "fuzz/scene_seeds.h"
#include "render/render.h"
#include "test.h"
#include "unit/medium/nanovdb_writer.h"

#include <zlib.h>

static char path[1200];

static const char *path_of(const char *name)
{
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    return path;
}

static void put(const char *name, const void *data, size_t size)
{
    struct sr_error error = {0};
    if (sr_file_write(path_of(name), data, size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

static void put_text(const char *name, const char *text)
{
    put(name, text, strlen(text));
}

static float density(int i, int j, int k)
{
    return (float)((i * 7 + j * 5 + k * 3) & 15);
}

static void put_volume(void)
{
    struct nanovdb_spec spec = {.name = "density",
                                .type = 1,
                                .lo = {0, 0, 0},
                                .hi = {9, 9, 9},
                                .value = density,
                                .matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    struct nanovdb_file file = {0};
    nanovdb_write(&file, &spec);
    put("volume.nvdb", file.data, file.size);
    free(file.data);
}

static void put_packed(const char *name, const char *text)
{
    gzFile file = gzopen(path_of(name), "wb");
    if (!file || gzputs(file, text) < 0 || gzclose(file) != Z_OK)
        test_fail(__FILE__, __LINE__, "%s cannot be written", name);
}

static const char measured_names[SEED_COUNT][20] = {"merl.binary", "rgl.bsdf",  "rgb.bsdf",    "polarised.pbsdf",
                                                    "klems.xml",   "tree.xml",  "cornell.dat", "astm.txt",
                                                    "abg.txt",     "table.txt", "cloud.txt"};

static const char more[] =
    "Include \"part.pbrt\"\nShape \"plymesh\" \"string filename\" \"mesh.ply.gz\"\n"
    "LightSource \"infinite\" \"string filename\" \"image.pfm\"\nLightSource \"ies\" \"string filename\" \"lamp.ies\"\n"
    "LightSource \"goniometric\" \"string filename\" \"image.png\"\nLightSource \"projection\" \"string filename\" \"image.hdr\"\n"
    "LightSource \"infinite\" \"spectrum L\" \"curve.spd\"\n"
    "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"image.exr\"\nMaterial \"diffuse\" \"texture reflectance\" \"a\"\nShape \"sphere\"\n"
    "Texture \"b\" \"spectrum\" \"imagemap\" \"string filename\" \"image.jpg\"\nMaterial \"diffuse\" \"texture reflectance\" \"b\" \"string normalmap\" \"image.png\"\nShape \"sphere\"\n"
    "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"image.tga\"\nMaterial \"diffuse\" \"texture reflectance\" \"c\"\nShape \"sphere\"\n"
    "Texture \"d\" \"float\" \"imagemap\" \"string filename\" \"image.qoi\"\nMaterial \"diffuse\" \"texture displacement\" \"d\"\nShape \"sphere\"\n"
    "MakeNamedMedium \"cloud\" \"string type\" \"nanovdb\" \"string filename\" \"volume.nvdb\"\nMediumInterface \"cloud\" \"\"\nMaterial \"interface\" Shape \"sphere\" \"float radius\" 2\n"
    "MediumInterface \"\" \"\"\nMaterial \"subsurface\" \"string name\" \"Skin1\" Shape \"sphere\" \"float radius\" .3\nMaterial \"hair\" Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 1]\n";

static void put_scene(const char *name, const char *estimator, const char *parameters)
{
    static char text[SEED_SIZE];
    const char *integrator = strstr(seed_scene_head, "\"volpath\"");
    int n = estimator ? snprintf(text, sizeof text, "%.*s\"%s\" %s # %s", (int)(integrator - seed_scene_head),
                                 seed_scene_head, estimator, parameters, integrator)
                      : snprintf(text, sizeof text, "%s", seed_scene_head);
    const char *fog = strstr(seed_scene_body, "MediumInterface"),
               *behind = strchr(fog, '\n'); // through which only volpath goes
    n += snprintf(text + n, sizeof text - (size_t)n, "%.*s%s%s", (int)(fog - seed_scene_body), seed_scene_body,
                  estimator ? behind : fog, estimator ? "" : more);
    for (int i = 0; i < SEED_COUNT && !estimator; ++i)
        n += snprintf(text + n, sizeof text - (size_t)n,
                      "Material \"measured\" \"string filename\" \"%s\"\nShape \"sphere\" \"float radius\" .2\n",
                      measured_names[i]);
    if (n >= (int)sizeof text)
        test_fail(__FILE__, __LINE__, "the scene is too long");
    put_text(name, text);
}

static void put_everything(void)
{
    static const char *const images[] = {"image.exr", "image.png", "image.jpg", "image.pfm",
                                         "image.hdr", "image.qoi", "image.tga"};
    static struct seed s;
    char ply[1024];
    for (int i = 0; i < 7; ++i) {
        image_seed(i, &s);
        put(images[i], s.data, s.size);
    }
    for (int i = 0; i < SEED_COUNT; ++i) {
        seed_make(i, &s);
        put(measured_names[i], s.data, s.size);
    }
    for (int i = 0; i < 2; ++i) {
        gltf_seed(i, &s);
        char *image = memmem(s.data, s.size, "\"bufferView\":0}],\"textures\"", 27); // one that can be read
        memcpy(image, "\"uri\":\"x.png\" ", 14);
        put(i ? "model.glb" : "model.gltf", s.data, s.size);
    }
    snprintf(ply, sizeof ply, "%s%s", seed_ply_head, seed_ply_body);
    put_text("model.ply", ply);
    put_packed("mesh.ply.gz", ply);
    put_text("part.pbrt", "AttributeBegin\nScale 2 2 2\nShape \"disk\"\nAttributeEnd\n");
    put_text("curve.spd", seed_spectrum);
    put_text("lens.dat", seed_lens);
    put_text("lamp.ies",
             "IESNA:LM-63-1995\nTILT=NONE\n1 500 1 3 2 1 2 0 0 0\n1 1 20\n0 45 90\n0 90\n100 80 10 90 70 5\n");
    put_text("model.mtl", seed_materials);
    image_seed(1, &s);
    put("none.png", s.data, s.size);
    put("x.png", s.data, s.size);
    put_text(
        "model.obj",
        "mtllib model.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1 4//1\nf -4 -3 -2 -1\n");
    put_text(
        "model.stl",
        "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
    put_volume();
    put_text(
        "lens.pbrt",
        "Camera \"realistic\" \"string lensfile\" \"lens.dat\" \"float aperturediameter\" 3 \"string aperture\" \"image.png\"\n"
        "WorldBegin\nLightSource \"infinite\"\nShape \"sphere\" \"float radius\" .1\n");
    put_scene("scene.pbrt", NULL, "");
}

const char *hostile_scene(const char *name)
{
    static bool is_written;
    if (!is_written)
        put_everything();
    is_written = true;
    return path_of(name);
}

const char *hostile_estimator(const char *name, const char *parameters)
{
    char file[64];
    snprintf(file, sizeof file, "%s.pbrt", name);
    put_scene(file, name, parameters);
    return path_of(file);
}

sr_status hostile_render(const char *name, const char *out, struct sr_error *error)
{
    struct sr_import_options options = {.threads = 1, .width = 3, .height = 2, .spp = 4};
    struct sr_import_result r;
    sr_status status = sr_import_pbrt(name, &options, &r, NULL, error);
    if (status != SR_OK)
        return status;
    struct sr_render_job job = sr_render_job_of(&r);
    job.threads = 1;
    job.with_aov = true;
    struct sr_film *film = NULL;
    struct sr_image *image = NULL;
    struct sr_render_report report;
    status = sr_render(&job, &film, &report, error);
    if (status == SR_OK)
        status = sr_render_image(film, true, false, &image, error);
    if (status == SR_OK)
        status = sr_image_write(out, image, NULL, error);
    sr_image_free(image);
    sr_film_destroy(film);
    sr_import_result_free(&r);
    return status;
}
