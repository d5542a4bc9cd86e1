/* SPDX-License-Identifier: MIT */
/* The triangles of one frame: points spread over them, and the distance to them. */
#ifndef SPH_MEASURE_MESH_H
#define SPH_MEASURE_MESH_H

#include "level/box_tree.h"

typedef struct sph__mesh {
    const sph_context *context; /* borrowed */
    uint32_t vertex_count, triangle_count;
    const uint32_t *triangles; /* borrowed */
    float *xyz;                /* the frame's positions */
    sph__box *boxes;
    sph__box_tree tree;
    double *cumulative; /* area of the triangles up to and with each */
    double area;
} sph__mesh;

/* Points of one surface. */
typedef struct sph__mesh_point {
    double position[3];
    uint32_t triangle;
} sph__mesh_point;

/* Room for a mesh. Zeroes `mesh` first; free it also after a failure. */
sph_status sph__mesh_init(sph__mesh *mesh, const sph_context *context, uint32_t vertex_count, const uint32_t *triangles,
                          size_t triangle_count);
void sph__mesh_free(sph__mesh *mesh);

/* Sorts the triangles into a tree by their places in `xyz`; or takes over the order of another mesh of the same ones.
 */
void sph__mesh_build(sph__mesh *mesh);
void sph__mesh_copy_order(sph__mesh *mesh, const sph__mesh *from);
/* To be called whenever `xyz` has been filled: boxes and areas. */
void sph__mesh_refit(sph__mesh *mesh);

double sph__mesh_diagonal(const sph__mesh *mesh, double low[3], double high[3]);

/*
 * Point `index` of `count` spread evenly by area; `shift` (two numbers in [0, 1)) moves them all. Ask in order of
 * index, with *cursor 0 at first.
 */
void sph__mesh_sample(const sph__mesh *mesh, uint32_t index, uint32_t count, const double shift[2], uint32_t *cursor,
                      sph__mesh_point *point);

/* Distance from x to the nearest triangle; *guess, any triangle, speeds it up when near, and becomes the nearest. */
double sph__mesh_distance(const sph__mesh *mesh, const double x[3], uint32_t *guess);

/* Numbers in [0, 1) for frame `frame`: hashed from `seed`. */
void sph__measure_shift(uint32_t seed, uint32_t frame, uint32_t surface, double shift[2]);

#endif
