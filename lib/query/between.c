/* SPDX-License-Identifier: MIT */
/*
 * Two posed levels. The gap between a sphere interpolated over one primitive and the nearest of another, |c - d| - r -
 * t, is convex in the weights of the first; its least value is found by cutting the polygon of possible weights through
 * its middle. Along a motion the gap of a pair is convex as well.
 */
#include <float.h>
#include <math.h>

#include "numeric/vector.h"
#include "query/query.h"

enum { MOST_CUTS = 200, MOST_CORNERS = MOST_CUTS + 4, MOST_STEPS = 100 };

static const double EXACT = 1e-10, TOUCHING = 1e-8; /* in the frame of the second level */

/* The sphere of `first` that comes nearest to `second`. */
typedef struct meeting {
    double gap;
    double weights[3]; /* of the sphere on first */
    double center[3], radius;
    sph__contact on_second;
} meeting;

/* What weights are still possible: a polygon of weights of corners 1 and 2. */
typedef struct polygon {
    int count;
    double x[MOST_CORNERS][2];
} polygon;

static void sphere_at(const sph__primitive *p, double b1, double b2, meeting *m)
{
    const double b[3] = {1 - b1 - b2, b1, b2};
    memset(m->center, 0, sizeof m->center);
    m->radius = 0;
    for (int32_t i = 0; i < p->corner_count; ++i) {
        m->weights[i] = fmax(0, b[i]);
        sph__add_scaled(m->center, m->weights[i], p->center[i], m->center);
        m->radius += m->weights[i] * p->radius[i];
    }
}

/* The gap there, and its gradient by the weights of corners 1 and 2. */
static void evaluate(const sph__primitive *first, const sph__primitive *second, const double b[2], meeting *m,
                     double gradient[2])
{
    double d[3];
    memset(m, 0, sizeof *m);
    sphere_at(first, b[0], b[1], m);
    sph__primitive_closest(second, m->center, &m->on_second);
    m->gap = m->on_second.distance - m->radius;
    for (int32_t i = 1; i < 3; ++i) {
        gradient[i - 1] = 0;
        if (i >= first->corner_count) continue;
        sph__subtract(first->center[i], first->center[0], d);
        gradient[i - 1] = sph__dot(m->on_second.normal, d) - (first->radius[i] - first->radius[0]);
    }
}

/* The centre of area; the mean of the corners where there is no area. */
static void middle_of(const polygon *p, double out[2])
{
    double area = 0, sum[2] = {0, 0}, mean[2] = {0, 0};
    for (int i = 0; i < p->count; ++i) {
        mean[0] += p->x[i][0] / p->count;
        mean[1] += p->x[i][1] / p->count;
    }
    for (int i = 2; i < p->count; ++i) {
        const double u[2] = {p->x[i - 1][0] - p->x[0][0], p->x[i - 1][1] - p->x[0][1]};
        const double v[2] = {p->x[i][0] - p->x[0][0], p->x[i][1] - p->x[0][1]};
        const double part = u[0] * v[1] - u[1] * v[0];
        area += part;
        sum[0] += part * (u[0] + v[0]);
        sum[1] += part * (u[1] + v[1]);
    }
    out[0] = mean[0];
    out[1] = mean[1];
    if (!(fabs(area) > 1e-300)) return;
    out[0] = p->x[0][0] + sum[0] / (3 * area);
    out[1] = p->x[0][1] + sum[1] / (3 * area);
}

/* Keeps what has (x - middle) . gradient <= 0. */
static void cut_polygon(polygon *p, const double middle[2], const double gradient[2])
{
    polygon kept;
    kept.count = 0;
    for (int i = 0; i < p->count; ++i) {
        const double *a = p->x[i], *b = p->x[(i + 1) % p->count];
        const double fa = (a[0] - middle[0]) * gradient[0] + (a[1] - middle[1]) * gradient[1];
        const double fb = (b[0] - middle[0]) * gradient[0] + (b[1] - middle[1]) * gradient[1];
        if (fa <= 0) memcpy(kept.x[kept.count++], a, sizeof kept.x[0]);
        if (p->count == 2 && i == 1) continue; /* a segment has one side */
        if ((fa < 0 && fb > 0) || (fa > 0 && fb < 0)) {
            const double t = fa / (fa - fb);
            kept.x[kept.count][0] = a[0] + t * (b[0] - a[0]);
            kept.x[kept.count++][1] = a[1] + t * (b[1] - a[1]);
        }
    }
    p->count = kept.count;
    memcpy(p->x, kept.x, (size_t)kept.count * sizeof kept.x[0]);
}

