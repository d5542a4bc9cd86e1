/* SPDX-License-Identifier: MIT */
/* The simplices of a level, each once, and which of them make up the solid. */
#include "level/solid.h"

static int compare(const uint32_t *a, const uint32_t *b, size_t width)
{
    for (size_t k = 0; k < width; ++k)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static void swap(uint32_t *a, uint32_t *b, size_t width)
{
    for (size_t k = 0; k < width; ++k) {
        const uint32_t t = a[k];
        a[k] = b[k];
        b[k] = t;
    }
}

static void sift_down(uint32_t *rows, size_t root, size_t count, size_t width)
{
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && compare(&rows[child * width], &rows[(child + 1) * width], width) < 0) ++child;
        if (compare(&rows[root * width], &rows[child * width], width) >= 0) return;
        swap(&rows[root * width], &rows[child * width], width);
    }
}

/* Sorts rows of `width` numbers and drops repeated rows; returns how many are left. A heap: qsort() may allocate. */
static size_t sort_unique(uint32_t *rows, size_t count, size_t width)
{
    size_t kept = 0;
    for (size_t i = count / 2; i-- > 0;)
        sift_down(rows, i, count, width);
    for (size_t end = count; end-- > 1;) {
        swap(rows, &rows[end * width], width);
        sift_down(rows, 0, end, width);
    }
    for (size_t i = 0; i < count; ++i) {
        if (kept > 0 && compare(&rows[(kept - 1) * width], &rows[i * width], width) == 0) continue;
        memmove(&rows[kept++ * width], &rows[i * width], width * sizeof *rows);
    }
    return kept;
}

static bool is_among(const uint32_t *rows, size_t count, const uint32_t *row, size_t width)
{
    size_t begin = 0, end = count;
    while (begin < end) {
        const size_t half = begin + (end - begin) / 2;
        const int order = compare(&rows[half * width], row, width);
        if (order == 0) return true;
        if (order < 0)
            begin = half + 1;
        else
            end = half;
    }
    return false;
}

/* Edges of a triangle with corners in ascending order, in ascending order. */
static const int SIDES[3][2] = {{0, 1}, {0, 2}, {1, 2}};

/* Triangles with three distinct corners; of the others the edges remain, of such edges the spheres. */
static size_t collect_triangles(const sph_level *level, uint32_t (*triangles)[3])
{
    size_t count = 0;
    for (size_t i = 0; i < level->triangle_count; ++i) {
        uint32_t *t = triangles[count];
        memcpy(t, &level->triangles[3 * i], sizeof triangles[0]);
        if (t[0] > t[1]) swap(&t[0], &t[1], 1);
        if (t[1] > t[2]) swap(&t[1], &t[2], 1);
        if (t[0] > t[1]) swap(&t[0], &t[1], 1);
        if (t[0] != t[1] && t[1] != t[2]) ++count;
    }
    return sort_unique(triangles[0], count, 3);
}

static size_t collect_edges(const sph_level *level, uint32_t (*edges)[2])
{
    size_t count = 0;
    for (size_t i = 0; i < level->triangle_count; ++i)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = level->triangles[3 * i + k], b = level->triangles[3 * i + (k + 1) % 3];
            edges[count][0] = a < b ? a : b;
            edges[count][1] = a < b ? b : a;
            count += a != b;
        }
    for (size_t i = 0; i < level->edge_count; ++i) {
        const uint32_t a = level->edges[2 * i], b = level->edges[2 * i + 1];
        edges[count][0] = a < b ? a : b;
        edges[count][1] = a < b ? b : a;
        count += a != b;
    }
    return sort_unique(edges[0], count, 2);
}

