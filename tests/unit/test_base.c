/* SPDX-License-Identifier: MIT */
/* The room that all others stand on: statuses, messages, memory, options, parallel loops, progress. */
#include <check.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "runner.h"
#include "support.h"

/* --- statuses and messages --- */

START_TEST(every_status_has_a_text_of_its_own)
{
    for (sph_status i = SPH_OK; i <= SPH_E_STATE; ++i)
        for (sph_status j = SPH_OK; j < i; ++j)
            ck_assert_str_ne(sph_status_text(i), sph_status_text(j));
    ck_assert_str_eq(sph_status_text(-1), sph_status_text(1000));
    ck_assert_str_ne(sph_status_text(1000), sph_status_text(SPH_E_STATE));
}
END_TEST

START_TEST(a_message_is_kept_until_the_next_failure)
{
    sph_context *context = test_context();
    ck_assert_str_eq(sph_context_last_message(context), "");
    ck_assert_str_eq(sph_context_last_message(NULL), "");
    ck_assert_int_eq(sph__fail(context, SPH_E_IO, "frame %d", 7), SPH_E_IO);
    ck_assert_str_eq(sph_context_last_message(context), "frame 7");
    ck_assert_int_eq(sph_context_fail(context, 99, "100 %s"), 99); /* not a format */
    ck_assert_str_eq(sph_context_last_message(context), "100 %s");
    ck_assert_int_eq(sph_context_fail(context, SPH_E_IO, NULL), SPH_E_IO);
    ck_assert_str_eq(sph_context_last_message(context), "");
    ck_assert_int_eq(sph_context_fail(NULL, SPH_E_IO, "nowhere to go"), SPH_E_IO);
    sph_context_destroy(context);
}
END_TEST

START_TEST(a_message_may_be_made_from_the_last_one)
{
    sph_context *context = test_context();
    sph_context_fail(context, SPH_E_IO, "disk");
    sph__fail(context, SPH_E_IO, "broken %s", sph_context_last_message(context));
    sph_context_fail(context, SPH_E_IO, sph_context_last_message(context));
    ck_assert_str_eq(sph_context_last_message(context), "broken disk");
    sph_context_destroy(context);
}
END_TEST

/* Bytes of the sequences of 1 to 4 bytes for A, e acute, euro, and a musical clef. */
static const char *const CHARACTERS[] = {"A", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9d\x84\x9e"};

START_TEST(long_messages_are_cut_between_characters)
{
    sph_context *context = test_context();
    const size_t bytes = strlen(CHARACTERS[_i]);
    for (size_t shift = 0; shift < 4; ++shift) {
        char text[2000] = "";
        for (size_t i = 0; i < shift; ++i)
            strcat(text, "x");
        while (strlen(text) < 1000)
            strcat(text, CHARACTERS[_i]);
        sph_context_fail(context, SPH_E_IO, text);
        const size_t length = strlen(sph_context_last_message(context));
        ck_assert_uint_eq(length, shift + (511 - shift) / bytes * bytes);
        ck_assert_mem_eq(sph_context_last_message(context), text, length);
    }
    sph_context_destroy(context);
}
END_TEST

enum { SPEAKERS = 40, ROUNDS = 50 };

typedef struct speaker {
    sph_context *context;
    int number;
    bool right;
} speaker;

static void *speak(void *argument)
{
    speaker *s = argument;
    char want[64];
    s->right = strcmp(sph_context_last_message(s->context), "") == 0;
    for (int i = 0; i < ROUNDS; ++i) {
        sph__fail(s->context, SPH_E_IO, "thread %d, round %d", s->number, i);
        snprintf(want, sizeof want, "thread %d, round %d", s->number, i);
        sched_yield();
        s->right = s->right && strcmp(sph_context_last_message(s->context), want) == 0;
    }
    return NULL;
}

START_TEST(each_of_many_threads_sees_its_own_messages)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    for (int again = 0; again < 3; ++again) { /* later threads get the ids of dead ones, but not their messages */
        pthread_t threads[SPEAKERS];
        speaker speakers[SPEAKERS];
        for (int i = 0; i < SPEAKERS; ++i) {
            speakers[i] = (speaker){context, i, false};
            ck_assert_int_eq(pthread_create(&threads[i], NULL, speak, &speakers[i]), 0);
        }
        for (int i = 0; i < SPEAKERS; ++i) {
            pthread_join(threads[i], NULL);
            ck_assert_msg(speakers[i].right, "thread %d read what it did not write", i);
        }
    }
    ck_assert_str_eq(sph_context_last_message(context), "");
    /* One slot per thread at most; fewer where the system gives new threads the ids of dead ones (sanitizers may not). */
    ck_assert_uint_le(faulty.live_blocks, SPEAKERS * 3);
    sph_context_destroy(context);
    ck_assert(faulty.live_blocks == 0 && !faulty.misused);
}
END_TEST

