/* SPDX-License-Identifier: MIT */
/* Few keys in order, without a branch that depends on it: most lists of what a node has are as short as this. */
#ifndef SPH_HIERARCHY_RANKS_H
#define SPH_HIERARCHY_RANKS_H

#include <stddef.h>
#include <stdint.h>

enum { SPH__RANKED = 8 };

/* How many of the first `count` keys, which are different, are below each of all. */
void sph__kernel_ranks(const uint64_t keys[SPH__RANKED], size_t count, uint64_t ranks[SPH__RANKED]);

#endif
