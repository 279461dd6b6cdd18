/* SPDX-License-Identifier: MIT */
/* The machine: statuses and messages, memory, threads, files, the clock, and the tables that describe parameters. */
#ifndef SR_BASE_BASE_H
#define SR_BASE_BASE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <steradian/base.h>

#if defined(__GNUC__)
#define SR_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define SR_PRINTF(text, first)
#endif
#define SR_INLINE static inline __attribute__((always_inline)) // what runs several times a bounce
#define SR_LIKELY(x) __builtin_expect(!!(x), 1)
#define SR_UNLIKELY(x) __builtin_expect(!!(x), 0)

/* ---- statuses: an operating error is a status and one sentence ---- */

/* The first mistake sticks: later calls of sr_fail leave it as it is. Always valid when zeroed. */
struct sr_error {
    sr_status status;
    char text[1024]; // one sentence: what, where (file:line:column), what was expected
};

SR_PRINTF(3, 4) sr_status sr_fail(struct sr_error *error, sr_status status, const char *format, ...);

/* Messages that are no errors go to whoever asked for them; the library itself never prints. A NULL log is silence. */
enum sr_severity { SR_INFO, SR_WARNING };
struct sr_log {
    void (*write)(void *user, enum sr_severity severity, const char *text);
    void *user;
    unsigned warning_count;
};
SR_PRINTF(3, 4) void sr_log(struct sr_log *log, enum sr_severity severity, const char *format, ...);

/* Where something stands in a text file; lines and columns count from 1. */
struct sr_location {
    const char *file;
    int line, column;
};

/* ---- memory: malloc is called in memory.c and nowhere else ---- */

void *sr_alloc(size_t size); // 64-byte aligned, zeroed; NULL when there is no memory (or size is absurd)
void *sr_realloc(void *p, size_t old_size,
                 size_t new_size); // the same; grown bytes are zeroed; on failure p stays valid
void sr_free(void *p);
uint64_t sr_alloc_count(void); // how often sr_alloc and sr_realloc have been called by this process
/* For tests: what has not been freed; and of the allocations to come, `count` fail after the next `after` of them. */
uint64_t sr_alloc_live(void);
void sr_alloc_fail(uint64_t after, uint64_t count);
bool sr_alloc_allowed(void); // counts one that a library makes by itself; false: it is to fail

/* A place for things that are freed together. Zeroed = empty and valid. */
struct sr_arena {
    struct sr_arena_block *blocks;
    size_t used;  // [B] in the newest block
    size_t total; // [B] handed out
};
void *sr_arena_alloc(struct sr_arena *arena, size_t size); // 64-byte aligned, zeroed; NULL when there is no memory
void *sr_arena_copy(struct sr_arena *arena, const void *data, size_t size);
char *sr_arena_string(struct sr_arena *arena, const char *text); // a copy
SR_PRINTF(2, 3) char *sr_arena_printf(struct sr_arena *arena, const char *format, ...);
/* Everything of `from` belongs to `to` from now on; `from` is empty. For things that threads have made apart. */
void sr_arena_adopt(struct sr_arena *to, struct sr_arena *from);
void sr_arena_free(struct sr_arena *arena);

/* A run of values that somebody else owns. */
struct sr_slice {
    const void *data;
    uint32_t count;
};

/* A growing array. Use: struct sr_array a = {0}; T *t = sr_array_push(&a, sizeof(T)); ((T *)a.data)[i] */
struct sr_array {
    void *data;
    size_t count, capacity; // in elements
};
void *sr_array_push(struct sr_array *array, size_t element_size); // a new zeroed element at the end; NULL: no memory
bool sr_array_reserve(struct sr_array *array, size_t count, size_t element_size);
void sr_array_free(struct sr_array *array);

/* ---- files ---- */

/* Reads a whole file, unpacking gzip by its magic bytes; "-" is standard input. The bytes are followed by one NUL that
 * is not counted. Refuses directories, and gzip that unpacks to more than max_size. Free *data with sr_free. */
sr_status sr_file_read(const char *path, size_t max_size, char **data, size_t *size, struct sr_error *error);

