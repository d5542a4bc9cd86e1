/* SPDX-License-Identifier: MIT */
/* What every call of coverage keeps to: threads, progress, failing allocations, refusals. */
#include <math.h>

#include "coverage_case.h"
#include "faults.h"
#include "hierarchy_case.h"
#include "runner.h"

enum { MEASURE = 1, INFLATE = 2 };

static sph_status work(sph_context *of, int calls, sph_level **out)
{
    uint64_t state = 7;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    sph_level *level = still_level(of, &s, FRAMES, 0);
    sph_animation *animation;
    sph_coverage c = {.struct_size = sizeof c};
    sph_inflation n = {.struct_size = sizeof n};
    sph_status status = SPH_E_NOMEM;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(of, xyz, POINTS, FRAMES);
    *out = NULL;
    if (level != NULL && animation != NULL) status = SPH_OK;
    if (status == SPH_OK && (calls & MEASURE) != 0) status = sph_coverage_measure(animation, level, &c);
    if (status == SPH_OK && (calls & INFLATE) != 0) status = sph_coverage_inflate(animation, level, NULL, &n, out);
    sph_animation_destroy(animation);
    sph_level_destroy(level);
    return status;
}

START_TEST(the_result_is_the_same_for_any_threads_and_executor)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    sph_context *one = test_context_with_threads(1);
    sph_level *expected, *level;
    ck_assert_int_eq(work(one, MEASURE | INFLATE, &expected), SPH_OK);
    sph_context_destroy(one); /* the level keeps it */
    for (int i = 0; i < 5; ++i) {
        sph_context *other = i < 3 ? test_context_with_executor(&executors[i]) : test_context_with_threads((uint32_t)i);
        ck_assert_int_eq(work(other, MEASURE | INFLATE, &level), SPH_OK);
        ck_assert_mem_eq(arrays_of(level).radii, arrays_of(expected).radii, 4 * (size_t)arrays_of(level).sphere_count);
        sph_level_destroy(level);
        sph_context_destroy(other);
    }
    sph_level_destroy(expected);
}
END_TEST

/* `user` says which calls. */
static sph_status work_and_destroy(sph_context *own, const void *user)
{
    const int calls = *(const int *)user;
    sph_level *level;
    const sph_status status = work(own, calls, &level);
    ck_assert((status == SPH_OK && (calls & INFLATE) != 0) == (level != NULL));
    sph_level_destroy(level);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    const int calls = MEASURE | INFLATE;
    check_every_allocation((test_faults){.work = work_and_destroy, .user = &calls, .least = 20, .sticky = _i});
}
END_TEST

START_TEST(progress_rises_and_may_cancel_at_any_call) /* _i: of the one or the other */
{
    const int calls = _i == 0 ? MEASURE : INFLATE;
    check_every_cancel((test_faults){.work = work_and_destroy, .user = &calls, .least = 2});
}
END_TEST

static void refused(sph_status status, sph_status expected, const char *part)
{
    ck_assert_int_eq(status, expected);
    ck_message_has(part);
}

START_TEST(what_is_wrong_is_refused_with_a_reason)
{
    float xyz[6] = {3e38f, 3e38f, 3e38f, 0, NAN, 0};
    sph_animation *far = points(context, xyz, 1, 1), *two = points(context, xyz, 1, 2),
                  *bad = points(context, xyz, 2, 1);
    sph_level *level = test_solid_level(context, &SOLIDS[0]), *out = level;
    sph_coverage c = {.struct_size = sizeof c};
    sph_inflation_options o;
    refused(sph_coverage_measure(two, level, &c), SPH_E_INVALID, "2 frames, the level 1");
    refused(sph_coverage_measure(bad, level, &c), SPH_E_INVALID, "vertex 1");
    refused(sph_coverage_measure(far, NULL, &c), SPH_E_INVALID, "NULL");
    refused(sph_coverage_measure(far, level, NULL), SPH_E_INVALID, "sph_coverage");
    c.struct_size = 3;
    refused(sph_coverage_measure(far, level, &c), SPH_E_INVALID, "struct_size");
    ck_assert_int_eq(sph_coverage_measure(NULL, level, &c), SPH_E_INVALID);
    sph_inflation_options_init(&o, sizeof o);
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_LIMIT, "would need a radius of");
    ck_assert_ptr_null(out);
    refused(sph_coverage_inflate(far, level, &o, NULL, NULL), SPH_E_INVALID, "no place");
    o.margin = NAN;
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "margin");
    o.margin = -1;
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "margin");
    sph_inflation_options_init(&o, sizeof o);
    o.rounds = 1001;
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "1001");
    memset(&o, 0, sizeof o);
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "not initialised");
    sph_level_destroy(level);
    sph_animation_destroy(far);
    sph_animation_destroy(two);
    sph_animation_destroy(bad);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("coverage calls");
    TCase *tc = tcase_create("calls");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, the_result_is_the_same_for_any_threads_and_executor);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_loop_test(tc, progress_rises_and_may_cancel_at_any_call, 0, 2);
    tcase_add_test(tc, what_is_wrong_is_refused_with_a_reason);
    return run_suite(suite, tc);
}
