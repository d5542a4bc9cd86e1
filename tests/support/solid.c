/* SPDX-License-Identifier: MIT */
#include "solid.h"

#include <float.h>
#include <math.h>

sph_level *test_solid_level(sph_context *context, const test_solid *s)
{
    sph_level *level = NULL;
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = s->sphere_count,
                                     .frame_count = 1,
                                     .centers = s->centers[0],
                                     .radii = s->radii,
                                     .edge_count = s->edge_count,
                                     .edges = s->edges[0],
                                     .triangle_count = s->triangle_count,
                                     .triangles = s->triangles[0]};
    sph_level_create_from_arrays(context, &arrays, &level);
    return level;
}

double test_solid_size(const test_solid *s)
{
    double size = 0;
    for (int k = 0; k < 3; ++k) {
        double low = DBL_MAX, high = -DBL_MAX;
        for (uint32_t i = 0; i < s->sphere_count; ++i) {
            low = fmin(low, (double)s->centers[i][k] - s->radii[i]);
            high = fmax(high, (double)s->centers[i][k] + s->radii[i]);
        }
        size = fmax(size, high - low);
    }
    return size > 0 ? size : 1;
}

/* |x - c| - r at weights 1 - u - v, u, v. */
static double at(const test_solid *s, const uint32_t *n, int count, const double x[3], double u, double v)
{
    const double b[3] = {1 - u - v, u, v};
    double c[3] = {0, 0, 0}, r = 0, most = 0, sum = 0;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k)
            c[k] += b[i] * (s->centers[n[i]][k] - x[k]);
        r += b[i] * s->radii[n[i]];
    }
    for (int k = 0; k < 3; ++k)
        most = fmax(most, fabs(c[k]));
    if (most == 0) return -r;
    for (int k = 0; k < 3; ++k)
        sum += (c[k] / most) * (c[k] / most);
    return most * sqrt(sum) - r;
}

static const double GOLDEN = 0.6180339887498949;

static double least_over_v(const test_solid *s, const uint32_t *n, int count, const double x[3], double u)
{
    double a = 0, b = 1 - u, p, q, fp, fq, best;
    if (count < 3) return at(s, n, count, x, u, 0);
    best = fmin(at(s, n, count, x, u, a), at(s, n, count, x, u, b));
    p = b - GOLDEN * (b - a), q = a + GOLDEN * (b - a);
    fp = at(s, n, count, x, u, p), fq = at(s, n, count, x, u, q);
    for (int i = 0; i < 36; ++i) {
        if (fp < fq) {
            b = q, q = p, fq = fp;
            p = b - GOLDEN * (b - a);
            fp = at(s, n, count, x, u, p);
        } else {
            a = p, p = q, fp = fq;
            q = a + GOLDEN * (b - a);
            fq = at(s, n, count, x, u, q);
        }
    }
    return fmin(best, fmin(fp, fq));
}

double test_simplex_distance(const test_solid *s, const uint32_t *n, int count, const double x[3])
{
    double a = 0, b = 1, p, q, fp, fq, best;
    if (count == 1) return at(s, n, 1, x, 0, 0);
    best = fmin(least_over_v(s, n, count, x, a), least_over_v(s, n, count, x, b));
    p = b - GOLDEN, q = GOLDEN;
    fp = least_over_v(s, n, count, x, p), fq = least_over_v(s, n, count, x, q);
    for (int i = 0; i < 36; ++i) {
        if (fp < fq) {
            b = q, q = p, fq = fp;
            p = b - GOLDEN * (b - a);
            fp = least_over_v(s, n, count, x, p);
        } else {
            a = p, p = q, fp = fq;
            q = a + GOLDEN * (b - a);
            fq = least_over_v(s, n, count, x, q);
        }
    }
    return fmin(best, fmin(fp, fq));
}

double test_solid_distance(const test_solid *s, const double x[3])
{
    double least = DBL_MAX;
    for (uint32_t i = 0; i < s->sphere_count; ++i)
        least = fmin(least, test_simplex_distance(s, &i, 1, x));
    for (uint32_t i = 0; i < s->edge_count; ++i)
        least = fmin(least, test_simplex_distance(s, s->edges[i], 2, x));
    for (uint32_t i = 0; i < s->triangle_count; ++i)
        least = fmin(least, test_simplex_distance(s, s->triangles[i], 3, x));
    return least;
}

static double along(const test_solid *s, const uint32_t *n, int count, const double from[3], const double to[3],
                    double t)
{
    double x[3];
    for (int k = 0; k < 3; ++k)
        x[k] = from[k] + t * (to[k] - from[k]);
    return test_simplex_distance(s, n, count, x);
}

/* Of one simplex, whose distance is convex along the way: down to the least place, then the root before it. */
static double first_root(const test_solid *s, const uint32_t *n, int count, const double from[3], const double to[3],
                         double radius)
{
    double a = 0, b = 1, inside = 2;
    if (along(s, n, count, from, to, 0) <= radius) return 0;
    if (along(s, n, count, from, to, 1) <= radius) inside = 1;
    for (int i = 0; i < 50 && inside > 1; ++i) {
        const double p = a + (b - a) / 3, q = b - (b - a) / 3;
        const double fp = along(s, n, count, from, to, p), fq = along(s, n, count, from, to, q);
        if (fp <= radius) inside = p;
        if (fp < fq)
            b = q;
        else
            a = p;
    }
    if (inside > 1 && along(s, n, count, from, to, b) <= radius) inside = b;
    if (inside > 1) return 2;
    a = 0;
    for (int i = 0; i < 45; ++i) {
        const double half = 0.5 * (a + inside);
        if (along(s, n, count, from, to, half) <= radius)
            inside = half;
        else
            a = half;
    }
    return inside;
}

double test_solid_cast(const test_solid *s, const double from[3], const double to[3], double radius)
{
    double first = 2;
    for (uint32_t i = 0; i < s->sphere_count; ++i)
        first = fmin(first, first_root(s, &i, 1, from, to, radius));
    for (uint32_t i = 0; i < s->edge_count; ++i)
        first = fmin(first, first_root(s, s->edges[i], 2, from, to, radius));
    for (uint32_t i = 0; i < s->triangle_count; ++i)
        first = fmin(first, first_root(s, s->triangles[i], 3, from, to, radius));
    return first;
}
