/* SPDX-License-Identifier: MIT */
/* The report on meshes whose faults are known. */
#include <math.h>
#include <stdlib.h>

#include "check_case.h"
#include "context_case.h"
#include "runner.h"

/* Nothing wrong but what the arguments say. */
static void assert_clean(const sph_animation_report *r)
{
    ck_assert_uint_eq(r->non_finite_count, 0);
    ck_assert_uint_eq(r->repeated_index_count, 0);
    ck_assert_uint_eq(r->duplicate_triangle_count, 0);
    ck_assert_uint_eq(r->zero_area_count, 0);
    ck_assert_uint_eq(r->boundary_edge_count, 0);
    ck_assert_uint_eq(r->non_manifold_edge_count, 0);
    ck_assert_uint_eq(r->inconsistent_edge_count, 0);
    ck_assert_uint_eq(r->wire_edge_count, 0);
    ck_assert_uint_eq(r->component_count, 1);
    ck_assert_uint_eq(r->isolated_vertex_count, 0);
    ck_assert_uint_eq(r->coincident_vertex_count, 0);
    ck_assert_uint_eq(r->inward_component_count, 0);
}

static sph_animation *closed_shape(int which)
{
    switch (which) {
    case 0:
        return test_cube(context, 4);
    case 1:
        return test_sphere(context, 0, 4);
    case 2:
        return test_sphere(context, 3, 3);
    default:
        return test_torus(context, 12, 7, 4);
    }
}

START_TEST(closed_outward_shapes_are_clean)
{
    const sph_animation_report r = check_and_destroy(closed_shape(_i));
    assert_clean(&r);
}
END_TEST

/* Triangle t with its last two corners swapped, for t in [begin, end). */
static void flip(sph_animation *a, size_t begin, size_t end)
{
    const size_t m = sph_animation_triangle_count(a);
    uint32_t *t = test_malloc(m, 3 * sizeof *t);
    memcpy(t, sph_animation_triangles(a), m * 3 * sizeof *t);
    for (size_t i = begin; i < end && i < m; ++i) {
        const uint32_t v = t[3 * i + 1];
        t[3 * i + 1] = t[3 * i + 2];
        t[3 * i + 2] = v;
    }
    ck_assert_int_eq(sph_animation_set_triangles(a, t, m, 0), SPH_OK);
    free(t);
}

START_TEST(closed_inward_shapes_have_one_inward_component)
{
    sph_animation *a = closed_shape(_i);
    sph_animation_report r;
    flip(a, 0, SIZE_MAX);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.inward_component_count, 1);
    r.inward_component_count = 0;
    assert_clean(&r);
}
END_TEST

START_TEST(one_flipped_triangle_makes_three_inconsistent_edges)
{
    sph_animation *a = closed_shape(_i);
    sph_animation_report r;
    flip(a, 0, SIZE_MAX);
    flip(a, 5, 6);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.inconsistent_edge_count, 3);
    r.inconsistent_edge_count = 0;
    assert_clean(&r); /* not consistently wound: neither outward nor inward */
}
END_TEST

START_TEST(a_grid_has_its_outline_for_a_boundary)
{
    sph_animation_report r = check_and_destroy(test_grid(context, 7, 4, 3));
    ck_assert_uint_eq(r.boundary_edge_count, 2 * (7 + 4));
    r.boundary_edge_count = 0;
    assert_clean(&r);
}
END_TEST

START_TEST(non_finite_positions_are_counted_and_the_first_is_named)
{
    sph_animation *a = test_cube(context, 5);
    float xyz[24];
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_read_frame(a, 2, xyz), SPH_OK);
    xyz[3 * 6] = NAN;
    xyz[3 * 6 + 1] = NAN; /* the same vertex counts once */
    xyz[3 * 4 + 2] = -INFINITY;
    ck_assert_int_eq(sph_animation_set_frame(a, 2, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_read_frame(a, 4, xyz), SPH_OK);
    xyz[0] = INFINITY;
    ck_assert_int_eq(sph_animation_set_frame(a, 4, xyz, 0), SPH_OK);
    flip(a, 0, SIZE_MAX);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.non_finite_count, 3);
    ck_assert_uint_eq(r.first_non_finite_frame, 2);
    ck_assert_uint_eq(r.first_non_finite_vertex, 4);
    ck_assert_uint_eq(r.inward_component_count, 1); /* by the other frames */
    ck_assert_uint_eq(r.zero_area_count, 0);
    ck_assert_uint_eq(r.coincident_vertex_count, 0);
}
END_TEST

