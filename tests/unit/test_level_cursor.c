/* SPDX-License-Identifier: MIT */
/* Cursors from level to level, what they and levels refuse, and levels by their error. */
#include <math.h>
#include <stdlib.h>

#include "awkward.h"
#include "hierarchy_case.h"
#include "runner.h"

typedef struct reading {
    uint32_t sphere_count;
    size_t edge_count, triangle_count;
    uint32_t *nodes, *edges, *triangles;
} reading;

static reading read_cursor(const sph_cursor *c)
{
    reading r = {sph_cursor_sphere_count(c), sph_cursor_edge_count(c), sph_cursor_triangle_count(c), NULL, NULL, NULL};
    r.nodes = test_malloc(r.sphere_count, sizeof *r.nodes);
    r.edges = test_malloc(r.edge_count, 2 * sizeof *r.edges);
    r.triangles = test_malloc(r.triangle_count, 3 * sizeof *r.triangles);
    ck_assert_int_eq(sph_cursor_read(c, r.nodes, NULL, NULL), SPH_OK); /* also one by one */
    ck_assert_int_eq(sph_cursor_read(c, NULL, r.edges, r.triangles), SPH_OK);
    return r;
}

static void check_same_reading(const reading *a, const reading *b)
{
    ck_assert_uint_eq(a->sphere_count, b->sphere_count);
    ck_assert_uint_eq(a->edge_count, b->edge_count);
    ck_assert_uint_eq(a->triangle_count, b->triangle_count);
    for (uint32_t i = 0; i < a->sphere_count; ++i)
        ck_assert_uint_eq(a->nodes[i], b->nodes[i]);
    for (size_t i = 0; i < 2 * a->edge_count; ++i)
        ck_assert_uint_eq(a->edges[i], b->edges[i]);
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        ck_assert_uint_eq(a->triangles[i], b->triangles[i]);
}

static void free_reading(reading *r)
{
    free(r->nodes);
    free(r->edges);
    free(r->triangles);
}

/* Readings of all levels on the way down; then any jump, up or down, must find the same. */
static void wander(const sph_animation *animation, unsigned jumps, uint64_t seed)
{
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    const uint32_t n = sph_hierarchy_vertex_count(h), least = n - sph_hierarchy_collapse_count(h);
    reading *readings = test_malloc((size_t)n + 1, sizeof *readings);
    sph_cursor *cursor;
    ck_assert_int_eq(sph_cursor_create(h, &cursor), SPH_OK);
    for (uint32_t count = n; count >= least; --count) {
        ck_assert_int_eq(sph_cursor_move(cursor, count), SPH_OK);
        readings[count] = read_cursor(cursor);
    }
    for (unsigned i = 0; i <= jumps; ++i) {
        const uint32_t count = i == jumps ? n : least + (uint32_t)(test_random(&seed) % (n - least + 1));
        reading r;
        ck_assert_int_eq(sph_cursor_move(cursor, count), SPH_OK);
        r = read_cursor(cursor);
        check_same_reading(&r, &readings[count]);
        free_reading(&r);
    }
    for (uint32_t count = least; count <= n; ++count)
        free_reading(&readings[count]);
    free(readings);
    sph_cursor_destroy(cursor);
    sph_hierarchy_destroy(h);
}

