/* SPDX-License-Identifier: MIT */
/* Unpacks what other formats keep in zlib's (RFC 1950), where they also tell the size. */
#include "base/base.h"

#include <zlib.h>

bool sr_inflate(const void *data, size_t size, void *out, size_t out_size)
{
    z_stream z = {0};
    if (inflateInit(&z) != Z_OK)
        return false;
    const size_t most = 1u << 30; // zlib counts in 32 bits
    const Bytef *in = data;
    Bytef *to = out;
    size_t in_left = size, out_left = out_size;
    int status = Z_OK;
    while (status == Z_OK) {
        uInt in_now = (uInt)(in_left < most ? in_left : most), out_now = (uInt)(out_left < most ? out_left : most);
        z.next_in = (Bytef *)(uintptr_t)in;
        z.next_out = to;
        z.avail_in = in_now;
        z.avail_out = out_now;
        status = inflate(&z, Z_NO_FLUSH); // no progress, such as for want of room, is an error
        in += in_now - z.avail_in;
        to += out_now - z.avail_out;
        in_left -= in_now - z.avail_in;
        out_left -= out_now - z.avail_out;
    }
    inflateEnd(&z);
    return status == Z_STREAM_END && out_left == 0;
}
