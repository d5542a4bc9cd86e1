/* SPDX-License-Identifier: MIT */
/* Numbers in files, byte by byte: compilers know these forms, and make a load, with or without a swap, of them. */
#ifndef SPH_IO_BYTES_H
#define SPH_IO_BYTES_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static inline uint16_t sph__io_load_16(const unsigned char *p, bool big)
{
    return (uint16_t)(big ? p[0] << 8 | p[1] : p[1] << 8 | p[0]);
}

static inline uint32_t sph__io_load_32(const unsigned char *p, bool big)
{
    return big ? p[3] | (uint32_t)p[2] << 8 | (uint32_t)p[1] << 16 | (uint32_t)p[0] << 24
               : p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static inline uint64_t sph__io_load_64(const unsigned char *p, bool big)
{
    const uint64_t first = sph__io_load_32(p, big), second = sph__io_load_32(p + 4, big);
    return big ? first << 32 | second : second << 32 | first;
}

static inline float sph__io_load_float(const unsigned char *p, bool big)
{
    const uint32_t bits = sph__io_load_32(p, big);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline double sph__io_load_double(const unsigned char *p, bool big)
{
    const uint64_t bits = sph__io_load_64(p, big);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void sph__io_store_32(unsigned char *p, uint32_t value, bool big)
{
    for (unsigned i = 0; i < 4; ++i)
        p[big ? 3 - i : i] = (unsigned char)(value >> 8 * i);
}

static inline void sph__io_store_float(unsigned char *p, float value, bool big)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    sph__io_store_32(p, bits, big);
}

#endif
