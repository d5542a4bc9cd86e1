/* SPDX-License-Identifier: MIT */
/* Welding, against what is known of the shapes and against comparing every vertex with every leader. */
#include <math.h>
#include <stdlib.h>

#include "context_case.h"
#include "runner.h"
#include "weld_case.h"

START_TEST(a_shape_taken_apart_comes_together_again)
{
    sph_animation *whole = _i % 3 == 0   ? test_cube(context, 3)
                           : _i % 3 == 1 ? test_sphere(context, 3, 4)
                                         : test_torus(context, 20, 9, 3);
    sph_animation *apart = taken_apart(whole), *welded;
    const uint32_t n = sph_animation_vertex_count(whole), corners = sph_animation_vertex_count(apart);
    const float tolerance = _i < 3 ? 0 : 1e-5f;
    const float *was, *is;
    float *first, *second;
    uint32_t *map = test_malloc(corners, sizeof *map), highest = 0;
    size_t wrong = 0;
    ck_assert_int_eq(sph_animation_weld(apart, tolerance, map, &welded), SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(welded), n);
    ck_assert_uint_eq(sph_animation_triangle_count(welded), sph_animation_triangle_count(whole));
    ck_assert_mem_eq(sph_animation_triangles(welded), map,
                     corners * sizeof *map); /* triangle i was 3 i, 3 i + 1, 3 i + 2 */
    was = first = read_all(apart);
    is = second = read_all(welded);
    for (uint32_t f = 0; f < sph_animation_frame_count(apart); ++f)
        for (uint32_t i = 0; i < corners; ++i) {
            wrong += memcmp(was + ((size_t)f * corners + i) * 3, is + ((size_t)f * n + map[i]) * 3, 12) != 0;
            wrong += map[i] > highest + 1; /* new ones come in the order of their first vertex */
            highest = map[i] > highest ? map[i] : highest;
        }
    ck_assert_uint_eq(wrong, 0);
    free(first);
    free(second);
    free(map);
    sph_animation_destroy(whole);
    sph_animation_destroy(apart);
    sph_animation_destroy(welded);
}
END_TEST

