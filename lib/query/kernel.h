/* SPDX-License-Identifier: MIT */
/*
 * Bounds of primitives as a structure of arrays, and the loops over them. A bound is a box along the axes and a slab
 * that is turned as the primitive is; all in the frame of the pose, that is within [-1, 1], in 32 bits. The
 * caller widens them by a margin that covers all rounding, so that what is pruned by them is never within reach. These
 * loops allocate nothing and cannot fail.
 */
#ifndef SPH_QUERY_KERNEL_H
#define SPH_QUERY_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SPH__QUERY_LANES = 16,
    SPH__QUERY_CHUNK = 128, /* boxes that are tested at a time; a multiple of 64 */
    SPH__QUERY_ROWS = 11
};

/* Rows, padded by a whole vector of boxes that nothing meets. */
typedef struct sph__query_bounds {
    float *rows; /* all of them */
    size_t stride;
    float *low[3], *high[3];                 /* rows 0, 2, 4 and 1, 3, 5 */
    float *normal[3], *slab_low, *slab_high; /* rows 6 to 10: of all slabs (fan.h) that which cuts off most */
} sph__query_bounds;

/* The same of a leaf: no vector is on two lines of a cache. */
typedef struct __attribute__((aligned(64))) sph__query_leaf {
    float rows[SPH__QUERY_ROWS][SPH__QUERY_LANES];
    uint32_t all; /* lanes that are primitives, as bits */
} sph__query_leaf;

/*
 * A segment p + t d, 0 <= t <= 1, along which something of extent `reach` moves. Where bounds are no help, all are met.
 */
typedef struct sph__query_ray {
    float above[3], below[3]; /* p plus, minus the reach */
    float inverse[3];         /* 1 / d, never infinite */
    float from[3], way[3];    /* p, d */
    float reach;
} sph__query_ray;

/* How far the two sides of a slab, widened by the reach, are ahead of a place. It is in the slab where the one is no
 * more than 0 and the other no less. */
static inline float sph__query_under(float low, float place, float reach)
{
    return low - (place + reach);
}

static inline float sph__query_over(float high, float place, float reach)
{
    return high - (place - reach);
}

static inline bool sph__query_begins_in_slab(const sph__query_bounds *b, uint32_t slot, const sph__query_ray *ray)
{
    const float place =
        b->normal[0][slot] * ray->from[0] + b->normal[1][slot] * ray->from[1] + b->normal[2][slot] * ray->from[2];
    return sph__query_under(b->slab_low[slot], place, ray->reach) <= 0 &&
           sph__query_over(b->slab_high[slot], place, ray->reach) >= 0;
}

/* What `entry` says where the segment does not meet the box. */
#define SPH__QUERY_MISS 2.0f

/*
 * Which of the boxes [begin, end), at most SPH__QUERY_CHUNK, the segment meets: their numbers in ascending order, and
 * the least t at which it is in each; returns how many.
 */
uint32_t sph__query_kernel_meet(const sph__query_bounds *bounds, size_t begin, size_t end, const sph__query_ray *ray,
                                uint32_t *met, float *entry);

/* bound[i] = a signed distance from x to box begin + i: nothing in it has a lesser one. */
void sph__query_kernel_distances(const sph__query_bounds *bounds, size_t begin, size_t end, const float x[3],
                                 float *bound);

#endif
