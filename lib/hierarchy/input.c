/* SPDX-License-Identifier: MIT */
/* The simplices of the input as decimation wants them: triangles that are wound outward. */
#include <math.h>

#include "hierarchy/build.h"

/* Whether the triangles close around v: by each edge that one leaves by exactly one comes in. */
static bool is_closed_around(const sph__builder *b, uint32_t v)
{
    const size_t begin = b->cell_starts[v], end = b->cell_starts[v + 1];
    if (begin == end || end - begin > SPH__FAN_LIMIT) return false;
    for (size_t i = begin; i < end; ++i) {
        uint32_t came = 0;
        for (size_t j = begin; j < end; ++j) came += b->vertex_cells[j][1] == b->vertex_cells[i][0];
        if (came != 1) return false;
    }
    return true;
}

/* Puts the triangles around v one after the other, as far as they hang together: whoever takes them in turn needs one more
 * corner for each, not two. */
static void chain_cells(sph__builder *b, uint32_t v)
{
    uint32_t(*cells)[2] = b->vertex_cells + b->cell_starts[v];
    const size_t count = b->cell_starts[v + 1] - b->cell_starts[v];
    if (count > SPH__FAN_LIMIT) return;
    for (size_t i = 1; i < count; ++i)
        for (size_t j = i; j < count; ++j) {
            const uint32_t found[2] = {cells[j][0], cells[j][1]};
            if (found[0] != cells[i - 1][1]) continue;
            memcpy(cells[j], cells[i], sizeof found);
            memcpy(cells[i], found, sizeof found);
            break;
        }
}

static sph_status list_cells(sph__builder *b)
{
    b->cell_starts = sph__zalloc(b->context, (size_t)b->n + 1, sizeof *b->cell_starts);
    b->vertex_cells = sph__alloc(b->context, 3 * b->cell_count, sizeof *b->vertex_cells);
    if (b->cell_starts == NULL || b->vertex_cells == NULL) return sph__fail_memory(b->context);
    for (size_t i = 0; i < 3 * b->cell_count; ++i) ++b->cell_starts[b->cells[i]];
    for (size_t v = 0, sum = 0; v <= b->n; ++v) {
        const size_t count = b->cell_starts[v];
        b->cell_starts[v] = sum;
        sum += count;
    }
    for (size_t t = 0; t < b->cell_count; ++t)
        for (unsigned k = 0; k < 3; ++k) {
            const uint32_t *corner = b->cells + 3 * t;
            uint32_t *others = b->vertex_cells[b->cell_starts[corner[k]]++];
            others[0] = corner[(k + 1) % 3];
            others[1] = corner[(k + 2) % 3];
        }
    for (size_t v = b->n; v > 0; --v) b->cell_starts[v] = b->cell_starts[v - 1];
    b->cell_starts[0] = 0;
    b->cell_open = sph__alloc(b->context, b->n, sizeof *b->cell_open);
    if (b->cell_open == NULL) return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) {
        b->cell_open[v] = !is_closed_around(b, v);
        chain_cells(b, v);
    }
    return SPH_OK;
}

/* The component of each triangle, as its lowest-numbered vertex; by union-find with path halving. */
static uint32_t find_root(uint32_t *parents, uint32_t v)
{
    while (parents[v] != v) v = parents[v] = parents[parents[v]];
    return v;
}

static sph_status find_components(const sph__builder *b, uint32_t **roots)
{
    uint32_t *parents = sph__alloc(b->context, b->n, sizeof *parents);
    if (parents == NULL) return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) parents[v] = v;
    for (size_t t = 0; t < b->cell_count; ++t)
        for (unsigned k = 1; k < 3; ++k) {
            const uint32_t p = find_root(parents, b->cells[3 * t]), q = find_root(parents, b->cells[3 * t + k]);
            if (p < q)
                parents[q] = p;
            else
                parents[p] = q;
        }
    for (uint32_t v = 0; v < b->n; ++v) parents[v] = find_root(parents, v);
    *roots = parents;
    return SPH_OK;
}

/* What triangles enclose with the first vertices of their components, and their areas. */
typedef struct volumes {
    const sph__builder *b;
    const uint32_t *roots;
    size_t first;           /* of the triangles at work */
    double (*triangles)[2]; /* signed volume and area of each, over all frames */
} volumes;

static void measure_range(void *argument, size_t begin, size_t end)
{
    const volumes *v = argument;
    for (size_t t = begin; t < end; ++t) {
        const uint32_t *corner = v->b->cells + 3 * (v->first + t);
        sph__kernel_volume(sph__node_center(v->b, v->roots[corner[0]]), sph__node_center(v->b, corner[0]),
                           sph__node_center(v->b, corner[1]), sph__node_center(v->b, corner[2]), v->b->stride,
                           v->triangles[t]);
    }
}

