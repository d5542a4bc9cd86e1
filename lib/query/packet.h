/* SPDX-License-Identifier: MIT */
/* Casts that are worked on side by side. */
#ifndef SPH_QUERY_PACKET_H
#define SPH_QUERY_PACKET_H

#include <float.h>

#include "query/query.h"
#include "query/step.h"

enum {
    SPH__QUERY_PAIRS = 448,  /* of casts with primitives, at a time; SPH__QUERY_CHUNK and more */
    SPH__QUERY_SWEEPS = 4096 /* at a time; numbers fit into two bytes */
};

/* One cast, in the frame of the pose, cut to where the segment is near the solid. */
typedef struct sph__query_cast {
    sph__query_cut cut;
    /* the best so far: t where it touches; at 0 or below minus the depth in which it begins. Least is best, and of
     * equal ones that with the lowest number */
    double value;
    uint32_t slot;   /* UINT32_MAX: none */
    uint32_t leaves; /* that it may meet, as bits */
} sph__query_cast;

/* Casts, and what has been listed of primitives that they may touch. */
typedef struct sph__query_packet {
    const sph_query *query;
    const sph_sweep *sweeps;         /* NULL: */
    const double *from, *to;         /* a ray in the frame */
    bool any;                        /* any hit will do */
    uint32_t count, pair_count;      /* of the casts, and of the pairs */
    uint16_t sweep[SPH__QUERY_WAVE]; /* that a cast is of */
    sph__query_cast casts[SPH__QUERY_WAVE];
    uint16_t first[SPH__QUERY_WAVE];  /* which of its pairs has the least key; SPH__QUERY_PAIRS: it has none */
    double key[SPH__QUERY_PAIRS + 1]; /* the last one is above all */
    uint32_t slot[SPH__QUERY_PAIRS + 1];
    uint8_t owner[SPH__QUERY_PAIRS + 1]; /* the cast */
} sph__query_packet;

static inline void sph__query_packet_begin(sph__query_packet *p)
{
    p->pair_count = 0;
    p->key[SPH__QUERY_PAIRS] = DBL_MAX;
}

/* Lists it where `counts` is 1. Without branches: what comes is anybody's guess. */
static inline void sph__query_packet_list(sph__query_packet *p, uint32_t cast, float key, uint32_t slot, int counts)
{
    const uint32_t pair = p->pair_count, first = p->first[cast];
    const int is_first = counts & (key < p->key[first]);
    p->key[pair] = key;
    p->slot[pair] = slot;
    p->owner[pair] = (uint8_t)cast;
    p->first[cast] = (uint16_t)sph__query_pick_number(is_first, pair, first);
    p->pair_count = pair + (uint32_t)counts;
}

/* What comes after this does not matter; below 0: nothing does any more. */
static inline double sph__query_packet_limit(const sph__query_packet *p, const sph__query_cast *c)
{
    if (p->any && c->slot != UINT32_MAX) return -1;
    return c->value > 1 ? 1 : c->value > 0 ? c->value : 0;
}

/* The cut segments of up to SPH__QUERY_TABLE casts. */
void sph__query_packet_moves(const sph__query_packet *p, const uint8_t *casts, uint32_t count, sph__query_moves *moves);

/* Nothing has touched yet. */
void sph__query_cast_begin(sph__query_cast *cast, const sph__query_aim *aim, uint32_t lane);
sph__query_room sph__query_packet_room(const sph__query_packet *p);

/*
 * Casts sweeps until it has had them all, or some thousand, or the packet is full: only those that may touch become
 * casts of it. Returns how many it has had. For up to SPH__QUERY_MANY primitives, and no tree.
 */
uint32_t sph__query_packet_many(sph__query_packet *p, size_t count);

/* Lets all that is listed have its say, and drops it. */
void sph__query_packet_resolve(sph__query_packet *p);

/* Tells the caller; `count` sweeps have been had. */
void sph__query_packet_answer(const sph__query_packet *p, sph_hit *hits, uint32_t count);

#endif
