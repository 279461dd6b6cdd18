/* SPDX-License-Identifier: MIT */
/* Directives and parameters as text that reads back to the same numbers. */
#ifndef SR_IMPORT_PBRT_PRINT_H
#define SR_IMPORT_PBRT_PRINT_H

#include "import/pbrt/description.h"

/* A text that grows. A lack of memory sticks. */
struct sr_print {
    char *text; // ended by NUL; free with sr_free
    size_t size, capacity;
    bool has_failed;
    int depth;          // of indentation, four blanks each
    const char *prefix; // of each line, behind the indentation; NULL: none
};

void sr_print_bytes(struct sr_print *out, const char *bytes, size_t count);
void sr_print_word(struct sr_print *out, const char *word);
void sr_print_line(struct sr_print *out, int more_depth); // begins a line: indentation and prefix
void sr_print_quoted(struct sr_print *out, const char *text);
/* The fewest digits that our reader and strtof take back to the same float; of doubles the same. */
void sr_print_float(struct sr_print *out, float value);
void sr_print_double(struct sr_print *out, double value);
double sr_print_few_digits(float value); // of the decimal that is written for it
/* The parameters behind what stands on the line already: there if they fit, else each on a line of its own. Ends the
 * line. */
void sr_print_params(struct sr_print *out, const struct sr_pbrt_params *params);

/* A triangle mesh as a PLY file. */
struct sr_print_mesh {
    const float *P, *N, *uv; // 3, 3, 2 for each vertex; N, uv may be NULL
    const int32_t *indices;  // 3 for each triangle
    const int32_t *faces;    // a number for each triangle, or NULL
    uint32_t vertex_count, triangle_count;
};
/* Whether a shape is a mesh that a PLY file can hold, of more than that many vertices. */
bool sr_print_is_mesh(const char *model, const struct sr_pbrt_params *params, uint32_t more_than,
                      struct sr_print_mesh *mesh);
/* Writes it, and makes a shape "plymesh" of it, whose words d holds. The scene lies in the file's folder. */
sr_status sr_print_mesh_apart(struct sr_pbrt_description *d, const char *path, const struct sr_print_mesh *mesh,
                              const char **model, struct sr_pbrt_params *params, struct sr_error *error);

#endif
