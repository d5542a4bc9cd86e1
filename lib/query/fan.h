/* SPDX-License-Identifier: MIT */
/*
 * Primitives once more, for speed: three edges side by side in vectors of four, evaluated without branches. A capsule
 * is the same edge four times, a sphere an edge of no length. The sphere of an edge that is nearest to x is at u =
 * d.share - across * lean + bias, clamped to [0, 1]: d from its first centre, across the distance from its axis. Where
 * the weights of the face are within the triangle, the face is nearest.
 *
 * Four slabs bound the primitive tighter than its box: across a triangle and its three edges, around an axis.
 */
#ifndef SPH_QUERY_FAN_H
#define SPH_QUERY_FAN_H

#include <stddef.h>

#include "level/primitive.h"
#include "query/kernel.h"

enum { SPH__QUERY_FAN = 4, SPH__QUERY_STEPS = 100 };

typedef struct __attribute__((aligned(64))) sph__query_fan { /* rows of four are read as vectors */
    double from[3][SPH__QUERY_FAN], span[3][SPH__QUERY_FAN]; /* first centre; from there to the second */
    double share[3][SPH__QUERY_FAN];                         /* span / length^2 */
    double lean[SPH__QUERY_FAN], bias[SPH__QUERY_FAN];
    double radius[SPH__QUERY_FAN], growth[SPH__QUERY_FAN]; /* of the first sphere; what the second has more */
    /* of the faces: directions, in which a place counts from the first centre; what height above the plane of the
     * centres adds; constants: that height, the weights of corners 1 and 2, the distance. Without faces no weights are
     * within the triangle. */
    double face[3][SPH__QUERY_FAN], face_height[SPH__QUERY_FAN], face_constant[SPH__QUERY_FAN];
    float normal[3][SPH__QUERY_FAN], low[SPH__QUERY_FAN], high[SPH__QUERY_FAN]; /* slabs */
} sph__query_fan;

_Static_assert(offsetof(sph__query_fan, lean) % 32 == 0 && offsetof(sph__query_fan, normal) % 16 == 0,
               "rows are vectors");

/* A sphere that moves from start to start + way. */
typedef struct sph__query_move {
    double start[3], way[3], radius;
    double tolerance; /* a distance that counts as touching */
} sph__query_move;

/* One of these, and a primitive that it may touch. */
typedef struct sph__query_pair {
    double t;        /* it touches no earlier; above 1: never */
    double distance; /* at t, less the radius; where `touches` */
    uint32_t slot;
    uint16_t move;
    uint8_t touches, steps;
} sph__query_pair;

void sph__query_fan_set(sph__query_fan *fan, const sph__primitive *primitive);

/* As sph__primitive_distance, but for rounding. */
double sph__query_fan_distance(const sph__query_fan *fan, const double x[3]);

/* A distance in the slabs' directions: no point of the primitive is nearer to x. */
float sph__query_fan_bound(const sph__query_fan *fan, const float x[3]);

/* Drops pairs that the slabs show not to touch up to `limit`; returns how many there are left, in the same order. */
uint32_t sph__query_fan_enter(const sph__query_fan *fans, const sph__query_ray *rays, sph__query_pair *pairs,
                              uint32_t count, double limit);

/* A step of Newton's method for each of pairs[which[i]]. */
void sph__query_fan_step(const sph__query_fan *fans, const sph__query_move *moves, sph__query_pair *pairs,
                         const uint32_t *which, uint32_t count);

#endif
