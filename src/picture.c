/* SPDX-License-Identifier: MIT */
#include "picture.h"

#include <errno.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

enum { SUPER = 2 }; /* rays along the side of a pixel */

void picture_turn(picture_view *view, double azimuth, double elevation)
{
    const double a = azimuth * M_PI / 180, e = elevation * M_PI / 180;
    const double right[3] = {cos(a), 0, -sin(a)}, up[3] = {-sin(a) * sin(e), cos(e), -cos(a) * sin(e)};
    const double back[3] = {sin(a) * cos(e), sin(e), cos(a) * cos(e)};
    memcpy(view->right, right, sizeof right);
    memcpy(view->up, up, sizeof up);
    memcpy(view->back, back, sizeof back);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The ray through (u, v), both from -1 to 1. */
static void set_ray(const picture_view *view, double u, double v, sph_sweep *ray)
{
    for (int k = 0; k < 3; ++k) {
        const double x = view->middle[k] + view->reach * (u * view->right[k] + v * view->up[k]);
        ray->from[k] = (float)(x + 1.1 * view->reach * view->back[k]);
        ray->to[k] = (float)(x - 1.1 * view->reach * view->back[k]);
    }
    ray->radius = 0;
}

/* Adds the colour of what a ray has hit: by how many spheres hold the place, lit from the upper left and from the eye.
 */
static void shade(const picture_view *view, const sph_hit *hit, double sum[3])
{
    static const double COLOURS[3][3] = {{0.80, 0.12, 0.10}, {0.95, 0.78, 0.15}, {0.25, 0.45, 0.85}};
    const double *n = hit->contact.normal;
    double light, gloss;
    int holders = 0;
    if (!hit->hit) {
        for (int k = 0; k < 3; ++k)
            sum[k] += 1;
        return;
    }
    for (int k = 0; k < 3; ++k)
        holders += hit->contact.weights[k] > 1e-6;
    light = fmax(0, (-0.5 * dot(n, view->right) + 0.7 * dot(n, view->up) + 0.5 * dot(n, view->back)));
    gloss = 0.25 * pow(fmax(0, -0.28 * dot(n, view->right) + 0.4 * dot(n, view->up) + 0.87 * dot(n, view->back)), 40);
    light = 0.25 + 0.3 * fmax(0, dot(n, view->back)) + 0.5 * light;
    for (int k = 0; k < 3; ++k)
        sum[k] += fmin(1, light * COLOURS[holders > 0 ? holders - 1 : 0][k] + gloss);
}

static void store_row(picture *p, const picture_view *view, const sph_hit *hits, uint32_t left, uint32_t y,
                      uint32_t size)
{
    for (uint32_t x = 0; x < size; ++x) {
        unsigned char *pixel = p->rgb + 3 * ((size_t)y * p->width + left + x);
        double sum[3] = {0, 0, 0};
        for (size_t i = 0; i < SUPER * SUPER; ++i)
            shade(view, &hits[(size_t)x * SUPER * SUPER + i], sum);
        for (int k = 0; k < 3; ++k)
            pixel[k] = (unsigned char)lround(255 * pow(sum[k] / (SUPER * SUPER), 1 / 1.5));
    }
}

sph_status picture_draw(picture *p, sph_context *context, const sph_query *query, const picture_view *view,
                        uint32_t left, uint32_t top, uint32_t size)
{
    const size_t count = (size_t)size * SUPER * SUPER;
    sph_sweep *rays = sph_context_allocate(context, count, sizeof *rays);
    sph_hit *hits = sph_context_allocate(context, count, sizeof *hits);
    sph_status status = SPH_OK;
    if (rays == NULL || hits == NULL) status = sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    for (uint32_t y = 0; y < size && status == SPH_OK; ++y) {
        for (size_t i = 0; i < count; ++i) {
            const double u = (double)(i / (SUPER * SUPER)) + ((double)(i % SUPER) + 0.5) / SUPER;
            const double v = (double)y + ((double)(i / SUPER % SUPER) + 0.5) / SUPER;
            memset(&rays[i], 0, sizeof *rays);
            set_ray(view, 2 * u / size - 1, 1 - 2 * v / size, &rays[i]);
        }
        status = sph_query_cast(query, rays, count, hits);
        if (status == SPH_OK) store_row(p, view, hits, left, top + y, size);
    }
    sph_context_release(context, rays);
    sph_context_release(context, hits);
    return status;
}

int picture_save(const picture *p, const char *path)
{
    png_image image = {.version = PNG_IMAGE_VERSION, .width = p->width, .height = p->height, .format = PNG_FORMAT_RGB};
    const size_t length = strlen(path) + 40;
    char *temporary = malloc(length);
    int result = DONE;
    if (temporary == NULL) return failure("out of memory");
    snprintf(temporary, length, "%s.%ld.tmp", path, (long)getpid());
    if (!png_image_write_to_file(&image, temporary, 0, p->rgb, 0, NULL))
        result = failure("%s: cannot be written: %s", path, image.message);
    else if (rename(temporary, path) != 0)
        result = failure("%s: cannot be put in place: %s", path, strerror(errno));
    if (result != DONE) remove(temporary);
    free(temporary);
    return result;
}