/* The report on one frame of n vertices at distinct places in general position: only connectivity can be wrong. */
static sph_animation_report check_simplices(uint32_t n, const uint32_t *triangles, size_t triangle_count,
                                            const uint32_t *edges, size_t edge_count)
{
    sph_animation *a = test_soup(context, n, 0, 1, 99);
    ck_assert_ptr_nonnull(a);
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, triangle_count, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_edges(a, edges, edge_count, 0), SPH_OK);
    return check_and_destroy(a);
}

START_TEST(triangles_that_repeat_a_vertex_are_edges_or_nothing)
{
    static const uint32_t triangles[] = {0, 1, 2, 3, 3, 4, 5, 6, 5, 7, 7, 7, 1, 8, 8};
    static const uint32_t edges[] = {0, 3, 9, 9, 5, 5};
    const sph_animation_report r = check_simplices(10, triangles, 5, edges, 3);
    ck_assert_uint_eq(r.repeated_index_count, 6);
    ck_assert_uint_eq(r.first_repeated_index, 1);
    ck_assert_uint_eq(r.zero_area_count, 4);
    ck_assert_uint_eq(r.first_zero_area_frame, 0);
    ck_assert_uint_eq(r.first_zero_area_triangle, 1);
    ck_assert_uint_eq(r.duplicate_triangle_count, 0);
    ck_assert_uint_eq(r.boundary_edge_count, 3);
    ck_assert_uint_eq(r.wire_edge_count, 4);       /* 34, 56, 18, 03 */
    ck_assert_uint_eq(r.component_count, 4);       /* 0 1 2 3 4 8, 5 6, 7, 9 */
    ck_assert_uint_eq(r.isolated_vertex_count, 2); /* 7, 9 */
}
END_TEST

START_TEST(the_first_repeated_edge_comes_after_all_triangles)
{
    static const uint32_t triangles[] = {0, 1, 2, 2, 1, 3};
    static const uint32_t edges[] = {0, 3, 1, 1};
    const sph_animation_report r = check_simplices(4, triangles, 2, edges, 2);
    ck_assert_uint_eq(r.repeated_index_count, 1);
    ck_assert_uint_eq(r.first_repeated_index, 3);
}
END_TEST

START_TEST(duplicate_triangles_count_in_any_order_of_their_corners)
{
    static const uint32_t triangles[] = {0, 1, 2, 3, 1, 2, 2, 0, 1, 2, 1, 0, 1, 2, 3, 0, 1, 3};
    const sph_animation_report r = check_simplices(4, triangles, 6, NULL, 0);
    ck_assert_uint_eq(r.duplicate_triangle_count, 3);
    ck_assert_uint_eq(r.non_manifold_edge_count, 4); /* 01: 4, 12: 5, 02: 3, 13: 3 */
    ck_assert_uint_eq(r.inconsistent_edge_count, 1); /* 23, which 3 1 2 and 1 2 3 both run along from 2 to 3 */
    ck_assert_uint_eq(r.boundary_edge_count, 1);     /* 03 */
}
END_TEST

START_TEST(wire_edges_are_different_edges_of_no_triangle)
{
    static const uint32_t triangles[] = {0, 1, 2};
    static const uint32_t edges[] = {1, 0, 2, 3, 3, 2, 4, 3, 2, 3, 0, 2};
    const sph_animation_report r = check_simplices(6, triangles, 1, edges, 6);
    ck_assert_uint_eq(r.wire_edge_count, 2);
    ck_assert_uint_eq(r.boundary_edge_count, 3);
    ck_assert_uint_eq(r.component_count, 2);
    ck_assert_uint_eq(r.isolated_vertex_count, 1);
}
END_TEST

START_TEST(zero_area_is_counted_by_frame_and_the_first_is_named)
{
    static const uint32_t triangles[] = {0, 1, 2, 1, 2, 3};
    static const float frames[3][12] = {{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0},
                                        {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 1e-3f}, /* the first is a line */
                                        {5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5}};    /* all is one point */
    sph_animation *a;
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_create(context, 4, 3, &a), SPH_OK);
    for (uint32_t f = 0; f < 3; ++f)
        ck_assert_int_eq(sph_animation_set_frame(a, f, frames[f], 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 2, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.zero_area_count, 3);
    ck_assert_uint_eq(r.first_zero_area_frame, 1);
    ck_assert_uint_eq(r.first_zero_area_triangle, 0);
}
END_TEST

