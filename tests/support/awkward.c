/* SPDX-License-Identifier: MIT */
#include "awkward.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

enum { MOST = 512 };
static const double TAU = 6.283185307179586;

static const char *const NAMES[AWKWARD_KIND_COUNT] = {"single vertex",
                                                      "two coincident",
                                                      "coincident wire",
                                                      "isolated",
                                                      "wires",
                                                      "wire star",
                                                      "repeated edges",
                                                      "triangle",
                                                      "duplicates",
                                                      "repeated indices",
                                                      "collinear",
                                                      "book",
                                                      "cone",
                                                      "components",
                                                      "flat",
                                                      "one point",
                                                      "squashed",
                                                      "collapsing",
                                                      "thin soup",
                                                      "soup",
                                                      "dense soup",
                                                      "moebius",
                                                      "whiskers",
                                                      "cube",
                                                      "sphere",
                                                      "torus"};

const char *awkward_name(unsigned kind)
{
    return NAMES[kind];
}

typedef struct draft {
    float rest[MOST][3];
    uint32_t triangles[MOST][3], edges[MOST][2];
    uint32_t n;
    size_t triangle_count, edge_count;
} draft;

static uint32_t add_vertex(draft *d, double x, double y, double z)
{
    d->rest[d->n][0] = (float)x;
    d->rest[d->n][1] = (float)y;
    d->rest[d->n][2] = (float)z;
    return d->n++;
}

static void add_triangle(draft *d, uint32_t a, uint32_t b, uint32_t c)
{
    memcpy(d->triangles[d->triangle_count++], (uint32_t[3]){a, b, c}, 3 * sizeof(uint32_t));
}

static void add_edge(draft *d, uint32_t a, uint32_t b)
{
    memcpy(d->edges[d->edge_count++], (uint32_t[2]){a, b}, 2 * sizeof(uint32_t));
}

static void add_random_vertices(draft *d, uint32_t count, uint64_t *state)
{
    for (uint32_t i = 0; i < count; ++i) {
        const double x = test_random_unit(state), y = test_random_unit(state), z = test_random_unit(state);
        add_vertex(d, x, y, z);
    }
}

static uint32_t random_vertex(const draft *d, uint64_t *state)
{
    return (uint32_t)(test_random(state) % d->n);
}

/* Triangles of any three vertices, the same one twice too. */
static void add_soup(draft *d, uint32_t vertices, size_t triangles, uint64_t seed)
{
    add_random_vertices(d, vertices, &seed);
    for (size_t t = 0; t < triangles; ++t) {
        const uint32_t a = random_vertex(d, &seed), b = random_vertex(d, &seed), c = random_vertex(d, &seed);
        add_triangle(d, a, b, c);
    }
}

static void add_grid(draft *d, uint32_t columns, uint32_t rows, double step)
{
    const uint32_t first = d->n, width = columns + 1;
    for (uint32_t i = 0; i < width * (rows + 1); ++i)
        add_vertex(d, step * (i % width), step * (i / width), 0);
    for (uint32_t y = 0; y < rows; ++y)
        for (uint32_t x = 0; x < columns; ++x) {
            const uint32_t a = first + y * width + x, b = a + 1, c = b + width, e = a + width;
            add_triangle(d, a, b, c);
            add_triangle(d, a, c, e);
        }
}

/* A shape of the other helpers, moved and scaled along z. */
static void add_shape(draft *d, sph_animation *shape, double shift, double flatten)
{
    const uint32_t first = d->n, n = sph_animation_vertex_count(shape);
    const uint32_t *t = sph_animation_triangles(shape);
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    if (sph_animation_read_frame(shape, 0, xyz) != SPH_OK) abort();
    for (uint32_t i = 0; i < n; ++i)
        add_vertex(d, (double)xyz[3 * i] + shift, (double)xyz[3 * i + 1], flatten * (double)xyz[3 * i + 2]);
    for (size_t i = 0; i < sph_animation_triangle_count(shape); ++i, t += 3)
        add_triangle(d, first + t[0], first + t[1], first + t[2]);
    free(xyz);
    sph_animation_destroy(shape);
}

/* Spokes from a tip to a circle, as wires or as the triangles of a cone. */
static void add_wheel(draft *d, uint32_t spokes, bool wires)
{
    const uint32_t tip = add_vertex(d, 0, 0, 1.5), first = d->n;
    for (uint32_t i = 0; i < spokes; ++i)
        add_vertex(d, cos(TAU * i / spokes), sin(TAU * i / spokes), 0);
    for (uint32_t i = 0; i < spokes; ++i) {
        if (wires)
            add_edge(d, tip, first + i);
        else
            add_triangle(d, tip, first + i, first + (i + 1) % spokes);
    }
}

