/* SPDX-License-Identifier: MIT */
/*
 * A few points of a union whose extents show that it is not thinnest here: witnesses, which are far apart, in all frames and
 * directions before anything else; guards, which were the ends of directions that were followed, where witnesses leave it open.
 */
#include "hierarchy/widths.h"

/* Points that witnesses are chosen from, in the first frame: any will do. */
enum { SAMPLES = 128 };

/* Frames that are asked for before they are read. */
enum { AHEAD = 32 };

typedef struct sample {
    double points[SAMPLES][3];
    size_t numbers[SAMPLES], count;
} sample;

static void take_sample(const sph__builder *b, const sph__extents *e, sample *some)
{
    const size_t step = e->point_count / (SAMPLES / 2) + 1;
    some->count = 0;
    for (size_t p = 0; p < e->point_count; p += step) {
        const uint32_t *place = e->points[p];
        const bool two = place[2] == SPH__NO_NODE;
        const float *x = sph__node_center(b, e->vertices[place[0]]), *y = sph__node_center(b, e->vertices[place[1]]);
        const float *z = two ? x : sph__node_center(b, e->vertices[place[2]]);
        const double part = two ? 0.5 : 1.0 / 3, last = two ? 0 : part;
        for (size_t k = 0; k < 3; ++k)
            some->points[some->count][k] = part * ((double)x[k * b->stride] + (double)y[k * b->stride]) +
                                           last * (double)z[k * b->stride];
        some->numbers[some->count++] = p;
    }
}

