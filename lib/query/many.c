/* SPDX-License-Identifier: MIT */
/* Many casts together, stage by stage: which of them may touch which primitives (sieve.h, wave.h). */
#include <float.h>
#include <string.h>

#include "numeric/vector.h"
#include "query/packet.h"
#include "query/sieve.h"

enum { AIM = SPH__QUERY_AIM, SLOTS = SPH__QUERY_SLOTS };

typedef sph__query_packet packet;

void sph__query_cast_begin(sph__query_cast *c, const sph__query_aim *aim, uint32_t lane)
{
    c->cut.before = aim->start[lane];
    c->cut.span = aim->span[lane];
    c->value = 2;
    c->slot = UINT32_MAX;
}

sph__query_room sph__query_packet_room(const packet *p)
{
    sph__query_room room = {.scale = p->query->scale};
    sph__copy3(p->query->origin, room.origin);
    sph__copy3(p->query->half, room.half);
    return room;
}

/* What they share. */
typedef struct wave {
    packet *packet;
    sph__query_room room;
    uint32_t leaf; /* the first of those whose turn it is */
    bool is_all;   /* there are no others */
    bool begins;   /* within which are those that wait? */
    uint32_t turn; /* of those called: who will be called next; the others are to be listed, or have been */
    sph__query_called called[2];
    sph__query_line lines[SPH__QUERY_WAVE];
    /* places of primitives whose bounds are met, or begun in, and that have not been looked at */
    uint64_t met[SPH__QUERY_WAVE], begun[SPH__QUERY_WAVE];
    uint8_t waiting[SLOTS], queue[SLOTS][SPH__QUERY_SIDE];
    sph__query_sieved sieved;
} wave;

/* --- who waits for a primitive --- */

/* Lists those called who touch, or begin within. About the latter nothing else is to be found out. */
static void list(wave *w, sph__query_called *called)
{
    packet *p = w->packet;
    if (p->pair_count + SPH__QUERY_SIDE > SPH__QUERY_PAIRS) sph__query_packet_resolve(p);
    for (uint32_t listed = called->listed; listed != 0; listed &= listed - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(listed), number = called->which[i];
        w->met[number] &= ~((uint64_t)w->begins << called->place);
        sph__query_packet_list(p, number, called->keys[i], called->slot, 1);
    }
    called->listed = 0;
}

/* Calls those that wait at a place, and lists those who have been called before: their keys are known by now, and with
 * them how many there are to list. */
static void call(wave *w, uint32_t place)
{
    const sph_query *q = w->packet->query;
    sph__query_called *called = &w->called[w->turn];
    called->place = place;
    called->slot = q->twigs[2 * (w->leaf + place / SPH__QUERY_LANES)] + place % SPH__QUERY_LANES;
    called->count = w->waiting[place];
    if (w->begins)
        sph__query_wave_begin(&q->parts[called->slot], w->lines, w->queue[place], called);
    else
        sph__query_wave_touch(&q->parts[called->slot], w->lines, w->queue[place], called);
    memcpy(called->which, w->queue[place], sizeof called->which);
    w->waiting[place] = 0;
    w->turn ^= 1;
    list(w, &w->called[w->turn]);
}

/*
 * Lets casts wait at all places in their masks, none of which is 0: at the first one each, then at the next, so that no
 * step waits for the one before. Both lists are used up.
 */
static void wait(wave *w, uint8_t *numbers, uint64_t *masks, uint32_t count)
{
    while (count > 0) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const uint64_t mask = masks[i], rest = mask & (mask - 1);
            const uint32_t place = (uint32_t)__builtin_ctzll(mask), waiting = w->waiting[place];
            const uint8_t number = numbers[i];
            w->queue[place][waiting] = number;
            w->waiting[place] = (uint8_t)(waiting + 1);
            numbers[kept] = number;
            masks[kept] = rest;
            kept += (uint32_t)sph__query_opaque(rest != 0);
            if (waiting + 1 == SPH__QUERY_SIDE) call(w, place);
        }
        count = kept;
    }
}

/* Everybody who still waits has a turn. */
static void call_all(wave *w)
{
    for (uint32_t place = 0; place < SLOTS; ++place)
        if (w->waiting[place] > 0) call(w, place);
    list(w, &w->called[w->turn ^ 1]);
}

/* --- the leaves whose turn it is --- */

/* The boxes that segments side by side meet, and in which they begin. */
typedef struct together {
    sph__query_aim aim;
    uint64_t met[AIM], begun[AIM];
    uint16_t which[AIM];
} together;

static void meet(wave *w, together *t, const uint32_t *leaves, uint32_t here)
{
    const sph_query *q = w->packet->query;
    uint64_t all = 0;
    for (uint32_t lane = 0; lane < here; ++lane)
        all |= (uint64_t)(leaves[lane] >> w->leaf & 15) << (SPH__QUERY_LEAVES * lane);
    sph__query_aim_sweeps(&t->aim, &w->room, w->packet->sweeps, t->which);
    sph__query_wave_meet(q->leaf_bounds + w->leaf, &t->aim, all, t->met, t->begun);
}

