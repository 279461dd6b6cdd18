/* SPDX-License-Identifier: MIT */
/* What the readers share: the bytes, the channels, the interpolants, the table for drawing directions. */
#ifndef SR_MEASURED_PRIVATE_H
#define SR_MEASURED_PRIVATE_H

#include "measured/measured.h"

#include <string.h>

#define PI 3.14159265358979323846

/* ---- the file ---- */

struct source {
    const char *name; // for messages
    const char *data;
    size_t size;
    struct sr_measured_options options;
    struct sr_arena *arena;
    struct sr_error *error;
};

/* ---- values over wavelengths ---- */

enum channel_kind { CHANNEL_GREY, CHANNEL_RGB, CHANNEL_SPECTRAL };

struct channels {
    enum channel_kind kind;
    int count;
    size_t stride;       // from one channel to the next, in floats
    const float *lambda; // [nm] increasing; SPECTRAL only
    float first, step;   // [nm] of even ones; step 0: they are not
    float log_offset;    // values are log(f + offset); 0: they are f
};
enum { MAX_CORNERS = 16, MAX_CHANNELS = 4096 };

/* A weighted sum of places in an array of floats. */
struct corners {
    int count;
    size_t base[MAX_CORNERS];
    float weight[MAX_CORNERS];
};
bool channels_set_lambda(struct channels *c, const float *lambda, int count); // false: not increasing or not positive
sr_spectrum channels_eval(const struct channels *c, const float *values, const struct corners *at, sr_spectrum lambda);
sr_spectrum uplift_at(float r, float g, float b, sr_spectrum lambda);

/* Where x lies on an increasing axis: the lower neighbour and the share of the upper one; clamped. */
static inline int axis_find(const float *axis, int count, float x, float *t)
{
    int lo = 0, hi = count - 1;
    *t = 0;
    if (!(x > axis[0]))
        return 0;
    if (x >= axis[hi]) {
        *t = hi > 0 ? 1 : 0;
        return hi > 0 ? hi - 1 : 0;
    }
    while (hi - lo > 1) {
        int mid = (lo + hi) / 2;
        if (axis[mid] <= x)
            lo = mid;
        else
            hi = mid;
    }
    *t = (x - axis[lo]) / (axis[hi] - axis[lo]);
    return lo;
}

/* ---- a table for drawing directions: guide.c ---- */

struct guide {
    int faces, thetas, phis; // slices: of wo's side, polar angle and azimuth
    int nu, nv;              // cells of a slice: polar angle and azimuth of the half vector, for each side
    uint32_t sides;
    float theta_step, phi_step; // [rad] between slices
    float *omega;               // [sr] of a cell of each row u
    struct sr_piecewise2 *slices;
};

/* ---- the common object ---- */

struct sr_measured {
    enum sr_measured_format format;
    const char *description, *note;
    const void *data; // the format's own
    /* f of the format's numbers; wi.z > 0 where has_back is false */
    sr_spectrum (*f)(const void *data, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda);
    /* share of the light from wi that leaves on that side, where it is a sum over patches; NULL: by quadrature of f */
    sr_spectrum (*albedo)(const void *data, sr_vec3 wi, uint32_t side, sr_spectrum lambda);
    /* density [1/sr] and draw of wi, where the data tell them better than guide; wo.z > 0 where has_back is false */
    float (*pdf)(const void *data, sr_vec3 wo, sr_vec3 wi);
    bool (*sample)(const void *data, sr_vec3 wo, float u_lobe, sr_vec2 u, sr_vec3 *wi);
    struct channels channels;
    int32_t quantity; // enum sr_measured_quantity, never AUTO
    uint32_t sides, back_sides;
    bool has_back; // light from behind meets data of its own
    bool is_isotropic;
    uint64_t values, invalid;
    float theta_i[2], theta_o[2]; // [rad] coverage
    double coverage;              // [1]
    struct guide guide;
};
sr_status guide_build(struct sr_measured *m, struct sr_arena *arena);
/* sr_measured_parse without the guide: what can go wrong with a file goes wrong here. */
sr_status measured_load(const char *name, const void *data, size_t size, const struct sr_measured_options *options,
                        struct sr_arena *arena, struct sr_measured **out, struct sr_error *error);

/* One function a format: fills in all of *m but guide; the format has been recognised already. */
sr_status read_merl(const struct source *s, struct sr_measured *m);
sr_status read_tensor_file(const struct source *s, struct sr_measured *m); // chooses among the two below
sr_status read_xml(const struct source *s, struct sr_measured *m);         // chooses Klems or tree
sr_status read_cornell(const struct source *s, struct sr_measured *m);
sr_status read_astm(const struct source *s, struct sr_measured *m);
sr_status read_abg(const struct source *s, struct sr_measured *m);
sr_status read_table(const struct source *s, struct sr_measured *m);

