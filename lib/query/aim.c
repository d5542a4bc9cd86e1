/* SPDX-License-Identifier: MIT */
#include "query/aim.h"

#include <math.h>

#include "hierarchy/lanes.h"
#include "query/transpose.h"

enum { AIM = SPH__QUERY_AIM };

SPH__INLINE double least(double a, double b)
{
    return a < b ? a : b;
}

SPH__INLINE double most(double a, double b)
{
    return a > b ? a : b;
}

/* What comes of a lane, with 64 bits. */
typedef struct __attribute__((aligned(64))) exact {
    double direction[3][AIM], per_length[AIM], reach[AIM];
} exact;

/* Cuts [enter, leave] to the slab |x| <= half, along one axis. A way of nothing is in it or beside it. */
SPH__INLINE void cut(double from, double way, double half, double *enter, double *leave)
{
    const double inverse = 1 / (fabs(way) > 1e-290 ? way : 1.0);
    const double a = (-half - from) * inverse, b = (half - from) * inverse;
    const double still = fabs(from) > half ? 4.0 : 0.0;
    *enter = most(*enter, fabs(way) > 1e-290 ? least(a, b) : still);
    *leave = least(*leave, fabs(way) > 1e-290 ? most(a, b) : 1.0);
}

/* How near something of this radius counts as touching: more than all rounding. */
SPH__INLINE double reach_of(const double from[3], const double way[3], double radius)
{
    const double far = most(fabs(from[0]), most(fabs(from[1]), fabs(from[2])));
    const double long_way = most(fabs(way[0]), most(fabs(way[1]), fabs(way[2])));
    return radius + (2e-6 * (1 + radius) + 1e-15 * (far + long_way));
}

SPH__INLINE void cut_lane(sph__query_aim *aim, exact *e, const double half[3], int i)
{
    const double from[3] = {aim->from[0][i], aim->from[1][i], aim->from[2][i]};
    const double way[3] = {aim->way[0][i], aim->way[1][i], aim->way[2][i]};
    const double reach = reach_of(from, way, aim->radius[i]);
    double enter = 0, leave = 1;
    for (int k = 0; k < 3; ++k)
        cut(from[k], way[k], half[k] + reach, &enter, &leave);
    aim->start[i] = enter;
    aim->span[i] = enter <= leave ? leave - enter : -1.0;
    e->reach[i] = reach;
}

/* What bounds need; nothing so big that 32 bits would not tell places apart is kept from any of them. */
SPH__INLINE void narrow_lane(sph__query_aim *aim, const exact *e, int k, int i)
{
    const double start = aim->from[k][i] + aim->start[i] * aim->way[k][i];
    const float slope = (float)(aim->span[i] * aim->way[k][i]), width = (float)e->reach[i];
    aim->above[k][i] = width < 1e3f ? (float)(start + e->reach[i]) : 1e30f;
    aim->below[k][i] = width < 1e3f ? (float)(start - e->reach[i]) : -1e30f;
    aim->inverse[k][i] = 1 / (width < 1e3f ? slope + copysignf(1e-18f, slope) : copysignf(1.0f, slope));
    aim->place[k][i] = width < 1e3f ? (float)start : 0.0f;
    aim->slope[k][i] = width < 1e3f ? slope : 0.0f;
}

SPH__INLINE void direct_lane(const sph__query_aim *aim, exact *e, int i)
{
    const double rest[3] = {aim->span[i] * aim->way[0][i], aim->span[i] * aim->way[1][i],
                            aim->span[i] * aim->way[2][i]};
    const double whole = sqrt(rest[0] * rest[0] + rest[1] * rest[1] + rest[2] * rest[2]);
    const double width = (float)e->reach[i], length = width < 1e3 ? whole : 0.0;
    const double inverse = 1 / (length > 1e-12 ? length : 1.0);
    for (int k = 0; k < 3; ++k)
        e->direction[k][i] = length > 1e-12 ? rest[k] * inverse : (k == 0 ? 1.0 : 0.0);
    e->per_length[i] = length > 1e-12 ? inverse : 0.0;
}

SPH__INLINE float narrow_reach(double reach)
{
    return (float)reach < 1e3f ? (float)reach : SPH__QUERY_FAR;
}

/* In loops over doubles alone and over floats, each in as wide vectors as there are. */
SPH__INLINE void aim_lanes(sph__query_aim *aim, const double half[3])
{
    exact e;
    for (int i = 0; i < AIM; ++i)
        cut_lane(aim, &e, half, i);
    for (int i = 0; i < AIM; ++i)
        direct_lane(aim, &e, i);
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < AIM; ++i)
            narrow_lane(aim, &e, k, i);
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < AIM; ++i)
            aim->direction[k][i] = (float)e.direction[k][i];
    for (int i = 0; i < AIM; ++i) {
        aim->per_length[i] = (float)e.per_length[i];
        aim->reach[i] = narrow_reach(e.reach[i]);
    }
}

_Static_assert(sizeof(sph_sweep) == sizeof(sph__query_v8f), "a sweep is a row");

