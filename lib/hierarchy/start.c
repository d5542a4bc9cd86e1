/* SPDX-License-Identifier: MIT */
/*
 * The start of the queue: the costs of all edges of the input. Vertices are taken in the order of a walk over the mesh, some
 * at a time, so that the blocks of leaves that they need are few and near.
 */
#include "hierarchy/single.h"

enum { WAVE = 256, LEAF_GRAIN = 8, EDGE_GRAIN = 32 };

/* A walk over the mesh, and the part of it that is at work. */
typedef struct walk {
    sph__builder *b;
    uint32_t *order, *ranks; /* [n] */
    uint32_t *fresh;         /* leaves to make */
    size_t fresh_count, fresh_capacity;
    uint32_t *edges;
    double *costs;
    size_t edge_count, edge_capacity, cost_capacity;
} walk;

static void walk_free(const sph_context *context, walk *w)
{
    sph__free(context, w->order);
    sph__free(context, w->ranks);
    sph__free(context, w->fresh);
    sph__free(context, w->edges);
    sph__free(context, w->costs);
}

/* Breadth first, from the lowest number of each component. */
static sph_status find_order(walk *w)
{
    const sph__builder *b = w->b;
    uint32_t count = 0;
    w->order = sph__alloc(b->context, b->n, sizeof *w->order);
    w->ranks = sph__alloc(b->context, b->n, sizeof *w->ranks);
    if (w->order == NULL || w->ranks == NULL) return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) w->ranks[v] = SPH__NO_NODE;
    for (uint32_t seed = 0, next = 0; seed < b->n; ++seed) {
        if (w->ranks[seed] != SPH__NO_NODE) continue;
        w->ranks[seed] = count;
        w->order[count++] = seed;
        for (; next < count; ++next) {
            const uint32_t v = w->order[next];
            for (uint32_t i = 0; i < sph__edge_count_of(&b->mesh, v); ++i) {
                const uint32_t x = sph__edge_other(&b->mesh, sph__edges_of(&b->mesh, v)[i], v);
                if (w->ranks[x] != SPH__NO_NODE) continue;
                w->ranks[x] = count;
                w->order[count++] = x;
            }
        }
    }
    return SPH_OK;
}

static sph_status hold(walk *w, uint32_t v)
{
    bool fresh;
    const sph_status status = sph__hold_leaf(w->b, v, &fresh);
    if (status != SPH_OK || !fresh) return status;
    if (!sph__reserve(w->b->context, (void **)&w->fresh, &w->fresh_capacity, w->fresh_count + 1, sizeof *w->fresh))
        return sph__fail_memory(w->b->context);
    w->fresh[w->fresh_count++] = v;
    return SPH_OK;
}

/* The edges from v to those before it. */
static sph_status list_edges(walk *w, uint32_t v)
{
    const sph__builder *b = w->b;
    const uint32_t count = sph__edge_count_of(&b->mesh, v);
    sph_status status = SPH_OK;
    if (!sph__reserve(b->context, (void **)&w->edges, &w->edge_capacity, w->edge_count + count, sizeof *w->edges) ||
        !sph__reserve(b->context, (void **)&w->costs, &w->cost_capacity, w->edge_count + count, sizeof *w->costs))
        return sph__fail_memory(b->context);
    for (uint32_t i = 0; i < count && status == SPH_OK; ++i) {
        const uint32_t e = sph__edges_of(&b->mesh, v)[i], x = sph__edge_other(&b->mesh, e, v);
        if (w->ranks[x] > w->ranks[v]) continue;
        w->edges[w->edge_count++] = e;
        status = hold(w, x);
    }
    return status;
}

static void fill_range(void *argument, size_t begin, size_t end)
{
    const walk *w = argument;
    for (size_t i = begin; i < end; ++i) sph__fill_leaf(w->b, w->fresh[i]);
}

static void evaluate_range(void *argument, size_t begin, size_t end)
{
    const walk *w = argument;
    for (size_t i = begin; i < end; ++i)
        w->costs[i] = sph__evaluate(w->b, w->edges[i], SPH__NO_NODE, &w->b->candidates[w->edges[i]]);
}

