/* SPDX-License-Identifier: MIT */
/* Boxes against a segment each, and parts of one primitive against many; these with the operations of touch.c. */
#include "query/wave.h"

#include <math.h>

#include "hierarchy/lanes.h"
#include "query/depth.h"
#include "query/step.h"
#include "query/transpose.h"

enum { SIDE = SPH__QUERY_SIDE, LANES = SPH__QUERY_LANES };

/* --- boxes --- */

/* Those of a leaf that the segment in a lane meets, and those of them in which it begins, as bits: by boxes and slabs.
 */
SPH__INLINE void meet(const sph__query_leaf *leaf, const sph__query_aim *aim, uint32_t lane, uint32_t *met,
                      uint32_t *begun)
{
    const float *rows = leaf->rows[0];
    const float *restrict low0 = rows, *restrict high0 = rows + LANES, *restrict low1 = rows + 2 * LANES;
    const float *restrict high1 = rows + 3 * LANES, *restrict low2 = rows + 4 * LANES;
    const float *restrict high2 = rows + 5 * LANES, *restrict n0 = rows + 6 * LANES, *restrict n1 = rows + 7 * LANES;
    const float *restrict n2 = rows + 8 * LANES, *restrict low3 = rows + 9 * LANES, *restrict high3 = rows + 10 * LANES;
    const float p0 = aim->above[0][lane], p1 = aim->above[1][lane], p2 = aim->above[2][lane];
    const float q0 = aim->below[0][lane], q1 = aim->below[1][lane], q2 = aim->below[2][lane];
    const float i0 = aim->inverse[0][lane], i1 = aim->inverse[1][lane], i2 = aim->inverse[2][lane];
    const float x0 = aim->place[0][lane], x1 = aim->place[1][lane], x2 = aim->place[2][lane];
    const float s0 = aim->slope[0][lane], s1 = aim->slope[1][lane], s2 = aim->slope[2][lane];
    const float reach = aim->reach[lane];
    int32_t __attribute__((aligned(64))) words[LANES];
    uint8_t __attribute__((aligned(16))) bytes[LANES];
    for (int i = 0; i < LANES; ++i) {
        const float a0 = (low0[i] - p0) * i0, a1 = (low1[i] - p1) * i1, a2 = (low2[i] - p2) * i2;
        const float b0 = (high0[i] - q0) * i0, b1 = (high1[i] - q1) * i1, b2 = (high2[i] - q2) * i2;
        const float place = n0[i] * x0 + n1[i] * x1 + n2[i] * x2, rate = n0[i] * s0 + n1[i] * s1 + n2[i] * s2;
        const float under = sph__query_under(low3[i], place, reach), over = sph__query_over(high3[i], place, reach);
        const float i3 = 1 / (rate + (rate < 0 ? -1e-18f : 1e-18f)), a3 = under * i3, b3 = over * i3;
        const float in = sph__query_most(sph__query_most(sph__query_least(a0, b0), sph__query_least(a1, b1)),
                                         sph__query_least(a2, b2));
        const float out = sph__query_least(sph__query_least(sph__query_most(a0, b0), sph__query_most(a1, b1)),
                                           sph__query_least(sph__query_most(a2, b2), 1));
        const int met_all = sph__query_most(sph__query_most(in, 0), sph__query_least(a3, b3)) <=
                            sph__query_least(out, sph__query_most(a3, b3));
        const int begun_in = (in <= 0) & (under <= 0) & (over >= 0);
        words[i] = (met_all ? 1 : 0) | (begun_in ? 2 : 0);
    }
    for (int i = 0; i < LANES; ++i)
        bytes[i] = (uint8_t)words[i];
    *met = sph__query_pack(bytes, 0);
    *begun = sph__query_pack(bytes, 1);
}

