/* SPDX-License-Identifier: MIT */
/* The handle: what goes in comes out, and what is wrong is said. */
#include <math.h>
#include <stdlib.h>

#include "context_case.h"
#include "runner.h"

START_TEST(create_rejects_counts_out_of_range)
{
    static const uint32_t counts[][2] = {{0, 1}, {1, 0}, {0x80000000u, 1}, {1, 0x80000000u}, {UINT32_MAX, UINT32_MAX}};
    sph_animation *a = (sph_animation *)&counts;
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i) {
        ck_assert_int_eq(sph_animation_create(context, counts[i][0], counts[i][1], &a), SPH_E_INVALID);
        ck_assert_ptr_null(a);
    }
    a = (sph_animation *)&counts;
    ck_assert_int_eq(sph_animation_create(NULL, 1, 1, &a), SPH_E_INVALID);
    ck_assert_ptr_null(a);
    ck_assert_int_eq(sph_animation_create(context, 1, 1, NULL), SPH_E_INVALID);
    sph_animation_destroy(NULL);
}
END_TEST

START_TEST(create_says_that_memory_is_out_for_sizes_beyond_it)
{
    sph_animation *a;
    ck_assert_int_eq(sph_animation_create(context, 0x7fffffff, 0x7fffffff, &a), SPH_E_NOMEM);
    ck_assert_ptr_null(a);
    ck_message_has("2147483647 frames of 2147483647 vertices");
}
END_TEST

