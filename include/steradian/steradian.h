/* SPDX-License-Identifier: MIT */
/* Steradian: light, computed and measured. All public headers at once. */
#ifndef STERADIAN_STERADIAN_H
#define STERADIAN_STERADIAN_H

#include "base.h"
#include "bsdf.h"
#include "picture.h"
#include "quantity.h"
#include "world.h"

#endif
