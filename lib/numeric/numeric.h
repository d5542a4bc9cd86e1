/* SPDX-License-Identifier: MIT */
/* Three-vectors and symmetric 3x3 matrices, stored as 00 01 02 11 12 22. */
#ifndef SPH_NUMERIC_H
#define SPH_NUMERIC_H

#include <stdbool.h>

#include "numeric/vector.h"

/* --- vectors --- */
/* Neither overflows nor underflows before the result does. */
double sph__length(const double a[3]);
/* Makes `a` a unit vector; false, and `a` unchanged, where its length is zero or not finite. */
bool sph__normalize(double a[3]);
bool sph__is_finite3(const double a[3]);

/* --- symmetric matrices --- */
static inline double sph__sym3_trace(const double m[6])
{
    return m[0] + m[3] + m[5];
}

/* out = m x; `out` is not `x` */
static inline void sph__sym3_apply(const double m[6], const double x[3], double out[3])
{
    out[0] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
    out[1] = m[1] * x[0] + m[3] * x[1] + m[4] * x[2];
    out[2] = m[2] * x[0] + m[4] * x[1] + m[5] * x[2];
}

/* m += scale * a a' */
static inline void sph__sym3_add_outer(double scale, const double a[3], double m[6])
{
    m[0] += scale * a[0] * a[0];
    m[1] += scale * a[0] * a[1];
    m[2] += scale * a[0] * a[2];
    m[3] += scale * a[1] * a[1];
    m[4] += scale * a[1] * a[2];
    m[5] += scale * a[2] * a[2];
}

double sph__sym3_determinant(const double m[6]);
/* m times its adjugate is the determinant times the identity. */
void sph__sym3_adjugate(const double m[6], double adjugate[6]);

/*
 * The positive definite m as P' L D L' P, the largest pivot first: backward stable however near m is to singular.
 * False where a pivot is not positive; then `out` must not be used.
 */
typedef struct sph__sym3_factor {
    int order[3];
    double lower[3]; /* L10 L20 L21 */
    double pivot[3];
} sph__sym3_factor;

bool sph__sym3_factorize(const double m[6], sph__sym3_factor *out);
/* x = m^-1 b; `x` may be `b` */
void sph__sym3_solve(const sph__sym3_factor *factor, const double b[3], double x[3]);

/* Eigenvalues in rising order, and unit eigenvectors, one per row, right-handed; `vectors` may be NULL. */
void sph__sym3_eigen(const double m[6], double values[3], double vectors[3][3]);

#endif
