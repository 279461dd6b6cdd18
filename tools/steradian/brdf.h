/* SPDX-License-Identifier: MIT */
/* What the parts of steradian brdf share: their list, specimens from arguments, directions and wavelengths. */
#ifndef SR_TOOLS_BRDF_H
#define SR_TOOLS_BRDF_H

#include "command.h"

#include "lab/lab.h"

/* One file each; a new one is its line in the list of brdf.c. Named "brdf eval" in messages. */
extern const struct command brdf_list, brdf_show, brdf_info, brdf_eval, brdf_reflectance, brdf_check, brdf_fit,
    brdf_convert, brdf_plot, brdf_measure;

/* The specimen of the words that are left after the options; the exit code of a mistake that has been told, or 0. */
int brdf_read_specimen(const struct command *command, int argc, char **argv, struct sr_arena *arena,
                       struct sr_specimen *specimen);
/* "THETA[,PHI]" [deg] as a local direction. From below the surface where theta is above 90. */
bool brdf_parse_direction(const struct command *command, const char *option, const char *text, double angles[2],
                          double direction[3]);
static inline sr_vec3 brdf_vec3(const double d[3])
{
    return (sr_vec3){(float)d[0], (float)d[1], (float)d[2]};
}
/* SR_LAMBDA_COUNT as text. */
#define BRDF_TEXT_OF(x) #x
#define BRDF_TEXT(x) BRDF_TEXT_OF(x)
#define BRDF_MOST_LAMBDAS BRDF_TEXT(SR_LAMBDA_COUNT)
/* Wavelengths [nm] to ask for: --lambda of one or more numbers "550" or "400,500,600"; at most SR_LAMBDA_COUNT. */
struct brdf_lambda {
    sr_spectrum lambda; // [nm] the last one repeated in what is left
    int count;
};
bool brdf_parse_lambda(const struct command *command, const char *text, struct brdf_lambda *out);
struct brdf_lambda brdf_default_lambda(void); // 550 nm
/* Whether light of different wavelengths differs here: else one column is enough. */
const char *brdf_lobe_words(uint32_t lobes, char text[128]); // "reflection, glossy"

#endif
