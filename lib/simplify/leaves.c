/* SPDX-License-Identifier: MIT */
/* The quadrics of the input's points, from the posed triangles around them. */
#include <math.h>

#include "simplify/simplify.h"

enum { POINT_GRAIN = 64 };
/* Coordinates whose squares are within 32 bits. */
#define COORDINATE_LIMIT 1e18F

/* What the input is in the example poses, while leaves are made. */
typedef struct leaves {
    sph__simplifier *b;
    float *posed;     /* [points][3][example_stride] */
    uint8_t *borders; /* [mesh.triangle_count]: bit k: of the edge from corner k to the next */
    double *blocks;   /* [SPH__SIMPLIFY_ROOMS][SPH__QUADRIC_ROWS * example_stride] */
    size_t grain;     /* points per block */
} leaves;

static void pose_points(void *argument, size_t begin, size_t end)
{
    const leaves *l = argument;
    const sph__simplifier *b = l->b;
    const sph_skin *skin = b->skin;
    const size_t k = skin->influence_count;
    for (size_t v = begin; v < end; ++v) {
        const double rest[3] = {(double)skin->rest[3 * v], (double)skin->rest[3 * v + 1],
                                (double)skin->rest[3 * v + 2]};
        uint32_t count = 0;
        if (b->slot_of[b->point_of[v]] != v) continue; /* not the first vertex of its point */
        while (count < k && skin->weights[v * k + count] > 0)
            ++count;
        sph__kernel_place(b->examples, skin->bone_count, b->example_stride, rest, skin->bones + v * k,
                          skin->weights + v * k, count, l->posed + b->point_of[v] * 3 * b->example_stride);
    }
}

/* The mean diagonal of the poses; in *largest the coordinate that is. */
static sph_status measure(const leaves *l, double *largest)
{
    const sph__simplifier *b = l->b;
    const size_t s = b->example_stride;
    double sum = 0;
    *largest = 0;
    for (uint32_t j = 0; j < b->example_count; ++j) {
        double squared = 0;
        for (size_t c = 0; c < 3; ++c) {
            float low = INFINITY, high = -INFINITY;
            for (uint32_t i = 0; i < b->points; ++i) {
                const float x = l->posed[(i * (size_t)3 + c) * s + j];
                if (!(fabsf(x) <= COORDINATE_LIMIT))
                    return sph__fail(b->context, SPH_E_INVALID, "example pose %u: point %u is at %g, beyond +-%g",
                                     (unsigned)j, (unsigned)i, (double)x, (double)COORDINATE_LIMIT);
                low = fminf(low, x);
                high = fmaxf(high, x);
            }
            *largest = fmax(*largest, fmax(fabs((double)low), fabs((double)high)));
            squared += ((double)high - (double)low) * ((double)high - (double)low);
        }
        sum += sqrt(squared);
    }
    b->p->bounding_diagonal = sum / b->example_count;
    return SPH_OK;
}

/* A scale that brings the largest coordinate near to 1: areas and their squares are neither too large nor too small. */
static void scale(leaves *l, double largest)
{
    sph__simplifier *b = l->b;
    const size_t bones = b->skin->bone_count, chunks = b->example_stride / SPH__LANES;
    int exponent = 0;
    if (largest > 0) frexp(largest, &exponent);
    b->scale = ldexp(1, -exponent);
    for (size_t i = 0; i < chunks * bones * 12 * SPH__LANES; ++i)
        b->examples[i] *= b->scale;
    for (size_t i = 0; b->transforms != b->examples && i < 12 * (size_t)SPH__LANES; ++i)
        b->transforms[i] *= b->scale;
    for (size_t i = 0; i < b->points * 3 * b->example_stride; ++i)
        l->posed[i] *= (float)b->scale;
}

/* Whether two triangles on both sides of an edge from p to q go on smoothly in all values but the normals. */
static bool is_seam(const sph__simplifier *b, uint32_t wedge, uint32_t other)
{
    const size_t size = b->p->value_count, count = b->o.attribute_count;
    if (wedge == other || count == 0) return false;
    return memcmp(b->p->values + (wedge + 1) * size - count, b->p->values + (other + 1) * size - count,
                  count * sizeof(float)) != 0;
}

