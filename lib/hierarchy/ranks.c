/* SPDX-License-Identifier: MIT */
#include "hierarchy/ranks.h"

#include "hierarchy/lanes.h"

_Static_assert((int)SPH__RANKED == (int)SPH__LANES, "a vector of keys");

SPH__CLONES static void rank_clones(const uint64_t *keys, size_t count, uint64_t *ranks)
{
    uint64_t before[SPH__RANKED] = {0};
    for (size_t i = 0; i < count; ++i) {
        const uint64_t key = keys[i];
        SPH__LANE_LOOP
        for (size_t l = 0; l < SPH__RANKED; ++l) before[l] += key < keys[l];
    }
    SPH__LANE_LOOP
    for (size_t l = 0; l < SPH__RANKED; ++l) ranks[l] = before[l];
}

void sph__kernel_ranks(const uint64_t keys[SPH__RANKED], size_t count, uint64_t ranks[SPH__RANKED])
{
    rank_clones(keys, count, ranks);
}
