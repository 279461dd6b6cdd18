/* SPDX-License-Identifier: MIT */
/* What scene files may name: every directive, option and plugin, with the tables by which its parameters are read. */
#include "import/pbrt/build.h"
#include "import/pbrt/parser.h"

const struct sr_param sr_pbrt_option_params[] = {
    {SR_PARAM_BOOL, "disablepixeljitter", "1", 0, 1, 0, 0, "samples go through the middles of the pixels"},
    {SR_PARAM_BOOL, "disabletexturefiltering", "1", 0, 1, 0, 0, "textures are looked up at points"},
    {SR_PARAM_BOOL, "disablewavelengthjitter", "1", 0, 1, 0, 0, "all samples have the same wavelengths"},
    {SR_PARAM_FLOAT, "displacementedgescale", "1", 0, INFINITY, 1, 0, "factor of \"edgelength\" of displaced meshes"},
    {SR_PARAM_BOOL, "forcediffuse", "1", 0, 1, 0, 0, "all materials become diffuse"},
    {SR_PARAM_STRING, "msereferenceimage", "1", 0, 0, NAN, 0, "picture to compare with; read, unused"},
    {SR_PARAM_STRING, "msereferenceout", "1", 0, 0, NAN, 0, "where the comparison is written; read, unused"},
    {SR_PARAM_BOOL, "pixelstats", "1", 0, 1, 0, 0, "statistics of each pixel; read, unused"},
    {SR_PARAM_ENUM, "rendercoordsys", "1", 0, 2, 1, 0, "camera|cameraworld|world"},
    {SR_PARAM_INT, "seed", "1", INT32_MIN, INT32_MAX, 0, 0, "of the random numbers, where the sampler has none"},
    {SR_PARAM_ENUM, "units", "1", 0, 1, 0, 0, "photometric|si"},
    {SR_PARAM_BOOL, "wavefront", "1", 0, 1, 0, 0, "how pbrt goes about it; read, unused"},
    {.name = NULL},
};

typedef void visitor(void *context, const struct sr_import_plugin *plugin);

static void tell(visitor *visit, void *context, const char *kind, const char *name, const struct sr_param *params)
{
    visit(context, &(struct sr_import_plugin){kind, name, params});
}

static void tell_words(visitor *visit, void *context)
{
    for (const struct sr_pbrt_directive *d = sr_pbrt_directives; d->word; ++d)
        tell(visit, context, "directive", d->word, NULL);
    for (const struct sr_pbrt_directive *d = sr_pbrt_annotations; d->word; ++d)
        tell(visit, context, "annotation", d->word, NULL);
    tell(visit, context, "Option", "", sr_pbrt_option_params);
    tell(visit, context, "Uncertainty", "", sr_pbrt_uncertainty_params);
}

static void tell_settings(visitor *visit, void *context)
{
    for (int i = 0; sr_sensor_models[i]; ++i)
        tell(visit, context, "Camera", sr_sensor_models[i]->name, sr_sensor_models[i]->params);
    tell(visit, context, "Film", "", sr_pbrt_film_params);
    tell(visit, context, "Film", "rgb", NULL);
    tell(visit, context, "Film", "gbuffer", sr_pbrt_gbuffer_params);
    tell(visit, context, "Film", "spectral", sr_pbrt_spectral_params);
    for (int i = 0; sr_filter_models[i]; ++i)
        tell(visit, context, "PixelFilter", sr_filter_models[i]->name, sr_filter_models[i]->params);
    tell(visit, context, "Sampler", "", sr_pbrt_sampler_params);
    for (int i = 0; sr_integrator_models[i]; ++i)
        tell(visit, context, "Integrator", sr_integrator_models[i]->name, sr_integrator_models[i]->params);
}

static void tell_textures(visitor *visit, void *context, const char *kind, bool is_float, bool is_spectrum)
{
    for (int i = 0; sr_texture_models[i]; ++i)
        if (sr_texture_models[i]->is_float == is_float && sr_texture_models[i]->is_spectrum == is_spectrum)
            tell(visit, context, kind, sr_texture_models[i]->name, sr_texture_models[i]->params);
}

void sr_import_plugins(visitor *visit, void *context)
{
    const struct sr_material_model *m;
    tell_words(visit, context);
    tell_settings(visit, context);
    tell(visit, context, "Shape", "", sr_pbrt_shape_params);
    for (int i = 0; sr_shape_models[i]; ++i)
        tell(visit, context, "Shape", sr_shape_models[i]->name, sr_shape_models[i]->params);
    tell(visit, context, "Shape", "plymesh", sr_pbrt_ply_params);
    tell(visit, context, "Material", "", sr_pbrt_material_params);
    for (int i = 0; (m = sr_material_model(i)); ++i)
        tell(visit, context, "Material", m->name, m->params);
    tell(visit, context, "Texture", "", sr_mapping_params);
    tell_textures(visit, context, "Texture", true, true);
    tell_textures(visit, context, "Texture float", true, false);
    tell_textures(visit, context, "Texture spectrum", false, true);
    for (int i = 0; sr_light_models[i]; ++i)
        tell(visit, context, "LightSource", sr_light_models[i]->name, sr_light_models[i]->params);
    tell(visit, context, "AreaLightSource", "diffuse", sr_light_emission_params);
    for (int i = 0; sr_medium_models[i]; ++i)
        tell(visit, context, "MakeNamedMedium", sr_medium_models[i]->name, sr_medium_models[i]->params);
    tell(visit, context, "Meter", "", sr_meter_common_params);
    for (int i = 0; sr_meter_models[i]; ++i)
        tell(visit, context, "Meter", sr_meter_models[i]->name, sr_meter_models[i]->params);
}
