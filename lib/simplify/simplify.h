/* SPDX-License-Identifier: MIT */
/* Internal door of the room "simplify": the handle laid open, and what the steps of making it share. */
#ifndef SPH_SIMPLIFY_INTERNAL_H
#define SPH_SIMPLIFY_INTERNAL_H

#include <sphmesh/simplify.h>

#include "base/base.h"
#include "hierarchy/collapses.h"
#include "hierarchy/edge_queue.h"
#include "simplify/kernel.h"
#include "simplify/solve.h"
#include "skin/skin.h"

struct sph_progressive {
    sph_context *context; /* retained */
    uint32_t point_count, collapse_count, pose_count, first_forced;
    uint32_t slots;       /* bones and weights of a point */
    uint32_t value_count; /* per wedge: the normal, if there are any, and the attributes */
    uint32_t attribute_count;
    double bounding_diagonal;
    sph_skin *frame; /* what all levels have in common; of its vertices there is but one */
    float *rest;     /* [points + C][3] */
    uint32_t *bones; /* [points + C][slots] */
    float *weights;  /* [points + C][slots] */
    /* As in sph__collapses. */
    uint32_t *children, *parents, *roots, *edge_others, *triangle_others;
    size_t *edge_starts, *triangle_starts;
    /* Per level, C + 1 of each. */
    uint32_t *vertex_counts, *triangle_counts;
    double *errors, *max_errors;
    /* A wedge is a point with the values that a triangle's corner has there. The first are the input's vertices. */
    float *values;              /* [wedges][value_count] */
    uint32_t *wedge_points;     /* [wedges] */
    uint32_t *wedge_sources;    /* [wedges]: an input vertex */
    uint32_t *triangle_wedges;  /* [born triangles][3]: of the youngest corner, and on in the order of the winding */
    uint32_t *triangle_sources; /* [born triangles]: the input's triangle */
};

/* For walking over it. */
sph__collapses sph__progressive_collapses(const sph_progressive *progressive);

/* Collapses look at up to so many bones of a point, whatever few of them leave the library in the end: what is pruned
 * early is missed later. */
enum { SPH__SIMPLIFY_WIDE = 12 };

/* Around so many edges at once are errors found, each with room of its own. */
enum { SPH__SIMPLIFY_ROOMS = 16 };

typedef struct sph__simplifier {
    sph_progressive *p;
    const sph_context *context;
    const sph_skin *skin;
    sph_simplify_options o;
    sph__progress progress;

    uint32_t n, points;
    uint32_t *point_of; /* [n] */
    uint32_t *wedge_of; /* [n]: the vertex that stands for all of the same point and values */
    double scale;       /* the input's size times this is what is computed with; a power of two */

    uint32_t example_count; /* poses that leaves are made from */
    size_t example_stride;  /* rounded up to whole lanes */
    double *examples;       /* [chunks][J][12][lanes] */
    uint32_t pose_count;    /* poses that collapses look at: the same, or the rest pose alone */
    size_t stride;
    double *transforms;       /* as examples */
    uint32_t transform_count; /* J, or one: the identity */

    sph__connectivity mesh; /* of points */
    uint32_t *numbers;      /* [mesh.triangle_count]: of the input */
    uint32_t (*corners)[3]; /* [mesh.triangle_count]: wedges */
    uint32_t *stamps;       /* [mesh.triangle_count]: the last point that has it */
    sph__edge_queue queue;
    sph__births births;
    uint32_t wide;         /* bones and weights of a point, while collapses look at it */
    float *rest, *weights; /* [2 points][3], [2 points][wide] */
    uint32_t *bones;       /* [2 points][wide] */
    float *centers;        /* [2 points][3][stride]: where points are in the poses */
    float *blocks;         /* [points][SPH__QUADRIC_ROWS * stride] by slot */
    double *costs, *areas; /* [points] by slot: the quadric at the point; the area that it stands for */
    double *shown;         /* [points] by slot: the quadric at the point as it leaves the library */
    uint32_t *slot_of;     /* [2 points] */
    uint8_t *locked;       /* [2 points] */
    double live_cost, live_area;
    float *new_center; /* [3][stride] */
    float *zeros;      /* [SPH__QUADRIC_ROWS * stride]: the quadric of nothing */

    uint32_t *uses; /* [wedges]: by triangles */
    uint32_t vertex_count, triangle_count;
    size_t wedge_count, value_capacity, point_capacity, source_capacity, use_capacity, corner_capacity, number_capacity;
    struct sph__wedge *around; /* scratch */
    uint32_t *moved;           /* scratch: triangles around a collapse */
    size_t around_capacity, moved_capacity;

    sph__solver rooms[SPH__SIMPLIFY_ROOMS];
    uint32_t *fresh; /* edges whose errors are to be found */
    double *fresh_costs;
    size_t fresh_count, fresh_capacity, fresh_cost_capacity;
} sph__simplifier;

static inline float *sph__center_of(const sph__simplifier *b, uint32_t point)
{
    return b->centers + point * 3 * b->stride;
}

static inline float *sph__block_of(const sph__simplifier *b, uint32_t point)
{
    return b->blocks + b->slot_of[point] * SPH__QUADRIC_ROWS * b->stride;
}

/* --- options.c --- */
sph_status sph__simplify_read_options(const sph_skin *skin, const sph_simplify_options *in, sph_simplify_options *o);

/* --- weld.c: vertices become points and wedges --- */
sph_status sph__simplify_weld(sph__simplifier *b);

/* --- poses.c: the example poses, and points with their places in them --- */
sph_status sph__simplify_read_poses(sph__simplifier *b);
/* Rest, bones and weights of the points, for collapses and as they leave the library. */
sph_status sph__simplify_make_points(sph__simplifier *b);
/* How many bones a point has. */
uint32_t sph__simplify_bone_count(const sph__simplifier *b, uint32_t point);
/* Where a point is in the poses. */
void sph__simplify_place(const sph__simplifier *b, uint32_t point, float *center);

/* --- leaves.c --- */
sph_status sph__simplify_make_leaves(sph__simplifier *b);

/* --- wedges.c --- */
/* One of the wedges around a collapse. */
typedef struct sph__wedge {
    uint32_t wedge, class_of; /* class_of: an index into the same list */
    uint32_t made;            /* of a class: the new wedge, or SPH__NO_NODE */
    uint32_t side;            /* 0: of u, 1: of v */
} sph__wedge;

/* Unites the wedges of u and v at w, `t` of the way from u to v, before the triangles move. */
sph_status sph__wedges_unite(sph__simplifier *b, uint32_t u, uint32_t v, uint32_t w, double t);
/* Forgets the wedges of the triangles that went with the collapse into w. */
void sph__wedges_settle(sph__simplifier *b, uint32_t w);
/* Records the wedges of the triangles that were last born. */
sph_status sph__wedges_record(sph__simplifier *b, uint32_t point);

/* --- decimate.c --- */
sph_status sph__simplify_decimate(sph__simplifier *b);

#endif
