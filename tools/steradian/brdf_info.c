/* SPDX-License-Identifier: MIT */
/* steradian brdf info: what a file of measured data holds, and what it is worth. */
#include "brdf.h"
#include "measured/measured.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] = "Usage: steradian brdf info FILE … [OPTIONS]\n"
                           "\n"
                           "Tells the format of a file of measured data, its conventions, what it covers, how much "
                           "light it returns, and how far\n"
                           "it is from reciprocal. Formats: MERL binary, RGL and polarised tensor files, BSDF XML, "
                           "Cornell, ASTM, ABg, tables.\n"
                           "\n"
                           "      --quantity WORD   what the numbers are, where the format leaves it open: bsdf, "
                           "cosine (f cos theta_o) or factor\n"
                           "                        (pi f)\n"
                           "      --angles WORD     of tables: degrees or radians\n"
                           "      --json            the same as JSON on standard output\n"
                           "\n"
                           "Exit code 1 where a file returns more light than it receives.\n"
                           "\n"
                           "Examples:\n"
                           "  steradian brdf info paint.binary\n"
                           "  steradian brdf info goniometer.txt --quantity cosine --angles degrees --json\n";

static const struct option long_options[] = {
    {"quantity", required_argument, NULL, 'q'},
    {"angles", required_argument, NULL, 'a'},
    {"json", no_argument, NULL, 'j'},
    {NULL, 0, NULL, 0},
};

static bool find_word(const char *option, const char *text, const char *const *words, int32_t *value)
{
    for (*value = 0; words[*value]; ++*value)
        if (strcmp(words[*value], text) == 0)
            return true;
    command_usage(&brdf_info, "--%s %s: %s%s%s%s%s was expected", option, text, words[1], words[3] ? ", " : " or ",
                  words[2], words[3] ? " or " : "", words[3] ? words[3] : "");
    return false;
}

static const char *sides_of(const struct sr_measured_report *r)
{
    return r->sides == (SR_MEASURED_REFLECTION | SR_MEASURED_TRANSMISSION) ? "reflection and transmission"
           : r->sides == SR_MEASURED_TRANSMISSION                          ? "transmission"
                                                                           : "reflection";
}

static void print(const char *path, const struct sr_measured_report *r)
{
    printf("%s: %s, %s, %s\n", path, r->format, r->is_isotropic ? "isotropic" : "anisotropic", sides_of(r));
    if (r->description[0])
        printf("  description   %s\n", r->description);
    printf("  numbers       %s; %llu of them, %llu invalid or negative and taken as 0\n", r->quantity,
           (unsigned long long)r->values, (unsigned long long)r->invalid);
    if (r->is_spectral)
        printf("  wavelengths   %d, %g … %g nm\n", r->channels, (double)r->lambda_min, (double)r->lambda_max);
    else
        printf("  colour        %s\n", r->channels == 3 ? "three channels, made spectra by uplift" : "grey");
    printf("  covers        theta_i %.4g … %.4g deg, theta_o %.4g … %.4g deg; %.1f %% of all pairs of directions\n",
           (double)r->theta_i_min, (double)r->theta_i_max, (double)r->theta_o_min, (double)r->theta_o_max,
           100 * r->coverage);
    printf("  energy        %s: at most %.4f of the light is returned, from theta %g, phi %g deg",
           r->largest_albedo > 1 ? "MAKES LIGHT" : "kept", r->largest_albedo, r->largest_theta, r->largest_phi);
    if (r->channels > 1)
        printf(", at %.0f nm", r->largest_lambda);
    printf("\n");
    if (r->reciprocity_max < 1e-4)
        printf("  reciprocity   kept\n");
    else
        printf("  reciprocity   off by %.2f %% in the mean, by %.1f %% at most (theta %.1f and %.1f, phi %.1f and %.1f "
               "deg)\n",
               100 * r->reciprocity_mean, 100 * r->reciprocity_max, r->reciprocity_theta[0], r->reciprocity_theta[1],
               r->reciprocity_phi[0], r->reciprocity_phi[1]);
    if (r->note[0])
        printf("  note          %s\n", r->note);
    printf("  total integrated scatter, mean of 430 … 680 nm:\n  theta_i [deg]");
    for (int i = 0; i < SR_MEASURED_REPORT_ANGLES; ++i)
        printf(" %7g", r->scatter[i].theta);
    if (r->sides & SR_MEASURED_REFLECTION) {
        printf("\n  reflected [1]");
        for (int i = 0; i < SR_MEASURED_REPORT_ANGLES; ++i)
            printf(" %7.4f", r->scatter[i].reflected);
    }
    if (r->sides & SR_MEASURED_TRANSMISSION) {
        printf("\n  passed [1]   ");
        for (int i = 0; i < SR_MEASURED_REPORT_ANGLES; ++i)
            printf(" %7.4f", r->scatter[i].transmitted);
    }
    printf("\n");
}

