/* SPDX-License-Identifier: MIT */
#include "measure/mesh.h"

#include <float.h>

#include "numeric/vector.h"

enum { LEAF_SIZE = 4 };

/* Steps of the golden ratio are spread evenly over [0, 1) however many there are. */
static const double GOLDEN = 0.61803398874989484820;

sph_status sph__mesh_init(sph__mesh *mesh, const sph_context *context, uint32_t vertex_count, const uint32_t *triangles,
                          size_t triangle_count)
{
    memset(mesh, 0, sizeof *mesh);
    mesh->context = context;
    if (triangle_count > (1u << 29)) return sph__fail(context, SPH_E_LIMIT, "more than 2^29 triangles");
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = (uint32_t)triangle_count;
    mesh->triangles = triangles;
    mesh->xyz = sph__alloc(context, vertex_count, 3 * sizeof *mesh->xyz);
    mesh->boxes = sph__alloc(context, triangle_count, sizeof *mesh->boxes);
    mesh->cumulative = sph__alloc(context, triangle_count, sizeof *mesh->cumulative);
    if (mesh->xyz == NULL || mesh->boxes == NULL || mesh->cumulative == NULL ||
        sph__box_tree_reserve(&mesh->tree, context, mesh->triangle_count, LEAF_SIZE) != SPH_OK)
        return sph__fail_memory(context);
    return SPH_OK;
}

void sph__mesh_free(sph__mesh *mesh)
{
    if (mesh->context == NULL) return;
    sph__free(mesh->context, mesh->xyz);
    sph__free(mesh->context, mesh->boxes);
    sph__free(mesh->context, mesh->cumulative);
    sph__box_tree_free(&mesh->tree);
    memset(mesh, 0, sizeof *mesh);
}

static void read_corners(const sph__mesh *mesh, uint32_t triangle, double corners[3][3])
{
    for (size_t i = 0; i < 3; ++i) {
        const float *v = &mesh->xyz[3 * (size_t)mesh->triangles[3 * (size_t)triangle + i]];
        for (int k = 0; k < 3; ++k)
            corners[i][k] = v[k];
    }
}

static double triangle_area(const double c[3][3])
{
    double u[3], v[3], n[3];
    sph__subtract(c[1], c[0], u);
    sph__subtract(c[2], c[0], v);
    sph__cross(u, v, n);
    return 0.5 * sph__norm(n);
}

/* Triangles of no area at all still have points: then each counts as much as another. */
static void measure_areas(sph__mesh *mesh)
{
    double sum = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; ++i) {
        double c[3][3];
        read_corners(mesh, i, c);
        sum += triangle_area((const double(*)[3])c);
        mesh->cumulative[i] = sum;
    }
    mesh->area = sum;
    for (uint32_t i = 0; sum <= 0 && i < mesh->triangle_count; ++i)
        mesh->cumulative[i] = i + 1.0;
}

static void set_boxes(sph__mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->triangle_count; ++i)
        mesh->boxes[i] = sph__box_of_triangle(mesh->xyz, &mesh->triangles[3 * (size_t)i]);
}

void sph__mesh_build(sph__mesh *mesh)
{
    set_boxes(mesh);
    sph__box_tree_build(&mesh->tree, mesh->boxes, mesh->triangle_count, LEAF_SIZE);
}

void sph__mesh_copy_order(sph__mesh *mesh, const sph__mesh *from)
{
    mesh->tree.item_count = from->tree.item_count;
    mesh->tree.depth = from->tree.depth;
    memcpy(mesh->tree.order, from->tree.order, mesh->triangle_count * sizeof *mesh->tree.order);
}

void sph__mesh_refit(sph__mesh *mesh)
{
    set_boxes(mesh);
    sph__box_tree_refit(&mesh->tree, mesh->boxes);
    measure_areas(mesh);
}

