/* SPDX-License-Identifier: MIT */
/* Buffers within the JSON: data: URIs in base64. */
#include <string.h>

#include "io/gltf.h"

static int digit_of(char c)
{
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62; /* the second of each pair is that of URLs */
    return c == '/' || c == '_' ? 63 : -1;
}

sph_status sph__gltf_decode_base64(const sph__gltf_document *d, uint32_t value, const char *text,
                                   sph__gltf_buffer *buffer)
{
    const char *comma = strchr(text, ',');
    size_t length, size = 0;
    uint32_t bits = 0;
    if (comma == NULL || comma - text < 7 || memcmp(comma - 7, ";base64", 7) != 0)
        return sph__io_fail(d->context, SPH_E_UNSUPPORTED, "%s: a data: URI that is not in base64",
                            sph__io_shown(d->path));
    ++comma;
    length = strlen(comma);
    while (length > 0 && comma[length - 1] == '=')
        --length;
    buffer->decoded = sph_context_allocate(d->context, length / 4 * 3 + 3, 1);
    if (buffer->decoded == NULL) return sph__io_fail_memory(d->context, d->path);
    for (size_t i = 0; i < length; ++i) {
        const int digit = digit_of(comma[i]);
        if (digit < 0) return sph__gltf_fail(d, value, "character %zu of the data: URI is not of base64", i);
        bits = bits << 6 | (unsigned)digit;
        if (i % 4 != 0) buffer->decoded[size++] = (unsigned char)(bits >> (6 - 2 * (i % 4)));
    }
    buffer->bytes = buffer->decoded;
    buffer->size = size;
    return SPH_OK;
}
