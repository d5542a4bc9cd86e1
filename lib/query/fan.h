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

enum { SPH__QUERY_FAN = 4 };

typedef struct __attribute__((aligned(64))) sph__query_fan { /* rows of four are read as vectors */
    double from[3][SPH__QUERY_FAN], span[3][SPH__QUERY_FAN]; /* first centre; from there to the second */
    double share[3][SPH__QUERY_FAN];                         /* span / length^2 */
    double lean[SPH__QUERY_FAN], bias[SPH__QUERY_FAN];
    double radius[SPH__QUERY_FAN], growth[SPH__QUERY_FAN]; /* of the first sphere; what the second has more */
    /* of the face, as in sph__primitive */
    double center[3], plane_normal[3], tilt[3], gradient[2][3], gradient_tilt[2], rise, face_radius;
    int64_t has_faces;
    float normal[3][SPH__QUERY_FAN], low[SPH__QUERY_FAN], high[SPH__QUERY_FAN]; /* slabs */
} sph__query_fan;

_Static_assert(offsetof(sph__query_fan, lean) % 32 == 0 && offsetof(sph__query_fan, normal) % 16 == 0,
               "rows are vectors");

/* A sphere that moves from start to start + way. */
typedef struct sph__query_move {
    double start[3], way[3], radius;
    double tolerance; /* a distance that counts as touching */
} sph__query_move;

void sph__query_fan_set(sph__query_fan *fan, const sph__primitive *primitive);

/* As sph__primitive_distance, but for rounding. */
double sph__query_fan_distance(const sph__query_fan *fan, const double x[3]);

/* A distance in the slabs' directions: no point of the primitive is nearer to x. */
float sph__query_fan_bound(const sph__query_fan *fan, const float x[3]);

/*
 * Of a segment that is in the box from `entry` on: the least t at which it is in the slabs as well, or SPH__QUERY_MISS.
 */
float sph__query_fan_entry(const sph__query_fan *fan, const sph__query_ray *ray, float entry);

/*
 * The first t from *t to 1 at which the primitive is touched goes to *t, the distance there less the radius to
 * *distance; false: there is none, or only beyond `limit`.
 */
bool sph__query_approach(const sph__query_fan *fan, const sph__query_move *move, double limit, double *t,
                         double *distance);

#endif
