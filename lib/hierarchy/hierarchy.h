/* SPDX-License-Identifier: MIT */
/* Internal door of the room "hierarchy": the handle laid open. */
#ifndef SPH_HIERARCHY_ROOM_H
#define SPH_HIERARCHY_ROOM_H

#include <sphmesh/hierarchy.h>

#include "base/base.h"

#define SPH__NO_NODE UINT32_MAX

/*
 * Nodes are numbered by birth, so a simplex lives from the birth of its youngest vertex to the death of the first that
 * dies: only births need recording. Simplices are kept with their youngest vertex.
 */
struct sph_hierarchy {
    sph_context *context; /* retained */
    uint32_t vertex_count, frame_count, collapse_count;
    uint32_t stride;          /* floats per row of centres: frame_count rounded up to whole lanes */
    uint32_t radii_per_frame; /* 1: rows of radii; 0: one radius per node */
    uint32_t first_forced;
    uint64_t evaluations;
    double bounding_diagonal;
    float *centers;            /* [n + C][3][stride] */
    float *radii;              /* [n + C], or [n + C][stride] */
    uint32_t *children;        /* [C][2], the smaller first */
    uint32_t *parents;         /* [n + C], SPH__NO_NODE for roots */
    uint32_t root_count;
    uint32_t *roots;           /* ascending */
    double *costs, *errors;    /* [C] */
    uint8_t *forced;           /* [C] */
    size_t *edge_starts;       /* [n + C + 1] into edge_others */
    uint32_t *edge_others;     /* the older end of each edge, ascending per node */
    size_t *triangle_starts;   /* [n + C + 1], in triangles, into triangle_others */
    uint32_t *triangle_others; /* [][2] the older corners of each triangle, in the order of its winding */
};

static inline uint32_t sph__node_count(const sph_hierarchy *h)
{
    return h->vertex_count + h->collapse_count;
}

/* The place of edge (node, other) in edge_others, node the younger; SIZE_MAX where there is none. */
size_t sph__hierarchy_find_edge(const sph_hierarchy *h, uint32_t node, uint32_t other);

/* Lists the roots from the parents: the last step of making a hierarchy. */
sph_status sph__hierarchy_list_roots(sph_hierarchy *h);

/* Unit directions spread evenly over the half-sphere, over which widths are taken. */
void sph__width_directions(uint32_t count, double (*directions)[3]);

#endif
