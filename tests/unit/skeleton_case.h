/* SPDX-License-Identifier: MIT */
/* What the tests of skeletons share: bones with random rigid motions, linked two by two, and joints made of them. */
#ifndef SPH_TEST_SKELETON_CASE_H
#define SPH_TEST_SKELETON_CASE_H

#include "context_case.h"

enum { MOST = 40, FRAMES = 12 };

extern uint64_t seed;
extern uint32_t bone_count, links[3 * MOST][2];
extern size_t link_count;
extern double transforms[FRAMES][MOST][12], packed[FRAMES * MOST * 12], pivots[MOST][3], radii[MOST];

/* The fixture, ended by teardown(): two linked bones that move in any way. */
void setup_skeleton(void);
void use_random_links(void);
double uniform(double low, double high);

/* --- rigid motions --- */
void turn(const double axis[3], double angle, double t[12]);
/* About a line through `p`. */
void turn_about(const double p[3], const double axis[3], double angle, double t[12]);
void product(const double a[12], const double b[12], double out[12]);
/* Bone `b` is bone `a`, turned about `point` in every frame; about one axis, or about another in each. */
void hinge(uint32_t a, uint32_t b, const double point[3], const double *axis, double angle);

/* --- skins, of which only bones matter here, and skeletons --- */
sph_skin *make_skin_in(sph_context *own);
sph_skeleton *make_with(const sph_skeleton_options *options, sph_skeleton_arrays *a);
sph_skeleton *make_rooted(uint32_t root, sph_skeleton_arrays *a);
void check_point(const double *p, const double *expected, double tolerance);
/* That the order lists each joint once, after its parent. */
void check_tree(const sph_skeleton_arrays *a, uint32_t roots);

#endif
