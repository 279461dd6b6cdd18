/* SPDX-License-Identifier: MIT */
/* --estimator help: the list, from the tables. */
#include "command.h"

#include "integrator/integrator.h"

#include <stdio.h>
#include <string.h>

static void print_params(const struct sr_param *p)
{
    for (; p && p->name; ++p)
        if (strcmp(p->name, "lightsampler") != 0 && strncmp(p->text, "accepted", 8) != 0)
            printf("  %-20s   %s%s%s\n", "", p->name,
                   p->kind == SR_PARAM_BOOL     ? "=true|false: "
                   : p->kind == SR_PARAM_STRING ? ": at first "
                   : p->kind == SR_PARAM_ENUM   ? "="
                                                : ": ",
                   p->text);
}

bool command_tells_estimators(int argc, char **argv)
{
    bool is_asked = false;
    for (int i = 1; i < argc; ++i) {
        const char *equals = strchr(argv[i], '=');
        bool is_option = strncmp(argv[i], "--estimator", 11) == 0 || strncmp(argv[i], "--integrator", 12) == 0;
        is_asked |= is_option && strcmp(equals ? equals + 1 : i + 1 < argc ? argv[i + 1] : "", "help") == 0;
    }
    if (!is_asked)
        return false;
    printf("--estimator NAME[,key=value…], where NAME is one of\n\n");
    for (int i = 0; sr_integrator_models[i]; ++i) {
        printf("  %-20s %s\n", sr_integrator_models[i]->name, sr_integrator_models[i]->text);
        print_params(sr_integrator_models[i]->params);
    }
    printf("\nor strategies of sampling, joined by '+', and ':' how they are weighed (balance, power, mean):\n\n");
    for (int i = 0; sr_strategy_name(i); ++i)
        printf("  %-20s %s\n", sr_strategy_name(i), sr_strategy_text(i));
    printf("\nmaxdepth is the scene's where it is not given.\n\n"
           "Examples:\n"
           "  steradian render scenes/cornell-box.pbrt --estimator uniform-hemisphere,maxdepth=1 -o uniform.png\n"
           "  steradian measure scenes/meters.pbrt --estimator bsdf+light-solid-angle:power\n");
    return true;
}
