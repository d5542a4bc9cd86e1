/* SPDX-License-Identifier: MIT */
/* Sums of angles, which come of products of vectors, against the sum of what atan2 gives for each. */
#include <check.h>
#include <math.h>

#include "hierarchy/caps.h"
#include "runner.h"
#include "support.h"

/* What the series of the arc tangent is precise to, and rounding. */
static const double PRECISION = 2e-9;

/* A sum whose lanes are alike. */
static void start(sph__turn *turn)
{
    sph__turn_start(turn);
}

static void add(sph__turn *turn, double x, double y)
{
    const sph__v8d zero = {0}, c = zero + x, s = zero + y;
    sph__v8d size;
    sph__turn_by(&c, &s, turn);
    sph__bring_near_one(&turn->x, &turn->y, &size);
}

static double angle_of(const sph__turn *turn)
{
    sph__v8d angle;
    sph__turn_angle(turn, &angle);
    for (size_t l = 1; l < SPH__LANES; ++l) ck_assert_double_eq(angle[l], angle[0]);
    return angle[0];
}

START_TEST(sums_of_angles_are_those_of_the_arc_tangent)
{
    uint64_t state = (uint64_t)_i + 1;
    sph__turn turn;
    double sum = 0;
    start(&turn);
    for (unsigned i = 0; i < 40; ++i) {
        const double size = pow(10, 200 * test_random_unit(&state) - 100), share = pow(test_random_unit(&state), 1 + _i % 3);
        const double angle = M_PI * (_i % 2 == 0 ? share : 1 - share), x = size * cos(angle), y = size * fabs(sin(angle));
        sum += atan2(y, x);
        add(&turn, x, y);
        ck_assert_double_eq_tol(angle_of(&turn), sum, PRECISION + 1e-15 * i);
    }
}
END_TEST

START_TEST(straight_and_right_angles_are_counted_and_no_angle_is_none)
{
    static const double VECTORS[][2] = {{-1, 0}, {1, 0}, {-3, 0}, {0, 2}, {0, 0}, {0, 1e-300}, {-1, 0}, {-0.0, 0}, {5, -0.0}};
    enum { COUNT = sizeof VECTORS / sizeof *VECTORS };
    sph__turn turn;
    double sum = 0;
    start(&turn);
    ck_assert_double_eq(angle_of(&turn), 0);
    for (unsigned i = 0; i < 3 * COUNT; ++i) {
        const double x = VECTORS[(i * (unsigned)(_i + 1)) % COUNT][0], y = VECTORS[(i * (unsigned)(_i + 1)) % COUNT][1];
        if (x > 0 || x < 0 || y > 0) sum += atan2(fabs(y), x);
        add(&turn, x, y);
        ck_assert_double_eq_tol(angle_of(&turn), sum, PRECISION);
    }
}
END_TEST

START_TEST(a_thousand_slivers_add_up)
{
    sph__turn turn;
    start(&turn);
    for (unsigned i = 0; i < 1000; ++i) add(&turn, cos(0.3), sin(0.3));
    ck_assert_double_eq_tol(angle_of(&turn), 300, 1e-8);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("caps");
    TCase *tc = tcase_create("caps");
    tcase_add_loop_test(tc, sums_of_angles_are_those_of_the_arc_tangent, 0, 200);
    tcase_add_loop_test(tc, straight_and_right_angles_are_counted_and_no_angle_is_none, 0, 8);
    tcase_add_test(tc, a_thousand_slivers_add_up);
    return run_suite(suite, tc);
}