START_TEST(positions_are_zero_until_set)
{
    sph_animation *a;
    float xyz[6] = {1, 1, 1, 1, 1, 1};
    double diagonal = -1;
    ck_assert_int_eq(sph_animation_create(context, 2, 3, &a), SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(a), 2);
    ck_assert_uint_eq(sph_animation_frame_count(a), 3);
    ck_assert_uint_eq(sph_animation_triangle_count(a), 0);
    ck_assert_uint_eq(sph_animation_edge_count(a), 0);
    ck_assert_ptr_null(sph_animation_triangles(a));
    ck_assert_ptr_null(sph_animation_edges(a));
    ck_assert_int_eq(sph_animation_read_frame(a, 2, xyz), SPH_OK);
    for (size_t i = 0; i < 6; ++i)
        ck_assert(xyz[i] == 0);
    ck_assert_int_eq(sph_animation_bounding_diagonal(a, &diagonal), SPH_OK);
    ck_assert(diagonal == 0);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(getters_give_nothing_for_null)
{
    float xyz[3];
    double diagonal;
    ck_assert_uint_eq(sph_animation_vertex_count(NULL), 0);
    ck_assert_uint_eq(sph_animation_frame_count(NULL), 0);
    ck_assert_uint_eq(sph_animation_triangle_count(NULL), 0);
    ck_assert_uint_eq(sph_animation_edge_count(NULL), 0);
    ck_assert_ptr_null(sph_animation_triangles(NULL));
    ck_assert_ptr_null(sph_animation_edges(NULL));
    ck_assert_int_eq(sph_animation_read_frame(NULL, 0, xyz), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_frame(NULL, 0, xyz, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_triangles(NULL, NULL, 0, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_edges(NULL, NULL, 0, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_bounding_diagonal(NULL, &diagonal), SPH_E_INVALID);
}
END_TEST

/* Strides in bytes, and not even a multiple of 4. */
static const size_t STRIDES[] = {0, 12, 13, 16, 31, 64};

START_TEST(frames_with_a_stride_arrive_tight)
{
    enum { N = 5 };
    const size_t stride = STRIDES[_i], step = stride == 0 ? 12 : stride;
    unsigned char *from = test_malloc((N - 1) * step + 12, 1); /* exact: the sanitizer sees a read beyond */
    float want[3 * N], got[3 * N];
    sph_animation *a;
    for (size_t i = 0; i < 3 * N; ++i)
        want[i] = (float)i * 1.5f - 7;
    memset(from, 0xff, (N - 1) * step + 12);
    for (size_t i = 0; i < N; ++i)
        memcpy(from + i * step, want + 3 * i, 12);
    ck_assert_int_eq(sph_animation_create(context, N, 2, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(a, 1, (const float *)(const void *)from, stride), SPH_OK);
    free(from);
    ck_assert_int_eq(sph_animation_read_frame(a, 1, got), SPH_OK);
    ck_assert_mem_eq(got, want, sizeof want);
    ck_assert_int_eq(sph_animation_read_frame(a, 0, got), SPH_OK);
    for (size_t i = 0; i < 3 * N; ++i)
        ck_assert(got[i] == 0);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(indices_with_a_stride_arrive_tight)
{
    static const uint32_t want[9] = {0, 1, 2, 3, 2, 1, 4, 4, 4};
    const size_t stride = STRIDES[_i], step = stride == 0 ? 12 : stride, edge_step = stride == 0 ? 8 : stride;
    unsigned char *from = test_malloc(2 * step + 12, 1), *edges = test_malloc(2 * edge_step + 8, 1);
    sph_animation *a;
    ck_assert_int_eq(sph_animation_create(context, 5, 1, &a), SPH_OK);
    for (size_t i = 0; i < 3; ++i) {
        memcpy(from + i * step, want + 3 * i, 12);
        memcpy(edges + i * edge_step, want + 2 * i, 8);
    }
    ck_assert_int_eq(sph_animation_set_triangles(a, (const uint32_t *)(const void *)from, 3, stride), SPH_OK);
    ck_assert_int_eq(sph_animation_set_edges(a, (const uint32_t *)(const void *)edges, 3, stride), SPH_OK);
    free(from);
    free(edges);
    ck_assert_uint_eq(sph_animation_triangle_count(a), 3);
    ck_assert_mem_eq(sph_animation_triangles(a), want, sizeof want);
    ck_assert_uint_eq(sph_animation_edge_count(a), 3);
    ck_assert_mem_eq(sph_animation_edges(a), want, 6 * sizeof *want);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(set_frame_names_what_is_wrong)
{
    float xyz[6] = {0};
    sph_animation *a;
    ck_assert_int_eq(sph_animation_create(context, 2, 3, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(a, 3, xyz, 0), SPH_E_INVALID);
    ck_message_has("frame 3 is not below 3");
    ck_assert_int_eq(sph_animation_set_frame(a, 0, NULL, 0), SPH_E_INVALID);
    ck_message_has("NULL");
    for (size_t stride = 1; stride < 12; ++stride)
        ck_assert_int_eq(sph_animation_set_frame(a, 0, xyz, stride), SPH_E_INVALID);
    ck_message_has("stride of 11 bytes");
    ck_assert_int_eq(sph_animation_set_frame(a, 0, xyz, SIZE_MAX), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_read_frame(a, 3, xyz), SPH_E_INVALID);
    ck_message_has("frame 3");
    ck_assert_int_eq(sph_animation_read_frame(a, 0, NULL), SPH_E_INVALID);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(set_indices_names_what_is_wrong_and_keeps_what_was)
{
    static const uint32_t good[6] = {0, 1, 2, 2, 1, 3}, bad[6] = {0, 1, 2, 2, 1, 4}, wild[3] = {0, UINT32_MAX, 1};
    sph_animation *a;
    ck_assert_int_eq(sph_animation_create(context, 4, 1, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(a, good, 2, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_edges(a, good, 3, 0), SPH_OK);

    ck_assert_int_eq(sph_animation_set_triangles(a, bad, 2, 0), SPH_E_INVALID);
    ck_message_has("triangle 1 names vertex 4");
    ck_assert_int_eq(sph_animation_set_triangles(a, wild, 1, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_triangles(a, NULL, 1, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_triangles(a, good, 1, 11), SPH_E_INVALID);
    ck_message_has("stride of 11 bytes");
    ck_assert_int_eq(sph_animation_set_triangles(a, good, 2, SIZE_MAX), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_triangles(a, good, (size_t)1 << 31, 0), SPH_E_LIMIT);
    ck_assert_int_eq(sph_animation_set_triangles(a, good, SIZE_MAX, 0), SPH_E_LIMIT);
    ck_assert_int_eq(sph_animation_set_edges(a, bad, 3, 0), SPH_E_INVALID);
    ck_message_has("edge 2 names vertex 4");
    ck_assert_int_eq(sph_animation_set_edges(a, NULL, 1, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_edges(a, good, 1, 7), SPH_E_INVALID);
    ck_assert_int_eq(sph_animation_set_edges(a, good, SIZE_MAX, 0), SPH_E_LIMIT);

    ck_assert_uint_eq(sph_animation_triangle_count(a), 2);
    ck_assert_mem_eq(sph_animation_triangles(a), good, sizeof good);
    ck_assert_uint_eq(sph_animation_edge_count(a), 3);
    ck_assert_mem_eq(sph_animation_edges(a), good, sizeof good);

    /* From what it holds already, and from nothing. */
    ck_assert_int_eq(sph_animation_set_triangles(a, sph_animation_triangles(a), 1, 0), SPH_OK);
    ck_assert_uint_eq(sph_animation_triangle_count(a), 1);
    ck_assert_mem_eq(sph_animation_triangles(a), good, 12);
    ck_assert_int_eq(sph_animation_set_triangles(a, NULL, 0, 0), SPH_OK);
    ck_assert_uint_eq(sph_animation_triangle_count(a), 0);
    ck_assert_ptr_null(sph_animation_triangles(a));
    ck_assert_int_eq(sph_animation_set_edges(a, NULL, 0, 0), SPH_OK);
    ck_assert_ptr_null(sph_animation_edges(a));
    sph_animation_destroy(a);
}
END_TEST

START_TEST(bounding_diagonal_is_the_mean_over_frames)
{
    static const float frames[3][6] = {{0, 0, 0, 1, 2, 2}, {5, 5, 5, 5, 5, 5}, {-1, -1, -1, -1, -7, 7}};
    sph_animation *a;
    double diagonal;
    ck_assert_int_eq(sph_animation_create(context, 2, 3, &a), SPH_OK);
    for (uint32_t f = 0; f < 3; ++f)
        ck_assert_int_eq(sph_animation_set_frame(a, f, frames[f], 0), SPH_OK);
    ck_assert_int_eq(sph_animation_bounding_diagonal(a, &diagonal), SPH_OK);
    ck_assert_double_eq_tol(diagonal, (3 + 0 + 10) / 3.0, 1e-15);
    ck_assert_int_eq(sph_animation_bounding_diagonal(a, NULL), SPH_E_INVALID);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(bounding_diagonal_stands_the_largest_floats)
{
    const float far[6] = {-3e38f, -3e38f, -3e38f, 3e38f, 3e38f, 3e38f};
    sph_animation *a;
    double diagonal;
    ck_assert_int_eq(sph_animation_create(context, 2, 1, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(a, 0, far, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_bounding_diagonal(a, &diagonal), SPH_OK);
    ck_assert_double_eq_tol(diagonal / (6e38 * sqrt(3)), 1, 1e-6);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(bounding_diagonal_names_the_vertex_that_is_not_finite)
{
    const float odd[3] = {NAN, INFINITY, -INFINITY};
    float xyz[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    sph_animation *a;
    double diagonal = 42;
    ck_assert_int_eq(sph_animation_create(context, 3, 4, &a), SPH_OK);
    xyz[3 + _i] = odd[_i];
    ck_assert_int_eq(sph_animation_set_frame(a, 2, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_bounding_diagonal(a, &diagonal), SPH_E_INVALID);
    ck_message_has("frame 2, vertex 1");
    ck_assert(diagonal == 42);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(an_animation_outlives_the_callers_hold_on_the_context)
{
    sph_context *own = test_context();
    sph_animation *a = test_cube(own, 2);
    double diagonal;
    ck_assert_ptr_nonnull(a);
    sph_context_destroy(own);
    ck_assert_int_eq(sph_animation_bounding_diagonal(a, &diagonal), SPH_OK);
    ck_assert_double_gt(diagonal, 3.4);
    sph_animation_destroy(a);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("animation");
    TCase *tc = tcase_create("handle");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, create_rejects_counts_out_of_range);
    tcase_add_test(tc, create_says_that_memory_is_out_for_sizes_beyond_it);
    tcase_add_test(tc, positions_are_zero_until_set);
    tcase_add_test(tc, getters_give_nothing_for_null);
    tcase_add_loop_test(tc, frames_with_a_stride_arrive_tight, 0, 6);
    tcase_add_loop_test(tc, indices_with_a_stride_arrive_tight, 0, 6);
    tcase_add_test(tc, set_frame_names_what_is_wrong);
    tcase_add_test(tc, set_indices_names_what_is_wrong_and_keeps_what_was);
    tcase_add_test(tc, bounding_diagonal_is_the_mean_over_frames);
    tcase_add_test(tc, bounding_diagonal_stands_the_largest_floats);
    tcase_add_loop_test(tc, bounding_diagonal_names_the_vertex_that_is_not_finite, 0, 3);
    tcase_add_test(tc, an_animation_outlives_the_callers_hold_on_the_context);
    return run_suite(suite, tc);
}
