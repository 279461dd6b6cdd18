/* SPDX-License-Identifier: MIT */
#include "import/pbrt/statement.h"
sr_status sr_pbrt_upgrade(struct sr_pbrt_upgrade *u, struct sr_pbrt_parser *p, struct sr_pbrt_statement *s)
{
    (void)u;
    (void)p;
    (void)s;
    return SR_OK;
}
