/* SPDX-License-Identifier: MIT */
/*
 * Internal door of the room "surface". The lattice is body-centred cubic: points of kind 0 are the corners of cubic
 * cells, points of kind 1 their centres. Every point is joined to six of its kind and to eight of the other, and these
 * edges cut space into equal tetrahedra. Bricks of 8^3 cells hold the points near the surface; all others are alike.
 */
#ifndef SPH_SURFACE_INTERNAL_H
#define SPH_SURFACE_INTERNAL_H

#include <sphmesh/surface.h>

#include "level/solid.h"

enum {
    SPH__BRICK_SIDE = 8,
    SPH__BRICK_POINTS = 2 * 8 * 8 * 8,
    SPH__POINT_EDGES = 7, /* that a point owns: +x, +y, +z, then (-x -y +z), (+x -y +z), (-x +y +z), (+x +y +z) */
};

/* What the table says of a brick that is not held: all of its points, and all that they are joined to, are alike. */
enum { SPH__BRICK_SOLID = -1, SPH__BRICK_OPEN = -2, SPH__BRICK_OUTER = -3, SPH__BRICK_MIXED = -4 };

typedef struct sph__brick {
    uint32_t at[3];
    uint32_t first_vertex, vertex_count;
    uint32_t triangle_count;
    size_t first_triangle;
    /* bit 8 y + x of layer z: not in the solid; joined to infinity */
    uint64_t open[2][8], outer[2][8];
    uint8_t edges[2][8][8][8]; /* which of the edges that a point owns cross the surface */
    uint16_t before[2][8][8];  /* crossings of the rows before this one */
} sph__brick;

/* The outer points of a brick and of those around it: bit x + 1 of [kind][z + 1][y + 1], x, y, z from -1 to 8. */
typedef uint16_t sph__brick_rows[2][10][10];

/* Memory that is counted. */
typedef struct sph__memory {
    const sph_context *context; /* borrowed */
    uint64_t limit, used;
    uint32_t resolution; /* for the message */
} sph__memory;

/* NULL with *status set when there is no more, or when it would be too much. */
void *sph__memory_allocate(sph__memory *memory, size_t count, size_t size, sph_status *status);
void sph__memory_free(sph__memory *memory, void *block, size_t count, size_t size);

typedef struct sph__grid {
    const sph_context *context; /* borrowed */
    const sph__solid *solid;    /* borrowed */
    sph__memory *memory;        /* borrowed */
    sph__progress *progress;    /* borrowed */
    double origin[3], cell;
    uint32_t size[3]; /* bricks */
    uint32_t table_count;
    int32_t *table; /* a brick's number, or SPH__BRICK_* */
    uint32_t brick_count;
    sph__brick *bricks;
} sph__grid;

typedef struct sph__surface_mesh {
    uint32_t vertex_count;
    size_t triangle_count;
    float *positions, *normals;
    uint32_t *triangles;
} sph__surface_mesh;

struct sph_surface {
    sph_context *context; /* retained */
    double cell;
    uint32_t frame_count;
    sph__surface_mesh *meshes;
};

/* --- the lattice around a posed solid (grid.c) --- */

/* Which of its points the solid covers. Takes what the other fields say from `grid`; free it also after a failure. */
sph_status sph__grid_sample(sph__grid *grid);
void sph__grid_free(sph__grid *grid);
/* The number of a held brick in the table, or SPH__BRICK_*. */
int32_t sph__grid_state(const sph__grid *grid, int64_t x, int64_t y, int64_t z);
void sph__grid_point(const sph__grid *grid, const sph__brick *brick, int kind, int x, int y, int z, double point[3]);
/* The rows of outer points of the brick at `at` and around. */
void sph__grid_rows(const sph__grid *grid, const uint32_t at[3], sph__brick_rows rows);
/* Runs body(grid or what starts with one, begin, end) over [0, count), reporting from `from` to `to` on the way. */
typedef void sph__grid_body(void *argument, size_t begin, size_t end);
sph_status sph__grid_loop(sph__grid *grid, size_t count, size_t grain, sph__grid_body *body, void *argument,
                          double from, double to);

/* Finds the points that are joined to infinity (flood.c). */
sph_status sph__grid_flood(sph__grid *grid);

/* The mesh between the outer points and all others (march.c). After a failure it holds what was made so far. */
sph_status sph__grid_march(sph__grid *grid, sph__surface_mesh *mesh);

#endif
