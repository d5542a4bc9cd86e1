/* SPDX-License-Identifier: MIT */
/* Internal door of the room "query": a level in one pose. */
#ifndef SPH_QUERY_INTERNAL_H
#define SPH_QUERY_INTERNAL_H

#include <pthread.h>
#include <stdatomic.h>

#include <sphmesh/query.h>

#include "level/solid.h"
#include "query/fan.h"
#include "query/kernel.h"
#include "query/wave.h"

enum {
    SPH__QUERY_LEAF = 16,       /* primitives per leaf of the tree */
    SPH__QUERY_TREE_FROM = 512, /* primitives from which on the tree is quicker */
    SPH__QUERY_MANY = 512,      /* up to so many, many casts are worked on together: */
    SPH__QUERY_MANY_LEAVES = 32 /* those are so many leaves at most */
};

/* The simplex of the level that a primitive stands for. */
typedef struct sph__query_simplex {
    uint32_t spheres[3];
    uint32_t number, kind;
    uint8_t corner[3]; /* which of the primitive's it is; 3: none */
} sph__query_simplex;

/* Which space is connected to infinity (cavity.c). */
typedef struct sph__query_cavities {
    pthread_mutex_t mutex; /* guards the making */
    bool has_mutex;
    atomic_uint_fast64_t pose; /* the pose it was made for; 0: none */
    int32_t size[3];           /* cells along the axes */
    double cell;               /* side of a cell, in the frame of the pose */
    double low[3];
    uint8_t *cells;
} sph__query_cavities;

/*
 * The pose lives in a frame of its own: x' = (x - origin) * scale, scale a power of two, so that the solid fits in
 * [-1, 1]^3. There are no overflows in it, and 32-bit bounds have a known error. Primitives are kept in the order of
 * the tree's leaves ("slots"); `solid.primitives`, `.corners` and `.boxes` are by slot too.
 */
struct sph_query {
    sph_context *context; /* retained */
    uint32_t sphere_count, frame_count, primitive_count;
    bool radii_per_frame, is_exhaustive;
    float *frame_centers; /* [frame_count][sphere_count][3] */
    float *frame_radii;   /* [sphere_count], or [frame_count][sphere_count] */
    sph__solid solid;     /* centers, radii: of the model */
    sph__query_simplex *simplices;
    uint32_t *numbers; /* of a slot: the primitive's place in the order of the simplices, by which ties go */
    /* of no more than SPH__QUERY_MANY primitives that are searched whole: leaves, each of two twigs, which begin there
     */
    uint32_t leaf_count;
    uint16_t twigs[2 * SPH__QUERY_MANY_LEAVES + 1];
    sph__box twig_boxes[2 * SPH__QUERY_MANY_LEAVES];
    sph__query_leaf *leaf_bounds;
    uint8_t *shared; /* of a slot: which parts a primitive with a lower number has too (parts.h) */
    sph__query_bounds bounds;
    sph__query_fan *fans;          /* by slot */
    sph__query_parts *parts;       /* by slot */
    double origin[3], scale, unit; /* unit = 1 / scale */
    double half[3];                /* the solid lies in +- half */
    uint64_t pose;                 /* counts up */
    sph__query_cavities *cavities;
};

static inline void sph__query_to_frame(const sph_query *q, const double x[3], double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = (x[k] - q->origin[k]) * q->scale;
}

/* Describes the place `c` (in the frame) of the primitive in `slot` to the caller. */
void sph__query_contact(const sph_query *q, uint32_t slot, const sph__contact *c, sph_contact *out);
/* None. */
void sph__query_no_contact(sph_contact *out);

/* Finds leaves, and the order of the primitives by them: 0 to primitive_count - 1 on entry. */
sph_status sph__query_leaves_build(sph_query *q, uint32_t *order);
void sph__query_leaves_pose(sph_query *q);

/* solid.centers and solid.radii have been set: all else that depends on the pose. */
void sph__query_repose(sph_query *q);

/* The least signed distance from x (in the frame) over the primitives; the lowest number of equal ones. */
double sph__query_distance(const sph_query *q, const double x[3], uint32_t *slot);
/* Is x (in the frame) nearer to a primitive than `margin`, or as near? */
bool sph__query_covers(const sph_query *q, const double x[3], double margin);

/* The first hit of the point from + t * (to - from) in the frame, 0 <= t <= 1; false: none, and t is 1. */
bool sph__query_cast_frame(const sph_query *q, const double from[3], const double to[3], double *t);

/* That `count` strided points are finite; resolves a stride of 0. */
sph_status sph__query_check_points(const sph_query *q, const char *name, const float *points, size_t *stride,
                                   size_t count);

bool sph__query_cavities_create(sph_query *q);
void sph__query_cavities_destroy(sph_query *q);

#endif
