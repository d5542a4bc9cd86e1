/* SPDX-License-Identifier: MIT */
/* Boxes against a segment each, and parts of one primitive against many; these with the operations of touch.c. */
#include "query/wave.h"

#include <math.h>

#include "hierarchy/lanes.h"
#include "query/step.h"
#include "query/transpose.h"

enum { SIDE = SPH__QUERY_SIDE };

/* --- boxes --- */

/* The boxes that the segment in a lane meets, in whole vectors. A row is chosen by the way it goes, without a branch.
 */
SPH__INLINE uint64_t meet(const sph__query_bounds *bounds, size_t begin, size_t count, const sph__query_aim *aim,
                          int lane)
{
    const size_t stride = bounds->stride;
    const float *rows = bounds->rows + begin;
    const size_t k0 = aim->inverse[0][lane] < 0, k1 = aim->inverse[1][lane] < 0, k2 = aim->inverse[2][lane] < 0;
    const float *restrict in0 = rows + k0 * stride, *restrict out0 = rows + (k0 ^ 1) * stride;
    const float *restrict in1 = rows + (2 + k1) * stride, *restrict out1 = rows + (2 + (k1 ^ 1)) * stride;
    const float *restrict in2 = rows + (4 + k2) * stride, *restrict out2 = rows + (4 + (k2 ^ 1)) * stride;
    const float p0 = aim->before[0][lane], p1 = aim->before[1][lane], p2 = aim->before[2][lane];
    const float q0 = aim->after[0][lane], q1 = aim->after[1][lane], q2 = aim->after[2][lane];
    const float i0 = aim->inverse[0][lane], i1 = aim->inverse[1][lane], i2 = aim->inverse[2][lane];
    uint8_t __attribute__((aligned(64))) meets[SPH__QUERY_SLOTS];
    for (size_t v = 0; v < SPH__QUERY_SLOTS / SPH__QUERY_LANES; ++v) {
        int32_t __attribute__((aligned(64))) words[SPH__QUERY_LANES];
        if (v * SPH__QUERY_LANES >= count) break;
        for (size_t l = 0; l < SPH__QUERY_LANES; ++l) {
            const size_t i = v * SPH__QUERY_LANES + l;
            const float a0 = (in0[i] - p0) * i0, a1 = (in1[i] - p1) * i1, a2 = (in2[i] - p2) * i2;
            const float b0 = (out0[i] - q0) * i0, b1 = (out1[i] - q1) * i1, b2 = (out2[i] - q2) * i2;
            const float in = sph__query_most(sph__query_most(a0, a1), sph__query_most(a2, 0));
            const float out = sph__query_least(sph__query_least(b0, b1), sph__query_least(b2, 1));
            words[l] = in <= out;
        }
        for (size_t l = 0; l < SPH__QUERY_LANES; ++l)
            meets[v * SPH__QUERY_LANES + l] = (uint8_t)words[l];
    }
    return sph__query_pack(meets);
}

SPH__CLONES static void wave_meet_clones(const sph__query_bounds *bounds, size_t begin, uint32_t count,
                                         const sph__query_aim *aim, uint64_t *masks)
{
    const uint64_t all = count < 64 ? ((uint64_t)1 << count) - 1 : ~(uint64_t)0;
    for (int i = 0; i < SPH__QUERY_AIM; ++i)
        masks[i] = aim->span[i] < 0 ? 0 : meet(bounds, begin, count, aim, i) & all;
}

void sph__query_wave_meet(const sph__query_bounds *bounds, size_t begin, uint32_t count, const sph__query_aim *aim,
                          uint64_t masks[SPH__QUERY_AIM])
{
    wave_meet_clones(bounds, begin, count, aim, masks);
}

/* --- parts --- */

typedef sph__query_side lines;
_Static_assert(sizeof(sph__query_line) == sizeof(sph__query_v8f), "a line is a row");

SPH__CLONES static void gather_clones(lines *side, const sph__query_line *all)
{
#define LINE(i) &all[side->which[at + (i)]]
    for (int at = 0; at < SIDE; at += 8)
        SPH__QUERY_TRANSPOSE(LINE, side->from[0] + at, side->from[1] + at, side->from[2] + at, side->direction[0] + at,
                             side->direction[1] + at, side->direction[2] + at, side->per_length + at, side->reach + at);
}

void sph__query_wave_gather(sph__query_side *side, const sph__query_line *all)
{
    gather_clones(side, all);
}

#define DIRECTION s->direction[0][i], s->direction[1][i], s->direction[2][i]

SPH__INLINE sph__query_foot foot_of(const sph__query_parts *p, int k, const lines *s, int i, float margin)
{
    return sph__query_foot_of(p->center[0][k], p->center[1][k], p->center[2][k], p->radius[k] + (s->reach[i] + margin),
                              margin, s->from[0][i], s->from[1][i], s->from[2][i], DIRECTION);
}

SPH__INLINE sph__query_span cone_of(const sph__query_parts *p, int k, const sph__query_foot *f, const lines *s, int i,
                                    float margin)
{
    return sph__query_span_cone(f, p->axis[0][k], p->axis[1][k], p->axis[2][k], p->sine[k], p->cosine[k], p->length[k],
                                DIRECTION, margin);
}

