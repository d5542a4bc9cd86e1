/* SPDX-License-Identifier: MIT */
#include "simplicial.h"

#include <stdlib.h>
#include <string.h>

#include "support.h"

static int compare_rows(const uint32_t *a, const uint32_t *b, unsigned width)
{
    for (unsigned k = 0; k < width; ++k)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_edges(const void *a, const void *b)
{
    return compare_rows(a, b, 2);
}

static int compare_triangles(const void *a, const void *b)
{
    return compare_rows(a, b, 3);
}

/* Drops repeated rows of a sorted array. */
static size_t unique_rows(uint32_t *rows, size_t count, unsigned width)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; ++i) {
        if (kept > 0 && compare_rows(rows + (kept - 1) * width, rows + i * width, width) == 0) continue;
        memmove(rows + kept++ * width, rows + i * width, width * sizeof *rows);
    }
    return kept;
}

static void add_edge(simplicial *c, uint32_t a, uint32_t b)
{
    if (a == b || a == SPH_NO_SPHERE || b == SPH_NO_SPHERE) return;
    c->edges[c->edge_count][0] = a < b ? a : b;
    c->edges[c->edge_count++][1] = a < b ? b : a;
}

static void swap_if_greater(uint32_t *a, uint32_t *b)
{
    const uint32_t x = *a;
    if (*a <= *b) return;
    *a = *b;
    *b = x;
}

static void add_triangle(simplicial *c, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t *t = c->triangles[c->triangle_count];
    add_edge(c, x, y);
    add_edge(c, y, z);
    add_edge(c, z, x);
    if (x == y || y == z || z == x || x == SPH_NO_SPHERE || y == SPH_NO_SPHERE || z == SPH_NO_SPHERE) return;
    memcpy(t, (uint32_t[3]){x, y, z}, 3 * sizeof *t);
    swap_if_greater(&t[0], &t[1]);
    swap_if_greater(&t[1], &t[2]);
    swap_if_greater(&t[0], &t[1]);
    ++c->triangle_count;
}

static simplicial start(uint32_t vertex_count, size_t edges, size_t triangles)
{
    return (simplicial){.vertex_count = vertex_count,
                        .edges = test_malloc(edges + 3 * triangles, 2 * sizeof(uint32_t)),
                        .triangles = test_malloc(triangles + 1, 3 * sizeof(uint32_t))};
}

static void sort(simplicial *c)
{
    qsort(c->edges, c->edge_count, sizeof *c->edges, compare_edges);
    qsort(c->triangles, c->triangle_count, sizeof *c->triangles, compare_triangles);
}

simplicial simplicial_of_labels(const sph_animation *animation, const uint32_t *labels, uint32_t vertex_count)
{
    const uint32_t *t = sph_animation_triangles(animation), *e = sph_animation_edges(animation);
    const size_t triangles = sph_animation_triangle_count(animation), edges = sph_animation_edge_count(animation);
    simplicial c = start(vertex_count, edges, triangles);
    for (size_t i = 0; i < triangles; ++i, t += 3)
        add_triangle(&c, labels[t[0]], labels[t[1]], labels[t[2]]);
    for (size_t i = 0; i < edges; ++i, e += 2)
        add_edge(&c, labels[e[0]], labels[e[1]]);
    sort(&c);
    c.edge_count = unique_rows(c.edges[0], c.edge_count, 2);
    c.triangle_count = unique_rows(c.triangles[0], c.triangle_count, 3);
    return c;
}