/* The least gap of the pair; gives up, false, once it cannot be below `enough`. */
static bool meet(const sph__primitive *first, const sph__primitive *second, double enough, meeting *best)
{
    static const double CORNERS[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    polygon p = {.count = first->corner_count};
    memcpy(p.x, CORNERS, sizeof CORNERS);
    best->gap = DBL_MAX;
    for (int i = 0; i < MOST_CUTS && p.count > 0; ++i) {
        double middle[2], gradient[2], least = 0;
        meeting m;
        middle_of(&p, middle);
        evaluate(first, second, middle, &m, gradient);
        if (m.gap < best->gap) *best = m;
        for (int k = 0; k < p.count; ++k)
            least = fmin(least, (p.x[k][0] - middle[0]) * gradient[0] + (p.x[k][1] - middle[1]) * gradient[1]);
        if (m.gap + least > enough) return false; /* a convex function is above its tangents */
        if (best->gap - (m.gap + least) <= EXACT) break;
        cut_polygon(&p, middle, gradient);
    }
    return best->gap <= enough;
}

/* A primitive of the first level, in the frame of the second, moved by `shift`. */
static void carry(const sph_query *first, uint32_t slot, const sph_query *second, const double shift[3],
                  sph__primitive *out)
{
    const sph__solid *s = &first->solid;
    const int32_t count = s->corner_counts[slot];
    double c[3][3], r[3];
    for (int32_t i = 0; i < count; ++i) {
        sph__query_to_frame(second, s->centers[s->corners[slot][i]], c[i]);
        for (int k = 0; k < 3; ++k)
            c[i][k] += shift[k];
        r[i] = s->radii[s->corners[slot][i]] * second->scale;
    }
    sph__primitive_set(out, count, (const double(*)[3])c, r);
}

static void fill_gap(const sph_query *first, uint32_t slot, const sph_query *second, uint32_t other, const meeting *m,
                     double s, sph_gap *gap)
{
    sph__contact on_first = {0};
    const double unit = 1 / second->scale;
    *gap = (sph_gap){.s = s, .distance = m->gap * unit, .hit = m->gap <= TOUCHING};
    memcpy(on_first.weights, m->weights, sizeof m->weights);
    sph__query_contact(first, slot, &on_first, &gap->first);
    sph__query_contact(second, other, &m->on_second, &gap->second);
    for (int k = 0; k < 3; ++k) {
        gap->first.normal[k] = -m->on_second.normal[k];
        gap->first.point[k] = (m->center[k] - m->radius * m->on_second.normal[k]) * unit + second->origin[k];
    }
}

/* --- searching pairs --- */

typedef struct search {
    const sph_query *first, *second;
    double motion[3]; /* in the frame of the second; 0 without one */
    bool moves;
    /* of the primitive of the first whose turn it is */
    uint32_t slot;
    sph__primitive carried;
    double low[3], high[3];
    /* the best so far */
    meeting best;
    double limit; /* a gap, or an s with a motion */
    uint32_t best_slot, best_other;
} search;

/* No pair in this box and that of the carried primitive has a lesser gap. */
static double gap_bound(const search *s, const sph__box *box)
{
    double sum = 0, most = -DBL_MAX;
    for (int k = 0; k < 3; ++k) {
        const double margin = 2e-6 * (1 + fabs(s->low[k]) + fabs(s->high[k]));
        const double d = fmax(box->low[k] - s->high[k], s->low[k] - box->high[k]) - margin;
        most = fmax(most, d);
        sum += d > 0 ? d * d : 0;
    }
    return most > 0 ? sqrt(sum) : most;
}

/* No pair touches before this s; above 1 where none does. */
static double touch_bound(const search *s, const sph__box *box)
{
    double enter = 0, leave = 1;
    for (int k = 0; k < 3; ++k) {
        const double margin = 2e-6 * (1 + fabs(s->low[k]) + fabs(s->high[k]) + fabs(s->motion[k]));
        const double a = box->low[k] - s->high[k] - margin, b = box->high[k] - s->low[k] + margin, v = s->motion[k];
        if (fabs(v) < 1e-290) {
            if (a > 0 || b < 0) return 2;
            continue;
        }
        enter = fmax(enter, fmin(a / v, b / v));
        leave = fmin(leave, fmax(a / v, b / v));
    }
    return enter <= leave ? enter : 2;
}

static double bound_of(const search *s, const sph__box *box)
{
    return s->moves ? touch_bound(s, box) : gap_bound(s, box);
}

/* The gap of the pair at s, and its slope. */
static bool meet_at(const search *s, const sph__primitive *other, double at, double enough, meeting *m, double *slope)
{
    double shift[3];
    sph__primitive moved;
    for (int k = 0; k < 3; ++k)
        shift[k] = at * s->motion[k];
    carry(s->first, s->slot, s->second, shift, &moved);
    if (!meet(&moved, other, enough, m)) return false;
    *slope = sph__dot(m->on_second.normal, s->motion);
    return true;
}

/* First touch of the pair from `at` on, where it is apart; up to the limit. */
static bool touch(const search *s, const sph__primitive *other, double at, double *found, meeting *m)
{
    double apart = at, through = 2; /* known to be so; 2: not known */
    for (int i = 0; i < MOST_STEPS; ++i) {
        double slope, next;
        if (!meet_at(s, other, at, DBL_MAX, m, &slope)) return false;
        *found = at;
        if (fabs(m->gap) <= TOUCHING) return true;
        if (m->gap < 0) {
            through = at;
        } else {
            apart = at;
            if (!(slope < 0) && through > 1) return false;
        }
        if (through <= 1 && through - apart < 1e-15) return true;
        next = slope < 0 && m->gap > 0 ? at - m->gap / slope : 2;
        if (through <= 1 && !(next > apart && next < through)) next = 0.5 * (apart + through);
        if (next > s->limit) return false;
        at = next;
    }
    return true;
}

static void consider(search *s, uint32_t other)
{
    const sph__primitive *p = &s->second->solid.primitives[other];
    const double bound = bound_of(s, &s->second->solid.boxes[other]);
    meeting m;
    double found = 0;
    if (bound > s->limit) return;
    if (!s->moves) {
        if (!meet(&s->carried, p, s->limit, &m) || (s->best_slot != UINT32_MAX && m.gap >= s->best.gap)) return;
        s->limit = m.gap;
    } else {
        if (!touch(s, p, bound, &found, &m) || (s->best_slot != UINT32_MAX && found >= s->limit)) return;
        s->limit = found;
    }
    s->best = m;
    s->best_slot = s->slot;
    s->best_other = other;
}

static void search_second(search *s)
{
    const sph__box_tree *tree = &s->second->solid.tree;
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    for (uint32_t i = 0; s->second->is_exhaustive && i < s->second->primitive_count; ++i)
        consider(s, i);
    if (!s->second->is_exhaustive) stack[top++] = (sph__box_visit){1, 0, tree->item_count, -DBL_MAX};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        const uint32_t half = sph__box_visit_middle(&v), left = 2 * v.node;
        if (v.bound > s->limit) continue;
        for (uint32_t i = v.begin; sph__box_tree_is_leaf(tree, v.node) && i < v.end; ++i)
            consider(s, i);
        if (sph__box_tree_is_leaf(tree, v.node)) continue;
        stack[top++] = (sph__box_visit){left, v.begin, half, bound_of(s, &tree->nodes[left])};
        stack[top++] = (sph__box_visit){left + 1, half, v.end, bound_of(s, &tree->nodes[left + 1])};
    }
}

