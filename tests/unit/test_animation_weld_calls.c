/* SPDX-License-Identifier: MIT */
/* Welding much at once, frames of a source, and what every call keeps to: refusals, progress, failing allocations. */
#include <math.h>
#include <stdlib.h>

#include "context_case.h"
#include "faults.h"
#include "runner.h"
#include "weld_case.h"

START_TEST(a_hundred_thousand_coincident_vertices_are_one)
{
    const uint32_t n = 100000;
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    sph_animation *a, *welded;
    ck_assert_int_eq(sph_animation_create(context, n, 3, &a), SPH_OK);
    for (size_t i = 0; i < 3 * (size_t)n; ++i)
        xyz[i] = 0.3f;
    ck_assert_int_eq(sph_animation_set_frame(a, 1, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_weld(a, _i == 0 ? 0 : 0.25f, NULL, &welded), SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(welded), 1);
    sph_animation_destroy(welded);
    free(xyz);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(a_hundred_thousand_vertices_that_meet_in_one_frame_stay_apart)
{
    const uint32_t n = 100000;
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    sph_animation *a, *welded;
    ck_assert_int_eq(sph_animation_create(context, n, 3, &a), SPH_OK); /* frames 0 and 1: all in the origin */
    for (uint32_t i = 0; i < n; ++i) {
        xyz[3 * i] = (float)(i % 100);
        xyz[3 * i + 1] = (float)(i / 100 % 100);
        xyz[3 * i + 2] = (float)(i / 10000);
    }
    ck_assert_int_eq(sph_animation_set_frame(a, 2, xyz, 0), SPH_OK);
    /* nothing; nothing by a hair; and, with a tolerance over the distance, the cubes 0 1, 2 3, ... of eight */
    ck_assert_int_eq(sph_animation_weld(a, _i == 0 ? 0 : _i == 1 ? 0.99f : 1, NULL, &welded), SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(welded), _i < 2 ? n : n / 8);
    sph_animation_destroy(welded);
    free(xyz);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(frames_of_a_source_pass_by_without_being_held)
{
    enum { N = 2000, FRAMES = 100 };
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *own = test_context_with_allocator(&allocator);
    sph_animation *held, *pulled, *welded;
    test_source source = {0};
    ck_assert_int_eq(sph_animation_create(context, N, FRAMES, &held), SPH_OK); /* all in the origin, always */
    source.from = held;
    pulled = test_pulled(own, &source);
    ck_assert_int_eq(sph_animation_weld(pulled, _i == 0 ? 0 : 0.1f, NULL, &welded), SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(welded), 1);
    ck_assert_uint_eq(source.reads, (_i == 0 ? 2 : 3) * FRAMES);
    ck_assert_uint_lt(faulty.peak_bytes, N * FRAMES * 3 * sizeof(float) / 10);
    sph_animation_destroy(welded);
    sph_animation_destroy(pulled);
    sph_animation_destroy(held);
    sph_context_destroy(own);
    ck_assert(faulty.live_blocks == 0 && !faulty.misused);
}
END_TEST

/* --- the call --- */

START_TEST(weld_rejects_bad_arguments)
{
    static const float bad[] = {-1, -1e-30f, NAN, INFINITY, -INFINITY};
    sph_animation *a = test_cube(context, 2), *welded = a;
    uint32_t map[8];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        welded = a;
        ck_assert_int_eq(sph_animation_weld(a, bad[i], map, &welded), SPH_E_INVALID);
        ck_assert_ptr_null(welded);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "tolerance"));
    }
    welded = a;
    ck_assert_int_eq(sph_animation_weld(NULL, 0, map, &welded), SPH_E_INVALID);
    ck_assert_ptr_null(welded);
    ck_assert_int_eq(sph_animation_weld(a, 0, map, NULL), SPH_E_INVALID);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(weld_names_the_vertex_that_is_not_finite)
{
    sph_animation *a = test_cube(context, 3), *welded = a;
    float xyz[24];
    uint32_t map[8] = {42};
    ck_assert_int_eq(sph_animation_read_frame(a, 2, xyz), SPH_OK);
    xyz[3 * 5 + 1] = _i % 2 == 0 ? NAN : INFINITY;
    ck_assert_int_eq(sph_animation_set_frame(a, 2, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_weld(a, _i < 2 ? 0 : 0.1f, map, &welded), SPH_E_INVALID);
    ck_assert_ptr_null(welded);
    ck_assert_uint_eq(map[0], 42);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "frame 2, vertex 5"));
    sph_animation_destroy(a);
}
END_TEST

/* A torus whose vertices are double, and which a tolerance of 0.3 welds further: every stage has work. */
static sph_animation *model_for(sph_context *own)
{
    sph_animation *torus = test_torus(own, 12, 8, 3), *apart;
    apart = taken_apart(torus);
    sph_animation_destroy(torus);
    return apart;
}

static const float STAGE_TOLERANCES[] = {0, 1e-4f, 0.3f};

typedef struct weld {
    const sph_animation *model;
    float tolerance;
    uint32_t *map; /* NULL: none is asked for */
} weld;

static sph_status pull_and_weld(sph_context *own, const void *user)
{
    const weld *w = user;
    test_source source = {.from = w->model};
    sph_animation *a = test_pulled(own, &source), *welded = a;
    sph_status status = SPH_E_NOMEM;
    if (w->map != NULL) w->map[0] = 42;
    if (a != NULL) status = sph_animation_weld(a, w->tolerance, w->map, &welded);
    ck_assert_int_eq(status == SPH_OK, welded != NULL);
    if (w->map != NULL) ck_assert_uint_eq(w->map[0], status == SPH_OK ? 0 : 42);
    sph_animation_destroy(welded);
    sph_animation_destroy(a);
    return status;
}

START_TEST(progress_never_falls_and_may_cancel_at_any_call)
{
    sph_animation *model = model_for(context);
    const weld w = {model, STAGE_TOLERANCES[_i], test_malloc(sph_animation_vertex_count(model), sizeof *w.map)};
    check_every_cancel((test_faults){.work = pull_and_weld, .user = &w, .least = 7, .complete = true});
    free(w.map);
    sph_animation_destroy(model);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
    sph_animation *model = model_for(context);
    const weld w = {model, STAGE_TOLERANCES[_i / 2], NULL};
    check_every_allocation((test_faults){.work = pull_and_weld, .user = &w, .least = 10, .sticky = _i % 2});
    sph_animation_destroy(model);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("animation weld calls");
    TCase *tc = tcase_create("calls");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_hundred_thousand_coincident_vertices_are_one, 0, 2);
    tcase_add_loop_test(tc, a_hundred_thousand_vertices_that_meet_in_one_frame_stay_apart, 0, 3);
    tcase_add_loop_test(tc, frames_of_a_source_pass_by_without_being_held, 0, 2);
    tcase_add_test(tc, weld_rejects_bad_arguments);
    tcase_add_loop_test(tc, weld_names_the_vertex_that_is_not_finite, 0, 4);
    tcase_add_loop_test(tc, progress_never_falls_and_may_cancel_at_any_call, 0, 3);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 6);
    return run_suite(suite, tc);
}
