/* SPDX-License-Identifier: MIT */
/* What every main of these tests does. */
#ifndef SPH_TEST_RUNNER_H
#define SPH_TEST_RUNNER_H

#include <check.h>
#include <stdlib.h>

/* Runs and frees the suite: what main returns. */
static inline int run_all(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    int failed;
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* The same with one more test case. */
static inline int run_suite(Suite *suite, TCase *tc)
{
    suite_add_tcase(suite, tc);
    return run_all(suite);
}

#endif
