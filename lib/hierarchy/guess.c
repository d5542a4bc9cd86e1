/* SPDX-License-Identifier: MIT */
#include "hierarchy/guess.h"

enum { FEWEST_EDGES = 4 * SPH__GUESSES, LEAF_GRAIN = 4, BATCH_EVERY = 4 };

sph_status sph__guesses_create(sph__builder *b)
{
    const uint32_t workers = sph__worker_count(b->context);
    const size_t rows = (3 + SPH__BLOCK_ROWS) * b->stride;
    sph__guesses *g;
    if (workers < 2 || b->single || b->h->radii_per_frame || b->coherence > 0 || b->mesh.edge_count < FEWEST_EDGES) return SPH_OK;
    g = b->guesses = sph__zalloc(b->context, 1, sizeof *g);
    if (g == NULL) return sph__fail_memory(b->context);
    g->rows = sph__zalloc(b->context, SPH__GUESSES, rows * sizeof *g->rows);
    g->places = sph__zalloc(b->context, b->mesh.edge_count, sizeof *g->places);
    g->extents = sph__zalloc(b->context, workers < SPH__GUESS_WORKERS ? workers : SPH__GUESS_WORKERS, sizeof *g->extents);
    if (g->rows == NULL || g->places == NULL || g->extents == NULL) return sph__fail_memory(b->context);
    for (size_t i = 0; i < SPH__GUESSES; ++i) {
        g->items[i].edge = SPH__NO_NODE;
        g->items[i].center = g->rows + i * rows;
        g->items[i].block = g->items[i].center + 3 * b->stride;
    }
    for (; g->worker_count < workers && g->worker_count < SPH__GUESS_WORKERS; ++g->worker_count) {
        const sph_status status = sph__extents_init(b, &g->extents[g->worker_count]);
        atomic_flag_clear(&g->busy[g->worker_count]);
        if (status == SPH_OK) continue;
        ++g->worker_count;
        return status;
    }
    return SPH_OK;
}

void sph__guesses_destroy(sph__builder *b)
{
    sph__guesses *g = b->guesses;
    if (g == NULL) return;
    for (uint32_t i = 0; i < g->worker_count; ++i) sph__extents_free(b, &g->extents[i]);
    sph__free(b->context, g->extents);
    sph__free(b->context, g->rows);
    sph__free(b->context, g->places);
    sph__free(b->context, g->fresh);
    sph__free(b->context, g);
}

static bool is_alive(const sph__builder *b, uint32_t node)
{
    return b->h->parents[node] == SPH__NO_NODE;
}

static void drop(sph__guesses *g, sph__guess *guess)
{
    if (guess->edge != SPH__NO_NODE) g->places[guess->edge] = 0;
    guess->edge = SPH__NO_NODE;
}

const sph__guess *sph__guess_find(const sph__builder *b, uint32_t edge)
{
    const sph__guess *guess;
    uint32_t u, v;
    if (b->guesses == NULL || b->guesses->places[edge] == 0) return NULL;
    guess = &b->guesses->items[b->guesses->places[edge] - 1];
    sph__edge_ends(&b->mesh, edge, &u, &v);
    return guess->ready && guess->u == u && guess->v == v ? guess : NULL;
}

double sph__guess_exact(const sph__guess *guess, sph__candidate *candidate)
{
    *candidate = guess->candidate;
    return guess->cost;
}

/* Neighbours change by dying only. */
static bool is_neighbourhood_alive(const sph__builder *b, const sph__guess *guess)
{
    for (size_t i = 0; i < guess->other_count; ++i)
        if (!is_alive(b, guess->others[i])) return false;
    return guess->all_others;
}

bool sph__guess_sphere(sph__builder *b, const sph__guess *guess, bool *inverts)
{
    const bool alive = is_neighbourhood_alive(b, guess);
    if (guess->inverts && !alive) return false;
    memcpy(b->new_center, guess->center, b->node_floats * sizeof(float));
    *inverts = alive ? guess->inverts : sph__inverts(b, guess->u, guess->v, b->new_center);
    return true;
}

const float *sph__guess_block(const sph__builder *b, const sph__guess *guess, sph__slot *slot)
{
    const sph__slot *from = &b->slots[b->n + (size_t)(guess - b->guesses->items)];
    slot->w = from->w;
    slot->b = from->b;
    slot->c = from->c;
    return guess->block;
}