simplicial simplicial_of_level(const sph_level_arrays *arrays, const char **wrong)
{
    simplicial c = start(arrays->sphere_count, arrays->edge_count, arrays->triangle_count);
    size_t wires;
    *wrong = NULL;
    for (size_t i = 0; i < 2 * arrays->edge_count; ++i)
        if (arrays->edges[i] >= arrays->sphere_count) *wrong = "an edge names no sphere";
    for (size_t i = 0; i < 3 * arrays->triangle_count; ++i)
        if (arrays->triangles[i] >= arrays->sphere_count) *wrong = "a triangle names no sphere";
    if (*wrong != NULL) return c;
    for (size_t i = 0; i < arrays->triangle_count; ++i) {
        const uint32_t *t = arrays->triangles + 3 * i;
        add_triangle(&c, t[0], t[1], t[2]);
    }
    if (c.triangle_count != arrays->triangle_count) *wrong = "a triangle names a sphere twice";
    sort(&c);
    if (unique_rows(c.triangles[0], c.triangle_count, 3) != c.triangle_count) *wrong = "a triangle is there twice";
    wires = c.edge_count = unique_rows(c.edges[0], c.edge_count, 2);
    for (size_t i = 0; i < arrays->edge_count; ++i)
        add_edge(&c, arrays->edges[2 * i], arrays->edges[2 * i + 1]);
    if (c.edge_count != wires + arrays->edge_count) *wrong = "a wire edge names a sphere twice";
    sort(&c);
    if (unique_rows(c.edges[0], c.edge_count, 2) != c.edge_count)
        *wrong = "a wire edge is there twice or belongs to a triangle";
    return c;
}

void simplicial_free(simplicial *c)
{
    free(c->edges);
    free(c->triangles);
    *c = (simplicial){0};
}

bool simplicial_equal(const simplicial *a, const simplicial *b)
{
    return a->vertex_count == b->vertex_count && a->edge_count == b->edge_count &&
           a->triangle_count == b->triangle_count &&
           (a->edge_count == 0 || memcmp(a->edges, b->edges, a->edge_count * sizeof *a->edges) == 0) &&
           (a->triangle_count == 0 ||
            memcmp(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles) == 0);
}

bool simplicial_has_edge(const simplicial *c, uint32_t a, uint32_t b)
{
    uint32_t key[2] = {a, b};
    swap_if_greater(&key[0], &key[1]);
    return c->edge_count > 0 && bsearch(key, c->edges, c->edge_count, sizeof *c->edges, compare_edges) != NULL;
}

bool simplicial_has_triangle(const simplicial *c, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t key[3] = {x, y, z};
    swap_if_greater(&key[0], &key[1]);
    swap_if_greater(&key[1], &key[2]);
    swap_if_greater(&key[0], &key[1]);
    return c->triangle_count > 0 &&
           bsearch(key, c->triangles, c->triangle_count, sizeof *c->triangles, compare_triangles) != NULL;
}

static uint32_t find(uint32_t *parents, uint32_t v)
{
    while (parents[v] != v)
        v = parents[v] = parents[parents[v]];
    return v;
}

uint32_t simplicial_components(const simplicial *c)
{
    uint32_t *parents = test_malloc(c->vertex_count, sizeof *parents), count = 0;
    for (uint32_t v = 0; v < c->vertex_count; ++v)
        parents[v] = v;
    for (size_t e = 0; e < c->edge_count; ++e)
        parents[find(parents, c->edges[e][0])] = find(parents, c->edges[e][1]);
    for (uint32_t v = 0; v < c->vertex_count; ++v)
        count += parents[v] == v;
    free(parents);
    return count;
}

long simplicial_euler(const simplicial *c)
{
    return (long)c->vertex_count - (long)c->edge_count + (long)c->triangle_count;
}

/*
 * One vertex and the edge (u, v) go, which cancels; so do the triangles at that edge, one of each pair of edges to a
 * common neighbour, and one of each pair of triangles over a common edge.
 */
long simplicial_euler_change(const simplicial *c, uint32_t u, uint32_t v)
{
    long change = 0;
    for (uint32_t x = 0; x < c->vertex_count; ++x) {
        if (x == u || x == v) continue;
        change += simplicial_has_edge(c, u, x) && simplicial_has_edge(c, v, x);
        change -= simplicial_has_triangle(c, u, v, x);
    }
    for (size_t e = 0; e < c->edge_count; ++e) {
        const uint32_t x = c->edges[e][0], y = c->edges[e][1];
        if (x == u || x == v || y == u || y == v) continue;
        change -= simplicial_has_triangle(c, u, x, y) && simplicial_has_triangle(c, v, x, y);
    }
    return change;
}
