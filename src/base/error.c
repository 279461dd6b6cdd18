/* SPDX-License-Identifier: MIT */
/* Messages: errors that stick, and notes for whoever wants to hear them. */
#include "base/base.h"

#include <stdio.h>

sr_status sr_fail(struct sr_error *error, sr_status status, const char *format, ...)
{
    if (error && error->status == SR_OK) {
        error->status = status;
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return status;
}

void sr_log(struct sr_log *log, enum sr_severity severity, const char *format, ...)
{
    if (!log)
        return;
    if (severity == SR_WARNING)
        ++log->warning_count;
    if (!log->write)
        return;
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    log->write(log->user, severity, text);
}
