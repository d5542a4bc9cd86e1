/* SPDX-License-Identifier: MIT */
/* Many moves against one primitive after the other; the answers are those of kernel.h and parts.h. */
#ifndef SPH_QUERY_WAVE_H
#define SPH_QUERY_WAVE_H

#include "query/parts.h"

enum { SPH__QUERY_WAVE = 256 }; /* moves at a time; a multiple of 64 */

/* Moves that may touch the primitive whose turn it is. What is beyond their number is left from others. */
typedef struct __attribute__((aligned(64))) sph__query_candidates {
    float entry[SPH__QUERY_WAVE], from[3][SPH__QUERY_WAVE], direction[3][SPH__QUERY_WAVE];
    float per_length[SPH__QUERY_WAVE], swell[SPH__QUERY_WAVE], margin[SPH__QUERY_WAVE];
    float first[SPH__QUERY_WAVE], last[SPH__QUERY_WAVE];
    uint16_t move[SPH__QUERY_WAVE];
} sph__query_candidates;

/* What moves; rays as a structure of arrays. */
typedef struct sph__query_wave {
    uint32_t count;
    const sph__query_ray *rays;
    float above[3][SPH__QUERY_WAVE], below[3][SPH__QUERY_WAVE], inverse[3][SPH__QUERY_WAVE];
    sph__query_candidates candidates;
} sph__query_wave;

/* Borrows rays. Those that are not set meet nothing. */
void sph__query_wave_begin(sph__query_wave *wave, uint32_t count, const sph__query_ray *rays);
void sph__query_wave_set(sph__query_wave *wave, uint32_t i, const sph__query_ray *ray);

/*
 * Pairs of the primitive in `slot` with moves that may touch it, and from when on; at most a wave, and one may be
 * written more. Returns how many.
 */
uint32_t sph__query_wave_pairs(sph__query_wave *wave, const sph__query_bounds *bounds, const sph__query_parts *parts,
                               uint32_t slot, sph__query_pair *pairs);

#endif
