/* SPDX-License-Identifier: MIT */
/*
 * A second, independent implementation of the hierarchy of animated sphere-meshes, to which the library's is compared:
 * quadratic time, every array as plain as can be, wide floating point. It knows nothing of lib/. Running out of memory
 * aborts: this is for tests.
 */
#ifndef SPHMESH_TESTS_REFERENCE_H
#define SPHMESH_TESTS_REFERENCE_H

#include <stdint.h>

#include "reference_quadric.h"

enum reference_radius_mode { REFERENCE_RADIUS_CONSTANT, REFERENCE_RADIUS_PER_FRAME, REFERENCE_RADIUS_ZERO };

struct reference_input {
    uint32_t vertex_count, frame_count;
    const float *positions; /* [F][n][3] */
    size_t triangle_count;
    const uint32_t *triangles; /* [m][3], counter-clockwise seen from outside */
    size_t edge_count;
    const uint32_t *edges;   /* [e][2] */
    const float *importance; /* [F][n], or NULL: all 1 */
    enum reference_radius_mode radius_mode;
    double radius_factor;
    double temporal_coherence; /* delta of Eq. 11, used as it is */
    uint32_t direction_count;
    const double *directions; /* [direction_count][3]: unit vectors the width is taken over */
};

struct reference_sphere {
    double (*centers)[3]; /* [F] */
    double *radii;        /* [F]: the same F times unless radii are per frame */
};

struct reference_collapse {
    uint32_t u, v, node; /* u < v */
    bool forced;
    double cost, error; /* the region's own quadric, without temporal coherence */
    struct reference_sphere sphere;
};

/* ---- all of it at once ---- */

struct reference_result {
    size_t collapse_count;
    struct reference_collapse *collapses;
};

void reference_run(const struct reference_input *input, struct reference_result *result);
void reference_result_free(struct reference_result *result);

/* ---- or step by step, so that a test can look into it and choose among edges that are as good ---- */

/* An edge between two nodes that are alive, evaluated. */
struct reference_edge {
    uint32_t u, v;            /* u < v */
    bool refused;             /* left the queue because it inverts; waits for its surroundings to change */
    double cost;              /* that decides: with temporal coherence */
    size_t degenerate_frames; /* in which the centre was on the segment from u to v */
    struct reference_sphere sphere;
};

struct reference;

struct reference *reference_create(const struct reference_input *input); /* borrows the input */
void reference_destroy(struct reference *reference);

/* The edge that the rules collapse next, or NULL when none is left. Refuses edges on its way. Valid until the next
 * call. */
const struct reference_edge *reference_next(struct reference *reference, bool *forced);
/* Any edge that is alive, or NULL. Valid until the next call that is not const. */
const struct reference_edge *reference_find(const struct reference *reference, uint32_t u, uint32_t v);
/* Collapses an edge that is alive; `sphere`, where not NULL, takes the place of the one that was found for it. */
void reference_collapse(struct reference *reference, uint32_t u, uint32_t v, bool forced,
                        const struct reference_sphere *sphere, struct reference_collapse *collapse);
void reference_collapse_free(struct reference_collapse *collapse);

/* Cost of any sphere for the region that an edge would make, the temporal coherence term included. */
double reference_cost(const struct reference *reference, uint32_t u, uint32_t v, const struct reference_sphere *sphere);
/*
 * The least s = sum_f sqrt(area area') n.n' over the triangles that the collapse of an edge into a sphere would move,
 * relative to the squares of their longest sides; 1 where there is none. Below zero: refused.
 */
double reference_least_turn(const struct reference *reference, uint32_t u, uint32_t v,
                            const struct reference_sphere *sphere);

/* ---- what a test may ask about the edge (u, v) of nodes that are alive ---- */

/* Upper bound of the radius in a frame (the same for all unless radii are per frame). */
double reference_radius_bound(const struct reference *reference, uint32_t u, uint32_t v, uint32_t frame);
/* Whether the planes of the united region leave its centre in this frame undetermined. */
bool reference_is_degenerate(const struct reference *reference, uint32_t u, uint32_t v, uint32_t frame);
/* Sum of W of the united region over all frames. */
double reference_weight(const struct reference *reference, uint32_t u, uint32_t v);
/* The same of 2 delta times area, the weight of temporal coherence. */
double reference_coherence_weight(const struct reference *reference, uint32_t u, uint32_t v);
/* Largest extent of the united region over all frames and directions. */
double reference_extent(const struct reference *reference, uint32_t u, uint32_t v);
/* Current sphere of a node that is alive. */
const struct reference_sphere *reference_node(const struct reference *reference, uint32_t node);
/* What is alive, in no order. */
size_t reference_triangle_count(const struct reference *reference);
size_t reference_edge_count(const struct reference *reference);
const uint32_t *reference_triangle(const struct reference *reference, size_t index);
const struct reference_edge *reference_edge(const struct reference *reference, size_t index);

#endif
