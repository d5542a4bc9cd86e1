/* SPDX-License-Identifier: MIT */
#include "variants.h"

#include <math.h>
#include <stdlib.h>

#include "support.h"

static const uint32_t FRAME_COUNTS[8] = {1, 2, 3, 7, 8, 9, 16, 20};
struct variant make_variant(enum case_shape shape, unsigned index)
{
    static const double factors[4] = {0.75, 0.75, 0.2, 3};
    const unsigned s = (unsigned)shape;
    return (struct variant){.motion = (enum case_motion)((index + s) % CASE_MOTION_COUNT),
                            .frame_count = FRAME_COUNTS[(index * 5 + s + index / 8) % 8],
                            .importance = (enum importance_kind)((index / 2 + s) % 3),
                            .radius_mode = (enum reference_radius_mode)(index % 3),
                            .radius_factor = factors[(index / 3) % 4],
                            .temporal_coherence = index % 5 == 3   ? 0.02
                                                  : index % 5 == 4 ? 1.5
                                                                   : 0,
                            .width_directions = index % 4 == 1 ? 3 : 30};
}

sph_animation *make_animation(sph_context *context, const struct case_mesh *mesh)
{
    sph_animation *animation;
    if (sph_animation_create(context, mesh->vertex_count, mesh->frame_count, &animation) != SPH_OK) abort();
    for (uint32_t f = 0; f < mesh->frame_count; ++f) {
        const float *positions = mesh->positions + 3 * (size_t)f * mesh->vertex_count;
        if (sph_animation_set_frame(animation, f, positions, 0) != SPH_OK) abort();
    }
    if (sph_animation_set_triangles(animation, mesh->triangles, mesh->triangle_count, 0) != SPH_OK) abort();
    if (sph_animation_set_edges(animation, mesh->edges, mesh->edge_count, 0) != SPH_OK) abort();
    return animation;
}

float *make_importance(const struct case_mesh *mesh, enum importance_kind kind, uint64_t seed)
{
    uint64_t state = seed;
    float *weights = test_malloc((size_t)mesh->frame_count * mesh->vertex_count, sizeof *weights);
    for (uint32_t f = 0; f < mesh->frame_count; ++f)
        for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
            float *weight = weights + (size_t)f * mesh->vertex_count + i;
            *weight = (float)(0.2 + 3 * test_random_unit(&state));
            if (test_random(&state) % 20 == 0) *weight = 0;
            if (kind == BY_VERTEX && f > 0) *weight = weights[i];
            if (kind == PLAIN) *weight = 1;
            if (kind == EXTREME) *weight = (float)pow(10, 4 * test_random_unit(&state) - 2);
        }
    return weights;
}

sph_hierarchy_options make_options(const struct variant *variant, const struct case_mesh *mesh, const float *importance)
{
    static const int32_t modes[3] = {SPH_RADIUS_CONSTANT, SPH_RADIUS_PER_FRAME, SPH_RADIUS_ZERO};
    sph_hierarchy_options options;
    sph_hierarchy_options_init(&options, sizeof options);
    options.importance = variant->importance == PLAIN ? SPH_IMPORTANCE_NONE : SPH_IMPORTANCE_CALLER;
    options.importance_weights = variant->importance == PLAIN ? NULL : importance;
    options.importance_frame_stride = variant->importance == BY_VERTEX ? 0 : mesh->vertex_count;
    options.orientation = SPH_ORIENTATION_AS_GIVEN;
    options.radius_mode = modes[variant->radius_mode];
    options.radius_factor = variant->radius_factor;
    options.temporal_coherence = variant->temporal_coherence;
    options.width_directions = variant->width_directions;
    return options;
}

struct reference_input make_input(const struct variant *variant, const struct case_mesh *mesh, const float *importance,
                                  const double *directions)
{
    struct reference_input input = case_input(mesh);
    input.importance = importance;
    input.radius_mode = variant->radius_mode;
    input.radius_factor = variant->radius_factor;
    input.temporal_coherence = variant->temporal_coherence;
    input.direction_count = variant->width_directions;
    input.directions = directions;
    return input;
}
