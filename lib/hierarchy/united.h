/* SPDX-License-Identifier: MIT */
/* Eight frames of the quadric of two regions, which all loops over frames begin with. */
#ifndef SPH_HIERARCHY_UNITED_H
#define SPH_HIERARCHY_UNITED_H

#include "hierarchy/lanes.h"
#include "quadric/minimizer.h"

/* The united quadric of eight frames, relative to the sphere of u. */
typedef struct frame_quadric {
    sph__v8d m00, m01, m02, m11, m12, m22, n0, n1, n2, b0, b1, b2;
    sph__v8d d0, d1, d2;   /* from the centre of u to that of v */
    sph__v8d sum_b, sum_c; /* what the shift of v adds to B and c */
} frame_quadric;

/* Eight frames of a row, from where they begin in the block. */
#define row(frames, number) sph__load(frames, (number) * SPH__LANES)

/* `offset`: what the radius of v is beyond that of u, in all lanes. */
SPH__INLINE void unite_frames(const sph__region *u, const sph__region *v, size_t s, size_t i, const sph__v8d *offset,
                              frame_quadric *q)
{
    const float *a = u->block + i * (u->leaf ? SPH__LEAF_ROWS : SPH__BLOCK_ROWS);
    const float *e = v->block + i * (v->leaf ? SPH__LEAF_ROWS : SPH__BLOCK_ROWS);
    const sph__v8d v00 = row(e, SPH__M00), v01 = row(e, SPH__M01), v02 = row(e, SPH__M02);
    const sph__v8d v11 = row(e, SPH__M11), v12 = row(e, SPH__M12), v22 = row(e, SPH__M22);
    const sph__v8d n0 = row(e, SPH__N0), n1 = row(e, SPH__N1), n2 = row(e, SPH__N2);
    const sph__v8d d0 = sph__load(v->center, i) - sph__load(u->center, i);
    const sph__v8d d1 = sph__load(v->center, s + i) - sph__load(u->center, s + i);
    const sph__v8d d2 = sph__load(v->center, 2 * s + i) - sph__load(u->center, 2 * s + i);
    const sph__v8d t0 = v00 * d0 + v01 * d1 + v02 * d2;
    const sph__v8d t1 = v01 * d0 + v11 * d1 + v12 * d2;
    const sph__v8d t2 = v02 * d0 + v12 * d1 + v22 * d2;
    const sph__v8d nd = n0 * d0 + n1 * d1 + n2 * d2;
    sph__v8d c = 0.5 * (t0 * d0 + t1 * d1 + t2 * d2) + *offset * nd;
    sph__v8d b0 = t0 + *offset * n0, b1 = t1 + *offset * n1, b2 = t2 + *offset * n2;
    if (!v->leaf) {
        const sph__v8d e0 = row(e, SPH__B0), e1 = row(e, SPH__B1), e2 = row(e, SPH__B2);
        c += e0 * d0 + e1 * d1 + e2 * d2;
        b0 += e0;
        b1 += e1;
        b2 += e2;
    }
    if (!u->leaf) {
        b0 += row(a, SPH__B0);
        b1 += row(a, SPH__B1);
        b2 += row(a, SPH__B2);
    }
    q->m00 = row(a, SPH__M00) + v00;
    q->m01 = row(a, SPH__M01) + v01;
    q->m02 = row(a, SPH__M02) + v02;
    q->m11 = row(a, SPH__M11) + v11;
    q->m12 = row(a, SPH__M12) + v12;
    q->m22 = row(a, SPH__M22) + v22;
    q->n0 = row(a, SPH__N0) + n0;
    q->n1 = row(a, SPH__N1) + n1;
    q->n2 = row(a, SPH__N2) + n2;
    q->b0 = b0;
    q->b1 = b1;
    q->b2 = b2;
    q->d0 = d0;
    q->d1 = d1;
    q->d2 = d2;
    q->sum_b = nd;
    q->sum_c = c;
}

/* Adds delta * sigma |q - mean|^2 to the candidate (Eq. 12); positions relative to the sphere of u. */
SPH__INLINE void add_coherence(const sph__region *u, const sph__region *v, size_t s, size_t i, double delta,
                               frame_quadric *q)
{
    const sph__v8d au = sph__load(u->mean, 3 * s + i), av = sph__load(v->mean, 3 * s + i);
    const sph__v8d zero = {0}, area = au + av, weight = 2 * delta * area;
    const sph__v8d share = sph__where(area, zero, av / area, area);
    sph__v8d x[3];
    for (size_t k = 0; k < 3; ++k) {
        const sph__v8d mu = sph__load(u->mean, k * s + i), mv = sph__load(v->mean, k * s + i);
        x[k] = mu + share * (mv - mu) - sph__load(u->center, k * s + i);
    }
    q->m00 += weight;
    q->m11 += weight;
    q->m22 += weight;
    q->b0 += weight * x[0];
    q->b1 += weight * x[1];
    q->b2 += weight * x[2];
    q->sum_c += 0.5 * weight * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

/* Adjugate and determinant; frames where that is not above `least` are degenerate, and their `inverse` is 0. */
typedef struct frame_inverse {
    sph__v8d a00, a01, a02, a11, a12, a22, det, least, inverse;
} frame_inverse;

SPH__INLINE void invert_frames(const frame_quadric *q, frame_inverse *v)
{
    const sph__v8d third = (q->m00 + q->m11 + q->m22) * (1.0 / 3.0);
    v->a00 = q->m11 * q->m22 - q->m12 * q->m12;
    v->a01 = q->m02 * q->m12 - q->m01 * q->m22;
    v->a02 = q->m01 * q->m12 - q->m02 * q->m11;
    v->a11 = q->m00 * q->m22 - q->m02 * q->m02;
    v->a12 = q->m01 * q->m02 - q->m00 * q->m12;
    v->a22 = q->m00 * q->m11 - q->m01 * q->m01;
    v->det = q->m00 * v->a00 + q->m01 * v->a01 + q->m02 * v->a02;
    v->least = SPH__DEGENERATE * (third * third * third);
    v->inverse = sph__where(v->det, v->least, 1.0 / v->det, v->det - v->det);
}

#endif