START_TEST(a_thread_without_memory_for_its_message_goes_without)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    sph_context_fail(context, SPH_E_IO, "mine");
    faulty.fail_at = faulty.calls + 1;
    faulty.sticky = true;
    for (int i = 0; i < SPEAKERS; ++i) {
        pthread_t thread;
        speaker s = {context, i, false};
        ck_assert_int_eq(pthread_create(&thread, NULL, speak, &s), 0);
        pthread_join(thread, NULL);
    }
    ck_assert_str_eq(sph_context_last_message(context), "mine");
    sph_context_destroy(context);
    ck_assert(faulty.live_blocks == 0 && !faulty.misused);
}
END_TEST

START_TEST(the_stamp_tells_whether_a_message_was_left)
{
    sph_context *context = test_context();
    uint64_t stamp = sph__message_stamp(context);
    ck_assert_uint_eq(stamp, 0);
    sph_context_fail(context, SPH_E_IO, "same");
    ck_assert_uint_ne(sph__message_stamp(context), stamp);
    stamp = sph__message_stamp(context);
    ck_assert_uint_eq(sph__message_stamp(context), stamp);
    sph_context_fail(context, SPH_E_IO, "same");
    ck_assert_uint_ne(sph__message_stamp(context), stamp);
    sph_context_destroy(context);
}
END_TEST

typedef struct log_record {
    int calls, severity;
    char text[600];
} log_record;

static void record_log(void *user, int32_t severity, const char *message)
{
    log_record *record = user;
    ++record->calls;
    record->severity = severity;
    snprintf(record->text, sizeof record->text, "%s", message);
}

START_TEST(the_log_goes_to_the_host)
{
    log_record record = {0};
    sph_context_options o;
    sph_context *context;
    sph_context_options_init(&o, sizeof o);
    o.log = record_log;
    o.log_user = &record;
    ck_assert_int_eq(sph_context_create(&o, &context), SPH_OK);
    sph_context_log(context, SPH_LOG_WARNING, "50 %d");
    ck_assert_int_eq(record.calls, 1);
    ck_assert_int_eq(record.severity, SPH_LOG_WARNING);
    ck_assert_str_eq(record.text, "50 %d");
    sph_context_log(context, SPH_LOG_INFO, NULL);
    sph_context_log(NULL, SPH_LOG_INFO, "nobody");
    ck_assert_int_eq(record.calls, 1);
    sph_context_destroy(context);
}
END_TEST

/* --- options --- */

/* A struct as it was at first, and as it has grown twice. */
typedef struct grown {
    uint32_t struct_size;
    uint32_t flags;
    double first;
    double late; /* appended */
    uint64_t latest;
} grown;
enum { GROWN_V1 = offsetof(grown, late) };
static const grown GROWN_DEFAULTS = {sizeof(grown), 0, 1.5, 2.5, 7};

START_TEST(an_older_callers_struct_is_not_overrun_and_gets_defaults)
{
    grown in, out = GROWN_DEFAULTS;
    memset(&in, 0xee, sizeof in);
    sph__options_init(&in, GROWN_V1, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
    ck_assert_uint_eq(in.struct_size, GROWN_V1);
    ck_assert(in.first == 1.5);
    for (size_t i = GROWN_V1; i < sizeof in; ++i)
        ck_assert_uint_eq(((unsigned char *)&in)[i], 0xee);
    in.first = 9;
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_OK);
    ck_assert(out.first == 9 && out.late == 2.5 && out.latest == 7);
    ck_assert_uint_eq(out.struct_size, sizeof out);
}
END_TEST

START_TEST(a_newer_callers_tail_must_be_unset)
{
    struct {
        grown known;
        uint64_t unknown;
    } in;
    sph_context *context = test_context();
    grown out = GROWN_DEFAULTS;
    memset(&in, 0xee, sizeof in);
    sph__options_init(&in, sizeof in, &GROWN_DEFAULTS, sizeof in.known, GROWN_V1);
    ck_assert_uint_eq(in.known.struct_size, sizeof in);
    ck_assert_uint_eq(in.unknown, 0);
    in.known.latest = 8;
    ck_assert_int_eq(sph__options_read(context, "grown", &in, &out, sizeof out, GROWN_V1), SPH_OK);
    ck_assert_uint_eq(out.latest, 8);
    for (size_t byte = 0; byte < sizeof in.unknown; ++byte) {
        in.unknown = UINT64_C(1) << 8 * byte;
        ck_assert_int_eq(sph__options_read(context, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_VERSION);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "grown"));
    }
    sph_context_destroy(context);
}
END_TEST

