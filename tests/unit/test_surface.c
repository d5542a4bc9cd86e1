/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_check.h"
#include "runner.h"
#include "support.h"
#include "surface_shapes.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static const uint32_t RESOLUTIONS[] = {5, 16, 48};

START_TEST(shapes_have_closed_manifold_surfaces_of_their_topology)
{
    shape s;
    make_shape(_i, &s);
    for (int i = 0; i < 3; ++i) {
        sph_surface *surface = extract(context, &s, RESOLUTIONS[i]);
        const mesh_facts f = check_surface(surface, 0);
        ck_assert_double_gt(f.volume, 0);
        if (RESOLUTIONS[i] > 10) { /* coarser ones may close holes */
            ck_assert_msg(f.euler == EXPECTED[_i].euler, "%s at %u: Euler characteristic %d", EXPECTED[_i].name,
                          (unsigned)RESOLUTIONS[i], f.euler);
            ck_assert_msg(f.parts == EXPECTED[_i].parts, "%s at %u: %d parts", EXPECTED[_i].name,
                          (unsigned)RESOLUTIONS[i], f.parts);
        }
        sph_surface_destroy(surface);
    }
}
END_TEST

START_TEST(vertices_are_on_the_surface_and_triangles_near_it)
{
    shape s;
    sph_surface *surface;
    const float *xyz, *normals;
    const uint32_t *t;
    double cell;
    size_t step;
    make_shape(_i, &s);
    surface = extract(context, &s, 24);
    xyz = sph_surface_positions(surface, 0);
    normals = sph_surface_normals(surface, 0);
    t = sph_surface_triangles(surface, 0);
    cell = sph_surface_cell(surface);
    step = sph_surface_vertex_count(surface, 0) / 60 + 1;
    for (size_t i = 0; i < sph_surface_vertex_count(surface, 0); i += step) {
        double x[3], up[3], d;
        for (size_t k = 0; k < 3; ++k)
            x[k] = xyz[3 * i + k];
        d = brute_distance(&s, x, SPH_SURFACE_LEAST_RADIUS * cell);
        /* rounding to float, and the share of an edge that vertices stay off its ends */
        ck_assert_msg(fabs(d) < 3e-4 * cell + 3e-7 * (fabs(x[0]) + fabs(x[1]) + fabs(x[2])),
                      "%s: vertex %zu is %g cells off", EXPECTED[_i].name, i, d / cell);
        for (size_t k = 0; k < 3; ++k)
            up[k] = x[k] + 0.01 * cell * normals[3 * i + k];
        ck_assert_double_gt(brute_distance(&s, up, SPH_SURFACE_LEAST_RADIUS * cell),
                            -1e-3 * cell - 1e-6); /* at creases; and floats */
    }
    step = sph_surface_triangle_count(surface, 0) / 60 + 1;
    for (size_t i = 0; i < sph_surface_triangle_count(surface, 0); i += step) {
        double x[3];
        for (size_t k = 0; k < 3; ++k)
            x[k] = ((double)xyz[3 * t[3 * i] + k] + xyz[3 * t[3 * i + 1] + k] + xyz[3 * t[3 * i + 2] + k]) / 3;
        ck_assert_double_lt(fabs(brute_distance(&s, x, SPH_SURFACE_LEAST_RADIUS * cell)), 0.4 * cell);
    }
    sph_surface_destroy(surface);
}
END_TEST

START_TEST(area_and_volume_of_a_sphere_and_a_capsule_converge)
{
    /* a cylinder of radius 0.5 and length 1 with two half spheres */
    const double area[2] = {4 * M_PI, 2 * M_PI}, volume[2] = {4 * M_PI / 3, M_PI / 4 + M_PI / 6};
    double last_area = 1, last_volume = 1;
    shape s = {0};
    if (_i == 0)
        make_shape(SPHERE, &s);
    else
        add_edge(&s, add_sphere(&s, 0.1, 0.2, 0.3, 0.5), add_sphere(&s, 1.1, 0.2, 0.3, 0.5));
    for (uint32_t n = 10; n <= 80; n *= 2) {
        sph_surface *surface = extract(context, &s, n);
        const mesh_facts f = check_surface(surface, 0);
        const double da = fabs(f.area - area[_i]) / area[_i], dv = fabs(f.volume - volume[_i]) / volume[_i];
        if (n > 10) { /* of second order */
            ck_assert_double_lt(da, last_area / 3);
            ck_assert_double_lt(dv, last_volume / 3);
        }
        ck_assert_double_lt(da, 6.0 / n / n);
        ck_assert_double_lt(dv, 8.0 / n / n);
        last_area = da;
        last_volume = dv;
        sph_surface_destroy(surface);
    }
}
END_TEST

