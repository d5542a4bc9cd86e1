/* SPDX-License-Identifier: MIT */
/* All by counting, not by comparing or hashing: linear in vertices, triangles and edges whatever the input. */
#include "animation/topology.h"

static const char STAGE[] = "checking topology";

static void count_repeated(const sph_animation *a, sph_animation_report *report)
{
    for (size_t t = 0; t < a->triangle_count; ++t)
        if (sph__names_vertex_twice(a->triangles + 3 * t, 3) && report->repeated_index_count++ == 0)
            report->first_repeated_index = t;
    for (size_t e = 0; e < a->edge_count; ++e)
        if (sph__names_vertex_twice(a->edges + 2 * e, 2) && report->repeated_index_count++ == 0)
            report->first_repeated_index = a->triangle_count + e;
}

/* --- components --- */

static uint32_t find_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

/* The lower root stays, so that a component is named by its lowest vertex. */
static void join(uint32_t *parent, uint32_t i, uint32_t k)
{
    i = find_root(parent, i);
    k = find_root(parent, k);
    if (i < k)
        parent[k] = i;
    else
        parent[i] = k;
}

static void join_triangles(const sph_animation *a, uint32_t *parent, uint8_t *used)
{
    for (uint32_t i = 0; i < a->vertex_count; ++i)
        parent[i] = i;
    for (size_t t = 0; t < a->triangle_count; ++t) {
        const uint32_t *v = a->triangles + 3 * t;
        if (sph__names_vertex_twice(v, 3)) continue;
        join(parent, v[0], v[1]);
        join(parent, v[0], v[2]);
        used[v[0]] = used[v[1]] = used[v[2]] = 1;
    }
}

/* The wires, some of them perhaps edges of triangles too: additional edges, and triangles that name two vertices only.
 */
static bool wire_at(const sph_animation *a, size_t i, const uint32_t **from, const uint32_t **to)
{
    const uint32_t *v = i < a->edge_count ? a->edges + 2 * i : a->triangles + 3 * (i - a->edge_count);
    if (i >= a->edge_count && !sph__names_vertex_twice(v, 3)) return false;
    *from = v;
    *to = i >= a->edge_count && v[0] == v[1] ? v + 2 : v + 1;
    return **from != **to;
}

static void join_wires(const sph_animation *a, uint32_t *parent, uint8_t *used)
{
    const uint32_t *from, *to;
    for (size_t i = 0; i < a->edge_count + a->triangle_count; ++i)
        if (wire_at(a, i, &from, &to)) {
            join(parent, *from, *to);
            used[*from] = used[*to] = 1;
        }
}

static sph_status count_components(const sph_animation *a, sph_animation_report *report, sph__patches *patches)
{
    const uint32_t n = a->vertex_count;
    uint32_t *parent = sph__alloc(a->context, n, sizeof *parent);
    uint8_t *used = sph__zalloc(a->context, n, 1);
    sph_status status = SPH_OK;
    patches->of = sph__alloc(a->context, n, sizeof *patches->of);
    patches->closed = sph__zalloc(a->context, n, 1);
    if (parent != NULL && used != NULL && patches->of != NULL && patches->closed != NULL) {
        join_triangles(a, parent, used);
        for (uint32_t i = 0; i < n; ++i) {
            patches->of[i] = find_root(parent, i);
            patches->closed[patches->of[i]] = used[i]; /* open edges are found later */
        }
        join_wires(a, parent, used);
        for (uint32_t i = 0; i < n; ++i) {
            if (parent[i] == i) ++report->component_count;
            if (used[i] == 0) ++report->isolated_vertex_count;
        }
    } else {
        status = sph__fail_memory(a->context);
    }
    sph__free(a->context, parent);
    sph__free(a->context, used);
    return status;
}

/* --- edges --- */

