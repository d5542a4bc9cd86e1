/* SPDX-License-Identifier: MIT */
#include "cases.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

enum { MOST_VERTICES = 256, MOST_TRIANGLES = 1024, MOST_EDGES = 512 };
static const double TAU = 6.283185307179586;

#define H 0.7071067811865476
#define T 0.5773502691896258
const double CASE_DIRECTIONS[7][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {T, T, T}, {T, -T, T}, {H, 0, -H}, {0, H, H}};
#undef H
#undef T

static const char *const NAMES[CASE_SHAPE_COUNT] = {
    "tetrahedron", "icosahedron", "sphere 42", "sphere 162", "torus",           "big torus",  "cube",
    "grid",        "strip",       "tube",      "wires",      "sphere on wires", "components", "fans",
    "soup",        "dense soup",  "slivers",   "duplicates", "crumpled"};

static double noise(uint64_t *state)
{
    return 2 * test_random_unit(state) - 1;
}

static uint32_t add_vertex(struct case_mesh *mesh, double x, double y, double z)
{
    float *to = mesh->rest + 3 * (size_t)mesh->vertex_count;
    to[0] = (float)x;
    to[1] = (float)y;
    to[2] = (float)z;
    return mesh->vertex_count++;
}

static void add_triangle(struct case_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *to = mesh->triangles + 3 * mesh->triangle_count++;
    to[0] = a;
    to[1] = b;
    to[2] = c;
}

static void add_edge(struct case_mesh *mesh, uint32_t a, uint32_t b)
{
    uint32_t *to = mesh->edges + 2 * mesh->edge_count++;
    to[0] = a;
    to[1] = b;
}

static void add_animation(struct case_mesh *mesh, sph_animation *animation, double scale, double shift)
{
    const uint32_t first = mesh->vertex_count, n = sph_animation_vertex_count(animation);
    const uint32_t *triangles = sph_animation_triangles(animation);
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    if (sph_animation_read_frame(animation, 0, xyz) != SPH_OK) abort();
    for (uint32_t i = 0; i < n; ++i)
        add_vertex(mesh, scale * xyz[3 * i] + shift, scale * xyz[3 * i + 1], scale * xyz[3 * i + 2]);
    for (size_t t = 0; t < sph_animation_triangle_count(animation); ++t)
        add_triangle(mesh, first + triangles[3 * t], first + triangles[3 * t + 1], first + triangles[3 * t + 2]);
    sph_animation_destroy(animation);
    free(xyz);
}

/* columns * rows quads; point (i, j) by its parameters. A closed direction ends where it starts. */
static void add_quads(struct case_mesh *mesh, unsigned columns, unsigned rows, bool closed_columns,
                      void (*point)(double s, double t, double xyz[3]))
{
    const uint32_t first = mesh->vertex_count;
    const unsigned across = closed_columns ? columns : columns + 1;
    for (unsigned j = 0; j <= rows; ++j)
        for (unsigned i = 0; i < across; ++i) {
            double xyz[3];
            point((double)i / columns, (double)j / rows, xyz);
            add_vertex(mesh, xyz[0], xyz[1], xyz[2]);
        }
    for (unsigned j = 0; j < rows; ++j)
        for (unsigned i = 0; i < columns; ++i) {
            const uint32_t a = first + j * across + i, b = first + j * across + (i + 1) % across;
            add_triangle(mesh, a, b, b + across);
            add_triangle(mesh, a, b + across, a + across);
        }
}

static void folded_point(double s, double t, double xyz[3]) /* a screen of flat panels */
{
    const double x = 6 * s, fold = x - 2 * floor(x / 2);
    xyz[0] = x;
    xyz[1] = 2 * t;
    xyz[2] = fold < 1 ? fold : 2 - fold;
}

static void strip_point(double s, double t, double xyz[3])
{
    xyz[0] = 8 * s;
    xyz[1] = t;
    xyz[2] = sin(5 * s);
}

static void tube_point(double s, double t, double xyz[3])
{
    xyz[0] = cos(TAU * s);
    xyz[1] = sin(TAU * s);
    xyz[2] = 5 * t;
}

