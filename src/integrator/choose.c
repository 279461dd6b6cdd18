/* SPDX-License-Identifier: MIT */
/* An estimator from one word of the command line: "path", "bdpt,maxdepth=9", "uniform-hemisphere+light-area:power". */
#include "integrator/strategies.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t size_of(const struct sr_param *row)
{
    switch (row->kind) {
    case SR_PARAM_BOOL:
        return sizeof(bool);
    case SR_PARAM_INT:
    case SR_PARAM_ENUM:
        return sizeof(int32_t);
    case SR_PARAM_FLOAT:
        return sizeof(float);
    default:
        return sizeof(const char *);
    }
}

static void set_initial(const struct sr_param *row, void *at)
{
    if (row->kind == SR_PARAM_BOOL)
        memcpy(at, &(bool){row->initial > 0}, sizeof(bool));
    else if (row->kind == SR_PARAM_FLOAT)
        memcpy(at, &(float){(float)row->initial}, sizeof(float));
    else if (row->kind == SR_PARAM_STRING)
        memcpy(at, &row->text, sizeof row->text);
    else
        memcpy(at, &(int32_t){(int32_t)row->initial}, sizeof(int32_t));
}

static const struct sr_param *find_row(const struct sr_param *rows, const char *name, size_t length)
{
    for (; rows && rows->name; ++rows)
        if (strlen(rows->name) == length && strncmp(rows->name, name, length) == 0)
            return rows;
    return NULL;
}

// index of the word in "a|b|c"; -1: none
static int choice_of(const char *choices, const char *word)
{
    size_t length = strlen(word);
    for (int i = 0;; ++i) {
        size_t n = strcspn(choices, "|");
        if (n == length && strncmp(choices, word, n) == 0)
            return i;
        if (!choices[n])
            return -1;
        choices += n + 1;
    }
}

static sr_status set(const struct sr_param *row, const char *value, void *at, struct sr_arena *arena,
                     struct sr_error *error)
{
    char *end;
    double number = strtod(value, &end);
    bool is_number = end != value && !*end && number >= row->min && number <= row->max;
    if (row->kind == SR_PARAM_STRING) {
        const char *copy = sr_arena_string(arena, value);
        memcpy(at, &copy, sizeof copy);
        return copy ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    }
    if (row->kind == SR_PARAM_ENUM) {
        int choice = choice_of(row->text, value);
        memcpy(at, &(int32_t){choice}, sizeof(int32_t));
        return choice >= 0
                   ? SR_OK
                   : sr_fail(error, SR_ERROR_USAGE, "%s=%s: one of %s was expected", row->name, value, row->text);
    }
    if (row->kind == SR_PARAM_BOOL) {
        bool is_true = strcmp(value, "true") == 0;
        memcpy(at, &is_true, sizeof is_true);
        return is_true || strcmp(value, "false") == 0
                   ? SR_OK
                   : sr_fail(error, SR_ERROR_USAGE, "%s=%s: true or false was expected", row->name, value);
    }
    if (!is_number || (row->kind == SR_PARAM_INT && number != floor(number)))
        return sr_fail(error, SR_ERROR_USAGE, "%s=%s: a %snumber from %g to %g was expected", row->name, value,
                       row->kind == SR_PARAM_INT ? "whole " : "", row->min, row->max);
    if (row->kind == SR_PARAM_INT)
        memcpy(at, &(int32_t){(int32_t)number}, sizeof(int32_t));
    else
        memcpy(at, &(float){(float)number}, sizeof(float));
    return SR_OK;
}

static bool begins_with_strategy(const char *text)
{
    size_t length = strcspn(text, "+:,");
    for (int i = 0; i < SR_STRATEGY_COUNT; ++i)
        if (strlen(sr_strategies[i].name) == length && strncmp(sr_strategies[i].name, text, length) == 0)
            return true;
    return false;
}

static sr_status no_such(const char *name, struct sr_error *error)
{
    char names[512];
    int n = 0;
    for (int i = 0; sr_integrator_models[i]; ++i)
        n += snprintf(names + n, sizeof names - (size_t)n, "%s%s", i ? ", " : "", sr_integrator_models[i]->name);
    for (int i = 0; i < SR_STRATEGY_COUNT; ++i)
        n += snprintf(names + n, sizeof names - (size_t)n, "%s%s",
                      i ? ", " : "; or strategies joined by '+': ", sr_strategies[i].name);
    return sr_fail(error, SR_ERROR_USAGE, "there is no estimator \"%s\"; there are %s", name, names);
}

sr_status sr_integrator_parse(const char *text, const struct sr_integrator *base, struct sr_arena *arena,
                              struct sr_integrator *out, struct sr_error *error)
{
    char *words = sr_arena_string(arena, text);
    if (!words)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    char *rest = words + strcspn(words, ","), *heuristic = NULL;
    if (*rest)
        *rest++ = 0;
    const struct sr_integrator_model *model = sr_integrator_model_find(words);
    bool is_strategies = !model && begins_with_strategy(words);
    if (is_strategies) {
        model = &sr_integrator_estimator;
        heuristic = strchr(words, ':');
        if (heuristic)
            *heuristic++ = 0;
    }
    if (!model)
        return no_such(words, error);
    char *self = sr_arena_alloc(arena, model->size);
    if (!self)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    for (const struct sr_param *row = model->params; row->name; ++row) {
        const struct sr_param *same = base ? find_row(base->model->params, row->name, strlen(row->name)) : NULL;
        bool is_alike = same && same->kind == row->kind && (base->model == model || row->kind == SR_PARAM_INT);
        if (is_alike)
            memcpy(self + row->offset, (const char *)base->self + same->offset, size_of(row));
        else
            set_initial(row, self + row->offset);
    }
    sr_status status = SR_OK;
    if (is_strategies)
        status = set(find_row(model->params, "strategies", 10), words,
                     self + find_row(model->params, "strategies", 10)->offset, arena, error);
    if (heuristic && status == SR_OK)
        status = set(find_row(model->params, "heuristic", 9), heuristic,
                     self + find_row(model->params, "heuristic", 9)->offset, arena, error);
    while (status == SR_OK && *rest) {
        char *setting = rest, *equals = strchr(setting, '=');
        rest += strcspn(rest, ",");
        if (*rest)
            *rest++ = 0;
        if (!equals || equals == setting)
            return sr_fail(error, SR_ERROR_USAGE, "\"%s\": key=value was expected", setting);
        const struct sr_param *row = find_row(model->params, setting, (size_t)(equals - setting));
        if (!row)
            return sr_fail(error, SR_ERROR_USAGE, "%s has no parameter \"%.*s\"", model->name, (int)(equals - setting),
                           setting);
        if (strcmp(row->name, "lightsampler") == 0)
            return sr_fail(error, SR_ERROR_USAGE,
                           "\"lightsampler\" is chosen by the scene file, for all estimators alike");
        status = set(row, equals + 1, self + row->offset, arena, error);
    }
    if (status == SR_OK && model->prepare)
        status = model->prepare(self, arena, error);
    *out = (struct sr_integrator){model, self};
    return status;
}