double sph__mesh_diagonal(const sph__mesh *mesh, double low[3], double high[3])
{
    for (size_t k = 0; k < 3; ++k) {
        low[k] = high[k] = mesh->xyz[k];
        for (uint32_t i = 1; i < mesh->vertex_count; ++i) {
            low[k] = fmin(low[k], mesh->xyz[3 * (size_t)i + k]);
            high[k] = fmax(high[k], mesh->xyz[3 * (size_t)i + k]);
        }
    }
    return sph__distance(low, high);
}

void sph__mesh_sample(const sph__mesh *mesh, uint32_t index, uint32_t count, const double shift[2], uint32_t *cursor,
                      sph__mesh_point *point)
{
    const double total = mesh->cumulative[mesh->triangle_count - 1];
    const double target = (index + shift[0]) / count * total;
    double c[3][3], before, share, root, other;
    while (*cursor + 1 < mesh->triangle_count && mesh->cumulative[*cursor] <= target)
        ++*cursor;
    before = *cursor == 0 ? 0 : mesh->cumulative[*cursor - 1];
    share = (target - before) / (mesh->cumulative[*cursor] - before);
    if (!(share >= 0 && share <= 1)) share = 1;
    root = sqrt(share);
    other = shift[1] + index * GOLDEN;
    other -= floor(other);
    read_corners(mesh, *cursor, c);
    for (int k = 0; k < 3; ++k)
        point->position[k] = (1 - root) * c[0][k] + root * ((1 - other) * c[1][k] + other * c[2][k]);
    point->triangle = *cursor;
}

static double segment_distance2(const double x[3], const double a[3], const double b[3])
{
    double d[3], v[3], s, length2;
    sph__subtract(b, a, d);
    sph__subtract(x, a, v);
    length2 = sph__dot(d, d);
    s = length2 > 0 ? sph__dot(v, d) / length2 : 0;
    s = s < 0 ? 0 : s > 1 ? 1 : s;
    sph__add_scaled(v, -s, d, v);
    return sph__dot(v, v);
}

/* By the sides' planes: within all three the foot is in the triangle, else it is on a side. */
static double triangle_distance2(const double x[3], const double c[3][3])
{
    double u[3], v[3], d[3], n[3], e[3], length2, height, b1, b2, best;
    sph__subtract(c[1], c[0], u);
    sph__subtract(c[2], c[0], v);
    sph__subtract(x, c[0], d);
    sph__cross(u, v, n);
    length2 = sph__dot(n, n);
    sph__cross(d, v, e);
    b1 = sph__dot(e, n);
    sph__cross(u, d, e);
    b2 = sph__dot(e, n);
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= length2 && length2 > 0) {
        height = sph__dot(d, n);
        return height * height / length2;
    }
    best = segment_distance2(x, c[0], c[1]);
    best = fmin(best, segment_distance2(x, c[1], c[2]));
    return fmin(best, segment_distance2(x, c[2], c[0]));
}

double sph__mesh_distance(const sph__mesh *mesh, const double x[3], uint32_t *guess)
{
    const sph__box_tree *tree = &mesh->tree;
    sph__box_visit stack[SPH__BOX_STACK];
    double c[3][3], best;
    int top = 0;
    read_corners(mesh, *guess, c);
    best = triangle_distance2(x, (const double(*)[3])c);
    stack[top++] = (sph__box_visit){1, 0, tree->item_count, 0};
    while (top > 0) {
        const sph__box_visit v = stack[--top];
        if (v.bound >= best) continue;
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
            double d2;
            if (sph__box_distance2(&mesh->boxes[tree->order[i]], x) >= best) continue;
            read_corners(mesh, tree->order[i], c);
            d2 = triangle_distance2(x, (const double(*)[3])c);
            if (d2 < best) {
                best = d2;
                *guess = tree->order[i];
            }
        }
    }
    return sqrt(best);
}

static uint64_t mix(uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

void sph__measure_shift(uint32_t seed, uint32_t frame, uint32_t surface, double shift[2])
{
    uint64_t state = mix(mix(mix(seed) ^ frame) ^ surface);
    for (int k = 0; k < 2; ++k) {
        state = mix(state);
        shift[k] = (double)(state >> 11) * 0x1p-53;
    }
}