START_TEST(vertices_that_part_in_one_frame_stay_two)
{
    static const float together[6] = {1, 2, 3, 1, 2, 3}, apart[6] = {1, 2, 3, 1, 2, 3.5f};
    sph_animation *a, *welded;
    uint32_t map[2];
    ck_assert_int_eq(sph_animation_create(context, 2, 5, &a), SPH_OK);
    for (uint32_t f = 0; f < 5; ++f)
        ck_assert_int_eq(sph_animation_set_frame(a, f, f == (uint32_t)_i ? apart : together, 0), SPH_OK);
    for (int with = 0; with < 2; ++with) {
        ck_assert_int_eq(sph_animation_weld(a, with == 0 ? 0 : 0.49f, map, &welded), SPH_OK);
        ck_assert_uint_eq(sph_animation_vertex_count(welded), 2);
        ck_assert(map[0] == 0 && map[1] == 1);
        sph_animation_destroy(welded);
    }
    ck_assert_int_eq(sph_animation_weld(a, 0.5f, map, &welded), SPH_OK); /* "no more than" */
    ck_assert_uint_eq(sph_animation_vertex_count(welded), 1);
    ck_assert(map[0] == 0 && map[1] == 0);
    sph_animation_destroy(welded);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(simplices_that_come_to_repeat_a_vertex_are_dropped)
{
    static const float xyz[15] = {0, 0, 0, 1, 0, 0, 0, 0, -0.0f, 0, 1, 0, 1, 0, 0};
    static const uint32_t triangles[] = {0, 1, 3, 0, 2, 3, 2, 4, 3, 3, 3, 1, 1, 0, 4};
    static const uint32_t edges[] = {0, 2, 2, 1, 3, 3, 4, 3};
    static const uint32_t want_map[] = {0, 1, 0, 2, 1}, want_triangles[] = {0, 1, 2, 0, 1, 2},
                          want_edges[] = {0, 1, 1, 2};
    sph_animation *a, *welded;
    uint32_t map[5];
    ck_assert_int_eq(sph_animation_create(context, 5, 1, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(a, 0, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 5, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_edges(a, edges, 4, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_weld(a, 0, map, &welded), SPH_OK);
    ck_assert_mem_eq(map, want_map, sizeof map);
    ck_assert_uint_eq(sph_animation_triangle_count(welded), 2);
    ck_assert_mem_eq(sph_animation_triangles(welded), want_triangles, sizeof want_triangles);
    ck_assert_uint_eq(sph_animation_edge_count(welded), 2);
    ck_assert_mem_eq(sph_animation_edges(welded), want_edges, sizeof want_edges);
    sph_animation_destroy(welded);
    ck_assert_int_eq(sph_animation_weld(a, 10, NULL, &welded), SPH_OK); /* all is one; the map is not wanted */
    ck_assert_uint_eq(sph_animation_vertex_count(welded), 1);
    ck_assert_uint_eq(sph_animation_triangle_count(welded), 0);
    ck_assert_ptr_null(sph_animation_triangles(welded));
    ck_assert_ptr_null(sph_animation_edges(welded));
    sph_animation_destroy(welded);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(a_chain_is_not_pulled_together_from_end_to_end)
{
    /* Vertices 0.6 apart, tolerance 1: pairs, each led by its lower vertex, whichever way the chain runs. */
    float xyz[3 * 9] = {0};
    sph_animation *a, *welded;
    uint32_t map[9];
    for (size_t i = 0; i < 9; ++i)
        xyz[3 * i + (size_t)_i % 3] = (_i < 3 ? 0.6f : -0.6f) * (float)i;
    ck_assert_int_eq(sph_animation_create(context, 9, 1, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(a, 0, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_weld(a, 1, map, &welded), SPH_OK);
    for (uint32_t i = 0; i < 9; ++i)
        ck_assert_uint_eq(map[i], i / 2);
    sph_animation_destroy(welded);
    sph_animation_destroy(a);
}
END_TEST

/* --- brute force --- */

static bool near_always(const float *xyz, size_t n, size_t frames, size_t a, size_t b, double tolerance)
{
    for (size_t f = 0; f < frames; ++f)
        for (size_t k = 0; k < 3; ++k)
            if (!(fabs((double)xyz[(f * n + a) * 3 + k] - (double)xyz[(f * n + b) * 3 + k]) <= tolerance)) return false;
    return true;
}

static uint32_t brute_map(const sph_animation *a, float tolerance, uint32_t *map)
{
    const size_t n = sph_animation_vertex_count(a), frames = sph_animation_frame_count(a);
    float *xyz = read_all(a);
    uint32_t *leaders = test_malloc(n, sizeof *leaders), count = 0;
    for (uint32_t i = 0; i < n; ++i) {
        uint32_t l = 0;
        while (l < count && !near_always(xyz, n, frames, i, leaders[l], tolerance))
            ++l;
        if (l == count) leaders[count++] = i;
        map[i] = l;
    }
    free(leaders);
    free(xyz);
    return count;
}

static void assert_like_brute_force(const sph_animation *a, float tolerance, uint64_t seed)
{
    const uint32_t n = sph_animation_vertex_count(a);
    uint32_t *want = test_malloc(n, sizeof *want), *got = test_malloc(n, sizeof *got);
    const uint32_t count = brute_map(a, tolerance, want);
    sph_animation *welded;
    ck_assert_int_eq(sph_animation_weld(a, tolerance, got, &welded), SPH_OK);
    ck_assert_msg(sph_animation_vertex_count(welded) == count && memcmp(want, got, n * sizeof *got) == 0,
                  "seed %d, tolerance %g: %u vertices, brute force says %u", (int)seed, (double)tolerance,
                  sph_animation_vertex_count(welded), count);
    sph_animation_destroy(welded);
    free(want);
    free(got);
}

static const float TOLERANCES[] = {0, 1e-30f, 1e-4f, 0.02f, 0.1f, 0.5f, 3, 3e37f};

/* Points that scatter about lattice points, another lattice in each frame; `scale` moves what rounding does. */
static sph_animation *random_points(uint64_t seed)
{
    static const float scales[] = {1, 1e-3f, 1e6f, 1e-30f, 1e35f};
    const uint32_t n = 1 + (uint32_t)(test_random(&seed) % 120), frames = 1 + (uint32_t)(test_random(&seed) % 3);
    const uint64_t sites = 1 + test_random(&seed) % 3;
    const float scale = seed % 2 == 0 ? 1 : scales[seed / 2 % 5], scatter = test_random(&seed) % 2 == 0 ? 0 : 0.03f;
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    sph_animation *a;
    ck_assert_int_eq(sph_animation_create(context, n, frames, &a), SPH_OK);
    for (uint32_t f = 0; f < frames; ++f) {
        for (size_t i = 0; i < 3 * (size_t)n; ++i)
            xyz[i] = scale * ((float)(test_random(&seed) % (sites + 1)) - 1 + scatter * (float)test_random_unit(&seed));
        ck_assert_int_eq(sph_animation_set_frame(a, f, xyz, 0), SPH_OK);
    }
    free(xyz);
    return a;
}

START_TEST(random_points_are_welded_as_by_brute_force)
{
    for (uint64_t seed = 0; seed < 250; ++seed) {
        sph_animation *a = random_points(seed);
        for (size_t t = 0; t < sizeof TOLERANCES / sizeof TOLERANCES[0]; ++t)
            assert_like_brute_force(a, TOLERANCES[t], seed);
        sph_animation_destroy(a);
    }
}
END_TEST

START_TEST(surfaces_welded_beyond_their_edges_are_as_by_brute_force)
{
    sph_animation *a = test_torus(context, 40, 17, 5), *grid = test_grid(context, 30, 20, 2);
    for (size_t t = 0; t < sizeof TOLERANCES / sizeof TOLERANCES[0]; ++t) {
        assert_like_brute_force(a, TOLERANCES[t], 0);
        assert_like_brute_force(grid, TOLERANCES[t] * 1.1f, 0);
    }
    assert_like_brute_force(grid, 1, 0); /* the very distance of its vertices */
    sph_animation_destroy(grid);
    sph_animation_destroy(a);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("animation weld");
    TCase *tc = tcase_create("weld");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_shape_taken_apart_comes_together_again, 0, 6);
    tcase_add_loop_test(tc, vertices_that_part_in_one_frame_stay_two, 0, 5);
    tcase_add_test(tc, simplices_that_come_to_repeat_a_vertex_are_dropped);
    tcase_add_loop_test(tc, a_chain_is_not_pulled_together_from_end_to_end, 0, 6);
    tcase_add_test(tc, random_points_are_welded_as_by_brute_force);
    tcase_add_test(tc, surfaces_welded_beyond_their_edges_are_as_by_brute_force);
    return run_suite(suite, tc);
}
