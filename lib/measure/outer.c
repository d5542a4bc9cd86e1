/* SPDX-License-Identifier: MIT */
#include <float.h>

#include "measure/measure.h"
#include "numeric/vector.h"

enum {
    FIRST_POINTS = 3000,  /* show what is connected */
    PILOT_POINTS = 1000,  /* tell which share of all patches is not covered */
    MOST_CANDIDATES = 40, /* times the points wanted */
    STARTS = 128,
    MOST_DESCENTS = 8,
    MOST_NEAR = 256
};

static const double SKIN = 1e-6, LIFT = 1e-7, TOLERANCE = 1e-7; /* of the size */

sph_status sph__outer_init(sph__outer *outer, const sph_level *level)
{
    sph_status status;
    memset(outer, 0, sizeof *outer);
    outer->context = level->context;
    status = sph__solid_init(&outer->solid, level);
    if (status != SPH_OK) return status;
    outer->touches_cavity = sph__alloc(outer->context, outer->solid.primitive_count, sizeof *outer->touches_cavity);
    return outer->touches_cavity == NULL ? sph__fail_memory(outer->context) : SPH_OK;
}

void sph__outer_free(sph__outer *outer)
{
    if (outer->context == NULL) return;
    sph__free(outer->context, outer->touches_cavity);
    sph__free(outer->context, outer->points);
    sph__free(outer->context, outer->boxes);
    sph__free(outer->context, outer->parents);
    sph__box_tree_free(&outer->outer_tree);
    sph__box_tree_free(&outer->all_tree);
    sph__solid_free(&outer->solid);
    memset(outer, 0, sizeof *outer);
}

static uint32_t candidates_for(double wanted, double share)
{
    const double most = MOST_CANDIDATES * wanted, need = share > 0 ? wanted / share : most;
    return (uint32_t)fmin(1e9, fmin(most, ceil(need)));
}

/*
 * A first part of the points is connected one by one. It tells the rest what is outside, and how many more are needed;
 * as both parts are spread evenly over all patches, together they are too.
 */
static bool spread(sph__outer *outer, double area, double wanted, const double shift[2])
{
    const double second_shift[2] = {shift[1], shift[0]};
    const double pilot = sph__patches_count(outer, area, PILOT_POINTS) / (double)PILOT_POINTS;
    uint32_t candidates = candidates_for(FIRST_POINTS, pilot), first, more = 0;
    outer->point_count = 0;
    outer->spacing = sqrt(area / candidates);
    if (!sph__patches_sample(outer, area, candidates, shift) || !sph__patches_extremes(outer) ||
        !sph__outer_connect(outer))
        return false;
    if (outer->extreme_begin < wanted) {
        first = outer->point_count;
        more = candidates_for(wanted - outer->extreme_begin, outer->extreme_begin / (double)candidates);
        if (!sph__patches_sample(outer, area, more, second_shift) || !sph__outer_extend(outer, first)) return false;
    }
    outer->area = area * outer->extreme_begin / ((double)candidates + more);
    outer->spacing = sqrt(area / ((double)candidates + more));
    return true;
}

/* Diagonal of everything that the solid fills. */
static double solid_diagonal(const sph__solid *solid)
{
    const sph__box *box = &solid->tree.nodes[1];
    const double low[3] = {box->low[0], box->low[1], box->low[2]};
    const double high[3] = {box->high[0], box->high[1], box->high[2]};
    return sph__distance(low, high);
}

sph_status sph__outer_pose(sph__outer *outer, const float *centers, const float *radii, double size, uint32_t samples,
                           const double shift[2])
{
    sph__solid_pose(&outer->solid, centers, radii, 0);
    size = fmax(size, solid_diagonal(&outer->solid));
    if (!(size > 0)) size = 1;
    outer->size = size;
    outer->skin = SKIN * size;
    outer->lift = LIFT * size;
    sph__solid_pose(&outer->solid, centers, radii, outer->skin);
    return spread(outer, sph__patches_area(&outer->solid), samples, shift) ? SPH_OK : SPH_E_NOMEM;
}

void sph__outer_point(const sph__outer *outer, uint32_t index, double x[3])
{
    const sph__surface_point *p = &outer->points[index];
    sph__add_scaled(p->position, -(outer->skin + outer->lift), p->normal, x);
}

/* Is the boundary point `c` of the primitive one of the outer surface? */
static bool is_outer(const sph__outer *outer, uint32_t primitive, const sph__contact *c)
{
    double landing[3];
    sph__add_scaled(c->point, outer->lift, c->normal, landing);
    return !sph__solid_covers(&outer->solid, landing, 0, NULL) &&
           sph__outer_is_outside(outer, primitive, landing, c->normal);
}

/* The nearest outer point among the feet of x on the primitives within `best`; `best` where there is none. */
static double try_feet(const sph__outer *outer, const double x[3], double best)
{
    uint32_t near[MOST_NEAR];
    uint32_t count = sph__solid_gather(&outer->solid, x, best, near, MOST_NEAR);
    if (count > MOST_NEAR) count = MOST_NEAR;
    for (uint32_t i = 0; i < count; ++i) {
        sph__contact c;
        sph__primitive_closest(&outer->solid.primitives[near[i]], x, &c);
        if (fabs(c.distance) < best && is_outer(outer, near[i], &c)) best = fabs(c.distance);
    }
    return best;
}

/* Do starts a and b lie in about the same direction from x? */
static bool same_direction(const double x[3], const double a[3], const double b[3])
{
    double u[3], v[3];
    sph__subtract(a, x, u);
    sph__subtract(b, x, v);
    return sph__dot(u, v) > 0.97 * sph__norm(u) * sph__norm(v);
}

/* Descends from the points around; the best distance known is `best`, none can be below `least`. */
static double search(const sph__outer *outer, const double x[3], double least)
{
    const double tolerance = TOLERANCE * outer->size, enough = least + 10 * tolerance;
    sph__neighbour near[STARTS];
    uint32_t used[MOST_DESCENTS], used_count = 0;
    double best = DBL_MAX;
    const uint32_t count = sph__outer_nearest(outer, &outer->outer_tree, x, INFINITY, STARTS, near);
    for (uint32_t i = 0; i < count && used_count < MOST_DESCENTS && best > enough; ++i) {
        double p[3], slack = 1.5 * outer->spacing, distance;
        bool fresh = true;
        if (best < DBL_MAX && sqrt(near[i].distance2) > best + slack) break;
        sph__copy3(outer->points[near[i].point].position, p);
        for (uint32_t k = 0; k < used_count && fresh; ++k)
            fresh = !same_direction(x, p, outer->points[used[k]].position);
        if (!fresh) continue;
        used[used_count++] = near[i].point;
        distance = sph__outer_descend(&outer->solid, x, p, tolerance, enough);
        if (distance < best) best = distance;
        if (used_count == 1 && best > enough) best = try_feet(outer, x, best);
    }
    return best;
}

double sph__outer_distance(const sph__outer *outer, const double x[3])
{
    sph__contact c;
    uint32_t nearest;
    double distance = sph__solid_distance(&outer->solid, x, &nearest);
    sph__primitive_closest(&outer->solid.primitives[nearest], x, &c);
    if (distance >= 0) {
        double landing[3];
        sph__add_scaled(c.point, outer->lift, c.normal, landing);
        if (sph__outer_is_outside(outer, nearest, landing, c.normal)) return distance + outer->skin;
    } else if (is_outer(outer, nearest, &c)) {
        return fabs(-distance - outer->skin);
    }
    return fabs(search(outer, x, fabs(distance)) - outer->skin);
}
