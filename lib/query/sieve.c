/* SPDX-License-Identifier: MIT */
#include "query/sieve.h"

#include <math.h>

#include "hierarchy/lanes.h"
#include "query/parts.h"
#include "query/transpose.h"

enum { LANES = 16 };

/* Segments side by side, in the frame of the pose. */
typedef struct __attribute__((aligned(64))) lanes {
    float ends[8][LANES]; /* as they are given */
    float above[3][LANES], below[3][LANES], inverse[3][LANES];
    int32_t is_far[LANES];
    int32_t leaves[LANES];
} lanes;

/* The frame, with 32 bits: the origin in two pieces, so that what is subtracted from a place near it is exact. */
typedef struct frame {
    float origin[3], rest[3], scale, blur;
} frame;

/* Where the scale is no ordinary number, all is far. */
static void set_frame(frame *f, const sph__query_room *room)
{
    double far = 0;
    for (int k = 0; k < 3; ++k) {
        volatile float rounded = (float)room->origin[k]; /* gcc 12 forgets to round where it does two at a time */
        f->origin[k] = rounded;
        f->rest[k] = (float)(room->origin[k] - rounded);
        far = fmax(far, fabs(room->origin[k]));
    }
    f->scale = room->scale > 1e-30 && room->scale < 1e30 ? (float)room->scale : INFINITY;
    f->blur = (float)(1e-5 + 1e-13 * far * room->scale);
}

/*
 * Widened by more than all that 32 bits lose, which is in proportion to how far the ends are. Those that are so far
 * that little would be left are let through.
 */
SPH__INLINE void aim_lane(lanes *s, const frame *f, int i)
{
    float from[3], way[3], far = 0, reach;
    for (int k = 0; k < 3; ++k) {
        const float to = ((s->ends[3 + k][i] - f->origin[k]) - f->rest[k]) * f->scale;
        from[k] = ((s->ends[k][i] - f->origin[k]) - f->rest[k]) * f->scale;
        way[k] = to - from[k];
        far = far + (fabsf(from[k]) + fabsf(to));
    }
    reach = s->ends[6][i] * f->scale;
    far = far + reach;
    reach = reach + (f->blur + 1e-5f * far);
    s->is_far[i] = far < 1e3f ? 0 : -1; /* also where it is no number */
    for (int k = 0; k < 3; ++k) {
        s->above[k][i] = from[k] + reach;
        s->below[k][i] = from[k] - reach;
        s->inverse[k][i] = 1 / (way[k] + copysignf(1e-18f, way[k]));
    }
}

SPH__INLINE void meet_box(lanes *s, const sph__box *box, int32_t bit)
{
    const float low0 = box->low[0], low1 = box->low[1], low2 = box->low[2];
    const float high0 = box->high[0], high1 = box->high[1], high2 = box->high[2];
    for (int i = 0; i < LANES; ++i) {
        const float i0 = s->inverse[0][i], i1 = s->inverse[1][i], i2 = s->inverse[2][i];
        const float a0 = (low0 - s->above[0][i]) * i0, b0 = (high0 - s->below[0][i]) * i0;
        const float a1 = (low1 - s->above[1][i]) * i1, b1 = (high1 - s->below[1][i]) * i1;
        const float a2 = (low2 - s->above[2][i]) * i2, b2 = (high2 - s->below[2][i]) * i2;
        const float in = sph__query_most(sph__query_most(sph__query_least(a0, b0), sph__query_least(a1, b1)),
                                         sph__query_most(sph__query_least(a2, b2), 0));
        const float out = sph__query_least(sph__query_least(sph__query_most(a0, b0), sph__query_most(a1, b1)),
                                           sph__query_least(sph__query_most(a2, b2), 1));
        s->leaves[i] |= in <= out ? bit : 0;
    }
}

#define ROW(i) &sweeps[i]
#define NEXT_ROW(i) &sweeps[8 + (i)]

/* Fewer than 16, and the last one again. */
static const sph_sweep *fill_up(sph_sweep rows[LANES], const sph_sweep *sweeps, uint32_t count)
{
    for (uint32_t i = 0; i < LANES; ++i)
        rows[i] = sweeps[i < count ? i : count - 1];
    return rows;
}

/* The leaves that 16 segments may meet. */
SPH__CLONES static void sieve_clones(const frame *f, const sph_sweep *sweeps, const sph__box *boxes,
                                     uint32_t leaf_count, uint32_t *restrict leaves)
{
    const uint32_t all = (uint32_t)(((uint64_t)1 << leaf_count) - 1);
    lanes s;
    SPH__QUERY_TRANSPOSE_16(ROW, NEXT_ROW, s.ends);
    for (int i = 0; i < LANES; ++i)
        aim_lane(&s, f, i);
    for (int i = 0; i < LANES; ++i)
        s.leaves[i] = s.is_far[i] & (int32_t)all;
    for (uint32_t box = 0; box < 2 * leaf_count; ++box)
        meet_box(&s, &boxes[box], (int32_t)(1u << box / 2));
    for (int i = 0; i < LANES; ++i)
        leaves[i] = (uint32_t)s.leaves[i];
}

void sph__query_sieve(sph__query_sieved *sieved, const sph__query_room *room, const sph_sweep *sweeps, uint32_t first,
                      uint32_t count, const sph__box *boxes, uint32_t leaf_count)
{
    uint32_t __attribute__((aligned(64))) leaves[LANES];
    sph_sweep last[LANES];
    uint32_t kept = 0;
    frame f;
    set_frame(&f, room);
    for (uint32_t begin = 0; begin < count; begin += LANES) {
        const uint32_t here = count - begin < LANES ? count - begin : LANES;
        const sph_sweep *rows = sweeps + first + begin;
        if (here < LANES) rows = fill_up(last, rows, here);
        sieve_clones(&f, rows, boxes, leaf_count, leaves);
        for (uint32_t i = 0; i < here; ++i) { /* what is not left is overwritten */
            sieved->which[kept] = (uint16_t)(first + begin + i);
            sieved->leaves[kept] = leaves[i];
            kept += leaves[i] != 0;
        }
    }
    sieved->count = kept;
}
