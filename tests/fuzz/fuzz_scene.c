/* SPDX-License-Identifier: MIT */
/* Scenes as text, and the small files that they name: whatever the bytes, they are read, built and rendered, or refused
 * with a reason.
 *
 * FUZZ_SEED: 0 pbrt text, as a description; 1 a whole scene, built, with one sample rendered of each pixel; 2 the
 * tables that a scene names: by its first byte a spectrum, a lens, a material library of OBJ, or anything packed by
 * gzip; 3 a PLY mesh. The scene includes itself, which must be found out. Runs as fuzz_measured.c does. */
#define _GNU_SOURCE
#include "fuzz/scene_seeds.h"
#include "fuzz/seeds.h"
#include "import/describe.h"
#include "import/obj.h"
#include "import/ply.h"
#include "integrator/integrator.h"
#include "render/render.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#define FUZZ_VARIANTS (FUZZ_SEED == 2 ? 4 : 1)
static int variant; // of the tables

static void pack(struct seed *s)
{
    z_stream z = {.next_in = (Bytef *)(uintptr_t)seed_scene_body,
                  .avail_in = sizeof seed_scene_body,
                  .next_out = s->data + s->size,
                  .avail_out = (uInt)(SEED_SIZE - s->size)};
    if (deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK ||
        deflate(&z, Z_FINISH) != Z_STREAM_END)
        exit(4);
    s->size += z.total_out;
    deflateEnd(&z);
}

static void make_seed(int number, struct seed *s)
{
    s->size = s->header = 0;
    if (number < 2) {
        seed_put(s, seed_scene_head, strlen(seed_scene_head));
        s->header = s->size;
        seed_put(s, seed_scene_body, strlen(seed_scene_body));
        if (number == 0)
            seed_print(s, "Include \"/proc/self/fd/100\"\n");
    } else if (number == 2) {
        static const char *const tables[] = {seed_spectrum, seed_lens, seed_materials};
        uint8_t which = (uint8_t)variant;
        seed_put(s, &which, 1);
        if (variant < 3)
            seed_put(s, tables[variant], strlen(tables[variant]));
        else
            pack(s);
    } else {
        seed_put(s, seed_ply_head, strlen(seed_ply_head));
        s->header = s->size;
        seed_put(s, seed_ply_body, strlen(seed_ply_body));
    }
}

static const char *seed_name(int number)
{
    return ((const char *const[]){"pbrt", "scene", "tables", "ply"})[number];
}

/* ---- files: in memory, under names that scenes can tell ---- */

enum { OUTER = 100, INNER = 101 };
#define OUTER_NAME "/proc/self/fd/100"
#define INNER_NAME "/proc/self/fd/101"

static void open_file(int number, const void *data, size_t size)
{
    int file = memfd_create("fuzzed", 0);
    if (file < 0 || write(file, data, size) != (ssize_t)size || dup2(file, number) < 0)
        exit(4);
    close(OUTER);
}

static void judge_status(sr_status status, const struct sr_error *error)
{
    if ((status == SR_OK) != (error->status == SR_OK) || (status != SR_OK && !error->text[0]))
        abort(); // a refusal has a reason
    if (status == SR_ERROR_RESOURCE)
        abort(); // nothing here is large
}

static void judge_text(const uint8_t *data, size_t size)
{
    open_file(OUTER, data, size);
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_pbrt_description d;
    judge_status(sr_pbrt_read(OUTER_NAME, &arena, NULL, &d, &error), &error);
    if (arena.total + d.words.total > 16 * d.text_B + 64 * size + (1u << 20))
        abort(); // memory by what the file says, not by what it is
    sr_pbrt_description_free(&d);
    sr_arena_free(&arena);
    close(OUTER);
}

static void judge_scene(const void *data, size_t size)
{
    open_file(OUTER, data, size);
    struct sr_import_options options = {.threads = 1, .width = 3, .height = 2, .spp = 1};
    struct sr_import_result r;
    struct sr_error error = {0};
    sr_status status = sr_import_pbrt(OUTER_NAME, &options, &r, NULL, &error);
    judge_status(status, &error);
    if (status == SR_OK) {
        struct sr_render_job job = sr_render_job_of(&r);
        job.spp = job.threads = 1;
        struct sr_film *film = NULL;
        struct sr_render_report report;
        if ((uint64_t)r.film.width * r.film.height <= 64 && r.scene)
            judge_status(sr_render(&job, &film, &report, &error), &error);
        sr_film_destroy(film);
        sr_import_result_free(&r);
    }
    close(OUTER);
}

