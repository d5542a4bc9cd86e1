/* SPDX-License-Identifier: MIT */
/* The memory that a context counts, and the limit that it keeps. */
#include <check.h>
#include <string.h>

#include "runner.h"
#include "support.h"

static sph_context *limited(uint64_t limit, test_faulty *faulty)
{
    sph_context_options o;
    sph_context *context = NULL;
    sph_context_options_init(&o, sizeof o);
    o.memory_limit = limit;
    o.allocator = test_faulty_allocator(faulty);
    o.thread_count = 1;
    ck_assert_int_eq(sph_context_create(&o, &context), SPH_OK);
    return context;
}

/* From an animation to a surface. */
static sph_status work(sph_context *context)
{
    sph_animation *animation = test_torus(context, 12, 8, 2);
    sph_hierarchy *h = NULL;
    sph_level *level = NULL;
    sph_query *query = NULL;
    sph_surface *surface = NULL;
    sph_surface_options o;
    sph_status status = SPH_E_NOMEM;
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 12;
    if (animation != NULL) status = sph_hierarchy_create(animation, NULL, &h);
    if (status == SPH_OK) status = sph_level_create(h, 10, &level);
    if (status == SPH_OK) status = sph_query_create(level, NULL, &query);
    if (status == SPH_OK) status = sph_query_pose_frame(query, 0);
    if (status == SPH_OK) status = sph_surface_create(level, &o, &surface);
    sph_surface_destroy(surface);
    sph_query_destroy(query);
    sph_level_destroy(level);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    return status;
}

START_TEST(the_count_is_that_of_the_allocator)
{
    test_faulty faulty = {0};
    sph_context *context = limited(0, &faulty);
    sph_animation *animation;
    const uint64_t idle = sph_context_memory_used(context);
    ck_assert_uint_eq(idle, faulty.live_bytes);
    animation = test_torus(context, 12, 8, 2);
    ck_assert_uint_gt(sph_context_memory_used(context), idle + 12 * 8 * 2 * 12);
    ck_assert_uint_eq(sph_context_memory_used(context), faulty.live_bytes);
    sph_animation_destroy(animation);
    ck_assert_int_eq(work(context), SPH_OK);
    ck_assert_uint_eq(sph_context_memory_used(context), idle);
    ck_assert_uint_eq(sph_context_memory_peak(context), faulty.peak_bytes);
    ck_assert_uint_eq(sph_context_memory_used(NULL), 0);
    ck_assert_uint_eq(sph_context_memory_peak(NULL), 0);
    sph_context_destroy(context);
    ck_assert_uint_eq(faulty.live_bytes, 0);
}
END_TEST

START_TEST(nothing_passes_the_limit_and_the_message_says_so)
{
    test_faulty free_run = {0};
    sph_context *context = limited(0, &free_run);
    uint64_t idle = sph_context_memory_used(context), peak, refused = 0;
    ck_assert_int_eq(work(context), SPH_OK);
    peak = sph_context_memory_peak(context);
    sph_context_destroy(context);
    for (unsigned step = 0; step <= 64; ++step) {
        test_faulty faulty = {0};
        const uint64_t limit = idle + (peak - idle) * step / 64;
        sph_status status;
        context = limited(limit, &faulty);
        status = work(context);
        ck_assert_int_eq(status, step == 64 ? SPH_OK : SPH_E_NOMEM);
        if (status != SPH_OK) {
            ++refused;
            ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "limit of "));
        }
        ck_assert_uint_eq(sph_context_memory_used(context), idle);
        ck_assert_uint_le(sph_context_memory_peak(context), limit);
        sph_context_destroy(context);
        ck_assert_uint_eq(faulty.live_bytes, 0);
        ck_assert(!faulty.misused);
    }
    ck_assert_uint_eq(refused, 64);
}
END_TEST

START_TEST(sizes_that_cannot_be_are_refused_before_anything_is_asked_for)
{
    test_faulty faulty = {0};
    sph_context *context = limited(UINT64_C(1) << 20, &faulty);
    sph_animation *animation = NULL;
    const size_t calls = faulty.calls;
    ck_assert_ptr_null(sph_context_allocate(context, SIZE_MAX / 2, 3));
    ck_assert_ptr_null(sph_context_allocate(context, 1, SIZE_MAX));
    ck_assert_ptr_null(sph_context_allocate(context, 1, PTRDIFF_MAX));
    ck_assert_ptr_null(sph_context_allocate(context, 1 << 20, 1));
    ck_assert_uint_eq(faulty.calls, calls);
    ck_assert_int_ne(sph_animation_create(context, 1 << 30, 1 << 30, &animation), SPH_OK);
    ck_assert_ptr_null(animation);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("memory_limit");
    TCase *tc = tcase_create("memory_limit");
    tcase_add_test(tc, the_count_is_that_of_the_allocator);
    tcase_add_test(tc, nothing_passes_the_limit_and_the_message_says_so);
    tcase_add_test(tc, sizes_that_cannot_be_are_refused_before_anything_is_asked_for);
    return run_suite(suite, tc);
}
