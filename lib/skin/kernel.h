/* SPDX-License-Identifier: MIT */
/* The loops that see all frames of all vertices. They allocate nothing and cannot fail. */
#ifndef SPH_SKIN_KERNEL_H
#define SPH_SKIN_KERNEL_H

#include "skin/problem.h"

/*
 * Sums of one group of frames over all vertices: [pair_count][10][8], for a pair of bones a b
 * sum area w_a w_b (p,1)(p,1)' (upper triangle by rows).
 */
void sph__skin_kernel_gram(const sph__problem *p, uint32_t group, double *gram);

/* The same of sum area w_a v (p,1)': [bones][12][8]. */
void sph__skin_kernel_moments(const sph__problem *p, uint32_t group, double *moments);

/*
 * One pass over the bones of a group: product[12][8] = moments of `bone` less what the other bones account for:
 * sum area w_a (v - sum_{b != a} w_b A_b (p,1)) (p,1)'.
 */
void sph__skin_kernel_remainder(const sph__problem *p, uint32_t group, uint32_t bone, const double *gram,
                                const double *moments, double *product);

/*
 * For vertices begin .. end - 1, which share their candidates: [pairs of places a >= b][8] each, the sums over frames
 * of area (A_a p - v).(A_b p - v), lane by lane. `offsets` has room for [candidates][3][8].
 */
void sph__skin_kernel_residual_gram(const sph__problem *p, size_t begin, size_t end, double *sums, double *offsets);

/* Sums over a vertex range and all frames of area times the squared residual, and of the squared residual. */
void sph__skin_kernel_energy(const sph__problem *p, const sph__influences *at, size_t begin, size_t end,
                             double energy[2]);

/* Sums over frames of the normal equations of a vertex's rest position: 6 of the matrix, then 3. */
void sph__skin_kernel_rest(const sph__problem *p, size_t v, double sums[9]);

#endif
