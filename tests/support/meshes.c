/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static const double TAU = 6.283185307179586;

void test_wave(const float rest[3], unsigned frame, unsigned frames, float bent[3])
{
    const double turn = TAU * frame / frames;
    const double bend = 0.3 * sin(turn);
    const double x = rest[0];
    bent[0] = rest[0];
    bent[1] = (float)(rest[1] + bend * sin(2 * x + turn));
    bent[2] = (float)(rest[2] + bend * cos(1.5 * x));
}

sph_animation *test_animation(sph_context *context, const float *rest, uint32_t n, const uint32_t *triangles,
                              size_t triangle_count, unsigned frames)
{
    float *bent = test_malloc(n, 3 * sizeof *bent);
    sph_animation *animation;
    sph_status status = sph_animation_create(context, n, frames, &animation);
    for (unsigned f = 0; status == SPH_OK && f < frames; ++f) {
        for (uint32_t i = 0; i < n; ++i)
            test_wave(rest + 3 * (size_t)i, f, frames, bent + 3 * (size_t)i);
        status = sph_animation_set_frame(animation, f, f == 0 ? rest : bent, 0);
    }
    if (status == SPH_OK) status = sph_animation_set_triangles(animation, triangles, triangle_count, 0);
    free(bent);
    if (status == SPH_OK) return animation;
    sph_animation_destroy(animation);
    return NULL;
}

