/* SPDX-License-Identifier: MIT */
/* Parts of inner loops that the kernels share, so that all ways of searching give the same bits. */
#ifndef SPH_QUERY_STEP_H
#define SPH_QUERY_STEP_H

#include <string.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "hierarchy/lanes.h"

/* Bit i is byte i, of 64 that are 0 or 1. */
SPH__INLINE uint64_t sph__query_pack(const uint8_t *bytes)
{
    uint64_t mask = 0;
#if defined(__SSE2__)
    for (int i = 0; i < 4; ++i) {
        const __m128i sixteen = _mm_loadu_si128((const __m128i *)(const void *)(bytes + 16 * i));
        mask |= (uint64_t)(uint32_t)_mm_movemask_epi8(_mm_slli_epi16(sixteen, 7)) << (16 * i);
    }
#else
    for (int i = 0; i < 8; ++i) {
        uint64_t eight = 0;
        for (int k = 0; k < 8; ++k) /* one load, whatever the order of bytes */
            eight |= (uint64_t)bytes[8 * i + k] << (8 * k);
        mask |= (eight * 0x0102040810204080u >> 56) << (8 * i); /* the lowest bits of the bytes, side by side */
    }
#endif
    return mask;
}

/* Compilers make branches of what is picked by a condition that they know, which would be a guess. */
SPH__INLINE int sph__query_opaque(int condition)
{
    __asm__("" : "+r"(condition));
    return condition;
}

SPH__INLINE double sph__query_pick(int condition, double a, double b)
{
    const int64_t mask = -(int64_t)sph__query_opaque(condition);
    int64_t x, y;
    memcpy(&x, &a, sizeof x);
    memcpy(&y, &b, sizeof y);
    x = (x & mask) | (y & ~mask);
    memcpy(&a, &x, sizeof a);
    return a;
}

SPH__INLINE uint32_t sph__query_pick_number(int condition, uint32_t a, uint32_t b)
{
    const uint32_t mask = 0 - (uint32_t)sph__query_opaque(condition);
    return (a & mask) | (b & ~mask);
}

#endif
