/* SPDX-License-Identifier: MIT */
/* Decimation: collapse the cheapest edge, again and again (section 4). */
#include <math.h>

#include "hierarchy/single.h"

/* Both ends of an edge have blocks then. */
static sph_status need_ends(sph__builder *b, uint32_t edge)
{
    uint32_t u, v;
    sph_status status;
    sph__edge_ends(&b->mesh, edge, &u, &v);
    sph__release_leaves(b);
    status = sph__need_leaf(b, u);
    return status == SPH_OK ? sph__need_leaf(b, v) : status;
}

/* The cost of the first of a new node's edges, from the collapse's guess where it has it. */
static sph_status evaluate_new(sph__builder *b, const uint32_t *edges, uint32_t count, uint32_t node, const sph__guess *guess,
                               double *cost)
{
    const uint32_t edge = edges[0], next = count > 1 ? sph__edge_other(&b->mesh, edges[1], node) : SPH__NO_NODE;
    sph_status status;
    if (guess != NULL && sph__guess_cost(b, guess, edge, sph__edge_other(&b->mesh, edge, node), cost))
        return SPH_OK;
    status = need_ends(b, edge);
    if (status == SPH_OK) *cost = sph__evaluate(b, edge, next, &b->candidates[edge]);
    return status;
}

/* The edges of a new node, into the queue. */
static sph_status push_around(sph__builder *b, uint32_t node, const sph__guess *guess)
{
    const uint32_t *edges = sph__edges_of(&b->mesh, node);
    const uint32_t count = sph__edge_count_of(&b->mesh, node);
    sph_status status = SPH_OK;
    b->h->evaluations += count;
    if (!sph__reserve(b->context, (void **)&b->costs, &b->cost_capacity, count, sizeof *b->costs))
        return sph__fail_memory(b->context);
    if (b->single) sph__single_evaluate(b, edges, count, b->costs);
    for (uint32_t i = 0; i < count && status == SPH_OK && !b->single; ++i)
        status = evaluate_new(b, edges + i, count - i, node, guess, &b->costs[i]);
    for (uint32_t i = 0; i < count && status == SPH_OK; ++i)
        sph__edge_queue_set(&b->queue, &b->mesh, edges[i], b->costs[i]);
    return status;
}

/* The united region's block, to where u or v had theirs, or to a new place. */
static sph_status unite_blocks(sph__builder *b, uint32_t nu, uint32_t nv, const float *block)
{
    const uint32_t u = b->mesh.nodes[nu].slot, v = b->mesh.nodes[nv].slot;
    if (b->single) return SPH_OK;
    if (b->h->radii_per_frame) {
        sph__blocks_give(&b->blocks, v);
        return SPH_OK;
    }
    if (nu < b->n && b->slots[u].block != NULL) sph__blocks_give(&b->leaf_blocks, u);
    if (nv < b->n && b->slots[v].block != NULL) sph__blocks_give(&b->leaf_blocks, v);
    if (nv >= b->n && nu < b->n)
        sph__blocks_pass(&b->blocks, v, u);
    else if (nv >= b->n)
        sph__blocks_give(&b->blocks, v);
    else if (nu < b->n && !sph__blocks_take(&b->blocks, u))
        return sph__fail_memory(b->context);
    memcpy(b->slots[u].block, block, SPH__BLOCK_ROWS * b->stride * sizeof(float));
    sph__limit_leaves(b);
    return SPH_OK;
}

/* The scalars of the united quadric, and its block; with radii per frame that of u becomes it. */
static const float *unite_quadrics(sph__builder *b, uint32_t nu, uint32_t nv, const sph__candidate *candidate,
                                   const sph__guess *guess)
{
    sph__slot *slot = sph__slot_of(b, nu);
    if (b->h->radii_per_frame) {
        slot->c = sph__per_frame_unite(b, nu, nv);
        return slot->block;
    }
    if (b->single) {
        sph__single_unite(b, nu, nv, candidate);
        return slot->block;
    }
    if (guess == NULL) {
        const sph__region u = sph__region_of(b, nu), v = sph__region_of(b, nv);
        sph__kernel_unite(&u, &v, b->stride, b->new_center, (double)candidate->radius, b->new_block, &slot->w,
                          &slot->b, &slot->c);
        return b->new_block;
    }
    return sph__guess_block(b, guess, slot);
}

