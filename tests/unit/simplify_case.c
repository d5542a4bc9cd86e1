/* SPDX-License-Identifier: MIT */
#include "simplify_case.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void turn_about_z(double angle, double out[12])
{
    const double c = cos(angle), s = sin(angle);
    memcpy(out, (double[12]){c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0}, 12 * sizeof *out);
}

static void add_triangle(uint32_t *triangles, size_t *count, uint32_t a, uint32_t b, uint32_t c)
{
    memcpy(triangles + 3 * (*count)++, (uint32_t[3]){a, b, c}, 3 * sizeof *triangles);
}

/* The wall between rings of `sides` vertices; the last joins the first where `closed`. */
static void add_wall(uint32_t *triangles, size_t *count, unsigned rings, unsigned sides, bool closed)
{
    for (uint32_t r = 0; r + 1 < rings; ++r)
        for (uint32_t s = 0; s + (closed ? 0 : 1) < sides; ++s) {
            const uint32_t a = r * sides + s, b = r * sides + (s + 1) % sides;
            add_triangle(triangles, count, a, a + sides, b);
            add_triangle(triangles, count, b, a + sides, b + sides);
        }
}

/* Place `s` of a ring of four sides, counter-clockwise seen from +x. */
static void square(unsigned s, unsigned cells, float *y, float *z)
{
    static const float CORNERS[5][2] = {{-0.5F, -0.5F}, {0.5F, -0.5F}, {0.5F, 0.5F}, {-0.5F, 0.5F}, {-0.5F, -0.5F}};
    const float t = (float)(s % cells) / (float)cells, *from = CORNERS[s / cells], *to = CORNERS[s / cells + 1];
    *y = from[0] + t * (to[0] - from[0]);
    *z = from[1] + t * (to[1] - from[1]);
}

static sph_skin *make_skin(sph_context *context, const sph_skin_arrays *a)
{
    sph_skin *skin = NULL;
    if (context != NULL && sph_skin_create_from_arrays(context, a, &skin) != SPH_OK) return NULL;
    return skin;
}

sph_skin *make_beam(sph_context *context, unsigned rings, unsigned cells)
{
    const unsigned sides = 4 * cells;
    const uint32_t n = rings * sides + 2;
    float *rest = test_malloc(n, 3 * sizeof *rest), *weights = test_malloc(n, sizeof *weights);
    uint32_t *bones = test_malloc(n, sizeof *bones), *triangles = test_malloc(2 * (size_t)n, 3 * sizeof *triangles);
    static double transforms[BEAM_FRAMES][2][12];
    sph_skin_arrays a = {.struct_size = sizeof a, .vertex_count = n, .bone_count = 2, .influence_count = 1};
    sph_skin *skin;
    size_t count = 0;
    for (uint32_t i = 0; i < n; ++i) {
        float *p = rest + 3 * (size_t)i;
        memcpy(p, (float[3]){i == n - 1 ? 2 : -2, 0, 0}, 3 * sizeof *p);
        if (i < rings * sides) {
            p[0] = -2 + 4 * (float)(i / sides) / (float)(rings - 1);
            square(i % sides, cells, &p[1], &p[2]);
        }
        bones[i] = p[0] > 1e-3F;
        weights[i] = 1;
    }
    add_wall(triangles, &count, rings, sides, true);
    for (uint32_t s = 0; s < sides; ++s) {
        const uint32_t next = (s + 1) % sides, end = (rings - 1) * sides;
        add_triangle(triangles, &count, n - 2, s, next);
        add_triangle(triangles, &count, n - 1, end + next, end + s);
    }
    for (unsigned f = 0; f < BEAM_FRAMES; ++f) {
        turn_about_z(0, transforms[f][0]);
        turn_about_z(0.25 * f - 1, transforms[f][1]);
    }
    a.rest = rest;
    a.weights = weights;
    a.bones = bones;
    a.frame_count = BEAM_FRAMES;
    a.transforms = transforms[0][0];
    a.triangles = triangles;
    a.triangle_count = count;
    skin = make_skin(context, &a);
    free(rest);
    free(weights);
    free(bones);
    free(triangles);
    return skin;
}

