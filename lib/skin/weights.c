/* SPDX-License-Identifier: MIT */
/* Weights of one vertex in the order and the numbers in which they leave the library. */
#include <math.h>

#include "skin/skin.h"

static const double UNITS = 16777216; /* 2^24: every number of them up to 1 is a float, and so is every sum of them */

/* Equal bones become one, the largest weight first; returns how many are above 0. */
static uint32_t join_and_sort(uint32_t *bones, double *weights, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t at = 0;
        if (!(weights[i] > 0)) continue;
        while (at < kept && bones[at] != bones[i])
            ++at;
        if (at < kept) {
            weights[at] += weights[i];
            continue;
        }
        bones[kept] = bones[i];
        weights[kept++] = weights[i];
    }
    for (uint32_t i = 1; i < kept; ++i) {
        const uint32_t bone = bones[i];
        const double weight = weights[i];
        uint32_t at = i;
        for (; at > 0 && (weights[at - 1] < weight || (weights[at - 1] == weight && bones[at - 1] > bone)); --at) {
            bones[at] = bones[at - 1];
            weights[at] = weights[at - 1];
        }
        bones[at] = bone;
        weights[at] = weight;
    }
    return kept;
}

/* Weights become whole numbers of units, what is left over going to the largest fractions. */
static void round_to_units(double *weights, uint32_t count)
{
    double sum = 0, left = UNITS;
    for (uint32_t i = 0; i < count; ++i)
        sum += weights[i];
    for (uint32_t i = 0; i < count; ++i) {
        weights[i] = weights[i] / sum * UNITS;
        left -= floor(weights[i]);
    }
    for (; left >= 1; --left) {
        uint32_t best = 0;
        for (uint32_t i = 1; i < count; ++i)
            if (weights[i] - floor(weights[i]) > weights[best] - floor(weights[best])) best = i;
        weights[best] = floor(weights[best]) + 1;
    }
    if (left < 0) weights[0] += left; /* the quotients were rounded up */
    for (uint32_t i = 0; i < count; ++i)
        weights[i] = floor(weights[i]);
}

bool sph__weights_order(uint32_t *bones, double *weights, uint32_t count, uint32_t limit, uint32_t *out_bones,
                        float *out_weights)
{
    uint32_t kept = join_and_sort(bones, weights, count);
    if (kept == 0) return false;
    if (kept > limit) kept = limit;
    round_to_units(weights, kept);
    for (uint32_t i = 0; i < limit; ++i) {
        const bool used = i < kept && weights[i] > 0;
        out_bones[i] = used ? bones[i] : 0;
        out_weights[i] = used ? (float)(weights[i] / UNITS) : 0;
    }
    return true;
}
