/* SPDX-License-Identifier: MIT */
/* Affine maps: three rows of [linear | translation]. */
#ifndef SPH_NUMERIC_AFFINE_H
#define SPH_NUMERIC_AFFINE_H

#include <stdbool.h>

/* False where there is no inverse; `out` is not `m`. */
bool sph__affine_invert(const double m[12], double out[12]);

#endif
