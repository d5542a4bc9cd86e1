/* SPDX-License-Identifier: MIT */
/*
 * Widths of regions (the radius bound): the least extent of a region's cells over all frames and directions.
 *
 * Extents of all frames would be many times bigger than quadrics, so they are kept for a few frames only, the probes: their
 * least is an upper bound of the width, and where they are all the frames it is the width. Besides, a region keeps a
 * lower bound of its extent per direction (extents only grow). Where the bounds do not decide, the extents are taken
 * afresh from the region's vertices: frames in chunks, the directions that can still matter, and each of these only
 * until it shows not to be the thinnest.
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

/* Rows of slots: intervals per probe, then lower bounds per direction. */
static double *probes_of(const sph__builder *b, const sph__slot *slot)
{
    return b->probes + (size_t)(slot - b->slots) * 2 * b->probe_count;
}

static float *bounds_of(const sph__builder *b, const sph__slot *slot)
{
    return b->width_bounds + (size_t)(slot - b->slots) * b->direction_count;
}

SPH__INLINE void smaller(const sph__v8d *x, sph__v8d *least)
{
    *least = sph__select(*x < *least, *x, *least);
}

SPH__INLINE void larger(const sph__v8d *x, sph__v8d *most)
{
    *most = sph__select(*x > *most, *x, *most);
}

SPH__INLINE void fill(double x, sph__v8d *v)
{
    *v = (sph__v8d){x, x, x, x, x, x, x, x};
}

static double least_lane(const sph__v8d *v)
{
    double least = (*v)[0];
    for (size_t l = 1; l < SPH__LANES; ++l) least = (*v)[l] < least ? (*v)[l] : least;
    return least;
}

/* Least extent of the union's probes. `count` is padded with intervals that never are the least. */
SPH__CLONES static double least_probe(const double *u, const double *v, size_t count)
{
    sph__v8d least;
    fill(INFINITY, &least);
    for (size_t i = 0; i < count; i += SPH__LANES) {
        sph__v8d low = *(const sph__v8d *)(u + i), high = *(const sph__v8d *)(u + count + i);
        smaller((const sph__v8d *)(v + i), &low);
        larger((const sph__v8d *)(v + count + i), &high);
        high -= low;
        smaller(&high, &least);
    }
    return least_lane(&least);
}

double sph__union_width_bound(const sph__builder *b, const sph__slot *u, const sph__slot *v)
{
    return least_probe(probes_of(b, u), probes_of(b, v), b->probe_count);
}

/* --- the points that a union's extents depend on --- */

/* The place of vertex v among the vertices of the union's points. */
static bool place_of(sph__builder *b, uint32_t v, uint32_t *place)
{
    if (b->place_stamps[v] != b->stamp) {
        if (!sph__reserve(b->context, (void **)&b->vertices, &b->vertex_capacity, b->vertex_count + 1,
                          sizeof *b->vertices))
            return false;
        b->place_stamps[v] = b->stamp;
        b->vertex_places[v] = (uint32_t)b->vertex_count;
        b->vertices[b->vertex_count++] = v;
    }
    *place = b->vertex_places[v];
    return true;
}

/* Makes the mean of three vertices a point, or of two where z is SPH__NO_NODE. */
static bool add_point(sph__builder *b, size_t *count, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t *point;
    if (!sph__reserve(b->context, (void **)&b->points, &b->point_capacity, *count + 1, sizeof *b->points)) return false;
    point = b->points[(*count)++];
    point[2] = z;
    return place_of(b, x, &point[0]) && place_of(b, y, &point[1]) && (z == SPH__NO_NODE || place_of(b, z, &point[2]));
}

/* The points of vertex v's cell: itself, and of the triangles that leave the region the midpoints and the centroid. */
static bool add_cell(sph__builder *b, size_t *count, uint32_t v)
{
    if (!add_point(b, count, v, v, SPH__NO_NODE)) return false;
    for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
        uint32_t x, y;
        bool x_inside, y_inside;
        sph__cell_others(b, i, v, &x, &y);
        x_inside = b->member_stamps[x] == b->stamp;
        y_inside = b->member_stamps[y] == b->stamp;
        if (x_inside && y_inside) continue; /* within the hull of the region's vertices */
        if (!x_inside && !add_point(b, count, v, x, SPH__NO_NODE)) return false;
        if (!y_inside && b->cell_open[v] && !add_point(b, count, v, y, SPH__NO_NODE)) return false;
        if (!(x_inside && x < v) && !(y_inside && y < v) && !add_point(b, count, v, x, y)) return false;
    }
    return true;
}