sph_animation *test_cube(sph_context *context, unsigned frames)
{
    /* Corner i has x, y, z from bits 0, 1, 2 of i. */
    static const uint32_t triangles[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                              {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    float corners[8][3];
    for (unsigned i = 0; i < 8; ++i)
        for (unsigned k = 0; k < 3; ++k)
            corners[i][k] = (i >> k & 1) != 0 ? 1.0f : -1.0f;
    return test_animation(context, corners[0], 8, triangles[0], 12, frames);
}

/* The vertices in the middle of edges, by the edge: open addressing. */
typedef struct middle_table {
    uint32_t (*slots)[3]; /* both ends, low first, and the middle; 0 0 0: free */
    size_t mask;
} middle_table;

/* The middle of edge (a, b), pushed out to the unit sphere and made once. */
static uint32_t edge_middle(middle_table *table, float *xyz, uint32_t *count, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    const float *p = xyz + 3 * (size_t)a, *q = xyz + 3 * (size_t)b;
    double m[3], length = 0;
    size_t i = (size_t)(((uint64_t)low << 32 | high) * 0x9e3779b97f4a7c15u >> 20) & table->mask;
    for (; table->slots[i][1] != 0; i = (i + 1) & table->mask)
        if (table->slots[i][0] == low && table->slots[i][1] == high) return table->slots[i][2];
    for (unsigned k = 0; k < 3; ++k) {
        m[k] = (double)p[k] + q[k];
        length += m[k] * m[k];
    }
    for (unsigned k = 0; k < 3; ++k)
        xyz[3 * (size_t)*count + k] = (float)(m[k] / sqrt(length));
    memcpy(table->slots[i], (uint32_t[3]){low, high, *count}, sizeof table->slots[i]);
    return (*count)++;
}

static void icosahedron(float *xyz, uint32_t *triangles)
{
    static const uint32_t faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                          {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                          {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                          {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    const double g = (1 + sqrt(5.0)) / 2, s = 1 / sqrt(1 + g * g);
    for (unsigned i = 0; i < 12; ++i) { /* (+-1, +-g, 0) and its turns of the axes */
        const double one = (i & 1) != 0 ? s : -s, golden = (i & 2) != 0 ? -g * s : g * s;
        float *v = xyz + 3 * (size_t)i;
        const unsigned axis = i / 4;
        v[axis] = (float)one;
        v[(axis + 1) % 3] = (float)golden;
        v[(axis + 2) % 3] = 0;
    }
    memcpy(triangles, faces, sizeof faces);
}

sph_animation *test_sphere(sph_context *context, unsigned subdivisions, unsigned frames)
{
    size_t m = 20, last = 20;
    for (unsigned s = 0; s < subdivisions; ++s)
        last *= 4;
    float *xyz = test_malloc(last / 2 + 2, 3 * sizeof *xyz);
    uint32_t *triangles = test_malloc(last, 3 * sizeof *triangles);
    middle_table table = {NULL, 63};
    uint32_t n = 12;
    sph_animation *animation;
    icosahedron(xyz, triangles);
    for (; m < last; m *= 4) {
        while (table.mask < 3 * m)
            table.mask = 2 * table.mask + 1;
        table.slots = test_malloc(table.mask + 1, sizeof *table.slots);
        for (size_t t = m;
             t-- > 0;) { /* triangle t becomes 4 t ... 4 t + 3: from the back, so that none is overwritten */
            uint32_t v[3], e[3];
            memcpy(v, triangles + 3 * t, sizeof v);
            for (unsigned k = 0; k < 3; ++k)
                e[k] = edge_middle(&table, xyz, &n, v[k], v[(k + 1) % 3]);
            const uint32_t four[4][3] = {
                {v[0], e[0], e[2]}, {v[1], e[1], e[0]}, {v[2], e[2], e[1]}, {e[0], e[1], e[2]}};
            memcpy(triangles + 12 * t, four, sizeof four);
        }
        free(table.slots);
    }
    animation = test_animation(context, xyz, n, triangles, m, frames);
    free(xyz);
    free(triangles);
    return animation;
}

sph_animation *test_torus(sph_context *context, unsigned rings, unsigned sides, unsigned frames)
{
    float *xyz = test_malloc((size_t)rings * sides, 3 * sizeof *xyz), *v = xyz;
    uint32_t *triangles = test_malloc((size_t)rings * sides * 2, 3 * sizeof *triangles), *t = triangles;
    sph_animation *animation;
    for (unsigned i = 0; i < rings; ++i)
        for (unsigned j = 0; j < sides; ++j, v += 3, t += 6) {
            const double u = TAU * i / rings, w = TAU * j / sides;
            const uint32_t i1 = (i + 1) % rings, j1 = (j + 1) % sides;
            const uint32_t a = i * sides + j, b = i1 * sides + j, c = i1 * sides + j1, d = i * sides + j1;
            const uint32_t two[6] = {a, b, c, a, c, d};
            v[0] = (float)((1 + 0.4 * cos(w)) * cos(u));
            v[1] = (float)((1 + 0.4 * cos(w)) * sin(u));
            v[2] = (float)(0.4 * sin(w));
            memcpy(t, two, sizeof two);
        }
    animation = test_animation(context, xyz, rings * sides, triangles, (size_t)rings * sides * 2, frames);
    free(xyz);
    free(triangles);
    return animation;
}

sph_animation *test_grid(sph_context *context, unsigned columns, unsigned rows, unsigned frames)
{
    const uint32_t n = (columns + 1) * (rows + 1), width = columns + 1;
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    uint32_t *triangles = test_malloc((size_t)columns * rows * 2, 3 * sizeof *triangles), *t = triangles;
    sph_animation *animation;
    for (uint32_t i = 0; i < n; ++i) {
        xyz[3 * (size_t)i] = (float)(i % width);
        xyz[3 * (size_t)i + 1] = (float)(i / width);
    }
    for (uint32_t y = 0; y < rows; ++y)
        for (uint32_t x = 0; x < columns; ++x, t += 6) {
            const uint32_t a = y * width + x, b = a + 1, c = b + width, d = a + width;
            const uint32_t two[6] = {a, b, c, a, c, d};
            memcpy(t, two, sizeof two);
        }
    animation = test_animation(context, xyz, n, triangles, (size_t)columns * rows * 2, frames);
    free(xyz);
    free(triangles);
    return animation;
}

sph_animation *test_soup(sph_context *context, uint32_t n, size_t triangle_count, unsigned frames, uint64_t seed)
{
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    uint32_t *triangles = test_malloc(triangle_count, 3 * sizeof *triangles);
    sph_animation *animation;
    for (size_t i = 0; i < 3 * (size_t)n; ++i)
        xyz[i] = (float)test_random_unit(&seed);
    for (size_t t = 0; n >= 3 && t < triangle_count; ++t) {
        const uint32_t a = (uint32_t)(test_random(&seed) % n);
        const uint32_t b = (a + 1 + (uint32_t)(test_random(&seed) % (n - 1))) % n;
        uint32_t c;
        do
            c = (uint32_t)(test_random(&seed) % n);
        while (c == a || c == b);
        memcpy(triangles + 3 * t, (uint32_t[3]){a, b, c}, 3 * sizeof(uint32_t));
    }
    animation = test_animation(context, xyz, n, triangles, n >= 3 ? triangle_count : 0, frames);
    free(xyz);
    free(triangles);
    return animation;
}
