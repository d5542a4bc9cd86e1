/* SPDX-License-Identifier: MIT */
/*
 * Casts. Along a segment the signed distance to a convex primitive, less the radius of what moves, is convex; so
 * Newton's method from before the first root climbs down to it and never passes it, whatever the primitive degenerates
 * to (fan.c). Bounds tell which primitives to look at, and where to begin.
 */
#include <float.h>
#include <math.h>

#include "numeric/vector.h"
#include "query/query.h"

enum {
    MOST_MOVES = SPH__QUERY_WAVE,          /* of a packet */
    MOST_PAIRS = 4 * SPH__QUERY_CHUNK + 1, /* at a time */
    WAVE_FROM = 8,                         /* moves from which on the wave is quicker */
    WAVE_TO = 512                          /* primitives up to which it is */
};

static const uint32_t NONE = UINT32_MAX;

/* One cast, in the frame of the pose, cut to where the segment is near the solid: s = before + t * span. */
typedef struct cast {
    double before, span;
    bool is_near;
    /* the best so far: the least t, of these the deepest, of these the lowest number */
    uint32_t slot; /* NONE: none */
    double t, depth;
    double limit; /* what comes later does not matter; -1: nothing does any more */
} cast;

/* Casts that are worked on side by side. */
typedef struct packet {
    const sph_query *query;
    bool any; /* any hit will do */
    uint32_t move_count, pair_count;
    cast casts[MOST_MOVES];
    bool is_aimed[MOST_MOVES];
    sph__query_move moves[MOST_MOVES];
    sph__query_ray rays[MOST_MOVES];
    sph__query_pair pairs[MOST_PAIRS];
} packet;

static inline double lesser(double a, double b)
{
    return a < b ? a : b;
}

static inline double greater(double a, double b)
{
    return a > b ? a : b;
}

/* Cuts [*enter, *leave] of from + s * way to the slab |x| <= half; false when nothing is left. */
static inline bool cut(double from, double way, double half, double *enter, double *leave)
{
    const double inverse = 1 / way, a = (-half - from) * inverse, b = (half - from) * inverse;
    if (!(fabs(way) > 1e-290)) return fabs(from) <= half;
    *enter = greater(*enter, lesser(a, b));
    *leave = lesser(*leave, greater(a, b));
    return *enter <= *leave;
}

static inline double largest(const double x[3])
{
    return greater(fabs(x[0]), greater(fabs(x[1]), fabs(x[2])));
}

static void begin(packet *p, uint32_t i, const double from[3], const double to[3], double radius)
{
    const sph_query *q = p->query;
    cast *c = &p->casts[i];
    sph__query_move *m = &p->moves[i];
    double enter = 0, leave = 1, way[3], margin;
    c->slot = NONE;
    c->t = 2;
    c->depth = 0;
    c->limit = 1;
    c->is_near = true;
    sph__subtract(to, from, way);
    margin = 2e-6 * (1 + radius) + 1e-15 * (largest(from) + largest(way));
    for (int k = 0; k < 3; ++k)
        c->is_near = c->is_near && cut(from[k], way[k], q->half[k] + radius + margin, &enter, &leave);
    if (!c->is_near) return;
    c->before = enter;
    c->span = leave - enter;
    for (int k = 0; k < 3; ++k) {
        m->start[k] = from[k] + enter * way[k];
        m->way[k] = c->span * way[k];
    }
    m->radius = radius;
    m->tolerance = 1e-14 * (1 + radius);
    p->is_aimed[i] = !(radius + margin < 1e3);
    if (!p->is_aimed[i])
        sph__query_ray_set(&p->rays[i], m->start, m->way, radius + margin);
    else
        p->rays[i] = sph__query_ray_all;
}

