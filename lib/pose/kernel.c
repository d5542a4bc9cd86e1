/* SPDX-License-Identifier: MIT */
/* The loops over vertices. They allocate nothing and cannot fail. */
#include <float.h>
#include <math.h>

#include "hierarchy/lanes.h"
#include "pose/pose.h"

typedef double v4d __attribute__((vector_size(32)));

/* out = a x b, the first three of four numbers */
#define CROSS(a, b)                                                                                                    \
    ((v4d){(a)[1] * (b)[2] - (a)[2] * (b)[1], (a)[2] * (b)[0] - (a)[0] * (b)[2], (a)[0] * (b)[1] - (a)[1] * (b)[0], 0})

SPH__INLINE void store_point(const v4d *point, float *out)
{
    for (int c = 0; c < 3; ++c)
        out[c] = (float)(*point)[c];
}

/* The direction of what is so long or so short that its square is not to be trusted; 0 where it has none. */
static void store_extreme(const double d[3], float *out)
{
    const double most = fmax(fmax(fabs(d[0]), fabs(d[1])), fabs(d[2])), sum = d[0] + d[1] + d[2];
    const bool has = most > 0 && most <= DBL_MAX && !isnan(sum);
    const double x = has ? d[0] / most : 0, y = has ? d[1] / most : 0, z = has ? d[2] / most : 0;
    const double length = has ? sqrt(x * x + y * y + z * z) : 1;
    out[0] = (float)(x / length);
    out[1] = (float)(y / length);
    out[2] = (float)(z / length);
}

SPH__INLINE void store_direction(const v4d *direction, float *out)
{
    const v4d d = *direction;
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (length >= 1e-100 && length <= 1e100) {
        const double scale = 1 / length;
        for (int c = 0; c < 3; ++c)
            out[c] = (float)(d[c] * scale);
    } else {
        const double parts[3] = {d[0], d[1], d[2]};
        store_extreme(parts, out);
    }
}

/* The weighted sum of the columns of the transforms of vertex v's bones. */
#define BLEND(columns)                                                                                                 \
    do {                                                                                                               \
        for (size_t s = v * k; s < (v + 1) * k && d->weights[s] > 0; ++s) {                                            \
            const v4d *t = (const v4d *)(palette + SPH__BONE_SIZE * (size_t)d->bones[s]);                              \
            const double w = (double)d->weights[s];                                                                    \
            for (int c = 0; c < 4; ++c)                                                                                \
                (columns)[c] += w * t[c];                                                                              \
        }                                                                                                              \
    } while (0)

/* The matrix of cofactors takes a normal along, whatever the columns do. */
#define TURN(columns, n)                                                                                               \
    (CROSS((columns)[1], (columns)[2]) * (double)(n)[0] + CROSS((columns)[2], (columns)[0]) * (double)(n)[1] +         \
     CROSS((columns)[0], (columns)[1]) * (double)(n)[2])

SPH__CLONES static void linear(const sph_deformer *d, const double *palette, size_t begin, size_t end, float *positions,
                               float *normals)
{
    const size_t k = d->influence_count;
    for (size_t v = begin; v < end; ++v) {
        const float *p = d->rest + 3 * v;
        v4d columns[4] = {{0}};
        BLEND(columns);
        if (positions != NULL) {
            const v4d moved =
                columns[0] * (double)p[0] + columns[1] * (double)p[1] + columns[2] * (double)p[2] + columns[3];
            store_point(&moved, positions + 3 * v);
        }
        if (normals != NULL) {
            const v4d turned = TURN(columns, d->normals + 3 * v);
            store_direction(&turned, normals + 3 * v);
        }
    }
}

void sph__pose_kernel_linear(const sph_deformer *deformer, const double *palette, size_t begin, size_t end,
                             float *positions, float *normals)
{
    linear(deformer, palette, begin, end, positions, normals);
}

/*
 * The rotation of the real part q, which has length 1, of p: p + 2 q x (q x p + w p). A quaternion and its negative are
 * one rotation: all come to the side of the first, which has the largest weight, so that the sum is never 0.
 */
#define ROTATE(q, p) ((p) + 2 * CROSS(q, CROSS(q, p) + (q)[3] * (p)))

SPH__CLONES static void dual(const sph_deformer *d, const double *palette, bool stretched, size_t begin, size_t end,
                             float *positions, float *normals)
{
    const size_t k = d->influence_count;
    for (size_t v = begin; v < end; ++v) {
        const float *rest = d->rest + 3 * v, *normal = normals == NULL ? NULL : d->normals + 3 * v;
        const v4d first = *(const v4d *)(palette + SPH__BONE_SIZE * (size_t)d->bones[v * k] + SPH__BONE_REAL);
        v4d columns[4] = {{0}}, real = {0}, shift = {0}, p, n = {0}, square;
        double scale;
        for (size_t s = v * k; s < (v + 1) * k && d->weights[s] > 0; ++s) {
            const double *t = palette + SPH__BONE_SIZE * (size_t)d->bones[s];
            const v4d q = *(const v4d *)(t + SPH__BONE_REAL), dot = q * first;
            const double w = (double)d->weights[s], side = (dot[0] + dot[1]) + (dot[2] + dot[3]) < 0 ? -w : w;
            real += side * q;
            shift += side * *(const v4d *)(t + SPH__BONE_DUAL);
        }
        square = real * real;
        scale = 1 / sqrt((square[0] + square[1]) + (square[2] + square[3]));
        real *= scale;
        shift *= scale;
        p = (v4d){(double)rest[0], (double)rest[1], (double)rest[2], 0};
        if (normal != NULL) n = (v4d){(double)normal[0], (double)normal[1], (double)normal[2], 0};
        if (stretched) {
            BLEND(columns);
            p = columns[0] * p[0] + columns[1] * p[1] + columns[2] * p[2] + columns[3];
            if (normal != NULL) n = TURN(columns, normal);
        }
        if (positions != NULL) {
            const v4d turned = ROTATE(real, p);
            const v4d moved = turned + 2 * (real[3] * shift - shift[3] * real + CROSS(real, shift));
            store_point(&moved, positions + 3 * v);
        }
        if (normal != NULL) {
            n = ROTATE(real, n);
            store_direction(&n, normals + 3 * v);
        }
    }
}

void sph__pose_kernel_dual(const sph_deformer *deformer, const double *palette, bool stretched, size_t begin,
                           size_t end, float *positions, float *normals)
{
    dual(deformer, palette, stretched, begin, end, positions, normals);
}
