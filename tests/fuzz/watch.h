/* SPDX-License-Identifier: MIT */
/* An input that takes too long is a finding, by the processor's time: on a busy machine the clock accuses the innocent.
 * What waits without working is found by the clock, after much longer. */
#ifndef SR_TESTS_FUZZ_WATCH_H
#define SR_TESTS_FUZZ_WATCH_H

#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/time.h>
#include <unistd.h>

enum { FUZZ_MOST_S = 60, FUZZ_FOREVER_S = 900 };

static void end_late(int number)
{
    static const char text[] = "an input takes more than a minute of the processor, or a quarter of an hour\n";
    (void)number;
    if (write(STDERR_FILENO, text, sizeof text - 1) < 0)
        _exit(4);
    abort(); // libFuzzer keeps the input
}

/* From now on one input is at work, until the next. libFuzzer has a clock of its own (-timeout). */
static void watch_input(void)
{
    static bool is_ready;
    if (!is_ready)
        signal(SIGPROF, end_late);
    setitimer(ITIMER_PROF, &(struct itimerval){.it_value = {.tv_sec = FUZZ_MOST_S}}, NULL);
#ifndef FUZZ_LIBFUZZER
    if (!is_ready)
        signal(SIGALRM, end_late);
    alarm(FUZZ_FOREVER_S);
#endif
    is_ready = true;
}

#endif
