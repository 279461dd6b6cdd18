/* SPDX-License-Identifier: MIT */
/* Luminaire files: whatever the bytes, the reader says what is wrong or gives intensities that are finite, a flux, a
 * report, directions to draw, and a file that reads back.
 *
 * FUZZ_SEED: 0 IES of type C, 1 of type B, 2 EULUMDAT. Runs as fuzz_measured.c does. */
#include "fuzz/seeds.h"
#include "measured/measured.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void photometry_seed(int which, struct seed *s)
{
    s->size = 0;
    if (which < 2) {
        seed_print(s,
                   "IESNA:LM-63-1995\n[MANUFAC] Formula & Sons\n[MORE] of numbers\nTILT=INCLUDE\n1\n2\n0 90\n1 0.9\n");
        seed_print(s, which ? "1 -1 1 5 3 2 1 .5 1 0\n1 1 20\n-90 -45 0 45 90\n0 45 90\n"
                            : "2 500 1.5 4 5 1 2 -0.3 -.3 0\n0.9 1 20\n0 30 60 90\n0 90 180 270 360\n");
    } else {
        seed_print(
            s,
            "Maker\n3\n4\n8\n45\n4\n30\nr\nname\nn\nfile\ndate\n100\n0\n50\n80\n40,5\n0\n0\n0\n0\n100\n80\n1,0\n0\n1\n1\nLED\n1500\n3000K\n80\n10\n");
        seed_print(s, "0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n45\n90\n135\n180\n225\n270\n315\n0\n30\n60\n90\n");
    }
    s->header = s->size;
    for (int i = 0; i < 20; ++i)
        seed_print(s, "%g\n", 100.5 - 5 * (i % 5));
}

static void judge(const uint8_t *data, size_t size)
{
    struct sr_arena arena = {0}, again = {0};
    struct sr_error error = {0};
    const struct sr_photometry *p, *q;
    sr_status status = sr_photometry_parse("file", data, size, &arena, &p, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status != SR_OK && !error.text[0]))
        abort(); // a refusal has a reason
    if (arena.total > 64 * size + (1u << 20))
        abort(); // memory by what the file says, not by what it is
    if (status == SR_OK) {
        struct sr_photometry_report report;
        struct sr_photometry_guide guide;
        uint32_t hash = (uint32_t)sr_hash_bytes(data, size, 0);
        for (int i = 0; i < 64; ++i) {
            double I = sr_photometry_intensity(p, (hash >> (i % 16)) % 720 - 180.0, i * 180.0 / 63);
            if (!(I >= 0) || !isfinite(I))
                abort();
        }
        if (hash % 64 == 0) { // slow
            sr_photometry_report(p, &report);
            if (!(report.flux > 0 && report.flux_down <= report.flux * 1.0001 &&
                  report.beam[0] <= report.field[0] + 1e-6 && report.field[1] <= 360.001))
                abort();
            if (sr_photometry_guide_build(p, &arena, &guide))
                for (int i = 0; i < 64; ++i) {
                    float pdf;
                    sr_vec3 d = sr_photometry_sample(&guide, (sr_vec2){(float)i / 64, (float)(i * 29 % 64) / 64}, &pdf);
                    if (!(pdf > 0) || !isfinite(pdf) || !(fabsf(sr_length2(d) - 1) < 1e-4f))
                        abort();
                }
        }
        for (int format = 0; format < 2 && p->c_count * p->gamma_count < 4096; ++format) {
            char *text;
            size_t length;
            struct sr_error reason = {0};
            if (sr_photometry_print(p, (enum sr_photometry_format)format, &text, &length, &reason) == SR_OK &&
                sr_photometry_parse("again", text, length, &again, &q, &reason) == SR_OK &&
                fabs(sr_photometry_flux(q, 0, 180) - sr_photometry_flux(p, 0, 180)) >
                    1e-3 * sr_photometry_flux(p, 0, 180))
                abort();
            sr_free(text);
        }
    }
    sr_arena_free(&again);
    sr_arena_free(&arena);
}

static void make_seed(int number, struct seed *seed)
{
    photometry_seed(number, seed);
}

static const char *seed_name(int number)
{
    return number == 2 ? "ldt" : "ies";
}

#include "fuzz/driver.h"
