/* SPDX-License-Identifier: MIT */
/*
 * The spherical quadric error written down as plainly as it can be: one block of coefficients per frame, sums in the
 * widest float type there is, every candidate sphere evaluated by the definition. Slow on purpose; it shares nothing
 * with lib/.
 */
#ifndef SPHMESH_TESTS_REFERENCE_QUADRIC_H
#define SPHMESH_TESTS_REFERENCE_QUADRIC_H

#include <stdbool.h>
#include <stddef.h>

typedef long double reference_real;

/* A frame whose matrix has no more than this times (trace / 3)^3 for its determinant counts as degenerate. */
#define REFERENCE_SINGULAR 1e-6L
/* Coefficients of the problem in (lambda, r) no larger than this, relative to what they are made of, count as zero. */
#define REFERENCE_ZERO 1e-12L

/* Q(q, r) = 1/2 q'M q + r N.q - b.q + 1/2 W r^2 - B r + c of one frame. */
struct reference_quadric {
    reference_real M[3][3], N[3], b[3], W, B, c;
};

/* weight (n.(p - q) - r)^2, with |n| = 1 */
void reference_quadric_add_plane(struct reference_quadric *quadric, const reference_real p[3],
                                 const reference_real n[3], reference_real weight);
/* weight |q - center|^2 */
void reference_quadric_add_attachment(struct reference_quadric *quadric, const reference_real center[3],
                                      reference_real weight);
/* Adds `other`, whose coordinates start at `origin` in those of `quadric`. */
void reference_quadric_add(struct reference_quadric *quadric, const struct reference_quadric *other,
                           const reference_real origin[3]);
reference_real reference_quadric_evaluate(const struct reference_quadric *quadric, const reference_real center[3],
                                          reference_real radius);
bool reference_quadric_is_degenerate(const struct reference_quadric *quadric);

struct reference_minimum {
    reference_real radius, lambda, cost;
    size_t degenerate_frames;
};

/*
 * The sphere of least sum over `count` frames: one radius in [0, radius_max] for all of them, and centres that are free
 * where the frame is regular and on the segment from u to v, at one lambda, where it is degenerate.
 */
void reference_quadric_minimise(const struct reference_quadric *quadrics, size_t count, reference_real (*u)[3],
                                reference_real (*v)[3], reference_real radius_max, struct reference_minimum *minimum,
                                reference_real (*centers)[3]);

#endif