static void cube_face(struct case_mesh *mesh, int axis, double side, unsigned cells)
{
    const uint32_t first = mesh->vertex_count;
    for (unsigned j = 0; j <= cells; ++j)
        for (unsigned i = 0; i <= cells; ++i) {
            double p[3];
            p[axis] = side;
            p[(axis + 1) % 3] = side * (2.0 * i / cells - 1);
            p[(axis + 2) % 3] = 2.0 * j / cells - 1;
            add_vertex(mesh, p[0], p[1], p[2]);
        }
    for (unsigned j = 0; j < cells; ++j)
        for (unsigned i = 0; i < cells; ++i) {
            const uint32_t a = first + j * (cells + 1) + i, c = a + cells + 2;
            add_triangle(mesh, a, a + 1, c);
            add_triangle(mesh, a, c, c - 1);
        }
}

/* Makes one of vertices at the same place, from the first on. */
static void weld(struct case_mesh *mesh)
{
    uint32_t map[MOST_VERTICES], kept = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
        uint32_t same = 0;
        while (same < kept && memcmp(mesh->rest + 3 * same, mesh->rest + 3 * i, 3 * sizeof *mesh->rest) != 0)
            ++same;
        if (same == kept) memmove(mesh->rest + 3 * kept++, mesh->rest + 3 * i, 3 * sizeof *mesh->rest);
        map[i] = same;
    }
    mesh->vertex_count = kept;
    for (size_t i = 0; i < 3 * mesh->triangle_count; ++i)
        mesh->triangles[i] = map[mesh->triangles[i]];
}

static void add_cube(struct case_mesh *mesh, unsigned cells)
{
    for (int axis = 0; axis < 3; ++axis) {
        cube_face(mesh, axis, 1, cells);
        cube_face(mesh, axis, -1, cells);
    }
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; ++i)
        mesh->rest[i] += 0.0f; /* -0 would not weld with 0 */
    weld(mesh);
}

static void add_wires(struct case_mesh *mesh, uint32_t n, uint64_t *state)
{
    const uint32_t first = mesh->vertex_count;
    for (uint32_t i = 0; i < n; ++i)
        add_vertex(mesh, noise(state), noise(state), noise(state));
    for (uint32_t i = 1; i < n; ++i)
        add_edge(mesh, first + i, first + (uint32_t)(test_random(state) % i));
    for (uint32_t i = 0; i < n / 2; ++i) /* and some rings; a vertex may be joined to itself, an edge given twice */
        add_edge(mesh, first + (uint32_t)(test_random(state) % n), first + (uint32_t)(test_random(state) % n));
}

/* Many triangles on one edge, and two fans that share but their tip. */
static void add_fans(struct case_mesh *mesh)
{
    const uint32_t a = add_vertex(mesh, 0, 0, -1), b = add_vertex(mesh, 0, 0, 1);
    uint32_t before;
    for (int i = 0; i < 7; ++i)
        add_triangle(mesh, a, b, add_vertex(mesh, cos(i * 0.8), sin(i * 0.8), 0.1 * i));
    for (int fan = 0; fan < 2; ++fan) {
        before = add_vertex(mesh, 1, fan, 2);
        for (int i = 1; i < 8; ++i) {
            const uint32_t next = add_vertex(mesh, cos(i * 0.7), sin(i * 0.7) + fan, 2 + fan);
            add_triangle(mesh, b, before, next);
            before = next;
        }
    }
}

static void add_awkward(struct case_mesh *mesh, uint64_t *state)
{
    const size_t m = mesh->triangle_count;
    const uint32_t n = mesh->vertex_count;
    for (int i = 0; i < 6; ++i) { /* twice, the other way round, with a corner named twice, self-edges */
        const uint32_t *t = mesh->triangles + 3 * (test_random(state) % m);
        add_triangle(mesh, t[1], t[2], t[0]);
        add_triangle(mesh, t[0], t[2], t[1]);
        add_triangle(mesh, t[0], t[1], t[1]);
        add_triangle(mesh, t[2], t[2], t[2]);
        add_edge(mesh, t[0], t[0]);
    }
    for (uint32_t i = 0; i < 8; ++i) { /* twins in place, joined by an edge or by a triangle of no area */
        const uint32_t old = (uint32_t)(test_random(state) % n), twin = add_vertex(mesh, 0, 0, 0);
        memcpy(mesh->rest + 3 * twin, mesh->rest + 3 * old, 3 * sizeof *mesh->rest);
        if (i % 2 == 0)
            add_edge(mesh, old, twin);
        else
            add_triangle(mesh, old, twin, (old + 1) % n);
    }
    add_vertex(mesh, 3, 0, 0); /* isolated */
}

