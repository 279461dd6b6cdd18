/* SPDX-License-Identifier: MIT */
/* EXR files are packed by all processors that there are, and do not show how many. */
#define _GNU_SOURCE
#include "make.h"

#if defined(__linux__)
#include <sched.h>

/* Bytes of the file of a picture of many chunks, packed by so many threads at most. */
static void encode_by(int threads, void **bytes, size_t *size)
{
    cpu_set_t all, some;
    EXPECT(sched_getaffinity(0, sizeof all, &all) == 0);
    CPU_ZERO(&some);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&some) < threads; cpu++)
        if (CPU_ISSET(cpu, &all))
            CPU_SET(cpu, &some);
    EXPECT(sched_setaffinity(0, sizeof some, &some) == 0);
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT(sr_image_create(70, 613, 7, (const char *const[]){"R", "G", "B", "depth", "u", "v", "id"}, SR_IMAGE_FLOATS,
                           &image, &error) == SR_OK);
    for (uint32_t i = 0; i < 70 * 613 * 7; i++)
        image->floats[i] = (float)(i * 2654435761u >> 20);
    EXPECT(sr_image_encode(".exr", image, NULL, bytes, size, &error) == SR_OK);
    sr_image_free(image);
    sched_setaffinity(0, sizeof all, &all);
}

TEST(exr_bytes_do_not_depend_on_threads)
{
    void *one, *more;
    size_t size, more_size;
    encode_by(1, &one, &size);
    encode_by(8, &more, &more_size);
    EXPECT(size == more_size && memcmp(one, more, size) == 0);
    sr_free(one);
    sr_free(more);
}
#endif
