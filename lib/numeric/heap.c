/* SPDX-License-Identifier: MIT */
#include "numeric/heap.h"

#include <math.h>

/* Four children per node: half the depth of a binary heap. The first child of all begins a cache line, and so all do. */
enum { ARITY = 4, LEAD = 3 };

static bool comes_before_equal(const sph__heap *heap, const sph__heap_entry *a, const sph__heap_entry *b)
{
    uint32_t a_tie, b_tie;
    if (a->key != b->key) { /* a NaN on one side or both */
        const bool a_nan = isnan(a->key), b_nan = isnan(b->key);
        if (a_nan != b_nan) return b_nan;
    }
    if (a->tie != b->tie) return a->tie < b->tie;
    a_tie = heap->ties[a->item];
    b_tie = heap->ties[b->item];
    if (a_tie != b_tie) return a_tie < b_tie;
    return a->item < b->item;
}

static inline bool comes_before(const sph__heap *heap, const sph__heap_entry *a, const sph__heap_entry *b)
{
    if (a->key < b->key) return true;
    if (a->key > b->key) return false;
    return comes_before_equal(heap, a, b);
}

static void put(sph__heap *heap, size_t place, sph__heap_entry entry)
{
    heap->entries[place] = entry;
    heap->places[entry.item] = (uint32_t)place;
}

static void sift_up(sph__heap *heap, size_t place, sph__heap_entry entry)
{
    while (place > 0) {
        const size_t parent = (place - 1) / ARITY;
        if (!comes_before(heap, &entry, &heap->entries[parent])) break;
        put(heap, place, heap->entries[parent]);
        place = parent;
    }
    put(heap, place, entry);
}

/* The first of four siblings: without branches that depend on it, but where keys are equal, or no number. */
static inline size_t first_of_four(const sph__heap *heap, size_t first)
{
    const sph__heap_entry *e = heap->entries + first;
    const size_t a = e[1].key < e[0].key, b = 2 + (e[3].key < e[2].key);
    const size_t best = e[b].key < e[a].key ? b : a;
    size_t equal = 0;
    for (size_t i = 0; i < ARITY; ++i) equal += !(e[best].key < e[i].key);
    if (equal == 1) return first + best;
    for (size_t i = equal = 0; i < ARITY; ++i)
        if (comes_before(heap, &e[i], &e[equal])) equal = i;
    return first + equal;
}

static void sift_down(sph__heap *heap, size_t place, sph__heap_entry entry)
{
    /* Below this place every node has a child. */
    const size_t parent_end = heap->count > 1 ? (heap->count - 2) / ARITY + 1 : 0;
    while (place < parent_end) {
        const size_t first = place * ARITY + 1;
        const size_t end = heap->count - first < ARITY ? heap->count : first + ARITY;
        size_t best = first;
        if ((first + ARITY) * ARITY < heap->count) /* all their children, as one of them is next */
            for (size_t i = 0; i < ARITY; ++i) __builtin_prefetch(&heap->entries[(first + i) * ARITY + 1]);
        if (end - first == ARITY)
            best = first_of_four(heap, first);
        else
            for (size_t child = first + 1; child < end; ++child)
                if (comes_before(heap, &heap->entries[child], &heap->entries[best])) best = child;
        if (!comes_before(heap, &heap->entries[best], &entry)) break;
        put(heap, place, heap->entries[best]);
        place = best;
    }
    put(heap, place, entry);
}

/* Writes `entry` at `place`, whose own entry no longer counts, and moves it to where it belongs. */
static void settle(sph__heap *heap, size_t place, sph__heap_entry entry)
{
    if (place > 0 && comes_before(heap, &entry, &heap->entries[(place - 1) / ARITY]))
        sift_up(heap, place, entry);
    else
        sift_down(heap, place, entry);
}

static sph_status reserve_items(sph__heap *heap, size_t count)
{
    const size_t before = heap->place_capacity;
    if (count <= before) return SPH_OK;
    if (!sph__reserve(heap->context, (void **)&heap->ties, &heap->tie_capacity, count, sizeof *heap->ties) ||
        !sph__reserve(heap->context, (void **)&heap->places, &heap->place_capacity, count, sizeof *heap->places))
        return sph__fail_memory(heap->context);
    for (size_t i = before; i < heap->place_capacity; ++i) heap->places[i] = SPH__HEAP_ABSENT;
    return SPH_OK;
}

static sph_status reserve_entries(sph__heap *heap, size_t count)
{
    void *memory = heap->memory;
    if (count > SIZE_MAX - LEAD) return sph__fail_memory(heap->context);
    if (count + LEAD <= heap->capacity) return SPH_OK;
    if (!sph__reserve(heap->context, &memory, &heap->capacity, count + LEAD, sizeof *heap->memory))
        return sph__fail_memory(heap->context);
    heap->memory = memory;
    heap->entries = heap->memory + LEAD;
    return SPH_OK;
}

