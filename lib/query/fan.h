/* SPDX-License-Identifier: MIT */
/*
 * Primitives once more, for speed: three edges side by side in vectors of four, evaluated without branches. A capsule
 * is the same edge four times, once the other way round, a sphere an edge of no length: the first lanes begin at the
 * corners. The sphere of an edge that is nearest to x is at u =
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

enum { SPH__QUERY_TABLE = 16 }; /* a multiple of 8 */

/* Spheres that move from start to start + way, side by side. */
typedef struct __attribute__((aligned(64))) sph__query_moves {
    double start[3][SPH__QUERY_TABLE], way[3][SPH__QUERY_TABLE], radius[SPH__QUERY_TABLE];
    double squared[SPH__QUERY_TABLE];   /* length of the way */
    double tolerance[SPH__QUERY_TABLE]; /* a distance that counts as touching */
} sph__query_moves;

/* Moves, each with a primitive that it may touch, side by side. */
typedef struct __attribute__((aligned(64))) sph__query_table {
    double t[SPH__QUERY_TABLE];        /* it touches no earlier; above 1: never */
    double distance[SPH__QUERY_TABLE]; /* at t, less the radius; where it touches */
    int64_t touches[SPH__QUERY_TABLE];
    /* of the step: what the foot in approach.c says */
    double course[SPH__QUERY_TABLE], length[SPH__QUERY_TABLE], soft[SPH__QUERY_TABLE];
    double weights[2][SPH__QUERY_TABLE], climbs[2][SPH__QUERY_TABLE];
    uint32_t slot[SPH__QUERY_TABLE];
} sph__query_table;

void sph__query_fan_set(sph__query_fan *fan, const sph__primitive *primitive);

/* As sph__primitive_distance, but for rounding. */
double sph__query_fan_distance(const sph__query_fan *fan, const double x[3]);

/* A distance in the slabs' directions: no point of the primitive is nearer to x. */
float sph__query_fan_bound(const sph__query_fan *fan, const float x[3]);

/* Of the primitives in `slots` those whose slabs the segment, which is in their boxes from entry[i] on, meets no later
 * than `limit`; returns how many there are left, in the same order. May be done in place. */
uint32_t sph__query_fan_enter(const sph__query_fan *fans, const sph__query_ray *ray, const float *entry,
                              uint32_t *slots, uint32_t count, double limit);

/* A step of Newton's method for each of the first `count`. */
void sph__query_fan_step(const sph__query_fan *fans, const sph__query_moves *moves, sph__query_table *table,
                         uint32_t count);

/* Places, side by side, and those of primitives that are nearest to them. */
typedef struct __attribute__((aligned(64))) sph__query_places {
    double x[3][SPH__QUERY_TABLE];
    double weights[3][SPH__QUERY_TABLE]; /* of the corners */
    double center[3][SPH__QUERY_TABLE], radius[SPH__QUERY_TABLE];
    double normal[3][SPH__QUERY_TABLE], point[3][SPH__QUERY_TABLE];
    double squared[SPH__QUERY_TABLE]; /* distance from that centre; where it is nearly 0, the normal is noise */
} sph__query_places;

/* Of primitive slots[i] for x[..][i]; the others are no numbers, or any. */
void sph__query_fan_closest(const sph__query_fan *fans, const uint32_t *slots, const int32_t *corner_counts,
                            sph__query_places *places, uint32_t count);

#endif
