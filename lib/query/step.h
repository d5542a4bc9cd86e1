/* SPDX-License-Identifier: MIT */
/* Parts of inner loops that the kernels share, so that all ways of searching give the same bits. */
#ifndef SPH_QUERY_STEP_H
#define SPH_QUERY_STEP_H

#include <string.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "hierarchy/lanes.h"

/* Bit i is bit `place` of byte i, of 16. */
SPH__INLINE uint32_t sph__query_pack(const uint8_t *bytes, int place)
{
#if defined(__SSE2__)
    const __m128i sixteen = _mm_loadu_si128((const __m128i *)(const void *)bytes);
    return (uint32_t)_mm_movemask_epi8(_mm_slli_epi16(sixteen, 7 - place));
#else
    uint32_t mask = 0;
    for (int i = 0; i < 16; ++i)
        mask |= (uint32_t)(bytes[i] >> place & 1) << i;
    return mask;
#endif
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
