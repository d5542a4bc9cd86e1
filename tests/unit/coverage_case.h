/* SPDX-License-Identifier: MIT */
/* What the tests of coverage share: points, levels of random solids, and the calls that must work. */
#ifndef SPH_TEST_COVERAGE_CASE_H
#define SPH_TEST_COVERAGE_CASE_H

#include "context_case.h"
#include "solid.h"

enum { POINTS = 40, FRAMES = 3 };

/* A ball, a capsule along x, and a thick triangle in the plane z = 0, each of radius 1/2. */
extern const test_solid SOLIDS[3];

/* An animation of nothing but points; NULL when memory is out. */
sph_animation *points(sph_context *of, const float *xyz, uint32_t count, uint32_t frames);
void random_points(uint64_t *state, float *xyz, size_t count);
test_solid random_solid(uint64_t *state);
/* The same solid in all frames. */
sph_level *still_level(sph_context *of, const test_solid *s, uint32_t frames, uint32_t per_frame);

sph_coverage measure(const sph_animation *animation, const sph_level *level);
sph_level *inflate(const sph_animation *animation, const sph_level *level, double margin, sph_inflation *out);

#endif
