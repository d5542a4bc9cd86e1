/* SPDX-License-Identifier: MIT */
#include "query/kernel.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "hierarchy/lanes.h"
#include "query/step.h"

/*
 * Plain loops, for the compiler to turn into vectors of whatever width: gcc 12 takes explicit ones that are wider than
 * the machine's apart, lane by lane, where they are compared. Lanes do not mix, so that the width does not show.
 */
static inline float lesser(float a, float b)
{
    return a < b ? a : b;
}

static inline float greater(float a, float b)
{
    return a > b ? a : b;
}

/* Swollen so that every span has some length; of which nothing follows. */
#define SWOLLEN 1e6f

const sph__query_ray sph__query_ray_all = {.above = {1e30f, 1e30f, 1e30f},
                                           .below = {-1e30f, -1e30f, -1e30f},
                                           .inverse = {1, 1, 1},
                                           .reach = 1e30f,
                                           .direction = {1, 0, 0},
                                           .swell = SWOLLEN};
const sph__query_ray sph__query_ray_none = {
    .above = {1e15f, 1e15f, 1e15f}, .below = {1e15f, 1e15f, 1e15f}, .inverse = {1, 1, 1}, .direction = {1, 0, 0}};

void sph__query_ray_set(sph__query_ray *ray, const double p[3], const double d[3], double reach)
{
    for (int k = 0; k < 3; ++k) {
        const float slope = (float)d[k];
        ray->above[k] = (float)(p[k] + reach);
        ray->below[k] = (float)(p[k] - reach);
        ray->inverse[k] = 1 / (slope + copysignf(1e-18f, slope));
        ray->from[k] = (float)p[k];
        ray->way[k] = slope;
    }
    ray->reach = (float)reach;
}

void sph__query_ray_aim(sph__query_ray *ray, const double d[3], double radius)
{
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), per_length = 1 / length;
    const bool is_long = length > 1e-12;
    for (int k = 0; k < 3; ++k)
        ray->direction[k] = is_long ? (float)(d[k] * per_length) : k == 0;
    ray->per_length = is_long ? (float)per_length : 0;
    ray->margin = 1e-5f * (1 + ray->reach);
    ray->swell = is_long ? (float)radius + ray->margin : SWOLLEN;
}

/* `count` boxes, in whole vectors. */
SPH__CLONES static uint32_t meet_clones(const sph__query_bounds *bounds, size_t begin, size_t count,
                                        const sph__query_ray *ray, uint32_t *restrict met, float *restrict entry)
{
    const float *restrict low0 = bounds->low[0] + begin, *restrict high0 = bounds->high[0] + begin;
    const float *restrict low1 = bounds->low[1] + begin, *restrict high1 = bounds->high[1] + begin;
    const float *restrict low2 = bounds->low[2] + begin, *restrict high2 = bounds->high[2] + begin;
    const float above0 = ray->above[0], above1 = ray->above[1], above2 = ray->above[2];
    const float below0 = ray->below[0], below1 = ray->below[1], below2 = ray->below[2];
    const float i0 = ray->inverse[0], i1 = ray->inverse[1], i2 = ray->inverse[2];
    float __attribute__((aligned(64))) all[SPH__QUERY_CHUNK];
    uint8_t __attribute__((aligned(64))) meets[SPH__QUERY_CHUNK];
    uint32_t found = 0;
    for (size_t i = count; i % 64 != 0; i += SPH__QUERY_LANES)
        memset(meets + i, 0, SPH__QUERY_LANES);
    for (size_t i = 0; i < count; ++i) {
        const float a0 = (low0[i] - above0) * i0, b0 = (high0[i] - below0) * i0;
        const float a1 = (low1[i] - above1) * i1, b1 = (high1[i] - below1) * i1;
        const float a2 = (low2[i] - above2) * i2, b2 = (high2[i] - below2) * i2;
        const float in = greater(greater(lesser(a0, b0), lesser(a1, b1)), greater(lesser(a2, b2), 0));
        const float out = lesser(lesser(greater(a0, b0), greater(a1, b1)), lesser(greater(a2, b2), 1));
        all[i] = in;
        meets[i] = in <= out;
    }
    for (size_t i = 0; i < count; i += 64)
        for (uint64_t mask = sph__query_pack(meets + i); mask != 0; mask &= mask - 1) {
            const size_t k = i + (size_t)__builtin_ctzll(mask);
            met[found] = (uint32_t)(begin + k);
            entry[found++] = all[k];
        }
    return found;
}

/* `end`, or what makes whole vectors: rows are padded, and so must be what is written. */
static size_t whole(size_t begin, size_t end)
{
    return (end - begin + SPH__QUERY_LANES - 1) / SPH__QUERY_LANES * SPH__QUERY_LANES;
}

uint32_t sph__query_kernel_meet(const sph__query_bounds *bounds, size_t begin, size_t end, const sph__query_ray *ray,
                                uint32_t *met, float *entry)
{
    uint32_t found = meet_clones(bounds, begin, whole(begin, end), ray, met, entry);
    while (found > 0 && met[found - 1] >= end) /* of another leaf */
        --found;
    return found;
}

SPH__CLONES static void distances_clones(const float *const low[3], const float *const high[3], size_t begin,
                                         size_t count, const float x[3], float *restrict bound)
{
    const float *restrict a0 = low[0] + begin, *restrict a1 = low[1] + begin, *restrict a2 = low[2] + begin;
    const float *restrict b0 = high[0] + begin, *restrict b1 = high[1] + begin, *restrict b2 = high[2] + begin;
    const float x0 = x[0], x1 = x[1], x2 = x[2];
    for (size_t i = 0; i < count; ++i) {
        const float d0 = greater(a0[i] - x0, x0 - b0[i]), d1 = greater(a1[i] - x1, x1 - b1[i]);
        const float d2 = greater(a2[i] - x2, x2 - b2[i]), most = greater(greater(d0, d1), d2);
        const float o0 = greater(d0, 0), o1 = greater(d1, 0), o2 = greater(d2, 0);
        const float root = sqrtf(o0 * o0 + o1 * o1 + o2 * o2);
        bound[i] = most > 0 ? root : most;
    }
}

void sph__query_kernel_distances(const sph__query_bounds *bounds, size_t begin, size_t end, const float x[3],
                                 float *bound)
{
    distances_clones((const float *const *)bounds->low, (const float *const *)bounds->high, begin, whole(begin, end), x,
                     bound);
}
