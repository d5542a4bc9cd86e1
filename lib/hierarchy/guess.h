/* SPDX-License-Identifier: MIT */
/*
 * Collapses worked out ahead, by all threads. The edges on top of the queue are likely to be collapsed next, and mostly far
 * from each other; so what their collapses compute is computed for many at once, and used when their turn comes, as
 * far as the nodes that it came from are still there. Nodes never change, so it is then what would be computed in turn.
 */
#ifndef SPH_HIERARCHY_GUESS_H
#define SPH_HIERARCHY_GUESS_H

#include <stdatomic.h>

#include "hierarchy/build.h"

/* Collapses ahead; threads that work on them; neighbours of a collapse whose edges are evaluated ahead. */
enum { SPH__GUESSES = SPH__GUESS_SLOTS, SPH__GUESS_WORKERS = 16, SPH__GUESS_OTHERS = 32 };

struct sph__guess {
    uint32_t edge, u, v; /* the edge and its ends; no edge: SPH__NO_NODE */
    sph_status status;   /* of working it out */
    uint32_t batch;      /* that it was prepared in */
    bool ready;          /* all but the edges' costs is there */
    bool far;            /* its exact cost is beyond the top of the queue: no more than that is there */
    bool inverts;        /* then there is neither a block nor a cost of edges */
    sph__candidate candidate;
    double cost; /* exact */
    size_t other_count;
    uint32_t others[SPH__GUESS_OTHERS]; /* neighbours of the new node, and its edges to them: */
    double costs[SPH__GUESS_OTHERS];
    sph__candidate candidates[SPH__GUESS_OTHERS];
    sph__parabola parabolas[SPH__GUESS_OTHERS];
    bool all_others;      /* these are all neighbours */
    float *center, *block; /* of the new node; its slot is that of number n + the guess's */
};

typedef struct sph__guesses {
    sph__guess items[SPH__GUESSES];
    float *rows;         /* of all centres and blocks */
    uint32_t *places;    /* [edges] 1 + the number of an edge's guess; 0: none */
    uint32_t misses;     /* edges without a guess since the last batch */
    uint32_t batches;    /* so far */
    double limit;        /* cost up to which collapses are worked out */
    size_t batch[SPH__GUESSES], batch_count;
    uint32_t *fresh;     /* leaves to make */
    size_t fresh_count, fresh_capacity;
    sph__extents *extents; /* [workers] */
    uint32_t worker_count;
    atomic_flag busy[SPH__GUESS_WORKERS];
} sph__guesses;

#endif