void sph__heap_init(sph__heap *heap, sph_context *context)
{
    *heap = (sph__heap){.context = context};
}

void sph__heap_free(sph__heap *heap)
{
    sph__free(heap->context, heap->memory);
    sph__free(heap->context, heap->places);
    sph__free(heap->context, heap->ties);
    sph__heap_init(heap, heap->context);
}

void sph__heap_clear(sph__heap *heap)
{
    for (size_t i = 0; i < heap->count; ++i)
        heap->places[heap->entries[i].item] = SPH__HEAP_ABSENT;
    heap->count = 0;
}

sph_status sph__heap_reserve(sph__heap *heap, size_t item_count)
{
    const sph_status status = reserve_items(heap, item_count);
    return status != SPH_OK ? status : reserve_entries(heap, item_count);
}

sph_status sph__heap_set(sph__heap *heap, uint32_t item, double key, uint64_t tie)
{
    const sph__heap_entry entry = {.key = key, .item = item, .tie = (uint32_t)(tie >> 32)};
    sph_status status;
    if (item == SPH__HEAP_ABSENT) return sph__fail(heap->context, SPH_E_LIMIT, "too many items in a queue");
    if (sph__heap_contains(heap, item)) {
        heap->ties[item] = (uint32_t)tie;
        settle(heap, heap->places[item], entry);
        return SPH_OK;
    }
    if ((status = reserve_items(heap, (size_t)item + 1)) != SPH_OK) return status;
    if ((status = reserve_entries(heap, heap->count + 1)) != SPH_OK) return status;
    heap->ties[item] = (uint32_t)tie;
    sift_up(heap, heap->count++, entry);
    return SPH_OK;
}

void sph__heap_append(sph__heap *heap, uint32_t item, double key, uint64_t tie)
{
    heap->ties[item] = (uint32_t)tie;
    put(heap, heap->count++, (sph__heap_entry){.key = key, .item = item, .tie = (uint32_t)(tie >> 32)});
}

void sph__heap_order(sph__heap *heap)
{
    for (size_t place = heap->count / ARITY + 1; place-- > 0;)
        if (place < heap->count) sift_down(heap, place, heap->entries[place]);
}

bool sph__heap_remove(sph__heap *heap, uint32_t item)
{
    size_t place;
    sph__heap_entry last;
    if (!sph__heap_contains(heap, item)) return false;
    place = heap->places[item];
    heap->places[item] = SPH__HEAP_ABSENT;
    last = heap->entries[--heap->count];
    if (place < heap->count) settle(heap, place, last);
    return true;
}

bool sph__heap_top(const sph__heap *heap, uint32_t *item)
{
    if (heap->count == 0) return false;
    if (item != NULL) *item = heap->entries[0].item;
    return true;
}

bool sph__heap_pop(sph__heap *heap, uint32_t *item)
{
    if (heap->count == 0) return false;
    if (item != NULL) *item = heap->entries[0].item;
    return sph__heap_remove(heap, heap->entries[0].item);
}

/* Makes `place` the i-th of a binary heap of places whose entries below i are in order. */
static void lift_place(const sph__heap *heap, uint32_t *places, size_t i, uint32_t place)
{
    while (i > 0 && comes_before(heap, &heap->entries[place], &heap->entries[places[(i - 1) / 2]])) {
        places[i] = places[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    places[i] = place;
}

static void sink_place(const sph__heap *heap, uint32_t *places, size_t count, uint32_t place)
{
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < count; i = child) {
        if (child + 1 < count && comes_before(heap, &heap->entries[places[child + 1]], &heap->entries[places[child]])) ++child;
        if (!comes_before(heap, &heap->entries[places[child]], &heap->entries[place])) break;
        places[i] = places[child];
    }
    places[i] = place;
}

size_t sph__heap_first(const sph__heap *heap, uint32_t *items, size_t most)
{
    uint32_t places[(ARITY - 1) * SPH__HEAP_FIRST + 1]; /* of the entries that may be next: their parents were found */
    size_t open = heap->count > 0, found = 0;
    if (most > SPH__HEAP_FIRST) most = SPH__HEAP_FIRST;
    for (places[0] = 0; found < most && open > 0; ++found) {
        const uint32_t best = places[0];
        const size_t first = (size_t)best * ARITY + 1;
        items[found] = heap->entries[best].item;
        --open;
        if (open > 0) sink_place(heap, places, open, places[open]);
        for (size_t child = first; child < first + ARITY && child < heap->count; ++child)
            lift_place(heap, places, open++, (uint32_t)child);
    }
    return found;
}

double sph__heap_key(const sph__heap *heap, uint32_t item)
{
    return sph__heap_contains(heap, item) ? heap->entries[heap->places[item]].key : (double)NAN;
}

size_t sph__heap_count(const sph__heap *heap)
{
    return heap->count;
}
