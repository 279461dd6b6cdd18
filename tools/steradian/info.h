/* SPDX-License-Identifier: MIT */
/* What the parts of steradian info share. */
#ifndef SR_TOOLS_INFO_H
#define SR_TOOLS_INFO_H

#include "command.h"

struct info_arguments {
    const char *path;
    const char *plot;    // NULL, or where a luminaire's figure goes
    const char *outfile; // NULL, or where it is written again, .ies or .ldt
    bool json, quiet;
};

/* Reads a scene and tells what it contains; the exit code. */
int info_scene(const struct info_arguments *arguments);
/* The same for a luminaire, IES or EULUMDAT. */
int info_luminaire(const struct info_arguments *arguments);
/* The same for a checkpoint or a part of a picture. */
int info_store(const struct info_arguments *arguments);

#endif
