/* SPDX-License-Identifier: MIT */
/*
 * A decomposition under way. Vertices are in an order of their own, those that share candidates beside each other.
 * Frames are in groups of eight, the lanes of the kernels; lanes behind the last frame have no area and count for
 * nothing. Coordinates are relative to `origin`.
 */
#ifndef SPH_SKIN_PROBLEM_H
#define SPH_SKIN_PROBLEM_H

#include "skin/skin.h"

enum {
    SPH__SKIN_LANES = 8,
    SPH__SKIN_ROWS = 4,          /* x y z area */
    SPH__SKIN_MOST_CANDIDATES = 64, /* of one vertex */
    SPH__SKIN_BLOCK = 8,         /* vertices that go through a kernel together */
};

/* Floats of a vertex in one group, and doubles of a bone's pose in one group. */
enum { SPH__SKIN_CELL = SPH__SKIN_ROWS * SPH__SKIN_LANES, SPH__SKIN_POSE = 12 * SPH__SKIN_LANES };

/* Bones that may move a vertex, rising; and for each pair of them, the lesser place second, the pair's number. */
typedef struct sph__candidates {
    uint32_t count;
    uint32_t *bones;
    uint32_t *pairs; /* of places a >= b at a (a + 1) / 2 + b */
} sph__candidates;

/* Influences of a vertex are `count[v]` first of its `limit` slots; a slot names a place among the candidates. */
typedef struct sph__influences {
    uint32_t *count;  /* [n] */
    uint32_t *places; /* [n][limit] */
    double *weights;  /* [n][limit] */
} sph__influences;

/* Beside whom a bone moves vertices. */
typedef struct sph__neighbour_pair {
    uint32_t bone, pair;
} sph__neighbour_pair;

typedef struct sph__problem {
    const sph_context *context; /* borrowed */
    uint32_t n, bones, frames, groups, limit;
    double origin[3];
    double diagonal; /* of the bounding box, mean over frames */
    bool uniform;        /* all areas are 1 */
    float *data;         /* [groups][n][4][8] */
    double *rest;        /* [n][3] */
    double *total;       /* [n]: area summed over frames */
    uint32_t *vertex;    /* [n]: the caller's number */
    double *poses;       /* [groups][bones][12][8] */
    uint32_t set_count, most; /* most: candidates of a set */
    sph__candidates *sets;
    uint32_t *set_bones, *set_pairs; /* all of them */
    uint32_t *set;                   /* [n] */
    sph__influences now;
    const uint8_t *fixed; /* [n], in this order: weights and rest position stay; or NULL */
    uint8_t *still;       /* [bones]: the transform stays */
    size_t pair_count;    /* the first `bones` are those of a bone with itself */
    size_t *near_starts;  /* [bones + 1] */
    sph__neighbour_pair *near;
} sph__problem;

static inline const float *sph__problem_data(const sph__problem *p, uint32_t group, size_t v)
{
    return p->data + ((size_t)group * p->n + v) * SPH__SKIN_CELL;
}

static inline double *sph__problem_pose(const sph__problem *p, uint32_t group, uint32_t bone)
{
    return p->poses + ((size_t)group * p->bones + bone) * SPH__SKIN_POSE;
}

static inline uint32_t sph__candidate_pair(const sph__candidates *set, uint32_t a, uint32_t b)
{
    return a >= b ? set->pairs[(size_t)a * (a + 1) / 2 + b] : set->pairs[(size_t)b * (b + 1) / 2 + a];
}

/* --- problem.c --- */

/* What a problem is made of; all borrowed. */
typedef struct sph__problem_input {
    const sph_context *context;
    const sph_skin_source *sources;
    size_t source_count;
    uint32_t n, bones, frames, limit;
    const uint32_t *labels; /* [n] */
    const sph__reach *reach;
    const float *rest;    /* [n][3] */
    const double *pivots; /* [bones][3] */
    bool uniform;         /* vertices count alike, not by area */
} sph__problem_input;

/* Everything but poses, which are at rest, and influences, of which there are none. Free after failure too. */
sph_status sph__problem_init(sph__problem *p, const sph__problem_input *input, sph__progress *progress);
void sph__problem_free(sph__problem *p);
sph_status sph__influences_allocate(const sph__problem *p, sph__influences *out);
void sph__influences_free(const sph__problem *p, sph__influences *influences);
void sph__influences_copy(const sph__problem *p, const sph__influences *from, sph__influences *to);

/* --- fit.c --- */

/*
 * Optimises the poses, bone by bone, `sweeps` times, weights fixed. The energy does not rise, but through bones whose squared
 * weights sum to less than `minor` (and those that move nothing): these get the mean of the poses of the bones that
 * `links` join them to. Rotations drift from proper by the last digit of each step, but where `exact`.
 */
sph_status sph__fit_poses(sph__problem *p, const sph_skin *skin, double minor, uint32_t sweeps, bool exact);

/* Sums over all frames and vertices: area times squared residual, and squared residual. */
sph_status sph__problem_energy(const sph__problem *p, const sph__influences *at, double energy[2]);

/* Optimises the rest positions of vertices that are not fixed. */
void sph__fit_rest(sph__problem *p);

#endif
