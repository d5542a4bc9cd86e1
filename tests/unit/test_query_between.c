/* SPDX-License-Identifier: MIT */
/* Two levels: against searching all weights, and where the answer is known. */
#include <check.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "solid.h"
#include "support.h"

static sph_context *context;
static uint64_t state;

static void setup(void)
{
    context = test_context();
    state = 11;
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static double between(double low, double high)
{
    return low + (high - low) * test_random_unit(&state);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(test_random(&state) % count);
}

static void random_solid(test_solid *s, double away)
{
    memset(s, 0, sizeof *s);
    s->sphere_count = 4;
    for (uint32_t i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k)
            s->centers[i][k] = (float)(between(-1, 1) + (k == 0 ? away : 0));
        s->radii[i] = below(4) ? (float)between(0, 0.4) : 0;
    }
    s->edge_count = 1;
    s->edges[0][0] = 3;
    s->triangle_count = 1;
    s->triangles[0][1] = 1 + below(2);
    s->triangles[0][2] = 2;
}

/* The least |c - d| - r - t, by halving a grid over the weights of the first around its best place. */
static double search_simplex(const test_solid *a, const uint32_t *n, int count, const test_solid *b,
                             const double shift[3])
{
    double best = DBL_MAX, at[2] = {1.0 / 3, 1.0 / 3}, step = 1.0 / 3;
    for (int round = 0; round < 40; ++round, step *= 0.6) {
        const double middle[2] = {at[0], at[1]};
        for (int i = -2; i <= 2; ++i)
            for (int j = -2; j <= 2; ++j) {
                double u = middle[0] + step * i / 2, v = middle[1] + step * j / 2, x[3], r, f;
                u = fmin(1, fmax(0, u));
                v = count < 3 ? 0 : fmin(1 - u, fmax(0, v));
                if (count < 2) u = 0;
                for (int k = 0; k < 3; ++k)
                    x[k] = shift[k] + (1 - u - v) * a->centers[n[0]][k] + u * a->centers[n[count > 1]][k] +
                           v * a->centers[n[count > 2 ? 2 : 0]][k];
                r = (1 - u - v) * a->radii[n[0]] + u * a->radii[n[count > 1]] + v * a->radii[n[count > 2 ? 2 : 0]];
                f = test_solid_distance(b, x) - r;
                if (f < best) {
                    best = f;
                    at[0] = u;
                    at[1] = v;
                }
            }
    }
    return best;
}

static double search(const test_solid *a, const test_solid *b, const double shift[3])
{
    return fmin(search_simplex(a, a->triangles[0], 3, b, shift), search_simplex(a, a->edges[0], 2, b, shift));
}

static sph_query *make_query(const test_solid *s, int32_t search_mode)
{
    sph_level *level = test_solid_level(context, s);
    sph_query *q = NULL;
    sph_query_options options;
    sph_query_options_init(&options, sizeof options);
    options.search = search_mode;
    ck_assert_int_eq(sph_query_create(level, &options, &q), SPH_OK);
    sph_level_destroy(level);
    return q;
}

/* The point on each is on its own boundary sphere; apart, their distance is the gap. */
static void check_gap(const sph_gap *g, double slack)
{
    double apart = 0;
    for (int k = 0; k < 3; ++k) {
        const double d = g->first.point[k] - g->second.point[k];
        ck_assert_double_eq_tol(d, g->distance * g->second.normal[k], slack);
        ck_assert_double_eq_tol(g->first.normal[k], -g->second.normal[k], 1e-12);
        apart += d * d;
    }
    ck_assert_double_eq_tol(sqrt(apart), fabs(g->distance), slack);
}

