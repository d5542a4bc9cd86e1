/* SPDX-License-Identifier: MIT */
/*
 * Which points are connected to infinity. Two points are joined when a path of one or two free segments leads from one
 * to the other, a point and infinity when a free ray leads away: so everything joined truly is connected, nothing
 * leaks, and the points that are joined to infinity by no chain are taken for ones in cavities.
 */
#include "measure/measure.h"

#include <float.h>

#include "numeric/vector.h"

enum { NEIGHBOURS = 8, MEMBERS = 48, DIRECTIONS = 9, ROUNDS = 3, LEAF_SIZE = 4 };

/* --- paths --- */

/* Over the top of a bulge: to where both tangent planes are below, and down again. */
static bool join_over(const sph__solid *solid, const sph__surface_point *a, const sph__surface_point *b)
{
    double up[3], middle[3], top[3], rise = 0, length;
    for (int k = 0; k < 3; ++k) {
        up[k] = a->normal[k] + b->normal[k];
        middle[k] = 0.5 * (a->position[k] + b->position[k]);
    }
    length = sph__norm(up);
    if (length < 0.8) return false; /* back to back */
    for (int k = 0; k < 3; ++k)
        up[k] /= length;
    for (int end = 0; end < 2; ++end) {
        const sph__surface_point *p = end == 0 ? a : b;
        double d[3];
        sph__subtract(p->position, middle, d);
        rise = fmax(rise, sph__dot(d, p->normal) / sph__dot(up, p->normal));
    }
    sph__add_scaled(middle, rise + 0.05 * sph__distance(a->position, b->position), up, top);
    return sph__solid_is_clear(solid, a->position, top) && sph__solid_is_clear(solid, top, b->position);
}

static bool join(const sph__solid *solid, const sph__surface_point *a, const sph__surface_point *b)
{
    double d[3];
    sph__subtract(b->position, a->position, d);
    if (sph__dot(a->normal, d) > 0 && sph__dot(b->normal, d) < 0) /* they face each other */
        return sph__solid_is_clear(solid, a->position, b->position);
    return join_over(solid, a, b);
}

/* A direction on the outer side of `normal`; number 0 is the normal. */
static void choose_direction(const double normal[3], int number, double out[3])
{
    const double angle = 2.399963229728653 * number, z = 1 - (double)number / DIRECTIONS, r = sqrt(1 - z * z);
    double a[3], b[3];
    sph__perpendicular(normal, a);
    sph__cross(normal, a, b);
    for (int k = 0; k < 3; ++k)
        out[k] = z * normal[k] + r * (cos(angle) * a[k] + sin(angle) * b[k]);
}

/* Where the ray from `position` lands, just off the solid; false when it goes to infinity. */
static bool land(const sph__outer *outer, const double position[3], const double direction[3],
                 sph__surface_point *landing)
{
    double s, x[3];
    uint32_t which;
    sph__contact c;
    if (!sph__solid_cast(&outer->solid, position, direction, DBL_MAX, &s, &which)) return false;
    sph__add_scaled(position, s, direction, x);
    sph__primitive_closest(&outer->solid.primitives[which], x, &c);
    sph__copy3(c.normal, landing->normal);
    sph__add_scaled(c.point, outer->lift, c.normal, landing->position);
    return true;
}

/* --- sets of points that are joined --- */

static uint32_t find(uint32_t *parents, uint32_t i)
{
    while (parents[i] != i)
        i = parents[i] = parents[parents[i]];
    return i;
}

static void unite(uint32_t *parents, uint32_t a, uint32_t b)
{
    a = find(parents, a);
    b = find(parents, b);
    if (a < b) /* the higher one is the root: infinity is the highest */
        parents[a] = b;
    else
        parents[b] = a;
}

