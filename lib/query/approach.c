/* SPDX-License-Identifier: MIT */
/*
 * Newton's method on the distance to a primitive, pair by pair. What the loops branch on does not depend on the answer,
 * so that the processor works on several pairs at a time: one alone would wait for two roots and two divisions a step.
 */
#include <math.h>
#include <string.h>

#include "hierarchy/lanes.h"
#include "query/fan.h"
#include "query/step.h"

typedef double v4d __attribute__((vector_size(32), may_alias));
typedef int64_t v4i __attribute__((vector_size(32), may_alias));
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

SPH__CLONES static uint32_t enter_clones(const sph__query_fan *fans, const sph__query_ray *ray, const float *entry,
                                         uint32_t *slots, uint32_t count, float limit)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t slot = slots[i];
        const int meets = enter(&fans[slot], ray, entry[i], limit);
        slots[kept] = slot;
        kept += (uint32_t)meets;
    }
    return kept;
}

uint32_t sph__query_fan_enter(const sph__query_fan *fans, const sph__query_ray *ray, const float *entry,
                              uint32_t *slots, uint32_t count, double limit)
{
    return enter_clones(fans, ray, entry, slots, count, (float)(limit + 1e-6)); /* more than it loses here */
}

/*
 * Of the edges and, in the last lane, the face: the distance from x, and the way's part along the direction from the
 * nearest sphere's centre, times the distance from there; a face has that direction alone. `lane` is the nearest.
 */
typedef struct foot {
    v4d distance, length, course, u; /* u: along the edges */
    v4d soft;                        /* the distance from there; below 0: a face */
    v4d face, climb;                 /* the weights of corners 1 and 2, and how they change along the way */
    int lane;
} foot;

SPH__INLINE void evaluate(const sph__query_fan *f, const double x[3], const double way[3], foot *out)
{
    const v4d zero = {0}, one = zero + 1.0;
    const v4i last = {0, 0, 0, -1}, sign = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};
    const v4d d0 = x[0] - LOAD4(f->from[0]), d1 = x[1] - LOAD4(f->from[1]), d2 = x[2] - LOAD4(f->from[2]);
    const v4d s0 = LOAD4(f->span[0]), s1 = LOAD4(f->span[1]), s2 = LOAD4(f->span[2]);
    const v4d n0 = LOAD4(f->face[0]), n1 = LOAD4(f->face[1]), n2 = LOAD4(f->face[2]), high = LOAD4(f->face_height);
    const v4d along = d0 * LOAD4(f->share[0]) + d1 * LOAD4(f->share[1]) + d2 * LOAD4(f->share[2]);
    const v4d w0 = d0 - along * s0, w1 = d1 - along * s1, w2 = d2 - along * s2;
    const v4d place = n0 * d0[0] + n1 * d1[0] + n2 * d2[0], course = n0 * way[0] + n1 * way[1] + n2 * way[2];
    const v4d above = zero + place[0], aside = (v4d)((v4i)high ^ ((v4i)above & sign)); /* high, as place[0] goes */
    const v4d face = place + aside * above + LOAD4(f->face_constant), climb = course + aside * course[0];
    v4d u, y0, y1, y2, across = w0 * w0 + w1 * w1 + w2 * w2, length, distance;
    int least, third, is_face;
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
    least = distance[1] < distance[0];
    third = distance[2] < distance[least];
    least += third * (2 - least);
    is_face = sph__query_opaque((face[1] >= 0) & (face[2] >= 0) & (face[1] + face[2] <= 1));
    out->lane = least + is_face * (3 - least);
    out->distance = SELECT4(last, face, distance);
    out->length = SELECT4(last, one, length);
    out->course = SELECT4(last, climb, y0 * way[0] + y1 * way[1] + y2 * way[2]);
    out->soft = SELECT4(last, -one, length);
    out->u = u;
    out->face = face;
    out->climb = climb;
}

SPH__INLINE void look(const sph__query_fan *f, const sph__query_moves *m, sph__query_table *table, uint32_t i)
{
    const double at = table->t[i], way[3] = {m->way[0][i], m->way[1][i], m->way[2][i]};
    const double x[3] = {m->start[0][i] + at * way[0], m->start[1][i] + at * way[1], m->start[2][i] + at * way[2]};
    foot here;
    evaluate(f, x, way, &here);
    table->distance[i] = here.distance[here.lane] - m->radius[i];
    table->course[i] = here.course[here.lane];
    table->length[i] = here.length[here.lane];
    table->soft[i] = here.soft[here.lane];
    table->weights[0][i] = here.face[1];
    table->weights[1][i] = here.face[2];
    table->climbs[0][i] = here.climb[1];
    table->climbs[1][i] = here.climb[2];
}

/*
 * Where the tangent reaches 0. What is along the segment is no farther from the nearest sphere's centre than the
 * tangent says and (way * t)^2 / (2 length): where that is nothing, the next place need not be looked at. No more need
 * it where it is on the same face.
 */
