/* SPDX-License-Identifier: MIT */
#include "numeric/affine.h"

#include <math.h>

bool sph__affine_invert(const double m[12], double out[12])
{
    double determinant = 0;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            const int i = (c + 1) % 3, k = (c + 2) % 3, j = (r + 1) % 3, l = (r + 2) % 3;
            out[4 * r + c] = m[4 * i + j] * m[4 * k + l] - m[4 * i + l] * m[4 * k + j];
        }
    for (int c = 0; c < 3; ++c)
        determinant += m[c] * out[4 * c];
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            out[4 * r + c] /= determinant;
        out[4 * r + 3] = -(out[4 * r] * m[3] + out[4 * r + 1] * m[7] + out[4 * r + 2] * m[11]);
    }
    for (int i = 0; i < 12; ++i)
        if (!isfinite(out[i])) return false;
    return true;
}
