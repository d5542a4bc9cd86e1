/* SPDX-License-Identifier: MIT */
/* Where joints are: hinges found in closed form, and bones that leave their joint open. */
#include <math.h>
#include <string.h>

#include "runner.h"
#include "skeleton_case.h"

static void middle_of_pivots(double middle[3])
{
    for (int k = 0; k < 3; ++k)
        middle[k] = (pivots[0][k] + pivots[1][k]) / 2;
}

static double distance(const double a[3], const double b[3])
{
    double squared = 0;
    for (int k = 0; k < 3; ++k)
        squared += pow(a[k] - b[k], 2);
    return sqrt(squared);
}

START_TEST(a_ball_joint_is_where_both_bones_turn)
{
    static const double POINT[3] = {0.3, -0.2, 0.4};
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = radii[1] = 1; /* within reach */
    hinge(0, 1, POINT, NULL, _i == 0 ? 1.5 : 0.01);
    skeleton = make_rooted(0, &a);
    check_point(a.positions + 3, POINT, _i == 0 ? 1e-12 : 1e-9);
    check_point(a.positions, pivots[0], 0);
    ck_assert_uint_eq(a.parents[1], 0);
    ck_assert_uint_eq(a.parents[0], SPH_NO_JOINT);
    ck_assert_double_le(a.gaps[1], 1e-12);
    /* In the frame of its parent the joint only turns: its place there is that at rest. */
    for (int f = 0; f < FRAMES; ++f) {
        double locals[24];
        ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed + (size_t)24 * (unsigned)f, locals), SPH_OK);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(locals[12 + 4 * k + 3], a.rest[12 + 4 * k + 3], 1e-11);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(a_hinge_s_joint_is_on_its_axis_nearest_to_where_the_spheres_meet)
{
    static const double POINT[3] = {0.3, 0.1, 0.4}, AXIS[3] = {0.6, 0, 0.8};
    double meeting[3], along = 0, expected[3];
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = 0.1;
    radii[1] = 0.3;
    for (int k = 0; k < 3; ++k)
        meeting[k] = pivots[0][k] + 0.25 * (pivots[1][k] - pivots[0][k]);
    for (int k = 0; k < 3; ++k)
        along += AXIS[k] * (meeting[k] - POINT[k]);
    for (int k = 0; k < 3; ++k)
        expected[k] = POINT[k] + along * AXIS[k];
    hinge(0, 1, POINT, AXIS, 1);
    skeleton = make_rooted(1, &a);
    check_point(a.positions, expected, 1e-10);
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(bones_that_move_as_one_meet_where_their_spheres_do)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    double middle[3];
    middle_of_pivots(middle);
    for (int f = 0; f < FRAMES; ++f)
        memcpy(transforms[f][1], transforms[f][0], sizeof transforms[f][0]);
    skeleton = make_rooted(0, &a);
    check_point(a.positions + 3, middle, 1e-15);
    ck_assert_double_le(a.gaps[1], 0);
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* Without a weight against it, such noise throws the joint far off: the turn is 0.002, the noise 0.003. */
START_TEST(noise_of_bones_that_hardly_turn_does_not_throw_their_joint_off)
{
    static const double POINT[3] = {0.1, 0.1, 0.1};
    double middle[3];
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    hinge(0, 1, POINT, NULL, 0.002);
    for (int f = 0; f < FRAMES; ++f)
        for (int r = 0; r < 3; ++r)
            transforms[f][1][4 * r + 3] += uniform(-0.003, 0.003);
    middle_of_pivots(middle);
    skeleton = make_rooted(0, &a);
    ck_assert_double_le(distance(a.positions + 3, middle), 0.5 * distance(pivots[1], pivots[0]));
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(a_joint_is_no_farther_off_than_the_spheres_reach)
{
    static const double FAR[3] = {500, -200, 300};
    double middle[3];
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = radii[1] = 0.25;
    hinge(0, 1, FAR, NULL, 1);
    middle_of_pivots(middle);
    skeleton = make_rooted(0, &a);
    ck_assert_double_eq_tol(distance(a.positions + 3, middle), distance(pivots[1], pivots[0]) + 0.5, 1e-9);
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* The joint's gap is the least that any place near it has: compared with places all around it. */
START_TEST(no_place_beside_a_joint_is_moved_more_alike)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = radii[1] = 100; /* within reach */
    skeleton = make_rooted(0, &a);
    for (int n = 0; n < 200; ++n) {
        double sum = 0, p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = a.positions[3 + k] + (n == 0 ? 0 : uniform(-0.1, 0.1));
        for (int f = 0; f < FRAMES; ++f)
            for (int r = 0; r < 3; ++r) {
                double d = 0;
                for (int c = 0; c < 4; ++c)
                    d += (transforms[f][0][4 * r + c] - transforms[f][1][4 * r + c]) * (c == 3 ? 1 : p[c]);
                sum += d * d / FRAMES;
            }
        if (n == 0)
            ck_assert_double_eq_tol(sqrt(sum), a.gaps[1], 1e-12);
        else /* the weight of the meeting place costs a little */
            ck_assert_double_ge(sqrt(sum), 0.8 * a.gaps[1]);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skeleton joints");
    TCase *tc = tcase_create("joints");
    tcase_add_checked_fixture(tc, setup_skeleton, teardown);
    tcase_add_loop_test(tc, a_ball_joint_is_where_both_bones_turn, 0, 2);
    tcase_add_test(tc, a_hinge_s_joint_is_on_its_axis_nearest_to_where_the_spheres_meet);
    tcase_add_test(tc, bones_that_move_as_one_meet_where_their_spheres_do);
    tcase_add_test(tc, noise_of_bones_that_hardly_turn_does_not_throw_their_joint_off);
    tcase_add_test(tc, a_joint_is_no_farther_off_than_the_spheres_reach);
    tcase_add_test(tc, no_place_beside_a_joint_is_moved_more_alike);
    return run_suite(suite, tc);
}
