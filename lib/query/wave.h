/* SPDX-License-Identifier: MIT */
/* Many moves against one primitive after the other; the answers are those of kernel.h and fan.h. */
#ifndef SPH_QUERY_WAVE_H
#define SPH_QUERY_WAVE_H

#include "query/fan.h"

enum { SPH__QUERY_WAVE = 128 }; /* moves at a time; a multiple of 16, below 256 */

/* Moves that may touch the primitive whose turn it is. What is beyond their number is left from others. */
typedef struct __attribute__((aligned(64))) sph__query_candidates {
    float entry[SPH__QUERY_WAVE], from[3][SPH__QUERY_WAVE], way[3][SPH__QUERY_WAVE], reach[SPH__QUERY_WAVE];
    float first[SPH__QUERY_WAVE], last[SPH__QUERY_WAVE];
    double start[3][SPH__QUERY_WAVE], course[3][SPH__QUERY_WAVE], radius[SPH__QUERY_WAVE], t[SPH__QUERY_WAVE];
    double distance[SPH__QUERY_WAVE], next[SPH__QUERY_WAVE];
    uint8_t move[SPH__QUERY_WAVE];
} sph__query_candidates;

/* What moves; rays as a structure of arrays. */
typedef struct sph__query_wave {
    uint32_t count;
    const sph__query_ray *rays;
    const sph__query_move *moves;
    float above[3][SPH__QUERY_WAVE], below[3][SPH__QUERY_WAVE], inverse[3][SPH__QUERY_WAVE];
    sph__query_candidates candidates;
} sph__query_wave;

/* Borrows rays and moves. Those that are not set meet nothing. */
void sph__query_wave_begin(sph__query_wave *wave, uint32_t count, const sph__query_ray *rays,
                           const sph__query_move *moves);
void sph__query_wave_set(sph__query_wave *wave, uint32_t i, const sph__query_ray *ray);

/*
 * Pairs of the moves with the primitive in `slot`, after the first step, that touch or may touch later; at most a wave,
 * and one may be written more. Returns how many.
 */
uint32_t sph__query_wave_pairs(sph__query_wave *wave, const sph__query_bounds *bounds, const sph__query_fan *fans,
                               uint32_t slot, sph__query_pair *pairs);

#endif
