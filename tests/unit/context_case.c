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
