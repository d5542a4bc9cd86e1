/* SPDX-License-Identifier: MIT */
/* Small convex quadratic programs over the simplex, solved exactly by an active set. */
#ifndef SPH_SIMPLEX_QP_H
#define SPH_SIMPLEX_QP_H

#include <stdint.h>

enum { SPH__SIMPLEX_QP_MOST = 64 };

/* Room for one solve: on the stack or shared by many. */
typedef struct sph__simplex_qp_room {
    double factor[SPH__SIMPLEX_QP_MOST][SPH__SIMPLEX_QP_MOST];
    double one[SPH__SIMPLEX_QP_MOST], target[SPH__SIMPLEX_QP_MOST];
    uint32_t free[SPH__SIMPLEX_QP_MOST];
} sph__simplex_qp_room;

/*
 * Minimises w'Hw - 2 b'w over w >= 0, sum w = 1, w_i = 0 where `allowed` (may be NULL: all are) is 0. H is symmetric,
 * positive semidefinite, `count` rows (at most SPH__SIMPLEX_QP_MOST) of `stride` numbers; b may be NULL: 0. Where many
 * w are minimal it is one of them. `w` starts feasible and comes back so, never with a greater value; steps are at most
 * 16 + 8 count. Returns how many were taken.
 */
uint32_t sph__simplex_qp(const double *h, uint32_t stride, const double *b, uint32_t count, const uint8_t *allowed,
                         double *w, sph__simplex_qp_room *room);

/* w'Hw - 2 b'w */
double sph__simplex_qp_value(const double *h, uint32_t stride, const double *b, uint32_t count, const double *w);

#endif
