/* SPDX-License-Identifier: MIT */
/*
 * The order of collapses: edges by cost, and apart from them those that were refused, which come back when their
 * surroundings change, and are taken in order of cost when nothing else is left.
 *
 * Only the cheapest are sorted. The others wait, with their costs, until these are used up: by then most of them have other
 * costs, or are no more.
 */
#ifndef SPH_HIERARCHY_EDGE_QUEUE_H
#define SPH_HIERARCHY_EDGE_QUEUE_H

#include "hierarchy/connectivity.h"
#include "numeric/heap.h"

typedef struct sph__edge_queue {
    sph__heap open;      /* edges whose cost is below the limit */
    double limit;
    bool all;            /* no edge waits, whatever it costs */
    uint32_t *waiting;   /* all edges that are left, and some that are not */
    size_t waiting_count;
    sph__heap refused;
    uint8_t *touched; /* by node: an edge of it was refused since those around it last came back */
    size_t touched_capacity;
} sph__edge_queue;

/* The ends of an edge, the older first. */
static inline void sph__edge_ends(const sph__connectivity *mesh, uint32_t edge, uint32_t *u, uint32_t *v)
{
    const uint32_t *ends = mesh->edges[edge].ends;
    *u = ends[0] < ends[1] ? ends[0] : ends[1];
    *v = ends[0] < ends[1] ? ends[1] : ends[0];
}

/* Edges of equal cost go by their ends. */
static inline uint64_t sph__edge_tie(const sph__connectivity *mesh, uint32_t edge)
{
    uint32_t u, v;
    sph__edge_ends(mesh, edge, &u, &v);
    return (uint64_t)u << 32 | v;
}

/* Whether an edge of this cost is in the heap. */
static inline bool sph__edge_queue_sorts(const sph__edge_queue *queue, double cost)
{
    return !(cost < 0) && (cost < queue->limit || queue->all); /* it may be no number */
}

void sph__edge_queue_init(sph__edge_queue *queue, sph_context *context);
void sph__edge_queue_free(sph__edge_queue *queue);
/* Before the first edge is set. */
sph_status sph__edge_queue_reserve(sph__edge_queue *queue, const sph__connectivity *mesh);
/* With a new cost; no longer refused. There is room for all edges. */
void sph__edge_queue_set(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t edge, double cost);
/* Takes it out, for now. */
void sph__edge_queue_take(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t edge);
/* The cheapest edge that was not refused; false where there is none. */
bool sph__edge_queue_top(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t *edge);
/* An edge that was taken out. */
sph_status sph__edge_queue_refuse(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t edge, double cost);
/* Takes the cheapest of those refused; false where there is none. */
bool sph__edge_queue_pop_refused(sph__edge_queue *queue, uint32_t *edge);
/* Forgets the edges that the last collapse took away. */
void sph__edge_queue_forget(sph__edge_queue *queue, sph__connectivity *mesh);
/* Refused edges around the neighbours of a new node come back: their triangles have changed. */
void sph__edge_queue_readmit(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t node);

#endif