static void judge_named(const char *text, const uint8_t *data, size_t size)
{
    open_file(INNER, data, size);
    judge_scene(text, strlen(text));
    close(INNER);
}

static void judge_library(const uint8_t *data, size_t size)
{
    static const struct sr_import_options nothing;
    static const char text[] = "mtllib " INNER_NAME "\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n";
    open_file(INNER, data, size);
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_pbrt_description d = {0};
    judge_status(sr_obj_read_text("file", text, sizeof text - 1, &nothing, &arena, NULL, &d, &error), &error);
    sr_pbrt_description_free(&d);
    sr_arena_free(&arena);
    close(INNER);
}

static void judge_packed(const uint8_t *data, size_t size)
{
    char *bytes;
    open_file(OUTER, data, size);
    size_t unpacked;
    struct sr_error error = {0};
    sr_status status = sr_file_read(OUTER_NAME, 64 << 20, &bytes, &unpacked, &error);
    judge_status(status, &error);
    if (status == SR_OK && (bytes[unpacked] != 0 || unpacked > 1100 * size))
        abort();
    sr_free(bytes);
    close(OUTER);
}

static void judge_table(const uint8_t *data, size_t size)
{
    if (size == 0)
        return;
    switch (data[0] % 4) {
    case 0:
        judge_named("WorldBegin LightSource \"infinite\" \"spectrum L\" \"" INNER_NAME "\"\n", data + 1, size - 1);
        break;
    case 1:
        judge_named("Camera \"realistic\" \"string lensfile\" \"" INNER_NAME
                    "\" \"float aperturediameter\" 3\nWorldBegin\n",
                    data + 1, size - 1);
        break;
    case 2:
        judge_library(data + 1, size - 1);
        break;
    default:
        judge_packed(data + 1, size - 1);
    }
}

static void judge_ply(const uint8_t *data, size_t size)
{
    struct sr_ply_mesh mesh = {0};
    struct sr_error error = {0};
    char *text = malloc(size + 1); // ended by NUL, as files are read
    if (!text)
        exit(4);
    memcpy(text, data, size);
    text[size] = 0;
    sr_status status = sr_ply_decode("file.ply", text, size, &mesh, &error);
    judge_status(status, &error);
    if (mesh.memory.total > 16 * size + (1u << 20))
        abort();
    for (uint32_t i = 0; status == SR_OK && i < 3 * mesh.triangle_count; ++i)
        if (mesh.triangles[i] < 0 || (uint32_t)mesh.triangles[i] >= mesh.vertex_count)
            abort();
    for (uint32_t i = 0; status == SR_OK && i < 4 * mesh.quad_count; ++i)
        if (mesh.quads[i] < 0 || (uint32_t)mesh.quads[i] >= mesh.vertex_count)
            abort();
    sr_ply_free(&mesh);
    free(text);
}

/* All words that a scene may have, as its text has them. */
static void write_word(void *context, const struct sr_import_plugin *plugin)
{
    static const char *const types[] = {"bool",      "integer", "float",   "string",  "string", "string",
                                        "point2",    "point3",  "vector3", "normal",  "rgb",    "spectrum",
                                        "blackbody", "texture", "texture", "texture", "string", "integer",
                                        "float",     "point2",  "point3",  "vector3", "normal", "rgb"};
    bool is_bare = strcmp(plugin->kind, "directive") == 0;
    if (plugin->name[0])
        fprintf(context, is_bare ? "\"%s \"\n" : "\"\\\"%s\\\" \"\n", plugin->name);
    for (const struct sr_param *p = plugin->params; p && p->name; ++p)
        fprintf(context, "\"\\\"%s %s\\\" \"\n", types[p->kind], p->name);
}

__attribute__((unused)) static void write_words(FILE *file) // by libFuzzer alone
{
    if (FUZZ_SEED < 2)
        sr_import_plugins(write_word, file);
}
#define FUZZ_DICTIONARY write_words

static void judge(const uint8_t *data, size_t size)
{
    switch (FUZZ_SEED) {
    case 0:
        judge_text(data, size);
        break;
    case 1:
        judge_scene(data, size);
        break;
    case 2:
        judge_table(data, size);
        break;
    default:
        judge_ply(data, size);
    }
}

#include "fuzz/driver.h"
