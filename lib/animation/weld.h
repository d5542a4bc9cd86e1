/* SPDX-License-Identifier: MIT */
/* Which vertices are one: shared between the exact way and the way with a tolerance. */
#ifndef SPH_WELD_H
#define SPH_WELD_H

#include "animation/animation.h"
#include "animation/partition.h"

typedef struct sph__weld {
    const sph_animation *animation;
    double tolerance;
    float *scratch;    /* of one frame, NULL where they are held */
    uint32_t *leaders; /* n entries: the vertex that stands for a vertex; itself where nothing is welded */
    sph__partition partition;
    sph__progress progress;
} sph__weld;

/* The next frame of a pass over all of them, checked to be finite. Reports progress. */
sph_status sph__weld_frame(sph__weld *weld, const char *stage, uint32_t frame, const float **xyz);
/* Sets the leaders for a tolerance above 0, from a partition refined by all frames. Takes 0.5 of the progress. */
sph_status sph__weld_within_tolerance(sph__weld *weld);

#endif