/* ---- tensor files: tensor.c ---- */

enum tensor_type { TENSOR_U8 = 1, TENSOR_U16 = 3, TENSOR_F32 = 10 };
struct tensor_field {
    char name[64];
    int dimensions;
    uint8_t type;
    uint64_t shape[8];
    uint64_t count;   // of elements
    const char *data; // inside the file
};
struct tensor_file {
    const struct source *source;
    int count;
    struct tensor_field fields[64];
};
/* NULL and an error where the field is missing or is not of that type and number of dimensions (0: any). */
const struct tensor_field *tensor_need(const struct tensor_file *t, const char *name, enum tensor_type type,
                                       int dimensions);
const struct tensor_field *tensor_find(const struct tensor_file *t, const char *name);
/* A copy as floats; NULL and an error where a value is not finite, if that matters, or below least. */
float *tensor_floats(const struct tensor_file *t, const struct tensor_field *f, float least);
sr_status read_rgl(const struct tensor_file *t, struct sr_measured *m);
sr_status read_polarised(const struct tensor_file *t, struct sr_measured *m);

/* ---- XML: xml.c ---- */

enum xml_direction { XML_TRANSMISSION_FRONT, XML_TRANSMISSION_BACK, XML_REFLECTION_FRONT, XML_REFLECTION_BACK };
enum { XML_COMPONENTS = 5, XML_BASES = 8, XML_RINGS = 64 }; // Y, X, Z, u, v
struct xml_basis {
    char name[64];
    int rings, total;
    float upper[XML_RINGS]; // [rad] upper edge of each ring
    int phis[XML_RINGS], first[XML_RINGS];
};
struct xml_block {
    char *text; // of ScatteringData, ended by a NUL
    size_t size;
    int line; // where it begins
    char column[64], row[64], basis[64];
};
struct xml_file {
    const struct source *source;
    char structure[32]; // IncidentDataStructure
    char title[200];
    char wavelength[64]; // which one is Y
    int basis_count;
    struct xml_basis bases[XML_BASES];
    struct xml_block blocks[4][XML_COMPONENTS];
};
sr_status read_klems(const struct xml_file *x, struct sr_measured *m);
sr_status read_tree(const struct xml_file *x, int rank, struct sr_measured *m);
/* Which of the components make colour: 1 Y only, 3 XYZ or Yuv, for all directions that are there. */
int xml_components(const struct xml_file *x, int kind[3]);

/* ---- rows of single measurements: rows.c chooses a grid or a cloud ---- */

struct rows {
    size_t count;
    float *angles; // 4 each [rad]: theta_i, phi_i, theta_o, phi_o
    float *values; // channels.count each
    struct channels channels;
};
sr_status rows_finish(const struct source *s, struct rows *rows, struct sr_measured *m);
bool grid_build(const struct source *s, const struct rows *rows, struct sr_measured *m, bool *no_memory);
sr_status cloud_build(const struct source *s, const struct rows *rows, struct sr_measured *m);

/* ---- numbers and words of text, whatever the locale: scan.c ---- */

struct scan {
    const char *at, *end, *line_start;
    int line;
};
struct scan scan_start(const char *data, size_t size);
bool scan_number(struct scan *s, double *value); // of the form -1.5e-3; s stays where it is if there is none
/* The next line without its end; false: no more. */
bool scan_line(struct scan *s, const char **begin, const char **end);
void scan_separators(struct scan *s);                    // blanks, tabs, commas, semicolons
bool scan_word(struct scan *s, char *word, size_t size); // letters, digits and _ ; cut to size
bool text_equal(const char *a, const char *b);           // whatever the case
bool text_has_prefix(const char *at, const char *end, const char *prefix);
SR_PRINTF(3, 4) sr_status fail_at(const struct source *s, int line, const char *format, ...);

/* ---- half and difference angles (Rusinkiewicz 1998): merl.c and polarised.c ---- */

struct half_difference {
    float theta_h, theta_d, phi_d; // [rad] phi_d in -pi … pi
};
struct half_difference half_difference_of(sr_vec3 wo, sr_vec3 wi);
void half_difference_directions(double theta_h, double theta_d, double phi_d, sr_vec3 *wo, sr_vec3 *wi);

/* ---- colour: the linear sRGB of f, by which all that are not spectral are written ---- */

enum { RGB_BANDS = 5 }; // times SR_LAMBDA_COUNT wavelengths
struct rgb_weights {
    sr_spectrum lambda[RGB_BANDS], r[RGB_BANDS], g[RGB_BANDS], b[RGB_BANDS];
};
struct rgb_weights rgb_weights_make(void);
struct sr_rgb rgb_of(const struct rgb_weights *w, sr_measured_source f, void *user, sr_vec3 wo, sr_vec3 wi);
struct sr_rgb rgb_of_xyz(float x, float y, float z);

#endif
