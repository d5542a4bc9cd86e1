/* SPDX-License-Identifier: MIT */
/* What the functions of a quadric refuse, and that a refusal, or a failed allocation, changes nothing. */
#include <math.h>

#include "faults.h"
#include "quadric_case.h"
#include "runner.h"

static const double CENTER[3] = {10, -20, 30}, HALF[3] = {1, 2, 3};

#define REFUSED(call, text)                                                                                            \
    do {                                                                                                               \
        sph_context_fail(context, SPH_OK, "");                                                                         \
        ck_assert_int_eq(call, SPH_E_INVALID);                                                                         \
        ck_assert_msg(strstr(sph_context_last_message(context), text) != NULL, "message: %s",                          \
                      sph_context_last_message(context));                                                              \
    } while (0)

START_TEST(bad_counts_and_missing_handles_are_refused)
{
    sph_quadric *q = (sph_quadric *)&context;
    REFUSED(sph_quadric_create(context, 0, &q), "0 frames");
    ck_assert_ptr_null(q);
    REFUSED(sph_quadric_create(context, UINT32_C(1) << 31, &q), "2147483648 frames");
    REFUSED(sph_quadric_create(context, 1, NULL), "NULL");
    ck_assert_int_eq(sph_quadric_create(NULL, 1, &q), SPH_E_INVALID);
    ck_assert_uint_eq(sph_quadric_frame_count(NULL), 0);
    sph_quadric_destroy(NULL);
    q = make_quadric(7);
    ck_assert_uint_eq(sph_quadric_frame_count(q), 7);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(bad_planes_and_attachments_are_refused_and_change_nothing)
{
    static const double good[3] = {1, 2, 3}, bad[3] = {0, (double)NAN, 0}, endless[3] = {0, 0, INFINITY};
    static const double zero[3] = {0, 0, 0}, huge[3] = {1e200, 0, 0}, x[3] = {1, 0, 0};
    sph_quadric *q = make_quadric(2), *copy = make_quadric(2);
    double centers[6] = {1, 2, 3, 4, 5, 6}, before, after;
    add_cuboid(q, 0, CENTER, HALF, 1);
    ck_assert_int_eq(sph_quadric_evaluate(q, centers, 1, &before), SPH_OK);
    ck_assert_int_eq(sph_quadric_add_plane(NULL, 0, good, good, 1), SPH_E_INVALID);
    REFUSED(sph_quadric_add_plane(q, 2, good, good, 1), "frame 2");
    REFUSED(sph_quadric_add_plane(q, 1, NULL, good, 1), "frame 1");
    REFUSED(sph_quadric_add_plane(q, 1, good, NULL, 1), "normal");
    REFUSED(sph_quadric_add_plane(q, 1, bad, good, 1), "point");
    REFUSED(sph_quadric_add_plane(q, 1, endless, good, 1), "point");
    REFUSED(sph_quadric_add_plane(q, 1, good, bad, 1), "normal");
    REFUSED(sph_quadric_add_plane(q, 1, good, endless, 1), "normal");
    REFUSED(sph_quadric_add_plane(q, 1, good, zero, 1), "normal");
    REFUSED(sph_quadric_add_plane(q, 1, good, good, -1), "weight");
    REFUSED(sph_quadric_add_plane(q, 1, good, good, (double)NAN), "weight");
    REFUSED(sph_quadric_add_plane(q, 1, good, good, INFINITY), "weight");
    REFUSED(sph_quadric_add_plane(q, 0, huge, x, 1), "frame 0: numbers too large");
    ck_assert_int_eq(sph_quadric_add_attachment(NULL, 0, good, 1), SPH_E_INVALID);
    REFUSED(sph_quadric_add_attachment(q, 2, good, 1), "frame 2");
    REFUSED(sph_quadric_add_attachment(q, 1, NULL, 1), "center");
    REFUSED(sph_quadric_add_attachment(q, 1, bad, 1), "center");
    REFUSED(sph_quadric_add_attachment(q, 1, good, -1), "weight");
    REFUSED(sph_quadric_add_attachment(q, 0, huge, 1), "too large");
    ck_assert_int_eq(sph_quadric_add_plane(q, 1, good, good, 0), SPH_OK); /* weighs nothing, changes nothing */
    ck_assert_int_eq(sph_quadric_add_attachment(q, 1, good, 0), SPH_OK);
    /* Fine alone, too far from the other quadric's planes. */
    ck_assert_int_eq(sph_quadric_add_plane(copy, 1, good, x, 1), SPH_OK);
    ck_assert_int_eq(sph_quadric_add_plane(copy, 0, huge, x, 1), SPH_OK);
    REFUSED(sph_quadric_add(q, copy), "frame 0");
    ck_assert_int_eq(sph_quadric_evaluate(q, centers, 1, &after), SPH_OK);
    ck_assert_double_eq(before, after);
    sph_quadric_destroy(q);
    sph_quadric_destroy(copy);
}
END_TEST

START_TEST(bad_questions_are_refused_and_leave_the_answers_alone)
{
    static const double good[6] = {1, 2, 3, 4, 5, 6}, bad[6] = {0, 0, 0, 0, INFINITY, 0};
    static const double huge[6] = {0, 0, 0, 1e300, 0, 0};
    sph_quadric *q = make_quadric(2), *three = make_quadric(3);
    sph_quadric_minimum minimum = {.radius = 42};
    double centers[6] = {42, 42, 42, 42, 42, 42}, cost = 42;
    add_cuboid(q, 0, CENTER, HALF, 1);
    add_plane(q, 1, 0, 0, 0, 1, 1, 1, 1);
    ck_assert_int_eq(sph_quadric_add(NULL, q), SPH_E_INVALID);
    REFUSED(sph_quadric_add(q, NULL), "NULL");
    REFUSED(sph_quadric_add(q, three), "3 frames");
    ck_assert_int_eq(sph_quadric_evaluate(NULL, good, 1, &cost), SPH_E_INVALID);
    REFUSED(sph_quadric_evaluate(q, NULL, 1, &cost), "centers");
    REFUSED(sph_quadric_evaluate(q, good, 1, NULL), "cost");
    REFUSED(sph_quadric_evaluate(q, good, (double)NAN, &cost), "radius");
    REFUSED(sph_quadric_evaluate(q, good, INFINITY, &cost), "radius");
    REFUSED(sph_quadric_evaluate(q, bad, 1, &cost), "frame 1");
    REFUSED(sph_quadric_evaluate(q, huge, 1, &cost), "too large");
    ck_assert_int_eq(sph_quadric_minimize(NULL, good, good, 1, &minimum, centers), SPH_E_INVALID);
    REFUSED(sph_quadric_minimize(q, good, good, 1, NULL, centers), "minimum");
    REFUSED(sph_quadric_minimize(q, NULL, good, 1, &minimum, centers), "NULL");
    REFUSED(sph_quadric_minimize(q, good, NULL, 1, &minimum, centers), "NULL");
    REFUSED(sph_quadric_minimize(q, good, good, -1, &minimum, centers), "radius_max");
    REFUSED(sph_quadric_minimize(q, good, good, (double)NAN, &minimum, centers), "radius_max");
    REFUSED(sph_quadric_minimize(q, good, bad, 1, &minimum, centers), "frame 1");
    REFUSED(sph_quadric_minimize(q, bad, good, 1, &minimum, centers), "frame 1");
    REFUSED(sph_quadric_minimize(q, huge, huge, 1, &minimum, centers), "too large");
    ck_assert_double_eq(cost, 42);
    ck_assert_double_eq(minimum.radius, 42);
    for (int i = 0; i < 6; ++i)
        ck_assert_double_eq(centers[i], 42);
    sph_quadric_destroy(q);
    sph_quadric_destroy(three);
}
END_TEST

START_TEST(a_quadric_outlives_its_creator_s_hold_on_the_context)
{
    sph_context *own = test_context();
    sph_quadric *q;
    ck_assert_int_eq(sph_quadric_create(own, 1, &q), SPH_OK);
    sph_context_destroy(own);
    add_plane(q, 0, 0, 0, 0, 0, 0, 1, 1);
    sph_quadric_destroy(q);
}
END_TEST

static sph_status create(sph_context *own, const void *user)
{
    sph_quadric *q = NULL;
    const sph_status status = sph_quadric_create(own, 5, &q);
    (void)user;
    ck_assert_int_eq(status == SPH_OK, q != NULL);
    sph_quadric_destroy(q);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    check_every_allocation((test_faults){.work = create, .least = 2, .sticky = _i});
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("quadric_refusals");
    TCase *tests = tcase_create("quadric_refusals");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, bad_counts_and_missing_handles_are_refused);
    tcase_add_test(tests, bad_planes_and_attachments_are_refused_and_change_nothing);
    tcase_add_test(tests, bad_questions_are_refused_and_leave_the_answers_alone);
    tcase_add_test(tests, a_quadric_outlives_its_creator_s_hold_on_the_context);
    tcase_add_loop_test(tests, every_allocation_may_fail, 0, 2);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