/* The vertices from `begin` to `end` of the walk. */
static sph_status run_wave(walk *w, uint32_t begin, uint32_t end)
{
    sph__builder *b = w->b;
    sph_status status = SPH_OK;
    w->fresh_count = w->edge_count = 0;
    sph__release_leaves(b);
    for (uint32_t i = begin; i < end && status == SPH_OK; ++i) {
        status = hold(w, w->order[i]);
        if (status == SPH_OK) status = list_edges(w, w->order[i]);
    }
    if (status != SPH_OK) return status;
    sph__parallel_for(b->context, w->fresh_count, LEAF_GRAIN, fill_range, w);
    sph__parallel_for(b->context, w->edge_count, EDGE_GRAIN, evaluate_range, w);
    b->h->evaluations += w->edge_count;
    for (size_t i = 0; i < w->edge_count; ++i) sph__edge_queue_set(&b->queue, &b->mesh, w->edges[i], w->costs[i]);
    return SPH_OK;
}

typedef struct edge_range {
    const sph__builder *b;
    const uint32_t *edges;
    double *costs;
} edge_range;

static void evaluate_single(void *argument, size_t begin, size_t end)
{
    const edge_range *r = argument;
    sph__single_evaluate(r->b, r->edges + begin, end - begin, r->costs + begin);
}

/* A single frame: all leaves are there, so edges are taken in the order of their numbers. */
static sph_status fill_single(sph__builder *b)
{
    enum { CHUNK = 1 << 14, GRAIN = 512 };
    const uint32_t count = b->mesh.edge_count;
    uint32_t *edges = sph__alloc(b->context, CHUNK, sizeof *edges);
    double *costs = sph__alloc(b->context, CHUNK, sizeof *costs);
    edge_range range = {b, edges, costs};
    sph_status status = edges == NULL || costs == NULL ? sph__fail_memory(b->context) : SPH_OK;
    for (uint32_t first = 0; first < count && status == SPH_OK; first += CHUNK) {
        const uint32_t some = count - first < CHUNK ? count - first : CHUNK;
        status = sph__progress_report(&b->progress, "evaluation", (double)first / count);
        for (uint32_t i = 0; i < some; ++i) edges[i] = first + i;
        if (status == SPH_OK) sph__parallel_for(b->context, some, GRAIN, evaluate_single, &range);
        for (uint32_t i = 0; i < some && status == SPH_OK; ++i)
            sph__edge_queue_set(&b->queue, &b->mesh, first + i, costs[i]);
    }
    b->h->evaluations += count;
    sph__free(b->context, edges);
    sph__free(b->context, costs);
    return status;
}

/* More frames: by waves of a walk. */
static sph_status fill_by_walk(sph__builder *b)
{
    walk w = {.b = b};
    sph_status status = find_order(&w);
    for (uint32_t i = 0; i < b->n && status == SPH_OK; i += WAVE) {
        status = sph__progress_report(&b->progress, "evaluation", (double)i / b->n);
        if (status == SPH_OK) status = run_wave(&w, i, b->n - i < WAVE ? b->n : i + WAVE);
    }
    walk_free(b->context, &w);
    return status;
}

sph_status sph__fill_queue(sph__builder *b)
{
    sph_status status;
    b->candidates = sph__alloc(b->context, b->mesh.edge_count, sizeof *b->candidates);
    if (b->candidates == NULL) return sph__fail_memory(b->context);
    if (b->probe_frames != b->frames && !b->h->radii_per_frame) {
        b->parabolas = sph__alloc(b->context, b->mesh.edge_count, sizeof *b->parabolas);
        if (b->parabolas == NULL) return sph__fail_memory(b->context);
    }
    status = sph__edge_queue_reserve(&b->queue, &b->mesh);
    if (status == SPH_OK) status = b->single ? fill_single(b) : fill_by_walk(b);
    for (uint32_t v = 0; v < b->n; ++v) b->live_weight += b->slots[v].w;
    return status;
}
