/* SPDX-License-Identifier: MIT */
/*
 * Casts: bounds list the primitives that a segment may touch, and resolve.c finds out which it touches first. A single
 * segment is taken to all primitives at once, or down a tree; many of them are taken together (wave.h).
 */
#include <float.h>
#include <math.h>

#include "numeric/vector.h"
#include "query/packet.h"

enum { MANY_FROM = 8 }; /* sweeps from which on it is quicker to cast them together */

typedef sph__query_packet packet;
typedef sph__query_cast cast;

static const uint32_t NONE = UINT32_MAX;

/* --- one segment after the other --- */

/* The one whose turn it is. */
typedef struct single {
    packet *packet;
    uint32_t number;
    sph__query_aim aim;
    sph__query_ray ray;
    sph__query_line line;
    bool has_line;
} single;

static inline double limit_of(const single *s)
{
    return sph__query_packet_limit(s->packet, &s->packet->casts[s->number]);
}

static void set_ray(const sph__query_aim *aim, sph__query_ray *ray)
{
    for (int k = 0; k < 3; ++k) {
        const float *const ends[2] = {aim->before[k], aim->after[k]};
        const int back = aim->inverse[k][0] < 0;
        ray->above[k] = ends[back][0];
        ray->below[k] = ends[!back][0];
        ray->inverse[k] = aim->inverse[k][0];
        ray->from[k] = aim->place[k][0];
        ray->way[k] = aim->slope[k][0];
    }
    ray->reach = aim->reach[0];
}

/* False: the segment is not near. */
static bool begin(single *s, packet *p, uint32_t number)
{
    const sph__query_room room = sph__query_packet_room(p);
    double from[3], to[3], radius = 0;
    bool is_near;
    s->packet = p;
    s->number = number;
    s->has_line = false;
    if (p->sweeps != NULL) {
        const sph_sweep *w = &p->sweeps[number];
        sph__query_to_frame(p->query, (const double[3]){w->from[0], w->from[1], w->from[2]}, from);
        sph__query_to_frame(p->query, (const double[3]){w->to[0], w->to[1], w->to[2]}, to);
        radius = w->radius * p->query->scale;
    } else {
        sph__copy3(p->from, from);
        sph__copy3(p->to, to);
    }
    is_near = sph__query_aim_one(&s->aim, &room, from, to, radius);
    sph__query_cast_begin(&p->casts[number], &s->aim, 0);
    p->fronts[number] = sph__query_front_empty;
    if (is_near) set_ray(&s->aim, &s->ray);
    return is_near;
}

/* Lists what it may touch of slots [begin_slot, end_slot), at most a chunk; nothing else is listed. */
static void add(single *s, uint32_t begin_slot, uint32_t end_slot)
{
    packet *p = s->packet;
    sph__query_listed listed[SPH__QUERY_CHUNK];
    uint32_t met[SPH__QUERY_CHUNK], count;
    float entry[SPH__QUERY_CHUNK];
    count = sph__query_kernel_meet(&p->query->bounds, begin_slot, end_slot, &s->ray, met, entry);
    if (count == 0) return;
    count = sph__query_fan_enter(p->query->fans, &s->ray, entry, met, count, limit_of(s));
    if (count == 0) return;
    if (!s->has_line) sph__query_aim_line(&s->aim, &s->line);
    s->has_line = true;
    count = sph__query_parts_touch(p->query->parts, p->query->fans, &s->line, met, count, listed);
    for (uint32_t i = 0; i < count; ++i)
        sph__query_packet_list(p, s->number, listed[i]);
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

static void search_tree(single *s)
{
    const sph__box_tree *tree = &s->packet->query->solid.tree;
    const sph__query_ray *ray = &s->ray;
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, 0};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        const uint32_t half = sph__box_visit_middle(&v), left = 2 * v.node;
        sph__box_visit a, b;
        if (v.bound > limit_of(s)) continue;
        if (sph__box_tree_is_leaf(tree, v.node)) {
            add(s, v.begin, v.end);
            sph__query_packet_resolve(s->packet, s->number, s->number + 1);
            continue;
        }
        a = (sph__box_visit){left, v.begin, half, entry_of(&tree->nodes[left], ray)};
        b = (sph__box_visit){left + 1, half, v.end, entry_of(&tree->nodes[left + 1], ray)};
        if (a.bound <= b.bound) {
            const sph__box_visit t = a;
            a = b;
            b = t;
        }
        if (a.bound <= 1) stack[top++] = a;
        if (b.bound <= 1) stack[top++] = b;
    }
}

/* All slots, a chunk at a time. */
static void search_all(single *s)
{
    const uint32_t count = s->packet->query->primitive_count;
    for (uint32_t i = 0; i < count && limit_of(s) >= 0; i += SPH__QUERY_CHUNK) {
        add(s, i, count - i < SPH__QUERY_CHUNK ? count : i + SPH__QUERY_CHUNK);
        sph__query_packet_resolve(s->packet, s->number, s->number + 1);
    }
}

