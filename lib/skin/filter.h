/* SPDX-License-Identifier: MIT */
/* The Gaussian of geodesic distance that smooths weights over the rest mesh. */
#ifndef SPH_SKIN_FILTER_H
#define SPH_SKIN_FILTER_H

#include "skin/problem.h"

enum { SPH__FILTER_MOST = 512 /* vertices that one vertex hears of */ };

/* For every vertex, in the problem's order, whom it hears of and how much; shares sum to 1. */
typedef struct sph__filter {
    sph_context *context; /* borrowed */
    size_t *starts;       /* [n + 1] */
    uint32_t *others;
    float *shares;
} sph__filter;

typedef struct sph__filter_input {
    sph_context *context;
    const sph__problem *problem;
    const float *rest; /* [n][3], in the caller's order, as are these: */
    const uint32_t *triangles, *edges;
    size_t triangle_count, edge_count;
    double sigma; /* model units, > 0; cut at three times it */
} sph__filter_input;

/* Zeroes `filter` first; free it after failure too. */
sph_status sph__filter_init(sph__filter *filter, const sph__filter_input *input, sph__progress *progress);
void sph__filter_free(sph__filter *filter);

/* smooth[v][place] = the filtered weights of the problem, for the candidates of v; rows of p->most. */
sph_status sph__filter_apply(const sph__filter *filter, const sph__problem *p, double *smooth);

#endif
