/* SPDX-License-Identifier: MIT */
/* Where a picture is taken from. */
#ifndef CAMERA_H
#define CAMERA_H

#include <sphmesh/query.h>

typedef struct box {
    double low[3], high[3];
} box;

/* Looks along -back at a plane through `middle`, of which it sees `half` to either side and up and down. */
typedef struct camera {
    double middle[3], half[2];
    double right[3], up[3], back[3]; /* unit */
    double distance;                 /* of the eye from the middle; 0: rays are parallel */
    double depth;                    /* what is drawn lies so near to the middle */
} camera;

/* How to aim it. */
typedef struct camera_aim {
    double azimuth, elevation; /* degrees around y (0: from +z), and above the horizon */
    double focal;              /* millimetres, of a film 36 mm wide; 0: parallel */
    double zoom;               /* 1: the box just fits */
    double centre[3];          /* in the middle of the picture where has_centre */
    bool has_centre;
} camera_aim;

/* Takes in the box, whose diagonal is above 0, on a picture of that width and height. */
void camera_set(camera *c, const camera_aim *aim, const box *b, uint32_t width, uint32_t height);
/* The ray through (u, v): from -1 to 1, left to right and bottom to top. */
void camera_ray(const camera *c, double u, double v, sph_sweep *ray);

static inline double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double box_diagonal(const box *b);

#endif
