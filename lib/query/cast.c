/* SPDX-License-Identifier: MIT */
/*
 * Casts. Along a segment the signed distance to a convex primitive, less the radius of what moves, is convex; so Newton's
 * method from before the first root climbs down to it and never passes it, whatever the primitive degenerates to. Bounds
 * tell which primitives to look at, and where to begin.
 */
#include <float.h>
#include <math.h>

#include "numeric/vector.h"
#include "query/query.h"

enum { MOST_STEPS = 100 };

/* One cast, in the frame of the pose, cut to where the segment is near the solid: start + t * way, 0 <= t <= 1. */
typedef struct cast {
    const sph_query *query;
    double start[3], way[3], radius;
    double before, span; /* s = before + t * span */
    double tolerance;    /* a distance that counts as touching */
    bool use_bounds, any;
    sph__query_ray ray;
    /* the best so far: the least t, of these the deepest, of these the lowest number */
    uint32_t slot; /* UINT32_MAX: none */
    double t, depth;
} cast;

/* Cuts [*enter, *leave] of from + s * way to the slab |x| <= half; false when nothing is left. */
static bool cut(double from, double way, double half, double *enter, double *leave)
{
    const double inverse = 1 / way;
    double first, last;
    if (!(fabs(way) > 1e-290)) return fabs(from) <= half;
    first = (-half - from) * inverse;
    last = (half - from) * inverse;
    if (first > last) {
        const double t = first;
        first = last;
        last = t;
    }
    *enter = fmax(*enter, first);
    *leave = fmin(*leave, last);
    return *enter <= *leave;
}

static double largest(const double x[3])
{
    return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
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
    c->radius = radius;
    c->before = enter;
    c->span = leave - enter;
    for (int k = 0; k < 3; ++k) {
        c->start[k] = from[k] + enter * way[k];
        c->way[k] = c->span * way[k];
    }
    c->tolerance = 1e-14 * (1 + radius);
    c->use_bounds = radius + margin < 1e3;
    if (c->use_bounds) sph__query_ray_set(&c->ray, c->start, c->way, radius + margin);
    c->slot = UINT32_MAX;
    c->t = 2;
    c->depth = 0;
    return true;
}

/* The first t >= `t` at which the primitive is touched; false: none up to min(1, the best so far). */
static bool approach(const cast *c, const sph__primitive *p, double *t, double *depth)
{
    double at = *t;
    for (int i = 0; i < MOST_STEPS; ++i) {
        double x[3], slope, f, next;
        sph__add_scaled(c->start, at, c->way, x);
        f = sph__primitive_slope(p, x, c->way, &slope) - c->radius;
        if (f <= c->tolerance) {
            *t = at;
            *depth = f < 0 && at == 0 && c->before == 0 ? -f : 0;
            return true;
        }
        if (!(slope < 0)) return false;
        next = at - f / slope;
        if (!(next <= 1)) {
            if (!(next <= 1 + 1e-12) || at == 1) return false;
            next = 1;
        }
        if (next > c->t) return false;
        if (next == at) next = nextafter(at, 2);
        at = next;
    }
    return false;
}

static void consider(cast *c, uint32_t slot, double t)
{
    const sph_query *q = c->query;
    double depth;
    if (!approach(c, &q->solid.primitives[slot], &t, &depth)) return;
    if (c->slot != UINT32_MAX) {
        if (t > c->t || (t == c->t && depth < c->depth)) return;
        if (t == c->t && depth == c->depth && q->numbers[slot] > q->numbers[c->slot]) return;
    }
    c->slot = slot;
    c->t = t;
    c->depth = depth;
}

/* Slots [begin, end), at most a chunk, in the order in which their bounds are entered. */
static void search_range(cast *c, uint32_t range_begin, uint32_t range_end)
{
    float entry[SPH__QUERY_CHUNK];
    uint32_t slot[SPH__QUERY_CHUNK];
    const uint32_t size = range_end - range_begin;
    uint32_t count = 0;
    if (!c->use_bounds) {
        for (uint32_t i = range_begin; i < range_end && !(c->any && c->slot != UINT32_MAX); ++i)
            consider(c, i, 0);
        return;
    }
    sph__query_kernel_entries(&c->query->bounds, range_begin, range_end, &c->ray, entry);
    for (uint32_t i = 0; i < size; ++i) {
        slot[count] = i;
        count += entry[i] <= 1;
    }
    while (count > 0) {
        uint32_t first = 0;
        for (uint32_t i = 1; i < count; ++i)
            if (entry[slot[i]] < entry[slot[first]]) first = i;
        if (entry[slot[first]] > c->t || (c->any && c->slot != UINT32_MAX)) return;
        consider(c, range_begin + slot[first], entry[slot[first]]);
        slot[first] = slot[--count];
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
    hit->s = fmin(1, c->before + c->t * c->span);
    hit->depth = c->depth / c->query->scale;
    hit->hit = 1;
    hit->reserved0 = 0;
    sph__add_scaled(c->start, c->t, c->way, x);
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
    *t = fmin(1, c.before + c.t * c.span);
    return true;
}
