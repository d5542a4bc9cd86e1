/* SPDX-License-Identifier: MIT */
/*
 * Work that is done again and again, while memory fails or the host cancels at one place after the other. What does
 * not hold fails the Check test that asks; support.h does without Check.
 */
#ifndef SPH_TEST_FAULTS_H
#define SPH_TEST_FAULTS_H

#include "support.h"

/*
 * Uses the library in a context made for this one run. Ends at the first call that is not SPH_OK, releases all it made,
 * and returns that status; asserts itself what its results are after a failure and after none.
 */
typedef sph_status test_work(sph_context *context, const void *user);

typedef struct test_faults {
    test_work *work;
    const void *user;
    size_t least;    /* allocations (the context's own among them), or reports of progress, that there are at least */
    bool sticky;     /* allocations: all fail from there on, not one alone */
    bool complete;   /* reports: the last of all is 1 */
    size_t thinning; /* allocations: n is followed by n + 1 + n / thinning; 0: each has its turn */
} test_faults;

/*
 * Allocation 1, 2, 3 ... fails, until none does: SPH_E_NOMEM each time, and nothing is left behind, or given back
 * wrongly.
 */
void check_every_allocation(test_faults faults);
/*
 * Report 1, 2, 3 ... of progress is answered with no, until none is: SPH_E_CANCELLED each time, without a further
 * report, and nothing is left behind; progress never falls.
 */
void check_every_cancel(test_faults faults);

#endif
