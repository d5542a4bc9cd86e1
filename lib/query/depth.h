/* SPDX-License-Identifier: MIT */
/*
 * How deep a place is in a primitive, with 32 bits: the least of the distances to its edges' capsules and, where the
 * place is above or below the triangle, that to its faces. Any sphere of the primitive bounds the distance from above,
 * so that only the choice of the sphere can make it too great, which is what `loose` is for (parts.c).
 */
#ifndef SPH_QUERY_DEPTH_H
#define SPH_QUERY_DEPTH_H

#include "query/parts.h"

/* To the capsule along the edge that begins at a corner; v is the place relative to that. */
SPH__INLINE float sph__query_depth_edge(float vx, float vy, float vz, float ax, float ay, float az, float radius,
                                        float sine, float tangent, float whole)
{
    const float z = vx * ax + vy * ay + vz * az, wx = vx - z * ax, wy = vy - z * ay, wz = vz - z * az;
    const float squared = wx * wx + wy * wy + wz * wz, foot = z - sqrtf(squared) * tangent;
    const float place = sph__query_least(sph__query_most(foot, 0), whole), past = z - place;
    return sqrtf(squared + past * past) - radius + sine * place;
}

/* One of the four measures of the faces, but for what height adds; v is relative to the first corner. */
SPH__INLINE float sph__query_depth_plane(float vx, float vy, float vz, float nx, float ny, float nz)
{
    return nx * vx + ny * vy + nz * vz;
}

/* The distance: of the edges, or of the faces where their weights say so. */
SPH__INLINE float sph__query_depth_choose(float edges, float first, float second, float face)
{
    const int is_face = (first >= 0) & (second >= 0) & (first + second <= 1);
    return is_face ? face : edges;
}

/* The key of a line that may begin within; above 0: it does not. */
SPH__INLINE float sph__query_depth_key(float distance, float loose, float reach)
{
    return distance - loose * (1 + reach) - reach;
}

#endif
