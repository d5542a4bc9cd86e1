/* SPDX-License-Identifier: MIT */
/*
 * Widths of regions (the radius bound): the least extent of a region's cells over all frames and directions.
 *
 * Extents of all frames would be many times bigger than quadrics, so they are kept for a few frames only, the probes: their
 * least is an upper bound of the width, and where they are all the frames it is the width. Extents only grow, so the
 * width of a part is a lower bound. Where the bounds do not decide, the extents are taken afresh from the region's
 * vertices: extents.c.
 */
#include "hierarchy/widths.h"

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

/* Least extent of the union's probes. `count` is padded with intervals that never are the least. */
SPH__CLONES static double least_probe(const double *u, const double *v, size_t count)
{
    sph__v8d least;
    sph__fill((double)INFINITY, &least);
    for (size_t i = 0; i < count; i += SPH__LANES) {
        sph__v8d low = *(const sph__v8d *)(u + i), high = *(const sph__v8d *)(u + count + i);
        sph__smaller((const sph__v8d *)(v + i), &low);
        sph__larger((const sph__v8d *)(v + count + i), &high);
        high -= low;
        sph__smaller(&high, &least);
    }
    return sph__least_lane(&least);
}

/* The same from intervals that hold the probes. */
SPH__CLONES static double least_bound(const float *u, const float *v, size_t count)
{
    sph__v8d least;
    sph__fill((double)INFINITY, &least);
    for (size_t i = 0; i < count; i += SPH__LANES) {
        sph__v8d low = sph__load(u, i), high = sph__load(u, count + i);
        const sph__v8d low_v = sph__load(v, i), high_v = sph__load(v, count + i);
        sph__smaller(&low_v, &low);
        sph__larger(&high_v, &high);
        high -= low;
        sph__smaller(&high, &least);
    }
    return sph__least_lane(&least);
}

double sph__union_width_bound(const sph__builder *b, const sph__slot *u, const sph__slot *v)
{
    if (b->probes == NULL) return least_bound(sph__probe_bounds_of(b, u), sph__probe_bounds_of(b, v), b->probe_count);
    return least_probe(sph__probes_of(b, u), sph__probes_of(b, v), b->probe_count);
}

void sph__copy_widths(const sph__builder *b, sph__slot *to, const sph__slot *from)
{
    to->width = from->width;
    if (b->probes == NULL)
        memcpy(sph__probe_bounds_of(b, to), sph__probe_bounds_of(b, from), 2 * b->probe_count * sizeof(float));
    else
        memcpy(sph__probes_of(b, to), sph__probes_of(b, from), 2 * b->probe_count * sizeof(double));
}

void sph__prefetch_widths(const sph__builder *b, const sph__slot *slot)
{
    enum { MOST = 512 };
    const char *row = b->probes == NULL ? (const char *)sph__probe_bounds_of(b, slot) : (const char *)sph__probes_of(b, slot);
    const size_t size = 2 * b->probe_count * (b->probes == NULL ? sizeof(float) : sizeof(double));
    for (size_t i = 0; i < MOST && i < size; i += 256)
        for (size_t k = 0; k < 256; k += 64) __builtin_prefetch(row + i + k);
}

/* Low ends, then high ends; by vectors as wide as they are read soon after, so that nothing waits for parts of them. */
SPH__CLONES static void unite_probes(double *low, const double *other, size_t count)
{
    sph__v8d *to = (sph__v8d *)low;
    const sph__v8d *from = (const sph__v8d *)other;
    for (size_t i = 0; i < count / SPH__LANES; ++i) {
        sph__smaller(&from[i], &to[i]);
        sph__larger(&from[count / SPH__LANES + i], &to[count / SPH__LANES + i]);
    }
}

