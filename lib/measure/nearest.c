/* SPDX-License-Identifier: MIT */
#include <float.h>

#include "measure/measure.h"

/* Keeps `found` sorted; the last one drops out when it is full. */
static uint32_t insert(sph__neighbour *found, uint32_t count, uint32_t capacity, sph__neighbour n)
{
    uint32_t i = count < capacity ? count : capacity - 1;
    for (; i > 0 && (found[i - 1].distance2 > n.distance2 ||
                     (found[i - 1].distance2 == n.distance2 && found[i - 1].point > n.point));
         --i)
        found[i] = found[i - 1];
    found[i] = n;
    return count < capacity ? count + 1 : capacity;
}

uint32_t sph__outer_nearest(const sph__outer *outer, const sph__box_tree *tree, const double x[3], double radius,
                            uint32_t capacity, sph__neighbour *found)
{
    double limit = radius < 1e150 ? radius * radius : DBL_MAX;
    sph__box_visit stack[SPH__BOX_STACK];
    uint32_t count = 0;
    int top = 0;
    if (tree->item_count == 0) return 0;
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, 0};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        if (v.bound > limit) continue;
        if (!sph__box_tree_is_leaf(tree, v.node)) {
            const uint32_t half = sph__box_visit_middle(&v), left = 2 * v.node;
            const sph__box_visit a = {left, v.begin, half, sph__box_distance2(&tree->nodes[left], x)};
            const sph__box_visit b = {left + 1, half, v.end, sph__box_distance2(&tree->nodes[left + 1], x)};
            const bool a_first = a.bound <= b.bound;
            stack[top++] = a_first ? b : a;
            stack[top++] = a_first ? a : b;
            continue;
        }
        for (uint32_t i = v.begin; i < v.end; ++i) {
            const uint32_t point = tree->order[i];
            const double *p = outer->points[point].position;
            const double dx = p[0] - x[0], dy = p[1] - x[1], dz = p[2] - x[2];
            const sph__neighbour n = {point, dx * dx + dy * dy + dz * dz};
            if (n.distance2 > limit) continue;
            count = insert(found, count, capacity, n);
            if (count == capacity) limit = found[count - 1].distance2;
        }
    }
    return count;
}
