/* SPDX-License-Identifier: MIT */
/* Transforms of bones from spheres that were moved: rigid motions, hinges, and what neighbours leave open. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "runner.h"
#include "support.h"

enum { MOST = 40 };

static sph_context *context;
static uint64_t state;
static double pivots[MOST][3], centers[MOST][3], transforms[MOST][12];
static uint32_t links[4 * MOST][2];
static uint32_t count, link_count;

static void setup(void)
{
    context = test_context();
    state = 3;
    count = link_count = 0;
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static void add(double x, double y, double z)
{
    const double p[3] = {x, y, z};
    memcpy(pivots[count], p, sizeof p);
    memcpy(centers[count++], p, sizeof p);
}

static void link_to(uint32_t a, uint32_t b)
{
    links[link_count][0] = a;
    links[link_count++][1] = b;
}

static sph_skin *make(void)
{
    static const float REST[3] = {0, 0, 0}, WEIGHT = 1;
    static const uint32_t BONE = 0;
    const sph_skin_arrays a = {.struct_size = sizeof a,
                               .vertex_count = 1,
                               .bone_count = count,
                               .influence_count = 1,
                               .rest = REST,
                               .bones = &BONE,
                               .weights = &WEIGHT,
                               .pivots = pivots[0],
                               .link_count = link_count,
                               .links = links[0]};
    sph_skin *skin = NULL;
    ck_assert_msg(sph_skin_create_from_arrays(context, &a, &skin) == SPH_OK, "%s", sph_context_last_message(context));
    return skin;
}

static void infer(const double *reference)
{
    sph_skin *skin = make();
    ck_assert_int_eq(sph_pose_from_spheres(skin, reference, centers[0], transforms[0]), SPH_OK);
    sph_skin_destroy(skin);
    for (uint32_t b = 0; b < count && reference == NULL; ++b) /* whatever else, the spheres are where they were put */
        for (int r = 0; r < 3; ++r) {
            const double *t = transforms[b] + 4 * r, *p = pivots[b];
            ck_assert_double_eq_tol(t[0] * p[0] + t[1] * p[1] + t[2] * p[2] + t[3], centers[b][r], 1e-12);
        }
}

/* By `angle` about the z axis, then moved. */
static void turn(double angle, double x, double y, double z, double out[12])
{
    const double t[12] = {cos(angle), -sin(angle), 0, x, sin(angle), cos(angle), 0, y, 0, 0, 1, z};
    memcpy(out, t, sizeof t);
}

static void apply(const double t[12], const double p[3], double out[3])
{
    for (int r = 0; r < 3; ++r)
        out[r] = t[4 * r] * p[0] + t[4 * r + 1] * p[1] + t[4 * r + 2] * p[2] + t[4 * r + 3];
}

static void check_transform(uint32_t bone, const double expected[12], double tolerance)
{
    for (int k = 0; k < 12; ++k)
        ck_assert_msg(fabs(transforms[bone][k] - expected[k]) <= tolerance, "bone %u, number %d: %g, not %g",
                      (unsigned)bone, k, transforms[bone][k], expected[k]);
}

/* That a bone is turned by `angle` about the z axis, wherever it is. */
static void check_angle(uint32_t bone, double angle)
{
    double expected[12];
    turn(angle, transforms[bone][3], transforms[bone][7], transforms[bone][11], expected);
    check_transform(bone, expected, 1e-12);
}

/* A body of random spheres, a straight limb, and a leaf that hangs on it. */
static void make_animal(void)
{
    for (uint32_t i = 0; i < 8; ++i) {
        add(test_random_unit(&state), test_random_unit(&state), test_random_unit(&state));
        for (uint32_t j = 0; j < i; ++j)
            link_to(i, j);
    }
    for (uint32_t i = 0; i < 6; ++i) {
        add(0.5, -1.0 - i, 0.5);
        link_to(count - 1, i == 0 ? 0 : count - 2);
    }
    add(0.9, -6, 0.6);
    link_to(count - 1, count - 2);
}

START_TEST(a_rigid_motion_of_all_spheres_is_that_motion_of_all_bones)
{
    double axis[3] = {0.36, 0.48, 0.8}, motion[12];
    const double angle = 0.4 + 0.9 * _i, c = cos(angle), s = sin(angle);
    make_animal();
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 4; ++k)
            motion[4 * r + k] = k == 3 ? r - 0.7 : (1 - c) * axis[r] * axis[k] + c * (r == k);
    for (int r = 0; r < 3; ++r) {
        motion[4 * r + (r + 1) % 3] -= s * axis[(r + 2) % 3];
        motion[4 * r + (r + 2) % 3] += s * axis[(r + 1) % 3];
    }
    for (uint32_t b = 0; b < count; ++b)
        apply(motion, pivots[b], centers[b]);
    infer(NULL);
    for (uint32_t b = 0; b < count; ++b)
        check_transform(b, motion, 1e-11);
}
END_TEST