/* The wedge of triangle t at point p. */
static uint32_t wedge_at(const sph__simplifier *b, uint32_t t, uint32_t p)
{
    const uint32_t *corner = b->mesh.triangles[t];
    return b->corners[t][corner[0] == p ? 0 : corner[1] == p ? 1 : 2];
}

/* An edge of which there is one triangle, or where texture does not go on. */
static bool is_border(const sph__simplifier *b, uint32_t t, unsigned k)
{
    const uint32_t p = b->mesh.triangles[t][k], q = b->mesh.triangles[t][(k + 1) % 3];
    const uint32_t *around = sph__triangles_of(&b->mesh, p);
    uint32_t others = 0;
    for (uint32_t i = 0; i < sph__triangle_count_of(&b->mesh, p); ++i) {
        const uint32_t *corner = b->mesh.triangles[around[i]];
        if (around[i] == t || (corner[0] != q && corner[1] != q && corner[2] != q)) continue;
        ++others;
        if (is_seam(b, wedge_at(b, t, p), wedge_at(b, around[i], p)) ||
            is_seam(b, wedge_at(b, t, q), wedge_at(b, around[i], q)))
            return true;
    }
    return others == 0;
}

static void find_borders(void *argument, size_t begin, size_t end)
{
    const leaves *l = argument;
    for (size_t t = begin; t < end; ++t)
        for (unsigned k = 0; k < 3; ++k)
            if (l->b->o.border_weight > 0 && is_border(l->b, (uint32_t)t, k)) l->borders[t] |= (uint8_t)(1 << k);
}

/* Adds triangle t to the quadric of one of its corners; its plane once, and those of its borders that end there. */
static void add_triangle(const leaves *l, uint32_t t, uint32_t point, const float *center, double *block,
                         double sums[2])
{
    const sph__simplifier *b = l->b;
    const size_t row = 3 * b->example_stride;
    const uint32_t *corner = b->mesh.triangles[t];
    const unsigned at = corner[0] == point ? 0 : corner[1] == point ? 1 : 2;
    const float *p = l->posed + corner[at] * row, *q = l->posed + corner[(at + 1) % 3] * row;
    const float *r = l->posed + corner[(at + 2) % 3] * row;
    const bool next = (l->borders[t] >> at & 1) != 0, last = (l->borders[t] >> (at + 2) % 3 & 1) != 0;
    sph__kernel_add_plane(p, q, r, center, b->example_stride, block, sums);
    if (next) sums[0] += sph__kernel_add_border(p, q, r, center, b->example_stride, b->o.border_weight, block);
    if (last) sums[0] += sph__kernel_add_border(r, p, q, center, b->example_stride, b->o.border_weight, block);
}

/* To floats; with the quadrics pulled back, all poses as one. */
static void store(const sph__simplifier *b, uint32_t point, const double *block)
{
    const size_t size = SPH__QUADRIC_ROWS * b->example_stride;
    float *out = b->blocks + point * SPH__QUADRIC_ROWS * b->stride;
    double pulled[6];
    if (b->o.method != SPH_SIMPLIFY_PULLED_BACK) {
        for (size_t i = 0; i < size; ++i)
            out[i] = (float)block[i];
        return;
    }
    sph__kernel_pull_back(block, b->examples, b->skin->bone_count, b->example_stride,
                          b->bones + (size_t)point * b->wide, b->weights + (size_t)point * b->wide,
                          sph__simplify_bone_count(b, point), pulled);
    memset(out, 0, SPH__QUADRIC_ROWS * SPH__LANES * sizeof *out);
    for (size_t q = 0; q < 6; ++q)
        out[q * SPH__LANES] = (float)(pulled[q] / (b->scale * b->scale));
}

