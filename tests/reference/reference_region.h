/* SPDX-License-Identifier: MIT */
/* A region of the input: what the reference knows of the vertices that one sphere stands for. */
#ifndef SPHMESH_TESTS_REFERENCE_REGION_H
#define SPHMESH_TESTS_REFERENCE_REGION_H

#include "reference.h"

struct region_frame {
    struct reference_quadric quadric; /* relative to the anchor */
    reference_real anchor[3];         /* position of one of the region's vertices */
    reference_real area;              /* of its barycentric cells */
    reference_real moment[3];         /* sum over its vertices of area times position, relative to the anchor */
};

struct region {
    bool alive;
    reference_real cost;
    struct region_frame *frames; /* [F] */
    double (*extents)[2];        /* [F][directions]: least and largest coordinate */
    struct reference_sphere sphere;
};

void *reference_allocate(size_t count, size_t size); /* zeroed */

void region_create_leaf(struct region *region, const struct reference_input *input, uint32_t vertex);
void region_unite(struct region *w, const struct region *u, const struct region *v,
                  const struct reference_input *input);
void region_free(struct region *region);

double region_width(const struct region *region, const struct reference_input *input, uint32_t frame);
/* Bound of the radius in a frame. */
double region_radius_bound(const struct region *region, const struct reference_input *input, uint32_t frame);
/* The frame's quadric with the term of temporal coherence, if any, added. */
struct reference_quadric region_candidate_quadric(const struct region *region, const struct reference_input *input,
                                                  uint32_t frame);
/* The region's best sphere for the segments between the spheres of u and v; returns its cost. */
reference_real region_fit(const struct region *region, const struct reference_input *input,
                          const struct reference_sphere *u, const struct reference_sphere *v,
                          struct reference_sphere *sphere, size_t *degenerate_frames);

/* The region's own quadric, without temporal coherence, at a sphere. */
reference_real region_cost(const struct region *region, uint32_t frame_count, const struct reference_sphere *sphere);

void reference_sphere_create(struct reference_sphere *sphere, uint32_t frame_count);
void reference_sphere_copy(struct reference_sphere *to, const struct reference_sphere *from, uint32_t frame_count);
void reference_sphere_free(struct reference_sphere *sphere);

#endif