SPH__CLONES static void aim_clones(sph__query_aim *aim, const sph__query_room *room, const sph_sweep *sweeps,
                                   const uint16_t *which)
{
#define SWEEP(i) &sweeps[which[at + (i)]]
#define COLUMN(i)                                                                                                      \
    (((i) < 3 ? aim->place[(i) % 3] : (i) < 6 ? aim->direction[(i) % 3] : (i) == 6 ? aim->per_length : aim->reach) + at)
#define LINE(i) &aim->lines[at + (i)]
    float __attribute__((aligned(64))) ends[8][AIM];
    const double half[3] = {room->half[0], room->half[1], room->half[2]}, scale = room->scale;
    for (int at = 0; at < AIM; at += 8)
        SPH__QUERY_TRANSPOSE(SWEEP, ends[0] + at, ends[1] + at, ends[2] + at, ends[3] + at, ends[4] + at, ends[5] + at,
                             ends[6] + at, ends[7] + at);
    for (int k = 0; k < 3; ++k) {
        const double origin = room->origin[k];
        for (int i = 0; i < AIM; ++i) {
            const double from = (ends[k][i] - origin) * scale, to = (ends[3 + k][i] - origin) * scale;
            aim->from[k][i] = from;
            aim->way[k][i] = to - from;
        }
    }
    for (int i = 0; i < AIM; ++i)
        aim->radius[i] = ends[6][i] * scale;
    aim_lanes(aim, half);
    for (int at = 0; at < AIM; at += 8)
        SPH__QUERY_TRANSPOSE(COLUMN, LINE(0), LINE(1), LINE(2), LINE(3), LINE(4), LINE(5), LINE(6), LINE(7));
}

void sph__query_aim_sweeps(sph__query_aim *aim, const sph__query_room *room, const sph_sweep *sweeps,
                           const uint16_t which[SPH__QUERY_AIM])
{
    aim_clones(aim, room, sweeps, which);
}

#define EIGHT(of) ((sph__v8d){of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)})
#define BEFORE(i) cuts[i]->before
#define SPAN(i) cuts[i]->span

SPH__CLONES static void moves_clones(sph__query_moves *m, uint32_t at, const sph__query_room *room,
                                     const sph_sweep *const *sweeps, const sph__query_cut *const *cuts)
{
    float __attribute__((aligned(64))) ends[8][8];
    double __attribute__((aligned(64))) before[8], span[8];
    const double scale = room->scale;
#define ROW(i) sweeps[i]
    SPH__QUERY_TRANSPOSE(ROW, ends[0], ends[1], ends[2], ends[3], ends[4], ends[5], ends[6], ends[7]);
    *(sph__v8d *)before = EIGHT(BEFORE); /* as a whole: what is written in pieces is slow to read so */
    *(sph__v8d *)span = EIGHT(SPAN);
    for (int k = 0; k < 3; ++k) {
        const double origin = room->origin[k];
        for (uint32_t i = 0; i < 8; ++i) {
            const double from = (ends[k][i] - origin) * scale, to = (ends[3 + k][i] - origin) * scale, way = to - from;
            m->start[k][at + i] = from + before[i] * way;
            m->way[k][at + i] = span[i] * way;
        }
    }
    for (uint32_t i = 0; i < 8; ++i) {
        const double radius = ends[6][i] * scale;
        m->radius[at + i] = radius;
        m->tolerance[at + i] = 1e-14 * (1 + radius);
    }
    for (uint32_t i = at; i < at + 8; ++i)
        m->squared[i] = m->way[0][i] * m->way[0][i] + m->way[1][i] * m->way[1][i] + m->way[2][i] * m->way[2][i];
}

void sph__query_aim_moves(sph__query_moves *moves, uint32_t at, const sph__query_room *room,
                          const sph_sweep *const sweeps[8], const sph__query_cut *const cuts[8])
{
    moves_clones(moves, at, room, sweeps, cuts);
}

bool sph__query_aim_one(sph__query_aim *aim, const sph__query_room *room, const double from[3], const double to[3],
                        double radius)
{
    double enter = 0, leave = 1, way[3];
    exact e;
    for (int k = 0; k < 3; ++k) {
        aim->from[k][0] = from[k];
        aim->way[k][0] = way[k] = to[k] - from[k];
    }
    aim->radius[0] = radius;
    e.reach[0] = reach_of(from, way, radius);
    aim->start[0] = 0;
    aim->span[0] = -1;
    for (int k = 0; k < 3; ++k) {
        cut(from[k], way[k], room->half[k] + e.reach[0], &enter, &leave);
        if (!(enter <= leave)) return false;
    }
    aim->start[0] = enter;
    aim->span[0] = leave - enter;
    for (int k = 0; k < 3; ++k)
        narrow_lane(aim, &e, k, 0);
    aim->reach[0] = narrow_reach(e.reach[0]);
    return true;
}

void sph__query_aim_line(const sph__query_aim *aim, sph__query_line *line)
{
    exact e;
    e.reach[0] = aim->reach[0];
    direct_lane(aim, &e, 0);
    for (int k = 0; k < 3; ++k) {
        line->from[k] = aim->place[k][0];
        line->direction[k] = (float)e.direction[k][0];
    }
    line->per_length = (float)e.per_length[0];
    line->reach = aim->reach[0];
}

/* All exponents but those of what is not finite are less than this; a radius has no sign. */
SPH__CLONES static uint32_t check_clones(const uint32_t *words, size_t count)
{
    static const uint32_t MASKS[8] = {0x7fffffffu, 0x7fffffffu, 0x7fffffffu, 0x7fffffffu,
                                      0x7fffffffu, 0x7fffffffu, 0xffffffffu, 0};
    uint32_t most_of[8] = {0}, found = 0;
    for (size_t i = 0; i < count; ++i)
        for (int l = 0; l < 8; ++l) {
            const uint32_t word = words[8 * i + (size_t)l] & MASKS[l];
            most_of[l] = word > most_of[l] ? word : most_of[l];
        }
    for (int l = 0; l < 8; ++l)
        found = most_of[l] > found ? most_of[l] : found;
    return found;
}

bool sph__query_aim_check(const sph_sweep *sweeps, size_t count)
{
    return count == 0 || check_clones((const uint32_t *)(const void *)sweeps, count) < 0x7f800000u;
}
