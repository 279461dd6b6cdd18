/* SPDX-License-Identifier: MIT */
/* Placeholder. */
#include "lab/private.h"
void lab_check_double(struct certifying *c)
{
    lab_skip(c, CHECK_DOUBLE, "there is no twin of this model in double precision");
}
