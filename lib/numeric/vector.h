/* SPDX-License-Identifier: MIT */
/* Vectors of three doubles. */
#ifndef SPH_VECTOR_H
#define SPH_VECTOR_H

#include <math.h>

static inline double sph__dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void sph__cross(const double a[3], const double b[3], double out[3])
{
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

static inline double sph__norm(const double a[3])
{
    return sqrt(sph__dot(a, a));
}

/* out = a - b */
static inline void sph__subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[k] - b[k];
}

/* out = a + scale * b */
static inline void sph__add_scaled(const double a[3], double scale, const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[k] + scale * b[k];
}

static inline double sph__distance(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sph__norm(d);
}

static inline void sph__copy3(const double from[3], double to[3])
{
    for (int k = 0; k < 3; ++k)
        to[k] = from[k];
}

/* A unit vector at right angles to the unit vector `a`. */
static inline void sph__perpendicular(const double a[3], double out[3])
{
    const int k = fabs(a[0]) < 0.6 ? 0 : fabs(a[1]) < 0.6 ? 1 : 2;
    double length;
    for (int j = 0; j < 3; ++j)
        out[j] = (j == k) - a[k] * a[j];
    length = sph__norm(out);
    for (int j = 0; j < 3; ++j)
        out[j] /= length;
}

#endif