START_TEST(structs_that_were_not_initialised_are_refused)
{
    grown in = {0}, out = GROWN_DEFAULTS;
    ck_assert_int_eq(sph__options_read(NULL, "grown", NULL, &out, sizeof out, GROWN_V1), SPH_OK);
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_INVALID);
    in.struct_size = GROWN_V1 - 1;
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_INVALID);
    in.struct_size = UINT32_MAX; /* rubbish: would be read far beyond its end */
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_INVALID);
    ck_assert_mem_eq(&out, &GROWN_DEFAULTS, sizeof out);
    sph__options_init(&in, GROWN_V1 - 1, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
    sph__options_init(&in, SIZE_MAX, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
    ck_assert_uint_eq(in.struct_size, UINT32_MAX);
    sph__options_init(NULL, sizeof in, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
}
END_TEST

static void *some_allocate(void *user, size_t size, size_t alignment)
{
    (void)user;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

START_TEST(context_create_refuses_bad_options)
{
    sph_context_options good, o;
    sph_context *context = (sph_context *)&o;
    sph_context_options_init(&good, sizeof good);
    ck_assert_uint_eq(good.struct_size, sizeof good);
#define ck_refused(change)                                                                                             \
    do {                                                                                                               \
        o = good;                                                                                                      \
        change;                                                                                                        \
        context = (sph_context *)&o;                                                                                   \
        ck_assert_int_eq(sph_context_create(&o, &context), SPH_E_INVALID);                                             \
        ck_assert_ptr_null(context);                                                                                   \
    } while (0)
    ck_refused(memset(&o, 0, sizeof o));
    ck_refused(o.flags = 1);
    ck_refused(o.reserved0 = 1);
    ck_refused(o.allocator.allocate = some_allocate);
    ck_refused(o.allocator.user = &o);
    ck_refused(o.executor.user = &o);
    ck_refused(o.thread_count = 257);
    ck_assert_int_eq(sph_context_create(&good, NULL), SPH_E_INVALID);
    sph_context_destroy(NULL);
}
END_TEST

/* --- memory --- */

START_TEST(context_creation_may_run_out_of_memory)
{
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = n, .sticky = _i == 1};
        sph_context_options o;
        sph_context *context;
        sph_status status;
        sph_context_options_init(&o, sizeof o);
        o.allocator = test_faulty_allocator(&faulty);
        o.thread_count = 3;
        status = sph_context_create(&o, &context);
        if (faulty.calls >= n) {
            ck_assert_int_eq(status, SPH_E_NOMEM);
            ck_assert_ptr_null(context);
        }
        sph_context_destroy(context);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!faulty.misused);
        if (faulty.calls < n) {
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 2);
            return;
        }
    }
}
END_TEST

START_TEST(sizes_that_overflow_are_out_of_memory)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    const size_t calls = faulty.calls;
    size_t product;
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX, 2));
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX / 2 + 1, 2));
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX, 1));
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX - SPH__ALIGN + 1, 1));
    ck_assert_ptr_null(sph__alloc(context, PTRDIFF_MAX, 1));
    ck_assert_ptr_null(sph__zalloc(context, SIZE_MAX, SIZE_MAX));
    ck_assert_ptr_null(sph_context_allocate(context, SIZE_MAX / 3, 4));
    ck_assert_ptr_null(sph_context_allocate(NULL, 1, 1));
    ck_assert_uint_eq(faulty.calls, calls); /* the host is not asked */
    ck_assert(sph__multiply_size(SIZE_MAX, 1, &product) && product == SIZE_MAX);
    ck_assert(sph__multiply_size(0, SIZE_MAX, &product) && product == 0);
    ck_assert(!sph__multiply_size((size_t)1 << 32, (size_t)1 << (sizeof(size_t) * 8 - 32), &product));
    sph_context_release(context, NULL);
    sph_context_destroy(context);
    ck_assert_uint_eq(faulty.live_blocks, 0);
}
END_TEST

