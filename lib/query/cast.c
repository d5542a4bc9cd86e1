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

/* One cast, in the frame of the pose, cut to where the segment is near the solid: start + t * way, 0 <= t <= 1. */
typedef struct cast {
    const sph_query *query;
    sph__query_move move;
    double before, span; /* s = before + t * span */
    bool use_bounds, any;
    sph__query_ray ray;
    /* the best so far: the least t, of these the deepest, of these the lowest number */
    uint32_t slot; /* UINT32_MAX: none */
    double t, depth;
} cast;

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

/* False when the segment is nowhere near. */
static bool begin(cast *c, const sph_query *q, const double from[3], const double to[3], double radius)
{
    double enter = 0, leave = 1, way[3], margin;
    sph__subtract(to, from, way);
    margin = 2e-6 * (1 + radius) + 1e-15 * (largest(from) + largest(way));
    for (int k = 0; k < 3; ++k)
        if (!cut(from[k], way[k], q->half[k] + radius + margin, &enter, &leave)) return false;
    c->query = q;
    c->move.radius = radius;
    c->before = enter;
    c->span = leave - enter;
    for (int k = 0; k < 3; ++k) {
        c->move.start[k] = from[k] + enter * way[k];
        c->move.way[k] = c->span * way[k];
    }
    c->move.tolerance = 1e-14 * (1 + radius);
    c->use_bounds = radius + margin < 1e3;
    if (c->use_bounds) sph__query_ray_set(&c->ray, c->move.start, c->move.way, radius + margin);
    c->slot = UINT32_MAX;
    c->t = 2;
    c->depth = 0;
    return true;
}

static void consider(cast *c, uint32_t slot, double t)
{
    const sph_query *q = c->query;
    double f, depth;
    if (!sph__query_approach(&q->fans[slot], &c->move, c->t, &t, &f)) return;
    depth = f < 0 && t == 0 && c->before == 0 ? -f : 0;
    if (c->slot != UINT32_MAX) {
        if (t > c->t || (t == c->t && depth < c->depth)) return;
        if (t == c->t && depth == c->depth && q->numbers[slot] > q->numbers[c->slot]) return;
    }
    c->slot = slot;
    c->t = t;
    c->depth = depth;
}

/* Bit i is byte i, of 64 that are 0 or 1. */
static inline uint64_t pack(const uint8_t *bytes)
{
    uint64_t mask = 0;
    for (int i = 0; i < 8; ++i) {
        uint64_t eight = 0;
        for (int k = 0; k < 8; ++k) /* one load, whatever the order of bytes */
            eight |= (uint64_t)bytes[8 * i + k] << (8 * k);
        mask |= (eight * 0x0102040810204080u >> 56) << (8 * i); /* the lowest bits of the bytes, side by side */
    }
    return mask;
}

/* Slots that are left after the slabs of those in the boxes, and where they are entered. */
static uint32_t gather(const cast *c, uint32_t begin_slot, uint32_t size, const float *box_entry, const uint8_t *meets,
                       float *entry, uint32_t *slot)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < size; i += 64)
        for (uint64_t mask = pack(meets + i); mask != 0; mask &= mask - 1) {
            const uint32_t k = i + (uint32_t)__builtin_ctzll(mask);
            entry[count] = sph__query_fan_entry(&c->query->fans[begin_slot + k], &c->ray, box_entry[k]);
            slot[count] = begin_slot + k;
            count += entry[count] <= 1;
        }
    return count;
}

/* Slots [begin, end), at most a chunk, in the order in which their bounds are entered. */
static void search_range(cast *c, uint32_t range_begin, uint32_t range_end)
{
    float box_entry[SPH__QUERY_CHUNK], entry[SPH__QUERY_CHUNK + 1];
    uint8_t meets[SPH__QUERY_CHUNK];
    uint32_t slot[SPH__QUERY_CHUNK + 1], count;
    const uint32_t size = range_end - range_begin;
    if (!c->use_bounds) {
        for (uint32_t i = range_begin; i < range_end && !(c->any && c->slot != UINT32_MAX); ++i)
            consider(c, i, 0);
        return;
    }
    sph__query_kernel_entries(&c->query->bounds, range_begin, range_end, &c->ray, box_entry, meets);
    memset(meets + size, 0, (64 - size % 64) % 64); /* padding, and slots of other leaves */
    count = gather(c, range_begin, size, box_entry, meets, entry, slot);
    while (count > 0) {
        uint32_t first = 0;
        for (uint32_t i = 1; i < count; ++i)
            first = entry[i] < entry[first] ? i : first;
        if (entry[first] > c->t || (c->any && c->slot != UINT32_MAX)) return;
        consider(c, slot[first], entry[first]);
        --count;
        entry[first] = entry[count];
        slot[first] = slot[count];
    }
}