/* The same of one frame: eight triangles at once. */
static void measure_single_range(void *argument, size_t begin, size_t end)
{
    const volumes *v = argument;
    _Alignas(SPH__ALIGN) float corners[4][3][SPH__LANES] = {{{0}}};
    double sums[SPH__LANES][2];
    for (size_t t = begin; t < end; t += SPH__LANES) {
        const size_t count = end - t < SPH__LANES ? end - t : SPH__LANES;
        for (size_t l = 0; l < count; ++l) {
            const uint32_t *corner = v->b->cells + 3 * (v->first + t + l);
            for (size_t k = 0; k < 3; ++k) {
                corners[0][k][l] = sph__node_center(v->b, v->roots[corner[0]])[k];
                for (size_t c = 0; c < 3; ++c) corners[c + 1][k][l] = sph__node_center(v->b, corner[c])[k];
            }
        }
        sph__kernel_volumes(corners, sums);
        memcpy(v->triangles + t, sums, count * sizeof *sums);
    }
}

/* Adds them up by component. */
static sph_status add_volumes(const sph__builder *b, const uint32_t *roots, double (*sums)[2])
{
    enum { GRAIN = 64, CHUNK = 1 << 14 };
    volumes v = {b, roots, 0, sph__alloc(b->context, CHUNK, sizeof *v.triangles)};
    if (v.triangles == NULL) return sph__fail_memory(b->context);
    for (size_t i = 0; i < b->n; ++i) sums[roots[i]][0] = sums[roots[i]][1] = 0;
    for (; v.first < b->cell_count; v.first += CHUNK) {
        const size_t count = b->cell_count - v.first < CHUNK ? b->cell_count - v.first : CHUNK;
        sph__parallel_for(b->context, count, GRAIN, b->single ? measure_single_range : measure_range, &v);
        for (size_t t = 0; t < count; ++t)
            for (unsigned k = 0; k < 2; ++k) sums[roots[b->cells[3 * (v.first + t)]]][k] += v.triangles[t][k];
    }
    sph__free(b->context, v.triangles);
    return SPH_OK;
}

/* A component counts as inside out where its signed volume is at most this part of a ball's of its area, negated. */
#define INWARD_SHARE 0.01

static void turn_inward_components(sph__builder *b, const uint32_t *roots, double (*sums)[2])
{
    for (size_t t = 0; t < b->cell_count; ++t) {
        const double *v = sums[roots[b->cells[3 * t]]];
        const double area = v[1] / b->frames, ball = area * sqrt(area) / 10.6347; /* 6 sqrt(pi) */
        if (v[0] / b->frames >= -INWARD_SHARE * ball) continue;
        const uint32_t swapped = b->cells[3 * t + 1];
        b->cells[3 * t + 1] = b->cells[3 * t + 2];
        b->cells[3 * t + 2] = swapped;
    }
}

static sph_status orient_outward(sph__builder *b)
{
    uint32_t *roots = NULL;
    double(*sums)[2];
    sph_status status = find_components(b, &roots);
    if (status != SPH_OK) return status;
    sums = sph__alloc(b->context, b->n, sizeof *sums); /* those of roots are used alone */
    status = sums == NULL ? sph__fail_memory(b->context) : add_volumes(b, roots, sums);
    if (status == SPH_OK) turn_inward_components(b, roots, sums);
    sph__free(b->context, sums);
    sph__free(b->context, roots);
    return status;
}

/* A triangle that names a vertex twice is an edge, or a point. */
static void split_triangles(sph__builder *b)
{
    for (size_t t = 0; t < b->animation->triangle_count; ++t) {
        const uint32_t *corner = b->animation->triangles + 3 * t;
        if (corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0]) {
            memcpy(b->cells + 3 * b->cell_count++, corner, 3 * sizeof *corner);
            continue;
        }
        b->wire[2 * b->wire_count] = corner[0];
        b->wire[2 * b->wire_count++ + 1] = corner[0] != corner[1] ? corner[1] : corner[2];
    }
}

sph_status sph__make_cells(sph__builder *b)
{
    const size_t triangles = b->animation->triangle_count, edges = b->animation->edge_count;
    sph_status status;
    b->cells = sph__alloc(b->context, 3 * triangles, sizeof *b->cells);
    b->wire = sph__alloc(b->context, edges + triangles, 2 * sizeof *b->wire);
    if (b->cells == NULL || b->wire == NULL) return sph__fail_memory(b->context);
    if (edges > 0) memcpy(b->wire, b->animation->edges, 2 * edges * sizeof *b->wire);
    b->wire_count = edges;
    split_triangles(b);
    if (b->options.orientation == SPH_ORIENTATION_OUTWARD) {
        status = orient_outward(b);
        if (status != SPH_OK) return status;
    }
    return list_cells(b);
}