static bool add_region(sph__builder *b, size_t *count, const sph__slot *slot)
{
    uint32_t v = slot->first;
    for (uint32_t i = 0; i < slot->count; ++i, v = b->next_member[v])
        if (!add_cell(b, count, v)) return false;
    return true;
}

static void mark_members(sph__builder *b, const sph__slot *slot)
{
    uint32_t v = slot->first;
    for (uint32_t i = 0; i < slot->count; ++i, v = b->next_member[v]) b->member_stamps[v] = b->stamp;
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

/* Eight frames of the vertices, relative to `origin`, and of the points. */
SPH__CLONES static void place_points(const sph__builder *b, uint32_t origin, size_t count, size_t i, double *vertices,
                                     double *points)
{
    const size_t s = b->stride;
    const float *o = b->h->centers + origin * b->node_floats + i;
    const sph__v8d *from = (const sph__v8d *)vertices;
    sph__v8d *to = (sph__v8d *)vertices;
    for (size_t v = 0; v < b->vertex_count; ++v) {
        const float *x = b->h->centers + b->vertices[v] * b->node_floats + i;
        for (size_t k = 0; k < 3; ++k) to[3 * v + k] = sph__load(x, k * s) - sph__load(o, k * s);
    }
    to = (sph__v8d *)points;
    for (size_t p = 0, at = 0; p < count; ++p) {
        const uint32_t *place = b->points[at];
        const sph__v8d *x = from + 3 * (size_t)place[0], *y = from + 3 * (size_t)place[1];
        if (place[2] == SPH__NO_NODE) {
            for (size_t k = 0; k < 3; ++k) to[3 * p + k] = 0.5 * (x[k] + y[k]);
        } else {
            const sph__v8d *z = from + 3 * (size_t)place[2];
            for (size_t k = 0; k < 3; ++k) to[3 * p + k] = (x[k] + y[k] + z[k]) * (1.0 / 3.0);
        }
        at = at + b->spread_stride < count ? at + b->spread_stride : at + b->spread_stride - count;
    }
}

/* Extents of the placed points along k; stops when all reach `enough`, for extents only grow. */
SPH__CLONES static void chunk_extents(const double *placed, size_t count, const double k[3], double enough,
                                      double *extents)
{
    sph__v8d low, high, extent;
    fill(INFINITY, &low);
    fill(-INFINITY, &high);
    for (size_t p = 0; p < count;) {
        const size_t end = count - p < 4 ? count : p + 4;
        int any = 0;
        for (; p < end; ++p) {
            const sph__v8d *x = (const sph__v8d *)(placed + 3 * p * SPH__LANES);
            const sph__v8d along = x[0] * k[0] + x[1] * k[1] + x[2] * k[2];
            smaller(&along, &low);
            larger(&along, &high);
        }
        extent = high - low;
        for (size_t l = 0; l < SPH__LANES; ++l) any |= extent[l] < enough;
        if (!any) break;
    }
    *(sph__v8d *)extents = high - low;
}

static double least_extent(const sph__builder *b, size_t i, const double extents[SPH__LANES])
{
    double least = INFINITY;
    for (size_t l = 0; l < SPH__LANES && i + l < b->frames; ++l) least = extents[l] < least ? extents[l] : least;
    return least;
}

/* Stamps of 2^32 unions ago would pass for this one's. */
static void start_stamp(sph__builder *b)
{
    if (++b->stamp != 0) return;
    memset(b->member_stamps, 0, b->n * sizeof *b->member_stamps);
    memset(b->place_stamps, 0, b->n * sizeof *b->place_stamps);
    b->stamp = 1;
}

static sph_status list_points(sph__builder *b, const sph__slot *u, const sph__slot *v, size_t *count)
{
    start_stamp(b);
    mark_members(b, u);
    mark_members(b, v);
    *count = 0;
    b->vertex_count = 0;
    if (!add_region(b, count, u) || !add_region(b, count, v) ||
        !sph__reserve(b->context, (void **)&b->placed, &b->placed_capacity, *count + b->vertex_count,
                      3 * SPH__LANES * sizeof *b->placed))
        return sph__fail_memory(b->context);
    b->placed_vertices = b->placed + 3 * SPH__LANES * *count;
    b->spread_stride = spread_stride(*count) % *count;
    return SPH_OK;
}

sph_status sph__union_width(sph__builder *b, const sph__slot *u, const sph__slot *v, sph__candidate *candidate)
{
    const float *low_u = bounds_of(b, u), *low_v = bounds_of(b, v);
    double best = sph__union_width_bound(b, u, v);
    size_t count;
    sph_status status;
    candidate->width = best;
    if (b->probe_frames == b->frames) return SPH_OK;
    status = list_points(b, u, v, &count);
    if (status != SPH_OK) return status;
    for (uint32_t j = 0; j < b->direction_count; ++j) b->least[j] = INFINITY;
    for (size_t i = 0; i < b->stride; i += SPH__LANES) {
        place_points(b, u->first, count, i, b->placed_vertices, b->placed);
        for (uint32_t j = 0; j < b->direction_count; ++j) {
            _Alignas(SPH__ALIGN) double extents[SPH__LANES];
            double least;
            const float bound = low_u[j] > low_v[j] ? low_u[j] : low_v[j];
            if ((double)bound >= best) { /* of these frames no more is known than that */
                if ((double)bound < b->least[j]) b->least[j] = (double)bound;
                continue;
            }
            chunk_extents(b->placed, count, b->directions[j], best, extents);
            least = least_extent(b, i, extents);
            if (least < b->least[j]) b->least[j] = least;
            if (least < best) best = least;
        }
    }
    candidate->width = best;
    b->least_of = candidate;
    return SPH_OK;
}

/* The united region's probes and bounds, into u's rows. */
void sph__unite_widths(sph__builder *b, sph__slot *u, const sph__slot *v, const sph__candidate *candidate)
{
    double *low = probes_of(b, u), *high = low + b->probe_count;
    const double *low_v = probes_of(b, v), *high_v = low_v + b->probe_count;
    float *bounds = bounds_of(b, u);
    const float *bounds_v = bounds_of(b, v);
    for (size_t i = 0; i < b->probe_count; ++i) {
        low[i] = low_v[i] < low[i] ? low_v[i] : low[i];
        high[i] = high_v[i] > high[i] ? high_v[i] : high[i];
    }
    if (candidate->exact && candidate->width > 0)
        u->width = candidate->width;
    else if (v->width > u->width)
        u->width = v->width;
    for (uint32_t j = 0; j < b->direction_count; ++j) {
        float bound = bounds[j] > bounds_v[j] ? bounds[j] : bounds_v[j];
        double known = u->width;
        if (b->least_of == candidate && b->least[j] != INFINITY && b->least[j] > known) known = b->least[j];
        if ((double)bound < known * (1 - 1e-6)) bound = (float)(known * (1 - 1e-6));
        bounds[j] = bound;
    }
    b->least_of = NULL;
}

sph_status sph__union_frame_widths(sph__builder *b, const sph__slot *u, const sph__slot *v, double *widths)
{
    size_t count;
    const sph_status status = list_points(b, u, v, &count);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < b->stride; i += SPH__LANES) {
        place_points(b, u->first, count, i, b->placed_vertices, b->placed);
        for (size_t l = 0; l < SPH__LANES; ++l) widths[i + l] = INFINITY;
        for (uint32_t j = 0; j < b->direction_count; ++j) {
            _Alignas(SPH__ALIGN) double extents[SPH__LANES];
            chunk_extents(b->placed, count, b->directions[j], INFINITY, extents);
            for (size_t l = 0; l < SPH__LANES; ++l) widths[i + l] = extents[l] < widths[i + l] ? extents[l] : widths[i + l];
        }
    }
    return SPH_OK;
}

