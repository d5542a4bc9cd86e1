/* SPDX-License-Identifier: MIT */
/*
 * Widths of regions (spec of the radius bound): the least extent of a region's cells over all frames and directions.
 *
 * Extents are not kept: they are many times bigger than quadrics. A region keeps a lower bound of its extent per direction
 * (extents only grow), and the direction and frame where it was found to be thin. That bounds a union's width from both
 * sides; where the bounds do not decide, the extents are taken afresh from the region's vertices, in the directions
 * that can still matter, thinnest first.
 */
#include <math.h>

#include "hierarchy/build.h"
#include "hierarchy/lanes.h"

/* Points spread by the golden angle over the half-sphere z > 0, turned step by step: no sines, so the same bits anywhere. */
void sph__width_directions(uint32_t count, double (*directions)[3])
{
    const double cosine = -0.73736887807831990, sine = 0.67549029426152362; /* of the golden angle, 2.39996 */
    double x = 1, y = 0;
    for (uint32_t j = 0; j < count; ++j) {
        const double z = (j + 0.5) / count, radius = sqrt(1 - z * z), turned = x * cosine - y * sine;
        directions[j][0] = radius * x;
        directions[j][1] = radius * y;
        directions[j][2] = z;
        y = x * sine + y * cosine;
        x = turned;
    }
}

static void mark_members(sph__builder *b, const sph__slot *slot)
{
    uint32_t v = slot->first;
    for (uint32_t i = 0; i < slot->count; ++i, v = b->next_member[v]) b->member_stamps[v] = b->stamp;
}

/* Calls for points of the cells of a region's vertices; interior triangles add nothing to the vertices' hull. */
SPH__INLINE void widen(const sph__v8d *x, sph__v8d *low, sph__v8d *high)
{
    *low = sph__select(*x < *low, *x, *low);
    *high = sph__select(*x > *high, *x, *high);
}

SPH__INLINE void project(const float *p, size_t s, size_t i, const sph__v8d origin[3], const double k[3], sph__v8d *out)
{
    *out = (sph__load(p, i) - origin[0]) * k[0] + (sph__load(p, s + i) - origin[1]) * k[1] +
           (sph__load(p, 2 * s + i) - origin[2]) * k[2];
}

/* Triangles of the cells that a region's extent depends on, laid out for one call of the loop over frames. */
typedef struct extent_points {
    const float *vertex;
    const float *others[2];
    int inside[2]; /* of the region */
} extent_points;

/* Widens the extents of all frames by a triangle of a vertex's cell; returns the least of them. */
SPH__CLONES static double widen_triangle(const extent_points *p, const float *origin, size_t s, size_t frames,
                                         const double k[3], double *low, double *high)
{
    sph__v8d least = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY};
    double result;
    for (size_t i = 0; i < s; i += SPH__LANES) {
        const sph__v8d o[3] = {sph__load(origin, i), sph__load(origin, s + i), sph__load(origin, 2 * s + i)};
        sph__v8d *l = (sph__v8d *)(low + i), *h = (sph__v8d *)(high + i), extent;
        sph__v8d x, y, z;
        project(p->vertex, s, i, o, k, &x);
        widen(&x, l, h);
        if (p->others[0] != NULL) {
            project(p->others[0], s, i, o, k, &y);
            project(p->others[1], s, i, o, k, &z);
            const sph__v8d xy = 0.5 * (x + y), xz = 0.5 * (x + z), center = (x + y + z) * (1.0 / 3.0);
            if (!p->inside[0]) widen(&xy, l, h);
            if (!p->inside[1]) widen(&xz, l, h);
            widen(&center, l, h);
        }
        extent = *h - *l;
        for (size_t f = frames; f < i + SPH__LANES; ++f) extent[f - i] = INFINITY; /* padding */
        least = sph__select(extent < least, extent, least);
    }
    result = least[0];
    for (size_t l = 1; l < SPH__LANES; ++l) result = least[l] < result ? least[l] : result;
    return result;
}

/*
 * Widens low and high by the cells of a region's vertices along direction k, until the least extent reaches `enough`:
 * extents only grow, so then this direction is not the thinnest. Returns the least extent.
 */
