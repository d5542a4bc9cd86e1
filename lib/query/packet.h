/* SPDX-License-Identifier: MIT */
/* Casts that are worked on side by side. */
#ifndef SPH_QUERY_PACKET_H
#define SPH_QUERY_PACKET_H

#include "query/query.h"
#include "query/step.h"

enum {
    SPH__QUERY_PAIRS = 512, /* of casts with primitives, at a time; SPH__QUERY_CHUNK and more */
    SPH__QUERY_NO_PAIR = 0xffff,
    SPH__QUERY_MANY = 512,
    SPH__QUERY_SWEEPS = 4096 /* at a time; numbers fit into two bytes */
};

/* One cast, in the frame of the pose, cut to where the segment is near the solid: s = before + t * span. */
typedef struct sph__query_cast {
    double before, span; /* a span below 0: it is not near */
    /* the best so far: t where it touches; at 0 or below minus the depth in which it begins. Least is best, and of
     * equal ones that with the lowest number */
    double value;
    uint32_t slot, number; /* UINT32_MAX: none */
} sph__query_cast;

/* What has been listed for a cast: the first primitive, and a list of the others. */
typedef struct sph__query_front {
    sph__query_listed first;
    uint32_t second; /* the least rank of the others */
    uint16_t others; /* SPH__QUERY_NO_PAIR ends a list */
} sph__query_front;

typedef struct sph__query_packet {
    const sph_query *query;
    const sph_sweep *sweeps;         /* NULL: */
    const double *from, *to;         /* a ray in the frame */
    bool any;                        /* any hit will do */
    uint32_t count, pair_count;      /* of the casts, and in `pairs` */
    uint16_t sweep[SPH__QUERY_WAVE]; /* that a cast is of */
    sph__query_cast casts[SPH__QUERY_WAVE];
    sph__query_front fronts[SPH__QUERY_WAVE];
    sph__query_listed pairs[SPH__QUERY_PAIRS + 1];
    uint16_t next[SPH__QUERY_PAIRS + 1];
} sph__query_packet;

static const sph__query_front sph__query_front_empty = {SPH__QUERY_UNLISTED, UINT32_MAX, SPH__QUERY_NO_PAIR};

/* Without branches: what comes is anybody's guess. */
static inline void sph__query_packet_list(sph__query_packet *p, uint32_t cast, sph__query_listed it)
{
    sph__query_front *f = &p->fronts[cast];
    const sph__query_listed before = f->first, other = it < before ? before : it;
    const uint32_t place = p->pair_count, others = f->others, rank = (uint32_t)(other >> 32);
    const uint32_t counts = (uint32_t)sph__query_opaque(other <= SPH__QUERY_LAST_LISTED);
    f->first = it < before ? it : before;
    f->second = rank < f->second ? rank : f->second;
    p->pairs[place] = other;
    p->next[place] = (uint16_t)others;
    f->others = (uint16_t)(others + (place - others) * counts);
    p->pair_count = place + counts;
}

/* What comes after this does not matter; below 0: nothing does any more. */
static inline double sph__query_packet_limit(const sph__query_packet *p, const sph__query_cast *c)
{
    if (p->any && c->slot != UINT32_MAX) return -1;
    return c->value > 1 ? 1 : c->value > 0 ? c->value : 0;
}

/* The cut segment of a cast. */
void sph__query_packet_move(const sph__query_packet *p, uint32_t cast, sph__query_move *move);

/* Nothing has touched yet. */
void sph__query_cast_begin(sph__query_cast *cast, const sph__query_aim *aim, uint32_t lane);
sph__query_room sph__query_packet_room(const sph__query_packet *p);

/*
 * Casts sweeps until it has had them all, or some thousand, or the packet is full: only those that may touch become
 * casts of it. Returns how many it has had. For up to SPH__QUERY_MANY primitives, and no tree.
 */
uint32_t sph__query_packet_many(sph__query_packet *p, size_t count);

/* Lets all that is listed have its say, and drops it; all is of casts [begin, end). */
void sph__query_packet_resolve(sph__query_packet *p, uint32_t begin, uint32_t end);

#endif
