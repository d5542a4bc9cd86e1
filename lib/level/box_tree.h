/* SPDX-License-Identifier: MIT */
/*
 * A complete binary tree of boxes over items (triangles, primitives, points). Node 1 is the root, 2 i and 2 i + 1 are
 * the children of i, and the items below a node are a range of `order` that halves on the way down; so a walk carries
 * the range with it and no node stores it. Same boxes, same tree.
 */
#ifndef SPH_BOX_TREE_H
#define SPH_BOX_TREE_H

#include <float.h>

#include "base/base.h"

typedef struct sph__box {
    float low[3], high[3];
} sph__box;

/* The box of nothing. */
static inline sph__box sph__box_empty(void)
{
    return (sph__box){{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
}

/* Makes it hold another. */
static inline void sph__box_grow(sph__box *box, const sph__box *other)
{
    for (int k = 0; k < 3; ++k) {
        box->low[k] = other->low[k] < box->low[k] ? other->low[k] : box->low[k];
        box->high[k] = other->high[k] > box->high[k] ? other->high[k] : box->high[k];
    }
}

/* The box of three of the points `xyz`. */
static inline sph__box sph__box_of_triangle(const float *xyz, const uint32_t corners[3])
{
    sph__box box;
    for (size_t k = 0; k < 3; ++k) {
        const float a = xyz[3 * (size_t)corners[0] + k], b = xyz[3 * (size_t)corners[1] + k];
        const float c = xyz[3 * (size_t)corners[2] + k];
        const float low = a < b ? a : b, high = a < b ? b : a;
        box.low[k] = low < c ? low : c;
        box.high[k] = high > c ? high : c;
    }
    return box;
}

typedef struct sph__box_tree {
    const sph_context *context; /* borrowed */
    uint32_t item_count, capacity;
    uint32_t depth;  /* of the leaves; the root's is 0 */
    uint32_t *order; /* items, leaf by leaf */
    sph__box *nodes; /* 2^(depth + 1) */
    size_t node_capacity;
} sph__box_tree;

/* One step of a walk. */
typedef struct sph__box_visit {
    uint32_t node, begin, end;
    double bound; /* whatever the walk orders or prunes by */
} sph__box_visit;

enum { SPH__BOX_STACK = 64 }; /* a walk never holds more */

/* Room for a tree over `capacity` items (below 2^30). On failure what was there stays and can be destroyed. */
sph_status sph__box_tree_reserve(sph__box_tree *tree, const sph_context *context, uint32_t capacity,
                                 uint32_t leaf_size);
void sph__box_tree_free(sph__box_tree *tree);
/* Sorts the items (at most the capacity) into a tree, leaves of at most `leaf_size`. Calls sph__box_tree_refit. */
void sph__box_tree_build(sph__box_tree *tree, const sph__box *boxes, uint32_t item_count, uint32_t leaf_size);
/* Other boxes for the same items, in the same tree. */
void sph__box_tree_refit(sph__box_tree *tree, const sph__box *boxes);

static inline bool sph__box_tree_is_leaf(const sph__box_tree *tree, uint32_t node)
{
    return node >> tree->depth != 0;
}

static inline uint32_t sph__box_visit_middle(const sph__box_visit *v)
{
    return v->begin + (v->end - v->begin) / 2;
}

/* Squared distance from x to the box, 0 inside. */
static inline double sph__box_distance2(const sph__box *box, const double x[3])
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const double below = box->low[k] - x[k], above = x[k] - box->high[k];
        const double d = below > above ? below : above;
        sum += d > 0 ? d * d : 0;
    }
    return sum;
}

/* The box of doubles, rounded outward. */
void sph__box_set(sph__box *box, const double low[3], const double high[3]);

#endif