/* --- leaves --- */

/* Widens the intervals of all directions by a point. */
SPH__CLONES static void widen_probes(const sph__builder *b, const double x[3], double *low, double *high)
{
    for (size_t j = 0; j < b->direction_stride; j += SPH__LANES) {
        const double *row = b->direction_rows + j;
        const sph__v8d along = *(const sph__v8d *)row * x[0] + *(const sph__v8d *)(row + b->direction_stride) * x[1] +
                               *(const sph__v8d *)(row + 2 * b->direction_stride) * x[2];
        smaller(&along, (sph__v8d *)(low + j));
        larger(&along, (sph__v8d *)(high + j));
    }
}

static void load_point(const sph__builder *b, uint32_t v, uint32_t frame, double x[3])
{
    const float *p = sph__node_center(b, v) + frame;
    for (size_t k = 0; k < 3; ++k) x[k] = p[k * b->stride];
}

static void probe_leaf(const sph__builder *b, uint32_t v, uint32_t frame, double *low, double *high)
{
    double p[3];
    load_point(b, v, frame, p);
    widen_probes(b, p, low, high);
    for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
        const uint32_t *corner = b->cells + 3 * (size_t)b->vertex_cells[i];
        double sum[3] = {0, 0, 0}, x[3], middle[3];
        for (unsigned c = 0; c < 3; ++c) {
            load_point(b, corner[c], frame, x);
            for (unsigned k = 0; k < 3; ++k) {
                middle[k] = 0.5 * (p[k] + x[k]);
                sum[k] += x[k];
            }
            if (corner[c] != v) widen_probes(b, middle, low, high);
        }
        for (unsigned k = 0; k < 3; ++k) sum[k] *= 1.0 / 3.0;
        widen_probes(b, sum, low, high);
    }
}

