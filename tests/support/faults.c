/* SPDX-License-Identifier: MIT */
#include <check.h>

#include "faults.h"

static sph_status run(const test_faults *faults, test_faulty *memory, test_progress *progress)
{
    sph_context_options options;
    sph_context *context;
    sph_status status;
    sph_context_options_init(&options, sizeof options);
    options.allocator = test_faulty_allocator(memory);
    if (progress != NULL) {
        options.progress = test_progress_callback;
        options.progress_user = progress;
    }
    status = sph_context_create(&options, &context);
    if (status == SPH_OK) status = faults->work(context, faults->user);
    sph_context_destroy(context);
    return status;
}

/* `what` has failed, or would have, had there been so many. */
static void check_memory(const test_faulty *memory, const char *what, size_t n)
{
    ck_assert_msg(memory->live_blocks == 0, "%zu blocks of %zu bytes are left after %s %zu", memory->live_blocks,
                  memory->live_bytes, what, n);
    ck_assert_msg(!memory->misused, "memory is asked for or given back wrongly after %s %zu", what, n);
}

static void check_end(sph_status status, size_t calls, size_t least, const char *what)
{
    ck_assert_msg(status == SPH_OK, "status %d when every %s goes well", (int)status, what);
    ck_assert_msg(calls >= least, "%zu %ss, not %zu or more", calls, what, least);
}

void check_every_allocation(test_faults faults)
{
    for (size_t n = 1;; n += 1 + (faults.thinning > 0 ? n / faults.thinning : 0)) {
        test_faulty memory = {.fail_at = n, .sticky = faults.sticky};
        const sph_status status = run(&faults, &memory, NULL);
        check_memory(&memory, "allocation", n);
        if (memory.calls < n) {
            check_end(status, memory.calls, faults.least, "allocation");
            return;
        }
        ck_assert_msg(status == SPH_E_NOMEM, "status %d although allocation %zu fails", (int)status, n);
    }
}

void check_every_cancel(test_faults faults)
{
    for (size_t n = 1;; ++n) {
        test_faulty memory = {0};
        test_progress progress = {.cancel_at = n};
        const sph_status status = run(&faults, &memory, &progress);
        check_memory(&memory, "report", n);
        ck_assert_msg(!progress.fell, "progress falls before report %zu", n);
        if (progress.calls < n) {
            check_end(status, progress.calls, faults.least, "report");
            if (faults.complete) ck_assert_double_eq_tol(progress.last, 1, 1e-12);
            return;
        }
        ck_assert_msg(status == SPH_E_CANCELLED, "status %d although report %zu is answered with no", (int)status, n);
        ck_assert_msg(progress.calls == n, "%zu reports although that of number %zu is answered with no",
                      progress.calls, n);
    }
}
