/* SPDX-License-Identifier: MIT */
/* Pairs of triangles of one mesh that intersect. */
#ifndef SPH_IMPLICIT_INTERSECT_H
#define SPH_IMPLICIT_INTERSECT_H

#include "base/base.h"
#include "level/box_tree.h"

enum { SPH__INTERSECT_LEAF = 4, SPH__INTERSECT_GRAIN = 128 /* leaves of one block */ };

/* Pairs, the lower triangle in the upper half; in order within a block of leaves. */
typedef struct sph__pairs {
    uint64_t *items;
    size_t count, capacity;
    bool out_of_memory;
} sph__pairs;

/* A search in one pose. */
typedef struct sph__intersector {
    const sph_context *context; /* borrowed */
    const uint32_t *triangles;  /* [t][3] */
    size_t triangle_count;
    const float *positions; /* of what the triangles name */
    const uint8_t *marks;   /* [t]: one of a pair must have one; NULL: all have */
    sph__box_tree tree;
    sph__box *boxes;   /* [t] */
    sph__pairs *lists; /* [block_count] */
    uint32_t block_count;
} sph__intersector;

/* Sorts the triangles of a pose into a tree; other poses then take it over. Free after failure too. */
sph_status sph__intersector_init(sph__intersector *x, const sph_context *context, const uint32_t *triangles,
                                 size_t triangle_count, const float *positions);
void sph__intersector_free(sph__intersector *x);
/* Another pose, in two halves: the boxes of triangles begin .. end - 1, and what is above them. */
void sph__intersector_box(sph__intersector *x, size_t begin, size_t end);
void sph__intersector_refit(sph__intersector *x);
/* The pairs of blocks begin .. end - 1 of leaves. */
void sph__intersector_search(sph__intersector *x, size_t begin, size_t end);

#endif
