/* SPDX-License-Identifier: MIT */
#include "query/kernel.h"

#include <math.h>

#include "hierarchy/lanes.h"

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

void sph__query_ray_set(sph__query_ray *ray, const double p[3], const double d[3], double reach)
{
    for (int k = 0; k < 3; ++k) {
        const float slope = (float)d[k];
        const double widen = copysign(reach, d[k]);
        ray->inverse[k] = 1 / (slope + copysignf(1e-18f, slope));
        ray->enter[k] = (float)(p[k] + widen);
        ray->leave[k] = (float)(p[k] - widen);
        ray->from[k] = (float)p[k];
        ray->way[k] = slope;
    }
    ray->reach = (float)reach;
}

SPH__CLONES static void entries_clones(const float *const near[3], const float *const far[3], size_t begin,
                                       size_t count, const sph__query_ray *ray, float *restrict entry,
                                       uint8_t *restrict meets)
{
    const float *restrict n0 = near[0] + begin, *restrict n1 = near[1] + begin, *restrict n2 = near[2] + begin;
    const float *restrict f0 = far[0] + begin, *restrict f1 = far[1] + begin, *restrict f2 = far[2] + begin;
    const float e0 = ray->enter[0], e1 = ray->enter[1], e2 = ray->enter[2];
    const float l0 = ray->leave[0], l1 = ray->leave[1], l2 = ray->leave[2];
    const float i0 = ray->inverse[0], i1 = ray->inverse[1], i2 = ray->inverse[2];
    for (size_t i = 0; i < count; ++i) {
        const float in = greater(greater((n0[i] - e0) * i0, (n1[i] - e1) * i1), greater((n2[i] - e2) * i2, 0));
        const float out = lesser(lesser((f0[i] - l0) * i0, (f1[i] - l1) * i1), lesser((f2[i] - l2) * i2, 1));
        entry[i] = in <= out ? in : SPH__QUERY_MISS;
    }
    for (size_t i = 0; i < count; ++i)
        meets[i] = entry[i] < SPH__QUERY_MISS;
}

/* `end`, or what makes whole vectors: rows are padded, and so must be what is written. */
static size_t whole(size_t begin, size_t end)
{
    return (end - begin + SPH__QUERY_LANES - 1) / SPH__QUERY_LANES * SPH__QUERY_LANES;
}

void sph__query_kernel_entries(const sph__query_bounds *bounds, size_t begin, size_t end, const sph__query_ray *ray,
                               float *entry, uint8_t *meets)
{
    const float *near[3], *far[3];
    for (int k = 0; k < 3; ++k) { /* without branches: the signs are as good as random */
        const float *const rows[2] = {bounds->low[k], bounds->high[k]};
        const int down = ray->inverse[k] < 0;
        near[k] = rows[down];
        far[k] = rows[!down];
    }
    entries_clones(near, far, begin, whole(begin, end), ray, entry, meets);
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