START_TEST(the_gap_is_the_least_over_all_pairs_of_interpolated_spheres)
{
    static const double STILL[3] = {0, 0, 0};
    for (int turn = 0; turn < 6; ++turn) {
        test_solid a, b;
        sph_query *p, *q;
        sph_gap gap, back;
        double want;
        random_solid(&a, turn % 3 == 0 ? 0.5 : 3);
        random_solid(&b, 0);
        want = fmin(search(&a, &b, STILL), search(&b, &a, STILL));
        p = make_query(&a, SPH_SEARCH_AUTO);
        q = make_query(&b, turn % 2 ? SPH_SEARCH_TREE : SPH_SEARCH_AUTO);
        ck_assert_int_eq(sph_query_between(p, q, &gap), SPH_OK);
        ck_assert_int_eq(sph_query_between(q, p, &back), SPH_OK);
        ck_assert_double_eq_tol(gap.distance, want, 1e-5);
        ck_assert_double_eq_tol(back.distance, gap.distance, 1e-8);
        ck_assert_uint_eq(gap.hit, gap.distance <= 0);
        check_gap(&gap, 1e-6);
        sph_query_destroy(p);
        sph_query_destroy(q);
    }
}
END_TEST

START_TEST(either_order_and_either_search_gives_the_same_gap)
{
    for (int turn = 0; turn < 300; ++turn) {
        const float motion[3] = {(float)between(-6, 1), (float)between(-1, 1), (float)between(-1, 1)};
        const float against[3] = {-motion[0], -motion[1], -motion[2]};
        test_solid a, b;
        sph_query *p, *q, *t;
        sph_gap gap[3];
        random_solid(&a, between(0, 4));
        random_solid(&b, 0);
        p = make_query(&a, SPH_SEARCH_EXHAUSTIVE);
        q = make_query(&b, SPH_SEARCH_EXHAUSTIVE);
        t = make_query(&b, SPH_SEARCH_TREE);
        ck_assert_int_eq(sph_query_between(p, q, &gap[0]), SPH_OK);
        ck_assert_int_eq(sph_query_between(q, p, &gap[1]), SPH_OK);
        ck_assert_int_eq(sph_query_between(p, t, &gap[2]), SPH_OK);
        ck_assert_double_eq_tol(gap[1].distance, gap[0].distance, 1e-8);
        ck_assert_double_eq_tol(gap[2].distance, gap[0].distance, 1e-8);
        ck_assert_int_eq(sph_query_cast_between(p, motion, q, &gap[0]), SPH_OK);
        ck_assert_int_eq(sph_query_cast_between(q, against, p, &gap[1]), SPH_OK);
        ck_assert_int_eq(sph_query_cast_between(p, motion, t, &gap[2]), SPH_OK);
        ck_assert_uint_eq(gap[1].hit, gap[0].hit);
        ck_assert_double_eq_tol(gap[1].s, gap[0].s, 1e-4);
        ck_assert_double_eq_tol(gap[2].s, gap[0].s, 1e-6);
        sph_query_destroy(p);
        sph_query_destroy(q);
        sph_query_destroy(t);
    }
}
END_TEST

START_TEST(a_moved_level_touches_where_its_gap_closes)
{
    int hits = 0;
    for (int turn = 0; turn < 200; ++turn) {
        float motion[3] = {-5, (float)between(-1, 1), (float)between(-1, 1)}, moved[4][3];
        test_solid a, b;
        sph_query *p, *q;
        sph_gap gap, there;
        double s;
        random_solid(&a, 4);
        random_solid(&b, 0);
        p = make_query(&a, SPH_SEARCH_AUTO);
        q = make_query(&b, SPH_SEARCH_AUTO);
        ck_assert_int_eq(sph_query_cast_between(p, motion, q, &gap), SPH_OK);
        hits += gap.hit != 0;
        for (int step = 0; step <= 8; ++step) { /* up to it and at it */
            s = gap.s * step / 8;
            for (int i = 0; i < 4; ++i)
                for (int k = 0; k < 3; ++k)
                    moved[i][k] = (float)(a.centers[i][k] + s * motion[k]);
            ck_assert_int_eq(sph_query_pose_centers(p, moved[0], 0, NULL), SPH_OK);
            ck_assert_int_eq(sph_query_between(p, q, &there), SPH_OK);
            ck_assert_double_ge(there.distance, -2e-6);
        }
        if (gap.hit) {
            ck_assert_double_eq_tol(there.distance, 0, 2e-6);
            check_gap(&gap, 1e-6);
        }
        sph_query_destroy(p);
        sph_query_destroy(q);
    }
    ck_assert_int_gt(hits, 50);
}
END_TEST

