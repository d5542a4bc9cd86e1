/* SPDX-License-Identifier: MIT */
/*
 * Bounds and parts for many moves at once, primitive by primitive: lanes are moves. The same operations as in touch.c
 * and kernel.c, so that the answers have the same bits.
 */
#include "query/wave.h"

#include <math.h>
#include <string.h>

#include "hierarchy/lanes.h"
#include "query/step.h"

enum { WAVE = SPH__QUERY_WAVE, FLOATS = 16 };

typedef sph__query_candidates candidates;

SPH__INLINE float least(float a, float b)
{
    return a < b ? a : b;
}

SPH__INLINE float most(float a, float b)
{
    return a > b ? a : b;
}

void sph__query_wave_begin(sph__query_wave *wave, uint32_t count, const sph__query_ray *rays)
{
    memset(wave, 0, sizeof *wave);
    wave->count = count;
    wave->rays = rays;
    for (uint32_t i = 0; i < WAVE; ++i)
        sph__query_wave_set(wave, i, &sph__query_ray_none);
}

void sph__query_wave_set(sph__query_wave *wave, uint32_t i, const sph__query_ray *ray)
{
    for (int k = 0; k < 3; ++k) {
        wave->above[k][i] = ray->above[k];
        wave->below[k][i] = ray->below[k];
        wave->inverse[k][i] = ray->inverse[k];
    }
}

/* Which moves meet the box, and when they enter it. */
SPH__INLINE uint32_t meet_box(const sph__query_wave *wave, uint32_t count, const float low[3], const float high[3],
                              candidates *c)
{
    int32_t __attribute__((aligned(64))) words[WAVE];
    uint8_t __attribute__((aligned(64))) meets[WAVE];
    float *entry = c->entry;
    uint32_t found = 0;
    const float l0 = low[0], l1 = low[1], l2 = low[2], h0 = high[0], h1 = high[1], h2 = high[2];
    for (uint32_t i = count; i % 64 != 0; i += FLOATS)
        memset(meets + i, 0, FLOATS);
    for (uint32_t i = 0; i < count; ++i) {
        const float a0 = (l0 - wave->above[0][i]) * wave->inverse[0][i];
        const float b0 = (h0 - wave->below[0][i]) * wave->inverse[0][i];
        const float a1 = (l1 - wave->above[1][i]) * wave->inverse[1][i];
        const float b1 = (h1 - wave->below[1][i]) * wave->inverse[1][i];
        const float a2 = (l2 - wave->above[2][i]) * wave->inverse[2][i];
        const float b2 = (h2 - wave->below[2][i]) * wave->inverse[2][i];
        const float in = most(most(least(a0, b0), least(a1, b1)), most(least(a2, b2), 0));
        const float out = least(least(most(a0, b0), most(a1, b1)), least(most(a2, b2), 1));
        entry[i] = in;
        words[i] = in <= out; /* as wide as the others: narrower ones would halve the vectors */
    }
    for (uint32_t i = 0; i < count; ++i)
        meets[i] = (uint8_t)words[i];
    for (uint32_t i = 0; i < count; i += 64)
        for (uint64_t mask = sph__query_pack(meets + i); mask != 0; mask &= mask - 1)
            c->move[found++] = (uint16_t)(i + (uint32_t)__builtin_ctzll(mask));
    return found;
}

/* The line of candidate i. */
#define LINE c->from[0][i], c->from[1][i], c->from[2][i], c->direction[0][i], c->direction[1][i], c->direction[2][i]
#define DIRECTION c->direction[0][i], c->direction[1][i], c->direction[2][i]

SPH__INLINE sph__query_foot foot_of(const sph__query_parts *p, int k, const candidates *c, uint32_t i)
{
    return sph__query_foot_of(p->center[0][k], p->center[1][k], p->center[2][k], p->radius[k] + c->swell[i],
                              c->margin[i], LINE);
}

SPH__INLINE sph__query_span cone_of(const sph__query_parts *p, int k, const sph__query_foot *f, const candidates *c,
                                    uint32_t i)
{
    return sph__query_span_cone(f, p->axis[0][k], p->axis[1][k], p->axis[2][k], p->sine[k], p->cosine[k], p->length[k],
                                DIRECTION, c->margin[i]);
}

SPH__INLINE sph__query_span cut_by_side(const sph__query_parts *p, int k, sph__query_span s, const sph__query_foot *f,
                                        const candidates *c, uint32_t i)
{
    return sph__query_span_cut(s, f, p->side[0][k], p->side[1][k], p->side[2][k],
                               p->beyond[k] + p->growth[k] * c->swell[i] + c->margin[i], DIRECTION);
}

