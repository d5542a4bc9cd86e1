/* SPDX-License-Identifier: MIT */
/*
 * Size. Quadrics go with the square of the input's size and their gradients with the cube, so at 32 bits the areas of
 * an input of size 1e-20 are zero. All is therefore computed at a size near 1, and brought back at the end. By powers
 * of two: they change no digit (but of what is below 2^-125 of the size), so a scaled input gives the same collapses.
 */
#include <math.h>

#include "hierarchy/build.h"

/* A coordinate whose bounding boxes are smaller by more than this far from the origin stays below 2^60 even so. */
enum { LARGEST_EXPONENT = 60, GRAIN = 256 };

typedef struct scaling {
    float *rows;
    size_t node_floats;
    double factor;
} scaling;

static void scale_range(void *argument, size_t begin, size_t end)
{
    const scaling *s = argument;
    for (size_t i = begin * s->node_floats; i < end * s->node_floats; ++i)
        s->rows[i] = (float)(s->rows[i] * s->factor);
}

/* Factors go beyond what 32 bits hold, so they are doubles. */
static void scale_rows(const sph__builder *b, float *rows, size_t count, size_t floats, int exponent)
{
    scaling s = {rows, floats, ldexp(1.0, exponent)};
    if (exponent != 0) sph__parallel_for(b->context, count, GRAIN, scale_range, &s);
}

int sph__size_exponent(double diagonal, double largest)
{
    int exponent = 0, highest = 0;
    if (!(diagonal > 0)) return 0;
    frexp(diagonal, &exponent);
    frexp(largest, &highest);
    return exponent < highest - LARGEST_EXPONENT ? highest - LARGEST_EXPONENT : exponent;
}

void sph__normalise_size(sph__builder *b, double diagonal, double largest)
{
    const int exponent = sph__size_exponent(diagonal, largest);
    scale_rows(b, b->h->centers, b->n, b->node_floats, b->size_exponent - exponent);
    b->size_exponent = exponent;
    b->h->bounding_diagonal = ldexp(diagonal, -exponent);
}

void sph__restore_size(sph__builder *b)
{
    sph_hierarchy *h = b->h;
    const size_t nodes = sph__node_count(h);
    const int exponent = b->size_exponent;
    h->bounding_diagonal = ldexp(h->bounding_diagonal, exponent);
    scale_rows(b, h->centers, nodes, b->node_floats, exponent);
    scale_rows(b, h->radii, nodes, h->radii_per_frame ? b->stride : 1, exponent);
    for (uint32_t t = 0; t < h->collapse_count; ++t) {
        h->errors[t] = ldexp(h->errors[t], exponent);
        h->costs[t] = ldexp(h->costs[t], 4 * exponent + b->weight_exponent); /* area times squared distance */
    }
}