__attribute__((noinline)) static void search_one(packet *p, uint32_t number)
{
    single s;
    if (!begin(&s, p, number)) return;
    if (p->query->is_exhaustive)
        search_all(&s);
    else
        search_tree(&s);
}

/* Casts some sweeps; returns how many. */
static uint32_t cast_sweeps(packet *p, const sph_query *q, const sph_sweep *sweeps, size_t count, bool any)
{
    p->query = q;
    p->sweeps = sweeps;
    p->any = any;
    p->pair_count = 0;
    if (q->is_exhaustive && count >= MANY_FROM && q->primitive_count <= SPH__QUERY_MANY)
        return sph__query_packet_many(p, count);
    p->count = count < SPH__QUERY_WAVE ? (uint32_t)count : SPH__QUERY_WAVE;
    for (uint32_t i = 0; i < p->count; ++i) {
        p->sweep[i] = (uint16_t)i;
        search_one(p, i);
    }
    return p->count;
}

/* --- answers --- */

static void answer(const packet *p, uint32_t i, sph_hit *hit)
{
    const sph_query *q = p->query;
    const cast *c = &p->casts[i];
    const double t = sph__query_pick(c->value > 0, c->value, 0), at = c->before + t * c->span;
    sph__query_move move;
    sph__contact contact;
    double x[3];
    hit->s = sph__query_pick(at < 1, at, 1);
    hit->depth = sph__query_pick(c->value < 0, -c->value * q->unit, 0);
    hit->hit = 1;
    sph__query_packet_move(p, i, &move);
    sph__add_scaled(move.start, t, move.way, x);
    if (!sph__query_fan_closest(&q->fans[c->slot], q->solid.corner_counts[c->slot], x, &contact))
        sph__primitive_closest(&q->solid.primitives[c->slot], x, &contact);
    sph__query_contact(q, c->slot, &contact, &hit->contact);
}

/* Those that hit apart from the others: nothing is to be guessed then. */
static void answer_all(const packet *p, sph_hit *hits, uint32_t sweeps)
{
    static const sph_hit OPEN = {.s = 1, .contact = {.spheres = {SPH_NO_SPHERE, SPH_NO_SPHERE, SPH_NO_SPHERE}}};
    uint8_t which[SPH__QUERY_WAVE];
    uint32_t count = 0;
    for (uint32_t i = 0; i < sweeps; ++i)
        hits[i] = OPEN;
    for (uint32_t i = 0; i < p->count; ++i) {
        which[count] = (uint8_t)i;
        count += (uint32_t)sph__query_opaque(p->casts[i].slot != NONE);
    }
    for (uint32_t i = 0; i < count; ++i)
        answer(p, which[i], &hits[p->sweep[which[i]]]);
}

static sph_status check(const sph_query *q, const char *name, const sph_sweep *sweeps, size_t count, const void *hits)
{
    if (q == NULL || ((sweeps == NULL || hits == NULL) && count != 0))
        return sph__fail(q == NULL ? NULL : q->context, SPH_E_INVALID, "%s: an argument is NULL", name);
    if (count >= MANY_FROM && sph__query_aim_check(sweeps, count)) return SPH_OK;
    for (size_t i = 0; i < count; ++i) {
        const sph_sweep *s = &sweeps[i];
        const float nothing = (s->from[0] - s->from[0]) + (s->from[1] - s->from[1]) + (s->from[2] - s->from[2]) +
                              (s->to[0] - s->to[0]) + (s->to[1] - s->to[1]) + (s->to[2] - s->to[2]);
        if (!(nothing == 0)) return sph__fail(q->context, SPH_E_INVALID, "%s: sweep %zu is not finite", name, i);
        if (!(s->radius >= 0 && s->radius <= FLT_MAX))
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
        const uint32_t had = cast_sweeps(&p, q, sweeps + done, count - done, false);
        answer_all(&p, hits + done, had);
        done += had;
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
        const uint32_t had = cast_sweeps(&p, q, sweeps + done, count - done, true);
        memset(hits + done, 0, had);
        for (uint32_t i = 0; i < p.count; ++i)
            hits[done + p.sweep[i]] = p.casts[i].slot != NONE;
        done += had;
    }
    return SPH_OK;
}

bool sph__query_cast_frame(const sph_query *q, const double from[3], const double to[3], double *t)
{
    packet p;
    const cast *c = &p.casts[0];
    p.query = q;
    p.sweeps = NULL;
    p.from = from;
    p.to = to;
    p.any = false;
    p.pair_count = 0;
    p.count = 1;
    search_one(&p, 0);
    *t = c->slot == NONE ? 1 : fmin(1, c->before + (c->value > 0 ? c->value : 0) * c->span);
    return c->slot != NONE;
}