static void improve(packet *p, const sph__query_pair *pair)
{
    const uint32_t *numbers = p->query->numbers;
    cast *c = &p->casts[pair->move];
    const double depth = pair->distance < 0 && pair->t == 0 && c->before == 0 ? -pair->distance : 0;
    if (c->slot != NONE) {
        if (pair->t > c->t || (pair->t == c->t && depth < c->depth)) return;
        if (pair->t == c->t && depth == c->depth && numbers[pair->slot] > numbers[c->slot]) return;
    }
    c->slot = pair->slot;
    c->t = pair->t;
    c->depth = depth;
    c->limit = p->any ? -1 : pair->t;
}

/* Can the pair still make a difference? */
static inline bool matters(const packet *p, const sph__query_pair *pair)
{
    return pair->t <= p->casts[pair->move].limit;
}

/* Drops pairs that make none. */
static void sift(packet *p)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < p->pair_count; ++i) {
        const sph__query_pair pair = p->pairs[i];
        p->pairs[kept] = pair;
        kept += matters(p, &pair);
    }
    p->pair_count = kept;
}

/* Of each move that has any the pairs that may touch first: all in which it begins, say. Returns how many. */
static uint32_t choose(const packet *p, uint32_t *turn)
{
    uint16_t first[MOST_MOVES];
    uint32_t count = 0;
    turn[0] = 0;
    if (p->pair_count == 1) return 1;
    for (uint32_t i = 0; i < p->pair_count; ++i)
        first[p->pairs[i].move] = (uint16_t)i;
    for (uint32_t i = 0; i < p->pair_count; ++i) {
        uint16_t *f = &first[p->pairs[i].move];
        *f = p->pairs[i].t < p->pairs[*f].t ? (uint16_t)i : *f;
    }
    for (uint32_t i = 0; i < p->pair_count; ++i) {
        turn[count] = i;
        count += p->pairs[i].t == p->pairs[first[p->pairs[i].move]].t;
    }
    return count;
}

/* Works on these pairs until they have touched or do not matter. */
static void approach(packet *p, uint32_t *turn, uint32_t count)
{
    while (count > 0) {
        uint32_t kept = 0;
        sph__query_fan_step(p->query->fans, p->moves, p->pairs, turn, count);
        for (uint32_t i = 0; i < count; ++i) {
            sph__query_pair *pair = &p->pairs[turn[i]];
            if (pair->touches) {
                improve(p, pair);
                pair->t = SPH__QUERY_MISS;
            }
            turn[kept] = turn[i];
            kept += matters(p, pair);
        }
        count = kept;
    }
}

/* Lets all pairs have their say. Mostly the first one of a move silences the others. */
static void resolve(packet *p)
{
    uint32_t turn[MOST_PAIRS + 1];
    for (sift(p); p->pair_count > 0; sift(p))
        approach(p, turn, choose(p, turn));
}

/* Pairs of a move with slots [begin, end), at most a chunk. */
static void add(packet *p, uint32_t move, uint32_t begin_slot, uint32_t end_slot)
{
    sph__query_pair *pairs = p->pairs + p->pair_count;
    uint32_t met[SPH__QUERY_CHUNK], count;
    float entry[SPH__QUERY_CHUNK];
    count = sph__query_kernel_meet(&p->query->bounds, begin_slot, end_slot, &p->rays[move], met, entry);
    for (uint32_t i = 0; i < count; ++i) {
        pairs[i].t = entry[i];
        pairs[i].move = (uint16_t)move;
        pairs[i].slot = met[i];
    }
    if (count == 0) return;
    count = sph__query_fan_enter(p->query->fans, p->rays, pairs, count, p->casts[move].limit);
    if (count == 0) return;
    if (!p->is_aimed[move]) {
        sph__query_ray_aim(&p->rays[move], p->moves[move].way, p->moves[move].radius);
        p->is_aimed[move] = true;
    }
    p->pair_count += sph__query_parts_touch(p->query->parts, p->rays, pairs, count);
}

