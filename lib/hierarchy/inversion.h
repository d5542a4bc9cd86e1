/* SPDX-License-Identifier: MIT */
/* Which collapses turn triangles over, summed over frames. */
#ifndef SPH_HIERARCHY_INVERSION_H
#define SPH_HIERARCHY_INVERSION_H

#include "hierarchy/connectivity.h"

/*
 * Whether one of the surviving triangles of u or v turns over when both move to `center`. Every node has three rows of
 * `stride` floats in `centers`, a multiple of SPH__LANES.
 */
bool sph__collapse_inverts(const sph__connectivity *mesh, const float *centers, size_t stride, uint32_t u, uint32_t v,
                           const float *center);

#endif