SPH__CLONES static void wave_meet_clones(const sph__query_leaf *those, const sph__query_aim *aim, uint64_t leaves,
                                         uint64_t *restrict met, uint64_t *restrict begun)
{
    for (int i = 0; i < SPH__QUERY_AIM; ++i)
        met[i] = begun[i] = 0;
    for (; leaves != 0; leaves &= leaves - 1) {
        const uint32_t bit = (uint32_t)__builtin_ctzll(leaves), lane = bit / SPH__QUERY_LEAVES;
        const uint32_t number = bit % SPH__QUERY_LEAVES;
        const sph__query_leaf *leaf = &those[number];
        uint32_t found, within;
        meet(leaf, aim, lane, &found, &within);
        met[lane] |= (uint64_t)(found & leaf->all) << (LANES * number);
        begun[lane] |= (uint64_t)(found & within & leaf->all) << (LANES * number);
    }
    for (int i = 0; i < SPH__QUERY_AIM; ++i) {
        const uint64_t passes = 0 - (uint64_t)(aim->span[i] >= 0);
        met[i] &= passes;
        begun[i] &= passes;
    }
}

void sph__query_wave_meet(const sph__query_leaf *those, const sph__query_aim *aim, uint64_t leaves,
                          uint64_t met[SPH__QUERY_AIM], uint64_t begun[SPH__QUERY_AIM])
{
    wave_meet_clones(those, aim, leaves, met, begun);
}

/* --- parts --- */

/* Side by side. */
typedef struct __attribute__((aligned(64))) lines {
    float from[3][SIDE], direction[3][SIDE], per_length[SIDE], reach[SIDE];
} lines;

_Static_assert(sizeof(sph__query_line) == sizeof(sph__query_v8f), "a line is a row");

#define LINE(i) &all[which[i]]
#define NEXT_LINE(i) &all[which[8 + (i)]]

SPH__INLINE void gather(lines *s, const sph__query_line *all, const uint8_t *which)
{
    float *const columns[8] = {s->from[0],      s->from[1],      s->from[2],    s->direction[0],
                               s->direction[1], s->direction[2], s->per_length, s->reach};
    SPH__QUERY_TRANSPOSE_16(LINE, NEXT_LINE, columns);
}

/* Feet side by side. */
typedef struct __attribute__((aligned(64))) feet {
    float at[SIDE], x[SIDE], y[SIDE], z[SIDE], radius[SIDE], apart[SIDE], inside[SIDE], blur[SIDE];
} feet;

#define DIRECTION s->direction[0][i], s->direction[1][i], s->direction[2][i]

/* --- of lines that begin outside --- */

/* What has been found out about each line: feet of the corners, when it is in parts of the primitive, and in the prism.
 */
typedef struct __attribute__((aligned(64))) findings {
    feet feet[3];
    float enter[SIDE], leave[SIDE], in[SIDE], out[SIDE];
} findings;

SPH__INLINE sph__query_foot foot_of(const findings *f, int k, int i)
{
    const feet *s = &f->feet[k];
    return (sph__query_foot){s->at[i], s->x[i], s->y[i], s->z[i], s->radius[i], s->apart[i], s->inside[i], s->blur[i]};
}

SPH__INLINE void set_feet(findings *f, const sph__query_parts *p, int k, const lines *s, int count)
{
    feet *to = &f->feet[k];
    for (int i = 0; i < count; ++i) {
        const float margin = sph__query_margin(s->reach[i]);
        const sph__query_foot foot =
            sph__query_foot_of(p->center[0][k], p->center[1][k], p->center[2][k], p->radius[k] + (s->reach[i] + margin),
                               margin, s->from[0][i], s->from[1][i], s->from[2][i], DIRECTION);
        to->at[i] = foot.at;
        to->x[i] = foot.x;
        to->y[i] = foot.y;
        to->z[i] = foot.z;
        to->radius[i] = foot.radius;
        to->apart[i] = foot.apart;
        to->inside[i] = foot.inside;
        to->blur[i] = foot.blur;
    }
}

