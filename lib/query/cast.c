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
        ray->above[k] = aim->above[k][0];
        ray->below[k] = aim->below[k][0];
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
    p->first[number] = SPH__QUERY_PAIRS;
    if (is_near) set_ray(&s->aim, &s->ray);
    return is_near;
}

/*
 * Of the primitives whose boxes it meets it may begin within those whose boxes it begins in. These are looked at first,
 * and mostly that is all; returns how many others there are, which are moved to the front.
 */
static uint32_t begin_within(single *s, uint32_t *met, float *entry, uint32_t count)
{
    const sph_query *q = s->packet->query;
    uint32_t within[SPH__QUERY_CHUNK + 1], slots[SPH__QUERY_CHUNK], begun = 0, kept = 0;
    float keys[SPH__QUERY_CHUNK];
    for (uint32_t i = 0; i < count; ++i) {
        within[begun] = i;
        begun += entry[i] <= 0 && sph__query_begins_in_slab(&q->bounds, met[i], &s->ray);
    }
    if (begun == 0) return count;
    for (uint32_t i = 0; i < begun; ++i)
        slots[i] = met[within[i]];
    sph__query_parts_begin(q->parts, &s->line, slots, begun, keys);
    within[begun] = UINT32_MAX;
    for (uint32_t i = 0, k = 0; i < count; ++i) {
        const uint32_t slot = met[i];
        const float key = i == within[k] ? keys[k++] : SPH__QUERY_MISS;
        met[kept] = slot;
        entry[kept] = entry[i];
        kept += key > 0;
        sph__query_packet_list(s->packet, s->number, key, slot, key <= 0);
    }
    sph__query_packet_resolve(s->packet);
    return kept;
}

/* Takes it to slots [begin_slot, end_slot), at most a chunk. */
static void add(single *s, uint32_t begin_slot, uint32_t end_slot)
{
    packet *p = s->packet;
    const sph_query *q = p->query;
    uint32_t met[SPH__QUERY_CHUNK], count;
    float entry[SPH__QUERY_CHUNK], keys[SPH__QUERY_CHUNK];
    count = sph__query_kernel_meet(&q->bounds, begin_slot, end_slot, &s->ray, met, entry);
    if (count == 0) return;
    if (!s->has_line) sph__query_aim_line(&s->aim, &s->line);
    s->has_line = true;
    count = begin_within(s, met, entry, count);
    if (count == 0 || limit_of(s) <= 0) return;
    count = sph__query_fan_enter(q->fans, &s->ray, entry, met, count, limit_of(s));
    if (count == 0) return;
    sph__query_parts_touch(q->parts, &s->line, met, count, keys);
    for (uint32_t i = 0; i < count; ++i)
        sph__query_packet_list(p, s->number, keys[i], met[i], keys[i] <= 1);
    sph__query_packet_resolve(p);
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
    for (uint32_t i = 0; i < count && limit_of(s) >= 0; i += SPH__QUERY_CHUNK)
        add(s, i, count - i < SPH__QUERY_CHUNK ? count : i + SPH__QUERY_CHUNK);
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
    sph__query_packet_begin(p);
    if (q->is_exhaustive && count >= MANY_FROM && q->primitive_count <= SPH__QUERY_MANY)
        return sph__query_packet_many(p, count);
    p->count = count < SPH__QUERY_WAVE ? (uint32_t)count : SPH__QUERY_WAVE;
    for (uint32_t i = 0; i < p->count; ++i) {
        p->sweep[i] = (uint16_t)i;
        search_one(p, i);
    }
    return p->count;
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
        sph__query_packet_answer(&p, hits + done, had);
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
    sph__query_packet_begin(&p);
    p.count = 1;
    search_one(&p, 0);
    *t = c->slot == NONE ? 1 : fmin(1, c->cut.before + (c->value > 0 ? c->value : 0) * c->cut.span);
    return c->slot != NONE;
}
