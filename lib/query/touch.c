/* SPDX-License-Identifier: MIT */
/* The parts of primitives against one line, four primitives at a time: lanes are corners, edges and sides. */
#include <string.h>

#include "query/depth.h"

enum { FAN = SPH__QUERY_FAN, TOGETHER = 4, LANES = FAN * TOGETHER };

/* Rows of four primitives, side by side; what is the same for all lanes of one, four times. */
typedef struct __attribute__((aligned(64))) lanes {
    float center[3][LANES], radius[LANES], axis[3][LANES], sine[LANES], cosine[LANES], length[LANES];
    float side[3][LANES], beyond[LANES], growth[LANES], face[3][LANES], room[LANES];
    float corner[3][LANES], thick[LANES]; /* the first corner */
    float shared_corner[LANES], shared_edge[LANES];
    float enter[LANES], leave[LANES], in[LANES], out[LANES];
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
        s->enter[l] = sph__query_least(sphere.enter + s->shared_corner[l], cone.enter + s->shared_edge[l]);
        s->leave[l] = sph__query_most(sphere.leave - s->shared_corner[l], cone.leave - s->shared_edge[l]);
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

/* When the line is in parts of its own. */
SPH__INLINE sph__query_span span_of(const lanes *s, int place)
{
    const sph__query_span prism = {most_of(s->in + FAN * place), least_of(s->out + FAN * place)};
    const sph__query_span parts = {least_of(s->enter + FAN * place), most_of(s->leave + FAN * place)};
    return sph__query_span_part(parts, sph__query_span_whole(prism), 0);
}

SPH__CLONES static void touch_clones(const sph__query_parts *parts, const sph__query_line *line, const uint32_t *slots,
                                     uint32_t count, float *keys)
{
    lanes s;
    for (uint32_t i = 0; i < count; i += TOGETHER) {
        const uint32_t here = count - i > 1 ? TOGETHER : 1;
        for (uint32_t j = 0; j < here; ++j) /* what is missing is the last one again */
            gather(&s, (int)j, &parts[slots[i + j < count ? i + j : count - 1]]);
        if (here == 1)
            meet(&s, line, FAN);
        else
            meet(&s, line, LANES);
        for (uint32_t j = 0; j < TOGETHER && i + j < count; ++j)
            keys[i + j] = sph__query_key(span_of(&s, (int)j), line->per_length);
    }
}

void sph__query_parts_touch(const sph__query_parts *parts, const sph__query_line *line, const uint32_t *slots,
                            uint32_t count, float *keys)
{
    touch_clones(parts, line, slots, count, keys);
}

/* --- where the line begins --- */

/* The edges of a primitive, and the measures of its faces. */
SPH__INLINE float distance_of(const sph__query_parts *p, const float from[3])
{
    float edges[FAN], planes[FAN];
    const float height =
        sph__query_depth_plane(from[0] - p->center[0][0], from[1] - p->center[1][0], from[2] - p->center[2][0],
                               p->plane[0][0], p->plane[1][0], p->plane[2][0]);
    for (int l = 0; l < FAN; ++l) {
        edges[l] = sph__query_depth_edge(from[0] - p->center[0][l], from[1] - p->center[1][l],
                                         from[2] - p->center[2][l], p->axis[0][l], p->axis[1][l], p->axis[2][l],
                                         p->radius[l], p->sine[l], p->tangent[l], p->whole[l]);
        planes[l] = sph__query_depth_plane(from[0] - p->center[0][0], from[1] - p->center[1][0],
                                           from[2] - p->center[2][0], p->plane[0][l], p->plane[1][l], p->plane[2][l]) +
                    fabsf(height) * p->plane_height[l] + p->plane_constant[l];
    }
    return sph__query_depth_choose(least_of(edges), planes[1], planes[2], planes[3]);
}

SPH__CLONES static void begin_clones(const sph__query_parts *parts, const sph__query_line *line, const uint32_t *slots,
                                     uint32_t count, float *keys)
{
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_parts *p = &parts[slots[i]];
        keys[i] = sph__query_depth_key(distance_of(p, line->from), p->loose, line->reach);
    }
}

void sph__query_parts_begin(const sph__query_parts *parts, const sph__query_line *line, const uint32_t *slots,
                            uint32_t count, float *keys)
{
    begin_clones(parts, line, slots, count, keys);
}
