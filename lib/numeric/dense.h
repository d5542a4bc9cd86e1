/* SPDX-License-Identifier: MIT */
/* Dense systems of linear equations. */
#ifndef SPH_NUMERIC_DENSE_H
#define SPH_NUMERIC_DENSE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * P A = L U in place, with partial pivoting; row i of the factors was row order[i]. False where a pivot is 0, or less
 * than `least` times the largest number of A; then the factors must not be used.
 */
bool sph__dense_factorize(double *a, size_t n, double least, uint32_t *order);
/* x = A^-1 b; `x` is not `b`. */
void sph__dense_solve(const double *factors, size_t n, const uint32_t *order, const double *b, double *x);

#endif
