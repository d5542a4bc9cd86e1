/* SPDX-License-Identifier: MIT */
#include "level/solid.h"

#include <float.h>

#include "numeric/vector.h"

/* Signed distance from x to the box: no primitive in it can have a lesser one. */
static inline double signed_distance(const sph__box *box, const double x[3])
{
    double sum = 0, most = -DBL_MAX;
    for (int k = 0; k < 3; ++k) {
        const double below = box->low[k] - x[k], above = x[k] - box->high[k];
        const double d = below > above ? below : above;
        if (d > most) most = d;
        sum += d > 0 ? d * d : 0;
    }
    return most > 0 ? sqrt(sum) : most;
}

/* Puts the children on the stack, the nearer one on top, where they are not beyond `limit`. */
static inline int push_children(const sph__box_tree *tree, const sph__box_visit *v, const double x[3], double limit,
                                sph__box_visit *stack, int top)
{
    const uint32_t half = sph__box_visit_middle(v), left = 2 * v->node;
    const sph__box_visit a = {left, v->begin, half, signed_distance(&tree->nodes[left], x)};
    const sph__box_visit b = {left + 1, half, v->end, signed_distance(&tree->nodes[left + 1], x)};
    const sph__box_visit *near = a.bound <= b.bound ? &a : &b, *far = near == &a ? &b : &a;
    if (far->bound <= limit) stack[top++] = *far;
    if (near->bound <= limit) stack[top++] = *near;
    return top;
}

double sph__solid_distance(const sph__solid *solid, const double x[3], uint32_t *nearest)
{
    const sph__box_tree *tree = &solid->tree;
    sph__box_visit stack[SPH__BOX_STACK];
    double best = DBL_MAX;
    uint32_t which = UINT32_MAX;
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, -DBL_MAX};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        if (v.bound > best) continue;
        if (!sph__box_tree_is_leaf(tree, v.node)) {
            top = push_children(tree, &v, x, best, stack, top);
            continue;
        }
        for (uint32_t i = v.begin; i < v.end; ++i) {
            const uint32_t p = tree->order[i];
            const double d = sph__primitive_distance(&solid->primitives[p], x);
            if (d > best || (d == best && p > which)) continue;
            best = d;
            which = p;
        }
    }
    if (nearest != NULL) *nearest = which;
    return best;
}

bool sph__solid_covers(const sph__solid *solid, const double x[3], double margin, uint32_t *which)
{
    const sph__box_tree *tree = &solid->tree;
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, -DBL_MAX};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        if (!sph__box_tree_is_leaf(tree, v.node)) {
            top = push_children(tree, &v, x, margin, stack, top);
            continue;
        }
        for (uint32_t i = v.begin; i < v.end; ++i) {
            if (sph__primitive_distance(&solid->primitives[tree->order[i]], x) >= margin) continue;
            if (which != NULL) *which = tree->order[i];
            return true;
        }
    }
    return false;
}

uint32_t sph__solid_gather(const sph__solid *solid, const double x[3], double radius, uint32_t *found,
                           uint32_t capacity)
{
    const sph__box_tree *tree = &solid->tree;
    sph__box_visit stack[SPH__BOX_STACK];
    uint32_t count = 0;
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, -DBL_MAX};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        if (!sph__box_tree_is_leaf(tree, v.node)) {
            top = push_children(tree, &v, x, radius, stack, top);
            continue;
        }
        for (uint32_t i = v.begin; i < v.end; ++i) {
            if (sph__primitive_distance(&solid->primitives[tree->order[i]], x) >= radius) continue;
            if (count < capacity) found[count] = tree->order[i];
            ++count;
        }
    }
    return count;
}

/* Does the ray meet the box at some s in [0, limit]? `inverse` is 1 / direction; the box is closed. */
static inline bool meets(const sph__box *box, const double origin[3], const double inverse[3], double limit)
{
    double enter = 0, leave = limit;
    for (int k = 0; k < 3; ++k) {
        const double a = (box->low[k] - origin[k]) * inverse[k], b = (box->high[k] - origin[k]) * inverse[k];
        const double first = a < b ? a : b, last = a < b ? b : a;
        if (first > enter) enter = first;
        if (last < leave) leave = last;
    }
    return enter <= leave;
}

