/* SPDX-License-Identifier: MIT */
/* What the tests of hierarchies and their levels share. */
#ifndef SPH_TEST_HIERARCHY_CASE_H
#define SPH_TEST_HIERARCHY_CASE_H

#include "context_case.h"

enum { MODES = 3 }; /* of radii */

sph_hierarchy_options default_options(void);
/* NULL: all defaults. */
sph_hierarchy *build(const sph_animation *animation, const sph_hierarchy_options *options);
sph_hierarchy *build_mode(const sph_animation *animation, int32_t radius_mode);

/* Of various modes and importances, with coherence and without. */
enum { CHOICES = MODES * 4 };
sph_hierarchy_options choose(unsigned choice);

sph_level_arrays arrays_of(const sph_level *level);
/* Of one frame. */
sph_level *make_level(uint32_t spheres, const float *centers, const float *radii, size_t edge_count,
                      const uint32_t *edges, size_t triangle_count, const uint32_t *triangles);

#endif