static double widen_region(sph__builder *b, const sph__slot *slot, const float *origin, const double k[3],
                           double enough)
{
    const size_t s = b->stride;
    double least = 0;
    uint32_t v = slot->first;
    for (uint32_t m = 0; m < slot->count; ++m, v = b->next_member[v]) {
        const float *center = sph__node_center(b, v);
        int any = 0;
        for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
            const uint32_t *corner = b->cells + 3 * (size_t)b->vertex_cells[i];
            extent_points points = {.vertex = center};
            for (unsigned n = 0, c = 0; c < 3; ++c) {
                if (corner[c] == v) continue;
                points.others[n] = sph__node_center(b, corner[c]);
                points.inside[n++] = b->member_stamps[corner[c]] == b->stamp;
            }
            if (points.inside[0] && points.inside[1]) continue;
            any = 1;
            least = widen_triangle(&points, origin, s, b->frames, k, b->extent_low, b->extent_high);
            if (least >= enough) return least;
        }
        if (!any) {
            const extent_points points = {.vertex = center};
            least = widen_triangle(&points, origin, s, b->frames, k, b->extent_low, b->extent_high);
            if (least >= enough) return least;
        }
    }
    return least;
}

static double project_frame(const sph__builder *b, uint32_t v, uint32_t frame, const double k[3])
{
    const float *p = sph__node_center(b, v) + frame;
    return p[0] * k[0] + p[b->stride] * k[1] + p[2 * b->stride] * k[2];
}

/* The same for one frame. */
static void widen_region_in_frame(sph__builder *b, const sph__slot *slot, uint32_t frame, const double k[3], double *low,
                                  double *high)
{
    uint32_t v = slot->first;
    for (uint32_t m = 0; m < slot->count; ++m, v = b->next_member[v]) {
        const double x = project_frame(b, v, frame, k);
        *low = x < *low ? x : *low;
        *high = x > *high ? x : *high;
        for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
            const uint32_t *corner = b->cells + 3 * (size_t)b->vertex_cells[i];
            double sum = x;
            for (unsigned c = 0; c < 3; ++c) {
                double y;
                if (corner[c] == v) continue;
                y = project_frame(b, corner[c], frame, k);
                sum += y;
                y = 0.5 * (x + y);
                *low = y < *low ? y : *low;
                *high = y > *high ? y : *high;
            }
            sum *= 1.0 / 3.0;
            *low = sum < *low ? sum : *low;
            *high = sum > *high ? sum : *high;
        }
    }
}

/* An upper bound for the union, where u is thin. Only v is looked at. */
static double width_bound_along(sph__builder *b, const sph__slot *u, const sph__slot *v)
{
    double low = u->thin_low, high = u->thin_high;
    widen_region_in_frame(b, v, u->width_frame, b->directions[u->width_direction], &low, &high);
    return high - low;
}

/* Rounding of an upper bound must not take it below what the exact search finds. */
#define BOUND_SLACK (1 + 1e-6)
/* Looking at a region that is so many times larger than the other would cost more than the better bound is worth. */
enum { UNBALANCED = 8 };

double sph__union_width_bound(sph__builder *b, const sph__slot *u, const sph__slot *v)
{
    const double x = v->cells / UNBALANCED > u->cells ? INFINITY : width_bound_along(b, u, v);
    const double y = u->cells / UNBALANCED > v->cells ? INFINITY : width_bound_along(b, v, u);
    return (x < y ? x : y) * BOUND_SLACK;
}

/* Least over frames of the union's extent in one direction, and the frame; or anything from `enough` on. */
static double union_extent(sph__builder *b, const sph__slot *u, const sph__slot *v, uint32_t direction, double enough,
                           uint32_t *frame)
{
    const float *origin = sph__node_center(b, u->first);
    double least;
    for (size_t f = 0; f < b->stride; ++f) {
        b->extent_low[f] = INFINITY;
        b->extent_high[f] = -INFINITY;
    }
    least = widen_region(b, u, origin, b->directions[direction], enough);
    if (least < enough) least = widen_region(b, v, origin, b->directions[direction], enough);
    for (uint32_t f = 0; f < b->frames; ++f)
        if (b->extent_high[f] - b->extent_low[f] <= least) {
            *frame = f;
            break;
        }
    return least;
}

void sph__union_width(sph__builder *b, const sph__slot *u, const sph__slot *v, sph__candidate *candidate)
{
    const float *low_u = b->width_bounds + (u - b->slots) * (size_t)b->direction_count;
    const float *low_v = b->width_bounds + (v - b->slots) * (size_t)b->direction_count;
    sph__keyed order[1024];
    double best = INFINITY;
    for (uint32_t j = 0; j < b->direction_count; ++j) {
        /* non-negative floats compare as their bits do */
        const float bound = low_u[j] > low_v[j] ? low_u[j] : low_v[j];
        uint32_t bits;
        memcpy(&bits, &bound, sizeof bits);
        order[j] = (sph__keyed){bits, j};
    }
    for (uint32_t j = 0; j < b->direction_count; ++j)
        if (j == u->width_direction || j == v->width_direction) order[j].key = 0; /* thin there: look first */
    sph__sort(order, b->direction_count);
    ++b->stamp;
    mark_members(b, u);
    mark_members(b, v);
    for (uint32_t i = 0; i < b->direction_count; ++i) {
        const uint32_t j = (uint32_t)order[i].item;
        const uint32_t bits = (uint32_t)order[i].key;
        uint32_t frame = 0;
        float bound;
        double extent;
        memcpy(&bound, &bits, sizeof bound);
        if ((double)bound >= best) break;
        extent = union_extent(b, u, v, j, best, &frame);
        if (extent < best) {
            best = extent;
            candidate->width_direction = j;
            candidate->width_frame = frame;
        }
    }
    candidate->width = best;
}