/* As the kernel does it; monotonous, so that a box is entered no later than the boxes in it. */
static float entry_of(const sph__box *box, const sph__query_ray *ray)
{
    float enter = 0, leave = 1;
    for (int k = 0; k < 3; ++k) {
        const bool up = !(ray->inverse[k] < 0);
        const float a = ((up ? box->low[k] : box->high[k]) - ray->enter[k]) * ray->inverse[k];
        const float b = ((up ? box->high[k] : box->low[k]) - ray->leave[k]) * ray->inverse[k];
        enter = a > enter ? a : enter;
        leave = b < leave ? b : leave;
    }
    return enter <= leave ? enter : SPH__QUERY_MISS;
}

static void search_tree(cast *c)
{
    const sph__box_tree *tree = &c->query->solid.tree;
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, 0};
    while (top > 0 && !(c->any && c->slot != UINT32_MAX)) {
        const sph__box_visit v = stack[--top];
        const uint32_t half = sph__box_visit_middle(&v), left = 2 * v.node;
        sph__box_visit a, b;
        if (v.bound > c->t) continue;
        if (sph__box_tree_is_leaf(tree, v.node)) {
            search_range(c, v.begin, v.end);
            continue;
        }
        a = (sph__box_visit){left, v.begin, half, c->use_bounds ? entry_of(&tree->nodes[left], &c->ray) : 0};
        b = (sph__box_visit){left + 1, half, v.end, c->use_bounds ? entry_of(&tree->nodes[left + 1], &c->ray) : 0};
        if (a.bound <= b.bound) {
            const sph__box_visit t = a;
            a = b;
            b = t;
        }
        if (a.bound <= 1) stack[top++] = a;
        if (b.bound <= 1) stack[top++] = b;
    }
}

static void search(cast *c)
{
    const uint32_t count = c->query->primitive_count;
    if (!c->query->is_exhaustive) {
        search_tree(c);
        return;
    }
    for (uint32_t i = 0; i < count && !(c->any && c->slot != UINT32_MAX); i += SPH__QUERY_CHUNK)
        search_range(c, i, count - i < SPH__QUERY_CHUNK ? count : i + SPH__QUERY_CHUNK);
}

static bool begin_sweep(cast *c, const sph_query *q, const sph_sweep *sweep, bool any)
{
    const double from[3] = {sweep->from[0], sweep->from[1], sweep->from[2]};
    const double to[3] = {sweep->to[0], sweep->to[1], sweep->to[2]};
    double a[3], b[3];
    sph__query_to_frame(q, from, a);
    sph__query_to_frame(q, to, b);
    c->any = any;
    return begin(c, q, a, b, sweep->radius * q->scale);
}

static void answer(const cast *c, sph_hit *hit)
{
    sph__contact contact;
    double x[3];
    hit->s = lesser(1, c->before + c->t * c->span);
    hit->depth = c->depth / c->query->scale;
    hit->hit = 1;
    hit->reserved0 = 0;
    sph__add_scaled(c->move.start, c->t, c->move.way, x);
    sph__primitive_closest(&c->query->solid.primitives[c->slot], x, &contact);
    sph__query_contact(c->query, c->slot, &contact, &hit->contact);
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
    const sph_status status = check(q, "sph_query_cast", sweeps, count, hits);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < count; ++i) {
        cast c;
        c.slot = UINT32_MAX;
        if (begin_sweep(&c, q, &sweeps[i], false)) search(&c);
        if (c.slot != UINT32_MAX) {
            answer(&c, &hits[i]);
        } else {
            hits[i] = (sph_hit){.s = 1};
            sph__query_no_contact(&hits[i].contact);
        }
    }
    return SPH_OK;
}

sph_status sph_query_cast_any(const sph_query *q, const sph_sweep *sweeps, size_t count, uint8_t *hits)
{
    const sph_status status = check(q, "sph_query_cast_any", sweeps, count, hits);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < count; ++i) {
        cast c;
        c.slot = UINT32_MAX;
        if (begin_sweep(&c, q, &sweeps[i], true)) search(&c);
        hits[i] = c.slot != UINT32_MAX;
    }
    return SPH_OK;
}

bool sph__query_cast_frame(const sph_query *q, const double from[3], const double to[3], double *t)
{
    cast c;
    c.slot = UINT32_MAX;
    c.any = false;
    *t = 1;
    if (begin(&c, q, from, to, 0)) search(&c);
    if (c.slot == UINT32_MAX) return false;
    *t = lesser(1, c.before + c.t * c.span);
    return true;
}
