/* SPDX-License-Identifier: MIT */
/* Small valid files of each format of measured data, and a way of damaging them that can be repeated. */
#ifndef TEST_FUZZ_SEEDS_H
#define TEST_FUZZ_SEEDS_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum {
    SEED_MERL,
    SEED_RGL,
    SEED_RGL_RGB,
    SEED_POLARISED,
    SEED_KLEMS,
    SEED_TREE,
    SEED_CORNELL,
    SEED_ASTM,
    SEED_ABG,
    SEED_TABLE,
    SEED_CLOUD,
    SEED_COUNT
};
enum { SEED_SIZE = 16384 }; // room that a file may take

static const char *const seed_names[SEED_COUNT] = {"merl",    "rgl",  "rgl_rgb", "polarised", "klems", "tree",
                                                   "cornell", "astm", "abg",     "table",     "cloud"};

struct seed {
    size_t size;
    size_t header; // bytes of it in which each byte matters
    unsigned char data[SEED_SIZE];
};

static inline void seed_put(struct seed *s, const void *data, size_t size)
{
    if (s->size + size <= SEED_SIZE) {
        memcpy(s->data + s->size, data, size);
        s->size += size;
    }
}
__attribute__((format(printf, 2, 3))) static inline void seed_print(struct seed *s, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    seed_put(s, text, strlen(text));
}

struct seed_field {
    const char *name;
    int type; // 1 uint8, 3 uint16, 10 float32
    int dimensions;
    uint64_t shape[6];
    float value; // of each element
    const float *values;
};

static inline void seed_tensor(struct seed *s, const struct seed_field *f, int count)
{
    uint64_t offset = 18, n[16];
    for (int i = 0; i < count; ++i) {
        offset += 2 + strlen(f[i].name) + 2 + 1 + 8 + 8 * (uint64_t)f[i].dimensions;
        n[i] = 1;
        for (int k = 0; k < f[i].dimensions; ++k)
            n[i] *= f[i].shape[k];
    }
    seed_put(s, "tensor_file\0\1\0", 14);
    seed_put(s, &(uint32_t){(uint32_t)count}, 4);
    for (int i = 0; i < count; ++i) {
        uint64_t width = f[i].type == 10 ? 4 : f[i].type == 3 ? 2 : 1;
        seed_put(s, &(uint16_t){(uint16_t)strlen(f[i].name)}, 2);
        seed_put(s, f[i].name, strlen(f[i].name));
        seed_put(s, &(uint16_t){(uint16_t)f[i].dimensions}, 2);
        seed_put(s, &(uint8_t){(uint8_t)f[i].type}, 1);
        seed_put(s, &offset, 8);
        for (int k = 0; k < f[i].dimensions; ++k)
            seed_put(s, &f[i].shape[k], 8);
        offset += width * n[i];
    }
    s->header = s->size;
    for (int i = 0; i < count; ++i)
        for (uint64_t k = 0; k < n[i]; ++k) {
            float v = f[i].values ? f[i].values[k] : f[i].value;
            if (f[i].type == 10)
                seed_put(s, &v, 4);
            else if (f[i].type == 3)
                seed_put(s, &(uint16_t){(uint16_t)v}, 2);
            else
                seed_put(s, &(uint8_t){(uint8_t)v}, 1);
        }
}

