/* SPDX-License-Identifier: MIT */
/*
 * Newton's method on the distance to a primitive, pair by pair. What the loops branch on does not depend on the answer,
 * so that the processor works on several pairs at a time: one alone would wait for two roots and two divisions a step.
 */
#include <math.h>
#include <string.h>

#include "hierarchy/lanes.h"
#include "query/step.h"

typedef double v4d __attribute__((vector_size(32), may_alias));
typedef int64_t v4i __attribute__((vector_size(32)));
typedef float v4f __attribute__((vector_size(16), may_alias));
typedef int32_t v4fi __attribute__((vector_size(16)));

#define LOAD4(row) (*(const v4d *)(row))
#define SELECT4(mask, a, b) ((v4d)(((mask) & (v4i)(a)) | (~(mask) & (v4i)(b))))
#define LOAD4F(row) (*(const v4f *)(row))
#define SELECT4F(mask, a, b) ((v4f)(((mask) & (v4fi)(a)) | (~(mask) & (v4fi)(b))))

SPH__INLINE float greater(float a, float b)
{
    return a > b ? a : b;
}

SPH__INLINE float lesser(float a, float b)
{
    return a < b ? a : b;
}

float sph__query_fan_bound(const sph__query_fan *f, const float x[3])
{
    const v4f place = LOAD4F(f->normal[0]) * x[0] + LOAD4F(f->normal[1]) * x[1] + LOAD4F(f->normal[2]) * x[2];
    const v4f below = LOAD4F(f->low) - place, above = place - LOAD4F(f->high);
    const v4f d = SELECT4F(below > above, below, above);
    return greater(greater(d[0], d[1]), greater(d[2], d[3]));
}

/* Is a segment that is in the box from `entry` on in the slabs as well, and no later than `limit`? */
SPH__INLINE int enter(const sph__query_fan *f, const sph__query_ray *ray, float entry, float limit)
{
    const v4f zero = {0}, tiny = zero + 1e-18f;
    const v4f n0 = LOAD4F(f->normal[0]), n1 = LOAD4F(f->normal[1]), n2 = LOAD4F(f->normal[2]);
    const v4f place = n0 * ray->from[0] + n1 * ray->from[1] + n2 * ray->from[2];
    const v4f rate = n0 * ray->way[0] + n1 * ray->way[1] + n2 * ray->way[2];
    const v4f inverse = 1.0f / (rate + SELECT4F(rate < zero, -tiny, tiny)); /* never infinite */
    const v4f a = (LOAD4F(f->low) - ray->reach - place) * inverse, b = (LOAD4F(f->high) + ray->reach - place) * inverse;
    const v4f first = SELECT4F(a < b, a, b), last = SELECT4F(a < b, b, a);
    const float in = greater(greater(greater(first[0], first[1]), greater(first[2], first[3])), entry);
    const float out = lesser(lesser(lesser(last[0], last[1]), lesser(last[2], last[3])), limit);
    return in <= out;
}

SPH__CLONES static uint32_t enter_clones(const sph__query_fan *fans, const sph__query_ray *rays, sph__query_pair *pairs,
                                         uint32_t count, float limit)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint16_t move = pairs[i].move;
        const uint32_t slot = pairs[i].slot;
        const double t = pairs[i].t;
        const int meets = enter(&fans[slot], &rays[move], (float)t, limit);
        pairs[kept].t = t;
        pairs[kept].move = move;
        pairs[kept].slot = slot;
        kept += (uint32_t)meets;
    }
    return kept;
}

uint32_t sph__query_fan_enter(const sph__query_fan *fans, const sph__query_ray *rays, sph__query_pair *pairs,
                              uint32_t count, double limit)
{
    return enter_clones(fans, rays, pairs, count, (float)(limit + 1e-6)); /* more than it loses here */
}

/*
 * The distance from x, and its slope along `way`: of the face where the weights are within the triangle, else of the
 * nearest of the edges.
 */
