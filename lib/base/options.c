/* SPDX-License-Identifier: MIT */
#include "base/base.h"

/* No struct of ours will ever be as large: a struct_size beyond it is rubbish, and must not be read to its end. */
enum { SIZE_LIMIT = 65536 };

void sph__options_init(void *options, size_t size, const void *defaults, size_t full, size_t least)
{
    const uint32_t struct_size = (uint32_t)size;
    if (options == NULL || size < least || size > SIZE_LIMIT) return;
    memset(options, 0, size);                             /* a newer caller's tail becomes 0 */
    memcpy(options, defaults, size < full ? size : full); /* an older caller's struct is not overrun */
    memcpy(options, &struct_size, sizeof struct_size);
}

sph_status sph__options_read(const sph_context *context, const char *name, const void *in, void *out, size_t full,
                             size_t least)
{
    const uint32_t struct_size = (uint32_t)full;
    uint32_t size;
    if (in == NULL) return SPH_OK;
    memcpy(&size, in, sizeof size);
    if (size > SIZE_LIMIT)
        return sph__fail(context, SPH_E_INVALID, "%s was not initialised: struct_size is %u", name, (unsigned)size);
    if (size < least)
        return sph__fail(context, SPH_E_INVALID, "%s was not initialised: struct_size is %u, at least %zu is needed",
                         name, (unsigned)size, least);
    for (size_t i = full; i < size; ++i)
        if (((const unsigned char *)in)[i] != 0)
            return sph__fail(context, SPH_E_VERSION, "%s has a field set (byte %zu) that this version does not know",
                             name, i);
    memcpy(out, in, size < full ? size : full);
    memcpy(out, &struct_size, sizeof struct_size);
    return SPH_OK;
}
