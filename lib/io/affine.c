/* SPDX-License-Identifier: MIT */
#include "io/affine.h"

#include <stddef.h>

const sph__io_affine sph__io_identity = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};

bool sph__io_is_identity(const sph__io_affine *a)
{
    for (int i = 0; i < 12; ++i)
        if (a->m[i] != sph__io_identity.m[i]) return false;
    return true;
}

sph__io_affine sph__io_multiply(const sph__io_affine *a, const sph__io_affine *b)
{
    sph__io_affine c;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) {
            const double *r = a->m + (ptrdiff_t)4 * row;
            c.m[4 * row + column] =
                r[0] * b->m[column] + r[1] * b->m[4 + column] + r[2] * b->m[8 + column] + (column == 3 ? r[3] : 0);
        }
    return c;
}

double sph__io_determinant(const double m[12])
{
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}
