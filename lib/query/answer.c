/* SPDX-License-Identifier: MIT */
/* What casts have hit, told to the caller: places side by side, as one alone would wait for roots and divisions. */
#include "numeric/vector.h"
#include "query/packet.h"

enum { LANES = SPH__QUERY_TABLE };

typedef sph__query_packet packet;

SPH__CLONES static void clear_clones(sph_hit *hits, uint32_t count)
{
    static const sph_hit OPEN = {.s = 1, .contact = {.spheres = {SPH_NO_SPHERE, SPH_NO_SPHERE, SPH_NO_SPHERE}}};
    for (uint32_t i = 0; i < count; ++i)
        hits[i] = OPEN;
}

/* Where a cast ends. */
static inline double time_of(const sph__query_cast *c)
{
    return sph__query_pick(c->value > 0, c->value, 0);
}

static void tell(const packet *p, uint32_t number, const sph__query_places *places, uint32_t i, sph_hit *hit)
{
    const sph_query *q = p->query;
    const sph__query_cast *c = &p->casts[number];
    const double at = c->cut.before + time_of(c) * c->cut.span;
    sph__contact contact;
    hit->s = sph__query_pick(at < 1, at, 1);
    hit->depth = sph__query_pick(c->value < 0, -c->value * q->unit, 0);
    hit->hit = 1;
    for (int k = 0; k < 3; ++k) {
        contact.point[k] = places->point[k][i];
        contact.normal[k] = places->normal[k][i];
        contact.weights[k] = places->weights[k][i];
    }
    if (!(places->squared[i] > 1e-8)) { /* the direction would be noise */
        const double x[3] = {places->x[0][i], places->x[1][i], places->x[2][i]};
        sph__primitive_closest(&q->solid.primitives[c->slot], x, &contact);
    }
    sph__query_contact(q, c->slot, &contact, &hit->contact);
}

/* Those of up to LANES casts. */
static void answer(const packet *p, const uint8_t *which, uint32_t count, sph_hit *hits)
{
    const sph_query *q = p->query;
    uint32_t slots[LANES];
    sph__query_moves moves;
    sph__query_places places;
    sph__query_packet_moves(p, which, count, &moves);
    for (uint32_t i = 0; i < count; ++i) {
        const sph__query_cast *c = &p->casts[which[i]];
        const double t = time_of(c);
        for (int k = 0; k < 3; ++k)
            places.x[k][i] = moves.start[k][i] + t * moves.way[k][i];
        slots[i] = c->slot;
    }
    sph__query_fan_closest(q->fans, slots, q->solid.corner_counts, &places, count);
    for (uint32_t i = 0; i < count; ++i)
        tell(p, which[i], &places, i, &hits[p->sweep[which[i]]]);
}

void sph__query_packet_answer(const packet *p, sph_hit *hits, uint32_t count)
{
    uint8_t which[SPH__QUERY_WAVE];
    uint32_t those = 0;
    clear_clones(hits, count);
    for (uint32_t i = 0; i < p->count; ++i) {
        which[those] = (uint8_t)i;
        those += (uint32_t)sph__query_opaque(p->casts[i].slot != UINT32_MAX);
    }
    for (uint32_t i = 0; i < those; i += LANES)
        answer(p, which + i, those - i < LANES ? those - i : LANES, hits);
}
