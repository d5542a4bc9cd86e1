/* SPDX-License-Identifier: MIT */
/* A GLB of a level in the making. */
#ifndef SPH_LEVEL_GLB_H
#define SPH_LEVEL_GLB_H

#include "io/gltf_write.h"
#include "io/level_export.h"

/* The bytes, in their order. */
enum { BALL, BALL_INDICES, ORIGINS, JOINTS, WEIGHTS, TRIANGLES, EDGES, TIMES, CENTERS, SCALES, VIEW_COUNT };

typedef struct sph__io_glb {
    sph__io_gltf_writer file;
    const sph_level_arrays *a;
    const sph__io_export *of;  /* NULL: without extras */
    bool *used;                /* of each sphere, with extras: an edge or a triangle has it */
    unsigned view[VIEW_COUNT]; /* number of each that there is */
} sph__io_glb;

/* Ends the scene's list of nodes, of which the next is `first`. */
void sph__io_glb_scene_extras(sph__io_glb *w, uint32_t first);
/* Inside the node of a sphere. */
void sph__io_glb_sphere_extras(sph__io_glb *w, uint32_t sphere);
/* Node `first`, and one for each capsule and thick triangle below it. */
void sph__io_glb_primitives(sph__io_glb *w, uint32_t first);

#endif
