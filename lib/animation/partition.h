/* SPDX-License-Identifier: MIT */
/* Groups of vertices that may be one, split finer by each frame that is shown. */
#ifndef SPH_PARTITION_H
#define SPH_PARTITION_H

#include "base/base.h"

/* Set in `members` at the last vertex of each group; vertices are below it. */
#define SPH__GROUP_END UINT32_C(0x80000000)

/*
 * Two vertices that differ by at most the tolerance in every coordinate of every frame shown are always in one group.
 * With tolerance 0 the converse holds too: a group is equal in every frame shown. Vertices alone are in no group.
 */
typedef struct sph__partition {
    const sph_context *context;
    uint32_t *members; /* vertices of groups of two and more, group after group, in no order within a group */
    uint32_t member_count;
    uint64_t *keys, *scratch; /* for sorting: vertex_count each */
} sph__partition;

/* All n vertices (below 2^31) in one group. Call sph__partition_free after a failure as well. */
sph_status sph__partition_init(sph__partition *partition, const sph_context *context, uint32_t n);
void sph__partition_free(sph__partition *partition);
/* Splits by one frame. Vertices that are not finite there leave their group. Linear where nothing splits, else n log n.
 */
void sph__partition_refine(sph__partition *partition, const float *xyz, double tolerance);
/* The end of the group that begins at members[begin]. */
uint32_t sph__group_end(const sph__partition *partition, uint32_t begin);
/* Sorts `count` keys; `scratch` has room for as many. */
void sph__sort_keys(uint64_t *keys, uint64_t *scratch, size_t count);

#endif
