/* SPDX-License-Identifier: MIT */
#include "level/box_tree.h"

#include <float.h>
#include <math.h>

void sph__box_set(sph__box *box, const double low[3], const double high[3])
{
    for (int k = 0; k < 3; ++k) {
        box->low[k] = nextafterf((float)low[k], -FLT_MAX);
        box->high[k] = nextafterf((float)high[k], FLT_MAX);
    }
}

static uint32_t tree_depth(uint32_t item_count, uint32_t leaf_size)
{
    uint32_t depth = 0;
    while ((((uint64_t)leaf_size) << depth) < item_count)
        ++depth;
    return depth;
}

sph_status sph__box_tree_reserve(sph__box_tree *tree, const sph_context *context, uint32_t capacity, uint32_t leaf_size)
{
    const size_t nodes = (size_t)2 << tree_depth(capacity, leaf_size);
    tree->context = context;
    if (capacity > tree->capacity || tree->order == NULL) {
        uint32_t *order = sph__alloc(context, capacity, sizeof *order);
        if (order == NULL) return SPH_E_NOMEM;
        sph__free(context, tree->order);
        tree->order = order;
        tree->capacity = capacity;
    }
    if (nodes > tree->node_capacity) {
        sph__box *boxes = sph__alloc(context, nodes, sizeof *boxes);
        if (boxes == NULL) return SPH_E_NOMEM;
        sph__free(context, tree->nodes);
        tree->nodes = boxes;
        tree->node_capacity = nodes;
    }
    return SPH_OK;
}

void sph__box_tree_free(sph__box_tree *tree)
{
    if (tree->context == NULL) return;
    sph__free(tree->context, tree->order);
    sph__free(tree->context, tree->nodes);
    memset(tree, 0, sizeof *tree);
}

static float middle(const sph__box *box, int axis)
{
    return 0.5f * box->low[axis] + 0.5f * box->high[axis];
}

static bool is_before(const sph__box *boxes, int axis, uint32_t a, uint32_t b)
{
    const float x = middle(&boxes[a], axis), y = middle(&boxes[b], axis);
    return x != y ? x < y : a < b;
}

static uint32_t median3(const sph__box *boxes, int axis, uint32_t a, uint32_t b, uint32_t c)
{
    if (is_before(boxes, axis, b, a)) {
        const uint32_t t = a;
        a = b;
        b = t;
    }
    if (is_before(boxes, axis, c, b)) return is_before(boxes, axis, c, a) ? a : c;
    return b;
}

/* Quickselect: afterwards everything before `nth` comes before it. The order is total, so the outcome is unique. */
static void select_nth(const sph__box *boxes, int axis, uint32_t *order, uint32_t begin, uint32_t end, uint32_t nth)
{
    while (end - begin > 1) {
        const uint32_t pivot = median3(boxes, axis, order[begin], order[begin + (end - begin) / 2], order[end - 1]);
        uint32_t i = begin, j = end - 1;
        for (;;) {
            while (is_before(boxes, axis, order[i], pivot))
                ++i;
            while (is_before(boxes, axis, pivot, order[j]))
                --j;
            if (i >= j) break;
            const uint32_t t = order[i];
            order[i++] = order[j];
            order[j--] = t;
        }
        /* [begin, i) is not after the pivot, [j + 1, end) not before it */
        if (nth < i)
            end = i;
        else if (nth > j)
            begin = j + 1;
        else
            return;
    }
}

static int longest_axis(const sph__box *boxes, const uint32_t *order, uint32_t begin, uint32_t end)
{
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (uint32_t i = begin; i < end; ++i)
        for (int k = 0; k < 3; ++k) {
            const float x = middle(&boxes[order[i]], k);
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
    int best = 0;
    for (int k = 1; k < 3; ++k)
        if (high[k] * 0.5f - low[k] * 0.5f > high[best] * 0.5f - low[best] * 0.5f) best = k;
    return best;
}

void sph__box_tree_build(sph__box_tree *tree, const sph__box *boxes, uint32_t item_count, uint32_t leaf_size)
{
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    tree->item_count = item_count;
    tree->depth = tree_depth(item_count, leaf_size);
    for (uint32_t i = 0; i < item_count; ++i)
        tree->order[i] = i;
    stack[top++] = (sph__box_visit){1, 0, item_count, 0};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        const uint32_t half = sph__box_visit_middle(&v);
        if (sph__box_tree_is_leaf(tree, v.node)) continue;
        if (v.end - v.begin > 1)
            select_nth(boxes, longest_axis(boxes, tree->order, v.begin, v.end), tree->order, v.begin, v.end, half);
        stack[top++] = (sph__box_visit){2 * v.node, v.begin, half, 0};
        stack[top++] = (sph__box_visit){2 * v.node + 1, half, v.end, 0};
    }
    sph__box_tree_refit(tree, boxes);
}

void sph__box_tree_refit(sph__box_tree *tree, const sph__box *boxes)
{
    const uint32_t first_leaf = (uint32_t)1 << tree->depth;
    sph__box_visit stack[SPH__BOX_STACK];
    int top = 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, 0};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        const uint32_t half = sph__box_visit_middle(&v);
        tree->nodes[v.node] = sph__box_empty();
        if (!sph__box_tree_is_leaf(tree, v.node)) {
            stack[top++] = (sph__box_visit){2 * v.node, v.begin, half, 0};
            stack[top++] = (sph__box_visit){2 * v.node + 1, half, v.end, 0};
            continue;
        }
        for (uint32_t i = v.begin; i < v.end; ++i)
            sph__box_grow(&tree->nodes[v.node], &boxes[tree->order[i]]);
    }
    for (uint32_t node = first_leaf - 1; node >= 1; --node) {
        sph__box_grow(&tree->nodes[node], &tree->nodes[2 * node]);
        sph__box_grow(&tree->nodes[node], &tree->nodes[2 * node + 1]);
    }
}
