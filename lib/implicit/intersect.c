/* SPDX-License-Identifier: MIT */
#include "implicit/intersect.h"

#include <math.h>

#include "implicit/implicit.h"
#include "numeric/predicate.h"

void sph__intersector_free(sph__intersector *x)
{
    sph__box_tree_free(&x->tree);
    sph__free(x->context, x->boxes);
    for (uint32_t b = 0; x->lists != NULL && b < x->block_count; ++b)
        sph__free(x->context, x->lists[b].items);
    sph__free(x->context, x->lists);
}

void sph__intersector_box(sph__intersector *x, size_t begin, size_t end)
{
    for (size_t t = begin; t < end; ++t)
        x->boxes[t] = sph__box_of_triangle(x->positions, x->triangles + 3 * t);
}

void sph__intersector_refit(sph__intersector *x)
{
    sph__box_tree_refit(&x->tree, x->boxes);
}

sph_status sph__intersector_init(sph__intersector *x, const sph_context *context, const uint32_t *triangles,
                                 size_t triangle_count, const float *positions)
{
    sph_status status;
    *x = (sph__intersector){
        .context = context, .triangles = triangles, .triangle_count = triangle_count, .positions = positions};
    x->tree.context = context;
    if (triangle_count >= 1u << 30)
        return sph__fail(context, SPH_E_LIMIT, "%zu triangles are too many", triangle_count);
    x->boxes = sph__alloc(context, triangle_count, sizeof *x->boxes);
    if (x->boxes == NULL) return sph__fail_memory(context);
    status = sph__box_tree_reserve(&x->tree, context, (uint32_t)triangle_count, SPH__INTERSECT_LEAF);
    if (status != SPH_OK) return status;
    sph__intersector_box(x, 0, triangle_count);
    sph__box_tree_build(&x->tree, x->boxes, (uint32_t)triangle_count, SPH__INTERSECT_LEAF);
    x->block_count = ((1u << x->tree.depth) + SPH__INTERSECT_GRAIN - 1) / SPH__INTERSECT_GRAIN;
    x->lists = sph__zalloc(context, x->block_count, sizeof *x->lists);
    return x->lists == NULL ? sph__fail_memory(context) : SPH_OK;
}

static bool overlap(const sph__box *a, const sph__box *b)
{
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] && b->low[1] <= a->high[1] &&
           a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

static bool meet(const sph__intersector *x, uint32_t t, uint32_t u)
{
    const float *p[3], *q[3];
    for (int i = 0; i < 3; ++i) {
        p[i] = x->positions + 3 * (size_t)x->triangles[3 * (size_t)t + i];
        q[i] = x->positions + 3 * (size_t)x->triangles[3 * (size_t)u + i];
    }
    return sph__triangles_meet(p, q);
}

static void add_pair(const sph__intersector *x, sph__pairs *list, uint32_t t, uint32_t u)
{
    void *items = list->items;
    if (list->out_of_memory) return;
    if (!sph__reserve(x->context, &items, &list->capacity, list->count + 1, sizeof *list->items)) {
        list->out_of_memory = true;
        return;
    }
    list->items = items;
    list->items[list->count++] = t < u ? (uint64_t)t << 32 | u : (uint64_t)u << 32 | t;
}

/* One triangle against those of a leaf: pairs of two marked ones are found from the lower. */
static void test_leaf(const sph__intersector *x, uint32_t t, uint32_t begin, uint32_t end, sph__pairs *list)
{
    for (uint32_t i = begin; i < end; ++i) {
        const uint32_t u = x->tree.order[i];
        if (u == t || (u < t && (x->marks == NULL || x->marks[u])) || !overlap(x->boxes + t, x->boxes + u)) continue;
        if (meet(x, t, u)) add_pair(x, list, t, u);
    }
}

static void search_triangle(const sph__intersector *x, uint32_t t, sph__pairs *list)
{
    sph__box_visit stack[SPH__BOX_STACK];
    int count = 1;
    stack[0] = (sph__box_visit){1, 0, x->tree.item_count, 0};
    while (count > 0) {
        const sph__box_visit v = stack[--count];
        const uint32_t middle = sph__box_visit_middle(&v);
        if (v.begin == v.end || !overlap(x->boxes + t, x->tree.nodes + v.node)) continue;
        if (sph__box_tree_is_leaf(&x->tree, v.node)) {
            test_leaf(x, t, v.begin, v.end, list);
            continue;
        }
        stack[count++] = (sph__box_visit){2 * v.node, v.begin, middle, 0};
        stack[count++] = (sph__box_visit){2 * v.node + 1, middle, v.end, 0};
    }
}

void sph__intersector_search(sph__intersector *x, size_t begin, size_t end)
{
    const size_t count = x->tree.item_count, per = (count + x->block_count - 1) / x->block_count;
    for (size_t b = begin; b < end; ++b) {
        sph__pairs *list = x->lists + b;
        list->count = 0;
        list->out_of_memory = false;
        for (size_t i = b * per; i < (b + 1) * per && i < count; ++i) {
            const uint32_t t = x->tree.order[i];
            if (x->marks == NULL || x->marks[t]) search_triangle(x, t, list);
        }
    }
}

static void search_blocks(void *argument, size_t begin, size_t end)
{
    sph__intersector_search(argument, begin, end);
}

static sph_status check_mesh(const sph_context *context, uint32_t n, const float *positions, size_t triangle_count,
                             const uint32_t *triangles)
{
    for (size_t i = 0; i < 3 * (size_t)n; ++i)
        if (!isfinite(positions[i])) return sph__fail(context, SPH_E_INVALID, "vertex %zu is not finite", i / 3);
    for (size_t i = 0; i < 3 * triangle_count; ++i)
        if (triangles[i] >= n)
            return sph__fail(context, SPH_E_INVALID, "triangle %zu names vertex %u, of %u", i / 3,
                             (unsigned)triangles[i], (unsigned)n);
    return SPH_OK;
}

sph_status sph_mesh_intersections(sph_context *context, uint32_t vertex_count, const float *positions,
                                  size_t triangle_count, const uint32_t *triangles, uint64_t *pairs)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph__intersector x;
    uint64_t count = 0;
    sph_status status;
    size_t bytes;
    if (context == NULL || pairs == NULL || (vertex_count != 0 && positions == NULL) ||
        (triangle_count != 0 && triangles == NULL))
        return sph__fail(context, SPH_E_INVALID, "sph_mesh_intersections: an argument is NULL");
    if (!sph__multiply_size(triangle_count, 3 * sizeof *triangles, &bytes) || triangle_count >= 1u << 30)
        return sph__fail(context, SPH_E_INVALID, "%zu triangles are too many", triangle_count);
    status = check_mesh(context, vertex_count, positions, triangle_count, triangles);
    if (status != SPH_OK) return status;
    if (triangle_count == 0) {
        *pairs = 0;
        return SPH_OK;
    }
    status = sph__intersector_init(&x, context, triangles, triangle_count, positions);
    if (status == SPH_OK) sph__parallel_for(context, x.block_count, 1, search_blocks, &x);
    for (uint32_t b = 0; status == SPH_OK && b < x.block_count; ++b) {
        if (x.lists[b].out_of_memory) status = sph__fail_memory(context);
        count += x.lists[b].count;
    }
    sph__intersector_free(&x);
    if (status == SPH_OK) *pairs = count;
    return status;
}
