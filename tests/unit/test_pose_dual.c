/* SPDX-License-Identifier: MIT */
/* Blends of dual quaternions: the formula as it is published, and what it is for. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "pose_case.h"
#include "runner.h"

static const int32_t METHODS[2] = {SPH_POSE_LINEAR, SPH_POSE_DUAL_QUATERNION};

/* The formula of Kavan et al. 2008, on quaternions as they are written there: w first, the product by its definition.
 */
static void multiply(const double a[4], const double b[4], double out[4])
{
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

typedef struct motion {
    double axis[3], angle, shift[3], dual[2][4];
} motion;

static void fill_dual(motion *m)
{
    const double t[4] = {0, m->shift[0] / 2, m->shift[1] / 2, m->shift[2] / 2};
    m->dual[0][0] = cos(m->angle / 2);
    for (int k = 0; k < 3; ++k)
        m->dual[0][k + 1] = sin(m->angle / 2) * m->axis[k];
    multiply(t, m->dual[0], m->dual[1]);
}

START_TEST(dual_quaternions_are_blended_normalised_and_applied)
{
    motion all[BONES];
    for (int b = 0; b < BONES; ++b) {
        double length = 0;
        for (int k = 0; k < 3; ++k) {
            all[b].axis[k] = uniform(-1, 1);
            all[b].shift[k] = uniform(-1, 1);
            length += all[b].axis[k] * all[b].axis[k];
        }
        for (int k = 0; k < 3; ++k)
            all[b].axis[k] /= sqrt(length);
        all[b].angle = uniform(0, 6.2); /* beyond a half turn: signs of quaternions differ */
        fill_dual(&all[b]);
        make_rigid(all[b].axis, all[b].angle, all[b].shift, transforms[0][b]);
    }
    pose(SPH_POSE_DUAL_QUATERNION, 1);
    for (int v = 0; v < VERTICES; ++v) {
        double sum[2][4] = {{0}}, p[4] = {0, (double)rest[v][0], (double)rest[v][1], (double)rest[v][2]}, length = 0;
        double conjugate[4], half[4], q[4], t[4], out[3];
        int heaviest = 0;
        for (int s = 1; s < SLOTS; ++s) /* the one whose side the others come to */
            if (weights[v][s] > weights[v][heaviest]) heaviest = s;
        for (int s = 0; s < SLOTS; ++s) {
            const motion *m = &all[bones[v][s]], *first = &all[bones[v][heaviest]];
            double dot = 0;
            for (int k = 0; k < 4; ++k)
                dot += m->dual[0][k] * first->dual[0][k];
            for (int k = 0; k < 8; ++k)
                sum[k / 4][k % 4] += (dot < 0 ? -1 : 1) * (double)weights[v][s] * m->dual[k / 4][k % 4];
        }
        for (int k = 0; k < 4; ++k)
            length += sum[0][k] * sum[0][k];
        for (int k = 0; k < 8; ++k)
            sum[k / 4][k % 4] /= sqrt(length);
        for (int k = 0; k < 4; ++k)
            conjugate[k] = k == 0 ? sum[0][k] : -sum[0][k];
        multiply(sum[0], p, half);
        multiply(half, conjugate, q);
        multiply(sum[1], conjugate, t);
        for (int k = 0; k < 3; ++k)
            out[k] = q[k + 1] + 2 * t[k + 1];
        check_point(moved[0][v], out, 2e-6);
    }
}
END_TEST

/* Two bones whose quaternions are nearly opposite, though their rotations are alike: the blend must not go the far way.
 */
START_TEST(rotations_just_below_and_above_a_half_turn_are_close)
{
    static const double AXIS[3] = {0, 0, 1}, NOWHERE[3] = {0, 0, 0};
    for (int b = 0; b < BONES; ++b)
        make_rigid(AXIS, M_PI + (b % 2 == 0 ? 0.1 : -0.1), NOWHERE, transforms[0][b]);
    pose(SPH_POSE_DUAL_QUATERNION, 1);
    for (int v = 0; v < VERTICES; ++v) {
        ck_assert_double_gt(-(double)moved[0][v][0] * (double)rest[v][0] - (double)moved[0][v][1] * (double)rest[v][1],
                            0.99 * hypot((double)rest[v][0], (double)rest[v][1]) *
                                hypot((double)rest[v][0], (double)rest[v][1]));
        ck_assert_double_eq_tol((double)moved[0][v][2], (double)rest[v][2], 1e-6);
    }
}
END_TEST

/* The ring in the middle of a cylinder whose ends are twisted against one another by `angle`. */
START_TEST(a_twisted_cylinder_keeps_its_section_with_dual_quaternions_and_loses_it_linearly)
{
    static const double AXIS[3] = {0, 0, 1}, NOWHERE[3] = {0, 0, 0};
    const double angle = 2.8;
    for (int v = 0; v < VERTICES; ++v) {
        const double a = 2 * M_PI * v / VERTICES;
        rest[v][0] = (float)cos(a);
        rest[v][1] = (float)sin(a);
        rest[v][2] = 0;
        for (int s = 0; s < SLOTS; ++s) {
            bones[v][s] = (uint32_t)s;
            weights[v][s] = s < 2 ? 0.5f : 0;
        }
    }
    make_rigid(AXIS, angle / 2, NOWHERE, transforms[0][0]);
    make_rigid(AXIS, -angle / 2, NOWHERE, transforms[0][1]);
    pose(METHODS[_i], 1);
    for (int v = 0; v < VERTICES; ++v)
        ck_assert_double_eq_tol(hypot((double)moved[0][v][0], (double)moved[0][v][1]), _i == 0 ? cos(angle / 2) : 1,
                                1e-6);
}
END_TEST

/* One bone swells about its pivot, the other stays: what lies between swells by the part that it has of it. */
START_TEST(scale_is_blended_about_the_pivots_wherever_the_origin_is)
{
    for (int v = 0; v < VERTICES; ++v)
        for (int s = 0; s < SLOTS; ++s) {
            bones[v][s] = (uint32_t)s;
            weights[v][s] = s == 0 ? 0.25f : s == 1 ? 0.75f : 0;
        }
    for (int b = 0; b < 2; ++b)
        memcpy(transforms[0][b], IDENTITY, sizeof IDENTITY);
    for (int k = 0; k < 3; ++k) {
        transforms[0][1][5 * k] = 2;
        transforms[0][1][4 * k + 3] = -pivots[1][k];
    }
    pose(SPH_POSE_DUAL_QUATERNION, 1);
    for (int v = 0; v < VERTICES; ++v)
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol((double)moved[0][v][k],
                                    (double)rest[v][k] + 0.75 * ((double)rest[v][k] - pivots[1][k]), 1e-6);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pose_dual");
    TCase *tc = tcase_create("pose_dual");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, dual_quaternions_are_blended_normalised_and_applied);
    tcase_add_test(tc, rotations_just_below_and_above_a_half_turn_are_close);
    tcase_add_loop_test(tc, a_twisted_cylinder_keeps_its_section_with_dual_quaternions_and_loses_it_linearly, 0, 2);
    tcase_add_test(tc, scale_is_blended_about_the_pivots_wherever_the_origin_is);
    return run_suite(suite, tc);
}
