/* SPDX-License-Identifier: MIT */
/* Two textures multiplied, wavelength by wavelength:  value = tex1 tex2.  (Numbers have "scale".) */
#include "texture/private.h"

struct product {
    struct sr_texture tex1, tex2;
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "tex1", "1", 0, INFINITY, 1, offsetof(struct product, tex1), "one factor"},
    {SR_PARAM_ALBEDO_TEXTURE, "tex2", "1", 0, INFINITY, 1, offsetof(struct product, tex2), "the other"},
    {0},
};

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct product *t = self;
    return sr_texture_spectrum(t->tex1, x, w) * sr_texture_spectrum(t->tex2, x, w);
}

const struct sr_texture_model sr_texture_product = {
    .name = "product",
    .params = params,
    .size = sizeof(struct product),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_spectrum = eval_spectrum,
};
