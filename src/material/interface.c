/* SPDX-License-Identifier: MIT */
/* No matter at all: the boundary of a medium. Light passes as if nothing were there. */
#include "material/private.h"

struct interface {
    char unused; // a struct cannot be empty
};

static const struct sr_param params[] = {
    {0},
};

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    (void)self, (void)c;
    out->model = NULL;
}

const struct sr_material_model sr_material_interface = {
    .name = "interface",
    .params = params,
    .size = sizeof(struct interface),
    .bsdf = bsdf,
};