/* The first hit, or with `any` some hit. */
static bool cast(const sph__solid *solid, const double origin[3], const double direction[3], double limit, bool any,
                 double *s, uint32_t *which)
{
    const sph__box_tree *tree = &solid->tree;
    sph__box_visit stack[SPH__BOX_STACK];
    double inverse[3], best = limit;
    uint32_t hit = UINT32_MAX;
    int top = 0;
    /* a component of 0 becomes tiny: then no product below is 0 * infinity */
    for (int k = 0; k < 3; ++k)
        inverse[k] = 1 / (fabs(direction[k]) > 1e-200 ? direction[k] : 1e-200);
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, 0};
    while (top > 0 && !(any && hit != UINT32_MAX)) {
        const sph__box_visit v = stack[--top];
        if (!meets(&tree->nodes[v.node], origin, inverse, best)) continue;
        if (!sph__box_tree_is_leaf(tree, v.node)) {
            const uint32_t half = sph__box_visit_middle(&v);
            stack[top++] = (sph__box_visit){2 * v.node, v.begin, half, 0};
            stack[top++] = (sph__box_visit){2 * v.node + 1, half, v.end, 0};
            continue;
        }
        for (uint32_t i = v.begin; i < v.end; ++i) {
            const uint32_t p = tree->order[i];
            double t;
            if (!meets(&solid->boxes[p], origin, inverse, best)) continue;
            if (!sph__primitive_cast(&solid->primitives[p], origin, direction, best, &t)) continue;
            if (t == best && p > hit) continue;
            best = t;
            hit = p;
        }
    }
    if (hit == UINT32_MAX) return false;
    *s = best;
    *which = hit;
    return true;
}

bool sph__solid_cast(const sph__solid *solid, const double origin[3], const double direction[3], double limit,
                     double *s, uint32_t *which)
{
    return cast(solid, origin, direction, limit, false, s, which);
}

bool sph__solid_is_clear(const sph__solid *solid, const double a[3], const double b[3])
{
    double d[3], s;
    uint32_t which;
    sph__subtract(b, a, d);
    return !cast(solid, a, d, 1, true, &s, &which);
}

bool sph__solid_escapes(const sph__solid *solid, const double origin[3], const double direction[3])
{
    double s;
    uint32_t which;
    return !cast(solid, origin, direction, DBL_MAX, true, &s, &which);
}

void sph__solid_pose(sph__solid *solid, const float *centers, const float *radii, double enlarge)
{
    for (uint32_t i = 0; i < solid->sphere_count; ++i) {
        for (size_t k = 0; k < 3; ++k)
            solid->centers[i][k] = centers[3 * (size_t)i + k];
        solid->radii[i] = radii[i] + enlarge;
    }
    for (uint32_t i = 0; i < solid->primitive_count; ++i) {
        double c[3][3], r[3], low[3], high[3];
        for (int32_t k = 0; k < solid->corner_counts[i]; ++k) {
            sph__copy3(solid->centers[solid->corners[i][k]], c[k]);
            r[k] = solid->radii[solid->corners[i][k]];
        }
        sph__primitive_set(&solid->primitives[i], solid->corner_counts[i], (const double(*)[3])c, r);
        sph__primitive_bounds(&solid->primitives[i], low, high);
        sph__box_set(&solid->boxes[i], low, high);
    }
    sph__box_tree_build(&solid->tree, solid->boxes, solid->primitive_count, SPH__SOLID_LEAF);
}

void sph__solid_free(sph__solid *solid)
{
    const sph_context *context = solid->context;
    if (context == NULL) return;
    sph__free(context, solid->triangles);
    sph__free(context, solid->edges);
    sph__free(context, solid->corners);
    sph__free(context, solid->corner_counts);
    sph__free(context, solid->centers);
    sph__free(context, solid->radii);
    sph__free(context, solid->primitives);
    sph__free(context, solid->boxes);
    sph__box_tree_free(&solid->tree);
    memset(solid, 0, sizeof *solid);
}
