/* SPDX-License-Identifier: MIT */
/* Vectors and affine matrices of the readers and writers. */
#ifndef SPH_IO_AFFINE_H
#define SPH_IO_AFFINE_H

#include <stdbool.h>

/* The upper three rows, row by row. */
typedef struct sph__io_affine {
    double m[12];
} sph__io_affine;

extern const sph__io_affine sph__io_identity;

bool sph__io_is_identity(const sph__io_affine *a);
/* Applies `b` first. */
sph__io_affine sph__io_multiply(const sph__io_affine *a, const sph__io_affine *b);
/* Of the linear part of twelve such numbers. */
double sph__io_determinant(const double m[12]);

static inline double sph__io_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