static void probe_leaves(void *argument, size_t begin, size_t end)
{
    const sph__builder *b = argument;
    for (size_t v = begin; v < end; ++v) {
        double *low = probes_of(b, &b->slots[v]), *high = low + b->probe_count;
        for (size_t i = 0; i < b->probe_count; ++i) {
            low[i] = INFINITY;
            high[i] = -INFINITY;
        }
        for (uint32_t probe = 0; probe < b->probe_frames; ++probe)
            probe_leaf(b, (uint32_t)v, probe * (b->frames / b->probe_frames), low + probe * b->direction_stride,
                       high + probe * b->direction_stride);
        for (size_t i = 0; i < b->probe_count; ++i)
            if (i % b->direction_stride >= b->direction_count) { /* padding: never the least */
                low[i] = 0;
                high[i] = INFINITY;
            }
    }
}

sph_status sph__make_widths(sph__builder *b)
{
    enum { PROBE_FRAMES = 2, GRAIN = 256 };
    const size_t stride = (b->direction_count + SPH__LANES - (size_t)1) / SPH__LANES * SPH__LANES;
    b->direction_stride = stride;
    b->probe_frames = b->frames < PROBE_FRAMES ? b->frames : PROBE_FRAMES;
    b->probe_count = b->probe_frames * stride;
    b->directions = sph__alloc(b->context, b->direction_count, sizeof *b->directions);
    b->direction_rows = sph__zalloc(b->context, 3, stride * sizeof *b->direction_rows);
    b->least = sph__alloc(b->context, b->direction_count, sizeof *b->least);
    b->vertex_places = sph__alloc(b->context, b->n, sizeof *b->vertex_places);
    b->place_stamps = sph__zalloc(b->context, b->n, sizeof *b->place_stamps);
    b->probes = sph__alloc(b->context, b->n, 2 * b->probe_count * sizeof *b->probes);
    b->width_bounds = sph__zalloc(b->context, b->n, b->direction_count * sizeof *b->width_bounds);
    if (b->directions == NULL || b->direction_rows == NULL || b->least == NULL || b->probes == NULL || b->vertex_places == NULL || b->place_stamps == NULL ||
        b->width_bounds == NULL)
        return sph__fail_memory(b->context);
    sph__width_directions(b->direction_count, b->directions);
    for (uint32_t j = 0; j < b->direction_count; ++j)
        for (size_t k = 0; k < 3; ++k) b->direction_rows[k * stride + j] = b->directions[j][k];
    sph__parallel_for(b->context, b->n, GRAIN, probe_leaves, b);
    return SPH_OK;
}