/* Quadric, sphere and members of the new node w, into the slot of u. */
static sph_status unite_regions(sph__builder *b, uint32_t nu, uint32_t nv, uint32_t w, const sph__candidate *candidate,
                                const sph__guess *guess)
{
    sph__slot *su = sph__slot_of(b, nu), *sv = sph__slot_of(b, nv);
    sph_hierarchy *h = b->h;
    const float *block;
    memcpy(sph__node_center(b, w), b->new_center, b->node_floats * sizeof(float));
    b->live_cost -= su->c + sv->c;
    if (h->radii_per_frame)
        memcpy(h->radii + w * b->stride, b->new_radii, b->stride * sizeof(float));
    else
        h->radii[w] = candidate->radius;
    block = unite_quadrics(b, nu, nv, candidate, guess);
    if (su->c < 0) su->c = 0;
    b->live_cost += su->c;
    if (b->means != NULL) {
        float *mean = b->means + (size_t)(su - b->slots) * 4 * b->stride;
        sph__kernel_unite_means(mean, b->means + (size_t)(sv - b->slots) * 4 * b->stride, b->stride, mean);
    }
    sph__unite_widths(b, su, sv, candidate);
    b->next_member[su->last] = (uint32_t)(sv - b->slots);
    su->last = sv->last;
    su->count += sv->count;
    su->node = w;
    b->mesh.nodes[w].slot = b->mesh.nodes[nu].slot;
    return unite_blocks(b, nu, nv, block);
}

static void record_collapse(sph__builder *b, uint32_t u, uint32_t v, uint32_t w, bool forced)
{
    sph_hierarchy *h = b->h;
    const uint32_t t = h->collapse_count++;
    const double cost = b->live_cost > 0 ? b->live_cost : 0;
    const double error = b->live_weight > 0 ? sqrt(cost / (0.5 * b->live_weight)) : 0;
    h->children[2 * (size_t)t] = u;
    h->children[2 * (size_t)t + 1] = v;
    h->parents[u] = h->parents[v] = w;
    h->parents[w] = SPH__NO_NODE;
    h->costs[t] = sph__slot_of(b, w)->c;
    h->errors[t] = t > 0 && h->errors[t - 1] > error ? h->errors[t - 1] : error;
    h->forced[t] = forced;
    if (forced && h->first_forced == SPH__NO_NODE) h->first_forced = t;
}

static sph_status collapse(sph__builder *b, uint32_t u, uint32_t v, const sph__candidate *candidate, bool forced,
                           const sph__guess *guess)
{
    const uint32_t w = b->n + b->h->collapse_count;
    sph_status status = unite_regions(b, u, v, w, candidate, guess);
    if (status == SPH_OK) status = sph__connectivity_collapse(&b->mesh, u, v, w);
    if (status != SPH_OK) return status;
    sph__edge_queue_forget(&b->queue, &b->mesh);
    if (guess == NULL) sph__prefetch_around(b, w);
    record_collapse(b, u, v, w, forced);
    status = sph__births_add(&b->births, &b->mesh, w);
    if (status == SPH_OK) status = push_around(b, w, guess);
    if (status == SPH_OK) sph__edge_queue_readmit(&b->queue, &b->mesh, w);
    return status;
}

/* The exact cost of an edge that is on top of the queue. */
static sph_status make_exact(sph__builder *b, uint32_t edge, double *cost)
{
    const sph__guess *guess = sph__guess_find(b, edge);
    sph_status status;
    uint32_t u, v;
    if (guess != NULL) {
        *cost = sph__guess_exact(guess, &b->candidates[edge]);
        return SPH_OK;
    }
    status = sph__is_parabola(b, edge) ? SPH_OK : need_ends(b, edge);
    if (status != SPH_OK) return status;
    if (!b->h->radii_per_frame) return sph__evaluate_exactly(b, &b->extents, edge, &b->candidates[edge], cost);
    sph__edge_ends(&b->mesh, edge, &u, &v);
    status = sph__union_frame_widths(b, &b->extents, sph__slot_of(b, u), sph__slot_of(b, v), b->union_widths);
    if (status != SPH_OK) return status;
    b->candidates[edge].width = 0;
    b->exact_edge = edge;
    *cost = sph__per_frame_cost(b, u, v, b->union_widths);
    return SPH_OK;
}

