/* SPDX-License-Identifier: MIT */
/* What every file of libsphmesh-io needs: failures, growing arrays, names. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "io/io.h"

enum { MESSAGE_SIZE = 512, SHOWN_SIZE = 200 };

sph_status sph__io_fail(sph_context *context, sph_status status, const char *format, ...)
{
    char text[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return sph_context_fail(context, status, text);
}

sph_status sph__io_fail_memory(sph_context *context, const char *path)
{
    return sph__io_fail(context, SPH_E_NOMEM, "%s: out of memory", sph__io_shown(path));
}

/* strerror_r comes in two kinds: one returns the text, the other a number. */
static const char *reason_gnu(const char *text, const char *buffer)
{
    (void)buffer;
    return text;
}

static const char *reason_posix(int failed, const char *buffer)
{
    return failed == 0 ? buffer : "unknown error";
}

#define REASON(result, buffer)                                                                                         \
    _Generic((result), char * : reason_gnu, const char * : reason_gnu, int : reason_posix)(result, buffer)

sph_status sph__io_fail_system(sph_context *context, const char *path, const char *what)
{
    const int error = errno;
    char buffer[128] = "";
    const char *reason = REASON(strerror_r(error, buffer, sizeof buffer), buffer);
    return sph__io_fail(context, error == ENOMEM ? SPH_E_NOMEM : SPH_E_IO, "%s: %s: %s", sph__io_shown(path), what,
                        reason);
}

const char *sph__io_shown(const char *path)
{
    const size_t length = strlen(path);
    const char *shown = length > SHOWN_SIZE ? path + (length - SHOWN_SIZE) : path;
    while (((unsigned char)*shown & 0xC0) == 0x80)
        ++shown; /* not in the middle of a character */
    return shown;
}

bool sph__io_reserve(sph_context *context, void **memory, size_t *capacity, size_t need, size_t size)
{
    size_t wanted = *capacity > SIZE_MAX / 2 ? need : *capacity * 2;
    void *grown;
    if (need <= *capacity) return true;
    if (wanted < need) wanted = need;
    if (wanted < 64) wanted = 64;
    grown = sph_context_allocate(context, wanted, size);
    if (grown == NULL) return false;
    if (*capacity != 0) memcpy(grown, *memory, *capacity * size);
    sph_context_release(context, *memory);
    *memory = grown;
    *capacity = wanted;
    return true;
}

char *sph__io_copy_string(sph_context *context, const char *text)
{
    const size_t size = strlen(text) + 1;
    char *copy = sph_context_allocate(context, size, 1);
    if (copy != NULL) memcpy(copy, text, size);
    return copy;
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c;
}

bool sph__io_has_ending(const char *path, const char *ending)
{
    const size_t length = strlen(path), size = strlen(ending);
    if (length <= size || path[length - size - 1] != '.') return false;
    for (size_t i = 0; i < size; ++i)
        if (lower(path[length - size + i]) != lower(ending[i])) return false;
    return true;
}

void sph__io_options_init(void *options, size_t size, const void *defaults, size_t full, size_t least)
{
    const uint32_t struct_size = (uint32_t)size;
    if (options == NULL || size < least || size > UINT32_MAX) return;
    memset(options, 0, size); /* a newer caller's tail becomes 0 */
    memcpy(options, defaults, size < full ? size : full);
    memcpy(options, &struct_size, sizeof struct_size);
}

sph_status sph__io_options_read(sph_context *context, const char *name, const void *in, void *out, size_t full,
                                size_t least)
{
    uint32_t size;
    if (in == NULL) return SPH_OK;
    memcpy(&size, in, sizeof size);
    if (size < least)
        return sph__io_fail(context, SPH_E_INVALID, "%s was not initialised: struct_size is %u, at least %zu is needed",
                            name, (unsigned)size, least);
    for (size_t i = full; i < size; ++i)
        if (((const unsigned char *)in)[i] != 0)
            return sph__io_fail(context, SPH_E_VERSION, "%s has a field set (byte %zu) that this version does not know",
                                name, i);
    memcpy(out, in, size < full ? size : full);
    return SPH_OK;
}
