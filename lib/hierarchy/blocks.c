/* SPDX-License-Identifier: MIT */
#include "hierarchy/build.h"

enum { SLAB_BLOCKS = 64 };

void sph__blocks_init(sph__blocks *blocks, const sph_context *context, size_t size)
{
    *blocks = (sph__blocks){.context = context, .size = (size + 15) / 16 * 16, .used = SLAB_BLOCKS};
}

void sph__blocks_free(sph__blocks *blocks)
{
    for (size_t i = 0; i < blocks->slab_count; ++i) sph__free(blocks->context, blocks->slabs[i]);
    sph__free(blocks->context, blocks->slabs);
    *blocks = (sph__blocks){0};
}

float *sph__blocks_take(sph__blocks *blocks)
{
    float *block = blocks->free_head;
    if (block != NULL) {
        memcpy(&blocks->free_head, block, sizeof blocks->free_head);
        return block;
    }
    if (blocks->used == SLAB_BLOCKS) {
        if (!sph__reserve(blocks->context, (void **)&blocks->slabs, &blocks->slab_capacity, blocks->slab_count + 1,
                          sizeof *blocks->slabs))
            return NULL;
        block = sph__alloc(blocks->context, SLAB_BLOCKS, blocks->size * sizeof(float));
        if (block == NULL) return NULL;
        blocks->slabs[blocks->slab_count++] = block;
        blocks->used = 0;
    }
    return blocks->slabs[blocks->slab_count - 1] + blocks->size * blocks->used++;
}

void sph__blocks_give(sph__blocks *blocks, float *block)
{
    memcpy(block, &blocks->free_head, sizeof blocks->free_head);
    blocks->free_head = block;
}