static inline void seed_make(int which, struct seed *s)
{
    static const float theta[] = {0, 0.5f, 1.2f}, nm[] = {450, 650}, half[] = {0, 0.7f, 1.5f},
                       turn[] = {-3.14f, 0, 3.14f}, zero[] = {0};
    s->size = s->header = 0;
    if (which == SEED_MERL) {
        seed_put(s, (int32_t[3]){4, 3, 5}, 12);
        s->header = s->size;
        for (int i = 0; i < 3 * 60; ++i)
            seed_put(s, &(double){i % 17 ? 100 + i : -1}, 8);
    } else if (which == SEED_RGL || which == SEED_RGL_RGB) {
        bool rgb = which == SEED_RGL_RGB;
        const struct seed_field fields[] = {
            {"theta_i", 10, 1, {3}, 0, theta},
            {"phi_i", 10, 1, {rgb ? 3 : 1}, 0, rgb ? turn : zero},
            {"ndf", 10, 2, {2, 2}, 1, NULL},
            {"sigma", 10, 2, {2, 2}, 1, NULL},
            {"vndf", 10, 4, {rgb ? 3 : 1, 3, 2, 3}, 1, NULL},
            {"jacobian", 1, 1, {1}, 1, NULL},
            {rgb ? "rgb" : "spectra", 10, 5, {rgb ? 3 : 1, 3, rgb ? 3 : 2, 2, 2}, 0.2f, NULL},
            {"description", 1, 1, {5}, 'x', NULL},
            {"wavelengths", 10, 1, {2}, 0, nm}};
        seed_tensor(s, fields, 9);
    } else if (which == SEED_POLARISED) {
        const struct seed_field fields[] = {{"phi_d", 10, 2, {1, 3}, 0, turn},
                                            {"theta_d", 10, 2, {1, 3}, 0, half},
                                            {"theta_h", 10, 2, {0, 3}, 0, NULL},
                                            {"wvls", 3, 1, {2}, 0, nm},
                                            {"M", 10, 6, {3, 3, 3, 2, 4, 4}, 0.3f, NULL}};
        seed_tensor(s, fields, 5);
    } else if (which == SEED_KLEMS || which == SEED_TREE) {
        bool tree = which == SEED_TREE;
        seed_print(
            s,
            "<?xml "
            "version=\"1.0\"?>\n<WindowElement><Optical><Layer><Material><Name>S</Name></Material><DataDefinition>"
            "<IncidentDataStructure>%s</IncidentDataStructure>",
            tree ? "TensorTree3" : "Columns");
        if (!tree)
            seed_print(s, "<AngleBasis><AngleBasisName>Small</AngleBasisName><AngleBasisBlock><nPhis>1</"
                          "nPhis><ThetaBounds><LowerTheta>0"
                          "</LowerTheta><UpperTheta>30</UpperTheta></ThetaBounds></"
                          "AngleBasisBlock><AngleBasisBlock><nPhis>4</nPhis>"
                          "<ThetaBounds><LowerTheta>30</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></"
                          "AngleBasisBlock></AngleBasis>");
        seed_print(s, "</DataDefinition>\n");
        static const char *const ways[] = {"Reflection Front", "Transmission Back"};
        static const char *const ranges[] = {"Visible", "CIE-X", "CIE-Z"};
        for (int i = 0; i < 6; ++i) {
            seed_print(s,
                       "<WavelengthData><Wavelength>%s</Wavelength><WavelengthDataBlock><WavelengthDataDirection>%s</"
                       "WavelengthDataDirection>",
                       ranges[i % 3], ways[i / 3]);
            seed_print(s, tree ? "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>"
                               : "<ColumnAngleBasis>Small</ColumnAngleBasis><RowAngleBasis>Small</RowAngleBasis>");
            seed_print(s, "<ScatteringData>");
            if (tree)
                seed_print(s, "{ {.1 .2 .3 .1 .2 .3 .1 .2} {.1} {.2} {.1} {.1} {.3} {.1} {.2} }");
            for (int k = 0; !tree && k < 25; ++k)
                seed_print(s, "%g, ", 0.1 + 0.01 * k);
            seed_print(s, "</ScatteringData></WavelengthDataBlock></WavelengthData>\n");
        }
        seed_print(s, "</Layer></Optical></WindowElement>");
        s->header = s->size;
    } else if (which == SEED_CORNELL) {
        seed_print(s, "# num wls\n2\n# wls\n450 650\n# theta i, phi i, theta s, phi s, values\n");
        s->header = s->size;
        for (int i = 0; i < 20; ++i)
            seed_print(s, "%.2f 0 %.2f %.2f 0.1 0.2\n", 0.2 + 0.3 * (i % 4), 0.05 * i, -0.15 * i);
    } else if (which == SEED_ASTM || which == SEED_TABLE) {
        seed_print(s, which == SEED_ASTM
                          ? "NUM_POINTS 18\nVARS theta_i,phi_i,theta_s,phi_s,450nm,650nm\n"
                          : "# quantity: cosine\n# angles: degrees\ntheta_i phi_i theta_o phi_o lambda f\n");
        s->header = s->size;
        for (int i = 0; i < 18; ++i)
            for (int k = 0; k < (which == SEED_ASTM ? 1 : 2); ++k)
                seed_print(s, "%g,%d,%g,%d,%g,%g\n", 0.5 * (i % 3), 0, 0.4 * (i / 3 % 3), i / 9,
                           which == SEED_ASTM ? 0.1 : 450 + 200.0 * k, 0.2);
    } else if (which == SEED_CLOUD) {
        seed_print(s, "theta_i phi_i theta_o phi_o r g b\n");
        s->header = s->size;
        for (int i = 0; i < 40; ++i)
            seed_print(s, "%d %d %d %d %g 0.2 0.1\n", i % 7 * 10, i % 3 * 40, i % 2 ? i % 5 * 15 : 180 - i % 5 * 15,
                       i * 9, 0.1 + 0.01 * i);
    } else {
        seed_print(s, "ABg BRDF\n# lambda A B g\n450 0.002 0.001 1.8\n650 0.001 0.0005 1.9\n");
        s->header = s->size;
    }
}