static void build(struct case_mesh *mesh, enum case_shape shape, uint64_t *state)
{
    static const uint32_t tetrahedron[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    sph_context *context = test_context();
    switch (shape) {
    case CASE_TETRAHEDRON:
        for (uint32_t i = 0; i < 4; ++i) {
            add_vertex(mesh, i == 1, i == 2, i == 3);
            add_triangle(mesh, tetrahedron[i][0], tetrahedron[i][1], tetrahedron[i][2]);
        }
        break;
    case CASE_ICOSAHEDRON:
        add_animation(mesh, test_sphere(context, 0, 1), 1, 0);
        break;
    case CASE_SPHERE_42:
        add_animation(mesh, test_sphere(context, 1, 1), 1, 0);
        break;
    case CASE_SPHERE_162:
        add_animation(mesh, test_sphere(context, 2, 1), 1, 0);
        break;
    case CASE_TORUS:
        add_animation(mesh, test_torus(context, 9, 5, 1), 1, 0);
        break;
    case CASE_BIG_TORUS:
        add_animation(mesh, test_torus(context, 20, 9, 1), 1, 0);
        break;
    case CASE_CUBE:
        add_cube(mesh, 4);
        break;
    case CASE_GRID:
        add_quads(mesh, 12, 4, false, folded_point);
        break;
    case CASE_STRIP:
        add_quads(mesh, 20, 1, false, strip_point);
        break;
    case CASE_TUBE:
        add_quads(mesh, 8, 10, true, tube_point);
        break;
    case CASE_WIRES:
        add_wires(mesh, 40, state);
        break;
    case CASE_SPHERE_ON_WIRES:
        add_animation(mesh, test_sphere(context, 1, 1), 1, 0);
        add_wires(mesh, 20, state);
        add_edge(mesh, 3, 42);
        add_edge(mesh, 3, 7);
        break;
    case CASE_COMPONENTS:
        add_animation(mesh, test_sphere(context, 1, 1), 1, 0);
        add_animation(mesh, test_torus(context, 6, 4, 1), 0.4, 3);
        add_animation(mesh, test_cube(context, 1), 0.05, -2);
        add_quads(mesh, 5, 1, false, strip_point);
        add_vertex(mesh, 0, 0, 0);
        break;
    case CASE_FANS:
        add_fans(mesh);
        break;
    case CASE_SOUP:
        add_animation(mesh, test_soup(context, 60, 60, 1, 7), 1, 0);
        break;
    case CASE_DENSE_SOUP:
        add_animation(mesh, test_soup(context, 30, 150, 1, 8), 1, 0);
        break;
    case CASE_SLIVERS:
    case CASE_DUPLICATES:
    case CASE_CRUMPLED:
        add_animation(mesh, test_torus(context, 10, 6, 1), 1, 0);
        break;
    default:
        abort();
    }
    if (shape == CASE_DUPLICATES) add_awkward(mesh, state);
    sph_context_destroy(context);
}

static void count_components(struct case_mesh *mesh)
{
    uint32_t label[MOST_VERTICES];
    for (uint32_t i = 0; i < mesh->vertex_count; ++i)
        label[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t k = 0; k < 3 * mesh->triangle_count + mesh->edge_count; ++k) {
            const uint32_t *t = mesh->triangles + k / 3 * 3, *e = mesh->edges + 2 * (k - 3 * mesh->triangle_count);
            const bool wire = k >= 3 * mesh->triangle_count;
            uint32_t *a = &label[wire ? e[0] : t[k % 3]], *b = &label[wire ? e[1] : t[(k + 1) % 3]];
            changed = changed || *a != *b;
            *a = *b = *a < *b ? *a : *b;
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; ++i)
        mesh->components += label[i] == i;
}

static void move_point(enum case_motion motion, const float rest[3], uint32_t frame, uint32_t frame_count,
                       double tremble, uint64_t *state, float out[3])
{
    const double angle = 2.0 * (frame + 1) / (frame_count + 1), co = cos(angle), si = sin(angle);
    if (motion == CASE_HALF) motion = 2 * frame < frame_count ? CASE_STRETCH : CASE_WAVE;
    if (motion == CASE_TUMBLE) {
        for (int k = 0; k < 3; ++k)
            out[k] = (float)noise(state);
    } else if (motion == CASE_WAVE) {
        test_wave(rest, frame, frame_count, out);
        for (int k = 0; k < 3; ++k)
            out[k] += (float)(tremble * noise(state));
    } else if (motion == CASE_RIGID) {
        out[0] = (float)(co * rest[0] - si * rest[1] + 0.1 * frame);
        out[1] = (float)(0.8 * (si * rest[0] + co * rest[1]) - 0.6 * rest[2]);
        out[2] = (float)(0.6 * (si * rest[0] + co * rest[1]) + 0.8 * rest[2]);
    } else {
        out[0] = (float)((1 + 0.3 * si) * rest[0] + 0.2 * co * rest[2]);
        out[1] = (float)(rest[1] - 0.3 * si * rest[0]);
        out[2] = (float)((1.2 - 0.3 * co) * rest[2]);
    }
}

void case_create(struct case_mesh *mesh, enum case_shape shape, enum case_motion motion, uint32_t frame_count,
                 uint64_t seed)
{
    uint64_t state = seed * 1000003 + (uint64_t)shape * 131 + frame_count;
    double tremble = 0.03;
    *mesh = (struct case_mesh){.frame_count = frame_count};
    mesh->rest = test_malloc(MOST_VERTICES, 3 * sizeof *mesh->rest);
    mesh->triangles = test_malloc(MOST_TRIANGLES, 3 * sizeof *mesh->triangles);
    mesh->edges = test_malloc(MOST_EDGES, 2 * sizeof *mesh->edges);
    build(mesh, shape, &state);
    snprintf(mesh->name, sizeof mesh->name, "%s, motion %d, %u frames, seed %u", NAMES[shape], (int)motion, frame_count,
             (unsigned)seed);
    count_components(mesh);
    mesh->positions = test_malloc((size_t)frame_count * mesh->vertex_count, 3 * sizeof *mesh->positions);
    if (shape == CASE_CRUMPLED) tremble = 0.3;
    if (motion == CASE_STRETCH || motion == CASE_HALF)
        for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; ++i)
            mesh->rest[i] += (float)(tremble * noise(&state));
    if (motion == CASE_RIGID) /* uneven, but planes across an axis stay planes */
        for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; ++i)
            mesh->rest[i] += (float)(0.15 * sin(1.7 * mesh->rest[i] + (double)(i % 3)));
    for (uint32_t f = 0; f < frame_count; ++f)
        for (uint32_t i = 0; i < mesh->vertex_count; ++i)
            move_point(motion, mesh->rest + 3 * (size_t)i, f, frame_count, tremble, &state,
                       mesh->positions + 3 * ((size_t)f * mesh->vertex_count + i));
    if (shape == CASE_SLIVERS || shape == CASE_DUPLICATES) /* some corners fall together, in some frames or all */
        for (uint32_t i = 0; i + 1 < mesh->vertex_count; i += 5)
            for (uint32_t f = i % 2; f < frame_count; f += 1 + i % 2)
                memcpy(mesh->positions + 3 * ((size_t)f * mesh->vertex_count + i),
                       mesh->positions + 3 * ((size_t)f * mesh->vertex_count + i + 1), 3 * sizeof(float));
}

void case_free(struct case_mesh *mesh)
{
    free(mesh->rest);
    free(mesh->positions);
    free(mesh->triangles);
    free(mesh->edges);
    *mesh = (struct case_mesh){0};
}

struct reference_input case_input(const struct case_mesh *mesh)
{
    return (struct reference_input){.vertex_count = mesh->vertex_count,
                                    .frame_count = mesh->frame_count,
                                    .positions = mesh->positions,
                                    .triangle_count = mesh->triangle_count,
                                    .triangles = mesh->triangles,
                                    .edge_count = mesh->edge_count,
                                    .edges = mesh->edges,
                                    .radius_factor = 0.75,
                                    .direction_count = 7,
                                    .directions = CASE_DIRECTIONS[0]};
}
