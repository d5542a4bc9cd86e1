/* SPDX-License-Identifier: MIT */
/*
 * A single frame. There is nothing to sum over, so loops go over edges, triangles or vertices instead, eight side by side,
 * and what a region has is one cache line. Each lane does what a row's first lane does with more frames, so the bits do
 * not depend on what is beside it.
 */
#ifndef SPH_HIERARCHY_SINGLE_H
#define SPH_HIERARCHY_SINGLE_H

#include "hierarchy/build.h"

static inline float *sph__single_rows(const sph__builder *b, size_t slot)
{
    return b->rows + slot * SPH__SINGLE_ROWS;
}

/* All leaves. */
sph_status sph__single_leaves(sph__builder *b);
/* The costs of edges, and their candidates. */
void sph__single_evaluate(const sph__builder *b, const uint32_t *edges, size_t count, double *costs);
/* The united sphere's centre into new_center. */
void sph__single_center(const sph__builder *b, uint32_t u, uint32_t v, const sph__candidate *candidate);
/* Whether one of the surviving triangles of u or v turns over when both move to `center`. */
bool sph__single_inverts(const sph__builder *b, uint32_t u, uint32_t v, const float *center);
/* The united quadric, relative to that sphere, into the rows of u. */
void sph__single_unite(const sph__builder *b, uint32_t u, uint32_t v, const sph__candidate *candidate);

#endif
