/* SPDX-License-Identifier: MIT */
#include "mesh_check.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "support.h"

/* As ck_assert_msg(), which tells Check of each call, too slow for every edge of a mesh. */
#define REQUIRE(what, ...) ((what) ? (void)0 : ck_abort_msg(__VA_ARGS__))

/* A directed edge and the corner opposite to it. */
typedef struct half_edge {
    uint32_t from, to, across;
} half_edge;

static int compare(const void *a, const void *b)
{
    const half_edge *p = a, *q = b;
    if (p->from != q->from) return p->from < q->from ? -1 : 1;
    return p->to < q->to ? -1 : p->to > q->to;
}

static const half_edge *find(const half_edge *edges, size_t count, uint32_t from, uint32_t to)
{
    const half_edge key = {from, to, 0};
    return bsearch(&key, edges, count, sizeof key, compare);
}

static half_edge *sort_edges(const uint32_t *t, size_t triangle_count)
{
    half_edge *edges = test_malloc(3 * triangle_count + 1, sizeof *edges);
    for (size_t i = 0; i < triangle_count; ++i)
        for (size_t k = 0; k < 3; ++k)
            edges[3 * i + k] = (half_edge){t[3 * i + k], t[3 * i + (k + 1) % 3], t[3 * i + (k + 2) % 3]};
    qsort(edges, 3 * triangle_count, sizeof *edges, compare);
    return edges;
}

/* Triangles around each vertex: as many as one walk around it meets. */
static void check_links(const half_edge *edges, size_t count, uint32_t vertex_count)
{
    size_t begin = 0;
    for (uint32_t v = 0; v < vertex_count; ++v) {
        size_t end = begin, walked = 0;
        const half_edge *e = &edges[begin];
        while (end < count && edges[end].from == v)
            ++end;
        REQUIRE(end - begin >= 3, "vertex %u has %zu triangles", (unsigned)v, end - begin);
        do {
            e = find(edges, count, v, e->across);
            REQUIRE(e != NULL, "an edge has one triangle");
        } while (++walked < count && e != &edges[begin]);
        REQUIRE(walked == end - begin, "vertex %u: %zu triangles in its first cycle, %zu in all", (unsigned)v, walked,
                end - begin);
        begin = end;
    }
}

static int count_parts(const uint32_t *t, size_t triangle_count, uint32_t vertex_count)
{
    uint32_t *parent = test_malloc(vertex_count + 1, sizeof *parent);
    int parts = (int)vertex_count;
    for (uint32_t i = 0; i < vertex_count; ++i)
        parent[i] = i;
    for (size_t i = 0; i < 3 * triangle_count; ++i) {
        uint32_t a = t[i], b = t[i - i % 3];
        while (parent[a] != a)
            a = parent[a] = parent[parent[a]];
        while (parent[b] != b)
            b = parent[b] = parent[parent[b]];
        if (a != b) --parts;
        parent[a] = b;
    }
    free(parent);
    return parts;
}

static void subtract(const float *a, const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[k] - b[k];
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void measure(const float *xyz, const uint32_t *t, size_t triangle_count, mesh_facts *f)
{
    const double origin[3] = {xyz[0], xyz[1], xyz[2]};
    for (size_t i = 0; i < triangle_count; ++i) {
        double a[3], b[3], c[3], u[3], v[3];
        subtract(xyz + 3 * (size_t)t[3 * i], origin, a);
        subtract(xyz + 3 * (size_t)t[3 * i + 1], origin, b);
        subtract(xyz + 3 * (size_t)t[3 * i + 2], origin, c);
        f->volume += determinant(a, b, c) / 6;
        for (int k = 0; k < 3; ++k) {
            u[k] = b[k] - a[k];
            v[k] = c[k] - a[k];
        }
        f->area += sqrt(fmax(0, dot(u, u) * dot(v, v) - dot(u, v) * dot(u, v))) / 2;
    }
}

mesh_facts check_surface(const sph_surface *surface, uint32_t index)
{
    const uint32_t *t = sph_surface_triangles(surface, index);
    const uint32_t vertex_count = sph_surface_vertex_count(surface, index);
    const size_t triangle_count = sph_surface_triangle_count(surface, index), edge_count = 3 * triangle_count;
    const float *normals = sph_surface_normals(surface, index);
    mesh_facts f = {0};
    half_edge *edges;
    ck_assert_uint_gt(triangle_count, 3);
    for (size_t i = 0; i < edge_count; ++i)
        REQUIRE(t[i] < vertex_count, "there is no vertex %u", (unsigned)t[i]);
    edges = sort_edges(t, triangle_count);
    for (size_t i = 0; i < edge_count; ++i) {
        REQUIRE(edges[i].from != edges[i].to, "a triangle has a vertex twice");
        REQUIRE(i == 0 || compare(&edges[i - 1], &edges[i]) != 0, "two triangles run through an edge alike");
        REQUIRE(find(edges, edge_count, edges[i].to, edges[i].from) != NULL, "an edge has one triangle");
    }
    check_links(edges, edge_count, vertex_count);
    free(edges);
    for (size_t i = 0; i < 3 * (size_t)vertex_count; i += 3) {
        const double n[3] = {normals[i], normals[i + 1], normals[i + 2]};
        REQUIRE(fabs(dot(n, n) - 1) < 1e-5, "normal %zu has length %g", i / 3, sqrt(dot(n, n)));
    }
    f.euler = (int)((int64_t)vertex_count - (int64_t)(edge_count / 2) + (int64_t)triangle_count);
    f.parts = count_parts(t, triangle_count, vertex_count);
    measure(sph_surface_positions(surface, index), t, triangle_count, &f);
    return f;
}

double winding_number(const sph_surface *surface, uint32_t index, const double x[3])
{
    const float *xyz = sph_surface_positions(surface, index);
    const uint32_t *t = sph_surface_triangles(surface, index);
    double sum = 0;
    for (size_t i = 0; i < sph_surface_triangle_count(surface, index); ++i) {
        double a[3], b[3], c[3], la, lb, lc;
        subtract(xyz + 3 * (size_t)t[3 * i], x, a);
        subtract(xyz + 3 * (size_t)t[3 * i + 1], x, b);
        subtract(xyz + 3 * (size_t)t[3 * i + 2], x, c);
        la = sqrt(dot(a, a));
        lb = sqrt(dot(b, b));
        lc = sqrt(dot(c, c));
        sum += 2 * atan2(determinant(a, b, c), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return sum / (4 * M_PI);
}