bool sph__guess_cost(sph__builder *b, const sph__guess *guess, uint32_t edge, uint32_t other, double *cost)
{
    for (size_t i = 0; i < guess->other_count; ++i)
        if (guess->others[i] == other) {
            *cost = guess->costs[i];
            b->candidates[edge] = guess->candidates[i];
            if (b->parabolas != NULL) b->parabolas[edge] = guess->parabolas[i];
            return true;
        }
    return false;
}

/* --- working one out --- */

static void list_others(const sph__builder *b, sph__guess *guess, uint32_t node)
{
    const uint32_t count = sph__edge_count_of(&b->mesh, node);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t x = sph__edge_other(&b->mesh, sph__edges_of(&b->mesh, node)[i], node);
        size_t at = 0;
        if (x == guess->u || x == guess->v) continue;
        while (at < guess->other_count && guess->others[at] != x) ++at;
        if (at < guess->other_count) continue;
        if (at == SPH__GUESS_OTHERS) {
            guess->all_others = false;
            return;
        }
        guess->others[guess->other_count++] = x;
    }
}

/* The costs of the new node's edges. */
static void evaluate_others(const sph__builder *b, sph__guess *guess, const sph__slot *slot)
{
    const sph__region w = {.block = guess->block,
                           .center = guess->center,
                           .radius = (double)guess->candidate.radius,
                           .w = slot->w,
                           .b = slot->b,
                           .c = slot->c};
    for (size_t i = 0; i < guess->other_count; ++i) {
        const bool last = i + 1 == guess->other_count;
        const sph__region next = sph__region_of(b, guess->others[last ? i : i + 1]);
        sph__region x = sph__region_of(b, guess->others[i]); /* older, so it is the first of the two */
        x.next = last ? NULL : &next;
        guess->costs[i] = sph__evaluate_regions(b, &x, &w, sph__slot_of(b, guess->others[i]), slot, &guess->candidates[i],
                                                &guess->parabolas[i]);
    }
}

static void work_out(sph__builder *b, sph__guess *guess, sph__extents *extents)
{
    const sph__region u = sph__region_of(b, guess->u), v = sph__region_of(b, guess->v);
    const sph__slot *su = sph__slot_of(b, guess->u), *sv = sph__slot_of(b, guess->v);
    sph__slot *slot = &b->slots[b->n + (size_t)(guess - b->guesses->items)];
    if (!sph__is_exact(&guess->candidate))
        guess->status = sph__evaluate_exactly(b, extents, guess->edge, &guess->candidate, &guess->cost);
    if (guess->status != SPH_OK) return;
    if (guess->cost > b->guesses->limit) {
        guess->far = true;
        return;
    }
    sph__kernel_centers(&u, &v, b->stride, b->coherence, guess->candidate.lambda,
                        (double)guess->candidate.radius, guess->center);
    guess->inverts = sph__inverts(b, guess->u, guess->v, guess->center);
    guess->ready = true;
    if (guess->inverts) return;
    sph__kernel_unite(&u, &v, b->stride, guess->center, (double)guess->candidate.radius, guess->block, &slot->w,
                      &slot->b, &slot->c);
    if (slot->c < 0) slot->c = 0;
    sph__copy_widths(b, slot, su);
    sph__unite_widths(b, slot, sv, &guess->candidate);
    evaluate_others(b, guess, slot);
}

static void work_out_range(void *argument, size_t begin, size_t end)
{
    sph__builder *b = argument;
    sph__guesses *g = b->guesses;
    uint32_t worker = 0;
    while (worker < g->worker_count && atomic_flag_test_and_set_explicit(&g->busy[worker], memory_order_acquire)) ++worker;
    if (worker == g->worker_count) return; /* more threads than there should be: these are done in turn */
    for (size_t i = begin; i < end; ++i) work_out(b, &g->items[g->batch[i]], &g->extents[worker]);
    atomic_flag_clear_explicit(&g->busy[worker], memory_order_release);
}

/* --- many at once --- */

static sph_status hold(sph__builder *b, uint32_t node)
{
    sph__guesses *g = b->guesses;
    bool fresh;
    const sph_status status = sph__hold_leaf(b, node, &fresh);
    if (status != SPH_OK || !fresh) return status;
    if (!sph__reserve(b->context, (void **)&g->fresh, &g->fresh_capacity, g->fresh_count + 1, sizeof *g->fresh))
        return sph__fail_memory(b->context);
    g->fresh[g->fresh_count++] = node;
    return SPH_OK;
}