/* As the kernel does it; monotonous, so that a box is entered no later than the boxes in it. */
static float entry_of(const sph__box *box, const sph__query_ray *ray)
{
    float enter = 0, leave = 1;
    for (int k = 0; k < 3; ++k) {
        const float a = (box->low[k] - ray->above[k]) * ray->inverse[k];
        const float b = (box->high[k] - ray->below[k]) * ray->inverse[k];
        const float first = a < b ? a : b, last = a < b ? b : a;
        enter = first > enter ? first : enter;
        leave = last < leave ? last : leave;
    }
    return enter <= leave ? enter : SPH__QUERY_MISS;
}

static void search_tree(packet *p, uint32_t move)
{
    const sph__box_tree *tree = &p->query->solid.tree;
    const sph__query_ray *ray = &p->rays[move];
    const cast *c = &p->casts[move];
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, 0};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        const uint32_t half = sph__box_visit_middle(&v), left = 2 * v.node;
        sph__box_visit a, b;
        if (v.bound > c->limit) continue;
        if (sph__box_tree_is_leaf(tree, v.node)) {
            add(p, move, v.begin, v.end);
            resolve(p);
            continue;
        }
        a = (sph__box_visit){left, v.begin, half, entry_of(&tree->nodes[left], ray)};
        b = (sph__box_visit){left + 1, half, v.end, entry_of(&tree->nodes[left + 1], ray)};
        if (a.bound <= b.bound) {
            const sph__box_visit t = a;
            a = b;
            b = t;
        }
        if (a.bound <= c->limit) stack[top++] = a;
        if (b.bound <= c->limit) stack[top++] = b;
    }
}

/* All slots, a chunk at a time. The pairs of other moves may wait for company. */
static void search_all(packet *p, uint32_t move)
{
    const uint32_t count = p->query->primitive_count;
    for (uint32_t i = 0; i < count; i += SPH__QUERY_CHUNK) {
        const uint32_t end = count - i < SPH__QUERY_CHUNK ? count : i + SPH__QUERY_CHUNK;
        if (i > 0 || p->pair_count + (end - i) > MOST_PAIRS) resolve(p);
        if (p->casts[move].limit < 0) return;
        add(p, move, i, end);
    }
}

/* All primitives, one after the other against all moves. */
static void search_wave(packet *p)
{
    const sph_query *q = p->query;
    sph__query_wave wave;
    sph__query_wave_begin(&wave, p->move_count, p->rays);
    for (uint32_t i = 0; i < p->move_count; ++i)
        if (p->casts[i].is_near) {
            if (!p->is_aimed[i]) sph__query_ray_aim(&p->rays[i], p->moves[i].way, p->moves[i].radius);
            sph__query_wave_set(&wave, i, &p->rays[i]);
        }
    for (uint32_t slot = 0; slot < q->primitive_count; ++slot) {
        if (p->pair_count + SPH__QUERY_WAVE + 1 > MOST_PAIRS) resolve(p);
        p->pair_count += sph__query_wave_pairs(&wave, &q->bounds, q->parts, slot, p->pairs + p->pair_count);
    }
}

static void search(packet *p)
{
    const bool exhaustive = p->query->is_exhaustive;
    if (exhaustive && p->move_count >= WAVE_FROM && p->query->primitive_count <= WAVE_TO) {
        search_wave(p);
    } else {
        for (uint32_t i = 0; i < p->move_count; ++i) {
            if (!p->casts[i].is_near) continue;
            if (exhaustive)
                search_all(p, i);
            else
                search_tree(p, i);
        }
    }
    if (p->pair_count > 0) resolve(p);
}

