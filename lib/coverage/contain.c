/* SPDX-License-Identifier: MIT */
/* Containment that rounding cannot feign. */
#include <float.h>

#include "coverage/coverage.h"
#include "numeric/vector.h"

/* Weights >= 0 of sum 1, up to the last bit. */
static void tidy(const double found[3], int32_t count, double weights[3])
{
    double sum = 0;
    for (int32_t k = 1; k < 3; ++k) {
        weights[k] = k < count && found[k] > 0 ? found[k] : 0;
        sum += weights[k];
    }
    for (int32_t k = 1; k < 3 && sum > 1; ++k)
        weights[k] /= sum;
    weights[0] = fmax(0, 1 - weights[1] - weights[2]);
}

/* The same for the sphere of one corner: without any rounding where the place is that of a point. */
static double corner_excess(const sph__primitive *p, int32_t corner, const double x[3], double *distance)
{
    double d[3], rounding;
    sph__subtract(p->center[corner], x, d);
    rounding = 16 * DBL_EPSILON * (fabs(d[0]) + fabs(d[1]) + fabs(d[2]) + p->radius[corner]);
    *distance = sph__norm(d) + rounding;
    return *distance - p->radius[corner];
}

static double inner_excess(const sph__primitive *p, const double x[3], const double weights[3], double *distance)
{
    double offset[3] = {0, 0, 0}, radius = 0, size = 0;
    for (int32_t i = 0; i < p->corner_count; ++i) {
        double d[3], extent;
        if (weights[i] == 0) continue;
        sph__subtract(p->center[i], x, d);
        extent = fabs(d[0]) + fabs(d[1]) + fabs(d[2]) + p->radius[i];
        if (extent > size) size = extent;
        for (int k = 0; k < 3; ++k)
            offset[k] += weights[i] * d[k];
        radius += weights[i] * p->radius[i];
    }
    /* some twenty operations, each wrong by half an epsilon of `size` at most */
    *distance = sph__norm(offset) + 16 * DBL_EPSILON * size;
    return *distance - radius;
}

double sph__coverage_excess(const sph__primitive *p, const double x[3], double weights[3], double *distance)
{
    sph__contact contact;
    double excess, reach;
    sph__primitive_closest(p, x, &contact);
    tidy(contact.weights, p->corner_count, weights);
    excess = inner_excess(p, x, weights, &reach);
    for (int32_t i = 0; i < p->corner_count; ++i) {
        double other, corner;
        if (weights[i] < 0.5) continue;
        corner = corner_excess(p, i, x, &other);
        if (corner >= excess) continue;
        excess = corner;
        reach = other;
        for (int32_t k = 0; k < 3; ++k)
            weights[k] = k == i;
    }
    if (distance != NULL) *distance = reach;
    return excess;
}