/* Three weights along the tube. */
static void weigh(double x, float weights[3])
{
    double sum = 0, w[3];
    for (int k = 0; k < 3; ++k)
        sum += w[k] = exp(-2.5 * (x - 1.5 * (k - 1)) * (x - 1.5 * (k - 1)));
    for (int k = 0; k < 3; ++k)
        weights[k] = (float)(w[k] / sum);
}

simplify_case make_tube(sph_context *context, unsigned rings, unsigned sides)
{
    const unsigned pitch = sides + 1; /* the seam's vertices are there twice */
    const uint32_t n = rings * pitch;
    simplify_case c = {.attributes = test_malloc(n, 2 * sizeof(float)), .normals = test_malloc(n, 3 * sizeof(float))};
    float *rest = test_malloc(n, 3 * sizeof *rest), *weights = test_malloc(n, 3 * sizeof *weights);
    uint32_t *bones = test_malloc(n, 3 * sizeof *bones), *triangles = test_malloc(2 * (size_t)n, 3 * sizeof *triangles);
    static double transforms[TUBE_FRAMES][3][12];
    sph_skin_arrays a = {.struct_size = sizeof a, .vertex_count = n, .bone_count = 3, .influence_count = 3};
    size_t count = 0;
    for (uint32_t i = 0; i < n; ++i) {
        const double x = 4.0 * (i / pitch) / (rings - 1) - 2, angle = 6.283185307179586 * (i % pitch % sides) / sides;
        const double radius = 0.5 + 0.05 * sin(3 * x + 2 * angle) + 0.04 * cos(5 * angle - x);
        memcpy(rest + 3 * (size_t)i, (float[3]){(float)x, (float)(radius * cos(angle)), (float)(radius * sin(angle))},
               3 * sizeof *rest);
        memcpy(c.normals + 3 * (size_t)i, (float[3]){0, (float)cos(angle), (float)sin(angle)}, 3 * sizeof(float));
        memcpy(c.attributes + 2 * (size_t)i, (float[2]){(float)(i % pitch) / (float)sides, (float)(x / 4 + 0.5)},
               2 * sizeof(float));
        memcpy(bones + 3 * (size_t)i, (uint32_t[3]){0, 1, 2}, 3 * sizeof *bones);
        weigh(x, weights + 3 * (size_t)i);
    }
    add_wall(triangles, &count, rings, pitch, false);
    for (unsigned f = 0; f < TUBE_FRAMES; ++f)
        for (int k = 0; k < 3; ++k) {
            turn_about_z(0.12 * f * (k - 1), transforms[f][k]);
            transforms[f][k][11] = 0.03 * f * k;
        }
    a.rest = rest;
    a.weights = weights;
    a.bones = bones;
    a.frame_count = TUBE_FRAMES;
    a.transforms = transforms[0][0];
    a.triangles = triangles;
    a.triangle_count = count;
    c.skin = make_skin(context, &a);
    free(rest);
    free(weights);
    free(bones);
    free(triangles);
    return c;
}

void free_case(simplify_case *c)
{
    sph_skin_destroy(c->skin);
    free(c->attributes);
    free(c->normals);
}

sph_skin_arrays arrays_of(const sph_skin *skin)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    ck_assert_int_eq(sph_skin_get_arrays(skin, &a), SPH_OK);
    return a;
}

sph_progressive *simplify(const sph_skin *skin, const sph_simplify_options *options)
{
    sph_progressive *p = NULL;
    ck_assert_int_eq(sph_progressive_create(skin, options, &p), SPH_OK);
    return p;
}

sph_skin *level_of(const sph_progressive *p, uint32_t level)
{
    sph_skin *skin = NULL;
    ck_assert_int_eq(sph_progressive_get_skin(p, level, &skin), SPH_OK);
    return skin;
}

sph_progressive_level figures_of(const sph_progressive *p, uint32_t level)
{
    sph_progressive_level l = {.struct_size = sizeof l};
    ck_assert_int_eq(sph_progressive_get_level(p, level, &l), SPH_OK);
    return l;
}
