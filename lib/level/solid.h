/* SPDX-License-Identifier: MIT */
/* A level posed in one frame as a union of primitives, with a tree of boxes over them. */
#ifndef SPH_SOLID_H
#define SPH_SOLID_H

#include "level/box_tree.h"
#include "level/level.h"
#include "level/primitive.h"

enum { SPH__SOLID_LEAF = 2 }; /* primitives per leaf of the tree */

typedef struct sph__solid {
    const sph_context *context; /* borrowed */
    uint32_t sphere_count;
    /* the simplices, each once */
    uint32_t triangle_count, edge_count;
    uint32_t (*triangles)[3]; /* three distinct spheres each */
    uint32_t (*edges)[2];     /* of triangles and wire edges; the smaller sphere first, ascending */
    /* what covers them all: the triangles, then the edges and spheres of no triangle */
    uint32_t primitive_count;
    uint32_t (*corners)[3];
    int32_t *corner_counts;
    /* the pose */
    double (*centers)[3];
    double *radii;
    sph__primitive *primitives;
    sph__box *boxes;
    sph__box_tree tree;
} sph__solid;

/* The simplices of a level, not posed yet. Zeroes `solid` first; free it also after a failure. */
sph_status sph__solid_init(sph__solid *solid, const sph_level *level);
void sph__solid_free(sph__solid *solid);

/* Poses it; `enlarge` (>= 0) is added to all radii. */
void sph__solid_pose(sph__solid *solid, const float *centers, const float *radii, double enlarge);

/*
 * The least signed distance over all primitives: outside it is the distance, inside the depth is at least its opposite.
 * Equal ones go to the lowest index.
 */
double sph__solid_distance(const sph__solid *solid, const double x[3], uint32_t *nearest);

/* Is x nearer than `margin` to a primitive (margin 0: inside)? To which goes to *which, which may be NULL. */
bool sph__solid_covers(const sph__solid *solid, const double x[3], double margin, uint32_t *which);

/* First hit of origin + s * direction, 0 <= s <= limit; as sph__primitive_cast. */
bool sph__solid_cast(const sph__solid *solid, const double origin[3], const double direction[3], double limit,
                     double *s, uint32_t *which);
/* Is the segment from a to b free of the solid? */
bool sph__solid_is_clear(const sph__solid *solid, const double a[3], const double b[3]);
/* Is the ray to infinity? */
bool sph__solid_escapes(const sph__solid *solid, const double origin[3], const double direction[3]);

/*
 * The primitives nearer to x than `radius`, at most `capacity`; returns how many there are in all. Where there are more
 * than the capacity, those given are some of them.
 */
uint32_t sph__solid_gather(const sph__solid *solid, const double x[3], double radius, uint32_t *found,
                           uint32_t capacity);

#endif
