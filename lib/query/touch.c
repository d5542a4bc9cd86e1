/* SPDX-License-Identifier: MIT */
/* The parts of primitives against one line, four primitives at a time: lanes are corners, edges and sides. */
#include <string.h>

#include "query/parts.h"

enum { FAN = SPH__QUERY_FAN, TOGETHER = 4, LANES = FAN * TOGETHER };

/* Rows of four primitives, side by side; what is the same for all lanes of one, four times. */
typedef struct __attribute__((aligned(64))) lanes {
    float center[3][LANES], radius[LANES], axis[3][LANES], sine[LANES], cosine[LANES], length[LANES];
    float side[3][LANES], beyond[LANES], growth[LANES], face[3][LANES], room[LANES];
    float corner[3][LANES], thick[LANES]; /* the first corner */
    float shared_corner[LANES], shared_edge[LANES];
    float enter[LANES], own[LANES], leave[LANES], in[LANES], out[LANES];
} lanes;

#define COPY(row) memcpy(&s->row[FAN * place], p->row, FAN * sizeof(float))

SPH__INLINE void gather(lanes *s, int place, const sph__query_parts *p)
{
    for (int k = 0; k < 3; ++k) {
        COPY(center[k]);
        COPY(axis[k]);
        COPY(side[k]);
        for (int l = 0; l < FAN; ++l) {
            s->corner[k][FAN * place + l] = p->center[k][0];
            s->face[k][FAN * place + l] = p->face[l & 1][k];
        }
    }
    COPY(radius);
    COPY(sine);
    COPY(cosine);
    COPY(length);
    COPY(beyond);
    COPY(growth);
    COPY(shared_corner);
    COPY(shared_edge);
    for (int l = 0; l < FAN; ++l) {
        s->thick[FAN * place + l] = p->radius[0];
        s->room[FAN * place + l] = p->room;
    }
}

SPH__INLINE void meet(lanes *s, const sph__query_line *line, int count)
{
    const float ex = line->direction[0], ey = line->direction[1], ez = line->direction[2];
    const float px = line->from[0], py = line->from[1], pz = line->from[2];
    const float margin = sph__query_margin(line->reach), swell = line->reach + margin;
    for (int l = 0; l < count; ++l) {
        const sph__query_foot f = sph__query_foot_of(s->center[0][l], s->center[1][l], s->center[2][l],
                                                     s->radius[l] + swell, margin, px, py, pz, ex, ey, ez);
        const sph__query_foot g = sph__query_foot_of(s->corner[0][l], s->corner[1][l], s->corner[2][l],
                                                     s->thick[l] + swell, margin, px, py, pz, ex, ey, ez);
        const sph__query_span cone = sph__query_span_cone(&f, s->axis[0][l], s->axis[1][l], s->axis[2][l], s->sine[l],
                                                          s->cosine[l], s->length[l], ex, ey, ez, margin);
        const sph__query_span sphere = sph__query_span_sphere(&f, margin);
        const sph__query_span side =
            sph__query_span_cut(sph__query_span_all, &f, s->side[0][l], s->side[1][l], s->side[2][l],
                                s->beyond[l] + s->growth[l] * swell + margin, ex, ey, ez);
        const sph__query_span prism = sph__query_span_cut(side, &g, s->face[0][l], s->face[1][l], s->face[2][l],
                                                          g.radius + s->room[l], ex, ey, ez);
        s->enter[l] = sph__query_least(sphere.enter, cone.enter);
        s->own[l] = sph__query_least(sphere.enter + s->shared_corner[l], cone.enter + s->shared_edge[l]);
        s->leave[l] = sph__query_most(sphere.leave, cone.leave);
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

/* When the line is in the primitive. */
SPH__INLINE sph__query_entry entry_of(const lanes *s, int place)
{
    const sph__query_span prism = {most_of(s->in + FAN * place), least_of(s->out + FAN * place)};
    const sph__query_entry parts = {least_of(s->enter + FAN * place), least_of(s->own + FAN * place),
                                    most_of(s->leave + FAN * place)};
    return sph__query_entry_part(parts, sph__query_span_whole(prism), 0);
}

SPH__CLONES static uint32_t touch_clones(const sph__query_parts *parts, const sph__query_fan *fans,
                                         const sph__query_line *line, const uint32_t *slots, uint32_t count,
                                         sph__query_listed *listed)
{
    const float swell = line->reach + sph__query_margin(line->reach);
    lanes s;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i += TOGETHER) {
        const uint32_t here = count - i > 1 ? TOGETHER : 1;
        for (uint32_t j = 0; j < here; ++j) /* what is missing is the last one again */
            gather(&s, (int)j, &parts[slots[i + j < count ? i + j : count - 1]]);
        if (here == 1)
            meet(&s, line, FAN);
        else
            meet(&s, line, LANES);
        for (uint32_t j = 0; j < TOGETHER && i + j < count; ++j) {
            const uint32_t slot = slots[i + j];
            const float bound = sph__query_fan_bound(&fans[slot], line->from) - swell;
            const float key = sph__query_key(entry_of(&s, (int)j), line->per_length, bound, line->reach);
            listed[kept] = sph__query_list(key, slot);
            kept += key <= 1;
        }
    }
    return kept;
}

uint32_t sph__query_parts_touch(const sph__query_parts *parts, const sph__query_fan *fans, const sph__query_line *line,
                                const uint32_t *slots, uint32_t count, sph__query_listed *listed)
{
    return count > 0 ? touch_clones(parts, fans, line, slots, count, listed) : 0;
}