static void make_leaf(const leaves *l, uint32_t point, double *block)
{
    const sph__simplifier *b = l->b;
    const uint32_t *triangles = sph__triangles_of(&b->mesh, point);
    const float *posed = l->posed + point * 3 * b->example_stride;
    double sums[2] = {0, 0};
    const bool pulled = b->o.method == SPH_SIMPLIFY_PULLED_BACK;
    sph__simplify_place(b, point, sph__center_of(b, point));
    memset(block, 0, SPH__QUADRIC_ROWS * b->example_stride * sizeof *block);
    for (uint32_t i = 0; i < sph__triangle_count_of(&b->mesh, point); ++i)
        add_triangle(l, triangles[i], point, pulled ? posed : sph__center_of(b, point), block, sums);
    b->costs[point] = b->shown[point] = sums[0];
    b->areas[point] = sums[1];
    store(b, point, block);
}

static void make_range(void *argument, size_t begin, size_t end)
{
    const leaves *l = argument;
    double *block = l->blocks + begin / l->grain * SPH__QUADRIC_ROWS * l->b->example_stride;
    for (size_t i = begin; i < end; ++i)
        make_leaf(l, (uint32_t)i, block);
}

static sph_status allocate(leaves *l)
{
    sph__simplifier *b = l->b;
    const size_t n = b->points, block = SPH__QUADRIC_ROWS * b->stride;
    const size_t row = 3 * b->example_stride * sizeof(float);
    l->posed = sph__zalloc(b->context, n, row);
    l->borders = sph__zalloc(b->context, b->mesh.triangle_count, 1);
    l->blocks = sph__alloc(b->context, SPH__SIMPLIFY_ROOMS, SPH__QUADRIC_ROWS * b->example_stride * sizeof *l->blocks);
    b->centers = sph__alloc(b->context, 2 * n, 3 * b->stride * sizeof *b->centers);
    b->new_center = sph__alloc(b->context, 3 * b->stride, sizeof *b->new_center);
    b->zeros = sph__zalloc(b->context, block, sizeof *b->zeros);
    b->blocks = sph__alloc(b->context, n, block * sizeof *b->blocks);
    b->costs = sph__alloc(b->context, n, sizeof *b->costs);
    b->areas = sph__alloc(b->context, n, sizeof *b->areas);
    b->shown = sph__alloc(b->context, n, sizeof *b->shown);
    b->slot_of = sph__alloc(b->context, 2 * n, sizeof *b->slot_of);
    if (l->posed == NULL || l->borders == NULL || l->blocks == NULL || b->centers == NULL || b->new_center == NULL ||
        b->zeros == NULL || b->blocks == NULL || b->costs == NULL || b->areas == NULL || b->shown == NULL ||
        b->slot_of == NULL)
        return sph__fail_memory(b->context);
    l->grain = (n + SPH__SIMPLIFY_ROOMS - 1) / SPH__SIMPLIFY_ROOMS;
    return SPH_OK;
}

/* slot_of: the first vertex of each point, while they are posed; then their slots. */
static void pose_all(leaves *l)
{
    sph__simplifier *b = l->b;
    for (uint32_t v = b->n; v-- > 0;)
        b->slot_of[b->point_of[v]] = v;
    sph__parallel_for(b->context, b->n, POINT_GRAIN, pose_points, l);
    for (uint32_t i = 0; i < b->points; ++i)
        b->slot_of[i] = i;
}

sph_status sph__simplify_make_leaves(sph__simplifier *b)
{
    leaves l = {.b = b};
    double largest = 0;
    sph_status status = allocate(&l);
    if (status == SPH_OK) {
        pose_all(&l);
        status = measure(&l, &largest);
    }
    if (status == SPH_OK) {
        scale(&l, largest);
        sph__parallel_for(b->context, b->mesh.triangle_count, POINT_GRAIN, find_borders, &l);
        sph__parallel_for(b->context, b->points, l.grain, make_range, &l);
        for (uint32_t i = 0; i < b->points; ++i) {
            b->live_cost += b->costs[i];
            b->live_area += b->areas[i];
        }
    }
    sph__free(b->context, l.posed);
    sph__free(b->context, l.borders);
    sph__free(b->context, l.blocks);
    return status;
}
