/* SPDX-License-Identifier: MIT */
/* steradian brdf eval: f and pdf of a specimen for a pair of directions. */
#include "brdf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian brdf eval SPECIMEN … --wi THETA[,PHI] --wo THETA[,PHI] [OPTIONS]\n"
    "\n"
    "Prints f [1/sr] (without the cosine), f cos theta_i [1/sr] and the density [1/sr] with which the specimen's "
    "sampler\n"
    "draws wi where light arrives at wo. Angles are in degrees from the normal; above 90: from below the surface.\n"
    "\n"
    "      --wi THETA[,PHI]   toward the light [deg]\n"
    "      --wo THETA[,PHI]   toward the viewer [deg]\n"
    "      --lambda NM[,NM …] wavelengths [nm], up to " BRDF_MOST_LAMBDAS " (550)\n"
    "      --importance       the form for light paths, without the factor eta^2 of radiance in another medium\n"
    "      --seed N           of models whose f is a random estimate (1)\n"
    "      --json             the same as JSON on standard output\n"
    "\n"
    "Examples:\n"
    "  steradian brdf eval diffuse reflectance=.5 --wi 0 --wo 60\n"
    "  steradian brdf eval conductor eta=metal-Au-eta k=metal-Au-k alpha_x=.2 alpha_y=.2 --wi 30,180 --wo 30 --lambda "
    "450,550,650\n"
    "  steradian brdf eval .3*diffuse + .7*conductor alpha_x=.1 alpha_y=.1 --wi 45,180 --wo 45 --json\n";

static const struct option long_options[] = {
    {"wi", required_argument, NULL, 'i'},
    {"wo", required_argument, NULL, 'o'},
    {"lambda", required_argument, NULL, 'l'},
    {"importance", no_argument, NULL, 'm'},
    {"seed", required_argument, NULL, 's'},
    {"json", no_argument, NULL, 'j'},
    {NULL, 0, NULL, 0},
};

struct arguments {
    bool has_wi, has_wo, json, importance;
    double wi_deg[2], wo_deg[2], wi[3], wo[3];
    struct brdf_lambda lambda;
    uint64_t seed;
};

static int print(const struct arguments *a, const struct sr_specimen *specimen)
{
    static struct sr_specimen_at at;
    sr_specimen_at(specimen, a->lambda.lambda, (uint32_t)a->seed, &at);
    enum sr_transport mode = a->importance ? SR_IMPORTANCE : SR_RADIANCE;
    float pdf;
    sr_spectrum f = sr_bsdf_f_pdf(&at.bsdf, brdf_vec3(a->wo), brdf_vec3(a->wi), mode, &pdf);
    uint32_t lobes = sr_bsdf_lobes(&at.bsdf);
    char words[128];
    if (a->json) {
        json_t *nm = json_array(), *values = json_array();
        for (int i = 0; i < a->lambda.count; ++i) {
            json_array_append_new(nm, json_real((double)a->lambda.lambda[i]));
            json_array_append_new(values, command_json_number((double)f[i]));
        }
        return command_print_json(
            "brdf eval",
            json_pack(
                "{s:o, s:{s:f, s:f, s:s}, s:{s:f, s:f, s:s}, s:s, s:{s:o, s:s}, s:{s:o, s:s}, s:o, s:o, s:s, s:b}",
                "specimen", command_json_text(specimen->title), "wi", "theta", a->wi_deg[0], "phi", a->wi_deg[1],
                "unit", "deg", "wo", "theta", a->wo_deg[0], "phi", a->wo_deg[1], "unit", "deg", "form",
                a->importance ? "importance" : "radiance", "lambda", "value", nm, "unit", "nm", "f", "value", values,
                "unit", "1/sr", "cos_theta_i", command_json_quantity(fabs(a->wi[2]), "1"), "pdf",
                command_json_quantity((double)pdf, "1/sr"), "lobes", brdf_lobe_words(lobes, words), "f_is_random",
                at.bsdf.model->is_random));
    }
    printf("%s\nwi %g,%g deg, wo %g,%g deg; lobes: %s\n\n", specimen->title, a->wi_deg[0], a->wi_deg[1], a->wo_deg[0],
           a->wo_deg[1], brdf_lobe_words(lobes, words));
    printf("%12s %14s %20s\n", "lambda [nm]", "f [1/sr]", "f cos_theta_i [1/sr]");
    for (int i = 0; i < a->lambda.count; ++i)
        printf("%12g %14.8g %20.8g\n", (double)a->lambda.lambda[i], (double)f[i], (double)f[i] * fabs(a->wi[2]));
    printf("\npdf %.8g 1/sr\n", (double)pdf);
    if (lobes & SR_LOBE_SPECULAR)
        printf("note: what it reflects or transmits as a mirror has no f: a delta function is not counted\n");
    if (at.bsdf.model->is_random)
        printf("note: f is a random estimate, right in the mean over seeds (--seed)\n");
    return 0;
}

static int run(int argc, char **argv)
{
    struct arguments a = {.lambda = brdf_default_lambda(), .seed = 1};
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":", long_options, &index)) != -1)
        switch (option) {
        case 'i':
            if (!brdf_parse_direction(&brdf_eval, "wi", optarg, a.wi_deg, a.wi))
                return SR_ERROR_USAGE;
            a.has_wi = true;
            break;
        case 'o':
            if (!brdf_parse_direction(&brdf_eval, "wo", optarg, a.wo_deg, a.wo))
                return SR_ERROR_USAGE;
            a.has_wo = true;
            break;
        case 'l':
            if (!brdf_parse_lambda(&brdf_eval, optarg, &a.lambda))
                return SR_ERROR_USAGE;
            break;
        case 'm':
            a.importance = true;
            break;
        case 's':
            if (!command_parse_uint(&brdf_eval, "seed", optarg, 0, UINT32_MAX, &a.seed))
                return SR_ERROR_USAGE;
            break;
        case 'j':
            a.json = true;
            break;
        default:
            return command_bad_option(&brdf_eval, long_options, option, argv);
        }
    if (!a.has_wi || !a.has_wo)
        return command_usage(&brdf_eval, "--%s THETA[,PHI] was expected", a.has_wi ? "wo" : "wi");
    struct sr_arena arena = {0};
    struct sr_specimen specimen;
    int code = brdf_read_specimen(&brdf_eval, argc, argv, &arena, &specimen);
    if (code == 0)
        code = print(&a, &specimen);
    sr_arena_free(&arena);
    return code;
}

const struct command brdf_eval = {"brdf eval", "f and pdf for a pair of directions", help, run};
