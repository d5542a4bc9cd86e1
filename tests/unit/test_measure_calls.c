/* SPDX-License-Identifier: MIT */
/* What every measuring keeps to: frames, threads, progress, failing allocations and sources, refusals. */
#include <math.h>
#include <stdlib.h>

#include "faults.h"
#include "hierarchy_case.h"
#include "runner.h"

/* A level of `frames` frames over the vertices of a coarse torus, that moves as the torus does. */
static sph_level *make_torus_level(sph_context *of, sph_animation *torus)
{
    const uint32_t n = sph_animation_vertex_count(torus), frames = sph_animation_frame_count(torus);
    float *centers = test_malloc((size_t)frames * n * 3, sizeof *centers), *radii = test_malloc(n, sizeof *radii);
    sph_level_arrays arrays = {.struct_size = sizeof arrays, .sphere_count = n, .frame_count = frames};
    sph_level *level = NULL;
    for (uint32_t f = 0; f < frames; ++f)
        ck_assert_int_eq(sph_animation_read_frame(torus, f, centers + (size_t)f * 3 * n), SPH_OK);
    for (uint32_t i = 0; i < n; ++i)
        radii[i] = 0.02f;
    arrays.centers = centers;
    arrays.radii = radii;
    arrays.triangles = sph_animation_triangles(torus);
    arrays.triangle_count = sph_animation_triangle_count(torus);
    sph_level_create_from_arrays(of, &arrays, &level);
    free(centers);
    free(radii);
    return level;
}

static sph_status measure_torus(sph_context *of, uint32_t frames, sph_distances *mean, sph_distances *per_frame)
{
    sph_animation *torus = test_torus(of, 12, 6, frames);
    sph_level *level = torus == NULL ? NULL : make_torus_level(of, torus);
    sph_measure_options options;
    sph_status status = SPH_E_NOMEM;
    sph_measure_options_init(&options, sizeof options);
    options.samples = 500;
    if (level != NULL) status = sph_measure_level(torus, level, &options, mean, per_frame);
    sph_level_destroy(level);
    sph_animation_destroy(torus);
    return status;
}

START_TEST(results_are_the_same_for_any_threads_and_executor)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    sph_distances expected = {0}, expected_frames[5], d = {0}, frames[5];
    sph_context *one = test_context_with_threads(1);
    ck_assert_int_eq(measure_torus(one, 5, &expected, expected_frames), SPH_OK);
    sph_context_destroy(one);
    for (int i = 0; i < 5; ++i) {
        sph_context *other = i < 3 ? test_context_with_executor(&executors[i]) : test_context_with_threads((uint32_t)i);
        ck_assert_int_eq(measure_torus(other, 5, &d, frames), SPH_OK);
        ck_assert_mem_eq(&d, &expected, sizeof d);
        ck_assert_mem_eq(frames, expected_frames, sizeof frames);
        sph_context_destroy(other);
    }
}
END_TEST

START_TEST(means_are_those_of_the_frames_and_frames_can_be_chosen)
{
    sph_animation *torus = test_torus(context, 12, 6, 5);
    sph_level *level = make_torus_level(context, torus);
    sph_measure_options options;
    sph_distances all[5], mean, some[2];
    double sum = 0;
    sph_measure_options_init(&options, sizeof options);
    options.samples = 500;
    ck_assert_int_eq(sph_measure_level(torus, level, &options, &mean, all), SPH_OK);
    for (int f = 0; f < 5; ++f) {
        sum += all[f].hausdorff / 5;
        ck_assert_double_eq(all[f].hausdorff, fmax(all[f].max12, all[f].max21));
        ck_assert_double_eq_tol(all[f].mean12, 0.02, 1e-3); /* half the shell's thickness; more below concave edges */
        ck_assert_double_ge(all[f].mean12, 0.02 - 1e-5);
        ck_assert_double_eq_tol(all[f].mean21, 0.02, 1e-5);
    }
    ck_assert_double_eq_tol(mean.hausdorff, sum, 1e-12);
    options.first_frame = 1;
    options.frame_step = 2;
    options.frame_limit = 2;
    ck_assert_int_eq(sph_measure_level(torus, level, &options, &mean, some), SPH_OK);
    ck_assert_mem_eq(&some[0], &all[1], sizeof some[0]);
    ck_assert_mem_eq(&some[1], &all[3], sizeof some[1]);
    sph_level_destroy(level);
    sph_animation_destroy(torus);
}
END_TEST

static const sph_distances UNTOUCHED = {.hausdorff = -1};

static sph_status measure_a_level(sph_context *own, const void *user)
{
    sph_distances d = UNTOUCHED;
    const sph_status status = measure_torus(own, 1, &d, NULL);
    (void)user;
    if (status != SPH_OK) ck_assert_mem_eq(&d, &UNTOUCHED, sizeof d);
    return status;
}

