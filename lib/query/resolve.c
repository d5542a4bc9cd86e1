/* SPDX-License-Identifier: MIT */
/*
 * Which of the listed primitives a cast touches first. Along a segment the signed distance to a convex primitive, less
 * the radius of what moves, is convex; so Newton's method from before the first root climbs down to it and never passes
 * it, whatever the primitive degenerates to (approach.c). The most promising primitive of each cast has the first turn,
 * and mostly shows all others to be later.
 */
#include <math.h>

#include "numeric/vector.h"
#include "query/packet.h"

enum {
    LANES = SPH__QUERY_TABLE,
    MOVES_FROM = 3 /* so many are made ready side by side */
};

typedef sph__query_packet packet;
typedef sph__query_cast cast;

static void set_move(const packet *p, const cast *c, uint32_t number, sph__query_moves *m, uint32_t i)
{
    double from[3], to[3], way[3], radius = 0;
    if (p->sweeps != NULL) {
        const sph_sweep *w = &p->sweeps[p->sweep[number]];
        sph__query_to_frame(p->query, (const double[3]){w->from[0], w->from[1], w->from[2]}, from);
        sph__query_to_frame(p->query, (const double[3]){w->to[0], w->to[1], w->to[2]}, to);
        radius = w->radius * p->query->scale;
    } else {
        sph__copy3(p->from, from);
        sph__copy3(p->to, to);
    }
    sph__subtract(to, from, way);
    for (int k = 0; k < 3; ++k) {
        m->start[k][i] = from[k] + c->cut.before * way[k];
        m->way[k][i] = way[k] = c->cut.span * way[k];
    }
    m->radius[i] = radius;
    m->squared[i] = sph__dot(way, way);
    m->tolerance[i] = 1e-14 * (1 + radius);
}

void sph__query_packet_moves(const packet *p, const uint8_t *numbers, uint32_t count, sph__query_moves *m)
{
    const bool are_few = count < MOVES_FROM || p->sweeps == NULL;
    sph__query_room room;
    for (uint32_t i = 0; i < count && are_few; ++i)
        set_move(p, &p->casts[numbers[i]], numbers[i], m, i);
    if (are_few) return;
    room = sph__query_packet_room(p);
    for (uint32_t at = 0; at < count; at += 8) {
        const sph_sweep *sweeps[8];
        const sph__query_cut *cuts[8];
        for (uint32_t i = 0; i < 8; ++i) {
            const uint32_t number = numbers[at + i < count ? at + i : count - 1];
            sweeps[i] = &p->sweeps[p->sweep[number]];
            cuts[i] = &p->casts[number].cut;
        }
        sph__query_aim_moves(m, at, &room, sweeps, cuts);
    }
}

/* What has touched in a lane may be the best of its cast. */
static inline void improve(const sph_query *q, cast *c, const sph__query_table *t, uint32_t i)
{
    const int is_within = (t->t[i] <= 0) & (t->distance[i] < 0) & (c->cut.before <= 0);
    const double value = sph__query_pick(is_within, t->distance[i], t->t[i]);
    const uint32_t slot = t->slot[i], best = sph__query_pick_number(c->slot != UINT32_MAX, c->slot, slot);
    const int is_less = (value == c->value) & (q->numbers[slot] < q->numbers[best]);
    const int is_better = (t->touches[i] != 0) & ((value < c->value) | is_less);
    c->value = sph__query_pick(is_better, value, c->value);
    c->slot = sph__query_pick_number(is_better, slot, c->slot);
}

static inline int is_open(const packet *p, const cast *c)
{
    return !(p->any & (c->slot != UINT32_MAX));
}

/* Does one that has not touched yet, but may from t on? */
static inline uint32_t may_touch(const packet *p, const cast *c, double t)
{
    return (uint32_t)sph__query_opaque((t <= 1) & ((t <= c->value) | (t <= 0)) & is_open(p, c));
}

/* A step for up to LANES pairs; keeps in the list those that need another one, and returns how many. */
static uint32_t step(packet *p, const uint16_t *pairs, uint32_t count, uint16_t *kept)
{
    uint8_t casts[LANES];
    sph__query_moves moves;
    sph__query_table table;
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t pair = pairs[i];
        const double key = p->key[pair];
        casts[i] = p->owner[pair];
        table.t[i] = sph__query_pick(key > 0, key, 0);
        table.slot[i] = p->slot[pair];
    }
    sph__query_packet_moves(p, casts, count, &moves);
    sph__query_fan_step(p->query->fans, &moves, &table, count);
    for (uint32_t i = 0; i < count; ++i) {
        const uint16_t pair = pairs[i];
        cast *c = &p->casts[casts[i]];
        improve(p->query, c, &table, i);
        p->key[pair] = table.t[i];
        kept[left] = pair;
        left += (table.touches[i] == 0) & may_touch(p, c, table.t[i]);
    }
    return left;
}

/* Newton's method, step by step for all of a list. */
static void climb(packet *p, uint16_t *pairs, uint32_t count)
{
    for (int steps = 0; count > 0 && steps < SPH__QUERY_STEPS; ++steps) {
        uint32_t left = 0;
        for (uint32_t i = 0; i < count; i += LANES)
            left += step(p, pairs + i, count - i < LANES ? count - i : LANES, pairs + left);
        count = left;
    }
}

/* Of the pairs that still make a difference those that are the first ones of their casts, or the others. */
static uint32_t choose(const packet *p, int are_first, uint16_t *pairs)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->pair_count; ++i) {
        const uint32_t owner = p->owner[i];
        const cast *c = &p->casts[owner];
        const int is_first = sph__query_opaque(p->first[owner] == i);
        const int matters = sph__query_opaque((p->key[i] <= c->value) & is_open(p, c));
        pairs[count] = (uint16_t)i;
        count += (uint32_t)((is_first == are_first) & matters);
    }
    return count;
}

void sph__query_packet_resolve(packet *p)
{
    uint16_t pairs[SPH__QUERY_PAIRS + 1];
    if (p->pair_count == 0) return;
    climb(p, pairs, choose(p, 1, pairs));
    climb(p, pairs, choose(p, 0, pairs));
    for (uint32_t i = 0; i < p->pair_count; ++i)
        p->first[p->owner[i]] = SPH__QUERY_PAIRS;
    p->pair_count = 0;
}
