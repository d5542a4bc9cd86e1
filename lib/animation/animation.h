/* SPDX-License-Identifier: MIT */
/* Internal door of the room "animation": the handle laid open, and frames by pointer. */
#ifndef SPH_ANIMATION_ROOM_H
#define SPH_ANIMATION_ROOM_H

#include <sphmesh/animation.h>

#include "base/base.h"

/* Most triangles, and most edges, of one animation: 3 indices each, and their edges, still count in 64 bits with ease.
 */
enum { SPH__SIMPLEX_LIMIT = 0x7fffffff };

struct sph_animation {
    sph_context *context; /* retained */
    uint32_t vertex_count, frame_count;
    float *positions; /* frame-major [F][n][3]; NULL with a source, and where they are the caller's */
    const char *borrowed; /* the caller's, by its strides in bytes; else NULL */
    size_t stride, frame_stride;
    sph_frame_source source;
    uint32_t *triangles; /* NULL where there are none */
    size_t triangle_count;
    uint32_t *edges; /* NULL where there are none */
    size_t edge_count;
};

/*
 * Memory for one frame, 3 n floats, where the animation pulls its frames; NULL, which suits sph__animation_frame, where
 * it holds them, or the caller does, one after another. Give it back with sph__free.
 */
sph_status sph__animation_scratch(const sph_animation *animation, float **scratch);

/*
 * The positions of a frame below F in *xyz: borrowed where the animation holds them, else read into `scratch`. One
 * thread at a time for an animation with a source; any number of threads otherwise.
 */
sph_status sph__animation_frame(const sph_animation *animation, uint32_t frame, float *scratch, const float **xyz);

/* For a triangle (3 corners) or an edge (2). */
static inline bool sph__names_vertex_twice(const uint32_t *simplex, uint32_t corners)
{
    return corners == 2 ? simplex[0] == simplex[1]
                        : simplex[0] == simplex[1] || simplex[1] == simplex[2] || simplex[2] == simplex[0];
}

/* SPH_E_INVALID, with a message that names frame and vertex, when one of the n positions is not finite. */
sph_status sph__check_finite(const sph_context *context, uint32_t frame, const float *xyz, uint32_t n);

#endif