/* Joins a point (of the set `self`) with its neighbours of other sets; with only one of them if `once`. */
static void join_neighbours(sph__outer *outer, const sph__surface_point *from, uint32_t self, bool once)
{
    sph__neighbour found[NEIGHBOURS];
    const uint32_t count = sph__outer_nearest(outer, &outer->all_tree, from->position, INFINITY, NEIGHBOURS, found);
    uint32_t *parents = outer->parents;
    for (uint32_t k = 0; k < count; ++k) {
        const uint32_t other = found[k].point;
        if (!once && find(parents, self) == find(parents, other)) continue;
        if (!join(&outer->solid, from, &outer->points[other])) continue;
        unite(parents, self, other);
        if (once) return;
    }
}

static void join_by_ray(sph__outer *outer, uint32_t i, int number)
{
    const sph__surface_point *p = &outer->points[i];
    double direction[3];
    sph__surface_point landing;
    choose_direction(p->normal, number, direction);
    if (land(outer, p->position, direction, &landing))
        join_neighbours(outer, &landing, i, true);
    else
        unite(outer->parents, i, outer->point_count);
}

/*
 * Rays from some members of every set that is not joined to infinity yet. `members` counts how often a set has had its
 * turn.
 */
static void join_sets_by_rays(sph__outer *outer, uint32_t *members)
{
    const uint32_t infinity = outer->point_count;
    memset(members, 0, (size_t)outer->point_count * sizeof *members);
    for (uint32_t i = 0; i < outer->point_count; ++i) {
        const uint32_t root = find(outer->parents, i);
        uint32_t turn;
        if (root == find(outer->parents, infinity)) continue;
        turn = members[root]++;
        if (turn >= MEMBERS && (turn & (turn - 1)) != 0) continue; /* then only every so often */
        for (int number = 0; number < DIRECTIONS; ++number)
            join_by_ray(outer, i, number);
    }
}

static bool set_boxes(sph__outer *outer)
{
    if (!sph__reserve(outer->context, (void **)&outer->boxes, &outer->box_capacity, outer->point_count,
                      sizeof *outer->boxes))
        return false;
    for (uint32_t i = 0; i < outer->point_count; ++i)
        sph__box_set(&outer->boxes[i], outer->points[i].position, outer->points[i].position);
    return true;
}

/* Over the first `count` points. */
static bool build_tree(sph__outer *outer, sph__box_tree *tree, uint32_t count)
{
    if (sph__box_tree_reserve(tree, outer->context, count, LEAF_SIZE) != SPH_OK) return false;
    sph__box_tree_build(tree, outer->boxes, count, LEAF_SIZE);
    return true;
}

static void join_all(sph__outer *outer, uint32_t *members)
{
    const uint32_t infinity = outer->point_count;
    uint32_t *parents = outer->parents;
    for (uint32_t i = 0; i <= infinity; ++i)
        parents[i] = i;
    for (uint32_t i = 0; i < infinity; ++i)
        if (sph__solid_escapes(&outer->solid, outer->points[i].position, outer->points[i].normal))
            unite(parents, i, infinity);
    for (uint32_t i = 0; i < infinity; ++i)
        if (find(parents, i) != find(parents, infinity)) join_neighbours(outer, &outer->points[i], i, false);
    for (int round = 0; round < ROUNDS; ++round)
        join_sets_by_rays(outer, members);
}

/* --- sorting --- */

/* The points by kind, each in its old order. `sorted` has room for all. */
static void sort_points(sph__outer *outer, sph__surface_point *sorted)
{
    uint32_t next = 0, ends[3];
    for (uint32_t kind = 0; kind < 3; ++kind) {
        for (uint32_t i = 0; i < outer->point_count; ++i)
            if (outer->points[i].kind == kind) sorted[next++] = outer->points[i];
        ends[kind] = next;
    }
    memcpy(outer->points, sorted, outer->point_count * sizeof *sorted);
    outer->extreme_begin = ends[SPH__POINT_SPREAD];
    outer->outer_count = ends[SPH__POINT_EXTREME];
}

