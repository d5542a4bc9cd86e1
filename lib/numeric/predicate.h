/* SPDX-License-Identifier: MIT */
/* Signs that are exact for points of floats: filtered by doubles, and where these cannot tell by sums of doubles. */
#ifndef SPH_NUMERIC_PREDICATE_H
#define SPH_NUMERIC_PREDICATE_H

#include <stdbool.h>

/* The sign of det(b - a, c - a, d - a): 1 where d is on the side that the triangle abc faces, counter-clockwise. */
int sph__orient3(const float a[3], const float b[3], const float c[3], const float d[3]);
/* The sign of det(b - a, c - a) in the coordinates x and y. */
int sph__orient2(const float a[3], const float b[3], const float c[3], int x, int y);

/*
 * Whether two triangles have a point in common besides corners that they share; corners are shared where all three
 * numbers are equal. Triangles that share all three are said not to, and those with two corners in one place; others without
 * area have their edges only.
 */
bool sph__triangles_meet(const float *const p[3], const float *const q[3]);

#endif