void sph__union_frame_widths(sph__builder *b, const sph__slot *u, const sph__slot *v, double *widths)
{
    for (uint32_t f = 0; f < b->frames; ++f) widths[f] = INFINITY;
    ++b->stamp;
    mark_members(b, u);
    mark_members(b, v);
    for (uint32_t j = 0; j < b->direction_count; ++j) {
        uint32_t frame;
        union_extent(b, u, v, j, INFINITY, &frame);
        for (uint32_t f = 0; f < b->frames; ++f) {
            const double extent = b->extent_high[f] - b->extent_low[f];
            if (extent < widths[f]) widths[f] = extent;
        }
    }
}

/* Where the union is thin, into u: as the exact search found it, else where the larger region is, which so is not looked at. */
static void unite_thin_extents(sph__builder *b, sph__slot *u, const sph__slot *v, const sph__candidate *candidate)
{
    const bool exact = candidate->exact && candidate->width > 0;
    const sph__slot *larger = v->cells > u->cells ? v : u, *smaller = larger == u ? v : u;
    const uint32_t direction = exact ? candidate->width_direction : larger->width_direction;
    const uint32_t frame = exact ? candidate->width_frame : larger->width_frame;
    double low = exact ? INFINITY : larger->thin_low, high = exact ? -INFINITY : larger->thin_high;
    if (exact) widen_region_in_frame(b, larger, frame, b->directions[direction], &low, &high);
    widen_region_in_frame(b, smaller, frame, b->directions[direction], &low, &high);
    u->width = exact ? candidate->width : u->width > v->width ? u->width : v->width;
    u->width_direction = direction;
    u->width_frame = frame;
    u->thin_low = low;
    u->thin_high = high;
}

void sph__unite_width_bounds(sph__builder *b, sph__slot *u, const sph__slot *v, const sph__candidate *candidate)
{
    float *low = b->width_bounds + (u - b->slots) * (size_t)b->direction_count;
    const float *low_v = b->width_bounds + (v - b->slots) * (size_t)b->direction_count;
    if (b->options.radius_mode != SPH_RADIUS_CONSTANT) return;
    unite_thin_extents(b, u, v, candidate);
    u->cells += v->cells;
    for (uint32_t j = 0; j < b->direction_count; ++j) {
        float bound = low[j] > low_v[j] ? low[j] : low_v[j];
        if ((double)bound < u->width * (1 - 1e-6)) bound = (float)(u->width * (1 - 1e-6));
        low[j] = bound;
    }
}

/* A leaf's cell: the thinnest direction of the first frame, as a place to look; bounds of zero. */
sph_status sph__make_widths(sph__builder *b)
{
    b->directions = sph__alloc(b->context, b->direction_count, sizeof *b->directions);
    b->width_bounds = sph__zalloc(b->context, b->n, b->direction_count * sizeof *b->width_bounds);
    b->extent_low = sph__alloc(b->context, b->stride, sizeof *b->extent_low);
    b->extent_high = sph__alloc(b->context, b->stride, sizeof *b->extent_high);
    if (b->directions == NULL || b->width_bounds == NULL || b->extent_low == NULL || b->extent_high == NULL)
        return sph__fail_memory(b->context);
    sph__width_directions(b->direction_count, b->directions);
    for (uint32_t v = 0; v < b->n; ++v) {
        sph__slot *slot = &b->slots[v];
        double least = INFINITY;
        slot->cells = b->cell_starts[v + 1] - b->cell_starts[v] + 1;
        for (uint32_t j = 0; j < b->direction_count; ++j) {
            double low = INFINITY, high = -INFINITY;
            widen_region_in_frame(b, slot, 0, b->directions[j], &low, &high);
            if (high - low < least) {
                least = high - low;
                slot->width_direction = j;
                slot->thin_low = low;
                slot->thin_high = high;
            }
        }
    }
    return SPH_OK;
}
