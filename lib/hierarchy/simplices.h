/* SPDX-License-Identifier: MIT */
/* The nodes, wire edges and triangles of one level, in node numbers and in one order whoever makes them. */
#ifndef SPH_HIERARCHY_SIMPLICES_H
#define SPH_HIERARCHY_SIMPLICES_H

#include "hierarchy/collapses.h"

typedef struct sph__simplices {
    uint32_t node_count;
    uint32_t *nodes; /* ascending */
    uint32_t *places; /* where an alive node is among `nodes`; undefined for others, so that making it takes no time */
    size_t edge_count;
    uint32_t *edges; /* wire edges; the smaller end first, ascending */
    size_t triangle_count;
    uint32_t *triangles; /* each starts with its smallest corner, its winding kept; ascending */
} sph__simplices;

/* What is alive before the node `end` is born: the jump to a level, in time proportional to the level. */
sph_status sph__simplices_jump(const sph__collapses *h, uint32_t end, sph__simplices *simplices);
void sph__simplices_free(const sph_context *context, sph__simplices *simplices);

/* Brings ends, corners and lists into the order above; `keys` has room for as many. */
void sph__order_edges(uint32_t *edges, size_t count, sph__keyed *keys);
void sph__order_triangles(uint32_t *triangles, size_t count, sph__keyed *keys);

#endif
