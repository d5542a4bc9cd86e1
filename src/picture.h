/* SPDX-License-Identifier: MIT */
/* Pictures of posed levels by parallel rays, and PNG files. */
#ifndef PICTURE_H
#define PICTURE_H

#include <sphmesh/sphmesh.h>

typedef struct picture {
    uint32_t width, height;
    unsigned char *rgb; /* rows from the top */
} picture;

/* Parallel rays along -back through a square of side 2 * reach around `middle`. */
typedef struct picture_view {
    double middle[3], reach;
    double right[3], up[3], back[3]; /* unit */
} picture_view;

/* Looks from `azimuth` degrees around y (0: from +z) and `elevation` above the horizon. */
void picture_turn(picture_view *view, double azimuth, double elevation);
/* Draws the level into the square tile of `size` pixels at (left, top). */
sph_status picture_draw(picture *p, sph_context *context, const sph_query *query, const picture_view *view,
                        uint32_t left, uint32_t top, uint32_t size);
/* Writes a PNG file, whole or not at all: DONE, or FAILED after it has said why. */
int picture_save(const picture *p, const char *path);

#endif
