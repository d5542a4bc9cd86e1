/* SPDX-License-Identifier: MIT */
/* What the tests of implicit skinning share: a closed tube along x that two bones bend and twist at its middle. */
#ifndef SPH_TEST_IMPLICIT_CASE_H
#define SPH_TEST_IMPLICIT_CASE_H

#include "support.h"

enum {
    TUBE_RINGS = 61,
    TUBE_SIDES = 24,
    TUBE_VERTICES = TUBE_RINGS * TUBE_SIDES + 2,
    TUBE_TRIANGLES = 2 * TUBE_RINGS * TUBE_SIDES
};

/* x from -4 to 4, radius 1; weights go from one bone to the other over x from -1 to 1. */
typedef struct tube {
    float rest[TUBE_VERTICES][3];
    uint32_t triangles[TUBE_TRIANGLES][3];
    uint32_t bones[TUBE_VERTICES][2];
    float weights[TUBE_VERTICES][2];
    double pivots[2][3];
    uint32_t parents[2];
    sph_skin_arrays arrays;
} tube;

void tube_init(tube *t);
/* NULL members where the library fails. */
sph_skin *tube_skin(const tube *t, sph_context *context);
sph_implicit *tube_implicit(const sph_skin *skin, const tube *t, int32_t operation);
/* The second bone turned by so many radians about the joint at the origin: bent about z, twisted about x. */
void tube_pose(double bend, double twist, double transforms[2][12]);
/* Of a closed mesh; triangles outward. */
double mesh_volume(const float *positions, const uint32_t *triangles, size_t triangle_count);

#endif
