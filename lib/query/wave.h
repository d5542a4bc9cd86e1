/* SPDX-License-Identifier: MIT */
/*
 * Many segments against all primitives: boxes segment by segment, for 16 primitives at a time; then primitive by
 * primitive, for up to 16 segments at a time, which wait until there are as many.
 */
#ifndef SPH_QUERY_WAVE_H
#define SPH_QUERY_WAVE_H

#include "query/parts.h"

enum {
    SPH__QUERY_WAVE = 224, /* segments at a time: numbers fit into a byte */
    SPH__QUERY_SIDE = 16,  /* segments side by side */
    SPH__QUERY_LEAVES = 4, /* leaves of primitives at a time, each of up to SPH__QUERY_LANES: */
    SPH__QUERY_SLOTS = 64  /* places of primitives */
};

/*
 * Which bounds of primitives the segment in each lane meets, and in which it begins, as bits, SPH__QUERY_LANES for each
 * of SPH__QUERY_LEAVES leaves; those that a lane may meet are so many bits of `leaves`.
 */
void sph__query_wave_meet(const sph__query_leaf *those, const sph__query_aim *aim, uint64_t leaves,
                          uint64_t met[SPH__QUERY_AIM], uint64_t begun[SPH__QUERY_AIM]);

/* Lines that have been called to a primitive, and their keys. */
typedef struct __attribute__((aligned(64))) sph__query_called {
    float keys[SPH__QUERY_SIDE];
    uint32_t listed; /* those who touch, or may begin within, as bits */
    uint32_t place, slot, count;
    uint8_t which[SPH__QUERY_SIDE];
} sph__query_called;

/* Of lines[which[..]], SPH__QUERY_SIDE of them, the first called->count: those that begin outside. */
void sph__query_wave_touch(const sph__query_parts *parts, const sph__query_line *lines, const uint8_t *which,
                           sph__query_called *called);
/* Those that may begin within. */
void sph__query_wave_begin(const sph__query_parts *parts, const sph__query_line *lines, const uint8_t *which,
                           sph__query_called *called);

#endif
