/* SPDX-License-Identifier: MIT */
/*
 * Primitives once more, in 32 bits, as the parts that cover them: the spheres, of each edge the cone between the
 * circles in which it touches its spheres, and the prism between the faces. Each is convex, so that a line is in it for
 * one interval, in closed form; the least beginning of these is where the line enters the primitive. All parts are
 * taken a little too big, by more than all rounding, so that what comes out is never later than the truth.
 *
 * A corner or an edge that is missing, or is contained, is another one again.
 *
 * Neighbours share spheres and edges, and a line that enters one there enters all of them. The one with the lowest
 * number answers for all: the others begin where the line enters what is theirs alone. That they do so within
 * themselves does no harm, as the touch is earlier than what is then found. That is for lines that begin outside. What
 * a line may begin within is told beforehand (depth.h).
 */
#ifndef SPH_QUERY_PARTS_H
#define SPH_QUERY_PARTS_H

#include <math.h>
#include <string.h>

#include "hierarchy/lanes.h"
#include "query/aim.h"
#include "query/fan.h"

typedef struct __attribute__((aligned(64))) sph__query_parts {
    float center[3][SPH__QUERY_FAN], radius[SPH__QUERY_FAN];
    /* of the edge that begins at the corner: its unit axis; slope of its side; between the circles */
    float axis[3][SPH__QUERY_FAN], sine[SPH__QUERY_FAN], cosine[SPH__QUERY_FAN], length[SPH__QUERY_FAN];
    float tangent[SPH__QUERY_FAN], whole[SPH__QUERY_FAN]; /* of that slope; between the centres */
    /* of the prism: outward normals of its sides, how far they are beyond the corners, and at what rate they move out
     * as the radius grows; normals of the faces; far below 0: there is none */
    float side[3][SPH__QUERY_FAN], beyond[SPH__QUERY_FAN], growth[SPH__QUERY_FAN];
    float face[2][3], room;
    /* of the spheres and of the edges: 0, or SPH__QUERY_NEVER where a primitive with a lower number has it too */
    float shared_corner[SPH__QUERY_FAN], shared_edge[SPH__QUERY_FAN];
    /* of the faces, as in fan.h: the height above the plane of the centres, two weights, the distance */
    float plane[3][SPH__QUERY_FAN], plane_height[SPH__QUERY_FAN], plane_constant[SPH__QUERY_FAN];
    float loose;           /* how much more than the distance may be computed, about the origin */
    uint32_t corner_count; /* 1, 2 or 3; as many edges, but for 2 one, and a prism for 3 */
} sph__query_parts;

/* Which of the corners, and of the edges from bit 3 on, are shared with a primitive of a lower number, as bits. */
void sph__query_parts_set(sph__query_parts *parts, const sph__primitive *primitive, uint32_t shared);

/*
 * Of primitives that a segment may touch. A key says how early at best: it touches no earlier than t = key; where key
 * is 0 or less it may begin within, to a signed distance of no less than key. Above 1: it does not touch. Least is
 * first, and numbers in the same order are compared without a branch.
 */
static inline uint64_t sph__query_rank(float key)
{
    uint32_t bits;
    memcpy(&bits, &key, sizeof bits);
    return bits ^ ((uint32_t)((int32_t)bits >> 31) | 0x80000000u);
}

/* The keys of the primitives in `slots`, which the line does not begin in. */
void sph__query_parts_touch(const sph__query_parts *parts, const sph__query_line *line, const uint32_t *slots,
                            uint32_t count, float *keys);
/* Of those that it may begin in; above 0: it does not. */
void sph__query_parts_begin(const sph__query_parts *parts, const sph__query_line *line, const uint32_t *slots,
                            uint32_t count, float *keys);

/* An interval of a line, as multiples of its unit direction. */
typedef struct sph__query_span {
    float enter, leave;
} sph__query_span;

/* Where the line is nearest to a corner, and what has been computed on the way. */
typedef struct sph__query_foot {
    float at, x, y, z;                 /* relative to the corner */
    float radius, apart, inside, blur; /* inside: apart^2 - radius^2; blur: more than its error and its likes' */
} sph__query_foot;

#define SPH__QUERY_NEVER 1e30f

/* How uncertain places along a line are, and what counts as the radius of what moves. */
SPH__INLINE float sph__query_margin(float reach)
{
    return 1e-5f * (1 + reach);
}

SPH__INLINE float sph__query_least(float a, float b)
{
    return a < b ? a : b;
}

SPH__INLINE float sph__query_most(float a, float b)
{
    return a > b ? a : b;
}

/* Of a ray: a place and the unit direction. */
#define SPH__QUERY_LINE_ARGUMENTS float px, float py, float pz, float ex, float ey, float ez

