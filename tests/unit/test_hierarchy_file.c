/* SPDX-License-Identifier: MIT */
/* Hierarchies as bytes: the same after it. */
#include <stdlib.h>

#include "faults.h"
#include "hierarchy_case.h"
#include "hierarchy_file_case.h"
#include "runner.h"

static void check_nodes(const sph_hierarchy *a, const sph_hierarchy *b)
{
    const uint32_t frames = sph_hierarchy_frame_count(a), n = sph_hierarchy_vertex_count(a);
    float *of_a = test_malloc(4 * frames, sizeof *of_a), *of_b = test_malloc(4 * frames, sizeof *of_b);
    ck_assert_uint_eq(sph_hierarchy_vertex_count(b), n);
    ck_assert_uint_eq(sph_hierarchy_frame_count(b), frames);
    ck_assert_uint_eq(sph_hierarchy_collapse_count(a), sph_hierarchy_collapse_count(b));
    ck_assert_uint_eq(sph_hierarchy_first_forced(a), sph_hierarchy_first_forced(b));
    ck_assert_double_eq(sph_hierarchy_bounding_diagonal(a), sph_hierarchy_bounding_diagonal(b));
    ck_assert_uint_eq(sph_hierarchy_evaluation_count(b), 0);
    for (uint32_t i = 0; i < n + sph_hierarchy_collapse_count(a); ++i) {
        ck_assert_int_eq(sph_hierarchy_sphere(a, i, of_a, of_a + 3 * frames), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_sphere(b, i, of_b, of_b + 3 * frames), SPH_OK);
        ck_assert_mem_eq(of_a, of_b, 4 * frames * sizeof *of_a);
    }
    for (uint32_t i = 0; i < sph_hierarchy_collapse_count(a); ++i) {
        sph_collapse x, y;
        ck_assert_int_eq(sph_hierarchy_collapse(a, i, &x), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_collapse(b, i, &y), SPH_OK);
        ck_assert_mem_eq(&x, &y, sizeof x);
    }
    free(of_a);
    free(of_b);
}

static void check_levels(const sph_hierarchy *a, const sph_hierarchy *b)
{
    const uint32_t n = sph_hierarchy_vertex_count(a), least = n - sph_hierarchy_collapse_count(a);
    for (uint32_t k = least; k <= n; ++k) {
        sph_level *x, *y;
        sph_level_arrays p, q;
        ck_assert_int_eq(sph_level_create(a, k, &x), SPH_OK);
        ck_assert_int_eq(sph_level_create(b, k, &y), SPH_OK);
        p = arrays_of(x);
        q = arrays_of(y);
        ck_assert_uint_eq(p.edge_count, q.edge_count);
        ck_assert_uint_eq(p.triangle_count, q.triangle_count);
        ck_assert_mem_eq(p.edges, q.edges, 8 * p.edge_count);
        ck_assert_mem_eq(p.triangles, q.triangles, 12 * p.triangle_count);
        ck_assert_mem_eq(p.labels, q.labels, 4 * p.label_count);
        ck_assert_mem_eq(p.centers, q.centers, 12 * (size_t)k * p.frame_count);
        sph_level_destroy(x);
        sph_level_destroy(y);
    }
}

START_TEST(a_hierarchy_comes_back_as_it_was)
{
    sph_hierarchy *h = make_hierarchy(context, _i / 3, _i % 3), *back = NULL;
    bytes b = write_all(h), again;
    ck_assert_msg(sph_hierarchy_read(context, b.data, b.size, &back) == SPH_OK, "%s",
                  sph_context_last_message(context));
    check_nodes(h, back);
    check_levels(h, back);
    again = write_all(back);
    ck_assert_uint_eq(b.size, again.size);
    ck_assert_mem_eq(b.data, again.data, b.size);
    free(b.data);
    free(again.data);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(back);
}
END_TEST

/* `user` holds the bytes. */
static sph_status read_and_write(sph_context *own, const void *user)
{
    const bytes *b = user;
    sph_hierarchy *back = NULL;
    bytes again = {NULL, 0, 0};
    sph_status status = sph_hierarchy_read(own, b->data, b->size, &back);
    ck_assert((back != NULL) == (status == SPH_OK));
    if (status == SPH_OK) status = sph_hierarchy_write(back, keep, &again);
    sph_hierarchy_destroy(back);
    free(again.data);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    sph_hierarchy *h = make_hierarchy(context, 1, SPH_RADIUS_PER_FRAME);
    bytes b = write_all(h);
    check_every_allocation((test_faults){.work = read_and_write, .user = &b, .least = 11, .sticky = _i});
    free(b.data);
    sph_hierarchy_destroy(h);
}
END_TEST

START_TEST(a_level_is_no_hierarchy_and_null_is_answered)
{
    sph_hierarchy *h = make_hierarchy(context, 0, SPH_RADIUS_CONSTANT), *back = h;
    sph_level *level, *level_back;
    bytes b = {NULL, 0, 0};
    ck_assert_int_eq(sph_level_create(h, 3, &level), SPH_OK);
    ck_assert_int_eq(sph_level_write(level, keep, &b), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_read(context, b.data, b.size, &back), SPH_E_FORMAT);
    ck_assert_ptr_null(back);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "holds a level, not a hierarchy"));
    ck_assert_int_eq(sph_level_read(context, b.data, b.size, &level_back), SPH_OK);
    sph_level_destroy(level_back);
    sph_level_destroy(level);
    ck_assert_int_eq(sph_hierarchy_read(NULL, b.data, b.size, &back), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_read(context, NULL, b.size, &back), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_read(context, b.data, b.size, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_write(NULL, keep, &b), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_write(h, NULL, &b), SPH_E_INVALID);
    free(b.data);
    sph_hierarchy_destroy(h);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy file");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_hierarchy_comes_back_as_it_was, 0, 3 * MESH_COUNT);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_test(tc, a_level_is_no_hierarchy_and_null_is_answered);
    return run_suite(suite, tc);
}
