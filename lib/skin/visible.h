/* SPDX-License-Identifier: MIT */
/* Whether a vertex of the rest mesh sees a point. */
#ifndef SPH_SKIN_VISIBLE_H
#define SPH_SKIN_VISIBLE_H

#include "level/box_tree.h"

typedef struct sph__occluder {
    const float *xyz;          /* borrowed, [n][3] */
    const uint32_t *triangles; /* borrowed */
    sph__box_tree tree;
} sph__occluder;

/* Zeroes `occluder` first; free it also after a failure. */
sph_status sph__occluder_init(sph__occluder *occluder, const sph_context *context, const float *xyz,
                              const uint32_t *triangles, size_t triangle_count);
void sph__occluder_free(sph__occluder *occluder);

/* Whether no triangle but those of `vertex` itself meets the open segment from it to `point`. */
bool sph__occluder_sees(const sph__occluder *occluder, uint32_t vertex, const double point[3]);

#endif
