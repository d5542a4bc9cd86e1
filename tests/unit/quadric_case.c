/* SPDX-License-Identifier: MIT */
#include "quadric_case.h"

sph_quadric *make_quadric(uint32_t frame_count)
{
    sph_quadric *quadric;
    ck_assert_int_eq(sph_quadric_create(context, frame_count, &quadric), SPH_OK);
    return quadric;
}

void add_plane(sph_quadric *quadric, uint32_t frame, double x, double y, double z, double nx, double ny, double nz,
               double weight)
{
    const double point[3] = {x, y, z}, normal[3] = {nx, ny, nz};
    ck_assert_int_eq(sph_quadric_add_plane(quadric, frame, point, normal, weight), SPH_OK);
}

void add_cuboid(sph_quadric *quadric, uint32_t frame, const double center[3], const double half[3], double sign)
{
    for (int axis = 0; axis < 3; ++axis)
        for (int side = -1; side <= 1; side += 2) {
            double point[3], normal[3] = {0, 0, 0};
            memcpy(point, center, sizeof point);
            point[axis] += side * half[axis];
            normal[axis] = sign * side * 7.0; /* any length will do */
            ck_assert_int_eq(sph_quadric_add_plane(quadric, frame, point, normal, 1.0), SPH_OK);
        }
}