START_TEST(vertices_coincide_only_when_they_do_in_all_frames)
{
    static const float frames[2][15] = {{1, 2, 3, 1, 2, 3, 0, -0.0f, 0, 1, 2, 3, -0.0f, 0, 0},
                                        {4, 5, 6, 4, 5, 7, 9, 9, 9, 4, 5, 6, 9, 9, 9}};
    sph_animation *a;
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_create(context, 5, 2, &a), SPH_OK);
    for (uint32_t f = 0; f < 2; ++f)
        ck_assert_int_eq(sph_animation_set_frame(a, f, frames[f], 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.coincident_vertex_count, 2); /* 3 with 0, and 4 with 2 though their zeros differ in sign */
}
END_TEST

START_TEST(orientation_is_that_of_the_volume_summed_over_frames)
{
    sph_animation *a = test_cube(context, 2);
    float xyz[24], mirrored[24];
    ck_assert_int_eq(sph_animation_read_frame(a, 0, xyz), SPH_OK);
    for (size_t i = 0; i < 24; ++i)
        mirrored[i] = (_i == 0 ? 1.1f : 0.9f) * (i % 3 == 0 ? -xyz[i] : xyz[i]);
    ck_assert_int_eq(sph_animation_set_frame(a, 1, mirrored, 0), SPH_OK);
    ck_assert_uint_eq(check_and_destroy(a).inward_component_count, _i == 0 ? 1 : 0);
}
END_TEST

START_TEST(small_inward_cubes_far_out_are_seen)
{
    /* Two cubes of edge 2/1000 about (1000, 1000, 1000), the second inward; a wire joins them. */
    sph_animation *cube = test_cube(context, 1), *a;
    float xyz[48];
    uint32_t triangles[72];
    const uint32_t wire[2] = {7, 8};
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_read_frame(cube, 0, xyz), SPH_OK);
    for (size_t i = 0; i < 24; ++i) {
        xyz[24 + i] = 1000.5f + xyz[i] / 1024;
        xyz[i] = 1000 + xyz[i] / 1024;
    }
    memcpy(triangles, sph_animation_triangles(cube), 36 * sizeof *triangles);
    for (size_t i = 0; i < 36; ++i)
        triangles[36 + i] = 8 + triangles[35 - i]; /* read backwards: turned over */
    sph_animation_destroy(cube);
    ck_assert_int_eq(sph_animation_create(context, 16, 1, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(a, 0, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 24, 0), SPH_OK);
    r = check(a);
    ck_assert_uint_eq(r.component_count, 2);
    ck_assert_uint_eq(r.inward_component_count, 1);
    ck_assert_int_eq(sph_animation_set_edges(a, wire, 1, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.component_count, 1);
    ck_assert_uint_eq(r.inward_component_count, 1);
}
END_TEST

START_TEST(a_two_sided_sheet_has_no_volume_and_is_not_inward)
{
    sph_animation *sheet = test_grid(context, 9, 9, 3), *a;
    const size_t m = sph_animation_triangle_count(sheet);
    uint32_t *triangles = test_malloc(2 * m, 3 * sizeof *triangles);
    sph_animation_report r;
    memcpy(triangles, sph_animation_triangles(sheet), 3 * m * sizeof *triangles);
    for (size_t i = 0; i < 3 * m; ++i)
        triangles[3 * m + i] = triangles[3 * m - 1 - i];
    a = sheet;
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 2 * m, 0), SPH_OK);
    free(triangles);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.duplicate_triangle_count, m);
    ck_assert_uint_eq(r.inward_component_count, 0);
    ck_assert_uint_eq(r.boundary_edge_count, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("animation check");
    TCase *tc = tcase_create("check");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, closed_outward_shapes_are_clean, 0, 4);
    tcase_add_loop_test(tc, closed_inward_shapes_have_one_inward_component, 0, 4);
    tcase_add_loop_test(tc, one_flipped_triangle_makes_three_inconsistent_edges, 0, 4);
    tcase_add_test(tc, a_grid_has_its_outline_for_a_boundary);
    tcase_add_test(tc, non_finite_positions_are_counted_and_the_first_is_named);
    tcase_add_test(tc, triangles_that_repeat_a_vertex_are_edges_or_nothing);
    tcase_add_test(tc, the_first_repeated_edge_comes_after_all_triangles);
    tcase_add_test(tc, duplicate_triangles_count_in_any_order_of_their_corners);
    tcase_add_test(tc, wire_edges_are_different_edges_of_no_triangle);
    tcase_add_test(tc, zero_area_is_counted_by_frame_and_the_first_is_named);
    tcase_add_test(tc, vertices_coincide_only_when_they_do_in_all_frames);
    tcase_add_loop_test(tc, orientation_is_that_of_the_volume_summed_over_frames, 0, 2);
    tcase_add_test(tc, small_inward_cubes_far_out_are_seen);
    tcase_add_test(tc, a_two_sided_sheet_has_no_volume_and_is_not_inward);
    return run_suite(suite, tc);
}
