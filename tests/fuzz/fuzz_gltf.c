/* SPDX-License-Identifier: MIT */
/* glTF files: whatever the bytes, the reader says what is wrong or gives shapes whose indices and runs are whole, in
 * memory that the size of the file bounds.
 *
 * FUZZ_SEED: 0 text with a buffer in it, 1 GLB. Runs as fuzz_measured.c does. */
#include "fuzz/gltf_seeds.h"
#include "import/gltf/gltf.h"

#include <stdio.h>
#include <stdlib.h>

static void judge_shape(const struct sr_pbrt_shape *s)
{
    const struct sr_pbrt_param *P = sr_pbrt_find(&s->entity.params, "P"),
                               *indices = sr_pbrt_find(&s->entity.params, "indices");
    const struct sr_pbrt_param *uv = sr_pbrt_find(&s->entity.params, "uv"), *N = sr_pbrt_find(&s->entity.params, "N");
    if (!P || !indices || P->count % 3 || indices->count % 3 || (uv && 3 * uv->count != 2 * P->count) ||
        (N && N->count != P->count))
        abort();
    for (uint32_t i = 0; i < indices->count; ++i)
        if (indices->ints[i] < 0 || (uint32_t)indices->ints[i] >= P->count / 3)
            abort();
}

static void judge(const uint8_t *bytes, size_t size)
{
    static const struct sr_import_options none;
    struct sr_arena data = {0};
    struct sr_error error = {0};
    struct sr_pbrt_description d;
    sr_status status = sr_gltf_read_bytes("model.gltf", (const char *)bytes, size, &none, &data, NULL, &d, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status != SR_OK && !error.text[0]))
        abort(); // a refusal has a reason
    if (data.total + d.words.total > 16 * size + ((size_t)64 << 20))
        abort();
    for (size_t i = 0; i < d.shapes.count && status == SR_OK; ++i)
        judge_shape(SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, i));
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
}

static void make_seed(int number, struct seed *seed)
{
    gltf_seed(number, seed);
}

static const char *seed_name(int number)
{
    return number ? "glb" : "gltf";
}

#include "fuzz/driver.h"
