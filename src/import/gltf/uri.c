/* SPDX-License-Identifier: MIT */
/* References to bytes: "data:…;base64,…" (RFC 2397, RFC 4648), and names of files with %41 for A (RFC 3986). */
#include "import/gltf/gltf.h"

#include <string.h>
#include <strings.h>

static int hex(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

char *sr_gltf_unescape(struct sr_arena *arena, const char *uri)
{
    char *out = sr_arena_alloc(arena, strlen(uri) + 1), *to = out;
    for (const char *c = uri; *c && out; ++c) {
        if (*c != '%') {
            *to++ = *c;
            continue;
        }
        int high = hex(c[1]), low = high < 0 ? -1 : hex(c[2]);
        if (low < 0 || high + low == 0)
            return NULL;
        *to++ = (char)(16 * high + low);
        c += 2;
    }
    return out;
}

static int digit64(char c)
{
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+' || c == '-' ? 62
           : c == '/' || c == '_' ? 63
                                  : -1;
}

size_t sr_gltf_base64(const char *text, size_t length, uint8_t *out)
{
    while (length && text[length - 1] == '=')
        --length;
    uint32_t bits = 0;
    size_t n = 0;
    for (size_t i = 0; i < length; ++i) {
        int d = digit64(text[i]);
        if (d < 0)
            return SIZE_MAX;
        bits = bits << 6 | (uint32_t)d;
        if (i % 4 != 0) // six bits of the first of four say no byte yet
            out[n++] = (uint8_t)(bits >> (6 - 2 * (i % 4)));
    }
    return length % 4 == 1 ? SIZE_MAX : n;
}

bool sr_gltf_is_data_uri(const char *uri)
{
    return strncasecmp(uri, "data:", 5) == 0;
}

bool sr_gltf_fetch(struct sr_gltf *g, const struct sr_gltf_at *at, const char *uri, struct sr_gltf_buffer *out)
{
    *out = (struct sr_gltf_buffer){NULL, 0};
    if (sr_gltf_is_data_uri(uri)) {
        const char *comma = strchr(uri, ',');
        bool is_base64 = comma && comma - uri >= 7 && strncasecmp(comma - 7, ";base64", 7) == 0;
        size_t length = is_base64 ? strlen(comma + 1) : 0;
        uint8_t *bytes = is_base64 ? sr_gltf_array_for(g, at, &g->c.d->words, length / 4 * 3 + 3, 1) : NULL;
        size_t size = bytes ? sr_gltf_base64(comma + 1, length, bytes) : SIZE_MAX;
        if (size == SIZE_MAX)
            sr_gltf_fail(g, at, "expected \"data:\" with base64");
        else
            *out = (struct sr_gltf_buffer){bytes, size};
        return sr_gltf_is_well(g);
    }
    char *name = strstr(uri, "://") ? NULL : sr_gltf_unescape(&g->scratch, uri);
    if (!name) {
        sr_gltf_fail(g, at, "\"%.200s\": expected the name of a file beside this one", uri);
        return false;
    }
    char *path = sr_path_beside(&g->scratch, g->c.path, name), *data;
    size_t size;
    struct sr_error inner = {0};
    if (!path || sr_file_read(path, (size_t)16 << 30, &data, &size, &inner) != SR_OK) {
        sr_gltf_fail(g, at, "%s", path ? inner.text : "not enough memory");
        return false;
    }
    uint8_t *copy = sr_arena_copy(&g->c.d->words, data, size);
    sr_free(data);
    if (!copy && size)
        sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
    *out = (struct sr_gltf_buffer){copy, size};
    return sr_gltf_is_well(g);
}
