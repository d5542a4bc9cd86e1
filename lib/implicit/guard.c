/* SPDX-License-Identifier: MIT */
/*
 * Intersections that the correction would make are taken back: nodes of such triangles go back part of their way, as
 * often as it takes, and if nothing helps all the way.
 */
#include <math.h>

#include "implicit/tracker.h"

enum { BLOCK = SPH__IMPLICIT_BLOCK, TRIANGLE_BLOCK = 4096, ROUNDS = 8 };

/* What is kept of the way after each round in which a node is at fault. */
static const float KEEP = 0.6f, LEAST_KEPT = 0.2f;

static const float *place(sph__track *t, size_t node, int when)
{
    return t->places[when] + 3 * node;
}

/* Where nodes are, as floats: what is written. */
static void write_places(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const size_t n = b->tracker->shell.node_count;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        if (!t->guarding) continue;
        for (size_t i = first; i < n && i < first + BLOCK; ++i)
            for (int c = 0; c < 3; ++c) {
                const double base = t->base[c][i], way = t->at[c][i] - base;
                t->places[0][3 * i + c] = (float)base;
                t->places[1][3 * i + c] =
                    t->kept[i] < 1 ? (float)(base + (double)t->kept[i] * way) : (float)t->at[c][i];
            }
    }
}

static bool has_moved(sph__track *t, uint32_t node)
{
    const float *p = place(t, node, 0), *q = place(t, node, 1);
    return p[0] < q[0] || p[0] > q[0] || p[1] < q[1] || p[1] > q[1] || p[2] < q[2] || p[2] > q[2];
}

/* Triangles that have moved in the first place stay marked, so that the counts are of the same pairs. */
static void mark_triangles(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * TRIANGLE_BLOCK;
        for (size_t i = first; t->guarding && i < s->triangle_count && i < first + TRIANGLE_BLOCK; ++i)
            t->marks[i] = has_moved(t, s->triangles[3 * i]) || has_moved(t, s->triangles[3 * i + 1]) ||
                          has_moved(t, s->triangles[3 * i + 2]);
    }
}

static void box_triangles(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const size_t count = b->tracker->shell.triangle_count;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * TRIANGLE_BLOCK;
        if (!t->guarding) continue;
        t->search.positions = t->places[b->round];
        sph__intersector_box(&t->search, first, count - first < TRIANGLE_BLOCK ? count : first + TRIANGLE_BLOCK);
    }
}

static void refit_trees(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    for (size_t i = begin; i < end; ++i)
        if (b->tracker->tracks[i].guarding) sph__intersector_refit(&b->tracker->tracks[i].search);
}

static void search_leaves(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        if (t->guarding) sph__intersector_search(&t->search, item % b->blocks, item % b->blocks + 1);
    }
}

static void run(sph__batch *b, size_t blocks, sph_range_fn *body)
{
    b->blocks = blocks;
    sph__parallel_for(b->tracker->context, b->count * blocks, 1, body, b);
}

/* Pairs of poses 0 (before) or 1 (after). */
static sph_status search(sph_tracker *tracker, size_t count, uint32_t when)
{
    sph__batch b = {.tracker = tracker, .count = count, .round = when};
    run(&b, (tracker->shell.triangle_count + TRIANGLE_BLOCK - 1) / TRIANGLE_BLOCK, box_triangles);
    run(&b, 1, refit_trees);
    run(&b, tracker->tracks[0].search.block_count, search_leaves);
    for (size_t i = 0; i < count; ++i) {
        const sph__track *t = tracker->tracks + i;
        for (uint32_t k = 0; t->guarding && k < t->search.block_count; ++k)
            if (t->search.lists[k].out_of_memory) return sph__fail_memory(tracker->context);
    }
    return SPH_OK;
}

static size_t count_pairs(const sph__track *t)
{
    size_t count = 0;
    for (uint32_t k = 0; k < t->search.block_count; ++k)
        count += t->search.lists[k].count;
    return count;
}

