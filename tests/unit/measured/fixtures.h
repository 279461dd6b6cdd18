/* SPDX-License-Identifier: MIT */
/* Files of measured data made of formulas, so that what is read from them is known. */
#ifndef TEST_MEASURED_FIXTURES_H
#define TEST_MEASURED_FIXTURES_H

#include "measured/measured.h"
#include "test.h"

#ifndef PI
#define PI 3.14159265358979323846
#endif

static inline sr_vec3 direction(double theta_deg, double phi_deg)
{
    double t = theta_deg * PI / 180, p = phi_deg * PI / 180;
    return (sr_vec3){(float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)cos(t)};
}

static inline sr_spectrum wavelengths(void)
{
    sr_spectrum lambda;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        lambda[i] = 420 + 260 * (float)i / (SR_LAMBDA_COUNT - 1);
    return lambda;
}

/* A matte base and a lobe about the half vector, reciprocal: f = a / pi + b h_z^n [1/sr]; over wavelengths the base
 * rises. */
struct gloss {
    float base, lobe, exponent;
};
static inline sr_spectrum gloss_f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    const struct gloss *g = user;
    if (!(wo.z > 0 && wi.z > 0))
        return SR_BLACK;
    sr_vec3 h = sr_normalize(sr_add(wo, wi));
    return g->base * SR_INV_PI * (0.5f + 0.5f * (lambda - 380) / 400) + g->lobe * powf(h.z, g->exponent);
}
static inline sr_spectrum grey_gloss_f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    (void)lambda;
    return gloss_f(user, wo, wi, SR_BLACK + 780);
}

/* INTEGRAL of f cos_theta_o dwo by Gauss-Legendre in theta and even steps in phi: without half vectors */
static inline double albedo_by_quadrature(sr_measured_source f, void *user, sr_vec3 wi, float lambda)
{
    enum { N = 200 };
    double x[N], w[N], sum = 0;
    sr_gauss_legendre(N, 0, PI / 2, x, w);
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j)
            sum += w[i] * sin(x[i]) * cos(x[i]) * 2 * PI / N *
                   (double)f(user, direction(x[i] * 180 / PI, 360.0 * (j + 0.5) / N), wi, SR_BLACK + lambda)[0];
    return sum;
}
static inline sr_spectrum measured_f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    return sr_measured_f(*(const struct sr_measured *const *)user, wo, wi, lambda);
}

/* Bytes that grow. */
struct bytes {
    char *data;
    size_t size, room;
};
static inline void put(struct bytes *b, const void *data, size_t size)
{
    if (!b->data || b->size + size > b->room) {
        b->room = 2 * (b->size + size) + 1;
        b->data = realloc(b->data, b->room);
        EXPECT(b->data);
    }
    memcpy(b->data + b->size, data, size);
    b->size += size;
}
__attribute__((format(printf, 2, 3))) static inline void print(struct bytes *b, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    int n = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    EXPECT(n >= 0 && n < (int)sizeof text);
    put(b, text, (size_t)n);
}
static inline void drop(struct bytes *b)
{
    free(b->data);
    *b = (struct bytes){0};
}

