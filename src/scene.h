/* SPDX-License-Identifier: MIT */
/* The figures of a picture, in order, and the box that its camera takes in. */
#ifndef SCENE_H
#define SCENE_H

#include "figure.h"
#include "session.h"

enum { SCENE_COUNTS = 64 };

typedef struct scene_options {
    input_options input;           /* its frames are those that the levels were made of */
    uint32_t counts[SCENE_COUNTS]; /* of spheres, for hierarchies */
    size_t count_count;
    const char *overlay; /* NULL: none */
    const char *bones;   /* a rig whose bones colour the input; NULL: none */
} scene_options;

typedef struct scene {
    figure *figures;
    size_t figure_count;
    figure overlay;  /* overlay.query NULL: none */
    box mean;        /* of the box over all frames: of the overlay, or the input, or what the hierarchies were made of,
                        or the levels, whichever there is first */
    double *middles; /* of the box in every frame, 3 each */
    uint32_t middle_count;
    double ground; /* the lowest point of all frames */
} scene;

/* DONE, or FAILED after it has said why. Close it also then. */
int scene_open(session *s, const scene_options *o, const arguments *paths, scene *out);
void scene_close(session *s, scene *sc);
/* Is it a level or a hierarchy, by its name? */
bool scene_is_level(const char *path);

#endif
