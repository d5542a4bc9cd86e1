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

enum { LANES = SPH__QUERY_TABLE };

typedef sph__query_packet packet;
typedef sph__query_cast cast;

/* Casts whose turn it is, side by side, each with a primitive that it may touch. */
typedef struct company {
    packet *packet;
    uint32_t next, count;           /* in `turns` */
    uint8_t turns[SPH__QUERY_WAVE]; /* casts whose turn comes */
    uint8_t cast[LANES], steps[LANES];
    sph__query_move moves[LANES];
    sph__query_table table;
} company;

void sph__query_packet_move(const packet *p, uint32_t number, sph__query_move *m)
{
    const sph_query *q = p->query;
    const cast *c = &p->casts[number];
    double from[3], to[3], way[3], radius = 0;
    if (p->sweeps != NULL) {
        const sph_sweep *w = &p->sweeps[p->sweep[number]];
        sph__query_to_frame(q, (const double[3]){w->from[0], w->from[1], w->from[2]}, from);
        sph__query_to_frame(q, (const double[3]){w->to[0], w->to[1], w->to[2]}, to);
        radius = w->radius * q->scale;
    } else {
        sph__copy3(p->from, from);
        sph__copy3(p->to, to);
    }
    sph__subtract(to, from, way);
    for (int k = 0; k < 3; ++k) {
        m->start[k] = from[k] + c->before * way[k];
        m->way[k] = c->span * way[k];
    }
    m->radius = radius;
    m->squared = sph__dot(m->way, m->way);
    m->tolerance = 1e-14 * (1 + radius);
}

/* What has touched in a lane may be the best of its cast. */
static inline void improve(const sph_query *q, cast *c, const sph__query_table *t, uint32_t i)
{
    const int is_within = (t->t[i] <= 0) & (t->distance[i] < 0) & (c->before <= 0);
    const double value = sph__query_pick(is_within, t->distance[i], t->t[i]);
    const uint32_t slot = t->slot[i], number = q->numbers[slot];
    const int is_better = (t->touches[i] != 0) & ((value < c->value) | ((value == c->value) & (number < c->number)));
    c->value = sph__query_pick(is_better, value, c->value);
    c->slot = sph__query_pick_number(is_better, slot, c->slot);
    c->number = sph__query_pick_number(is_better, number, c->number);
}

/* Does what is listed still make a difference? */
static inline bool matters(const packet *p, const cast *c, sph__query_listed it)
{
    const int is_open = !(p->any & (c->slot != UINT32_MAX));
    return sph__query_opaque((it <= SPH__QUERY_LAST_LISTED) & (sph__query_key_of(it) <= c->value) & is_open);
}

/* Does a lane that has not touched yet, but may from t on? */
static inline bool may_touch(const packet *p, const cast *c, double t)
{
    const int is_open = !(p->any & (c->slot != UINT32_MAX));
    return sph__query_opaque((t <= 1) & ((t <= c->value) | (t <= 0)) & is_open);
}

/* Takes the first of the others from the list of a cast. */
static sph__query_listed take(packet *p, uint32_t number)
{
    sph__query_front *front = &p->fronts[number];
    sph__query_listed first = SPH__QUERY_UNLISTED, second = SPH__QUERY_UNLISTED;
    uint16_t last = SPH__QUERY_NO_PAIR;
    for (uint16_t pair = front->others; pair != SPH__QUERY_NO_PAIR;) {
        const uint16_t next = p->next[pair];
        const sph__query_listed it = p->pairs[pair], other = it < first ? first : it;
        p->pairs[pair] = other; /* what is taken bubbles up, and leaves its place */
        p->next[pair] = last;
        first = it < first ? it : first;
        second = other < second ? other : second;
        last = other > SPH__QUERY_LAST_LISTED ? last : pair;
        pair = next;
    }
    front->others = last;
    front->second = (uint32_t)(second >> 32);
    return first;
}

static inline void set_lane(company *now, uint32_t lane, sph__query_listed it)
{
    const float key = sph__query_key_of(it);
    now->table.t[lane] = sph__query_pick(key > 0, key, 0);
    now->table.slot[lane] = (uint32_t)it;
    now->steps[lane] = 0;
}

/* Gives a lane to the next cast; false: there is none. */
static bool fill(company *now, uint32_t lane)
{
    packet *p = now->packet;
    while (now->next < now->count) {
        const uint32_t number = now->turns[now->next++];
        if (!matters(p, &p->casts[number], p->fronts[number].first)) continue;
        now->cast[lane] = (uint8_t)number;
        sph__query_packet_move(p, number, &now->moves[lane]);
        set_lane(now, lane, p->fronts[number].first);
        return true;
    }
    return false;
}

static void copy_lane(company *now, uint32_t to, uint32_t from)
{
    now->cast[to] = now->cast[from];
    now->steps[to] = now->steps[from];
    now->moves[to] = now->moves[from];
    now->table.t[to] = now->table.t[from];
    now->table.distance[to] = now->table.distance[from];
    now->table.touches[to] = now->table.touches[from];
    now->table.slot[to] = now->table.slot[from];
}

/* After a step: is there more to do in the lane? */
static bool carry_on(company *now, uint32_t lane)
{
    packet *p = now->packet;
    const uint32_t number = now->cast[lane];
    cast *c = &p->casts[number];
    bool goes_on;
    improve(p->query, c, &now->table, lane);
    goes_on = (now->table.touches[lane] == 0) & may_touch(p, c, now->table.t[lane]);
    if (goes_on && ++now->steps[lane] < SPH__QUERY_STEPS) return true;
    if (matters(p, c, (sph__query_listed)p->fronts[number].second << 32)) {
        set_lane(now, lane, take(p, number));
        return true;
    }
    return fill(now, lane);
}

void sph__query_packet_resolve(packet *p, uint32_t begin, uint32_t end)
{
    company now;
    uint32_t count = 0;
    now.packet = p;
    now.next = now.count = 0;
    for (uint32_t i = begin; i < end; ++i) {
        now.turns[now.count] = (uint8_t)i;
        now.count += p->fronts[i].first <= SPH__QUERY_LAST_LISTED;
    }
    while (count < LANES && fill(&now, count))
        ++count;
    while (count > 0) {
        sph__query_fan_step(p->query->fans, now.moves, &now.table, count);
        for (uint32_t i = 0; i < count;) {
            if (carry_on(&now, i))
                ++i;
            else if (i < --count)
                copy_lane(&now, i, count);
        }
    }
    for (uint32_t i = 0; i < now.count; ++i)
        p->fronts[now.turns[i]] = sph__query_front_empty;
    p->pair_count = 0;
}
