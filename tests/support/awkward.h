/* SPDX-License-Identifier: MIT */
/* Inputs of every kind that the library accepts, the senseless ones before all. */
#ifndef SPH_TEST_AWKWARD_H
#define SPH_TEST_AWKWARD_H

#include <sphmesh/sphmesh.h>

enum awkward_kind {
    AWKWARD_SINGLE_VERTEX,
    AWKWARD_TWO_COINCIDENT, /* and not connected */
    AWKWARD_COINCIDENT_WIRE,
    AWKWARD_ISOLATED,
    AWKWARD_WIRES, /* a random graph */
    AWKWARD_WIRE_STAR,
    AWKWARD_REPEATED_EDGES, /* and edges from a vertex to itself */
    AWKWARD_TRIANGLE,
    AWKWARD_DUPLICATES, /* of both windings */
    AWKWARD_REPEATED_INDICES,
    AWKWARD_COLLINEAR, /* triangles without area */
    AWKWARD_BOOK,      /* pages around one edge */
    AWKWARD_CONE,      /* triangles around one vertex */
    AWKWARD_COMPONENTS,
    AWKWARD_FLAT,
    AWKWARD_ONE_POINT,
    AWKWARD_SQUASHED,   /* a sphere that is almost flat */
    AWKWARD_COLLAPSING, /* a sphere of which later frames leave a point, a line, a disc */
    AWKWARD_THIN_SOUP,
    AWKWARD_SOUP,
    AWKWARD_DENSE_SOUP,
    AWKWARD_MOEBIUS,
    AWKWARD_WHISKERS, /* a torus with wires */
    AWKWARD_CUBE,
    AWKWARD_SPHERE,
    AWKWARD_TORUS,
    AWKWARD_KIND_COUNT
};

const char *awkward_name(unsigned kind);

typedef struct awkward_options {
    unsigned frames;
    double scale; /* of all coordinates; 0: 1 */
    double shift; /* of all coordinates, after the scale */
    bool inward;  /* all triangles wound the other way round */
} awkward_options;

/* At most some 100 vertices. Frame 0 is at rest, the others waver; NULL when the library fails. */
sph_animation *awkward_animation(sph_context *context, unsigned kind, awkward_options options);
/* The same at its natural size. */
sph_animation *awkward(sph_context *context, unsigned kind, unsigned frames);

/* Connected components, counted from triangles and edges. */
uint32_t test_component_count(const sph_animation *animation);

#endif
