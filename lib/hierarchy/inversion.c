/* SPDX-License-Identifier: MIT */
#include "hierarchy/inversion.h"

#include "hierarchy/kernel.h"

/* Whether one of the surviving triangles of `node` turns over when the node moves to the new centre. */
static bool inverts_around(const sph__connectivity *mesh, const float *centers, size_t stride, uint32_t node,
                           uint32_t other, const float *center)
{
    const uint32_t *triangles = sph__list_items(&mesh->node_triangles, node);
    const uint32_t count = sph__list_count(&mesh->node_triangles, node);
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

/* The same of one frame: eight triangles at once. */
static bool single_inverts_around(const sph__connectivity *mesh, const float *centers, uint32_t node, uint32_t other,
                                  const float *center)
{
    const uint32_t *triangles = sph__list_items(&mesh->node_triangles, node);
    const uint32_t count = sph__list_count(&mesh->node_triangles, node);
    _Alignas(SPH__ALIGN) float corners[4][3][SPH__LANES] = {{{0}}}; /* no triangle: a point, which does not turn */
    size_t lane = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t x[2];
        sph__triangle_others(mesh, triangles[i], node, x);
        if (x[0] == other || x[1] == other) continue;
        for (size_t k = 0; k < 3; ++k) {
            corners[0][k][lane] = centers[3 * (size_t)x[0] + k];
            corners[1][k][lane] = centers[3 * (size_t)x[1] + k];
            corners[2][k][lane] = centers[3 * (size_t)node + k];
            corners[3][k][lane] = center[k];
        }
        if (++lane < SPH__LANES) continue;
        if (sph__kernel_any_inversion(corners)) return true;
        lane = 0; /* what stays in the lanes does not turn */
    }
    return lane > 0 && sph__kernel_any_inversion(corners);
}

bool sph__collapse_inverts(const sph__connectivity *mesh, const float *centers, size_t stride, uint32_t u, uint32_t v,
                           const float *center)
{
    if (stride == 1)
        return single_inverts_around(mesh, centers, u, v, center) || single_inverts_around(mesh, centers, v, u, center);
    return inverts_around(mesh, centers, stride, u, v, center) || inverts_around(mesh, centers, stride, v, u, center);
}
