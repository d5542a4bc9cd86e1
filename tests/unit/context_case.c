/* SPDX-License-Identifier: MIT */
#include "context_case.h"

sph_context *context;

void setup(void)
{
    context = test_context();
    ck_assert_ptr_nonnull(context);
}

void teardown(void)
{
    sph_context_destroy(context);
}

void make_others(sph_context *others[OTHERS])
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    static const uint32_t threads[] = {1, 2, 5};
    for (int i = 0; i < 3; ++i) {
        others[i] = test_context_with_threads(threads[i]);
        others[3 + i] = test_context_with_executor(&executors[i]);
    }
}