/* The triangles, the edges of no triangle, the spheres of no edge. `used` has room for the edges of the triangles. */
static uint32_t collect_primitives(sph__solid *solid, uint32_t (*used)[2], uint8_t *has_edge)
{
    uint32_t count = 0;
    size_t used_count = 0;
    for (uint32_t i = 0; i < solid->triangle_count; ++i) {
        memcpy(solid->corners[count], solid->triangles[i], sizeof solid->triangles[i]);
        solid->corner_counts[count++] = 3;
        for (int k = 0; k < 3; ++k, ++used_count)
            for (int end = 0; end < 2; ++end)
                used[used_count][end] = solid->triangles[i][SIDES[k][end]];
    }
    used_count = sort_unique(used[0], used_count, 2);
    for (uint32_t i = 0; i < solid->edge_count; ++i) {
        has_edge[solid->edges[i][0]] = has_edge[solid->edges[i][1]] = 1;
        if (is_among(used[0], used_count, solid->edges[i], 2)) continue;
        memcpy(solid->corners[count], solid->edges[i], sizeof solid->edges[i]);
        solid->corner_counts[count++] = 2;
    }
    for (uint32_t i = 0; i < solid->sphere_count; ++i) {
        if (has_edge[i]) continue;
        solid->corners[count][0] = i;
        solid->corner_counts[count++] = 1;
    }
    return count;
}

static sph_status allocate(sph__solid *solid, const sph_level *level)
{
    const sph_context *context = solid->context;
    const size_t triangles = level->triangle_count, edges = 3 * triangles + level->edge_count;
    const size_t primitives = triangles + edges + level->sphere_count;
    if (triangles > (1u << 28) || level->edge_count > (1u << 28) || level->sphere_count > (1u << 28))
        return SPH_E_LIMIT;
    /* one more of each: the collectors write the one that they may drop */
    solid->triangles = sph__alloc(context, triangles + 1, sizeof *solid->triangles);
    solid->edges = sph__alloc(context, edges + 1, sizeof *solid->edges);
    solid->corners = sph__alloc(context, primitives, sizeof *solid->corners);
    solid->corner_counts = sph__alloc(context, primitives, sizeof *solid->corner_counts);
    solid->centers = sph__alloc(context, level->sphere_count, sizeof *solid->centers);
    solid->radii = sph__alloc(context, level->sphere_count, sizeof *solid->radii);
    if (solid->triangles == NULL || solid->edges == NULL || solid->corners == NULL || solid->corner_counts == NULL ||
        solid->centers == NULL || solid->radii == NULL)
        return SPH_E_NOMEM;
    return SPH_OK;
}

static sph_status collect(sph__solid *solid, const sph_level *level)
{
    const sph_context *context = solid->context;
    uint32_t(*used)[2];
    uint8_t *has_edge;
    solid->triangle_count = (uint32_t)collect_triangles(level, solid->triangles);
    solid->edge_count = (uint32_t)collect_edges(level, solid->edges);
    used = sph__alloc(context, 3 * (size_t)solid->triangle_count, sizeof *used);
    has_edge = sph__zalloc(context, solid->sphere_count, 1);
    if (used != NULL && has_edge != NULL) solid->primitive_count = collect_primitives(solid, used, has_edge);
    sph__free(context, used);
    sph__free(context, has_edge);
    return used != NULL && has_edge != NULL ? SPH_OK : SPH_E_NOMEM;
}

sph_status sph__solid_init(sph__solid *solid, const sph_level *level)
{
    const sph_context *context = level->context;
    sph_status status;
    memset(solid, 0, sizeof *solid);
    solid->context = context;
    solid->sphere_count = level->sphere_count;
    if ((status = allocate(solid, level)) == SPH_OK) status = collect(solid, level);
    if (status == SPH_E_LIMIT) return sph__fail(context, status, "a level of more than 2^28 spheres or simplices");
    if (status != SPH_OK) return sph__fail_memory(context);
    solid->primitives = sph__alloc(context, solid->primitive_count, sizeof *solid->primitives);
    solid->boxes = sph__alloc(context, solid->primitive_count, sizeof *solid->boxes);
    if (solid->primitives == NULL || solid->boxes == NULL ||
        sph__box_tree_reserve(&solid->tree, context, solid->primitive_count, SPH__SOLID_LEAF) != SPH_OK)
        return sph__fail_memory(context);
    return SPH_OK;
}
