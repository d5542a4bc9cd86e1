/* SPDX-License-Identifier: MIT */
#include "hierarchy/lists.h"

sph_status sph__lists_init(sph__lists *lists, const sph_context *context, size_t steps)
{
    const size_t size = SPH__LIST_STEP * sizeof *lists->arena;
    *lists = (sph__lists){.context = context};
    for (size_t i = 0; i <= SPH__LIST_SIZES; ++i) lists->heads[i] = UINT32_MAX;
    /* Some arena from the start: empty lists have a place in it, and nothing is added to NULL. */
    if (sph__reserve(context, (void **)&lists->arena, &lists->capacity, steps + 1, size)) return SPH_OK;
    return sph__fail_memory(context);
}

void sph__lists_free(sph__lists *lists)
{
    if (lists->context != NULL) sph__free(lists->context, lists->arena);
    *lists = (sph__lists){0};
}

static unsigned size_of(size_t steps)
{
    return (unsigned)__builtin_ctzll(steps) + 1;
}

/* Free room begins with the place of the next of its size. */
static sph_status take_room(sph__lists *lists, size_t steps, uint32_t *place)
{
    uint32_t *head = &lists->heads[size_of(steps)];
    if (*head != UINT32_MAX) {
        *place = *head;
        *head = lists->arena[(size_t)*place * SPH__LIST_STEP];
        return SPH_OK;
    }
    if (lists->used > UINT32_MAX - steps || !sph__reserve(lists->context, (void **)&lists->arena, &lists->capacity,
                                                          lists->used + steps, SPH__LIST_STEP * sizeof *lists->arena))
        return sph__fail_memory(lists->context);
    *place = (uint32_t)lists->used;
    lists->used += steps;
    return SPH_OK;
}

static void give_room(sph__lists *lists, const sph__list *list)
{
    if (list->size == 0) return;
    *sph__list_items(lists, list) = lists->heads[list->size];
    lists->heads[list->size] = list->place;
}

sph_status sph__list_reserve(sph__lists *lists, sph__list *list, size_t count)
{
    const size_t steps = sph__list_steps(count);
    sph__list moved = *list;
    sph_status status;
    if (steps == 0 || (list->size > 0 && steps <= (size_t)1 << (list->size - 1))) return SPH_OK;
    if (count > SPH__LIST_MOST) return sph__fail_memory(lists->context);
    status = take_room(lists, steps, &moved.place);
    if (status != SPH_OK) return status;
    moved.size = size_of(steps);
    memcpy(sph__list_items(lists, &moved), sph__list_items(lists, list), list->count * sizeof *lists->arena);
    give_room(lists, list);
    *list = moved;
    return SPH_OK;
}

void sph__list_remove(const sph__lists *lists, sph__list *list, uint32_t item)
{
    uint32_t *items = sph__list_items(lists, list);
    for (uint32_t i = 0; i < list->count; ++i)
        if (items[i] == item) {
            items[i] = items[--list->count];
            return;
        }
}

void sph__list_drop(sph__lists *lists, sph__list *list)
{
    give_room(lists, list);
    *list = (sph__list){0};
}
