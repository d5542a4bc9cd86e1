/* SPDX-License-Identifier: MIT */
/* Poses of skeletons: motion that stays the same, told relative to parents. */
#include <string.h>

#include "runner.h"
#include "skeleton_case.h"

/* 0: a tree; 1: with a root above it; 2: a list; 3: with a root. 4 to 7: transforms that also scale and shear. */
START_TEST(poses_relative_to_parents_are_the_same_poses)
{
    sph_skeleton_options o;
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    use_random_links();
    for (int f = 0; f < FRAMES; ++f)
        for (uint32_t b = 0; b < bone_count && _i >= 4; ++b)
            for (int e = 0; e < 12; ++e)
                transforms[f][b][e] += uniform(-0.2, 0.2);
    sph_skeleton_options_init(&o, sizeof o);
    o.layout = _i & 2 ? SPH_SKELETON_FLAT : SPH_SKELETON_TREE;
    o.single_root = _i & 1;
    skeleton = make_with(&o, &a);
    ck_assert_uint_eq(a.joint_count, bone_count + (_i & 1));
    check_tree(&a, (_i & 3) == 2 ? bone_count : 1);
    if (_i & 1) ck_assert_uint_eq(a.order[0], bone_count);
    for (int f = 0; f < FRAMES; ++f) {
        double locals[18 * 12], back[17 * 12], worlds[18][12];
        ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed + (size_t)f * 12 * bone_count, locals), SPH_OK);
        for (uint32_t i = 0; i < a.joint_count; ++i) {
            /* By hand: what a reader of the tree makes of it. */
            const uint32_t j = a.order[i], parent = a.parents[j];
            double skinning[12];
            if (parent == SPH_NO_JOINT)
                memcpy(worlds[j], locals + 12 * (size_t)j, sizeof worlds[j]);
            else
                product(worlds[parent], locals + 12 * (size_t)j, worlds[j]);
            product(worlds[j], a.inverse_bind + 12 * (size_t)j, skinning);
            for (int e = 0; e < 12; ++e) {
                const double expected = j < bone_count ? transforms[f][j][e] : e % 5 == 0;
                ck_assert_double_eq_tol(skinning[e], expected, 1e-12);
            }
        }
        ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, locals, back), SPH_OK);
        for (uint32_t e = 0; e < 12 * bone_count; ++e)
            ck_assert_double_eq_tol(back[e], packed[(size_t)f * 12 * bone_count + e], 1e-12);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(at_rest_the_joints_are_where_they_are_and_not_turned)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    double still[17 * 12] = {0}, back[17 * 12];
    use_random_links();
    skeleton = make_with(NULL, &a);
    ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, a.rest, back), SPH_OK);
    for (uint32_t b = 0; b < bone_count; ++b) {
        for (int k = 0; k < 3; ++k)
            still[12 * b + 5 * (unsigned)k] = 1;
        for (int e = 0; e < 12; ++e)
            ck_assert_double_eq_tol(back[12 * b + (unsigned)e], still[12 * b + (unsigned)e], 1e-14);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq(a.inverse_bind[12 * b + 4 * (unsigned)k + 3], -a.positions[3 * b + (unsigned)k]);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(a_joint_takes_along_what_hangs_on_it)
{
    static const double AXIS[3] = {0, 0, 1};
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    double locals[3 * 12], out[3 * 12], expected[12], bent[12], t[12];
    bone_count = 3;
    link_count = 2;
    links[1][0] = 1;
    links[1][1] = 2;
    skeleton = make_rooted(0, &a);
    memcpy(locals, a.rest, sizeof locals);
    turn(AXIS, 0.5, t);
    product(locals + 12, t, bent);
    memcpy(locals + 12, bent, sizeof bent);
    ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, locals, out), SPH_OK);
    turn_about(a.positions + 3, AXIS, 0.5, expected);
    for (int e = 0; e < 12; ++e) {
        ck_assert_double_eq_tol(out[e], e % 5 == 0, 1e-15);
        ck_assert_double_eq_tol(out[12 + e], expected[e], 1e-14);
        ck_assert_double_eq_tol(out[24 + e], expected[e], 1e-14);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skeleton poses");
    TCase *tc = tcase_create("poses");
    tcase_add_checked_fixture(tc, setup_skeleton, teardown);
    tcase_add_loop_test(tc, poses_relative_to_parents_are_the_same_poses, 0, 8);
    tcase_add_test(tc, at_rest_the_joints_are_where_they_are_and_not_turned);
    tcase_add_test(tc, a_joint_takes_along_what_hangs_on_it);
    return run_suite(suite, tc);
}
