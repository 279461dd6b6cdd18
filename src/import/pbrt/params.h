/* SPDX-License-Identifier: MIT */
/* Parameter lists: "type name" value, "type name" [ values ], … */
#ifndef SR_IMPORT_PBRT_PARAMS_H
#define SR_IMPORT_PBRT_PARAMS_H

#include "import/pbrt/description.h"
#include "import/pbrt/lexer.h"

/* Room for values whose number is not known yet; kept from one list to the next. */
struct sr_pbrt_scratch {
    struct sr_array floats, ints, strings, params;
};
void sr_pbrt_scratch_free(struct sr_pbrt_scratch *s);

/* Reads the list up to the next directive. defaults (of Attribute) come behind the entity's own. */
sr_status sr_pbrt_params_read(struct sr_pbrt_description *d, struct sr_pbrt_lexer *lexer,
                              struct sr_pbrt_scratch *scratch, enum sr_colour_space_id space,
                              struct sr_pbrt_params defaults, struct sr_pbrt_params *out, struct sr_error *error);
/* The one of Option: as above, or a name without a type (pbrt's way), where the value tells the type. */
sr_status sr_pbrt_option_read(struct sr_pbrt_description *d, struct sr_pbrt_lexer *lexer,
                              struct sr_pbrt_scratch *scratch, struct sr_pbrt_params *out, struct sr_error *error);

#endif
