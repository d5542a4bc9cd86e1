/* SPDX-License-Identifier: MIT */
/*
 * Importance from curvature. A sharp tip has almost no area, and the planes of its triangles do not show that it ends: a
 * sphere may slide along them, and the tip is lost. What a tip does have is curvature: its normals cover a part of the
 * sphere of directions. So each vertex of positive angle deficit (the Gaussian curvature of its cell) adds one plane
 * more: through the vertex, along its normal, weighted by the deficit times SPH__CAP_RADIUS^2. That is the area of the
 * cap over the tip on the surface that runs SPH__CAP_RADIUS outside the mesh. docs/importance.md tells of the choice.
 */
#include <math.h>

#include "hierarchy/build.h"
#include "hierarchy/lanes.h"

#define TWO_PI 6.283185307179586
#define HALF_PI 1.5707963267948966

#define DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])

SPH__INLINE void take_root(sph__v8d *x)
{
    for (size_t l = 0; l < SPH__LANES; ++l) (*x)[l] = sqrt((*x)[l]);
}

/* The tangent of half the angle whose tangent is *t. */
SPH__INLINE void halve(sph__v8d *t)
{
    sph__v8d root = 1.0 + *t * *t;
    take_root(&root);
    *t = *t / (1.0 + root);
}

/* Adds the angle of (x, y), y >= 0, in [0, pi]; by halving the angle twice, and then its series, to 1e-9: no library
 * function, so the same bits everywhere. 0 for the zero vector. */
SPH__INLINE void add_angle(const sph__v8d *x, const sph__v8d *y, sph__v8d *sum)
{
    const sph__v8d size = sph__select(*x < 0, -*x, *x);
    const sph__v8i steep = *y > size;
    const sph__v8d high = sph__select(steep, *y, size), low = sph__select(steep, size, *y);
    sph__v8d t = sph__select(high > 0, low / high, high), t2, a;
    halve(&t);
    halve(&t);
    t2 = t * t;
    a = 4.0 * t *
        (1.0 - t2 * (1.0 / 3 - t2 * (1.0 / 5 - t2 * (1.0 / 7 - t2 * (1.0 / 9 - t2 * (1.0 / 11 - t2 * (1.0 / 13)))))));
    a = sph__select(steep, HALF_PI - a, a);
    *sum += sph__select(*x < 0, 2 * HALF_PI - a, a);
}

SPH__INLINE void subtract(const float *q, const float *p, size_t s, size_t i, sph__v8d e[3])
{
    for (size_t k = 0; k < 3; ++k) e[k] = sph__load(q, k * s + i) - sph__load(p, k * s + i);
}

/* Eight frames of the sum of angles around v. */
SPH__INLINE void sum_angles(const sph__builder *b, uint32_t v, size_t i, sph__v8d *angles)
{
    const size_t s = b->stride;
    const float *p = sph__node_center(b, v);
    *angles = (sph__v8d){0};
    for (size_t c = b->cell_starts[v]; c < b->cell_starts[v + 1]; ++c) {
        uint32_t next, previous;
        sph__v8d e[3], f[3], n[3], cosine, sine;
        sph__cell_others(b, c, v, &next, &previous);
        subtract(sph__node_center(b, next), p, s, i, e);
        subtract(sph__node_center(b, previous), p, s, i, f);
        n[0] = e[1] * f[2] - e[2] * f[1];
        n[1] = e[2] * f[0] - e[0] * f[2];
        n[2] = e[0] * f[1] - e[1] * f[0];
        cosine = DOT(e, f);
        sine = DOT(n, n);
        take_root(&sine);
        add_angle(&cosine, &sine, angles);
    }
}

SPH__CLONES static double add_cap(const sph__builder *b, uint32_t v, double weight, float *block)
{
    const size_t s = b->stride;
    sph__v8d total = {0};
    for (size_t i = 0; i < s; i += SPH__LANES) {
        sph__v8d angles, n[3], length, w;
        sum_angles(b, v, i, &angles);
        for (size_t k = 0; k < 3; ++k) n[k] = sph__load(block, (SPH__N0 + k) * s + i);
        length = DOT(n, n);
        take_root(&length);
        /* no angle at all is no tip but a vertex whose triangles have collapsed */
        w = sph__select((length > 0) & (angles > 0) & (angles < TWO_PI), weight * (TWO_PI - angles), angles * 0);
        for (size_t k = 0; k < 3; ++k) n[k] = sph__select(length > 0, n[k] / length, length);
        total += w;
        sph__store(block, 0 * s + i, sph__load(block, 0 * s + i) + w * n[0] * n[0]);
        sph__store(block, 1 * s + i, sph__load(block, 1 * s + i) + w * n[0] * n[1]);
        sph__store(block, 2 * s + i, sph__load(block, 2 * s + i) + w * n[0] * n[2]);
        sph__store(block, 3 * s + i, sph__load(block, 3 * s + i) + w * n[1] * n[1]);
        sph__store(block, 4 * s + i, sph__load(block, 4 * s + i) + w * n[1] * n[2]);
        sph__store(block, 5 * s + i, sph__load(block, 5 * s + i) + w * n[2] * n[2]);
        for (size_t k = 0; k < 3; ++k)
            sph__store(block, (SPH__N0 + k) * s + i, sph__load(block, (SPH__N0 + k) * s + i) + w * n[k]);
    }
    return sph__sum(total);
}

double sph__add_cap(const sph__builder *b, uint32_t v, float *block)
{
    const double radius = SPH__CAP_RADIUS * b->h->bounding_diagonal;
    return !b->cell_open[v] ? add_cap(b, v, 2 * radius * radius, block) : 0;
}
