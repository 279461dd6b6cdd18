/* SPDX-License-Identifier: MIT */
/* A film as a picture. */
#include "render/render.h"
#include "test.h"

/* For some number of channels the memory ends when only the attributes are left to be set. */
TEST(a_picture_without_memory_leaves_nothing_behind)
{
    for (uint32_t buckets = 1; buckets < 600; ++buckets) {
        struct sr_film_settings settings = {.width = 2,
                                            .height = 1,
                                            .x1 = 2,
                                            .y1 = 1,
                                            .buckets = buckets,
                                            .lambda_min = 400,
                                            .lambda_max = 700,
                                            .bucket_scale = 1,
                                            .exposure_time = 1,
                                            .iso = 100};
        struct sr_error error = {0};
        struct sr_film *film;
        EXPECT_EQUAL_INT(sr_film_create(&settings, false, &film, &error), SR_OK);
        uint64_t before = sr_alloc_count();
        struct sr_image *image;
        EXPECT_EQUAL_INT(sr_render_image(film, true, false, &image, &error), SR_OK);
        uint64_t all = sr_alloc_count() - before;
        EXPECT_EQUAL_INT(image->channel_count, 3 + 4 + buckets);
        sr_image_free(image);
        image = NULL;
        uint64_t live = sr_alloc_live();
        sr_alloc_fail(all - 1, 1);
        EXPECT_EQUAL_INT(sr_render_image(film, true, false, &image, &error), SR_ERROR_RESOURCE);
        sr_alloc_fail(0, 0);
        EXPECT(image == NULL);
        EXPECT_EQUAL_INT(sr_alloc_live(), live);
        sr_film_destroy(film);
    }
}