/* Takes the cheapest edge whose cost is exact off the queue; false where it is empty. */
static sph_status next_edge(sph__builder *b, uint32_t *edge, double *cost, bool *found)
{
    while ((*found = sph__edge_queue_top(&b->queue, &b->mesh, edge))) {
        sph_status status = sph__guess_find(b, *edge) == NULL ? sph__guess_ahead(b) : SPH_OK;
        if (status != SPH_OK) return status;
        *found = sph__edge_queue_top(&b->queue, &b->mesh, edge); /* it may be another now */
        *cost = b->mesh.edges[*edge].cost;
        if (sph__is_exact(&b->candidates[*edge])) {
            sph__edge_queue_take(&b->queue, &b->mesh, *edge);
            return SPH_OK;
        }
        status = make_exact(b, *edge, cost);
        if (status != SPH_OK) return status;
        sph__edge_queue_set(&b->queue, &b->mesh, *edge, *cost);
    }
    return SPH_OK;
}

/* The sphere of an edge whose cost is exact. */
static sph_status make_sphere(sph__builder *b, uint32_t edge, uint32_t nu, uint32_t nv)
{
    const sph__candidate *candidate = &b->candidates[edge];
    sph_status status = need_ends(b, edge);
    if (status != SPH_OK) return status;
    if (b->single) {
        sph__single_center(b, nu, nv, candidate);
        return SPH_OK;
    }
    if (!b->h->radii_per_frame) {
        const sph__region u = sph__region_of(b, nu), v = sph__region_of(b, nv);
        sph__kernel_centers(&u, &v, b->stride, b->coherence, candidate->lambda, (double)candidate->radius,
                            b->new_center);
        return SPH_OK;
    }
    if (b->exact_edge != edge) {
        status = sph__union_frame_widths(b, &b->extents, sph__slot_of(b, nu), sph__slot_of(b, nv), b->union_widths);
        if (status != SPH_OK) return status;
        b->exact_edge = edge;
    }
    sph__per_frame_sphere(b, nu, nv, b->union_widths);
    return SPH_OK;
}

/* The next collapse, or refusal; where only refused edges are left the cheapest of them is collapsed. */
static sph_status step(sph__builder *b, bool *done)
{
    uint32_t edge = 0, u, v;
    bool forced, found, inverts;
    double cost = 0;
    const sph__guess *guess;
    sph_status status = next_edge(b, &edge, &cost, &found);
    if (status != SPH_OK) return status;
    forced = !found;
    *done = forced && !sph__edge_queue_pop_refused(&b->queue, &edge);
    if (*done) return SPH_OK;
    sph__edge_ends(&b->mesh, edge, &u, &v);
    sph__prefetch_collapse(b, u, v);
    guess = forced ? NULL : sph__guess_find(b, edge);
    if (guess == NULL || !sph__guess_sphere(b, guess, &inverts)) {
        guess = NULL;
        status = make_sphere(b, edge, u, v);
        if (status != SPH_OK) return status;
        sph__prefetch_neighbours(b, u);
        sph__prefetch_neighbours(b, v);
        if (forced)
            inverts = false;
        else
            inverts = b->single ? sph__single_inverts(b, u, v, b->new_center) : sph__inverts(b, u, v, b->new_center);
    }
    if (inverts) return sph__edge_queue_refuse(&b->queue, &b->mesh, edge, cost);
    return collapse(b, u, v, &b->candidates[edge], forced, guess);
}

sph_status sph__decimate(sph__builder *b)
{
    sph_status status;
    uint32_t report_every;
    b->new_center = sph__zalloc(b->context, b->node_floats, sizeof(float));
    b->new_block = sph__alloc(b->context, SPH__BLOCK_ROWS, b->stride * sizeof(float));
    if (b->new_center == NULL || b->new_block == NULL) return sph__fail_memory(b->context);
    sph__progress_part(&b->progress, 0.2);
    status = sph__fill_queue(b);
    if (status == SPH_OK) status = sph__guesses_create(b);
    sph__progress_part(&b->progress, 0.6);
    /* As often for the same amount of memory that is passed: a host may have to look after it. */
    report_every = b->stride < 1024 ? (uint32_t)(1024 / b->stride) : 1;
    if (report_every > 64) report_every = 64;
    for (bool done = false; status == SPH_OK && !done;) {
        if (b->h->collapse_count % report_every == 0)
            status = sph__progress_report(&b->progress, "decimation", (double)b->h->collapse_count / b->n);
        if (status == SPH_OK) status = step(b, &done);
    }
    return status;
}
