/* SPDX-License-Identifier: MIT */
/* Kernels over triangles: whether they turn over, and what they enclose. */
#include <math.h>

#include "hierarchy/kernel.h"
#include "hierarchy/lanes.h"

/* The normals, as long as twice the areas, of (p, q, before) and (p, q, after). */
SPH__INLINE void make_normals(const sph__v8d p[3], const sph__v8d q[3], const sph__v8d before[3],
                              const sph__v8d after[3], sph__v8d n[3], sph__v8d m[3])
{
    sph__v8d e[3], f[3], g[3];
    for (size_t k = 0; k < 3; ++k) {
        e[k] = q[k] - p[k];
        f[k] = before[k] - p[k];
        g[k] = after[k] - p[k];
    }
    for (size_t k = 0; k < 3; ++k) {
        const size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        n[k] = e[k1] * f[k2] - e[k2] * f[k1];
        m[k] = e[k1] * g[k2] - e[k2] * g[k1];
    }
}

SPH__INLINE void load_points(const float *x, size_t s, size_t i, sph__v8d to[3])
{
    for (size_t k = 0; k < 3; ++k) to[k] = sph__load(x, k * s + i);
}

/* In eight frames. */
SPH__INLINE void find_normals(const float *p, const float *q, const float *before, const float *after, size_t s, size_t i,
                              sph__v8d n[3], sph__v8d m[3])
{
    sph__v8d points[4][3];
    load_points(p, s, i, points[0]);
    load_points(q, s, i, points[1]);
    load_points(before, s, i, points[2]);
    load_points(after, s, i, points[3]);
    make_normals(points[0], points[1], points[2], points[3], n, m);
}

#define DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])

/* Below zero in one lane at least. */
SPH__INLINE bool is_any_negative(const sph__v8d *x)
{
    int any = 0;
    for (size_t l = 0; l < SPH__LANES; ++l) any |= (*x)[l] < 0;
    return any != 0;
}

/* Asks for the frames that come so many later. */
enum { AHEAD = 32 };

/* Whether the two normals are opposed in any frame. */
SPH__CLONES static bool opposed_clones(const float *p, const float *q, const float *before, const float *after, size_t s)
{
    sph__v8d least = {0};
    for (size_t i = 0; i < s; i += SPH__LANES) {
        sph__v8d n[3], m[3], dot;
        for (size_t k = 0; k < 3 && i % (2 * SPH__LANES) == 0; ++k) {
            __builtin_prefetch(p + k * s + i + AHEAD);
            __builtin_prefetch(q + k * s + i + AHEAD);
        }
        find_normals(p, q, before, after, s, i, n, m);
        dot = DOT(n, m);
        sph__smaller(&dot, &least);
    }
    return is_any_negative(&least);
}

/* The sum over frames of sqrt(area * area') n.n' = (N.N') / (2 sqrt(|N| |N'|)), N being twice the area times n. */
SPH__CLONES static double inversion_clones(const float *p, const float *q, const float *before, const float *after,
                                           size_t s)
{
    const sph__v8d zero = {0};
    sph__v8d sum = {0};
    for (size_t i = 0; i < s; i += SPH__LANES) {
        sph__v8d n[3], m[3], squared, root;
        find_normals(p, q, before, after, s, i, n, m);
        squared = DOT(n, n) * DOT(m, m);
        root = sph__root(squared);
        root = sph__root(root);
        sum += sph__where(squared, zero, DOT(n, m) / root, squared - squared);
    }
    return 0.5 * sph__sum(sum);
}

bool sph__kernel_inverts(const float *p, const float *q, const float *before, const float *after, size_t stride)
{
    return opposed_clones(p, q, before, after, stride) && inversion_clones(p, q, before, after, stride) < 0;
}

/* Eight points of one frame, each of four floats of which three count. */
SPH__INLINE void gather_points(const float *const *from, sph__v8d to[3])
{
    sph__v8f rows[4], pairs[4];
    for (size_t l = 0; l < 4; ++l)
        rows[l] = __builtin_shufflevector(*(const sph__v4f *)from[l], *(const sph__v4f *)from[l + 4], 0, 1, 2, 3, 4, 5, 6, 7);
    for (size_t l = 0; l < 2; ++l) {
        pairs[l] = __builtin_shufflevector(rows[2 * l], rows[2 * l + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        pairs[l + 2] = __builtin_shufflevector(rows[2 * l], rows[2 * l + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    to[0] = sph__widen(__builtin_shufflevector(pairs[0], pairs[1], 0, 1, 8, 9, 4, 5, 12, 13));
    to[1] = sph__widen(__builtin_shufflevector(pairs[0], pairs[1], 2, 3, 10, 11, 6, 7, 14, 15));
    to[2] = sph__widen(__builtin_shufflevector(pairs[2], pairs[3], 0, 1, 8, 9, 4, 5, 12, 13));
}

SPH__CLONES static bool any_inversion_clones(const float *const *p, const float *const *q, const float *before,
                                             const float *after)
{
    const sph__v8d zero = {0};
    sph__v8d points[4][3], n[3], m[3], dot;
    gather_points(p, points[0]);
    gather_points(q, points[1]);
    for (size_t k = 0; k < 3; ++k) {
        points[2][k] = zero + (double)before[k];
        points[3][k] = zero + (double)after[k];
    }
    make_normals(points[0], points[1], points[2], points[3], n, m);
    dot = DOT(n, m);
    return is_any_negative(&dot);
}

bool sph__kernel_any_inversion(const float *const p[SPH__LANES], const float *const q[SPH__LANES], const float before[3],
                               const float after[3])
{
    return any_inversion_clones(p, q, before, after);
}

SPH__INLINE void add_volume(const float *o, const float *p, const float *q, const float *r, size_t s, size_t i,
                            sph__v8d *volume, sph__v8d *area)
{
    sph__v8d d[3], e[3], f[3], n[3], squared;
    for (size_t k = 0; k < 3; ++k) {
        const sph__v8d at = sph__load(p, k * s + i);
        d[k] = at - sph__load(o, k * s + i);
        e[k] = sph__load(q, k * s + i) - at;
        f[k] = sph__load(r, k * s + i) - at;
    }
    for (size_t k = 0; k < 3; ++k) {
        const size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        n[k] = e[k1] * f[k2] - e[k2] * f[k1];
    }
    squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    *area += sph__root(squared);
    *volume += n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
}

SPH__CLONES static void volume_clones(const float *o, const float *p, const float *q, const float *r, size_t s,
                                      double sums[2])
{
    sph__v8d volume = {0}, area = {0};
    for (size_t i = 0; i < s; i += SPH__LANES) add_volume(o, p, q, r, s, i, &volume, &area);
    sums[0] = sph__sum(volume) / 6;
    sums[1] = sph__sum(area) / 2;
}

SPH__CLONES static void volumes_clones(float (*corners)[3][SPH__LANES], double (*sums)[2])
{
    sph__v8d volume = {0}, area = {0};
    add_volume(corners[0][0], corners[1][0], corners[2][0], corners[3][0], SPH__LANES, 0, &volume, &area);
    for (size_t l = 0; l < SPH__LANES; ++l) {
        sums[l][0] = volume[l] / 6;
        sums[l][1] = area[l] / 2;
    }
}

void sph__kernel_volumes(float corners[4][3][SPH__LANES], double sums[SPH__LANES][2])
{
    volumes_clones(corners, sums);
}

void sph__kernel_volume(const float *o, const float *p, const float *q, const float *r, size_t stride, double sums[2])
{
    volume_clones(o, p, q, r, stride, sums);
}
