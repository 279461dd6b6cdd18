/* SPDX-License-Identifier: MIT */
/* OBJ and STL: whatever the bytes, the reader says what is wrong, or gives a scene whose triangles name vertices that
 * are there, all of them somewhere, within the memory that the file's size allows.
 *
 * FUZZ_SEED: 0 OBJ, 1 STL as text, 2 STL in bytes. Runs as fuzz_measured.c does. */
#include "fuzz/seeds.h"
#include "import/obj.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void mesh_seed(int which, struct seed *s)
{
    s->size = 0;
    if (which == 0) {
        seed_print(
            s,
            "mtllib none.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nv .5 .2 0\nvt 0 0\nvt 1 0 0\nvt 1 1\nvn 0 0 1\n");
        s->header = s->size;
        seed_print(s,
                   "f 1/1/1 2/2/1 3/3/1 4//1\nusemtl m\nf -5 -4 -3 -2 -1\ng b c\nf 1 2 3 \\\n 4 5\n# end\nf 5 4 1\n");
    } else if (which == 1) {
        seed_print(s, "solid x\n");
        s->header = s->size;
        for (int i = 0; i < 3; ++i)
            seed_print(
                s,
                "facet normal 0 0 1\nouter loop\nvertex %d 0 0\nvertex 1 %d 0\nvertex 0 1e-3 -2.5\nendloop\nendfacet\n",
                i, i);
    } else {
        s->size = s->header = 84;
        memset(s->data, 0, 84);
        s->data[80] = 4;
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < 50; ++k)
                s->data[s->size++] = (uint8_t)(k % 4 == 3 ? 0x3f : k * i);
    }
}

static void judge_shape(const struct sr_pbrt_shape *shape)
{
    const struct sr_pbrt_param *P = sr_pbrt_find(&shape->entity.params, "P"),
                               *indices = sr_pbrt_find(&shape->entity.params, "indices");
    if (!P || !indices || P->count % 3 || indices->count % 3)
        abort();
    for (uint32_t i = 0; i < P->count; ++i)
        if (!isfinite(P->floats[i]))
            abort();
    for (uint32_t i = 0; i < indices->count; ++i)
        if (indices->ints[i] < 0 || 3 * (uint32_t)indices->ints[i] >= P->count)
            abort();
}

static void judge(const uint8_t *data, size_t size)
{
    static const struct sr_import_options nothing;
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_pbrt_description d = {0};
    char *text = malloc(size + 1); // ended by NUL, as files are read
    if (!text)
        exit(4);
    memcpy(text, data, size);
    text[size] = 0;
    sr_status status = FUZZ_SEED == 0 ? sr_obj_read_text("file", text, size, &nothing, &arena, NULL, &d, &error)
                                      : sr_stl_read_bytes("file", text, size, &nothing, &arena, NULL, &d, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status != SR_OK && !error.text[0]))
        abort(); // a refusal has a reason
    if (arena.total + d.words.total > 16 * size + (1u << 20))
        abort(); // memory by what the file says, not by what it is
    for (size_t i = 0; status == SR_OK && i < d.shapes.count; ++i)
        judge_shape(SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, i));
    sr_pbrt_description_free(&d);
    sr_arena_free(&arena);
    free(text);
}

static void make_seed(int number, struct seed *seed)
{
    mesh_seed(number, seed);
}

static const char *seed_name(int number)
{
    return number ? "stl" : "obj";
}

#include "fuzz/driver.h"
