/* SPDX-License-Identifier: MIT */
/* What the tests of quadrics share. */
#ifndef SPH_TEST_QUADRIC_CASE_H
#define SPH_TEST_QUADRIC_CASE_H

#include <sphmesh/quadric.h>

#include "context_case.h"

sph_quadric *make_quadric(uint32_t frame_count);
void add_plane(sph_quadric *quadric, uint32_t frame, double x, double y, double z, double nx, double ny, double nz,
               double weight);
/* Six planes of weight 1, at `half` from the center along each axis; outward, or inward where `sign` is -1. */
void add_cuboid(sph_quadric *quadric, uint32_t frame, const double center[3], const double half[3], double sign);

#endif
