/* SPDX-License-Identifier: MIT */
/* The simplices of a level, as they follow from the input and from who holds which vertex: nothing else. */
#ifndef SPH_TEST_SIMPLICIAL_H
#define SPH_TEST_SIMPLICIAL_H

#include <sphmesh/sphmesh.h>

/* Corners ascending, simplices ascending, each once. `edges` are all of them, those of triangles too. */
typedef struct simplicial {
    uint32_t vertex_count;
    size_t edge_count, triangle_count;
    uint32_t (*edges)[2];
    uint32_t (*triangles)[3];
} simplicial;

/* The image of the input when its vertices become `labels`; SPH_NO_SPHERE has no image. */
simplicial simplicial_of_labels(const sph_animation *animation, const uint32_t *labels, uint32_t vertex_count);
/*
 * That of a level, from its arrays; NULL in *wrong, or what is wrong with them: an index out of range, a simplex that
 * is there twice or names a vertex twice, a wire edge that is that of a triangle.
 */
simplicial simplicial_of_level(const sph_level_arrays *arrays, const char **wrong);
void simplicial_free(simplicial *complex);

bool simplicial_equal(const simplicial *a, const simplicial *b);
bool simplicial_has_edge(const simplicial *complex, uint32_t a, uint32_t b);
bool simplicial_has_triangle(const simplicial *complex, uint32_t a, uint32_t b, uint32_t c);
uint32_t simplicial_components(const simplicial *complex);
/* V - E + T */
long simplicial_euler(const simplicial *complex);
/* What uniting u and v does to V - E + T, by the simplices around them. O(V + E + T) */
long simplicial_euler_change(const simplicial *complex, uint32_t u, uint32_t v);

#endif
