/* SPDX-License-Identifier: MIT */
/* Statuses, messages of each thread, and the log. */
#include <check.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>

#include "base/base.h"
#include "runner.h"
#include "support.h"

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
    /* One slot per thread at most; fewer where the system gives new threads the ids of dead ones (sanitizers may not).
     */
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

int main(void)
{
    Suite *suite = suite_create("base messages");
    TCase *tc = tcase_create("messages");
    tcase_add_test(tc, every_status_has_a_text_of_its_own);
    tcase_add_test(tc, a_message_is_kept_until_the_next_failure);
    tcase_add_test(tc, a_message_may_be_made_from_the_last_one);
    tcase_add_loop_test(tc, long_messages_are_cut_between_characters, 0, 4);
    tcase_add_test(tc, each_of_many_threads_sees_its_own_messages);
    tcase_add_test(tc, a_thread_without_memory_for_its_message_goes_without);
    tcase_add_test(tc, the_stamp_tells_whether_a_message_was_left);
    tcase_add_test(tc, the_log_goes_to_the_host);
    return run_suite(suite, tc);
}
