/* SPDX-License-Identifier: MIT */
/* Internal door of the room "hierarchy": the handle laid open. */
#ifndef SPH_HIERARCHY_ROOM_H
#define SPH_HIERARCHY_ROOM_H

#include <sphmesh/hierarchy.h>

#include "hierarchy/collapses.h"

/* Children, parents, roots and simplices are as in sph__collapses. */
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
    uint32_t *children;
    uint32_t *parents;
    uint32_t root_count;
    uint32_t *roots;
    double *costs, *errors;    /* [C] */
    uint8_t *forced;           /* [C] */
    size_t *edge_starts;
    uint32_t *edge_others;
    size_t *triangle_starts;
    uint32_t *triangle_others;
};

static inline uint32_t sph__node_count(const sph_hierarchy *h)
{
    return h->vertex_count + h->collapse_count;
}

/* For walking over it. */
sph__collapses sph__hierarchy_collapses(const sph_hierarchy *h);

/* Lists the roots from the parents: the last step of making a hierarchy. */
sph_status sph__hierarchy_list_roots(sph_hierarchy *h);

/* Unit directions spread evenly over the half-sphere, over which widths are taken. */
void sph__width_directions(uint32_t count, double (*directions)[3]);

#endif
