/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700

#include "kernel_loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "hierarchy/build.h"

struct kernel_loop {
    uint32_t n, frames;
    size_t stride;
    float *centers, *blocks; /* [n][3][stride], [n] blocks of SPH__BLOCK_ROWS rows */
    double *weights;         /* [n] */
    uint32_t (*edges)[2];
    size_t edge_count;
    double sum; /* of costs, so that none can be left out */
};

static void *allocate(size_t count, size_t size)
{
    void *memory = NULL;
    if (posix_memalign(&memory, 64, count * size) != 0) bench_die(NULL, "memory");
    memset(memory, 0, count * size);
    return memory;
}

/* Adds the plane of one triangle in one frame to the quadric of a corner. */
static void add_plane(kernel_loop *l, uint32_t v, size_t frame, const double n[3], double area)
{
    static const unsigned ROWS[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
    float *block = l->blocks + v * SPH__BLOCK_ROWS * l->stride;
    for (unsigned k = 0; k < 6; ++k)
        block[sph__block_place(SPH__BLOCK_ROWS, k, frame)] += (float)(2 * area * n[ROWS[k][0]] * n[ROWS[k][1]]);
    for (unsigned k = 0; k < 3; ++k) {
        block[sph__block_place(SPH__BLOCK_ROWS, SPH__N0 + k, frame)] += (float)(2 * area * n[k]);
        block[sph__block_place(SPH__BLOCK_ROWS, SPH__B0 + k, frame)] += (float)(1e-3 * area * n[k]);
    }
    l->weights[v] += 2 * area;
}

static void add_frame(kernel_loop *l, const sph_animation *animation, size_t frame, const float *xyz)
{
    const uint32_t *triangles = sph_animation_triangles(animation);
    for (uint32_t v = 0; v < l->n; ++v)
        for (unsigned k = 0; k < 3; ++k)
            l->centers[(3 * (size_t)v + k) * l->stride + frame] = xyz[3 * (size_t)v + k];
    for (size_t t = 0; t < sph_animation_triangle_count(animation); ++t) {
        const uint32_t *c = triangles + 3 * t;
        const float *p = xyz + 3 * (size_t)c[0], *q = xyz + 3 * (size_t)c[1], *r = xyz + 3 * (size_t)c[2];
        double e[3], g[3], n[3], length;
        for (unsigned k = 0; k < 3; ++k) {
            e[k] = (double)q[k] - p[k];
            g[k] = (double)r[k] - p[k];
        }
        for (unsigned k = 0; k < 3; ++k)
            n[k] = e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3];
        length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!(length > 0)) continue;
        for (unsigned k = 0; k < 3; ++k)
            n[k] /= length;
        for (unsigned k = 0; k < 3; ++k)
            add_plane(l, c[k], frame, n, length / 6);
    }
}

/* Each edge of two triangles once, the smaller end first; then shuffled. */
static void list_edges(kernel_loop *l, const sph_animation *animation)
{
    const uint32_t *triangles = sph_animation_triangles(animation);
    const size_t corners = 3 * sph_animation_triangle_count(animation);
    uint64_t state = 1;
    l->edges = allocate(corners, sizeof *l->edges);
    for (size_t i = 0; i < corners; ++i) {
        const uint32_t a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1];
        if (a >= b) continue;
        l->edges[l->edge_count][0] = a;
        l->edges[l->edge_count++][1] = b;
    }
    for (size_t i = l->edge_count; i > 1; --i) {
        const size_t j = bench_random(&state) % i;
        uint32_t kept[2];
        memcpy(kept, l->edges[i - 1], sizeof kept);
        memcpy(l->edges[i - 1], l->edges[j], sizeof kept);
        memcpy(l->edges[j], kept, sizeof kept);
    }
}

kernel_loop *kernel_loop_create(const sph_animation *animation)
{
    kernel_loop *l = allocate(1, sizeof *l);
    float *xyz;
    l->n = sph_animation_vertex_count(animation);
    l->frames = sph_animation_frame_count(animation);
    l->stride = (l->frames + (size_t)SPH__LANES - 1) / SPH__LANES * SPH__LANES;
    l->centers = allocate(3 * (size_t)l->n * l->stride, sizeof *l->centers);
    l->blocks = allocate(SPH__BLOCK_ROWS * (size_t)l->n * l->stride, sizeof *l->blocks);
    l->weights = allocate(l->n, sizeof *l->weights);
    xyz = allocate(l->n, 3 * sizeof *xyz);
    for (uint32_t f = 0; f < l->frames; ++f) {
        if (sph_animation_read_frame(animation, f, xyz) != SPH_OK) bench_die(NULL, "frame");
        add_frame(l, animation, f, xyz);
    }
    free(xyz);
    list_edges(l, animation);
    return l;
}

static sph__region region(const kernel_loop *l, uint32_t v)
{
    return (sph__region){.block = l->blocks + v * SPH__BLOCK_ROWS * l->stride,
                         .center = l->centers + v * 3 * l->stride,
                         .w = l->weights[v]};
}

double kernel_loop_run(kernel_loop *l, uint64_t evaluations)
{
    const double began = bench_processor();
    for (uint64_t i = 0; i < evaluations; ++i) {
        const uint32_t *ends = l->edges[i % l->edge_count];
        const sph__region u = region(l, ends[0]), v = region(l, ends[1]);
        sph__sums sums;
        sph__kernel_sums(&u, &v, l->frames, l->stride, 0, &sums);
        l->sum += sph__sums_minimize(&sums, u.radius, INFINITY).cost;
    }
    return bench_processor() - began;
}

void kernel_loop_destroy(kernel_loop *l)
{
    free(l->centers);
    free(l->blocks);
    free(l->weights);
    free(l->edges);
    free(l);
}
