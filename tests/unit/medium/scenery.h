/* SPDX-License-Identifier: MIT */
/* What the tests of media share: filling a medium by its table. */
#ifndef TEST_MEDIUM_SCENERY_H
#define TEST_MEDIUM_SCENERY_H

#include "medium/medium.h"
#include "test.h"

struct sr_arena *scenery_arena(void);
/* A medium's self with every parameter at its default, untransformed. */
void *scenery_medium(const struct sr_medium_model *model);
void *scenery_member(const struct sr_medium_model *model, void *self, const char *name); // of that parameter
struct sr_medium scenery_prepare(const struct sr_medium_model *model, void *self);
/* Of a prepare that must fail: the message. */
const char *scenery_refusal(const struct sr_medium_model *model, void *self);
static inline struct sr_wavelengths scenery_wavelengths(void)
{
    return sr_wavelengths_sample((struct sr_lambda_range){380, 720}, 0.4f);
}

#endif
