/* SPDX-License-Identifier: MIT */
/*
 * Bounds and the first step of Newton's method for many moves at once, primitive by primitive: lanes are moves. The
 * same operations in the same order as in approach.c and kernel.c, so that the answers have the same bits.
 */
#include "query/wave.h"

#include <math.h>
#include <string.h>

#include "hierarchy/lanes.h"
#include "query/step.h"

enum { WAVE = SPH__QUERY_WAVE, FLOATS = 16, DOUBLES = 8 };

typedef sph__query_candidates candidates;

SPH__INLINE float least(float a, float b)
{
    return a < b ? a : b;
}

SPH__INLINE float most(float a, float b)
{
    return a > b ? a : b;
}

void sph__query_wave_begin(sph__query_wave *wave, uint32_t count, const sph__query_ray *rays,
                           const sph__query_move *moves)
{
    memset(wave, 0, sizeof *wave);
    wave->count = count;
    wave->rays = rays;
    wave->moves = moves;
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
        meets[i] = in <= out;
    }
    for (uint32_t i = 0; i < count; i += 64)
        for (uint64_t mask = sph__query_pack(meets + i); mask != 0; mask &= mask - 1)
            c->move[found++] = (uint8_t)(i + (uint32_t)__builtin_ctzll(mask));
    return found;
}

/* Cuts the ways of the candidates to the slabs. */
SPH__INLINE void cut_lanes(const sph__query_fan *f, const candidates *c, uint32_t count, float *restrict first,
                           float *restrict last)
{
    for (uint32_t i = 0; i < count; ++i) {
        float in = first[i], out = 1;
        for (int l = 0; l < SPH__QUERY_FAN; ++l) {
            const float n0 = f->normal[0][l], n1 = f->normal[1][l], n2 = f->normal[2][l];
            const float place = n0 * c->from[0][i] + n1 * c->from[1][i] + n2 * c->from[2][i];
            const float rate = n0 * c->way[0][i] + n1 * c->way[1][i] + n2 * c->way[2][i];
            const float inverse = 1.0f / (rate + (rate < 0 ? -1e-18f : 1e-18f));
            const float a = (f->low[l] - c->reach[i] - place) * inverse;
            const float b = (f->high[l] + c->reach[i] - place) * inverse;
            in = most(least(a, b), in);
            out = least(most(a, b), out);
        }
        first[i] = in;
        last[i] = out;
    }
}

/* Of the candidates those that meet the slabs too. */
SPH__INLINE uint32_t meet_slabs(const sph__query_fan *f, const sph__query_ray *rays, candidates *c, uint32_t count)
{
    const uint32_t whole = (count + FLOATS - 1) / FLOATS * FLOATS;
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_ray *ray = &rays[c->move[i]];
        for (int k = 0; k < 3; ++k) {
            c->from[k][i] = ray->from[k];
            c->way[k][i] = ray->way[k];
        }
        c->reach[i] = ray->reach;
        c->first[i] = c->entry[c->move[i]];
    }
    cut_lanes(f, c, whole, c->first, c->last);
    for (uint32_t i = 0; i < count; ++i) {
        c->move[found] = c->move[i];
        c->t[found] = c->first[i];
        found += c->first[i] <= c->last[i];
    }
    return found;
}