START_TEST(memory_is_aligned_zeroed_and_grows)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    void *empty = sph__alloc(context, 0, 8);
    unsigned char *bytes = sph__zalloc(context, 100, 1);
    void *array = NULL;
    size_t capacity = 0;
    ck_assert_ptr_nonnull(empty);
    ck_assert_uint_eq((uintptr_t)bytes % 64, 0);
    for (size_t i = 0; i < 100; ++i)
        ck_assert_uint_eq(bytes[i], 0);
    for (size_t i = 0; i < 100; ++i)
        bytes[i] = (unsigned char)i;
    bytes = sph__realloc(context, bytes, 1000, 1);
    for (size_t i = 0; i < 100; ++i)
        ck_assert_uint_eq(bytes[i], i);
    bytes = sph__realloc(context, bytes, 10, 1);
    for (size_t i = 0; i < 10; ++i)
        ck_assert_uint_eq(bytes[i], i);
    ck_assert_ptr_null(sph__realloc(context, bytes, SIZE_MAX, 2));
    ck_assert_uint_eq(bytes[9], 9);
    for (size_t n = 1; n < 1000; ++n) {
        ck_assert(sph__reserve(context, &array, &capacity, n, sizeof(size_t)));
        ck_assert_uint_ge(capacity, n);
        ((size_t *)array)[n - 1] = n;
    }
    for (size_t n = 1; n < 1000; ++n)
        ck_assert_uint_eq(((size_t *)array)[n - 1], n);
    ck_assert(!sph__reserve(context, &array, &capacity, SIZE_MAX, sizeof(size_t)));
    ck_assert_uint_ge(capacity, 999);
    ck_assert_uint_eq(((size_t *)array)[998], 999);
    ck_assert_uint_lt(faulty.calls, 30); /* it doubles */
    sph__free(context, array);
    sph__free(context, bytes);
    sph__free(context, empty);
    sph__free(context, NULL);
    sph_context_destroy(context);
    ck_assert(faulty.live_blocks == 0 && !faulty.misused);
}
END_TEST

START_TEST(the_last_handle_takes_the_context_along)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    ck_assert_ptr_eq(sph__context_retain(context), context);
    sph_context_destroy(context);
    ck_assert_uint_gt(faulty.live_blocks, 0);
    ck_assert_int_eq(sph_context_fail(context, SPH_E_IO, "alive"), SPH_E_IO);
    sph__context_release(context);
    ck_assert_uint_eq(faulty.live_blocks, 0);
    sph__context_release(NULL);
}
END_TEST

/* --- parallel loops --- */

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

static TCase *message_tests(void)
{
    TCase *tc = tcase_create("messages");
    tcase_add_test(tc, every_status_has_a_text_of_its_own);
    tcase_add_test(tc, a_message_is_kept_until_the_next_failure);
    tcase_add_test(tc, a_message_may_be_made_from_the_last_one);
    tcase_add_loop_test(tc, long_messages_are_cut_between_characters, 0, 4);
    tcase_add_test(tc, each_of_many_threads_sees_its_own_messages);
    tcase_add_test(tc, a_thread_without_memory_for_its_message_goes_without);
    tcase_add_test(tc, the_stamp_tells_whether_a_message_was_left);
    tcase_add_test(tc, the_log_goes_to_the_host);
    return tc;
}

static TCase *memory_tests(void)
{
    TCase *tc = tcase_create("options and memory");
    tcase_add_test(tc, an_older_callers_struct_is_not_overrun_and_gets_defaults);
    tcase_add_test(tc, a_newer_callers_tail_must_be_unset);
    tcase_add_test(tc, structs_that_were_not_initialised_are_refused);
    tcase_add_test(tc, context_create_refuses_bad_options);
    tcase_add_loop_test(tc, context_creation_may_run_out_of_memory, 0, 2);
    tcase_add_test(tc, sizes_that_overflow_are_out_of_memory);
    tcase_add_test(tc, memory_is_aligned_zeroed_and_grows);
    tcase_add_test(tc, the_last_handle_takes_the_context_along);
    return tc;
}

static TCase *loop_tests(void)
{
    TCase *tc = tcase_create("loops and progress");
    tcase_add_loop_test(tc, a_loop_visits_every_item_once_in_whole_blocks, 0, EXECUTORS);
    tcase_add_loop_test(tc, a_loop_of_almost_all_numbers_does_not_wrap_around, 0, EXECUTORS);
    tcase_add_loop_test(tc, loops_within_loops_are_done_too, 0, EXECUTORS);
    tcase_add_loop_test(tc, threads_may_run_loops_on_one_context_at_once, 0, EXECUTORS);
    tcase_add_loop_test(tc, sums_over_blocks_have_the_same_bits_with_every_executor, 0, EXECUTORS);
    tcase_add_test(tc, progress_in_parts_never_falls);
    tcase_add_test(tc, a_false_answer_cancels_and_says_during_what);
    return tc;
}

int main(void)
{
    Suite *suite = suite_create("base");
    suite_add_tcase(suite, message_tests());
    suite_add_tcase(suite, memory_tests());
    suite_add_tcase(suite, loop_tests());
    return run_all(suite);
}