SPH__INLINE void add(findings *f, sph__query_span part, int i)
{
    f->enter[i] = sph__query_least(f->enter[i], part.enter);
    f->leave[i] = sph__query_most(f->leave[i], part.leave);
}

SPH__INLINE void add_sphere(findings *f, int k, const lines *s, int count)
{
    for (int i = 0; i < count; ++i) {
        const sph__query_foot foot = foot_of(f, k, i);
        add(f, sph__query_span_sphere(&foot, sph__query_margin(s->reach[i])), i);
    }
}

SPH__INLINE void add_cone(findings *f, const sph__query_parts *p, int k, const lines *s, int count)
{
    for (int i = 0; i < count; ++i) {
        const sph__query_foot foot = foot_of(f, k, i);
        add(f,
            sph__query_span_cone(&foot, p->axis[0][k], p->axis[1][k], p->axis[2][k], p->sine[k], p->cosine[k],
                                 p->length[k], DIRECTION, sph__query_margin(s->reach[i])),
            i);
    }
}

SPH__INLINE void cut_by_side(findings *f, const sph__query_parts *p, int k, const lines *s, int count)
{
    for (int i = 0; i < count; ++i) {
        const float margin = sph__query_margin(s->reach[i]);
        const sph__query_foot foot = foot_of(f, k, i);
        const sph__query_span prism = sph__query_span_cut(
            (sph__query_span){f->in[i], f->out[i]}, &foot, p->side[0][k], p->side[1][k], p->side[2][k],
            p->beyond[k] + p->growth[k] * (s->reach[i] + margin) + margin, DIRECTION);
        f->in[i] = prism.enter;
        f->out[i] = prism.leave;
    }
}

SPH__INLINE void cut_by_face(findings *f, const sph__query_parts *p, int k, const lines *s, int count)
{
    for (int i = 0; i < count; ++i) {
        const sph__query_foot foot = foot_of(f, 0, i);
        const sph__query_span prism =
            sph__query_span_cut((sph__query_span){f->in[i], f->out[i]}, &foot, p->face[k][0], p->face[k][1],
                                p->face[k][2], foot.radius + p->room, DIRECTION);
        f->in[i] = prism.enter;
        f->out[i] = prism.leave;
    }
}

SPH__INLINE void add_prism(findings *f, const sph__query_parts *p, const lines *s, int count)
{
    for (int i = 0; i < count; ++i) {
        f->in[i] = -SPH__QUERY_NEVER;
        f->out[i] = SPH__QUERY_NEVER;
    }
    for (int k = 0; k < 3; ++k)
        cut_by_side(f, p, k, s, count);
    for (int k = 0; k < 2; ++k)
        cut_by_face(f, p, k, s, count);
    for (int i = 0; i < count; ++i)
        add(f, sph__query_span_whole((sph__query_span){f->in[i], f->out[i]}), i);
}

/* Which of the keys are not above the limit, as bits. */
SPH__INLINE uint32_t those_up_to(const float *keys, float limit, int count)
{
    int32_t bits = 0;
    for (int i = 0; i < count; ++i)
        bits |= keys[i] <= limit ? 1 << i : 0;
    return (uint32_t)bits;
}

/* What is shared with a primitive of a lower number is left out; `edges` begin at the first corners. */
SPH__INLINE uint32_t touch(const sph__query_parts *p, const lines *s, int corners, int edges, int count,
                           float *restrict keys)
{
    findings f;
    for (int i = 0; i < count; ++i) {
        f.enter[i] = SPH__QUERY_NEVER;
        f.leave[i] = -SPH__QUERY_NEVER;
    }
    for (int k = 0; k < corners; ++k) {
        set_feet(&f, p, k, s, count);
        if (p->shared_corner[k] == 0) add_sphere(&f, k, s, count);
        if (k < edges && p->shared_edge[k] == 0) add_cone(&f, p, k, s, count);
    }
    if (corners == 3) add_prism(&f, p, s, count);
    for (int i = 0; i < count; ++i)
        keys[i] = sph__query_key((sph__query_span){f.enter[i], f.leave[i]}, s->per_length[i]);
    return those_up_to(keys, 1, count);
}

