/* SPDX-License-Identifier: MIT */
/* MakeNamedMedium: each medium is made once, when the first surface, light or camera asks for its name. */
#include "import/pbrt/build.h"

#include <string.h>

static sr_status check_preset(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e)
{
    const char *preset = NULL;
    sr_status status = sr_pbrt_get_string(b->d, &e->params, "preset", &preset, b->error);
    if (status != SR_OK || !preset || !preset[0])
        return status;
    struct sr_pbrt_suggestion s = {.word = preset};
    char buffer[160];
    for (int i = 0; sr_medium_preset_name(i); ++i) {
        if (strcmp(sr_medium_preset_name(i), preset) == 0)
            return SR_OK;
        sr_pbrt_suggest(&s, sr_medium_preset_name(i));
    }
    struct sr_location where = sr_pbrt_find(&e->params, "preset")->where;
    return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT, "there is no preset of a medium named \"%s\"%s", preset,
                        sr_pbrt_suggestion_text(&s, buffer));
}

/* What the numbers of "Le" mean, where that may surprise; those of other spectra are no emission. */
static void tell_emission(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e)
{
    struct sr_pbrt_param *Le = sr_pbrt_find(&e->params, "Le");
    if (!Le)
        return;
    struct sr_pbrt_entity only = *e;
    only.params = (struct sr_pbrt_params){Le, 1};
    sr_pbrt_tell_normalisation(b, &only);
}

static sr_status make(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_medium *out)
{
    const struct sr_medium_model *m = sr_medium_model_find(e->model);
    if (!m) {
        const char *names[16];
        size_t n = 0;
        for (; sr_medium_models[n] && n < 16; ++n)
            names[n] = sr_medium_models[n]->name;
        return sr_pbrt_unsupported(b, e, names, n);
    }
    struct sr_medium_common *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    sr_status status = sr_pbrt_bind(b, m->params, e, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, self);
    if (status == SR_OK)
        status = check_preset(b, e);
    if (status != SR_OK)
        return status;
    self->medium_to_world = sr_pbrt_transform_of(b, e->transform, SR_PBRT_TO_WORLD);
    self->space = e->space;
    self->is_absolute = b->result->units == SR_UNITS_SI;
    struct sr_error inner = {0};
    if (m->prepare(self, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    tell_emission(b, e);
    sr_pbrt_warn_unused(b, e, m->params, NULL);
    *out = (struct sr_medium){m, self};
    return SR_OK;
}

sr_status sr_pbrt_medium(struct sr_pbrt_build *b, const char *name, struct sr_location where, struct sr_medium *out)
{
    *out = (struct sr_medium){0};
    if (!name || !name[0])
        return SR_OK;
    uint32_t index1 = sr_pbrt_names_find(&b->d->medium_names, name);
    if (!index1) {
        struct sr_pbrt_suggestion s = {.word = name};
        char buffer[160];
        sr_pbrt_names_suggest(&b->d->medium_names, &s);
        return sr_pbrt_fail(b->d, where, b->error, SR_ERROR_INPUT, "there is no medium named \"%s\"%s", name,
                            sr_pbrt_suggestion_text(&s, buffer));
    }
    struct sr_medium *made = &b->media[index1 - 1];
    if (!made->model) {
        sr_status status = make(b, SR_PBRT_AT(b->d->media, struct sr_pbrt_entity, index1 - 1), made);
        if (status != SR_OK)
            return status;
    }
    *out = *made;
    return SR_OK;
}
