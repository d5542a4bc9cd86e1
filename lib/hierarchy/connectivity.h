/* SPDX-License-Identifier: MIT */
/* The simplices of the level that decimation stands at: edges and triangles between nodes, and what a collapse does. */
#ifndef SPH_HIERARCHY_CONNECTIVITY_H
#define SPH_HIERARCHY_CONNECTIVITY_H

#include "base/base.h"
#include "hierarchy/lists.h"

/* What a collapse reads of an edge: its ends, and what collapsing it costs. */
typedef struct sph__edge {
    uint32_t ends[2];
    double cost; /* below 0: it has none, for the following reason */
} sph__edge;

#define SPH__NO_COST (-1.0)
#define SPH__REFUSED (-2.0)
#define SPH__GONE (-3.0)

/* What it reads of a node. */
typedef struct sph__node {
    sph__list edges, triangles;
    uint32_t mark; /* the last new node that has it as a neighbour; SPH__SHARED besides: of both of its parts */
    uint32_t slot; /* the caller's: where it keeps what it knows of it */
} sph__node;

#define SPH__SHARED (UINT32_C(1) << 31)

typedef struct sph__connectivity {
    const sph_context *context;
    bool two_sided; /* triangles of the same corners, wound the other way, are two */
    sph__edge *edges;         /* an edge keeps its number when an end is renamed */
    uint32_t edge_count;      /* at the start; numbers are never reused */
    uint32_t (*triangles)[3]; /* corners in the order of their winding */
    uint32_t triangle_count;
    sph__node *nodes;
    sph__lists lists;  /* of the nodes */
    uint32_t *removed; /* edges that the last collapse took away */
    size_t removed_count, removed_capacity;
    sph__keyed *keys; /* scratch */
    size_t key_capacity;
} sph__connectivity;

/*
 * Unique edges and triangles of the input. Simplices that name a vertex twice keep what is left of them. Nodes up to
 * 2 * vertex_count - 2 may come to be. `numbers`, where not NULL, has room for triangle_count: the input's number of each
 * triangle that is kept.
 */
sph_status sph__connectivity_init(sph__connectivity *c, const sph_context *context, uint32_t vertex_count,
                                  const uint32_t *triangles, size_t triangle_count, const uint32_t *edges,
                                  size_t edge_count, bool two_sided, uint32_t *numbers);
void sph__connectivity_free(sph__connectivity *c);

/* What a node has; valid until the next collapse. */
static inline uint32_t *sph__edges_of(const sph__connectivity *c, uint32_t node)
{
    return sph__list_items(&c->lists, &c->nodes[node].edges);
}

static inline uint32_t sph__edge_count_of(const sph__connectivity *c, uint32_t node)
{
    return c->nodes[node].edges.count;
}

static inline uint32_t *sph__triangles_of(const sph__connectivity *c, uint32_t node)
{
    return sph__list_items(&c->lists, &c->nodes[node].triangles);
}

static inline uint32_t sph__triangle_count_of(const sph__connectivity *c, uint32_t node)
{
    return c->nodes[node].triangles.count;
}

static inline uint32_t sph__edge_other(const sph__connectivity *c, uint32_t edge, uint32_t node)
{
    return c->edges[edge].ends[0] ^ c->edges[edge].ends[1] ^ node; /* no branch that depends on which it is */
}

/* Unites u and v into w: the edge (u, v) and what has become double go into `removed`. */
sph_status sph__connectivity_collapse(sph__connectivity *c, uint32_t u, uint32_t v, uint32_t w);

/* The two other corners of triangle t, in the order of its winding after `node`. */
static inline void sph__triangle_others(const sph__connectivity *c, uint32_t t, uint32_t node, uint32_t others[2])
{
    static const uint8_t next[] = {1, 2, 0, 1};
    const uint32_t *corner = c->triangles[t];
    const unsigned at = (corner[1] == node) + 2u * (corner[2] == node);
    others[0] = corner[next[at]];
    others[1] = corner[next[at + 1]];
}

#endif
