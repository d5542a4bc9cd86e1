/* SPDX-License-Identifier: MIT */
/* Bone heat: geometric weights on the rest mesh (Baran and Popovic 2007). */
#ifndef SPH_SKIN_HEAT_H
#define SPH_SKIN_HEAT_H

#include "skin/skin.h"

enum { SPH__HEAT_LANES = 8 };

/* (-Laplacian + H) of the rest mesh: symmetric, positive definite, no entry beside the diagonal above 0. */
typedef struct sph__heat_matrix {
    uint32_t n;
    size_t *starts;    /* [n + 1] */
    uint32_t *columns; /* of the entries beside the diagonal */
    double *entries, *diagonal;
} sph__heat_matrix;

typedef struct sph__heat_input {
    const sph_context *context;
    uint32_t n, bones;
    const float *rest;      /* [n][3] */
    const uint32_t *labels; /* [n]: the bone of a vertex that sees none */
    const uint32_t *triangles, *edges;
    size_t triangle_count, edge_count;
    const double *pivots; /* [bones][3] */
    double scale;         /* of the model; lengths below 1e-6 of it count as that */
    const sph__reach *reach;
} sph__heat_input;

/*
 * Weights of the bones within reach of each vertex, in the order of sph__reach at the vertex' label, rows of reach->most
 * numbers; at least 0, not normalised.
 */
sph_status sph__heat_weights(const sph__heat_input *input, double *weights, sph__progress *progress);

/* matrix x for eight right-hand sides at once (kernel.c). */
void sph__heat_kernel_apply(const sph__heat_matrix *matrix, const double *x, double *out);
/* dots[lane] = sum a b, and to += scale[lane] * from. */
void sph__heat_kernel_dot(const double *a, const double *b, size_t n, double dots[SPH__HEAT_LANES]);
void sph__heat_kernel_add(double *to, const double scale[SPH__HEAT_LANES], const double *from, size_t n);

#endif