SPH__INLINE void go(const sph__query_moves *moves, sph__query_table *table, uint32_t i)
{
    const v4d zero = {0}, one = zero + 1.0, miss = zero + (double)SPH__QUERY_MISS;
    const v4d at = LOAD4(table->t + i), distance = LOAD4(table->distance + i), course = LOAD4(table->course + i);
    const v4d tolerance = LOAD4(moves->tolerance + i), soft = LOAD4(table->soft + i);
    const v4i nears = course < zero, touches = distance <= tolerance;
    const v4d onward = -(distance * LOAD4(table->length + i)) / SELECT4(nears, course, -one);
    const v4d first = LOAD4(table->weights[0] + i) + onward * LOAD4(table->climbs[0] + i);
    const v4d second = LOAD4(table->weights[1] + i) + onward * LOAD4(table->climbs[1] + i);
    const v4i is_flat = (soft < zero) & (first >= zero) & (second >= zero) & (first + second <= one);
    const v4i is_small = onward * onward * LOAD4(moves->squared + i) <= tolerance * soft;
    const v4d ahead = SELECT4(nears, at + onward, miss);
    const v4i is_sure = (is_flat | is_small) & (ahead <= one) & ~touches;
    const v4i ends = (ahead > one) & (ahead <= one + 1e-12) & (at < one);
    const v4d next = SELECT4(ends, one, ahead);
    const v4d after = SELECT4(next == at, at + (at * 3e-16 + 1e-300), next); /* the next number, or the one after */
    *(v4d *)(table->t + i) = SELECT4(touches, at, after);
    *(v4d *)(table->distance + i) = SELECT4(is_sure, zero, distance);
    *(v4i *)(table->touches + i) = touches | is_sure;
}

SPH__CLONES static void step_clones(const sph__query_fan *fans, const sph__query_moves *moves, sph__query_table *table,
                                    uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        look(&fans[table->slot[i]], moves, table, i);
    for (uint32_t i = 0; i < count; i += SPH__QUERY_FAN)
        go(moves, table, i);
}

void sph__query_fan_step(const sph__query_fan *fans, const sph__query_moves *moves, sph__query_table *table,
                         uint32_t count)
{
    step_clones(fans, moves, table, count);
}

static const double STILL[3] = {0, 0, 0};

SPH__CLONES static double distance_clones(const sph__query_fan *fan, const double x[3])
{
    foot f;
    evaluate(fan, x, STILL, &f);
    return f.distance[f.lane];
}

double sph__query_fan_distance(const sph__query_fan *fan, const double x[3])
{
    return distance_clones(fan, x);
}

/* --- the nearest places --- */

/* The weights of the corners at which lanes begin (fan.h). Of the edges in a lane, the other end is the next corner of
 * a triangle, or the other one of a capsule; that of a sphere is itself: it has a u of 0. */
SPH__INLINE void weigh(const sph__query_fan *fan, int is_triangle, sph__query_places *places, uint32_t i)
{
    static const double __attribute__((aligned(32)))
    CORNERS[4][SPH__QUERY_FAN] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    static const uint8_t ENDS[2][SPH__QUERY_FAN] = {{1, 0, 1, 1}, {1, 2, 0, 3}};
    const double x[3] = {places->x[0][i], places->x[1][i], places->x[2][i]};
    const v4d zero = {0};
    foot f;
    evaluate(fan, x, STILL, &f);
    const double u = f.u[f.lane];
    const v4i is_face = (v4i){0} - (int64_t)(f.lane == 3);
    const v4d edge = LOAD4(CORNERS[f.lane]) * (1 - u) + LOAD4(CORNERS[ENDS[is_triangle][f.lane]]) * u;
    const v4d face = {1 - f.face[1] - f.face[2], f.face[1], f.face[2], 0}, w = SELECT4(is_face, face, edge);
    const v4d weights = SELECT4(w > zero, w, zero), radii = weights * LOAD4(fan->radius);
    for (int k = 0; k < 3; ++k) {
        const v4d row = weights * LOAD4(fan->from[k]);
        places->weights[k][i] = weights[k];
        places->center[k][i] = row[0] + row[1] + row[2];
    }
    places->radius[i] = radii[0] + radii[1] + radii[2];
}

SPH__INLINE void point_out(sph__query_places *places, uint32_t i)
{
    const double n0 = places->x[0][i] - places->center[0][i], n1 = places->x[1][i] - places->center[1][i];
    const double n2 = places->x[2][i] - places->center[2][i], squared = n0 * n0 + n1 * n1 + n2 * n2;
    const double per_length = 1 / sqrt(squared), radius = places->radius[i];
    places->squared[i] = squared;
    places->normal[0][i] = n0 * per_length;
    places->normal[1][i] = n1 * per_length;
    places->normal[2][i] = n2 * per_length;
    places->point[0][i] = places->center[0][i] + radius * (n0 * per_length);
    places->point[1][i] = places->center[1][i] + radius * (n1 * per_length);
    places->point[2][i] = places->center[2][i] + radius * (n2 * per_length);
}

SPH__CLONES static void closest_clones(const sph__query_fan *fans, const uint32_t *slots, const int32_t *corner_counts,
                                       sph__query_places *places, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        weigh(&fans[slots[i]], corner_counts[slots[i]] == 3, places, i);
    for (uint32_t at = 0; at < count; at += SPH__QUERY_FAN) /* in whole vectors */
        for (uint32_t i = at; i < at + SPH__QUERY_FAN; ++i)
            point_out(places, i);
}

void sph__query_fan_closest(const sph__query_fan *fans, const uint32_t *slots, const int32_t *corner_counts,
                            sph__query_places *places, uint32_t count)
{
    closest_clones(fans, slots, corner_counts, places, count);
}
