/* SPDX-License-Identifier: MIT */
/* Distances of points. */
#include <float.h>
#include <math.h>

#include "query/query.h"

/* A point as the bounds see it: far ones are drawn to a cube around all boxes, which brings no box farther away. */
typedef struct probe {
    const sph_query *query;
    const double *x;
    float seen[3];
    float margin;
    double best; /* nothing beyond it is looked for */
    uint32_t slot;
    bool any;
} probe;

static void begin(probe *p, const sph_query *q, const double x[3], double best, bool any)
{
    float most = 0;
    p->query = q;
    p->x = x;
    for (int k = 0; k < 3; ++k) {
        p->seen[k] = x[k] > 1e3 ? 1e3f : x[k] < -1e3 ? -1e3f : (float)x[k];
        most = fmaxf(most, fabsf(p->seen[k]));
    }
    p->margin = 2e-6f * (1 + most);
    p->best = best;
    p->slot = UINT32_MAX;
    p->any = any;
}

static void consider(probe *p, uint32_t slot)
{
    const sph_query *q = p->query;
    double d;
    if (sph__query_fan_bound(&q->fans[slot], p->seen) - p->margin > p->best) return;
    d = sph__query_fan_distance(&q->fans[slot], p->x);
    if (d > p->best || (d == p->best && p->slot != UINT32_MAX && q->numbers[slot] > q->numbers[p->slot])) return;
    p->best = d;
    p->slot = slot;
}

static void search_range(probe *p, uint32_t range_begin, uint32_t range_end)
{
    float bound[SPH__QUERY_CHUNK];
    uint32_t slot[SPH__QUERY_CHUNK], count = 0, nearest = 0;
    const uint32_t size = range_end - range_begin;
    sph__query_kernel_distances(&p->query->bounds, range_begin, range_end, p->seen, bound);
    for (uint32_t i = 0; i < size; ++i) {
        bound[i] -= p->margin;
        if (bound[i] < bound[nearest]) nearest = i;
    }
    if (bound[nearest] > p->best) return;
    consider(p, range_begin + nearest);
    for (uint32_t i = 0; i < size; ++i) {
        slot[count] = i;
        count += bound[i] <= p->best && i != nearest;
    }
    while (count > 0) {
        uint32_t first = 0;
        for (uint32_t i = 1; i < count; ++i)
            if (bound[slot[i]] < bound[slot[first]]) first = i;
        if (bound[slot[first]] > p->best || (p->any && p->slot != UINT32_MAX)) return;
        consider(p, range_begin + slot[first]);
        slot[first] = slot[--count];
    }
}

/* As the kernel does it. */
static float bound_of(const sph__box *box, const float x[3])
{
    float sum = 0, most = -FLT_MAX;
    for (int k = 0; k < 3; ++k) {
        const float below = box->low[k] - x[k], above = x[k] - box->high[k];
        const float d = below > above ? below : above;
        most = d > most ? d : most;
        sum += d > 0 ? d * d : 0;
    }
    return most > 0 ? sqrtf(sum) : most;
}

static void search_tree(probe *p)
{
    const sph__box_tree *tree = &p->query->solid.tree;
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, -DBL_MAX};
    while (top > 0 && !(p->any && p->slot != UINT32_MAX)) {
        const sph__box_visit v = stack[--top];
        const uint32_t half = sph__box_visit_middle(&v), left = 2 * v.node;
        sph__box_visit a, b;
        if (v.bound > p->best) continue;
        if (sph__box_tree_is_leaf(tree, v.node)) {
            search_range(p, v.begin, v.end);
            continue;
        }
        a = (sph__box_visit){left, v.begin, half, bound_of(&tree->nodes[left], p->seen) - p->margin};
        b = (sph__box_visit){left + 1, half, v.end, bound_of(&tree->nodes[left + 1], p->seen) - p->margin};
        if (a.bound <= b.bound) {
            const sph__box_visit t = a;
            a = b;
            b = t;
        }
        stack[top++] = a;
        stack[top++] = b;
    }
}

static void search(probe *p)
{
    const uint32_t count = p->query->primitive_count;
    if (!p->query->is_exhaustive) {
        search_tree(p);
        return;
    }
    for (uint32_t i = 0; i < count && !(p->any && p->slot != UINT32_MAX); i += SPH__QUERY_CHUNK)
        search_range(p, i, count - i < SPH__QUERY_CHUNK ? count : i + SPH__QUERY_CHUNK);
}

double sph__query_distance(const sph_query *q, const double x[3], uint32_t *slot)
{
    probe p;
    begin(&p, q, x, DBL_MAX, false);
    search(&p);
    *slot = p.slot;
    return p.best;
}

bool sph__query_covers(const sph_query *q, const double x[3], double margin)
{
    probe p;
    begin(&p, q, x, margin, true);
    search(&p);
    return p.slot != UINT32_MAX;
}

sph_status sph_query_nearest(const sph_query *q, const float *points, size_t stride, size_t count, sph_nearest *nearest)
{
    SPH__OWN(q, SPH__QUERY);
    sph_status status;
    if (q == NULL || (nearest == NULL && count != 0))
        return sph__fail(q == NULL ? NULL : q->context, SPH_E_INVALID, "sph_query_nearest: an argument is NULL");
    if ((status = sph__query_check_points(q, "sph_query_nearest", points, &stride, count)) != SPH_OK) return status;
    for (size_t i = 0; i < count; ++i) {
        sph__contact contact;
        uint32_t slot;
        float f[3];
        double x[3];
        memcpy(f, (const char *)points + i * stride, sizeof f);
        sph__query_to_frame(q, (const double[3]){f[0], f[1], f[2]}, x);
        sph__query_distance(q, x, &slot);
        sph__primitive_closest(&q->solid.primitives[slot], x, &contact);
        nearest[i].distance = contact.distance / q->scale;
        sph__query_contact(q, slot, &contact, &nearest[i].contact);
    }
    return SPH_OK;
}
