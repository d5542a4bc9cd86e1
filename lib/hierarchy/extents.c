/* SPDX-License-Identifier: MIT */
/*
 * The exact width of a union, from the vertices of its regions. A few of its points, far apart, show for nearly all frames
 * and directions that the least extent is not there; only for what is left are all points placed, frames in chunks, and
 * each direction followed only until it shows not to be the thinnest.
 */
#include "hierarchy/widths.h"

sph_status sph__extents_init(const sph__builder *b, sph__extents *e)
{
    *e = (sph__extents){.stamp = 0};
    e->places = sph__zalloc(b->context, b->n, sizeof *e->places);
    e->witnesses = sph__alloc(b->context, 3 * (SPH__WITNESSES - 1), b->stride * sizeof *e->witnesses);
    e->chunk_least = sph__alloc(b->context, b->stride / SPH__LANES, b->direction_stride * sizeof *e->chunk_least);
    e->chunk_floor = sph__alloc(b->context, b->stride / SPH__LANES, sizeof *e->chunk_floor);
    return e->places == NULL || e->witnesses == NULL || e->chunk_least == NULL || e->chunk_floor == NULL
               ? sph__fail_memory(b->context)
               : SPH_OK;
}

void sph__extents_free(const sph__builder *b, sph__extents *e)
{
    sph__free(b->context, e->places);
    sph__free(b->context, e->vertices);
    sph__free(b->context, e->points);
    sph__free(b->context, e->placed);
    sph__free(b->context, e->witnesses);
    sph__free(b->context, e->chunk_least);
    sph__free(b->context, e->chunk_floor);
}

/* --- the points that a union's extents depend on --- */

/* The place of vertex v among the vertices of the union's points; there is room for it. */
static uint32_t place_of(const sph__builder *b, sph__extents *e, uint32_t v)
{
    struct sph__extent_vertex *vertex = &e->places[v];
    if (vertex->place_stamp != e->stamp) {
        vertex->place_stamp = e->stamp;
        vertex->place = (uint32_t)e->vertex_count;
        e->vertices[e->vertex_count++] = v;
        for (size_t k = 0; k < 3; ++k) __builtin_prefetch(sph__node_center(b, v) + k * b->stride); /* read when all are listed */
    }
    return vertex->place;
}

/* Makes the mean of three vertices a point, or of two where z is SPH__NO_NODE; by their places. */
static void add_point(sph__extents *e, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t *point = e->points[e->point_count++];
    point[0] = x;
    point[1] = y;
    point[2] = z;
}

/* The points of vertex v's cell: itself, and of the triangles that leave the region the midpoints and the centroid. */
static bool add_cell(const sph__builder *b, sph__extents *e, uint32_t v)
{
    const size_t cells = b->cell_starts[v + 1] - b->cell_starts[v];
    uint32_t own;
    if (!sph__reserve(b->context, (void **)&e->vertices, &e->vertex_capacity, e->vertex_count + 2 * cells + 1,
                      sizeof *e->vertices) ||
        !sph__reserve(b->context, (void **)&e->points, &e->point_capacity, e->point_count + 3 * cells + 1,
                      sizeof *e->points))
        return false;
    own = place_of(b, e, v);
    add_point(e, own, own, SPH__NO_NODE);
    for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
        const uint32_t x = b->vertex_cells[i][0], y = b->vertex_cells[i][1];
        const bool x_inside = e->places[x].member_stamp == e->stamp, y_inside = e->places[y].member_stamp == e->stamp;
        if (x_inside && y_inside) continue; /* within the hull of the region's vertices */
        if (!x_inside) add_point(e, own, place_of(b, e, x), SPH__NO_NODE);
        if (!y_inside && b->cell_open[v]) add_point(e, own, place_of(b, e, y), SPH__NO_NODE);
        if (!(x_inside && x < v) && !(y_inside && y < v)) add_point(e, own, place_of(b, e, x), place_of(b, e, y));
    }
    return true;
}

static bool add_region(const sph__builder *b, sph__extents *e, const sph__slot *slot)
{
    uint32_t v = (uint32_t)(slot - b->slots);
    for (uint32_t i = 0, next; i < slot->count; ++i, v = next) {
        next = b->next_member[v];
        if (i + 1 < slot->count) __builtin_prefetch(b->vertex_cells[b->cell_starts[next]]);
        if (!add_cell(b, e, v)) return false;
    }
    return true;
}

