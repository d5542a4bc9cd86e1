/* SPDX-License-Identifier: MIT */
/* A GLB of a level in the making. */
#ifndef SPH_LEVEL_GLB_H
#define SPH_LEVEL_GLB_H

#include "io/level_export.h"

/* The bytes, in their order. */
enum { BALL, BALL_INDICES, ORIGINS, JOINTS, WEIGHTS, TRIANGLES, EDGES, TIMES, CENTERS, SCALES, VIEW_COUNT };

/* Text that grows, and the bytes that it speaks of. */
typedef struct sph__io_glb {
    sph_context *context;
    const sph_level_arrays *a;
    const sph__io_export *of; /* NULL: without extras */
    bool *used;               /* of each sphere, with extras: an edge or a triangle has it */
    char *text;
    size_t length, capacity;
    bool failed;
    uint64_t binary;           /* bytes so far */
    unsigned view[VIEW_COUNT]; /* number of each that there is */
    unsigned views, accessors;
} sph__io_glb;

void sph__io_glb_add(sph__io_glb *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sph__io_glb_add_float(sph__io_glb *w, float value);

/* Ends the scene's list of nodes, of which the next is `first`. */
void sph__io_glb_scene_extras(sph__io_glb *w, uint32_t first);
/* Inside the node of a sphere. */
void sph__io_glb_sphere_extras(sph__io_glb *w, uint32_t sphere);
/* Node `first`, and one for each capsule and thick triangle below it. */
void sph__io_glb_primitives(sph__io_glb *w, uint32_t first);

#endif
