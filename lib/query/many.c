/* SPDX-License-Identifier: MIT */
/* Many casts together: which of them may touch which primitives (wave.h). */
#include <string.h>

#include "numeric/vector.h"
#include "query/packet.h"

enum { AIM = SPH__QUERY_AIM, SLOTS = SPH__QUERY_SLOTS };

typedef sph__query_packet packet;

void sph__query_cast_begin(sph__query_cast *c, const sph__query_aim *aim, uint32_t lane)
{
    c->before = aim->start[lane];
    c->span = aim->span[lane];
    c->value = 2;
    c->slot = c->number = UINT32_MAX;
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
    uint32_t begin, count; /* the slots whose turn it is */
    uint32_t turn;         /* of the sides: that which is to be filled next; the other one is full, or empty */
    sph__query_side sides[2];
    sph__query_line lines[SPH__QUERY_WAVE];
    uint8_t waiting[SPH__QUERY_SLOTS], queue[SPH__QUERY_SLOTS][SPH__QUERY_SIDE];
} wave;

/* Lists those of a side that touch. */
static void touch(wave *w, sph__query_side *side)
{
    packet *p = w->packet;
    float __attribute__((aligned(64))) keys[SPH__QUERY_SIDE];
    if (side->count == 0) return;
    if (p->pair_count + SPH__QUERY_SIDE > SPH__QUERY_PAIRS) sph__query_packet_resolve(p, 0, p->count);
    sph__query_wave_touch(&p->query->parts[side->slot], &p->query->fans[side->slot], side, keys);
    for (uint32_t i = 0; i < side->count; ++i)
        sph__query_packet_list(p, side->which[i], sph__query_list(keys[i], side->slot));
    side->count = 0;
}

/* Calls those that wait for a primitive, and lets those have their turn that have been called before. */
static void call(wave *w, uint32_t place)
{
    sph__query_side *side = &w->sides[w->turn];
    side->slot = w->begin + place;
    side->count = w->waiting[place];
    memcpy(side->which, w->queue[place], sizeof side->which);
    w->waiting[place] = 0;
    sph__query_wave_gather(side, w->lines);
    w->turn ^= 1;
    touch(w, &w->sides[w->turn]);
}

/* Lets segments wait for the primitives whose boxes they meet. Bit by bit, without a guess at where a mask ends. */
static void wait(wave *w, const uint8_t *numbers, const uint64_t *masks, uint32_t count)
{
    uint64_t mask = masks[0];
    for (uint32_t i = 0; i < count;) {
        const uint32_t place = (uint32_t)__builtin_ctzll(mask), waiting = w->waiting[place];
        const uint64_t rest = mask & (mask - 1);
        const uint32_t ends = (uint32_t)sph__query_opaque(rest == 0);
        w->queue[place][waiting] = numbers[i];
        w->waiting[place] = (uint8_t)(waiting + 1);
        i += ends;
        mask = rest | (masks[i] & (0 - (uint64_t)ends));
        if (waiting + 1 == SPH__QUERY_SIDE) call(w, place);
    }
}

/* Everybody who still waits has a turn. */
static void call_all(wave *w)
{
    for (uint32_t place = 0; place < w->count; ++place)
        if (w->waiting[place] > 0) call(w, place);
    touch(w, &w->sides[w->turn ^ 1]);
}

/* Takes up `here` sweeps from number `first` on, and the slots whose turn it is: the first ones. */
__attribute__((noinline)) static void take_up(wave *w, const sph__query_room *room, uint32_t first, uint32_t here,
                                              bool is_all)
{
    packet *p = w->packet;
    uint64_t masks[AIM + 1];
    uint16_t which[AIM];
    uint8_t numbers[AIM];
    uint32_t count = 0;
    sph__query_aim aim;
    for (uint32_t lane = 0; lane < AIM; ++lane)
        which[lane] = (uint16_t)(first + (lane < here ? lane : here - 1));
    sph__query_aim_sweeps(&aim, room, p->sweeps, which);
    sph__query_wave_meet(&p->query->bounds, w->begin, w->count, &aim, masks);
    for (uint32_t lane = 0; lane < here; ++lane) { /* what may touch nothing is overwritten by the next one */
        const uint32_t number = p->count;
        sph__query_cast_begin(&p->casts[number], &aim, lane);
        w->lines[number] = aim.lines[lane];
        p->fronts[number] = sph__query_front_empty;
        p->sweep[number] = which[lane];
        numbers[count] = (uint8_t)number;
        masks[count] = masks[lane];
        count += masks[lane] != 0;
        p->count += is_all ? masks[lane] != 0 : aim.span[lane] >= 0;
    }
    masks[count] = 1;
    wait(w, numbers, masks, count);
}

/* The casts of the packet from `first` on, at most eight, and later slots. */
__attribute__((noinline)) static void take_again(wave *w, const sph__query_room *room, uint32_t first)
{
    packet *p = w->packet;
    const uint32_t here = p->count - first < AIM ? p->count - first : AIM;
    uint64_t masks[AIM + 1];
    uint16_t which[AIM];
    uint8_t numbers[AIM];
    uint32_t count = 0;
    sph__query_aim aim;
    for (uint32_t lane = 0; lane < AIM; ++lane)
        which[lane] = p->sweep[first + (lane < here ? lane : here - 1)];
    sph__query_aim_sweeps(&aim, room, p->sweeps, which);
    sph__query_wave_meet(&p->query->bounds, w->begin, w->count, &aim, masks);
    for (uint32_t lane = 0; lane < here; ++lane) {
        numbers[count] = (uint8_t)(first + lane);
        masks[count] = masks[lane];
        count += (masks[lane] != 0) & !(p->any && p->casts[first + lane].slot != UINT32_MAX);
    }
    masks[count] = 1;
    wait(w, numbers, masks, count);
}

uint32_t sph__query_packet_many(packet *p, size_t count)
{
    const uint32_t slots = p->query->primitive_count;
    const sph__query_room room = sph__query_packet_room(p);
    uint32_t had = 0;
    wave w;
    w.packet = p;
    w.begin = 0;
    w.count = slots < SLOTS ? slots : SLOTS;
    w.turn = w.sides[0].count = w.sides[1].count = 0;
    memset(w.waiting, 0, sizeof w.waiting);
    memset(w.queue, 0, sizeof w.queue); /* what is beyond those that wait is somebody, too */
    memset(&w.lines[0], 0, sizeof w.lines[0]);
    p->count = 0;
    while (had < count && had < SPH__QUERY_SWEEPS && p->count + AIM <= SPH__QUERY_WAVE) {
        const uint32_t here = count - had < AIM ? (uint32_t)(count - had) : AIM;
        take_up(&w, &room, had, here, slots <= SLOTS);
        had += here;
    }
    call_all(&w);
    for (w.begin = SLOTS; w.begin < slots; w.begin += SLOTS) {
        w.count = slots - w.begin < SLOTS ? slots - w.begin : SLOTS;
        for (uint32_t i = 0; i < p->count; i += AIM)
            take_again(&w, &room, i);
        call_all(&w);
    }
    sph__query_packet_resolve(p, 0, p->count);
    return had;
}