SPH__CLONES static void unite_bounds(float *low, const float *other, size_t count)
{
    for (size_t i = 0; i < count; ++i) low[i] = other[i] < low[i] ? other[i] : low[i];
    for (size_t i = count; i < 2 * count; ++i) low[i] = other[i] > low[i] ? other[i] : low[i];
}

/* The united region's probes, into u's rows. */
void sph__unite_widths(const sph__builder *b, sph__slot *u, const sph__slot *v, const sph__candidate *candidate)
{
    if (b->probes == NULL)
        unite_bounds(sph__probe_bounds_of(b, u), sph__probe_bounds_of(b, v), b->probe_count);
    else
        unite_probes(sph__probes_of(b, u), sph__probes_of(b, v), b->probe_count);
    if (candidate->width > 0)
        u->width = (double)candidate->width;
    else if (v->width > u->width)
        u->width = v->width;
}

/* --- leaves --- */

/* Points whose extents are taken in one pass over the directions. */
enum { POINTS = 32 };

typedef struct point_list {
    const sph__builder *b;
    double *low, *high; /* of all directions */
    double points[POINTS][3];
    size_t count;
} point_list;

/* Widens the intervals by the points. */
SPH__CLONES static void widen_probes(const point_list *list)
{
    const size_t ds = list->b->direction_stride;
    for (size_t j = 0; j < ds; j += SPH__LANES) {
        const double *row = list->b->direction_rows + j;
        const sph__v8d k0 = *(const sph__v8d *)row, k1 = *(const sph__v8d *)(row + ds);
        const sph__v8d k2 = *(const sph__v8d *)(row + 2 * ds);
        sph__v8d low = *(const sph__v8d *)(list->low + j), high = *(const sph__v8d *)(list->high + j);
        for (size_t p = 0; p < list->count; ++p) {
            const double *x = list->points[p];
            const sph__v8d along = k0 * x[0] + k1 * x[1] + k2 * x[2];
            sph__smaller(&along, &low);
            sph__larger(&along, &high);
        }
        *(sph__v8d *)(list->low + j) = low;
        *(sph__v8d *)(list->high + j) = high;
    }
}

static double *next_point(point_list *list)
{
    if (list->count == POINTS) {
        widen_probes(list);
        list->count = 0;
    }
    return list->points[list->count++];
}

static void load_point(const sph__builder *b, uint32_t v, uint32_t frame, double x[3])
{
    const float *p = sph__node_center(b, v) + frame;
    for (size_t k = 0; k < 3; ++k) x[k] = p[k * b->stride];
}

static void add_middle(point_list *list, const double p[3], const double x[3])
{
    double *middle = next_point(list);
    for (unsigned k = 0; k < 3; ++k) middle[k] = 0.5 * (p[k] + x[k]);
}

/* A cell's point in triangles: where they close around the vertex, each edge is met twice, and taken once. */
static void probe_leaf(const sph__builder *b, uint32_t v, uint32_t frame, double *low, double *high)
{
    point_list list = {.b = b, .low = low, .high = high};
    double p[3];
    load_point(b, v, frame, p);
    memcpy(next_point(&list), p, sizeof p);
    for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
        double x[2][3], *middle;
        for (unsigned c = 0; c < 2; ++c) load_point(b, b->vertex_cells[i][c], frame, x[c]);
        add_middle(&list, p, x[0]);
        if (b->cell_open[v]) add_middle(&list, p, x[1]);
        middle = next_point(&list);
        for (unsigned k = 0; k < 3; ++k) middle[k] = (p[k] + x[0][k] + x[1][k]) * (1.0 / 3.0);
    }
    widen_probes(&list);
}

/* All probes of leaf v. */
static void probe_frames(const sph__builder *b, uint32_t v, double *low, double *high)
{
    for (size_t i = 0; i < b->probe_count; ++i) {
        low[i] = (double)INFINITY;
        high[i] = (double)-INFINITY;
    }
    for (uint32_t probe = 0; probe < b->probe_frames; ++probe)
        probe_leaf(b, v, probe * (b->frames / b->probe_frames), low + probe * b->direction_stride,
                   high + probe * b->direction_stride);
    for (size_t i = 0; i < b->probe_count; ++i)
        if (i % b->direction_stride >= b->direction_count) { /* padding: never the least */
            low[i] = 0;
            high[i] = (double)INFINITY;
        }
}

