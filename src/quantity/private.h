/* SPDX-License-Identifier: MIT */
/* The tables of numbers behind this room, written by scripts/make-spectrum-data. Only this room includes them. */
#ifndef SR_QUANTITY_PRIVATE_H
#define SR_QUANTITY_PRIVATE_H

#include "quantity/quantity.h"

enum { EFFICIENCY_COUNT = 471 }; // 360 … 830 nm by 1 nm

extern const double sr_data_efficacy[4];                        // [lm/W] photopic, scotopic, V_F of 2 and of 10 degrees
extern const float sr_data_efficiency[EFFICIENCY_COUNT + 1][4]; // [1]

#endif