/* For each vertex the edges to higher ones, one entry for each triangle, or each wire, that has it. */
typedef struct rows {
    size_t *start;  /* entries of vertex v: [start[v], start[v + 1]) */
    uint32_t *ends; /* twice the higher vertex, plus 1 where the edge runs downwards */
} rows;

/* Counts an edge (`fill` false), or puts it in its place. */
static void visit_edge(rows *r, uint32_t from, uint32_t to, bool fill)
{
    const uint32_t low = from < to ? from : to;
    if (fill)
        r->ends[r->start[low + 1]++] = (low == from ? to : from) << 1 | (from > to);
    else
        ++r->start[low + 2];
}

static void visit_triangles(const sph_animation *a, rows *r, bool fill)
{
    for (size_t t = 0; t < a->triangle_count; ++t) {
        const uint32_t *v = a->triangles + 3 * t;
        if (sph__names_vertex_twice(v, 3)) continue;
        for (size_t k = 0; k < 3; ++k)
            visit_edge(r, v[k], v[(k + 1) % 3], fill);
    }
}

static void visit_wires(const sph_animation *a, rows *r, bool fill)
{
    const uint32_t *from, *to;
    for (size_t i = 0; i < a->edge_count + a->triangle_count; ++i)
        if (wire_at(a, i, &from, &to)) visit_edge(r, *from, *to, fill);
}

static bool build_rows(const sph_animation *a, void (*visit)(const sph_animation *, rows *, bool), rows *r)
{
    const size_t n = a->vertex_count;
    r->ends = NULL;
    r->start = sph__zalloc(a->context, n + 2, sizeof *r->start);
    if (r->start == NULL) return false;
    visit(a, r, false);
    for (size_t i = 1; i < n + 2; ++i)
        r->start[i] += r->start[i - 1];
    r->ends = sph__alloc(a->context, r->start[n + 1], sizeof *r->ends);
    if (r->ends == NULL) return false;
    visit(a, r, true); /* moves start[v + 1] from the row's begin to its end */
    return true;
}

static void free_rows(const sph_context *context, rows *r)
{
    sph__free(context, r->start);
    sph__free(context, r->ends);
}

/* The edges from `low` to higher vertices. uses[2 v + d]: triangles with the edge to v in direction d; all 0 before and
 * after. */
static void count_row(const rows *triangles, const rows *wires, uint32_t low, uint32_t *uses,
                      sph_animation_report *report, sph__patches *patches)
{
    for (size_t i = triangles->start[low]; i < triangles->start[low + 1]; ++i)
        ++uses[triangles->ends[i]];
    for (size_t i = wires->start[low]; i < wires->start[low + 1]; ++i) {
        uint32_t *use = uses + (wires->ends[i] & ~UINT32_C(1));
        if (use[0] + use[1] > 0) continue;
        ++report->wire_edge_count;
        use[0] = 1; /* the same edge again is not counted */
    }
    for (size_t i = triangles->start[low]; i < triangles->start[low + 1]; ++i) {
        uint32_t *use = uses + (triangles->ends[i] & ~UINT32_C(1));
        const uint32_t both = use[0] + use[1];
        if (both == 0) continue; /* seen */
        if (both == 1) ++report->boundary_edge_count;
        if (both == 2 && use[0] != use[1]) ++report->inconsistent_edge_count;
        if (both > 2) ++report->non_manifold_edge_count;
        if (use[0] != use[1]) patches->closed[patches->of[low]] = 0;
        use[0] = use[1] = 0;
    }
    for (size_t i = wires->start[low]; i < wires->start[low + 1]; ++i)
        uses[wires->ends[i] & ~UINT32_C(1)] = 0;
}

static sph_status count_edges(const sph_animation *a, sph_animation_report *report, sph__patches *patches)
{
    rows triangles = {NULL, NULL}, wires = {NULL, NULL};
    uint32_t *uses = sph__zalloc(a->context, a->vertex_count, 2 * sizeof *uses);
    const bool built = uses != NULL && build_rows(a, visit_triangles, &triangles) && build_rows(a, visit_wires, &wires);
    if (built)
        for (uint32_t low = 0; low < a->vertex_count; ++low)
            count_row(&triangles, &wires, low, uses, report, patches);
    sph__free(a->context, uses);
    free_rows(a->context, &triangles);
    free_rows(a->context, &wires);
    return built ? SPH_OK : sph__fail_memory(a->context);
}