/* Marks the primitives that touch a cavity. */
static void mark_cavities(sph__outer *outer)
{
    enum { MOST = 64 };
    const double reach = 4 * outer->lift;
    memset(outer->touches_cavity, 0, outer->solid.primitive_count * sizeof *outer->touches_cavity);
    for (uint32_t i = outer->outer_count; i < outer->point_count; ++i) {
        const sph__surface_point *p = &outer->points[i];
        uint32_t found[MOST];
        const uint32_t count = sph__solid_gather(&outer->solid, p->position, reach, found, MOST);
        for (uint32_t k = 0; k < count && k < MOST; ++k)
            outer->touches_cavity[found[k]] = true;
    }
    outer->has_cavities = outer->outer_count < outer->point_count;
}

/* By kind, with trees over all and over the outer ones. */
static bool arrange(sph__outer *outer)
{
    sph__surface_point *sorted = sph__alloc(outer->context, outer->point_count, sizeof *sorted);
    if (sorted == NULL) return false;
    sort_points(outer, sorted);
    sph__free(outer->context, sorted);
    mark_cavities(outer);
    return set_boxes(outer) && build_tree(outer, &outer->outer_tree, outer->outer_count) &&
           build_tree(outer, &outer->all_tree, outer->point_count);
}

bool sph__outer_connect(sph__outer *outer)
{
    const uint32_t count = outer->point_count;
    uint32_t *members = sph__alloc(outer->context, count, sizeof *members);
    bool done = members != NULL &&
                sph__reserve(outer->context, (void **)&outer->parents, &outer->parent_capacity, (size_t)count + 1,
                             sizeof *outer->parents) &&
                set_boxes(outer) && build_tree(outer, &outer->all_tree, count);
    if (done) {
        join_all(outer, members);
        for (uint32_t i = 0; i < count; ++i)
            if (find(outer->parents, i) != find(outer->parents, count)) outer->points[i].kind = SPH__POINT_CAVITY;
    }
    sph__free(outer->context, members);
    return done && arrange(outer);
}

/* --- any other point --- */

/* 1 outside, 0 in a cavity, as the first neighbour that p can be joined to; -1: to none. */
static int ask_neighbours(const sph__outer *outer, const sph__surface_point *p)
{
    sph__neighbour found[NEIGHBOURS];
    const uint32_t count = sph__outer_nearest(outer, &outer->all_tree, p->position, INFINITY, NEIGHBOURS, found);
    for (uint32_t i = 0; i < count; ++i) {
        const sph__surface_point *other = &outer->points[found[i].point];
        if (join(&outer->solid, p, other)) return other->kind != SPH__POINT_CAVITY;
    }
    return -1;
}

/* A point wrongly taken for an outer one would spoil the largest distance, so there is no guessing by neighbours. */
static bool is_outside(const sph__outer *outer, const sph__surface_point *p)
{
    int answer = -1;
    if (sph__solid_escapes(&outer->solid, p->position, p->normal)) return true;
    answer = ask_neighbours(outer, p);
    for (int number = 0; answer < 0 && number < DIRECTIONS; ++number) {
        sph__surface_point landing;
        double direction[3];
        choose_direction(p->normal, number, direction);
        if (!land(outer, p->position, direction, &landing)) return true;
        answer = ask_neighbours(outer, &landing);
    }
    return answer == 1; /* a niche that nothing can be seen from counts as a cavity */
}

bool sph__outer_is_outside(const sph__outer *outer, uint32_t primitive, const double position[3],
                           const double normal[3])
{
    sph__surface_point p = {.kind = SPH__POINT_SPREAD};
    if (!outer->touches_cavity[primitive]) return true;
    sph__copy3(position, p.position);
    sph__copy3(normal, p.normal);
    return is_outside(outer, &p);
}

bool sph__outer_extend(sph__outer *outer, uint32_t first)
{
    for (uint32_t i = first; i < outer->point_count; ++i) {
        sph__surface_point *p = &outer->points[i];
        if (!is_outside(outer, p)) p->kind = SPH__POINT_CAVITY;
    }
    return arrange(outer);
}
