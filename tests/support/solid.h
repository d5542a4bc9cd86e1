/* SPDX-License-Identifier: MIT */
/*
 * The solid by its definition, slowly: spheres interpolated over weights, the least of |x - c(b)| - r(b) found by
 * nested search. Nothing here shares a formula with the library.
 */
#ifndef SPH_TEST_SOLID_H
#define SPH_TEST_SOLID_H

#include <sphmesh/sphmesh.h>

enum { TEST_SOLID_SPHERES = 32, TEST_SOLID_SIMPLICES = 32 };

typedef struct test_solid {
    uint32_t sphere_count, edge_count, triangle_count;
    float centers[TEST_SOLID_SPHERES][3], radii[TEST_SOLID_SPHERES];
    uint32_t edges[TEST_SOLID_SIMPLICES][2], triangles[TEST_SOLID_SIMPLICES][3];
} test_solid;

sph_level *test_solid_level(sph_context *context, const test_solid *solid);
/* Largest extent of anything that the solid fills; not 0. */
double test_solid_size(const test_solid *solid);
/* The least |x - c(b)| - r(b) over `count` spheres' weights. */
double test_simplex_distance(const test_solid *solid, const uint32_t *spheres, int count, const double x[3]);
/* Over all simplices and spheres. */
double test_solid_distance(const test_solid *solid, const double x[3]);
/* The first s in [0, 1] at which the distance of from + s (to - from) is at most `radius` (any); 2: none. */
double test_solid_cast(const test_solid *solid, const double from[3], const double to[3], double radius);

#endif
