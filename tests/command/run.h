/* SPDX-License-Identifier: MIT */
/* The command run as a user would, with everything that it says. */
#ifndef SR_TESTS_COMMAND_RUN_H
#define SR_TESTS_COMMAND_RUN_H

#include "test.h"

#include "image/image.h"

#include <jansson.h>
#include <sys/types.h>

enum { MAX_SAID = 1 << 16 };

struct said {
    int code; // exit code, or 256 + the signal that killed it
    char out[MAX_SAID], err[MAX_SAID];
};

/* Runs `steradian ARGUMENTS` (words split at blanks) in the test's folder, standard input from the file `input` or
 * empty where it is NULL. Static result; a crash (signal, or a sanitizer's report) fails the test. */
const struct said *run(const char *arguments, const char *input);
/* The same, and the exit code must be this one. */
const struct said *run_expecting(int code, const char *arguments);
/* Starts it and returns at once; output goes to the files "out" and "err" of the test's folder. */
pid_t start(const char *arguments);
/* Waits until it catches the signal; before, that would end it. */
void wait_until_caught(pid_t pid, int number);
/* Waits for it. */
const struct said *finish(pid_t pid);

/* A file of this name and text in the test's folder. */
void put_file(const char *name, const char *text);
/* A file of the test's folder as an image that must be freed, or a failed test. */
struct sr_image *get_image(const char *name);
/* How many entries of the test's folder have this in their name. */
int count_files(const char *part);
void remove_file(const char *name);
/* Standard output as JSON, or a failed test; release it. */
json_t *json_of(const struct said *s);
/* The path of the Cornell box. */
#define CORNELL SR_TEST_SOURCE_DIR "/scenes/cornell-box.pbrt"

#define EXPECT_SAYS(text, part)                                                                                        \
    do {                                                                                                               \
        if (!strstr(text, part))                                                                                       \
            test_fail(__FILE__, __LINE__, "\"%s\" was expected in: %s", part, text);                                   \
    } while (0)

#endif