SPH__INLINE double evaluate(const sph__query_fan *f, const double x[3], const double way[3], double *slope)
{
    const v4d zero = {0}, one = zero + 1.0;
    const v4d d0 = x[0] - LOAD4(f->from[0]), d1 = x[1] - LOAD4(f->from[1]), d2 = x[2] - LOAD4(f->from[2]);
    const v4d s0 = LOAD4(f->span[0]), s1 = LOAD4(f->span[1]), s2 = LOAD4(f->span[2]);
    const v4d n0 = LOAD4(f->face[0]), n1 = LOAD4(f->face[1]), n2 = LOAD4(f->face[2]), high = LOAD4(f->face_height);
    const v4d along = d0 * LOAD4(f->share[0]) + d1 * LOAD4(f->share[1]) + d2 * LOAD4(f->share[2]);
    const v4d w0 = d0 - along * s0, w1 = d1 - along * s1, w2 = d2 - along * s2;
    const v4d place = n0 * d0[0] + n1 * d1[0] + n2 * d2[0], course = n0 * way[0] + n1 * way[1] + n2 * way[2];
    const v4d face = place + high * fabs(place[0]) + LOAD4(f->face_constant);
    const double climb = course[3] + copysign(high[3], place[0]) * course[0];
    const int is_face = (face[1] >= 0) & (face[2] >= 0) & (face[1] + face[2] <= 1);
    v4d u, y0, y1, y2, across = w0 * w0 + w1 * w1 + w2 * w2, length, distance, rate;
    int least, third;
    for (int l = 0; l < SPH__QUERY_FAN; ++l)
        across[l] = sqrt(across[l]);
    u = along - across * LOAD4(f->lean) + LOAD4(f->bias);
    u = SELECT4(u > zero, u, zero);
    u = SELECT4(u < one, u, one);
    y0 = d0 - u * s0;
    y1 = d1 - u * s1;
    y2 = d2 - u * s2;
    length = y0 * y0 + y1 * y1 + y2 * y2;
    for (int l = 0; l < SPH__QUERY_FAN; ++l)
        length[l] = sqrt(length[l]);
    distance = length - (LOAD4(f->radius) + u * LOAD4(f->growth));
    rate = (y0 * way[0] + y1 * way[1] + y2 * way[2]) / (length + 1e-300); /* 0 at a centre, no less than 1e-160 else */
    least = distance[1] < distance[0];
    third = distance[2] < distance[least];
    least += third * (2 - least);
    *slope = sph__query_pick(is_face, climb, rate[least]);
    return sph__query_pick(is_face, face[3], distance[least]);
}

SPH__INLINE void step(const sph__query_fan *f, const sph__query_move *m, sph__query_pair *p)
{
    const double at = p->t;
    const double x[3] = {m->start[0] + at * m->way[0], m->start[1] + at * m->way[1], m->start[2] + at * m->way[2]};
    double slope;
    const double distance = evaluate(f, x, m->way, &slope) - m->radius;
    sph__query_finish(p, distance, m->tolerance, sph__query_pick(slope < 0, at - distance / slope, SPH__QUERY_MISS));
}

SPH__CLONES static void some_clones(const sph__query_fan *fans, const sph__query_move *moves, sph__query_pair *pairs,
                                    const uint32_t *which, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        sph__query_pair *p = &pairs[which[i]];
        step(&fans[p->slot], &moves[p->move], p);
    }
}

void sph__query_fan_step(const sph__query_fan *fans, const sph__query_move *moves, sph__query_pair *pairs,
                         const uint32_t *which, uint32_t count)
{
    some_clones(fans, moves, pairs, which, count);
}

SPH__CLONES static double distance_clones(const sph__query_fan *fan, const double x[3])
{
    static const double STILL[3] = {0, 0, 0};
    double slope;
    return evaluate(fan, x, STILL, &slope);
}

double sph__query_fan_distance(const sph__query_fan *fan, const double x[3])
{
    return distance_clones(fan, x);
}
