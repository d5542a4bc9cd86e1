/* SPDX-License-Identifier: MIT */
/* Levels whose surface is known, and their signed distance by brute force. */
#ifndef SPH_TEST_SURFACE_SHAPES_H
#define SPH_TEST_SURFACE_SHAPES_H

#include <sphmesh/sphmesh.h>

enum { MOST_SPHERES = 128, MOST_SIMPLICES = 256 };

typedef struct shape {
    uint32_t spheres;
    size_t edges, triangles;
    float centers[3 * MOST_SPHERES], radii[MOST_SPHERES];
    uint32_t edge[2 * MOST_SIMPLICES], triangle[3 * MOST_SIMPLICES];
} shape;

/* Shapes of a known topology. */
enum {
    SPHERE,
    CAPSULE,
    TRIANGLE,
    BALLS,
    RING,
    THETA,
    STAR,
    THIN_STAR,
    SHEET,
    FLAT,
    SHELL,
    THIN_SHELL,
    FILLED_SHELL,
    CUP,
    NESTED_RINGS,
    POINT,
    WIRE,
    CONTAINED,
    TWICE,
    SHAPES
};

typedef struct shape_facts {
    const char *name;
    int euler, parts;
} shape_facts;
extern const shape_facts EXPECTED[SHAPES];

uint32_t add_sphere(shape *s, double x, double y, double z, double r);
void add_edge(shape *s, uint32_t a, uint32_t b);
void add_star(shape *s, uint32_t branches, double r);
/* One of the above, alone. */
void make_shape(int kind, shape *s);
/* Nine spheres, and edges and triangles of any of them. */
void random_shape(uint64_t *state, shape *s);

/* NULL when the library fails. */
sph_level *make_level(sph_context *of, const shape *s);
/* Asserts that it can be done. */
sph_surface *extract(sph_context *context, const shape *s, uint32_t resolution);

/* Signed distance to the shape's solid with radii of at least `least_radius`. */
double brute_distance(const shape *s, const double x[3], double least_radius);

#endif
