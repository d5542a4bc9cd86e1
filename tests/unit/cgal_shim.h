/* SPDX-License-Identifier: MIT */
/* Distances from points to triangles, and whether triangles meet, by CGAL's exact predicates, for C. */
#ifndef SPH_TEST_CGAL_SHIM_H
#define SPH_TEST_CGAL_SHIM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles must not be degenerate. Distances of `point_count` points (3 doubles each) go to `distances`. */
void cgal_distances(const float *xyz, const uint32_t *triangles, size_t triangle_count, const double *points,
                    size_t point_count, double *distances);

/* Whether two triangles (9 floats each, not degenerate) have a point in common, by exact predicates. */
int cgal_triangles_meet(const float *p, const float *q);

#ifdef __cplusplus
}
#endif

#endif