static inline const struct sr_measured *parse_with(struct sr_arena *arena, const struct bytes *b,
                                                   struct sr_measured_options options)
{
    struct sr_error error = {0};
    const struct sr_measured *m;
    if (sr_measured_parse("fixture", b->data, b->size, &options, arena, &m, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return m;
}
static inline const struct sr_measured *parse(struct sr_arena *arena, const struct bytes *b)
{
    return parse_with(arena, b, (struct sr_measured_options){0});
}
/* It is refused, for a reason that contains these words. */
static inline void expect_refused(const struct bytes *b, const char *words)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    const struct sr_measured *m;
    sr_status status = sr_measured_parse("fixture", b->data, b->size, NULL, &arena, &m, &error);
    if (status != SR_ERROR_INPUT || m || !strstr(error.text, words) || strncmp(error.text, "fixture", 7) != 0)
        test_fail(__FILE__, __LINE__, "status %d, \"%s\": a refusal with \"%s\" was expected", status, error.text,
                  words);
    sr_arena_free(&arena);
}

/* ---- tensor files ---- */

struct tensor {
    const char *name;
    int type, dimensions;
    const void *data;
    uint64_t shape[6];
};
static inline struct bytes tensor_file(const struct tensor *fields, int count)
{
    struct bytes b = {0};
    put(&b, "tensor_file\0\1\0", 14);
    put(&b, &(uint32_t){(uint32_t)count}, 4);
    uint64_t offset = 18, size[16];
    for (int i = 0; i < count; ++i) {
        offset += 2 + strlen(fields[i].name) + 2 + 1 + 8 + 8 * (uint64_t)fields[i].dimensions;
        size[i] = fields[i].type == 10 ? 4 : fields[i].type == 3 ? 2 : 1;
        for (int k = 0; k < fields[i].dimensions; ++k)
            size[i] *= fields[i].shape[k];
    }
    for (int i = 0; i < count; ++i) {
        put(&b, &(uint16_t){(uint16_t)strlen(fields[i].name)}, 2);
        put(&b, fields[i].name, strlen(fields[i].name));
        put(&b, &(uint16_t){(uint16_t)fields[i].dimensions}, 2);
        put(&b, &(uint8_t){(uint8_t)fields[i].type}, 1);
        put(&b, &offset, 8);
        for (int k = 0; k < fields[i].dimensions; ++k)
            put(&b, &fields[i].shape[k], 8);
        offset += size[i];
    }
    for (int i = 0; i < count; ++i)
        put(&b, fields[i].data, size[i]);
    return b;
}

/* An RGL file whose warp is the identity: the density is 1 everywhere, so spectra are f cos_theta_i over the half
 * vector. quarter: 1, 2 or 4 of the turn that phi_i covers; 0: isotropic. */
static inline struct bytes rgl_file(sr_measured_source f, void *user, int part, bool is_rgb)
{
    enum { N = 48, T = 10, W = 3 };
    int P = part == 0 ? 1 : 24 / part + 1;
    static const float lambda[W] = {400, 550, 700}, ones4[4] = {1, 1, 1, 1};
    static const uint8_t no = 0;
    float theta[T], phi[25];
    float *ones = malloc((size_t)P * T * 4 * sizeof(float)),
          *spectra = malloc((size_t)P * T * W * N * N * sizeof(float));
    EXPECT(ones && spectra);
    for (int i = 0; i < P * T * 4; ++i)
        ones[i] = 1;
    for (int p = 0; p < P; ++p)
        phi[p] = part ? (float)(2 * PI / part * p / (P - 1) - PI) : 0;
    for (int t = 0; t < T; ++t)
        theta[t] = (float)(85.0 / 180 * PI * t / (T - 1));
    for (int p = 0; p < P; ++p)
        for (int t = 0; t < T; ++t)
            for (int j = 0; j < N; ++j)
                for (int i = 0; i < N; ++i) {
                    double u = i / (N - 1.0), theta_m = u * u * PI / 2, phi_m = 2 * PI * j / (N - 1.0) - PI;
                    sr_vec3 wo = direction((double)theta[t] * 180 / PI, (double)phi[p] * 180 / PI);
                    sr_vec3 m = direction(theta_m * 180 / PI, (phi_m + (part ? 0 : (double)phi[p])) * 180 / PI);
                    float c = sr_dot(wo, m);
                    sr_vec3 wi = sr_sub(sr_scale(2 * c, m), wo);
                    sr_spectrum l = {400, 550, 700, 550}, v = SR_BLACK;
                    for (int k = 4; k < SR_LAMBDA_COUNT; ++k)
                        l[k] = 550;
                    if (c > 0 && wi.z > 0)
                        v = f(user, wo, wi, l) * wi.z;
                    for (int k = 0; k < W; ++k)
                        spectra[(((p * T + t) * W + k) * N + j) * N + i] = v[k];
                }
    const struct tensor fields[] = {{"theta_i", 10, 1, theta, {T}},
                                    {"phi_i", 10, 1, phi, {(uint64_t)P}},
                                    {"ndf", 10, 2, ones4, {2, 2}},
                                    {"sigma", 10, 2, ones4, {2, 2}},
                                    {"vndf", 10, 4, ones, {(uint64_t)P, T, 2, 2}},
                                    {"jacobian", 1, 1, &no, {1}},
                                    {is_rgb ? "rgb" : "spectra", 10, 5, spectra, {(uint64_t)P, T, W, N, N}},
                                    {"wavelengths", 10, 1, lambda, {W}}};
    struct bytes b = tensor_file(fields, is_rgb ? 7 : 8);
    free(ones);
    free(spectra);
    return b;
}

/* ---- BSDF XML ---- */

static inline void xml_begin(struct bytes *b, const char *structure)
{
    print(b,
          "<?xml version=\"1.0\"?>\n<WindowElement xmlns=\"http://windows.lbl.gov\"><Optical><Layer><Material><Name>A "
          "sheet</Name></Material>"
          "<DataDefinition><IncidentDataStructure>%s</IncidentDataStructure></DataDefinition>\n",
          structure);
}
static inline void xml_block_begin(struct bytes *b, const char *wavelength, const char *way, const char *basis,
                                   bool is_tree)
{
    print(b,
          "<WavelengthData><Wavelength "
          "unit=\"Integral\">%s</Wavelength><WavelengthDataBlock><WavelengthDataDirection>%s</WavelengthDataDirection>",
          wavelength, way);
    if (is_tree)
        print(b, "<AngleBasis>%s</AngleBasis>", basis);
    else
        print(b, "<ColumnAngleBasis>%s</ColumnAngleBasis><RowAngleBasis>%s</RowAngleBasis>", basis, basis);
    print(b, "<ScatteringData>\n");
}
static inline void xml_block_end(struct bytes *b)
{
    print(b, "</ScatteringData></WavelengthDataBlock></WavelengthData>\n");
}
static inline void xml_end(struct bytes *b)
{
    print(b, "</Layer></Optical></WindowElement>\n");
}

/* ---- text ---- */

/* Goniometer data in Cornell's format: on rings whose steps of phi grow toward the pole, so that they fill no grid. */
static inline struct bytes cornell_file(sr_measured_source f, void *user)
{
    struct bytes b = {0};
    print(&b, "# A formula\n# num wls\n4\n# wls\n400 500 600 700\n# theta i, phi i, theta s, phi_s, values\n");
    for (int i = 0; i < 9; ++i)
        for (int k = 0; k < 10; ++k) {
            int n = 1 + 2 * k;
            for (int l = 0; l < n; ++l) {
                double theta_i = 5 + 9.0 * i, theta_s = 8.5 * k, phi_s = n > 1 ? -180.0 * l / (n - 1) : 0;
                sr_spectrum lambda = {400, 500, 600, 700};
                for (int c = 4; c < SR_LAMBDA_COUNT; ++c)
                    lambda[c] = 700;
                sr_spectrum v = f(user, direction(theta_s, phi_s), direction(theta_i, 0), lambda);
                print(&b, "%f 0.000000 %f %f %f %f %f %f\n", theta_i * PI / 180, theta_s * PI / 180, phi_s * PI / 180,
                      (double)v[0], (double)v[1], (double)v[2], (double)v[3]);
            }
        }
    return b;
}

/* A table over a grid of isotropic data, theta in steps of step degrees. */
static inline struct bytes table_file(sr_measured_source f, void *user, int step, const char *head)
{
    struct bytes b = {0};
    print(&b, "%s", head);
    for (int i = 0; i <= 90 - step; i += step)
        for (int k = 0; k <= 90 - step; k += step)
            for (int l = 0; l <= 180; l += 2 * step)
                print(&b, "%d 0 %d %d %.7g\n", i, k, l,
                      (double)f(user, direction(k, l), direction(i, 0), SR_BLACK + 550)[0]);
    return b;
}

#endif
