/* SPDX-License-Identifier: MIT */
/*
 * Importance from curvature. A sharp tip has almost no area, and the planes of its triangles do not show that it ends: a
 * sphere may slide along them, and the tip is lost. What a tip does have is curvature: its normals cover a part of the
 * sphere of directions. So each vertex of positive angle deficit (the Gaussian curvature of its cell) adds one plane
 * more: through the vertex, along its normal, weighted by the deficit times SPH__CAP_RADIUS^2. That is the area of the
 * cap over the tip on the surface that runs SPH__CAP_RADIUS outside the mesh. docs/importance.md tells of the choice.
 */
#ifndef SPH_HIERARCHY_CAPS_H
#define SPH_HIERARCHY_CAPS_H

#include <math.h>

#include "hierarchy/build.h"
#include "hierarchy/lanes.h"

#define SPH__TWO_PI 6.283185307179586
#define SPH__HALF_PI 1.5707963267948966

#define SPH__DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])

#define SPH__TAN_PI_16 0.19891236737965800
#define SPH__TAN_PI_8 0.41421356237309505
#define SPH__TAN_3_PI_16 0.66817863791929891

/* The angle of (x, y), y >= 0, in [0, pi]: that to the nearest of 0, pi/8 and pi/4 by its series, to 1e-10; no library
 * function, so the same bits everywhere. */
SPH__INLINE void sph__angle_of(const sph__v8d *x, const sph__v8d *y, sph__v8d *angle)
{
    const sph__v8d zero = {0};
    const sph__v8d size = sph__where(zero, *x, -*x, *x);
    const sph__v8d high = sph__where(*y, size, *y, size), low = sph__where(*y, size, size, *y);
    const sph__v8d first = high * SPH__TAN_PI_16, second = high * SPH__TAN_3_PI_16;
    sph__v8d middle = sph__where(low, first, zero + SPH__TAN_PI_8, zero);
    sph__v8d around = sph__where(low, first, zero + SPH__HALF_PI / 4, zero), t, t2, a;
    middle = sph__where(low, second, zero + 1.0, middle);
    around = sph__where(low, second, zero + SPH__HALF_PI / 2, around);
    t = (low - middle * high) / (high + middle * low);
    t2 = t * t;
    a = t * (1.0 - t2 * (1.0 / 3 - t2 * (1.0 / 5 - t2 * (1.0 / 7 - t2 * (1.0 / 9 - t2 * (1.0 / 11 - t2 * (1.0 / 13)))))));
    a += around;
    a = sph__where(*y, size, SPH__HALF_PI - a, a);
    *angle = sph__where(zero, *x, 2 * SPH__HALF_PI - a, a);
}

/*
 * A sum of angles in [0, pi] without a function for each: the vectors (x, y) that have them, y >= 0, are multiplied as
 * complex numbers. Whenever that leads below the x axis it is turned back by half a turn, which is counted.
 */
typedef struct sph__turn {
    sph__v8d x, y; /* y >= 0: what is beyond the half-turns */
    sph__v8i half_turns;
} sph__turn;

#define SPH__SIGN INT64_MIN
#define SPH__EXPONENT INT64_C(0x7ff0000000000000)

SPH__INLINE void sph__turn_start(sph__turn *turn)
{
    const sph__v8d zero = {0};
    const sph__v8i none = {0};
    turn->x = zero + 1.0;
    turn->y = zero;
    turn->half_turns = none;
}

/* To |x| + |y| in [1, 2), by a power of two, and the zero vector to itself; returns |x| + |y| as it was. */
SPH__INLINE void sph__bring_near_one(sph__v8d *x, sph__v8d *y, sph__v8d *size)
{
    sph__v8d scale;
    *size = (sph__v8d)((sph__v8i)*x & ~SPH__SIGN) + (sph__v8d)((sph__v8i)*y & ~SPH__SIGN);
    scale = (sph__v8d)(SPH__EXPONENT - (INT64_C(1) << 52) - ((sph__v8i)*size & SPH__EXPONENT));
    *x *= scale;
    *y *= scale;
}

/* Adds the angle of (x, y), y >= 0; 0 for the zero vector. */
SPH__INLINE void sph__turn_by(const sph__v8d *cosine, const sph__v8d *sine, sph__turn *turn)
{
    const sph__v8d zero = {0};
    sph__v8d c = *cosine, s = *sine, size, x, y;
    sph__v8i below;
    sph__bring_near_one(&c, &s, &size);
    c = sph__where(size, zero, c, zero + 1.0);
    x = turn->x * c - turn->y * s;
    y = turn->x * s + turn->y * c;
    below = (sph__v8i)y & SPH__SIGN;
    turn->x = (sph__v8d)((sph__v8i)x ^ below);
    turn->y = (sph__v8d)((sph__v8i)y ^ below);
    turn->half_turns += (sph__v8i)((sph__v8u)below >> 63);
}

SPH__INLINE void sph__turn_angle(const sph__turn *turn, sph__v8d *angle)
{
    const sph__v8i two_to_52 = ((sph__v8i){0}) + INT64_C(0x4330000000000000);
    const sph__v8d half_turns = (sph__v8d)(turn->half_turns | two_to_52) - (sph__v8d)two_to_52;
    sph__angle_of(&turn->x, &turn->y, angle);
    *angle += 2 * SPH__HALF_PI * half_turns;
}

/* Adds the cap's plane in eight frames, from the sum of angles and the rows of the quadric without it: its part of W. */
SPH__INLINE void sph__add_cap_plane(const sph__turn *turn, double weight, float *eight, sph__v8d *total)
{
    const sph__v8d zero = {0};
    sph__v8d n[3], angles, squared, length, w, x, y, z;
    sph__turn_angle(turn, &angles);
#define row(number) sph__load(eight, (number) * SPH__LANES)
    for (size_t k = 0; k < 3; ++k) n[k] = row(SPH__N0 + k);
    squared = SPH__DOT(n, n);
    length = sph__root(squared);
    /* no angle at all is no tip but a vertex whose triangles have collapsed */
    w = weight * (SPH__TWO_PI - angles);
    w = sph__where(w, zero, w, zero);
    w = sph__where(angles, zero, w, zero);
    w = sph__where(squared, zero, w, zero);
    *total += w;
    w = sph__where(w, zero, w / squared, zero);
    x = w * n[0];
    y = w * n[1];
    z = w * n[2];
    sph__store(eight, SPH__M00 * SPH__LANES, row(SPH__M00) + x * n[0]);
    sph__store(eight, SPH__M01 * SPH__LANES, row(SPH__M01) + x * n[1]);
    sph__store(eight, SPH__M02 * SPH__LANES, row(SPH__M02) + x * n[2]);
    sph__store(eight, SPH__M11 * SPH__LANES, row(SPH__M11) + y * n[1]);
    sph__store(eight, SPH__M12 * SPH__LANES, row(SPH__M12) + y * n[2]);
    sph__store(eight, SPH__M22 * SPH__LANES, row(SPH__M22) + z * n[2]);
    sph__store(eight, SPH__N0 * SPH__LANES, n[0] + x * length);
    sph__store(eight, SPH__N1 * SPH__LANES, n[1] + y * length);
    sph__store(eight, SPH__N2 * SPH__LANES, n[2] + z * length);
#undef row
}

#endif
