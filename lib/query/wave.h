/* SPDX-License-Identifier: MIT */
/*
 * Many segments against all primitives: boxes segment by segment, for 16 primitives at a time; then parts primitive by
 * primitive, for up to 16 segments at a time, which wait until there are as many.
 */
#ifndef SPH_QUERY_WAVE_H
#define SPH_QUERY_WAVE_H

#include "query/parts.h"

enum {
    SPH__QUERY_WAVE = 176, /* segments at a time: numbers fit into a byte */
    SPH__QUERY_SIDE = 16,  /* segments side by side */
    SPH__QUERY_SLOTS = 64  /* primitives at a time */
};

/* Which of the boxes [begin, begin + count), at most 64, the segment in each lane meets, as bits. */
void sph__query_wave_meet(const sph__query_bounds *bounds, size_t begin, uint32_t count, const sph__query_aim *aim,
                          uint64_t masks[SPH__QUERY_AIM]);

/* Lines side by side, and a primitive that they may touch. */
typedef struct __attribute__((aligned(64))) sph__query_side {
    float from[3][SPH__QUERY_SIDE], direction[3][SPH__QUERY_SIDE], per_length[SPH__QUERY_SIDE], reach[SPH__QUERY_SIDE];
    uint8_t which[SPH__QUERY_SIDE];
    uint32_t slot, count;
} sph__query_side;

/* Puts lines[side->which[..]] side by side. Best some time before they are used: what is written in pieces is slow to
 * read as a whole for a while. */
void sph__query_wave_gather(sph__query_side *side, const sph__query_line *lines);

/* Their keys; above 1: does not touch. */
void sph__query_wave_touch(const sph__query_parts *parts, const sph__query_fan *fan, const sph__query_side *side,
                           float keys[SPH__QUERY_SIDE]);

#endif
