/* SPDX-License-Identifier: MIT */
/*
 * Spheres in place of a solid: those interpolated at the points of a grid on each simplex. Around a point the solid is
 * made of pieces, half a step of the grid wide, whose corners are known; a sphere that reaches the farthest of them
 * contains its pieces, and by how much it is larger than the interpolated sphere bounds the gap between these and the
 * solid.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "io/affine.h"
#include "io/level_export.h"

enum { MOST_STEPS = 1024, MOST_TRIANGLE_STEPS = 256, MOST_BALLS = 1000000 };

typedef struct vertex {
    double c[3], r;
} vertex;

/* The spheres at these points of simplices: `weights` of `steps`, corners ascending. */
typedef struct cover {
    const sph__io_export *e;
    sph__io_balls *balls;
    double gap; /* largest so far */
    sph_status status;
} cover;

static vertex sphere_of(const sph__io_export *e, uint32_t index)
{
    const float *c = e->a.centers + 3 * (size_t)index;
    return (vertex){{c[0], c[1], c[2]}, e->a.radii[index]};
}

/* In this order, so that a point that two simplices share comes out the same. */
static vertex blend(const vertex *v, const uint32_t *weights, uint32_t corners, uint32_t steps)
{
    vertex m = {{0, 0, 0}, 0};
    for (uint32_t i = 0; i < corners; ++i) {
        if (weights[i] == 0) continue;
        for (int k = 0; k < 3; ++k)
            m.c[k] += weights[i] * v[i].c[k];
        m.r += weights[i] * v[i].r;
    }
    for (int k = 0; k < 3; ++k)
        m.c[k] /= steps;
    m.r /= steps;
    return m;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void between(const vertex *a, const vertex *b, double d[3])
{
    for (int k = 0; k < 3; ++k)
        d[k] = b->c[k] - a->c[k];
}

/* Distance from a point of a segment to the rim of the cone over the one `along` from it, whose radius there is `r`. */
static double rim(double along, double r, double sine)
{
    return sqrt(fmax(0, along * along + 2 * along * r * sine + r * r));
}

/* Radius that contains the pieces of the capsule from a to b half a step on either side of place i of `steps`. */
static double capsule_reach(const vertex *a, const vertex *b, uint32_t i, uint32_t steps)
{
    double d[3], length, sine, reach;
    between(a, b, d);
    length = sqrt(sph__io_dot(d, d));
    sine = length > 0 ? fmax(-1, fmin(1, (a->r - b->r) / length)) : 0;
    reach = a->r + (b->r - a->r) * i / steps;
    for (int side = -1; side <= 1; side += 2) {
        const double place = (i + 0.5 * side) / steps;
        if (place < 0 || place > 1) continue;
        reach = fmax(reach, rim(0.5 * side * length / steps, a->r + (b->r - a->r) * place, sine));
    }
    return reach;
}

/* A capsule of which one sphere is all. */
static bool is_one_sphere(const vertex *a, const vertex *b)
{
    double d[3];
    between(a, b, d);
    return sqrt(sph__io_dot(d, d)) <= fabs(a->r - b->r);
}

/* --- thick triangles --- */

/* The two unit normals of planes that touch all three spheres; false where there are none. */
static bool touching(const vertex *v, double normals[2][3])
{
    double a[3], b[3], n[3], t[3], area, rise;
    between(&v[0], &v[1], a);
    between(&v[0], &v[2], b);
    cross(a, b, n);
    area = sqrt(sph__io_dot(n, n));
    if (!(area > 1e-9 * sqrt(sph__io_dot(a, a) * sph__io_dot(b, b)))) return false;
    for (int k = 0; k < 3; ++k)
        n[k] /= area;
    { /* in their plane, by the gradients of the weights */
        double g[3], h[3];
        cross(b, n, g);
        cross(n, a, h);
        for (int k = 0; k < 3; ++k)
            t[k] = ((v[0].r - v[1].r) * g[k] + (v[0].r - v[2].r) * h[k]) / area;
    }
    rise = 1 - sph__io_dot(t, t);
    if (!(rise > 0)) return false;
    for (int k = 0; k < 3; ++k) {
        normals[0][k] = t[k] + sqrt(rise) * n[k];
        normals[1][k] = t[k] - sqrt(rise) * n[k];
    }
    return true;
}

/* Where the slab of a small triangle ends, over the middles of its sides and its own, as seen from its corner 0. */
static double slab_reach(const vertex *corner, double normals[2][3])
{
    static const double PLACES[3][3] = {{0.5, 0.5, 0}, {0.5, 0, 0.5}, {1 / 3.0, 1 / 3.0, 1 / 3.0}};
    double reach = 0;
    for (int i = 0; i < 3; ++i)
        for (int side = 0; side < 2; ++side) {
            double d[3] = {0, 0, 0}, r = 0;
            for (int j = 0; j < 3; ++j)
                r += PLACES[i][j] * corner[j].r;
            for (int k = 0; k < 3; ++k) {
                for (int j = 0; j < 3; ++j)
                    d[k] += PLACES[i][j] * (corner[j].c[k] - corner[0].c[k]);
                d[k] += r * normals[side][k];
            }
            reach = fmax(reach, sqrt(sph__io_dot(d, d)));
        }
    return reach;
}

/* Radius that contains what of the triangle is around point w of its grid. */
static double triangle_reach(const vertex *v, const uint32_t w[3], uint32_t steps, bool has_faces,
                             double normals[2][3])
{
    /* the six small triangles around: steps from the point to their other corners */
    static const int AROUND[6][3] = {{1, -1, 0}, {1, 0, -1}, {0, 1, -1}, {-1, 1, 0}, {-1, 0, 1}, {0, -1, 1}};
    double reach = 0;
    vertex corner[3];
    corner[0] = blend(v, w, 3, steps);
    for (int t = 0; t < 6 && has_faces; ++t) {
        bool inside = true;
        for (int j = 1; j < 3; ++j) {
            uint32_t other[3];
            for (int k = 0; k < 3; ++k) {
                const int64_t weight = (int64_t)w[k] + AROUND[(t + j - 1) % 6][k];
                if (weight < 0) inside = false;
                other[k] = weight < 0 ? 0 : (uint32_t)weight;
            }
            corner[j] = blend(v, other, 3, steps);
        }
        if (inside) reach = fmax(reach, slab_reach(corner, normals));
    }
    for (int k = 0; k < 3; ++k) { /* on a side: its capsule */
        const vertex *a = &v[(k + 1) % 3], *b = &v[(k + 2) % 3];
        if (w[k] == 0 && !is_one_sphere(a, b)) reach = fmax(reach, capsule_reach(a, b, w[(k + 2) % 3], steps));
    }
    return fmax(reach, corner[0].r);
}

/* --- collecting --- */

static void add_ball(cover *c, const vertex *v, double reach)
{
    sph__io_balls *balls = c->balls;
    void *memory = balls->items;
    sph__io_ball ball;
    double moved = 0, radius = v->r;
    if (c->status != SPH_OK) return;
    if (balls->count >= 4 * (size_t)MOST_BALLS) {
        c->status = SPH_E_LIMIT;
        return;
    }
    c->gap = fmax(c->gap, reach - v->r);
    if (!sph__io_reserve(balls->context, &memory, &balls->capacity, balls->count + 1, sizeof *balls->items)) {
        c->status = sph_context_fail(balls->context, SPH_E_NOMEM, "out of memory");
        return;
    }
    balls->items = memory;
    for (int k = 0; k < 3; ++k) {
        ball.center[k] = (float)v->c[k];
        moved += fabs(ball.center[k] - v->c[k]);
    }
    if (c->e->cover_solid) {
        const double size = fabs(v->c[0]) + fabs(v->c[1]) + fabs(v->c[2]) + reach;
        if (reach > v->r || moved > 0) radius = reach + moved + 64 * DBL_EPSILON * size;
        ball.radius = (float)radius;
        if (ball.radius < radius) ball.radius = nextafterf(ball.radius, INFINITY);
    } else {
        ball.radius = (float)radius;
    }
    balls->items[balls->count++] = ball;
}

static int compare(const sph__io_ball *a, const sph__io_ball *b)
{
    for (int k = 0; k < 3; ++k)
        if (a->center[k] != b->center[k]) return a->center[k] < b->center[k] ? -1 : 1;
    return a->radius != b->radius ? (a->radius > b->radius ? -1 : 1) : 0;
}

static void sift_down(sph__io_ball *items, size_t root, size_t count)
{
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        const sph__io_ball moved = items[root];
        if (child + 1 < count && compare(&items[child], &items[child + 1]) < 0) ++child;
        if (compare(&moved, &items[child]) >= 0) return;
        items[root] = items[child];
        items[child] = moved;
    }
}