START_TEST(balls_meet_where_arithmetic_says)
{
    const test_solid ball = {.sphere_count = 1, .centers = {{7, 0, 0}}, .radii = {1}};
    const test_solid rod = {
        .sphere_count = 2, .edge_count = 1, .edges = {{0, 1}}, .centers = {{0, 0, -9}, {0, 0, 9}}, .radii = {2, 2}};
    const float motion[3] = {-8, 0, 0}, aside[3] = {0, 0, 100}, over[3] = {-14, 7.5f, 0};
    sph_query *p = make_query(&ball, SPH_SEARCH_AUTO), *q = make_query(&rod, SPH_SEARCH_AUTO);
    sph_gap g;
    ck_assert_int_eq(sph_query_between(p, q, &g), SPH_OK);
    ck_assert_double_eq_tol(g.distance, 4, 1e-8);
    ck_assert_double_eq_tol(g.second.weights[0], 0.5, 1e-6);
    ck_assert_double_eq_tol(g.first.point[0], 6, 1e-6);
    ck_assert_int_eq(sph_query_cast_between(p, motion, q, &g), SPH_OK);
    ck_assert_uint_eq(g.hit, 1);
    ck_assert_double_eq_tol(g.s, 0.5, 1e-6);
    ck_assert_double_eq_tol(g.second.point[0], 2, 1e-6);
    ck_assert_double_eq_tol(g.first.point[0], 2, 1e-6);
    ck_assert_int_eq(sph_query_cast_between(p, aside, q, &g), SPH_OK);
    ck_assert_uint_eq(g.hit, 0);
    ck_assert_double_eq(g.s, 1);
    ck_assert_int_eq(sph_query_cast_between(p, over, q, &g), SPH_OK);
    ck_assert_uint_eq(g.hit, 0);
    ck_assert_int_eq(sph_query_between(q, q, &g), SPH_OK);
    ck_assert_double_eq_tol(g.distance, -4, 1e-8);
    ck_assert_int_eq(sph_query_cast_between(q, motion, q, &g), SPH_OK);
    ck_assert_uint_eq(g.hit, 1);
    ck_assert_double_eq(g.s, 0);
    sph_query_destroy(p);
    sph_query_destroy(q);
}
END_TEST

START_TEST(bad_arguments_are_refused)
{
    const test_solid ball = {.sphere_count = 1, .radii = {1}};
    const float motion[3] = {0, NAN, 0}, still[3] = {0, 0, 0};
    sph_query *q = make_query(&ball, SPH_SEARCH_AUTO);
    sph_gap g = {.s = 7};
    ck_assert_int_eq(sph_query_between(NULL, q, &g), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_between(q, NULL, &g), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_between(q, q, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_cast_between(q, motion, q, &g), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_cast_between(q, NULL, q, &g), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_cast_between(NULL, still, q, &g), SPH_E_INVALID);
    ck_assert_double_eq(g.s, 7);
    sph_query_destroy(q);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("query_between");
    TCase *tc = tcase_create("query_between");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, the_gap_is_the_least_over_all_pairs_of_interpolated_spheres);
    tcase_add_test(tc, either_order_and_either_search_gives_the_same_gap);
    tcase_add_test(tc, a_moved_level_touches_where_its_gap_closes);
    tcase_add_test(tc, balls_meet_where_arithmetic_says);
    tcase_add_test(tc, bad_arguments_are_refused);
    return run_suite(s, tc);
}
