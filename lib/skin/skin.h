/* SPDX-License-Identifier: MIT */
/* Internal door of the room "skin": the handle laid open. */
#ifndef SPH_SKIN_INTERNAL_H
#define SPH_SKIN_INTERNAL_H

#include <sphmesh/skin.h>

#include "base/base.h"

struct sph_skin {
    sph_context *context; /* retained */
    uint32_t vertex_count, bone_count, influence_count, frame_count, clip_count;
    uint32_t rigid;
    size_t triangle_count, link_count;
    float *rest;              /* [n][3] */
    uint32_t *bones;          /* [n][k] */
    float *weights;           /* [n][k], in order: see sph__weights_order */
    double *transforms;       /* [F][J][12] */
    sph_skin_clip *clips;     /* [clip_count], their names within `names` */
    char *names;
    double *pivots, *radii;   /* [J][3], [J] */
    uint32_t *triangles;      /* [triangle_count][3] */
    uint32_t *links;          /* [link_count][2] */
    sph_skin_error *errors;   /* [F], then overall; NULL where nothing was measured */
};

/* A skin whose arrays have room for what `sizes` counts (its pointers are not looked at), zeroed, and no clips. */
sph_status sph__skin_allocate(sph_context *context, const sph_skin_arrays *sizes, sph_skin **out);
/* Copies clips with their names. */
sph_status sph__skin_set_clips(sph_skin *skin, const sph_skin_clip *clips, uint32_t count);
/* Sorts and joins pairs of bones, the lower first; returns how many are left. `keys` has room for `count`. */
size_t sph__skin_order_links(uint32_t *links, size_t count, sph__keyed *keys);
/* Whether a transform is a proper rotation, to 1e-6, and a translation. */
bool sph__skin_is_rigid(const double transform[12]);

/*
 * Brings the `count` influences of one vertex in order and keeps the `limit` largest: no bone twice, weights falling,
 * equal ones by bone; multiples of 2^-24 whose sum is 1; behind them zeros of bone 0 up to `limit`. `bones` and
 * `weights` are used up. False where no weight is above 0.
 */
bool sph__weights_order(uint32_t *bones, double *weights, uint32_t count, uint32_t limit, uint32_t *out_bones,
                        float *out_weights);

/* out = transform applied to p */
static inline void sph__transform_point(const double transform[12], const double p[3], double out[3])
{
    for (int r = 0; r < 3; ++r)
        out[r] = transform[4 * r] * p[0] + transform[4 * r + 1] * p[1] + transform[4 * r + 2] * p[2] +
                 transform[4 * r + 3];
}

/* The areas of the vertices' barycentric cells in one frame: a third of that of every triangle around. */
void sph__cell_areas(const uint32_t *triangles, size_t triangle_count, const float *xyz, uint32_t n, double *areas);

/* The diagonal of the bounding box of n points. */
double sph__frame_diagonal(const float *xyz, uint32_t n);

/* That all sources are of one mesh with `vertex_count` vertices; the sum of their frames in *frame_count. */
sph_status sph__skin_check_sources(const sph_context *context, const sph_skin_source *sources, size_t source_count,
                                   uint32_t vertex_count, uint32_t *frame_count);
/* Measures into skin->errors. */
sph_status sph__skin_measure_self(sph_skin *skin, const sph_skin_source *sources, size_t source_count,
                                  sph__progress *progress);

/* --- reach.c: which bones may move a vertex --- */

/* For every cell itself and those within `rings` steps along adjacent cells of the mesh. */
typedef struct sph__reach {
    const sph_context *context; /* borrowed */
    uint32_t cell_count, most;  /* largest number of bones of a cell */
    size_t *starts;             /* [cell_count + 1] */
    uint32_t *bones;            /* each cell's own first, the others rising */
} sph__reach;

/* `labels` are all below `cell_count`. Free after failure too. */
sph_status sph__reach_find(sph__reach *reach, const sph_context *context, uint32_t cell_count, const uint32_t *labels,
                           const uint32_t *triangles, size_t triangle_count, const uint32_t *edges, size_t edge_count,
                           uint32_t rings);
void sph__reach_free(sph__reach *reach);

#endif
