/* SPDX-License-Identifier: MIT */
/* The parts of primitives against one ray each, four pairs at a time: lanes are corners, edges and sides. */
#include <string.h>

#include "query/parts.h"

enum { FAN = SPH__QUERY_FAN, PAIRS = 4, LANES = FAN * PAIRS };

/* Rows of four primitives, side by side; what is the same for all lanes of a pair, four times. */
typedef struct __attribute__((aligned(64))) lanes {
    float center[3][LANES], radius[LANES], axis[3][LANES], sine[LANES], cosine[LANES], length[LANES];
    float side[3][LANES], beyond[LANES], growth[LANES];
    float from[3][LANES], direction[3][LANES], swell[LANES], margin[LANES], face[3][LANES], room[LANES];
    float corner[3][LANES], thick[LANES]; /* the first corner */
    float enter[LANES], leave[LANES], in[LANES], out[LANES];
} lanes;

#define COPY(row) memcpy(&s->row[FAN * pair], p->row, FAN * sizeof(float))

SPH__INLINE void gather(lanes *s, int pair, const sph__query_parts *p, const sph__query_ray *r)
{
    for (int k = 0; k < 3; ++k) {
        COPY(center[k]);
        COPY(axis[k]);
        COPY(side[k]);
        for (int l = 0; l < FAN; ++l) {
            s->from[k][FAN * pair + l] = r->from[k];
            s->direction[k][FAN * pair + l] = r->direction[k];
            s->corner[k][FAN * pair + l] = p->center[k][0];
            s->face[k][FAN * pair + l] = p->face[l & 1][k];
        }
    }
    COPY(radius);
    COPY(sine);
    COPY(cosine);
    COPY(length);
    COPY(beyond);
    COPY(growth);
    for (int l = 0; l < FAN; ++l) {
        s->swell[FAN * pair + l] = r->swell;
        s->margin[FAN * pair + l] = r->margin;
        s->thick[FAN * pair + l] = p->radius[0];
        s->room[FAN * pair + l] = p->room;
    }
}

SPH__INLINE void meet(lanes *s, int count)
{
    for (int l = 0; l < count; ++l) {
        const float ex = s->direction[0][l], ey = s->direction[1][l], ez = s->direction[2][l];
        const float px = s->from[0][l], py = s->from[1][l], pz = s->from[2][l];
        const sph__query_foot f = sph__query_foot_of(s->center[0][l], s->center[1][l], s->center[2][l],
                                                     s->radius[l] + s->swell[l], s->margin[l], px, py, pz, ex, ey, ez);
        const sph__query_foot g = sph__query_foot_of(s->corner[0][l], s->corner[1][l], s->corner[2][l],
                                                     s->thick[l] + s->swell[l], s->margin[l], px, py, pz, ex, ey, ez);
        const sph__query_span cone = sph__query_span_cone(&f, s->axis[0][l], s->axis[1][l], s->axis[2][l], s->sine[l],
                                                          s->cosine[l], s->length[l], ex, ey, ez, s->margin[l]);
        const sph__query_span both = sph__query_span_join(sph__query_span_sphere(&f, s->margin[l]), cone);
        const sph__query_span side =
            sph__query_span_cut(sph__query_span_all, &f, s->side[0][l], s->side[1][l], s->side[2][l],
                                s->beyond[l] + s->growth[l] * s->swell[l] + s->margin[l], ex, ey, ez);
        const sph__query_span prism = sph__query_span_cut(side, &g, s->face[0][l], s->face[1][l], s->face[2][l],
                                                          g.radius + s->room[l], ex, ey, ez);
        s->enter[l] = both.enter;
        s->leave[l] = both.leave;
        s->in[l] = prism.enter;
        s->out[l] = prism.leave;
    }
}

SPH__INLINE float least_of(const float *row)
{
    return sph__query_least(sph__query_least(row[0], row[1]), sph__query_least(row[2], row[3]));
}

SPH__INLINE float most_of(const float *row)
{
    return sph__query_most(sph__query_most(row[0], row[1]), sph__query_most(row[2], row[3]));
}

/* Does the pair touch? Then its t becomes when. */
SPH__INLINE int finish(const lanes *s, int pair, float per_length, float *t)
{
    const sph__query_span prism = {most_of(s->in + FAN * pair), least_of(s->out + FAN * pair)};
    const sph__query_span parts = {least_of(s->enter + FAN * pair), most_of(s->leave + FAN * pair)};
    const sph__query_span whole = sph__query_span_join(parts, sph__query_span_whole(prism));
    *t = sph__query_most(whole.enter * per_length, *t);
    return (*t <= 1) & (whole.leave * per_length >= 0);
}

SPH__CLONES static uint32_t touch_clones(const sph__query_parts *parts, const sph__query_ray *rays,
                                         sph__query_pair *pairs, uint32_t count)
{
    lanes s;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i += PAIRS) {
        const uint32_t here = count - i > 1 ? PAIRS : 1;
        for (uint32_t j = 0; j < here; ++j) { /* what is missing is the last one again */
            const sph__query_pair *pair = &pairs[i + j < count ? i + j : count - 1];
            gather(&s, (int)j, &parts[pair->slot], &rays[pair->move]);
        }
        if (here == 1)
            meet(&s, FAN);
        else
            meet(&s, LANES);
        for (uint32_t j = 0; j < PAIRS && i + j < count; ++j) {
            const uint16_t move = pairs[i + j].move;
            const uint32_t slot = pairs[i + j].slot;
            float t = (float)pairs[i + j].t;
            const int touches = finish(&s, (int)j, rays[move].per_length, &t);
            pairs[kept] = (sph__query_pair){.t = t, .slot = slot, .move = move};
            kept += (uint32_t)touches;
        }
    }
    return kept;
}

uint32_t sph__query_parts_touch(const sph__query_parts *parts, const sph__query_ray *rays, sph__query_pair *pairs,
                                uint32_t count)
{
    return count > 0 ? touch_clones(parts, rays, pairs, count) : 0;
}