static bool same_center(const sph__io_ball *a, const sph__io_ball *b)
{
    return a->center[0] == b->center[0] && a->center[1] == b->center[1] && a->center[2] == b->center[2];
}

/* In ascending order; of those at one place the largest. */
static void sort_and_unite(sph__io_balls *balls)
{
    size_t kept = 0;
    for (size_t i = balls->count / 2; i-- > 0;)
        sift_down(balls->items, i, balls->count);
    for (size_t end = balls->count; end-- > 1;) {
        const sph__io_ball last = balls->items[end];
        balls->items[end] = balls->items[0];
        balls->items[0] = last;
        sift_down(balls->items, 0, end);
    }
    for (size_t i = 0; i < balls->count; ++i)
        if (kept == 0 || !same_center(&balls->items[kept - 1], &balls->items[i]))
            balls->items[kept++] = balls->items[i];
    balls->count = kept;
}

static void sort_corners(const uint32_t *simplex, uint32_t corners, uint32_t sorted[3])
{
    for (uint32_t i = 0; i < corners; ++i) {
        uint32_t j = i;
        for (; j > 0 && sorted[j - 1] > simplex[i]; --j)
            sorted[j] = sorted[j - 1];
        sorted[j] = simplex[i];
    }
}

/* The capsule on a grid of so many steps: its gap, and with `c` its spheres. */
static double capsule_grid(cover *c, const vertex *v, uint32_t steps)
{
    double gap = 0;
    for (uint32_t i = 0; i <= steps; ++i) {
        const uint32_t w[2] = {steps - i, i};
        const vertex m = blend(v, w, 2, steps);
        const double reach = capsule_reach(&v[0], &v[1], i, steps);
        gap = fmax(gap, reach - m.r);
        if (c != NULL) add_ball(c, &m, reach);
    }
    return gap;
}