START_TEST(every_allocation_may_fail) /* _i: 0 = fail once, 1 = fail from there on */
{
    check_every_allocation((test_faults){.work = measure_a_level, .least = 20, .sticky = _i});
}
END_TEST

static sph_status measure_meshes(sph_context *own, const void *user)
{
    sph_animation *torus = test_torus(own, 12, 6, 5);
    sph_distances d = UNTOUCHED;
    const sph_status status = sph_measure_meshes(torus, torus, NULL, &d, NULL);
    (void)user;
    if (status != SPH_OK) ck_assert_mem_eq(&d, &UNTOUCHED, sizeof d);
    sph_animation_destroy(torus);
    return status;
}

START_TEST(progress_rises_and_may_cancel_at_any_call)
{
    check_every_cancel((test_faults){.work = measure_meshes, .least = 2});
}
END_TEST

static void refused(const sph_animation *animation, const sph_level *level, const sph_measure_options *options,
                    const char *part)
{
    sph_distances d = {.hausdorff = -1};
    ck_assert_int_eq(sph_measure_level(animation, level, options, &d, NULL), SPH_E_INVALID);
    ck_message_has(part);
    ck_assert_double_eq(d.hausdorff, -1);
}

START_TEST(what_cannot_be_measured_is_refused_with_a_reason)
{
    const float center[3] = {0}, radius = 1, bad[24] = {[4] = NAN};
    sph_animation *cube = test_cube(context, 1), *two = test_cube(context, 2), *bare = NULL;
    sph_level *level = make_level(1, center, &radius, 0, NULL, 0, NULL);
    sph_measure_options options;
    sph_distances d;
    ck_assert_int_eq(sph_animation_create(context, 1, 1, &bare), SPH_OK);
    refused(bare, level, NULL, "no triangles");
    refused(two, level, NULL, "2 frames, the level 1");
    sph_measure_options_init(&options, sizeof options);
    options.samples = 0;
    refused(cube, level, &options, "0 samples");
    sph_measure_options_init(&options, sizeof options);
    options.first_frame = 1;
    refused(cube, level, &options, "first_frame is 1");
    sph_measure_options_init(&options, sizeof options);
    options.frame_step = 0;
    refused(cube, level, &options, "frame_step");
    sph_measure_options_init(&options, sizeof options);
    options.flags = 1;
    refused(cube, level, &options, "flags");
    memset(&options, 0, sizeof options);
    refused(cube, level, &options, "not initialised");
    ck_assert_int_eq(sph_animation_set_frame(cube, 0, bad, 0), SPH_OK);
    refused(cube, level, NULL, "vertex 1");
    ck_assert_int_eq(sph_measure_level(NULL, level, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_level(cube, NULL, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_level(cube, level, NULL, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_meshes(NULL, cube, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_meshes(cube, two, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_meshes(two, bare, NULL, &d, NULL), SPH_E_INVALID);
    sph_level_destroy(level);
    sph_animation_destroy(bare);
    sph_animation_destroy(two);
    sph_animation_destroy(cube);
}
END_TEST

static sph_status failing_frame(void *user, uint32_t frame, float *xyz)
{
    (void)frame;
    memset(xyz, 0, 9 * sizeof *xyz);
    return --*(int *)user < 0 ? SPH_E_IO : SPH_OK;
}

START_TEST(a_failing_frame_source_ends_the_measure_with_its_status)
{
    const float center[9] = {0}, radius = 1;
    const uint32_t triangle[3] = {0, 1, 2};
    const sph_level_arrays arrays = {
        .struct_size = sizeof arrays, .sphere_count = 1, .frame_count = 3, .centers = center, .radii = &radius};
    for (int good = 0; good <= 4; ++good) {
        int left = good;
        const sph_frame_source source = {&left, failing_frame, NULL};
        sph_animation *animation = NULL;
        sph_level *level = NULL;
        sph_distances d;
        ck_assert_int_eq(sph_animation_create_from_source(context, 3, 3, &source, &animation), SPH_OK);
        ck_assert_int_eq(sph_animation_set_triangles(animation, triangle, 1, 0), SPH_OK);
        ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
        ck_assert_int_eq(sph_measure_level(animation, level, NULL, &d, NULL), good < 4 ? SPH_E_IO : SPH_OK);
        if (good == 4) ck_assert_double_eq_tol(d.mean12, 1, 1e-5); /* a triangle of no area at the centre */
        sph_level_destroy(level);
        sph_animation_destroy(animation);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("measure calls");
    TCase *tc = tcase_create("calls");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, results_are_the_same_for_any_threads_and_executor);
    tcase_add_test(tc, means_are_those_of_the_frames_and_frames_can_be_chosen);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_test(tc, progress_rises_and_may_cancel_at_any_call);
    tcase_add_test(tc, what_cannot_be_measured_is_refused_with_a_reason);
    tcase_add_test(tc, a_failing_frame_source_ends_the_measure_with_its_status);
    return run_suite(suite, tc);
}