SPH__INLINE sph__query_span cut_by_side(const sph__query_parts *p, int k, sph__query_span span,
                                        const sph__query_foot *f, const lines *s, int i, float margin)
{
    return sph__query_span_cut(span, f, p->side[0][k], p->side[1][k], p->side[2][k],
                               p->beyond[k] + p->growth[k] * (s->reach[i] + margin) + margin, DIRECTION);
}

SPH__INLINE sph__query_span cut_by_face(const sph__query_parts *p, int k, sph__query_span span,
                                        const sph__query_foot *f, const lines *s, int i)
{
    return sph__query_span_cut(span, f, p->face[k][0], p->face[k][1], p->face[k][2], f->radius + p->room, DIRECTION);
}

/* As sph__query_fan_bound. */
SPH__INLINE float bound_of(const sph__query_fan *f, const lines *s, int i)
{
    float d = -SPH__QUERY_NEVER;
    for (int k = 0; k < SPH__QUERY_FAN; ++k) {
        const float place =
            f->normal[0][k] * s->from[0][i] + f->normal[1][k] * s->from[1][i] + f->normal[2][k] * s->from[2][i];
        d = sph__query_most(d, sph__query_most(f->low[k] - place, place - f->high[k]));
    }
    return d;
}

static const sph__query_entry NO_ENTRY = {SPH__QUERY_NEVER, SPH__QUERY_NEVER, -SPH__QUERY_NEVER};

SPH__INLINE float finish(const sph__query_fan *f, const lines *s, int i, float margin, sph__query_entry entry)
{
    return sph__query_key(entry, s->per_length[i], bound_of(f, s, i) - (s->reach[i] + margin), s->reach[i]);
}

SPH__INLINE void touch_spheres(const sph__query_parts *p, const sph__query_fan *fan, const lines *s, int count,
                               float *restrict keys)
{
    for (int i = 0; i < count; ++i) {
        const float margin = sph__query_margin(s->reach[i]);
        const sph__query_foot f = foot_of(p, 0, s, i, margin);
        keys[i] = finish(fan, s, i, margin, sph__query_entry_part(NO_ENTRY, sph__query_span_sphere(&f, margin), 0));
    }
}

/* A corner, the edge that begins there, the side along it, and the faces. */
#define CORNER(k)                                                                                                      \
    const sph__query_foot f##k = foot_of(p, k, s, i, margin);                                                          \
    entry = sph__query_entry_part(entry, sph__query_span_sphere(&f##k, margin), p->shared_corner[k])
#define EDGE(k) entry = sph__query_entry_part(entry, cone_of(p, k, &f##k, s, i, margin), p->shared_edge[k])
#define SIDE_OF(k) prism = cut_by_side(p, k, prism, &f##k, s, i, margin)

SPH__INLINE void touch_capsules(const sph__query_parts *p, const sph__query_fan *fan, const lines *s, int count,
                                float *restrict keys)
{
    for (int i = 0; i < count; ++i) {
        const float margin = sph__query_margin(s->reach[i]);
        sph__query_entry entry = NO_ENTRY;
        CORNER(0);
        EDGE(0);
        CORNER(1);
        keys[i] = finish(fan, s, i, margin, entry);
    }
}

SPH__INLINE void touch_triangles(const sph__query_parts *p, const sph__query_fan *fan, const lines *s, int count,
                                 float *restrict keys)
{
    for (int i = 0; i < count; ++i) {
        const float margin = sph__query_margin(s->reach[i]);
        sph__query_span prism = sph__query_span_all;
        sph__query_entry entry = NO_ENTRY;
        CORNER(0);
        EDGE(0);
        SIDE_OF(0);
        prism = cut_by_face(p, 0, prism, &f0, s, i);
        prism = cut_by_face(p, 1, prism, &f0, s, i);
        CORNER(1);
        EDGE(1);
        SIDE_OF(1);
        CORNER(2);
        EDGE(2);
        SIDE_OF(2);
        entry = sph__query_entry_part(entry, sph__query_span_whole(prism), 0);
        keys[i] = finish(fan, s, i, margin, entry);
    }
}

SPH__CLONES static void side_clones(const sph__query_parts *parts, const sph__query_fan *fan, const lines *side,
                                    float *restrict keys)
{
    if (parts->corner_count == 3 && side->count > SIDE / 2)
        touch_triangles(parts, fan, side, SIDE, keys);
    else if (parts->corner_count == 3)
        touch_triangles(parts, fan, side, SIDE / 2, keys);
    else if (parts->corner_count == 2)
        touch_capsules(parts, fan, side, SIDE, keys);
    else
        touch_spheres(parts, fan, side, SIDE, keys);
}

void sph__query_wave_touch(const sph__query_parts *parts, const sph__query_fan *fan, const sph__query_side *side,
                           float keys[SPH__QUERY_SIDE])
{
    side_clones(parts, fan, side, keys);
}
