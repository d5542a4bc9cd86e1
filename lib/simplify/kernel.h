/* SPDX-License-Identifier: MIT */
/*
 * The loops over poses. A point's quadric is kept relative to where the point is in each pose, so that its gradient
 * there is almost nothing and 32 bits are enough: in each pose M, symmetric, and b, of x'Mx - 2 b'x + c with x from the
 * point on; of c only the sum over poses is kept. A block has eight poses of all rows, then the next eight. Rows are
 * padded with zeros. The loops allocate nothing and cannot fail.
 */
#ifndef SPH_SIMPLIFY_KERNEL_H
#define SPH_SIMPLIFY_KERNEL_H

#include <stddef.h>
#include <stdint.h>

#include "hierarchy/kernel.h"

enum { SPH__QUADRIC_ROWS = 9 };

/* The symmetric 4x4 form of a pair of bones: 00 01 02 11 12 22 03 13 23 33. */
enum { SPH__FORM_SIZE = 10 };

/*
 * The error of a point at rest position anchor + x, with weights a of `count` bones, over all poses: with z = (x, 1)
 *     sum_kl a_k a_l z' S_kl z - 2 sum_k a_k g_k.z + c.
 * Pairs go (0,0) (1,0) (1,1) (2,0) ...; S_kl = S_lk.
 */
typedef struct sph__form {
    uint32_t count;
    double *pairs;  /* [count (count + 1) / 2][SPH__FORM_SIZE] */
    double *linear; /* [count][4] */
    double constant;
} sph__form;

static inline size_t sph__form_pair(uint32_t k, uint32_t l)
{
    return k < l ? (size_t)l * (l + 1) / 2 + k : (size_t)k * (k + 1) / 2 + l;
}

/* One quadric as the loops see it. */
typedef struct sph__posed {
    const float *block, *center;
    double constant;
} sph__posed;

/* Doubles of scratch that a form of `count` bones takes. */
size_t sph__form_room(uint32_t count);

/*
 * The form of the sum of two quadrics. Transforms are [stride / lanes][transform_count][12][lanes], bones below
 * transform_count; `room` is aligned to 64 bytes.
 */
void sph__kernel_form(const sph__posed *u, const sph__posed *v, size_t stride, const double *transforms,
                      uint32_t transform_count, const uint32_t *bones, const double anchor[3], double *room,
                      sph__form *form);

/* The sum of two quadrics relative to `center`, into `block`, which may be that of u or v; returns its constant. */
double sph__kernel_unite_posed(const sph__posed *u, const sph__posed *v, size_t stride, const float *center,
                               float *block);

/* Where a point with these bones and weights is: three rows. */
void sph__kernel_place(const double *transforms, uint32_t transform_count, size_t stride, const double rest[3],
                       const uint32_t *bones, const float *weights, uint32_t count, float *center);

/*
 * Adds the plane of the triangle (p, q, r), as heavy as a third of its area, to a quadric in doubles (eight poses of
 * nine rows, then the next), relative to `center`. sums[0] takes what is added to the constant, sums[1] the third of
 * the area.
 */
void sph__kernel_add_plane(const float *p, const float *q, const float *r, const float *center, size_t stride,
                           double *block, double sums[2]);
/* The same for the plane at right angles to the triangle along (p, q), as heavy as a third of that edge's square times
 * `weight`; returns what is added to the constant. */
double sph__kernel_add_border(const float *p, const float *q, const float *r, const float *center, size_t stride,
                              double weight, double *block);

/* The sum over poses of A'MA, A the linear part of the blended transforms: 6 numbers. */
void sph__kernel_pull_back(const double *block, const double *transforms, uint32_t transform_count, size_t stride,
                           const uint32_t *bones, const float *weights, uint32_t count, double out[6]);

#endif