static double triangle_grid(cover *c, const vertex *v, uint32_t steps)
{
    double gap = 0, normals[2][3];
    const bool has_faces = touching(v, normals);
    for (uint32_t i = 0; i <= steps; ++i)
        for (uint32_t j = 0; i + j <= steps; ++j) {
            const uint32_t w[3] = {steps - i - j, i, j};
            const vertex m = blend(v, w, 3, steps);
            const double reach = triangle_reach(v, w, steps, has_faces, normals);
            if (w[0] > 0 && w[1] > 0 && w[2] > 0 && !has_faces) continue; /* the sides are all */
            gap = fmax(gap, reach - m.r);
            if (c != NULL) add_ball(c, &m, reach);
        }
    return gap;
}

/* The fewest steps, about, that leave no more than the gap. */
static uint32_t count_steps(const vertex *v, uint32_t corners, double gap)
{
    const uint32_t most = corners == 2 ? MOST_STEPS : MOST_TRIANGLE_STEPS;
    uint32_t steps = 1;
    while (steps < most) {
        if ((corners == 2 ? capsule_grid(NULL, v, steps) : triangle_grid(NULL, v, steps)) <= gap) return steps;
        steps += 1 + steps / 8;
    }
    return most;
}

/* Triangles share one number of steps, so that they share the spheres on their sides. */
static uint32_t triangle_steps(const sph__io_export *e)
{
    uint32_t steps = 1;
    for (size_t i = 0; i < e->a.triangle_count; ++i) {
        uint32_t sorted[3], needed;
        vertex v[3];
        if (sph__io_export_is_flat(e->a.triangles + 3 * i, 3)) continue;
        sort_corners(e->a.triangles + 3 * i, 3, sorted);
        for (int k = 0; k < 3; ++k)
            v[k] = sphere_of(e, sorted[k]);
        needed = count_steps(v, 3, e->gap);
        if (needed > steps) steps = needed;
    }
    return steps;
}

static void cover_edge(cover *c, const uint32_t *edge)
{
    uint32_t sorted[3];
    vertex v[2];
    if (edge[0] == edge[1]) return;
    sort_corners(edge, 2, sorted);
    for (int k = 0; k < 2; ++k)
        v[k] = sphere_of(c->e, sorted[k]);
    if (!is_one_sphere(&v[0], &v[1])) (void)capsule_grid(c, v, count_steps(v, 2, c->e->gap));
}

static void cover_triangle(cover *c, const uint32_t *triangle, uint32_t steps)
{
    static const int SIDES[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    uint32_t sorted[3];
    vertex v[3];
    if (sph__io_export_is_flat(triangle, 3)) {
        for (int i = 0; i < 3; ++i) {
            const uint32_t edge[2] = {triangle[SIDES[i][0]], triangle[SIDES[i][1]]};
            cover_edge(c, edge);
        }
        return;
    }
    sort_corners(triangle, 3, sorted);
    for (int k = 0; k < 3; ++k)
        v[k] = sphere_of(c->e, sorted[k]);
    (void)triangle_grid(c, v, steps);
}

sph_status sph__io_cover_with_balls(const sph__io_export *e, sph__io_balls *balls)
{
    cover c = {.e = e, .balls = balls};
    const uint32_t steps = triangle_steps(e);
    *balls = (sph__io_balls){.context = e->context};
    for (uint32_t i = 0; i < e->a.sphere_count; ++i) {
        const vertex v = sphere_of(e, i);
        add_ball(&c, &v, v.r);
    }
    for (size_t i = 0; i < e->a.edge_count && c.status == SPH_OK; ++i)
        cover_edge(&c, e->a.edges + 2 * i);
    for (size_t i = 0; i < e->a.triangle_count && c.status == SPH_OK; ++i)
        cover_triangle(&c, e->a.triangles + 3 * i, steps);
    if (c.status == SPH_OK) sort_and_unite(balls);
    balls->gap = c.gap;
    if (c.status == SPH_E_LIMIT || (c.status == SPH_OK && (balls->count > MOST_BALLS || c.gap > 1.0001 * e->gap)))
        return sph__io_fail(e->context, SPH_E_LIMIT, "more than %d spheres would be needed for a gap of %g", MOST_BALLS,
                            e->gap);
    return c.status;
}

void sph__io_balls_release(sph__io_balls *balls)
{
    sph_context_release(balls->context, balls->items);
    balls->items = NULL;
}
