/* SPDX-License-Identifier: MIT */
/* Exact signs, and triangles that meet: known cases, and CGAL where it is there. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "numeric/predicate.h"
#include "runner.h"
#include "support.h"
#if defined(HAVE_CGAL)
#include "cgal_shim.h"
#endif

static bool meet(const float p[9], const float q[9])
{
    const float *a[3] = {p, p + 3, p + 6}, *b[3] = {q, q + 3, q + 6};
    const bool result = sph__triangles_meet(a, b);
    ck_assert_int_eq(sph__triangles_meet(b, a), result);
    return result;
}

static const float BASE[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
static const struct {
    float other[9];
    bool meets;
    const char *what;
} CASES[] = {{{1, 1, -1, 1, 1, 1, 2, 1, 1}, true, "through the middle"},
             {{1, 1, 1, 1, 1, 2, 2, 1, 2}, false, "above"},
             {{9, 9, -1, 9, 9, 1, 9, 8, 1}, false, "beside"},
             {{1, 1, 0, 1, 1, 2, 2, 1, 2}, true, "touching with a corner"},
             {{-1, 2, -1, -1, 2, 1, 5, 2, 1}, true, "across"},
             {{1, 1, 0, 2, 1, 0, 1, 2, 0}, true, "flat, within"},
             {{8, 8, 0, 9, 8, 0, 8, 9, 0}, false, "flat, apart"},
             {{0, 0, 0, 4, 0, 0, 0, 4, 1}, false, "on one edge, folded up"},
             {{0, 0, 0, 4, 0, 0, 1, 3, 0}, true, "on one edge, lying upon it"},
             {{0, 0, 0, 4, 0, 0, 1, -3, 0}, false, "on one edge, flat and beside"},
             {{0, 0, 0, -4, 1, 2, -3, -1, 1}, false, "at one corner, away"},
             {{0, 0, 0, 1, 1, -1, 1, 1, 1}, true, "at one corner, and through"},
             {{0, 0, 0, 1, 1, 0, 2, 1, 3}, true, "at one corner, and touching"},
             {{0, 4, 0, 0, 0, 0, 4, 0, 0}, false, "the same three corners"},
             {{2, 2, 0, 5, 5, 0, 5, 5, 3}, true, "touching an edge with a corner"}};

START_TEST(triangles_meet_as_they_should)
{
    ck_assert_msg(meet(BASE, CASES[_i].other) == CASES[_i].meets, "%s", CASES[_i].what);
}
END_TEST

START_TEST(signs_of_nearly_flat_tetrahedra_are_exact)
{
    /* on the plane z = x + y, and off it by the last bit of z */
    for (int i = 0; i < 2000; ++i) {
        const float x = 1 + 0.125f * (float)(i % 17), y = 3 + 0.0625f * (float)(i % 29);
        const float a[3] = {0, 0, 0}, b[3] = {1, 0, 1}, c[3] = {0, 1, 1}, d[3] = {x, y, x + y};
        const float above[3] = {x, y, nextafterf(x + y, 99)}, below[3] = {x, y, nextafterf(x + y, -99)};
        ck_assert_int_eq(sph__orient3(a, b, c, d), 0);
        ck_assert_int_eq(sph__orient3(a, b, c, above), 1);
        ck_assert_int_eq(sph__orient3(a, b, c, below), -1);
    }
    { /* numbers so far apart that doubles lose the small ones */
        const float a[3] = {1e20f, 0, 0}, b[3] = {1e20f, 1, 0}, c[3] = {1e20f, 0, 1}, d[3] = {1e-20f, 0, 0};
        const float e[3] = {0, 0, 0}, f[3] = {1, 1, 0}, g[3] = {1e10f, 1e10f, 0}, h[3] = {1e10f, 1e10f, 1e-30f};
        ck_assert_int_eq(sph__orient3(a, b, c, d), -1);
        ck_assert_int_eq(sph__orient2(e, f, g, 0, 1), 0);
        ck_assert_int_eq(sph__orient3(e, f, g, h), 0);
    }
}
END_TEST