static inline uint32_t seed_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33);
}

/* One to eight of: a bit turned, a byte replaced, an interesting number, bytes dropped or doubled, a cut, a word
 * exchanged. */
static inline void seed_damage(struct seed *s, uint64_t *state)
{
    static const int64_t numbers[] = {
        0,          1,         -1,        2,         255,       256,       4096,
        65535,      65536,     INT32_MAX, INT32_MIN, INT64_MAX, INT64_MIN, 0x7ff8000000000000,
        0x7f800000, 0x7fc00000};
    static const char *const words[] = {"nan", "-1",      "1e999", "inf", "{",  "}", "<", ">",     "90",
                                        "0",   "theta_i", "550nm", "-",   "\n", " ", "#", "1e-320"};
    for (uint32_t n = 1 + seed_random(state) % 8; n > 0 && s->size > 0; --n) {
        // damage of headers is worth more
        size_t limit = s->header > 0 && s->header < s->size && seed_random(state) & 1 ? s->header : s->size;
        size_t at = seed_random(state) % limit, length = 1 + seed_random(state) % 16;
        length = length < s->size - at ? length : s->size - at;
        switch (seed_random(state) % 7) {
        case 0:
            s->data[at] ^= (unsigned char)(1u << seed_random(state) % 8);
            break;
        case 1:
            s->data[at] = (unsigned char)seed_random(state);
            break;
        case 2: {
            size_t width = (size_t)1 << seed_random(state) % 4;
            int64_t v = numbers[seed_random(state) % 16];
            memcpy(s->data + at, &v, width < s->size - at ? width : s->size - at);
            break;
        }
        case 3:
            memmove(s->data + at, s->data + at + length, s->size - at - length);
            s->size -= length;
            break;
        case 4:
            if (s->size + length <= SEED_SIZE) {
                memmove(s->data + at + length, s->data + at, s->size - at);
                s->size += length;
            }
            break;
        case 5:
            if (seed_random(state) % 8 == 0)
                s->size = at;
            break;
        default: {
            const char *word = words[seed_random(state) % 17];
            size_t width = strlen(word);
            memcpy(s->data + at, word, width < s->size - at ? width : s->size - at);
        }
        }
    }
}

#endif
