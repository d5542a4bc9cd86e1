/* SPDX-License-Identifier: MIT */
/* The largest distance of vertices that a level leaves uncovered. */
#include <math.h>

#include "coverage_case.h"
#include "hierarchy_case.h"
#include "runner.h"

/* Points, and how far they are outside. */
static const float OUTSIDE[3][3][4] = {{{1, 2, 5, 1.5f}, {2, 2, 3, 0.5f}, {1, 2, 3.25f, 0}},
                                       {{1, 2, 0, 1.5f}, {-1, 0, 0, 0.5f}, {1.5f, 0.25f, 0, 0}},
                                       {{0.5f, 0.5f, 2, 1.5f}, {0.5f, -1, 0, 0.5f}, {0.5f, 0.5f, -0.4375f, 0}}};

START_TEST(the_uncovered_distance_is_that_of_the_closed_form)
{
    sph_level *level = test_solid_level(context, &SOLIDS[_i]);
    for (int i = 0; i < 3; ++i) {
        const float *p = OUTSIDE[_i][i];
        sph_animation *animation = points(context, p, 1, 1);
        const sph_coverage c = measure(animation, level);
        ck_assert_double_eq_tol(c.distance, p[3], 1e-13);
        ck_assert_uint_eq(c.uncovered_count, p[3] > 0);
        sph_animation_destroy(animation);
    }
    sph_level_destroy(level);
}
END_TEST

START_TEST(the_uncovered_distance_is_that_of_brute_force)
{
    uint64_t state = 1 + (uint64_t)_i;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    double largest = 0;
    uint32_t count = 0, doubtful = 0;
    sph_animation *animation;
    sph_level *level = still_level(context, &s, FRAMES, 0);
    sph_coverage c;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(context, xyz, POINTS, FRAMES);
    c = measure(animation, level);
    for (size_t i = 0; i < POINTS * FRAMES; ++i) {
        const double x[3] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]}, d = test_solid_distance(&s, x);
        if (i == c.frame * POINTS + c.vertex) ck_assert_double_eq_tol(fmax(d, 0), c.distance, 1e-7);
        largest = fmax(largest, d);
        count += d > 1e-7;
        doubtful += fabs(d) <= 1e-7;
    }
    ck_assert_double_eq_tol(c.distance, largest, 1e-7);
    ck_assert_uint_ge(c.uncovered_count, count);
    ck_assert_uint_le(c.uncovered_count, count + doubtful);
    sph_animation_destroy(animation);
    sph_level_destroy(level);
}
END_TEST

/* Spheres of no radius at the vertices contain them, without any tolerance. */
START_TEST(the_finest_level_contains_its_vertices_and_does_not_grow)
{
    sph_animation *animation = test_sphere(context, 2, 4);
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL, *inflated;
    sph_inflation i;
    sph_coverage c;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &hierarchy), SPH_OK);
    ck_assert_int_eq(sph_level_create(hierarchy, sph_animation_vertex_count(animation), &level), SPH_OK);
    c = measure(animation, level);
    ck_assert_double_eq(c.distance, 0);
    ck_assert_uint_eq(c.uncovered_count, 0);
    inflated = inflate(animation, level, 0, &i);
    ck_assert_uint_eq(i.grown_count, 0);
    ck_assert_uint_eq(i.rounds, 1);
    ck_assert_mem_eq(arrays_of(inflated).radii, arrays_of(level).radii,
                     4 * (size_t)sph_animation_vertex_count(animation));
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("coverage");
    TCase *tc = tcase_create("coverage");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, the_uncovered_distance_is_that_of_the_closed_form, 0, 3);
    tcase_add_loop_test(tc, the_uncovered_distance_is_that_of_brute_force, 0, 8);
    tcase_add_test(tc, the_finest_level_contains_its_vertices_and_does_not_grow);
    return run_suite(suite, tc);
}