/* Takes up `here` sweeps that the sieve has left, from number `first` of them on. */
__attribute__((noinline)) static void take_up(wave *w, uint32_t first, uint32_t here)
{
    packet *p = w->packet;
    together t;
    for (uint32_t lane = 0; lane < AIM; ++lane)
        t.which[lane] = w->sieved.which[first + (lane < here ? lane : here - 1)];
    meet(w, &t, w->sieved.leaves + first, here);
    for (uint32_t lane = 0; lane < here; ++lane) { /* what may touch nothing is overwritten by the next one */
        const uint32_t number = p->count;
        sph__query_cast_begin(&p->casts[number], &t.aim, lane);
        w->lines[number] = t.aim.lines[lane];
        w->met[number] = t.met[lane];
        w->begun[number] = t.begun[lane];
        p->first[number] = SPH__QUERY_PAIRS;
        p->casts[number].leaves = w->sieved.leaves[first + lane];
        p->sweep[number] = t.which[lane];
        p->count += w->is_all ? t.met[lane] != 0 : t.aim.span[lane] >= 0;
    }
}

/* The casts of the packet from `first` on, as many as go side by side, and later leaves. */
__attribute__((noinline)) static void take_again(wave *w, uint32_t first)
{
    packet *p = w->packet;
    const uint32_t here = p->count - first < AIM ? p->count - first : AIM;
    uint32_t leaves[AIM];
    together t;
    for (uint32_t lane = 0; lane < AIM; ++lane) {
        const uint32_t number = first + (lane < here ? lane : here - 1);
        t.which[lane] = p->sweep[number];
        leaves[lane] = p->casts[number].leaves;
    }
    meet(w, &t, leaves, here);
    memcpy(w->met + first, t.met, here * sizeof *w->met);
    memcpy(w->begun + first, t.begun, here * sizeof *w->begun);
}

/* Those that are in `masks`, and to which something may still matter, have their turn. */
static void look_at(wave *w, uint64_t *masks, double from)
{
    packet *p = w->packet;
    uint8_t numbers[SPH__QUERY_WAVE];
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->count; ++i) {
        const uint64_t mask = masks[i];
        numbers[count] = (uint8_t)i;
        masks[count] = mask;
        count += (uint32_t)sph__query_opaque((mask != 0) & (sph__query_packet_limit(p, &p->casts[i]) >= from));
    }
    wait(w, numbers, masks, count);
    call_all(w);
    sph__query_packet_resolve(p);
}

/* First what they begin within, which mostly is the answer where there is anything; then what is ahead. */
static void look_around(wave *w)
{
    w->begins = true;
    look_at(w, w->begun, 0);
    w->begins = false;
    look_at(w, w->met, DBL_MIN);
}

/* Takes up what is near of the next sweeps; returns how many it has had, with room for as many as there are, all. */
static uint32_t take_sweeps(wave *w, uint32_t first, uint32_t count)
{
    const sph_query *q = w->packet->query;
    const sph__query_sieved *sieved = &w->sieved;
    sph__query_sieve(&w->sieved, &w->room, w->packet->sweeps, first, count, q->twig_boxes, q->leaf_count);
    for (uint32_t i = 0; i < sieved->count; i += AIM) {
        if (w->packet->count + AIM > SPH__QUERY_WAVE) return sieved->which[i] - first;
        take_up(w, i, sieved->count - i < AIM ? sieved->count - i : AIM);
    }
    return count;
}

uint32_t sph__query_packet_many(packet *p, size_t count)
{
    const uint32_t leaves = p->query->leaf_count;
    const uint32_t most = count < SPH__QUERY_SWEEPS ? (uint32_t)count : SPH__QUERY_SWEEPS;
    uint32_t had = 0, here, taken;
    wave w;
    w.packet = p;
    w.room = sph__query_packet_room(p);
    w.leaf = w.turn = 0;
    w.called[0].listed = w.called[1].listed = 0;
    w.is_all = leaves <= SPH__QUERY_LEAVES;
    memset(w.waiting, 0, sizeof w.waiting);
    memset(w.queue, 0, sizeof w.queue); /* what is beyond those that wait is somebody, too */
    memset(&w.lines[0], 0, sizeof w.lines[0]);
    p->count = 0;
    do {
        here = most - had < SPH__QUERY_SIEVED ? most - had : SPH__QUERY_SIEVED;
        taken = take_sweeps(&w, had, here);
        had += taken;
    } while (taken == here && had < most);
    look_around(&w);
    for (w.leaf = SPH__QUERY_LEAVES; w.leaf < leaves; w.leaf += SPH__QUERY_LEAVES) {
        for (uint32_t i = 0; i < p->count; i += AIM)
            take_again(&w, i);
        look_around(&w);
    }
    return had;
}
