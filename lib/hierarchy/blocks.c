/* SPDX-License-Identifier: MIT */
#include "hierarchy/blocks.h"

#include "hierarchy/build.h"

/* Slabs are so many bytes, for inputs small and large; where blocks are larger, they hold a few. */
enum { LEAST_BYTES = 1 << 18, MOST_BYTES = 1 << 21, PARTS = 256, FEWEST = 4 };

static size_t padded(size_t size)
{
    return (size + 15) / 16 * 16;
}

void sph__slabs_init(sph__slabs *slabs, const sph_context *context, size_t size, size_t most)
{
    const size_t block = padded(size) * sizeof(float), part = most * (block / PARTS);
    size_t count = (part < LEAST_BYTES ? LEAST_BYTES : part > MOST_BYTES ? MOST_BYTES : part) / block;
    if (count > most) count = most;
    *slabs = (sph__slabs){.context = context, .size = (count < FEWEST ? FEWEST : count) * padded(size)};
}

void sph__slabs_free(sph__slabs *slabs)
{
    while (slabs->spare_count > 0) sph__free(slabs->context, slabs->spare[--slabs->spare_count]);
}

static float *take_slab(sph__slabs *slabs)
{
    if (slabs->spare_count > 0) return slabs->spare[--slabs->spare_count];
    return sph__alloc(slabs->context, slabs->size, sizeof(float));
}

static void give_slab(sph__slabs *slabs, float *slab)
{
    if (slabs->spare_count < sizeof slabs->spare / sizeof slabs->spare[0])
        slabs->spare[slabs->spare_count++] = slab;
    else
        sph__free(slabs->context, slab);
}

void sph__blocks_init(sph__blocks *blocks, sph__slabs *source, sph__slot *slots, size_t size)
{
    *blocks = (sph__blocks){.source = source, .slots = slots, .size = padded(size)};
    blocks->per_slab = source->size / blocks->size;
}

void sph__blocks_free(sph__blocks *blocks)
{
    const sph_context *context = blocks->source->context;
    for (size_t i = 0; i < blocks->slab_count; ++i) sph__free(context, blocks->slabs[i]);
    sph__free(context, blocks->slabs);
    sph__free(context, blocks->owners);
    *blocks = (sph__blocks){0};
}

static float *block_at(const sph__blocks *blocks, size_t place)
{
    return blocks->slabs[place / blocks->per_slab] + place % blocks->per_slab * blocks->size;
}

static void own(sph__blocks *blocks, size_t place, uint32_t slot)
{
    blocks->owners[place] = slot;
    blocks->slots[slot].place = (uint32_t)place;
    blocks->slots[slot].block = block_at(blocks, place);
}

bool sph__blocks_take(sph__blocks *blocks, uint32_t slot)
{
    const sph_context *context = blocks->source->context;
    if (!sph__reserve(context, (void **)&blocks->owners, &blocks->owner_capacity, blocks->count + 1,
                      sizeof *blocks->owners))
        return false;
    if (blocks->count / blocks->per_slab == blocks->slab_count) {
        float *slab;
        if (!sph__reserve(context, (void **)&blocks->slabs, &blocks->slab_capacity, blocks->slab_count + 1,
                          sizeof *blocks->slabs))
            return false;
        slab = take_slab(blocks->source);
        if (slab == NULL) return false;
        blocks->slabs[blocks->slab_count++] = slab;
    }
    own(blocks, blocks->count++, slot);
    return true;
}

void sph__blocks_give(sph__blocks *blocks, uint32_t slot)
{
    const size_t place = blocks->slots[slot].place, last = --blocks->count;
    blocks->slots[slot].block = NULL;
    if (place != last) {
        memcpy(block_at(blocks, place), block_at(blocks, last), blocks->size * sizeof(float));
        own(blocks, place, blocks->owners[last]);
    }
    /* One empty slab stays: what goes may come again. */
    if (last / blocks->per_slab + 2 < blocks->slab_count) give_slab(blocks->source, blocks->slabs[--blocks->slab_count]);
}

void sph__blocks_pass(sph__blocks *blocks, uint32_t from, uint32_t to)
{
    const size_t place = blocks->slots[from].place;
    blocks->slots[from].block = NULL;
    own(blocks, place, to);
}

size_t sph__blocks_bytes(const sph__blocks *blocks)
{
    return blocks->slab_count * blocks->source->size * sizeof(float);
}
