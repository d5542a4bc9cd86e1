/* SPDX-License-Identifier: MIT */
/* What every main of these tests does. */
#ifndef SPH_TEST_RUNNER_H
#define SPH_TEST_RUNNER_H

#include <check.h>
#include <stdlib.h>

static inline int run_suite(Suite *suite, TCase *tc)
{
    SRunner *runner;
    int failed;
    suite_add_tcase(suite, tc);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

#endif
