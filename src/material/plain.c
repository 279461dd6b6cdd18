/* SPDX-License-Identifier: MIT */
/* The material of any BSDF model, made from its table: each parameter may be a texture.
 *
 * A row of the BSDF's table becomes one of the material's: FLOAT a float texture, ALBEDO and UNBOUNDED spectrum
 * textures, all others stay as they are. What no texture varies is put into a pattern of the model's data once; a hit
 * copies the pattern, asks the textures that are left, and lets the model get ready. */
#include "material/private.h"

#include <pthread.h>
#include <string.h>

enum { MODELS = 96, ROWS = 40 };

union slot { // of a row of the table
    struct bound_float number;
    struct bound_spectrum spectrum;
    int32_t integer;
    bool flag;
    const char *file;
};

struct plain {
    const struct sr_bsdf_model *bsdf;
    union slot slots[ROWS];
    uint8_t varying[ROWS]; // rows that are asked at each hit
    int varying_count;
    _Alignas(64) unsigned char pattern[SR_BSDF_SIZE];
};

static float within(float value, const struct sr_param *row)
{
    return value >= (float)row->min ? sr_min(value, (float)row->max) : (float)row->min; // NaN: the least
}

static sr_spectrum spectrum_within(sr_spectrum s, const struct sr_param *row)
{
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        s[i] = within(s[i], row);
    return s;
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct plain *m = self;
    m->varying_count = 0;
    for (int i = 0; m->bsdf->params[i].name; ++i) {
        const struct sr_param *row = &m->bsdf->params[i];
        union slot *slot = &m->slots[i];
        void *member = m->pattern + row->offset;
        bool is_fixed = true;
        if (row->kind == SR_PARAM_FLOAT) {
            bind_float(&slot->number, (float)row->initial);
            is_fixed = slot->number.is_constant;
            if (is_fixed)
                memcpy(member, &(float){within(slot->number.constant, row)}, sizeof(float));
        } else if (row->kind == SR_PARAM_ALBEDO || row->kind == SR_PARAM_UNBOUNDED) {
            bind_spectrum(&slot->spectrum, sr_spd_constant((float)row->initial));
            is_fixed = slot->spectrum.constant.kind == SR_SPD_CONSTANT;
            sr_spectrum value = spectrum_within(SR_BLACK + slot->spectrum.constant.scale, row);
            if (is_fixed)
                memcpy(member, &value, sizeof value);
        } else if (row->kind == SR_PARAM_BOOL) {
            memcpy(member, &slot->flag, sizeof slot->flag);
        } else if (row->kind == SR_PARAM_FILE) {
            memcpy(member, &slot->file, sizeof slot->file);
        } else {
            memcpy(member, &slot->integer, sizeof slot->integer);
        }
        if (!is_fixed)
            m->varying[m->varying_count++] = (uint8_t)i;
    }
    return m->bsdf->load ? m->bsdf->load(m->pattern, arena, error) : SR_OK;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct plain *m = self;
    memcpy(out->data, m->pattern, m->bsdf->size);
    for (int k = 0; k < m->varying_count; ++k) {
        const struct sr_param *row = &m->bsdf->params[m->varying[k]];
        const union slot *slot = &m->slots[m->varying[k]];
        void *member = out->data + row->offset;
        if (row->kind == SR_PARAM_FLOAT) {
            memcpy(member, &(float){within(eval_float(&slot->number, c), row)}, sizeof(float));
        } else {
            sr_spectrum value = spectrum_within(eval_spectrum(&slot->spectrum, c), row);
            memcpy(member, &value, sizeof value);
        }
    }
    out->model = m->bsdf;
    if (m->bsdf->ready)
        m->bsdf->ready(out->data, &(struct sr_bsdf_at){c->w->lambda, c->seed});
}

static struct sr_material_model models[MODELS];
static struct sr_param tables[MODELS][ROWS + 1];
static int model_count;
static pthread_once_t once = PTHREAD_ONCE_INIT;

static enum sr_param_kind textured(enum sr_param_kind kind)
{
    return kind == SR_PARAM_FLOAT       ? SR_PARAM_FLOAT_TEXTURE
           : kind == SR_PARAM_ALBEDO    ? SR_PARAM_ALBEDO_TEXTURE
           : kind == SR_PARAM_UNBOUNDED ? SR_PARAM_UNBOUNDED_TEXTURE
                                        : kind;
}

static void make_models(void)
{
#define ONE(name) +1
    _Static_assert(0 SR_BSDF_MODELS(ONE) <= MODELS, "more models than the list has room for");
    for (; sr_bsdf_models[model_count]; ++model_count) {
        const struct sr_bsdf_model *b = sr_bsdf_models[model_count];
        struct sr_param *table = tables[model_count];
        for (int i = 0; b->params[i].name && i < ROWS; ++i) {
            table[i] = b->params[i];
            table[i].kind = textured(b->params[i].kind);
            table[i].offset = offsetof(struct plain, slots) + (size_t)i * sizeof(union slot);
        }
        models[model_count] = (struct sr_material_model){
            .name = b->name, .params = table, .size = sizeof(struct plain), .prepare = prepare, .bsdf = bsdf};
    }
}

const struct sr_material_model *sr_material_of_bsdf(const struct sr_bsdf_model *bsdf)
{
    pthread_once(&once, make_models);
    for (int i = 0; i < model_count; ++i)
        if (sr_bsdf_models[i] == bsdf)
            return &models[i];
    return NULL;
}

sr_status sr_material_prepare(const struct sr_material_model *model, void *self, struct sr_arena *arena,
                              struct sr_error *error)
{
    if (model->prepare == prepare)
        ((struct plain *)self)->bsdf = sr_bsdf_models[model - models];
    return model->prepare ? model->prepare(self, arena, error) : SR_OK;
}
