/* SPDX-License-Identifier: MIT */
/* Facts about a closed triangle mesh, found without any help of the library. */
#ifndef MESH_CHECK_H
#define MESH_CHECK_H

#include <sphmesh/sphmesh.h>

typedef struct mesh_facts {
    int euler; /* vertices - edges + triangles */
    int parts; /* connected ones */
    double area, volume;
} mesh_facts;

/*
 * Fails the test unless every edge has exactly two triangles that run through it in opposite directions, every vertex
 * one cycle of triangles around it, and every normal unit length.
 */
mesh_facts check_surface(const sph_surface *surface, uint32_t index);

/* How often the mesh goes around x, by solid angles. */
double winding_number(const sph_surface *surface, uint32_t index, const double x[3]);

#endif
