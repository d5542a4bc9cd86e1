/* SPDX-License-Identifier: MIT */
/* What every skeleton keeps to: threads, refusals, extreme skins, progress, failing allocations. */
#include <math.h>
#include <string.h>

#include "faults.h"
#include "runner.h"
#include "skeleton_case.h"

START_TEST(threads_and_executors_do_not_change_a_bit)
{
    sph_skeleton_arrays a, other;
    sph_skeleton *skeleton;
    use_random_links();
    skeleton = make_with(NULL, &a);
    for (int i = 0; i < 3; ++i) {
        const sph_executor executor = i == 0 ? test_executor_reverse() : test_executor_threads();
        sph_context *own = i == 2 ? test_context_with_threads(1) : test_context_with_executor(&executor);
        sph_skin *skin = make_skin_in(own);
        sph_skeleton *again = NULL;
        ck_assert_int_eq(sph_skeleton_create(skin, NULL, &again), SPH_OK);
        other.struct_size = sizeof other;
        ck_assert_int_eq(sph_skeleton_get_arrays(again, &other), SPH_OK);
        ck_assert_mem_eq(a.parents, other.parents, bone_count * sizeof *a.parents);
        ck_assert_mem_eq(a.positions, other.positions, bone_count * 3 * sizeof *a.positions);
        ck_assert_mem_eq(a.gaps, other.gaps, bone_count * sizeof *a.gaps);
        sph_skin_destroy(skin);
        sph_context_destroy(own);
        sph_skeleton_destroy(again);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

static void check_refused(const sph_skin *skin, const sph_skeleton_options *o, const char *message)
{
    sph_skeleton *skeleton = (sph_skeleton *)context;
    ck_assert_int_eq(sph_skeleton_create(skin, o, &skeleton), SPH_E_INVALID);
    ck_assert_ptr_null(skeleton);
    ck_assert_msg(strstr(sph_context_last_message(context), message) != NULL, "%s", sph_context_last_message(context));
}

START_TEST(bad_options_and_poses_are_refused_by_name)
{
    sph_skin *skin = make_skin_in(context);
    sph_skeleton_options good, o;
    sph_skeleton_arrays a = {.struct_size = 4};
    sph_skeleton *skeleton;
    double locals[24];
    sph_skeleton_options_init(&good, sizeof good);
    o = good, o.layout = 2, check_refused(skin, &o, "layout is 2");
    o = good, o.root = -1, check_refused(skin, &o, "root is -1");
    o = good, o.root = SPH_ROOT_GIVEN, o.root_bone = 2, check_refused(skin, &o, "root_bone is 2");
    o = good, o.single_root = 2, check_refused(skin, &o, "single_root is 2");
    o = good, o.flags = 1, check_refused(skin, &o, "flags");
    ck_assert_int_eq(sph_skeleton_create(NULL, NULL, &skeleton), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_create(skin, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_create(skin, NULL, &skeleton), SPH_OK);
    ck_assert_int_eq(sph_skeleton_get_arrays(skeleton, &a), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_get_arrays(NULL, &a), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_get_locals(skeleton, NULL, locals), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, locals, NULL), SPH_E_INVALID);
    packed[17] = NAN;
    ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed, locals), SPH_E_INVALID);
    ck_assert_msg(strstr(sph_context_last_message(context), "bone 1") != NULL, "%s", sph_context_last_message(context));
    memset(packed, 0, sizeof packed);
    ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed, locals), SPH_E_INVALID);
    ck_assert_msg(strstr(sph_context_last_message(context), "inverted") != NULL, "%s",
                  sph_context_last_message(context));
    sph_skeleton_destroy(skeleton);
    sph_skeleton_destroy(NULL);
    sph_skin_destroy(skin);
}
END_TEST

/* Numbers whose squares are beyond double precision, pivots at one place, and a single bone still make a tree. */
START_TEST(extreme_skins_make_finite_trees)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    use_random_links();
    for (uint32_t b = 0; b < bone_count; ++b) {
        transforms[0][b][3] = _i == 0 ? 1e300 * b : 0;
        for (int k = 0; k < 3 && _i == 1; ++k)
            pivots[b][k] = 1;
    }
    if (_i == 2) bone_count = 1, link_count = 0;
    skeleton = make_with(NULL, &a);
    check_tree(&a, 1);
    for (uint32_t i = 0; i < 3 * bone_count; ++i)
        ck_assert(isfinite(a.positions[i]));
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* `user` holds the options. */
static sph_status make_and_pose(sph_context *own, const void *user)
{
    sph_skin *skin = make_skin_in(own);
    sph_skeleton *skeleton = NULL;
    sph_status status = SPH_E_NOMEM;
    double locals[17 * 12], out[17 * 12];
    if (skin != NULL) status = sph_skeleton_create(skin, user, &skeleton);
    ck_assert((skeleton != NULL) == (status == SPH_OK));
    if (status == SPH_OK) status = sph_skeleton_get_locals(skeleton, packed, locals);
    if (status == SPH_OK) status = sph_skeleton_get_transforms(skeleton, locals, out);
    sph_skeleton_destroy(skeleton);
    sph_skin_destroy(skin);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    sph_skeleton_options o;
    use_random_links();
    link_count = 5; /* several parts */
    sph_skeleton_options_init(&o, sizeof o);
    o.root = _i / 2 == 0 ? SPH_ROOT_CENTER : SPH_ROOT_HEAVIEST;
    check_every_allocation((test_faults){.work = make_and_pose, .user = &o, .least = 30, .sticky = _i % 2});
}
END_TEST

START_TEST(progress_does_not_fall_and_may_cancel)
{
    use_random_links();
    link_count = 5;
    check_every_cancel((test_faults){.work = make_and_pose, .least = 3});
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skeleton calls");
    TCase *tc = tcase_create("calls");
    tcase_add_checked_fixture(tc, setup_skeleton, teardown);
    tcase_add_test(tc, threads_and_executors_do_not_change_a_bit);
    tcase_add_test(tc, bad_options_and_poses_are_refused_by_name);
    tcase_add_loop_test(tc, extreme_skins_make_finite_trees, 0, 3);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 4);
    tcase_add_test(tc, progress_does_not_fall_and_may_cancel);
    return run_suite(suite, tc);
}