static void mark_members(const sph__builder *b, sph__extents *e, const sph__slot *slot)
{
    uint32_t v = (uint32_t)(slot - b->slots);
    for (uint32_t i = 0; i < slot->count; ++i, v = b->next_member[v]) {
        __builtin_prefetch(&b->cell_starts[v]);
        e->places[v].member_stamp = e->stamp;
    }
}

/* A stride coprime to the count, so that points far apart come first and a direction's extent shows soon. */
static size_t spread_stride(size_t count)
{
    size_t stride = count / 2 + 1;
    for (;; ++stride) {
        size_t x = count, y = stride;
        while (y != 0) {
            const size_t rest = x % y;
            x = y;
            y = rest;
        }
        if (x == 1) return stride;
    }
}

/* Stamps of 2^32 unions ago would pass for this one's. */
static void start_stamp(const sph__builder *b, sph__extents *e)
{
    if (++e->stamp != 0) return;
    memset(e->places, 0, b->n * sizeof *e->places);
    e->stamp = 1;
}

static sph_status list_points(const sph__builder *b, sph__extents *e, const sph__slot *u, const sph__slot *v)
{
    start_stamp(b, e);
    mark_members(b, e, u);
    mark_members(b, e, v);
    e->point_count = e->vertex_count = 0;
    if (!add_region(b, e, u) || !add_region(b, e, v) ||
        !sph__reserve(b->context, (void **)&e->placed, &e->placed_capacity, e->point_count + e->vertex_count,
                      3 * SPH__LANES * sizeof *e->placed))
        return sph__fail_memory(b->context);
    e->placed_vertices = e->placed + 3 * SPH__LANES * e->point_count;
    e->spread_stride = spread_stride(e->point_count) % e->point_count;
    return SPH_OK;
}

/* --- all points, eight frames at a time --- */

/* Eight frames of the vertices, relative to the first, and of the points. */
SPH__CLONES static void place_points(const sph__builder *b, const sph__extents *e, size_t i, double *vertices,
                                     double *points)
{
    const size_t s = b->stride, count = e->point_count;
    const float *o = b->h->centers + e->vertices[0] * b->node_floats + i;
    const sph__v8d *from = (const sph__v8d *)vertices;
    sph__v8d *to = (sph__v8d *)vertices;
    for (size_t v = 0; v < e->vertex_count; ++v) {
        const float *x = b->h->centers + e->vertices[v] * b->node_floats + i;
        for (size_t k = 0; k < 3; ++k) to[3 * v + k] = sph__load(x, k * s) - sph__load(o, k * s);
    }
    to = (sph__v8d *)points;
    for (size_t p = 0, at = 0; p < count; ++p) {
        const uint32_t *place = e->points[at];
        const sph__v8d *x = from + 3 * (size_t)place[0], *y = from + 3 * (size_t)place[1];
        if (place[2] == SPH__NO_NODE) {
            for (size_t k = 0; k < 3; ++k) to[3 * p + k] = 0.5 * (x[k] + y[k]);
        } else {
            const sph__v8d *z = from + 3 * (size_t)place[2];
            for (size_t k = 0; k < 3; ++k) to[3 * p + k] = (x[k] + y[k] + z[k]) * (1.0 / 3.0);
        }
        at = sph__next_spread(e, at);
    }
}

/* Extents of the placed points along k; stops when all reach `enough`, for extents only grow. */
SPH__CLONES static void chunk_extents(const double *placed, size_t count, const double k[3], double enough,
                                      double *extents)
{
    sph__v8d low, high, extent;
    sph__fill((double)INFINITY, &low);
    sph__fill((double)-INFINITY, &high);
    for (size_t p = 0; p < count;) {
        const size_t end = count - p < 4 ? count : p + 4;
        int any = 0;
        for (; p < end; ++p) {
            const sph__v8d *x = (const sph__v8d *)(placed + 3 * p * SPH__LANES);
            const sph__v8d along = x[0] * k[0] + x[1] * k[1] + x[2] * k[2];
            sph__smaller(&along, &low);
            sph__larger(&along, &high);
        }
        extent = high - low;
        for (size_t l = 0; l < SPH__LANES; ++l) any |= extent[l] < enough;
        if (!any) break;
    }
    *(sph__v8d *)extents = high - low;
}

