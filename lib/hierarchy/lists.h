/* SPDX-License-Identifier: MIT */
/* Many short lists of integers in one arena, recycled by size. */
#ifndef SPH_HIERARCHY_LISTS_H
#define SPH_HIERARCHY_LISTS_H

#include "base/base.h"

typedef struct sph__list {
    size_t offset;
    uint32_t count, capacity; /* a power of two, or 0 */
} sph__list;

typedef struct sph__lists {
    const sph_context *context;
    uint32_t *arena;
    size_t used, capacity;
    size_t free_heads[33]; /* by log2 of the capacity; SIZE_MAX: none */
    sph__list *lists;
    size_t list_count;
} sph__lists;

sph_status sph__lists_init(sph__lists *lists, const sph_context *context, size_t list_count);
void sph__lists_free(sph__lists *lists);

/* Valid until the next call that adds to any list. */
static inline uint32_t *sph__list_items(const sph__lists *lists, uint32_t list)
{
    return lists->arena + lists->lists[list].offset;
}

static inline uint32_t sph__list_count(const sph__lists *lists, uint32_t list)
{
    return lists->lists[list].count;
}

/* Makes room in the first `count` lists, all still empty, side by side: for so many items in each. */
sph_status sph__lists_lay_out(sph__lists *lists, const uint32_t *counts, size_t count);
/* Makes room for `count` items in all. */
sph_status sph__list_reserve(sph__lists *lists, uint32_t list, uint32_t count);
/* Adds one item; SPH_E_NOMEM leaves the list as it was. */
sph_status sph__list_add(sph__lists *lists, uint32_t list, uint32_t item);
/* Removes the first occurrence, the last item takes its place. */
void sph__list_remove(sph__lists *lists, uint32_t list, uint32_t item);
/* Empties the list and gives its room back. */
void sph__list_drop(sph__lists *lists, uint32_t list);

#endif
