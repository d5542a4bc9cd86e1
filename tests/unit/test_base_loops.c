/* SPDX-License-Identifier: MIT */
/* Parallel loops, and progress. */
#include <check.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "runner.h"
#include "support.h"

enum { MOST_ITEMS = 5000 };

typedef struct visits {
    size_t count, grain;
    atomic_int seen[MOST_ITEMS];
    atomic_int misplaced; /* blocks that do not begin at a multiple of the grain or have a wrong end */
} visits;

static void visit(void *argument, size_t begin, size_t end)
{
    visits *v = argument;
    const size_t want = v->count - begin < v->grain ? v->count : begin + v->grain;
    if (begin % v->grain != 0 || begin >= v->count || end != want) atomic_fetch_add(&v->misplaced, 1);
    for (size_t i = begin; i < end && i < MOST_ITEMS; ++i)
        atomic_fetch_add(&v->seen[i], 1);
}

static void check_loop(sph_context *context, size_t count, size_t grain)
{
    visits *v = test_malloc(1, sizeof *v);
    size_t wrong = 0;
    v->count = count;
    v->grain = grain;
    sph_context_parallel_for(context, count, grain, visit, v);
    ck_assert_int_eq(v->misplaced, 0);
    for (size_t i = 0; i < MOST_ITEMS; ++i)
        wrong += v->seen[i] != (i < count ? 1 : 0);
    ck_assert_uint_eq(wrong, 0);
    free(v);
}

static sph_context *executor_context(int which)
{
    static const uint32_t counts[] = {0, 1, 2, 3, 8, 33};
    sph_executor executor;
    if (which < 6) return test_context_with_threads(counts[which]);
    executor = which == 6 ? test_executor_reverse() : which == 7 ? test_executor_scattered() : test_executor_threads();
    return test_context_with_executor(&executor);
}
enum { EXECUTORS = 9 };

START_TEST(a_loop_visits_every_item_once_in_whole_blocks)
{
    static const size_t sizes[][2] = {{0, 1},
                                      {1, 1},
                                      {2, 1},
                                      {7, 3},
                                      {64, 64},
                                      {65, 64},
                                      {999, 1},
                                      {5000, 128},
                                      {5000, 7},
                                      {10, SIZE_MAX},
                                      {5000, SIZE_MAX / 2}};
    sph_context *context = executor_context(_i);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i)
        check_loop(context, sizes[i][0], sizes[i][1]);
    for (size_t i = 0; i < 200; ++i)
        check_loop(context, 1 + i % 20, 1 + i % 3);
    ck_assert_uint_ge(sph__worker_count(context), 1);
    sph_context_destroy(context);
}
END_TEST

static void count_call(void *argument, size_t begin, size_t end)
{
    if (begin < end) atomic_fetch_add((atomic_int *)argument, 1);
}

START_TEST(a_loop_of_almost_all_numbers_does_not_wrap_around)
{
    sph_context *context = executor_context(_i);
    atomic_int calls = 0;
    sph_context_parallel_for(context, SIZE_MAX, SIZE_MAX / 2 + 1, count_call, &calls);
    ck_assert_int_eq(calls, 2);
    sph_context_parallel_for(context, SIZE_MAX, SIZE_MAX / 3, count_call, &calls);
    ck_assert_int_eq(calls, 5);
    sph_context_parallel_for(context, SIZE_MAX, SIZE_MAX - 1, count_call, &calls);
    ck_assert_int_eq(calls, 7);
    /* nothing to call, or not with these arguments */
    sph_context_parallel_for(context, 0, 1, count_call, &calls);
    sph_context_parallel_for(context, 1, 0, count_call, &calls);
    sph_context_parallel_for(context, 1, 1, NULL, &calls);
    sph_context_parallel_for(NULL, 1, 1, count_call, &calls);
    ck_assert_int_eq(calls, 7);
    sph_context_destroy(context);
}
END_TEST

typedef struct nest {
    sph_context *context;
    atomic_int seen[60 * 50];
} nest;

typedef struct nest_row {
    nest *nest;
    size_t row;
} nest_row;

static void visit_column(void *argument, size_t begin, size_t end)
{
    const nest_row *r = argument;
    for (size_t i = begin; i < end; ++i)
        atomic_fetch_add(&r->nest->seen[r->row * 50 + i], 1);
}

static void visit_row(void *argument, size_t begin, size_t end)
{
    nest *n = argument;
    for (size_t row = begin; row < end; ++row) {
        nest_row r = {n, row};
        sph__parallel_for(n->context, 50, 4, visit_column, &r);
    }
}

START_TEST(loops_within_loops_are_done_too)
{
    nest *n = test_malloc(1, sizeof *n);
    size_t wrong = 0;
    n->context = executor_context(_i);
    sph__parallel_for(n->context, 60, 7, visit_row, n);
    for (size_t i = 0; i < 60 * 50; ++i)
        wrong += n->seen[i] != 1;
    ck_assert_uint_eq(wrong, 0);
    sph_context_destroy(n->context);
    free(n);
}
END_TEST

