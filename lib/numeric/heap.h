/* SPDX-License-Identifier: MIT */
/* A priority queue of small integers whose keys may change: the smallest key is on top. */
#ifndef SPH_NUMERIC_HEAP_H
#define SPH_NUMERIC_HEAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/base.h"

/* Four of them are a cache line. */
typedef struct sph__heap_entry {
    double key;
    uint32_t item;
    uint32_t tie; /* the upper half of it */
} sph__heap_entry;

/*
 * Order: by key, equal keys by tie, equal ties by item; so what comes out never depends on what went in first.
 * -0 equals 0; a NaN key comes after all others, infinity included. Memory grows with the largest item ever seen.
 */
typedef struct sph__heap {
    sph_context *context; /* borrowed: outlives the heap */
    sph__heap_entry *memory, *entries; /* entries begin within `memory` so that siblings share a cache line */
    size_t count, capacity;
    uint32_t *places; /* of an item in `entries`, or SPH__HEAP_ABSENT */
    uint32_t *ties;   /* lower halves, of items: read where all else is equal */
    size_t place_capacity, tie_capacity;
} sph__heap;

#define SPH__HEAP_ABSENT UINT32_MAX

void sph__heap_init(sph__heap *heap, sph_context *context);
/* Gives back the memory; the heap may be used again. A zeroed heap is fine. */
void sph__heap_free(sph__heap *heap);
/* Removes everything and keeps the memory. */
void sph__heap_clear(sph__heap *heap);

/* Makes room, so that sph__heap_set cannot fail for items below `item_count`. */
sph_status sph__heap_reserve(sph__heap *heap, size_t item_count);
/* Inserts `item`, or changes its key and tie. On failure (out of memory; item UINT32_MAX) the heap is unchanged. */
sph_status sph__heap_set(sph__heap *heap, uint32_t item, double key, uint64_t tie);
/* Many at once: items that are not in the heap, below what room was made for; and after the last of them, the order. */
void sph__heap_append(sph__heap *heap, uint32_t item, double key, uint64_t tie);
void sph__heap_order(sph__heap *heap);
/* False if `item` is not in the heap. */
bool sph__heap_remove(sph__heap *heap, uint32_t item);
/* The first item into *item, which may be NULL; false, and *item untouched, where the heap is empty. */
bool sph__heap_top(const sph__heap *heap, uint32_t *item);
/* The same, and removes it. */
bool sph__heap_pop(sph__heap *heap, uint32_t *item);

/* The first `most` items in their order, at most SPH__HEAP_FIRST; returns how many. */
enum { SPH__HEAP_FIRST = 128 };
size_t sph__heap_first(const sph__heap *heap, uint32_t *items, size_t most);

static inline bool sph__heap_contains(const sph__heap *heap, uint32_t item)
{
    return item < heap->place_capacity && heap->places[item] != SPH__HEAP_ABSENT;
}

/* Asks for what a change of `item` will read: what is known of it, and once that is there, its place in the queue. */
static inline void sph__heap_prefetch_item(const sph__heap *heap, uint32_t item)
{
    if (item < heap->place_capacity) __builtin_prefetch(&heap->places[item], 1);
}

static inline void sph__heap_prefetch_place(const sph__heap *heap, uint32_t item)
{
    size_t place;
    if (!sph__heap_contains(heap, item)) return;
    place = heap->places[item];
    __builtin_prefetch(&heap->entries[place]);
    if (place > 0) __builtin_prefetch(&heap->entries[(place - 1) / 4]);
    if (4 * place + 1 < heap->count) __builtin_prefetch(&heap->entries[4 * place + 1]);
}

/* NaN where `item` is not in the heap. */
double sph__heap_key(const sph__heap *heap, uint32_t item);
size_t sph__heap_count(const sph__heap *heap);

#endif
