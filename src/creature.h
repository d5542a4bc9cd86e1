/* SPDX-License-Identifier: MIT */
/* A walking animal made of nothing but this code: something to try the program on without any file. */
#ifndef CREATURE_H
#define CREATURE_H

#include <sphmesh/animation.h>

enum {
    CREATURE_FRAMES = 48,
    CREATURE_RESOLUTION = 48,     /* cells along the body: about 8,000 vertices */
    CREATURE_RESOLUTION_MIN = 32, /* below, ears and feet fall between the cells */
    CREATURE_RESOLUTION_MAX = 200,
    CREATURE_FRAMES_MAX = 10000
};

/*
 * Makes the creature walking one loop of `frame_count` frames: y is up, x forward, about 3.3 units long. Closed,
 * manifold, one component, wound outward. The same bits on every machine: it uses no function of libm but the square
 * root.
 */
sph_status creature_create(sph_context *context, uint32_t frame_count, uint32_t resolution, sph_animation **out);

#endif
