/* SPDX-License-Identifier: MIT */
/*
 * Waiting for memory. Collapses jump about the mesh, and each of them reads some two hundred cache lines, that lead from one
 * to the next: edge, nodes, their lists, neighbours, what is known of these. What the top of the queue leads to is asked for
 * some collapses early, a step at each.
 */
#include "hierarchy/single.h"

/* Entries of the queue: the next; its siblings, and their children. */
enum { NEXT = 1, NEAR = 5, FAR = 21 };

static void ask_for(const void *place)
{
    __builtin_prefetch(place);
}

static void ask_for_slot(const sph__builder *b, const sph__slot *slot)
{
    enum { MOST = 20 * 64 };
    const size_t size = (slot->node < b->n ? b->leaf_rows : SPH__BLOCK_ROWS) * b->stride * sizeof(float);
    sph__prefetch_widths(b, slot);
    if (b->single || slot->block == NULL) return;
    for (size_t at = 0; at < size && at < MOST; at += 64) ask_for((const char *)slot->block + at);
}

/* What is at a node's number. */
static void ask_for_node(const sph__builder *b, uint32_t node)
{
    ask_for(&b->mesh.nodes[node]);
    if (!b->single) ask_for(sph__node_center(b, node));
}

/* Where what is known of a node begins. */
static void ask_for_state(const sph__builder *b, uint32_t node)
{
    ask_for(sph__slot_of(b, node));
    if (b->single) ask_for(sph__single_rows(b, b->mesh.nodes[node].slot));
}

/* What a node leads to. */
static void ask_for_lists(const sph__builder *b, uint32_t node)
{
    ask_for(sph__edges_of(&b->mesh, node));
    ask_for(sph__triangles_of(&b->mesh, node));
    ask_for_state(b, node);
}

static void ask_for_simplices(const sph__builder *b, uint32_t node)
{
    const uint32_t *edges = sph__edges_of(&b->mesh, node);
    const uint32_t *triangles = sph__triangles_of(&b->mesh, node);
    const uint32_t edge_count = sph__edge_count_of(&b->mesh, node);
    const uint32_t triangle_count = sph__triangle_count_of(&b->mesh, node);
    for (uint32_t i = 0; i < edge_count; ++i) ask_for(&b->mesh.edges[edges[i]]);
    for (uint32_t i = 0; i < triangle_count; ++i) ask_for(b->mesh.triangles[triangles[i]]);
    ask_for_slot(b, sph__slot_of(b, node));
}

static void ask_for_neighbours(const sph__builder *b, uint32_t node)
{
    const uint32_t *edges = sph__edges_of(&b->mesh, node);
    const uint32_t count = sph__edge_count_of(&b->mesh, node);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t x = sph__edge_other(&b->mesh, edges[i], node);
        ask_for_node(b, x);
        ask_for(&b->candidates[edges[i]]);
        if (sph__edge_queue_sorts(&b->queue, b->mesh.edges[edges[i]].cost)) sph__heap_prefetch_item(&b->queue.open, edges[i]);
    }
}

void sph__prefetch_collapse(const sph__builder *b, uint32_t u, uint32_t v)
{
    const sph__heap_entry *top = b->queue.open.entries;
    const size_t count = sph__heap_count(&b->queue.open);
    for (size_t i = NEAR; i < FAR && i < count; ++i) {
        ask_for(&b->mesh.edges[top[i].item]);
        ask_for(&b->candidates[top[i].item]);
    }
    for (size_t i = NEXT; i < NEAR && i < count; ++i)
        for (unsigned k = 0; k < 2; ++k) ask_for_node(b, b->mesh.edges[top[i].item].ends[k]);
    for (size_t i = 0; i < NEXT && i < count; ++i)
        for (unsigned k = 0; k < 2; ++k) ask_for_lists(b, b->mesh.edges[top[i].item].ends[k]);
    ask_for_simplices(b, u);
    ask_for_simplices(b, v);
    ask_for_neighbours(b, u);
    ask_for_neighbours(b, v);
}

/* What is known of the neighbours. */
void sph__prefetch_neighbours(const sph__builder *b, uint32_t node)
{
    const uint32_t *edges = sph__edges_of(&b->mesh, node);
    const uint32_t count = sph__edge_count_of(&b->mesh, node);
    for (uint32_t i = 0; i < count; ++i) ask_for_state(b, sph__edge_other(&b->mesh, edges[i], node));
}

void sph__prefetch_around(const sph__builder *b, uint32_t node)
{
    const uint32_t *edges = sph__edges_of(&b->mesh, node);
    const uint32_t count = sph__edge_count_of(&b->mesh, node);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t x = sph__edge_other(&b->mesh, edges[i], node);
        const char *center = (const char *)sph__node_center(b, x);
        ask_for_state(b, x);
        for (size_t at = 0; at < b->node_floats * sizeof(float) && at < 6 * 64; at += 64) ask_for(center + at);
    }
    for (uint32_t i = 0; i < count; ++i) ask_for_slot(b, sph__slot_of(b, sph__edge_other(&b->mesh, edges[i], node)));
}
