/* SPDX-License-Identifier: MIT */
/* What is handed over as a whole: positions that stay the caller's, and all collapses in one call. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "support.h"

enum { FRAMES = 3, PADDING = 5 };

static sph_context *context;

static void setup(void)
{
    context = test_context();
}

static void teardown(void)
{
    sph_context_destroy(context);
}

/* The frames of `animation`, each vertex `vertex` floats after the last, each frame `frame`; the rest is NaN. */
static float *spread(const sph_animation *animation, size_t vertex, size_t frame)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    float *tight = test_malloc(n, 3 * sizeof *tight), *all = test_malloc(FRAMES * frame, sizeof *all);
    memset(all, 0xff, FRAMES * frame * sizeof *all);
    for (uint32_t f = 0; f < FRAMES; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, tight), SPH_OK);
        for (uint32_t i = 0; i < n; ++i)
            memcpy(all + f * frame + i * vertex, tight + 3 * (size_t)i, 3 * sizeof *tight);
    }
    free(tight);
    return all;
}

static sph_animation *borrow(const sph_animation *like, const float *positions, size_t vertex, size_t frame)
{
    sph_animation *animation;
    ck_assert_int_eq(sph_animation_create_from_positions(context, sph_animation_vertex_count(like), FRAMES, positions,
                                                         vertex * sizeof(float), frame * sizeof(float), &animation),
                     SPH_OK);
    ck_assert_int_eq(
        sph_animation_set_triangles(animation, sph_animation_triangles(like), sph_animation_triangle_count(like), 0),
        SPH_OK);
    return animation;
}

static sph_hierarchy *build(const sph_animation *animation)
{
    sph_hierarchy *hierarchy;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &hierarchy), SPH_OK);
    return hierarchy;
}

START_TEST(borrowed_frames_are_those_that_the_caller_has)
{
    static const size_t VERTEX[] = {3, 0, 4, 3};
    sph_animation *held = test_torus(context, 12, 8, FRAMES);
    const size_t n = sph_animation_vertex_count(held), vertex = VERTEX[_i] == 0 ? 3 : VERTEX[_i];
    const size_t frame = n * vertex + (_i == 3 ? PADDING : 0);
    float *positions = spread(held, vertex, frame), *one = test_malloc(n, 3 * sizeof *one);
    sph_animation *borrowed = borrow(held, positions, VERTEX[_i], _i == 1 ? 0 : frame);
    sph_hierarchy *expected = build(held), *found = build(borrowed);
    const uint32_t count = sph_hierarchy_collapse_count(expected);
    ck_assert_uint_eq(sph_hierarchy_collapse_count(found), count);
    for (uint32_t t = 0; t < count; ++t) {
        sph_collapse a, b;
        ck_assert_int_eq(sph_hierarchy_collapse(expected, t, &a), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_collapse(found, t, &b), SPH_OK);
        ck_assert_mem_eq(&a, &b, sizeof a);
    }
    positions[2 * frame + 5 * vertex] = 41; /* nothing was copied */
    ck_assert_int_eq(sph_animation_read_frame(borrowed, 2, one), SPH_OK);
    ck_assert(one[15] == 41);
    ck_assert_int_eq(sph_animation_set_frame(borrowed, 0, positions, 0), SPH_E_STATE);
    sph_hierarchy_destroy(expected);
    sph_hierarchy_destroy(found);
    sph_animation_destroy(borrowed);
    sph_animation_destroy(held);
    free(positions);
    free(one);
}
END_TEST

START_TEST(positions_that_cannot_be_are_refused)
{
    static const size_t STRIDES[][2] = {{11, 0}, {4, 0}, {14, 0}, {12, 30}, {SIZE_MAX - 3, 0}, {0, SIZE_MAX - 3},
                                        {0, SIZE_MAX / 2}};
    const uint32_t counts[][2] = {{0, 2}, {2, 0}, {UINT32_MAX, 2}};
    float xyz[12] = {0};
    const float *odd = (const float *)(const void *)((const char *)xyz + 2);
    sph_animation *animation = (sph_animation *)&xyz;
    for (size_t i = 0; i < sizeof STRIDES / sizeof STRIDES[0]; ++i) {
        const sph_status status = sph_animation_create_from_positions(context, 2, 2, xyz, STRIDES[i][0], STRIDES[i][1],
                                                                      &animation);
        ck_assert_int_eq(status, SPH_E_INVALID);
        ck_assert_ptr_null(animation);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "strides"));
    }
    for (size_t i = 0; i < 3; ++i)
        ck_assert_int_eq(
            sph_animation_create_from_positions(context, counts[i][0], counts[i][1], xyz, 0, 0, &animation),
            SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_create_from_positions(context, 2, 2, NULL, 0, 0, &animation), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_create_from_positions(context, 1, 1, odd, 0, 0, &animation), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_create_from_positions(NULL, 2, 2, xyz, 0, 0, &animation), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_create_from_positions(context, 2, 2, xyz, 0, 0, NULL), SPH_E_INVALID);
}
END_TEST

START_TEST(collapses_come_all_at_once_or_in_parts)
{
    sph_animation *animation = test_torus(context, 12, 8, 2);
    sph_hierarchy *hierarchy = build(animation);
    const uint32_t count = sph_hierarchy_collapse_count(hierarchy), half = count / 2;
    sph_collapse *all = test_malloc(count, sizeof *all), one;
    ck_assert_uint_eq(count, 95);
    ck_assert_int_eq(sph_hierarchy_read_collapses(hierarchy, 0, half, all), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_read_collapses(hierarchy, half, count - half, all + half), SPH_OK);
    for (uint32_t t = 0; t < count; ++t) {
        ck_assert_int_eq(sph_hierarchy_collapse(hierarchy, t, &one), SPH_OK);
        ck_assert_mem_eq(&all[t], &one, sizeof one);
    }
    ck_assert_int_eq(sph_hierarchy_read_collapses(hierarchy, count, 0, NULL), SPH_OK);
    one.u = 77;
    ck_assert_int_eq(sph_hierarchy_read_collapses(hierarchy, count, 1, &one), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_read_collapses(hierarchy, 1, UINT32_MAX, &one), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_read_collapses(hierarchy, count + 1, 0, &one), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_read_collapses(hierarchy, 0, 1, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_read_collapses(NULL, 0, 1, &one), SPH_E_INVALID);
    ck_assert_uint_eq(one.u, 77);
    free(all);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("borrowed");
    TCase *tc = tcase_create("whole arrays");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, borrowed_frames_are_those_that_the_caller_has, 0, 4);
    tcase_add_test(tc, positions_that_cannot_be_are_refused);
    tcase_add_test(tc, collapses_come_all_at_once_or_in_parts);
    return run_suite(suite, tc);
}