static uint32_t cast_sweeps(packet *p, const sph_query *q, const sph_sweep *sweeps, size_t count, bool any)
{
    const uint32_t moves = count < MOST_MOVES ? (uint32_t)count : MOST_MOVES;
    p->query = q;
    p->any = any;
    p->pair_count = 0;
    p->move_count = moves;
    for (uint32_t i = 0; i < moves; ++i) {
        const sph_sweep *w = &sweeps[i];
        double from[3], to[3];
        sph__query_to_frame(q, (const double[3]){w->from[0], w->from[1], w->from[2]}, from);
        sph__query_to_frame(q, (const double[3]){w->to[0], w->to[1], w->to[2]}, to);
        begin(p, i, from, to, w->radius * q->scale);
    }
    search(p);
    return moves;
}

static void answer(const packet *p, uint32_t i, sph_hit *hit)
{
    const cast *c = &p->casts[i];
    sph__contact contact;
    double x[3];
    if (c->slot == NONE) {
        *hit = (sph_hit){.s = 1};
        sph__query_no_contact(&hit->contact);
        return;
    }
    hit->s = lesser(1, c->before + c->t * c->span);
    hit->depth = c->depth / p->query->scale;
    hit->hit = 1;
    hit->reserved0 = 0;
    sph__add_scaled(p->moves[i].start, c->t, p->moves[i].way, x);
    sph__primitive_closest(&p->query->solid.primitives[c->slot], x, &contact);
    sph__query_contact(p->query, c->slot, &contact, &hit->contact);
}

static sph_status check(const sph_query *q, const char *name, const sph_sweep *sweeps, size_t count, const void *hits)
{
    if (q == NULL || ((sweeps == NULL || hits == NULL) && count != 0))
        return sph__fail(q == NULL ? NULL : q->context, SPH_E_INVALID, "%s: an argument is NULL", name);
    for (size_t i = 0; i < count; ++i) {
        const sph_sweep *s = &sweeps[i];
        bool finite = true;
        for (int k = 0; k < 3; ++k)
            finite = finite && isfinite(s->from[k]) && isfinite(s->to[k]);
        if (!finite) return sph__fail(q->context, SPH_E_INVALID, "%s: sweep %zu is not finite", name, i);
        if (!(isfinite(s->radius) && s->radius >= 0))
            return sph__fail(q->context, SPH_E_INVALID, "%s: the radius of sweep %zu is %g", name, i,
                             (double)s->radius);
    }
    return SPH_OK;
}

sph_status sph_query_cast(const sph_query *q, const sph_sweep *sweeps, size_t count, sph_hit *hits)
{
    SPH__OWN(q, SPH__QUERY);
    const sph_status status = check(q, "sph_query_cast", sweeps, count, hits);
    packet p;
    if (status != SPH_OK) return status;
    for (size_t done = 0; done < count;) {
        const uint32_t moves = cast_sweeps(&p, q, sweeps + done, count - done, false);
        for (uint32_t i = 0; i < moves; ++i)
            answer(&p, i, &hits[done + i]);
        done += moves;
    }
    return SPH_OK;
}

sph_status sph_query_cast_any(const sph_query *q, const sph_sweep *sweeps, size_t count, uint8_t *hits)
{
    SPH__OWN(q, SPH__QUERY);
    const sph_status status = check(q, "sph_query_cast_any", sweeps, count, hits);
    packet p;
    if (status != SPH_OK) return status;
    for (size_t done = 0; done < count;) {
        const uint32_t moves = cast_sweeps(&p, q, sweeps + done, count - done, true);
        for (uint32_t i = 0; i < moves; ++i)
            hits[done + i] = p.casts[i].slot != NONE;
        done += moves;
    }
    return SPH_OK;
}

bool sph__query_cast_frame(const sph_query *q, const double from[3], const double to[3], double *t)
{
    packet p;
    p.query = q;
    p.any = false;
    p.pair_count = 0;
    p.move_count = 1;
    begin(&p, 0, from, to, 0);
    search(&p);
    *t = 1;
    if (p.casts[0].slot == NONE) return false;
    *t = lesser(1, p.casts[0].before + p.casts[0].t * p.casts[0].span);
    return true;
}
