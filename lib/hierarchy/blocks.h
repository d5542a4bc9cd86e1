/* SPDX-License-Identifier: MIT */
/* The blocks of quadrics: of regions that collapses have made, and of as many leaves as there is room for. */
#ifndef SPH_HIERARCHY_BLOCKS_H
#define SPH_HIERARCHY_BLOCKS_H

#include "base/base.h"

struct sph__slot;

/* Memory that blocks of one kind have given back, for those of another. */
typedef struct sph__slabs {
    const sph_context *context;
    size_t size; /* floats of each */
    float *spare[2];
    size_t spare_count;
} sph__slabs;

/* `size`: floats of the largest block; `most`: blocks of that size that there may be. */
void sph__slabs_init(sph__slabs *slabs, const sph_context *context, size_t size, size_t most);
void sph__slabs_free(sph__slabs *slabs);

/* Blocks of floats of one size, each owned by a slot, packed: when one goes, the last takes its place. */
typedef struct sph__blocks {
    sph__slabs *source;
    struct sph__slot *slots; /* of the owners */
    size_t size;             /* floats per block */
    size_t per_slab;         /* blocks */
    float **slabs;
    size_t slab_count, slab_capacity;
    uint32_t *owners;
    size_t count, owner_capacity;
} sph__blocks;

void sph__blocks_init(sph__blocks *blocks, sph__slabs *source, struct sph__slot *slots, size_t size);
void sph__blocks_free(sph__blocks *blocks);
/* Gives the slot a block of undefined content; false when out of memory. */
bool sph__blocks_take(sph__blocks *blocks, uint32_t slot);
/* Takes the slot's block away. */
void sph__blocks_give(sph__blocks *blocks, uint32_t slot);
/* The block now belongs to another slot. */
void sph__blocks_pass(sph__blocks *blocks, uint32_t from, uint32_t to);
/* Bytes taken from the allocator for blocks. */
size_t sph__blocks_bytes(const sph__blocks *blocks);

#endif
