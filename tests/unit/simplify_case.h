/* SPDX-License-Identifier: MIT */
/* What the tests of simplified skins share: a square beam of two parts, and a round tube with a seam of texture. */
#ifndef SPH_TEST_SIMPLIFY_CASE_H
#define SPH_TEST_SIMPLIFY_CASE_H

#include "support.h"

enum { BEAM_FRAMES = 9, TUBE_FRAMES = 10 };

/* A skin, and what belongs to its vertices. */
typedef struct simplify_case {
    sph_skin *skin;
    float *attributes; /* [n][2]: texture coordinates; NULL: none */
    float *normals;    /* [n][3] */
} simplify_case;

/*
 * A closed beam of square rings along x from -2 to 2, `cells` to each side of a ring. Bone 0 holds all vertices up to
 * x = 0, bone 1 all beyond, and turns about z there, by up to 1: the poses bend the strip behind x = 0 alone.
 */
sph_skin *make_beam(sph_context *context, unsigned rings, unsigned cells);

/*
 * An open round tube along x with `sides` sides and a bumpy surface, bent and twisted by three bones with smooth
 * weights. Its texture goes around once: at its seam vertices are there twice.
 */
simplify_case make_tube(sph_context *context, unsigned rings, unsigned sides);
void free_case(simplify_case *c);

sph_skin_arrays arrays_of(const sph_skin *skin);
/* A progressive mesh that must come to be. */
sph_progressive *simplify(const sph_skin *skin, const sph_simplify_options *options);
sph_skin *level_of(const sph_progressive *p, uint32_t level);
sph_progressive_level figures_of(const sph_progressive *p, uint32_t level);

#endif