START_TEST(sheets_of_no_thickness_are_meshed_on_both_sides)
{
    shape s;
    sph_surface *surface;
    mesh_facts f;
    double r;
    make_shape(FLAT, &s);
    surface = extract(context, &s, 60);
    f = check_surface(surface, 0);
    r = SPH_SURFACE_LEAST_RADIUS * sph_surface_cell(surface);
    /* a slab of 2 x 2 with a round rim */
    ck_assert_double_eq_tol(f.volume, 8 * r + 4 * M_PI * r * r, 0.05 * f.volume);
    ck_assert_double_eq_tol(f.area, 8 + 8 * M_PI * r, 0.05 * f.area);
    sph_surface_destroy(surface);
}
END_TEST

START_TEST(cavities_are_no_part_of_the_surface)
{
    static const double radii[] = {0.15, 0, 0.1};
    shape s;
    sph_surface *surface;
    mesh_facts f;
    double r, nearest = 1e300;
    make_shape(SHELL + _i, &s);
    surface = extract(context, &s, 40);
    f = check_surface(surface, 0);
    r = fmax(radii[_i], SPH_SURFACE_LEAST_RADIUS * sph_surface_cell(surface));
    /* a filled cube of side 2 and r around it: faces, edges, corners */
    ck_assert_double_eq_tol(f.volume, 8 + 24 * r + 6 * M_PI * r * r + 4 * M_PI / 3 * r * r * r, 0.01 * f.volume);
    for (size_t i = 0; i < 3 * (size_t)sph_surface_vertex_count(surface, 0); i += 3) {
        const float *x = sph_surface_positions(surface, 0) + i;
        nearest = fmin(nearest, fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2]))));
    }
    ck_assert_double_gt(nearest, 1 + 0.5 * r); /* corners are round */
    sph_surface_destroy(surface);
    make_shape(CUP, &s);
    surface = extract(context, &s, 40);
    ck_assert_double_lt(check_surface(surface, 0).volume, 2); /* but an open one holds no water */
    sph_surface_destroy(surface);
}
END_TEST

START_TEST(surfaces_of_random_levels_separate_inside_from_outside)
{
    uint64_t state = 100 + (uint64_t)_i;
    shape s;
    sph_surface *surface;
    double cell;
    random_shape(&state, &s);
    surface = extract(context, &s, 20);
    check_surface(surface, 0);
    cell = sph_surface_cell(surface);
    for (int i = 0; i < 60; ++i) {
        double x[3], d, turns;
        for (int k = 0; k < 3; ++k)
            x[k] = 1.6 * test_random_unit(&state) - 0.3;
        d = brute_distance(&s, x, SPH_SURFACE_LEAST_RADIUS * cell);
        if (fabs(d) < 0.5 * cell) continue;
        turns = winding_number(surface, 0, x);
        ck_assert_double_eq_tol(turns, round(turns), 1e-6);
        if (d < 0) {
            ck_assert_double_eq_tol(turns, 1, 1e-6);
        } else if (d > 0.25) { /* too far for a gap or a cavity of these */
            ck_assert_double_eq_tol(turns, 0, 1e-6);
        }
    }
    sph_surface_destroy(surface);
}
END_TEST

/* Sizes and places at which floats still have something to say. */
START_TEST(tiny_huge_and_far_levels_are_extracted)
{
    static const double SCALES[][2] = {{1e-30, 0}, {1e30, 0}, {1, 1e4}, {1e-3, 1e6}, {0, 1e20}, {0, 0}};
    shape s;
    sph_surface *surface;
    mesh_facts f;
    make_shape(STAR, &s);
    for (uint32_t i = 0; i < s.spheres; ++i) {
        for (uint32_t k = 0; k < 3; ++k)
            s.centers[3 * i + k] = (float)(s.centers[3 * i + k] * SCALES[_i][0] + SCALES[_i][1]);
        s.radii[i] = (float)(s.radii[i] * SCALES[_i][0]);
    }
    surface = extract(context, &s, 30);
    f = check_surface(surface, 0);
    ck_assert_int_eq(f.euler, 2);
    ck_assert_int_eq(f.parts, 1);
    sph_surface_destroy(surface);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("surface");
    TCase *shapes = tcase_create("shapes"), *distances = tcase_create("distances");
    tcase_add_checked_fixture(shapes, setup, teardown);
    tcase_add_loop_test(shapes, shapes_have_closed_manifold_surfaces_of_their_topology, 0, SHAPES);
    tcase_add_loop_test(shapes, area_and_volume_of_a_sphere_and_a_capsule_converge, 0, 2);
    tcase_add_test(shapes, sheets_of_no_thickness_are_meshed_on_both_sides);
    tcase_add_loop_test(shapes, cavities_are_no_part_of_the_surface, 0, 3);
    tcase_add_loop_test(shapes, tiny_huge_and_far_levels_are_extracted, 0, 6);
    suite_add_tcase(suite, shapes);
    tcase_add_checked_fixture(distances, setup, teardown);
    tcase_add_loop_test(distances, vertices_are_on_the_surface_and_triangles_near_it, 0, SHAPES);
    tcase_add_loop_test(distances, surfaces_of_random_levels_separate_inside_from_outside, 0, 20);
    suite_add_tcase(suite, distances);
    return run_all(suite);
}