/* Squared distance from `from`; of what is across `axis` where there is one. */
static double spread_from(const double x[3], const double from[3], const double *axis)
{
    const double d[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
    double c[3];
    if (axis == NULL) return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    for (unsigned k = 0; k < 3; ++k) c[k] = d[(k + 1) % 3] * axis[(k + 2) % 3] - d[(k + 2) % 3] * axis[(k + 1) % 3];
    return c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
}

/* The one farthest so. */
static size_t farthest(const sample *some, const double from[3], const double *axis)
{
    size_t best = 0;
    double most = -1;
    for (size_t i = 0; i < some->count; ++i) {
        const double spread = spread_from(some->points[i], from, axis);
        if (spread > most) {
            most = spread;
            best = i;
        }
    }
    return best;
}

/* Far apart in the first frame: the ends of the union, and what is farthest from the line between them. */
static void choose_witnesses(const sph__builder *b, const sph__extents *e, size_t witnesses[SPH__WITNESSES])
{
    sample some;
    size_t chosen[SPH__WITNESSES];
    double axis[3];
    take_sample(b, e, &some);
    chosen[0] = farthest(&some, some.points[0], NULL);
    chosen[1] = farthest(&some, some.points[chosen[0]], NULL);
    for (unsigned k = 0; k < 3; ++k) axis[k] = some.points[chosen[1]][k] - some.points[chosen[0]][k];
    chosen[2] = farthest(&some, some.points[chosen[1]], axis);
    chosen[3] = farthest(&some, some.points[chosen[2]], axis);
    for (size_t i = 0; i < SPH__WITNESSES; ++i) witnesses[i] = some.numbers[chosen[i]];
}

/* The rows that a point is the mean of. */
typedef struct point_rows {
    const float *rows[3];
    bool two;
} point_rows;

static point_rows rows_of(const sph__builder *b, const sph__extents *e, size_t p)
{
    const uint32_t *place = e->points[p];
    const bool two = place[2] == SPH__NO_NODE;
    return (point_rows){{sph__node_center(b, e->vertices[place[0]]), sph__node_center(b, e->vertices[place[1]]),
                         sph__node_center(b, e->vertices[place[two ? 1 : 2]])}, two};
}

SPH__INLINE void load_point(const point_rows *p, size_t s, size_t i, sph__v8d x[3])
{
    for (size_t k = 0; k < 3; ++k) {
        const sph__v8d two = sph__load(p->rows[0], k * s + i) + sph__load(p->rows[1], k * s + i);
        x[k] = p->two ? 0.5 * two : (two + sph__load(p->rows[2], k * s + i)) * (1.0 / 3.0);
    }
}

/* The other witnesses from the first; returns how far they are in any frame, in sums of coordinates. */
SPH__CLONES static double place_witnesses(const sph__builder *b, const sph__extents *e,
                                          const size_t witnesses[SPH__WITNESSES], double *rows)
{
    const size_t s = b->stride;
    point_rows points[SPH__WITNESSES];
    sph__v8d most = {0};
    double size = 0;
    for (size_t w = 0; w < SPH__WITNESSES; ++w) points[w] = rows_of(b, e, witnesses[w]);
    for (size_t i = 0; i < s; i += SPH__LANES) {
        sph__v8d o[3], x[3];
        for (size_t l = 0; l < 9 * SPH__WITNESSES && i % (2 * SPH__LANES) == 0; ++l)
            __builtin_prefetch(points[l / 9].rows[l / 3 % 3] + l % 3 * s + i + AHEAD);
        load_point(&points[0], s, i, o);
        for (size_t w = 1; w < SPH__WITNESSES; ++w) {
            load_point(&points[w], s, i, x);
            for (size_t k = 0; k < 3; ++k) {
                const sph__v8d d = x[k] - o[k], back = -d;
                sph__larger(&back, &most);
                *(sph__v8d *)(rows + (3 * (w - 1) + k) * s + i) = d;
                sph__larger(&d, &most);
            }
        }
    }
    for (size_t l = 0; l < SPH__LANES; ++l) size = most[l] > size ? most[l] : size;
    return 3 * size;
}

/* The witnesses' least extents in each chunk of frames, by direction, into chunk_least; of all directions into floors. */
SPH__CLONES static void witness_extents(const sph__builder *b, const double *rows, double *chunk_least, double *floors)
{
    const size_t s = b->stride, ds = b->direction_stride;
    for (size_t i = 0; i < s; i += SPH__LANES, chunk_least += ds) {
        const size_t lanes = b->frames - i < SPH__LANES ? b->frames - i : SPH__LANES;
        sph__v8d least_of_all;
        sph__fill((double)INFINITY, &least_of_all);
        for (size_t j = 0; j < ds; j += SPH__LANES) {
            const double *k = b->direction_rows + j;
            const sph__v8d k0 = *(const sph__v8d *)k, k1 = *(const sph__v8d *)(k + ds);
            const sph__v8d k2 = *(const sph__v8d *)(k + 2 * ds);
            sph__v8d least;
            sph__fill((double)INFINITY, &least);
            for (size_t l = 0; l < lanes; ++l) {
                const double *d = rows + i + l;
                sph__v8d low = {0}, high = {0}, along;
                for (size_t w = 0; w < SPH__WITNESSES - 1; ++w) {
                    along = k0 * d[3 * w * s] + k1 * d[(3 * w + 1) * s] + k2 * d[(3 * w + 2) * s];
                    sph__smaller(&along, &low);
                    sph__larger(&along, &high);
                }
                high -= low;
                sph__smaller(&high, &least);
            }
            *(sph__v8d *)(chunk_least + j) = least;
            sph__smaller(&least, &least_of_all);
        }
        floors[i / SPH__LANES] = sph__least_lane(&least_of_all);
    }
}

double sph__place_witnesses(const sph__builder *b, sph__extents *e)
{
    size_t witnesses[SPH__WITNESSES];
    double size;
    choose_witnesses(b, e, witnesses);
    size = place_witnesses(b, e, witnesses, e->witnesses);
    witness_extents(b, e->witnesses, e->chunk_least, e->chunk_floor);
    return 1e-13 * size;
}

/* --- guards --- */

void sph__add_guards(sph__extents *e, const double k[3], size_t lane)
{
    size_t ends[2] = {0, 0};
    double low = (double)INFINITY, high = (double)-INFINITY;
    if (e->guard_count + 2 > SPH__GUARDS) return;
    for (size_t p = 0, at = 0; p < e->point_count; ++p, at = sph__next_spread(e, at)) {
        const double *x = e->placed + 3 * p * SPH__LANES + lane;
        const double along = x[0] * k[0] + x[SPH__LANES] * k[1] + x[2 * SPH__LANES] * k[2];
        if (along < low) {
            low = along;
            ends[0] = at;
        }
        if (along > high) {
            high = along;
            ends[1] = at;
        }
    }
    e->guards[e->guard_count++] = ends[0];
    e->guards[e->guard_count++] = ends[1];
}

SPH__CLONES static void place_guards(const sph__builder *b, const sph__extents *e, size_t i, double *placed)
{
    const float *o = sph__node_center(b, e->vertices[0]) + i;
    sph__v8d *to = (sph__v8d *)placed;
    for (size_t g = 0; g < e->guard_count; ++g) {
        const point_rows p = rows_of(b, e, e->guards[g]);
        for (size_t k = 0; k < 3; ++k) {
            const size_t at = k * b->stride;
            const sph__v8d origin = sph__load(o, at);
            const sph__v8d two = (sph__load(p.rows[0], at + i) - origin) + (sph__load(p.rows[1], at + i) - origin);
            to[3 * g + k] = p.two ? 0.5 * two : (two + (sph__load(p.rows[2], at + i) - origin)) * (1.0 / 3.0);
        }
    }
}

void sph__place_guards(const sph__builder *b, const sph__extents *e, size_t i, double *placed)
{
    place_guards(b, e, i, placed);
}