/* Up to so many frames all are probes; of more, a few, as all it does is to put off some exact widths. */
enum { FRAMES_ALL = 2, FRAMES_SOME = 1, MOST_PROBES = FRAMES_SOME * 1024 };


/* The vertices of a mesh may be in any order. */
static void ask_for_cell(const sph__builder *b, size_t v)
{
    enum { MOST = 16 };
    for (size_t i = 0; i < MOST && b->cell_starts[v] + i < b->cell_starts[v + 1]; ++i)
        __builtin_prefetch(sph__node_center(b, b->vertex_cells[b->cell_starts[v] + i][0]));
}

static void probe_leaves(void *argument, size_t begin, size_t end)
{
    enum { AHEAD = 4 };
    const sph__builder *b = argument;
    for (size_t v = begin; v < end; ++v) {
        double *low = sph__probes_of(b, &b->slots[v]);
        if (v + AHEAD < end) ask_for_cell(b, v + AHEAD);
        probe_frames(b, (uint32_t)v, low, low + b->probe_count);
    }
}

/* Rounded outward. */
static void bound_leaves(void *argument, size_t begin, size_t end)
{
    _Alignas(SPH__ALIGN) double low[MOST_PROBES], high[MOST_PROBES];
    const sph__builder *b = argument;
    for (size_t v = begin; v < end; ++v) {
        float *bounds = sph__probe_bounds_of(b, &b->slots[v]);
        probe_frames(b, (uint32_t)v, low, high);
        for (size_t i = 0; i < b->probe_count; ++i) {
            bounds[i] = (float)(low[i] - 1e-7 * fabs(low[i]) - 1e-37);
            bounds[b->probe_count + i] = (float)(high[i] + 1e-7 * fabs(high[i]) + 1e-37);
        }
    }
}

sph_status sph__make_widths(sph__builder *b)
{
    enum { GRAIN = 256 };
    bool all;
    const size_t stride = (b->direction_count + SPH__LANES - (size_t)1) / SPH__LANES * SPH__LANES;
    b->direction_stride = stride;
    b->probe_frames = b->frames <= FRAMES_ALL ? b->frames : FRAMES_SOME;
    b->probe_count = b->probe_frames * stride;
    b->directions = sph__alloc(b->context, b->direction_count, sizeof *b->directions);
    b->direction_rows = sph__zalloc(b->context, 3, stride * sizeof *b->direction_rows);
    all = b->probe_frames == b->frames;
    if (all)
        b->probes = sph__alloc(b->context, b->n + (size_t)SPH__GUESS_SLOTS, 2 * b->probe_count * sizeof *b->probes);
    else
        b->probe_bounds = sph__alloc(b->context, b->n + (size_t)SPH__GUESS_SLOTS, 2 * b->probe_count * sizeof *b->probe_bounds);
    if (b->directions == NULL || b->direction_rows == NULL || (all ? b->probes == NULL : b->probe_bounds == NULL))
        return sph__fail_memory(b->context);
    sph__width_directions(b->direction_count, b->directions);
    for (size_t j = 0; j < stride; ++j) /* padded with the last, which changes nothing that is least */
        for (size_t k = 0; k < 3; ++k)
            b->direction_rows[k * stride + j] = b->directions[j < b->direction_count ? j : b->direction_count - 1][k];
    sph__parallel_for(b->context, b->n, GRAIN, all ? probe_leaves : bound_leaves, b);
    return all && !b->h->radii_per_frame ? SPH_OK : sph__extents_init(b, &b->extents);
}