SPH__CLONES static void wave_touch_clones(const sph__query_parts *parts, const sph__query_line *all,
                                          const uint8_t *which, sph__query_called *called)
{
    lines side;
    uint32_t listed;
    gather(&side, all, which);
    if (parts->corner_count == 3 && called->count > SIDE / 2)
        listed = touch(parts, &side, 3, 3, SIDE, called->keys);
    else if (parts->corner_count == 3)
        listed = touch(parts, &side, 3, 3, SIDE / 2, called->keys);
    else if (parts->corner_count == 2)
        listed = touch(parts, &side, 2, 1, SIDE, called->keys);
    else
        listed = touch(parts, &side, 1, 0, SIDE, called->keys);
    called->listed = listed & ((1u << called->count) - 1);
}

void sph__query_wave_touch(const sph__query_parts *parts, const sph__query_line *all, const uint8_t *which,
                           sph__query_called *called)
{
    wave_touch_clones(parts, all, which, called);
}

/* --- where lines begin --- */

SPH__INLINE float edge_of(const sph__query_parts *p, int k, const lines *s, int i)
{
    return sph__query_depth_edge(s->from[0][i] - p->center[0][k], s->from[1][i] - p->center[1][k],
                                 s->from[2][i] - p->center[2][k], p->axis[0][k], p->axis[1][k], p->axis[2][k],
                                 p->radius[k], p->sine[k], p->tangent[k], p->whole[k]);
}

SPH__INLINE float plane_of(const sph__query_parts *p, int l, const lines *s, int i)
{
    return sph__query_depth_plane(s->from[0][i] - p->center[0][0], s->from[1][i] - p->center[1][0],
                                  s->from[2][i] - p->center[2][0], p->plane[0][l], p->plane[1][l], p->plane[2][l]);
}

SPH__INLINE float measure_of(const sph__query_parts *p, int l, const lines *s, int i, float height)
{
    return plane_of(p, l, s, i) + height * p->plane_height[l] + p->plane_constant[l];
}

/* Spheres and capsules begin with all that they are; of a triangle three edges and the faces count. */
SPH__INLINE float distance_of(const sph__query_parts *p, int is_triangle, const lines *s, int i)
{
    const float edges = sph__query_least(edge_of(p, 0, s, i), edge_of(p, 1, s, i));
    const float height = fabsf(plane_of(p, 0, s, i));
    return is_triangle
               ? sph__query_depth_choose(sph__query_least(edges, edge_of(p, 2, s, i)), measure_of(p, 1, s, i, height),
                                         measure_of(p, 2, s, i, height), measure_of(p, 3, s, i, height))
               : edges;
}

SPH__INLINE uint32_t begin(const sph__query_parts *p, int is_triangle, const lines *s, int count, float *restrict keys)
{
    for (int i = 0; i < count; ++i)
        keys[i] = sph__query_depth_key(distance_of(p, is_triangle, s, i), p->loose, s->reach[i]);
    return those_up_to(keys, 0, count);
}

SPH__CLONES static void wave_begin_clones(const sph__query_parts *parts, const sph__query_line *all,
                                          const uint8_t *which, sph__query_called *called)
{
    lines side;
    uint32_t listed;
    gather(&side, all, which);
    if (parts->corner_count == 3 && called->count > SIDE / 2)
        listed = begin(parts, 1, &side, SIDE, called->keys);
    else if (parts->corner_count == 3)
        listed = begin(parts, 1, &side, SIDE / 2, called->keys);
    else
        listed = begin(parts, 0, &side, SIDE, called->keys);
    called->listed = listed & ((1u << called->count) - 1);
}

void sph__query_wave_begin(const sph__query_parts *parts, const sph__query_line *all, const uint8_t *which,
                           sph__query_called *called)
{
    wave_begin_clones(parts, all, which, called);
}
