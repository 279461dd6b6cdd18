/* SPDX-License-Identifier: MIT */
/* What the readers and writers of luminaire files share. */
#ifndef SR_MEASURED_PHOTOMETRY_PRIVATE_H
#define SR_MEASURED_PHOTOMETRY_PRIVATE_H

#include "measured/private.h"

enum { PHOTOMETRY_WORDS = 256, PHOTOMETRY_NOTE = 600 };

/* A luminaire while it is read. */
struct photometry_draft {
    struct sr_photometry p;
    struct sr_photometry_word words[PHOTOMETRY_WORDS];
    char note[PHOTOMETRY_NOTE];
};

sr_status read_ies(const struct source *s, struct photometry_draft *d);
sr_status read_ldt(const struct source *s, struct photometry_draft *d);
sr_status print_ies(const struct sr_photometry *p, struct sr_array *text);
sr_status print_ldt(const struct sr_photometry *p, struct sr_array *text);

SR_PRINTF(2, 3) void photometry_note(struct photometry_draft *d, const char *format, ...);
/* A word without blanks at its ends and without control characters; false: no memory. More than fit are left out. */
bool photometry_add_word(const struct source *s, struct photometry_draft *d, const char *key, const char *begin,
                         const char *end);
/* Angles strictly increasing and finite, candelas finite and not negative, planes as the symmetry has them. */
sr_status photometry_check(const struct sr_photometry *p, const char *name, struct sr_error *error);

/* false: no memory */
SR_PRINTF(2, 3) bool text_put(struct sr_array *text, const char *format, ...);
bool text_number(struct sr_array *text, double value, const char *after);

#endif