/* --- duplicates --- */

/* The lowest (0), middle (1) or highest (2) vertex of a triangle. */
static uint32_t ranked(const uint32_t *v, uint32_t rank)
{
    const uint32_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
    if (rank == 0) return v[2] < low ? v[2] : low;
    if (rank == 2) return v[2] > high ? v[2] : high;
    return v[2] < low ? low : v[2] > high ? high : v[2];
}

/* A stable counting sort of triangles by the vertex of one rank. `start` has n + 1 entries. */
static void sort_by_rank(const sph_animation *a, uint32_t rank, const uint32_t *from, uint32_t *to, size_t count,
                         uint32_t *start)
{
    memset(start, 0, ((size_t)a->vertex_count + 1) * sizeof *start);
    for (size_t i = 0; i < count; ++i)
        ++start[ranked(a->triangles + 3 * (size_t)from[i], rank) + 1];
    for (size_t i = 1; i < a->vertex_count; ++i)
        start[i] += start[i - 1];
    for (size_t i = 0; i < count; ++i)
        to[start[ranked(a->triangles + 3 * (size_t)from[i], rank)]++] = from[i];
}

static bool same_vertices(const sph_animation *a, uint32_t t, uint32_t other)
{
    const uint32_t *v = a->triangles + 3 * (size_t)t, *w = a->triangles + 3 * (size_t)other;
    return ranked(v, 0) == ranked(w, 0) && ranked(v, 1) == ranked(w, 1) && ranked(v, 2) == ranked(w, 2);
}

static sph_status count_duplicates(const sph_animation *a, sph_animation_report *report)
{
    uint32_t *order = sph__alloc(a->context, a->triangle_count, sizeof *order);
    uint32_t *other = sph__alloc(a->context, a->triangle_count, sizeof *other);
    uint32_t *start = sph__alloc(a->context, (size_t)a->vertex_count + 1, sizeof *start);
    const bool enough = order != NULL && other != NULL && start != NULL;
    size_t count = 0;
    if (enough) {
        for (size_t t = 0; t < a->triangle_count; ++t)
            if (!sph__names_vertex_twice(a->triangles + 3 * t, 3)) order[count++] = (uint32_t)t;
        sort_by_rank(a, 2, order, other, count, start);
        sort_by_rank(a, 1, other, order, count, start);
        sort_by_rank(a, 0, order, other, count, start);
        for (size_t i = 1; i < count; ++i)
            if (same_vertices(a, other[i - 1], other[i])) ++report->duplicate_triangle_count;
    }
    sph__free(a->context, order);
    sph__free(a->context, other);
    sph__free(a->context, start);
    return enough ? SPH_OK : sph__fail_memory(a->context);
}

sph_status sph__topology_count(const sph_animation *animation, sph_animation_report *report, sph__patches *patches,
                               sph__progress *progress)
{
    sph_status status = sph__progress_report(progress, STAGE, 0);
    *patches = (sph__patches){NULL, NULL};
    count_repeated(animation, report);
    if (status == SPH_OK) status = count_components(animation, report, patches);
    if (status == SPH_OK) status = sph__progress_report(progress, STAGE, 0.3);
    if (status == SPH_OK) status = count_edges(animation, report, patches);
    if (status == SPH_OK) status = sph__progress_report(progress, STAGE, 0.7);
    if (status == SPH_OK) status = count_duplicates(animation, report);
    return status;
}

void sph__patches_free(const sph_context *context, sph__patches *patches)
{
    sph__free(context, patches->of);
    sph__free(context, patches->closed);
    *patches = (sph__patches){NULL, NULL};
}
