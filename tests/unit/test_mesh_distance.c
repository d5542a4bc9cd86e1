/* SPDX-License-Identifier: MIT */
/* Distances from points to the triangles of a frame, against all triangles one by one, and against CGAL. */
#include <check.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "animation/animation.h"
#include "measure/mesh.h"
#include "numeric/vector.h"
#include "runner.h"
#include "support.h"

#ifdef HAVE_CGAL
#include "cgal_shim.h"
#endif

enum { POINTS = 400 };

static sph_context *context;
static sph_animation *animation;
static sph__mesh mesh;
static uint64_t state;

static void setup(void)
{
    context = test_context();
    animation = NULL;
    mesh = (sph__mesh){0};
    state = 1;
}

static void teardown(void)
{
    sph__mesh_free(&mesh);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
}

/* Frame 1 is measured with the tree of frame 0. */
static void load(int which)
{
    switch (which) {
    case 0:
        animation = test_sphere(context, 4, 2);
        break;
    case 1:
        animation = test_soup(context, 500, 700, 2, 3);
        break;
    case 2:
        animation = test_grid(context, 30, 1, 2);
        break;
    case 3:
        animation = test_cube(context, 2);
        break;
    default:
        animation = test_soup(context, 3, 1, 2, 9);
        break;
    }
    ck_assert_int_eq(
        sph__mesh_init(&mesh, context, animation->vertex_count, animation->triangles, animation->triangle_count),
        SPH_OK);
    ck_assert_int_eq(sph_animation_read_frame(animation, 0, mesh.xyz), SPH_OK);
    sph__mesh_build(&mesh);
    ck_assert_int_eq(sph_animation_read_frame(animation, 1, mesh.xyz), SPH_OK);
    sph__mesh_refit(&mesh);
}

static void random_point(double x[3])
{
    const double scale = test_random_unit(&state) < 0.5 ? 1.2 : 4;
    for (int k = 0; k < 3; ++k)
        x[k] = scale * (2 * test_random_unit(&state) - 1);
}

static void corner(uint32_t triangle, uint32_t k, double x[3])
{
    const float *v = &mesh.xyz[3 * (size_t)mesh.triangles[3 * (size_t)triangle + k]];
    for (int l = 0; l < 3; ++l)
        x[l] = v[l];
}

/* The nearest of the three weights, by halving: squared distance to a triangle is convex in them. */
static double distance_to_triangle(const double x[3], uint32_t triangle)
{
    double a[3], b[3], c[3], best = DBL_MAX, at1 = 0.5, at2 = 0.5;
    corner(triangle, 0, a);
    corner(triangle, 1, b);
    corner(triangle, 2, c);
    for (double width = 0.5; width > 1e-8; width *= 0.85) {
        const double from1 = at1, from2 = at2;
        for (int i = -3; i <= 3; ++i)
            for (int j = -3; j <= 3; ++j) {
                const double b1 = fmax(0, fmin(1, from1 + width * i / 3));
                const double b2 = fmax(0, fmin(1 - b1, from2 + width * j / 3));
                double p[3], d;
                for (int k = 0; k < 3; ++k)
                    p[k] = (1 - b1 - b2) * a[k] + b1 * b[k] + b2 * c[k];
                d = sph__distance(x, p);
                if (d >= best) continue;
                best = d;
                at1 = b1;
                at2 = b2;
            }
    }
    return best;
}

START_TEST(distance_is_the_least_over_all_triangles)
{
    uint32_t guess = 0;
    load(_i);
    for (int i = 0; i < 25; ++i) {
        double x[3], best = DBL_MAX;
        random_point(x);
        for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
            double center[3], reach = 0, v[3];
            for (int k = 0; k < 3; ++k)
                center[k] = 0;
            for (uint32_t k = 0; k < 3; ++k) {
                corner(t, k, v);
                sph__add_scaled(center, 1.0 / 3, v, center);
            }
            for (uint32_t k = 0; k < 3; ++k) {
                corner(t, k, v);
                reach = fmax(reach, sph__distance(v, center));
            }
            if (sph__distance(x, center) - reach > best) continue;
            best = fmin(best, distance_to_triangle(x, t));
        }
        ck_assert_double_eq_tol(sph__mesh_distance(&mesh, x, &guess), best, 1e-5);
        ck_assert_double_le(sph__mesh_distance(&mesh, x, &guess), best + 1e-12);
    }
}
END_TEST

START_TEST(the_guess_changes_nothing)
{
    load(_i);
    for (int i = 0; i < 50; ++i) {
        double x[3], first;
        uint32_t guess = 0;
        random_point(x);
        first = sph__mesh_distance(&mesh, x, &guess);
        guess = mesh.triangle_count - 1;
        ck_assert_double_eq(sph__mesh_distance(&mesh, x, &guess), first);
    }
}
END_TEST

#ifdef HAVE_CGAL
START_TEST(distance_agrees_with_cgal)
{
    double points[3 * POINTS], expected[POINTS];
    uint32_t guess = 0;
    load(_i);
    for (int i = 0; i < POINTS; ++i)
        random_point(points + 3 * i);
    cgal_distances(mesh.xyz, mesh.triangles, mesh.triangle_count, points, POINTS, expected);
    for (int i = 0; i < POINTS; ++i)
        ck_assert_double_eq_tol(sph__mesh_distance(&mesh, points + 3 * i, &guess), expected[i], 1e-12);
}
END_TEST
#endif

START_TEST(points_lie_on_their_triangles_and_are_as_many_as_their_area_asks)
{
    enum { COUNT = 2000 };
    const double shift[2] = {0.25, 0.5};
    double *counts, worst = 0;
    uint32_t cursor = 0;
    load(_i);
    counts = test_malloc(mesh.triangle_count, sizeof *counts);
    for (uint32_t i = 0; i < mesh.triangle_count; ++i)
        counts[i] = 0;
    for (uint32_t i = 0; i < COUNT; ++i) {
        sph__mesh_point p;
        sph__mesh_sample(&mesh, i, COUNT, shift, &cursor, &p);
        ck_assert_uint_lt(p.triangle, mesh.triangle_count);
        ck_assert_double_lt(distance_to_triangle(p.position, p.triangle), 1e-5);
        ++counts[p.triangle];
    }
    for (uint32_t i = 0; i < mesh.triangle_count; ++i) {
        const double area = mesh.cumulative[i] - (i == 0 ? 0 : mesh.cumulative[i - 1]);
        worst = fmax(worst, fabs(counts[i] - area / mesh.area * COUNT));
    }
    ck_assert_double_le(worst, 1 + 1e-6); /* as near as whole numbers come */
    free(counts);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("mesh distance");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, distance_is_the_least_over_all_triangles, 0, 5);
    tcase_add_loop_test(tc, the_guess_changes_nothing, 0, 5);
#ifdef HAVE_CGAL
    tcase_add_loop_test(tc, distance_agrees_with_cgal, 0, 5);
#endif
    tcase_add_loop_test(tc, points_lie_on_their_triangles_and_are_as_many_as_their_area_asks, 0, 5);
    return run_suite(suite, tc);
}
