/* SPDX-License-Identifier: MIT */
/*
 * Segments made ready, 16 side by side: in the frame of the pose, cut to where they pass the solid, and in 32 bits
 * for the bounds. Lanes do not mix, so that one alone gets the same bits.
 */
#ifndef SPH_QUERY_AIM_H
#define SPH_QUERY_AIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sphmesh/query.h>

#include "query/fan.h"

enum { SPH__QUERY_AIM = 16 };

/* A line as the parts of primitives see it (parts.h). */
typedef struct __attribute__((aligned(32))) sph__query_line {
    float from[3], direction[3]; /* unit */
    float per_length;            /* what makes a t of a length along it; 0: t says nothing */
    float reach;                 /* the radius of what moves, and some more; SPH__QUERY_FAR: it says nothing either */
} sph__query_line;

#define SPH__QUERY_FAR 1e15f

/* What all segments have in common: x' = (x - origin) * scale, and the solid is within +- half. */
typedef struct sph__query_room {
    double origin[3], scale, half[3];
} sph__query_room;

typedef struct __attribute__((aligned(64))) sph__query_aim {
    double from[3][SPH__QUERY_AIM], way[3][SPH__QUERY_AIM], radius[SPH__QUERY_AIM]; /* in the frame */
    /* the part that passes the solid: of the whole it is start + t * span; a span below 0: none does */
    double start[SPH__QUERY_AIM], span[SPH__QUERY_AIM];
    /* what bounds need (kernel.h), in 32 bits */
    float above[3][SPH__QUERY_AIM], below[3][SPH__QUERY_AIM]; /* the place plus, minus the reach */
    float inverse[3][SPH__QUERY_AIM];                         /* 1 / slope, never infinite */
    float place[3][SPH__QUERY_AIM], slope[3][SPH__QUERY_AIM], reach[SPH__QUERY_AIM];
    float direction[3][SPH__QUERY_AIM], per_length[SPH__QUERY_AIM];
    sph__query_line lines[SPH__QUERY_AIM]; /* the same again */
} sph__query_aim;

/* Of sweeps[which[..]]. */
void sph__query_aim_sweeps(sph__query_aim *aim, const sph__query_room *room, const sph_sweep *sweeps,
                           const uint16_t which[SPH__QUERY_AIM]);

/* What is left of a segment, s = before + t * span; a span below 0: nothing. */
typedef struct sph__query_cut {
    double before, span;
} sph__query_cut;

/* What is left of sweeps, from number `at` on, eight side by side. */
void sph__query_aim_moves(sph__query_moves *moves, uint32_t at, const sph__query_room *room,
                          const sph_sweep *const sweeps[8], const sph__query_cut *const cuts[8]);

/* Of one whose ends and radius in the frame are given, but for its line; false: it does not pass the solid. */
bool sph__query_aim_one(sph__query_aim *aim, const sph__query_room *room, const double from[3], const double to[3],
                        double radius);
/* And its line. */
void sph__query_aim_line(const sph__query_aim *aim, sph__query_line *line);

/* Are all finite, with radii that are not below 0? Sometimes says no where the radius is -0. */
bool sph__query_aim_check(const sph_sweep *sweeps, size_t count);

#endif
