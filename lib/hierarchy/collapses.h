/* SPDX-License-Identifier: MIT */
/*
 * What walking over collapses needs to know of them, whatever it is that is collapsed. Nodes are numbered by birth, so
 * a simplex lives from the birth of its youngest vertex to the death of the first that dies: only births are recorded,
 * and simplices are kept with their youngest vertex.
 */
#ifndef SPH_HIERARCHY_COLLAPSES_H
#define SPH_HIERARCHY_COLLAPSES_H

#include <sphmesh/hierarchy.h>

#include "hierarchy/connectivity.h"

#define SPH__NO_NODE UINT32_MAX

/* A view: nothing of it is owned. */
typedef struct sph__collapses {
    const sph_context *context;
    uint32_t vertex_count, collapse_count, root_count;
    const uint32_t *children;        /* [C][2], the smaller first */
    const uint32_t *parents;         /* [n + C], SPH__NO_NODE for roots */
    const uint32_t *roots;           /* ascending */
    const size_t *edge_starts;       /* [n + C + 1] into edge_others */
    const uint32_t *edge_others;     /* the older end of each edge, ascending per node */
    const size_t *triangle_starts;   /* [n + C + 1], in triangles, into triangle_others */
    const uint32_t *triangle_others; /* [][2] the older corners of each triangle, in the order of its winding; ascending
                                        per node */
} sph__collapses;

/* All nodes that ever are. */
static inline uint32_t sph__collapses_node_count(const sph__collapses *h)
{
    return h->vertex_count + h->collapse_count;
}

static inline bool sph__node_alive(const uint32_t *parents, uint32_t node, uint32_t end)
{
    return node < end && parents[node] >= end; /* a root's parent is SPH__NO_NODE */
}

/* The place of edge (node, other) in edge_others, node the younger; SIZE_MAX where there is none. */
size_t sph__collapses_find_edge(const sph__collapses *collapses, uint32_t node, uint32_t other);

/* Numbers of nodes without parents, ascending; `roots` has room for them. */
void sph__list_roots(const uint32_t *parents, uint32_t node_count, uint32_t *roots, uint32_t root_count);

/* A cursor at the finest level; what is viewed must outlive it. */
sph_status sph__cursor_create(const sph__collapses *collapses, sph_cursor **out);

/* The simplices of nodes at their birth, in order: what collapses record while they are made. */
typedef struct sph__births {
    size_t *edge_starts, *triangle_starts; /* as above; the caller's */
    uint32_t *edges;                       /* other ends */
    size_t edge_count, edge_capacity;
    uint32_t *triangles;                      /* other corners */
    size_t triangle_count, triangle_capacity; /* indices: two per triangle */
    sph__keyed *keys; /* scratch; after an addition the items are the triangles' numbers, in order */
    size_t key_capacity;
} sph__births;

/* Appends the simplices of `node`, just born. */
sph_status sph__births_add(sph__births *births, const sph__connectivity *mesh, uint32_t node);
/* The same for nodes 0 to count - 1, before the first collapse. */
sph_status sph__births_add_leaves(sph__births *births, const sph__connectivity *mesh, uint32_t count);
/* Not the starts. */
void sph__births_free(sph__births *births, const sph_context *context);

#endif