static double least_extent(const sph__builder *b, size_t i, const double extents[SPH__LANES])
{
    double least = (double)INFINITY;
    for (size_t l = 0; l < SPH__LANES && i + l < b->frames; ++l) least = extents[l] < least ? extents[l] : least;
    return least;
}

/* --- chunks of frames --- */

/* Eight frames, and what is placed of them. */
typedef struct chunk {
    _Alignas(SPH__ALIGN) double guards[SPH__GUARDS * 3 * SPH__LANES];
    size_t i;
    bool guarded, placed;
} chunk;

/* Whether the guards are as far apart along a direction in all frames. */
static bool is_guarded(const sph__builder *b, const sph__extents *e, chunk *c, uint32_t direction, double best)
{
    _Alignas(SPH__ALIGN) double extents[SPH__LANES];
    if (c->placed || e->guard_count == 0) return false;
    if (!c->guarded) sph__place_guards(b, e, c->i, c->guards);
    c->guarded = true;
    chunk_extents(c->guards, e->guard_count, b->directions[direction], best, extents);
    return least_extent(b, c->i, extents) >= best;
}

/* Lowers *best by the extents of all points along a direction. */
static void follow(const sph__builder *b, sph__extents *e, chunk *c, uint32_t direction, double *best)
{
    _Alignas(SPH__ALIGN) double extents[SPH__LANES];
    const double *k = b->directions[direction];
    size_t thinnest = 0;
    if (!c->placed) place_points(b, e, c->i, e->placed_vertices, e->placed);
    c->placed = true;
    chunk_extents(e->placed, e->point_count, k, *best, extents);
    for (size_t l = 1; l < SPH__LANES && c->i + l < b->frames; ++l)
        if (extents[l] < extents[thinnest]) thinnest = l;
    if (extents[thinnest] < *best) *best = extents[thinnest];
    sph__add_guards(e, k, thinnest);
}

/* Lowers *best by the extents in one chunk of frames, where witnesses and guards leave it open. */
static void try_chunk(const sph__builder *b, sph__extents *e, size_t i, double noise, double *best)
{
    const double *least = e->chunk_least + i / SPH__LANES * b->direction_stride;
    chunk c;
    if (e->chunk_floor[i / SPH__LANES] > *best * (1 + 1e-9) + noise) return;
    c.i = i;
    c.guarded = c.placed = false;
    for (uint32_t j = 0; j < b->direction_count; ++j) {
        if (least[j] > *best * (1 + 1e-9) + noise || is_guarded(b, e, &c, j, *best)) continue;
        follow(b, e, &c, j, best);
    }
}

sph_status sph__union_width(const sph__builder *b, sph__extents *e, const sph__slot *u, const sph__slot *v,
                            double *width)
{
    size_t first = 0;
    double noise;
    sph_status status;
    *width = sph__union_width_bound(b, u, v);
    if (b->probe_frames == b->frames) return SPH_OK;
    status = list_points(b, e, u, v);
    if (status != SPH_OK) return status;
    e->guard_count = 0;
    noise = sph__place_witnesses(b, e);
    for (size_t i = SPH__LANES; i < b->stride; i += SPH__LANES)
        if (e->chunk_floor[i / SPH__LANES] < e->chunk_floor[first / SPH__LANES]) first = i;
    try_chunk(b, e, first, noise, width);
    for (size_t i = 0; i < b->stride; i += SPH__LANES)
        if (i != first) try_chunk(b, e, i, noise, width);
    return SPH_OK;
}

sph_status sph__union_frame_widths(const sph__builder *b, sph__extents *e, const sph__slot *u, const sph__slot *v,
                                   double *widths)
{
    const sph_status status = list_points(b, e, u, v);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < b->stride; i += SPH__LANES) {
        place_points(b, e, i, e->placed_vertices, e->placed);
        for (size_t l = 0; l < SPH__LANES; ++l) widths[i + l] = (double)INFINITY;
        for (uint32_t j = 0; j < b->direction_count; ++j) {
            _Alignas(SPH__ALIGN) double extents[SPH__LANES];
            chunk_extents(e->placed, e->point_count, b->directions[j], (double)INFINITY, extents);
            for (size_t l = 0; l < SPH__LANES; ++l)
                widths[i + l] = extents[l] < widths[i + l] ? extents[l] : widths[i + l];
        }
    }
    return SPH_OK;
}
