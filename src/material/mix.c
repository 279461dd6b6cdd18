/* SPDX-License-Identifier: MIT */
/* One of two materials at each hit: the second with probability `amount`, so that the mean is the mixture.
 *
 * What the choice leaves of the uniform number is again uniform: u / amount, or (u - amount) / (1 - amount). */
#include "material/private.h"

struct mix {
    struct sr_slice materials; // of const struct sr_material *
    struct bound_float amount; // [1]
};

static const struct sr_param params[] = {
    {SR_PARAM_MATERIALS, "materials", "1", 0, 0, NAN, offsetof(struct mix, materials), "names of the two materials"},
    {SR_PARAM_FLOAT_TEXTURE, "amount", "1", -INFINITY, INFINITY, 0.5, offsetof(struct mix, amount.texture),
     "share of the second"},
    {0},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct mix *m = self;
    if (m->materials.count != 2)
        return sr_fail(error, SR_ERROR_INPUT, "a mix is of two materials, not of %u", (unsigned)m->materials.count);
    bind_float(&m->amount, 0.5f);
    return SR_OK;
}

static const struct sr_material *choose(const void *self, struct sr_material_context *c)
{
    const struct mix *m = self;
    const struct sr_material *const *materials = m->materials.data;
    float amount = eval_float(&m->amount, c);
    if (!(amount > 0))
        return materials[0];
    if (amount >= 1)
        return materials[1];
    bool second = c->u < amount;
    float u = second ? c->u / amount : (c->u - amount) / (1 - amount);
    c->u = u < SR_ONE_MINUS_EPSILON ? u : SR_ONE_MINUS_EPSILON;
    return materials[second];
}

const struct sr_material_model sr_material_mix = {
    .name = "mix",
    .params = params,
    .size = sizeof(struct mix),
    .prepare = prepare,
    .choose = choose,
};