/* Of an edge the distance less the radius, its slope times the length, the length. */
#define EDGE(e, distance, rate, length)                                                                                \
    const double d0##e = x0 - f->from[0][e], d1##e = x1 - f->from[1][e], d2##e = x2 - f->from[2][e];                   \
    const double along##e = d0##e * f->share[0][e] + d1##e * f->share[1][e] + d2##e * f->share[2][e];                  \
    const double w0##e = d0##e - along##e * f->span[0][e], w1##e = d1##e - along##e * f->span[1][e];                   \
    const double w2##e = d2##e - along##e * f->span[2][e];                                                             \
    const double across##e = sqrt(w0##e * w0##e + w1##e * w1##e + w2##e * w2##e);                                      \
    const double v##e = along##e - across##e * f->lean[e] + f->bias[e];                                                \
    const double p##e = v##e > 0 ? v##e : 0, u##e = p##e < 1 ? p##e : 1;                                               \
    const double y0##e = d0##e - u##e * f->span[0][e], y1##e = d1##e - u##e * f->span[1][e];                           \
    const double y2##e = d2##e - u##e * f->span[2][e];                                                                 \
    const double length = sqrt(y0##e * y0##e + y1##e * y1##e + y2##e * y2##e);                                         \
    const double distance = length - (f->radius[e] + u##e * f->growth[e]);                                             \
    const double rate = y0##e * c0 + y1##e * c1 + y2##e * c2

SPH__INLINE void step_lanes(const sph__query_fan *f, const candidates *c, uint32_t begin, double *restrict distances,
                            double *restrict nexts)
{
    for (uint32_t i = begin; i < begin + DOUBLES; ++i) {
        const double at = c->t[i], c0 = c->course[0][i], c1 = c->course[1][i], c2 = c->course[2][i];
        const double x0 = c->start[0][i] + at * c0, x1 = c->start[1][i] + at * c1, x2 = c->start[2][i] + at * c2;
        EDGE(0, distance0, rate0, length0);
        EDGE(1, distance1, rate1, length1);
        EDGE(2, distance2, rate2, length2);
        const double place = f->face[0][0] * d00 + f->face[1][0] * d10 + f->face[2][0] * d20, height = fabs(place);
        const double b1 = f->face[0][1] * d00 + f->face[1][1] * d10 + f->face[2][1] * d20 + f->face_height[1] * height +
                          f->face_constant[1];
        const double b2 = f->face[0][2] * d00 + f->face[1][2] * d10 + f->face[2][2] * d20 + f->face_height[2] * height +
                          f->face_constant[2];
        const double above = f->face[0][3] * d00 + f->face[1][3] * d10 + f->face[2][3] * d20 +
                             f->face_height[3] * height + f->face_constant[3];
        const double climb =
            f->face[0][3] * c0 + f->face[1][3] * c1 + f->face[2][3] * c2 +
            copysign(f->face_height[3], place) * (f->face[0][0] * c0 + f->face[1][0] * c1 + f->face[2][0] * c2);
        const int is_second = distance1 < distance0;
        const double first = is_second ? distance1 : distance0;
        const int is_third = distance2 < first;
        const double edge = is_third ? distance2 : first;
        const double rate = is_third ? rate2 : is_second ? rate1 : rate0;
        const double length = is_third ? length2 : is_second ? length1 : length0;
        const int is_face = (b1 >= 0) & (b2 >= 0) & (b1 + b2 <= 1);
        const double distance = (is_face ? above : edge) - c->radius[i];
        const double slope = is_face ? climb : rate / (length + 1e-300);
        const double next = at - distance / slope;
        distances[i] = distance;
        nexts[i] = slope < 0 ? next : (double)SPH__QUERY_MISS;
    }
}

/* The first steps; pairs that touch or may touch later. */
SPH__INLINE uint32_t step_moves(const sph__query_fan *f, const sph__query_move *moves, candidates *c, uint32_t count,
                                uint32_t slot, sph__query_pair *pairs)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_move *m = &moves[c->move[i]];
        for (int k = 0; k < 3; ++k) {
            c->start[k][i] = m->start[k];
            c->course[k][i] = m->way[k];
        }
        c->radius[i] = m->radius;
    }
    for (uint32_t i = 0; i < count; i += DOUBLES)
        step_lanes(f, c, i, c->distance, c->next);
    for (uint32_t i = 0; i < count; ++i) {
        sph__query_pair *p = &pairs[found];
        *p = (sph__query_pair){.t = c->t[i], .slot = slot, .move = c->move[i]};
        sph__query_finish(p, c->distance[i], moves[c->move[i]].tolerance, c->next[i]);
        found += p->t <= 1;
    }
    return found;
}

SPH__CLONES static uint32_t wave_clones(sph__query_wave *wave, const sph__query_bounds *bounds,
                                        const sph__query_fan *fans, uint32_t slot, sph__query_pair *pairs)
{
    const uint32_t whole = (wave->count + FLOATS - 1) / FLOATS * FLOATS;
    const float low[3] = {bounds->low[0][slot], bounds->low[1][slot], bounds->low[2][slot]};
    const float high[3] = {bounds->high[0][slot], bounds->high[1][slot], bounds->high[2][slot]};
    candidates *c = &wave->candidates;
    uint32_t count = meet_box(wave, whole, low, high, c);
    if (count > 0) count = meet_slabs(&fans[slot], wave->rays, c, count);
    return count > 0 ? step_moves(&fans[slot], wave->moves, c, count, slot, pairs) : 0;
}

uint32_t sph__query_wave_pairs(sph__query_wave *wave, const sph__query_bounds *bounds, const sph__query_fan *fans,
                               uint32_t slot, sph__query_pair *pairs)
{
    return wave_clones(wave, bounds, fans, slot, pairs);
}
