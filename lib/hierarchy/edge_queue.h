/* SPDX-License-Identifier: MIT */
/*
 * The order of collapses: edges by cost, and apart from them those that were refused, which come back when their
 * surroundings change, and are taken in order of cost when nothing else is left.
 */
#ifndef SPH_HIERARCHY_EDGE_QUEUE_H
#define SPH_HIERARCHY_EDGE_QUEUE_H

#include "hierarchy/connectivity.h"
#include "numeric/heap.h"

typedef struct sph__edge_queue {
    sph__heap open, refused;
    uint8_t *touched; /* by node: an edge of it was refused since those around it last came back */
    size_t touched_capacity;
} sph__edge_queue;

/* The ends of an edge, the older first. */
static inline void sph__edge_ends(const sph__connectivity *mesh, uint32_t edge, uint32_t *u, uint32_t *v)
{
    const uint32_t *ends = mesh->edges[edge];
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

static inline bool sph__edge_queue_is_empty(const sph__edge_queue *queue)
{
    return sph__heap_count(&queue->open) == 0 && sph__heap_count(&queue->refused) == 0;
}

void sph__edge_queue_init(sph__edge_queue *queue, sph_context *context);
void sph__edge_queue_free(sph__edge_queue *queue);
/* With a new cost; no longer refused. */
sph_status sph__edge_queue_set(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t edge, double cost);
/* An edge that was taken out. */
sph_status sph__edge_queue_refuse(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t edge, double cost);
/* Forgets the edges that the last collapse took away. */
void sph__edge_queue_forget(sph__edge_queue *queue, const sph__connectivity *mesh);
/* Refused edges around the neighbours of a new node come back: their triangles have changed. */
sph_status sph__edge_queue_readmit(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t node);

#endif