static void add_moebius(draft *d, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        for (int side = -1; side <= 1; side += 2) {
            const double turn = TAU * i / count, r = 1 + 0.3 * side * cos(turn / 2);
            add_vertex(d, r * cos(turn), r * sin(turn), 0.3 * side * sin(turn / 2));
        }
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t next = (i + 1) % count, flip = next == 0;
        const uint32_t a = 2 * i, b = 2 * i + 1, c = 2 * next + flip, e = 2 * next + 1 - flip;
        add_triangle(d, a, c, b);
        add_triangle(d, b, c, e);
    }
}

static void add_wires(draft *d)
{
    uint64_t state = 7;
    add_random_vertices(d, 24, &state);
    for (unsigned e = 0; e < 26; ++e) {
        const uint32_t a = random_vertex(d, &state), b = random_vertex(d, &state);
        add_edge(d, a, b);
    }
}

static void add_duplicates(draft *d)
{
    static const uint32_t corners[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    add_vertex(d, 0, 0, 0);
    add_vertex(d, 1, 0, 0);
    add_vertex(d, 0, 1, 0);
    add_vertex(d, 0, 0, 1);
    for (unsigned t = 0; t < 20; ++t) {
        const uint32_t *c = corners[t % 4];
        if (t % 3 == 0)
            add_triangle(d, c[1], c[0], c[2]);
        else
            add_triangle(d, c[t % 3], c[(t + 1) % 3], c[(t + 2) % 3]);
    }
}

static void add_repeated_indices(draft *d)
{
    static const uint32_t corners[7][3] = {{0, 0, 1}, {1, 2, 1}, {3, 2, 2}, {4, 4, 4}, {0, 1, 2}, {5, 6, 5}, {1, 1, 0}};
    uint64_t state = 3;
    add_random_vertices(d, 7, &state);
    for (unsigned t = 0; t < 7; ++t)
        add_triangle(d, corners[t][0], corners[t][1], corners[t][2]);
}

static void add_components(draft *d, sph_context *context)
{
    uint64_t state = 5;
    add_shape(d, test_cube(context, 1), 0, 1);
    add_shape(d, test_cube(context, 1), 0, 1); /* in the same place */
    add_shape(d, test_sphere(context, 0, 1), 5, 1);
    add_grid(d, 2, 2, 1);
    add_random_vertices(d, 4, &state);
    add_edge(d, d->n - 4, d->n - 3);
}

static void draw_flat_kinds(draft *d, unsigned kind)
{
    switch (kind) {
    case AWKWARD_SINGLE_VERTEX:
        add_vertex(d, 1, 2, 3);
        break;
    case AWKWARD_COINCIDENT_WIRE:
        add_edge(d, 0, 1); /* fall through */
    case AWKWARD_TWO_COINCIDENT:
        add_vertex(d, 1, 2, 3);
        add_vertex(d, 1, 2, 3);
        break;
    case AWKWARD_REPEATED_EDGES:
        for (unsigned i = 0; i < 4; ++i)
            add_vertex(d, i, i * i, 0);
        for (unsigned e = 0; e < 12; ++e)
            add_edge(d, e % 4, (e / 4 + e) % 4);
        break;
    case AWKWARD_COLLINEAR:
        for (unsigned i = 0; i < 12; ++i)
            add_vertex(d, i, 0, 0);
        for (uint32_t i = 0; i + 2 < 12; ++i)
            add_triangle(d, i, i + 1, i + 2);
        break;
    case AWKWARD_BOOK:
        add_vertex(d, 0, 0, -1);
        add_vertex(d, 0, 0, 1);
        for (unsigned i = 0; i < 9; ++i)
            add_triangle(d, 0, 1, add_vertex(d, cos(i), sin(i), 0.1 * i));
        break;
    case AWKWARD_FLAT:
        add_grid(d, 6, 5, 1);
        break;
    case AWKWARD_ONE_POINT:
        add_grid(d, 4, 4, 0);
        break;
    default:
        break;
    }
}

static void draw(draft *d, sph_context *context, unsigned kind)
{
    uint64_t state = 11;
    switch (kind) {
    case AWKWARD_ISOLATED:
        add_random_vertices(d, 7, &state);
        break;
    case AWKWARD_WIRES:
        add_wires(d);
        break;
    case AWKWARD_WIRE_STAR:
        add_wheel(d, 20, true);
        break;
    case AWKWARD_TRIANGLE:
        add_soup(d, 3, 0, 1);
        add_triangle(d, 0, 1, 2);
        break;
    case AWKWARD_DUPLICATES:
        add_duplicates(d);
        break;
    case AWKWARD_REPEATED_INDICES:
        add_repeated_indices(d);
        break;
    case AWKWARD_CONE:
        add_wheel(d, 40, false);
        break;
    case AWKWARD_COMPONENTS:
        add_components(d, context);
        break;
    case AWKWARD_SQUASHED:
        add_shape(d, test_sphere(context, 1, 1), 0, 1e-6);
        break;
    case AWKWARD_COLLAPSING:
    case AWKWARD_SPHERE:
        add_shape(d, test_sphere(context, 1, 1), 0, 1);
        break;
    case AWKWARD_THIN_SOUP:
        add_soup(d, 40, 12, 1);
        break;
    case AWKWARD_SOUP:
        add_soup(d, 25, 50, 2);
        break;
    case AWKWARD_DENSE_SOUP:
        add_soup(d, 12, 150, 3);
        break;
    case AWKWARD_MOEBIUS:
        add_moebius(d, 16);
        break;
    case AWKWARD_WHISKERS:
        add_shape(d, test_torus(context, 7, 5, 1), 0, 1);
        add_random_vertices(d, 12, &state);
        for (unsigned e = 0; e < 14; ++e) {
            const uint32_t a = random_vertex(d, &state), b = random_vertex(d, &state);
            add_edge(d, a, b);
        }
        break;
    case AWKWARD_CUBE:
        add_shape(d, test_cube(context, 1), 0, 1);
        break;
    case AWKWARD_TORUS:
        add_shape(d, test_torus(context, 9, 6, 1), 0, 1);
        break;
    default:
        draw_flat_kinds(d, kind);
        break;
    }
}

static void pose(const draft *d, unsigned kind, awkward_options o, unsigned frame, float (*xyz)[3])
{
    for (uint32_t i = 0; i < d->n; ++i) {
        test_wave(d->rest[i], frame, o.frames, xyz[i]);
        for (unsigned k = 0; k < 3; ++k) {
            float x = frame == 0 ? d->rest[i][k] : xyz[i][k];
            if (kind == AWKWARD_COLLAPSING && frame % 4 > k) x = 0;
            if (kind == AWKWARD_ONE_POINT) x = (float)frame;
            if (kind == AWKWARD_FLAT) x = d->rest[i][k] * (float)(1 + frame);
            if (kind == AWKWARD_COLLINEAR && k > 0) x = (float)frame * d->rest[i][0];
            /* no coordinate is so small that a small scale takes digits from it */
            x = (float)(nearbyint((double)x * 0x1p40) * 0x1p-40);
            xyz[i][k] = (float)((double)x * (o.scale != 0 ? o.scale : 1) + o.shift);
        }
    }
}

sph_animation *awkward_animation(sph_context *context, unsigned kind, awkward_options o)
{
    draft *d = test_malloc(1, sizeof *d);
    float(*xyz)[3] = test_malloc(MOST, sizeof *xyz);
    sph_context *own = test_context(); /* the caller's may be one whose memory fails */
    sph_animation *animation = NULL;
    sph_status status;
    if (own == NULL) abort();
    draw(d, own, kind);
    for (size_t t = 0; t < d->triangle_count && o.inward; ++t) {
        const uint32_t swapped = d->triangles[t][1];
        d->triangles[t][1] = d->triangles[t][2];
        d->triangles[t][2] = swapped;
    }
    status = sph_animation_create(context, d->n, o.frames, &animation);
    for (unsigned f = 0; f < o.frames && status == SPH_OK; ++f) {
        pose(d, kind, o, f, xyz);
        status = sph_animation_set_frame(animation, f, xyz[0], 0);
    }
    if (status == SPH_OK) status = sph_animation_set_triangles(animation, d->triangles[0], d->triangle_count, 0);
    if (status == SPH_OK) status = sph_animation_set_edges(animation, d->edges[0], d->edge_count, 0);
    if (status != SPH_OK) {
        sph_animation_destroy(animation);
        animation = NULL;
    }
    sph_context_destroy(own);
    free(d);
    free(xyz);
    return animation;
}

sph_animation *awkward(sph_context *context, unsigned kind, unsigned frames)
{
    return awkward_animation(context, kind, (awkward_options){.frames = frames});
}

static uint32_t find(uint32_t *parents, uint32_t v)
{
    while (parents[v] != v)
        v = parents[v] = parents[parents[v]];
    return v;
}

uint32_t test_component_count(const sph_animation *animation)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    const uint32_t *triangles = sph_animation_triangles(animation), *edges = sph_animation_edges(animation);
    uint32_t *parents = test_malloc(n, sizeof *parents), count = 0;
    for (uint32_t v = 0; v < n; ++v)
        parents[v] = v;
    for (size_t i = 0; i < 3 * sph_animation_triangle_count(animation); ++i)
        parents[find(parents, triangles[i])] = find(parents, triangles[i / 3 * 3]);
    for (size_t e = 0; e < sph_animation_edge_count(animation); ++e)
        parents[find(parents, edges[2 * e])] = find(parents, edges[2 * e + 1]);
    for (uint32_t v = 0; v < n; ++v)
        count += parents[v] == v;
    free(parents);
    return count;
}
