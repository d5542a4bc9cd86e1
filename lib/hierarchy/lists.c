/* SPDX-License-Identifier: MIT */
#include "hierarchy/lists.h"

sph_status sph__lists_init(sph__lists *lists, const sph_context *context, size_t list_count)
{
    *lists = (sph__lists){.context = context, .list_count = list_count};
    for (size_t i = 0; i < sizeof lists->free_heads / sizeof lists->free_heads[0]; ++i) lists->free_heads[i] = SIZE_MAX;
    lists->lists = sph__zalloc(context, list_count, sizeof *lists->lists);
    /* Some arena from the start: empty lists have a place in it, and nothing is added to NULL. */
    if (lists->lists != NULL && sph__reserve(context, (void **)&lists->arena, &lists->capacity, 8, sizeof *lists->arena))
        return SPH_OK;
    sph__lists_free(lists);
    return sph__fail_memory(context);
}

void sph__lists_free(sph__lists *lists)
{
    sph__free(lists->context, lists->arena);
    sph__free(lists->context, lists->lists);
    *lists = (sph__lists){0};
}

/* A free block holds the offset of the next in its first two items. */
static void set_link(uint32_t *block, size_t next)
{
    block[0] = (uint32_t)next;
    block[1] = (uint32_t)((uint64_t)next >> 32);
}

static size_t get_link(const uint32_t *block)
{
    return (size_t)(block[0] | (uint64_t)block[1] << 32);
}

static unsigned log2_of(uint32_t power)
{
    return (unsigned)__builtin_ctz(power);
}

static sph_status take_block(sph__lists *lists, uint32_t capacity, size_t *offset)
{
    size_t *head = &lists->free_heads[log2_of(capacity)];
    if (*head != SIZE_MAX) {
        *offset = *head;
        *head = get_link(lists->arena + *offset);
        return SPH_OK;
    }
    if (!sph__reserve(lists->context, (void **)&lists->arena, &lists->capacity, lists->used + capacity,
                      sizeof *lists->arena))
        return sph__fail_memory(lists->context);
    *offset = lists->used;
    lists->used += capacity;
    return SPH_OK;
}

static void give_block(sph__lists *lists, size_t offset, uint32_t capacity)
{
    size_t *head = &lists->free_heads[log2_of(capacity)];
    set_link(lists->arena + offset, *head);
    *head = offset;
}

static uint32_t capacity_for(uint32_t count)
{
    uint32_t capacity = 8;
    while (capacity < count) capacity *= 2;
    return capacity;
}

sph_status sph__lists_lay_out(sph__lists *lists, const uint32_t *counts, size_t count)
{
    size_t total = lists->used;
    for (size_t i = 0; i < count; ++i) {
        if (counts[i] > UINT32_C(1) << 31) return sph__fail_memory(lists->context);
        if (counts[i] > 0) total += capacity_for(counts[i]);
    }
    if (!sph__reserve(lists->context, (void **)&lists->arena, &lists->capacity, total, sizeof *lists->arena))
        return sph__fail_memory(lists->context);
    for (size_t i = 0; i < count; ++i) {
        if (counts[i] == 0) continue;
        lists->lists[i] = (sph__list){.offset = lists->used, .capacity = capacity_for(counts[i])};
        lists->used += lists->lists[i].capacity;
    }
    return SPH_OK;
}

sph_status sph__list_reserve(sph__lists *lists, uint32_t list, uint32_t count)
{
    sph__list *l = &lists->lists[list];
    size_t offset = 0;
    uint32_t capacity;
    sph_status status;
    if (count <= l->capacity) return SPH_OK;
    if (count > UINT32_C(1) << 31) return sph__fail_memory(lists->context);
    capacity = capacity_for(count);
    status = take_block(lists, capacity, &offset);
    if (status != SPH_OK) return status;
    if (l->capacity != 0) {
        memcpy(lists->arena + offset, lists->arena + l->offset, l->count * sizeof *lists->arena);
        give_block(lists, l->offset, l->capacity);
    }
    l->offset = offset;
    l->capacity = capacity;
    return SPH_OK;
}

sph_status sph__list_add(sph__lists *lists, uint32_t list, uint32_t item)
{
    sph__list *l = &lists->lists[list];
    if (l->count == l->capacity) {
        const sph_status status = sph__list_reserve(lists, list, l->count + 1);
        if (status != SPH_OK) return status;
    }
    lists->arena[l->offset + l->count++] = item;
    return SPH_OK;
}

void sph__list_remove(sph__lists *lists, uint32_t list, uint32_t item)
{
    sph__list *l = &lists->lists[list];
    uint32_t *items = lists->arena + l->offset;
    for (uint32_t i = 0; i < l->count; ++i)
        if (items[i] == item) {
            items[i] = items[--l->count];
            return;
        }
}

void sph__list_drop(sph__lists *lists, uint32_t list)
{
    sph__list *l = &lists->lists[list];
    if (l->capacity != 0) give_block(lists, l->offset, l->capacity);
    *l = (sph__list){0};
}
