/* SPDX-License-Identifier: MIT */
/* Internal door of the room "measure": the outer surface of a posed level. */
#ifndef SPH_MEASURE_INTERNAL_H
#define SPH_MEASURE_INTERNAL_H

#include <sphmesh/measure.h>

#include "level/solid.h"

/* A point just off the boundary of the solid. */
typedef struct sph__surface_point {
    double position[3]; /* `lift` off the boundary */
    double normal[3];   /* unit, outward */
    uint32_t kind;      /* one of the following */
} sph__surface_point;

enum {
    SPH__POINT_SPREAD = 0,  /* outer */
    SPH__POINT_EXTREME = 1, /* outer, at a sharp end: one too many for a mean */
    SPH__POINT_CAVITY = 2
};

/*
 * The outer surface of a level in one frame. All radii are enlarged by `skin`, a millionth of the size of things: so
 * even points, wires and sheets of no thickness have an inside, two sides and a surface, and nothing leaks through a
 * seam.
 */
typedef struct sph__outer {
    const sph_context *context; /* borrowed */
    sph__solid solid;
    double size, skin, lift; /* model units */
    double area;             /* of the outer surface, estimated */
    double spacing;          /* of the points */
    bool has_cavities;       /* some points were not connected to infinity */
    bool *touches_cavity;    /* of each primitive */
    uint32_t point_count;    /* the outer ones first, then those in cavities */
    uint32_t outer_count;
    sph__surface_point *points;
    size_t point_capacity;
    uint32_t extreme_begin; /* points from here to outer_count stand at sharp ends: they weigh nothing */
    sph__box *boxes;
    size_t box_capacity;
    sph__box_tree all_tree, outer_tree;
    uint32_t *parents; /* while points are being joined */
    size_t parent_capacity;
} sph__outer;

sph_status sph__outer_init(sph__outer *outer, const sph_level *level);
void sph__outer_free(sph__outer *outer);

/*
 * Poses the level, and spreads about `samples` points over its outer surface. `size` is the model's diagonal. May run
 * on any thread; on failure (SPH_E_NOMEM) no message is set.
 */
sph_status sph__outer_pose(sph__outer *outer, const float *centers, const float *radii, double size, uint32_t samples,
                           const double shift[2]);

/* Point `index` (below outer_count) on the surface of the level itself. */
void sph__outer_point(const sph__outer *outer, uint32_t index, double x[3]);

/* Distance from x to the outer surface, on either side of it. */
double sph__outer_distance(const sph__outer *outer, const double x[3]);

/* --- points spread over the boundaries of all primitives (patches.c) --- */

/* Area of all boundary patches of the posed solid. */
double sph__patches_area(const sph__solid *solid);
/* Adds the points of `count` spread over all patches that nothing covers to the points; false when out of memory. */
bool sph__patches_sample(sph__outer *outer, double area, uint32_t count, const double shift[2]);
/* How many of `count` such points would be kept. */
uint32_t sph__patches_count(const sph__outer *outer, double area, uint32_t count);
/* Adds the sharp ends: of every sphere the point that is farthest from its neighbours. */
bool sph__patches_extremes(sph__outer *outer);

/* --- what is connected to infinity (connect.c) --- */

/* Finds out which of the points are in cavities, and sorts them; false when out of memory. */
bool sph__outer_connect(sph__outer *outer);
/* The same for points from `first` on, by those before, which are sorted; then sorts all. */
bool sph__outer_extend(sph__outer *outer, uint32_t first);
/* Does this point, just off a primitive with `normal` pointing away from it, belong to the outside? */
bool sph__outer_is_outside(const sph__outer *outer, uint32_t primitive, const double position[3],
                           const double normal[3]);

/* --- searches --- */

typedef struct sph__neighbour {
    uint32_t point;
    double distance2;
} sph__neighbour;

/*
 * The points of the tree nearest to x, at most `capacity` and within `radius`, in ascending order of distance. `first`
 * is the number of the tree's first point.
 */
uint32_t sph__outer_nearest(const sph__outer *outer, const sph__box_tree *tree, const double x[3], double radius,
                            uint32_t capacity, sph__neighbour *found);

/*
 * Moves p, which lies off the solid, towards x as long as the way stays off the solid, to a place where no small step
 * leads nearer; returns the distance left (descend.c). Stops early below `enough`.
 */
double sph__outer_descend(const sph__solid *solid, const double x[3], double p[3], double tolerance, double enough);

#endif
