/* SPDX-License-Identifier: MIT */
/* Frames that come from a source of the caller: when it is read, how it ends, and what its failures become. */
#include "context_case.h"
#include "runner.h"

START_TEST(a_source_is_read_when_frames_are_needed_and_destroyed_once)
{
    sph_animation *held = test_torus(context, 6, 4, 5), *pulled;
    test_source source = {.from = held};
    float a[72], b[72];
    double want, got;
    pulled = test_pulled(context, &source);
    ck_assert_ptr_nonnull(pulled);
    ck_assert_uint_eq(source.reads, 0);
    for (uint32_t f = 0; f < 5; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(held, f, a), SPH_OK);
        ck_assert_int_eq(sph_animation_read_frame(pulled, f, b), SPH_OK);
        ck_assert_mem_eq(a, b, sizeof a);
    }
    ck_assert_uint_eq(source.reads, 5);
    ck_assert_int_eq(sph_animation_bounding_diagonal(held, &want), SPH_OK);
    ck_assert_int_eq(sph_animation_bounding_diagonal(pulled, &got), SPH_OK);
    ck_assert(want == got);
    ck_assert_uint_eq(source.reads, 10);
    ck_assert_int_eq(sph_animation_set_frame(pulled, 0, a, 0), SPH_E_STATE);
    ck_assert_uint_eq(source.destroys, 0);
    sph_animation_destroy(pulled);
    ck_assert_uint_eq(source.destroys, 1);
    sph_animation_destroy(held);
}
END_TEST

START_TEST(a_source_is_destroyed_once_when_creation_fails)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *own = test_context_with_allocator(&allocator);
    test_source source = {0};
    const sph_frame_source frames = test_frame_source(&source);
    sph_frame_source no_reader = frames;
    sph_animation *a;
    no_reader.read_frame = NULL;
    ck_assert_int_eq(sph_animation_create_from_source(own, 0, 1, &frames, &a), SPH_E_INVALID);
    ck_assert_uint_eq(source.destroys, 1);
    ck_assert_int_eq(sph_animation_create_from_source(own, 1, 0, &frames, &a), SPH_E_INVALID);
    ck_assert_uint_eq(source.destroys, 2);
    ck_assert_int_eq(sph_animation_create_from_source(own, 1, 1, &frames, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(source.destroys, 3);
    ck_assert_int_eq(sph_animation_create_from_source(NULL, 1, 1, &frames, &a), SPH_E_INVALID);
    ck_assert_uint_eq(source.destroys, 4);
    ck_assert_int_eq(sph_animation_create_from_source(own, 1, 1, &no_reader, &a), SPH_E_INVALID);
    ck_assert_uint_eq(source.destroys, 5);
    ck_assert_int_eq(sph_animation_create_from_source(own, 1, 1, NULL, &a), SPH_E_INVALID);
    faulty.fail_at = faulty.calls + 1;
    ck_assert_int_eq(sph_animation_create_from_source(own, 1, 1, &frames, &a), SPH_E_NOMEM);
    ck_assert_uint_eq(source.destroys, 6);
    ck_assert_ptr_null(a);
    sph_context_destroy(own);
    ck_assert(faulty.live_blocks == 0 && !faulty.misused);
}
END_TEST

START_TEST(a_source_without_a_destroy_function_is_fine)
{
    test_source source = {0};
    sph_frame_source frames = test_frame_source(&source);
    sph_animation *a;
    frames.destroy = NULL;
    ck_assert_int_eq(sph_animation_create_from_source(context, 0, 1, &frames, &a), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_create_from_source(context, 1, 1, &frames, &a), SPH_OK);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(a_failing_source_fails_the_call_with_its_status)
{
    sph_animation *held = test_cube(context, 6), *pulled, *welded;
    test_source source = {.from = held};
    sph_animation_report report;
    float xyz[24];
    double diagonal = 42;
    uint32_t map[8] = {42};
    pulled = test_pulled(context, &source);
    source.failure = SPH_E_IO;
    source.fail_at = 1;
    ck_assert_int_eq(sph_animation_read_frame(pulled, 4, xyz), SPH_E_IO);
    ck_message_has("frame 4");
    source.reads = 0;
    source.fail_at = 3;
    ck_assert_int_eq(sph_animation_bounding_diagonal(pulled, &diagonal), SPH_E_IO);
    ck_message_has("frame 2");
    ck_assert(diagonal == 42);
    source.failure = 12345; /* a status of its own is handed on */
    for (size_t n = 1; n <= 12; ++n) {
        source.reads = 0;
        source.fail_at = n;
        ck_assert_int_eq(sph_animation_weld(pulled, 0, map, &welded), 12345);
        ck_assert_ptr_null(welded);
        ck_assert_uint_eq(map[0], 42);
    }
    for (size_t n = 1; n <= 6; ++n) {
        sph_animation_report_init(&report, sizeof report);
        report.wire_edge_count = 42;
        source.reads = 0;
        source.fail_at = n;
        ck_assert_int_eq(sph_animation_check(pulled, &report), 12345);
        ck_assert_uint_eq(report.wire_edge_count, 42);
        ck_message_has("unknown status");
    }
    sph_animation_destroy(pulled);
    sph_animation_destroy(held);
}
END_TEST

static sph_status explaining_read(void *user, uint32_t frame, float *xyz)
{
    (void)frame;
    (void)xyz;
    return sph_context_fail(user, SPH_E_FORMAT, "the tape is torn");
}

START_TEST(the_message_of_a_source_is_not_talked_over)
{
    const sph_frame_source frames = {context, explaining_read, NULL};
    sph_animation *a;
    float xyz[3];
    ck_assert_int_eq(sph_animation_create_from_source(context, 1, 1, &frames, &a), SPH_OK);
    for (int i = 0; i < 2; ++i) {
        ck_assert_int_eq(sph_animation_read_frame(a, 0, xyz), SPH_E_FORMAT);
        ck_assert_str_eq(sph_context_last_message(context), "the tape is torn");
    }
    sph_animation_destroy(a);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("animation source");
    TCase *tc = tcase_create("source");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, a_source_is_read_when_frames_are_needed_and_destroyed_once);
    tcase_add_test(tc, a_source_is_destroyed_once_when_creation_fails);
    tcase_add_test(tc, a_source_without_a_destroy_function_is_fine);
    tcase_add_test(tc, a_failing_source_fails_the_call_with_its_status);
    tcase_add_test(tc, the_message_of_a_source_is_not_talked_over);
    return run_suite(suite, tc);
}
