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

/* Of 64. */
SPH__INLINE uint64_t pack(const uint8_t *bytes)
{
    uint64_t mask = 0;
    for (int i = 0; i < 64; i += 16)
        mask |= (uint64_t)sph__query_pack(bytes + i, 0) << i;
    return mask;
}

/* `count` boxes, in whole vectors. */
SPH__CLONES static uint32_t meet_clones(const sph__query_bounds *bounds, size_t begin, size_t count,
                                        const sph__query_ray *ray, uint32_t *restrict met, float *restrict entry)
{
    /* a row is chosen by the way it goes, without a branch */
    const size_t stride = bounds->stride, k0 = ray->inverse[0] < 0, k1 = ray->inverse[1] < 0, k2 = ray->inverse[2] < 0;
    const float *rows = bounds->rows + begin, *const ends[2] = {ray->above, ray->below};
    const float *restrict in0 = rows + k0 * stride, *restrict out0 = rows + (k0 ^ 1) * stride;
    const float *restrict in1 = rows + (2 + k1) * stride, *restrict out1 = rows + (2 + (k1 ^ 1)) * stride;
    const float *restrict in2 = rows + (4 + k2) * stride, *restrict out2 = rows + (4 + (k2 ^ 1)) * stride;
    const float p0 = ends[k0][0], p1 = ends[k1][1], p2 = ends[k2][2];
    const float q0 = ends[k0 ^ 1][0], q1 = ends[k1 ^ 1][1], q2 = ends[k2 ^ 1][2];
    const float i0 = ray->inverse[0], i1 = ray->inverse[1], i2 = ray->inverse[2];
    float __attribute__((aligned(64))) all[SPH__QUERY_CHUNK];
    uint8_t __attribute__((aligned(64))) meets[SPH__QUERY_CHUNK];
    uint32_t found = 0;
    for (size_t i = count; i % 64 != 0; i += SPH__QUERY_LANES)
        memset(meets + i, 0, SPH__QUERY_LANES);
    for (size_t i = 0; i < count; ++i) {
        const float a0 = (in0[i] - p0) * i0, a1 = (in1[i] - p1) * i1, a2 = (in2[i] - p2) * i2;
        const float b0 = (out0[i] - q0) * i0, b1 = (out1[i] - q1) * i1, b2 = (out2[i] - q2) * i2;
        const float in = greater(greater(a0, a1), greater(a2, 0));
        const float out = lesser(lesser(b0, b1), lesser(b2, 1));
        all[i] = in;
        meets[i] = in <= out;
    }
    for (size_t i = 0; i < count; i += 64)
        for (uint64_t mask = pack(meets + i); mask != 0; mask &= mask - 1) {
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
