/* SPDX-License-Identifier: MIT */
/* The options that hierarchies are compared with. */
#ifndef SPHMESH_TESTS_VARIANTS_H
#define SPHMESH_TESTS_VARIANTS_H

#include "cases.h"

enum importance_kind { PLAIN, BY_VERTEX, BY_VERTEX_AND_FRAME, EXTREME };

struct variant {
    enum case_motion motion;
    uint32_t frame_count;
    enum importance_kind importance;
    enum reference_radius_mode radius_mode;
    double radius_factor, temporal_coherence;
    uint32_t width_directions;
};

/* Number `index` of the endless ways to treat a shape. */
struct variant make_variant(enum case_shape shape, unsigned index);
/* [F][n] weights */
float *make_importance(const struct case_mesh *mesh, enum importance_kind kind, uint64_t seed);
sph_animation *make_animation(sph_context *context, const struct case_mesh *mesh);
/* `importance` is borrowed. */
sph_hierarchy_options make_options(const struct variant *variant, const struct case_mesh *mesh,
                                   const float *importance);
/* `importance` and `directions` are borrowed. */
struct reference_input make_input(const struct variant *variant, const struct case_mesh *mesh, const float *importance,
                                  const double *directions);

#endif