SPH__INLINE sph__query_span cut_by_face(const sph__query_parts *p, int k, sph__query_span s, const sph__query_foot *f,
                                        const candidates *c, uint32_t i)
{
    return sph__query_span_cut(s, f, p->face[k][0], p->face[k][1], p->face[k][2], f->radius + p->room, DIRECTION);
}

SPH__INLINE void finish(candidates *c, uint32_t i, sph__query_span s)
{
    c->first[i] = most(s.enter * c->per_length[i], c->first[i]);
    c->last[i] = s.leave * c->per_length[i];
}

SPH__INLINE void touch_spheres(const sph__query_parts *p, candidates *c, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_foot f = foot_of(p, 0, c, i);
        finish(c, i, sph__query_span_sphere(&f, c->margin[i]));
    }
}

SPH__INLINE void touch_capsules(const sph__query_parts *p, candidates *c, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_foot f = foot_of(p, 0, c, i), g = foot_of(p, 1, c, i);
        const sph__query_span a = sph__query_span_sphere(&f, c->margin[i]), b = cone_of(p, 0, &f, c, i);
        finish(c, i, sph__query_span_join(sph__query_span_join(a, b), sph__query_span_sphere(&g, c->margin[i])));
    }
}

SPH__INLINE void touch_triangles(const sph__query_parts *p, candidates *c, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_foot f = foot_of(p, 0, c, i), g = foot_of(p, 1, c, i), h = foot_of(p, 2, c, i);
        sph__query_span s = sph__query_span_all, t = sph__query_span_sphere(&f, c->margin[i]);
        t = sph__query_span_join(t, sph__query_span_sphere(&g, c->margin[i]));
        t = sph__query_span_join(t, sph__query_span_sphere(&h, c->margin[i]));
        t = sph__query_span_join(t, cone_of(p, 0, &f, c, i));
        t = sph__query_span_join(t, cone_of(p, 1, &g, c, i));
        t = sph__query_span_join(t, cone_of(p, 2, &h, c, i));
        s = cut_by_side(p, 0, s, &f, c, i);
        s = cut_by_side(p, 1, s, &g, c, i);
        s = cut_by_side(p, 2, s, &h, c, i);
        s = cut_by_face(p, 0, s, &f, c, i);
        s = cut_by_face(p, 1, s, &f, c, i);
        finish(c, i, sph__query_span_join(t, sph__query_span_whole(s)));
    }
}

/* Of the candidates those that meet the parts; pairs that may touch. */
SPH__INLINE uint32_t meet_parts(const sph__query_parts *p, const sph__query_ray *rays, candidates *c, uint32_t count,
                                uint32_t slot, sph__query_pair *pairs)
{
    const uint32_t whole = (count + FLOATS - 1) / FLOATS * FLOATS;
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_ray *ray = &rays[c->move[i]];
        for (int k = 0; k < 3; ++k) {
            c->from[k][i] = ray->from[k];
            c->direction[k][i] = ray->direction[k];
        }
        c->per_length[i] = ray->per_length;
        c->swell[i] = ray->swell;
        c->margin[i] = ray->margin;
        c->first[i] = c->entry[c->move[i]];
    }
    if (p->corner_count == 3)
        touch_triangles(p, c, whole);
    else if (p->corner_count == 2)
        touch_capsules(p, c, whole);
    else
        touch_spheres(p, c, whole);
    for (uint32_t i = 0; i < count; ++i) {
        pairs[found] = (sph__query_pair){.t = c->first[i], .slot = slot, .move = c->move[i]};
        found += (c->first[i] <= 1) & (c->last[i] >= 0);
    }
    return found;
}

SPH__CLONES static uint32_t wave_clones(sph__query_wave *wave, const sph__query_bounds *bounds,
                                        const sph__query_parts *parts, uint32_t slot, sph__query_pair *pairs)
{
    const uint32_t whole = (wave->count + FLOATS - 1) / FLOATS * FLOATS;
    const float low[3] = {bounds->low[0][slot], bounds->low[1][slot], bounds->low[2][slot]};
    const float high[3] = {bounds->high[0][slot], bounds->high[1][slot], bounds->high[2][slot]};
    candidates *c = &wave->candidates;
    const uint32_t count = meet_box(wave, whole, low, high, c);
    return count > 0 ? meet_parts(&parts[slot], wave->rays, c, count, slot, pairs) : 0;
}

uint32_t sph__query_wave_pairs(sph__query_wave *wave, const sph__query_bounds *bounds, const sph__query_parts *parts,
                               uint32_t slot, sph__query_pair *pairs)
{
    return wave_clones(wave, bounds, parts, slot, pairs);
}
