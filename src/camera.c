/* SPDX-License-Identifier: MIT */
#include "camera.h"

#include <math.h>
#include <string.h>

static const double MARGIN = 1.08; /* limbs of single frames reach beyond the mean box */

static void turn(camera *c, double azimuth, double elevation)
{
    const double a = azimuth * M_PI / 180, e = elevation * M_PI / 180;
    const double right[3] = {cos(a), 0, -sin(a)}, up[3] = {-sin(a) * sin(e), cos(e), -cos(a) * sin(e)};
    const double back[3] = {sin(a) * cos(e), sin(e), cos(a) * cos(e)};
    memcpy(c->right, right, sizeof right);
    memcpy(c->up, up, sizeof up);
    memcpy(c->back, back, sizeof back);
}

double box_diagonal(const box *b)
{
    double sum = 0;
    for (int k = 0; k < 3; ++k)
        sum += (b->high[k] - b->low[k]) * (b->high[k] - b->low[k]);
    return sqrt(sum);
}

/* How far the corners of the box are seen from the middle, to the side and upwards. */
static void find_extent(const camera *c, const box *b, double extent[2])
{
    extent[0] = extent[1] = 0;
    for (int i = 0; i < 8; ++i) {
        double x[3], scale;
        for (int k = 0; k < 3; ++k)
            x[k] = (i >> k & 1 ? b->high[k] : b->low[k]) - (b->low[k] + b->high[k]) / 2;
        scale = c->distance > 0 ? c->distance / (c->distance - dot(x, c->back)) : 1;
        extent[0] = fmax(extent[0], fabs(dot(x, c->right)) * scale);
        extent[1] = fmax(extent[1], fabs(dot(x, c->up)) * scale);
    }
}

void camera_set(camera *c, const camera_aim *aim, const box *b, uint32_t width, uint32_t height)
{
    const double diagonal = box_diagonal(b), aspect = (double)width / height;
    double extent[2];
    turn(c, aim->azimuth, aim->elevation);
    /* never so near that the box reaches the eye */
    c->distance = aim->focal > 0 ? diagonal / 2 * fmax(1.5, aim->focal / 18) : 0;
    find_extent(c, b, extent);
    c->half[0] = MARGIN * fmax(extent[0], extent[1] * aspect) / aim->zoom;
    c->half[1] = c->half[0] / aspect;
    c->depth = 4 * diagonal;
    for (int k = 0; k < 3; ++k)
        c->middle[k] = aim->has_centre ? aim->centre[k] : (b->low[k] + b->high[k]) / 2;
}

void camera_ray(const camera *c, double u, double v, sph_sweep *ray)
{
    double way[3], length = 0;
    memset(ray, 0, sizeof *ray);
    for (int k = 0; k < 3; ++k) {
        way[k] = u * c->half[0] * c->right[k] + v * c->half[1] * c->up[k] - c->distance * c->back[k];
        length += way[k] * way[k];
    }
    length = sqrt(length);
    for (int k = 0; k < 3; ++k) {
        const double eye = c->middle[k] + c->distance * c->back[k];
        if (c->distance > 0) {
            ray->from[k] = (float)eye;
            ray->to[k] = (float)(eye + (c->distance + c->depth) / length * way[k]);
        } else {
            ray->from[k] = (float)(eye + way[k] + c->depth * c->back[k]);
            ray->to[k] = (float)(eye + way[k] - c->depth * c->back[k]);
        }
    }
}
