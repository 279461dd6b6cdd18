/* SPDX-License-Identifier: MIT */
/* What every header of Steradian needs: visibility, version, statuses. C17 and C++. */
#ifndef STERADIAN_BASE_H
#define STERADIAN_BASE_H

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define SR_API __attribute__((visibility("default")))
#else
#define SR_API
#endif

/* How a call ended. An operating error is a status and one sentence; the library never prints and never exits. */
typedef enum sr_status {
    SR_OK = 0,
    SR_ERROR_CHECK = 1,    /* a check failed or a target was missed */
    SR_ERROR_USAGE = 2,    /* the caller's arguments make no sense */
    SR_ERROR_INPUT = 3,    /* a file or scene is wrong */
    SR_ERROR_RESOURCE = 4, /* memory, disk, permissions */
    SR_CANCELLED = 5       /* somebody wanted to stop; what is done is kept */
} sr_status;

/* The library's version, such as "0.1.0". */
SR_API const char *sr_version(void);
/* What the processor must know for the library that is running: "x86-64-v2", "x86-64-v3", "x86-64-v4", or another
 * kind's name. */
SR_API const char *sr_isa(void);

#ifdef __cplusplus
}
#endif

#endif