START_TEST(spheres_that_stay_leave_their_bones_alone)
{
    static const double IDENTITY[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    make_animal();
    infer(NULL);
    for (uint32_t b = 0; b < count; ++b)
        check_transform(b, IDENTITY, 1e-12);
}
END_TEST

/* Seven spheres in a line, bent at the fourth: one half stays, the other turns with its end, the hinge by half. */
START_TEST(a_bent_chain_turns_half_as_far_at_its_hinge)
{
    const double angle = 1.1;
    for (uint32_t i = 0; i < 7; ++i) {
        const double along = i < 4 ? 0 : i - 3;
        add(i, 0, 0);
        if (i > 0) link_to(i - 1, i);
        if (i > 3) {
            centers[i][0] = 3 + along * cos(angle);
            centers[i][1] = along * sin(angle);
        }
    }
    infer(NULL);
    for (uint32_t i = 0; i < 7; ++i)
        check_angle(i, i < 3 ? 0 : i == 3 ? angle / 2 : angle);
}
END_TEST

START_TEST(one_neighbor_turns_a_sphere_by_the_smallest_rotation)
{
    add(0, 0, 0);
    add(1, 0, 0);
    link_to(0, 1);
    centers[1][0] = 0;
    centers[1][1] = 3; /* the length may change */
    infer(NULL);
    check_angle(0, M_PI / 2);
    check_angle(1, M_PI / 2);
}
END_TEST

START_TEST(a_neighbor_that_comes_to_the_other_side_is_a_half_turn_and_no_mirror)
{
    add(0, 0, 0);
    add(1, 0, 0);
    link_to(0, 1);
    centers[1][0] = -1;
    infer(NULL);
    for (uint32_t b = 0; b < 2; ++b) {
        const double *t = transforms[b];
        ck_assert_double_eq_tol(t[0], -1, 1e-12);
        ck_assert_double_eq_tol(t[0] * (t[5] * t[10] - t[6] * t[9]), 1, 1e-12);
    }
}
END_TEST

/* A leaf on the axis about which the body turns: what it sees of its neighbour does not change. */
START_TEST(what_one_neighbor_leaves_open_is_taken_from_it)
{
    double motion[12];
    add(0, 0, 0);
    add(1, 0, 0.1);
    add(0, 1, 0);
    add(0, 0, 2);
    link_to(0, 1);
    link_to(0, 2);
    link_to(1, 2);
    link_to(0, 3);
    turn(0.8, 0, 0, 0, motion);
    for (uint32_t b = 0; b < count; ++b)
        apply(motion, pivots[b], centers[b]);
    ck_assert_double_eq(centers[3][2] - centers[0][2], 2);
    infer(NULL);
    check_transform(3, motion, 1e-12);
}
END_TEST

START_TEST(spheres_without_neighbors_or_on_top_of_them_are_moved_and_not_turned)
{
    add(1, 2, 3);
    add(5, 5, 5);
    add(5, 5, 5);
    link_to(1, 2);
    centers[0][0] = -4;
    centers[2][2] = 9;
    infer(NULL);
    for (uint32_t b = 0; b < 3; ++b)
        check_angle(b, 0);
}
END_TEST

START_TEST(an_edit_of_a_pose_comes_after_it)
{
    double reference[MOST][12], motion[12], expected[12];
    make_animal();
    for (uint32_t b = 0; b < count; ++b) {
        double at[3];
        turn(0.1 * b, b, 0, 1, reference[b]);
        turn(-0.6, 1, 2, 3, motion);
        apply(reference[b], pivots[b], at);
        apply(motion, at, centers[b]);
    }
    infer(reference[0]);
    for (uint32_t b = 0; b < count; ++b) {
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 4; ++k) {
                expected[4 * r + k] = k == 3 ? motion[4 * r + 3] : 0;
                for (int j = 0; j < 3; ++j)
                    expected[4 * r + k] += motion[4 * r + j] * reference[b][4 * j + k];
            }
        check_transform(b, expected, 1e-10);
    }
}
END_TEST

START_TEST(what_is_wrong_is_said)
{
    sph_skin *skin;
    make_animal();
    skin = make();
    ck_assert_int_eq(sph_pose_from_spheres(NULL, NULL, centers[0], transforms[0]), SPH_E_INVALID);
    ck_assert_int_eq(sph_pose_from_spheres(skin, NULL, NULL, transforms[0]), SPH_E_INVALID);
    ck_assert_int_eq(sph_pose_from_spheres(skin, NULL, centers[0], NULL), SPH_E_INVALID);
    centers[5][2] = NAN;
    ck_assert_int_eq(sph_pose_from_spheres(skin, NULL, centers[0], transforms[0]), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "sphere 5"));
    centers[5][2] = 0;
    memset(transforms, 0, sizeof transforms);
    transforms[3][1] = INFINITY;
    ck_assert_int_eq(sph_pose_from_spheres(skin, transforms[0], centers[0], transforms[0]), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "bone 3"));
    sph_skin_destroy(skin);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pose_spheres");
    TCase *tc = tcase_create("pose_spheres");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_rigid_motion_of_all_spheres_is_that_motion_of_all_bones, 0, 4);
    tcase_add_test(tc, spheres_that_stay_leave_their_bones_alone);
    tcase_add_test(tc, a_bent_chain_turns_half_as_far_at_its_hinge);
    tcase_add_test(tc, one_neighbor_turns_a_sphere_by_the_smallest_rotation);
    tcase_add_test(tc, a_neighbor_that_comes_to_the_other_side_is_a_half_turn_and_no_mirror);
    tcase_add_test(tc, what_one_neighbor_leaves_open_is_taken_from_it);
    tcase_add_test(tc, spheres_without_neighbors_or_on_top_of_them_are_moved_and_not_turned);
    tcase_add_test(tc, an_edit_of_a_pose_comes_after_it);
    tcase_add_test(tc, what_is_wrong_is_said);
    return run_suite(suite, tc);
}
