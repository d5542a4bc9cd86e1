/* SPDX-License-Identifier: MIT */
/* Internal door of the room "level". */
#ifndef SPH_LEVEL_INTERNAL_H
#define SPH_LEVEL_INTERNAL_H

#include <sphmesh/level.h>

#include "base/base.h"

struct sph_level {
    sph_context *context; /* retained */
    uint32_t sphere_count, frame_count;
    uint32_t radii_per_frame;
    size_t edge_count, triangle_count, label_count;
    float *centers;      /* [frame_count][sphere_count][3] */
    float *radii;        /* [sphere_count], or [frame_count][sphere_count] with radii_per_frame */
    uint32_t *edges;     /* [edge_count][2], of no triangle */
    uint32_t *triangles; /* [triangle_count][3] */
    uint32_t *labels;    /* [label_count], or NULL */
};

/* A level whose arrays have room for what `sizes` counts (its pointers are not looked at) and undefined content. */
sph_status sph__level_allocate(sph_context *context, const sph_level_arrays *sizes, sph_level **out);

/* That all values are finite, radii not negative, and indices in range; SPH_E_INVALID names the first that is not. */
sph_status sph__level_check(const sph_level *level);

/* The radii of one frame. */
const float *sph__level_radii(const sph_level *level, uint32_t frame);
/* The centres of one frame. */
const float *sph__level_centers(const sph_level *level, uint32_t frame);

#endif
