/* SPDX-License-Identifier: MIT */
/*
 * The convex solids a level is made of: a sphere, a tapered capsule (hull of two spheres), a thick triangle (hull of
 * three). The signed distance of a point is the least |x - c(b)| - r(b) over the barycentric weights b; it is exact
 * outside and inside, and convex in x. Any radii >= 0 and any centres will do: coincident, collinear, one within
 * another.
 */
#ifndef SPH_PRIMITIVE_H
#define SPH_PRIMITIVE_H

#include <stdbool.h>
#include <stdint.h>

#include "numeric/vector.h"

/* The capsule along one edge. */
typedef struct sph__primitive_edge {
    int32_t from, to;    /* corners */
    int32_t only;        /* the corner whose sphere contains the other; -1: neither does */
    double axis[3];      /* unit, from -> to */
    double length;       /* between the centres */
    double sine, cosine; /* of the slope of the side: (r(from) - r(to)) / length */
} sph__primitive_edge;

typedef struct sph__primitive {
    int32_t corner_count; /* 1, 2 or 3 */
    bool has_faces;       /* of a triangle: two planes touch all three spheres */
    double center[3][3];
    double radius[3];
    sph__primitive_edge edge[3]; /* one for a capsule, three for a triangle */
    /* with has_faces: */
    double plane_normal[3];  /* unit normal of the plane of the centres */
    double tilt[3];          /* in that plane; the faces' normals are tilt +- rise * plane_normal */
    double rise;             /* > 0 */
    double gradient[2][3];   /* of the weights of corners 1 and 2 in the plane of the centres */
    double gradient_tilt[2]; /* gradient . tilt / rise */
} sph__primitive;

/* The nearest point of a primitive's boundary. */
typedef struct sph__contact {
    double distance;   /* < 0 inside */
    double point[3];   /* on the boundary */
    double normal[3];  /* unit, outward */
    double weights[3]; /* barycentric, of the sphere that touches there; >= 0, sum 1 */
} sph__contact;

/* Prepares the hull of `corner_count` (1 to 3) finite spheres. */
void sph__primitive_set(sph__primitive *primitive, int32_t corner_count, const double (*centers)[3],
                        const double *radii);

double sph__primitive_distance(const sph__primitive *primitive, const double x[3]);
/* The same, and its derivative along `direction`. */
double sph__primitive_slope(const sph__primitive *primitive, const double x[3], const double direction[3],
                            double *slope);
void sph__primitive_closest(const sph__primitive *primitive, const double x[3], sph__contact *contact);

/*
 * First point origin + s * direction, 0 <= s <= limit, in the primitive; 0 where the origin is inside. False where
 * there is none; *s is then untouched. A primitive of no volume is hit on its faces, not on edges and points of no
 * radius.
 */
bool sph__primitive_cast(const sph__primitive *primitive, const double origin[3], const double direction[3],
                         double limit, double *s);

/* The axis-aligned box of the primitive. */
void sph__primitive_bounds(const sph__primitive *primitive, double low[3], double high[3]);

/* Corners of the planar face on side +1 or -1 of the plane of the centres, and its normal; needs has_faces. */
void sph__primitive_face(const sph__primitive *primitive, int side, double corners[3][3], double normal[3]);

/* Of the sphere that the face nearest to centre 0 + d touches, `height` (towards that face) above the centres' plane.
 * The edges on whose outer side the weights are, as bits. */
static inline int sph__primitive_weights(const sph__primitive *p, const double d[3], double height, double *b1,
                                         double *b2)
{
    *b1 = sph__dot(p->gradient[0], d) - height * p->gradient_tilt[0];
    *b2 = sph__dot(p->gradient[1], d) - height * p->gradient_tilt[1];
    return (*b2 < 0 ? 1 : 0) | (*b1 + *b2 > 1 ? 2 : 0) | (*b1 < 0 ? 4 : 0);
}

#endif