/* The pairs of before, in order, so that others can be looked up. */
static sph_status keep_before(sph_tracker *tracker, sph__track *t)
{
    const size_t count = count_pairs(t);
    void *pairs = t->before;
    size_t at = 0;
    if (!sph__reserve(tracker->context, &pairs, &t->before_capacity, count, sizeof *t->before))
        return sph__fail_memory(tracker->context);
    t->before = pairs;
    for (uint32_t k = 0; k < t->search.block_count; ++k)
        for (size_t i = 0; i < t->search.lists[k].count; ++i)
            t->before[at++] = t->search.lists[k].items[i];
    t->before_count = count;
    for (size_t gap = count / 2; gap > 0; gap /= 2) /* by Shell; there are few */
        for (size_t i = gap; i < count; ++i) {
            const uint64_t held = t->before[i];
            size_t k = i;
            for (; k >= gap && t->before[k - gap] > held; k -= gap)
                t->before[k] = t->before[k - gap];
            t->before[k] = held;
        }
    return SPH_OK;
}

static bool was_before(const sph__track *t, uint64_t pair)
{
    size_t low = 0, high = t->before_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (t->before[middle] < pair)
            low = middle + 1;
        else
            high = middle;
    }
    return low < t->before_count && t->before[low] == pair;
}

/* New pairs: their nodes go back. Returns how many there are. */
static size_t take_back(const sph_tracker *tracker, sph__track *t)
{
    const sph__shell *s = &tracker->shell;
    size_t fresh = 0;
    memset(t->state, 0, s->node_count); /* from now on: whether a node is at fault in this round */
    for (uint32_t k = 0; k < t->search.block_count; ++k)
        for (size_t i = 0; i < t->search.lists[k].count; ++i) {
            const uint64_t pair = t->search.lists[k].items[i];
            if (was_before(t, pair)) continue;
            ++fresh;
            for (int c = 0; c < 6; ++c)
                t->state[s->triangles[3 * (size_t)(c < 3 ? pair >> 32 : pair & UINT32_MAX) + c % 3]] = 1;
        }
    for (size_t i = 0; i < s->node_count; ++i)
        if (t->state[i]) t->kept[i] = t->kept[i] * KEEP < LEAST_KEPT ? 0 : t->kept[i] * KEEP;
    return fresh;
}

static void finish(const sph_tracker *tracker, sph__track *t, bool give_up)
{
    for (size_t i = 0; i < tracker->shell.node_count; ++i) {
        if (give_up) t->kept[i] = 0;
        t->report.held_back += t->kept[i] < 1;
        for (int c = 0; c < 3; ++c)
            t->at[c][i] =
                t->kept[i] < 1 ? t->base[c][i] + (double)t->kept[i] * (t->at[c][i] - t->base[c][i]) : t->at[c][i];
    }
    t->report.pairs_before = t->before_count;
    t->report.pairs_after = give_up ? t->before_count : t->after_count;
    t->guarding = false;
}

sph_status sph__guard(sph_tracker *tracker, size_t count)
{
    const size_t node_blocks = tracker->block_count;
    sph__batch b = {.tracker = tracker, .count = count};
    sph_status status;
    size_t left = count;
    for (size_t i = 0; i < count; ++i) {
        sph__track *t = tracker->tracks + i;
        t->guarding = true;
        for (size_t k = 0; k < tracker->shell.node_count; ++k)
            t->kept[k] = 1;
    }
    run(&b, node_blocks, write_places);
    run(&b, (tracker->shell.triangle_count + TRIANGLE_BLOCK - 1) / TRIANGLE_BLOCK, mark_triangles);
    status = search(tracker, count, 0);
    for (size_t i = 0; i < count && status == SPH_OK; ++i)
        status = keep_before(tracker, tracker->tracks + i);
    for (int round = 0; round <= ROUNDS && left > 0 && status == SPH_OK; ++round) {
        if (round > 0) run(&b, node_blocks, write_places);
        status = search(tracker, count, 1);
        for (size_t i = 0; i < count && status == SPH_OK; ++i) {
            sph__track *t = tracker->tracks + i;
            if (!t->guarding) continue;
            t->after_count = count_pairs(t);
            if (round < ROUNDS && take_back(tracker, t) > 0) continue;
            finish(tracker, t, t->after_count > t->before_count);
            --left;
        }
    }
    return status;
}
