/* SPDX-License-Identifier: MIT */
#include "hierarchy/inversion.h"

#include "hierarchy/kernel.h"

/* Whether one of the surviving triangles of `node` turns over when the node moves to the new centre. */
static bool inverts_around(const sph__connectivity *mesh, const float *centers, size_t stride, uint32_t node,
                           uint32_t other, const float *center)
{
    const uint32_t *triangles = sph__triangles_of(mesh, node);
    const uint32_t count = sph__triangle_count_of(mesh, node);
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t x[2];
        sph__triangle_others(mesh, triangles[i], node, x);
        if (x[0] == other || x[1] == other) continue;
        if (sph__kernel_inverts(centers + x[0] * 3 * stride, centers + x[1] * 3 * stride, centers + node * 3 * stride,
                                center, stride))
            return true;
    }
    return false;
}

bool sph__collapse_inverts(const sph__connectivity *mesh, const float *centers, size_t stride, uint32_t u, uint32_t v,
                           const float *center)
{
    return inverts_around(mesh, centers, stride, u, v, center) || inverts_around(mesh, centers, stride, v, u, center);
}
