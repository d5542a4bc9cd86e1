/* SPDX-License-Identifier: MIT */
/* What most tests of the public interface share: a context for each test, and what it said last. */
#ifndef SPH_TEST_CONTEXT_CASE_H
#define SPH_TEST_CONTEXT_CASE_H

#include <check.h>
#include <string.h>

#include "support.h"

extern sph_context *context;

/* The fixture: a context of all defaults. */
void setup(void);
void teardown(void);

/* Contexts of one, two and five threads, and of each executor of support.h: their results must be the same. */
enum { OTHERS = 6 };
void make_others(sph_context *others[OTHERS]);

#define ck_message_has(part)                                                                                           \
    ck_assert_msg(strstr(sph_context_last_message(context), (part)) != NULL, "message \"%s\" lacks \"%s\"",            \
                  sph_context_last_message(context), (part))

#endif