#if defined(HAVE_CGAL)
/* _i: how coarse the grid is that coordinates are on; the coarser, the more is flat, touching, or on one line */
START_TEST(random_triangles_meet_where_cgal_says_so)
{
    const double steps[] = {3, 6, 40, 1e6};
    uint64_t random = 11 + (uint64_t)_i;
    int met = 0, compared = 0;
    for (int k = 0; k < 8000; ++k) {
        float p[18], areas[2] = {0, 0};
        bool shared = false;
        for (int i = 0; i < 18; ++i)
            p[i] = (float)floor(steps[_i] * test_random_unit(&random));
        for (int i = 0; i < 2; ++i)
            for (int c = 0; c < 3; ++c) {
                const float *q = p + 9 * i;
                const int x = (c + 1) % 3, y = (c + 2) % 3;
                areas[i] += fabsf((q[3 + x] - q[x]) * (q[6 + y] - q[y]) - (q[3 + y] - q[y]) * (q[6 + x] - q[x]));
            }
        for (int i = 0; i < 9; ++i)
            shared = shared || memcmp(p + 3 * (i / 3), p + 9 + 3 * (i % 3), 3 * sizeof *p) == 0;
        if (shared || !(areas[0] > 0) || !(areas[1] > 0)) continue;
        ++compared;
        met += meet(p, p + 9);
        ck_assert_int_eq(meet(p, p + 9), cgal_triangles_meet(p, p + 9) != 0);
    }
    ck_assert_int_gt(compared, 1000);
    ck_assert_int_gt(met, 100);
}
END_TEST
#endif

START_TEST(a_mesh_has_the_pairs_that_all_against_all_have)
{
    enum { N = 150 };
    static float xyz[3 * N][3];
    static uint32_t triangles[N][3];
    sph_context *context = test_context();
    uint64_t random = 2, pairs, expected = 0;
    for (size_t i = 0; i < 9 * N; ++i)
        xyz[i / 3][i % 3] = (float)(test_random_unit(&random) + (double)(i / 9 % 7) * 0.4);
    for (uint32_t i = 0; i < 3 * N; ++i)
        triangles[i / 3][i % 3] = i % 5 == 0 && i > 9 ? i - 7 : i; /* some share corners */
    for (size_t i = 0; i < N; ++i)
        for (size_t k = 0; k < i; ++k) {
            const float *a[3], *b[3];
            for (int c = 0; c < 3; ++c) {
                a[c] = xyz[triangles[i][c]];
                b[c] = xyz[triangles[k][c]];
            }
            expected += sph__triangles_meet(a, b);
        }
    ck_assert_int_eq(sph_mesh_intersections(context, 3 * N, xyz[0], N, triangles[0], &pairs), SPH_OK);
    ck_assert_uint_eq(pairs, expected);
    ck_assert_uint_gt(pairs, 100);
    triangles[4][1] = 3 * N;
    ck_assert_int_eq(sph_mesh_intersections(context, 3 * N, xyz[0], N, triangles[0], &pairs), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "triangle 4"));
    xyz[7][2] = NAN;
    ck_assert_int_eq(sph_mesh_intersections(context, 3 * N, xyz[0], 4, triangles[0], &pairs), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "vertex 7"));
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("predicate");
    TCase *tc = tcase_create("all");
    tcase_add_loop_test(tc, triangles_meet_as_they_should, 0, (int)(sizeof CASES / sizeof *CASES));
    tcase_add_test(tc, signs_of_nearly_flat_tetrahedra_are_exact);
#if defined(HAVE_CGAL)
    tcase_add_loop_test(tc, random_triangles_meet_where_cgal_says_so, 0, 4);
#endif
    tcase_add_test(tc, a_mesh_has_the_pairs_that_all_against_all_have);
    return run_suite(s, tc);
}