static json_t *to_json(const char *path, const struct sr_measured_report *r)
{
    json_t *scatter = json_array();
    for (int i = 0; i < SR_MEASURED_REPORT_ANGLES; ++i)
        json_array_append_new(scatter,
                              json_pack("{s:o, s:o, s:o}", "theta_i", command_json_quantity(r->scatter[i].theta, "deg"),
                                        "reflected", command_json_quantity(r->scatter[i].reflected, "1"), "transmitted",
                                        command_json_quantity(r->scatter[i].transmitted, "1")));
    json_t *j = json_pack("{s:o, s:s, s:o, s:s, s:o, s:s, s:b, s:b, s:i, s:I, s:I}", "file", command_json_text(path),
                          "format", r->format, "description", command_json_text(r->description), "quantity",
                          r->quantity, "note", command_json_text(r->note), "sides", sides_of(r), "is_isotropic",
                          r->is_isotropic, "is_spectral", r->is_spectral, "channels", r->channels, "values",
                          (json_int_t)r->values, "invalid", (json_int_t)r->invalid);
    const struct {
        const char *name, *unit;
        double value;
    } numbers[] = {{"lambda_min", "nm", r->is_spectral ? (double)r->lambda_min : NAN},
                   {"lambda_max", "nm", r->is_spectral ? (double)r->lambda_max : NAN},
                   {"theta_i_min", "deg", (double)r->theta_i_min},
                   {"theta_i_max", "deg", (double)r->theta_i_max},
                   {"theta_o_min", "deg", (double)r->theta_o_min},
                   {"theta_o_max", "deg", (double)r->theta_o_max},
                   {"coverage", "1", r->coverage},
                   {"largest_albedo", "1", r->largest_albedo},
                   {"largest_albedo_theta", "deg", r->largest_theta},
                   {"largest_albedo_phi", "deg", r->largest_phi},
                   {"largest_albedo_lambda", "nm", r->largest_lambda},
                   {"reciprocity_mean", "1", r->reciprocity_mean},
                   {"reciprocity_max", "1", r->reciprocity_max}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i)
        json_object_set_new(j, numbers[i].name, command_json_quantity(numbers[i].value, numbers[i].unit));
    json_object_set_new(j, "scatter", scatter);
    return j;
}

static int run(int argc, char **argv)
{
    static const char *const quantities[] = {"auto", "bsdf", "cosine", "factor", NULL};
    static const char *const angles[] = {"auto", "degrees", "radians", NULL};
    struct sr_measured_options options = {0};
    bool as_json = false;
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":", long_options, &index)) != -1) {
        bool ok = true;
        switch (option) {
        case 'q':
            ok = find_word("quantity", optarg, quantities, &options.quantity);
            break;
        case 'a':
            ok = find_word("angles", optarg, angles, &options.angles);
            break;
        case 'j':
            as_json = true;
            break;
        default:
            return command_bad_option(&brdf_info, long_options, option, argv);
        }
        if (!ok)
            return SR_ERROR_USAGE;
    }
    if (optind >= argc)
        return command_usage(&brdf_info, "a file of measured data was expected");
    json_t *files = json_array();
    int code = 0;
    for (int i = optind; i < argc && code <= SR_ERROR_CHECK; ++i) {
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        const struct sr_measured *m;
        struct sr_measured_report report;
        if (sr_measured_read(argv[i], &options, &arena, &m, &error) != SR_OK)
            code = command_fail(brdf_info.name, &error);
        else {
            sr_measured_report(m, &report);
            code = report.largest_albedo > 1 ? SR_ERROR_CHECK : code;
            if (as_json)
                json_array_append_new(files, to_json(argv[i], &report));
            else
                print(argv[i], &report);
        }
        sr_arena_free(&arena);
    }
    if (as_json && code <= SR_ERROR_CHECK) {
        int printed = command_print_json(brdf_info.name, json_pack("{s:O}", "files", files));
        code = printed ? printed : code;
    }
    json_decref(files);
    return code;
}

const struct command brdf_info = {"brdf info", "what a file of measured data holds, and what it is worth", help, run};