typedef struct sums {
    double parts[64]; /* one per block of 16: plain memory, for the sanitizer to watch */
} sums;

static void sum_block(void *argument, size_t begin, size_t end)
{
    sums *s = argument;
    for (size_t i = begin; i < end; ++i)
        s->parts[begin / 16] += 1.0 / (1.0 + (double)i);
}

static double harmonic(sph_context *context)
{
    sums s = {{0}};
    double total = 0;
    sph__parallel_for(context, 1000, 16, sum_block, &s);
    for (size_t i = 0; i < 64; ++i)
        total += s.parts[i];
    return total;
}

static void *loop_thread(void *argument)
{
    static const double expected = 7.485470860550345; /* the 1000th harmonic number */
    for (int i = 0; i < 50; ++i)
        if (fabs(harmonic(argument) - expected) > 1e-12) return argument;
    return NULL;
}

START_TEST(threads_may_run_loops_on_one_context_at_once)
{
    sph_context *context = executor_context(_i);
    pthread_t threads[4];
    for (int i = 0; i < 4; ++i)
        ck_assert_int_eq(pthread_create(&threads[i], NULL, loop_thread, context), 0);
    for (int i = 0; i < 4; ++i) {
        void *wrong;
        pthread_join(threads[i], &wrong);
        ck_assert_ptr_null(wrong);
    }
    sph_context_destroy(context);
}
END_TEST

START_TEST(sums_over_blocks_have_the_same_bits_with_every_executor)
{
    sph_context *context = executor_context(_i), *one = executor_context(1);
    ck_assert(harmonic(context) == harmonic(one));
    sph_context_destroy(context);
    sph_context_destroy(one);
}
END_TEST

/* --- progress --- */

START_TEST(progress_in_parts_never_falls)
{
    test_progress record = {0};
    sph_context *context = test_context_with_progress(test_progress_callback, &record);
    sph__progress progress;
    sph__progress_begin(&progress, context);
    sph__progress_part(&progress, 0.25);
    ck_assert_int_eq(sph__progress_report(&progress, "first", 0.5), SPH_OK);
    ck_assert(record.last == 0.125);
    ck_assert_int_eq(sph__progress_report(&progress, "first", 0.25), SPH_OK); /* back: stays */
    ck_assert(record.last == 0.125);
    sph__progress_part(&progress, 0.75);
    ck_assert_int_eq(sph__progress_report(&progress, "second", 0), SPH_OK);
    ck_assert(record.last == 0.25);
    ck_assert_int_eq(sph__progress_report(&progress, "second", NAN), SPH_OK);
    ck_assert_int_eq(sph__progress_report(&progress, "second", -5), SPH_OK);
    ck_assert(record.last == 0.25);
    ck_assert_int_eq(sph__progress_report(&progress, "second", 1), SPH_OK);
    ck_assert(record.last == 1);
    ck_assert_int_eq(sph__progress_report(&progress, "second", 2), SPH_OK);
    ck_assert(record.last == 1);
    ck_assert(!record.fell);
    ck_assert_uint_eq(record.calls, 7);
    sph_context_destroy(context);
}
END_TEST

START_TEST(a_false_answer_cancels_and_says_during_what)
{
    test_progress record = {.cancel_at = 2};
    sph_context *context = test_context_with_progress(test_progress_callback, &record);
    ck_assert_int_eq(sph_context_report_progress(context, "knitting", 0.5), SPH_OK);
    ck_assert_int_eq(sph_context_report_progress(context, "knitting", 0.75), SPH_E_CANCELLED);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "knitting"));
    ck_assert_int_eq(sph_context_report_progress(context, NULL, 0.5), SPH_E_INVALID);
    ck_assert_int_eq(sph_context_report_progress(context, "knitting", NAN), SPH_E_INVALID);
    ck_assert_int_eq(sph_context_report_progress(context, "knitting", 1.5), SPH_E_INVALID);
    ck_assert_int_eq(sph_context_report_progress(NULL, "knitting", 0.5), SPH_E_INVALID);
    ck_assert_uint_eq(record.calls, 2);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("base loops");
    TCase *tc = tcase_create("loops and progress");
    tcase_add_loop_test(tc, a_loop_visits_every_item_once_in_whole_blocks, 0, EXECUTORS);
    tcase_add_loop_test(tc, a_loop_of_almost_all_numbers_does_not_wrap_around, 0, EXECUTORS);
    tcase_add_loop_test(tc, loops_within_loops_are_done_too, 0, EXECUTORS);
    tcase_add_loop_test(tc, threads_may_run_loops_on_one_context_at_once, 0, EXECUTORS);
    tcase_add_loop_test(tc, sums_over_blocks_have_the_same_bits_with_every_executor, 0, EXECUTORS);
    tcase_add_test(tc, progress_in_parts_never_falls);
    tcase_add_test(tc, a_false_answer_cancels_and_says_during_what);
    return run_suite(suite, tc);
}
