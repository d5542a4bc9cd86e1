/* SPDX-License-Identifier: MIT */
/* The least error of a form: position and weights in turn. */
#ifndef SPH_SIMPLIFY_SOLVE_H
#define SPH_SIMPLIFY_SOLVE_H

#include <stdbool.h>

#include "numeric/simplex_qp.h"
#include "simplify/kernel.h"

enum { SPH__SIMPLIFY_BONES = SPH__SIMPLEX_QP_MOST }; /* most around an edge */

/* A place where the minimisation may be: a position relative to the form's anchor, and weights of its bones. */
typedef struct sph__trial {
    double x[3];
    double weights[SPH__SIMPLIFY_BONES];
    double error;
} sph__trial;

/* Told after every half-step. */
typedef void sph__half_step_fn(void *user, int weights, double error);

/* What one solve needs: reused by many. */
typedef struct sph__solver {
    sph__form form; /* its arrays, and `room`, have room for SPH__SIMPLIFY_BONES, or as many as there ever are */
    double *room;
    double *matrix; /* [bones][bones] */
    sph__simplex_qp_room qp;
    double edge[3]; /* from u, which is at 0, to v */
    double tolerance;
    uint32_t round_limit;
    sph__half_step_fn *half_step; /* may be NULL */
    void *user;
} sph__solver;

double sph__form_error(const sph__form *form, const double x[3], const double *weights);

/*
 * The best position with these weights; where that is open, the best one on the edge. Never with a greater error; in
 * trial->error, which must be right before.
 */
void sph__solve_position(const sph__solver *solver, sph__trial *trial);
/* The best weights with this position, of the bones that are allowed (NULL: all). The same. */
void sph__solve_weights(sph__solver *solver, const uint8_t *allowed, sph__trial *trial);
/* Both in turn, until nothing is to be gained. */
void sph__solve_both(sph__solver *solver, const uint8_t *allowed, sph__trial *trial);
/* The same with at most `limit` bones: those that weigh most stay. */
void sph__solve_limited(sph__solver *solver, uint32_t limit, sph__trial *trial);

#endif
