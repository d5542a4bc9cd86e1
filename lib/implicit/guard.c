/* SPDX-License-Identifier: MIT */
/*
 * Intersections that the correction would make are taken back: nodes of such triangles go back part of their way, as
 * often as it takes, and if nothing helps all the way.
 */
#include <math.h>

#include "implicit/tracker.h"
#include "numeric/predicate.h"

enum { BLOCK = SPH__IMPLICIT_BLOCK, TRIANGLE_BLOCK = 4096, ROUNDS = 24, GENTLE_ROUNDS = 5 };

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

/* Round 0: triangles that have moved; later ones: those of nodes that were at fault. */
static void mark_triangles(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * TRIANGLE_BLOCK;
        for (size_t i = first; t->guarding && i < s->triangle_count && i < first + TRIANGLE_BLOCK; ++i) {
            const uint32_t *corner = s->triangles + 3 * i;
            if (b->round == 0)
                t->moved[i] = has_moved(t, corner[0]) || has_moved(t, corner[1]) || has_moved(t, corner[2]);
            t->marks[i] = t->moved[i] != 0 &&
                          (b->round == 0 || (t->state[corner[0]] | t->state[corner[1]] | t->state[corner[2]]) != 0);
        }
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
        t->search.positions = t->places[1];
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

static void search_all(void *argument, size_t begin, size_t end)
{
    sph__intersector_search(argument, begin, end);
}

static void run(sph__batch *b, size_t blocks, sph_range_fn *body)
{
    b->blocks = blocks;
    sph__parallel_for(b->tracker->context, b->count * blocks, 1, body, b);
}

/* Pairs of marked triangles: they take the place of those that were known of them. */
static void take_pairs(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph_context *context = b->tracker->context;
    for (size_t i = begin; i < end; ++i) {
        sph__track *t = b->tracker->tracks + i;
        size_t count = 0;
        if (!t->guarding) continue;
        for (size_t k = 0; k < t->now.count; ++k)
            if (!t->marks[t->now.items[k] >> 32] && !t->marks[t->now.items[k] & UINT32_MAX])
                t->now.items[count++] = t->now.items[k];
        t->now.count = count;
        for (uint32_t k = 0; k < t->search.block_count; ++k) {
            const sph__pairs *list = t->search.lists + k;
            void *items = t->now.items;
            t->now.out_of_memory = t->now.out_of_memory || list->out_of_memory;
            if (list->count == 0 || t->now.out_of_memory) continue;
            if (!sph__reserve(context, &items, &t->now.capacity, t->now.count + list->count, sizeof *t->now.items)) {
                t->now.out_of_memory = true;
                continue;
            }
            t->now.items = items;
            memcpy(t->now.items + t->now.count, list->items, list->count * sizeof *list->items);
            t->now.count += list->count;
        }
    }
}

/* The pairs of where nodes are now. */
static sph_status search(sph__batch *b)
{
    const sph_tracker *tracker = b->tracker;
    const size_t blocks = (tracker->shell.triangle_count + TRIANGLE_BLOCK - 1) / TRIANGLE_BLOCK;
    run(b, tracker->block_count, write_places);
    run(b, blocks, mark_triangles);
    run(b, blocks, box_triangles);
    run(b, 1, refit_trees);
    run(b, tracker->tracks[0].search.block_count, search_leaves);
    run(b, 1, take_pairs);
    for (size_t i = 0; i < b->count; ++i)
        if (tracker->tracks[i].now.out_of_memory) return sph__fail_memory(tracker->context);
    return SPH_OK;
}

static bool was_before(const sph_tracker *tracker, const sph__track *t, uint64_t pair)
{
    const uint32_t *corners = tracker->shell.triangles;
    const float *p[2][3];
    for (size_t i = 0; i < 6; ++i)
        p[i / 3][i % 3] = t->places[0] + 3 * (size_t)corners[3 * (i < 3 ? pair >> 32 : pair & UINT32_MAX) + i % 3];
    return sph__triangles_meet(p[0], p[1]);
}

/* Nodes of new pairs are at fault: they go back. */
static void take_back(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    const bool gentle = b->round < GENTLE_ROUNDS;
    for (size_t i = begin; i < end; ++i) {
        sph__track *t = b->tracker->tracks + i;
        if (!t->guarding) continue;
        t->fresh = 0;
        memset(t->state, 0, s->node_count); /* from now on: whether a node is at fault in this round */
        for (size_t k = 0; k < t->now.count; ++k) {
            const uint64_t pair = t->now.items[k];
            if (was_before(b->tracker, t, pair)) continue;
            ++t->fresh;
            for (size_t c = 0; c < 6; ++c)
                t->state[s->triangles[3 * (size_t)(c < 3 ? pair >> 32 : pair & UINT32_MAX) + c % 3]] = 1;
        }
        if (b->round == 0 || t->now.count < t->best_count) {
            t->best_count = t->now.count;
            t->best_fresh = t->fresh;
            memcpy(t->best, t->kept, s->node_count * sizeof *t->best);
        }
        for (size_t k = 0; k < s->node_count; ++k)
            if (t->state[k]) t->kept[k] = gentle && t->kept[k] * KEEP >= LEAST_KEPT ? t->kept[k] * KEEP : 0;
        if (t->fresh == 0) t->guarding = false;
    }
}

/* Pairs, one of them a triangle that has moved, as blending has them. */
static sph_status count_before(sph_tracker *tracker, sph__track *t, size_t *count)
{
    const sph__shell *s = &tracker->shell;
    *count = 0;
    memcpy(t->marks, t->moved, s->triangle_count);
    t->search.positions = t->places[0];
    sph__intersector_box(&t->search, 0, s->triangle_count);
    sph__intersector_refit(&t->search);
    sph__parallel_for(tracker->context, t->search.block_count, 1, search_all, &t->search);
    for (uint32_t k = 0; k < t->search.block_count; ++k) {
        if (t->search.lists[k].out_of_memory) return sph__fail_memory(tracker->context);
        *count += t->search.lists[k].count;
    }
    return SPH_OK;
}

static void finish(const sph_tracker *tracker, sph__track *t, bool give_up)
{
    for (size_t i = 0; i < tracker->shell.node_count; ++i) {
        const float kept = give_up ? 0 : t->best[i];
        t->report.held_back += kept < 1;
        for (int c = 0; c < 3 && kept < 1; ++c)
            t->at[c][i] = t->base[c][i] + (double)kept * (t->at[c][i] - t->base[c][i]);
    }
}

sph_status sph__guard(sph_tracker *tracker, size_t count)
{
    sph__batch b = {.tracker = tracker, .count = count};
    sph_status status = SPH_OK;
    bool any = true;
    for (size_t i = 0; i < count; ++i) {
        sph__track *t = tracker->tracks + i;
        t->guarding = true;
        t->now.count = 0;
        t->now.out_of_memory = false;
        for (size_t k = 0; k < tracker->shell.node_count; ++k)
            t->kept[k] = 1;
    }
    for (b.round = 0; b.round <= ROUNDS && any && status == SPH_OK; ++b.round) {
        status = search(&b);
        if (status == SPH_OK) run(&b, 1, take_back);
        any = false;
        for (size_t i = 0; i < count; ++i)
            any = any || tracker->tracks[i].guarding;
    }
    for (size_t i = 0; i < count && status == SPH_OK; ++i) {
        sph__track *t = tracker->tracks + i;
        size_t before = t->best_count;
        /* without new ones there are no more than before; else they must be counted */
        if (t->best_fresh > 0) status = count_before(tracker, t, &before);
        finish(tracker, t, t->best_count > before);
    }
    return status;
}