/* A free guess, or one that no longer is of use, or the one that is needed last; NULL where that is before `cost`. */
static sph__guess *take(sph__builder *b, double cost)
{
    sph__guesses *g = b->guesses;
    sph__guess *last = NULL;
    for (size_t i = 0; i < SPH__GUESSES; ++i) {
        sph__guess *guess = &g->items[i];
        if (guess->edge != SPH__NO_NODE && guess->batch == g->batches) continue;
        if (guess->edge == SPH__NO_NODE || !guess->ready || !is_alive(b, guess->u) || !is_alive(b, guess->v)) {
            last = guess;
            break;
        }
        if (guess->cost > cost && (last == NULL || guess->cost > last->cost)) last = guess;
    }
    if (last != NULL) drop(g, last);
    return last;
}

static sph_status prepare(sph__builder *b, sph__guess *guess, uint32_t edge)
{
    sph__guesses *g = b->guesses;
    sph_status status;
    if (g->places[edge] != 0) drop(g, &g->items[g->places[edge] - 1]);
    guess->edge = edge;
    guess->batch = g->batches;
    guess->ready = guess->far = false;
    guess->status = SPH_OK;
    guess->all_others = true;
    guess->other_count = 0;
    guess->candidate = b->candidates[edge];
    guess->cost = b->mesh.edges[edge].cost;
    sph__edge_ends(&b->mesh, edge, &guess->u, &guess->v);
    g->places[edge] = (uint32_t)(guess - g->items) + 1;
    g->batch[g->batch_count++] = (size_t)(guess - g->items);
    list_others(b, guess, guess->u);
    list_others(b, guess, guess->v);
    status = hold(b, guess->u);
    if (status == SPH_OK) status = hold(b, guess->v);
    for (size_t i = 0; i < guess->other_count && status == SPH_OK; ++i) status = hold(b, guess->others[i]);
    return status;
}

static void fill_range(void *argument, size_t begin, size_t end)
{
    const sph__builder *b = argument;
    for (size_t i = begin; i < end; ++i) sph__fill_leaf(b, b->guesses->fresh[i]);
}

/* Edges whose exact cost puts their turn off: that much is known now. */
static sph_status put_off(sph__builder *b)
{
    sph__guesses *g = b->guesses;
    for (size_t i = 0; i < g->batch_count; ++i) {
        sph__guess *guess = &g->items[g->batch[i]];
        if (guess->status != SPH_OK) return sph__fail_memory(b->context);
        if (!guess->far) continue;
        b->candidates[guess->edge] = guess->candidate;
        sph__edge_queue_set(&b->queue, &b->mesh, guess->edge, guess->cost);
        drop(g, guess);
    }
    return SPH_OK;
}

/* Of edges that share a node, only the first can come true. */
static bool claim_ends(sph__builder *b, uint32_t edge)
{
    uint32_t u, v;
    sph__slot *su, *sv;
    bool free;
    sph__edge_ends(&b->mesh, edge, &u, &v);
    su = sph__slot_of(b, u);
    sv = sph__slot_of(b, v);
    free = su->batch != b->guesses->batches && sv->batch != b->guesses->batches;
    su->batch = sv->batch = b->guesses->batches;
    return free;
}

/* Chooses from the top of the queue, and prepares. */
static sph_status choose(sph__builder *b)
{
    sph__guesses *g = b->guesses;
    uint32_t top[SPH__HEAP_FIRST];
    const size_t count = sph__heap_first(&b->queue.open, top, SPH__HEAP_FIRST);
    sph_status status = SPH_OK;
    g->limit = count > 0 ? sph__heap_key(&b->queue.open, top[count - 1]) : 0;
    ++g->batches;
    g->batch_count = g->fresh_count = 0;
    sph__release_leaves(b);
    for (size_t i = 0; i < count && status == SPH_OK; ++i) {
        sph__guess *guess;
        if (!claim_ends(b, top[i]) || sph__guess_find(b, top[i]) != NULL) continue;
        if (g->fresh_count > b->leaf_capacity / 2 || (guess = take(b, sph__heap_key(&b->queue.open, top[i]))) == NULL) break;
        status = prepare(b, guess, top[i]);
    }
    return status;
}

sph_status sph__guess_ahead(sph__builder *b)
{
    sph__guesses *g = b->guesses;
    sph_status status;
    if (g == NULL || sph__heap_count(&b->queue.open) < FEWEST_EDGES) return SPH_OK;
    if (g->misses++ % BATCH_EVERY != 0) return SPH_OK;
    status = choose(b);
    if (status != SPH_OK) return status;
    sph__parallel_for(b->context, g->fresh_count, LEAF_GRAIN, fill_range, b);
    sph__parallel_for(b->context, g->batch_count, 1, work_out_range, b);
    return put_off(b);
}