START_TEST(a_cursor_finds_the_same_level_whichever_way_it_came)
{
    sph_animation *animation = _i < AWKWARD_KIND_COUNT ? awkward(context, (unsigned)_i, 3) : test_sphere(context, 3, 2);
    wander(animation, 100, (uint64_t)_i);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(two_cursors_on_one_hierarchy_do_not_meet)
{
    sph_animation *animation = test_torus(context, 9, 6, 2);
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    sph_cursor *a, *b;
    reading before, after;
    ck_assert_int_eq(sph_cursor_create(h, &a), SPH_OK);
    ck_assert_int_eq(sph_cursor_create(h, &b), SPH_OK);
    ck_assert_int_eq(sph_cursor_move(a, 20), SPH_OK);
    before = read_cursor(a);
    ck_assert_int_eq(sph_cursor_move(b, 1), SPH_OK);
    after = read_cursor(a);
    check_same_reading(&before, &after);
    free_reading(&before);
    free_reading(&after);
    sph_cursor_destroy(a);
    sph_cursor_destroy(b);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* --- refusals --- */

START_TEST(counts_out_of_range_are_refused_and_the_message_says_the_range)
{
    static const uint32_t BAD[] = {0, 3, 8 + 8 + 12 + 9 + 4 + 1, UINT32_MAX, 0x80000000u};
    sph_animation *animation =
        awkward(context, AWKWARD_COMPONENTS, 2); /* two cubes, an icosahedron, a sheet, four more */
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    sph_cursor *cursor;
    ck_assert_uint_eq(sph_animation_vertex_count(animation), 41);
    ck_assert_uint_eq(sph_hierarchy_collapse_count(h), 41 - 7);
    ck_assert_int_eq(sph_cursor_create(h, &cursor), SPH_OK);
    ck_assert_int_eq(sph_cursor_move(cursor, 9), SPH_OK);
    for (unsigned i = 0; i < sizeof BAD / sizeof *BAD; ++i) {
        sph_level *level = (sph_level *)h;
        ck_assert_int_eq(sph_level_create(h, BAD[i], &level), SPH_E_INVALID);
        ck_assert_ptr_null(level);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "from 7 to 41"));
        ck_assert_int_eq(sph_cursor_move(cursor, BAD[i]), SPH_E_INVALID);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "from 7 to 41"));
        ck_assert_uint_eq(sph_cursor_sphere_count(cursor), 9); /* stays where it was */
    }
    sph_cursor_destroy(cursor);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(null_is_answered_and_never_read)
{
    sph_animation *animation = test_cube(context, 1);
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    sph_level *level = (sph_level *)h;
    sph_cursor *cursor = (sph_cursor *)h;
    ck_assert_int_eq(sph_level_create(NULL, 1, &level), SPH_E_INVALID);
    ck_assert_ptr_null(level);
    ck_assert_int_eq(sph_level_create(h, 1, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_cursor_create(NULL, &cursor), SPH_E_INVALID);
    ck_assert_ptr_null(cursor);
    ck_assert_int_eq(sph_cursor_create(h, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_cursor_move(NULL, 1), SPH_E_INVALID);
    ck_assert_int_eq(sph_cursor_read(NULL, NULL, NULL, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(sph_cursor_sphere_count(NULL), 0);
    ck_assert_uint_eq(sph_cursor_edge_count(NULL) + sph_cursor_triangle_count(NULL), 0);
    ck_assert_int_eq(sph_level_optimize_connectivity(NULL, animation), SPH_E_INVALID);
    ck_assert_int_eq(sph_level_create(h, 3, &level), SPH_OK);
    ck_assert_int_eq(sph_level_optimize_connectivity(level, NULL), SPH_E_INVALID);
    sph_cursor_destroy(NULL);
    sph_level_destroy(level);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* --- levels by error --- */

static uint32_t search_linearly(const sph_hierarchy *h, double max_error)
{
    uint32_t best = sph_hierarchy_vertex_count(h);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        if (c.error <= max_error) best = sph_hierarchy_vertex_count(h) - t - 1;
    }
    return best;
}

static void check_search(const sph_hierarchy *h, double max_error)
{
    uint32_t count = 0;
    ck_assert_int_eq(sph_hierarchy_count_for_error(h, max_error, &count), SPH_OK);
    ck_assert_uint_eq(count, search_linearly(h, max_error));
}

START_TEST(a_level_is_found_by_its_error)
{
    sph_animation *animation = awkward(context, (unsigned)_i, 3);
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    check_search(h, 0);
    check_search(h, 1e-300);
    check_search(h, (double)INFINITY);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        check_search(h, c.error);
        check_search(h, nextafter(c.error, (double)INFINITY));
        if (c.error > 0) check_search(h, nextafter(c.error, 0));
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("level cursor");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, a_cursor_finds_the_same_level_whichever_way_it_came, 0, AWKWARD_KIND_COUNT + 1);
    tcase_add_test(tc, two_cursors_on_one_hierarchy_do_not_meet);
    tcase_add_test(tc, counts_out_of_range_are_refused_and_the_message_says_the_range);
    tcase_add_test(tc, null_is_answered_and_never_read);
    tcase_add_loop_test(tc, a_level_is_found_by_its_error, 0, AWKWARD_KIND_COUNT);
    return run_suite(suite, tc);
}
