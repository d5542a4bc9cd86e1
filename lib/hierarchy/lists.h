/* SPDX-License-Identifier: MIT */
/* Many short lists of integers in one arena, recycled by size. */
#ifndef SPH_HIERARCHY_LISTS_H
#define SPH_HIERARCHY_LISTS_H

#include "base/base.h"

/* Zeros: an empty list. */
typedef struct sph__list {
    uint32_t place;                /* in the arena, in steps of SPH__LIST_STEP items */
    uint32_t count : 27, size : 5; /* there is room for SPH__LIST_STEP << (size - 1) items; 0: for none */
} sph__list;

/* Items of a list at most; and its sizes. */
enum { SPH__LIST_STEP = 8, SPH__LIST_MOST = 1 << 26, SPH__LIST_SIZES = 24 };

/* The arena. */
typedef struct sph__lists {
    const sph_context *context;
    uint32_t *arena;
    size_t used, capacity;                 /* in steps */
    uint32_t heads[SPH__LIST_SIZES + 1]; /* by size: free room; UINT32_MAX: none */
} sph__lists;

/* `steps`: room that will be needed in all, more or less. */
sph_status sph__lists_init(sph__lists *lists, const sph_context *context, size_t steps);
void sph__lists_free(sph__lists *lists);

/* Valid until the next call that adds to any list. */
static inline uint32_t *sph__list_items(const sph__lists *lists, const sph__list *list)
{
    return lists->arena + (size_t)list->place * SPH__LIST_STEP;
}

/* Steps of room for so many items. */
static inline size_t sph__list_steps(size_t count)
{
    size_t steps = count > 0;
    while (steps * SPH__LIST_STEP < count) steps *= 2;
    return steps;
}

/* Makes room for `count` items in all; SPH_E_NOMEM leaves the list as it was. */
sph_status sph__list_reserve(sph__lists *lists, sph__list *list, size_t count);
/* Adds one item where there is room for it. */
static inline void sph__list_put(const sph__lists *lists, sph__list *list, uint32_t item)
{
    sph__list_items(lists, list)[list->count++] = item;
}
/* Adds one item; SPH_E_NOMEM leaves the list as it was. */
static inline sph_status sph__list_add(sph__lists *lists, sph__list *list, uint32_t item)
{
    const bool full = list->count % SPH__LIST_STEP == 0; /* perhaps */
    const sph_status status = full ? sph__list_reserve(lists, list, (size_t)list->count + 1) : SPH_OK;
    if (status == SPH_OK) sph__list_put(lists, list, item);
    return status;
}
/* Removes the first occurrence, the last item takes its place. */
void sph__list_remove(const sph__lists *lists, sph__list *list, uint32_t item);
/* Empties the list and gives its room back. */
void sph__list_drop(sph__lists *lists, sph__list *list);

#endif
