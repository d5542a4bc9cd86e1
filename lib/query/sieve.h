/* SPDX-License-Identifier: MIT */
/*
 * Which of many segments may come near which leaves of primitives at all: 16 side by side, with 32 bits, by two boxes
 * for each leaf. Half of what is asked, or more, mostly ends here.
 */
#ifndef SPH_QUERY_SIEVE_H
#define SPH_QUERY_SIEVE_H

#include <sphmesh/query.h>

#include "level/box_tree.h"
#include "query/aim.h"

enum { SPH__QUERY_SIEVED = 128 }; /* segments at a time */

/* Those that are left, in the same order. */
typedef struct sph__query_sieved {
    uint32_t count;
    uint16_t which[SPH__QUERY_SIEVED + 1];
    uint32_t leaves[SPH__QUERY_SIEVED + 1]; /* that each may meet, as bits */
} sph__query_sieved;

/* Of sweeps [first, first + count), at most SPH__QUERY_SIEVED; of up to 32 leaves, two boxes each. */
void sph__query_sieve(sph__query_sieved *sieved, const sph__query_room *room, const sph_sweep *sweeps, uint32_t first,
                      uint32_t count, const sph__box *boxes, uint32_t leaf_count);

#endif
