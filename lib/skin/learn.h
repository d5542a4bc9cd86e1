/* SPDX-License-Identifier: MIT */
/* Weights with the poses fixed. */
#ifndef SPH_SKIN_LEARN_H
#define SPH_SKIN_LEARN_H

#include "skin/problem.h"

/*
 * What the weights of a vertex minimise: share (E + g |w - smooth|^2) + (1 - share) g |w - before|^2, with E the sum of
 * area times squared residual over frames and g = gamma times the vertex' total area.
 */
typedef struct sph__learn_goal {
    double gamma;         /* squared model units; 0: E alone */
    const double *smooth; /* [n][most], by place; NULL where gamma is 0 */
    const double *share;  /* [n]; NULL: 1 */
} sph__learn_goal;

/* What the new weights of a vertex do. */
typedef struct sph__learn_change {
    double before, after; /* E */
    double goal_before, goal_after;
    double distance; /* squared, from the weights before */
} sph__learn_change;

/*
 * Weights from p->now into `next`, at most p->limit per vertex; the goal of no vertex rises. `changes` (n entries) may be
 * NULL.
 */
sph_status sph__learn_weights(const sph__problem *p, const sph__learn_goal *goal, sph__influences *next,
                              sph__learn_change *changes);

#endif
