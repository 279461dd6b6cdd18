/* SPDX-License-Identifier: MIT */
/* Files of a part of a picture, and checkpoints: whatever the bytes, they are refused with a reason, or what they hold
 * is whole.
 *
 * Checksums would keep a fuzzer out, so that most inputs are given right ones first, wherever their sections are: what
 * is behind must stand a file that somebody has made on purpose. Runs as fuzz_measured.c does. */
#define _GNU_SOURCE
#include "fuzz/seeds.h"
#include "import/import.h"
#include "render/render.h"
#include "store/layout.h"
#include "temporary.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#define NAME "/proc/self/fd/100"

static void open_file(const void *data, size_t size)
{
    int file = memfd_create("fuzzed", 0);
    if (file < 0 || write(file, data, size) != (ssize_t)size || dup2(file, 100) < 0)
        exit(4);
    close(file);
}

static void sign(uint8_t *bytes, size_t size)
{
    struct store_header h;
    if (size < sizeof h)
        return;
    memcpy(&h, bytes, sizeof h);
    h.size = size;
    h.crc = sr_store_crc_header(&h);
    memcpy(bytes, &h, sizeof h);
    size_t at = sizeof h;
    for (uint32_t i = 0; i < h.sections && size - at >= sizeof(struct store_section); ++i) {
        struct store_section s;
        memcpy(&s, bytes + at, sizeof s);
        s.crc = sr_store_crc_header(&s);
        memcpy(bytes + at, &s, sizeof s);
        at += sizeof s;
        uint64_t blocks = store_blocks(s.size), rest = s.size + store_gap(s.size);
        if (s.size > size || rest + 4 * blocks > size - at)
            return;
        uint8_t *data = bytes + at, *sums = data + rest;
        for (uint64_t b = 0; b < blocks; ++b) {
            uint64_t from = b * SR_STORE_BLOCK, n = s.size - from < SR_STORE_BLOCK ? s.size - from : SR_STORE_BLOCK;
            uint32_t crc = sr_store_crc_block(i, b, data + from, n);
            memcpy(sums + 4 * b, &crc, 4);
        }
        at += rest + 4 * blocks + store_gap(4 * blocks);
        if (at > size)
            return;
    }
}

static void judge_status(sr_status status, const struct sr_error *error)
{
    if ((status == SR_OK) != (error->status == SR_OK) || (status != SR_OK && !error->text[0]) ||
        status == SR_ERROR_RESOURCE)
        abort(); // a refusal has a reason
}

static void judge(const uint8_t *data, size_t size)
{
    uint8_t *bytes = malloc(size ? size : 1);
    if (!bytes)
        exit(4);
    memcpy(bytes, data, size);
    if (size % 8 != 1)
        sign(bytes, size);
    open_file(bytes, size);
    struct sr_error error = {0}, of_part = {0};
    struct sr_store_in *in;
    struct sr_render_part *part;
    sr_status status = sr_store_open(NAME, NULL, &in, &error);
    judge_status(status, &error);
    if (status == SR_OK) {
        const char *name;
        size_t B;
        uint64_t sum = 0;
        for (uint32_t i = 0; sr_store_section(in, i, &name, &B); ++i) {
            const uint8_t *at = sr_store_get(in, name, &B);
            for (size_t k = 0; at && k < B; ++k)
                sum += at[k];
        }
        __asm__ volatile("" : : "r"(sum));
        struct sr_render_progress_kept kept;
        sr_render_checkpoint_tells(in, &kept);
        sr_store_close(in);
    }
    status = sr_render_part_read(NAME, &part, &of_part);
    judge_status(status, &of_part);
    if (status == SR_OK) {
        struct sr_render_range range;
        for (size_t i = 0; sr_render_part_range(part, i, &range); ++i)
            if (range.begin >= range.end)
                abort();
        struct sr_image *image = NULL;
        struct sr_film *film = sr_render_part_film(part);
        if (film)
            sr_render_image(film, true, sr_render_part_is_replicated(part), &image, &error);
        sr_image_free(image);
        sr_render_part_destroy(part);
    }
    close(100);
    free(bytes);
}

static void make_seed(int number, struct seed *s)
{
    static const char scene[] = "WorldBegin LightSource \"infinite\" Shape \"sphere\"\n";
    struct sr_import_options options = {.threads = 1, .width = 3, .height = 2, .spp = 4};
    struct sr_import_result r;
    struct sr_error error = {0};
    struct sr_render_part *part;
    struct sr_render_report report;
    char folder[512], path[600], *bytes;
    size_t size;
    open_file(scene, sizeof scene - 1);
    if (!make_temporary_folder("fuzz", folder) || sr_import_pbrt(NAME, &options, &r, NULL, &error) != SR_OK)
        exit(4);
    snprintf(path, sizeof path, "%s/part", folder);
    struct sr_render_job job = sr_render_job_of(&r);
    job.spp = 4;
    job.threads = 1;
    job.with_aov = number >= 0;
    if (sr_render_samples(&job, (struct sr_render_range){0, 3}, &part, &report, &error) != SR_OK ||
        sr_render_part_write(part, "a 1\n", "b", path, &error) != SR_OK ||
        sr_file_read(path, SEED_SIZE, &bytes, &size, &error) != SR_OK)
        exit(4);
    unlink(path);
    rmdir(folder);
    sr_render_part_destroy(part);
    sr_import_result_free(&r);
    close(100);
    s->size = 0;
    seed_put(s, bytes, size);
    s->header = s->size < 1024 ? s->size : 1024;
    sr_free(bytes);
}

static const char *seed_name(int number)
{
    return number ? "" : "store";
}

#include "fuzz/driver.h"
