/* SPDX-License-Identifier: MIT */
/* Small animated meshes of every awkward kind, jittered so that no two edges cost the same. */
#ifndef SPHMESH_TESTS_CASES_H
#define SPHMESH_TESTS_CASES_H

#include <sphmesh/sphmesh.h>

#include "reference.h"

struct case_mesh {
    char name[64];
    uint32_t vertex_count, frame_count;
    float *rest;      /* [n][3] */
    float *positions; /* [F][n][3], once animated */
    size_t triangle_count, edge_count;
    uint32_t *triangles, *edges;
    size_t components; /* isolated vertices included */
};

enum case_shape {
    CASE_TETRAHEDRON,
    CASE_ICOSAHEDRON,
    CASE_SPHERE_42,
    CASE_SPHERE_162,
    CASE_TORUS,
    CASE_BIG_TORUS,
    CASE_CUBE,
    CASE_GRID,
    CASE_STRIP,
    CASE_TUBE,
    CASE_WIRES,
    CASE_SPHERE_ON_WIRES,
    CASE_COMPONENTS,
    CASE_FANS,
    CASE_SOUP,
    CASE_DENSE_SOUP,
    CASE_SLIVERS,
    CASE_DUPLICATES,
    CASE_CRUMPLED,
    CASE_SHAPE_COUNT
};

/* How the frames come from the rest shape. */
enum case_motion {
    CASE_WAVE,    /* bends, and every vertex trembles in every frame */
    CASE_RIGID,   /* turns and shifts as a whole; flat stays flat but for rounding */
    CASE_STRETCH, /* jittered at rest, then scaled and sheared anew per frame */
    CASE_HALF,    /* as the last up to the middle, then as the wave */
    CASE_TUMBLE,  /* every vertex anywhere in every frame */
    CASE_MOTION_COUNT
};

void case_create(struct case_mesh *mesh, enum case_shape shape, enum case_motion motion, uint32_t frame_count,
                 uint64_t seed);
void case_free(struct case_mesh *mesh);
struct reference_input case_input(const struct case_mesh *mesh);
/* A spread of unit directions for tests that need no others. */
extern const double CASE_DIRECTIONS[7][3];

#endif
