/* SPDX-License-Identifier: MIT */
/* What every call of sph_animation_check() keeps to: refusals, sizes of reports, sources, progress, memory. */
#include <stddef.h>

#include "check_case.h"
#include "context_case.h"
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

START_TEST(progress_never_falls_and_may_cancel_at_any_call)
{
    test_progress progress = {0};
    sph_context *own = test_context_with_progress(test_progress_callback, &progress);
    sph_animation *a = test_torus(own, 8, 6, 5);
    sph_animation_report r;
    size_t calls;
    check(a);
    calls = progress.calls;
    ck_assert_uint_gt(calls, 5);
    ck_assert(!progress.fell);
    ck_assert_double_eq_tol(progress.last, 1, 1e-12);
    for (size_t n = 1; n <= calls; ++n) {
        progress = (test_progress){.cancel_at = n};
        sph_animation_report_init(&r, sizeof r);
        ck_assert_int_eq(sph_animation_check(a, &r), SPH_E_CANCELLED);
        ck_assert_uint_eq(progress.calls, n);
        ck_assert_uint_eq(r.component_count, 0);
    }
    sph_animation_destroy(a);
    sph_context_destroy(own);
}
END_TEST

static sph_status faulty_scenario(const sph_allocator *allocator, const sph_animation *model)
{
    sph_context *own = test_context_with_allocator(allocator);
    test_source source = {.from = model};
    sph_animation *a = own == NULL ? NULL : test_pulled(own, &source);
    sph_animation_report r;
    sph_status status = a == NULL ? SPH_E_NOMEM : SPH_OK;
    sph_animation_report_init(&r, sizeof r);
    if (status == SPH_OK) status = sph_animation_check(a, &r);
    if (status == SPH_OK) ck_assert_uint_eq(r.component_count, 1);
    if (status != SPH_OK) ck_assert_uint_eq(r.component_count, 0);
    sph_animation_destroy(a);
    sph_context_destroy(own);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    sph_animation *model = test_torus(context, 8, 6, 3);
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = n, .sticky = _i != 0};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        const sph_status status = faulty_scenario(&allocator, model);
        ck_assert_msg(faulty.live_blocks == 0, "leak of %zu bytes when allocation %zu fails", faulty.live_bytes, n);
        ck_assert(!faulty.misused);
        if (faulty.calls < n) {
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 15);
            break;
        }
        ck_assert_int_eq(status, SPH_E_NOMEM);
    }
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
