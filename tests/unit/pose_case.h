/* SPDX-License-Identifier: MIT */
/* What the tests of poses share: a skin of random weights, random poses of it, and how these are moved and compared. */
#ifndef SPH_TEST_POSE_CASE_H
#define SPH_TEST_POSE_CASE_H

#include "support.h"

enum { BONES = 5, SLOTS = 4, VERTICES = 2500, POSES = 11 };

extern sph_context *context;
extern float rest[VERTICES][3], normals[VERTICES][3], weights[VERTICES][SLOTS];
extern uint32_t bones[VERTICES][SLOTS];
extern double transforms[POSES][BONES][12], pivots[BONES][3]; /* rigid, turned by up to 1.5 */
extern float moved[POSES][VERTICES][3], turned[POSES][VERTICES][3];
extern sph_skin_arrays arrays;
extern const double IDENTITY[12];

void setup(void);
void teardown(void);
/* The deformer of `arrays` and `normals`. */
sph_deformer *make(void);
/* Moves the first `count` poses into `moved` and `turned`. */
void pose(int32_t method, size_t count);

double uniform(double low, double high);
/* A rotation by `angle` about `axis`, which has length 1, and a translation. */
void make_rigid(const double axis[3], double angle, const double shift[3], double out[12]);
/* A rotation by `angle` about any axis, and a translation of up to 1 along each. */
void random_rigid(double angle, double out[12]);
void apply(const double transform[12], const double p[3], double out[3]);
/* A normal by the inverse of the transform's linear part, transposed, with length 1. */
void turn_normal(const double transform[12], const float *n, double out[3]);
void check_point(const float *got, const double *expected, double tolerance);

#endif
