/* SPDX-License-Identifier: MIT */
/* What every call of sph_animation_check() keeps to: refusals, sizes of reports, sources, progress, memory. */
#include <stddef.h>

#include "check_case.h"
#include "context_case.h"
#include "faults.h"
#include "runner.h"

START_TEST(check_rejects_bad_arguments)
{
    sph_animation *a = test_cube(context, 1);
    sph_animation_report r = {0};
    ck_assert_int_eq(sph_animation_check(a, &r), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "not initialised"));
    ck_assert_int_eq(sph_animation_check(a, NULL), SPH_E_INVALID);
    sph_animation_report_init(&r, sizeof r);
    ck_assert_int_eq(sph_animation_check(NULL, &r), SPH_E_INVALID);
    sph_animation_report_init(NULL, sizeof r);
    memset(&r, 0xff, sizeof r);
    sph_animation_report_init(&r, sizeof r - 1); /* smaller than it ever was */
    ck_assert_uint_eq(r.struct_size, UINT32_MAX);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(a_larger_report_of_a_newer_caller_is_filled_and_its_tail_zeroed)
{
    struct {
        sph_animation_report known;
        uint64_t tail, guard;
    } newer;
    sph_animation *a = test_cube(context, 1);
    newer.tail = newer.guard = 77;
    sph_animation_report_init(&newer.known, offsetof(__typeof__(newer), guard));
    newer.tail = 78;
    ck_assert_int_eq(sph_animation_check(a, &newer.known), SPH_OK);
    ck_assert_uint_eq(newer.known.struct_size, offsetof(__typeof__(newer), guard));
    ck_assert_uint_eq(newer.known.component_count, 1);
    ck_assert_uint_eq(newer.tail, 0);
    ck_assert_uint_eq(newer.guard, 77);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(frames_from_a_source_give_the_same_report_in_one_pass)
{
    sph_animation *held = test_torus(context, 9, 5, 7), *pulled;
    test_source source = {.from = held};
    sph_animation_report want = check(held), got;
    pulled = test_pulled(context, &source);
    got = check_and_destroy(pulled);
    ck_assert_mem_eq(&got, &want, sizeof got);
    ck_assert_uint_eq(source.reads, 7);
    sph_animation_destroy(held);
}
END_TEST

/* `user` is the animation that is read. */
static sph_status pull_and_check(sph_context *own, const void *user)
{
    test_source source = {.from = user};
    sph_animation *a = test_pulled(own, &source);
    sph_animation_report r;
    sph_status status = SPH_E_NOMEM;
    sph_animation_report_init(&r, sizeof r);
    if (a != NULL) status = sph_animation_check(a, &r);
    ck_assert_uint_eq(r.component_count, status == SPH_OK);
    sph_animation_destroy(a);
    return status;
}

START_TEST(progress_never_falls_and_may_cancel_at_any_call)
{
    sph_animation *model = test_torus(context, 8, 6, 5);
    check_every_cancel((test_faults){.work = pull_and_check, .user = model, .least = 6, .complete = true});
    sph_animation_destroy(model);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
    sph_animation *model = test_torus(context, 8, 6, 3);
    check_every_allocation((test_faults){.work = pull_and_check, .user = model, .least = 15, .sticky = _i});
    sph_animation_destroy(model);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("animation check calls");
    TCase *tc = tcase_create("calls");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, check_rejects_bad_arguments);
    tcase_add_test(tc, a_larger_report_of_a_newer_caller_is_filled_and_its_tail_zeroed);
    tcase_add_test(tc, frames_from_a_source_give_the_same_report_in_one_pass);
    tcase_add_test(tc, progress_never_falls_and_may_cancel_at_any_call);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    return run_suite(suite, tc);
}