/* Unpacks zlib's format into exactly out_size bytes; false: it is damaged, or of another size. */
bool sr_inflate(const void *data, size_t size, void *out, size_t out_size);

/* Writes beside the final name and renames, so that a half-written file never bears it. */
sr_status sr_file_write(const char *path, const void *data, size_t size, struct sr_error *error);
bool sr_file_exists(const char *path);
/* `name` as seen from the folder of the file `from` (absolute names stay as they are). */
char *sr_path_beside(struct sr_arena *arena, const char *from, const char *name);
/* Lower-case comparison of the end of a file name, such as ".exr". */
bool sr_path_has_ending(const char *path, const char *ending);

/* ---- threads: POSIX ---- */

int sr_thread_count(void); // processors that this process may use
/* Calls work(context, t) for t = 0 … threads-1 at the same time and waits for all. Denormals are flushed in each. */
void sr_parallel(int threads, void (*work)(void *context, int thread), void *context);
/* Calls work(context, i) for i = 0 … count-1, in any order, on that many threads. */
void sr_parallel_for(int threads, uint64_t count, void (*work)(void *context, uint64_t i), void *context);

/* ---- clock ---- */

double sr_clock_s(void);         // monotonic [s]
double sr_cpu_s(void);           // of the processors, taken by all threads of this process so far [s]
uint64_t sr_peak_memory_B(void); // largest resident set of this process so far [B]

/* ---- parameters: what a model has, standing once, read by importer, laboratory, docs and tests ---- */

enum sr_param_kind {
    SR_PARAM_BOOL,              // bool
    SR_PARAM_INT,               // int32_t
    SR_PARAM_FLOAT,             // float
    SR_PARAM_ENUM,              // int32_t: index into choices "a|b|c"; default = index
    SR_PARAM_STRING,            // const char *
    SR_PARAM_FILE,              // const char *: resolved against the scene file's folder
    SR_PARAM_POINT2,            // sr_vec2
    SR_PARAM_POINT3,            // sr_vec3
    SR_PARAM_VECTOR3,           // sr_vec3
    SR_PARAM_NORMAL3,           // sr_vec3
    SR_PARAM_ALBEDO,            // struct sr_spd, a reflectance or transmittance in 0 … 1 per wavelength
    SR_PARAM_UNBOUNDED,         // struct sr_spd, any positive quantity (eta, k)
    SR_PARAM_ILLUMINANT,        // struct sr_spd, an emission
    SR_PARAM_FLOAT_TEXTURE,     // struct sr_texture
    SR_PARAM_ALBEDO_TEXTURE,    // struct sr_texture
    SR_PARAM_UNBOUNDED_TEXTURE, // struct sr_texture
    SR_PARAM_MATERIALS,         // struct sr_slice of const struct sr_material *
    SR_PARAM_INTS,              // struct sr_slice of int32_t
    SR_PARAM_FLOATS,            // struct sr_slice of float
    SR_PARAM_POINT2S,           // struct sr_slice of sr_vec2
    SR_PARAM_POINT3S,           // struct sr_slice of sr_vec3 (12 bytes each)
    SR_PARAM_VECTOR3S,          // struct sr_slice of sr_vec3
    SR_PARAM_NORMAL3S,          // struct sr_slice of sr_vec3
    SR_PARAM_RGBS,              // struct sr_slice of struct sr_rgb; valid until the model has been prepared
};

/* One parameter. Where the file gives none, the value is `initial`; NaN means "none": a texture then has a NULL model,
 * a spectrum kind SR_SPD_NONE, a float stays NaN, a slice is empty. Tables end with a row whose name is NULL. */
struct sr_param {
    enum sr_param_kind kind;
    const char *name; // the word of the scene file
    const char *unit; // "1", "m", "deg", "nm", "sr^-1", …
    double min, max;  // a value outside is an error of the scene
    double initial;
    size_t offset;    // of the member in the model's struct
    const char *text; // one line for the manual; for ENUM: the choices "a|b|c"; for STRING: the default
};

#endif
