/* SPDX-License-Identifier: MIT */
/* Pictures of posed figures by rays, and PNG files. */
#ifndef PICTURE_H
#define PICTURE_H

#include "camera.h"
#include "figure.h"

typedef struct picture {
    uint32_t width, height;
    unsigned char *rgb; /* rows from the top */
} picture;

/* What is drawn on one tile, and how. */
typedef struct tile {
    const figure *figure;
    const figure *overlay; /* drawn as if of glass over it; NULL: none */
    const camera *camera;
    uint32_t left, top, width, height;
    uint32_t samples; /* rays along the side of a pixel */
    bool has_shadows; /* also from the ground */
    double ground;    /* its height */
    double scale;     /* the diagonal of the box that is looked at */
} tile;

/*
 * Rows are shared among the context's threads; the picture is the same for any number of them. Of all the work `done`
 * is done, and the tile is a `share` of it: that is for progress.
 */
sph_status picture_draw(picture *p, sph_context *context, const tile *t, double done, double share);
/* Writes a PNG file, whole or not at all: DONE, or FAILED after it has said why. */
int picture_save(const picture *p, const char *path);

#endif