static void search_pairs(search *s)
{
    static const double STILL[3] = {0, 0, 0};
    s->best_slot = UINT32_MAX;
    for (uint32_t i = 0; i < s->first->primitive_count; ++i) {
        s->slot = i;
        carry(s->first, i, s->second, STILL, &s->carried);
        sph__primitive_bounds(&s->carried, s->low, s->high);
        search_second(s);
    }
}

/* Something that the least gap is not above: that of single spheres of the first. */
static double least_of_spheres(const sph_query *first, const sph_query *second)
{
    double least = DBL_MAX;
    for (uint32_t i = 0; i < first->sphere_count; ++i) {
        double x[3];
        uint32_t slot;
        sph__query_to_frame(second, first->solid.centers[i], x);
        least = fmin(least, sph__query_distance(second, x, &slot) - first->solid.radii[i] * second->scale);
    }
    return least + 2 * EXACT;
}

sph_status sph_query_between(const sph_query *first, const sph_query *second, sph_gap *gap)
{
    SPH__OWN(first, SPH__QUERY);
    SPH__OWN(second, SPH__QUERY);
    search s = {.first = first, .second = second};
    if (first == NULL || second == NULL || gap == NULL)
        return sph__fail(first != NULL    ? first->context
                         : second != NULL ? second->context
                                          : NULL,
                         SPH_E_INVALID, "sph_query_between: an argument is NULL");
    s.limit = least_of_spheres(first, second);
    search_pairs(&s);
    fill_gap(first, s.best_slot, second, s.best_other, &s.best, 0, gap);
    return SPH_OK;
}

sph_status sph_query_cast_between(const sph_query *first, const float motion[3], const sph_query *second, sph_gap *gap)
{
    SPH__OWN(first, SPH__QUERY);
    SPH__OWN(second, SPH__QUERY);
    search s = {.first = first, .second = second, .moves = true, .limit = 1};
    sph_gap still;
    sph_status status;
    if (first == NULL || motion == NULL || second == NULL || gap == NULL)
        return sph__fail(first != NULL    ? first->context
                         : second != NULL ? second->context
                                          : NULL,
                         SPH_E_INVALID, "sph_query_cast_between: an argument is NULL");
    if (!isfinite(motion[0]) || !isfinite(motion[1]) || !isfinite(motion[2]))
        return sph__fail(first->context, SPH_E_INVALID, "sph_query_cast_between: the motion is not finite");
    if ((status = sph_query_between(first, second, &still)) != SPH_OK) return status;
    if (still.hit) {
        *gap = still;
        return SPH_OK;
    }
    for (int k = 0; k < 3; ++k)
        s.motion[k] = motion[k] * second->scale;
    search_pairs(&s);
    if (s.best_slot == UINT32_MAX) {
        *gap = (sph_gap){.s = 1};
        sph__query_no_contact(&gap->first);
        sph__query_no_contact(&gap->second);
        return SPH_OK;
    }
    fill_gap(first, s.best_slot, second, s.best_other, &s.best, s.limit, gap);
    gap->hit = 1;
    return SPH_OK;
}
