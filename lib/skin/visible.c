/* SPDX-License-Identifier: MIT */
#include "skin/visible.h"

#include <math.h>

#include "numeric/vector.h"

enum { LEAF = 4 };

static void corner(const sph__occluder *o, uint32_t vertex, double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = (double)o->xyz[3 * (size_t)vertex + k];
}

sph_status sph__occluder_init(sph__occluder *o, const sph_context *context, const float *xyz, const uint32_t *triangles,
                              size_t triangle_count)
{
    const uint32_t count = triangle_count < (1u << 30) ? (uint32_t)triangle_count : 0;
    sph__box *boxes;
    sph_status status;
    *o = (sph__occluder){.xyz = xyz, .triangles = triangles};
    if (count != triangle_count)
        return sph__fail(context, SPH_E_LIMIT, "%zu triangles are more than visibility can be told for", triangle_count);
    if (count == 0) return SPH_OK;
    status = sph__box_tree_reserve(&o->tree, context, count, LEAF);
    if (status != SPH_OK) return status;
    boxes = sph__alloc(context, count, sizeof *boxes);
    if (boxes == NULL) return sph__fail_memory(context);
    for (uint32_t t = 0; t < count; ++t) {
        double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, x[3];
        for (int c = 0; c < 3; ++c) {
            corner(o, triangles[3 * (size_t)t + c], x);
            for (int k = 0; k < 3; ++k) {
                low[k] = fmin(low[k], x[k]);
                high[k] = fmax(high[k], x[k]);
            }
        }
        sph__box_set(&boxes[t], low, high);
    }
    sph__box_tree_build(&o->tree, boxes, count, LEAF);
    sph__free(context, boxes);
    return SPH_OK;
}

void sph__occluder_free(sph__occluder *o)
{
    sph__box_tree_free(&o->tree);
}

static bool meets_box(const sph__box *box, const double from[3], const double way[3])
{
    double enter = 0, leave = 1;
    for (int k = 0; k < 3; ++k) {
        const double low = (double)box->low[k] - from[k], high = (double)box->high[k] - from[k];
        if (way[k] == 0) {
            if (low > 0 || high < 0) return false;
            continue;
        }
        enter = fmax(enter, fmin(low / way[k], high / way[k]));
        leave = fmin(leave, fmax(low / way[k], high / way[k]));
    }
    return enter <= leave * (1 + 1e-12);
}

/* Whether the segment crosses a triangle that `vertex` is no corner of. */
static bool crosses(const sph__occluder *o, uint32_t triangle, uint32_t vertex, const double from[3],
                    const double way[3])
{
    const uint32_t *c = o->triangles + 3 * (size_t)triangle;
    double a[3], b[3], e[3], u[3], v[3], p[3], q[3], s[3], det, x, y, t;
    if (c[0] == vertex || c[1] == vertex || c[2] == vertex) return false;
    corner(o, c[0], a);
    corner(o, c[1], b);
    corner(o, c[2], e);
    sph__subtract(b, a, u);
    sph__subtract(e, a, v);
    sph__cross(way, v, p);
    det = sph__dot(u, p);
    if (det == 0) return false;
    sph__subtract(from, a, s);
    x = sph__dot(s, p) / det;
    if (!(x >= 0 && x <= 1)) return false;
    sph__cross(s, u, q);
    y = sph__dot(way, q) / det;
    t = sph__dot(v, q) / det;
    return y >= 0 && x + y <= 1 && t > 1e-9 && t < 1;
}

bool sph__occluder_sees(const sph__occluder *o, uint32_t vertex, const double point[3])
{
    sph__box_visit stack[SPH__BOX_STACK];
    double from[3], way[3];
    int top = 0;
    if (o->tree.item_count == 0) return true;
    corner(o, vertex, from);
    sph__subtract(point, from, way);
    stack[top++] = (sph__box_visit){1, 0, o->tree.item_count, 0};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        if (!meets_box(&o->tree.nodes[v.node], from, way)) continue;
        if (!sph__box_tree_is_leaf(&o->tree, v.node)) {
            const uint32_t half = sph__box_visit_middle(&v);
            stack[top++] = (sph__box_visit){2 * v.node, v.begin, half, 0};
            stack[top++] = (sph__box_visit){2 * v.node + 1, half, v.end, 0};
            continue;
        }
        for (uint32_t i = v.begin; i < v.end; ++i)
            if (crosses(o, o->tree.order[i], vertex, from, way)) return false;
    }
    return true;
}
