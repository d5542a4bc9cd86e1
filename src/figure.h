/* SPDX-License-Identifier: MIT */
/* What is drawn: a level, or an animated mesh as a level of spheres of radius zero; in one pose at a time. */
#ifndef FIGURE_H
#define FIGURE_H

#include <sphmesh/io.h>

#include "camera.h"

typedef struct figure {
    sph_level *level;         /* as drawn; of a mesh the connectivity, in one frame */
    sph_animation *animation; /* NULL: a level */
    sph_query *query;
    uint32_t frame_count;
    const float *centers, *radii; /* of the pose; a mesh has no radii */
    float *positions, *normals;   /* of a mesh, in the pose */
    float *colours;               /* of a mesh's vertices, linear, 3 each; NULL: all the same */
    double pen;                   /* how far from a sphere or edge its colour goes */
} figure;

/* What of a figure is seen at a place. */
typedef struct figure_place {
    double normal[3]; /* unit, to the side of the eye */
    double colour[3]; /* linear */
} figure_place;

/*
 * Makes a figure of a level, which stays the caller's, or of an animation, which becomes the figure's. Nothing is drawn
 * thinner than `line` to either side. Close it also after a failure.
 */
sph_status figure_of_level(figure *f, sph_context *context, const sph_level *level, double line);
sph_status figure_of_animation(figure *f, sph_context *context, sph_animation *animation, double line);
/* Colours the vertices of a mesh by the bones that they follow, mixed by weight. The skin must have as many vertices. */
sph_status figure_colour_by_bones(figure *f, sph_context *context, const sph_skin *skin);
void figure_close(figure *f, sph_context *context);
sph_status figure_pose(figure *f, uint32_t frame);
/* What a ray in that direction sees where it has hit. */
void figure_look(const figure *f, const sph_hit *hit, const double direction[3], figure_place *place);

#endif
