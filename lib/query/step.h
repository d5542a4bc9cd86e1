/* SPDX-License-Identifier: MIT */
/* Parts of inner loops that the kernels share, so that all ways of searching give the same bits. */
#ifndef SPH_QUERY_STEP_H
#define SPH_QUERY_STEP_H

#include <string.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "hierarchy/lanes.h"
#include "query/fan.h"

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

/* Compilers make a branch of `?:`, which would be a guess. */
SPH__INLINE double sph__query_pick(int condition, double a, double b)
{
    const int64_t mask = -(int64_t)condition;
    int64_t x, y;
    memcpy(&x, &a, sizeof x);
    memcpy(&y, &b, sizeof y);
    x = (x & mask) | (y & ~mask);
    memcpy(&a, &x, sizeof a);
    return a;
}

/* The next number up; of one >= 0. */
SPH__INLINE double sph__query_following(double x)
{
    int64_t bits;
    memcpy(&bits, &x, sizeof bits);
    ++bits;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* What follows from the distance at t and from where the tangent there reaches 0. */
SPH__INLINE void sph__query_finish(sph__query_pair *p, double distance, double tolerance, double next)
{
    const double at = p->t;
    const int touches = distance <= tolerance;
    next = sph__query_pick((next > 1) & (next <= 1 + 1e-12) & (at < 1), 1, next);
    next = sph__query_pick(next == at, sph__query_following(at), next);
    next = sph__query_pick(p->steps + 1 < SPH__QUERY_STEPS, next, SPH__QUERY_MISS);
    p->t = sph__query_pick(touches, at, next);
    p->distance = distance;
    p->touches = (uint8_t)touches;
    ++p->steps;
}

#endif
