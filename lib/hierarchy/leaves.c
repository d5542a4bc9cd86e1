/* SPDX-License-Identifier: MIT */
/* The regions of single vertices: their quadrics, from the triangles around them. */
#include <math.h>

#include "hierarchy/build.h"
#include "hierarchy/lanes.h"

/* Adds one triangle's plane, of every frame, to the quadric of its corner p. `weights` are 2/3 times the importance. */
SPH__CLONES static double add_triangle(const float *p, const float *q, const float *r, size_t s, double weight,
                                       const float *weights, float *block)
{
    sph__v8d total = {0};
    for (size_t i = 0; i < s; i += SPH__LANES) {
        const sph__v8d px = sph__load(p, i), py = sph__load(p, s + i), pz = sph__load(p, 2 * s + i);
        const sph__v8d ex = sph__load(q, i) - px, ey = sph__load(q, s + i) - py, ez = sph__load(q, 2 * s + i) - pz;
        const sph__v8d fx = sph__load(r, i) - px, fy = sph__load(r, s + i) - py, fz = sph__load(r, 2 * s + i) - pz;
        const sph__v8d nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
        const sph__v8d squared = nx * nx + ny * ny + nz * nz;
        sph__v8d length, scale, w = {0};
        for (size_t l = 0; l < SPH__LANES; ++l) length[l] = sqrt(squared[l]);
        w += weight;
        if (weights != NULL) w *= sph__load(weights, i);
        /* w = weight * area: N = 2 w n = weight' * (length / 2) n */
        scale = sph__select(squared > 0, w / length, squared - squared);
        total += w * length;
        sph__store(block, 0 * s + i, sph__load(block, 0 * s + i) + scale * nx * nx);
        sph__store(block, 1 * s + i, sph__load(block, 1 * s + i) + scale * nx * ny);
        sph__store(block, 2 * s + i, sph__load(block, 2 * s + i) + scale * nx * nz);
        sph__store(block, 3 * s + i, sph__load(block, 3 * s + i) + scale * ny * ny);
        sph__store(block, 4 * s + i, sph__load(block, 4 * s + i) + scale * ny * nz);
        sph__store(block, 5 * s + i, sph__load(block, 5 * s + i) + scale * nz * nz);
        sph__store(block, 6 * s + i, sph__load(block, 6 * s + i) + w * nx);
        sph__store(block, 7 * s + i, sph__load(block, 7 * s + i) + w * ny);
        sph__store(block, 8 * s + i, sph__load(block, 8 * s + i) + w * nz);
    }
    return sph__sum(total);
}

/* The quadric of vertex v into the leaf rows of `block`; returns W. */
static double make_leaf(const sph__builder *b, uint32_t v, float *block)
{
    const size_t s = b->stride;
    double w = 0;
    memset(block, 0, SPH__BLOCK_ROWS * s * sizeof *block);
    for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
        const uint32_t *corner = b->cells + 3 * (size_t)b->vertex_cells[i];
        const unsigned at = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
        const float *weights = b->importance_per_frame ? b->importance + v * s : NULL;
        const double k = b->importance != NULL && !b->importance_per_frame ? (double)b->importance[v] : 1;
        /* 2 * area / 3 = length / 3 */
        w += add_triangle(sph__node_center(b, v), sph__node_center(b, corner[(at + 1) % 3]),
                          sph__node_center(b, corner[(at + 2) % 3]), s, k / 3, weights, block);
    }
    if (b->options.importance == SPH_IMPORTANCE_CURVATURE) w += sph__add_cap(b, v, block);
    return w;
}

static void make_range(void *argument, size_t begin, size_t end)
{
    sph__builder *b = argument;
    for (size_t v = begin; v < end; ++v) b->slots[v].w = make_leaf(b, (uint32_t)v, b->slots[v].block);
}

/* Area of v's cell and its mean (the vertex itself) per frame. */
static void make_mean(const sph__builder *b, uint32_t v, float *rows)
{
    const size_t s = b->stride;
    const float *p = sph__node_center(b, v);
    memcpy(rows, p, 3 * s * sizeof *rows);
    for (size_t f = 0; f < s; ++f) {
        double area = 0;
        for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
            const uint32_t *corner = b->cells + 3 * (size_t)b->vertex_cells[i];
            const float *x = sph__node_center(b, corner[0]), *y = sph__node_center(b, corner[1]);
            const float *z = sph__node_center(b, corner[2]);
            double e[3], g[3], squared = 0;
            for (unsigned k = 0; k < 3; ++k) {
                e[k] = (double)y[k * s + f] - x[k * s + f];
                g[k] = (double)z[k * s + f] - x[k * s + f];
            }
            for (unsigned k = 0; k < 3; ++k) {
                const double n = e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3];
                squared += n * n;
            }
            area += sqrt(squared) / 6;
        }
        rows[3 * s + f] = (float)area;
    }
}

static sph_status make_means(sph__builder *b)
{
    b->means = sph__alloc(b->context, (size_t)b->n, 4 * b->stride * sizeof *b->means);
    if (b->means == NULL) return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) make_mean(b, v, b->means + v * 4 * b->stride);
    return SPH_OK;
}

sph_status sph__make_leaves(sph__builder *b)
{
    enum { BATCH = 4096, GRAIN = 64 };
    for (uint32_t v = 0; v < b->n; ++v) {
        sph__slot *slot = &b->slots[v];
        *slot = (sph__slot){.node = v, .first = v, .last = v, .count = 1, .block = sph__blocks_take(&b->blocks)};
        if (slot->block == NULL) return sph__fail_memory(b->context);
        b->slot_of[v] = v;
        b->next_member[v] = SPH__NO_NODE;
        if (b->h->radii_per_frame)
            memset(b->h->radii + v * b->stride, 0, b->stride * sizeof *b->h->radii);
        else
            b->h->radii[v] = 0;
    }
    sph__parallel_for(b->context, b->n, GRAIN, make_range, b);
    for (uint32_t v = 0; v < b->n; ++v) b->live_weight += b->slots[v].w;
    return b->coherence > 0 ? make_means(b) : SPH_OK;
}

sph__region sph__region_of(const sph__builder *b, uint32_t node)
{
    const sph__slot *slot = &b->slots[b->slot_of[node]];
    return (sph__region){.block = slot->block,
                         .center = sph__node_center(b, node),
                         .mean = b->means == NULL ? NULL : b->means + b->slot_of[node] * 4 * b->stride,
                         .radius = b->h->radii_per_frame ? 0 : (double)b->h->radii[node],
                         .w = slot->w,
                         .b = slot->b,
                         .c = slot->c,
                         .leaf = node < b->n};
}