SPH__INLINE sph__query_foot sph__query_foot_of(float cx, float cy, float cz, float radius, float margin,
                                               SPH__QUERY_LINE_ARGUMENTS)
{
    sph__query_foot f;
    const float vx = px - cx, vy = py - cy, vz = pz - cz, at = vx * ex + vy * ey + vz * ez;
    float apart, squared;
    f.at = -at;
    f.x = vx - at * ex;
    f.y = vy - at * ey;
    f.z = vz - at * ez;
    apart = f.x * f.x + f.y * f.y + f.z * f.z;
    squared = radius * radius;
    f.radius = radius;
    f.apart = apart;
    f.inside = apart - squared;
    /* the foot is not quite the nearest place: of that what a product with `apart` itself may lose */
    f.blur = 8e-6f * (apart + squared) + 1e3f * (margin * margin);
    return f;
}

SPH__INLINE sph__query_span sph__query_span_sphere(const sph__query_foot *f, float margin)
{
    const float square = f->blur - f->inside, root = sqrtf(sph__query_most(square, 0)) + margin;
    const float enter = f->at - root, leave = f->at + root;
    return (sph__query_span){square < 0 ? SPH__QUERY_NEVER : enter, square < 0 ? -SPH__QUERY_NEVER : leave};
}

/*
 * With `a` the part of the direction along the axis and z the place along it from the first circle on, the cone is
 * where (cosine^2 - a^2) u^2 - 2 a z u + cosine^2 inside - z^2 <= 0. A line that is nearly as steep as its side, or
 * steeper, is given the whole way between the circles.
 */
SPH__INLINE sph__query_span sph__query_span_cone(const sph__query_foot *f, float ax, float ay, float az, float sine,
                                                 float cosine, float length, float ex, float ey, float ez, float margin)
{
    const float a = ax * ex + ay * ey + az * ez, z = ax * f->x + ay * f->y + az * f->z - f->radius * sine;
    const float flat = cosine * cosine - a * a, square = z * z - flat * f->inside + f->blur;
    const int is_steep = flat < 0.05f;
    const float root = cosine * sqrtf(sph__query_most(square, 0)) + margin, inverse = 1 / (is_steep ? 1.0f : flat);
    const float first = square < 0 ? SPH__QUERY_NEVER : (a * z - root) * inverse;
    const float last = square < 0 ? -SPH__QUERY_NEVER : (a * z + root) * inverse;
    const float across = 1 / (a + (a < 0 ? -1e-18f : 1e-18f));
    const float one = (-margin - z) * across, other = (length + margin - z) * across;
    const float in = sph__query_least(one, other), out = sph__query_most(one, other);
    const float enter = sph__query_most(is_steep ? -SPH__QUERY_NEVER : first, in);
    const float leave = sph__query_least(is_steep ? SPH__QUERY_NEVER : last, out);
    return (sph__query_span){enter > leave ? SPH__QUERY_NEVER : enter + f->at,
                             enter > leave ? -SPH__QUERY_NEVER : leave + f->at};
}

/* Cuts a span to the side of a plane, `room` beyond the corner along the normal. */
SPH__INLINE sph__query_span sph__query_span_cut(sph__query_span s, const sph__query_foot *f, float nx, float ny,
                                                float nz, float room, float ex, float ey, float ez)
{
    const float rate = nx * ex + ny * ey + nz * ez, place = nx * f->x + ny * f->y + nz * f->z;
    const float at = (room - place) * (1 / (rate + (rate < 0 ? -1e-18f : 1e-18f))) + f->at;
    const float enter = rate < 0 ? at : -SPH__QUERY_NEVER, leave = rate < 0 ? SPH__QUERY_NEVER : at;
    return (sph__query_span){sph__query_most(enter, s.enter), sph__query_least(leave, s.leave)};
}

static const sph__query_span sph__query_span_all = {-SPH__QUERY_NEVER, SPH__QUERY_NEVER};

/* What cutting has left. */
SPH__INLINE sph__query_span sph__query_span_whole(sph__query_span s)
{
    return (sph__query_span){s.enter > s.leave ? SPH__QUERY_NEVER : s.enter,
                             s.enter > s.leave ? -SPH__QUERY_NEVER : s.leave};
}

/* When a line is in the parts of a primitive that it does not share. */
SPH__INLINE sph__query_span sph__query_span_part(sph__query_span all, sph__query_span part, float shared)
{
    return (sph__query_span){sph__query_least(all.enter, part.enter + shared),
                             sph__query_most(all.leave, part.leave - shared)};
}

static const sph__query_span sph__query_span_none = {SPH__QUERY_NEVER, -SPH__QUERY_NEVER};

/* The key of a line that does not begin within. */
SPH__INLINE float sph__query_key(sph__query_span parts, float per_length)
{
    const float first = parts.enter * per_length, last = parts.leave * per_length;
    return last < 0 || first > 1 ? SPH__QUERY_MISS : sph__query_most(first, 0);
}

#endif
