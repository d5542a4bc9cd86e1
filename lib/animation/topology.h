/* SPDX-License-Identifier: MIT */
/* What the report says about connectivity alone. */
#ifndef SPH_TOPOLOGY_H
#define SPH_TOPOLOGY_H

#include "animation/animation.h"

/*
 * Patches: the components that triangles join, without the wires, each named by its lowest vertex.
 */
typedef struct sph__patches {
    uint32_t *of;    /* n entries: the patch of a vertex */
    uint8_t *closed; /* n entries, by the patch's name: has triangles, and each edge as often in one direction as the
                        other */
} sph__patches;

/* Fills the counts of the report that need no positions. Give `patches` back with sph__patches_free, after failure
 * also. */
sph_status sph__topology_count(const sph_animation *animation, sph_animation_report *report, sph__patches *patches,
                               sph__progress *progress);
void sph__patches_free(const sph_context *context, sph__patches *patches);

#endif
