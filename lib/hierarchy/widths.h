/* SPDX-License-Identifier: MIT */
/* What the two halves of the widths share: rows of slots, and vectors that keep the least and the most. */
#ifndef SPH_HIERARCHY_WIDTHS_H
#define SPH_HIERARCHY_WIDTHS_H

#include <math.h>

#include "hierarchy/build.h"
#include "hierarchy/lanes.h"

/* The intervals of a slot's probes: low ends, then high ends. Bounds of them, where they are not all frames. */
static inline double *sph__probes_of(const sph__builder *b, const sph__slot *slot)
{
    return b->probes + (size_t)(slot - b->slots) * 2 * b->probe_count;
}

static inline float *sph__probe_bounds_of(const sph__builder *b, const sph__slot *slot)
{
    return b->probe_bounds + (size_t)(slot - b->slots) * 2 * b->probe_count;
}

/* The points of a union are placed in the order 0, spread_stride, 2 spread_stride ... of their numbers. */
static inline size_t sph__next_spread(const sph__extents *e, size_t number)
{
    number += e->spread_stride;
    return number < e->point_count ? number : number - e->point_count;
}

/* Chooses witnesses from the points, and finds their extents; returns how far rounding may move these. */
double sph__place_witnesses(const sph__builder *b, sph__extents *e);
/* The points at both ends of direction k, in a lane of the points that are placed, become guards, while there is room. */
void sph__add_guards(sph__extents *e, const double k[3], size_t lane);
/* Eight frames of the guards, from i on, as the points are placed. */
void sph__place_guards(const sph__builder *b, const sph__extents *e, size_t i, double *placed);

SPH__INLINE void sph__fill(double x, sph__v8d *v)
{
    *v = (sph__v8d){x, x, x, x, x, x, x, x};
}

SPH__INLINE double sph__least_lane(const sph__v8d *v)
{
    double least = (*v)[0];
    for (size_t l = 1; l < SPH__LANES; ++l) least = (*v)[l] < least ? (*v)[l] : least;
    return least;
}

#endif
