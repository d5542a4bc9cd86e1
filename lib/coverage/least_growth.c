/* SPDX-License-Identifier: MIT */
/*
 * min sum (r' - r)^2 with linear covers, by ascent on the multipliers of the dual problem, one at a time (C. Hildreth,
 * A quadratic programming procedure, 1957). As weights and multipliers are never negative, no radius falls below r.
 */
#include <math.h>

#include "coverage/coverage.h"

/* The radii of the cover; returns what it lacks. */
static double lack_of(const sph__cover *c, double *radii, size_t stride, double *found[3])
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        found[k] = &radii[c->frame * stride + c->spheres[k]];
        sum += c->weights[k] * *found[k];
    }
    return c->reach - sum;
}

void sph__least_growth(sph__cover *covers, size_t count, double *radii, size_t stride, uint32_t sweeps,
                       double tolerance)
{
    for (uint32_t sweep = 0; sweep < sweeps; ++sweep) {
        double largest = 0;
        for (size_t i = 0; i < count; ++i) {
            sph__cover *c = &covers[i];
            double *r[3], step = lack_of(c, radii, stride, r), squared = 0;
            for (int k = 0; k < 3; ++k)
                squared += c->weights[k] * c->weights[k];
            step = fmax(-c->multiplier, step / squared);
            if (step == 0) continue;
            c->multiplier += step;
            for (int k = 0; k < 3; ++k)
                *r[k] += step * c->weights[k];
            largest = fmax(largest, fabs(step));
        }
        if (largest <= tolerance) break;
    }
}
