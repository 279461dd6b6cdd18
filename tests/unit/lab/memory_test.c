/* SPDX-License-Identifier: MIT */
/* The laboratory when memory ends. */
#include "specimens.h"

/* Which check meets the allocation that fails is chance, as threads share them. */
TEST(a_certificate_is_of_all_checks_or_an_error_when_memory_ends)
{
    struct sr_specimen s = specimen("diffuse");
    struct sr_certificate_options options = {.sets = 4, .samples = 2048, .significance = 1e-6};
    struct sr_certificate whole, c;
    struct sr_error error = {0};
    uint64_t before = sr_alloc_count();
    EXPECT_EQUAL_INT(sr_certify(&s, &options, &whole, &error), SR_OK);
    uint64_t all = sr_alloc_count() - before;
    for (uint64_t i = 0; i < all; ++i) {
        error = (struct sr_error){0};
        sr_alloc_fail(i, 1);
        sr_status status = sr_certify(&s, &options, &c, &error);
        sr_alloc_fail(0, 0);
        EXPECT(status == SR_OK || status == SR_ERROR_RESOURCE);
        EXPECT(status != SR_OK || (c.passed && c.evaluations == whole.evaluations));
    }
}
