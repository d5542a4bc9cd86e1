/* SPDX-License-Identifier: MIT */
/* Numbers that are none, and the largest and smallest there are. */
#include <check.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "runner.h"
#include "solid.h"
#include "support.h"

static const test_solid BALL = {.sphere_count = 1, .centers = {{0, 0, 0}}, .radii = {1}};

static sph_context *context;
static uint64_t state;

static void setup(void)
{
    context = test_context();
    state = 20160301;
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(test_random(&state) % count);
}

START_TEST(sweeps_that_are_not_finite_are_refused_and_named)
{
    const float bad[3] = {NAN, INFINITY, -INFINITY};
    sph_level *level = test_solid_level(context, &BALL);
    sph_query *q;
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    for (int i = 0; i < 42; ++i) {
        const size_t count = i < 21 ? 3 : 20; /* many are looked at together */
        sph_sweep sweeps[20] = {{{0}}};
        sph_hit hits[20];
        uint8_t any[20] = {7};
        hits[0].s = 7;
        if (i % 7 < 3)
            sweeps[2].from[i % 7] = bad[i / 7 % 3];
        else if (i % 7 < 6)
            sweeps[2].to[i % 7 - 3] = bad[i / 7 % 3];
        else
            sweeps[2].radius = bad[i / 7 % 3];
        ck_assert_int_eq(sph_query_cast(q, sweeps, count, hits), SPH_E_INVALID);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "sweep 2"));
        ck_assert_int_eq(sph_query_cast_any(q, sweeps, count, any), SPH_E_INVALID);
        ck_assert_double_eq(hits[0].s, 7);
        ck_assert_uint_eq(any[0], 7);
    }
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_radius_below_0_is_refused_but_not_minus_0)
{
    sph_level *level = test_solid_level(context, &BALL);
    sph_query *q;
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    for (size_t count = 1; count < 20; ++count) {
        sph_sweep sweeps[20] = {{{0}}};
        sph_hit hits[20];
        sweeps[count - 1].radius = -0.0f;
        sweeps[count - 1].from[0] = -3;
        ck_assert_int_eq(sph_query_cast(q, sweeps, count, hits), SPH_OK);
        ck_assert_double_eq_tol(hits[count - 1].s, 2.0 / 3, 1e-7);
        sweeps[count - 1].radius = -1e-45f;
        ck_assert_int_eq(sph_query_cast(q, sweeps, count, hits), SPH_E_INVALID);
    }
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

START_TEST(numbers_as_large_and_as_small_as_floats_get_do_no_harm)
{
    static const float VALUES[] = {0, FLT_MAX, -FLT_MAX, FLT_MIN, 1e-45f, -1e-45f, 1, -1, 1e20f};
    for (int turn = 0; turn < 3000; ++turn) {
        test_solid s = {.sphere_count = 3, .triangle_count = 1, .triangles = {{0, 1, 2}}};
        const float point[3] = {VALUES[below(9)], VALUES[below(9)], VALUES[below(9)]};
        sph_sweep sweep = {.radius = fabsf(VALUES[below(9)])}, same[8];
        sph_level *level;
        sph_query *q;
        sph_hit hit, hits[8];
        sph_nearest nearest;
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k)
                s.centers[i][k] = VALUES[below(9)];
            s.radii[i] = fabsf(VALUES[below(9)]);
            sweep.from[i] = VALUES[below(9)];
            sweep.to[i] = VALUES[below(9)];
        }
        level = test_solid_level(context, &s);
        ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
        ck_assert_int_eq(sph_query_cast(q, &sweep, 1, &hit), SPH_OK);
        ck_assert(hit.s >= 0 && hit.s <= 1 && hit.depth >= 0 && isfinite(hit.contact.point[0]));
        for (int i = 0; i < 8; ++i)
            same[i] = sweep;
        ck_assert_int_eq(sph_query_cast(q, same, 8, hits), SPH_OK);
        ck_assert_mem_eq(&hits[turn % 8], &hit, sizeof hit);
        ck_assert_int_eq(sph_query_nearest(q, point, 0, 1, &nearest), SPH_OK);
        ck_assert(isfinite(nearest.distance) && isfinite(nearest.contact.point[0]));
        sph_query_destroy(q);
        sph_level_destroy(level);
    }
}
END_TEST

START_TEST(points_that_are_not_finite_are_refused_and_named)
{
    static const float BAD[3] = {NAN, INFINITY, -INFINITY};
    sph_level *level = test_solid_level(context, &BALL);
    sph_query *q;
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    for (int i = 0; i < 9; ++i) {
        float points[3][3] = {{0}};
        sph_nearest nearest[3];
        uint8_t inside[3] = {7, 7, 7};
        nearest[0].distance = 7;
        points[2][i % 3] = BAD[i / 3];
        ck_assert_int_eq(sph_query_nearest(q, points[0], 0, 3, nearest), SPH_E_INVALID);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "point 2"));
        ck_assert_int_eq(sph_query_contains(q, points[0], 0, 3, SPH_CAVITY_SOLID, inside), SPH_E_INVALID);
        ck_assert_double_eq(nearest[0].distance, 7);
        ck_assert_uint_eq(inside[0], 7);
    }
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("query_limits");
    TCase *tc = tcase_create("query_limits");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, sweeps_that_are_not_finite_are_refused_and_named);
    tcase_add_test(tc, a_radius_below_0_is_refused_but_not_minus_0);
    tcase_add_test(tc, points_that_are_not_finite_are_refused_and_named);
    tcase_add_test(tc, numbers_as_large_and_as_small_as_floats_get_do_no_harm);
    return run_suite(s, tc);
}
