/* SPDX-License-Identifier: MIT */
/* Levels that grow until they contain every vertex. */
#include <math.h>

#include "coverage_case.h"
#include "hierarchy_case.h"
#include "runner.h"

START_TEST(a_ball_grows_to_its_farthest_vertex)
{
    static const float xyz[] = {0, 0, 1.5f, 0.3f, 0, 0, 0, -1.25f, 0};
    const test_solid ball = {.sphere_count = 1, .radii = {1}};
    sph_animation *animation = points(context, xyz, 3, 1);
    sph_level *level = test_solid_level(context, &ball), *inflated;
    for (int i = 0; i < 2; ++i) {
        const double margin = 0.1 * i;
        sph_inflation n;
        float r;
        inflated = inflate(animation, level, margin, &n);
        r = arrays_of(inflated).radii[0];
        ck_assert_double_ge(r, 1.5 + margin);
        ck_assert_double_le(r, 1.5002 + margin);
        ck_assert_uint_eq(n.grown_count, 1);
        ck_assert_double_eq_tol(n.max_growth, r - 1.0, 1e-12);
        ck_assert_double_eq_tol(n.mean_growth, r - 1.0, 1e-12);
        ck_assert_double_eq_tol(n.volume_before, 4 * M_PI / 3, 0.1);
        ck_assert_double_eq_tol(n.volume_after, 4 * M_PI / 3 * pow(r, 3), 0.2);
        sph_level_destroy(inflated);
    }
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

/* Only what is concerned grows, and by equal parts where a vertex is over the middle. */
START_TEST(growth_is_least_and_local)
{
    static const float xyz[] = {1, 0, 0.7f, 9, 0, 0.4f};
    const test_solid chain = {.sphere_count = 4,
                              .centers = {{0, 0, 0}, {2, 0, 0}, {8, 0, 0}, {10, 0, 0}},
                              .radii = {0.5f, 0.5f, 0.5f, 0.5f},
                              .edge_count = 2,
                              .edges = {{0, 1}, {2, 3}}};
    sph_animation *animation = points(context, xyz, 2, 1);
    sph_level *level = test_solid_level(context, &chain);
    sph_inflation n;
    sph_level *inflated = inflate(animation, level, 0, &n);
    const float *r = arrays_of(inflated).radii;
    ck_assert_double_eq_tol(r[0], 0.7, 5e-4);
    ck_assert_double_eq_tol(r[1], 0.7, 5e-4);
    ck_assert_float_eq(r[2], 0.5f);
    ck_assert_float_eq(r[3], 0.5f);
    ck_assert_uint_eq(n.grown_count, 2);
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

static void check_contains(const sph_level *level, const test_solid *original, const float *xyz, double margin)
{
    const sph_level_arrays a = arrays_of(level);
    for (size_t f = 0; f < a.frame_count; ++f) {
        test_solid s = *original;
        for (size_t i = 0; i < s.sphere_count; ++i) {
            s.radii[i] = a.radii[i + (a.radii_per_frame ? f * s.sphere_count : 0)];
            ck_assert_float_ge(s.radii[i], original->radii[i]);
        }
        for (size_t i = 0; i < POINTS; ++i) {
            const float *p = xyz + 3 * (f * POINTS + i);
            const double x[3] = {p[0], p[1], p[2]};
            ck_assert_double_le(test_solid_distance(&s, x), 1e-8 - margin);
        }
    }
}

START_TEST(inflated_levels_contain_every_vertex_by_brute_force)
{
    const uint32_t per_frame = _i % 2;
    const double margin = _i % 3 == 0 ? 0.01 : 0;
    uint64_t state = 50 + (uint64_t)_i;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    sph_animation *animation;
    sph_level *level = still_level(context, &s, FRAMES, per_frame), *inflated;
    sph_inflation n;
    sph_coverage before;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(context, xyz, POINTS, FRAMES);
    before = measure(animation, level);
    inflated = inflate(animation, level, margin, &n);
    check_contains(inflated, &s, xyz, margin);
    ck_assert_uint_eq(measure(animation, inflated).uncovered_count, 0);
    ck_assert_double_eq(measure(animation, inflated).distance, 0);
    ck_assert_uint_eq(arrays_of(inflated).radii_per_frame, per_frame);
    ck_assert_mem_eq(arrays_of(inflated).centers, arrays_of(level).centers, 12 * (size_t)FRAMES * s.sphere_count);
    ck_assert_mem_eq(arrays_of(inflated).triangles, arrays_of(level).triangles, 12 * (size_t)s.triangle_count);
    /* growing all radii by the uncovered distance would do too: this must be less in sum */
    ck_assert_double_le(n.mean_growth, before.distance + margin + 1e-3);
    ck_assert_double_ge(n.max_growth, 0);
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(without_rounds_it_still_contains_every_vertex)
{
    uint64_t state = 99;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    sph_inflation_options o;
    sph_animation *animation;
    sph_level *level = still_level(context, &s, FRAMES, 0), *inflated = NULL, *least;
    sph_inflation quick = {.struct_size = sizeof quick}, slow;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(context, xyz, POINTS, FRAMES);
    sph_inflation_options_init(&o, sizeof o);
    o.rounds = 0;
    ck_assert_int_eq(sph_coverage_inflate(animation, level, &o, &quick, &inflated), SPH_OK);
    check_contains(inflated, &s, xyz, 0);
    least = inflate(animation, level, 0, &slow);
    ck_assert_double_lt(slow.mean_growth, quick.mean_growth);
    sph_level_destroy(least);
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("coverage inflation");
    TCase *tc = tcase_create("inflation");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, a_ball_grows_to_its_farthest_vertex);
    tcase_add_test(tc, growth_is_least_and_local);
    tcase_add_loop_test(tc, inflated_levels_contain_every_vertex_by_brute_force, 0, 8);
    tcase_add_test(tc, without_rounds_it_still_contains_every_vertex);
    return run_suite(suite, tc);
}
